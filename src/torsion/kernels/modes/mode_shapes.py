"""Shapes of the modes next to given frequencies, by the stiffness that both sides of every span show.

For s = w^2 and angles x that solve D(s) x = 0, -x' (dD/ds) x is the generalised inertia, distributed inertia included:
a shaft has t^2 dh/ds + a^2 d(s Ji)/ds + b^2 d(s Jo)/ds of it, with its end angles a and b and the torque t = (a - b)/h
in its flexibility; its elastic energy is, twice, t^2 d(s h)/ds + s^2 (a^2 dJi/ds + b^2 dJo/ds).
"""

from dataclasses import dataclass, field
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.trees.elimination import eliminate_undamped, forced, spread
from torsion.kernels.trees.tree import Tree
from torsion.sources import source

if TYPE_CHECKING:
    from torsion.kernels.distributed.span_laws import Shafts


_LARGEST_BLOCK = 2**20  # stations times columns of shapes at once; 8 MB an array (measured)
_LEAST_COLUMNS = 64  # at once, however many stations
_NUDGES = (
    0.0,
    2.0**-51,
    -(2.0**-51),
    2.0**-50,
)  # relative changes of a frequency that do not matter
# Relative; components that near count as equal when the sign of a shape is chosen.
_EQUAL_SIZE = 1e-6
# Of the torque in a shaft; a smaller one at its end is a difference of equal terms.
_ROUNDING_OF_ENDS = 8e-15


@dataclass(frozen=True)
class Shapes:
    """Shapes of generalised inertia 1 of the modes next to given frequencies."""

    angle: FloatArray  # (stations, m) rad
    torque: FloatArray  # (stations, m) N m, in the flexibility of each span as it acts on the side of the leaves
    inner: FloatArray  # (shafts, m) N m, at the root end of each distributed shaft
    outer: FloatArray  # (shafts, m) N m, at its other end
    correction: FloatArray  # (m,) of w^2 by Rayleigh's quotient
    passed: FloatArray  # (m,) sum over the spans of |torque| |angle at the parent|, N m

    def put(self, columns: IntArray | slice, shapes: "Shapes") -> None:
        """Write `shapes` over those in `columns`."""
        for values, new in zip(vars(self).values(), vars(shapes).values(), strict=True):
            values[..., columns] = new

    def scale(self, factor: FloatArray) -> None:
        """Multiply each shape by its `factor` (m,), in place."""
        for values in (self.angle, self.torque, self.inner, self.outer):
            np.multiply(values, factor, out=values)

    def correct(self, columns: slice, share: FloatArray) -> None:
        """Take `share` (columns, columns) of the shapes in `columns` from one another, in place."""
        for values in (self.angle, self.torque, self.inner, self.outer):
            values[:, columns] -= values[:, columns] @ share


@dataclass(frozen=True)
class ShaftModes:
    """What distributed shafts add to modes."""

    torque_outer: FloatArray  # (stations, m) N m on station i at the outer end of its span; a spring's `torque`
    kinetic: FloatArray  # (stations, m) share of the kinetic energy: the station's own and half of each shaft at it
    elastic: FloatArray  # (stations, m) share of the elastic energy in span i
    shaft_kinetic: FloatArray  # (shafts, m) share of the kinetic energy in each shaft


@dataclass(frozen=True)
class TreeModes:
    """Elastic modes of a tree in ascending order, of generalised inertia 1, and its rigid motions."""

    frequency: FloatArray  # (m,) rad/s
    lower: FloatArray  # (m,) rad/s, proven to be no more than the frequency of the given train
    upper: FloatArray  # (m,) rad/s, proven to be no less
    angle: FloatArray  # (stations, m) rad; the first of the largest components positive
    torque: FloatArray  # (stations, m) N m, at the root end of span i as it acts on the side of the leaves; 0 at a root
    rigid: int  # number of rigid motions, known from the graph
    # (stations, rigid) rad; constant over each free part, generalised inertia 1.
    rigid_angle: FloatArray
    certified: bool = True  # whether `lower` and `upper` are proven, up to the stated rounding of the laws of shafts
    loop_torque: FloatArray = field(
        default_factory=lambda: np.empty((0, 0))
    )  # (loops, m) N m, on the second station
    shafts: ShaftModes | None = None


