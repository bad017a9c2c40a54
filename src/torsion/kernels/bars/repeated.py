"""Shapes of repeated frequencies of a tree with bars, and the last digits of orthogonality between close ones.

At two frequencies s_i and s_j the shapes are orthogonal in the mean of -dD/ds between both (D being the dynamic
stiffness), which is the distributed inertia of the continuum.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from torsion.kernels.bars.passes import bar_passes, forced
from torsion.kernels.bars.shapes import BarShapes
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.repeated import relative_gap, telling_apart
from torsion.kernels.tree import FloatArray, IntArray

_SHIFTS = (1e-6, 5e-2)  # of the gap to the next mode: first near, to leave others behind, then far, free of rounding
_STEPS = (2, 5)
_LIMIT_OF_CLOSE = 1e-3  # relative distance; beyond, shapes are orthogonal to 1e-13 by themselves
_GAUSS = legendre.leggauss(5)  # for the mean of a slope; over a twentieth of s it is right to rounding
_ROUNDING_OF_PRODUCT = 4e-15
_SWEEPS = 4


@dataclass(frozen=True)
class _Inertia:
    """-dD/ds of every bar, or its mean between two frequencies, (bars, m): between the ends and at each."""

    across: FloatArray  # kg m2
    inner: FloatArray
    outer: FloatArray

    def load(self, train: BarTree, angle: FloatArray, twist: FloatArray) -> FloatArray:
        """The whole train's times shapes (stations, m), from their angles and the twists of the bars (bars, m)."""
        load = train.tree.moving_inertia[:, None] * angle
        across = self.across * twist
        inner = self.inner * angle[train.parent] + across
        outer = self.outer * angle[train.bars.node] - across
        train.add_ends(load, inner, outer)
        load[train.tree.held] = 0.0
        return load


def _inertia(train: BarTree, begin: FloatArray, end: FloatArray) -> _Inertia:
    """Mean of -dD/ds between the squares `begin` and `end` (m,)."""
    total = np.zeros((3, train.bars.size, len(begin)))
    for place, weight in zip(*(part.tolist() for part in _GAUSS), strict=True):
        at = train.bars.slopes(begin + (0.5 + 0.5 * place) * (end - begin))
        total[0] += 0.5 * weight * (at.flexibility_slope / (at.flexibility * at.flexibility))
        total[1] += 0.5 * weight * (at.inner + at.square * at.inner_slope)
        total[2] += 0.5 * weight * (at.outer + at.square * at.outer_slope)
    return _Inertia(*total)


def repeated_shapes(train: BarTree, frequency: FloatArray, groups: list[IntArray]) -> BarShapes:
    """The shapes of the modes in `groups`, one group after another, of generalised inertia 1, by inverse iteration.

    In each group every further shape is zero where one before it is largest: parts that do not touch are told apart.
    """
    parts = [_group_shapes(train, frequency, group) for group in groups]
    angle, inner, outer, between = (np.concatenate([part[k] for part in parts], axis=1) for k in range(4))
    none = np.zeros(angle.shape[1])
    return BarShapes(angle, inner, outer, between, none, none)


def _group_shapes(train: BarTree, frequency: FloatArray, group: IntArray) -> list[FloatArray]:
    """Angles, torques at both ends and between of one group; D(s) x = 0 as D(s') x = (s - s') M x, M the mean slope."""
    gap, number = relative_gap(frequency, group), len(group)
    at = np.full(number, frequency[group[0]])
    square, body = at * at, np.sqrt(train.static.moving_inertia)[:, None]
    here = _inertia(train, square, square)
    load = body * np.random.default_rng(number).standard_normal((train.tree.size, number))
    angle = between = twist = np.zeros(0)
    for shift, steps in zip(_SHIFTS, _STEPS, strict=True):
        beside = at * (1.0 - shift * gap)
        passes, flexibility = bar_passes(train, beside), train.bars.at(beside * beside)[0]
        across = _inertia(train, beside * beside, square)
        for _ in range(steps):
            angle, _, _, between = forced(train, passes, load)
            twist = flexibility * between[train.bars.node]
            for _ in range(2):
                matrix = _orthonormal(angle.T @ here.load(train, angle, twist))
                angle, between, twist = angle @ matrix, between @ matrix, twist @ matrix
            load = across.load(train, angle, twist)
    matrix = telling_apart(body * angle)
    return _told(train, square, angle @ matrix, between @ matrix, twist @ matrix)


def _told(
    train: BarTree, square: FloatArray, angle: FloatArray, between: FloatArray, twist: FloatArray
) -> list[FloatArray]:
    """Angles, torques at both ends of the spans and between, of shapes with the twists (bars, m) of the bars."""
    flexibility, inner, outer = train.bars.at(square)
    node, middle = train.bars.node, twist / flexibility
    between[node] = middle
    near, far = between.copy(), between.copy()
    near[node] = middle - square * inner * angle[train.parent]
    far[node] = middle + square * outer * angle[node]
    return [angle, near, far, between]


def _orthonormal(products: FloatArray) -> FloatArray:
    """Matrix that makes shapes with these inner products orthonormal."""
    scale = 1.0 / np.sqrt(np.diag(products))
    even = scale[:, None] * (0.5 * (products + products.T)) * scale
    values, vectors = np.linalg.eigh(even)
    matrix: FloatArray = scale[:, None] * (vectors / np.sqrt(np.maximum(values, np.finfo(float).tiny)))
    return matrix


def orthogonalise(train: BarTree, frequency: FloatArray, shapes: BarShapes) -> None:
    """Make the shapes of close ascending frequencies (m,) orthogonal, in place; half is taken from each of the two."""
    first, second = _close_pairs(frequency)
    if not len(first):
        return
    square = frequency * frequency
    flexibility, node = train.bars.at(square)[0], train.bars.node
    inertia = _inertia(train, square[first], square[second])
    for _ in range(_SWEEPS):
        twist = flexibility * shapes.between[node]
        angle = shapes.angle[:, first]
        values = np.einsum("ip,i,ip->p", angle, train.tree.moving_inertia, shapes.angle[:, second])
        for part, end in ((inertia.inner, train.parent), (inertia.outer, node)):
            values = values + np.einsum("bp,bp,bp->p", part, angle[end], shapes.angle[np.ix_(end, second)])
        values = values + np.einsum("bp,bp,bp->p", inertia.across, twist[:, first], twist[:, second])
        values[np.abs(values) < _ROUNDING_OF_PRODUCT] = 0.0
        if not values.any():
            return
        product = np.zeros((len(frequency), len(frequency)))
        product[first, second] = product[second, first] = values
        mixed = np.eye(len(frequency)) - 0.5 * product
        for rows in (shapes.angle, shapes.inner, shapes.outer, shapes.between):
            rows[:] = rows @ mixed


def _close_pairs(frequency: FloatArray) -> tuple[IntArray, IntArray]:
    """Pairs of modes nearer to each other than `_LIMIT_OF_CLOSE`, relative."""
    last = np.searchsorted(frequency, frequency * (1.0 + _LIMIT_OF_CLOSE), side="right")
    number = last - np.arange(len(frequency)) - 1
    first = np.repeat(np.arange(len(frequency)), number)
    begins = np.repeat(np.cumsum(number) - number, number)
    return first, first + 1 + np.arange(len(first)) - begins
