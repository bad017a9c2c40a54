"""The common period of joints and torques: how many harmonics it takes, and what of the file makes it too long.

A train repeats its motion when all that excites it does. Downstream of a gear of large coprime numbers of teeth that
is after many revolutions, unless all orders lie on one side of it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations

import numpy as np

from torsion.analyses.response.synthesis import common_order
from torsion.errors import SolveError
from torsion.kernels.trees.tree import connected
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


def harmonics_needed(rank: int, joints: Sequence[Fraction], torques: Sequence[Fraction]) -> int:
    """Return the harmonics of the common period of joints and torques of these orders, all of one shaft.

    rank: how many multiples of a joint's own order count.
    """
    order = common_order([*joints, *torques]) or Fraction(1)
    joint = max(joints, default=order)
    torque = max(torques, default=Fraction(0))
    return max(int(rank * max(joint / order, Fraction(1))), int(torque / order) + 2)


def period_too_long(train: Train, rank: int, limit: int, *, vibratory: bool) -> SolveError:
    """Return why a train needs more than `limit` harmonics: the two worst orders and the gear between them.

    vibratory: torques are taken along, not the joints alone.
    """
    ratio = [station.ratio for station in train.stations]
    sources = [
        Source(mesh.name, Fraction(order), mesh.driving, order * ratio[mesh.driving], True)
        for mesh in train.constraints
        for order, _ in mesh.error
    ]
    sources += [
        Source(torque.name, torque.order, station, torque.order * ratio[station], False)
        for torque in train.torques
        for station in [torque.station]
        if torque.order is not None and vibratory
    ]

    def needed(some: Sequence[Source]) -> int:
        joints = [source.of_reference for source in some if source.is_joint]
        torques = [source.of_reference for source in some if not source.is_joint]
        return harmonics_needed(rank, joints, torques)

    first, second = max(combinations(sources, 2), key=needed, default=(sources[0], sources[0]))
    # The gears on different sides of which the worst two lie, in a train without closed loops.
    gears = []
    links: list[Spring | Bar | Constraint] = [*train.springs, *train.bars, *train.constraints]
    for mesh in train.constraints:
        ends = np.array([(link.driving, link.driven) for link in links if link is not mesh], int)
        group = connected(len(ratio), *ends.reshape(-1, 2).T)
        is_driven = group == group[mesh.driven]
        if mesh.ratio != 1 and is_driven[first.station] != is_driven[second.station]:
            gears.append(mesh)
    period = 1 / common_order([source.of_reference for source in sources])
    length = (
        f"repeat together only every {float(period):.6g} revolutions of the reference shaft, which takes about "
        f"{needed(sources)} harmonics, and {limit} are the most"
    )
    names = (
        f"{first.name} (order {first.order} of its shaft) and {second.name} (order {second.order})"
    )
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
