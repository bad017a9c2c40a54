"""Shapes of repeated frequencies, and the last digits of orthogonality between close ones.

At two squares s_i and s_j of frequencies, shapes are orthogonal in the mean of -dD/ds between both, D being the dynamic
stiffness: the inertia of the stations, and of each distributed shaft what the slopes of its law say.
"""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.elimination import SpanSides, eliminate_undamped, forced
from torsion.kernels.mode_shapes import Shapes, end_torques
from torsion.kernels.tree import Tree

REPEATED = 1e-13  # relative distance below which frequencies count as one: their shapes are then any orthogonal set
# First near, to leave all other modes behind, then far, where the response has no rounding.
_SHIFTS = (1e-6, 5e-2)
# Of inverse iteration, and one at the end; a step keeps that much of a mode which is one gap away.
_STEPS = (2, 5)
_EVEN = 1e3 * REPEATED  # relative distance from which the modes of a group respond alike
_ROUNDING_OF_PRODUCT = 4e-15  # inner products below are as orthogonal as the arithmetic allows
_CLOSE = 1e-2  # relative distance of frequencies beyond which shapes are orthogonal to about 1e-14 by themselves
_CLOSE_OF_SHAFTS = 1e-3  # to 1e-13, which is what laws of shafts allow
# Up to which one product is faster than one a run of close frequencies (measured).
_SHAPES_AT_ONCE = 256
_NOTHING = 1e-140  # beside the largest, about 1; products of smaller ones would be subnormal, which are slow
_SWEEPS = 8  # each squares the inner products
_GAUSS = 5  # points for the mean of a slope; over a twentieth of s it is right to rounding


@dataclass(frozen=True)
class _Inertia:
    """-dD/ds, or its mean between two squares of frequencies (m,): of the stations, and of every shaft (shafts, m)."""

    tree: Tree
    across: FloatArray  # kg m2, between the ends
    inner: FloatArray  # kg m2, at each end
    outer: FloatArray

    def load(self, angle: FloatArray, twist: FloatArray) -> FloatArray:
        """The whole train's times shapes (stations, m), the twists (shafts, m) of the shafts among them."""
        tree = self.tree
        load: FloatArray = tree.moving_inertia[:, None] * angle
        if tree.shafts is not None:
            across = self.across * twist
            inner = self.inner * angle[tree.shaft_parent] + across
            tree.add_ends(load, inner, self.outer * angle[tree.shafts.node] - across)
            load[tree.held] = 0.0
        return load


def _inertia(tree: Tree, begin: FloatArray, end: FloatArray) -> _Inertia:
    """Mean of -dD/ds between the squares `begin` and `end` (m,)."""
    total = np.zeros((3, len(tree.shaft_parent), len(begin)))
    if tree.shafts is None:
        return _Inertia(tree, *total)
    from numpy.polynomial import legendre

    for point, weight in zip(*(part.tolist() for part in legendre.leggauss(_GAUSS)), strict=True):
        slopes = tree.shafts.slopes(begin + (0.5 + 0.5 * point) * (end - begin))
        total[0] += (
            0.5 * weight * (slopes.flexibility_slope / (slopes.flexibility * slopes.flexibility))
        )
        total[1] += 0.5 * weight * (slopes.inner + slopes.square * slopes.inner_slope)
        total[2] += 0.5 * weight * (slopes.outer + slopes.square * slopes.outer_slope)
    return _Inertia(tree, *total)


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
            shapes = _response(tree, sides, shifted * shifted, load)
            shapes /= np.max(np.abs(root * shapes[: tree.size]), axis=0)
            _normalise(inertia, shapes, parts if step == 0 or tree.shafts is not None else uneven)
            load = mean.load(shapes[: tree.size], shapes[2 * tree.size :])
    shapes = _response(tree, sides, shifted * shifted, load)
    _normalise(inertia, shapes, parts)

    # Parts of a train that do not touch have shapes of their own.
    for part in parts:
        shapes[:, part] = shapes[:, part] @ _separating(root * shapes[: tree.size, part])
    angle, torque, twist = np.split(shapes, (tree.size, 2 * tree.size))
    if tree.shafts is not None:
        torque[tree.shafts.node] = twist / tree.shafts.at(square)[0]
    none = np.zeros(len(square))
    return Shapes(angle, torque, *end_torques(tree, square, angle, torque), none, none)


def _response(tree: Tree, sides: SpanSides, square: FloatArray, load: FloatArray) -> FloatArray:
    """Angles and torques (2 stations, m) under `load` (stations, m) N m, and the twists (shafts, m) of shafts."""
    angle, torque = forced(sides, load)
    if tree.shafts is None:
        return np.concatenate((angle, torque))
    return np.concatenate((angle, torque, tree.shafts.at(square)[0] * torque[tree.shafts.node]))


def _normalise(inertia: _Inertia, shapes: FloatArray, parts: list[IntArray]) -> None:
    """Make the shapes of each part orthonormal, in place; those of shafts twice, for their products are less exact."""
    tree, size = inertia.tree, inertia.tree.size
    for _ in range(1 if tree.shafts is None else 2):
        load = inertia.load(shapes[:size], shapes[2 * size :]) if tree.shafts is not None else None
        for part in parts:
            angle = shapes[:size, part]
            if load is None:
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
        load = inertia.load(angle[:, first], twist[:, first])
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
