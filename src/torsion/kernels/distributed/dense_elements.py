"""Modes of finite elements beyond the lowest frequency of an element by itself, by a dense decomposition.

For few, coarse elements of high degree of which many modes are wanted. In coordinates whose sum of squares is the
elastic energy, with the inertia in a factor C, the singular values c of C give s = 1/c^2; Rayleigh's quotient of the
energies, span by span, corrects them. Massless stations need no care. Nothing is proven.

Every span that bends has a coordinate; the modes inside the elements are the others.
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.distributed.condensed_element import CondensedElements
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.mode_shapes import ShaftModes, TreeModes, shape_sign
from torsion.kernels.reduction import Rigidity, bends, rigid_shapes, rigidity
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class Bends:
    """What coordinates mean. A spring is a span that is not rigid; that of a shaft has its static flexibility."""

    spring: IntArray  # (springs,) outer station of each
    root: FloatArray  # (springs,) root of its flexibility, (rad/(N m))^1/2
    bend: FloatArray  # (springs, coordinates) angle of the outer end less that of the inner one, over `root`
    angle: FloatArray  # (stations, coordinates) rad
    inside: IntArray  # (shafts, modes) coordinate of each mode inside an element


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
    coordinates, local = static_bends(tree, shafts, element), _local_inertia(element)
    count = min(count, rigidity(tree.static).elastic + int(np.count_nonzero(element.modes)))
    mass = _rows_of_inertia(tree, shafts, coordinates, local)
    y = np.linalg.svd(mass, full_matrices=False)[2][:count].T
    weight = np.sum((mass @ y) ** 2, axis=0)
    square = np.sum(y * y, axis=0) / weight
    order = np.argsort(square, kind="stable")
    y, square = y[:, order] / np.sqrt(weight[order]), square[order]
    angle = coordinates.angle @ y
    y = y * (sign := shape_sign(angle))
    angle *= sign
    twist, torque = np.zeros_like(angle), np.zeros_like(angle)
    bend, root = coordinates.bend @ y, coordinates.root[:, None]
    twist[coordinates.spring], torque[coordinates.spring] = -root * bend, -bend / root
    parts = np.concatenate(
        (angle[_ends(tree, shafts)], y[coordinates.inside]), axis=1
    )  # (shafts, 2 + modes, m)
    carried = local @ parts
    of_shafts, elastic, outer = np.sum(parts * carried, axis=1), torque * twist, torque.copy()
    elastic[shafts.node] += np.sum(parts[:, 2:] ** 2, axis=1)
    torque[shafts.node] -= square * carried[:, 0]
    outer[shafts.node] += square * carried[:, 1]
    _fill_rigid(tree, angle, torque, outer, square)
    kinetic = tree.moving_inertia[:, None] * angle**2
    tree.add_ends(kinetic, 0.5 * of_shafts, 0.5 * of_shafts)
    frequency, rigid = np.sqrt(square), rigid_shapes(tree.static, rigidity(tree.static))
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
    tree: Tree, shafts: Shafts, coordinates: Bends, local: FloatArray
) -> FloatArray:
    """C (rows, coordinates), with as many rows for an element as it has unknowns, of its inertia `local` = R'R."""
    try:
        root = np.linalg.cholesky(local).transpose(0, 2, 1)
    except np.linalg.LinAlgError:  # an element without inertia
        values, vectors = np.linalg.eigh(local)
        root = np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.transpose(0, 2, 1)
    number, unknowns, _ = root.shape
    rows = root[:, :, :2] @ coordinates.angle[_ends(tree, shafts)]
    row = np.arange(unknowns)[None, :, None]
    rows[np.arange(number)[:, None, None], row, coordinates.inside[:, None, :]] += root[:, :, 2:]
    stations = np.flatnonzero(tree.moving_inertia > 0.0)
    station_rows = np.sqrt(tree.moving_inertia[stations])[:, None] * coordinates.angle[stations]
    return np.concatenate((rows.reshape(number * unknowns, -1), station_rows))


def _ends(tree: Tree, shafts: Shafts) -> IntArray:
    """(shafts, 2) stations at the inner and the outer end of each."""
    return np.column_stack([tree.shaft_parent, shafts.node])


def _fill_rigid(
    tree: Tree, angle: FloatArray, torque: FloatArray, outer: FloatArray, square: FloatArray
) -> None:
    """Torques of rigid spans, by the equilibrium of all that lies beyond them; in place."""
    for i in range(tree.size - 1, -1, -1):
        if tree.parents[i] >= 0 and tree.shaft_of[i] < 0 and tree.flexibility[i] == 0.0:
            needed = -square * tree.moving_inertia[i] * angle[i]
            for child in tree.children[i]:
                needed = needed + torque[child]
            torque[i] = outer[i] = needed


def static_bends(train: Tree, shafts: Shafts, element: CondensedElements) -> Bends:
    """The coordinates of the tree `train`, whose shafts `shafts` are `element`."""
    tree = train.static
    rigid_bodies = rigidity(tree)
    spring, root, bend, angle = bends(tree, rigid_bodies)
    angle = np.concatenate((angle, _balance(tree, rigid_bodies, shafts, element)), axis=1)
    inside = bend.shape[1] + np.arange(element.modes.size).reshape(element.modes.shape)
    bend = np.concatenate((bend, np.zeros((len(spring), element.modes.size))), axis=1)
    return Bends(spring, root, bend, angle, inside)


def _balance(
    tree: Tree, bodies: Rigidity, shafts: Shafts, element: CondensedElements
) -> FloatArray:
    """Angle (stations, modes) by which a free part turns back as a whole, lest a mode inside carry it along."""
    inertia = tree.moving_inertia
    part = bodies.component[:, None] == bodies.component[bodies.free_roots]
    share = part / (inertia @ part)
    turned = share @ part[shafts.node].T
    return -np.repeat(turned, element.modes.shape[1], axis=1) * element.coupling_turn.reshape(-1)
