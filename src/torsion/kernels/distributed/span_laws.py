"""What a span with distributed inertia looks like from its ends: a spring and two inertias, all of them of frequency.

Seen from its ends, a piece of a shaft at s = w^2 is a symmetric reciprocal two-port, so that a pi stands for it: a
flexibility h(s) between the end inertias Ji(s) at its inner and Jo(s) at its outer end. Below the lowest frequency of
the piece with both ends fixed all three are positive, and Sturm counts need no correction (Wittrick and Williams 1971).
With a loss factor of the material, G becomes G (1 + i eta): h and s are divided by 1 + i eta, J is J(s/(1 + i eta)).
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray

Pi = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]
UNIT_ROUNDOFF = 2.0**-53
_STEP = 1e-100  # rad2/s2, beside which nothing changes but imaginary parts (Squire and Trapp 1998)
_FEW = (
    2**9
)  # shafts times frequencies, up to which it does not pay to look for equal shafts (measured)


@dataclass(frozen=True)
class Slopes:
    """Values of the pi and their derivatives with respect to s = w^2; all (shafts, m)."""

    flexibility: FloatArray  # rad/(N m)
    inner: FloatArray  # kg m2
    outer: FloatArray  # kg m2
    flexibility_slope: FloatArray  # rad s2/(N m)
    inner_slope: FloatArray  # kg m2 s2
    outer_slope: FloatArray  # kg m2 s2


@dataclass(frozen=True)
class Law(ABC):
    """The pi of shafts of one sort, as a function of s = w^2; every field has a row for each shaft."""

    both_ends: ClassVar[
        tuple[str, ...]
    ] = ()  # fields (shafts, 2, ...) of the inner and the outer end
    ends_at_limit: ClassVar[bool] = False  # beyond its limit it says nothing

    @property
    def size(self) -> int:
        return len(next(iter(vars(self).values())))

    @property
    @abstractmethod
    def limit(self) -> float:
        """Angular frequency (rad/s) below which every flexibility and end inertia is positive."""

    def at(self, square: NDArray[Any]) -> Pi:
        """Flexibility rad/(N m), inner and outer end inertia kg m2, each (shafts, m), at s (m,) or (shafts, m)."""
        if square.ndim > 1:
            return self._pi(square)
        few, position = self._distinct_at(square)
        flexibility, inner, outer = few._pi(square[None])
        return flexibility[position], inner[position], outer[position]

    def slopes(self, square: FloatArray) -> Slopes:
        """The same with their derivatives at s (m,), real."""
        few, position = self._distinct_at(square)
        return Slopes(*(row[position] for row in few._slopes(square[None])))

    @abstractmethod
    def rounding(self, square: FloatArray) -> FloatArray:
        """Relative error (m,) that rounding may leave in the values at s (m,), besides that of s itself."""

    def turned(self, which: BoolArray) -> Self:
        """The same with inner and outer end exchanged in `which` (shafts,)."""
        exchanged = {}
        for name in self.both_ends:
            values = getattr(self, name)
            exchanged[name] = np.where(
                which.reshape(-1, *[1] * (values.ndim - 1)), values[:, ::-1], values
            )
        return replace(self, **exchanged)

    @abstractmethod
    def _pi(self, s: NDArray[Any]) -> Pi:
        """What `at` returns, at s (1, m) or (shafts, m)."""

    def _slopes(self, s: FloatArray) -> tuple[FloatArray, ...]:
        """The six of `Slopes`, each (shafts, m), at s (1, m): by a complex step, which cancels nothing."""
        rows = self._pi(s + 1j * _STEP)
        return *(row.real for row in rows), *(row.imag / _STEP for row in rows)

    def _distinct_at(self, square: NDArray[Any]) -> tuple[Self, IntArray | slice]:
        """As `_distinct`; all shafts, where it does not pay to look for equal ones."""
        return (self, slice(None)) if self.size * len(square) <= _FEW else self._distinct

    @cached_property
    def _distinct(self) -> tuple[Self, IntArray | slice]:
        """The different shafts, and which one each shaft is."""
        columns = {field.name: getattr(self, field.name) for field in fields(self)}
        first, position = distinct(
            np.concatenate([column.reshape(self.size, -1) for column in columns.values()], axis=1)
        )
        return replace(self, **{name: column[first] for name, column in columns.items()}), position


@dataclass(frozen=True)
class Shafts:
    """Spans of a tree that are pieces of a shaft, or finite elements of one; those of one law after another."""

    node: IntArray  # (shafts,) station at the outer end of each, which is the number of its span
    laws: tuple[Law, ...]  # of all shafts in the order of `node`

    @cached_property
    def limit(self) -> float:
        """Angular frequency (rad/s) below which every flexibility and end inertia is positive."""
        return min(law.limit for law in self.laws)

    @cached_property
    def reach(self) -> float:
        """Angular frequency (rad/s) up to which the laws hold at all; counts need `limit`, responses only this."""
        return min((law.limit for law in self.laws if law.ends_at_limit), default=math.inf)

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """Where the shafts of each law stand among all shafts."""
        edges = np.cumsum([0, *(law.size for law in self.laws)]).tolist()
        if edges[-1] != len(self.node):
            raise ValueError(f"the laws are for {edges[-1]} shafts; expected {len(self.node)}")
        return tuple(slice(a, b) for a, b in pairwise(edges))

    def at(self, square: ArrayLike) -> Pi:
        """As of a `Law`; `square` (m,), or (shafts, m), real or complex, rad2/s2."""
        s = np.asarray(square)
        values = [
            law.at(s if s.ndim == 1 else s[part])
            for law, part in zip(self.laws, self.parts, strict=True)
        ]
        flexibility, inner, outer = (
            values[0] if len(values) == 1 else map(np.concatenate, zip(*values, strict=True))
        )
        return flexibility, inner, outer

    def lossy(self, square: FloatArray, loss: FloatArray) -> Pi:
        """The same of a material with the loss factors `loss` (shafts,), complex, at real s (m,)."""
        flexibility, inner, outer = np.empty((3, len(loss), len(square)), dtype=complex)
        for eta in np.unique(loss).tolist():
            rows, turn = loss == eta, 1.0 + 1j * eta
            h, near, far = self.at(square / turn)
            flexibility[rows], inner[rows], outer[rows] = h[rows] / turn, near[rows], far[rows]
        return flexibility, inner, outer

    def slopes(self, square: FloatArray) -> Slopes:
        """Return what `Law.slopes` does, for the shafts of all laws."""
        slopes = [vars(law.slopes(square)).values() for law in self.laws]
        return Slopes(*map(np.concatenate, zip(*slopes, strict=True)))

    def rounding(self, square: FloatArray) -> FloatArray:
        """As of a `Law`, the largest of any."""
        return np.asarray(np.max([law.rounding(square) for law in self.laws], axis=0))

    def turned(self, which: BoolArray) -> "Shafts":
        """Return what `Law.turned` does, for the shafts of all laws."""
        laws = tuple(
            law.turned(which[part]) for law, part in zip(self.laws, self.parts, strict=True)
        )
        return replace(self, laws=laws)


def distinct(table: FloatArray) -> tuple[IntArray, IntArray | slice]:
    """First row of each sort in `table` (shafts, values), and which sort (shafts,) each row is."""
    number: dict[bytes, int] = {}
    position = np.array(
        [number.setdefault(row.tobytes(), len(number)) for row in table], dtype=np.int64
    )
    first = np.unique(position, return_index=True)[1]
    return first, position if len(first) < len(table) else slice(None)


def alternating(coefficients: NDArray[Any], v: NDArray[Any]) -> NDArray[Any]:
    """sum_k (-v)^k c_k by Horner's rule; coefficients (..., terms), the leading axes as those of v."""
    terms = coefficients.shape[-1]
    minus = -v
    total = np.broadcast_to(coefficients[..., terms - 1, None], v.shape).astype(v.dtype)
    for k in range(terms - 2, -1, -1):
        total *= minus
        total += coefficients[..., k, None]
    return total
