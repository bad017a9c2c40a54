"""Machines with blades in a fluid: pumps, fans, and propellers with what models of damping and ice rules need."""

from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.model.component import Lowering
from torsion.model.machine import INERTIA_FOR_HELD, Machine
from torsion.model.parts import ImpellerRecord, PropellerRecord, Symbol
from torsion.primitives import Torque

Ratio = Annotated[float, Quantity("1", above=0, usual="ratio of a propeller")]


class BladeTorque(Declared):
    """One harmonic component of blade-order excitation."""

    blade_order: Annotated[int, Field(ge=1, le=20)] = required("1 is once per blade passing")
    torque: fields.TorqueAmount = required("amplitude (zero to peak): % of the mean torque, or N m")
    phase: fields.Angle = given("phase at angle zero", 0.0)


def _read_entrained(value: Any) -> tuple[str, float]:
    unit = "1" if isinstance(value, str) and value.strip().endswith("%") else "kg*m**2"
    return unit, Quantity(unit, at_least=0).read(value)


class BladedMachine(Machine, usual_load="quadratic", symbol=Symbol("fluid")):
    """A machine with blades or vanes in a fluid."""

    entrained: Annotated[
        Any, BeforeValidator(_read_entrained, json_schema_input_type=float | str)
    ] = given("entrained water: % of dry, or kg*m**2")
    blades: Annotated[int, Field(ge=1, le=20)] | None = given("number of blades or vanes")
    diameter: Annotated[float, Quantity("m", above=0, usual="diameter of a propeller")] | None = (
        given("diameter")
    )
    excitation: tuple[BladeTorque, ...] = given("list of {blade_order, torque, phase}", ())

    def refuse_clashes(self) -> None:
        if self.excitation and self.blades is None:
            message = "`blades` is missing; blade orders need the number of blades"
            raise refuse(message, key="excitation")
        if self.held and (self.entrained is not None or self.excitation):
            key = "excitation" if self.excitation else "entrained"
            raise refuse(f"a fixed {self.keyword} has no `{key}`", INERTIA_FOR_HELD, key)
        if self.entrained and self.inertia:
            unit, amount = self.entrained
            share, hint = (amount, "") if unit == "1" else (amount / self.inertia, f"{amount:g} %?")
            words = f"the entrained water has {{}} times the inertia of the {self.keyword}"
            self.refuse_unusual("entrained water over inertia", share, words, hint, "entrained")
        super().refuse_clashes()

    @property
    def impeller(self) -> ImpellerRecord:
        """Its inertia in parts, and its blades."""
        unit, amount = self.entrained or ("", 0.0)
        dry = self.inertia or 0.0
        water = None if self.entrained is None else dry * amount if unit == "1" else amount
        return ImpellerRecord(dry, water, self.blades, self.diameter)

    def lower(self, build: Lowering) -> None:
        impeller = self.impeller
        station = self.lower_rotor(build, "dry" if impeller.water else "")
        if not self.held:
            build.record(impeller)
        build.inertia(station, impeller.water or 0.0, "entrained water")
        for number, harmonic in enumerate(self.excitation):
            order, amount = Fraction(harmonic.blade_order * (self.blades or 0)), harmonic.torque
            size = amount.torque, amount.of_mean, ()
            path = (*build.parts[-1].path, "excitation", number)
            torque = Torque(
                build.name, station, order, None, *size, harmonic.phase, path, self.source
            )
            build.add(torque)


class Pump(BladedMachine, keyword="pump"):
    """A pump absorbs power. By default its torque grows with the square of the speed."""

    title = "rotodynamic pump with blade orders and entrained water"
    example = """\
- pump: {inertia: 3, power: 400 kW}
- pump: {inertia: 3, entrained: 20 %, power: 400 kW, load: {exponent: 2, at_rest: 20 %}, blades: 6,
         excitation: [{blade_order: 1, torque: 2 %}]}"""


class Fan(BladedMachine, keyword="fan"):
    """A fan absorbs power. By default its torque grows with the square of the speed."""

    title = "fan or blower with blade orders"
    example = "- fan: {inertia: 45 kg*m**2, power: 200 kW, speed: 1470 rpm}"


class Propeller(BladedMachine, keyword="propeller"):
    """A propeller absorbs power. Its data include entrained water, damping and blade orders."""

    title = "ship propeller with entrained water, damping, blade orders and ice"
    example = """\
- propeller: {inertia: 42}
- propeller: {inertia: 42, entrained: 25 %, blades: 4, damping: {model: archer, factor: 30},
              excitation: [{blade_order: 1, torque: 6 %}, {blade_order: 2, torque: 2 %}]}"""
    groups = (
        ("Inertia and damping", "inertia held tolerance entrained damping"),
        ("Power and load", "power torque speed load drive"),
        ("Geometry", "blades diameter pitch pitch_ratio hub_ratio area_ratio ducted"),
        ("Excitation", "excitation"),
    )

    inertia: fields.Inertia | None = given("dry polar mass moment of inertia")
    tolerance: fields.Tolerance | None = given(
        "tolerance of the inertia and of the entrained water, for example 10 %"
    )
    pitch: Literal["fixed", "controllable"] | None = given(
        "kind of the propeller: with a controllable pitch class rules demand zero pitch too, as a case"
    )
    pitch_ratio: Ratio | None = given("pitch / diameter; at 0.7 of the radius where ice is milled")
    hub_ratio: (
        Annotated[float, Quantity("1", above=0, below=1, usual="ratio of a propeller")] | None
    ) = given("diameter of the hub / diameter; for the ice torque of a class")
    ducted: bool = given("it turns in a duct; for the ice torque of a class", False)
    area_ratio: Ratio | None = given("expanded blade area / disc area")

    @property
    def impeller(self) -> PropellerRecord:
        """Its inertia in parts, its blades and its size."""
        return PropellerRecord(
            **vars(super().impeller),
            pitch_ratio=self.pitch_ratio,
            area_ratio=self.area_ratio,
            hub_ratio=self.hub_ratio,
            is_ducted=self.ducted,
            pitch=self.pitch,
        )
