"""References in 100-digit arithmetic: frequencies proven by counts to 60 digits, and steady responses.

gmpy2 does the arithmetic where it is installed, mpmath otherwise. The frequencies are the zeros of the characteristic
polynomial of the tree, which elimination from the leaves carries as the fraction a/b that is the dynamic stiffness
seen at a station: no quotient, no pole. Newton's method starts from singular values in double precision; the answer
is accepted when the number of frequencies below w (1 -+ 1e-60), counted by signs, is that of the mode wanted.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp

from benchmarks.cases import Case, Condensed, condensed
from torsion.analyses.compare.model_errors import relative_errors

DIGITS = 100
PROVEN = 60

try:
    import gmpy2

    gmpy2.get_context().precision = int(DIGITS * 3.33)
    real, imaginary_unit, ARITHMETIC = gmpy2.mpfr, gmpy2.mpc(0, 1), f"gmpy2 {gmpy2.version()}"
    square_root = gmpy2.sqrt
except ImportError:
    import mpmath

    _context = mpmath.MPContext()
    _context.dps = DIGITS
    real, imaginary_unit, ARITHMETIC = (
        _context.mpf,
        _context.mpc(0, 1),
        f"mpmath {mpmath.__version__}",
    )
    square_root = _context.sqrt


class Elimination(NamedTuple):
    """What one elimination at w**2 gives."""

    count: int  # natural frequencies below w, rigid motion included
    value: Any  # of the characteristic polynomial, whose sign and scale are free
    slope: Any  # its derivative by w**2


def eliminate(tree: Condensed, square: Any) -> Elimination:
    """Counts the frequencies below sqrt(square) and evaluates the characteristic polynomial there."""
    one, zero = real(1), real(0)
    above = [-square * inertia for inertia in tree.inertia]  # a of every station, b is `below`
    below = [one] * len(above)
    above_slope = [-inertia for inertia in tree.inertia]
    below_slope = [zero] * len(above)
    count = 0
    for i in range(len(above) - 1, 0, -1):
        a, da, parent = above[i], above_slope[i], tree.parent[i]
        negative = (a < 0) != (below[i] < 0)
        b = below[i] * tree.stiffness[i] + a  # the span turns a/b into k a / (k b + a)
        db = below_slope[i] * tree.stiffness[i] + da
        a, da = a * tree.stiffness[i], da * tree.stiffness[i]
        count += negative - ((b < 0) != (a < 0))
        p, dp, q, dq = above[parent], above_slope[parent], below[parent], below_slope[parent]
        above_slope[parent] = dp * b + p * db + da * q + a * dq
        above[parent] = p * b + a * q
        below_slope[parent] = dq * b + q * db
        below[parent] = q * b
    count += (above[0] < 0) != (below[0] < 0)
    return Elimination(count, above[0], above_slope[0])


def frequencies(case: Case, modes: Sequence[int]) -> list[Any]:
    """The elastic frequencies of the given numbers (1 is the lowest), rad/s, each proven to 60 digits."""
    tree = condensed(case, real)
    start = starting_values(condensed(case))
    return [_frequency(tree, mode, start[mode]) for mode in modes]


def starting_values(tree: Condensed) -> np.ndarray:
    """Singular values of D_k^1/2 B D_J^-1/2 ascending, rad/s; the first stands for the rigid motion."""
    size = len(tree.parent)
    factor = np.zeros((size, size))
    child = np.arange(1, size)
    stiffness, inertia = np.array(tree.stiffness)[1:], np.array(tree.inertia)
    factor[child, child] = np.sqrt(stiffness / inertia[1:])
    parent = np.array(tree.parent[1:], dtype=int)
    factor[child, parent] = -np.sqrt(stiffness / inertia[parent])
    return np.linalg.svd(factor, compute_uv=False)[::-1]


def response(case: Case, frequency: float, force: Sequence[complex]) -> tuple[list[Any], list[Any]]:
    """Angle of every station (rad) and torque of every span (N m, on the child; 0 at the root), at their own speeds."""
    tree = condensed(case, real)
    size, w = case.size, real(float(frequency))
    load = [r * _complex(f) for r, f in zip(tree.ratio, force, strict=True)]
    z = [
        imaginary_unit * w * c - w * w * j for c, j in zip(tree.damping, tree.inertia, strict=True)
    ]
    compliance, share = [real(0)] * size, [real(0)] * size
    for i in range(size - 1, 0, -1):
        compliance[i] = 1 / (tree.stiffness[i] + imaginary_unit * w * tree.viscous[i])
        share[i] = 1 / (1 + compliance[i] * z[i])
        z[tree.parent[i]] += z[i] * share[i]
        load[tree.parent[i]] += load[i] * share[i]
    angle, torque = [load[0] / z[0]] * size, [real(0) * imaginary_unit] * size
    for i in range(1, size):
        torque[i] = (z[i] * angle[tree.parent[i]] - load[i]) * share[i]
        angle[i] = angle[tree.parent[i]] - compliance[i] * torque[i]
    angle = [r * q for r, q in zip(tree.ratio, angle, strict=True)]
    return angle, [t / s for t, s in zip(torque, tree.span_ratio, strict=True)]


def worst(found: Sequence[float] | np.ndarray, exact: Sequence[Any]) -> float:
    """Largest relative error, the difference taken in the reference's digits; infinite where a value is missing."""
    with mp.workdps(DIGITS):
        error = np.abs(relative_errors(found, exact))
    return float(np.where(np.isnan(error), np.inf, error).max())


def torque_errors(
    torque: np.ndarray, reference: Sequence[Any], smallest: float = 0.0
) -> tuple[float, float]:
    """Largest error of one frequency's torques: over the largest of them, and each above `smallest` over its own."""
    if not np.all(np.isfinite(torque)):
        return float("inf"), float("inf")
    size = [abs(t) for t in reference]
    difference = [abs(_complex(v) - t) for v, t in zip(torque, reference, strict=True)]
    each = (d / s for d, s in zip(difference, size, strict=True) if s > smallest)
    return float(max(difference) / max(size)), float(max(each))


def _frequency(tree: Condensed, mode: int, start: float) -> Any:
    square = real(float(start)) ** 2
    for _ in range(12):
        _, value, slope = eliminate(tree, square)
        step = value * square / (slope * square - value)  # the rigid motion's zero is divided out
        square -= step
        if abs(step) < abs(square) * real(10) ** -(PROVEN + 5):
            break
    frequency = square_root(abs(square))
    return (
        frequency
        if _proven(tree, mode, frequency)
        else _bisected(tree, mode, real(float(start) or 1.0))
    )


def _proven(tree: Condensed, mode: int, frequency: Any) -> bool:
    margin = real(10) ** -PROVEN
    below = eliminate(tree, (frequency * (1 - margin)) ** 2).count
    return below == mode and eliminate(tree, (frequency * (1 + margin)) ** 2).count == mode + 1


def _bisected(tree: Condensed, mode: int, start: Any) -> Any:
    """Bisection of w by counts alone, for the mode that Newton's method missed."""
    low, high = start / 2, start * 2
    while eliminate(tree, low * low).count > mode:
        low /= 16
    while eliminate(tree, high * high).count <= mode:
        high *= 16
    while high - low > high * real(10) ** -(PROVEN + 1):
        middle = (low + high) / 2
        if eliminate(tree, middle * middle).count > mode:
            high = middle
        else:
            low = middle
    return (low + high) / 2


def _complex(value: complex) -> Any:
    return real(float(value.real)) + imaginary_unit * real(float(value.imag))
