"""Natural frequencies of many trains of one layout, side by side: a column of inertias and flexibilities for each.

From the modes of one train, the geometric middle of all, every other begins at its Ritz values, the natural frequencies
of all its motions in which these modes add up. Rayleigh's steps lead from there to its modes; the counts that enclose a
frequency are the sweeps of one train, with a train in each column. Trains that counts do not confirm are solved each by
itself.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.modes.mode_shapes import TreeModes, free_shapes
from torsion.kernels.modes.natural_modes import count_below, expected_width, tree_modes
from torsion.kernels.modes.network_counts import Way
from torsion.kernels.trees.tree import Tree

_FURTHER = 30  # modes of the middle train beside those wanted, by which all others begin
_COLUMNS = 2048  # trains at once: arrays of a sweep stay in the cache (measured)
_LARGEST = 2**19  # stations times trains at once
_STEPS = 6  # of Rayleigh; 2 are usual
_SETTLED = 1e-8  # relative step after which the next one is below rounding: each squares the error
_FARTHEST = 0.3  # relative step beyond which one has left its mode
_WIDENED = (1.0, 4.0)  # times the width in which counts are expected to enclose it


@dataclass(frozen=True)
class VariantModes:
    """Elastic modes of every train, ascending."""

    frequency: FloatArray  # (modes, trains) rad/s
    lower: FloatArray  # (modes, trains) rad/s, proven to be no more
    upper: FloatArray  # (modes, trains) rad/s, proven to be no less
    alone: int  # frequencies that had to be found train by train


def variant_modes(
    tree: Tree, flexibility: FloatArray, inertia: FloatArray, count: int
) -> VariantModes:
    """The lowest `count` elastic modes of the trains in the columns of `flexibility` and `inertia` (stations, trains).

    tree: their layout, and which stations are fixed. A flexibility or inertia that is 0 in one train is 0 in all.
    Raises ValueError for arrays of other shapes, or fewer modes than `count`; SolveError as `tree_modes` does.

    >>> two = Tree(np.array([-1, 0]), np.zeros(2), np.zeros(2), np.zeros(2, dtype=bool))
    >>> stiffness = np.array([1e4, 2e4, 4e4])
    >>> found = variant_modes(two, np.stack([0 * stiffness, 1 / stiffness]), np.ones((2, 3)), 1)
    >>> found.frequency.round(8)  # sqrt(2 k/J)
    array([[141.42135624, 200.        , 282.84271247]])
    """
    if not flexibility.shape == inertia.shape == (tree.size, flexibility.shape[-1]):
        raise ValueError(
            f"{tree.size} stations, flexibility {flexibility.shape}, inertia {inertia.shape}"
        )
    # The modes of a train in their middle span the shapes from which the search in each begins.
    middle = replace(tree, flexibility=middle_of(flexibility), inertia=middle_of(inertia))
    middle_modes = tree_modes(middle, count + _FURTHER)
    if len(middle_modes.frequency) < count:
        raise ValueError(
            f"the trains have {len(middle_modes.frequency)} elastic modes, not {count}"
        )
    many = replace(tree, flexibility=flexibility, inertia=inertia)
    bounds, alone = np.empty((3, count, flexibility.shape[1])), 0
    for part in parts(tree.size, flexibility.shape[1]):
        trains = many.columns(part)
        start = ritz_values(trains, middle, middle_modes, count + _FURTHER)[:count]
        frequency, passed = np.array([_settled(trains, begin) for begin in start]).swapaxes(0, 1)
        order = np.argsort(frequency, axis=0)
        frequency, passed = (np.take_along_axis(v, order, axis=0) for v in (frequency, passed))
        bounds[:, :, part], proven = frequency, np.ones(frequency.shape[1], dtype=bool)
        for mode, hertz in enumerate(frequency):
            # Two counts prove each frequency; a train with one that is not proven is solved by itself.
            bounds[1:, mode, part], is_proven = enclosed(
                trains,
                count_below,
                hertz,
                expected_width(trains, hertz, passed[mode]),
                mode + middle_modes.rigid,
                _WIDENED,
            )
            proven &= is_proven
        for column in (part.start + np.flatnonzero(~proven)).tolist():
            modes = tree_modes(many.columns(column), count)
            bounds[:, :, column] = modes.frequency, modes.lower, modes.upper
            alone += count
    frequency, lower, upper = bounds
    return VariantModes(frequency, lower, upper, alone)


def middle_of(values: FloatArray) -> FloatArray:
    """Geometric mean (stations,) over the trains; 0 where all are 0, or not used."""
    with np.errstate(divide="ignore"):
        return np.asarray(np.exp(np.log(values).mean(axis=1)))


def ritz_values(
    trains: Tree,
    middle: Tree,
    modes: TreeModes,
    number: int,
    chords: tuple[FloatArray, FloatArray] | None = None,
) -> FloatArray:
    """Frequencies (number, trains) rad/s by Ritz's method, from modes and rigid motions of the `middle` train.

    chords: flexibility of spans that close loops, (chords, trains) and of the middle train.
    """
    torque, flexibility, middle_flexibility = modes.torque, trains.flexibility, middle.flexibility
    if chords is not None:
        torque = np.vstack([torque, modes.loop_torque])
        flexibility = np.concatenate([flexibility, chords[0]])
        middle_flexibility = np.append(middle_flexibility, chords[1])
    twist = torque[:, :number] * middle_flexibility[:, None]
    stiffness = np.divide(1.0, flexibility, out=np.zeros_like(flexibility), where=flexibility > 0.0)
    angle = np.hstack([modes.rigid_angle, modes.angle[:, :number]])
    potential, kinetic = (
        np.einsum("ia,ib,it->tab", shape, shape, weight, optimize=True)
        for shape, weight in ((twist, stiffness), (angle, trains.moving_inertia))
    )
    rigid, elastic = slice(modes.rigid), slice(modes.rigid, None)
    along = kinetic[:, rigid, elastic]
    kinetic = kinetic[:, elastic, elastic] - along.transpose(0, 2, 1) @ np.linalg.solve(
        kinetic[:, rigid, rigid], along
    )

    # Periods, of which the longest, those of the lowest modes, have the least rounding; factors keep it from squaring.
    try:
        root = np.linalg.solve(np.linalg.cholesky(potential), np.linalg.cholesky(kinetic))
    except np.linalg.LinAlgError:
        # The energies of a train far from the middle one are rounding; it is not proven, and solved by itself.
        return np.repeat(modes.frequency[:number, None], len(kinetic), axis=1)
    period = np.linalg.svd(root, compute_uv=False).T
    frequency: FloatArray = 1.0 / np.maximum(period, 2.0**-52 * period[0])
    return frequency


def parts(size: int, trains: int) -> Iterator[slice]:
    width = max(1, min(_COLUMNS, _LARGEST // size))
    return (slice(begin, min(begin + width, trains)) for begin in range(0, trains, width))


def toward(tree: Tree, root: int) -> list[tuple[int, int, int]]:
    """Every station but the root, the next one toward it and the span between, the farthest first."""
    steps, reached = [], [(root, -1)]
    for station, behind in reached:
        near = [(child, child) for child in tree.children[station]]
        near += [(tree.parents[station], station)] if tree.parents[station] >= 0 else []
        for neighbour, span in near:
            if neighbour != behind:
                reached.append((neighbour, station))
                steps.append((neighbour, station, span))
    return steps[::-1]


def _settled(trains: Tree, start: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Frequency (trains,) rad/s after Rayleigh's steps, and the sum of |torque| |angle at the parent| of its shape."""
    frequency = start.copy()
    passed = np.zeros(len(start))
    left = np.arange(len(start))
    some = trains
    for _ in range(_STEPS):
        frequencies = frequency[left]
        shapes = free_shapes(some, frequencies)
        with np.errstate(all="ignore"):
            share = shapes.correction / frequencies**2
            change = share / (1.0 + np.sqrt(1.0 + share))
        change[~(np.abs(change) <= _FARTHEST)] = 0.0
        frequency[left] = frequencies * (1.0 + change)
        passed[left] = shapes.passed
        going = np.abs(change) > _SETTLED
        if not going.any():
            break
        left = left[going]
        some = trains.columns(left)
    return frequency, np.where(np.isfinite(passed), passed, 0.0)


def enclosed(
    trains: Tree | Way,
    count: Callable[..., IntArray],
    frequency: FloatArray,
    half: FloatArray,
    mode: int | IntArray,
    widened: tuple[float, ...],
) -> tuple[FloatArray, BoolArray]:
    """Bounds (2, m) rad/s of the mode (from 0, rigid ones counted) about each `frequency` (m,), and which are proven.

    count: of some trains and w, frequencies below, with `bound` never less (1.0) or never more (-1.0). half: relative
    half width (m,), which is `widened` by each factor for those that are left.
    """
    bounds, left = np.stack([frequency] * 2), np.arange(len(frequency))
    modes = np.broadcast_to(mode, frequency.shape)
    is_proven = np.zeros(len(frequency), dtype=bool)
    for times in widened:
        some = trains if len(left) == len(frequency) else trains.columns(left)
        lower, upper = (frequency[left] * (1.0 + sign * times * half[left]) for sign in (-1, 1))
        proven = count(some, lower, bound=1.0) <= modes[left]
        proven &= count(some, upper, bound=-1.0) > modes[left]
        bounds[:, left], is_proven[left] = (lower, upper), proven
        left = left[~proven]
        if not left.size:
            break
    return bounds, is_proven
