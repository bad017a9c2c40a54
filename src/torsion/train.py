"""The train: its components as placed, its stations with their speed ratios, and its primitives."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from typing import Any

from torsion.errors import Fault, InputError, Path, nearest
from torsion.model.component import STEEL, Arrival, Component, Lowering, Material
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
        return self.parts[by_name(name, self.positions)]

    @cached_property
    def positions(self) -> dict[str, int]:
        """Where every component stands in `parts`, by its name."""
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
                engine, part = torque.cylinder, self.stations[torque.station].part
                name = self.parts[part if engine is None else engine.engine].name
                name = torque.mesh[0] if torque.mesh else name
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
        shafts = [bar for bar in self.bars if bar.section is None]
        ends = {bar.driven: (bar.outer[1], bar.bore[1]) for bar in shafts}
        starts = ((ends.get(bar.driving), (bar.outer[0], bar.bore[0])) for bar in shafts)
        return any(end not in (None, start) for end, start in starts)

    @cached_property
    def has_referred_figures(self) -> bool:
        """Some figures of the file are for another speed than their component's own."""
        return any(part.referred_to is not None for part in self.parts)

    @property
    def has_loops(self) -> bool:
        """A component of `links` closes a loop."""
        return any(part.path[:1] == ("links",) for part in self.parts)

    @property
    def taken_as_linear(self) -> tuple[tuple[str, str], ...]:
        """What is nonlinear in its couplings and is left out of modes, of a clutch also of the response; and how."""
        rows = []
        for part in self.parts:
            if part.nonlinear is not None:
                what = "all but the transient response takes" if part.is_clutch else "modes take"
                why = f"{what} the coupling as linear: {part.nonlinear.words}"
                why += "" if part.is_clutch else "; the response takes it by harmonic balance"
                rows.append((f"what is nonlinear in '{part.name}'", why))
        return tuple(rows)

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
        for position, component in enumerate(components):
            component.enter(build, ("train", position))
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

    # Speeds count from that of the reference.
    counted = None
    if reference is not None:
        counted = _named(build, reference, ("operation", "at"), point=False)
    unit = Fraction(1) if counted is None else counted.ratio
    parts = (
        replace(
            part,
            ratio=part.ratio / unit,
            referred_to=None if part.referred_to is None else part.referred_to / unit,
        )
        for part in build.parts
    )
    stations = (replace(station, ratio=station.ratio / unit) for station in build.stations)
    primitives: dict[str, Any] = {
        f"{kind.__name__.lower()}s": tuple(
            primitive for primitive in build.primitives if isinstance(primitive, kind)
        )
        for kind in (Inertia, Spring, Bar, Constraint, Damper, Torque)
    }
    train = Train(
        parts=tuple(parts),
        stations=tuple(stations),
        **primitives,
        materials=build.materials,
        sources=tuple(citations),
    )
    return train, build.faults


def _excite(build: Lowering, excitation: Excitation, path: Path) -> None:
    """Lower an excitation at a point, or at the mesh of a gear."""
    name, at_path = excitation.at, (*path, "at")
    for mesh in build.primitives:
        if not isinstance(mesh, Constraint) or mesh.name != name:
            continue
        if build.parts[mesh.part].kind == "gear":
            from torsion.model.gears.mesh_excitation import mesh_torque

            if isinstance(excitation_torque := mesh_torque(excitation, mesh, path), Fault):
                build.faults.append(excitation_torque)
            else:
                build.add(excitation_torque)
            return
    if (point := _named(build, name, at_path)) is None:
        return
    if excitation.transmission_error is not None or excitation.harmonic != 1:
        message = f"'{name}' has no teeth, and so no transmission error"
        build.faults.append(Fault(at_path, message, "the name of a gear, or `torque` with `order`"))
        return
    build.add(excitation.primitive(name, point.stations[0], path, excitation.source))


