"""Where the train has arrived while its components are lowered, one after another."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import Any

from torsion.components.component import Component
from torsion.components.material import Material
from torsion.components.part_records import CouplingRatings, JointRecord, PropellerRecord, ShaftRecord
from torsion.errors import Fault, Path
from torsion.primitives import Inertia, Primitive, Spring, Station


@dataclass(frozen=True)
class Part:
    """A component as placed in the train, and what analyses, rules and reports need to know of it."""

    name: str
    kind: str  # its key in the file: disc, shaft, coupling, ...
    is_point: bool  # else a link between points, or a branch
    path: Path  # where it stands in the file
    stations: tuple[int, ...] = ()  # the stations it made or took
    ratio: Fraction = Fraction(1)  # its speed (of a gear: of the driving side) / the reference speed
    depth: int = 0  # 0 on the main line, 1 on a branch, 2 on a branch of a branch
    referred_to: Fraction | None = None  # ratio of the speed at which its figures are given; None: its own
    is_named: bool = False  # by the file, not by its kind and number
    note: str | None = None
    source: str | None = None  # where its figures come from
    damping: tuple[str, float] | None = None  # key and value of its internal damping as given in the file
    power: float | None = None  # W, of a motor
    application_factor: float | None = None  # K_A, of a gear
    ratings: CouplingRatings | None = None
    shaft: ShaftRecord | None = None
    joint: JointRecord | None = None
    propeller: PropellerRecord | None = None


@dataclass(frozen=True)
class Arrival:
    """The state of the walk; a branch starts from a copy of it."""

    here: int | None = None  # the last station
    is_open: bool = False  # no point has taken that station yet
    ratio: Fraction = Fraction(1)
    sense: int = 1
    referred_to: Fraction | None = None  # the ratio of the speed at which figures that follow are given; None: own
    yoke: float | None = None  # rad from its plane of the last joint's driven yoke at angle zero; None behind a gear
    joint: int | None = None  # part of that joint
    depth: int = 0

    @property
    def referred(self) -> Fraction:
        """Own speed / speed at which figures are given."""
        return Fraction(1) if self.referred_to is None else self.ratio / self.referred_to


@dataclass
class Lowering:
    """Collects stations and primitives. Components call `point` or `link`, then `add`."""

    materials: Mapping[str, Material]
    parts: list[Part] = field(default_factory=list)
    stations: list[Station] = field(default_factory=list)
    primitives: list[Primitive] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    at: Arrival = field(default_factory=Arrival)
    _numbers: dict[str, int] = field(default_factory=dict)

    @property
    def part(self) -> int:
        """Position of the component that is being lowered."""
        return len(self.parts) - 1

    @property
    def name(self) -> str:
        """Name of the component that is being lowered."""
        return self.parts[-1].name

    def walk(self, components: Sequence[Component], path: Path) -> None:
        """Lower a list of components, each from where the one before it ended."""
        for position, component in enumerate(components):
            self._place(component, (*path, position, component.keyword))

    def _place(self, component: Component, path: Path) -> None:
        number = self._numbers[component.keyword] = self._numbers.get(component.keyword, 0) + 1
        name = component.name or f"{component.keyword}-{number}"
        at = self.at
        part = Part(
            name, component.keyword, component.sort == "point", path,
            ratio=at.ratio, depth=at.depth, referred_to=at.referred_to,
            is_named=component.name is not None, note=component.note, source=component.source,
        )  # fmt: skip
        self.parts.append(part)
        component.lower(self)

    def record(self, **facts: Any) -> None:
        """Leave facts on the part of the component that is being lowered, by the fields of `Part`."""
        self.parts[-1] = replace(self.parts[-1], **facts)

    def station(self, name: str, *, is_ground: bool = False, part: int | None = None) -> int:
        """A new station at the speed of where the train has arrived."""
        owner = self.part if part is None else part
        self.stations.append(Station(name, owner, self.at.ratio, self.at.sense, is_ground))
        return len(self.stations) - 1

    def point(self) -> int:
        """The station of a point: the open end of the link before it, or a new one rigidly joined to the last point."""
        before, part = self.at.here, self.part
        if before is not None and self.at.is_open:
            here = before
            self.stations[here] = replace(self.stations[here], name=self.name, part=part)
        else:
            here = self.station(self.name)
            if before is not None:
                self.add(Spring(f"{self.name} rigid", part, before, here, 0.0))
        self.at = replace(self.at, here=here, is_open=False)
        self.parts[part] = replace(self.parts[part], stations=(here,))
        return here

    def link(self, ratio: Fraction = Fraction(1), sense: int = 1) -> tuple[int, int]:
        """The driving and the driven station of a link; the driven one is massless until a point takes it."""
        part = self.part
        driving = self.at.here if self.at.here is not None else self.station(f"{self.name} start")
        self.at = replace(self.at, ratio=self.at.ratio * ratio, sense=self.at.sense * sense)
        driven = self.station(f"{self.name} end")
        self.at = replace(self.at, here=driven, is_open=True)
        self.parts[part] = replace(self.parts[part], stations=(driving, driven))
        return driving, driven

    def branch(self, start: Arrival, components: Sequence[Component], path: Path, *, deeper: bool = True) -> None:
        """Lower a branch from `start`, then return to where the train had arrived."""
        main = self.at
        self.at = replace(start, depth=start.depth + deeper)
        self.walk(components, path)
        self.at = main

    def join(self, first: Part, second: Part, component: Component, path: Path) -> None:
        """Lower a link between two points that are there already, which closes a loop."""
        driving, driven = first.stations[0], second.stations[0]
        sense = self.stations[driving].sense
        main, self.at = self.at, Arrival(driving, False, first.ratio, sense, first.referred_to)
        before = len(self.primitives)
        self._place(component, (*path, component.keyword))
        made = self.parts[-1].stations[-1]
        swapped = [_moved(primitive, made, driven) for primitive in self.primitives[before:]]
        self.primitives[before:] = swapped
        del self.stations[made]
        self.parts[-1] = replace(self.parts[-1], stations=(driving, driven))
        self.at = main

    def add(self, *primitives: Primitive) -> None:
        """Collect primitives; an inertia of nothing is left out."""
        self.primitives.extend(p for p in primitives if not (isinstance(p, Inertia) and p.inertia == 0))

    def material(self, name: str) -> Material | None:
        """The material of that name, or None with a fault noted."""
        found = self.materials.get(name)
        if found is None:
            self.fault(f"no material is called '{name}'", f"there is {', '.join(self.materials)}", "material")
        return found

    def own(self, value: float) -> float:
        """An inertia, stiffness or damping as given, brought to the station's own speed (`gear: referred`)."""
        return value if self.at.referred == 1 else value / float(self.at.referred**2)

    def fault(self, message: str, hint: str = "", key: str | int | None = None) -> None:
        """Note that the component being lowered cannot stand where or as it stands."""
        path = self.parts[-1].path if key is None else (*self.parts[-1].path, key)
        self.faults.append(Fault(path, message, hint))


def _moved(primitive: Primitive, old: int, new: int) -> Primitive:
    """The primitive with one of its stations exchanged."""
    changes: dict[str, Any] = {
        key: new for key in ("station", "driving", "driven") if getattr(primitive, key, None) == old
    }
    return replace(primitive, **changes)
