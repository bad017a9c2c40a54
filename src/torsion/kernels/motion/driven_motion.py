"""The motion of a train under given torques and under such as follow it: the sum of both, to be read at any times."""

from dataclasses import dataclass, fields

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.damped_motion import Motion
from torsion.kernels.motion.interface_motion import Steps


@dataclass(frozen=True)
class DrivenMotion(Motion):
    """The last loads are the torques that follow the motion."""

    steps: Steps

    @property
    def cuts(self) -> FloatArray:
        """(cuts,) s, where the torques have kinks."""
        return np.union1d(super().cuts, self.steps.begin)

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and speeds (rigid motions + modes, times) at times >= 0 (s) that ascend."""
        place, speed = super().at(time)
        turned, turning, y = self.steps.at(time)
        further = self.modal(y)
        return place + np.concatenate([turned, further[0]]), speed + np.concatenate(
            [turning, further[1]]
        )

    def loads_at(self, time: FloatArray) -> FloatArray:
        """(loads, times)."""
        return self._with(super().loads_at(time), self.steps.torque(time))

    def load_rates_at(self, time: FloatArray) -> FloatArray:
        """(loads, times) per second."""
        return self._with(super().load_rates_at(time), self.steps.torque_rate(time))

    def _with(self, given: FloatArray, following: FloatArray) -> FloatArray:
        given[len(given) - len(following) :] = following
        return given


def driven(given: Motion, steps: Steps) -> DrivenMotion:
    """The given motion with the steps of what follows it."""
    return DrivenMotion(
        **{one.name: getattr(given, one.name) for one in fields(given)}, steps=steps
    )
