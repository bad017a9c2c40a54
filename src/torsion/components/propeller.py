"""A propeller: inertia with entrained water, damping by one of the usual models, blade-order excitation."""

import math
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.components.component import Component
from torsion.components.lowering import Lowering, PropellerRecord
from torsion.fields import Declared, Quantity, given, refuse, required
from torsion.primitives import Damper, Torque

SEA_WATER = 1025.0  # kg/m3
USUAL_FACTOR = {"archer": "30", "frahm": "3", "quasi-steady": "2 - J K_Q'/K_Q of the open-water curve"}
Ratio = Annotated[float, Quantity("1", above=0, usual=(None, 5.0), slip=("%",))]


class BladeTorque(Declared):
    """One harmonic component of blade-order excitation."""

    blade_order: Annotated[int, Field(ge=1, le=20)] = required("1 is once per blade passing")
    torque: fields.TorqueAmount = required("amplitude (half range): % of the mean torque, or N m")
    phase: fields.Angle = given("phase at angle zero", 0.0)


class PropellerDamping(Declared):
    """A damping of the propeller; the report prints which model was used."""

    model: Literal["viscous", "archer", "schwanecke", "frahm", "quasi-steady"] = required("the model")
    value: fields.Damping | None = given("of `viscous`: the damping itself")
    factor: fields.Number | None = given("of archer (20..40 with n in rpm), frahm (2..4), quasi-steady: the factor")

    def refuse_clashes(self) -> None:
        if self.model in USUAL_FACTOR and self.factor is None:
            raise refuse(f"`factor` is missing for {self.model}", f"usual: {USUAL_FACTOR[self.model]}")
        if self.model == "viscous" and self.value is None:
            raise refuse("`value` is missing", "damping in N*m*s/rad")
        if self.model == "schwanecke" and self.factor is not None:
            raise refuse("schwanecke has no `factor`", "it follows from diameter, pitch_ratio and area_ratio", "factor")
        if self.model != "viscous" and self.value is not None:
            raise refuse(f"{self.model} has no `value`", "give `factor`, or the value alone", "value")


def _plain_value(value: Any) -> Any:
    return value if isinstance(value, dict | PropellerDamping) else {"model": "viscous", "value": value}


def _read_entrained(value: Any) -> tuple[str, float]:
    unit = "1" if isinstance(value, str) and value.strip().endswith("%") else "kg*m**2"
    return unit, Quantity(unit, at_least=0).read(value)


class Propeller(Component, keyword="propeller", sort="point"):
    """A propeller, impeller or other rotor that absorbs the power."""

    inertia: fields.Inertia = required("dry polar mass moment of inertia")
    entrained: Annotated[Any, BeforeValidator(_read_entrained, json_schema_input_type=float | str)] = given(
        "entrained water: % of dry, or kg*m**2"
    )
    tolerance: fields.Tolerance | None = given("tolerance of the inertia and of the entrained water, for example 10 %")
    blades: Annotated[int, Field(ge=1, le=20)] | None = given("number of blades")
    diameter: Annotated[float, Quantity("m", above=0, usual=(None, 400.0), slip=("mm",))] | None = given("diameter")
    pitch: Literal["fixed", "controllable"] | None = given(
        "kind of the propeller: with a controllable pitch class rules demand zero pitch too, as a case"
    )
    pitch_ratio: Ratio | None = given("pitch / diameter; at 0.7 of the radius where ice is milled")
    hub_ratio: Annotated[float, Quantity("1", above=0, below=1, slip=("%",))] | None = given(
        "diameter of the hub / diameter; for the ice torque of a class"
    )
    ducted: bool = given("it turns in a duct; for the ice torque of a class", False)
    area_ratio: Ratio | None = given("expanded blade area / disc area")
    damping: Annotated[PropellerDamping, BeforeValidator(_plain_value, float | str | PropellerDamping)] | None = given(
        "N*m*s/rad, or {model: archer | schwanecke | frahm | quasi-steady, factor}"
    )
    excitation: tuple[BladeTorque, ...] = given("list of {blade_order, torque, phase}", ())

    def refuse_clashes(self) -> None:
        if self.excitation and self.blades is None:
            raise refuse("`blades` is missing; blade orders need the number of blades", key="excitation")
        needed = ("diameter", "pitch_ratio", "area_ratio")
        missing = [key for key in needed if getattr(self, key) is None]
        if self.damping is not None and self.damping.model == "schwanecke" and missing:
            raise refuse(f"schwanecke needs {', '.join(missing)}", key="damping")

    def lower(self, build: Lowering) -> None:
        model, factor = ("viscous", None) if self.damping is None else (self.damping.model, self.damping.factor)
        unit, amount = self.entrained or ("", 0.0)
        water = self.inertia * amount if unit == "1" else amount
        entrained = None if self.entrained is None else water
        shape = self.blades, self.diameter, self.pitch_ratio, self.area_ratio
        build.record(propeller=PropellerRecord(
            self.inertia, entrained, *shape, model, factor, self.hub_ratio, self.ducted, self.pitch,
        ))  # fmt: skip
        here = build.point()
        build.record(inertia_tolerance=self.tolerance)
        build.inertia(here, self.inertia, "dry" if water else "")
        build.inertia(here, water, "entrained water")
        if self.damping is not None:
            build.add(self.damper(self.damping, here, build))
        for place, line in enumerate(self.excitation):
            order = Fraction(line.blade_order * (self.blades or 0))
            size, path = line.torque, (*build.parts[-1].path, "excitation", place)
            amount = size.torque, size.of_mean, ()
            build.add(Torque(build.name, here, order, None, *amount, line.phase, path, self.source))

    def damper(self, damping: PropellerDamping, station: int, build: Lowering) -> Damper:
        """Damping to ground: Archer A Q/n with n in rpm, Frahm and quasi-steady a Q/omega, Schwanecke ~ omega.

        Schwanecke: 0.0231 rho D^5 (P/D)^2 EAR/pi per speed, N m s2/rad2 (to be verified against its source).
        """
        if damping.model == "viscous":
            return Damper(station, constant=build.own(damping.value or 0.0))
        if damping.model == "schwanecke":
            diameter, pitch, area = self.diameter or 0.0, self.pitch_ratio or 0.0, self.area_ratio or 0.0
            return Damper(station, speed_factor=0.0231 * SEA_WATER * diameter**5 * pitch**2 * area / math.pi)
        factor = damping.factor or 0.0
        return Damper(station, torque_factor=factor * 2.0 * math.pi / 60.0 if damping.model == "archer" else factor)
