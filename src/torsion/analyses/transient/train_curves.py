"""Torques of the spans and speeds of the stations of a train at any times, and their samples with the peaks between."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.analyses.transient.following_torques import Carrier, Following
from torsion.analyses.transient.peaks import Extremes
from torsion.analyses.transient.state_before import State
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress
from torsion.kernels.transient.damped_motion import Motion
from torsion.kernels.transient.driven_motion import DrivenMotion

BLOCK = 2**21  # values of one array at once


@dataclass(frozen=True)
class TrainCurves:
    """Torques and speeds at any time."""

    system: System
    found: Modes
    before: State
    shape: FloatArray  # (stations, rigid motions + modes)
    motion: Motion | DrivenMotion
    slowed: FloatArray  # (spans, rigid motions + modes) N m s/rad: the damping part of the torques, of speeds
    carrier: Carrier
    follows: Following | None

    @cached_property
    def carried(self) -> FloatArray | None:
        """(spans, interfaces): torques that joints carry; None where there are none."""
        carried = None if self.follows is None else self.follows.carried(self.system)
        return None if carried is None or not carried.any() else carried

    def torque(self, time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Torques (spans, times) with the damping part, their rates, and speeds (stations, times) of the stations."""
        place, speed = self.motion.at(time)
        vibration, its_rate = _vibration(self.before, time)
        elastic = self.found.torque @ place[self.motion.train.rigid :]
        torque = self.before.torque[:, None] + elastic + self.slowed @ speed + vibration
        rate = self.found.torque @ speed[self.motion.train.rigid :] + its_rate
        if self.slowed.any():
            rate += self.slowed @ self.motion.acceleration(time, place, speed)
        angle, turning, _ = self.carrier.at(time)
        turning += self.shape @ speed
        if self.carried is not None and self.follows is not None and isinstance(self.motion, DrivenMotion):
            torque += self.carried @ self.motion.steps.torque(time)
            rate += self.carried @ self.motion.steps.torque_rate(time)
            self.follows.patched(self.system, angle + self.shape @ place, turning)
        return torque, rate, turning

    def torque_of(self, span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Torque and its rate (pairs,) of every span at a time of its own."""
        order = np.argsort(at, kind="stable")
        place, speed, gained = np.empty((3, self.shape.shape[1], len(at)))
        place[:, order], speed[:, order] = self.motion.at(at[order])
        vibration, its_rate = _vibration(self.before, at, span)
        elastic, slowed = self.found.torque[span], self.slowed[span]
        rigid = self.motion.train.rigid
        torque = self.before.torque[span] + _paired(elastic, place[rigid:]) + _paired(slowed, speed) + vibration
        rate = _paired(elastic, speed[rigid:]) + its_rate
        if slowed.any():
            gained[:, order] = self.motion.acceleration(at[order], place[:, order], speed[:, order])
            rate = rate + _paired(slowed, gained)
        if self.carried is not None and isinstance(self.motion, DrivenMotion):
            torque = torque + _paired(self.carried[span], self.motion.steps.torque(at))
            rate = rate + _paired(self.carried[span], self.motion.steps.torque_rate(at))
        return torque, rate


def _paired(rows: FloatArray, columns: FloatArray) -> FloatArray:
    """Of row k and column k."""
    return np.asarray(np.einsum("km,mk->k", rows, columns))


def sampled(
    curves: TrainCurves, time: FloatArray, progress: Progress
) -> tuple[FloatArray, FloatArray, tuple[tuple[FloatArray, FloatArray], ...]]:
    """Torques (spans, times), speeds (stations, times); values and times of the greatest torque and its negative."""
    spans, stations = len(curves.slowed), len(curves.shape)
    torque, turning = np.empty((spans, len(time))), np.empty((stations, len(time)))
    high, low = Extremes.none(spans), Extremes.none(spans)
    size = max(2, BLOCK // max(curves.shape.shape[1], spans, stations))
    for first in range(0, len(time) - 1, size):
        part = slice(first, min(first + size, len(time) - 1) + 1)  # a block begins with the last sample before it
        torque[:, part], rate, turning[:, part] = curves.torque(time[part])
        high.add(time[part], torque[:, part], rate)
        low.add(time[part], -torque[:, part], -rate)
        progress("motion over time", part.stop / len(time))

    def negative(span: IntArray, at: FloatArray) -> tuple[FloatArray, FloatArray]:
        value, rate = curves.torque_of(span, at)
        return -value, -rate

    ends = []
    for sampled, extremes, function in ((torque, high, curves.torque_of), (-torque, low, negative)):
        top, when = extremes.exact(function)
        best = sampled.argmax(axis=1)
        of_samples = sampled[np.arange(spans), best]
        ends.append((np.maximum(top, of_samples), np.where(top >= of_samples, when, time[best])))
    return torque, turning, tuple(ends)


def _vibration(before: State, time: FloatArray, span: IntArray | None = None) -> tuple[FloatArray, FloatArray]:
    """Torque of the steady vibration and its rate of change, (spans, times); with `span` of its pairs with times."""
    turned = np.exp(1j * np.multiply.outer(before.frequency, time))
    growing = 1j * before.frequency[:, None] * turned
    if span is None:
        torque, rate = (before.amplitude.T @ wave for wave in (turned, growing))
    else:
        torque, rate = ((before.amplitude[:, span] * wave).sum(axis=0) for wave in (turned, growing))
    return torque.real, rate.real
