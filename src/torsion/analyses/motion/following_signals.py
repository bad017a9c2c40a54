"""Torques that follow the motion of a train with nonlinear couplings: polynomial signals of it, step by step."""

import math
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from torsion.analyses.motion.following_torques import Following
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.findings import Progress
from torsion.kernels.motion.collocation import Marched
from torsion.kernels.motion.event_driven_collocation import Interfaces, event_driven_under_laws
from torsion.kernels.motion.event_driven_motion import EventDrivenMotion, March
from torsion.kernels.motion.interface_motion import Known
from torsion.kernels.motion.piecewise_elements import Element
from torsion.kernels.motion.piecewise_train import State

CUT_SHORT = 0.1  # of the tolerance: events end steps inside, where collocation is not as accurate as at their ends


@dataclass(frozen=True)
class FollowingSignals:
    """One signal for all laws at a station, and one for every interface of a joint."""

    follows: Following
    system: System
    settings: TransientSettings

    @cached_property
    def signal(self) -> IntArray:
        """(interfaces,) which signal each is a part of."""
        joints = len(self.follows.station) - 2 * len(self.follows.cuts)  # they stand last
        own, signal = np.unique(self.follows.station[:joints], return_inverse=True)
        return np.concatenate([signal, len(own) + np.arange(2 * len(self.follows.cuts))])

    @property
    def number(self) -> int:
        """Of signals."""
        return int(self.signal.max(initial=-1)) + 1

    @property
    def where(self) -> FloatArray:
        """(stations, signals) where they act."""
        found = np.zeros((len(self.system.stations), self.number))
        found[self.follows.station, self.signal] = 1.0
        return found

    @property
    def carried(self) -> FloatArray:
        """(spans, signals) that joints carry of them at once."""
        each, found = (
            np.zeros((len(self.system.spans), len(self.signal))),
            np.zeros((len(self.system.spans), self.number)),
        )
        self.follows.carried(self.system, each)
        np.add.at(found.T, self.signal, each.T)
        return found

    @property
    def means(self) -> tuple[FloatArray, FloatArray]:
        """(stations,) and (spans,) N m: mean torques of the joints on their ends, and in the spans that carry them."""
        acting, carried = np.zeros(len(self.system.stations)), np.zeros(len(self.system.spans))
        for cut in self.follows.cuts:
            acting[[cut.front, cut.behind]] += -cut.mean, cut.mean
            for span, which, factor in cut.carried(self.system):
                carried[span] += factor * (cut.mean if which else -cut.mean)
        return acting, carried

    def _turning(self, time: FloatArray) -> Known:
        """How the interfaces turn without any torque."""
        angle, speed, rate = (one[self.follows.station] for one in self.follows.carrier.at(time))
        return angle, speed, rate

    def march(
        self,
        march: March,
        state: State,
        z: FloatArray,
        shape: FloatArray,
        untwisted: FloatArray,
        progress: Progress,
    ) -> tuple[EventDrivenMotion, Marched]:
        """The motion of a train of shapes (stations, rigid motions + modes), from a state at time 0.

        untwisted: (modes,) places from which the angles count.
        """
        shown = partial(progress, "torques that follow")
        at = Interfaces(shape[self.follows.station], self.signal, self._turning, untwisted)
        scheme = self.follows.scheme(self.system, self.settings, march.train.signals.breaks)
        scheme = replace(
            scheme,
            duration=march.duration,
            longest=march.fineness * scheme.longest,
            tolerance=CUT_SHORT * march.fineness**4 * scheme.tolerance,
        )
        return event_driven_under_laws(march, state, z, at, self.follows.laws, scheme, shown)


def quickest(w: FloatArray, elements: tuple[Element, ...], duration: float) -> float:
    """s, of a radian of the fastest motion of the modes and elements, about."""
    squares = [
        one.stiffness * float(one.ends @ one.ends)
        for one in elements
        if math.isfinite(one.stiffness)
    ]
    return 1.0 / max(
        float(w.max(initial=0.0)), math.sqrt(max(squares, default=0.0)), 1.0 / duration
    )