def name_fault(
    name: str, path: Path, kinds: Mapping[str, tuple[str, bool]], *, point: bool = True
) -> Fault | None:
    """The fault of a name that is none of the known components', or that of no point where one is needed.

    kinds: of every component its kind, and whether it is a point.
    """
    names = [component for component, (_, is_point) in kinds.items() if is_point or not point]
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
    both, message = f"'{first.name}' and '{second.name}'", ""
    driving, driven = first.stations[0], second.stations[0]
    sense = build.stations[driving].sense
    if any("differential" in part.path for part in (first, second)):
        message = "a half of a differential takes no link"
        hint = "write the train without `differential`, both halves one by one"
    elif first.stations == second.stations:
        message, hint = f"{both} are one point", "a link joins two different points"
    elif first.ratio != second.ratio or sense != build.stations[driven].sense:
        message = f"{both} do not turn together"
        hint = "a link joins two different points of the same speed and sense of rotation"
    elif first.referred_to != second.referred_to:
        message = f"{both} are not referred to one speed, and so the link's figures to neither"
        hint = "refer both (gear: referred), or neither"
    if message:
        build.faults.append(Fault((*path, "between"), message, hint))
        return

    # The link is lowered as if it led on from the first point; its far end then is the second one.
    main, begin = build.arrival, len(build.primitives)
    build.arrival = Arrival(driving, False, first.ratio, sense, first.referred_to)
    link.component.enter(build, path)
    made = build.parts[-1].stations[-1]
    for position, primitive in enumerate(build.primitives[begin:], begin):
        ends = (end for end in ENDS if getattr(primitive, end, None) == made)
        moved: dict[str, Any] = dict.fromkeys(ends, driven)
        build.primitives[position] = replace(primitive, **moved)
    del build.stations[made]
    build.place(stations=(driving, driven))
    build.arrival = main


def taken(name: str, path: Path, taken_by: Path, *, given: bool = True) -> Fault:
    """The fault of a name, given or automatic, that another component has; paths are those of the components."""
    if given:
        message, path = f"the name '{name}' is taken", (*path, "name")
        return Fault(path, message, "names are unique", other=taken_by)
    message = f"its name would be '{name}', which is taken"
    return Fault(path, message, "give one of the two another `name`", other=taken_by)


def fixed_point_faults(train: Train) -> list[Fault]:
    """A fault for every fixed point that rigid spans alone join to an earlier one."""
    held = {lump.station for lump in train.inertias if math.isinf(lump.inertia)}
    spans: list[Spring | Constraint] = [*train.springs, *train.constraints]
    near: dict[int, list[tuple[int, Spring | Constraint]]] = {}
    for span in spans if len(held) > 1 else ():
        for station, neighbour in ((span.driving, span.driven), (span.driven, span.driving)):
            if span.flexibility == 0:
                near.setdefault(station, []).append((neighbour, span))
    faults = []
    for station in sorted(held):
        # The shortest rigid way to a fixed point before it.
        way: dict[int, list[Spring | Constraint]] = {station: []}
        for reached in (met := [station]):
            for neighbour, span in near.get(reached, []):
                if neighbour not in way:
                    way[neighbour] = [*way[reached], span]
                    met.append(neighbour)
        before = next((point for point in met if point in held and point < station), None)
        if before is None:
            continue
        part, earlier = (train.parts[train.stations[fixed].part] for fixed in (station, before))
        uneven = [span for span in way[before] if isinstance(span, Constraint) and span.error]
        path: Path = (*part.path, "held")
        message = f"'{part.name}' is fixed, and rigid parts alone join it to '{earlier.name}', which is fixed too"
        if uneven:
            joint = train.parts[uneven[-1].part]
            path, ends = joint.path, f"'{earlier.name}' and '{part.name}'"
            message = f"'{joint.name}' cannot turn: {ends} are fixed, with nothing elastic between"
        faults.append(Fault(path, message, "put a stiffness between them, or fix one of them only"))
    return faults
