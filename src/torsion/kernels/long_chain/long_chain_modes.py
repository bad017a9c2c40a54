"""Modes of a tree whose stations lie in one long row: solved as a chain of positive inertias and flexibilities only.

Rigid spans merge stations, a station without inertia joins its two spans into one: sums of positive numbers. A row
fixed at both ends is solved for its torques: with J and h exchanged it is a free chain. What is inside a merged
station or span is a weighted mean of its two ends, with positive weights: no difference of angles or torques.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.long_chain.lowest_modes import are_available, lowest_modes
from torsion.kernels.long_chain.temple import Chain
from torsion.kernels.mode_shapes import Shapes, TreeModes, shape_sign
from torsion.kernels.repeated import orthogonalise
from torsion.kernels.tree import Tree, rerooted_at_end

_CLOSE = 1e-2  # relative distance of frequencies, beyond which shapes differ by themselves
_SAME = 1e-6  # inner product of two shapes, from which each is taken to hold a part of the other


def long_chain_modes(
    tree: Tree, count: int, *, progress: Callable[[int, int], None] | None = None
) -> TreeModes | None:
    """The lowest `count` elastic modes of a tree that is a row of stations, in a time that grows with both alike.

    None where it is no row, has no elastic mode, two of them are one to rounding, or this scipy lacks the routines:
    `tree_modes` then finds them otherwise. `progress` is given the number of modes done and wanted. Raises SolveError
    for frequencies out of range.
    """
    if not are_available():
        return None
    row = rerooted_at_end(tree)
    known = None if row is None or row.tree.held[1:-1].any() else reduce_row(row.tree)
    if row is None or known is None:
        return None
    wanted = min(count, len(known.chain.inertia) - int(known.chain.is_free))
    whole, (frequency, lower, upper) = np.zeros((2, wanted, tree.size)), np.empty((3, wanted))
    rigid = np.full(
        (tree.size, 0 if tree.holds else 1), 1.0 / np.sqrt(row.tree.moving_inertia.sum())
    )
    modes = TreeModes(frequency, lower, upper, whole[0].T, whole[1].T, rigid.shape[1], rigid)
    for mode, found in enumerate(lowest_modes(known.chain, wanted)):
        frequency[mode] = found.frequency
        lower[mode], upper[mode] = (
            found.lower * (1.0 - known.rounding),
            found.upper * (1.0 + known.rounding),
        )
        angle, torque = known.shape(found.angle, found.torque, found.frequency)
        torque = np.append(0.0, torque)  # of the root, which has no span
        if row.tree is not tree:
            angle, torque = row.angles(angle[:, None])[:, 0], row.torques(torque[:, None])[:, 0]
        modes.angle[:, mode], modes.torque[:, mode] = angle, torque
        if progress is not None:
            progress(mode + 1, wanted)
    if not _are_distinct(tree, modes):
        return None
    shapes = Shapes.of_springs(modes.angle, modes.torque)
    orthogonalise(tree, modes.frequency, shapes)
    shapes.scale(shape_sign(shapes.angle))
    return modes


def _are_distinct(tree: Tree, modes: TreeModes) -> bool:
    """Whether shapes of close frequencies came out as different ones."""
    for mode in np.flatnonzero(np.diff(modes.frequency) < _CLOSE * modes.frequency[1:]).tolist():
        one, other = modes.angle[:, mode], modes.angle[:, mode + 1]
        if abs(float((tree.moving_inertia * one * other).sum())) > _SAME:
            return False
    return True


@dataclass(frozen=True)
class Means:
    """Values as weighted means of two of a list each."""

    one: IntArray
    other: IntArray
    weight: FloatArray  # of the one
    rest: FloatArray  # of the other

    def of(self, values: FloatArray) -> FloatArray:
        """The means of `values`."""
        return values[self.one] * self.weight + values[self.other] * self.rest


@dataclass(frozen=True)
class Reduction:
    """The chain of a row and the way back."""

    chain: Chain  # reversed if only the first station is fixed; if both are, of torques in place of angles
    first_held: bool
    last_held: bool
    means: (
        tuple[Means, Means] | None
    )  # of the angles at ends and moving bodies, of the torques; None where all move
    merged: int  # at most so many inertias or flexibilities in one sum

    @property
    def rounding(self) -> float:
        """Relative error of a frequency that the sums may cause."""
        return (self.merged - 1) * 2.0**-53

    def shape(
        self, inner: FloatArray, passed: FloatArray, frequency: float
    ) -> tuple[FloatArray, FloatArray]:
        """Angles (stations,) and torques (spans,) along the row, of the `inner` angles (n,) and `passed` torques of the
        chain at `frequency`, rad/s, scaled to a generalised inertia of 1."""
        if self.first_held and self.last_held:
            angle, torque = -passed / frequency, inner * frequency
        elif self.first_held:
            angle, torque = inner[::-1], -passed[::-1]
        else:
            angle, torque = inner, passed
        if self.means is None:
            return angle, torque
        stations, spans = self.means
        first, last = 0.0 if self.first_held else angle[0], 0.0 if self.last_held else angle[-1]
        before, behind = [] if self.first_held else [0.0], [] if self.last_held else [0.0]
        return (
            stations.of(np.concatenate(([first], angle, [last]))),
            spans.of(np.concatenate((before, torque, behind))),
        )


def reduce_row(row: Tree) -> Reduction | None:
    """The chain of a row, a tree that is one and fixed at its ends at most; None where it has no elastic mode."""
    first_held, last_held = bool(row.held[0]), bool(row.held[-1]) and row.size > 1
    inertia_of_all, flexibility = row.moving_inertia, row.flexibility[1:]
    soft = flexibility > 0.0
    body = np.concatenate(([0], np.cumsum(soft)))
    starts = np.concatenate(([0], np.flatnonzero(soft) + 1))
    mass, spring = np.add.reduceat(inertia_of_all, starts), flexibility[soft]
    moves = mass > 0.0
    moves[0] &= not first_held
    moves[-1] &= not last_held
    heavy = np.flatnonzero(moves)
    held = first_held + last_held
    if len(heavy) == 0 or len(heavy) + (held > 0) < 2:
        return None
    near, far, inertia = heavy[0], heavy[-1], mass[heavy]
    first, last = (
        spring[:near].sum(keepdims=True)[:first_held],
        spring[far:].sum(keepdims=True)[:last_held],
    )
    between = np.concatenate((first, np.add.reduceat(spring[near:far], heavy[:-1] - near), last))
    if held == 2:
        chain = Chain(between, inertia)
    else:
        chain = (
            Chain(inertia[::-1].copy(), between[::-1].copy())
            if first_held
            else Chain(inertia, between)
        )
    is_plain = held == 0 and len(heavy) == row.size
    before = np.searchsorted(heavy, np.arange(len(mass)), side="right") - 1
    edges = np.concatenate(([0], heavy, [len(spring)]))
    return Reduction(
        chain,
        first_held,
        last_held,
        None
        if is_plain
        else (_station_means(body, before, moves, spring), _span_means(row, body, before, moves)),
        max(int(np.max(np.diff(np.append(starts, len(body))))), int(np.max(np.diff(edges)))),
    )


def _station_means(body: IntArray, before: IntArray, moves: BoolArray, spring: FloatArray) -> Means:
    """A body that does not move by itself stands between its neighbours as its distances in flexibility say.

    `before` (bodies,) counts the moving bodies up to each one, less 1.
    """
    weight, rest = np.ones(len(moves)), np.zeros(len(moves))
    rest[1:], weight[:-1] = sums_in_groups(spring, before[:-1])
    weight[moves], rest[moves] = 1.0, 0.0
    if not moves[0]:
        weight[0], rest[0] = 1.0, 0.0
    if not moves[-1]:
        weight[-1], rest[-1] = 0.0, 1.0
    whole = weight + rest
    one = before + 1
    return Means(
        one[body], np.where(moves, one, one + 1)[body], (weight / whole)[body], (rest / whole)[body]
    )


def _span_means(row: Tree, body: IntArray, before: IntArray, moves: BoolArray) -> Means:
    """A rigid span inside a moving body carries a mean of the torques at both of its ends, weighted by inertia."""
    one = before[body[:-1]] + 1
    inside = (row.flexibility[1:] == 0.0) & moves[body[:-1]]
    behind, beyond = sums_in_groups(row.moving_inertia, body)
    rest, weight = np.where(inside, behind[:-1], 1.0), np.where(inside, beyond[1:], 0.0)
    whole = weight + rest
    return Means(one - inside, one, weight / whole, rest / whole)


def sums_in_groups(terms: FloatArray, group: IntArray) -> tuple[FloatArray, FloatArray]:
    """Running sums (n,) of positive `terms` (n,) from the first and the last of every run of equal `group` (n,)."""
    before, behind, step = terms.copy(), terms.copy(), 1
    while step < len(terms) and (same := group[step:] == group[:-step]).any():
        before[step:] += np.where(same, before[:-step], 0.0)
        behind[:-step] += np.where(same, behind[step:], 0.0)
        step *= 2
    return before, behind
