"""Natural modes of a train with closed loops (power splits): a tree, and chords that close it."""

from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.modes.mode_shapes import (
    Shapes,
    TreeModes,
    orthogonalise,
    orthonormal,
    repeated_groups,
    shape_sign,
)
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.elimination import eliminate_undamped, forced
from torsion.kernels.trees.tree import (
    Rigidity,
    Tree,
    closing_no_loop,
    cut,
    rigid_shapes,
    rigidity,
    walk,
    with_reactions,
)
from torsion.kernels.trees.tree_response import around, pairs
from torsion.sources import source

_DGEJSV_FULL_ACCURACY = 2  # joba='F': columns are scaled, rows may be badly scaled too


def star_mesh_factor(
    tree: Tree, bodies: Rigidity, chords: tuple[IntArray, IntArray, FloatArray] | None = None
) -> tuple[IntArray, FloatArray, FloatArray]:
    """First station and inertia (bodies,) kg m2 of what moves, and G (bodies, rank) of the springs; parallel ones add.

    chords: stations at both ends and the positive flexibility (loops,) rad/(N m) of spans that close loops. Adding
    inertias merges a rigid span. Cholesky's factorisation with the largest s/J as pivot, s being the row's sum, by the
    star-mesh rule k_ij += k_i k_j / s, by which massless bodies are eliminated before; it ends at s = 0, so that the
    rank is exact. All numbers are positive and none is subtracted: every frequency keeps its relative accuracy.
    """
    stations = np.arange(tree.size)
    head = np.flatnonzero((bodies.body == stations) & ~bodies.fixed)
    number = np.full(tree.size, len(head))
    number[head] = np.arange(len(head))
    number = number[bodies.body]  # of the moving body of each station; one more where it is fixed
    spans = tree.parent, stations, tree.flexibility
    near, far, flexibility = (
        spans if chords is None else (np.append(*pair) for pair in zip(spans, chords, strict=True))
    )
    is_spring = (near >= 0) & (flexibility > 0.0) & (number[near] != number[far])
    springs = np.zeros((len(head) + 1, len(head) + 1))
    ends = number[near[is_spring]], number[far[is_spring]]
    np.add.at(springs, ends, 1.0 / flexibility[is_spring])
    springs += springs.T
    mesh, tie = springs[:-1, :-1].copy(), springs[:-1, -1].copy()
    inertia: FloatArray = np.zeros(len(head) + 1)
    np.add.at(inertia, number, tree.moving_inertia)
    inertia = inertia[:-1]
    heavy = inertia > 0.0
    mass = np.where(heavy, inertia, 1.0)
    left, columns = np.ones(len(inertia), dtype=bool), []
    for _ in range(len(inertia)):
        total = mesh.sum(axis=1) + tie
        ease = np.where(heavy | (total == 0.0), total / mass, np.inf)
        pivot = int(np.argmax(np.where(left, ease, -1.0)))
        if not total[pivot] > 0.0:
            break
        share = mesh[pivot] / total[pivot]
        if heavy[pivot]:
            column = -share
            column[pivot] = 1.0
            columns.append(np.sqrt(total[pivot]) * column / np.sqrt(mass))
        mesh += np.outer(share, mesh[pivot])
        tie += share * tie[pivot]
        mesh[pivot], mesh[:, pivot], tie[pivot], left[pivot] = 0.0, 0.0, 0.0, False
        np.fill_diagonal(mesh, 0.0)
    factor = np.array(columns).reshape(-1, len(inertia))[:, heavy].T.copy(order="F")
    return head[heavy], inertia[heavy], factor


