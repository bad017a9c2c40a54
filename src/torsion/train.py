"""The train: its components as placed, its stations with their speed ratios, and its primitives."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from torsion.errors import Fault, InputError, Path, nearest
from torsion.model.component import STEEL, Arrival, Component, Lowering, Material, lower_line
from torsion.model.machine_torques import Excitation
from torsion.model.parts import Part, ShaftRecord
from torsion.primitives import (
    Bar,
    Constraint,
    Damper,
    Inertia,
    SectionMesh,
    Spring,
    Station,
    StepForm,
    Torque,
)
from torsion.results import by_name, listed, one_line
from torsion.sources import collected

ENDS = ("station", "driving", "driven")  # the stations that primitives name


@dataclass(frozen=True)
class Link:
    """A component between two named points that closes a loop."""

    between: tuple[str, str]
    component: Component


@dataclass(frozen=True, repr=False)
class Train:
    """A shaft train, lowered."""

    parts: tuple[Part, ...]
    stations: tuple[Station, ...]
    inertias: tuple[Inertia, ...]
    springs: tuple[Spring, ...]
    bars: tuple[Bar, ...]
    constraints: tuple[Constraint, ...]
    dampers: tuple[Damper, ...]
    torques: tuple[Torque, ...]
    materials: Mapping[str, Material]
    modal_damping: tuple[
        float, ...
    ] = ()  # damping ratio of each elastic mode, the last of all above; () for none
    # Of shafts that say none of their own; None: all are springs already.
    steps: StepForm | None = "none"
    sources: tuple[
        tuple[str, str], ...
    ] = ()  # literature of the formulas of its components: key, place in it

    def __repr__(self) -> str:
        names = listed((part.name for part in self.parts), most=6)
        return one_line(f"Train: {len(self.parts)} components ({names})")

    def __getitem__(self, name: str) -> Part:
        """The component of that name; raises KeyError with the nearest name."""
        return by_name(name, {part.name: part for part in reversed(self.parts)})

    def part(self, name: str) -> Part:
        """The component of that name; raises KeyError."""
        return self.parts[self.position(name)]

    def position(self, name: str) -> int:
        """Where it stands in `parts`; raises KeyError."""
        return self._position[name]

    @cached_property
    def _position(self) -> dict[str, int]:
        return {part.name: number for number, part in reversed(list(enumerate(self.parts)))}

    def of_kind(self, kind: str) -> Iterator[tuple[int, Part]]:
        """Every component of a kind with its position in `parts`."""
        return ((number, part) for number, part in enumerate(self.parts) if part.kind == kind)

    @cached_property
    def periodic_torques(self) -> Mapping[str, tuple[Torque, ...]]:
        """Torques by order or of a fixed frequency, by the name of the component at which they act."""
        torques: dict[str, tuple[Torque, ...]] = {}
        for torque in self.torques:
            if torque.order is not None or torque.frequency is not None:
                part = (
                    self.stations[torque.station].part
                    if torque.cylinder is None
                    else torque.cylinder.engine
                )
                name = torque.mesh[0] if torque.mesh else self.parts[part].name
                torques[name] = (*torques.get(name, ()), torque)
        return torques

    @property
    def has_shafts(self) -> bool:
        """A shaft has an inertia of its own, so that the models of shafts differ."""
        return any(bar.density > 0 for bar in self.bars)

    @property
    def has_meshed_sections(self) -> bool:
        """A shaft has a `section` by mesh, yet to be solved."""
        return any(isinstance(bar.section, SectionMesh) for bar in self.bars)

    @property
    def has_steps(self) -> bool:
        """Steps between shafts, or hubs on them, are yet to be taken into their flexibility."""
        stated = any(part.shaft is not None and part.shaft.step is not None for part in self.parts)
        return self.steps is not None and (self.steps != "none" or stated or self.has_hubs)

    @property
    def has_hubs(self) -> bool:
        """A shaft has a hub on its end."""
        return any(part.shaft is not None and bool(part.shaft.hubs) for part in self.parts)

    @property
    def has_corners(self) -> bool:
        """A shaft begins with another diameter or bore where one ends; something may stand between them."""
        ends = {bar.driven: (bar.outer[1], bar.bore[1]) for bar in self.bars if bar.section is None}
        starts = [
            (bar.driving, (bar.outer[0], bar.bore[0])) for bar in self.bars if bar.section is None
        ]
        return any(ends.get(station, across) != across for station, across in starts)

    @property
    def has_fillets(self) -> bool:
        """A step between shafts is a fillet of a stated radius, or a shaft has notches."""
        records = [p.shaft for p in self.parts if p.shaft is not None]
        return any(
            record.notches or (record.step is not None and record.step.round) for record in records
        )

    @property
    def damping_of_components(self) -> str:
        """The name of one that has damping of its own; empty where none has."""
        named = [spring.name for spring in self.springs if spring.damps]
        named += [bar.name for bar in self.bars if bar.loss_factor > 0]
        named += [self.parts[self.stations[damper.station].part].name for damper in self.dampers]
        return next(iter(named), "")

    @cached_property
    def has_referred_figures(self) -> bool:
        """Some figures of the file are for another speed than their component's own."""
        return any(part.referred_to is not None for part in self.parts)

    @property
    def has_loops(self) -> bool:
        """A component of `links` closes a loop."""
        return any(part.path[:1] == ("links",) for part in self.parts)

    @property
    def has_tables(self) -> bool:
        """The stiffness of a coupling follows a table."""
        return any(spring.table is not None for spring in self.springs)

    def has_tables_over(self, over: str) -> bool:
        """The stiffness of a coupling follows a table over that."""
        return any(
            spring.table is not None and spring.table.over == over for spring in self.springs
        )

    @property
    def follows_speed(self) -> bool:
        """A stiffness follows the speed, or the mean torque of a speed."""
        return self.has_tables_over("mean torque") or self.has_tables_over("speed")

    @property
    def has_nonlinear_couplings(self) -> bool:
        """A coupling has play, friction, stages or a capacity."""
        return any(part.nonlinear is not None for part in self.parts)

    @cached_property
    def sectioned(self) -> dict[str, list[Bar]]:
        """The sections of every shaft from a table of sections, by the name of the shaft."""
        bars: dict[str, list[Bar]] = {}
        for bar in self.bars:
            if (part := self.parts[bar.part]).whole != part.name:
                bars.setdefault(part.whole, []).append(bar)
        return bars

    def shaft(self, bar: Bar) -> ShaftRecord:
        """What is known of the shaft that a `Bar` is of; raises LookupError where it is of another component."""
        if (record := self.parts[bar.part].shaft) is None:
            raise LookupError(bar.name)
        return record


