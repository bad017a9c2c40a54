"""Modes of a tree whose stations lie in one long row: solved as a chain, in the tree's own numbers."""

import numpy as np

from torsion.kernels.long_chain.lowest_modes import ChainMode, Progress, lowest_modes
from torsion.kernels.long_chain.row_as_chain import Reduction, reduce_row
from torsion.kernels.long_chain.twisted import are_available
from torsion.kernels.mode_shapes import Shapes, TreeModes, shape_sign
from torsion.kernels.repeated import orthogonalise
from torsion.kernels.rerooting import Rerooted, rerooted_at_end
from torsion.kernels.tree import Tree

_CLOSE = 1e-2  # relative distance of frequencies, beyond which shapes differ by themselves
_SAME = 1e-6  # inner product of two shapes, from which each is taken to hold a part of the other


def long_chain_modes(tree: Tree, count: int, *, progress: Progress | None = None) -> TreeModes | None:
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
    result = _Collected(tree, row, known, wanted)
    lowest_modes(known.chain, wanted, result.put, progress)
    modes = result.modes
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


class _Collected:
    """Room for the modes, filled one by one, so that no more than one is kept twice."""

    def __init__(self, tree: Tree, row: Rerooted, known: Reduction, wanted: int) -> None:
        self.row, self.known, self.is_in_order = row, known, row.tree is tree
        angle, torque = np.zeros((2, wanted, tree.size))
        frequency, lower, upper = np.empty((3, wanted))
        rigid = np.full((tree.size, 0 if tree.holds else 1), 1.0 / np.sqrt(row.tree.moving_inertia.sum()))
        self.modes = TreeModes(frequency, lower, upper, angle.T, torque.T, rigid.shape[1], rigid)

    def put(self, mode: int, found: ChainMode) -> None:
        """Take one mode in."""
        modes, rounding, row = self.modes, self.known.rounding, self.row
        modes.frequency[mode] = found.frequency
        modes.lower[mode], modes.upper[mode] = found.lower * (1.0 - rounding), found.upper * (1.0 + rounding)
        angle, torque = self.known.shape(found.angle, found.torque, found.frequency)
        if self.is_in_order:
            modes.angle[:, mode], modes.torque[1:, mode] = angle, torque
            return
        modes.angle[:, mode] = row.angles(angle[:, None])[:, 0]
        modes.torque[:, mode] = row.torques(np.append(0.0, torque)[:, None])[:, 0]
