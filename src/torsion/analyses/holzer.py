"""The Holzer table of a mode, taken from the mode itself: station by station, all referred to the reference speed."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.mode_nodes import TINY
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.kernels.tree import Tree


@dataclass(frozen=True)
class HolzerTable:
    """One mode, row by row from the root of the tree toward its leaves.

    A row is a station and the span that leads to it from a row above: angle = angle of that row - twist (+ what a
    rigid span does not twist), and the torque of the span is what all stations on the side of the root exert on it.
    """

    frequency: float  # Hz
    station: IntArray  # (rows,) position of the station in the system
    before: IntArray  # (rows,) row from which the span leads here, -1 at a start
    span: IntArray  # (rows,) position of that span in the system, -1 at a start
    inertia: FloatArray  # (rows,) kg m2 at own speed; infinite where grounded
    referred_inertia: FloatArray  # (rows,) kg m2
    angle: FloatArray  # (rows,) at reference speed; the first row is 1, or the largest where the first stands still
    inertia_torque: FloatArray  # (rows,) N m per radian of the scale: omega^2 J angle
    torque: FloatArray  # (rows,) N m that twists the span, positive toward the leaves
    flexibility: FloatArray  # (rows,) rad/(N m) of the span, referred
    twist: FloatArray  # (rows,) rad: flexibility * torque


def holzer(system: System, modes: Modes, mode: int) -> HolzerTable:
    """The table of one mode (counted from 0) of a train without loops; spans that close loops have no row.

    Nothing is summed up along the train, as Holzer's own recurrence does, so no error grows along it. A piece of a
    shaft with distributed inertia stands in it as what it is at the frequency of the mode: a spring between two
    inertias at its ends (of the exact model h = L/(G I) sin(mu)/mu, J = rho I L/2 tan(mu/2)/(mu/2), mu = omega L/c).
    """
    condensed = system.condensed
    nodes = _from_root(condensed.tree)
    place = np.full(condensed.tree.size, -1, dtype=np.int64)
    place[nodes] = np.arange(len(nodes))
    span, station = _spans_and_stations(system)
    keep = condensed.tree.parent >= 0
    keep[condensed.tree.parent[keep]] = True
    keep |= len(nodes) == 1
    rows = nodes[keep[nodes]]
    place = np.cumsum(keep[nodes])[place] - 1
    ratio = system.speed_ratio[station]
    angle = np.where(condensed.is_held_copy, 0.0, modes.shape[station, mode] / ratio)
    scale = float(angle[rows][np.argmax(np.abs(angle[rows]))])  # the largest where the first stands still
    if abs(angle[rows][0]) > TINY * abs(scale):
        scale = float(angle[rows][0])
    omega = 2.0 * math.pi * modes.frequency[mode]
    torque = np.zeros(condensed.tree.size)
    has = span >= 0
    torque[has] = (modes.torque[:, mode] * system.span_ratio)[span[has]] * condensed.sign[span[has]]
    tree = replace(condensed.tree, shafts=system.condensed_shafts)
    flexibility, inertia = (values[:, 0] for values in tree.at(np.array([omega**2])))
    if system.condensed_shafts is not None:
        node = system.condensed_shafts.node
        torque[node] = (angle[condensed.tree.parent] - angle)[node] / flexibility[node]
    own = np.where(condensed.tree.held, np.inf, inertia / ratio**2)
    moving = np.where(condensed.tree.held, 0.0, inertia)
    twist = np.where(np.isfinite(flexibility), flexibility, 0.0) * torque
    before = np.where(condensed.tree.parent >= 0, place[condensed.tree.parent], -1)
    return HolzerTable(
        float(modes.frequency[mode]), station[rows], before[rows], span[rows], own[rows], inertia[rows],
        (angle / scale)[rows], (omega**2 * moving * angle / scale)[rows], (torque / scale)[rows],
        flexibility[rows], (twist / scale)[rows],
    )  # fmt: skip


def _from_root(tree: Tree) -> IntArray:
    """Tree stations, each branch to its end before the next."""
    order: list[int] = []
    for root in tree.roots:
        stack = [root]
        while stack:
            here = stack.pop()
            order.append(here)
            stack.extend(reversed(tree.children[here]))
    return np.array(order, dtype=np.int64)


def _spans_and_stations(system: System) -> tuple[IntArray, IntArray]:
    """(tree stations,) the system's span that leads to each (-1 at a root) and its station."""
    condensed = system.condensed
    span = np.full(condensed.tree.size, -1, dtype=np.int64)
    station = np.zeros(condensed.tree.size, dtype=np.int64)
    in_tree = np.flatnonzero(condensed.span >= 0)
    span[condensed.span[in_tree]] = in_tree
    station[condensed.node] = np.arange(len(system.stations))
    for copy in np.flatnonzero(condensed.is_held_copy).tolist():
        by = int(span[copy])
        station[copy] = system.driven[by] if condensed.sign[by] > 0 else system.driving[by]
    return span, station
