"""The lowest modes of a long chain: brackets by counts, Rayleigh's quotients from twisted vectors, and the enclosure.

A back end for long chains: LAPACK counts in one sweep of the chain and makes a twisted vector in about three (dlaneg
and dlar1v), one frequency at a time, which the sweeps of `sturm` and `two_sides` for many frequencies cannot (measured
from 2000 stations). The matrix is L D L' with unit lower bidiagonal L: its Sturm count and its vectors need no entry
of the product. Brackets are halved only until the quotients converge. (Parlett and Dhillon 1997; Marques, Riedy and
Voemel 2006 for counts in IEEE arithmetic.)
"""

import ctypes
import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.lapack import call, routine
from torsion.kernels.long_chain.temple import Chain, quotient
from torsion.sources import source

_BRACKET = (
    2.0**-6
)  # relative width of the bracket of a square from which quotients take fewer sweeps than halving
_SETTLED = 1e-14  # of the width of the bracket: an error of the shift that the shape does not show
_NOISE = 2.0**-6  # of the worst case of the roundings of one sweep; they are seldom more (measured)
_STEPS = 8  # of Rayleigh's quotient before halving takes over; 3 or 4 are common
_FULL = 2.0**-52
_NUDGES = (0.0, 2.0**-51, -(2.0**-51), 2.0**-50)  # relative; of no effect on the shape
_APART = 1e-4  # relative distance to a neighbour's bracket below which a farther one is sought
_PROBE = 2.0**-8  # relative distance at which it is sought
_WIDE = (
    3.0  # errors of a count: an enclosure by counts is then as narrow as one by Temple's inequality
)
_LUMP = 32  # stations that become one in a coarser chain; its low frequencies are those of the chain to (phase/24)^2
_STATIONS_FOR_GUESS = 64  # of the coarser chain for every mode
_WIDENING = 16.0  # of the square while no bracket is known
_RANGE = 1e280  # of entries and of their inverses, so that nothing over- or underflows
_DLANEG, _DLAR1V = "i iddddi", "v iiiddddddddiiddiidddd"
_SMALLEST_PIVOT = 2.3e-308  # both take it; neither needs it, as their arithmetic is IEEE's


@dataclass(frozen=True)
class BidiagonalFactor:
    """L D L' of n rows in the four arrays that LAPACK reads, contiguous float64."""

    diagonal: FloatArray  # (n,) D
    lower: FloatArray  # (n,) L below its diagonal; the last is unused
    product: FloatArray  # (n,) L D
    square: FloatArray  # (n,) L L D
    vector: FloatArray  # (n,) written by each twisted factorisation
    work: FloatArray  # (4 n,) likewise

    @property
    def size(self) -> int:
        """Number of rows."""
        return len(self.diagonal)


@dataclass(frozen=True)
class Twisted:
    """What one twisted factorisation at a shift gives; the arrays last until the next one of the same matrix."""

    vector: FloatArray  # (n,) 1 at the row of the twist
    correction: float  # of the shift by Rayleigh's quotient
    twist: int  # row from which the vector was built
    factor: BidiagonalFactor

    def passed_on(self) -> FloatArray:
        """(twist,) what each row before the twist adds to the diagonal of the next one when it is eliminated."""
        size = self.factor.size
        return self.factor.work[2 * size + 1 : 2 * size + 1 + self.twist]

    def taken_back(self) -> FloatArray:
        """(n - 1 - twist,) what each row from the twist on has added to it when the next one is eliminated."""
        size, rows = self.factor.size, slice(self.twist, self.factor.size - 1)
        upper, pivot = (
            self.factor.work[size : 2 * size - 1][rows],
            self.factor.work[3 * size + 1 :][rows],
        )
        with np.errstate(all="ignore"):
            taken: FloatArray = pivot * (upper / self.factor.lower[rows])
        stiff = np.isinf(pivot)  # the next row is at rest
        taken[stiff] = self.factor.diagonal[rows][stiff]
        return taken


@dataclass(frozen=True)
class ChainMode:
    """One elastic mode of a chain, scaled to a generalised inertia of 1."""

    frequency: float  # rad/s
    lower: float  # rad/s, proven
    upper: float  # rad/s, proven
    angle: FloatArray  # (n,)
    torque: FloatArray  # as many as flexibilities; torque with which each station drives the next


