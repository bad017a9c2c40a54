"""Uniform pieces of shafts as continua, in closed form."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.distributed.span_laws import (
    UNIT_ROUNDOFF,
    Law,
    Pi,
    alternating_slope,
    distinct,
)

_ROUNDINGS = 20.0  # of tan (4 units), what follows from it and the factors
_SERIES_BELOW = 4.0  # square of the phase; above, differences lose less than a digit
_TERMS = 14  # 4^14/29! < 1e-22
_SINE = np.array([1.0 / math.factorial(2 * k + 1) for k in range(_TERMS)])  # of sin(mu)/mu in mu^2
_COSINE = np.array([1.0 / math.factorial(2 * k + 2) for k in range(_TERMS)])  # of (1 - cos mu)/mu^2


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
        by_sine, by_tangent = _derivatives(travel * s, sine, tangent, cosine)
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
            np.atleast_1d(np.asarray(values, dtype=np.float64))
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


def _derivatives(
    v: FloatArray, sine: FloatArray, tangent: FloatArray, cosine: FloatArray
) -> tuple[FloatArray, ...]:
    """Derivatives with respect to v = mu^2 of sin(mu)/mu and tan(mu/2)/(mu/2) = 2 ((1 - cos mu)/mu^2)/(sin(mu)/mu)."""
    versed = 0.5 * (tangent * sine)
    small = v < _SERIES_BELOW
    near, far = np.where(small, v, 0.0), np.where(small, 1.0, v)
    by_sine = np.where(small, alternating_slope(_SINE, near), (cosine - sine) / (2.0 * far))
    by_versed = np.where(small, alternating_slope(_COSINE, near), (0.5 * sine - versed) / far)
    return by_sine, 2.0 * (by_versed - versed * by_sine / sine) / sine
