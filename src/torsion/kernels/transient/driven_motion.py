"""The motion of a train under given torques and under such as follow it: the sum of both, to be read at any times."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.transient.damped_motion import ModalTrain, Motion
from torsion.kernels.transient.interface_motion import Steps


@dataclass(frozen=True)
class DrivenMotion:
    """As `Motion` is read."""

    given: Motion
    steps: Steps
    column: FloatArray  # (rigid motions + modes, interfaces)

    @property
    def train(self) -> ModalTrain:
        """Of both."""
        return self.given.train

    @property
    def cuts(self) -> FloatArray:
        """(cuts,) s, where the torques have kinks."""
        return np.union1d(self.given.cuts, self.steps.begin)

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and speeds (rigid motions + modes, times) at times >= 0 (s) that ascend."""
        place, speed = self.given.at(time)
        turned, turning, y = self.steps.at(time)
        further = self.given.modal(y)
        return place + np.concatenate([turned, further[0]]), speed + np.concatenate([turning, further[1]])

    def force_at(self, time: FloatArray) -> FloatArray:
        """(rigid motions + modes, times) of all torques."""
        return np.asarray(self.given.force_at(time) + self.column @ self.steps.torque(time))

    def acceleration(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(rigid motions + modes, times) by the balance of torques, of what `at` returned."""
        train = self.train
        return np.asarray(self.force_at(time) - train.damping @ speed - train.w_of_all[:, None] ** 2 * place)
