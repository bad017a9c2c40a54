"""Nodes of mode shapes: the spans over which the angle changes its sign.

A station that stands still takes the sign of its neighbour toward the root: a node at a station counts once. A grounded
station has no sign: the shape starts there and does not cross it.

Of a chain the modes have 1, 2, 3, ... nodes, one less where an end is fixed (Sturm): nothing is to be counted, and no
angle of a localised mode that is too small for its sign spoils the number. Elsewhere an angle may be tiny and yet true:
beside a light disc on a soft coupling a heavy one moves by the ratio of their inertias. A tiny angle is rounding only
where the torques on its station cancel to rounding, where equilibrium does not give it, or where nothing but such
stations drives it.
"""

import math
from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.modes.mode_shapes import TreeModes
from torsion.kernels.modes.natural_modes import SHARE_OF_LIMIT, count_below, tree_modes
from torsion.kernels.trees.tree import Tree, connected, rigidity

LARGEST_BLOCK = 2**20  # stations times modes at once; 8 MB an array
TINY = 1e-12  # of the largest amplitude (referred to one speed): an angle that may be rounding
CANCELS = 1e-10  # of the torques on a station: a sum that is rounding of the angles around it
UNBALANCED = (
    0.5  # of the torques on a station: a sum that shows the sign of its angle to be unknown
)


