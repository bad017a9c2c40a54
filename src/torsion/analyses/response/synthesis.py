"""All lines of a response together: the half range of their sum over the common cycle, true to phase."""

import math
from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import SMALL_BLOCK, Response, Synthesis, blocks
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.trees.tree_response import Status

SAMPLES = 8  # of the highest harmonic, before extremes are refined
MOST_SAMPLES = 5_000  # of a cycle; a longer one is given by its bound
BLOCK_VALUES = 131_072  # samples computed at once (0.5 MB stays in a processor's cache)
SINGLE = float(np.finfo(np.float32).eps)  # samples are in single precision, extremes in double
MOST_CELLS = 8_000  # cells refined at once; a cell is half a step to either side of a sample
DEGREE = (
    12  # of the Taylor polynomial in a cell, which errs by (pi/8)^13/13! = 8.5e-16 of the bound
)
BEND_VARIES = 0.25  # most share of itself by which the second derivative varies in a cell where Newton's method is used
NEWTON_STEPS = 3  # after one from the middle: a third of a half width off at most, then a third of the square at most
POWERS = np.arange(1.0, DEGREE + 1)[:, None]
HALVES = [  # (powers, powers) each: the coefficients of the left and of the right half of a cell, as a cell of its own
    np.array(
        [
            [math.comb(m, k) * middle ** (m - k) / 2**k for m in range(DEGREE + 1)]
            for k in range(DEGREE + 1)
        ]
    )
    for middle in (-0.5, 0.5)
]


def synthesis(response: Response) -> Synthesis:
    """Return half range, peak with the mean torque, RMS and arithmetic bound of every span at every speed.

    Orders are summed as phasors in time. Fixed frequencies have no common cycle with them: their magnitudes
    are added. The same holds, as a bound, where the cycle of all orders is too long, or engines stand in any phase to
    each other; `turns` is 0 then.
    Where the status of a line is not ok, the sum has no value: it is infinite.
    """
    orders = [line.order for line in response.lines]
    values = np.empty((4, *response.mean.shape))
    for part in blocks(len(response.mean), response.mean.shape[1], SMALL_BLOCK):
        torque = response.torque[part]
        mean = response.mean[part]
        size = np.abs(torque)
        bound = size.sum(axis=1)
        phasors = np.moveaxis(torque, 1, 2).reshape(bound.size, len(orders))
        highest, lowest, fixed = (
            total.reshape(bound.shape) for total in _sums(orders, phasors, response.by_magnitude)
        )
        peak = np.maximum(np.abs(mean + highest + fixed), np.abs(mean + lowest - fixed))
        rms = np.sqrt((size**2).sum(axis=1) / 2.0)
        answered = np.isfinite(bound) & (response.status[part] == Status.OK).all(axis=1)[:, None]
        values[:, part] = np.where(
            answered, [(highest - lowest) / 2.0 + fixed, peak, rms, bound], np.inf
        )
    turns = common_cycle([order for order in orders if order is not None])[0]
    half_range, peak, rms, bound = values
    return Synthesis(half_range, peak, rms, bound, Fraction(0) if response.by_magnitude else turns)


def half_range(response: Response, phasors: ComplexArray) -> FloatArray:
    """Return the half range (speeds,) of any quantity whose lines are `phasors` (speeds, lines), summed as torques are.

    Infinite where the status of a line is not ok.
    """
    half_ranges = half_range_of(
        [line.order for line in response.lines], phasors, by_magnitude=response.by_magnitude
    )
    return np.where(
        np.isfinite(half_ranges) & (response.status == Status.OK).all(axis=1), half_ranges, np.inf
    )


def half_range_of(
    orders: Sequence[Fraction | None], phasors: ComplexArray, *, by_magnitude: bool = False
) -> FloatArray:
    """Return the half range (rows,) of the sum of `phasors` (rows, components), each of an order or a fixed frequency."""
    highest, lowest, fixed = _sums(orders, phasors, by_magnitude)
    return np.asarray(fixed + (highest - lowest) / 2.0)


