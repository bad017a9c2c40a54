"""Finite elements of a shaft as spans: the unknowns inside are eliminated at each frequency (dynamic condensation).

The angles inside an element are relative to its static bend, and there in its modes with both ends fixed, of
stiffness 1 and inertia c_j. With the whole inertia between static bends (a, b at the ends, c across) and the coupling
g_j of the modes to both, the dynamic stiffness across is -1/h with

    1/h = k + s c + s^2 sum g_inner g_outer/(1 - s c_j),    J = row sum of the inertia + s sum g_end g_turn/(1 - s c_j),

where g_turn couples to the turning of the element as a whole, which has no stiffness at all: no torque, exactly.
Without unknowns inside, 1/h = k + s c and J is constant: linear elements keep full relative accuracy.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.distributed.span_laws import UNIT_ROUNDOFF, Law, Pi, Slopes, distinct

_ROUNDINGS = 64.0  # of stiffness, inertia and coupling, in comparison with many digits
_AT_ONCE = 2**18  # modes inside times frequencies; 2 MB an array
_FEW = 2**11  # modes inside times frequencies, up to which it does not pay to look for equal elements (measured)
_NEARLY = 1e-6  # how near to 0 or 1 an unknown inside must come when the element turns by 1


@dataclass(frozen=True)
class CondensedElements(Law):
    """Condensed elements; modes inside, fixed at both ends, as (shafts, inside)."""

    stiffness: FloatArray  # (shafts,) N m/rad, k of the static bend
    across: FloatArray  # (shafts,) kg m2, c
    inner: FloatArray  # (shafts,) kg m2, row sum at the inner end
    outer: FloatArray  # (shafts,) kg m2
    modes: FloatArray  # (shafts, inside) s2, c_j = 1/frequency^2
    coupling_inner: FloatArray  # (shafts, inside) g of the inner end
    coupling_outer: FloatArray  # (shafts, inside)
    coupling_turn: FloatArray  # (shafts, inside) g of the turning as a whole: not the rounded sum of the other two

    @cached_property
    def limit(self) -> float:
        """Lowest frequency (rad/s) of any element with both ends fixed; infinite without unknowns inside."""
        largest = float(self.modes.max(initial=0.0))
        return 1.0 / math.sqrt(largest) if largest > 0.0 else math.inf

    @cached_property
    def _distinct(self) -> tuple["CondensedElements", IntArray]:
        """The different elements, and which one each shaft is."""
        columns = [getattr(self, name) for name in self.__dataclass_fields__]
        first, position = distinct(np.concatenate([column.reshape(self.size, -1) for column in columns], axis=1))
        return CondensedElements(*(column[first] for column in columns)), position

    @cached_property
    def _weights(self) -> FloatArray:
        """(shafts, 3, inside) of s/(1 - s c_j) in 1/h, less its static part, and in both end inertias."""
        pairs = (
            (self.coupling_inner, self.coupling_outer),
            (self.coupling_inner, self.coupling_turn),
            (self.coupling_outer, self.coupling_turn),
        )
        return np.stack([one * other for one, other in pairs], axis=1)

    def at(self, square: NDArray[Any]) -> Pi:
        if square.ndim > 1 or self.modes.size * len(square) <= _FEW:
            return self._values(np.broadcast_to(square, (self.size, square.shape[-1])))
        few, position = self._distinct
        flexibility, inner, outer = few._values(np.broadcast_to(square, (few.size, len(square))))
        return flexibility[position], inner[position], outer[position]

    def _values(self, s: NDArray[Any]) -> Pi:
        return self._pi(s, self._summed(s, lambda part, modes: part / (1.0 - part * modes)))

    def _pi(self, s: NDArray[Any], rows: NDArray[Any]) -> Pi:
        spring = 1.0 / (self.stiffness[:, None] + s * (self.across[:, None] + rows[:, 0]))
        return spring, self.inner[:, None] + rows[:, 1], self.outer[:, None] + rows[:, 2]

    def _summed(self, s: NDArray[Any], answer: Callable[[NDArray[Any], FloatArray], NDArray[Any]]) -> NDArray[Any]:
        """Sums (shafts, 3, m) over the modes inside of `_weights` times `answer` of s (shafts, m) and the modes."""
        found = np.empty((self.size, 3, s.shape[1]), dtype=s.dtype)
        block = max(1, _AT_ONCE // max(self.modes.size, 1))
        for begin in range(0, s.shape[1], block):
            part = slice(begin, begin + block)
            found[:, :, part] = self._weights @ answer(s[:, None, part], self.modes[:, :, None])
        return found

    def slopes(self, square: FloatArray) -> Slopes:
        few, position = self._distinct
        s = np.broadcast_to(square, (few.size, len(square)))
        plain = few._summed(s, lambda part, modes: part / (1.0 - part * modes))
        squared = few._summed(s, lambda part, modes: 1.0 / (1.0 - part * modes) ** 2)
        h, inner, outer = few._pi(s, plain)
        of_stiffness = few.across[:, None] + (plain[:, 0] + s * squared[:, 0])
        rows = (h, inner, outer, -(h * h) * of_stiffness, squared[:, 1], squared[:, 2])
        return Slopes(square, *(row[position] for row in rows))

    def rounding(self, square: FloatArray) -> FloatArray:
        nearest = 1.0 - square * self.modes.max(initial=0.0)
        return np.asarray(_ROUNDINGS * UNIT_ROUNDOFF / np.maximum(nearest, UNIT_ROUNDOFF))

    def turned(self, which: BoolArray) -> "CondensedElements":
        swap = np.asarray(which)[:, None]
        return replace(
            self,
            inner=np.where(which, self.outer, self.inner),
            outer=np.where(which, self.inner, self.outer),
            coupling_inner=np.where(swap, self.coupling_outer, self.coupling_inner),
            coupling_outer=np.where(swap, self.coupling_inner, self.coupling_outer),
        )

    def scaled(self, stiffness: ArrayLike, inertia: ArrayLike) -> "CondensedElements":
        """The elements with their stiffness and inertia multiplied by `stiffness` and `inertia` (shafts,), positive.

        Of one element, as many as there are factors.
        """
        k, m = (np.asarray(factor, dtype=np.float64) for factor in (stiffness, inertia))
        g = (m / np.sqrt(k))[:, None]
        ends, couplings = (self.across, self.inner, self.outer), (self.coupling_inner, self.coupling_outer)
        inside = (self.modes * (m / k)[:, None], *(coupling * g for coupling in (*couplings, self.coupling_turn)))
        return CondensedElements(self.stiffness * k, *(end * m for end in ends), *inside)

    @classmethod
    def joined(cls, parts: "Sequence[CondensedElements]") -> "CondensedElements":
        """Elements of one degree, one part after another."""
        if len(parts) == 1:
            return parts[0]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in cls.__dataclass_fields__))


def condensed_elements(stiffness: ArrayLike, inertia: ArrayLike) -> CondensedElements:
    """Elements with matrices N m/rad and kg m2, (shafts, unknowns, unknowns) each: first the inner, then the outer end.

    The unknowns inside may be angles (nodal elements) or factors of bubbles (hierarchic ones): which, is read off the
    stiffness. Raises ValueError where turning the element as a whole bends it.
    """
    k, m = (np.asarray(matrix, dtype=np.float64) for matrix in (stiffness, inertia))
    if k.ndim != 3 or k.shape != m.shape or k.shape[1] != k.shape[2] or k.shape[1] < 2:
        raise ValueError(f"matrices have shapes {k.shape} and {m.shape}; expected (shafts, unknowns, unknowns) twice")
    if not len(k):
        return CondensedElements(*np.zeros((4, 0)), *np.zeros((4, 0, k.shape[1] - 2)))
    return _condensed(k, m) if k.shape[1] > 2 else _linear(k, m)


def _linear(k: FloatArray, m: FloatArray) -> CondensedElements:
    across = 0.5 * (m[:, 0, 1] + m[:, 1, 0])
    none = np.zeros((len(k), 0))
    spring = -0.5 * (k[:, 0, 1] + k[:, 1, 0])
    return CondensedElements(spring, across, m[:, 0, 0] + across, m[:, 1, 1] + across, none, none, none, none)


def _condensed(k: FloatArray, m: FloatArray) -> CondensedElements:
    number, unknowns, _ = k.shape
    inside = k[:, 2:, 2:]
    bend = np.zeros((number, unknowns))  # static, under the outer end's angle 1, the inner end fixed
    bend[:, 1], bend[:, 2:] = 1.0, -np.linalg.solve(inside, k[:, 2:, 1, None])[:, :, 0]
    turn = np.ones((number, unknowns))
    turn[:, 2:] = _rigid(-np.linalg.solve(inside, k[:, 2:, :2].sum(axis=2)[:, :, None])[:, :, 0])
    other = turn - bend
    lower = np.linalg.cholesky(inside)
    half = np.linalg.solve(lower, m[:, 2:, 2:])
    held = np.linalg.solve(lower, half.transpose(0, 2, 1))
    modes, vectors = np.linalg.eigh(0.5 * (held + held.transpose(0, 2, 1)))
    shapes = np.linalg.solve(lower.transpose(0, 2, 1), vectors)

    def product(one: FloatArray, two: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("bi,bij,bj->b", one, m, two))

    def coupling(shape: FloatArray) -> FloatArray:
        return np.asarray(np.einsum("bji,bjl,bl->bi", shapes, m[:, 2:], shape))

    return CondensedElements(
        np.einsum("bi,bij,bj->b", bend, k, bend),
        product(other, bend),
        product(other, turn),
        product(bend, turn),
        np.maximum(modes, 0.0),
        coupling(other),
        coupling(bend),
        coupling(turn),
    )


def _rigid(inside: FloatArray) -> FloatArray:
    """Unknowns inside (shafts, inside) when the element turns by 1, exactly 0 or 1, from what solving has left."""
    exact = np.rint(inside)
    if np.any(np.abs(inside - exact) > _NEARLY) or np.any((exact != 0.0) & (exact != 1.0)):
        raise ValueError("turning an element as a whole bends it: its stiffness has no rigid motion")
    return exact
