"""Finite elements of a shaft as spans: the unknowns inside are eliminated at each frequency (dynamic condensation).

The angles inside an element are relative to its static bend, and there in its modes with both ends fixed, of
stiffness 1 and inertia c_j. With the whole inertia between static bends (a, b at the ends, c across) and the coupling
g_j of the modes to both, the dynamic stiffness across is -1/h with

    1/h = k + s c + s^2 sum g_inner g_outer/(1 - s c_j),    J = row sum of the inertia + s sum g_end g_turn/(1 - s c_j),

where g_turn couples to the turning of the element as a whole, which has no stiffness at all: no torque, exactly.
Without unknowns inside, 1/h = k + s c and J is constant: linear elements keep full relative accuracy.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.distributed.span_laws import UNIT_ROUNDOFF, Law, Pi, Shafts
from torsion.kernels.modes.mode_shapes import ShaftModes, TreeModes, shape_sign
from torsion.kernels.trees.tree import Tree, bends, rigid_shapes, rigidity

_ROUNDINGS = 64.0  # of stiffness, inertia and coupling, in comparison with many digits
_AT_ONCE = 2**18  # modes inside times frequencies; 2 MB an array
_NEARLY = 1e-6  # how near to 0 or 1 an unknown inside must come when the element turns by 1


@dataclass(frozen=True)
class CondensedElements(Law):
    """Condensed elements; modes inside, fixed at both ends, as (shafts, inside)."""

    both_ends: ClassVar = ("ends", "coupling")
    stiffness: FloatArray  # (shafts,) N m/rad, k of the static bend
    across: FloatArray  # (shafts,) kg m2, c
    ends: FloatArray  # (shafts, 2) kg m2, row sums at the inner and the outer end
    modes: FloatArray  # (shafts, inside) s2, c_j = 1/frequency^2
    coupling: FloatArray  # (shafts, 2, inside) g of the inner and the outer end
    coupling_turn: FloatArray  # (shafts, inside) g of the turning as a whole: not the rounded sum of the other two

    @cached_property
    def limit(self) -> float:
        """Lowest frequency (rad/s) of any element with both ends fixed; infinite without unknowns inside."""
        largest = float(self.modes.max(initial=0.0))
        return 1.0 / math.sqrt(largest) if largest > 0.0 else math.inf

    @cached_property
    def _weights(self) -> FloatArray:
        """(shafts, 3, inside) of s/(1 - s c_j) in 1/h, less its static part, and in both end inertias."""
        across = self.coupling.prod(axis=1, keepdims=True)
        return np.concatenate([across, self.coupling * self.coupling_turn[:, None]], axis=1)

    def _pi(self, s: NDArray[Any]) -> Pi:
        rows = np.empty((self.size, 3, s.shape[1]), dtype=s.dtype)
        block = max(1, _AT_ONCE // max(self.modes.size, 1))
        for begin in range(0, s.shape[1], block):
            part = s[:, None, begin : begin + block]
            rows[:, :, begin : begin + block] = self._weights @ (
                part / (1.0 - part * self.modes[:, :, None])
            )
        spring = 1.0 / (self.stiffness[:, None] + s * (self.across[:, None] + rows[:, 0]))
        return spring, self.ends[:, :1] + rows[:, 1], self.ends[:, 1:] + rows[:, 2]

    def rounding(self, square: FloatArray) -> FloatArray:
        nearest = 1.0 - square * self.modes.max(initial=0.0)
        return np.asarray(_ROUNDINGS * UNIT_ROUNDOFF / np.maximum(nearest, UNIT_ROUNDOFF))

    def scaled(self, stiffness: ArrayLike, inertia: ArrayLike) -> "CondensedElements":
        """The elements with their stiffness and inertia multiplied by `stiffness` and `inertia` (shafts,), positive.

        Of one element, as many as there are factors.
        """
        k, m = (np.asarray(factor, dtype=float)[:, None] for factor in (stiffness, inertia))
        g = m / np.sqrt(k)
        couplings = self.coupling * g[:, None], self.coupling_turn * g
        return CondensedElements(
            self.stiffness * k[:, 0],
            self.across * m[:, 0],
            self.ends * m,
            self.modes * (m / k),
            *couplings,
        )

    @classmethod
    def joined(cls, parts: "Sequence[CondensedElements]") -> "CondensedElements":
        """Elements of one degree, one part after another."""
        return cls(
            *(np.concatenate([getattr(part, name.name) for part in parts]) for name in fields(cls))
        )


def condensed_elements(stiffness: ArrayLike, inertia: ArrayLike) -> CondensedElements:
    """Elements with matrices N m/rad and kg m2, (shafts, unknowns, unknowns) each: first the inner, then the outer end.

    The unknowns inside may be angles (nodal elements) or factors of bubbles (hierarchic ones): which, is read off the
    stiffness. Raises ValueError where turning the element as a whole bends it.
    """
    k, m = (np.asarray(matrix, dtype=float) for matrix in (stiffness, inertia))
    if k.ndim != 3 or k.shape != m.shape or k.shape[1] != k.shape[2] or k.shape[1] < 2:
        raise ValueError(
            f"matrices have shapes {k.shape} and {m.shape}; expected (shafts, unknowns, unknowns) twice"
        )
    number, unknowns, _ = k.shape
    inside = k[:, 2:, 2:]
    bend = np.zeros(
        (number, unknowns)
    )  # static, under the outer end's angle 1, the inner end fixed
    bend[:, 1], bend[:, 2:] = 1.0, -np.linalg.solve(inside, k[:, 2:, 1, None])[:, :, 0]
    turn = np.ones((number, unknowns))
    # Unknowns inside when the element turns by 1 are 0 or 1, exactly, but for what solving has left.
    given = -np.linalg.solve(inside, k[:, 2:, :2].sum(axis=2)[:, :, None])[:, :, 0]
    turn[:, 2:] = np.rint(given)
    if np.any(np.abs(given - turn[:, 2:]) > _NEARLY) or not np.isin(turn, (0.0, 1.0)).all():
        raise ValueError(
            "turning an element as a whole bends it: its stiffness has no rigid motion"
        )
    inner_bend = turn - bend
    lower = np.linalg.cholesky(inside)
    half = np.linalg.solve(lower, m[:, 2:, 2:])
    held = np.linalg.solve(lower, half.transpose(0, 2, 1))
    modes, vectors = np.linalg.eigh(0.5 * (held + held.transpose(0, 2, 1)))
    shapes = np.linalg.solve(lower.transpose(0, 2, 1), vectors)
    both = np.stack([inner_bend, bend], axis=1)
    return CondensedElements(
        np.einsum("bi,bij,bj->b", bend, k, bend),
        np.einsum("bi,bij,bj->b", inner_bend, m, bend),
        np.einsum("bei,bij,bj->be", both, m, turn),
        np.maximum(modes, 0.0),
        np.einsum("bji,bjl,bel->bei", shapes, m[:, 2:], both),
        np.einsum("bji,bjl,bl->bi", shapes, m[:, 2:], turn),
    )


def dense_modes(tree: Tree, count: int) -> TreeModes:
    """The lowest `count` elastic modes, or all there are, of a tree whose shafts are finite elements of one degree.

    `lower` and `upper` are the frequencies themselves and `certified` is False. Raises ValueError for other shafts.
    """
    shafts = tree.shafts
    if shafts is None:
        raise ValueError("the dense way is for a tree with distributed shafts")
    (element,) = shafts.laws if len(shafts.laws) == 1 else (None,)
    if not isinstance(element, CondensedElements):
        raise ValueError(
            "the dense way is for finite elements of one degree; expected one law of elements"
        )
    spring, root, bends_of, angles, inside = static_bends(tree, shafts, element)
    local, bodies = _local_inertia(element), rigidity(tree.static)
    ends = np.column_stack([tree.shaft_parent, shafts.node])
    count = min(count, bodies.elastic + int(np.count_nonzero(element.modes)))
    mass = _rows_of_inertia(tree, ends, angles, inside, local)
    y = np.linalg.svd(mass, full_matrices=False)[2][:count].T
    weight = np.sum((mass @ y) ** 2, axis=0)
    square = np.sum(y * y, axis=0) / weight
    order = np.argsort(square, kind="stable")
    y, square = y[:, order] / np.sqrt(weight[order]), square[order]
    angle = angles @ y
    y = y * (sign := shape_sign(angle))
    angle *= sign
    twist, torque = np.zeros_like(angle), np.zeros_like(angle)
    bend, root = bends_of @ y, root[:, None]
    twist[spring], torque[spring] = -root * bend, -bend / root
    parts = np.concatenate((angle[ends], y[inside]), axis=1)  # (shafts, 2 + modes, m)
    carried = local @ parts
    of_shafts, elastic, outer = np.sum(parts * carried, axis=1), torque * twist, torque.copy()
    elastic[shafts.node] += np.sum(parts[:, 2:] ** 2, axis=1)
    torque[shafts.node] -= square * carried[:, 0]
    outer[shafts.node] += square * carried[:, 1]

    # Torques of rigid spans, by the equilibrium of all that lies beyond them.
    is_rigid = tree.flexibility == 0.0
    is_rigid[shafts.node] = False
    for station, _, _ in tree.steps:
        if is_rigid[station]:
            beyond = sum(torque[child] for child in tree.children[station])
            torque[station] = beyond - square * tree.moving_inertia[station] * angle[station]
            outer[station] = torque[station]
    kinetic = tree.moving_inertia[:, None] * angle**2
    tree.add_ends(kinetic, 0.5 * of_shafts, 0.5 * of_shafts)
    frequency, rigid = np.sqrt(square), rigid_shapes(tree.static, bodies)
    return TreeModes(
        frequency,
        frequency.copy(),
        frequency.copy(),
        angle,
        torque,
        rigid.shape[1],
        rigid,
        certified=False,
        shafts=ShaftModes(outer, kinetic, elastic / square, of_shafts),
    )


def _local_inertia(element: CondensedElements) -> FloatArray:
    """Inertia (shafts, 2 + modes, 2 + modes) kg m2 of the ends and the modes inside."""
    number, modes = element.modes.shape
    local = np.zeros((number, 2 + modes, 2 + modes))
    local[:, [0, 1], [0, 1]] = element.ends - element.across[:, None]
    local[:, 0, 1] = local[:, 1, 0] = element.across
    local[:, :2, 2:] = element.coupling
    local[:, 2:, :2] = element.coupling.transpose(0, 2, 1)
    inside = np.arange(2, 2 + modes)
    local[:, inside, inside] = element.modes
    return local


def _rows_of_inertia(
    tree: Tree, ends: IntArray, angle: FloatArray, inside: IntArray, local: FloatArray
) -> FloatArray:
    """C (rows, coordinates), with as many rows for an element as it has unknowns, of its inertia `local` = R'R."""
    try:
        root = np.linalg.cholesky(local).transpose(0, 2, 1)
    except np.linalg.LinAlgError:  # an element without inertia
        values, vectors = np.linalg.eigh(local)
        root = np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.transpose(0, 2, 1)
    number, unknowns, _ = root.shape
    rows = root[:, :, :2] @ angle[ends]
    row = np.arange(unknowns)[None, :, None]
    rows[np.arange(number)[:, None, None], row, inside[:, None, :]] += root[:, :, 2:]
    stations = np.flatnonzero(tree.moving_inertia > 0.0)
    station_rows = np.sqrt(tree.moving_inertia[stations])[:, None] * angle[stations]
    return np.concatenate((rows.reshape(number * unknowns, -1), station_rows))


def static_bends(
    train: Tree, shafts: Shafts, element: CondensedElements
) -> tuple[IntArray, FloatArray, FloatArray, FloatArray, IntArray]:
    """What the coordinates of the tree `train` mean, whose shafts `shafts` are `element`.

    As of `bends`, a shaft being a spring of its static flexibility: springs (springs,), roots of their flexibilities,
    the bend of each over its root (springs, coordinates), angles (stations, coordinates) rad; and the coordinate of
    each mode inside an element (shafts, modes).
    """
    tree = train.static
    bodies = rigidity(tree)
    spring, root, bend, angle = bends(tree, bodies)

    # A free part turns back as a whole, lest a mode inside carry it along.
    part = bodies.component[:, None] == bodies.component[bodies.free_roots]
    turned = part / (tree.moving_inertia @ part) @ part[shafts.node].T
    balance = np.repeat(turned, element.modes.shape[1], axis=1) * element.coupling_turn.reshape(-1)
    angle = np.concatenate((angle, -balance), axis=1)
    inside = bend.shape[1] + np.arange(element.modes.size).reshape(element.modes.shape)
    bend = np.concatenate((bend, np.zeros((len(spring), element.modes.size))), axis=1)
    return spring, root, bend, angle, inside