def jacobi_svd(matrix: FloatArray, vectors: str = "") -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return left singular vectors (rows, columns), singular values (columns,), descending, and right ones.

    `vectors` holds "U" and "V" where they are wanted. One-sided Jacobi rotations after a QR decomposition, dgejsv
    (Drmac and Veselic 2008): relative accuracy wherever the columns are well conditioned once scaled. Needs at least
    as many rows as columns; raises SolveError where the rotations do not converge.
    """
    from scipy.linalg import lapack

    jobs = {"jobu": 0 if "U" in vectors else 3, "jobv": 0 if "V" in vectors else 3}
    values, left, right, work, _, info = lapack.dgejsv(
        matrix, joba=_DGEJSV_FULL_ACCURACY, jobr=1, jobt=0, jobp=0, **jobs
    )
    if info != 0:
        raise SolveError(
            f"dgejsv did not converge (info {info}); check the train for spans of 0 or infinite stiffness"
        )
    return left[:, : matrix.shape[1]], values * (work[0] / work[1]), right


_ROUNDING = 2.0**-52
_ROUNDING_PER_BODY = (
    4.0  # half width of the enclosure in rounding units a body; measured errors are below 4 in all
)
_SHIFTS = 0.3 ** np.arange(
    1.0, 25.0
)  # relative distances at which a response may be taken; far ones round the least
_STEPS = 3  # of inverse iteration; the Jacobi shapes it starts from are right to rounding already


@dataclass(frozen=True)
class LoopedTrain:
    """A train with loops, renumbered as a tree; its spans are those of the given tree, then the given chords."""

    tree: Tree
    station: IntArray  # (stations,) where each station of the given tree is now
    span: IntArray  # (spans,) where each given span is now
    sign: FloatArray  # (spans, 1) -1 where a given span now runs the other way
    first: IntArray  # (chords,) new stations at both ends of each chord
    second: IntArray
    flexibility: FloatArray  # (chords,) rad/(N m)

    def given(self, modes: TreeModes) -> TreeModes:
        """Modes with torques in stations and chords, at the given stations, spans and chords."""
        torque, size = modes.torque[self.span] * self.sign, len(self.station)
        return replace(
            modes,
            angle=modes.angle[self.station],
            rigid_angle=modes.rigid_angle[self.station],
            torque=torque[:size],
            loop_torque=torque[size:],
        )


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
        return train.given(tree_modes(train.tree, count))
    bodies = rigidity(train.tree)
    solved = cut(train.tree, bodies)
    wanted = bodies.elastic if count is None else min(count, bodies.elastic)
    if wanted == 0:
        return replace(tree_modes(tree, 0), loop_torque=np.empty((len(first), 0)))

    # All frequencies and rough shapes by Jacobi's rotations; the shapes of repeated ones need all of them.
    chords = train.first, train.second, train.flexibility
    head, inertia, factor = star_mesh_factor(train.tree, bodies, chords)
    left, values, _ = jacobi_svd(factor[:, : bodies.elastic], "U")
    frequency, angle = values[::-1], np.zeros((train.tree.size, len(values)))
    angle[head] = left[:, ::-1] / np.sqrt(inertia)[:, None]
    angle, torque = _shapes(solved, train, frequency, angle[bodies.body])
    sign = shape_sign(angle)
    angle, torque = (angle * sign)[:, :wanted], (torque * sign)[:, :wanted]
    of_tree, of_chords = np.split(torque, [train.tree.size])
    load = pairs(train.tree.size, train.first, train.second).T @ of_chords
    torque = np.vstack([with_reactions(train.tree, bodies, of_tree, load), of_chords])
    frequency = frequency[:wanted]
    margin = frequency * (_ROUNDING_PER_BODY * _ROUNDING * bodies.elastic)
    return train.given(
        TreeModes(
            frequency=frequency,
            lower=frequency - margin,
            upper=frequency + margin,
            angle=angle,
            torque=torque,
            rigid=len(bodies.free_roots),
            rigid_angle=rigid_shapes(train.tree, bodies),
            certified=False,
        )
    )


def _shapes(
    tree: Tree, train: LoopedTrain, frequency: FloatArray, start: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m), torques (stations + chords, m), mass-normalised, by inverse iteration from `start`.

    The response is that of the tree, and of torque pairs where the loops are torn. The twist of a torn span is the sum
    of those along its path in the tree, never a difference of angles.
    """
    inertia = tree.moving_inertia[:, None]
    root = np.sqrt(inertia)
    groups = repeated_groups(frequency, np.ones(len(frequency), dtype=bool))

    # Beside each frequency, as far from it as can be, but no nearer to another one than half as far.
    candidates = frequency * np.concatenate([1.0 - _SHIFTS, 1.0 + _SHIFTS])[:, None]
    distance, above = np.abs(candidates - frequency), np.searchsorted(frequency, candidates)
    neighbours = np.maximum(above - 1, 0), np.minimum(above, len(frequency) - 1)
    nearest = np.min([np.abs(candidates - frequency[number]) for number in neighbours], axis=0)
    farthest = np.argmax(np.where(nearest >= 0.5 * distance, distance, -1.0), axis=0)
    sides = eliminate_undamped(tree, candidates[farthest, np.arange(len(frequency))])
    ends = train.first, train.second
    acting = np.where(tree.held, 0.0, pairs(tree.size, *ends))
    units = [forced(sides, row[:, None]) for row in acting]
    twist = around(tree, *ends) * tree.flexibility
    system = np.stack([-(twist @ torque).T for _, torque in units], axis=2)
    system += np.diag(train.flexibility)
    angle, torque = start, np.empty(0)
    for _ in range(_STEPS):
        angle, torque = forced(sides, inertia * angle)
        torn = np.linalg.solve(system, (twist @ torque).T[:, :, None])[:, :, 0].T
        for row, unit in zip(torn, units, strict=True):
            angle, torque = angle + row * unit[0], torque + row * unit[1]
        torque = np.vstack([torque, torn])
        for group in groups:
            matrix = orthonormal(root * angle[:, group])
            angle[:, group], torque[:, group] = angle[:, group] @ matrix, torque[:, group] @ matrix
    none = np.zeros((0, len(frequency)))
    shapes = Shapes(angle, torque, none, none, *np.zeros((2, len(frequency))))
    orthogonalise(tree, frequency, shapes)
    return angle, torque