def train(
    components: Sequence[Component],
    *,
    excitations: Sequence[Excitation] = (),
    links: Sequence[Link] = (),
    materials: Mapping[str, Material] | None = None,
    reference: str | None = None,
    steps: StepForm = "none",
) -> Train:
    """Lower a list of components; every speed ratio counts from the component called `reference` (default: the first).

    steps: of the shafts that say no `step`, taken as springs when the train is assembled. Raises InputError with every
    fault of the train as a whole.
    """
    lowered_train, faults = lowered(
        components, excitations=excitations, links=links, materials=materials, reference=reference
    )
    if lowered_train is None or faults:
        raise InputError(faults)
    return replace(lowered_train, steps=steps)


def lowered(
    components: Sequence[Component],
    *,
    excitations: Sequence[Excitation | None],
    links: Sequence[Link | None],
    materials: Mapping[str, Material] | None,
    reference: str | None,
    folder: str = ".",
) -> tuple[Train | None, list[Fault]]:
    """The train as far as it is known, and its faults; None stands for what cannot be read, and is left out.

    folder: from which paths of files count.
    """
    build = Lowering({"steel": STEEL, **(materials or {})}, folder=folder)
    with collected() as citations:
        lower_line(build, components, ("train",))
    if not build.stations:
        fault = Fault(("train",), "the train has no component that turns", "list its components")
        return None, [*build.faults, fault]
    for position, link in enumerate(links):
        if link is not None:
            _close(build, link, ("links", position))
    for position, excitation in enumerate(excitations):
        if excitation is not None:
            _excite(build, excitation, ("excitations", position))
    first: dict[str, Path] = {}
    for part in build.parts:
        if part.name in first:
            fault = taken(part.name, part.path, first[part.name], given=part.is_named)
            build.faults.append(fault)
        first.setdefault(part.name, part.path)
    counted = (
        None if reference is None else _named(build, reference, ("operation", "at"), point=False)
    )
    train = _train(build, Fraction(1) if counted is None else counted.ratio)
    return replace(train, sources=tuple(citations)), build.faults


