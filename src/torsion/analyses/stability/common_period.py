"""The common period of joints and torques: how many harmonics it takes, and what of the file makes it too long.

A train repeats its motion when all that excites it does. Downstream of a gear of large coprime numbers of teeth that
is after many revolutions, unless all orders lie on one side of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
from math import gcd, lcm

import numpy as np

from torsion.errors import SolveError
from torsion.kernels.spanning_forest import connected
from torsion.primitives import Bar, Constraint, Spring
from torsion.train import Train


@dataclass(frozen=True)
class Source:
    """Something that repeats `order` times in a revolution of its own station."""

    name: str
    order: Fraction
    station: int
    of_reference: Fraction  # the same order per revolution of the reference station
    is_joint: bool


def common_order(orders: Sequence[Fraction]) -> Fraction:
    """Return the greatest order of which all are whole multiples; 0 of none."""
    if not orders:
        return Fraction(0)
    below = lcm(*(order.denominator for order in orders))
    return Fraction(gcd(*(int(order * below) for order in orders)), below)


def harmonics_needed(rank: int, joints: Sequence[Fraction], torques: Sequence[Fraction]) -> int:
    """Return the harmonics of the common period of joints and torques of these orders, all of one shaft.

    rank: how many multiples of a joint's own order count.
    """
    order = common_order([*joints, *torques]) or Fraction(1)
    joint = max(joints, default=order)
    torque = max(torques, default=Fraction(0))
    return max(int(rank * max(joint / order, Fraction(1))), int(torque / order) + 2)


def too_long(train: Train, rank: int, limit: int, *, vibratory: bool) -> SolveError:
    """Return why a train needs more than `most` harmonics: the two worst orders and the gear between them.

    vibratory: torques are taken along, not the joints alone.
    """
    sources = _list_sources(train, vibratory=vibratory)

    def needed(some: Sequence[Source]) -> int:
        joints = [source.of_reference for source in some if source.is_joint]
        torques = [source.of_reference for source in some if not source.is_joint]
        return harmonics_needed(rank, joints, torques)

    first, second = max(combinations(sources, 2), key=needed, default=(sources[0], sources[0]))
    period = 1 / common_order([source.of_reference for source in sources])
    length = (
        f"repeat together only every {float(period):.6g} revolutions of the reference shaft, which takes about "
        f"{needed(sources)} harmonics, and {limit} are the most"
    )
    names = (
        f"{first.name} (order {first.order} of its shaft) and {second.name} (order {second.order})"
    )
    gears = [
        mesh
        for mesh in train.constraints
        if mesh.ratio != 1
        and (first.station in (driven_side := _driven_side(train, mesh)))
        != (second.station in driven_side)
    ]
    if not gears:
        return SolveError(f"{names} {length}", "take orders with smaller whole numbers")
    gear = max(gears, key=lambda mesh: mesh.ratio.numerator * mesh.ratio.denominator)
    return SolveError(
        f"{names} lie on both sides of '{gear.name}' (teeth {gear.ratio.numerator}/{gear.ratio.denominator}) "
        f"and {length}",
        f"{'excite, and bend joints,' if vibratory else 'bend joints'} on one side of the gear only, or take numbers of "
        "teeth with a smaller common multiple",
        train.parts[gear.part].path,
    )


def _list_sources(train: Train, *, vibratory: bool) -> list[Source]:
    rows = [
        (mesh.name, Fraction(order), mesh.driving, True)
        for mesh in train.constraints
        for order, _ in mesh.error
    ]
    rows += [
        (torque.name, torque.order, torque.station, False)
        for torque in train.torques
        if torque.order is not None and vibratory
    ]
    return [
        Source(name, order, station, order * train.stations[station].ratio, is_joint)
        for name, order, station, is_joint in rows
    ]


def _driven_side(train: Train, gear: Constraint) -> set[int]:
    """Stations on the driven side of a gear of a train without closed loops."""
    links: list[Spring | Bar | Constraint] = [*train.springs, *train.bars, *train.constraints]
    ends = np.array([(link.driving, link.driven) for link in links if link is not gear], dtype=int)
    group = connected(len(train.stations), *ends.reshape(-1, 2).T)
    return set(np.flatnonzero(group == group[gear.driven]).tolist())
