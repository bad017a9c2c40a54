"""Sweep of a tree from its roots: both sides of every span meet and give its angle and torque."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from torsion.kernels.sweeps import Branches, Layout, Row, Rows, branches, guarded_sum, share
from torsion.kernels.tree import FloatArray


@dataclass(frozen=True)
class Equations:
    """One linear system for every column: own angle = force + torques, angle = angle of parent - hc torque + twist."""

    own: Sequence[Row]  # N m/rad, the dynamic stiffness of each station alone
    compliance: Sequence[Row]  # hc, rad/(N m)
    force: Sequence[Any]  # N m
    twist: Sequence[Any] | None  # rad


@dataclass(frozen=True)
class Answer:
    """Where the answer goes; its rows are filled in place."""

    angle: Sequence[Row]  # rad
    torque: Sequence[Row]  # N m, of span i on station i
    amplification: FloatArray | None  # (columns,) largest (|z d| + |zd|)/|z d + zd| of any span; not asked if None


def solve(plan: Layout, given: Equations, answer: Answer, guard: bool = False) -> None:
    """Fill `answer`: angle = (f d + e)/(z d + zd), torque = (e z - f zd)/(z d + zd).

    z, f: stiffness and source of the branch of span i; zd, fd: of everything else, at the parent; d = 1 + hc zd and
    e = fd + zd twist. No angle is ever subtracted from another, so that the only cancellation is that of the physics.
    """
    found = branches(plan, given.own, given.compliance, given.force, given.twist, guard)
    stiffness: Rows = [None] * plan.size
    source: Rows = [None] * plan.size
    for station in range(plan.size):
        parent = plan.parent[station]
        if parent < 0:
            rest = _root(plan, given, found, answer, station)
        elif plan.prescribed[parent]:
            rest = _beside_prescribed(plan, given, found, answer, station)
        else:
            rest = _join(plan, given, found, answer, station, stiffness[station], source[station], guard)
            stiffness[station] = source[station] = None
        found.stiffness[station] = found.source[station] = None
        if rest is not None:
            share(plan.children[station], found.stiffness_through, stiffness, rest[0])
            share(plan.children[station], found.source_through, source, rest[1])


Rest = tuple[Row, Row] | None  # stiffness and source at a station without its branches; None where it is prescribed


def _root(plan: Layout, given: Equations, found: Branches, answer: Answer, station: int) -> Rest:
    if plan.held[station]:
        return None
    factor = np.reciprocal(found.stiffness[station])
    np.multiply(found.source[station], factor, out=answer.angle[station])
    _note(answer, found.stiffness[station], None, factor)
    return given.own[station], given.force[station]


def _join(
    plan: Layout, given: Equations, found: Branches, answer: Answer, station: int, zd: Row, fd: Row, guard: bool
) -> Rest:
    z, f = found.stiffness[station], found.source[station]
    e = fd if given.twist is None else fd + zd * given.twist[station]
    d = guarded_sum(given.compliance[station] * zd, guard)
    if plan.held[station]:
        factor = np.reciprocal(d)
        np.multiply(e, factor, out=answer.torque[station])
        _note(answer, d - 1, 1.0, factor)
        return None
    inner = z * d
    factor = np.reciprocal(inner + zd)
    _note(answer, inner, zd, factor)
    np.multiply(f * d + e, factor, out=answer.angle[station])
    np.multiply(e * z - f * zd, factor, out=answer.torque[station])
    if not plan.children[station]:
        return None
    np.reciprocal(d, out=d)
    return given.own[station] + zd * d, given.force[station] + e * d


def _beside_prescribed(plan: Layout, given: Equations, found: Branches, answer: Answer, station: int) -> Rest:
    """A span whose root end turns by a given angle; with its twist, `moved`."""
    hc, torque = given.compliance[station], answer.torque[station]
    moved = answer.angle[plan.parent[station]]
    if given.twist is not None:
        moved = moved + given.twist[station]
    if plan.held[station]:
        np.divide(moved, hc, out=torque)
        return None
    z, f = found.stiffness[station], found.source[station]
    if plan.rigid[station]:
        answer.angle[station][:] = moved
        np.subtract(moved * z, f, out=torque)
        return None
    product = hc * z
    factor = np.reciprocal(1 + product)
    _note(answer, product, 1.0, factor)
    np.multiply(moved + hc * f, factor, out=answer.angle[station])
    np.multiply(moved * z - f, factor, out=torque)
    return given.own[station] + 1 / hc, given.force[station] + moved / hc


def _note(answer: Answer, one: Row, other: Row | float | None, factor: Row) -> None:
    """Take in the loss of one sum, one + other = 1/factor."""
    if answer.amplification is not None:
        loss = np.abs(one)
        if other is not None:
            loss += np.abs(other)
        loss *= np.abs(factor)
        np.maximum(answer.amplification, loss, out=answer.amplification)
