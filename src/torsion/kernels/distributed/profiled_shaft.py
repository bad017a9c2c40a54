"""Pieces of shafts of any profile as continua, by power series in the square of the frequency.

theta' = f T and T' = -s m theta with f = 1/(G I) and m = rho I along the piece are integrated term by term (Peano and
Baker): theta = A theta_inner + B T_inner at the outer end, with A = sum (-s)^k a_k and B = sum (-s)^k b_k, and D like A
from the other end. All coefficients are integrals of positive functions. The pi is h = B, Ji = (1 - A)/(s B) and
Jo = (1 - D)/(s B), in whose coefficients s is divided out.
"""

import math
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import FloatArray
from torsion.kernels.distributed.span_laws import UNIT_ROUNDOFF, Law, Pi, alternating

POINTS = 32  # of Gauss along a piece
TERMS = 20  # of each series; at the limit the first one left out is below 1e-18 of the first
_ROUNDINGS = 64.0  # of a coefficient; several times what was found in comparison with many digits
# Last term at the limit, relative to the first; above, the profile is too steep.
_LARGEST_LEFT_OUT = 1e-15


@cache
def _rule(points: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Gauss' points and weights on 0..1, and the matrix of the integrals from 0 to each point of a polynomial there.

    In the longest arithmetic there is: rounded points and weights would cost a digit where a profile is steep.
    """
    degree = np.arange(points)
    x = legendre.leggauss(points)[0].astype(np.longdouble)
    for _ in range(2):  # Newton
        values, slope = _legendre(x, points)
        x = x - values[:, points] / slope
    values, slope = _legendre(x, points)
    weight = 2 / ((1 - x) * (1 + x) * slope**2)
    to_series = (0.5 + degree)[:, None] * (values[:, :points] * weight[:, None]).T
    from_start = np.column_stack([x + 1, (values[:, 2:] - values[:, :-2]) / (2 * degree[1:] + 1)])
    rule = 0.5 * (x + 1), 0.5 * weight, 0.5 * from_start @ to_series
    places, weights, integrals = (part.astype(np.float64) for part in rule)
    return places, weights, integrals


def _legendre(x: NDArray[Any], degree: int) -> tuple[NDArray[Any], NDArray[Any]]:
    """Legendre's polynomials to `degree` at `x` (points, degree + 1), and the slope of the last."""
    values = legendre.legvander(x, degree)
    return values, degree * (values[:, degree - 1] - x * values[:, degree]) / ((1 - x) * (1 + x))


def profile_points(points: int = POINTS) -> FloatArray:
    """Where a profile is sampled: Gauss' points (points,) between 0 at the inner and 1 at the outer end."""
    return _rule(points)[0].copy()


@dataclass(frozen=True)
class ProfileShafts(Law):
    """Series in v = s F M, F and M being the whole flexibility and inertia: h = F b(v), J = M e(v)/b(v)."""

    both_ends: ClassVar = ("ends",)
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

    @property
    def reach(self) -> float:
        """Angular frequency (rad/s) up to which the law holds; its series have as many terms as the limit needs."""
        return self.limit

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
        return np.asarray(_ROUNDINGS * UNIT_ROUNDOFF * np.abs(growth))


def profile_shafts(
    length: ArrayLike, flexibility_per_length: FloatArray, inertia_per_length: FloatArray
) -> ProfileShafts:
    """Pieces of `length` (shafts,) m, sampled at `profile_points`: f = 1/(G I) and m = rho I, each (shafts, points).

    f in rad/(N m2), m in kg m. The profile is smooth within a piece: a step, or a change of taper, ends it. Raises
    ValueError for a piece in which the series do not converge, as its profile is too steep.
    """
    long = np.atleast_1d(np.asarray(length, dtype=np.float64))
    f, m = (
        np.atleast_2d(np.asarray(a, dtype=np.float64))
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
