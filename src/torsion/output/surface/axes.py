"""Where the bodies of a train stand: one after another along axes that are parallel, and apart so that none overlap.

The train goes on along x. A gear, a branch and a link that closes a loop begin an axis beside the one they start from;
the wheels of a gear touch, their diameters in the ratio of its speeds.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.assembly.system import System
from torsion.components.lowering import Part
from torsion.errors import Path
from torsion.output.surface import bodies
from torsion.output.surface.bodies import Body, Sizes
from torsion.primitives import Bar

Place = tuple[float, float]  # m, y and z of an axis along x
Box = tuple[float, float, float]  # from x, to x, radius: m
SIDES = tuple((math.cos(k * math.pi / 4), math.sin(k * math.pi / 4)) for k in (6, 2, 0, 4, 7, 5, 1, 3))  # below first
GROWTH = 1.15  # of a distance, or of a wheel, until nothing overlaps
TRIES = 40  # at larger and larger wheels
CLEARANCE = 0.3  # between bodies of two axes, in the mean diameter of the shafts


@dataclass
class Axis:
    """A line on which bodies turn."""

    parent: int | None = None
    ties: list[float] = field(default_factory=list)  # x where its parent carries it without a gear
    bodies: list[Body] = field(default_factory=list)
    place: Place = (0.0, 0.0)

    @property
    def boxes(self) -> list[Box]:
        """What its bodies fill."""
        return [(float(body.x[0]), float(body.x[-1]), body.widest) for body in self.bodies]


@dataclass(frozen=True)
class Mesh:
    """A driving wheel with every wheel that it drives."""

    part: int
    x: float
    driving: tuple[int, int]  # axis, station
    driven: tuple[tuple[int, int, float], ...]  # axis, station, diameter / diameter of the driving wheel


@dataclass
class _Walk:
    """How far the train has been laid out."""

    system: System
    size: Sizes
    axes: list[Axis] = field(default_factory=list)
    meshes: list[Mesh] = field(default_factory=list)
    line: dict[Path, tuple[int, float]] = field(default_factory=dict)  # of every list of components: axis, x
    station: dict[int, tuple[int, float]] = field(default_factory=dict)  # axis, x

    def begin(self, parent: int | None, *ties: float) -> int:
        """A new axis."""
        self.axes.append(Axis(parent, list(ties)))
        return len(self.axes) - 1


@dataclass(frozen=True)
class Room:
    """What is filled already; bodies of one axis never overlap."""

    clearance: float  # m, between bodies
    least: float  # m, distance of two axes
    filled: list[tuple[float, ...]] = field(default_factory=list)  # of each body its axis, place and box

    def fill(self, axis: int, place: Place, boxes: Sequence[Box]) -> None:
        """Bodies of an axis now stand there."""
        self.filled.extend((axis, *place, *box) for box in boxes)

    def is_free(self, axis: int, place: Place, boxes: Sequence[Box]) -> bool:
        """None of the bodies of an axis would overlap with what is there."""
        if not self.filled or not boxes:
            return True
        own, y, z, first, last, radius = np.array(self.filled).T
        start, end, size = np.array(boxes).T[:, :, None]
        near = 1e-6 * self.clearance  # two that only touch are not beside each other
        beside = (start < last - near) & (first < end - near)
        apart = (np.hypot(y - place[0], z - place[1]) >= size + radius + self.clearance) | (own == axis)
        return not np.any(beside & ~apart)

    def free(self, axis: int, start: Place, boxes: Sequence[Box]) -> Place:
        """The nearest place beside `start` where nothing overlaps."""
        distance = self.least
        while True:
            for place in sides(start, distance):
                if self.is_free(axis, place, boxes):
                    return place
            distance *= GROWTH


def sides(start: Place, distance: float) -> Iterator[Place]:
    """Places at a distance, below first."""
    return ((start[0] + distance * y, start[1] + distance * z) for y, z in SIDES)


def axes(system: System) -> list[Axis]:
    """The axes of a train with all their bodies, in place."""
    walk = _Walk(system, bodies.sizes(system))
    spans: dict[int, list[int]] = {}
    for k, span in enumerate(system.spans):
        spans.setdefault(span.part, []).append(k)
    bars = {bar.part: bar for bar in system.train.bars}
    for index, part in enumerate(system.train.parts):
        if not part.stations:
            continue
        axis, x = _arrived(walk, part)
        mine = spans.get(index, [])
        if part.kind == "gear":
            _mesh(walk, index, mine, axis, x)
            continue
        made = _made(walk, index, mine, bars.get(index), x)
        walk.axes[axis].bodies.extend(made)
        after = float(made[0].x[-1])
        walk.line[part.line] = axis, after
        walk.station.setdefault(part.stations[0], (axis, x))
        walk.station.setdefault(part.stations[-1], (axis, after))
    _put_apart(walk)
    return walk.axes


def _made(walk: _Walk, index: int, spans: list[int], bar: Bar | None, x: float) -> list[Body]:
    """The bodies of a component that is no gear."""
    part = walk.system.train.parts[index]
    if part.is_point:
        return bodies.point(walk.system, index, spans, x, walk.size)
    if bar is not None:
        return [bodies.shaft(walk.system, bar, spans, x)]
    kind = "coupling" if part.joint is None else "joint"
    return [bodies.link(index, kind, (part.stations[0], part.stations[-1]), spans[0], x, walk.size)]


def _arrived(walk: _Walk, part: Part) -> tuple[int, float]:
    """Axis and place at which a component begins."""
    line = part.line
    if part.path[0] == "links":
        (axis, first), (_, last) = (walk.station[end] for end in (part.stations[0], part.stations[-1]))
        return walk.begin(axis, first, last), min(first, last)
    if line not in walk.line:
        around = (line[:k] for k in range(len(line) - 1, 0, -1))
        on, x = next((walk.line[one] for one in around if one in walk.line), (None, 0.0))
        walk.line[line] = walk.begin(on, *([] if on is None else [x])), x
    return walk.line[line]


def _mesh(walk: _Walk, index: int, spans: Sequence[int], axis: int, x: float) -> None:
    """A gear: the train goes on along the axis of its driven wheel, each of its branches along that of its own."""
    system, path = walk.system, walk.system.train.parts[index].path
    after = x + bodies.length_of("gear", walk.size)
    driven = []
    for position, k in enumerate(spans):
        span = system.spans[k]
        new = walk.begin(axis)
        driven.append((new, span.driven, 1.0 / float(span.ratio)))
        walk.station[span.driven] = new, after
        line = path[:-2] if position == 0 else (*path, "branches", position - 1, "train")
        walk.line[line] = new, after
    walk.station.setdefault(system.spans[spans[0]].driving, (axis, x))
    walk.meshes.append(Mesh(index, x, (axis, system.spans[spans[0]].driving), tuple(driven)))


def _put_apart(walk: _Walk) -> None:
    """Give every axis its place, one after another, at the least distance at which nothing overlaps."""
    room = Room(CLEARANCE * walk.size.diameter, 1.5 * walk.size.diameter)
    behind = {index: mesh for mesh in walk.meshes for index, _, _ in mesh.driven}
    for index, axis in enumerate(walk.axes):
        if index not in behind:
            if axis.parent is not None:
                axis.place = room.free(index, walk.axes[axis.parent].place, axis.boxes)
            room.fill(index, axis.place, axis.boxes)
        elif index == behind[index].driven[0][0]:
            _put_gear(walk, room, behind[index])


def _put_gear(walk: _Walk, room: Room, mesh: Mesh) -> None:
    """The least wheels with which every axis behind the gear finds a place; apart from each other if there are none."""
    end = mesh.x + bodies.length_of("gear", walk.size)
    driving, station = mesh.driving
    start = walk.axes[driving].place
    least = radius = 0.9 * walk.size.diameter * max(1.0, *(1.0 / ratio for _, _, ratio in mesh.driven))
    places = _around(walk, room, mesh, end, radius)
    while places is None and radius < least * GROWTH**TRIES:
        radius *= GROWTH
        places = _around(walk, room, mesh, end, radius)
    if places is None:
        radius = least
    walk.axes[driving].bodies.append(bodies.wheel(mesh.part, station, mesh.x, walk.size, radius))
    room.fill(driving, start, [(mesh.x, end, radius)])
    for position, (index, driven, ratio) in enumerate(mesh.driven):
        axis = walk.axes[index]
        axis.bodies.insert(0, bodies.wheel(mesh.part, driven, mesh.x, walk.size, radius * ratio))
        axis.place = room.free(index, start, axis.boxes) if places is None else places[position]
        room.fill(index, axis.place, axis.boxes)


def _around(walk: _Walk, room: Room, mesh: Mesh, end: float, radius: float) -> list[Place] | None:
    """Places of the driven axes around a driving wheel of that radius; None where there are none."""
    start, taken = walk.axes[mesh.driving[0]].place, replace(room, filled=list(room.filled))
    if not room.is_free(mesh.driving[0], start, [(mesh.x, end, radius)]):
        return None
    found = []
    for index, _, ratio in mesh.driven:
        boxes = [(mesh.x, end, radius * ratio), *walk.axes[index].boxes]
        place = next((p for p in sides(start, radius * (1.0 + ratio)) if taken.is_free(index, p, boxes)), None)
        if place is None:
            return None
        taken.fill(index, place, boxes)
        found.append(place)
    return found