def _excite(build: Lowering, excitation: Excitation, path: Path) -> None:
    """Lower an excitation at a point, or at the mesh of a gear."""
    made = (
        constraint
        for constraint in build.primitives
        if isinstance(constraint, Constraint) and constraint.name == excitation.at
    )
    mesh = next(
        (constraint for constraint in made if build.parts[constraint.part].kind == "gear"), None
    )
    if mesh is not None:
        from torsion.model.mesh_excitation import mesh_torque

        if isinstance(excitation_torque := mesh_torque(excitation, mesh, path), Fault):
            build.faults.append(excitation_torque)
        else:
            build.add(excitation_torque)
        return
    if (point := _named(build, excitation.at, (*path, "at"))) is None:
        return
    if excitation.transmission_error is not None or excitation.harmonic != 1:
        message = f"'{excitation.at}' has no teeth, and so no transmission error"
        build.faults.append(
            Fault((*path, "at"), message, "the name of a gear, or `torque` with `order`")
        )
        return
    build.add(excitation.primitive(excitation.at, point.stations[0], path, excitation.source))


def _train(build: Lowering, unit: Fraction) -> Train:
    """The train with its speeds counted from one that is `unit` of the first."""

    def select(kind: type) -> tuple:  # type: ignore[type-arg]
        return tuple(p for p in build.primitives if isinstance(p, kind))

    referred = [
        None if part.referred_to is None else part.referred_to / unit for part in build.parts
    ]
    return Train(
        tuple(
            replace(p, ratio=p.ratio / unit, referred_to=to)
            for p, to in zip(build.parts, referred, strict=True)
        ),
        tuple(replace(station, ratio=station.ratio / unit) for station in build.stations),
        select(Inertia),
        select(Spring),
        select(Bar),
        select(Constraint),
        select(Damper),
        select(Torque),
        build.materials,
    )


def name_fault(
    name: str, path: Path, kinds: Mapping[str, tuple[str, bool]], *, point: bool = True
) -> Fault | None:
    """The fault of a name that is none of the known components', or that of no point where one is needed.

    known: of every component its kind, and whether it is a point.
    """
    names = [known_name for known_name, (_, is_point) in kinds.items() if is_point or not point]
    if name in names:
        return None
    listed = f"points: {', '.join(names)}" if point else "the name of a component"
    if name in kinds:
        kind = kinds[name][0]
        return Fault(path, f"'{name}' is a{'n' * (kind[0] in 'aeiou')} {kind}, not a point", listed)
    near = nearest(name, names)
    return Fault(
        path, f"no component is called '{name}'", f"did you mean '{near}'?" if near else listed
    )


def _named(build: Lowering, name: str, path: Path, *, point: bool = True) -> Part | None:
    """The point, or any component, called `name`; a fault is noted where there is none."""
    # Of a name that is given twice the point is meant.
    ordered = sorted(build.parts, key=lambda part: part.is_point)
    kinds = {part.name: (part.kind, part.is_point) for part in ordered}
    fault = name_fault(name, path, kinds, point=point)
    if fault is not None:
        build.faults.append(fault)
        return None
    return next(part for part in build.parts if part.name == name and (part.is_point or not point))


