"""Modes of a train with distributed inertia: how many its division resolves, and what they are."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.kernels.distributed.condensed_element import CondensedElements
from torsion.kernels.distributed.dense_elements import dense_modes, estimated_frequencies
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.enclosure import SHARE_OF_LIMIT, brackets
from torsion.kernels.mode_shapes import TreeModes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.reduction import rigidity
from torsion.kernels.sturm import count_below
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


def reach(tree: Tree, shafts: Shafts, highest: float = math.inf) -> Reach:
    """The elastic modes of the undamped `tree` up to `highest` (rad/s), as far as the distributed shafts resolve them.

    Linear elements have no unknowns inside, and resolve all the modes that they have.
    """
    return _reach(replace(tree, shafts=shafts), highest)


def _reach(tree: Tree, highest: float = math.inf) -> Reach:
    known = rigidity(tree.static)
    top = min(highest * ABOVE, SHARE_OF_LIMIT * _limit(tree))
    if not math.isfinite(top):
        return Reach(known.elastic, math.inf)
    return Reach(int(count_below(tree, np.array([top]))[0]) - len(known.free_roots), top)


def above_mode(tree: Tree, shafts: Shafts, count: int) -> float:
    """A frequency (rad/s) just above the elastic mode `count` (counted from 1), which lies in reach."""
    whole = replace(tree, shafts=shafts)
    rigid = len(rigidity(whole.static).free_roots)
    return float(brackets(whole, np.array([rigid + count - 1]), tolerance=JUST_ABOVE)[1][0])


def referred_modes(tree: Tree, shafts: Shafts, count: int | None) -> TreeModes:
    """The lowest `count` elastic modes on the undamped tree; None: all that the distributed shafts resolve.

    Where finite elements are too few for the counts the modes are those of the dense problem, without certificate.
    Raises SolveError where the pieces of a continuum are too long.
    """
    tree, unknowns = replace(tree, shafts=shafts), _unknowns(tree, shafts)
    if count is not None and math.isfinite(shafts.limit):
        if unknowns <= FEW_UNKNOWNS:
            return _dense_first(tree, count)
        if tree.size + shafts.size <= FEW_BARS:
            start = estimated_frequencies(tree, count)
            if len(start) == count and bool(np.all(start <= SURELY * SHARE_OF_LIMIT * shafts.limit)):
                return tree_modes(tree, count, start=start)
    known = _reach(tree)
    beyond = count is not None and count > known.count and math.isfinite(known.frequency)
    if count is not None and beyond and unknowns <= LARGEST_DENSE:
        return dense_modes(tree, count)
    return tree_modes(tree, known.count if count is None else count)


def _dense_first(tree: Tree, count: int) -> TreeModes:
    """The modes of the dense problem, from which those in reach of counts are proven."""
    found = dense_modes(tree, count)
    in_reach = len(found.frequency) == count and bool(np.all(found.frequency <= SHARE_OF_LIMIT * _limit(tree)))
    return tree_modes(tree, count, start=found.frequency) if in_reach else found


def _limit(tree: Tree) -> float:
    """Angular frequency (rad/s) from which counts would need a correction."""
    return math.inf if tree.shafts is None else tree.shafts.limit


def _unknowns(tree: Tree, shafts: Shafts) -> float:
    """Angles and unknowns inside of finite elements; infinite for a continuum."""
    return tree.size + sum(law.modes.size if isinstance(law, CondensedElements) else math.inf for law in shafts.laws)
