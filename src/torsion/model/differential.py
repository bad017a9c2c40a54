"""A differential with two equal halves, by their motion together and their motion against each other."""

import math
from dataclasses import replace
from typing import Annotated, Any

from pydantic import Field

from torsion import fields
from torsion.errors import Fault, Path
from torsion.fields import Declared, given, refuse, required
from torsion.model.component import Line, lower_branch
from torsion.model.lowering import Lowering, Part
from torsion.primitives import Bar, Constraint, Damper, Inertia, Primitive, Section, Spring, Torque

Teeth = Annotated[int, Field(ge=1, le=1000)]
KINDS = (
    "coupling",
    "shaft",
    "disc",
    "propeller",
    "damper",
    "gear",
    "branch",
    "planets",
)  # that a half may have
OPPOSED = " opposed"
TOGETHER = "both halves downstream of {} together, with one angle; each carries half of the torque"
AGAINST = "the halves downstream of {} against each other, with opposite angles; each carries half of the torque"


class Differential(Declared):
    """What stands behind the case of a differential: two equal halves, which share its torque equally."""

    train: Line = required("the train of one half, from its side gear; the other half is equal")
    side_gear: fields.Inertia = given("inertia of each side gear", 0.0)
    planets: Annotated[int, Field(ge=1, le=100)] = given(
        "how many planets (differential pinions)", 2
    )
    planet_inertia: fields.Inertia = given("of one planet about its own axis", 0.0)
    teeth: Annotated[tuple[Teeth, ...], Field(min_length=2, max_length=2)] | None = given(
        "[side gear, planet]"
    )

    def refuse_clashes(self) -> None:
        if self.planet_inertia and self.teeth is None:
            raise refuse(
                "`planet_inertia` needs `teeth: [side gear, planet]`",
                "they say how fast the planets turn",
            )

    def lower(self, build: Lowering, gear: Part, case: int) -> None:
        """Lower the halves twice: together, on the case, and against each other, apart from all else.

        With the angles s + a and s - a of two equal halves all energies are those of two trains of twice their inertia
        and stiffness, one of angles s and one of angles a. The case turns with s alone (its speed is the mean of
        both halves'), so that nothing joins the second train to anything.
        """
        path, main, number = (*gear.path, "differential", "train"), build.at, build.number.copy()
        build.inertia(case, 2.0 * self.side_gear, "side gears")
        self._halves(build, gear, case, path)
        build.number, faults = number, len(build.faults)
        begin = len(build.parts), len(build.stations), len(build.primitives)
        build.member(gear, "side gears", "disc", is_point=True)
        free = build.station(build.name)
        build.record(stations=(free,), depth=gear.depth + 1)
        spin = 0.0 if self.teeth is None else self.teeth[0] / self.teeth[1]
        build.inertia(free, 2.0 * self.side_gear, "both")
        build.inertia(free, self.planets * self.planet_inertia * spin**2, f"{self.planets} planets")
        self._halves(build, gear, free, path)
        del build.faults[faults:]
        _oppose(build, begin, gear.name)
        build.at = main

    def _halves(self, build: Lowering, gear: Part, station: int, path: Path) -> None:
        """Lower the train of both halves together from a station."""
        parts, first = len(build.parts), len(build.primitives)
        lower_branch(build, replace(build.at, here=station, is_open=False), self.train, path)
        for k in range(parts, len(build.parts)):
            if (fault := _fault(build.parts[k])) is not None:
                build.faults.append(fault)
            build.parts[k] = _doubled_part(build.parts[k], gear.name)
        for k in range(first, len(build.primitives)):
            doubled = _doubled(build.primitives[k])
            if isinstance(doubled, str):
                part = build.parts[getattr(build.primitives[k], "part", -1)]
                build.faults.append(
                    Fault(
                        part.path, f"the half of a differential does not support: {doubled}", HINT
                    )
                )
            else:
                build.primitives[k] = doubled


HINT = "give a plain stiffness and discs, or write the train without `differential`"


