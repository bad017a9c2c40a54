"""Which share of the load every span carries at constant speed, in exact fractions, and how far it twists there.

Everything is referred to the reference speed: a share of 1 is the whole mean torque at that speed. The sums run over
a spanning tree with exact numbers, so a span that carries nothing carries exactly nothing.
"""

from fractions import Fraction

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.spanning_forest import Walk, closing_no_loop, walk

Shares = list[Fraction]


def statics(system: System, applied: Shares, reference: int) -> tuple[FloatArray, FloatArray]:
    """Under 1 N m, of which the shares (stations,) sum to zero: torques (spans,) N m, twists (stations,) rad.

    A torque is positive from driving to driven; twists are against the reference station.
    A grounded station that neither drives nor loads takes no mean torque: it turns at the mean speed by definition.
    Raises SolveError where the mean torque has to pass a span without stiffness, or cannot reach its load.
    """
    way = _way(system, reference)
    torque = np.array([float(share) for share in _tree_torques(system, way, applied)])
    flexibility = system.flexibility / system.span_ratio**2
    finite = np.where(np.isfinite(flexibility), flexibility, 0.0)
    loops = np.setdiff1d(np.flatnonzero(np.isfinite(flexibility)), way.above)
    if loops.size:
        cycle = _cycles(system, way, loops)
        around = (cycle * finite) @ cycle.T
        torque = torque - cycle.T @ np.linalg.solve(around, cycle @ (finite * torque))
    _refuse_slipping(system, torque)
    twist = np.zeros(len(system.stations))
    for station, parent, span in _from_roots(way):
        if span >= 0:
            twist[station] = twist[parent] - _toward_leaves(system, span, station) * (finite[span] * torque[span])
    return torque, twist


def _way(system: System, reference: int) -> Walk:
    """A spanning tree from the reference station, with spans without stiffness only where nothing else leads on."""
    ends, finite = (len(system.stations), system.driving, system.driven), np.isfinite(system.flexibility)
    way = walk(*ends, finite, [reference])
    if finite.all():
        return way
    ranked = np.concatenate([way.above[way.above >= 0], np.flatnonzero(~finite)])
    return walk(*ends, closing_no_loop(*ends, ranked), [reference])


def _from_roots(way: Walk) -> list[tuple[int, int, int]]:
    """Station, parent and span between them, every station after its parent; -1 at a root."""
    return list(zip(*(each.tolist() for each in (way.order, way.parent[way.order], way.above[way.order])), strict=True))


def _toward_leaves(system: System, span: int, station: int) -> int:
    """1 where the span's driven end is `station`, else -1."""
    return 1 if system.driven[span] == station else -1


def _tree_torques(system: System, way: Walk, applied: Shares) -> Shares:
    """(spans,) share carried by each span of the tree: what is applied beyond it, with the sign of its direction."""
    beyond, shares = list(applied), [Fraction(0)] * len(system.spans)
    for station, parent, span in reversed(_from_roots(way)):
        if span >= 0:
            shares[span] = -beyond[station] * _toward_leaves(system, span, station)
            beyond[parent] += beyond[station]
        elif beyond[station] != 0:
            raise SolveError("the mean torque cannot reach the load: drive and load are not joined by any span")
    return shares


def _cycles(system: System, way: Walk, loops: IntArray) -> FloatArray:
    """(loops, spans) 1 for each span that closes a loop and +-1 for those of the tree around it: their twists are 0."""
    cycle = np.zeros((len(loops), len(system.spans)))
    for row, closing in zip(cycle, loops.tolist(), strict=True):
        row[closing] = 1.0
        for end, sense in ((int(system.driving[closing]), 1.0), (int(system.driven[closing]), -1.0)):
            station = end
            while (span := int(way.above[station])) >= 0:
                row[span] += sense * _toward_leaves(system, span, station)
                station = int(way.parent[station])
    return cycle


def _refuse_slipping(system: System, torque: FloatArray) -> None:
    """A span without stiffness carries no torque while both of its ends turn at one speed."""
    for span in np.flatnonzero(np.isinf(system.flexibility) & (torque != 0)).tolist():
        message = f"the mean torque has to pass through '{system.spans[span].name}', that has damping but no stiffness"
        raise SolveError(f"{message}; give it a stiffness")