@source("Kruskal1956")
def stiffest_tree(
    tree: Tree, first: IntArray, second: IntArray, flexibility: FloatArray
) -> LoopedTrain:
    """Tear every loop at its softest span (Kruskal 1956): what is torn is then a correction, not the main path.

    The root of a part is a fixed station wherever there is one, so that angles are sums of twists from the ground.
    Spans are those of `tree`, from parent to station, and (chords,) ones from `first` to `second`.
    """
    near, far = np.append(tree.parent, first), np.append(np.arange(tree.size), second)
    soft = np.append(tree.flexibility, flexibility)
    ranked = np.argsort(soft, kind="stable")
    chosen = closing_no_loop(tree.size, near, far, ranked[near[ranked] >= 0])
    way = walk(tree.size, near, far, chosen, np.flatnonzero(tree.held).tolist())
    order, station = way.order, np.argsort(way.order)
    span, above = way.above[order], way.parent[order]
    parent = np.where(above >= 0, station[above], -1)
    new = Tree(parent, np.where(span >= 0, soft[span], 0.0), tree.inertia[order], tree.held[order])
    torn = np.flatnonzero(~chosen & (near >= 0))
    source, sign = np.zeros(len(near), dtype=np.int64), np.zeros((len(near), 1))
    inside = np.flatnonzero(span >= 0)
    source[span[inside]] = inside
    sign[span[inside], 0] = np.where(station[far[span[inside]]] == inside, 1.0, -1.0)
    source[torn], sign[torn] = tree.size + np.arange(len(torn)), 1.0
    return LoopedTrain(
        new, station, source, sign, station[near[torn]], station[far[torn]], soft[torn]
    )
