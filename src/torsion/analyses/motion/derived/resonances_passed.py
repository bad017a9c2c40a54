"""Resonances that a changing speed passes: when, how fast, and how much of the steady amplitude is reached.

With the exciting phase w t + a t**2/2 and x = t sqrt(a) the amplitude is that of A, A' + p A = exp(i x**2/2) to within
w/sqrt(a), p = zeta w/sqrt(a), from long before: |A| = sqrt(pi/2) |W(i (p/(2 b) - b x))|, b = exp(-i pi/4)/sqrt(2), with
W Faddeeva's function; the steady amplitude is 1/p.

>>> [round(share_of_steady(p), 3) for p in (0.08, 0.4, 1.58, 20.0)]
[0.204, 0.649, 0.964, 1.0]
"""

import cmath
import math
from collections.abc import Iterator, Sequence

import numpy as np

from torsion.analyses.motion.train.following_torques import Follower
from torsion.analyses.motion.transient_motion import Passage
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.motion.loaded_modes import ModalTrain
from torsion.kernels.motion.torque_laws import Wave
from torsion.sources import source

NEAR = 1e-9  # relative: a frequency that changes by less does not pass


def _excitations(
    system: System, follows: Sequence[Follower], time: FloatArray, speed: FloatArray
) -> Iterator[tuple[str, FloatArray]]:
    """What excites, and its frequency (times,) rad/s."""
    for follower in follows:
        law, words = follower.law, follower.words
        own_speed = abs(float(system.speed_ratio[follower.stations[0]])) * speed
        if isinstance(law, Wave) and np.ndim(law.order) == 0:
            frequency = np.abs(law.order * own_speed + complex(law.rate).imag)
            yield words, law.window.holds(time) * frequency
        elif follower.cut is not None:
            for order in follower.cut.orders:
                yield f"order {order} of {words}", order * own_speed


def mean_speed(system: System, turning: FloatArray) -> FloatArray:
    """(times,) rad/s of the reference: where the train is fixed, else of its momentum."""
    ratio = np.abs(system.speed_ratio)
    weight = np.where(system.held, 1.0, 0.0) if system.held.any() else system.lumped_inertia * ratio
    return np.asarray(weight @ turning / (weight @ ratio))


def passages(
    system: System,
    follows: Sequence[Follower],
    train: ModalTrain,
    time: FloatArray,
    turning: FloatArray,
) -> tuple[Passage, ...]:
    """In the order of time; turning: (stations, times) rad/s."""
    passages, speed = list[Passage](), mean_speed(system, turning)
    ratios = np.diag(train.damping)[train.rigid :] / (2.0 * train.w)
    for words, excited in _excitations(system, follows, time, speed):
        rate = np.diff(excited) / np.diff(time)
        for mode, (w, ratio) in enumerate(zip(train.w.tolist(), ratios.tolist(), strict=True), 1):
            is_crossed = np.diff(np.signbit(excited - w)) != 0
            samples = np.flatnonzero(is_crossed & (np.abs(rate) * time[-1] > NEAR * w))
            for sample in samples.tolist():
                share = (w - excited[sample]) / (excited[sample + 1] - excited[sample])
                when = float(time[sample] + share * (time[sample + 1] - time[sample]))
                passed = abs(float(rate[sample]))
                passage = Passage(
                    mode,
                    words,
                    when,
                    float(np.interp(when, time, speed)),
                    w / (2.0 * math.pi),
                    2.0 * ratio * w / passed,
                    share_of_steady(ratio * w / math.sqrt(passed)),
                )
                passages.append(passage)
    return tuple(sorted(passages, key=lambda passage: passage.time))


LATEST = 4.0  # x by which every amplitude has been at its greatest: without damping at 2.16
GRID = 801  # points; the second search is between two of the first


@source("Lewis1932")
def share_of_steady(p: float) -> float:
    """The greatest amplitude over the steady one."""
    from scipy.special import wofz

    turn = cmath.exp(-0.25j * math.pi) / math.sqrt(2.0)
    low, high, best = 0.0, LATEST, 0.0
    for _ in range(2):
        x = np.linspace(low, high, GRID)
        size = p * math.sqrt(math.pi / 2.0) * np.abs(wofz(1j * (p / (2.0 * turn) - turn * x)))
        top = int(np.argmax(size))
        best = float(size[top])
        low, high = float(x[max(top - 1, 0)]), float(x[min(top + 1, GRID - 1)])
    return best
