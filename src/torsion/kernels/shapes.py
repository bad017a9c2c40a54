"""Shapes of the modes next to given frequencies, by sweeps over the layers of a tree.

One sweep inward and one outward give the dynamic stiffness of both sides of every span as sums of terms only; one more
each way the angles, as products outward from one station, and the torques, as products of a stiffness and an angle.
No angle is subtracted from another, so that each component keeps its own relative accuracy (the re-rooted, or twisted,
factorisation of Parlett and Dhillon 1997).
"""

from dataclasses import dataclass

import numpy as np

from torsion.kernels.chain_passes import both_ways, spread
from torsion.kernels.layers import add_children, of_the_rest
from torsion.kernels.passes import stiffness_passes
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree


@dataclass(frozen=True)
class FreeShapes:
    """Shapes (stations, m), mass-normalised, of the modes next to given frequencies."""

    angle: FloatArray  # rad
    torque: FloatArray  # N m
    correction: FloatArray  # (m,) of w^2 by Rayleigh's quotient
    passed: FloatArray  # (m,) sum over the spans of |torque| |angle at the parent|, N m

    @classmethod
    def empty(cls, stations: int, columns: int) -> "FreeShapes":
        """Shapes yet to be put in."""
        angle, torque = np.empty((2, stations, columns))
        return cls(angle, torque, *np.empty((2, columns)))

    @property
    def finite(self) -> BoolArray:
        """Whether each shape (m,) is finite throughout; the sum over its spans tells."""
        return np.isfinite(self.passed)

    def put(self, columns: IntArray | slice, shapes: "FreeShapes") -> None:
        """Write `shapes` over those in `columns`."""
        self.angle[:, columns], self.torque[:, columns] = shapes.angle, shapes.torque
        self.correction[columns], self.passed[columns] = shapes.correction, shapes.passed

    def take(self, columns: IntArray) -> "FreeShapes":
        """The shapes in `columns`."""
        return FreeShapes(
            self.angle[:, columns], self.torque[:, columns], self.correction[columns], self.passed[columns]
        )


@dataclass(frozen=True)
class _Sides:
    """Both sides of every span at each frequency; (stations, m) or, for what is passed on, (stations + 1, m)."""

    total: FloatArray  # N m/rad, dynamic stiffness of the whole train seen at each station
    passed: FloatArray  # N m/rad, of the station and all outward of it, seen through the span from the parent
    returned: FloatArray  # N m/rad, of all the rest, seen through the span from the station
    outward: FloatArray  # angle of each station over that of its parent, without sources outward
    inward: FloatArray  # angle of each parent over that of the station, without sources inward


def free_shapes(tree: Tree, w: FloatArray) -> FreeShapes:
    """The shape at each frequency `w` (m,) rad/s, from the station where the residual |Z| / J is least.

    A column comes out not finite where the frequency is a repeated one to the last digit: its shape is not determined
    by one station. Stations must be numbered layer by layer.
    """
    if not tree.is_ready:
        raise ValueError("free_shapes takes a tree whose stations are numbered layer by layer")
    with np.errstate(divide="ignore", over="ignore", under="ignore", invalid="ignore"):
        sides = _sides(tree, w)
        start, column = _least_residual(tree, sides.total), np.arange(len(w))
        angle, torque, product = _spread(tree, sides, start)
        passed = np.add.reduce(np.abs(product, product), axis=0)
        mass = tree.moving_inertia @ np.multiply(angle, angle, product[: tree.size])
        correction = sides.total[start, column] / mass
        passed /= np.where(mass < np.inf, mass, np.nan)
        scale = 1.0 / np.sqrt(mass)
        angle *= scale
        torque *= scale
    return FreeShapes(angle, torque, correction, passed)


def _sides(tree: Tree, w: FloatArray) -> _Sides:
    """Both sides of every span at angular frequencies `w` (m,), by the way that suits the tree."""
    if tree.is_chain:
        return _sides_of_chain(tree, tree.own_stiffness(w * w))
    if not tree.is_swept_by_stations:
        return _sides_of_layers(tree, tree.own_stiffness(w * w))
    passes = stiffness_passes(tree, w)
    return _Sides(passes.total, passes.passed, passes.returned, passes.transmitted_outward, passes.transmitted_inward)


def _sides_of_layers(tree: Tree, own: FloatArray) -> _Sides:
    """The sweep inward, then the one outward, from the dynamic stiffness `own` (stations, m) of each station alone."""
    size, columns = own.shape
    total, outward, inward, rest = own.copy(), *np.empty((3, size, columns))
    passed, returned = np.empty((size + 1, columns)), np.empty((size, columns))
    passed[:size] = tree.flexibility[:, None]
    returned[:] = passed[:size]
    passed[size] = 0.0
    roots = slice(0, tree.parents.count(-1))
    passed[roots] = returned[roots] = outward[roots] = inward[roots] = 0.0
    reciprocal, add = np.reciprocal, np.add
    for layer in reversed(tree.layers or ()):
        stations = layer.stations
        inverse, through = outward[stations], passed[stations]
        reciprocal(total[stations], inverse)
        add(through, inverse, through)
        reciprocal(through, through)
        add_children(layer, passed, total[layer.above])
    _transmission(tree, passed[:size], outward, total)
    for layer in tree.layers or ():
        stations, above = layer.stations, layer.above
        inverse, through, behind = inward[stations], returned[stations], rest[stations]
        if layer.is_in_line:
            add(own[above], returned[above], behind)
        else:
            of_the_rest(layer, own[above] + returned[above], passed, behind)
        reciprocal(behind, inverse)
        add(through, inverse, through)
        reciprocal(through, through)
    _transmission(tree, returned, inward, rest)
    return _Sides(np.add(total, returned, out=total), passed, returned, outward, inward)


