"""A differential with two equal halves, by their motion together and their motion against each other."""

import math
from dataclasses import replace
from typing import Annotated

from pydantic import Field

from torsion import fields
from torsion.errors import Fault, Path
from torsion.fields import Declared, given, refuse, required
from torsion.model.component import Line, Lowering, lower_branch
from torsion.model.parts import CouplingRatings, GearRating, ImpellerRecord, MachineRecord, Part
from torsion.primitives import Bar, Constraint, Damper, Inertia, Primitive, Section, Spring, Torque

Teeth = Annotated[int, Field(ge=1, le=1000)]
# Kinds that a half may have.
KINDS = ("coupling", "shaft", "disc", "propeller", "damper", "gear", "branch", "planets")
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
            message = "`planet_inertia` needs `teeth: [side gear, planet]`"
            raise refuse(message, "they say how fast the planets turn")

    def lower(self, build: Lowering, gear: Part, case: int) -> None:
        """Lower the halves twice: together, on the case, and against each other, apart from all else.

        With the angles s + a and s - a of two equal halves all energies are those of two trains of twice their inertia
        and stiffness, one of angles s and one of angles a. The case turns with s alone (its speed is the mean of
        both halves'), so that nothing joins the second train to anything.
        """
        path, main = (*gear.path, "differential", "train"), build.arrival
        number = build.number.copy()
        build.inertia(case, 2.0 * self.side_gear, "side gears")
        self._halves(build, gear, case, path)
        build.number, faults = number, len(build.faults)
        parts, stations, first = len(build.parts), len(build.stations), len(build.primitives)
        build.member(gear, "side gears", "disc", is_point=True)
        free = build.station(build.name)
        build.place(stations=(free,), depth=gear.depth + 1)
        spin = 0.0 if self.teeth is None else self.teeth[0] / self.teeth[1]
        build.inertia(free, 2.0 * self.side_gear, "both")
        build.inertia(free, self.planets * self.planet_inertia * spin**2, f"{self.planets} planets")
        self._halves(build, gear, free, path)
        del build.faults[faults:]
        build.arrival = main

        # What does not act on halves that move against each other is taken away.
        nothing = (CouplingRatings, GearRating, MachineRecord, ImpellerRecord)
        build.parts[parts:] = [
            replace(
                part.without(*nothing),
                name=part.name + OPPOSED,
                kind="disc" if part.machine is not None else part.kind,
                remark=AGAINST.format(gear.name),
                is_opposed=True,
            )
            for part in build.parts[parts:]
        ]
        build.stations[stations:] = [
            replace(station, name=station.name + OPPOSED) for station in build.stations[stations:]
        ]
        build.primitives[first:] = [
            replace(primitive, name=primitive.name + OPPOSED)
            if isinstance(primitive, Spring | Bar | Constraint)
            else primitive
            for primitive in build.primitives[first:]
            if not isinstance(primitive, Torque)
        ]

    def _halves(self, build: Lowering, gear: Part, station: int, path: Path) -> None:
        """Lower the train of both halves together from a station."""
        parts, first = len(build.parts), len(build.primitives)
        lower_branch(
            build, replace(build.arrival, station=station, is_open=False), self.train, path
        )
        unsupported = list[tuple[Path, str]]()
        for k, part in enumerate(build.parts[parts:], parts):
            words = "" if part.kind in KINDS else part.kind
            if part.nonlinear is not None or part.warming is not None:
                words = "coupling that is nonlinear or warms"
            if part.machine is not None and part.machine.is_stated:
                words = f"{part.kind} with `power`, `torque` or a table of `load`"
            if part.shaft is not None and (part.shaft.role is not None or part.shaft.support):
                words = "shaft with `role` or `support`"
            unsupported.append((part.path, words))
            ratings = (
                record.times(2.0)
                for record in part.records
                if isinstance(record, CouplingRatings | GearRating)
            )
            remark = part.remark or TOGETHER.format(gear.name)
            build.parts[k] = replace(part.with_records(*ratings), remark=remark)
        for k, primitive in enumerate(build.primitives[first:], first):
            doubled = _doubled(primitive)
            if isinstance(doubled, str):
                owner = build.parts[getattr(primitive, "part", -1)]
                unsupported.append((owner.path, doubled))
            else:
                build.primitives[k] = doubled
        hint = "give a plain stiffness and discs, or write the train without `differential`"
        build.faults += [
            Fault(path, f"the half of a differential does not support: {words}", hint)
            for path, words in unsupported
            if words
        ]


def _doubled(primitive: Primitive) -> Primitive | str:
    """Two equal ones as one of twice their inertia, stiffness and damping; what it is where that is not possible."""
    match primitive:
        case Inertia():
            return replace(primitive, inertia=2.0 * primitive.inertia)
        case Spring() if primitive.table is not None:
            return "coupling by table"
        case Spring():
            return replace(
                primitive,
                flexibility=primitive.flexibility / 2.0,
                viscous=2.0 * primitive.viscous,
            )
        case Bar() if not isinstance(primitive.section, Section | None):
            return "shaft with a meshed `section`"
        case Bar(outer=(outer, other), bore=(bore, other_bore)) if (outer, bore) != (
            other,
            other_bore,
        ):
            return "conical shaft"
        case Bar(outer=(outer, _), bore=(bore, _)):
            # One shaft of twice the torsion constant, polar moment and stress modulus.
            if primitive.section is not None:
                sizes = {key: 2.0 * size for key, size in vars(primitive.section).items()}
                section = replace(primitive.section, **sizes)
                return replace(primitive, section=section, outer=(2.0**0.25 * outer,) * 2)
            polar = math.pi * (outer**4 - bore**4) / 16.0  # twice that of one
            return replace(
                primitive,
                outer=((32.0 * polar / math.pi) ** 0.25,) * 2,
                bore=(0.0, 0.0),
                section=Section(polar, polar, 2.0 * polar / outer),
            )
        case Constraint() if primitive.error or primitive.toothing is not None:
            return "joint" if primitive.error else "gear with `module` or `pitch_diameter`"
        case Constraint():
            return replace(primitive, flexibility=primitive.flexibility / 2.0)
        case Damper():  # torque_factor and load_factor go with the mean torque there, which is that of both
            return replace(
                primitive,
                constant=2.0 * primitive.constant,
                speed_factor=2.0 * primitive.speed_factor,
            )
        case Torque():
            table = tuple((speed, 2.0 * torque) for speed, torque in primitive.table)
            return replace(primitive, torque=2.0 * primitive.torque, table=table)
