"""Spans with distributed inertia: which stations of a tree have one, and what it is like at each frequency."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.distributed.element import CondensedElements, condensed_elements
from torsion.kernels.distributed.profile import ProfileShafts, profile_points, profile_shafts
from torsion.kernels.distributed.span_law import Law, Pi, Slopes
from torsion.kernels.distributed.uniform import UniformShafts, uniform_shafts

__all__ = [
    "CondensedElements",
    "Law",
    "ProfileShafts",
    "Shafts",
    "UniformShafts",
    "condensed_elements",
    "one_mode_elements",
    "profile_points",
    "profile_shafts",
    "uniform_shafts",
]  # fmt: skip


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


def one_mode_elements(shafts: Shafts) -> CondensedElements:
    """Elements with one mode inside that are near to shafts of a finite limit, up to half of it.

    Their values and slopes at frequency 0 are those of the shafts, which gives the coupling of the mode; its own
    frequency follows from the end inertias at half the limit.
    """
    middle = 0.25 * shafts.limit**2
    at, (_, inner, outer) = shafts.slopes(np.zeros(1)), shafts.at(np.array([middle]))
    first, last = at.inner_slope[:, 0], at.outer_slope[:, 0]
    turn = first + last
    rise = inner[:, 0] - at.inner[:, 0] + (outer[:, 0] - at.outer[:, 0])
    mode = 1.0 / middle - np.divide(turn, rise, out=np.full(shafts.size, 1.0 / middle), where=rise > 0.0)
    root = np.sqrt(np.maximum(turn, 0.0))
    share = np.divide(1.0, root, out=np.zeros(shafts.size), where=root > 0.0)
    inside = (np.clip(mode, 0.0, 1.0 / shafts.limit**2), first * share, last * share, root)
    across = -at.flexibility_slope[:, 0] / at.flexibility[:, 0] ** 2
    ends = (1.0 / at.flexibility[:, 0], across, at.inner[:, 0], at.outer[:, 0])
    return CondensedElements(*ends, *(values[:, None] for values in inside))
