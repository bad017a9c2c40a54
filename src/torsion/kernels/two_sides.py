"""The dynamic stiffness of both sides of every span, and shapes that follow without a difference of angles.

One sweep from the leaves to the roots and one back give, at every span, the stiffness of the train toward the leaves
and of all the rest, both as sums of terms only: the share of siblings is summed from the left and from the right, never
as the total minus its own. Three back ends do the same: station by station (`elimination`), layer by layer, and along a
chain from both ends at once (measured). Infinite values are meant (a fixed station, a node): callers of `sides_of` and
`spread` ignore them by `np.errstate`.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.kernels.elimination import eliminate_undamped
from torsion.kernels.layers import add_children, of_the_rest, sweep_to_roots
from torsion.kernels.tree import Tree

Spread = tuple[FloatArray, FloatArray, FloatArray]


@dataclass(frozen=True)
class Sides:
    """Dynamic stiffness at w (m,) rad/s, (stations, m) N m/rad; what is passed on may have one row more, of zeros.

    The ends of distributed shafts count as inertia of the stations.
    """

    total: FloatArray  # Z: of the whole train at each station; 0 at a natural frequency
    passed: FloatArray  # zz: of the station and all beyond it, seen by the parent through the span; 0 at a root
    returned: FloatArray  # y: of all the rest, seen by the station through the span; 0 at a root
    to_leaves: FloatArray  # angle of each station over that of its parent, without sources beyond
    to_root: (
        FloatArray  # angle of each parent over that of the station, without sources in the rest
    )


def sides_of(tree: Tree, w: FloatArray) -> Sides:
    """Return both sides of every span at angular frequencies `w` (m,), by the back end that suits the tree."""
    if tree.shafts is None and tree.is_chain:
        return _sides_of_chain(tree, tree.own_stiffness(w * w))
    if tree.shafts is None and not tree.is_swept_by_stations:
        return _sides_of_layers(tree, tree.own_stiffness(w * w))
    return _sides_by_stations(tree, w)


def spread(tree: Tree, sides: Sides, start: IntArray) -> Spread:
    """Return angles (stations, m) that are 1 at `start` (m,), span torques (stations, m) and their products.

    The products are those of the torques with the angles at the parents, and may have one row more. On the way from
    the start to the root the torque is that of the rest of the train, elsewhere that of the branch.
    """
    if tree.shafts is None and tree.is_chain:
        return _spread_along_chain(tree, sides, start)
    if tree.shafts is None and not tree.is_swept_by_stations:
        return _spread_by_layers(tree, sides, start)
    return _spread_by_stations(tree, sides, start)


def _sides_by_stations(tree: Tree, w: FloatArray) -> Sides:
    """Return `sides_of` a small tree, or one with distributed shafts."""
    plan, seen = eliminate_undamped(tree, w)
    divisor, passed, to_leaves = (
        np.array(rows) for rows in (seen.divisor, seen.through, seen.transfer)
    )
    to_root = 1.0 / divisor
    returned = np.array(seen.rest) * to_root
    passed[plan.roots] = to_leaves[plan.roots] = 0.0
    to_leaves[tree.held] = 0.0
    to_root[tree.held[tree.parent]] = 0.0  # a fixed parent does not turn
    return Sides(np.array(seen.branch) + returned, passed, returned, to_leaves, to_root)


def _spread_by_layers(tree: Tree, sides: Sides, start: IntArray) -> Spread:
    """Spread the angle at the start layer by layer, as `spread` returns it."""
    to_root, to_leaves, passed = sides.to_root, sides.to_leaves, sides.passed
    angle, torque, product = np.zeros_like(to_root), np.zeros_like(to_root), np.zeros_like(passed)
    angle[start, np.arange(len(start))] = 1.0
    multiply, add = np.multiply, np.add
    for layer in reversed(tree.layers or ()):
        stations = layer.stations
        multiply(angle[stations], to_root[stations], product[stations])
        add_children(layer, product, angle[layer.above])
    path, column = np.divmod(np.flatnonzero(angle != 0.0), angle.shape[1])
    to_leaves[path, column] = 0.0
    for layer in tree.layers or ():
        stations, before = layer.stations, angle[layer.above]
        if not layer.is_in_line:
            before = before.take(layer.parent, 0)
        layer_angle, moment, share = angle[stations], torque[stations], product[stations]
        add(layer_angle, multiply(before, to_leaves[stations], share), layer_angle)
        multiply(before, passed[stations], moment)
        multiply(before, moment, share)
    torque[path, column] = -sides.returned[path, column] * angle[path, column]
    product[path, column] = torque[path, column] * angle[tree.parent[path], column]
    return angle, torque, product


def _spread_by_stations(tree: Tree, sides: Sides, start: IntArray) -> Spread:
    """Spread the angle at the start station by station, as `spread` returns it."""
    angle, product = np.zeros(sides.to_leaves.shape), np.empty(len(start))
    angle[start, np.arange(len(start))] = 1.0
    rows, factor = list(angle), list(sides.to_root)
    multiply, add = np.multiply, np.add
    for i, parent in zip(range(tree.size - 1, -1, -1), reversed(tree.parents), strict=True):
        if parent >= 0:
            multiply(rows[i], factor[i], product)
            add(rows[parent], product, rows[parent])
    is_toward_root = angle != 0.0
    torque = np.where(is_toward_root, -sides.returned * angle, 0.0)
    factor = list(np.where(is_toward_root, 0.0, sides.to_leaves))
    for i, parent in enumerate(tree.parents):
        if parent >= 0:
            multiply(rows[parent], factor[i], product)
            add(rows[i], product, rows[i])
    at_parent = angle[tree.parent]
    np.copyto(torque, sides.passed * at_parent, where=~is_toward_root)
    torque[tree.roots] = 0.0
    return angle, torque, np.multiply(at_parent, torque, out=at_parent)


def _sides_of_layers(tree: Tree, station_stiffness: FloatArray) -> Sides:
    """Both sweeps, from the dynamic stiffness `own` (stations, m) of each station by itself."""
    size, columns = station_stiffness.shape
    total, to_leaves, to_root, rest_stiffness = (
        station_stiffness.copy(),
        *np.empty((3, size, columns)),
    )
    passed, returned = np.empty((size + 1, columns)), np.empty((size, columns))
    passed[:size] = tree.flexibility_columns
    returned[:] = passed[:size]
    passed[size] = 0.0
    roots = slice(0, tree.parents.count(-1))
    passed[roots] = returned[roots] = to_leaves[roots] = to_root[roots] = 0.0
    sweep_to_roots(tree.layers or (), total, passed, to_leaves)
    reciprocal, add = np.reciprocal, np.add
    _transmission(tree, passed[:size], to_leaves, total)
    for layer in tree.layers or ():
        stations, above = layer.stations, layer.above
        inverse, through, behind = to_root[stations], returned[stations], rest_stiffness[stations]
        if layer.is_in_line:
            add(station_stiffness[above], returned[above], behind)
        else:
            of_the_rest(layer, station_stiffness[above] + returned[above], passed, behind)
        reciprocal(behind, inverse)
        add(through, inverse, through)
        reciprocal(through, through)
    _transmission(tree, returned, to_root, rest_stiffness)
    return Sides(np.add(total, returned, out=total), passed, returned, to_leaves, to_root)


def _transmission(
    tree: Tree, through: FloatArray, inverse: FloatArray, stiffness: FloatArray
) -> None:
    """Make of `inverse`, 1/z, the angle of the far end of a span over that of the near one: 1/(1 + h z) = zz/z.

    Taken from the rounded zz, which is what the next station has seen: at a node both are large by the same rounding.
    A stiffness of 0 passes the whole angle on; where every station has inertia it is due to rounding, and the shape
    comes out not finite.
    """
    np.multiply(through, inverse, out=inverse)
    if not tree.is_plain:
        soft = stiffness == 0.0
        if soft.any():
            inverse[soft] = 1.0


def _sides_of_chain(tree: Tree, station_stiffness: FloatArray) -> Sides:
    """Like `_sides_of_layers`, from both ends at once: m columns from the last station to the first, m back."""
    size, columns = station_stiffness.shape
    behind, (inverse, through) = np.empty((size, 2 * columns)), np.empty((2, size - 1, 2 * columns))
    behind[:, :columns], behind[:, columns:] = station_stiffness[::-1], station_stiffness
    through[:, :columns], through[:, columns:] = (
        tree.flexibility_columns[:0:-1],
        tree.flexibility_columns[1:],
    )
    add, reciprocal, rows = np.add, np.reciprocal, list(behind)
    behind_row = rows[0]
    for turned, seen, ahead in zip(inverse, through, rows[1:], strict=True):
        reciprocal(behind_row, turned)
        add(seen, turned, seen)
        reciprocal(seen, seen)
        add(ahead, seen, ahead)
        behind_row = ahead
    total, (passed, returned, to_leaves, to_root) = (
        behind[::-1, :columns].copy(),
        np.zeros((4, size + 1, columns)),
    )
    passed[1:size], returned[1:size] = through[::-1, :columns], through[:, columns:]
    to_leaves[1:size], to_root[1:size] = inverse[::-1, :columns], inverse[:, columns:]
    _transmission(tree, passed[1:size], to_leaves[1:size], total[1:])
    _transmission(tree, returned[1:size], to_root[1:size], behind[:-1, columns:])
    total[1:] += returned[1:size]
    return Sides(total, passed, returned[:size], to_leaves[:size], to_root[:size])


def _spread_along_chain(tree: Tree, sides: Sides, start: IntArray) -> Spread:
    """Spread the angle at the start along a chain, both ways at once, as `spread` returns it."""
    columns, is_toward_root = len(start), np.arange(tree.size - 1)[:, None] < start
    factor = np.ones((tree.size - 1, 2 * columns))
    np.copyto(factor[:, :columns], sides.to_root[:0:-1], where=is_toward_root[::-1])
    np.copyto(factor[:, columns:], sides.to_leaves[1:], where=~is_toward_root)
    multiply, rows = np.multiply, list(factor)
    for near, far in pairwise(rows):
        multiply(near, far, far)
    angle = np.ones((tree.size, columns))
    angle[:-1] = factor[::-1, :columns]
    angle[1:] *= factor[:, columns:]
    torque, product = np.zeros((2, *sides.passed.shape))
    before, moment = angle[:-1], torque[1 : tree.size]
    multiply(before, sides.passed[1 : tree.size], moment)
    returned = multiply(sides.returned[1:], angle[1:])
    np.copyto(moment, np.negative(returned, returned), where=is_toward_root)
    multiply(before, moment, product[1 : tree.size])
    return angle, torque[: tree.size], product
