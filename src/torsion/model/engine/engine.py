"""A reciprocating engine: crank throws with their inertias, crank spans, and the torque of every cylinder."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from itertools import chain, pairwise
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.fields import given, needs, refuse, required
from torsion.kernels.engine.crank_slider import (
    CrankSlider,
    Throw,
    carter,
    ker_wilson,
    rod_as_masses,
)
from torsion.kernels.engine.gas_torque import Cylinder, CylinderOrder, State
from torsion.model.component import STEEL, Lowering
from torsion.model.engine.crankshaft import VARYING, Crankshaft
from torsion.model.engine.declarations import (
    MOST_ORDER,
    Gas,
    Geometry,
    Journal,
    Masses,
    Misfire,
    Number,
    Numbers,
    Phase,
    Share,
    Throws,
    Web,
)
from torsion.model.engine.gas_laws import Frame, GasFault, Law, law_of
from torsion.model.engine.record import CylinderRecord, EngineRecord
from torsion.model.parts import MachineRecord, ShaftRecord
from torsion.primitives import Torque

SIZES = "geometry: {bore, stroke, rod_length}"
TWICE = 1e-9  # rad: firing angles that differ by less are one


class Engine(Crankshaft, keyword="engine"):
    """An engine is a crankshaft from its free end to its last throw, with gas and mass torques."""

    title = "reciprocating engine with crankshaft, gas torque and misfire"
    example = """\
