"""All lines of a response together: the half range of their sum over the common cycle, true to phase."""

import math
from fractions import Fraction

import numpy as np

from torsion.analyses.response.over_speed import Response, Synthesis
from torsion.assembly.system import System
from torsion.kernels.tree import ComplexArray, FloatArray
from torsion.kernels.tree_response import Status

SAMPLES = 32  # of the highest harmonic, before extremes are refined
MOST_SAMPLES = 20_000  # of a cycle; a longer one is given by its bound
BLOCK_VALUES = 65_536  # samples held at once (0.5 MB stays in a processor's cache)
SAMPLING_LOSS = (math.pi / SAMPLES) ** 2 / 2.0  # of the bound: most that the sample beside a maximum stands lower
SECOND = 2e-5  # of the bound: maxima that the parabola, good to (2 pi/32)^4/128 = 1.2e-5, cannot tell from the highest
NEWTON_STEPS = 3  # from the parabola's place, a thousandth of a cycle of the highest harmonic off: quadratic from there

__all__ = ["Synthesis", "synthesis"]


def synthesis(system: System, response: Response) -> Synthesis:
    """Half range, peak with the mean torque, RMS and arithmetic bound of every span at every speed.

    Orders are summed as phasors in time. Lines of fixed frequency have no common cycle with them: their magnitudes
    are added. The same holds, as a bound, where the cycle of all orders is too long; `turns` is 0 then.
    Where a line has no answer (status singular), so has the sum: it is infinite.
    """
    size = np.abs(response.torque)
    bound = size.sum(axis=1)
    rms = np.sqrt((size**2).sum(axis=1) / 2.0)
    ordered = np.array([line.order is not None for line in response.lines], dtype=bool)
    fixed = size[:, ~ordered].sum(axis=1)
    orders = [line.order for line in response.lines if line.order is not None]
    turns, harmonics = common_cycle(orders)
    highest, lowest = (np.zeros_like(bound) for _ in range(2))
    if turns == 0:
        highest[:] = size[:, ordered].sum(axis=1)
        lowest = -highest
    else:
        phasors = np.moveaxis(response.torque[:, ordered], 1, 2).reshape(-1, len(orders))
        highest, lowest = (values.reshape(bound.shape) for values in extremes(phasors, harmonics))
    half_range = (highest - lowest) / 2.0 + fixed
    peak = np.maximum(np.abs(response.mean + highest + fixed), np.abs(response.mean + lowest - fixed))
    answered = np.isfinite(bound) & (response.status != Status.SINGULAR).all(axis=1)[:, None]
    values = [np.where(answered, value, np.inf) for value in (half_range, peak, rms, bound)]
    return Synthesis(values[0], values[1], values[2], values[3], turns)


def common_cycle(orders: list[Fraction]) -> tuple[Fraction, np.ndarray]:
    """Turns after which all orders repeat, and each order in cycles of that; 0 turns where that is too long."""
    if not orders:
        return Fraction(0), np.empty(0, dtype=np.int64)
    numerator = math.gcd(*(order.numerator for order in orders))
    base = Fraction(numerator, math.lcm(*(order.denominator for order in orders)))
    highest = max(orders) / base
    if highest * SAMPLES > MOST_SAMPLES:
        return Fraction(0), np.empty(0, dtype=np.int64)
    return 1 / base, np.array([int(order / base) for order in orders], dtype=np.int64)


def extremes(phasors: ComplexArray, harmonics: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Largest and smallest value (rows,) of Re sum phasor exp(i harmonic t) over a cycle; phasors (rows, harmonics)."""
    highest, lowest = np.zeros(len(phasors)), np.zeros(len(phasors))
    if phasors.size == 0:
        return highest, lowest
    if phasors.shape[1] == 1:
        highest[:] = np.abs(phasors[:, 0])
        return highest, -highest
    number = int(harmonics.max()) * SAMPLES
    angle = 2.0 * math.pi * np.arange(-1, number + 1) / number
    wave = np.concatenate([np.cos(np.outer(harmonics, angle)), -np.sin(np.outer(harmonics, angle))])
    rows = max(1, BLOCK_VALUES // number)
    with np.errstate(all="ignore"):
        for start in range(0, len(phasors), rows):
            block = phasors[start : start + rows]
            value = np.concatenate([block.real, block.imag], axis=1) @ wave
            highest[start : start + rows] = _highest(block, harmonics, value, angle)
            lowest[start : start + rows] = -_highest(-block, harmonics, np.negative(value, out=value), angle)
    return highest, lowest


def _highest(phasors: ComplexArray, harmonics: np.ndarray, value: FloatArray, angle: FloatArray) -> FloatArray:
    """(rows,) the largest value on and between the samples `value` (rows, samples + one more at each end).

    Parabolas through three samples tell which maxima may be the highest; Newton's method on the slope of the sum
    finds each of these.
    """
    middle, bound = value[:, 1:-1], np.abs(phasors).sum(axis=1)
    near = middle >= (middle.max(axis=1) - SAMPLING_LOSS * bound)[:, None]
    row, place = np.divmod(np.flatnonzero(near), middle.shape[1])
    before, at, after = (value[row, place + k] for k in range(3))
    top = (at >= before) & (at >= after)
    row, place, before, at, after = (array[top] for array in (row, place, before, at, after))
    bend = before + after - 2.0 * at
    shift = np.where(bend < 0, (before - after) / (2.0 * bend), 0.0)
    vertex = at + np.where(bend < 0, (after - before) * shift / 4.0, 0.0)
    best = np.full(len(value), -np.inf)
    np.maximum.at(best, row, vertex)
    keep = vertex >= best[row] - SECOND * bound[row]
    row, sampled = row[keep], at[keep]
    step = angle[1] - angle[0]
    t = angle[place[keep] + 1] + shift[keep] * step
    for _ in range(NEWTON_STEPS):
        turned = phasors[row] * np.exp(1j * np.outer(t, harmonics))
        slope, curve = -(turned.imag @ harmonics), -(turned.real @ harmonics**2)
        t = t + np.clip(np.where(curve < 0, -slope / curve, 0.0), -step, step)
    refined = (phasors[row] * np.exp(1j * np.outer(t, harmonics))).real.sum(axis=1)
    best[:] = 0.0
    np.maximum.at(best, row, np.fmax(sampled, refined))
    return best
