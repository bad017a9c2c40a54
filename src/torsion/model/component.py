"""What every component is: a frozen declaration of its fields, and how it lowers to primitives.

Also here: where the train has arrived while its components are lowered, and the material of shafts.
"""

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from pkgutil import resolve_name
from typing import Annotated, Any, ClassVar, Literal

from pydantic import InstanceOf, WithJsonSchema

from torsion import fields
from torsion.errors import Fault, Path, nearest
from torsion.fields import Quantity, Sized, given, refuse, required
from torsion.model import KINDS
from torsion.model.parts import PLAIN, DataSheet, Part, Symbol
from torsion.primitives import Inertia, Primitive, Spring, Station

Strength = Annotated[float, Quantity("Pa", above=0, usual="strength")]


class Material(Sized):
    """An isotropic elastic material."""

    shear_modulus: fields.Modulus = required("G")
    youngs_modulus: fields.Modulus | None = given("E; needed for bending only")
    density: Annotated[float, Quantity("kg/m**3", at_least=0, usual="density")] = required(
        "rho; 0 makes a massless shaft"
    )
    tensile_strength: Strength | None = given("sigma_B, needed by the class rules")
    yield_strength: Strength | None = given(
        "R_eH or R_p0.2, needed by the rule `ice`; `kr` and `nk` use it"
    )
    loss_factor: fields.LossFactor = given(
        "energy lost in a cycle / (2 pi peak elastic energy)", 0.0
    )

    def refuse_clashes(self) -> None:
        if (self.yield_strength or 0.0) > (self.tensile_strength or math.inf):
            message = "the yield strength is above the tensile strength"
            raise refuse(message, "are they interchanged?", "yield_strength")


STEEL = Material(shear_modulus=79.3e9, youngs_modulus=206e9, density=7850.0)


@dataclass(frozen=True)
class Arrival:
    """The state of the walk; a branch starts from a copy of it."""

    station: int | None = None  # the last one
    is_open: bool = False  # no point has taken that station yet
    ratio: Fraction = Fraction(1)
    sense: int = 1
    referred_to: Fraction | None = (
        None  # the ratio of the speed at which figures that follow are given; None: own
    )
    yoke: float | None = (
        None  # rad from its plane of the last joint's driven yoke at angle zero; None behind a gear
    )
    joint: int | None = None  # part of that joint
    depth: int = 0

    @property
    def scale(self) -> float:
        """(Own speed / speed at which figures are given)^2, by which those of the component are to be divided."""
        return 1.0 if self.referred_to is None else float((self.ratio / self.referred_to) ** 2)


@dataclass
class Lowering:
    """Collects parts, stations and primitives. Components call `point` or `link`, then `add`."""

    materials: Mapping[str, Material]
    parts: list[Part] = field(default_factory=list)
    stations: list[Station] = field(default_factory=list)
    primitives: list[Primitive] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)
    arrival: Arrival = field(default_factory=Arrival)
    number: Counter[str] = field(default_factory=Counter)  # of components of a kind that were met
    folder: str = "."  # from which paths of files count

    @property
    def part(self) -> int:
        """Position of the component that is being lowered."""
        return len(self.parts) - 1

    @property
    def name(self) -> str:
        """Name of the component that is being lowered."""
        return self.parts[-1].name

    def member(
        self, owner: Part, name: str, kind: str, *, is_point: bool, symbol: Symbol = PLAIN
    ) -> None:
        """Begin a piece of a component that is itself a point or a link, as every other component is."""
        facts: dict[str, Any] = {"stations": (), "is_named": False, "note": None, "symbol": symbol}
        facts |= {"kind": kind, "is_point": is_point, "ratio": self.arrival.ratio}
        self.parts.append(replace(owner, name=f"{owner.name} {name}", **facts))

    def material(self, name: str, *keys: str | int) -> Material | None:
        """The material of that name; None, with a fault at `material` behind these keys, where there is none."""
        material = self.materials.get(name)
        if material is None:
            near = nearest(name, self.materials)
            example = "{shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa}"
            hint = f"declare it with its figures, as `materials: {{{name}: {example}}}`; there is {', '.join(self.materials)}"
            hint = f"did you mean '{near}'?" if near else hint
            self.fault(f"no material is called '{name}'", hint, *keys, "material")
        return material

    def record(self, *records: object) -> None:
        """Leave records on the part of the component that is being lowered; None is no record."""
        given_records = (record for record in records if record is not None)
        self.parts[-1] = self.parts[-1].with_records(*given_records)

    def place(self, **facts: Any) -> None:
        """State where the component that is being lowered stands, by the fields of `Part`."""
        self.parts[-1] = replace(self.parts[-1], **facts)

    def station(self, name: str, *, is_ground: bool = False, part: int | None = None) -> int:
        """A new station at the speed of where the train has arrived."""
        owner = self.part if part is None else part
        self.stations.append(
            Station(name, owner, self.arrival.ratio, self.arrival.sense, is_ground)
        )
        return len(self.stations) - 1

    def point(self) -> int:
        """The station of a point: the open end of the link before it, or a new one rigidly joined to the last point."""
        before = self.arrival.station
        if before is not None and self.arrival.is_open:
            point = before
            self.stations[point] = replace(self.stations[point], name=self.name, part=self.part)
        else:
            point = self.station(self.name)
            if before is not None:
                self.add(Spring(f"{self.name} rigid", self.part, before, point, 0.0))
        self.arrival = replace(self.arrival, station=point, is_open=False)
        self.place(stations=(point,))
        return point

    def link(
        self,
        ratio: Fraction = Fraction(1),
        sense: int = 1,
        halves: tuple[float, float] | None = None,
        half: str = "half",
        **behind: Any,
    ) -> tuple[int, int]:
        """The driving and the driven station of a link with the inertias of its `halves`; a point may take the driven.

        behind: what changes of the arrival, beside speed and sense.
        """
        before = self.arrival
        driving = self.station(f"{self.name} start") if before.station is None else before.station
        at_driving, at_driven = halves or (0.0, 0.0)
        self.inertia(driving, at_driving, f"driving {half}")
        behind |= {"ratio": before.ratio * ratio, "sense": before.sense * sense}
        self.arrival = replace(before, **behind)
        driven = self.station(f"{self.name} end")
        self.inertia(driven, at_driven, f"driven {half}")
        self.arrival = replace(self.arrival, station=driven, is_open=True)
        self.place(stations=(driving, driven))
        return driving, driven

    def add(self, *primitives: Primitive) -> None:
        """Collect primitives in the order in which components add them."""
        self.primitives.extend(primitives)

    def inertia(self, station: int, given: float, what: str = "", part: int | None = None) -> None:
        """Collect an inertia (kg m2) as the component gives it; nothing is left out."""
        if given:
            owner = self.part if part is None else part
            self.add(Inertia(station, self.to_own_speed(given), owner, what, given))

    def to_own_speed(self, value: float) -> float:
        """An inertia, stiffness or damping as given, brought to the station's own speed (`gear: referred`)."""
        return value / self.arrival.scale

    def fault(self, message: str, hint: str = "", *keys: str | int) -> None:
        """Note that the component being lowered cannot stand where or as it stands."""
        self.faults.append(Fault((*self.parts[-1].path, *keys), message, hint))


