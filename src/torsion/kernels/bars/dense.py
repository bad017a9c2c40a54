"""Modes of finite elements beyond the lowest frequency of an element by itself, by a dense decomposition.

For few, coarse elements of high degree of which many modes are asked. In coordinates whose sum of squares is the
elastic energy (`bends`), with the inertia in a factor C, the singular values c of C give s = 1/c^2; Rayleigh's quotient
of the energies, span by span, corrects them. Massless stations need no care. Nothing is proven.
"""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.bars.bends import Bends, bends
from torsion.kernels.bars.element import ElementBars
from torsion.kernels.bars.modes import BarModes
from torsion.kernels.bars.singular import largest_right_vectors
from torsion.kernels.bars.spans import Bars, one_mode_bars
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.modes import rigid_shapes, shape_sign
from torsion.kernels.tree import FloatArray, Tree

_LEAST = 1e-11  # of the largest singular value; one that is less is not right to 1e-4


@dataclass(frozen=True)
class _Shapes:
    """Shapes of generalised inertia 1."""

    square: FloatArray  # (m,) rad2/s2
    angle: FloatArray  # (stations, m) rad
    twist: FloatArray  # (stations, m) rad, angle at the inner end of a span less that at the outer one
    torque: FloatArray  # (stations, m) N m, in the flexibility of a span; 0 of rigid ones
    parts: FloatArray  # (bars, 2 + modes, m) unknowns of the elements: both ends, then the modes inside


def element_modes_dense(tree: Tree, bars: Bars, count: int) -> BarModes:
    """The lowest `count` elastic modes, or all there are, of a tree whose bars are all finite elements of one degree.

    `lower` and `upper` are the frequencies themselves and `certified` is False. Raises ValueError for other bars.
    """
    return dense_modes(BarTree(tree, bars), count)


def dense_modes(train: BarTree, count: int) -> BarModes:
    """`element_modes_dense` of a tree with its bars."""
    element = _element(train.bars)
    coordinates, local = bends(train, element), _local_inertia(element)
    mass = _rows_of_inertia(train, coordinates, _root(local))
    y = largest_right_vectors(mass, _number(train, element, count))
    weight = np.sum((mass @ y) ** 2, axis=0)
    square = np.sum(y * y, axis=0) / weight
    order = np.argsort(square, kind="stable")
    y, square = y[:, order] / np.sqrt(weight[order]), square[order]
    return _told(train, element, local, _shapes(train, coordinates, y, square))


def estimated_frequencies(train: BarTree, count: int) -> FloatArray:
    """The lowest `count` elastic frequencies rad/s, ascending, of bars of any law with a finite limit.

    With one mode inside each bar: too high by less than 0.08 (w/limit)^4 where bars are alike (measured). Fewer where
    there are fewer, or where the others are too far from the first to be estimated.
    """
    element = one_mode_bars(train.bars)
    mass = _rows_of_inertia(train, bends(train, element), _root(_local_inertia(element)))
    values = np.linalg.svd(mass, compute_uv=False)[: _number(train, element, count)]
    return np.asarray(1.0 / values[values > _LEAST * values.max(initial=0.0)])


def _number(train: BarTree, element: ElementBars, count: int) -> int:
    """As many of the modes asked for as there are."""
    return min(count, train.known.elastic + int(np.count_nonzero(element.modes)))


def _element(bars: Bars) -> ElementBars:
    if len(bars.laws) != 1 or not isinstance(bars.laws[0], ElementBars):
        raise ValueError("the dense way is for finite elements of one degree; expected one law of elements")
    return bars.laws[0]


def _local_inertia(element: ElementBars) -> FloatArray:
    """Inertia (bars, 2 + modes, 2 + modes) kg m2 of the ends and the modes inside."""
    bars, modes = element.modes.shape
    local = np.zeros((bars, 2 + modes, 2 + modes))
    local[:, 0, 0], local[:, 1, 1] = element.inner - element.across, element.outer - element.across
    local[:, 0, 1] = local[:, 1, 0] = element.across
    local[:, 0, 2:] = local[:, 2:, 0] = element.coupling_inner
    local[:, 1, 2:] = local[:, 2:, 1] = element.coupling_outer
    inside = np.arange(2, 2 + modes)
    local[:, inside, inside] = element.modes
    return local


