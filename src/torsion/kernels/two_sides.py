"""The dynamic stiffness of both sides of every span; shapes and responses that follow without a difference of angles.

One sweep from the leaves to the roots and one back give, at every span, the stiffness of the train toward the leaves
and of all the rest, both as sums of terms only: the share of siblings is summed from the left and from the right, never
taken from a total. Angles are then products along the train from one station, torques products of a stiffness and an
angle, so that each component keeps its own relative accuracy (the re-rooted, or twisted, factorisation of Parlett and
Dhillon 1997). A distributed shaft is seen through its outer end inertia, its flexibility and its inner one: there is no
torque at a free end, exactly.

The free shapes of springs have back ends with the same recurrence: a chain is swept from both ends at once, so that a
row costs little more than half, a large tree layer by layer: a third of the time for 100 stations (measured).
Infinite values are meant (a fixed station, a node): callers of `sides_of` and `spread` ignore them by `np.errstate`.
"""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.layers import add_children, of_the_rest, share, sweep_to_roots
from torsion.kernels.tree import Tree

Spread = tuple[FloatArray, FloatArray, FloatArray, BoolArray | None]


@dataclass(frozen=True)
class TwoSides:
    """Dynamic stiffness at w (m,) rad/s, station by station; all (stations, m), N m/rad. At a root of the rest 0.

    Of a spring, what lies at its ends is the same with and without the ends of the span.
    """

    branch: FloatArray  # z: of the station and all beyond it, seen at the station
    passed: FloatArray  # the same with the outer end of the span to the parent, seen through the flexibility
    rest: FloatArray  # zd: of all the rest, seen at the parent
    returned: FloatArray  # the same with the inner end of the span, seen through the flexibility
    branch_end: FloatArray  # `branch` with the outer end of the span
    branch_passed: (
        FloatArray  # zz: `passed` with the inner end, all that the span shows at the parent
    )
    rest_end: FloatArray  # `rest` with the inner end of the span
    rest_passed: (
        FloatArray  # y: `returned` with the outer end, all that the span shows at the station
    )

    @cached_property
    def total(self) -> FloatArray:
        """Dynamic stiffness of the whole train (stations, m), seen at each station; 0 at a natural frequency."""
        return self.branch + self.rest_passed

    @cached_property
    def to_leaves(self) -> FloatArray:
        """Angle of each station over that of its parent (stations, m), without sources beyond."""
        return _ratio(self.passed, self.branch_end)

    @cached_property
    def to_root(self) -> FloatArray:
        """Angle of each parent over that of the station (stations, m), without sources in the rest."""
        return _ratio(self.returned, self.rest_end)


@dataclass(frozen=True)
class Sides:
    """What shapes take of `TwoSides`, by another back end; what is passed on may have one row more."""

    total: FloatArray
    passed: FloatArray
    returned: FloatArray
    to_leaves: FloatArray
    to_root: FloatArray


def sides_of(tree: Tree, w: FloatArray) -> Sides | TwoSides:
    """Both sides of every span at angular frequencies `w` (m,), by the back end that suits the tree."""
    if tree.is_chain and tree.shafts is None:
        return _sides_of_chain(tree, tree.own_stiffness(w * w))
    if not tree.is_swept_by_stations and tree.shafts is None:
        return _sides_of_layers(tree, tree.own_stiffness(w * w))
    return two_sides(tree, w)


