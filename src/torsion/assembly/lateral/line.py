"""The shafts of a train that bend: each from joint to joint or end, with its supports, by the train's own data."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

from torsion.assembly.lateral.lacking import missing, supports_of
from torsion.assembly.lateral.shaft import Beam, Point, Segment
from torsion.components.support import fits
from torsion.errors import Fault, Path
from torsion.primitives import Bar
from torsion.train import Train

Placing = tuple[int, Literal["driving", "driven"], int]  # part of a joint, which of its shafts, where on this one


@dataclass(frozen=True, slots=True)
class JointAt:
    """A joint at an end of a shaft."""

    part: int  # of the joint
    point: int  # of the beam
    shaft: Literal["driving", "driven"]  # which of the joint's two shafts this one is


@dataclass(frozen=True)
class BendingShaft:
    """Shafts in a row without joint, gear or elastic coupling between them; it bends as one."""

    name: str
    parts: tuple[int, ...]  # its shafts, in the direction of power flow
    ratio: Fraction  # its speed / reference speed
    beam: Beam
    joints: tuple[JointAt, ...]  # before it, then behind it
    loads: tuple[str, ...]  # components that stand on it, whose mass the file does not say
    lacks: str = ""  # why its bending is not computed; empty where it is
    place: Path = ()  # of the key in the file that this is about; empty where it is about none


def bending_shafts(train: Train) -> tuple[tuple[BendingShaft, ...], list[Fault]]:
    """Every shaft line of a train, and the faults of their data.

    Joints hold both their shafts in place and let them tilt; everything else but a `support` leaves them free.
    """
    node = _nodes(train)
    faults: list[Fault] = []
    found = [_shaft(train, row, node, faults) for row in _rows(train.bars, node)]
    return tuple(found), faults


def _nodes(train: Train) -> list[int]:
    """(stations,) the first station that each one is rigidly joined to."""
    node = list(range(len(train.stations)))

    def root(station: int) -> int:
        while node[station] != station:
            station = node[station]
        return station

    for spring in train.springs:
        if spring.flexibility == 0:
            one, other = sorted((root(spring.driving), root(spring.driven)))
            node[other] = one
    return [root(station) for station in range(len(node))]


def _rows(bars: Sequence[Bar], node: list[int]) -> list[list[Bar]]:
    """Distributed shafts that touch each other; in a row each starts where the one before it ends."""
    rows: list[list[Bar]] = []
    for bar in bars:
        ends = {node[bar.driving], node[bar.driven]}
        near = [row for row in rows if ends & {node[s] for each in row for s in (each.driving, each.driven)}]
        joined = [each for row in near for each in row] + [bar]
        rows = [row for row in rows if row not in near] + [joined]
    return rows


def _shaft(train: Train, row: list[Bar], node: list[int], faults: list[Fault]) -> BendingShaft:
    names = ", ".join(bar.name for bar in row)
    parts = tuple(bar.part for bar in row)
    stations = [node[row[0].driving], *(node[bar.driven] for bar in row)]
    straight = all(node[bar.driving] == at for bar, at in zip(row, stations, strict=False))
    if not straight or len(set(stations)) < len(stations):
        return BendingShaft(names, parts, train.stations[row[0].driving].ratio, Beam(()), (), (), "it branches")
    before, of_material = len(faults), list[Fault]()
    lacks: str = ""
    place: Path = ()
    joints = _joints(train, node, stations)
    if any(at not in (0, len(row)) for _, _, at in joints):
        lacks = "a joint stands between its ends"
    segments = [_segment(train, bar, of_material) for bar in row]
    points, held = _points(train, row, joints)
    points += _supports(train, row, bool(joints) and joints[0][2] > 0, faults)
    beam = Beam(tuple(segments), tuple(points), names)
    if not lacks and len(faults) == before:
        lacks, place = missing(train, row, beam)
    faults += [] if lacks else of_material
    at = tuple(JointAt(part, held[k], side) for k, (part, side, _) in enumerate(joints))
    ratio = train.stations[row[0].driving].ratio
    return BendingShaft(names, parts, ratio, beam, at, _loads(train, node, stations, parts), lacks, place)


def _joints(train: Train, node: list[int], stations: list[int]) -> list[Placing]:
    """The joints on a shaft by their position among its stations."""
    found: list[Placing] = []
    for mesh in train.constraints:
        if train.parts[mesh.part].joint is None:
            continue
        if node[mesh.driven] in stations:
            found.append((mesh.part, "driven", stations.index(node[mesh.driven])))
        if node[mesh.driving] in stations:
            found.append((mesh.part, "driving", stations.index(node[mesh.driving])))
    return sorted(found, key=lambda joint: joint[2])


def _segment(train: Train, bar: Bar, faults: list[Fault]) -> Segment:
    part, name = train.parts[bar.part], train.shaft(bar).material
    modulus = train.materials[name].youngs_modulus
    if modulus is None:
        hint = f"write it under materials: {name}"
        faults.append(Fault((*part.path, "material"), f"bending needs the `youngs_modulus` of '{name}'", hint))
    return Segment(bar.length, bar.outer, bar.bore, modulus or 1.0, bar.density, bar.shear_modulus, bar.loss_factor)


def _points(train: Train, row: list[Bar], joints: list[Placing]) -> tuple[list[Point], list[int]]:
    """Pinned points of the joints, one for all that share a place, and which of them each joint has."""
    points: list[Point] = []
    at: dict[int, int] = {}
    for part, _, place in joints:
        if place not in at:
            at[place] = len(points)
            points.append(Point(sum(bar.length for bar in row[:place]), train.parts[part].name, held="pinned"))
    return points, [at[place] for _, _, place in joints]


def _supports(train: Train, row: list[Bar], is_from_behind: bool, faults: list[Fault]) -> list[Point]:
    """The supports of every shaft, counted from its end that faces the joint."""
    points = []
    begin = 0.0
    for bar in row:
        part, every = train.parts[bar.part], supports_of(train, bar)
        for number, (support, path) in enumerate(every):
            if not fits(support, bar.length):
                message = f"the support stands {support.at:g} m along a shaft of {bar.length:g} m"
                faults.append(Fault((*path, "at"), message, "at most the length of the shaft"))
                continue
            place = bar.length - support.at if is_from_behind else support.at
            name = part.name if len(every) == 1 else f"{part.name} {number + 1}"
            points.append(
                Point(
                    begin + place, f"support of {name}", support.mass,
                    stiffness=support.stiffness_of_planes, damping=support.damping_of_planes,
                )
            )  # fmt: skip
        begin += bar.length
    return points


def _loads(train: Train, node: list[int], stations: list[int], parts: tuple[int, ...]) -> tuple[str, ...]:
    """Names of the discs, motors, wheels and the like on a shaft."""
    here = {place for place in range(len(node)) if node[place] in stations}
    return tuple(
        part.name
        for number, part in enumerate(train.parts)
        if number not in parts and not (part.joint or part.shaft) and here & set(part.stations)
    )
