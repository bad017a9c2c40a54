"""Resonances that a changing speed passes: when, how fast, and how much of the steady amplitude is reached."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from torsion.analyses.motion.train.following_torques import Follower
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.motion.damped_modes import ModalTrain
from torsion.kernels.motion.resonance_passage import share_of_steady
from torsion.kernels.motion.torque_laws import Wave
from torsion.results import reported, result

NEAR = 1e-9  # relative: a frequency that changes by less does not pass


@reported
class Passage:
    """A mode that an order, or a pulsation, meets while the speed changes."""

    mode: int = result("the elastic mode, from 1")
    what: str = result("what excites it")
    time: float = result("s", "when")
    speed: float = result("rad/s", "reference speed there")
    frequency: float = result("Hz", "of the mode")
    seconds: float = result("s", "how long within the range of half the power")
    share: float = result(
        "1", "maximum amplitude / steady amplitude at that speed; by a closed form"
    )


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
