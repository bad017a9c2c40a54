"""Natural frequencies and mode shapes of a train with closed loops (power splits): a tree and chords."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.factors import conductance, star_mesh_factor
from torsion.kernels.lapack import jacobi_svd
from torsion.kernels.loops.chords import LoopedTrain, around, pairs, stiffest_tree
from torsion.kernels.mode_shapes import Shapes, TreeModes, shape_sign
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.reduction import Rigidity, cut, reduce_tree, rigid_shapes, rigidity, with_reactions
from torsion.kernels.repeated import orthogonalise, orthonormal, repeated_groups
from torsion.kernels.tree import Tree
from torsion.kernels.two_sides import forced, two_sides

Response = Callable[[FloatArray], tuple[FloatArray, FloatArray]]

_ROUNDING = 2.0**-52
_ROUNDING_PER_BODY = 4.0  # half width of the enclosure in rounding units a body; measured errors are below 4 in all
_SHIFTS = 0.3 ** np.arange(1.0, 25.0)  # relative distances at which a response may be taken; far ones round the least
_STEPS = 3  # of inverse iteration; the Jacobi shapes it starts from are right to rounding already


def graph_modes(
    tree: Tree, first: IntArray, second: IntArray, flexibility: FloatArray, count: int | None = None
) -> TreeModes:
    """The lowest `count` elastic modes, or all, of `tree` with chords from `first` to `second` (chords,).

    `flexibility` (chords,) rad/(N m), positive. `loop_torque` is on the second station: (angle[first] - angle[second])
    / flexibility. No count proves these frequencies: `lower`, `upper` hold the error bound of the method, 4 rounding
    units a body (Jacobi's rotations of a star-mesh factor), and `certified` is False unless there is no loop but
    through fixed stations.
    """
    if len(first) == 0:
        return tree_modes(tree, count)
    if not np.all(flexibility > 0.0):
        raise ValueError("a chord needs a positive flexibility; put rigid spans into the tree")
    train = stiffest_tree(tree, first, second, flexibility)
    if not len(train.first):  # the loops go only through fixed stations
        return _given(tree, train, tree_modes(train.tree, count))
    known = rigidity(train.tree)
    solved = cut(train.tree, known)
    wanted = known.elastic if count is None else min(count, known.elastic)
    if wanted == 0:
        return replace(tree_modes(tree, 0), loop_torque=np.empty((len(first), 0)))
    frequency, start = _jacobi_modes(train, known)
    angle, torque = _shapes(solved, train, frequency, start)
    sign = shape_sign(angle)
    angle, torque = (angle * sign)[:, :wanted], (torque * sign)[:, :wanted]
    torque = _with_all_reactions(train, solved, known, torque)
    frequency = frequency[:wanted]
    margin = frequency * (_ROUNDING_PER_BODY * _ROUNDING * max(known.elastic, 1))
    return _given(tree, train, TreeModes(
        frequency=frequency,
        lower=frequency - margin,
        upper=frequency + margin,
        angle=angle,
        torque=torque,
        rigid=len(known.free_roots),
        rigid_angle=rigid_shapes(train.tree, known),
        certified=False,
    ))  # fmt: skip


def _given(tree: Tree, train: LoopedTrain, found: TreeModes) -> TreeModes:
    """The modes of the spanning tree at the stations and spans of `tree` and at the chords."""
    given = train.sign[:, None] * found.torque[train.source]
    return replace(
        found, angle=found.angle[train.station], rigid_angle=found.rigid_angle[train.station],
        torque=given[: tree.size], loop_torque=given[tree.size :],
    )  # fmt: skip


def _jacobi_modes(train: LoopedTrain, known: Rigidity) -> tuple[FloatArray, FloatArray]:
    """All elastic frequencies, ascending, and the angles (stations, modes) of the stations with inertia."""
    reduced = reduce_tree(train.tree, known, (train.first, train.second, train.flexibility))
    factor = star_mesh_factor(reduced.inertia, conductance(reduced), reduced.ground)[:, : known.elastic]
    left, values, _ = jacobi_svd(factor, "U")
    angle = np.zeros((train.tree.size, len(values)))
    angle[reduced.head] = left[:, ::-1] / np.sqrt(reduced.inertia)[:, None]
    return values[::-1], angle[known.body]


def _shapes(tree: Tree, train: LoopedTrain, frequency: FloatArray, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m), torques (stations + chords, m), mass-normalised, by inverse iteration from `start`."""
    inertia = tree.moving_inertia[:, None]
    root = np.sqrt(inertia)
    groups = repeated_groups(frequency, np.ones(len(frequency), dtype=bool))
    respond = _torn_response(tree, train, _beside(frequency))
    angle, torque = start, np.empty(0)
    for _ in range(_STEPS):
        angle, torque = respond(inertia * angle)
        for group in groups:
            matrix = orthonormal(root * angle[:, group])
            angle[:, group], torque[:, group] = angle[:, group] @ matrix, torque[:, group] @ matrix
    orthogonalise(tree, frequency, Shapes.of_springs(angle, torque))
    return angle, torque


def _beside(frequency: FloatArray) -> FloatArray:
    """For each of `frequency` (m,) one as far from it as can be, but no nearer to another one by more than half."""
    candidates = frequency * np.concatenate([1.0 - _SHIFTS, 1.0 + _SHIFTS])[:, None]
    own = np.abs(candidates - frequency)
    nearest = np.min(np.abs(candidates[:, :, None] - frequency), axis=2)
    allowed = np.where(nearest >= 0.5 * own, own, -1.0)
    beside: FloatArray = candidates[np.argmax(allowed, axis=0), np.arange(len(frequency))]
    return beside


def _torn_response(tree: Tree, train: LoopedTrain, w: FloatArray) -> Response:
    """Response at `w` (m,) of the train with loops: that of the tree, and of torque pairs where the loops are torn.

    The twist of a torn span is the sum of those along its path in the tree, never a difference of angles.
    """
    sides, ends = two_sides(tree, w), (train.first, train.second)
    acting = np.where(tree.held, 0.0, pairs(tree.size, *ends))
    units = [forced(tree, sides, np.repeat(row[:, None], len(w), axis=1)) for row in acting]
    twist = around(tree, *ends) * tree.flexibility
    system = np.stack([-(twist @ torque).T for _, torque in units], axis=2) + np.diag(train.flexibility)

    def respond(load: FloatArray) -> tuple[FloatArray, FloatArray]:
        angle, torque = forced(tree, sides, load)
        torn = np.linalg.solve(system, (twist @ torque).T[:, :, None])[:, :, 0].T
        for row, unit in zip(torn, units, strict=True):
            angle, torque = angle + row * unit[0], torque + row * unit[1]
        return angle, np.vstack([torque, torn])

    return respond


def _with_all_reactions(train: LoopedTrain, solved: Tree, known: Rigidity, torque: FloatArray) -> FloatArray:
    """Torques (stations + chords, m) with those of rigid spans between fixed stations."""
    if solved is train.tree:
        return torque
    size = train.tree.size
    load = pairs(size, train.first, train.second).T @ torque[size:]
    return np.vstack([with_reactions(train.tree, known, torque[:size], load), torque[size:]])