def _transmission(tree: Tree, through: FloatArray, inverse: FloatArray, stiffness: FloatArray) -> None:
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


def _least_residual(tree: Tree, total: FloatArray) -> IntArray:
    """Station (m,) with inertia at which |Z| / J is least."""
    residual = np.abs(total)
    residual *= (1.0 / tree.moving_inertia)[:, None]  # infinite without inertia, or not a number
    if not tree.is_plain:
        undetermined = np.isnan(residual)
        if undetermined.any():
            residual[undetermined] = np.inf
    least: IntArray = residual.argmin(axis=0)
    return least


def _spread(tree: Tree, sides: _Sides, start: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Angles (stations, m) that are 1 at `start` (m,), span torques (stations, m), and the products of these with the
    angles at the parents, with one row more.

    From the start and inward of it the torque is that of the rest of the train, elsewhere that of the branch.
    """
    if tree.is_chain:
        return _spread_along_chain(tree, sides, start)
    if tree.is_swept_by_stations:
        return _spread_by_stations(tree, sides, start)
    inward, outward, passed = sides.inward, sides.outward, sides.passed
    angle, torque, product = np.zeros_like(inward), np.zeros_like(inward), np.zeros_like(passed)
    angle[start, np.arange(len(start))] = 1.0
    multiply, add = np.multiply, np.add
    for layer in reversed(tree.layers or ()):
        stations = layer.stations
        multiply(angle[stations], inward[stations], product[stations])
        add_children(layer, product, angle[layer.above])
    path, column = np.divmod(np.flatnonzero(angle != 0.0), angle.shape[1])
    outward[path, column] = 0.0
    for layer in tree.layers or ():
        stations, before = layer.stations, angle[layer.above]
        if not layer.is_in_line:
            before = before.take(layer.parent, 0)
        here, moment, share = angle[stations], torque[stations], product[stations]
        add(here, multiply(before, outward[stations], share), here)
        multiply(before, passed[stations], moment)
        multiply(before, moment, share)
    torque[path, column] = -sides.returned[path, column] * angle[path, column]
    product[path, column] = torque[path, column] * angle[tree.parent[path], column]
    return angle, torque, product


def _sides_of_chain(tree: Tree, own: FloatArray) -> _Sides:
    """Like `_sides_of_layers`, from both ends at once."""
    size, columns = own.shape
    behind, inverse, through = both_ways(own, tree.flexibility)
    total, (passed, returned, outward, inward) = behind[::-1, :columns].copy(), np.zeros((4, size + 1, columns))
    passed[1:size], returned[1:size] = through[::-1, :columns], through[:, columns:]
    outward[1:size], inward[1:size] = inverse[::-1, :columns], inverse[:, columns:]
    _transmission(tree, passed[1:size], outward[1:size], total[1:])
    _transmission(tree, returned[1:size], inward[1:size], behind[:-1, columns:])
    total[1:] += returned[1:size]
    return _Sides(total, passed, returned[:size], outward[:size], inward[:size])


def _spread_along_chain(tree: Tree, sides: _Sides, start: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Like `_spread`, both ways at once; `product` has no row more."""
    angle, torque, product = spread(sides.inward[1:], sides.outward[1:], start), *np.zeros((2, *sides.passed.shape))
    before, moment = angle[:-1], torque[1 : tree.size]
    np.multiply(before, sides.passed[1 : tree.size], moment)
    returned = np.multiply(sides.returned[1:], angle[1:])
    np.copyto(moment, np.negative(returned, returned), where=np.arange(1, tree.size)[:, None] <= start)
    np.multiply(before, moment, product[1 : tree.size])
    return angle, torque[: tree.size], product


def _spread_by_stations(tree: Tree, sides: _Sides, start: IntArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Like `_spread`, one station after another; `product` has no row more."""
    angle, product = np.zeros(sides.outward.shape), np.empty(len(start))
    angle[start, np.arange(len(start))] = 1.0
    rows, factor = list(angle), list(sides.inward)
    multiply, add = np.multiply, np.add
    for i, parent in zip(range(tree.size - 1, -1, -1), reversed(tree.parents), strict=True):
        if parent >= 0:
            multiply(rows[i], factor[i], product)
            add(rows[parent], product, rows[parent])
    is_inward = angle != 0.0
    torque = np.where(is_inward, -sides.returned * angle, 0.0)
    factor = list(np.where(is_inward, 0.0, sides.outward))
    for i, parent in enumerate(tree.parents):
        if parent >= 0:
            multiply(rows[parent], factor[i], product)
            add(rows[i], product, rows[i])
    at_parent = angle[tree.parent]
    np.copyto(torque, sides.passed * at_parent, where=~is_inward)
    torque[tree.roots] = 0.0
    return angle, torque, np.multiply(at_parent, torque, out=at_parent)
