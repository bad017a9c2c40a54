"""Rows of springs with inertias between them, seen from their two ends."""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.arrays import BoolArray, FloatArray
from torsion.kernels.distributed.span_laws import UNIT_ROUNDOFF, Law, Pi

_ROUNDINGS = 8.0  # of one step of the elimination


@dataclass(frozen=True)
class SegmentChains(Law):
    """Spring, inertia, spring, inertia, ..., spring from the inner to the outer end; shorter rows end in zeros.

    The inertias are eliminated one after another. Two flexibilities h1, h2 that meet at an inertia J are at s = w^2
    one of h = h1 + h2 - s J h1 h2, with the inertias J h2/h and J h1/h at its ends.
    """

    flexibility: FloatArray  # (rows, segments) rad/(N m)
    inertia: FloatArray  # (rows, segments) kg m2 behind each spring; 0 behind the last
    is_turned: BoolArray  # (rows,) the row is given from its outer to its inner end

    @cached_property
    def limit(self) -> float:
        """rad/s that no frequency of a row with both ends fixed lies below (Dunkerley's bound)."""
        before = np.cumsum(self.flexibility, axis=1)
        total = before[:, -1:]
        held = np.divide(
            before * (total - before), total, out=np.zeros_like(before), where=total > 0.0
        )
        slowest = float((self.inertia * held).sum(axis=1).max(initial=0.0))
        return 1.0 / math.sqrt(slowest) if slowest > 0.0 else math.inf

    def _pi(self, s: NDArray[Any]) -> Pi:
        h = np.repeat(self.flexibility[:, :1], s.shape[1], axis=1).astype(s.dtype)
        inner, outer = np.zeros_like(h), np.zeros_like(h)
        for k in range(1, self.flexibility.shape[1]):
            spring, between = self.flexibility[:, k, None], self.inertia[:, k - 1, None] + outer
            joined = h + spring - s * between * h * spring
            share = between / joined
            inner += share * spring
            outer = share * h
            h = joined
        return self._from_inside(h, inner, outer)

    def rounding(self, square: FloatArray) -> FloatArray:
        """As of a `Law`: by how much every flexibility is less than the sum of its springs."""
        total = self.flexibility.sum(axis=1).max(initial=0.0)
        h = self.at(square)[0]
        growth = total / np.maximum(np.abs(h).min(axis=0, initial=total), UNIT_ROUNDOFF * total)
        return np.asarray(_ROUNDINGS * self.flexibility.shape[1] * UNIT_ROUNDOFF * growth)

    def turned(self, which: BoolArray) -> "SegmentChains":
        return replace(self, is_turned=self.is_turned ^ which)

    def _from_inside(self, h: NDArray[Any], first: NDArray[Any], last: NDArray[Any]) -> Pi:
        """What was found at both ends of the rows as they are given, at the inner and the outer end."""
        if not self.is_turned.any():
            return h, first, last
        swap = self.is_turned[:, None]
        return h, np.where(swap, last, first), np.where(swap, first, last)
