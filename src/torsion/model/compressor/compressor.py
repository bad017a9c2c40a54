"""A reciprocating compressor or pump: crank throws, and the torque that the pressures in its cylinders absorb."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from pathlib import Path as FilePath
from typing import Annotated, Any

import numpy as np
from pydantic import BeforeValidator, Field

from torsion import fields, units
from torsion.arrays import FloatArray
from torsion.errors import Fault, Path, Refusal
from torsion.fields import Declared, Mass, Quantity, given, refuse, required
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.kernels.engine.gas_torque import Cylinder, CylinderOrder, Diagram, GasLaw
from torsion.kernels.engine.pressure_cycles import NoLoop, of_loop
from torsion.model.component import Lowering
from torsion.model.compressor.record import CompressorRecord, End, EndRecord, ThrowRecord
from torsion.model.engine.crankshaft import VARYING, Crankshaft, check_rod
from torsion.model.engine.declarations import Crankcase, Length
from torsion.model.engine.gas_laws import (
    COLUMNS,
    ENDS_MEET,
    GasFault,
    absolute_pressures,
    over_cycle,
)
from torsion.primitives import Torque
from torsion.tables import Columns, named

HEAD: End = "head end"
CRANK: End = "crank end"
SMALL = 1e-9  # of the largest harmonic: a mean torque that is rounding
SWEPT = 0.01  # relative: how far the volumes or the travel of a file may be from the swept ones
_HEAD = (
    "volume [dm3], pressure [bar]; or travel [mm], stroke [%] or angle [deg] in the first column"
)
VOLUME, TRAVEL, SHARE = (
    Columns(
        (name, "pressure"),
        (unit, "Pa"),
        _HEAD,
        "12.5, 3.4",
        f"a finite pressure at a {name}",
        0.0,
        is_loop=True,
    )
    for name, unit in (("volume", "m**3"), ("travel", "m"), ("stroke", "1"))
)
ANGLE = Columns(COLUMNS.names, COLUMNS.units, _HEAD, COLUMNS.row, COLUMNS.meant)


def _pressures(value: Any) -> Any:
    """A constant pressure (Pa), else the name of a file."""
    if isinstance(value, str):
        try:
            units.to_si(value, "Pa")
        except Refusal:
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


class Compressor(Crankshaft, keyword="compressor"):
    """A compressor is a crankshaft with pistons that absorb the mean torque."""

    title = "reciprocating compressor or pump with crankshaft"
    example = """\
