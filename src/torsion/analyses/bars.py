"""Modes of a train with distributed inertia: how many its division resolves, and what they are."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.kernels.bars.counts import count_below
from torsion.kernels.bars.dense import dense_modes, estimated_frequencies
from torsion.kernels.bars.modes import BarModes, modes_of
from torsion.kernels.bars.search import SHARE_OF_LIMIT, brackets
from torsion.kernels.bars.spans import Bars, ElementBars
from torsion.kernels.bars.tree import BarTree
from torsion.kernels.tree import Tree

JUST_ABOVE = 1e-3  # relative
LARGEST_DENSE = 2000  # unknowns of finite elements that are solved at once where counts cannot reach
FEW_UNKNOWNS = 120  # that are solved at once sooner than counts find out what lies in reach (measured)
FEW_BARS = 200  # stations and bars, of which an estimate is the faster start (measured)
SURELY = 0.98  # of the reach of counts, below which an estimated frequency lies in it
ABOVE = 1.0 + 1e-9  # a mode at the highest frequency itself is one of those up to it


@dataclass(frozen=True)
class Reach:
    """The elastic modes up to a frequency."""

    count: int
    frequency: float  # rad/s


def reach(tree: Tree, bars: Bars, highest: float = math.inf) -> Reach:
    """The elastic modes of the undamped `tree` up to `highest` (rad/s), as far as the division into bars resolves them.

    Linear elements have no unknowns inside, and resolve all the modes that they have.
    """
    return _reach(BarTree(tree, bars), highest)


def _reach(train: BarTree, highest: float = math.inf) -> Reach:
    top = min(highest * ABOVE, SHARE_OF_LIMIT * train.bars.limit)
    if not math.isfinite(top):
        return Reach(train.known.elastic, math.inf)
    return Reach(int(count_below(train, np.array([top]))[0]) - len(train.known.free_roots), top)


def above_mode(tree: Tree, bars: Bars, count: int) -> float:
    """A frequency (rad/s) just above the elastic mode `count` (counted from 1), which lies in reach."""
    train = BarTree(tree, bars)
    rigid = len(train.known.free_roots)
    return float(brackets(train, np.array([rigid + count - 1]), tolerance=JUST_ABOVE)[1][0])


def referred_modes(tree: Tree, bars: Bars, count: int | None) -> BarModes:
    """The lowest `count` elastic modes on the undamped tree; None: all that the division resolves.

    Where finite elements are too few for the counts the modes are those of the dense problem, without certificate.
    Raises SolveError where the pieces of a continuum are too long.
    """
    train, unknowns = BarTree(tree, bars), _unknowns(tree, bars)
    if count is not None and math.isfinite(bars.limit):
        if unknowns <= FEW_UNKNOWNS:
            return _dense_first(train, count)
        if tree.size + bars.size <= FEW_BARS:
            start = estimated_frequencies(train, count)
            if len(start) == count and bool(np.all(start <= SURELY * SHARE_OF_LIMIT * bars.limit)):
                return modes_of(train, count, start=start)
    known = _reach(train)
    beyond = count is not None and count > known.count and math.isfinite(known.frequency)
    if count is not None and beyond and unknowns <= LARGEST_DENSE:
        return dense_modes(train, count)
    return modes_of(train, known.count if count is None else count)


def _dense_first(train: BarTree, count: int) -> BarModes:
    """The modes of the dense problem, from which those in reach of counts are proven."""
    found = dense_modes(train, count)
    top = SHARE_OF_LIMIT * train.bars.limit
    in_reach = len(found.frequency) == count and bool(np.all(found.frequency <= top))
    return modes_of(train, count, start=found.frequency) if in_reach else found


def _unknowns(tree: Tree, bars: Bars) -> float:
    """Angles and unknowns inside of finite elements; infinite for a continuum."""
    inside = [law.modes.size if isinstance(law, ElementBars) else math.inf for law in bars.laws]
    return tree.size + sum(inside)