def _sums(
    orders: Sequence[Fraction | None], phasors: ComplexArray, by_magnitude: bool
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return largest and smallest sum (rows,) of the orders of `phasors` (rows, components), and that of the fixed."""
    turns, harmonics = common_cycle([order for order in orders if order is not None])
    ordered = np.array([order is not None for order in orders], dtype=bool)
    fixed = np.abs(phasors[:, ~ordered]).sum(axis=1)
    if turns == 0 or by_magnitude:
        bound = np.abs(phasors[:, ordered]).sum(axis=1)
        return bound, -bound, fixed
    return (*extremes(phasors.compress(ordered, axis=1), harmonics), fixed)


def common_order(orders: Sequence[Fraction]) -> Fraction:
    """Return the greatest order of which all are whole multiples; 0 of none."""
    if not orders:
        return Fraction(0)
    below = math.lcm(*(order.denominator for order in orders))
    return Fraction(math.gcd(*(int(order * below) for order in orders)), below)


def common_cycle(orders: list[Fraction]) -> tuple[Fraction, np.ndarray]:
    """Return the revolutions after which all orders repeat (0 if too many), and each order in cycles per such period."""
    base = common_order(orders)
    if not base or max(orders) / base * SAMPLES > MOST_SAMPLES:
        return Fraction(0), np.empty(0, dtype=np.int64)
    return 1 / base, np.array([int(order / base) for order in orders], dtype=np.int64)


def extremes(phasors: ComplexArray, harmonics: np.ndarray) -> tuple[FloatArray, FloatArray]:
    """Return largest and smallest value (rows,) of Re sum phasor exp(i harmonic t) over a cycle; phasors (rows, harmonics).

    The sample nearest to an extreme is within h^2/8 sum n^2 |phasor| of it, h the step (the slope is zero there): every
    sample that may be nearest is refined, so that the result is exact to rounding.
    """
    if phasors.size == 0:
        return np.zeros(len(phasors)), np.zeros(len(phasors))
    if phasors.shape[1] == 1:
        amplitude = np.abs(phasors[:, 0])
        return amplitude, -amplitude
    number = int(harmonics.max()) * SAMPLES
    turned = np.exp(2j * math.pi / number * (np.outer(np.arange(number), harmonics) % number))
    # Re(a b*) is the product of both as real pairs.
    wave = turned.conj().view(np.float64).T.astype(np.float32)
    phase = math.pi / number * harmonics  # in half a step
    rounding = 3.0 * SINGLE * (len(harmonics) + 2)  # of the bound, at most: of two samples
    # From phasors at a sample, as real pairs, to the Taylor polynomial of their sum in a cell, -1..1.
    power = np.arange(DEGREE + 1)[:, None]
    expanded = phase**power / [[math.factorial(m)] for m in range(DEGREE + 1)]
    expanded = (np.array([1, -1j, -1, 1j])[power % 4] * expanded).view(np.float64)
    phasors = np.ascontiguousarray(phasors, dtype=np.complex128)
    upright = len(phasors)  # rows: then come the same waves upside down
    best = np.zeros(2 * upright)
    near: list[IntArray] = []
    rows = max(BLOCK_VALUES // number, 1)
    cells = 0
    with np.errstate(all="ignore"):
        size = np.abs(phasors)
        # Without a value where that is 0: no extreme is to be found.
        bound = size.sum(axis=1, keepdims=True)
        loss = ((size @ (phase**2 / 2.0))[:, None] / bound + rounding).astype(np.float32)
        for start in range(0, upright, rows):
            part = slice(start, min(start + rows, upright))
            value = (phasors[part].view(np.float64) / bound[part]).astype(np.float32) @ wave
            high = value >= value.max(axis=1, keepdims=True) - loss[part]
            low = value <= value.min(axis=1, keepdims=True) + loss[part]
            near += [
                np.flatnonzero(high) + start * number,
                np.flatnonzero(low) + (upright + start) * number,
            ]
            cells += len(near[-2]) + len(near[-1])
            if part.stop < upright and cells < MOST_CELLS:
                continue
            row, sample = np.divmod(np.concatenate(near), number)
            phasors_there = phasors.take(row % upright, axis=0)
            phasors_there *= turned.take(sample, axis=0)
            sign = np.where(row < upright, 1.0, -1.0)
            _raise(best, row, sign * (expanded @ phasors_there.view(np.float64).T))
            near = []
            cells = 0
    return best[:upright], -best[upright:]


def _raise(best: FloatArray, row: IntArray, polynomial: FloatArray) -> None:
    """Raise `best` (rows,) to the largest value of the polynomials (powers, cells), each of the row (cells,) named.

    A cell whose second derivative is negative and varies little has its largest value where Newton's method ends. Any
    other counts by its middle and is halved, until it is of that sort or nothing in it can exceed what is found.
    """
    while row.size:
        slope = polynomial[1:] * POWERS
        bend = slope[1:] * POWERS[:-1]
        bends = np.abs(bend[1:]).sum(axis=0) <= -BEND_VARIES * bend[0]
        x = np.where(bends, np.clip(-slope[0] / bend[0], -1.0, 1.0), 0.0)
        for _ in range(NEWTON_STEPS):
            step = _value(slope, x) / _value(bend, x)
            x = np.where(bends, np.clip(x - step, -1.0, 1.0), x)
        np.fmax.at(best, row, _value(polynomial, x))
        unclear = ~bends & (polynomial[0] + np.abs(polynomial[1:]).sum(axis=0) > best[row])
        polynomial = np.hstack([half @ polynomial[:, unclear] for half in HALVES])
        row = np.tile(row[unclear], 2)


def _value(polynomial: FloatArray, x: FloatArray) -> FloatArray:
    """Return the values (cells,) of the polynomials (powers, cells) at x (cells,)."""
    value: FloatArray = polynomial[-1].copy()
    for coefficient in polynomial[-2::-1]:
        value *= x
        value += coefficient
    return value
