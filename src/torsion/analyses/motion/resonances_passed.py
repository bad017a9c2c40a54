"""Resonances that a changing speed passes: when, how fast, and how much of the steady amplitude is reached."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.motion.following_torques import Following
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.kernels.motion.damped_motion import ModalTrain
from torsion.kernels.motion.resonance_passage import share_of_steady
from torsion.kernels.motion.torque_laws import Wave
from torsion.results import reported, result

NEAR = 1e-9  # relative: a frequency that changes by less does not pass


@reported
class Passage:
    """A mode that an order, or a pulsation, meets while the speed changes."""

    mode: int = result("", (), "the elastic mode, from 1")
    what: str = result("", (), "what excites it")
    time: float = result("s", (), "when")
    speed: float = result("rad/s", (), "reference speed there")
    frequency: float = result("Hz", (), "of the mode")
    seconds: float = result("s", (), "how long within the range of half the power")
    share: float = result(
        "1", (), "maximum amplitude / steady amplitude at that speed; by a closed form"
    )


def _excitations(
    system: System, follows: Following, time: FloatArray, speed: FloatArray
) -> Iterator[tuple[str, FloatArray]]:
    """What excites, and its frequency (times,) rad/s."""
    ratio = np.abs(system.speed_ratio[follows.station])
    joints = dict(zip(follows.first, follows.cuts, strict=True))
    for law, words in zip(follows.laws, follows.words, strict=True):
        at = float(ratio[law.at[0]])
        if isinstance(law, Wave):
            yield (
                words,
                law.window.holds(time) * np.abs(law.order * at * speed + complex(law.rate).imag),
            )
        elif law.at[0] in joints:
            for order in joints[law.at[0]].orders:
                yield f"order {order} of {words}", order * at * speed


def mean_speed(system: System, turning: FloatArray) -> FloatArray:
    """(times,) rad/s of the reference: where the train is fixed, else of its momentum."""
    ratio = np.abs(system.speed_ratio)
    weight = np.where(system.held, 1.0, 0.0) if system.held.any() else system.lumped_inertia * ratio
    return np.asarray(weight @ turning / (weight @ ratio))


def passages(
    system: System, follows: Following, train: ModalTrain, time: FloatArray, turning: FloatArray
) -> tuple[Passage, ...]:
    """In the order of time; turning: (stations, times) rad/s."""
    found, speed = list[Passage](), mean_speed(system, turning)
    ratio = np.diag(train.damping)[train.rigid :] / (2.0 * train.w)
    for words, excited in _excitations(system, follows, time, speed):
        rate = np.diff(excited) / np.diff(time)
        for mode, (w, damping) in enumerate(zip(train.w.tolist(), ratio.tolist(), strict=True)):
            here = np.flatnonzero(
                (np.diff(np.signbit(excited - w)) != 0) & (np.abs(rate) * time[-1] > NEAR * w)
            )
            for at in here.tolist():
                share = (w - excited[at]) / (excited[at + 1] - excited[at])
                when = float(time[at] + share * (time[at + 1] - time[at]))
                passed = abs(float(rate[at]))
                found.append(
                    Passage(
                        mode + 1,
                        words,
                        when,
                        float(np.interp(when, time, speed)),
                        w / (2.0 * math.pi),
                        2.0 * damping * w / passed,
                        share_of_steady(damping * w / math.sqrt(passed)),
                    )
                )
    return tuple(sorted(found, key=lambda one: one.time))