def _root(local: FloatArray) -> FloatArray:
    """R of each inertia (bars, unknowns, unknowns) R'R."""
    try:
        return np.asarray(np.linalg.cholesky(local).transpose(0, 2, 1))
    except np.linalg.LinAlgError:  # an element without inertia
        values, vectors = np.linalg.eigh(local)
        return np.asarray(np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.transpose(0, 2, 1))


def _rows_of_inertia(train: BarTree, coordinates: Bends, root: FloatArray) -> FloatArray:
    """C (rows, coordinates), with as many rows for an element as it has unknowns."""
    bars, unknowns, _ = root.shape
    rows = root[:, :, :2] @ coordinates.angle[_ends(train)]
    row = np.arange(unknowns)[None, :, None]
    rows[np.arange(bars)[:, None, None], row, coordinates.inside[:, None, :]] += root[:, :, 2:]
    inertia = train.tree.moving_inertia
    stations = np.flatnonzero(inertia > 0.0)
    own = np.sqrt(inertia[stations])[:, None] * coordinates.angle[stations]
    return np.concatenate((rows.reshape(bars * unknowns, -1), own))


def _ends(train: BarTree) -> np.ndarray:
    """(bars, 2) stations at the inner and the outer end of each."""
    return np.column_stack([train.parent, train.bars.node])


def _shapes(train: BarTree, coordinates: Bends, y: FloatArray, square: FloatArray) -> _Shapes:
    angle = coordinates.angle @ y
    y = y * (sign := shape_sign(angle))
    angle *= sign
    twist, torque = np.zeros_like(angle), np.zeros_like(angle)
    bend, root = coordinates.bend @ y, coordinates.root[:, None]
    twist[coordinates.spring], torque[coordinates.spring] = -root * bend, -bend / root
    return _Shapes(square, angle, twist, torque, np.concatenate((angle[_ends(train)], y[coordinates.inside]), axis=1))


def _told(train: BarTree, element: ElementBars, local: FloatArray, shapes: _Shapes) -> BarModes:
    """Torques at both ends of the spans and the energies."""
    node, square, angle, torque = train.bars.node, shapes.square, shapes.angle, shapes.torque
    carried = local @ shapes.parts
    of_bars = np.sum(shapes.parts * carried, axis=1)
    elastic, outer = torque * shapes.twist, torque.copy()
    elastic[node] += np.sum(shapes.parts[:, 2:] ** 2, axis=1)
    torque[node] -= square * carried[:, 0]
    outer[node] += square * carried[:, 1]
    _fill_rigid(train, angle, torque, outer, square)
    kinetic = train.tree.moving_inertia[:, None] * angle**2
    train.add_ends(kinetic, 0.5 * of_bars, 0.5 * of_bars)
    frequency, rigid = np.sqrt(square), rigid_shapes(train.static, train.known)
    return BarModes(
        frequency,
        frequency.copy(),
        frequency.copy(),
        angle,
        torque,
        outer,
        rigid.shape[1],
        rigid,
        kinetic,
        elastic / square,
        of_bars,
        certified=False,
    )


def _fill_rigid(train: BarTree, angle: FloatArray, torque: FloatArray, outer: FloatArray, square: FloatArray) -> None:
    """Torques of rigid spans, by the equilibrium of all that lies outward of them; in place."""
    tree = train.tree
    for i in range(tree.size - 1, -1, -1):
        if tree.parents[i] >= 0 and train.bar_of[i] < 0 and tree.flexibility[i] == 0.0:
            needed = -square * tree.moving_inertia[i] * angle[i]
            for child in tree.children[i]:
                needed = needed + torque[child]
            torque[i] = outer[i] = needed