- compressor:
    name: compressor
    stroke: 180 mm
    rod_length: 430 mm
    throws:
    - {angle: 0 deg, bore: 400 mm, piston_rod: 60 mm, reciprocating: 128 kg,
       head_end: reciprocating_compressor_1_head.csv, crank_end: reciprocating_compressor_1_crank.csv}
    - {angle: 0 deg, bore: 235 mm, piston_rod: 60 mm, reciprocating: 128 kg,
       head_end: reciprocating_compressor_2_head.csv, crank_end: 3.1 bar}
    absolute: true
    mechanical_efficiency: 94 %
    crank_inertia: 1.4 kg*m**2
    stiffness: 5 MN*m/rad
    loss_factor: 1 %"""

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
    orders: Annotated[int, Field(ge=1, le=48)] = given("highest order of the crankshaft", 12)

    def refuse_clashes(self) -> None:
        check_rod(self.rod_length, self.stroke)
        self.refuse_throws(len(self.throws))
        ends = [key for throw in self.throws for key in throw.keys_given("head_end", "crank_end")]
        if ends and self.absolute is None:
            hint = "absolute: true, or false of pressures above the surroundings"
            raise refuse("`absolute` is missing", hint)
        if not ends and not any(throw.reciprocating for throw in self.throws):
            message = "nothing excites: pressures and masses are missing"
            raise refuse(message, "give `head_end` and `crank_end`")

    @property
    def slider(self) -> CrankSlider:
        """The crank mechanism of every throw."""
        return CrankSlider.of_stroke(self.stroke, self.rod_length)

    def lower(self, build: Lowering) -> None:
        owner = build.part
        path, faults = build.parts[owner].path, len(build.faults)
        over_angle = [
            self.slider.inertia_harmonics(VARYING, throw.reciprocating) for throw in self.throws
        ]
        moving = [
            (f"throw {number}", float(inertia[0].real))
            for number, inertia in enumerate(over_angle, 1)
        ]
        stations, _ = self.lower_throws(build, moving)
        throws = []
        for number, (throw, station) in enumerate(zip(self.throws, stations, strict=True)):
            ends, at_throw = list[EndRecord](), (*path, "throws", number)
            for end, pressure, rod in (
                (HEAD, throw.head_end, throw.tail_rod),
                (CRANK, throw.crank_end, throw.piston_rod),
            ):
                if pressure is None:
                    continue
                area = math.pi / 4.0 * (throw.bore**2 - rod**2)
                cylinder = Cylinder(self.slider, area, 1)
                try:
                    ends.append(self._end(FilePath(build.folder), end, pressure, cylinder))
                except GasFault as fault:
                    key = (*at_throw, end.replace(" ", "_"))
                    build.faults.append(Fault(key, fault.message, fault.hint))
            gas = np.zeros(self.orders + 1, dtype=np.complex128)
            throws.append(
                ThrowRecord(
                    number + 1,
                    station,
                    throw.angle,
                    tuple(ends),
                    np.asarray(sum((end.torque for end in ends), gas)),
                    self.slider.inertia_torque(self.orders, throw.reciprocating),
                    over_angle[number],
                )
            )
        record = CompressorRecord(owner, tuple(throws), self.mechanical_efficiency)
        build.parts[owner] = build.parts[owner].with_records(record)
        if len(build.faults) == faults:
            # An end that gives work: its rows run backwards, or the ends are exchanged.
            for number, given in ((k, end) for k, throw in enumerate(throws) for end in throw.ends):
                drives = float(given.torque[0].real)
                if drives > SMALL * float(np.abs(given.torque).max()):
                    what = f"the {given.end} of throw {number + 1}"
                    message = f"{what} drives the shaft: {drives:.5g} N m on the mean"
                    hint = "rows follow the motion of the piston; volume and travel count from the dead centre of"
                    key = (*path, "throws", number, given.end.replace(" ", "_"))
                    build.faults.append(Fault(key, message, f"{hint} the same end"))
            build.add(*self._torques(build, record, path))

    def _end(self, folder: FilePath, end: End, given: str | float, cylinder: Cylinder) -> EndRecord:
        """The working side of a piston with its diagram and harmonics; raises GasFault."""
        clearance: float | None = None
        around = 0.0 if self.absolute else self.surroundings
        is_file = isinstance(given, str)
        if isinstance(given, str):
            file = folder / given
            columns = named(file, (ANGLE, VOLUME, TRAVEL, SHARE))
            first, pressure = absolute_pressures(
                file, columns, is_absolute=bool(self.absolute), around=self.surroundings
            )
            if columns is ANGLE and self.tdc is None:
                message = f"'{file}' is over the angle, and `tdc` is missing"
                raise GasFault(message, "angle of the dead centre of the head end")
            if columns is ANGLE:
                angle = first - (self.tdc or 0.0)
                diagram = over_cycle(file, angle, pressure, 2.0 * math.pi, "revolution")
            else:
                travel, clearance = _travel(file, first, columns, cylinder)
                travel = cylinder.crank.stroke - travel if end == CRANK else travel
                try:
                    diagram = of_loop(cylinder.crank, travel, pressure, ENDS_MEET)
                except NoLoop as fault:
                    row = "" if fault.row is None else f", row {fault.row + 1} below the units"
                    raise GasFault(f"'{file}'{row}: {fault.message}", fault.hint) from None
        else:
            ends = np.full(2, given + around)
            diagram = Diagram(np.array([0.0, 2.0 * math.pi]), ends)
        sense = 1.0 if end == HEAD else -1.0
        torque = sense * diagram.torque(cylinder, self.orders, self.surroundings)
        if not is_file:
            torque[0] = 0.0  # what it takes it gives back
        words = given if isinstance(given, str) else f"constant {given / 1e5:g} bar"
        return EndRecord(end, words, is_file, cylinder, diagram, clearance, torque)

    def _torques(self, build: Lowering, record: CompressorRecord, path: Path) -> Iterator[Torque]:
        """One primitive for every throw and order that is there."""
        for throw in record.throws:
            name, station = build.stations[throw.station].name, throw.station
            law = GasLaw("nothing", np.zeros(1), throw.gas[None, :])
            for order in range(1, self.orders + 1):
                if throw.gas[order] or throw.inertia[order]:
                    inertia, phasor = complex(throw.inertia[order]), throw.phasor(order)
                    cylinder = CylinderOrder(
                        law, order, inertia, phasor, station, 1.0, engine=record.part
                    )
                    torque = Torque(name, station, Fraction(order), path=path, source=self.source)
                    yield replace(torque, cylinder=cylinder)

    def data_sheet(self) -> Iterator[tuple[str, str]]:
        yield "Throws", str(len(self.throws))
        yield "Stroke, connecting rod", f"{1e3 * self.stroke:.6g}, {1e3 * self.rod_length:.6g} mm"
        yield "Radius / rod", f"{self.slider.radius / self.slider.rod:.5g}"
        yield "Pressure outside of the cylinders", f"{self.surroundings / 1e5:.5g} bar"


def _travel(
    file: FilePath, first: FloatArray, columns: Columns, cylinder: Cylinder
) -> tuple[FloatArray, float | None]:
    """(rows,) m from the dead centre of this end, and the clearance; the ends of the file are the dead centres."""
    low, high, stroke = float(first.min()), float(first.max()), cylinder.crank.stroke
    full, unit, size = {
        "volume": (cylinder.swept, "dm3", 1e3),
        "travel": (stroke, "mm", 1e3),
        "stroke": (1.0, "%", 100.0),
    }[columns.names[0]]
    if not math.isclose(high - low, full, rel_tol=SWEPT):
        swept = (
            f"{(high - low) * size:.5g} {unit}, bore, rods and stroke give {full * size:.5g} {unit}"
        )
        hint = "the file holds one whole revolution, from dead centre to dead centre"
        raise GasFault(f"'{file}': its {columns.names[0]} spans {swept}", hint)
    travel = np.asarray((first - low) / (high - low) * stroke)
    return travel, low / (high - low) if columns is VOLUME else None