def _close(build: Lowering, link: Link, path: Path) -> None:
    """Lower a link between two points of equal speed and sense."""
    first, second = (
        _named(build, name, (*path, "between", side)) for side, name in enumerate(link.between)
    )
    if first is None or second is None:
        return
    both, ends_path = f"'{first.name}' and '{second.name}'", (*path, "between")
    senses = {build.stations[part.stations[0]].sense for part in (first, second)}
    if any("differential" in part.path for part in (first, second)):
        hint = "write the train without `differential`, both halves one by one"
        build.faults.append(Fault(ends_path, "a half of a differential takes no link", hint))
    elif first.stations == second.stations:
        build.faults.append(
            Fault(ends_path, f"{both} are one point", "a link joins two different points")
        )
    elif first.ratio != second.ratio or len(senses) > 1:
        hint = "a link joins two different points of the same speed and sense of rotation"
        build.faults.append(Fault(ends_path, f"{both} do not turn together", hint))
    elif first.referred_to != second.referred_to:
        message = f"{both} are not referred to one speed, and so the link's figures to neither"
        build.faults.append(Fault(ends_path, message, "refer both (gear: referred), or neither"))
    else:
        _join(build, first, second, link.component, path)


def _join(build: Lowering, first: Part, second: Part, component: Component, path: Path) -> None:
    """Lower a link between two points that are there already."""
    driving, driven = first.stations[0], second.stations[0]
    sense, begin = build.stations[driving].sense, len(build.primitives)
    main, build.arrival = (
        build.arrival,
        Arrival(driving, False, first.ratio, sense, first.referred_to),
    )
    component.enter(build, path)
    made = build.parts[-1].stations[-1]
    for position, primitive in enumerate(build.primitives[begin:], begin):
        moved: dict[str, Any] = dict.fromkeys(
            (end for end in ENDS if getattr(primitive, end, None) == made), driven
        )
        build.primitives[position] = replace(primitive, **moved)
    del build.stations[made]
    build.place(stations=(driving, driven))
    build.arrival = main


def taken(name: str, path: Path, taken_by: Path, *, given: bool = True) -> Fault:
    """The fault of a name, given or automatic, that another component has; paths are those of the components."""
    if given:
        return Fault(
            (*path, "name"), f"the name '{name}' is taken", "names are unique", other=taken_by
        )
    return Fault(
        path,
        f"its name would be '{name}', which is taken",
        "give one of the two another `name`",
        other=taken_by,
    )


Rigid = dict[
    int, list[tuple[int, Spring | Constraint]]
]  # of each station: (the other one, the rigid span between)


def fixed_point_faults(train: Train) -> list[Fault]:
    """A fault for every fixed point that rigid spans alone join to an earlier one."""
    held = {lump.station for lump in train.inertias if math.isinf(lump.inertia)}
    if len(held) < 2:
        return []
    near: Rigid = {}
    spans: list[Spring | Constraint] = [*train.springs, *train.constraints]
    for span in spans:
        if span.flexibility == 0:
            near.setdefault(span.driving, []).append((span.driven, span))
            near.setdefault(span.driven, []).append((span.driving, span))
    return [fault for station in sorted(held) for fault in _fault(train, station, held, near)]


def _fault(train: Train, station: int, held: set[int], near: Rigid) -> Iterator[Fault]:
    """The fault of a fixed station, by the shortest rigid way to one before it."""
    way: dict[int, list[Spring | Constraint]] = {station: []}
    for reached in (met := [station]):
        for neighbour, span in near.get(reached, []):
            if neighbour not in way:
                way[neighbour] = [*way[reached], span]
                met.append(neighbour)
    before = [neighbour for neighbour in met if neighbour in held and neighbour < station]
    if not before:
        return
    part, earlier = (train.parts[train.stations[fixed].part] for fixed in (station, before[0]))
    uneven = [span for span in way[before[0]] if isinstance(span, Constraint) and span.error]
    hint = "put a stiffness between them, or fix one of them only"
    if uneven:
        joint = train.parts[uneven[-1].part]
        ends = f"'{earlier.name}' and '{part.name}'"
        message = f"'{joint.name}' cannot turn: {ends} are fixed, with nothing elastic between"
        yield Fault(joint.path, message, hint)
    else:
        message = f"'{part.name}' is fixed, and rigid parts alone join it to '{earlier.name}', which is fixed too"
        yield Fault((*part.path, "held"), message, hint)