def nodes(
    system: System, tree: Tree, chords: IntArray, shape: FloatArray, square: FloatArray
) -> IntArray:
    """Return the sign changes (modes,) of the shape (stations, modes), rad at own speed, over the spans of the tree.

    tree: the undamped one with its distributed shafts; chords: spans that close loops; square: (modes,) rad2/s2.
    """
    station = np.arange(tree.size)
    rigid = (tree.parent >= 0) & (tree.flexibility == 0.0)
    if tree.shafts is not None:
        rigid[tree.shafts.node] = False
    body = _followed(
        np.where(rigid, tree.parent, station)
    )  # the first of the stations that are joined rigidly
    spans = np.flatnonzero((tree.parent >= 0) & ~rigid)
    held = tree.held[body]
    is_chain = tree.parents == list(range(-1, tree.size - 1))
    if is_chain and tree.shafts is None and not chords.size:
        fixed = held[np.unique(body)]
        if not fixed[1:-1].any():
            return np.arange(len(square)) + (0 if fixed.any() else 1)
    above = station.copy()
    above[spans] = body[tree.parent[spans]]
    node = body[system.condensed.node]
    of_chords = (system.span_ratio[chords] ** 2 / system.flexibility[chords])[:, None]
    outer = np.append(spans, node[system.driving[chords]])
    inner = np.append(above[spans], node[system.driven[chords]])
    counts = np.zeros(len(square), dtype=np.int64)
    length = max(1, LARGEST_BLOCK // max(tree.size, 1))
    for part in (slice(first, first + length) for first in range(0, len(square), length)):
        angle = np.zeros((tree.size, len(square[part])))
        angle[system.condensed.node] = shape[:, part] / system.speed_ratio[:, None]
        angle[held] = 0.0
        sign = np.sign(angle).astype(np.int8)
        moves = np.abs(angle) > TINY * np.abs(angle).max(axis=0, initial=0.0)
        if not moves[~held].all():
            flexibility, inertia = tree.at(square[part])
            stiffness = np.vstack(
                [
                    1.0 / flexibility[spans],
                    np.broadcast_to(of_chords, (len(chords), angle.shape[1])),
                ]
            )
            kinetic = np.zeros_like(angle)
            np.add.at(kinetic, body, np.where(tree.held[:, None], 0.0, inertia * square[part]))
            still = _still(
                (outer, inner), stiffness, kinetic, angle, (moves, ~moves & ~held[:, None])
            )
            sign[still & (above == station)[:, None]] = 1
            index = np.arange(sign.size).reshape(sign.shape)
            sign = sign.ravel()[_followed(np.where(still, index[above], index).ravel())].reshape(
                sign.shape
            )
        counts[part] = np.count_nonzero(sign[spans] * sign[above[spans]] < 0, axis=0)
    return counts


def _followed(way: IntArray) -> IntArray:
    """Return (places,) where the way from each place ends: `way` names the next one, itself at an end."""
    while not np.array_equal(beyond := way[way], way):
        way = beyond
    return way


def _still(
    ends: tuple[IntArray, IntArray],
    stiffness: FloatArray,
    kinetic: FloatArray,
    angle: FloatArray,
    judged: tuple[BoolArray, BoolArray],
) -> BoolArray:
    """Return (stations, modes) which of the tiny angles are rounding alone.

    ends: (spans,) stations; stiffness: (spans, modes); kinetic: (stations, modes) w^2 J; judged: angles that are larger
    than tiny, and the tiny ones.
    """
    moves, tiny = judged
    torque, elastic, torques, stiffest = np.zeros(
        (4, *angle.shape)
    )  # sums over the spans of a station, and of magnitudes
    for station, other_station in (ends, ends[::-1]):
        np.add.at(torque, station, stiffness * angle[other_station])
        np.add.at(elastic, station, stiffness)
        np.add.at(torques, station, np.abs(stiffness * angle[other_station]))
        np.add.at(stiffest, station, np.abs(stiffness))
    size = np.abs(angle)
    cancels = size * np.maximum(stiffest, np.abs(kinetic)) <= CANCELS * torques
    lacks = np.abs(torque - (elastic - kinetic) * angle)
    doubtful = (
        tiny & ~cancels & ~(lacks > UNBALANCED * (torques + (stiffest + np.abs(kinetic)) * size))
    )
    index = np.arange(angle.size).reshape(angle.shape)
    both = doubtful[ends[0]] & doubtful[ends[1]]
    group = connected(angle.size, index[ends[0]][both], index[ends[1]][both])
    driven = np.zeros(angle.size, dtype=bool)
    for station, other_station in (ends, ends[::-1]):
        driven[group[index[station][doubtful[station] & moves[other_station]]]] = True
    return np.asarray(tiny & ~(doubtful & driven[group].reshape(angle.shape)))


def rigid_shapes(system: System) -> FloatArray:
    """Return the rigid motions (stations, motions) rad at own speed, generalised inertia 1.

    That of the whole train comes first, where nothing holds it; then those of parts that turn against each other.
    Raises SolveError for such a part without inertia.
    """
    ratio = system.speed_ratio
    finite = np.isfinite(system.flexibility)
    part = connected(len(ratio), system.driving[finite], system.driven[finite])
    loose = np.setdiff1d(part, part[system.held])
    shapes = np.where(part[:, None] == loose, ratio[:, None], 0.0)
    if not system.held.any():
        shapes[:, 0] = ratio
    if not loose.size:
        return shapes
    upper = np.linalg.qr(np.sqrt(np.where(system.held, 0.0, system.inertia))[:, None] * shapes).R
    if not np.diag(upper).all():
        raise SolveError("a part of the train turns freely and has no inertia", "give it one")
    return np.linalg.solve((upper * np.sign(np.diag(upper))[:, None]).T, shapes.T).T


def massless(system: System) -> BoolArray:
    """Return (stations,) where nothing that is rigidly joined to the station has an inertia."""
    rigid = system.flexibility == 0.0
    group = connected(len(system.stations), system.driving[rigid], system.driven[rigid])
    total = np.zeros(len(group))
    np.add.at(total, group, system.inertia)
    return np.asarray(total[group] == 0.0)


def beside_modes(system: System) -> tuple[BoolArray, BoolArray]:
    """Return stations and spans whose angle, and torque, under torques on the train is not a sum over the modes alone."""
    without = massless(system)
    return without, (system.flexibility == 0.0) | without[system.driving] | without[system.driven]


# Unknowns of finite elements that are solved at once where counts cannot reach.
LARGEST_DENSE = 2000
ABOVE = 1.0 + 1e-9  # a mode at the highest frequency itself is one of those up to it


@dataclass(frozen=True)
class Reach:
    """The elastic modes up to a frequency."""

    count: int
    frequency: float  # rad/s


def reach(tree: Tree, highest: float = math.inf) -> Reach:
    """Return the elastic modes of the undamped `tree` up to `highest` (rad/s), as far as its distributed shafts resolve them.

    Linear elements have no unknowns inside, and resolve all the modes that they have.
    """
    motions = rigidity(tree.static)
    # The angular frequency from which counts would need a correction.
    limit = math.inf if tree.shafts is None else tree.shafts.limit
    top = min(highest * ABOVE, SHARE_OF_LIMIT * limit)
    if not math.isfinite(top):
        return Reach(motions.elastic, math.inf)
    return Reach(int(count_below(tree, np.array([top]))[0]) - len(motions.free_roots), top)


def referred_modes(tree: Tree, count: int | None) -> TreeModes:
    """Return the lowest `count` elastic modes on the undamped tree; None: all that the distributed shafts resolve.

    Where finite elements are too few for the counts the modes are those of the dense problem, without certificate.
    Raises SolveError where the pieces of a continuum are too long.
    """
    resolved = reach(tree)
    if count is not None and count > resolved.count and math.isfinite(resolved.frequency):
        from torsion.kernels.distributed.finite_elements import CondensedElements, dense_modes

        # Angles and unknowns inside of finite elements; infinite for a continuum.
        laws = () if tree.shafts is None else tree.shafts.laws
        inner = (law.modes.size if isinstance(law, CondensedElements) else math.inf for law in laws)
        if tree.size + sum(inner) <= LARGEST_DENSE:
            return dense_modes(tree, count)
    return tree_modes(tree, resolved.count if count is None else count)
