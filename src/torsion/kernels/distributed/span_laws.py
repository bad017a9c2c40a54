"""What a span with distributed inertia looks like from its ends: a spring and two inertias, all of them of frequency.

Seen from its ends, a piece of a shaft at s = w^2 is a symmetric reciprocal two-port, so that a pi stands for it: a
flexibility h(s) between the end inertias Ji(s) at its inner and Jo(s) at its outer end. Below the lowest frequency of
the piece with both ends fixed all three are positive, and Sturm counts need no correction (Wittrick and Williams 1971).
With a loss factor of the material, G becomes G (1 + i eta): h and s are divided by 1 + i eta, J is J(s/(1 + i eta)).
"""

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray

Pi = tuple[NDArray[Any], NDArray[Any], NDArray[Any]]
UNIT_ROUNDOFF = 2.0**-53


@dataclass(frozen=True)
class Slopes:
    """Values of the pi and their derivatives with respect to s = w^2; all (shafts, m), but `square`."""

    square: FloatArray  # (m,) rad2/s2, s
    flexibility: FloatArray  # rad/(N m)
    inner: FloatArray  # kg m2
    outer: FloatArray  # kg m2
    flexibility_slope: FloatArray  # rad s2/(N m)
    inner_slope: FloatArray  # kg m2 s2
    outer_slope: FloatArray  # kg m2 s2

    @classmethod
    def joined(cls, parts: "list[Slopes]") -> "Slopes":
        """One after another."""
        names = list(cls.__dataclass_fields__)[1:]
        return cls(parts[0].square, *(np.concatenate([getattr(part, name) for part in parts]) for name in names))


class Law(ABC):
    """The pi of shafts of one sort, as a function of s = w^2."""

    @property
    def size(self) -> int:
        """Number of shafts: rows of every field."""
        return len(next(iter(vars(self).values())))

    @property
    @abstractmethod
    def limit(self) -> float:
        """Angular frequency (rad/s) below which every flexibility and end inertia is positive."""

    @property
    def reach(self) -> float:
        """Angular frequency (rad/s) up to which the law holds at all."""
        return math.inf

    @abstractmethod
    def at(self, square: NDArray[Any]) -> Pi:
        """Flexibility rad/(N m), inner and outer end inertia kg m2, each (shafts, m), at s (m,) or (shafts, m)."""

    @abstractmethod
    def slopes(self, square: FloatArray) -> Slopes:
        """The same with their derivatives at s (m,), real."""

    @abstractmethod
    def rounding(self, square: FloatArray) -> FloatArray:
        """Relative error (m,) that rounding may leave in the values at s (m,), besides that of s itself."""

    @abstractmethod
    def turned(self, which: BoolArray) -> "Law":
        """The same with inner and outer end exchanged in `which` (shafts,)."""


@dataclass(frozen=True)
class Shafts:
    """Spans of a tree that are pieces of a shaft, or finite elements of one; those of one law after another."""

    node: IntArray  # (shafts,) station at the outer end of each, which is the number of its span
    laws: tuple[Law, ...]  # of all shafts in the order of `node`

    @property
    def size(self) -> int:
        """Number of shafts."""
        return len(self.node)

    @cached_property
    def limit(self) -> float:
        """Angular frequency (rad/s) below which every flexibility and end inertia is positive."""
        return min((law.limit for law in self.laws), default=np.inf)

    @cached_property
    def reach(self) -> float:
        """Angular frequency (rad/s) up to which the laws hold at all; counts need `limit`, responses only this."""
        return min((law.reach for law in self.laws), default=np.inf)

    @cached_property
    def parts(self) -> tuple[slice, ...]:
        """The shafts of each law."""
        edges = np.cumsum([0, *(law.size for law in self.laws)]).tolist()
        if edges[-1] != self.size:
            raise ValueError(f"the laws are those of {edges[-1]} shafts; expected {self.size}")
        return tuple(slice(a, b) for a, b in pairwise(edges))

    def at(self, square: ArrayLike) -> Pi:
        """Flexibility rad/(N m), inner and outer end inertia kg m2, each (shafts, m), at s = w^2.

        `square` (m,), or (shafts, m), real or complex, rad2/s2.
        """
        s = np.asarray(square)
        found = [
            law.at(s if s.ndim == 1 else s[part]) for law, part in zip(self.laws, self.parts, strict=True) if law.size
        ]
        if len(found) == 1:
            return found[0]
        if not found:
            none = np.empty((0, s.shape[-1]), dtype=s.dtype)
            return none, none, none
        flexibility, inner, outer = (np.concatenate(rows) for rows in zip(*found, strict=True))
        return flexibility, inner, outer

    def lossy(self, square: FloatArray, loss: FloatArray) -> Pi:
        """The same of a material with the loss factors `loss` (shafts,), complex, at real s (m,)."""
        shapes = (self.size, len(square))
        flexibility, inner, outer = (np.empty(shapes, dtype=np.complex128) for _ in range(3))
        for law, part in zip(self.laws, self.parts, strict=True):
            for eta in np.unique(loss[part]).tolist():
                turn = 1.0 + 1j * eta
                rows = np.flatnonzero(loss[part] == eta) + part.start
                h, near, far = law.at(square / turn)
                kept = rows - part.start
                flexibility[rows], inner[rows], outer[rows] = h[kept] / turn, near[kept], far[kept]
        return flexibility, inner, outer

    def slopes(self, square: FloatArray) -> Slopes:
        """Values and derivatives with respect to s, each (shafts, m), at real s (m,)."""
        parts = [law.slopes(square) for law in self.laws if law.size]
        return Slopes.joined(parts) if parts else Slopes(square, *np.empty((6, 0, len(square))))

    def rounding(self, square: FloatArray) -> FloatArray:
        """Relative error (m,) that rounding may leave in the values at s (m,), besides that of s itself."""
        largest = np.zeros(len(square))
        for law in self.laws:
            np.maximum(largest, law.rounding(square) if law.size else 0.0, out=largest)
        return largest

    def turned(self, which: BoolArray) -> "Shafts":
        """The same with inner and outer end exchanged in `which` (shafts,)."""
        return Shafts(
            self.node, tuple(law.turned(which[part]) for law, part in zip(self.laws, self.parts, strict=True))
        )


def distinct(table: FloatArray) -> tuple[IntArray, IntArray]:
    """First row of each sort in `table` (shafts, values), and which sort (shafts,) each row is."""
    number: dict[bytes, int] = {}
    position = np.array([number.setdefault(row.tobytes(), len(number)) for row in table], dtype=np.int64)
    first = np.zeros(len(number), dtype=np.int64)
    first[position[::-1]] = np.arange(len(table))[::-1]
    return first, position


def alternating(coefficients: FloatArray, v: NDArray[Any]) -> NDArray[Any]:
    """sum_k (-v)^k c_k by Horner's rule; coefficients (..., terms), the leading axes as those of v."""
    terms = coefficients.shape[-1]
    minus = -v
    total = np.broadcast_to(coefficients[..., terms - 1, None], v.shape).astype(v.dtype)
    for k in range(terms - 2, -1, -1):
        total *= minus
        total += coefficients[..., k, None]
    return total


def alternating_slope(coefficients: FloatArray, v: NDArray[Any]) -> NDArray[Any]:
    """Derivative with respect to v of `alternating`."""
    powers = np.arange(1, coefficients.shape[-1])
    return -alternating(coefficients[..., 1:] * powers, v)
