"""A reciprocating compressor or pump: crank throws, and the torque that the pressures in its cylinders absorb."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from pathlib import Path as FilePath
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field

from torsion import fields, units
from torsion.errors import Fault, Path
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.kernels.engine.gas_law import CylinderOrder, GasLaw
from torsion.kernels.engine.gas_torque import Cylinder
from torsion.model.component import Component
from torsion.model.compressor.ends import Pressures, end_of
from torsion.model.compressor.record import CompressorRecord, End, EndRecord, ThrowRecord
from torsion.model.engine.crankshaft import Crankshaft, of
from torsion.model.engine.declarations import Crankcase, Length
from torsion.model.engine.gas_laws import GasFault
from torsion.model.lowering import Lowering, Mass
from torsion.primitives import Torque

SMALL = 1e-9  # of the largest harmonic: a mean torque that is rounding
VARYING = 8  # harmonics of the inertia over a revolution that are kept


def _pressures(value: Any) -> Any:
    """A constant pressure (Pa), else the name of a file."""
    if isinstance(value, str):
        try:
            units.to_si(value, "Pa")
        except units.UnitFault:
            if value.strip():
                return value
            raise refuse("the name of the file is empty", "head_end: stage_1.csv") from None
    return Quantity("Pa", above=0, usual="pressure of a gas").read(value)


EndPressures = Annotated[Any, BeforeValidator(_pressures, json_schema_input_type=float | str)]


class CompressorThrow(Declared):
    """A throw with the cylinder on it."""

    angle: fields.Angle = required(
        "crank angle of the dead centre of the head end (smallest volume of the head "
        "end); it includes the direction of the cylinder: 0 deg for both throws of an "
        "opposed pair"
    )
    bore: Length = required("diameter of the cylinder")
    piston_rod: Annotated[float, Quantity("m", at_least=0, usual="piston rod")] = given(
        "diameter of the piston rod, which takes area from the crank end", 0.0
    )
    tail_rod: Annotated[float, Quantity("m", at_least=0, usual="piston rod")] = given(
        "diameter of a tail rod, which takes area from the head end", 0.0
    )
    reciprocating: Mass = given("piston, rods, crosshead and the connecting rod's share", 0.0)
    head_end: EndPressures | None = given(
        "its pressures, or a constant one of an end that is unloaded; without it the "
        "end is open to the surroundings"
    )
    crank_end: EndPressures | None = given("the same of the end on the side of the crank")

    def refuse_clashes(self) -> None:
        for key in ("piston_rod", "tail_rod"):
            if getattr(self, key) >= self.bore:
                raise refuse("the rod is not thinner than the bore", "both are diameters", key)


class Compressor(Component, keyword="compressor", sort="line"):
    """A reciprocating compressor or pump with its crankshaft; it absorbs the mean torque."""

    stroke: Length = required("way of the pistons")
    rod_length: Length = required("connecting rod, between the centres of its eyes")
    throws: Annotated[tuple[CompressorThrow, ...], Field(min_length=1, max_length=20)] = required(
        "from the first end of the crankshaft"
    )
    absolute: bool | None = given("true: pressures are absolute; false: gauge pressures")
    surroundings: Crankcase = given("absolute pressure outside of the cylinders", 101325.0)
    tdc: fields.Angle | None = given(
        "angle in files over the crank angle at which the head end is at its dead centre"
    )
    mechanical_efficiency: Annotated[
        float, Quantity("1", above=0, at_most=1, usual="efficiency")
    ] = given("torque of the gas / that at the shaft", 1.0)
    reverse: bool = given("true: the train meets its last throw first", False)
    inertia: Annotated[tuple[fields.Inertia, ...], OneOrMany] = given(
        "of every throw with the mean of its moving masses; one value for all", ()
    )
    crank_inertia: Annotated[tuple[fields.Inertia, ...], OneOrMany] = given(
        "of every throw without masses, in place of `inertia`; the mean of `reciprocating` is added",
        (),
    )
    stiffness: Annotated[tuple[fields.Stiffness, ...], OneOrMany] = given(
        "between throws; one value for all", ()
    )
    damping: Annotated[tuple[fields.Damping, ...], OneOrMany] = given(
        "to ground, by throw; one value for all", ()
    )
    loss_factor: fields.LossFactor = given("of the crank spans", 0.0)
    orders: Annotated[int, Field(ge=1, le=48)] = given("highest order of the crankshaft", 12)

    @classmethod
    def points_within(cls, name: str, body: Mapping[str, Any]) -> Iterator[str]:
        throws = body.get("throws")
        if isinstance(throws, list):
            yield from (f"{name} throw {place}" for place in range(1, len(throws) + 1))

    def refuse_clashes(self) -> None:
        if self.rod_length <= self.stroke / 2.0:
            message = "the rod is not longer than half the stroke"
            raise refuse(message, "the piston could not pass its dead centres", "rod_length")
        if bool(self.inertia) == bool(self.crank_inertia):
            raise refuse(
                "give `inertia`, or `crank_inertia`",
                "crank_inertia: 2.5 kg*m**2",
                "crank_inertia" if self.inertia else "",
            )
        number = len(self.throws)
        for key, most in (
            ("inertia", number),
            ("crank_inertia", number),
            ("damping", number),
            ("stiffness", number - 1),
        ):
            values = getattr(self, key)
            if len(values) not in (0, 1, most):
                what = "throws" if most == number else "spans between them"
                hint = "one value, or each"
                raise refuse(
                    f"`{key}` has {len(values)} values, and there are {most} {what}", hint, key
                )
        if number > 1 and not self.stiffness:
            raise refuse(
                "`stiffness` of the crank spans is missing", "between throws; one value for all"
            )
        ends = [
            end for one in self.throws for end in (one.head_end, one.crank_end) if end is not None
        ]
        if ends and self.absolute is None:
            raise refuse(
                "`absolute` is missing",
                "absolute: true, or false of pressures above the surroundings",
            )
        if not ends and not any(one.reciprocating for one in self.throws):
            raise refuse(
                "nothing excites: pressures and masses are missing",
                "give `head_end` and `crank_end`",
            )

    def lower(self, build: Lowering) -> None:
        owner, slider = build.part, CrankSlider.of_stroke(self.stroke, self.rod_length)
        names = tuple(f"throw {place}" for place in range(1, len(self.throws) + 1))
        crankshaft = Crankshaft(
            names, self.stiffness, self.damping, self.loss_factor, reverse=self.reverse
        )
        stations, _ = crankshaft.lower(
            build, lambda here, throw: self._masses(build, here, throw, slider)
        )
        path, first = build.parts[owner].path, len(build.faults)
        throws = []
        for place, station in enumerate(stations):
            ends = tuple(self._ends(build, owner, place, slider))
            throws.append(self._throw(place, station, ends, slider))
        record = CompressorRecord(
            owner, tuple(throws), self.mechanical_efficiency, tuple(self._words(slider))
        )
        build.parts[owner] = replace(build.parts[owner], compressor=record)
        if len(build.faults) == first:
            self._refuse_driving(build, record)
            for torque in self._torques(build, record, path):
                build.add(torque)

    def _masses(self, build: Lowering, here: int, throw: int, slider: CrankSlider) -> None:
        if self.inertia:
            build.inertia(here, of(self.inertia, throw))
            return
        build.inertia(here, of(self.crank_inertia, throw), "crank")
        mean = slider.inertia_harmonics(0, self.throws[throw].reciprocating)[0].real
        build.inertia(here, float(mean), "moving masses, mean")

    def _ends(
        self, build: Lowering, owner: int, place: int, slider: CrankSlider
    ) -> Iterator[EndRecord]:
        """The working sides of a piston; a fault is noted where the file's figures give none."""
        one = self.throws[place]
        pressures = Pressures(
            FilePath(build.folder), bool(self.absolute), self.surroundings, self.tdc, self.orders
        )
        sides: tuple[tuple[End, str, Any, float], ...] = (
            ("head end", "head_end", one.head_end, one.tail_rod),
            ("crank end", "crank_end", one.crank_end, one.piston_rod),
        )
        for end, key, pressure, rod in sides:
            if pressure is None:
                continue
            cylinder = Cylinder(slider, math.pi / 4.0 * (one.bore**2 - rod**2), 1)
            try:
                yield end_of(end, pressure, cylinder, pressures)
            except GasFault as fault:
                build.faults.append(self._fault(build, owner, (place, key), fault))

    @staticmethod
    def _fault(build: Lowering, owner: int, where: tuple[int, str], fault: GasFault) -> Fault:
        return Fault((*build.parts[owner].path, "throws", *where), fault.message, fault.hint)

    def _throw(
        self, place: int, station: int, ends: tuple[EndRecord, ...], slider: CrankSlider
    ) -> ThrowRecord:
        one = self.throws[place]
        gas = (
            np.sum([end.torque for end in ends], axis=0)
            if ends
            else np.zeros(self.orders + 1, dtype=np.complex128)
        )
        return ThrowRecord(
            place + 1,
            station,
            one.angle,
            ends,
            np.asarray(gas),
            slider.inertia_torque(self.orders, one.reciprocating),
            slider.inertia_harmonics(VARYING, one.reciprocating),
        )

    def _refuse_driving(self, build: Lowering, record: CompressorRecord) -> None:
        """A throw that gives work: its rows run backwards, or the ends are exchanged."""
        for one in record.throws:
            for end in one.ends:
                drives = float(end.torque[0].real)
                if drives > SMALL * float(np.abs(end.torque).max()):
                    key = "head_end" if end.end == "head end" else "crank_end"
                    message = f"the {end.end} of throw {one.number} drives the shaft: {drives:.5g} N m on the mean"
                    hint = (
                        "rows follow the motion of the piston; volume and travel count from the dead centre of "
                        "the same end"
                    )
                    fault = GasFault(message, hint)
                    build.faults.append(
                        self._fault(build, record.part, (one.number - 1, key), fault)
                    )

    def _torques(self, build: Lowering, record: CompressorRecord, path: Path) -> Iterator[Torque]:
        """One primitive for every throw and order that is there."""
        for one in record.throws:
            name = build.stations[one.station].name
            law = GasLaw("nothing", np.zeros(1), one.gas[None, :])
            for order in range(1, self.orders + 1):
                if one.gas[order] or one.inertia[order]:
                    cylinder = CylinderOrder(
                        law,
                        order,
                        complex(one.inertia[order]),
                        one.phasor(order),
                        one.station,
                        1.0,
                        engine=record.part,
                    )
                    yield Torque(
                        name,
                        one.station,
                        Fraction(order),
                        path=path,
                        source=self.source,
                        cylinder=cylinder,
                    )

    def _words(self, slider: CrankSlider) -> Iterator[tuple[str, str]]:
        """Figures of the data sheet."""
        yield "Throws", str(len(self.throws))
        yield "Stroke, connecting rod", f"{1e3 * self.stroke:.6g}, {1e3 * self.rod_length:.6g} mm"
        yield "Radius / rod", f"{slider.radius / slider.rod:.5g}"
        yield "Pressure outside of the cylinders", f"{self.surroundings / 1e5:.5g} bar"