@dataclass
class Counts:
    """All counts made so far."""

    factor: BidiagonalFactor
    made: list[tuple[float, int]] = field(
        default_factory=list
    )  # a square of a frequency, and how many are below it

    def at(self, square: float) -> int:
        """Count of squares below `square`."""
        for known, count in self.made:
            if known == square:
                return count
        self.made.append((square, negative_count(self.factor, square)))
        return self.made[-1][1]

    def bracket(self, mode: int) -> tuple[float, float]:
        """The largest square known with a count of at most `mode`, and the smallest with a greater one."""
        low = max(square for square, count in self.made if count <= mode)
        return low, min(square for square, count in self.made if count > mode)

    def halve(self, mode: int, width: float, *, alone: bool = False) -> tuple[float, float]:
        """The bracket of `mode` when it is narrower than `width`, relatively, and, if `alone`, holds no other mode."""
        low, high = self.bracket(mode)
        while high - low > width * high or (
            alone and self.at(high) - self.at(low) > 1 and high - low > _FULL * high
        ):
            middle = (
                math.sqrt(low) * math.sqrt(high) if high > 4.0 * low else low + 0.5 * (high - low)
            )
            self.at(middle)
            low, high = self.bracket(mode)
        return low, high

    def neighbours(self, mode: int, square: float) -> tuple[float, float]:
        """Squares between `mode` and the one before, and the one after; as far from `square` as is known."""
        sides = (mode, -1.0), (mode + 1, 1.0)
        for count, side in sides:
            if abs(self._farthest(count, side, square) - square) < _APART * square:
                self.at(square * (1.0 + side * _PROBE))
        below, above = (self._farthest(*one, square) for one in sides)
        return below, above

    def _farthest(self, count: int, side: float, square: float) -> float:
        """The smallest (side -1) or largest (side 1) square known with this count; `square` where there is none."""
        return max(
            (at for at, number in self.made if number == count),
            key=lambda at: side * at,
            default=square,
        )


def factor_of(chain: Chain) -> BidiagonalFactor:
    """L D L' of the chain, from its data by products and quotients only. Raises SolveError for entries out of range."""
    inertia, flexibility = chain.inertia, chain.flexibility
    size, spans = len(inertia), len(inertia) - 1
    diagonal, lower, square = np.zeros((3, size))
    with np.errstate(over="ignore", under="ignore", divide="ignore", invalid="ignore"):
        diagonal[: len(flexibility)] = 1.0 / (inertia[: len(flexibility)] * flexibility)
        lower[:spans] = -np.sqrt(inertia[:-1] / inertia[1:])
        square[:spans] = 1.0 / (inertia[1:] * flexibility[:spans])
        product = diagonal * lower
    for entries in (diagonal[: len(flexibility)], square[:spans]):
        if not (entries.min(initial=1.0) > 1.0 / _RANGE and entries.max(initial=1.0) < _RANGE):
            raise SolveError(
                "a natural frequency lies outside 1e-140..1e140 rad/s; check the units"
            )
    return BidiagonalFactor(diagonal, lower, product, square, np.empty(size), np.empty(4 * size))


@source("ParlettDhillon1997")
def lowest_modes(chain: Chain, wanted: int) -> Iterator[ChainMode]:
    """The lowest `wanted` elastic modes in ascending order, one at a time; the chain has at least so many."""
    counts, rigid, guess = Counts(factor_of(chain)), int(chain.is_free), list[float]()
    if len(chain.inertia) >= _LUMP * _STATIONS_FOR_GUESS * (wanted + 1):
        guess = [found.frequency**2 for found in lowest_modes(chain.lumped(_LUMP), wanted)]
    _span_all(counts, chain, rigid, rigid + wanted - 1, guess)
    for mode in range(rigid, rigid + wanted):
        yield _mode(chain, counts, mode, guess[mode - rigid] if guess else math.nan)


def _span_all(counts: Counts, chain: Chain, first: int, last: int, guess: list[float]) -> None:
    """Make the counts that bracket the modes `first` to `last`, from what a guess or a uniform chain says."""
    for one, other in pairwise(guess):
        counts.at(math.sqrt(one) * math.sqrt(other))
    square = 0.5 * math.pi**2 / (chain.total_inertia * chain.total_flexibility)
    low = 0.5 * guess[0] if guess else square
    while counts.at(low) > first:
        low /= _WIDENING
    high = (1.0 + 1.0 / len(guess)) * guess[-1] if guess else square * (last - first + 2) ** 2
    while counts.at(high) <= last:
        high *= _WIDENING


def _mode(chain: Chain, counts: Counts, mode: int, guess: float) -> ChainMode:
    low, high = counts.bracket(mode)
    start = guess
    if not (low < guess < high and counts.at(high) - counts.at(low) == 1):
        low, high = counts.halve(mode, _BRACKET, alone=True)
        start = low + 0.5 * (high - low)
    shape = _rayleigh(chain, counts.factor, low, high, start)
    found = None if shape is None else _proven(chain, counts, mode, shape)
    if shape is None or found is None or found[2] - found[1] > _WIDE * chain.slack * found[0]:
        low, high = counts.halve(mode, _FULL)
        shape = _finite_shape(chain, counts.factor, low + 0.5 * (high - low))
        found = _counted(chain, counts, mode)
    scale = 1.0 / math.sqrt(shape.generalised)
    np.multiply(shape.angle, scale, out=shape.angle)
    np.multiply(shape.torque, scale, out=shape.torque)
    return ChainMode(*found, shape.angle, shape.torque)