def two_sides(tree: Tree, w: FloatArray) -> TwoSides:
    """The two sweeps at angular frequencies `w` (m,), station by station."""
    square, h, near, far = (
        w * w,
        tree.flexibilities,
        dict[int, FloatArray](),
        dict[int, FloatArray](),
    )
    with np.errstate(all="ignore"):
        station_stiffness = tree.own_stiffness(square)
        stiffness, zd = np.zeros((3, *station_stiffness.shape)), [np.zeros(len(w))] * tree.size
        stiffness[0] = station_stiffness
        own_rows, z, zz, y = list(station_stiffness), *map(list, stiffness)
        z_end, zz_end, zd_end, y_end = z, zz, zd, y
        if tree.shafts is not None:
            flexibility, inner, outer = tree.shafts.at(square)
            node, h, ends = (
                tree.shafts.node.tolist(),
                h.copy(),
                np.zeros((4, *station_stiffness.shape)),
            )
            near, far = (dict(zip(node, part * square, strict=True)) for part in (inner, outer))
            z_end, zz_end, zd_end, y_end = map(list, ends)
            for station, row in zip(node, flexibility, strict=True):
                h[station] = row
        parents, add, subtract, reciprocal = tree.parents, np.add, np.subtract, np.reciprocal
        for i in range(tree.size - 1, -1, -1):
            parent = parents[i]
            z_end[i] = subtract(z[i], far[i], z_end[i]) if i in far else z[i]
            if parent >= 0:
                reciprocal(add(h[i], reciprocal(z_end[i], zz[i]), zz[i]), zz[i])
                zz_end[i] = subtract(zz[i], near[i], zz_end[i]) if i in near else zz[i]
                add(z[parent], zz_end[i], z[parent])
        for i, children in enumerate(tree.children):
            if children:
                share(children, zz_end, zd, own_rows[i] + y_end[i])
            for child in children:
                zd_end[child] = (
                    subtract(zd[child], near[child], zd_end[child]) if child in near else zd[child]
                )
                reciprocal(add(h[child], reciprocal(zd_end[child], y[child]), y[child]), y[child])
                y_end[child] = (
                    subtract(y[child], far[child], y_end[child]) if child in far else y[child]
                )
    seen = stiffness[0], stiffness[1], np.array(zd), stiffness[2]
    if tree.shafts is None:
        return TwoSides(*seen, *seen)
    for part, plain_part in zip(ends, seen, strict=True):
        part[tree.springs] = plain_part[tree.springs]
    return TwoSides(*seen, *ends)


def forced(tree: Tree, sides: TwoSides, torque: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Angles (stations, m) rad and torques (stations, m) N m under `torque` (stations, m) N m at each station.

    The torque is that in the flexibility of a span, as it acts on the side of the leaves. Each side is a stiffness and
    a source (Norton), and both meet at either end: with ff, zz and fd, zd at the root end (fd zz - ff zd)/(zz + zd).
    """
    f, (ff, g), rest_source = (
        torque.copy(),
        np.zeros((2, *torque.shape)),
        [np.zeros(torque.shape[1])] * tree.size,
    )
    torque_rows, source, passed, back, parents = (
        list(torque),
        list(f),
        list(ff),
        list(g),
        tree.parents,
    )
    with np.errstate(all="ignore"):
        to_leaves, to_root = list(sides.to_leaves), list(sides.to_root)
        for i in range(tree.size - 1, -1, -1):
            parent = parents[i]
            if parent >= 0:
                np.multiply(source[i], to_leaves[i], passed[i])
                np.add(source[parent], passed[i], source[parent])
        for i, children in enumerate(tree.children):
            if children:
                share(children, passed, rest_source, torque_rows[i] + back[i])
            for child in children:
                np.multiply(rest_source[child], to_root[child], back[child])
        fd, z, zz, zd, y = (
            np.array(rest_source),
            sides.branch_end,
            sides.passed,
            sides.rest_end,
            sides.returned,
        )
        at_parent, at_station = (fd * zz - ff * zd) / (zz + zd), (g * z - f * y) / (z + y)
        span, angle = (
            np.where(np.abs(zd) <= np.abs(z), at_parent, at_station),
            (f + g) / sides.total,
        )
    if tree.holds:
        angle[tree.held] = 0.0
        span[np.isinf(sides.branch) & np.isinf(sides.rest)] = 0.0  # between two fixed stations
    span[tree.roots] = 0.0
    return angle, span


def _ratio(through: FloatArray, stiffness: FloatArray) -> FloatArray:
    """Like `_transmission`, from a `stiffness` z instead of its inverse."""
    ratio: FloatArray = through / stiffness
    soft = stiffness == 0.0
    if soft.any():
        ratio[soft] = 1.0
    return ratio


def spread(tree: Tree, sides: Sides | TwoSides, start: IntArray) -> Spread:
    """Angles (stations, m) that are 1 at `start` (m,), span torques (stations, m), and the products of these with the
    angles at the parents, which may have one row more; where stations are swept, also which (stations, m) lie on the
    way from the start to the root.

    On that way the torque is that of the rest of the train, elsewhere that of the branch.
    """
    if isinstance(sides, TwoSides):
        return _spread_by_stations(tree, sides, start)
    return (
        _spread_along_chain(tree, sides, start)
        if tree.is_chain
        else _spread_by_layers(tree, sides, start)
    )


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
    return angle, torque, product, None


def _spread_by_stations(tree: Tree, sides: TwoSides, start: IntArray) -> Spread:
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
    return angle, torque, np.multiply(at_parent, torque, out=at_parent), is_toward_root


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
    return angle, torque[: tree.size], product, None
