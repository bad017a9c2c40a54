"""Uniform pieces of shafts as continua, in closed form."""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.distributed.span_laws import (
    UNIT_ROUNDOFF,
    Law,
    Pi,
    alternating,
    distinct,
)

_ROUNDINGS = 20.0  # of tan (4 units), what follows from it and the factors
_SERIES_BELOW = 4.0  # square of the phase; above, differences lose less than a digit
_TERMS = 14  # 4^14/29! < 1e-22
_SINE = np.array([1.0 / math.factorial(2 * k + 1) for k in range(_TERMS)])  # of sin(mu)/mu in mu^2
_COSINE = np.array([1.0 / math.factorial(2 * k + 2) for k in range(_TERMS)])  # of (1 - cos mu)/mu^2
_SINE_SLOPE, _COSINE_SLOPE = (
    row[1:] * np.arange(1, _TERMS) for row in (_SINE, _COSINE)
)  # by -mu^2


@dataclass(frozen=True)
class UniformShafts(Law):
    """h = L/(G I) sin(mu)/mu and J = rho I L/2 tan(mu/2)/(mu/2) with the phase mu = w L sqrt(rho/G) of each piece."""

    flexibility: FloatArray  # (shafts,) rad/(N m), L/(G I)
    half: FloatArray  # (shafts,) kg m2, half the inertia of the piece
    travel: FloatArray  # (shafts,) s2, square of the time a wave needs along the piece

    @cached_property
    def limit(self) -> float:
        """Lowest frequency (rad/s) with both ends fixed: pi over the longest travel time."""
        longest = float(self.travel.max(initial=0.0))
        return math.pi / math.sqrt(longest) if longest > 0.0 else math.inf

    @cached_property
    def _travels(self) -> tuple[FloatArray, IntArray | slice]:
        """The different squares of travel times, and which one each shaft has."""
        first, position = distinct(self.travel[:, None])
        return self.travel[first], position

    def _pi(self, s: NDArray[Any]) -> Pi:
        travel, position = self._travels if len(s) == 1 else (self.travel, slice(None))
        sine, tangent, _ = (row[position] for row in _functions(travel[:, None] * s))
        end = np.multiply(tangent, self.half[:, None], out=tangent)
        return np.multiply(sine, self.flexibility[:, None], out=sine), end, end

    def _slopes(self, s: FloatArray) -> tuple[FloatArray, ...]:
        h, half, travel = self.flexibility[:, None], self.half[:, None], self.travel[:, None]
        sine, tangent, cosine = _functions(travel * s)

        # With respect to v = mu^2; tan(mu/2)/(mu/2) = 2 ((1 - cos mu)/mu^2)/(sin(mu)/mu).
        v, versed = travel * s, 0.5 * (tangent * sine)
        small = v < _SERIES_BELOW
        near, far = np.where(small, v, 0.0), np.where(small, 1.0, v)
        by_sine = np.where(small, -alternating(_SINE_SLOPE, near), (cosine - sine) / (2.0 * far))
        by_versed = np.where(small, -alternating(_COSINE_SLOPE, near), (0.5 * sine - versed) / far)
        by_tangent = 2.0 * (by_versed - versed * by_sine / sine) / sine
        end, end_slope = half * tangent, half * (travel * by_tangent)
        return h * sine, end, end, h * (travel * by_sine), end_slope, end_slope

    def rounding(self, square: FloatArray) -> FloatArray:
        return np.full(len(square), _ROUNDINGS * UNIT_ROUNDOFF)


def uniform_shafts(
    length: ArrayLike, rigidity: ArrayLike, inertia_per_length: ArrayLike
) -> UniformShafts:
    """Uniform pieces of `length` m, `rigidity` G I N m2 and `inertia_per_length` rho I kg m, each (shafts,)."""
    long, stiff, heavy = np.broadcast_arrays(
        *(
            np.atleast_1d(np.asarray(values, dtype=float))
            for values in (length, rigidity, inertia_per_length)
        )
    )
    return UniformShafts(long / stiff, 0.5 * (heavy * long), (long * heavy) * (long / stiff))


def _functions(v: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any], NDArray[Any]]:
    """sin(mu)/mu, tan(mu/2)/(mu/2) and cos(mu) at v = mu^2, from one tangent."""
    half = 0.5 * np.sqrt(v)
    tangent = np.tan(half)
    with np.errstate(invalid="ignore"):
        ratio = tangent / half
    ratio[half == 0] = 1.0
    np.multiply(tangent, tangent, out=tangent)
    below = 1.0 + tangent
    return ratio / below, ratio, (1.0 - tangent) / below


POINTS = 32  # of Gauss along a piece
TERMS = 20  # of each series; at the limit the first one left out is below 1e-18 of the first
_COEFFICIENT_ROUNDINGS = (
    64.0  # of a coefficient; several times what was found in comparison with many digits
)
# Last term at the limit, relative to the first; above, the profile is too steep.
_LARGEST_LEFT_OUT = 1e-15