- engine:
    name: main engine
    cylinders: 6
    strokes: 4
    firing_order: [1, 5, 3, 6, 2, 4]
    inertia: [0.0467, 0.0327, 0.0467, 0.0467, 0.0327, 0.0487]
    stiffness: [1.253e6, 1.253e6, 1.678e6, 1.253e6, 1.253e6]
    damping: 2 N*m*s/rad
    loss_factor: 3.5 %
    journal: {diameter: 90 mm}
    geometry: {bore: 105 mm, stroke: 137 mm, rod_length: 207 mm}
    masses: {reciprocating: 2.521 kg}
    gas: {cycle: wiebe, compression_ratio: 17, charge: 2.4 bar, exhaust: 2 bar, imep: 18 bar, p_max: 150 bar,
          duration: 60 deg}
    misfire: 3"""
    groups = (
        (
            "Cylinders and firing",
            "cylinders strokes firing_order firing_angles throws reverse phase",
        ),
        (
            "Crankshaft",
            "inertia crank_inertia stiffness damping loss_factor journal pin material web",
        ),
        ("Excitation", "geometry masses gas power mechanical_efficiency orders"),
        ("Misfire and imbalance", "misfire cut_out keep_power imbalance"),
    )

    clashes = (
        needs("masses", "geometry", hint=SIZES),
        needs("web", "geometry", hint=SIZES),
        needs("crank_inertia", "masses", hint="their mean is added to it"),
    )

    cylinders: Annotated[int, Field(ge=1, le=40)] = required("number of cylinders")
    strokes: Literal[2, 4] = required("of a cycle")
    firing_order: tuple[Number, ...] = given(
        "numbers of the cylinders as they fire, evenly spaced", ()
    )
    firing_angles: tuple[fields.Angle, ...] = given(
        "crank angle at which each cylinder fires, cylinder 1 first", ()
    )
    phase: Phase | None = given(
        "crank angle at which its first cylinder fires, at reference angle zero; needed if "
        "a train has several engines"
    )
    throws: Throws = given(
        "cylinders on each throw from the first end: [[1, 2], [3, 4]] (default: one each)", ()
    )
    power: fields.Power | None = given("rated power; shares the load where several drive one train")
    journal: Journal | None = given("{diameter, bore} of its journals, for their stress")
    pin: Journal | None = given("{diameter, bore} of its pins, for their stress")
    material: str = given("of the crankshaft, for the rules that judge its stress", "steel")
    web: Web | None = given(
        "{thickness, width} of its webs: the report then estimates the stiffness of a throw"
    )
    geometry: Geometry | None = given("{bore, stroke, rod_length, offset} of a cylinder")
    masses: Masses | None = given(
        "{reciprocating}, or {piston, rod} of a cylinder, for their torque"
    )
    gas: Gas | None = given("gas torque of a cylinder; without it only the moving masses excite")
    misfire: Misfire = given("cylinders without fuel; needs motored harmonics", ())
    cut_out: Numbers = given("cylinders with their valves open: no gas torque", ())
    imbalance: tuple[tuple[Number, Share], ...] = given(
        "list of [cylinder, heat relative to the other cylinders]: [[1, 105 %], [6, 95 %]]", ()
    )
    keep_power: bool = given("true: the other cylinders make up for `misfire` and `cut_out`", False)
    orders: Annotated[int, Field(ge=1, le=MOST_ORDER)] | None = given(
        "highest order of the crankshaft (default: 12, of two strokes 15, or the highest of the tables)"
    )

    @property
    def revolutions(self) -> int:
        """Revolutions of the crankshaft in one cycle."""
        return self.strokes // 2

    @property
    def lanes(self) -> tuple[tuple[int, ...], ...]:
        """Numbers of the cylinders on every throw, from the first end."""
        return self.throws or tuple((number,) for number in range(1, self.cylinders + 1))

    def refuse_clashes(self) -> None:
        self._check_firing()
        self.refuse_throws(len(self.lanes))
        self._check_states()
        journals, geometry, masses = (self.journal, self.pin), self.geometry, self.masses
        sized = all(journal is not None and journal.length for journal in journals)
        if self.web is not None and not sized:
            message = "`web` needs `journal` and `pin` with their `length`"
            raise refuse(message, "journal: {diameter: 90 mm, length: 40 mm}", "web")
        rod = None if masses is None else masses.rod
        if rod is not None and geometry is not None and rod.centre >= geometry.rod_length:
            message = "the centre of mass lies beyond the rod"
            raise refuse(message, "it counts from the centre of the big end", "masses")
        if self.gas is None and masses is None:
            message = "nothing excites: `gas` and `masses` are missing"
            raise refuse(message, "give one of them, or discs")

    def _check_firing(self) -> None:
        order, angles, z = self.firing_order, self.firing_angles, self.cylinders
        cycle = 2.0 * math.pi * self.revolutions
        if bool(order) == bool(angles) and (z > 1 or order):
            words = "exclude each other" if order else "are both missing"
            message = f"`firing_order` and `firing_angles` {words}"
            raise refuse(message, "firing_order: [1, 3, 4, 2]", "firing_angles" if order else "")
        message, numbers = f"does not name each of {z} cylinders once", list(range(1, z + 1))
        if order and sorted(order) != numbers:
            raise refuse(f"`firing_order` {message}", f"numbers 1 to {z}", "firing_order")
        if angles and len(angles) != z:
            words = f"`firing_angles` are {len(angles)}, cylinders {z}"
            raise refuse(words, "one angle a cylinder", "firing_angles")
        if any(not 0 <= angle < cycle - TWICE for angle in angles):
            limit = f"from 0 to below {360 * self.revolutions} deg"
            raise refuse("a firing angle lies outside the cycle", limit, "firing_angles")
        if self.throws and sorted(chain(*self.throws)) != numbers:
            raise refuse(f"`throws` {message}", "throws: [[1, 2], [3, 4]]", "throws")
        for throw in self.lanes:
            fires = sorted(cycle * float(self._cycles[number - 1]) for number in throw)
            if any(after - before < TWICE for before, after in pairwise(fires)):
                words = "two cylinders of one throw fire at one angle"
                key = "firing_angles" if angles else "throws"
                raise refuse(words, "a V engine has its bank angle between", key)

    def _check_states(self) -> None:
        """Refuse cylinders that do not exist, are named twice, or are the last that fires."""
        misfiring = () if self.misfire == "worst" else self.misfire
        uneven = tuple(number for number, _ in self.imbalance)
        states = {"misfire": misfiring, "cut_out": self.cut_out, "imbalance": uneven}
        keys: dict[int, str] = {}
        for key, numbers in states.items():
            for number in numbers:
                if number > self.cylinders:
                    hint = f"numbers 1 to {self.cylinders}"
                    raise refuse(f"there is no cylinder {number}", hint, key)
                if number in keys:
                    message = f"cylinder {number} is named twice, in `{keys[number]}` and `{key}`"
                    raise refuse(message, "each once", key)
                keys[number] = key
        cold = [*misfiring, *self.cut_out]
        without_fuel = {*cold, *(number for number, heat in self.imbalance if not heat)}
        if len(without_fuel) + (self.misfire == "worst") >= self.cylinders:
            key = self.keys_given(*states)[0]
            raise refuse("no cylinder is left that fires", "leave one", key)
        gas = self.gas
        if (cold or self.misfire or self.imbalance) and gas is None:
            key = "misfire" if cold else "imbalance"
            raise refuse("without `gas` there is nothing to misfire", "give `gas`", key)
        if self.misfire and gas is not None and (gas.table or gas.tables) and gas.motored is None:
            hint = "rows `motored` of `gas`, a diagram or a cycle"
            raise refuse("a misfire needs the motored harmonics", hint, "misfire")

    @property
    def _cycles(self) -> tuple[Fraction, ...]:
        """(cylinders,) of a cycle, at which each fires."""
        if self.firing_angles:
            cycle = 2.0 * math.pi * self.revolutions
            return tuple(Fraction(angle / cycle) for angle in self.firing_angles)
        order = self.firing_order or (1,)
        return tuple(
            Fraction(order.index(number), self.cylinders) for number in range(1, self.cylinders + 1)
        )

    def lower(self, build: Lowering) -> None:
        owner, slider, revolutions = build.part, self.slider, self.revolutions
        cylinder = None
        if slider is not None and self.geometry is not None:
            cylinder = Cylinder(slider, math.pi / 4.0 * self.geometry.bore**2, revolutions)
        law = Law(None, "not given")
        if self.gas is not None:
            frame = Frame(
                revolutions,
                self._highest,
                self.cylinders,
                self.mechanical_efficiency,
                cylinder,
                FilePath(build.folder),
            )
            try:
                law = law_of(self.gas, frame)
            except GasFault as fault:
                build.fault(fault.message, fault.hint, "gas", *fault.key)
        build.material(self.material)
        # The one with the smallest section modulus.
        journals = (journal for journal in (self.journal, self.pin) if journal is not None)
        journal, shaft = min(journals, key=lambda journal: journal.modulus, default=None), None
        if journal is not None:
            size = journal.diameter, journal.bore
            shaft = ShaftRecord(self.material, "crank", (), (), journal=size)
        inertia = np.zeros(self._highest * revolutions + 1, dtype=np.complex128)
        over_angle = np.zeros(1, dtype=np.complex128)
        if slider is not None and self.masses is not None:
            mass, correction, turning = self._moving
            inertia[::revolutions] = slider.inertia_torque(self._highest, mass, correction)
            over_angle = slider.inertia_harmonics(VARYING, mass, correction)
            over_angle[0] += turning
        mean = float(over_angle[0].real)
        names = [
            f"cylinder {lane[0]}" if len(lane) == 1 else f"throw {number}"
            for number, lane in enumerate(self.lanes, 1)
        ]
        throws = [(name, len(lane) * mean) for name, lane in zip(names, self.lanes, strict=True)]
        stations, spans = self.lower_throws(build, throws, shaft)
        record = EngineRecord(
            owner,
            revolutions,
            tuple(self._cylinder_records(stations)),
            stations,
            spans,
            self.mechanical_efficiency,
            law.law,
            law.words,
            inertia,
            over_angle,
            cylinder,
            law.curves,
            None if journal is None else journal.modulus,
            self.keep_power,
            self.phase is not None,
            self.phase == "worst",
            self.misfire == "worst",
            law.remarks,
            tuple(self._sizes()),
        )
        build.parts[owner] = build.parts[owner].with_records(
            record, MachineRecord(True, self.power)
        )
        if law.law is not None or inertia.any():
            self._add_torques(build, owner, record)

    @property
    def _highest(self) -> int:
        """Order of the crankshaft: that of the file, else the usual one or the highest of the tables."""
        if self.orders is not None:
            return self.orders
        tables: list[Any] = []
        gas = self.gas
        if gas is not None:
            tables = [gas.table or (), gas.motored or (), *(table.rows for table in gas.tables)]
        highest: list[int] = [math.ceil(row[0]) for rows in tables for row in rows]
        return max(12 if self.strokes == 4 else 15, *highest, 1)

    @property
    def slider(self) -> CrankSlider | None:
        """The crank mechanism of a cylinder; None without `geometry`."""
        size = self.geometry
        if size is None:
            return None
        return CrankSlider.of_stroke(size.stroke, size.rod_length, size.offset)

    @property
    def _moving(self) -> tuple[float, float, float]:
        """Reciprocating mass (kg), J_c (kg m2) and the inertia (kg m2) of what turns with the pin, of a cylinder."""
        masses, slider = self.masses, self.slider
        if masses is None or slider is None:
            return 0.0, 0.0, 0.0
        if masses.rod is None:
            return masses.reciprocating or 0.0, 0.0, 0.0
        rod = masses.rod
        rotating, reciprocating, correction = rod_as_masses(
            slider.rod, rod.mass, rod.centre, rod.inertia
        )
        mass = (masses.piston or 0.0) + reciprocating
        return mass, correction, rotating * slider.radius**2

    def _sizes(self) -> Iterator[tuple[str, float, tuple[str, ...]]]:
        """Sizes of a throw that the file has here, by the keys of the rule that judges it, and their own keys."""
        yield "strokes", self.strokes, ("strokes",)
        for key, journal in (("pin", self.pin), ("journal", self.journal)):
            if journal is not None:
                has_bore = "bore" in journal.model_fields_set
                yield key, journal.diameter, (key, "diameter")
                yield f"{key}_bore", journal.bore, (key, "bore") if has_bore else (key,)
        if self.web is not None:
            yield "web_thickness", self.web.thickness, ("web", "thickness")
            yield "web_width", self.web.width, ("web", "width")
        if self.geometry is not None:
            yield "radius", self.geometry.stroke / 2.0, ("geometry", "stroke")

    def _cylinder_records(self, stations: tuple[int, ...]) -> Iterator[CylinderRecord]:
        """Yield the cylinders in the order of their numbers; stations: of the throws."""
        throws = {number: throw for throw, lane in enumerate(self.lanes) for number in lane}
        misfiring = () if self.misfire == "worst" else self.misfire
        heat = dict.fromkeys(range(1, self.cylinders + 1), 1.0) | dict(self.imbalance)
        states: dict[int, State] = dict.fromkeys(heat, "firing")
        states |= dict.fromkeys(misfiring, "motored") | dict.fromkeys(self.cut_out, "cut out")
        # The angle (rad) by which it stands behind the reference; 0 where that is not known.
        turned = 0.0 if self.phase is None or isinstance(self.phase, str) else self.phase
        raised = 1.0
        if self.keep_power:
            firing = (heat[number] for number, state in states.items() if state == "firing")
            raised = self.cylinders / sum(firing)
        for number, state in states.items():
            yield CylinderRecord(
                number,
                stations[throws[number]],
                throws[number],
                self._cycles[number - 1],
                turned,
                self.revolutions,
                state,
                raised * heat[number],
            )

    def data_sheet(self) -> Iterator[tuple[str, str]]:
        yield "Cylinders", str(self.cylinders)
        yield "Strokes of a cycle", str(self.strokes)
        if self.firing_order:
            yield "Firing order", "-".join(map(str, self.firing_order))
        size, slider = self.geometry, self.slider
        if size is None or slider is None:
            return
        lengths = (size.bore, size.stroke, size.rod_length)
        yield "Bore, stroke, rod", " × ".join(f"{1e3 * length:.6g}" for length in lengths) + " mm"
        yield "Radius / rod", f"{slider.radius / slider.rod:.5g}"
        if size.offset:
            yield "Offset", f"{1e3 * size.offset:.6g} mm"
        if self.web is not None and self.journal is not None and self.pin is not None:
            journal, pin = (
                (size.diameter, size.bore, size.length or 0.0) for size in (self.journal, self.pin)
            )
            throw = Throw(journal, pin, (self.web.thickness, self.web.width), slider.radius)
            estimates = ", ".join(
                f"{formula(throw, STEEL.shear_modulus) * 1e-6:.4g} MN m/rad ({name})"
                for name, formula in (("Carter", carter), ("Ker Wilson", ker_wilson))
            )
            words = f"{estimates}, of steel; used is the stiffness of the file"
            yield "Stiffness of a throw, estimate, to be verified", words
        if self.masses is not None:
            mass, correction, turning = self._moving
            yield "Reciprocating mass of a cylinder", f"{mass:.6g} kg"
            if self.masses.rod is not None:
                yield "Correction of the rod, inertia", f"{correction:.5g} kg m²"
                yield "Rotating share of the rod, inertia", f"{turning:.5g} kg m²"

    def _add_torques(self, build: Lowering, owner: int, record: EngineRecord) -> None:
        """Add one primitive for every cylinder and harmonic of its torque."""
        part, load = build.parts[owner], record.load_says
        acts = np.abs(record.inertia) > 0
        if record.gas is not None:
            acts |= (np.abs(record.gas.firing) > 0).any(axis=0)
        for cylinder in record.cylinders:
            for harmonic in range(1, len(acts)):
                if not acts[harmonic]:
                    continue
                law = CylinderOrder(
                    record.gas,
                    harmonic,
                    complex(record.inertia[harmonic]),
                    cylinder.phasor(harmonic),
                    *load,
                    cylinder.state,
                    cylinder.share,
                    owner,
                    record.by_chance,
                )
                order, path = Fraction(harmonic, record.revolutions), part.path
                torque = Torque(part.name, cylinder.station, order, path=path, source=self.source)
                build.add(replace(torque, cylinder=law))
