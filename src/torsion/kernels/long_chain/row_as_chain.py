"""A row of stations as a chain of positive inertias and flexibilities only, and the shapes of the row from those of it.

Rigid spans merge stations, a station without inertia joins its two spans into one: sums of positive numbers. A row
fixed at both ends is solved for its torques: with J and h exchanged it is a free chain. What is inside a merged
station or span is a weighted mean of its two ends, with positive weights: no difference of angles or torques.
"""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.kernels.long_chain.temple import Chain
from torsion.kernels.tree import Tree


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

    chain: Chain
    is_dual: bool  # torques and angles have changed places
    is_reversed: bool
    first_held: bool
    last_held: bool
    stations: Means | None  # of the angles at the ends and the moving bodies; None where they are the bodies
    spans: Means | None  # of the torques at the ends and between the bodies
    merged: int  # at most so many inertias or flexibilities in one sum

    @property
    def rounding(self) -> float:
        """Relative error of a frequency that the sums may cause."""
        return (self.merged - 1) * 2.0**-53

    def shape(self, inner: FloatArray, passed: FloatArray, frequency: float) -> tuple[FloatArray, FloatArray]:
        """Angles (stations,) and torques (spans,) along the row, of the `inner` angles (n,) and `passed` torques of the
        chain at `frequency`, rad/s, scaled to a generalised inertia of 1."""
        if self.is_dual:
            angle, torque = -passed / frequency, inner * frequency
        elif self.is_reversed:
            angle, torque = inner[::-1], -passed[::-1]
        else:
            angle, torque = inner, passed
        if self.stations is None or self.spans is None:
            return angle, torque
        first = 0.0 if self.first_held else angle[0]
        last = 0.0 if self.last_held else angle[-1]
        ends = ([] if self.first_held else [0.0], [] if self.last_held else [0.0])
        return (
            self.stations.of(np.concatenate(([first], angle, [last]))),
            self.spans.of(np.concatenate((ends[0], torque, ends[1]))),
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
    near, far = heavy[0], heavy[-1]
    between = np.add.reduceat(spring[near:far], heavy[:-1] - near) if far > near else np.empty(0)
    first, last = spring[:near].sum(keepdims=True), spring[far:].sum(keepdims=True)
    inertia = mass[heavy]
    if held == 2:
        chain = Chain(np.concatenate((first, between, last)), inertia)
    elif first_held:
        chain = Chain(inertia[::-1].copy(), np.concatenate((first, between))[::-1].copy())
    else:
        chain = Chain(inertia, np.concatenate((between, last)) if last_held else between)
    is_plain = held == 0 and len(heavy) == row.size
    before = np.searchsorted(heavy, np.arange(len(mass)), side="right") - 1
    edges = np.concatenate(([0], heavy, [len(spring)]))
    return Reduction(
        chain, held == 2, first_held and held == 1, first_held, last_held,
        None if is_plain else _station_means(body, before, moves, spring),
        None if is_plain else _span_means(row, body, before, moves),
        max(int(np.max(np.diff(np.append(starts, len(body))))), int(np.max(np.diff(edges)))),
    )  # fmt: skip


def _station_means(body: IntArray, before: IntArray, moves: BoolArray, spring: FloatArray) -> Means:
    """A body that does not move by itself stands between its neighbours as its distances in flexibility say.

    `before` (bodies,) counts the moving bodies up to each one, less 1.
    """
    span_group = before[:-1]
    weight, rest = np.ones(len(moves)), np.zeros(len(moves))
    rest[1:] = running_sum_in_groups(spring, span_group)
    weight[:-1] = running_sum_in_groups(spring[::-1], span_group[::-1])[::-1]
    weight[moves], rest[moves] = 1.0, 0.0
    if not moves[0]:
        weight[0], rest[0] = 1.0, 0.0
    if not moves[-1]:
        weight[-1], rest[-1] = 0.0, 1.0
    whole = weight + rest
    one = before + 1
    return Means(one[body], np.where(moves, one, one + 1)[body], (weight / whole)[body], (rest / whole)[body])


def _span_means(row: Tree, body: IntArray, before: IntArray, moves: BoolArray) -> Means:
    """A rigid span inside a moving body carries a mean of the torques at both of its ends, weighted by inertia."""
    one = before[body[:-1]] + 1
    inside = (row.flexibility[1:] == 0.0) & moves[body[:-1]]
    behind = running_sum_in_groups(row.moving_inertia, body)[:-1]
    beyond = running_sum_in_groups(row.moving_inertia[::-1], body[::-1])[::-1][1:]
    rest = np.where(inside, behind, 1.0)
    weight = np.where(inside, beyond, 0.0)
    whole = weight + rest
    return Means(one - inside, one, weight / whole, rest / whole)


def running_sum_in_groups(terms: FloatArray, group: IntArray) -> FloatArray:
    """Running sums (n,) of positive `terms` (n,) that begin anew with every run of equal `group` (n,)."""
    total, step = terms.copy(), 1
    while step < len(terms):
        same = group[step:] == group[:-step]
        if not same.any():
            break
        total[step:] += np.where(same, total[:-step], 0.0)
        step *= 2
    return total