def shapes_at(tree: Tree, frequency: FloatArray) -> Shapes:
    """The shapes at `frequency` (m,) rad/s; one that is not finite, a node on a station exactly, is found beside.

    A column comes out not finite where the frequency is a repeated one to the last digit: its shape is not determined
    by one station.
    """
    angle, torque = np.empty((2, tree.size, len(frequency)))
    ends = np.empty((2, len(tree.shaft_parent), len(frequency)))
    shapes = Shapes(angle, torque, *ends, *np.empty((2, len(frequency))))
    left, block = np.arange(len(frequency)), max(_LEAST_COLUMNS, _LARGEST_BLOCK // tree.size)
    for nudge in _NUDGES:
        # In blocks of columns, so that memory stays bounded.
        for begin in range(0, len(left), block):
            part = left[begin : begin + block]
            shapes.put(part, free_shapes(tree, frequency[part] * (1.0 + nudge)))
        left = np.flatnonzero(~np.isfinite(shapes.passed))
        if not left.size:
            break
    return shapes


@source("ParlettDhillon1997")
def free_shapes(tree: Tree, w: FloatArray) -> Shapes:
    """The shape at each frequency `w` (m,) rad/s, from the station where the residual |Z| / J is least."""
    with np.errstate(all="ignore"):
        sides = eliminate_undamped(tree, w)
        residual = np.abs(sides.whole) / tree.static.inertia_columns
        residual[np.isnan(residual)] = np.inf  # without inertia
        start, column = residual.argmin(axis=0), np.arange(len(w))
        angle, torque = spread(sides, start)
        passed = np.abs(torque * angle[tree.parent]).sum(axis=0)
        mass = (tree.inertia_columns * (angle * angle)).sum(axis=0)
        inner, outer = end_torques(tree, w * w, angle, torque)
        if tree.shafts is not None:
            of_shafts, _ = shaft_energies(tree, tree.shafts, w * w, angle, torque)
            mass = mass + of_shafts.sum(axis=0)
        correction = sides.whole[start, column] / mass
        passed /= np.where(mass < np.inf, mass, np.nan)
        shapes = Shapes(angle, torque, inner, outer, correction, passed)
        shapes.scale(1.0 / np.sqrt(mass))
    return shapes


def end_torques(
    tree: Tree, square: FloatArray, angle: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return torques (shafts, m) N m at the inner and the outer end of each shaft at `square` (m,) of the frequencies.

    From the torque in its flexibility and the inertia at both of its ends; what is less than the rounding of both is 0,
    as at a free end.
    """
    if tree.shafts is None:
        return torque[:0], torque[:0]
    middle, (_, inner, outer) = torque[tree.shafts.node], tree.shafts.at(square)
    ends = []
    for inertia, turned in ((-inner, angle[tree.shaft_parent]), (outer, angle[tree.shafts.node])):
        end = middle + square * inertia * turned
        ends.append(np.where(np.abs(end) <= _ROUNDING_OF_ENDS * np.abs(middle), 0.0, end))
    return ends[0], ends[1]


def shaft_energies(
    tree: Tree, shafts: "Shafts", square: FloatArray, angle: FloatArray, torque: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Share (shafts, m) of each shaft in the generalised inertia, kg m2 rad2, and twice its elastic energy, N m."""
    slopes, node = shafts.slopes(square), shafts.node
    a, b, t = (values * values for values in (angle[tree.shaft_parent], angle[node], torque[node]))
    inner = (slopes.inner + square * slopes.inner_slope) * a
    outer = (slopes.outer + square * slopes.outer_slope) * b
    ends = slopes.inner_slope * a + slopes.outer_slope * b
    twist = slopes.flexibility + square * slopes.flexibility_slope
    return slopes.flexibility_slope * t + inner + outer, twist * t + square * square * ends


def shape_sign(angle: FloatArray) -> FloatArray:
    """Sign (m,) of the first angle in each shape (stations, m) that is, to rounding, as large as any."""
    size = np.abs(angle)
    first = np.argmax(size >= (1.0 - _EQUAL_SIZE) * size.max(axis=0), axis=0)
    sign: FloatArray = np.sign(angle[first, np.arange(angle.shape[1])])
    return sign


REPEATED = 1e-13  # relative distance below which frequencies count as one: their shapes are then any orthogonal set
# First near, to leave all other modes behind, then far, where the response has no rounding.
_SHIFTS = (1e-6, 5e-2)
# Of inverse iteration; a step keeps that much of a mode which is one gap away.
_STEPS = (2, 6)
_EVEN = 1e3 * REPEATED  # relative distance from which the modes of a group respond alike
_ROUNDING_OF_PRODUCT = 4e-15  # inner products below are as orthogonal as the arithmetic allows
_CLOSE = 1e-2  # relative distance of frequencies beyond which shapes are orthogonal to about 1e-14 by themselves
_CLOSE_OF_SHAFTS = 1e-3  # to 1e-13, which is what laws of shafts allow
# Up to which one product is faster than one a run of close frequencies (measured).
_SHAPES_AT_ONCE = 256
_NOTHING = 1e-140  # beside the largest, about 1; products of smaller ones would be subnormal, which are slow
_SWEEPS = 8  # each squares the inner products
_GAUSS = 5  # points for the mean of a slope; over a twentieth of s it is right to rounding


def _inertia(tree: Tree, begin: FloatArray, end: FloatArray) -> FloatArray:
    """Mean of -dD/ds between the squares `begin` and `end` (m,): kg m2 (3, shafts, m), across, inner and outer end."""
    total = np.zeros((3, len(tree.shaft_parent), len(begin)))
    if tree.shafts is None:
        return total
    from numpy.polynomial import legendre

    for point, weight in zip(*(part.tolist() for part in legendre.leggauss(_GAUSS)), strict=True):
        square = begin + (0.5 + 0.5 * point) * (end - begin)
        slopes = tree.shafts.slopes(square)
        across = slopes.flexibility_slope / (slopes.flexibility * slopes.flexibility)
        inner = slopes.inner + square * slopes.inner_slope
        outer = slopes.outer + square * slopes.outer_slope
        total += 0.5 * weight * np.array([across, inner, outer])
    return total


def _load(tree: Tree, inertia: FloatArray, angle: FloatArray, twist: FloatArray) -> FloatArray:
    """Inertia of the whole train times shapes (stations, m), the twists (shafts, m) of the shafts among them."""
    load: FloatArray = tree.moving_inertia[:, None] * angle
    if tree.shafts is not None:
        across = inertia[0] * twist
        inner = inertia[1] * angle[tree.shaft_parent] + across
        tree.add_ends(load, inner, inertia[2] * angle[tree.shafts.node] - across)
        load[tree.held] = 0.0
    return load


def repeated_groups(frequency: FloatArray, undetermined: BoolArray) -> list[IntArray]:
    """Runs of equal frequencies in ascending `frequency` (m,), and single ones that are `undetermined` (m,)."""
    is_new = frequency[1:] - frequency[:-1] > REPEATED * frequency[1:]
    if is_new.all() and not undetermined.any():
        return []
    edges = [0, *(np.flatnonzero(is_new) + 1).tolist(), len(frequency)]
    return [np.arange(a, b) for a, b in pairwise(edges) if b - a > 1 or undetermined[a]]


def repeated_shapes(tree: Tree, frequency: FloatArray, groups: list[IntArray]) -> Shapes:
    """The shapes of the modes in `groups`, one group after another, of generalised inertia 1.

    Inverse iteration with the responses to torques, at a frequency beside each group: D(s) x = 0 is D(s') x =
    (s - s') M x, M being the mean slope. In each group every further shape is zero where one before it is largest, so
    that parts of a train that do not touch are separated.
    """
    columns = np.concatenate(groups)
    parts = np.split(np.arange(len(columns)), np.cumsum([len(group) for group in groups])[:-1])
    gaps = list[float]()  # relative distance from each to the nearest other frequency, at most 1
    for group in groups:
        centre = float(frequency[group[0]])
        nearest = np.abs(np.delete(frequency, group) - centre).min(initial=centre)
        gaps += [min(1.0, float(nearest) / centre)] * len(group)
    gap = np.array(gaps)
    group_frequency, root = frequency[columns], np.sqrt(tree.static.moving_inertia)[:, None]
    square = group_frequency * group_frequency
    inertia = _inertia(tree, square, square)
    load = root * np.random.default_rng(len(columns)).standard_normal((tree.size, len(columns)))

    # First close to the group, so that all other modes die out, then far, where the response has no rounding.
    for shift, steps in zip(_SHIFTS, _STEPS, strict=True):
        shifted = group_frequency * (1.0 - shift * gap)
        sides, mean = eliminate_undamped(tree, shifted), _inertia(tree, shifted * shifted, square)
        uneven = [part for part in parts if shift * gap[part[0]] < _EVEN]
        for step in range(steps):
            angle, torque = forced(sides, load)
            twist = torque[:0]
            if tree.shafts is not None:
                twist = tree.shafts.at(shifted * shifted)[0] * torque[tree.shafts.node]
            shapes = np.concatenate((angle, torque, twist))
            shapes /= np.max(np.abs(root * angle), axis=0)
            is_even = 0 < step < steps - 1 and tree.shafts is None
            _normalise(tree, inertia, shapes, uneven if is_even else parts)
            load = _load(tree, mean, shapes[: tree.size], shapes[2 * tree.size :])

    # Parts of a train that do not touch have shapes of their own.
    for part in parts:
        shapes[:, part] = shapes[:, part] @ _separating(root * shapes[: tree.size, part])
    angle, torque, twist = np.split(shapes, (tree.size, 2 * tree.size))
    if tree.shafts is not None:
        torque[tree.shafts.node] = twist / tree.shafts.at(square)[0]
    none = np.zeros(len(square))
    return Shapes(angle, torque, *end_torques(tree, square, angle, torque), none, none)


def _normalise(tree: Tree, inertia: FloatArray, shapes: FloatArray, parts: list[IntArray]) -> None:
    """Make the shapes of each part orthonormal, in place; those of shafts twice, for their products are less exact."""
    size = tree.size
    for _ in range(1 if tree.shafts is None else 2):
        load = _load(tree, inertia, shapes[:size], shapes[2 * size :])
        for part in parts:
            angle = shapes[:size, part]
            if tree.shafts is None:
                matrix = orthonormal(np.sqrt(tree.moving_inertia)[:, None] * angle)
            else:
                products = angle.T @ load[:, part]
                scale = 1.0 / np.sqrt(np.diag(products))
                even = scale[:, None] * (0.5 * (products + products.T)) * scale
                values, vectors = np.linalg.eigh(even)
                root = np.sqrt(np.maximum(values, np.finfo(float).tiny))
                matrix = scale[:, None] * (vectors / root)
            shapes[:, part] = shapes[:, part] @ matrix


def orthogonalise(tree: Tree, frequency: FloatArray, shapes: Shapes) -> None:
    """Make the shapes (stations, m) of close ascending frequencies (m,) orthogonal, in place.

    Close shapes are wrong by rounding over the distance of their frequencies, in each other's direction; half of that
    is taken from each of the two (Loewdin 1950). Shapes that are orthogonal to rounding are not touched.
    """
    if tree.shafts is not None:
        _orthogonalise_with_shafts(tree, frequency, shapes)
        return
    is_separate = frequency[1:] - frequency[:-1] > _CLOSE * frequency[1:]
    if is_separate.all():
        return
    root = np.sqrt(tree.moving_inertia)[:, None]
    run = np.append(0, np.cumsum(is_separate))
    edges = [0, *(np.flatnonzero(is_separate) + 1).tolist(), len(frequency)]
    if len(frequency) <= _SHAPES_AT_ONCE:
        edges = [0, len(frequency)]
    for begin, end in pairwise(edges):
        part = slice(begin, end)
        is_apart = run[part, None] != run[part]
        for _ in range(_SWEEPS if end - begin > 1 else 0):
            weighted = root * shapes.angle[:, part]
            weighted[np.abs(weighted) < _NOTHING] = 0.0
            product = weighted.T @ weighted
            product.flat[:: end - begin + 1] -= 1.0
            product[is_apart | (np.abs(product) < _ROUNDING_OF_PRODUCT)] = 0.0
            if not product.any():
                break
            shapes.correct(part, 0.5 * product)
            if np.max(np.abs(product)) ** 2 < _ROUNDING_OF_PRODUCT:
                break


def _orthogonalise_with_shafts(tree: Tree, frequency: FloatArray, shapes: Shapes) -> None:
    """The same pair by pair, for the inertia of the shafts is another for every pair."""
    last = np.searchsorted(frequency, frequency * (1.0 + _CLOSE_OF_SHAFTS), side="right")
    number = last - np.arange(len(frequency)) - 1
    first = np.repeat(np.arange(len(frequency)), number)
    begins = np.repeat(np.cumsum(number) - number, number)
    second = first + 1 + np.arange(len(first)) - begins
    if tree.shafts is None or not len(first):
        return
    square = frequency * frequency
    flexibility, node = tree.shafts.at(square)[0], tree.shafts.node
    inertia = _inertia(tree, square[first], square[second])
    for _ in range(_SWEEPS):
        twist, angle = flexibility * shapes.torque[node], shapes.angle
        load = _load(tree, inertia, angle[:, first], twist[:, first])
        values = np.einsum("ip,ip->p", load, angle[:, second])
        values[np.abs(values) < _ROUNDING_OF_PRODUCT] = 0.0
        if not values.any():
            return
        product = np.zeros((len(frequency), len(frequency)))
        product[first, second] = product[second, first] = values
        shapes.correct(slice(None), 0.5 * product)


def orthonormal(weighted: FloatArray) -> FloatArray:
    """Matrix that makes the columns of `weighted` orthonormal."""
    scale = 1.0 / np.linalg.norm(weighted, axis=0)
    if len(scale) == 1:
        return np.asarray(scale[:, None])
    triangle = np.linalg.qr(weighted * scale, mode="r")
    matrix: FloatArray = scale[:, None] * np.linalg.solve(triangle, np.eye(len(scale)))
    return matrix


def _separating(basis: FloatArray) -> FloatArray:
    """Rotation after which each column of `basis` is zero in the rows where those before it are largest."""
    if basis.shape[1] == 1:
        return np.ones((1, 1))
    remainder, directions = basis.copy(), list[FloatArray]()
    for _ in range(basis.shape[1]):
        row = remainder[np.argmax(np.einsum("ij,ij->i", remainder, remainder))]
        for previous in directions:
            row = row - previous * (previous @ row)
        direction = row / np.linalg.norm(row)
        directions.append(direction)
        remainder = remainder - np.outer(remainder @ direction, direction)
    return np.column_stack(directions)
