"""Machines, which drive or absorb: one set of keys, and by kind the words, the sign and the usual law of load."""

import math
from fractions import Fraction
from typing import Annotated, Any, ClassVar, Literal

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.fields import Declared, Quantity, exclusive, given, refuse, required
from torsion.model.component import Lowering, Rotor
from torsion.model.machine_torques import EXPONENTS, DriveLaw, Harmonic, Load, LoadLaw, Ripple
from torsion.model.parts import ImpellerRecord, MachineRecord, PropellerRecord, Symbol
from torsion.primitives import Damper, Spring, Torque
from torsion.sources import note

SEA_WATER = 1025.0  # kg/m3
INERTIA_FOR_HELD = "give its `inertia` in place of `held`"
DRIVER = Symbol("driver")
USUAL_FACTOR = {
    "archer": "30",
    "frahm": "3",
    "quasi-steady": "2 - J K_Q'/K_Q of the open-water curve",
}


class MachineDamping(Declared):
    """A damping to ground of a machine; the report prints which model was used."""

    model: Literal["viscous", "archer", "schwanecke", "frahm", "quasi-steady", "law"] = required(
        "the model; `law`: the slope of its law of load acts in vibration"
    )
    value: fields.Damping | None = given("of `viscous`: the damping itself")
    factor: fields.Number | None = given(
        "of archer (20..40 with n in rpm), frahm (2..4), quasi-steady: the factor"
    )

    def refuse_clashes(self) -> None:
        model, figures = self.model, self.keys_given("value", "factor")
        if model in USUAL_FACTOR and self.factor is None:
            raise refuse(f"`factor` is missing for {model}", f"usual: {USUAL_FACTOR[model]}")
        if model == "law" and figures:
            hint = "the law of load gives the damping; keep one of them"
            raise refuse(f"`damping: law` beside a `{figures[0]}`", hint, figures[0])
        if model == "viscous" and self.value is None:
            raise refuse("`value` is missing", "damping in N*m*s/rad")
        if model == "schwanecke" and self.factor is not None:
            hint = "it follows from diameter, pitch_ratio and area_ratio"
            raise refuse("schwanecke has no `factor`", hint, "factor")
        if model != "viscous" and self.value is not None:
            raise refuse(f"{model} has no `value`", "give `factor`, or only the value", "value")


# A plain value is a viscous damping, and the word `law` the model of that name.
_PLAIN_DAMPING = BeforeValidator(
    lambda value: (
        {"model": "law"}
        if value == "law"
        else value
        if isinstance(value, dict | MachineDamping)
        else {"model": "viscous", "value": value}
    ),
    float | str | MachineDamping,
)


