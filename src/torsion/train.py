"""The train: its components as placed, its stations with their speed ratios, and its primitives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from difflib import get_close_matches
from fractions import Fraction

from torsion.components.base import Component
from torsion.components.excitation import Excitation
from torsion.components.lowering import Lowering, Part
from torsion.components.material import STEEL, Material
from torsion.errors import Fault, InputError, Path
from torsion.primitives import Bar, Constraint, Damper, Inertia, Spring, Station, Torque


@dataclass(frozen=True)
class Link:
    """A component between two named points that closes a loop."""

    between: tuple[str, str]
    component: Component


@dataclass(frozen=True)
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

    def part(self, name: str) -> Part:
        """The component of that name; raises KeyError."""
        for part in self.parts:
            if part.name == name:
                return part
        raise KeyError(name)

    def ratio(self, name: str) -> Fraction:
        """Speed of a component / speed of the reference station."""
        return self.part(name).ratio


def train(
    components: Sequence[Component],
    *,
    excitations: Sequence[Excitation] = (),
    links: Sequence[Link] = (),
    materials: Mapping[str, Material] | None = None,
    reference: str | None = None,
) -> Train:
    """Lower a list of components; every speed ratio counts from the component called `reference` (default: the first).

    Raises InputError with every fault of the train as a whole.
    """
    build = Lowering({"steel": STEEL, **(materials or {})})
    build.walk(components, ("train",))
    if not build.stations:
        build.faults.append(Fault(("train",), "the train has no component that turns", "list its components"))
    for position, link in enumerate(links):
        _close(build, link, ("links", position))
    for position, excitation in enumerate(excitations):
        point = _point(build, excitation.at, ("excitations", position, "at"))
        if point is not None:
            build.add(excitation.on(point.stations[0]))
    _names(build)
    unit = _reference(build, reference)
    if build.faults:
        raise InputError(build.faults)
    return _train(build, unit)


def _train(build: Lowering, unit: Fraction) -> Train:
    def of(kind: type) -> tuple:  # type: ignore[type-arg]
        return tuple(p for p in build.primitives if isinstance(p, kind))

    return Train(
        parts=tuple(_counted(part, unit) for part in build.parts),
        stations=tuple(replace(station, ratio=station.ratio / unit) for station in build.stations),
        inertias=of(Inertia), springs=of(Spring), bars=of(Bar), constraints=of(Constraint),
        dampers=of(Damper), torques=of(Torque), materials=build.materials,
    )  # fmt: skip


def _counted(part: Part, unit: Fraction) -> Part:
    """The part with its speeds counted from the reference component's."""
    referred_to = None if part.referred_to is None else part.referred_to / unit
    return replace(part, ratio=part.ratio / unit, referred_to=referred_to)


def _point(build: Lowering, name: str, path: Path) -> Part | None:
    """The point called `name`; a fault is noted where there is none."""
    points = {part.name: part for part in build.parts if part.component.sort == "point"}
    if name in points:
        return points[name]
    others = {part.name: part.component.keyword for part in build.parts}
    if name in others:
        build.faults.append(Fault(path, f"'{name}' is a {others[name]}, not a point", f"points: {', '.join(points)}"))
    else:
        near = get_close_matches(name, points, 1)
        hint = f"did you mean '{near[0]}'?" if near else f"points: {', '.join(points)}"
        build.faults.append(Fault(path, f"no component is called '{name}'", hint))
    return None


def _close(build: Lowering, link: Link, path: Path) -> None:
    """Lower a link between two points of equal speed and sense."""
    first, second = (_point(build, name, (*path, "between", side)) for side, name in enumerate(link.between))
    if first is None or second is None:
        return
    both, place = f"'{first.name}' and '{second.name}'", (*path, "between")
    senses = {build.stations[part.stations[0]].sense for part in (first, second)}
    if first.stations == second.stations or first.ratio != second.ratio or len(senses) > 1:
        hint = "a link joins two different points of the same speed and sense of rotation"
        build.faults.append(Fault(place, f"{both} do not turn together", hint))
    elif first.referred_to != second.referred_to:
        message = f"{both} are not referred to one speed, and so the link's figures to neither"
        build.faults.append(Fault(place, message, "refer both (gear: referred), or neither"))
    else:
        build.join(first, second, link.component, path)


def _names(build: Lowering) -> None:
    seen: dict[str, Path] = {}
    for part in build.parts:
        if part.name in seen:
            where = ".".join(str(step) for step in seen[part.name])
            path = (*part.path, "name") if part.component.name else part.path
            build.faults.append(Fault(path, f"the name '{part.name}' is taken by {where}", "names are unique"))
        seen.setdefault(part.name, part.path)


def _reference(build: Lowering, name: str | None) -> Fraction:
    if name is None:
        return Fraction(1)
    for part in build.parts:
        if part.name == name:
            return part.ratio
    near = get_close_matches(name, [part.name for part in build.parts], 1)
    hint = f"did you mean '{near[0]}'?" if near else "the name of a component"
    build.faults.append(Fault(("operation", "at"), f"no component is called '{name}'", hint))
    return Fraction(1)
