"""Natural frequencies and mode shapes of the undamped train."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from torsion.analyses.shares import lumped_elastic, lumped_kinetic, nodes, shares
from torsion.assembly.folding import Folded
from torsion.assembly.system import System
from torsion.fields import Declared, given
from torsion.kernels.tree import FloatArray, IntArray, Tree

if TYPE_CHECKING:
    from torsion.kernels.mode_shapes import ShaftModes, TreeModes


class Asked(Declared):
    """Settings of `modes`."""

    count: Annotated[int, Field(ge=1, le=100_000)] = given("how many elastic modes", 6)
    damped: bool | None = given("damped frequencies and damping ratios too (default: when something damps)")


@dataclass(frozen=True)
class Modes:
    """Natural frequencies with their certificate; shapes scaled to a generalised inertia of 1 kg m2."""

    frequency: FloatArray  # (modes,) Hz, elastic modes, ascending
    shape: FloatArray  # (stations, modes) rad at own speed
    torque: FloatArray  # (spans, modes) N m at the driving station's speed, positive when the driving side pushes
    lower: FloatArray  # (modes,) Hz; counts prove that the mode lies in [lower, upper]
    upper: FloatArray  # (modes,) Hz
    rigid: int  # rigid motions, frequency exactly 0
    certified: bool
    system: System = field(repr=False)
    distributed: "ShaftModes | None" = field(default=None, repr=False)  # of a train with distributed inertia

    @cached_property
    def kinetic(self) -> FloatArray:
        """(stations, modes) share of the kinetic energy; of a distributed span half at either end."""
        energy = lumped_kinetic(self.system, self.shape)
        if self.distributed is not None and self.system.bars is not None:
            for end in (0, 1):
                np.add.at(energy, self.system.bars.ends[:, end], self.distributed.shaft_kinetic / 2.0)
        return shares(energy)

    @cached_property
    def elastic(self) -> FloatArray:
        """(spans, modes) share of the elastic energy."""
        if self.distributed is not None:
            return shares(self.distributed.elastic[self.system.folded.span])
        return shares(lumped_elastic(self.system, self.torque))

    @cached_property
    def nodes(self) -> IntArray:
        """(modes,) sign changes of the shape over elastic spans."""
        return nodes(self.system, self.shape)

    @property
    def enclosure(self) -> FloatArray:
        """(modes, 2) Hz: lower and upper bound of each frequency."""
        return np.stack([self.lower, self.upper], axis=1)


def modes(system: System, count: int | None = 6, *, progress: Callable[[int, int], None] | None = None) -> Modes:
    """The lowest `count` elastic modes (None: all). Raises SolveError for a frequency that cannot be proven.

    progress: told how many of how many modes are done, where they are found one by one (few of a long row of stations).
    """
    if system.bars is not None and system.folded_bars is not None:
        from torsion.analyses.bars import referred_modes

        found = referred_modes(undamped_tree(system.folded), system.folded_bars, count)
        outer = found.torque if found.shafts is None else found.shafts.torque_outer
        return _modes(system, found, bar_torques(system, found.torque, outer))
    closing = closing_spans(system)
    found = _referred_modes(system, closing, count, progress)
    return _modes(system, found, span_torques(system, found.torque, closing, found.loop_torque))


def _referred_modes(
    system: System, closing: IntArray, count: int | None, progress: Callable[[int, int], None] | None
) -> "TreeModes":
    """The modes on the folded tree, with the spans `closing` that close its loops."""
    tree = undamped_tree(system.folded)
    if not closing.size:
        from torsion.kernels.natural_modes import tree_modes

        return tree_modes(tree, count, progress=progress)
    from torsion.kernels.loops.looped_modes import graph_modes

    node = system.folded.node
    flexibility = (system.flexibility / system.span_ratio**2)[closing]
    return graph_modes(tree, node[system.driving[closing]], node[system.driven[closing]], flexibility, count)


def undamped_tree(folded: Folded) -> Tree:
    """The tree without the spans that have damping but no stiffness, which hold nothing without damping."""
    tree = folded.tree
    slips = np.isinf(tree.flexibility)
    if not slips.any():
        return tree
    return replace(tree, parent=np.where(slips, -1, tree.parent), flexibility=np.where(slips, 0.0, tree.flexibility))


def closing_spans(system: System) -> IntArray:
    """(closing,) spans with a stiffness that close loops or lie beside another span."""
    extra = system.folded.extra
    return extra[np.isfinite(system.flexibility[extra])]


def span_torques(system: System, torque: np.ndarray, closing: IntArray, closing_torque: np.ndarray) -> np.ndarray:
    """(spans, columns) N m at each driving station's speed, from torques (tree stations, columns) on the tree.

    closing_torque: (closing, columns) N m at one speed, positive when the driving side pushes.
    """
    folded = system.folded
    told = _rows(torque, folded.span)
    scale = folded.sign * system.span_ratio
    if folded.extra.size:
        told = told.copy()
        told[folded.extra] = 0.0
        told[closing] = closing_torque * folded.sign[closing, None]
    return told if (scale == 1.0).all() else np.asarray(told / scale[:, None])


def bar_torques(system: System, torque: np.ndarray, torque_outer: np.ndarray) -> np.ndarray:
    """(spans, columns) N m at each driving station, from torques (tree stations, columns) at both ends of spans."""
    folded = system.folded
    at_driving = torque_outer.copy()
    from_parent = folded.span[folded.sign > 0]
    at_driving[from_parent] = torque[from_parent]
    none = np.empty(0, dtype=np.int64)
    return span_torques(system, at_driving, none, np.empty((0, torque.shape[1])))


def _modes(system: System, found: "TreeModes", torque: FloatArray) -> Modes:
    """The modes at own speeds."""
    hertz, ratio = 1.0 / (2.0 * math.pi), system.speed_ratio
    angle = _rows(found.angle, system.folded.node)
    shape = angle if (ratio == 1.0).all() else np.asarray(angle * ratio[:, None])
    return Modes(
        found.frequency * hertz, shape, torque, found.lower * hertz, found.upper * hertz, found.rigid, found.certified,
        system, found.shafts,
    )  # fmt: skip


def _rows(values: np.ndarray, at: IntArray) -> np.ndarray:
    """values[at], with the memory laid out as that of `values`; they themselves where `at` counts up by one."""
    if at.size and at[0] >= 0 and np.array_equal(at, np.arange(at[0], at[0] + at.size)):
        return values[int(at[0]) : int(at[0]) + at.size]
    return values[at] if values.flags.c_contiguous else np.take(values.T, at, axis=1).T