def _fault(part: Part) -> Fault | None:
    """What a half cannot have, of a component."""
    what = "" if part.kind in KINDS else part.kind
    if part.nonlinear is not None or part.warming is not None:
        what = "coupling that is nonlinear or warms"
    if part.machine is not None and part.machine.is_stated:
        what = f"{part.kind} with `power`, `torque` or a table of `load`"
    if part.shaft is not None and (part.shaft.role is not None or part.shaft.support):
        what = "shaft with `role` or `support`"
    return (
        Fault(part.path, f"the half of a differential does not support: {what}", HINT)
        if what
        else None
    )


def _doubled_part(part: Part, gear: str) -> Part:
    """With the limits of both halves."""

    def twice(limit: float | None) -> float | None:
        return None if limit is None else 2.0 * limit

    ratings = None if part.ratings is None else part.ratings.times(2.0)
    remark = part.remark or TOGETHER.format(gear)
    return replace(part, ratings=ratings, max_torque=twice(part.max_torque), remark=remark)


def _doubled(one: Primitive) -> Primitive | str:
    """Two equal ones as one of twice their inertia, stiffness and damping; what it is where that is not possible."""
    match one:
        case Inertia():
            return replace(one, inertia=2.0 * one.inertia)
        case Spring() if one.table is not None:
            return "coupling by table"
        case Spring():
            return replace(one, flexibility=one.flexibility / 2.0, viscous=2.0 * one.viscous)
        case Bar():
            return _doubled_bar(one)
        case Constraint() if one.error or one.toothing is not None:
            return "joint" if one.error else "gear with `module` or `pitch_diameter`"
        case Constraint():
            return replace(one, flexibility=one.flexibility / 2.0)
        case Damper():  # torque_factor and load_factor go with the mean torque there, which is that of both
            return replace(one, constant=2.0 * one.constant, speed_factor=2.0 * one.speed_factor)
        case Torque():
            table = tuple((speed, 2.0 * torque) for speed, torque in one.table)
            return replace(one, torque=2.0 * one.torque, table=table)


def _doubled_bar(bar: Bar) -> Bar | str:
    """One shaft of twice the torsion constant, polar moment and stress modulus."""
    if bar.section is not None and not isinstance(bar.section, Section):
        return "shaft with a meshed `section`"
    if bar.outer[0] != bar.outer[1] or bar.bore[0] != bar.bore[1]:
        return "conical shaft"
    outer, bore = bar.outer[0], bar.bore[0]
    polar = math.pi * (outer**4 - bore**4) / 16.0  # twice that of one
    modulus = 2.0 * polar / outer
    if bar.section is not None:
        return replace(
            bar,
            section=replace(bar.section, **{k: 2.0 * v for k, v in vars(bar.section).items()}),
            outer=(2.0**0.25 * outer,) * 2,
        )
    return replace(
        bar,
        outer=((32.0 * polar / math.pi) ** 0.25,) * 2,
        bore=(0.0, 0.0),
        section=Section(polar, polar, modulus),
    )


def _oppose(build: Lowering, begin: tuple[int, int, int], gear: str) -> None:
    """Name what was lowered since then, and take away what does not act on halves that move against each other."""
    parts, stations, first = begin
    nothing: dict[str, Any] = {"ratings": None, "max_torque": None, "application_factor": None}
    nothing |= {"machine": None, "impeller": None, "propeller": None}
    for k in range(parts, len(build.parts)):
        own = build.parts[k]
        kind = "disc" if own.machine is not None else own.kind
        name = own.name + OPPOSED
        build.parts[k] = replace(
            own, name=name, kind=kind, remark=AGAINST.format(gear), is_opposed=True, **nothing
        )
    for k in range(stations, len(build.stations)):
        build.stations[k] = replace(build.stations[k], name=build.stations[k].name + OPPOSED)
    kept = [one for one in build.primitives[first:] if not isinstance(one, Torque)]
    build.primitives[first:] = [
        replace(one, name=one.name + OPPOSED) if isinstance(one, Spring | Bar | Constraint) else one
        for one in kept
    ]