def section_name(shaft: str, number: int) -> str:
    """Return the name of a section of a shaft; `Part.whole` is the way back.

    >>> section_name("line", 2)
    'line [2]'
    """
    return f"{shaft} [{number}]"


class Component(Sized):
    """One entry of the train."""

    keyword: ClassVar[str]  # its kind, the key of its entry in the train
    sort: ClassVar[Literal["point", "link", "line", "none"]]  # line: points and links in a row
    symbol: ClassVar[Symbol] = PLAIN  # in the sketch of the train
    title: ClassVar[str]  # of its page in the manual
    example: ClassVar[str] = ""  # entries of a train
    groups: ClassVar[tuple[tuple[str, str], ...]] = ()  # of its keys in the manual: heading, keys

    name: str | None = given(
        "name by which excitations, links and results call it (default: kind and number)"
    )
    note: str | None = given("free text")
    source: str | None = given("source of the data: manufacturer, drawing, estimate")

    def __init_subclass__(cls, **facts: Any) -> None:
        super().__init_subclass__()
        for name, fact in facts.items():
            setattr(cls, name, fact)

    def lower(self, build: Lowering) -> None:
        """Add this component's stations and primitives where the train has arrived."""
        raise NotImplementedError

    def data_sheet(self) -> Iterable[tuple[str, str]]:
        """Return rows of its data sheet in the report: label, value with unit."""
        return ()

    def enter(self, build: Lowering, path: Path) -> None:
        """Make this component a part of the train where that has arrived, and lower it; `path` is its entry's."""
        build.number[self.keyword] += 1
        part = Part(
            self.name or f"{self.keyword}-{build.number[self.keyword]}",
            self.keyword,
            self.sort == "point",
            (*path, self.keyword),
            ratio=build.arrival.ratio,
            depth=build.arrival.depth,
            referred_to=build.arrival.referred_to,
            is_named=self.name is not None,
            note=self.note,
            source=self.source,
            symbol=self.symbol,
        )
        build.parts.append(part)
        position = build.part
        self.lower(build)
        if rows := tuple(self.data_sheet()):
            build.parts[position] = build.parts[position].with_records(DataSheet(rows))


class Rotor(Component, sort="point"):
    """What every point with one inertia has: `inertia`, or `held: true`."""

    inertia: fields.Inertia | None = given("polar mass moment of inertia")
    held: bool = given("turns at exactly its mean speed: a fixed end", False)
    tolerance: fields.Tolerance | None = given("tolerance of the inertia, for example 5 %")

    def refuse_clashes(self) -> None:
        if self.held and self.inertia is not None:
            hint = "a fixed point needs no inertia"
            raise refuse("`inertia` and `held: true` exclude each other", hint, "inertia")
        if not self.held and self.inertia is None:
            raise refuse("`inertia` is missing", "give `inertia`, or `held: true` for a fixed end")
        if self.held and self.tolerance is not None:
            message = "a fixed point has no inertia that could vary"
            raise refuse(message, "leave it out", "tolerance")

    def lower_rotor(self, build: Lowering, what: str = "") -> int:
        """Add the station of this point with its inertia; `what` names the inertia where there is another one."""
        station = build.point()
        build.place(inertia_tolerance=self.tolerance)
        build.inertia(station, math.inf if self.held else self.inertia or 0.0, what)
        return station


Line = Annotated[
    tuple[InstanceOf[Component], ...], WithJsonSchema({"allOf": [{"$ref": "#/$defs/train"}]})
]  # a train in a component


def lower_branch(
    build: Lowering, start: Arrival, components: Sequence[Component], path: Path
) -> None:
    """Lower a branch from `start`, then return to where the train had arrived."""
    main, build.arrival = build.arrival, replace(start, depth=start.depth + 1)
    for position, component in enumerate(components):
        component.enter(build, (*path, position))
    build.arrival = main


def component_class(kind: str) -> type[Component]:
    """The class of a kind; raises KeyError for a word that is no kind."""
    kind_class: type[Component] = resolve_name(KINDS[kind])
    return kind_class
