"""Nodes of mode shapes: the spans over which the angle changes its sign.

A station that stands still takes the sign of its neighbour toward the root: a node at a station counts once. A grounded
station has no sign: the shape starts there and does not cross it.

Of a chain the modes have 1, 2, 3, ... nodes, one less where an end is fixed (Sturm): nothing is to be counted, and no
angle of a localised mode that is too small for its sign spoils the number. Elsewhere an angle may be tiny and yet true:
beside a light disc on a soft coupling a heavy one moves by the ratio of their inertias. A tiny angle is rounding only
where the torques on its station cancel to rounding, where equilibrium does not give it, or where nothing but such
stations drives it.
"""

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.kernels.tree import Tree, connected

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
    if tree.is_chain and tree.shafts is None and not chords.size:
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
