"""The times at which curves are looked at, so that no peak stands between them unseen: samples, and what is faster.

Four times to a period of the fastest mode, of every torque that turns while it acts, and of the steady vibration; some
between every two cuts, at which a torque begins or ends, and closer and closer behind each, for what dies away fast.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray

PER_PERIOD = 4.0  # times from which a vibration is resolved
# where cycles are counted: a cubic through values and rates is then exact to 1e-4
PER_PERIOD_COUNTED = 16.0
BETWEEN = 16  # times between two cuts
MOST_BETWEEN = 200_000  # of them altogether, where cuts are many
MOST_TIMES = 4_000_000
CLOSER = math.sqrt(0.5)  # every next time behind a cut
MOST_CLOSER = 60


@dataclass(frozen=True)
class Wave:
    """Something that vibrates for a time."""

    begin: float  # s
    end: float
    w: float  # rad/s


@dataclass(frozen=True)
class Looked:
    """Times that ascend, and which of them are the samples."""

    time: FloatArray
    sample: IntArray
    turn: float  # rad of the fastest in a step, at most
    left: float  # rad/s from which on some waves are not resolved: inf where all are


def looked_at(
    time: FloatArray,
    finer: int,
    cuts: FloatArray,
    waves: Iterable[Wave],
    quickest: float,
    budget: float,
    per_period: float,
) -> Looked:
    """From samples, and how many times finer the modes are resolved.

    quickest: 1/s of all that dies away. budget: times that there may be, besides samples and cuts. per_period: times to a
    period.
    """
    last, step = float(time[-1]), float(time[1] - time[0]) / finer
    samples = np.arange(len(time))
    base = np.interp(np.arange((len(time) - 1) * finer + 1) / finer, samples, time)
    cuts = np.unique(cuts[(cuts > 0.0) & (cuts < last)])
    between = _times_between(np.array([0.0, *cuts, last]), quickest)
    times = [base, np.nextafter(cuts, 0.0), cuts, *between]
    room, left, turn, resolved = min(budget, MOST_TIMES), math.inf, 0.0, 2.0 * math.pi / per_period
    for wave in sorted(waves, key=lambda wave: wave.w):
        begin, end = max(wave.begin, 0.0), min(wave.end, last)
        if begin >= end or wave.w * step <= resolved:
            continue
        number = math.ceil((end - begin) * wave.w * per_period / (2.0 * math.pi))
        if number > room:
            left = min(left, wave.w)
            continue
        room, turn = room - number, resolved
        times.append(np.linspace(begin, end, number + 1)[:-1])
    moments = np.unique(np.concatenate(times))
    return Looked(moments, np.searchsorted(moments, time), turn, left)


def _times_between(edges: FloatArray, quickest: float) -> list[FloatArray]:
    """Times between edges, closer and closer behind each while what dies away is felt."""
    begin, length = edges[:-1], np.diff(edges)
    number = max(2, min(BETWEEN, MOST_BETWEEN // len(begin)))
    times = [begin + length * (share / number) for share in range(1, number)]
    share = CLOSER / number
    for _ in range(MOST_CLOSER):
        needed = length * share * quickest > 1.0 / BETWEEN
        if not needed.any():
            break
        times.append((begin + length * share)[needed])
        share *= CLOSER
    return times
