"""Modes of finite elements beyond the lowest frequency of an element by itself, by a dense decomposition.

For few, coarse elements of high degree of which many modes are asked. With K = B'B and M = C'C in factors, the upper
triangle R of the stacked B and sqrt(s0) C makes C R^-1 a matrix whose singular values c give s = 1/c^2 - s0; Rayleigh's
quotient of the energies, span by span, corrects them. Massless stations need no care. Nothing is proven.
"""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.bars.element import ElementBars
from torsion.kernels.bars.modes import BarModes
from torsion.kernels.bars.spans import Bars
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.modes import rigid_shapes, shape_sign
from torsion.kernels.reduction import Rigidity, rigidity
from torsion.kernels.tree import FloatArray, IntArray, Tree


@dataclass(frozen=True)
class _Unknowns:
    """Angles of the moving rigid bodies, then the modes inside the elements."""

    of_station: IntArray  # (stations,) unknown of each station; that of fixed ones is one more than the last, and 0
    inside: IntArray  # (bars, modes)
    number: int


def element_modes_dense(tree: Tree, bars: Bars, count: int) -> BarModes:
    """The lowest `count` elastic modes, or all there are, of a tree whose bars are all finite elements of one degree.

    `lower` and `upper` are the frequencies themselves and `certified` is False. Raises ValueError for other bars.
    """
    train = BarTree(tree, bars)
    element = _element(bars)
    known = rigidity(train.static)
    unknowns = _unknowns(train, known, element)
    local = _local_inertia(element)
    bend, mass = _rows_of_bend(train, unknowns, element), _rows_of_inertia(train, unknowns, local)
    rigid = len(known.free_roots)
    x = _vectors(bend, mass, _low_square(train.static), rigid + count)[:, rigid:]
    twice, weight = np.sum((bend @ x) ** 2, axis=0), np.sum((mass @ x) ** 2, axis=0)
    square = twice / np.where(weight > 0.0, weight, np.nan)
    order = np.argsort(square, kind="stable")[: min(count, int(np.isfinite(square).sum()))]
    x, square = x[:, order] / np.sqrt(weight[order]), square[order]
    x = np.concatenate((x, np.zeros((1, len(square)))))
    x = x * shape_sign(x[unknowns.of_station])
    return _told(train, known, unknowns, element, local, x, square)


def _element(bars: Bars) -> ElementBars:
    if len(bars.laws) != 1 or not isinstance(bars.laws[0], ElementBars):
        raise ValueError("the dense way is for finite elements of one degree; expected one law of elements")
    return bars.laws[0]


def _low_square(tree: Tree) -> float:
    """Square of a frequency (rad2/s2) below most of the train's: whole flexibility and whole inertia in one."""
    moving = tree.parent >= 0
    return float(1.0 / (tree.moving_inertia.sum() * tree.flexibility[moving].sum()))


def _unknowns(train: BarTree, known: Rigidity, element: ElementBars) -> _Unknowns:
    free = np.unique(known.body[~known.fixed])
    of_station = np.searchsorted(free, known.body)
    number = len(free) + element.modes.size
    of_station[known.fixed] = number
    inside = len(free) + np.arange(element.modes.size).reshape(element.modes.shape)
    return _Unknowns(of_station, inside, number)


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


def _rows_of_bend(train: BarTree, unknowns: _Unknowns, element: ElementBars) -> FloatArray:
    """B (springs, unknowns): the square root of a stiffness times the twist; an inside mode has stiffness 1."""
    tree = train.tree
    plain = train.plain[(tree.parent[train.plain] >= 0) & (tree.flexibility[train.plain] > 0.0)]
    outer = np.concatenate((plain, train.bars.node))
    root = np.sqrt(np.concatenate((1.0 / tree.flexibility[plain], element.stiffness)))
    rows, modes = np.arange(len(outer)), unknowns.inside.reshape(-1)
    bend = np.zeros((len(outer) + len(modes), unknowns.number + 1))
    bend[rows, unknowns.of_station[tree.parent[outer]]] += root
    bend[rows, unknowns.of_station[outer]] -= root
    bend[len(outer) + np.arange(len(modes)), modes] = 1.0
    return bend[:, :-1]


def _rows_of_inertia(train: BarTree, unknowns: _Unknowns, local: FloatArray) -> FloatArray:
    """C (rows, unknowns), with as many rows for an element as it has unknowns."""
    values, vectors = np.linalg.eigh(local)
    root = np.sqrt(np.maximum(values, 0.0))[:, :, None] * vectors.transpose(0, 2, 1)
    places = np.column_stack([_ends(train, unknowns), unknowns.inside])
    stations = np.flatnonzero(train.tree.moving_inertia > 0.0)
    mass = np.zeros((local.shape[0] * local.shape[1] + len(stations), unknowns.number + 1))
    rows = np.arange(local.shape[0] * local.shape[1]).reshape(local.shape[:2])
    np.add.at(mass, (rows[:, :, None], places[:, None, :]), root)
    mass[rows.size + np.arange(len(stations)), unknowns.of_station[stations]] = np.sqrt(train.tree.inertia[stations])
    return mass[:, :-1]


def _ends(train: BarTree, unknowns: _Unknowns) -> IntArray:
    return unknowns.of_station[np.column_stack([train.parent, train.bars.node])]


def _vectors(bend: FloatArray, mass: FloatArray, low_square: float, wanted: int) -> FloatArray:
    """Shapes (unknowns, wanted) in ascending order of frequency, the rigid motions first."""
    stacked = np.concatenate((bend, np.sqrt(low_square) * mass))
    scale = 1.0 / np.linalg.norm(stacked, axis=0)
    triangle = np.asarray(np.linalg.qr(stacked * scale, mode="r"))
    flat = np.linalg.solve(triangle.T, (mass * scale).T).T
    vectors = np.linalg.svd(flat, full_matrices=False)[2][:wanted]
    return np.asarray(scale[:, None] * np.linalg.solve(triangle, vectors.T))


def _told(
    train: BarTree,
    known: Rigidity,
    unknowns: _Unknowns,
    element: ElementBars,
    local: FloatArray,
    x: FloatArray,
    square: FloatArray,
) -> BarModes:
    """Torques and energies of the shapes `x` (unknowns + 1, m) of generalised inertia 1."""
    tree, node = train.tree, train.bars.node
    angle = x[unknowns.of_station]
    parts = np.concatenate((x[_ends(train, unknowns)], x[unknowns.inside]), axis=1)  # (bars, 2 + modes, m)
    carried = np.einsum("bij,bjm->bim", local, parts)
    of_bars = np.einsum("bim,bim->bm", parts, carried)
    twist = angle[tree.parent] - angle
    twist[tree.roots] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        torque = np.where(tree.flexibility[:, None] > 0.0, twist / tree.flexibility[:, None], 0.0)
    torque[tree.roots] = 0.0
    outer = torque.copy()
    bend = element.stiffness[:, None] * twist[node]
    torque[node], outer[node] = bend - square * carried[:, 0], bend + square * carried[:, 1]
    _fill_rigid(train, angle, torque, outer, square)
    kinetic = tree.moving_inertia[:, None] * angle**2
    train.add_ends(kinetic, 0.5 * of_bars, 0.5 * of_bars)
    elastic = torque * twist
    elastic[node] = bend * twist[node] + np.sum(parts[:, 2:] ** 2, axis=1)
    frequency, rigid = np.sqrt(square), rigid_shapes(train.static, known)
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
