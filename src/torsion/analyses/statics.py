"""Which share of the load every span carries at constant speed, in exact fractions, and how far it twists there.

Everything is referred to the reference speed: a share of 1 is the whole mean torque at that speed. The sums run over
a spanning tree with exact numbers, so a span that carries nothing carries exactly nothing.
"""

from collections import deque
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError

Shares = list[Fraction]


@dataclass(frozen=True)
class Statics:
    """The train under a mean torque of 1 N m at reference speed."""

    torque: FloatArray  # (spans,) N m at reference speed, positive from driving to driven
    twist: FloatArray  # (stations,) rad at reference speed, against the reference station


@dataclass(frozen=True)
class _Walk:
    """A spanning tree of stations and spans, rooted at the reference station."""

    order: list[int]  # stations, every one after its parent
    span: list[int]  # (stations,) the span towards the parent, -1 at a start
    parent: list[int]  # (stations,)
    extra: list[int]  # spans that close loops


def statics(system: System, applied: Shares, reference: int) -> Statics:
    """Torques and twists under shares (stations,) of the mean torque that sum to zero.

    A grounded station that neither drives nor loads takes no mean torque: it turns at the mean speed by definition.
    Raises SolveError where the mean torque has to pass a span without stiffness, or cannot reach its load.
    """
    walk = _walk(system, reference)
    shares = _tree_torques(system, walk, applied)
    torque = np.array([float(share) for share in shares])
    flexibility = system.flexibility / system.span_ratio**2
    loops = [span for span in walk.extra if np.isfinite(flexibility[span])]
    if loops:
        torque = _with_loops(system, walk, loops, torque, flexibility)
    _refuse_slipping(system, torque)
    twist = np.zeros(len(system.stations))
    for station in walk.order:
        span = walk.span[station]
        if span >= 0:
            turned = flexibility[span] * torque[span] if np.isfinite(flexibility[span]) else 0.0
            twist[station] = twist[walk.parent[station]] - _toward_leaves(system, span, station) * turned
    return Statics(torque, twist)


def _toward_leaves(system: System, span: int, station: int) -> int:
    """1 where the span's driven end is `station`, else -1."""
    return 1 if system.spans[span].driven == station else -1


def _walk(system: System, reference: int) -> _Walk:
    """Breadth first; spans without stiffness only where nothing else leads on."""
    number = len(system.stations)
    span, parent, seen = [-1] * number, [-1] * number, [False] * number
    near = _neighbours(system, np.isfinite(system.flexibility))
    slipping = _neighbours(system, ~np.isfinite(system.flexibility))
    order: list[int] = []
    used: set[int] = set()
    starts = deque([reference, *range(number)])
    while starts:
        start = starts.popleft()
        if seen[start]:
            continue
        seen[start] = True
        queue, later = deque([start]), deque[tuple[int, int, int]]()
        while queue or later:
            if queue:
                here = queue.popleft()
                order.append(here)
                found = [(here, there, by) for there, by in near[here]]
                later.extend((here, there, by) for there, by in slipping[here])
            else:
                found = [later.popleft()]
            for here, there, by in found:
                if not seen[there]:
                    seen[there], parent[there], span[there] = True, here, by
                    used.add(by)
                    queue.append(there)
    return _Walk(order, span, parent, [s for s in range(len(system.spans)) if s not in used])


def _neighbours(system: System, chosen: BoolArray) -> list[list[tuple[int, int]]]:
    """(station, span) on the other end of every chosen span, for each station."""
    near: list[list[tuple[int, int]]] = [[] for _ in system.stations]
    for number in np.flatnonzero(chosen).tolist():
        span = system.spans[number]
        near[span.driving].append((span.driven, number))
        near[span.driven].append((span.driving, number))
    return near


def _tree_torques(system: System, walk: _Walk, applied: Shares) -> Shares:
    """(spans,) share carried by each span of the tree: what is applied beyond it, with the sign of its direction."""
    beyond, shares = list(applied), [Fraction(0)] * len(system.spans)
    for station in reversed(walk.order):
        span = walk.span[station]
        if span >= 0:
            shares[span] = -beyond[station] * _toward_leaves(system, span, station)
            beyond[walk.parent[station]] += beyond[station]
        elif beyond[station] != 0:
            raise SolveError("the mean torque cannot reach the load: drive and load are not joined by any span")
    return shares


def _with_loops(
    system: System, walk: _Walk, loops: list[int], torque: FloatArray, flexibility: FloatArray
) -> FloatArray:
    """Torques shared between the ways around each loop so that the twists around it sum to zero."""
    cycle = np.zeros((len(loops), len(system.spans)))
    for row, span in enumerate(loops):
        cycle[row, span] = 1.0
        for end, way in ((system.spans[span].driving, -1.0), (system.spans[span].driven, 1.0)):
            station = end
            while walk.span[station] >= 0:
                by = walk.span[station]
                cycle[row, by] -= way * _toward_leaves(system, by, station)
                station = walk.parent[station]
    finite = np.where(np.isfinite(flexibility), flexibility, 0.0)
    around = (cycle * finite) @ cycle.T
    return np.asarray(torque - cycle.T @ np.linalg.solve(around, cycle @ (finite * torque)))


def _refuse_slipping(system: System, torque: FloatArray) -> None:
    """A span without stiffness carries no torque while both of its ends turn at one speed."""
    for span in np.flatnonzero(np.isinf(system.flexibility) & (torque != 0)).tolist():
        message = f"the mean torque has to pass through '{system.spans[span].name}', that has damping but no stiffness"
        raise SolveError(f"{message}; give it a stiffness")