@cache
def _rule(points: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss' points and weights on 0..1, and the matrix of the integrals from 0 to each point of a polynomial there.

    In the longest arithmetic there is: rounded points and weights would cost a digit where a profile is steep.
    """
    degree = np.arange(points)
    root = legendre.leggauss(points)[0].astype(np.longdouble)
    for _ in range(
        3
    ):  # two steps of Newton, and Legendre's polynomials with the slope of the last at the root
        x = root
        values = legendre.legvander(x, points)
        slope = points * (values[:, points - 1] - x * values[:, points]) / ((1 - x) * (1 + x))
        root = x - values[:, points] / slope
    weight = 2 / ((1 - x) * (1 + x) * slope**2)
    to_series = (0.5 + degree)[:, None] * (values[:, :points] * weight[:, None]).T
    from_start = np.column_stack([x + 1, (values[:, 2:] - values[:, :-2]) / (2 * degree[1:] + 1)])
    rule = 0.5 * (x + 1), 0.5 * weight, 0.5 * from_start @ to_series
    places, weights, integrals = (part.astype(np.float64) for part in rule)
    return places, weights, integrals


def profile_points(points: int = POINTS) -> FloatArray:
    """Where a profile is sampled: Gauss' points (points,) between 0 at the inner and 1 at the outer end."""
    return _rule(points)[0].copy()


@dataclass(frozen=True)
class ProfileShafts(Law):
    """Series in v = s F M, F and M being the whole flexibility and inertia: h = F b(v), J = M e(v)/b(v)."""

    both_ends: ClassVar = ("ends",)
    ends_at_limit: ClassVar = True  # its series have as many terms as the limit needs
    flexibility: FloatArray  # (shafts,) rad/(N m), F
    inertia: FloatArray  # (shafts,) kg m2, M
    spring: FloatArray  # (shafts, terms) of b
    ends: FloatArray  # (shafts, 2, terms) of e at the inner and the outer end

    @cached_property
    def _travel(self) -> FloatArray:
        return self.flexibility * self.inertia

    @cached_property
    def limit(self) -> float:
        """A frequency (rad/s) at most 2 % below the lowest one with both ends fixed, for a uniform piece.

        b has the zeros v_i > 0 with sum 1/v_i^2 = b_1^2 - 2 b_0 b_2 for b_0 = 1, so that none is below the inverse
        root of that sum (Newton's identity).
        """
        first, second = self.spring[:, 1], self.spring[:, 2]
        with np.errstate(divide="ignore"):  # a shaft without inertia has no limit
            square = 1.0 / np.sqrt(first * first - 2.0 * second) / self._travel
        return float(np.sqrt(square.min(initial=np.inf)))

    def _pi(self, s: NDArray[Any]) -> Pi:
        v = self._travel[:, None] * s
        spring = alternating(self.spring, v)
        share = self.inertia[:, None] / spring
        spring *= self.flexibility[:, None]
        return (
            spring,
            share * alternating(self.ends[:, 0], v),
            share * alternating(self.ends[:, 1], v),
        )

    def rounding(self, square: FloatArray) -> FloatArray:
        """That of the coefficients times what cancels in the series."""
        v = self._travel.max(initial=0.0) * square
        below, above = (alternating(self.spring[:1], sign * v[None])[0] for sign in (1.0, -1.0))
        growth = above / np.maximum(below, UNIT_ROUNDOFF)
        return np.asarray(_COEFFICIENT_ROUNDINGS * UNIT_ROUNDOFF * np.abs(growth))


def profile_shafts(
    length: ArrayLike, flexibility_per_length: FloatArray, inertia_per_length: FloatArray
) -> ProfileShafts:
    """Pieces of `length` (shafts,) m, sampled at `profile_points`: f = 1/(G I) and m = rho I, each (shafts, points).

    f in rad/(N m2), m in kg m. The profile is smooth within a piece: a step, or a change of taper, ends it. Raises
    ValueError for a piece in which the series do not converge, as its profile is too steep.
    """
    long = np.atleast_1d(np.asarray(length, dtype=float))
    f, m = (
        np.atleast_2d(np.asarray(a, dtype=float))
        for a in (flexibility_per_length, inertia_per_length)
    )
    _, weight, from_start = _rule(f.shape[1])
    flexibility, mass = f @ weight, m @ weight
    f, m = f / flexibility[:, None], m / np.where(mass > 0.0, mass, 1.0)[:, None]
    inner = _series(m @ from_start.T, f, m, weight, from_start)
    outer = _series(m[:, ::-1] @ from_start.T, f[:, ::-1], m[:, ::-1], weight, from_start)
    spring = _series(np.ones_like(f), f, m, weight, from_start)
    shafts = ProfileShafts(
        flexibility * long, mass * long, spring, np.stack([inner, outer], axis=1)
    )
    if math.isfinite(shafts.limit):
        last = spring[:, -1] * ((shafts.limit * shafts.limit) * shafts._travel) ** (TERMS - 1)
        worst = int(np.argmax(last))
        if not last[worst] < _LARGEST_LEFT_OUT or not (spring > 0.0).all():
            raise ValueError(
                f"shaft {worst} has too steep a profile for its series; divide it more finely"
            )
    return shafts


def _series(
    running: FloatArray, f: FloatArray, m: FloatArray, weight: FloatArray, from_start: FloatArray
) -> FloatArray:
    """Coefficients (shafts, TERMS): whole integrals of f times `running`, which then goes through f and m in turn."""
    coefficients = []
    for _ in range(TERMS):
        product = f * running
        coefficients.append(product @ weight)
        running = (m * (product @ from_start.T)) @ from_start.T
    return np.stack(coefficients, axis=1)
