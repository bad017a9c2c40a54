"""Natural frequencies and mode shapes of the undamped train."""

import math
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from torsion.assembly.folding import Folded
from torsion.assembly.system import BarSpans, System
from torsion.fields import Declared, given
from torsion.kernels.tree import BoolArray, FloatArray, IntArray, Tree

if TYPE_CHECKING:
    from torsion.kernels.bar_modes import BarModes
    from torsion.kernels.bars import Bars
    from torsion.kernels.modes import TreeModes

STANDS_STILL = 1e-12  # of the largest amplitude (referred to one speed); a smaller one is rounding and has no sign


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
    kinetic: FloatArray  # (stations, modes) share of the kinetic energy; of a distributed span half at either end
    elastic: FloatArray  # (spans, modes) share of the elastic energy
    nodes: np.ndarray  # (modes,) int: sign changes of the shape over elastic spans

    @property
    def enclosure(self) -> FloatArray:
        """(modes, 2) Hz: lower and upper bound of each frequency."""
        return np.stack([self.lower, self.upper], axis=1)


def modes(system: System, count: int | None = 6) -> Modes:
    """The lowest `count` elastic modes (None: all). Raises SolveError for a frequency that cannot be proven."""
    if system.bars is not None and system.folded_bars is not None:
        return _modes_with_bars(system, system.bars, system.folded_bars, count)
    closing = closing_spans(system)
    found = _referred_modes(system, closing, count)
    torque = span_torques(system, found.torque, closing, found.loop_torque)
    flexibility = np.where(is_elastic(system), system.flexibility, 0.0)
    return _modes(system, found, torque, _kinetic(system, found.angle), flexibility[:, None] * torque**2)


def _modes_with_bars(system: System, spans: BarSpans, bars: "Bars", count: int | None) -> Modes:
    """The modes of a train some of whose spans have distributed inertia."""
    from torsion.analyses.bars import referred_modes

    found = referred_modes(undamped_tree(system.folded), bars, count)
    kinetic = _kinetic(system, found.angle)
    for end in (0, 1):
        np.add.at(kinetic, spans.ends[:, end], found.bar_kinetic / 2.0)
    torque = bar_torques(system, found.torque, found.torque_outer)
    return _modes(system, found, torque, kinetic, found.elastic[system.folded.span])


def _referred_modes(system: System, closing: IntArray, count: int | None) -> "TreeModes":
    """The modes on the folded tree, with the spans `closing` that close its loops."""
    tree = undamped_tree(system.folded)
    if not closing.size:
        from torsion.kernels.modes import tree_modes

        return tree_modes(tree, count)
    from torsion.kernels.graph_modes import graph_modes

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
    told = np.zeros((len(system.spans), torque.shape[1]), dtype=torque.dtype)
    in_tree = np.flatnonzero(folded.span >= 0)
    told[in_tree] = torque[folded.span[in_tree]] * folded.sign[in_tree, None]
    if closing.size:
        told[closing] = closing_torque
    return np.asarray(told / system.span_ratio[:, None])


def bar_torques(system: System, torque: np.ndarray, torque_outer: np.ndarray) -> np.ndarray:
    """(spans, columns) N m at each driving station, from torques (tree stations, columns) at both ends of spans."""
    folded = system.folded
    at_driving = torque_outer.copy()
    from_parent = folded.span[folded.sign > 0]
    at_driving[from_parent] = torque[from_parent]
    none = np.empty(0, dtype=np.int64)
    return span_torques(system, at_driving, none, np.empty((0, torque.shape[1])))


def _modes(
    system: System, found: "TreeModes | BarModes", torque: FloatArray, kinetic: FloatArray, elastic: FloatArray
) -> Modes:
    """The modes at own speeds; kinetic (stations, modes) and elastic (spans, modes) energy in any units."""
    hertz = 1.0 / (2.0 * math.pi)
    return Modes(
        found.frequency * hertz, _shape(system, found.angle), torque, found.lower * hertz, found.upper * hertz,
        found.rigid, found.certified, kinetic / kinetic.sum(axis=0), elastic / elastic.sum(axis=0),
        _nodes(system, found.angle),
    )  # fmt: skip


def _shape(system: System, angle: FloatArray) -> FloatArray:
    """(stations, modes) rad at own speed."""
    return np.asarray(angle[system.folded.node] * system.speed_ratio[:, None])


def _kinetic(system: System, angle: FloatArray) -> FloatArray:
    """(stations, modes) twice the kinetic energy / w^2 of what is lumped at each station."""
    inertia = np.where(system.held, 0.0, system.lumped_inertia)
    return np.asarray(inertia[:, None] * _shape(system, angle) ** 2)


def is_elastic(system: System) -> BoolArray:
    """(spans,) spans that store energy: neither rigid nor without stiffness."""
    return np.asarray((system.flexibility > 0) & np.isfinite(system.flexibility))


def _nodes(system: System, angle: FloatArray) -> IntArray:
    """(modes,) spans over which the shape changes its sign.

    A station that stands still takes the sign of the station inward of it, so that a node at a station counts once.
    A held station has no sign: the shape starts there and does not cross it.
    """
    tree = system.folded.tree
    size = np.abs(angle)
    sign = np.where(size > STANDS_STILL * size.max(axis=0, initial=0.0), np.sign(angle), 0.0)
    sign[tree.held] = 0.0
    for station in np.flatnonzero((sign == 0.0).any(axis=1) & ~tree.held).tolist():
        inward = sign[tree.parent[station]] if tree.parent[station] >= 0 else 1.0
        sign[station] = np.where(sign[station] == 0.0, inward, sign[station])
    joined = (tree.parent >= 0) & np.isfinite(tree.flexibility)
    crosses: IntArray = np.count_nonzero((sign * sign[tree.parent] < 0.0) & joined[:, None], axis=0)
    return crosses
