"""Modes of finite elements beyond the lowest frequency of an element by itself, by a dense decomposition.

For few, coarse elements of high degree of which many modes are asked. In coordinates whose sum of squares is the
elastic energy (`static_bends`), with the inertia in a factor C, the singular values c of C give s = 1/c^2; Rayleigh's
quotient of the energies, span by span, corrects them. Massless stations need no care. Nothing is proven.
"""

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.distributed.distributed_shafts import Shafts, one_mode_elements
from torsion.kernels.distributed.element import CondensedElements
from torsion.kernels.distributed.singular import largest_right_vectors
from torsion.kernels.distributed.static_bends import Bends, static_bends
from torsion.kernels.natural_modes import ShaftModes, TreeModes, rigid_shapes, shape_sign
from torsion.kernels.reduction import rigidity
from torsion.kernels.tree import Tree

_LEAST = 1e-11  # of the largest singular value; one that is less is not right to 1e-4


def dense_modes(tree: Tree, count: int) -> TreeModes:
    """The lowest `count` elastic modes, or all there are, of a tree whose shafts are finite elements of one degree.

    `lower` and `upper` are the frequencies themselves and `certified` is False. Raises ValueError for other shafts.
    """
    shafts = _of(tree)
    element = _element(shafts)
    coordinates, local = static_bends(tree, shafts, element), _local_inertia(element)
    mass = _rows_of_inertia(tree, shafts, coordinates, _root(local))
    y = largest_right_vectors(mass, _number(tree, element, count))
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
    parts = np.concatenate((angle[_ends(tree, shafts)], y[coordinates.inside]), axis=1)  # (shafts, 2 + modes, m)
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
        frequency, frequency.copy(), frequency.copy(), angle, torque, rigid.shape[1], rigid, certified=False,
        shafts=ShaftModes(outer, kinetic, elastic / square, of_shafts),
    )  # fmt: skip


def estimated_frequencies(tree: Tree, count: int) -> FloatArray:
    """The lowest `count` elastic frequencies rad/s, ascending, of shafts of any law with a finite limit.

    With one mode inside each shaft: too high by less than 0.08 (w/limit)^4 where shafts are alike (measured). Fewer
    where there are fewer, or where the others are too far from the first to be estimated.
    """
    shafts = _of(tree)
    element = one_mode_elements(shafts)
    mass = _rows_of_inertia(tree, shafts, static_bends(tree, shafts, element), _root(_local_inertia(element)))
    values = np.linalg.svd(mass, compute_uv=False)[: _number(tree, element, count)]
    return np.asarray(1.0 / values[values > _LEAST * values.max(initial=0.0)])


def _of(tree: Tree) -> Shafts:
    if tree.shafts is None:
        raise ValueError("the dense way is for a tree with distributed shafts")
    return tree.shafts


def _number(tree: Tree, element: CondensedElements, count: int) -> int:
    """As many of the modes asked for as there are."""
    return min(count, rigidity(tree.static).elastic + int(np.count_nonzero(element.modes)))


def _element(shafts: Shafts) -> CondensedElements:
    if len(shafts.laws) != 1 or not isinstance(shafts.laws[0], CondensedElements):
        raise ValueError("the dense way is for finite elements of one degree; expected one law of elements")
    return shafts.laws[0]


def _local_inertia(element: CondensedElements) -> FloatArray:
    """Inertia (shafts, 2 + modes, 2 + modes) kg m2 of the ends and the modes inside."""
    number, modes = element.modes.shape
    local = np.zeros((number, 2 + modes, 2 + modes))
    local[:, 0, 0], local[:, 1, 1] = element.inner - element.across, element.outer - element.across
    local[:, 0, 1] = local[:, 1, 0] = element.across
    local[:, 0, 2:] = local[:, 2:, 0] = element.coupling_inner
    local[:, 1, 2:] = local[:, 2:, 1] = element.coupling_outer
    inside = np.arange(2, 2 + modes)
    local[:, inside, inside] = element.modes
    return local


def _root(local: FloatArray) -> FloatArray:
    """R of each inertia (shafts, unknowns, unknowns) R'R."""
    try:
        return np.asarray(np.linalg.cholesky(local).transpose(0, 2, 1))
    except np.linalg.LinAlgError:  # an element without inertia
        values, vectors = np.linalg.eigh(local)
        return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.transpose(0, 2, 1))


def _rows_of_inertia(tree: Tree, shafts: Shafts, coordinates: Bends, root: FloatArray) -> FloatArray:
    """C (rows, coordinates), with as many rows for an element as it has unknowns."""
    number, unknowns, _ = root.shape
    rows = root[:, :, :2] @ coordinates.angle[_ends(tree, shafts)]
    row = np.arange(unknowns)[None, :, None]
    rows[np.arange(number)[:, None, None], row, coordinates.inside[:, None, :]] += root[:, :, 2:]
    inertia = tree.moving_inertia
    stations = np.flatnonzero(inertia > 0.0)
    own = np.sqrt(inertia[stations])[:, None] * coordinates.angle[stations]
    return np.concatenate((rows.reshape(number * unknowns, -1), own))


def _ends(tree: Tree, shafts: Shafts) -> IntArray:
    """(shafts, 2) stations at the inner and the outer end of each."""
    return np.column_stack([tree.shaft_parent, shafts.node])


def _fill_rigid(tree: Tree, angle: FloatArray, torque: FloatArray, outer: FloatArray, square: FloatArray) -> None:
    """Torques of rigid spans, by the equilibrium of all that lies outward of them; in place."""
    for i in range(tree.size - 1, -1, -1):
        if tree.parents[i] >= 0 and tree.shaft_of[i] < 0 and tree.flexibility[i] == 0.0:
            needed = -square * tree.moving_inertia[i] * angle[i]
            for child in tree.children[i]:
                needed = needed + torque[child]
            torque[i] = outer[i] = needed