class Machine(Rotor, symbol=Symbol("load")):
    """What every machine has: its inertia, and the power that it takes or gives."""

    drives_train: ClassVar[bool] = False
    usual_load: ClassVar[str] = ""  # law of load of its kind; empty: as `operation.load` says
    harmonics_key: ClassVar[str] = ""  # of its own harmonic torques
    clashes = (exclusive("power", "torque"),)

    damping: Annotated[MachineDamping, _PLAIN_DAMPING] | None = given(
        "N*m*s/rad, or {model: archer | schwanecke | frahm | quasi-steady, factor}, or `law`: slope of its law of load"
    )
    power: fields.Power | None = given("power that it absorbs or delivers at `speed`")
    torque: fields.PositiveTorque | None = given("the torque there, in place of `power`")
    speed: fields.Speed | None = given(
        "its own speed at that power (default: at `operation.rated.speed`)"
    )
    load: Load | None = given(
        "law of load over its own speed: constant, linear, quadratic (or propeller), constant-power, "
        "{exponent, at_rest}, or [[speed, torque], ...]"
    )

    drive: DriveLaw | None = given(
        "law of a machine that drives: {slip: 1 %}, {droop: 4 %}, {law: speed | torque} or {torque: [[speed, torque], "
        "...]}; `lag` lets its slope act in vibration (default: it delivers what the loads take, at a constant torque)"
    )

    @property
    def is_driver(self) -> bool:
        """The machine delivers power to the train: by its kind, or by its own key."""
        return getattr(self, "drives", self.drives_train)

    @property
    def harmonics(self) -> tuple[Harmonic, ...]:
        """The harmonic torques that the machine itself excites with."""
        torques: tuple[Harmonic, ...] = getattr(self, self.harmonics_key, ())
        return torques

    def refuse_clashes(self) -> None:
        sizes, drive = self.keys_given("power", "torque"), self.drive
        model = None if self.damping is None else self.damping.model
        if self.held and sizes and not self.is_driver:
            message = "a `held` machine takes what is left: leave out its power"
            raise refuse(message, "", sizes[0])
        if self.held and self.harmonics:
            key = self.harmonics_key
            message = f"a fixed {self.keyword} cannot be moved by its {key}"
            raise refuse(message, INERTIA_FOR_HELD, key)
        needed = ("diameter", "pitch_ratio", "area_ratio")
        missing = [key for key in needed if getattr(self, key, None) is None]
        if model == "schwanecke" and missing:
            raise refuse(f"schwanecke needs {', '.join(missing)}", key="damping")
        if self.is_driver and self.load is not None:
            raise refuse("`load` of a machine that drives", "give `drive`", "load")
        if drive is not None and not self.is_driver:
            raise refuse("`drive` on a machine that absorbs", "give `load`", "drive")
        if drive is not None and drive.lag is not None and not (self.speed is not None and sizes):
            message = "`lag` needs the `power` or `torque` of the machine and its `speed`, from which its slope follows"
            raise refuse(message, "for example `power: 200 kW, speed: 1500 rpm`", "drive")
        if self.is_driver and model == "law":
            raise refuse("`damping: law` is for a load", "give `drive` with a `lag`", "damping")
        if self.load is not None and self.load.table and sizes:
            message = f"`{sizes[0]}` and a table of `load` exclude each other"
            raise refuse(message, "the table states the torque", sizes[0])
        if self.speed is not None and not sizes:
            message = "`speed` belongs to a `power` or `torque`"
            raise refuse(message, "give one of them too", "speed")
        super().refuse_clashes()

    def lower_rotor(self, build: Lowering, what: str = "") -> int:
        damping, drive = self.damping or MachineDamping.model_construct(model="viscous"), self.drive
        usual_load = LoadLaw(EXPONENTS[self.usual_load]) if self.usual_load else None
        record = MachineRecord(
            self.is_driver,
            self.power,
            self.torque,
            self.speed,
            self.load,
            usual_load,
            self.held,
            drive,
            damping.model,
            damping.factor,
        )
        build.record(record)
        station = super().lower_rotor(build, what)
        if drive is not None and drive.lag is not None:
            # A slope s with a time constant is a damper s in series with a spring s/lag: s iω/(1 + iω lag).
            torque, name = record.rated_torque(0.0) or 0.0, f"{build.name} drive"
            slope = build.to_own_speed(drive.slope_at_rated(torque, self.speed or 0.0))
            field = build.station(name)
            spring = Spring(name, build.part, station, field, drive.lag / slope)
            build.add(spring, Damper(field, slope))
        # Damping to ground: Archer A Q/n with n in rpm, Frahm and quasi-steady a Q/omega, Schwanecke ~ omega:
        # 0.0231 rho D^5 (P/D)^2 EAR/pi per speed, N m s2/rad2 (to be verified against its source).
        factor = damping.factor or 0.0
        match damping.model:
            case "viscous" if not damping.value:
                return station
            case "viscous":
                damper = Damper(station, constant=build.to_own_speed(damping.value or 0.0))
            case "law":
                damper = Damper(station, load_factor=1.0)
            case "schwanecke":
                note("Schwanecke")
                keys = ("diameter", "pitch_ratio", "area_ratio")
                diameter, pitch, area = (getattr(self, key) for key in keys)
                size = 0.0231 * SEA_WATER * diameter**5 * pitch**2 * area / math.pi
                damper = Damper(station, speed_factor=size)
            case "archer":
                note("Archer")
                damper = Damper(station, torque_factor=factor * 2.0 * math.pi / 60.0)
            case _:
                if damping.model == "frahm":
                    note("Frahm")
                damper = Damper(station, torque_factor=factor)
        build.add(damper)
        return station

    def lower(self, build: Lowering) -> None:
        station = self.lower_rotor(build)
        for number, harmonic in enumerate(self.harmonics):
            path = (*build.parts[-1].path, self.harmonics_key, number)
            build.add(harmonic.primitive(build.name, station, path, self.source))


class GeneralMachine(Machine, keyword="machine"):
    """A machine absorbs power, or drives. Use it for a driven machine without a kind of its own."""

    title = "roll, mill, crusher, winch, test brake or other load"
    example = """\
- machine: {inertia: 2600, torque: 30 kN*m}
- machine: {name: mill, inertia: 2600, torque: 30 kN*m, load: constant,
           excitation: [{order: 3, torque: 5 %}]}"""

    harmonics_key = "excitation"
    drives: bool = given("true: it drives the train", False)
    excitation: tuple[Ripple, ...] = given(
        "its periodic torque: list of {order or frequency, torque, phase}", ()
    )


class RippleMachine(Machine):
    """A machine whose torque has a ripple by order or frequency."""

    ripple: tuple[Ripple, ...] = given(
        "torque ripple: list of {order or frequency, torque, phase}", ()
    )

    harmonics_key = "ripple"


class Motor(RippleMachine, keyword="motor", drives_train=True, symbol=DRIVER):
    """A motor drives the train, with ripple torques at orders of its shaft."""

    title = "electric motor or other driver"
    example = """\
- motor: {inertia: 8.5}
- motor: {inertia: 8.5, power: 400 kW, ripple: [{order: 6, torque: 1 %, phase: 30 deg}]}"""


class Turbine(RippleMachine, keyword="turbine", drives_train=True, symbol=DRIVER):
    """A turbine drives the train."""

    title = "turbine"
    example = "- turbine: {inertia: 1800 kg*m**2, source: drawing}"


class Generator(RippleMachine, keyword="generator", usual_load="constant"):
    """A generator absorbs power. By default its torque is constant over the speed."""

    title = "generator, alternator or exciter"
    example = """\
- generator: {inertia: 95, power: 1200 kW}
- generator: {inertia: 95, power: 1200 kW, load: constant-power, ripple: [{order: 2, torque: 1 %}]}"""


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
