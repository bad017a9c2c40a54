"""Shapes of repeated frequencies, and the last digits of orthogonality between close ones."""

from itertools import pairwise

import numpy as np

from torsion.kernels.passes import forced, forced_angles, sources, stiffness_passes
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree

REPEATED = 1e-13  # relative distance below which frequencies count as one: their shapes are then any orthogonal set
_SHIFTS = (1e-6, 5e-2)  # first near, to leave all other modes behind, then far, where the response has no rounding
_STEPS = (2, 5)  # of inverse iteration, and one at the end; a step keeps that much of a mode which is one gap away
_EVEN = 1e3 * REPEATED  # relative distance from which the modes of a group respond alike
_ROUNDING_OF_PRODUCT = 4e-15  # inner products below are as orthogonal as the arithmetic allows
_CLOSE = 1e-2  # relative distance of frequencies beyond which shapes are orthogonal to about 1e-14 by themselves
_SHAPES_AT_ONCE = 256  # up to which one product is faster than one a run of close frequencies (measured)
_NOTHING = 1e-140  # beside the largest, about 1; products of smaller ones would be subnormal, which are slow
_SWEEPS = 8  # each squares the inner products


def repeated_groups(frequency: FloatArray, undetermined: BoolArray) -> list[IntArray]:
    """Runs of equal frequencies in ascending `frequency` (m,), and single ones that are `undetermined` (m,)."""
    is_new = frequency[1:] - frequency[:-1] > REPEATED * frequency[1:]
    if is_new.all() and not undetermined.any():
        return []
    edges = [0, *(np.flatnonzero(is_new) + 1).tolist(), len(frequency)]
    return [np.arange(a, b) for a, b in pairwise(edges) if b - a > 1 or undetermined[a]]


def repeated_shapes(tree: Tree, frequency: FloatArray, groups: list[IntArray]) -> tuple[FloatArray, FloatArray]:
    """Angles and span torques (stations, columns), mass-normalised, of the modes in `groups`, one group after another.

    Inverse iteration with the responses to torques, at a frequency beside each group. In each group every further
    shape is zero where one before it is largest, so that parts of a train that do not touch are told apart.
    """
    columns = np.concatenate(groups)
    parts = np.split(np.arange(len(columns)), np.cumsum([len(group) for group in groups])[:-1])
    gap = np.concatenate([np.full(len(group), relative_gap(frequency, group)) for group in groups])
    inertia = tree.moving_inertia[:, None]
    root = np.sqrt(inertia)
    load = root * np.random.default_rng(len(columns)).standard_normal((tree.size, len(columns)))
    for shift, steps in zip(_SHIFTS, _STEPS, strict=True):
        passes = stiffness_passes(tree, frequency[columns] * (1.0 - shift * gap))
        uneven = [part for part in parts if shift * gap[part[0]] < _EVEN]
        for step in range(steps):
            angle = forced_angles(tree, passes, sources(tree, passes, load))
            angle /= np.max(np.abs(root * angle), axis=0)
            for part in parts if step == 0 else uneven:
                angle[:, part] = angle[:, part] @ orthonormal(root * angle[:, part])
            load = inertia * angle
    angle, torque = forced(tree, passes, load)
    for part in parts:
        mix(angle, torque, part, orthonormal(root * angle[:, part]))
        mix(angle, torque, part, telling_apart(root * angle[:, part]))
    return angle, torque


def orthogonalise(tree: Tree, frequency: FloatArray, angle: FloatArray, torque: FloatArray) -> None:
    """Make the shapes (stations, m) of close ascending frequencies (m,) orthogonal, in place.

    Close shapes are wrong by rounding over the distance of their frequencies, in each other's direction; half of that
    is taken from each of the two (Loewdin 1950). Shapes that are orthogonal to rounding are not touched.
    """
    apart = frequency[1:] - frequency[:-1] > _CLOSE * frequency[1:]
    if apart.all():
        return
    root = np.sqrt(tree.moving_inertia)[:, None]
    run, edges = np.append(0, np.cumsum(apart)), [0, *(np.flatnonzero(apart) + 1).tolist(), len(frequency)]
    if len(frequency) <= _SHAPES_AT_ONCE:
        edges = [0, len(frequency)]
    for begin, end in pairwise(edges):
        part = slice(begin, end)
        is_apart = run[part, None] != run[part]
        for _ in range(_SWEEPS if end - begin > 1 else 0):
            weighted = root * angle[:, part]
            weighted[np.abs(weighted) < _NOTHING] = 0.0
            product = weighted.T @ weighted
            product.flat[:: end - begin + 1] -= 1.0
            product[is_apart | (np.abs(product) < _ROUNDING_OF_PRODUCT)] = 0.0
            if not product.any():
                break
            angle[:, part] -= angle[:, part] @ (0.5 * product)
            torque[:, part] -= torque[:, part] @ (0.5 * product)
            if np.max(np.abs(product)) ** 2 < _ROUNDING_OF_PRODUCT:
                break


def mix(angle: FloatArray, torque: FloatArray, columns: IntArray, matrix: FloatArray) -> None:
    """Replace the shapes in `columns` by their combinations, in place."""
    angle[:, columns], torque[:, columns] = angle[:, columns] @ matrix, torque[:, columns] @ matrix


def relative_gap(frequency: FloatArray, group: IntArray) -> float:
    """Relative distance from the group's frequency to the nearest other one, at most 1."""
    here = frequency[group[0]]
    others = np.delete(frequency, group)
    return min(1.0, float(np.min(np.abs(others - here))) / here) if len(others) else 1.0


def orthonormal(weighted: FloatArray) -> FloatArray:
    """Matrix that makes the columns of `weighted` orthonormal."""
    scale = 1.0 / np.linalg.norm(weighted, axis=0)
    if len(scale) == 1:
        return np.asarray(scale[:, None])
    triangle = np.linalg.qr(weighted * scale, mode="r")
    matrix: FloatArray = scale[:, None] * np.linalg.solve(triangle, np.eye(len(scale)))
    return matrix


def telling_apart(basis: FloatArray) -> FloatArray:
    """Rotation after which each column of `basis` is zero in the rows where those before it are largest."""
    if basis.shape[1] == 1:
        return np.ones((1, 1))
    rest, directions = basis.copy(), list[FloatArray]()
    for _ in range(basis.shape[1]):
        row = rest[np.argmax(np.einsum("ij,ij->i", rest, rest))]
        for known in directions:
            row = row - known * (known @ row)
        direction = row / np.linalg.norm(row)
        directions.append(direction)
        rest = rest - np.outer(rest @ direction, direction)
    return np.column_stack(directions)