@dataclass(frozen=True)
class _Shape:
    """A shape next to a given square of the frequency, of any size."""

    generalised: float  # inertia
    angle: FloatArray  # (n,)
    torque: FloatArray  # as many as flexibilities


def _rayleigh(
    chain: Chain, factor: BidiagonalFactor, low: float, high: float, square: float
) -> _Shape | None:
    """The shape of the mode between the squares `low` and `high`; None where the quotients lead elsewhere."""
    settled = max(_SETTLED * (high - low), _NOISE * chain.slack * high)
    for _ in range(_STEPS):
        change = twisted_vector(factor, square).correction
        square += change
        if not 2.0 * low - high <= square <= 2.0 * high - low:
            return None
        if abs(change) <= math.sqrt(settled * (high - low)):
            return _finite_shape(chain, factor, square)
    return None


def _finite_shape(chain: Chain, factor: BidiagonalFactor, square: float) -> _Shape:
    """The shape at `square`, or a few units of rounding beside it where a node falls on a station exactly."""
    for nudge in _NUDGES:
        twisted = twisted_vector(factor, square * (1.0 + nudge))
        with np.errstate(all="ignore"):
            shape = _shape(chain, twisted)
            if math.isfinite(
                float(np.dot(shape.torque, shape.torque)) + float(np.dot(shape.angle, shape.angle))
            ):
                return shape
    raise SolveError(f"no shape was found near {math.sqrt(square):.6g} rad/s; request fewer modes")


def _shape(chain: Chain, twisted: Twisted) -> _Shape:
    """Angles and torques, each torque a product of a dynamic stiffness and an angle."""
    root, vector, twist = chain.root, twisted.vector, twisted.twist
    torque = np.empty(len(chain.flexibility))
    moment = root * vector
    torque[:twist] = -twisted.passed_on() * moment[1 : twist + 1]
    torque[twist : len(root) - 1] = twisted.taken_back() * moment[twist:-1]
    angle = vector / root
    torque[len(root) - 1 :] = angle[-1:] / chain.flexibility[len(root) - 1 :]
    return _Shape(float(np.dot(vector, vector)), angle, torque)


def _proven(
    chain: Chain, counts: Counts, mode: int, shape: _Shape
) -> tuple[float, float, float] | None:
    """Frequency and its enclosure, rad/s, by Temple's inequality; None where the mode is not known to be alone."""
    found = quotient(chain, shape.angle)
    below, above = counts.neighbours(mode, found.frequency**2)
    least, most = math.sqrt(below) * (1.0 + chain.slack), math.sqrt(above) * (1.0 - chain.slack)
    if not least < found.frequency < most:
        return None
    bounds = found.enclosure(0.0 if mode == int(chain.is_free) else least, most)
    return None if bounds is None else (found.frequency, *bounds)


def _counted(chain: Chain, counts: Counts, mode: int) -> tuple[float, float, float]:
    """Frequency and its enclosure, rad/s, by the counts alone."""
    low, high = sorted(counts.bracket(mode))
    middle = math.sqrt(low + 0.5 * (high - low))
    return middle, math.sqrt(low) * (1.0 - chain.slack), math.sqrt(high) * (1.0 + chain.slack)


def are_available() -> bool:
    """Both routines are in this scipy, with 32-bit integers."""
    return routine("dlaneg", _DLANEG) is not None and routine("dlar1v", _DLAR1V) is not None


def negative_count(factor: BidiagonalFactor, shift: float) -> int:
    """Number of eigenvalues of L D L' below `shift`, for entries that differ by a few units of rounding."""
    size = factor.size
    found = call(
        "dlaneg", _DLANEG, size, factor.diagonal, factor.square, shift, _SMALLEST_PIVOT, size
    )
    assert found is not None
    return int(found[0])


def twisted_vector(factor: BidiagonalFactor, shift: float) -> Twisted:
    """The vector of L D L' next to `shift`, as products either way from the row with the smallest residual.

    Componentwise accurate where the eigenvalue is well apart (Parlett and Dhillon 1997).
    """
    size, support = factor.size, (ctypes.c_int * 2)()
    found = call(
        "dlar1v",
        _DLAR1V,
        size,
        1,
        size,
        shift,
        factor.diagonal,
        factor.lower,
        factor.product,
        factor.square,
        _SMALLEST_PIVOT,
        0.0,
        factor.vector,
        0,
        0,
        0.0,
        0.0,
        0,
        support,
        0.0,
        0.0,
        0.0,
        factor.work,
    )
    assert found is not None
    return Twisted(factor.vector, correction=found[-1], twist=found[-4] - 1, factor=factor)
