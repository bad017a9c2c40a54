"""The common period of joints and torques: how many harmonics it takes, and what of the file makes it too long.

A train repeats its motion when all that excites it does. Behind a gear of large coprime numbers of teeth that is after
many revolutions, unless all orders lie on one side of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import numpy as np

from torsion.analyses.stability.mechanism import common_order
from torsion.errors import SolveError
from torsion.kernels.spanning_forest import connected
from torsion.primitives import Bar, Constraint, Spring
from torsion.train import Train

NEAR = 0.02  # relative: a ratio farther from the file's own is another gear and no remedy
QUICK = 120  # harmonics that are solved in about a minute; a ratio with more is offered where none near has fewer


@dataclass(frozen=True)
class Source:
    """Something that repeats `order` times in a revolution of its own station."""

    name: str
    order: Fraction
    station: int
    is_joint: bool


def harmonics_needed(rank: int, joints: Sequence[Fraction], torques: Sequence[Fraction]) -> int:
    """Harmonics of the common period of joints and torques of these orders, all of one shaft.

    rank: how many multiples of a joint's own order count.
    """
    order = common_order([*joints, *torques]) or Fraction(1)
    joint, torque = max(joints, default=order), max(torques, default=Fraction(0))
    return max(int(rank * max(joint / order, Fraction(1))), int(torque / order) + 2)


def too_long(train: Train, rank: int, most: int, *, vibratory: bool) -> SolveError:
    """Why a train needs more than `most` harmonics, with the gear and the orders, and the teeth that would do.

    vibratory: torques are taken along, not the joints alone.
    """
    sources = _sources(train, vibratory=vibratory)
    ratios = [station.ratio for station in train.stations]
    needed = _needed(sources, ratios, rank)
    period = 1 / common_order([one.order * ratios[one.station] for one in sources])
    length = f"repeat together only every {float(period):.6g} revolutions of the reference shaft, which takes about "
    length += f"{needed} harmonics, and {most} are the most"
    first, second = max(
        combinations(sources, 2),
        key=lambda pair: _needed(pair, ratios, rank),
        default=(sources[0], sources[0]),
    )
    names = (
        f"{first.name} (order {first.order} of its shaft) and {second.name} (order {second.order})"
    )
    between = [
        mesh
        for mesh in train.constraints
        if mesh.ratio != 1
        and (first.station in (far := _beyond(train, mesh))) != (second.station in far)
    ]
    if not between:
        return SolveError(f"{names} {length}", "take orders with smaller whole numbers")
    offered = [
        (near, mesh)
        for mesh in between
        if (near := _nearest(train, mesh, sources, rank, most)) is not None
    ]
    worst = max(between, key=lambda one: one.ratio.numerator * one.ratio.denominator)
    near, mesh = min(offered, key=lambda one: abs(one[0] / one[1].ratio - 1), default=(None, worst))
    teeth = f"{mesh.ratio.numerator}/{mesh.ratio.denominator}"
    message = f"{names} lie on both sides of '{mesh.name}' (teeth {teeth}) and {length}"
    remedy = (
        f"{'excite, and bend joints,' if vibratory else 'bend joints'} on one side of the gear only"
    )
    if near is not None:
        off = 100.0 * abs(float(near / mesh.ratio) - 1.0)
        remedy = f"take `teeth: [{near.numerator}, {near.denominator}]` for it, {off:.2g} % off, or {remedy}"
    return SolveError(message, remedy, train.parts[mesh.part].path)


def _sources(train: Train, *, vibratory: bool) -> list[Source]:
    joints = [
        Source(mesh.name, Fraction(order), mesh.driving, True)
        for mesh in train.constraints
        for order, _ in mesh.error
    ]
    torques = [
        Source(one.name, one.order, one.station, False)
        for one in train.torques
        if one.order is not None and vibratory
    ]
    return [*joints, *torques]


def _needed(sources: Sequence[Source], ratios: Sequence[Fraction], rank: int) -> int:
    orders = [(one.order * ratios[one.station], one.is_joint) for one in sources]
    joints, torques = (
        [order for order, is_joint in orders if is_joint is kind] for kind in (True, False)
    )
    return harmonics_needed(rank, joints, torques)


def _beyond(train: Train, mesh: Constraint) -> set[int]:
    """Stations on the driven side of a gear of a train without closed loops."""
    pieces: list[Spring | Bar | Constraint] = [*train.springs, *train.bars, *train.constraints]
    ends = np.array(
        [(one.driving, one.driven) for one in pieces if one is not mesh], dtype=int
    ).reshape(-1, 2)
    group = connected(len(train.stations), *ends.T)
    return set(np.flatnonzero(group == group[mesh.driven]).tolist())


def _nearest(
    train: Train, mesh: Constraint, sources: list[Source], rank: int, most: int
) -> Fraction | None:
    """The ratio nearest to a gear's own with which `most` harmonics are enough; None where there is none near."""
    beyond, ratios = _beyond(train, mesh), [station.ratio for station in train.stations]

    def needed(ratio: Fraction) -> int:
        there = [one * ratio / mesh.ratio if k in beyond else one for k, one in enumerate(ratios)]
        return _needed(sources, there, rank)

    every = {Fraction(round(mesh.ratio * teeth), teeth) for teeth in range(1, most + 1)}
    close = {
        one: number
        for one in every
        if abs(one / mesh.ratio - 1) <= NEAR and (number := needed(one)) <= most
    }
    return min(close, key=lambda one: (close[one] > QUICK, abs(one / mesh.ratio - 1)), default=None)
