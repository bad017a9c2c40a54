"""A reciprocating engine: crank throws with their inertias, crank spans, and the torque of every cylinder."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fractions import Fraction
from itertools import pairwise
from pathlib import Path as FilePath
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import Field

from torsion import fields
from torsion.fields import OneOrMany, Quantity, given, refuse, required
from torsion.kernels.engine.crank_slider import CrankSlider, Rod
from torsion.kernels.engine.crank_throw import Throw, carter, ker_wilson
from torsion.kernels.engine.gas_law import CylinderOrder
from torsion.kernels.engine.gas_torque import Cylinder
from torsion.model.component import Component
from torsion.model.engine.crankshaft import Crankshaft, of
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
    weakest,
)
from torsion.model.engine.gas_laws import Frame, GasFault, Law, law_of
from torsion.model.engine.record import CylinderRecord, EngineRecord
from torsion.model.lowering import Lowering, ShaftRecord
from torsion.model.machine_records import MachineRecord
from torsion.model.material import STEEL
from torsion.primitives import Torque

TWICE = 1e-9  # rad: firing angles that differ by less are one
VARYING = 8  # harmonics of the inertia over a revolution that are kept


class Engine(Component, keyword="engine", sort="line"):
    """A reciprocating engine with its crankshaft, from its free end to its last throw."""

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
    reverse: bool = given("true: the train meets its last throw first", False)
    power: fields.Power | None = given("rated power; shares the load where several drive one train")
    mechanical_efficiency: Annotated[
        float, Quantity("1", above=0, at_most=1, usual="efficiency")
    ] = given("mean torque / mean gas torque", 1.0)
    inertia: Annotated[tuple[fields.Inertia, ...], OneOrMany] = given(
        "of every throw with the mean of its rods and pistons, from the first end; one value for all",
        (),
    )
    crank_inertia: Annotated[tuple[fields.Inertia, ...], OneOrMany] = given(
        "of every throw without masses, in place of `inertia`; the mean of `masses` is added", ()
    )
    stiffness: Annotated[tuple[fields.Stiffness, ...], OneOrMany] = given(
        "between throws, from the first end; one value for all", ()
    )
    damping: Annotated[tuple[fields.Damping, ...], OneOrMany] = given(
        "to ground, by throw; one value for all", ()
    )
    loss_factor: fields.LossFactor = given("of the crank spans", 0.0)
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
        """Of a cycle."""
        return self.strokes // 2

    @property
    def lanes(self) -> tuple[tuple[int, ...], ...]:
        """Cylinders of every throw."""
        return self.throws or tuple((number,) for number in range(1, self.cylinders + 1))

    @classmethod
    def points_within(cls, name: str, body: Mapping[str, Any]) -> Iterator[str]:
        number, throws = body.get("cylinders"), body.get("throws")
        if isinstance(throws, list):
            yield from (f"{name} throw {place}" for place in range(1, len(throws) + 1))
        if isinstance(number, int):
            yield from (f"{name} cylinder {place}" for place in range(1, min(number, 99) + 1))

    def refuse_clashes(self) -> None:
        for check in (self._firing, self._throws, self._lists, self._states):
            check()
        if self.web is not None:
            sized = (
                self.journal is not None
                and self.pin is not None
                and self.journal.length
                and self.pin.length
            )
            if not sized or self.geometry is None:
                hint = "journal: {diameter: 90 mm, length: 40 mm}"
                raise refuse(
                    "`web` needs `journal` and `pin` with their `length`, and `geometry`",
                    hint,
                    "web",
                )
        if self.masses is not None and self.geometry is None:
            raise refuse(
                "`masses` need the `geometry` of the cylinder",
                "geometry: {bore, stroke, rod_length}",
                "masses",
            )
        rod = None if self.masses is None else self.masses.rod
        if rod is not None and self.geometry is not None and rod.centre >= self.geometry.rod_length:
            raise refuse(
                "the centre of mass lies beyond the rod",
                "it counts from the centre of the big end",
                "masses",
            )
        if bool(self.inertia) == bool(self.crank_inertia):
            raise refuse(
                "give `inertia`, or `crank_inertia` with `masses`",
                "inertia: 0.047 kg*m**2",
                "crank_inertia" if self.inertia else "",
            )
        if self.crank_inertia and self.masses is None:
            raise refuse(
                "`crank_inertia` needs `masses`", "their mean is added to it", "crank_inertia"
            )
        if self.gas is None and self.masses is None:
            raise refuse(
                "nothing excites: `gas` and `masses` are missing", "give one of them, or discs"
            )

    def _firing(self) -> None:
        order, angles, z = self.firing_order, self.firing_angles, self.cylinders
        if bool(order) == bool(angles) and (z > 1 or order):
            what = "exclude each other" if order else "are both missing"
            raise refuse(
                f"`firing_order` and `firing_angles` {what}",
                "firing_order: [1, 3, 4, 2]",
                "firing_angles" if order else "",
            )
        if order and sorted(order) != list(range(1, z + 1)):
            raise refuse(
                f"`firing_order` does not name each of {z} cylinders once",
                f"numbers 1 to {z}",
                "firing_order",
            )
        if angles and len(angles) != z:
            raise refuse(
                f"`firing_angles` are {len(angles)}, cylinders {z}",
                "one angle a cylinder",
                "firing_angles",
            )
        if any(not 0 <= one < self._cycle - TWICE for one in angles):
            limit = f"from 0 to below {360 * self.revolutions} deg"
            raise refuse("a firing angle lies outside the cycle", limit, "firing_angles")

    def _throws(self) -> None:
        named = [number for throw in self.throws for number in throw]
        if self.throws and sorted(named) != list(range(1, self.cylinders + 1)):
            message = f"`throws` do not name each of {self.cylinders} cylinders once"
            raise refuse(message, "throws: [[1, 2], [3, 4]]", "throws")
        fires = [self._cycle * float(share) for share in self._cycles]
        for throw in self.lanes:
            at = sorted(fires[number - 1] for number in throw)
            if any(after - before < TWICE for before, after in pairwise(at)):
                raise refuse(
                    "two cylinders of one throw fire at one angle",
                    "a V engine has its bank angle between",
                    "firing_angles" if self.firing_angles else "throws",
                )

    def _lists(self) -> None:
        number = len(self.lanes)
        for key, most in (
            ("inertia", number),
            ("crank_inertia", number),
            ("damping", number),
            ("stiffness", number - 1),
        ):
            values = getattr(self, key)
            if len(values) not in (0, 1, most) or len(values) > most:
                what = "throws" if most == number else "spans between them"
                raise refuse(
                    f"`{key}` has {len(values)} values, and there are {most} {what}",
                    "one value, or each",
                    key,
                )
        if number > 1 and not self.stiffness:
            raise refuse(
                "`stiffness` of the crank spans is missing", "between throws; one value for all"
            )

    def _states(self) -> None:
        uneven, missing = (
            tuple(number for number, _ in self.imbalance),
            () if self.misfire == "worst" else self.misfire,
        )
        named = [("misfire", missing), ("cut_out", self.cut_out), ("imbalance", uneven)]
        for key, numbers in named:
            wrong = next((number for number in numbers if number > self.cylinders), None)
            if wrong is not None:
                raise refuse(f"there is no cylinder {wrong}", f"numbers 1 to {self.cylinders}", key)
            if len(set(numbers)) < len(numbers):
                raise refuse("a cylinder is named twice", "each once", key)
        out = [*missing, *self.cut_out]
        every = [*out, *uneven]
        twice = next((number for number in every if every.count(number) > 1), None)
        if twice is not None:
            raise refuse(
                f"cylinder {twice} is named by two of `misfire`, `cut_out` and `imbalance`",
                "one of them",
                "cut_out" if twice in self.cut_out else "misfire",
            )
        cold = {number for number, heat in self.imbalance if not heat}
        if len({*out, *cold}) + (self.misfire == "worst") >= self.cylinders:
            key = "misfire" if self.misfire else "cut_out" if self.cut_out else "imbalance"
            raise refuse("no cylinder is left that fires", "leave one", key)
        if (out or self.misfire or self.imbalance) and self.gas is None:
            raise refuse(
                "without `gas` there is nothing to misfire",
                "give `gas`",
                named[0][0] if out else "imbalance",
            )
        gas = self.gas
        if self.misfire and gas is not None and (gas.table or gas.tables) and gas.motored is None:
            raise refuse(
                "a misfire needs the motored harmonics",
                "rows `motored` of `gas`, a diagram or a cycle",
                "misfire",
            )

    @property
    def _cycle(self) -> float:
        return 2.0 * math.pi * self.revolutions

    @property
    def _turned(self) -> float:
        """rad, by which it stands behind the reference; 0 where that is not known."""
        return 0.0 if self.phase is None or isinstance(self.phase, str) else self.phase

    @property
    def _cycles(self) -> tuple[Fraction, ...]:
        """(cylinders,) of a cycle, at which each fires."""
        if self.firing_angles:
            return tuple(Fraction(angle / self._cycle) for angle in self.firing_angles)
        order = self.firing_order or (1,)
        return tuple(
            Fraction(order.index(number), self.cylinders) for number in range(1, self.cylinders + 1)
        )

    def lower(self, build: Lowering) -> None:
        owner, law = build.part, self._law(build)
        build.material(self.material)
        slider = self._slider()
        stations, cranks = self._throws_and_spans(build, slider)
        record = self._record(owner, (stations, cranks), slider, law)
        build.parts[owner] = replace(
            build.parts[owner], engine=record, machine=MachineRecord(True, self.power)
        )
        if law is not None or record.inertia.any():
            self._torques(build, owner, record)

    def _law(self, build: Lowering) -> Law | None:
        """The gas torque; a fault is noted where the file's figures give none."""
        if self.gas is None:
            return None
        slider = self._slider()
        frame = Frame(
            self.revolutions,
            self._highest,
            self.cylinders,
            self.mechanical_efficiency,
            None if slider is None else self._cylinder(slider),
            FilePath(build.folder),
        )
        try:
            return law_of(self.gas, frame)
        except GasFault as fault:
            build.fault(fault.message, fault.hint, "gas", *fault.key)
            return None

    @property
    def _highest(self) -> int:
        """Order of the crankshaft: that of the file, else the usual one or the highest of the tables."""
        if self.orders is not None:
            return self.orders
        gas = self.gas
        tables = (
            []
            if gas is None
            else [gas.table or (), gas.motored or (), *(one.rows for one in gas.tables)]
        )
        highest: list[int] = [math.ceil(row[0]) for rows in tables for row in rows]
        return max(12 if self.strokes == 4 else 15, *highest, 1)

    def _slider(self) -> CrankSlider | None:
        size = self.geometry
        return (
            None
            if size is None
            else CrankSlider.of_stroke(size.stroke, size.rod_length, size.offset)
        )

    def _cylinder(self, slider: CrankSlider) -> Cylinder:
        bore = 0.0 if self.geometry is None else self.geometry.bore
        return Cylinder(slider, math.pi / 4.0 * bore**2, self.revolutions)

    def _moving(self, slider: CrankSlider) -> tuple[float, float, float]:
        """Reciprocating mass (kg), J_c (kg m2) and the inertia (kg m2) of what turns with the pin, of a cylinder."""
        masses = self.masses
        if masses is None:
            return 0.0, 0.0, 0.0
        if masses.rod is None:
            return masses.reciprocating or 0.0, 0.0, 0.0
        rod = Rod(masses.rod.mass, masses.rod.centre, masses.rod.inertia)
        turning = rod.rotating(slider.rod) * slider.radius**2
        return (
            (masses.piston or 0.0) + rod.reciprocating(slider.rod),
            rod.correction(slider.rod),
            turning,
        )

    def _throws_and_spans(
        self, build: Lowering, slider: CrankSlider | None
    ) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """Lower the crankshaft: stations of the throws and parts of the spans, both from its first end."""
        size, shaft = weakest(self.journal, self.pin), None
        if size is not None:
            shaft = ShaftRecord(self.material, "crank", (), (), journal=(size.diameter, size.bore))
        names = tuple(self._named(throw) for throw in range(len(self.lanes)))
        crankshaft = Crankshaft(
            names, self.stiffness, self.damping, self.loss_factor, shaft, self.reverse
        )
        return crankshaft.lower(build, lambda here, throw: self._masses(build, here, throw, slider))

    def _named(self, throw: int) -> str:
        lane = self.lanes[throw]
        return f"cylinder {lane[0]}" if len(lane) == 1 else f"throw {throw + 1}"

    def _masses(self, build: Lowering, here: int, throw: int, slider: CrankSlider | None) -> None:
        """The inertia of a throw, with the mean of its moving masses where they are to be added."""
        if self.inertia:
            build.inertia(here, of(self.inertia, throw))
            return
        build.inertia(here, of(self.crank_inertia, throw), "crank")
        if slider is not None:
            mass, correction, turning = self._moving(slider)
            mean = slider.inertia_harmonics(0, mass, correction)[0].real + turning
            build.inertia(here, len(self.lanes[throw]) * float(mean), "moving masses, mean")

    def _record(
        self,
        owner: int,
        made: tuple[tuple[int, ...], tuple[int, ...]],
        slider: CrankSlider | None,
        law: Law | None,
    ) -> EngineRecord:
        """What analyses and reports read."""
        harmonics = self._highest * self.revolutions
        inertia, over_angle = (
            np.zeros(harmonics + 1, dtype=np.complex128),
            np.zeros(1, dtype=np.complex128),
        )
        if slider is not None and self.masses is not None:
            mass, correction, turning = self._moving(slider)
            inertia[:: self.revolutions] = slider.inertia_torque(self._highest, mass, correction)
            over_angle = slider.inertia_harmonics(VARYING, mass, correction)
            over_angle[0] += turning
        modulus = None if (round_ := weakest(self.journal, self.pin)) is None else round_.modulus
        cylinder = None if slider is None else self._cylinder(slider)
        gas, words = (None, "not given") if law is None else (law.law, law.words)
        return EngineRecord(
            owner,
            self.revolutions,
            tuple(self._each(made[0])),
            *made,
            self.mechanical_efficiency,
            gas,
            words,
            inertia,
            over_angle,
            cylinder,
            () if law is None else law.curves,
            modulus,
            self.keep_power,
            self.phase is not None,
            self.phase == "worst",
            self.misfire == "worst",
            tuple(self._words(slider)),
            () if law is None else law.remarks,
            tuple(self._sizes()),
        )

    def _sizes(self) -> Iterator[tuple[str, float, tuple[str, ...]]]:
        """Sizes of a throw that the file has here, by the keys of the rule that judges it, and their own keys."""
        yield "strokes", self.strokes, ("strokes",)
        for key, journal in (("pin", self.pin), ("journal", self.journal)):
            if journal is not None:
                yield key, journal.diameter, (key, "diameter")
                yield (
                    f"{key}_bore",
                    journal.bore,
                    (key, "bore") if "bore" in journal.model_fields_set else (key,),
                )
        if self.web is not None:
            yield "web_thickness", self.web.thickness, ("web", "thickness")
            yield "web_width", self.web.width, ("web", "width")
        if self.geometry is not None:
            yield "radius", self.geometry.stroke / 2.0, ("geometry", "stroke")

    def _each(self, stations: tuple[int, ...]) -> Iterator[CylinderRecord]:
        """The cylinders in the order of their numbers."""
        lane = {number: throw for throw, numbers in enumerate(self.lanes) for number in numbers}
        out, misfire = set(self.cut_out), () if self.misfire == "worst" else self.misfire
        uneven = dict(self.imbalance)
        share = {number: uneven.get(number, 1.0) for number in range(1, self.cylinders + 1)}
        fires = [number for number in share if number not in out and number not in misfire]
        raised = self.cylinders / sum(share[number] for number in fires) if self.keep_power else 1.0
        for number, heat in share.items():
            state: Literal["firing", "motored", "cut out"] = (
                "cut out" if number in out else "motored" if number in misfire else "firing"
            )
            yield CylinderRecord(
                number,
                stations[lane[number]],
                lane[number],
                self._cycles[number - 1],
                self._turned,
                self.revolutions,
                state,
                raised * heat,
            )

    def _words(self, slider: CrankSlider | None) -> Iterator[tuple[str, str]]:
        """Figures of the data sheet."""
        yield "Cylinders", str(self.cylinders)
        yield "Strokes of a cycle", str(self.strokes)
        if self.firing_order:
            yield "Firing order", "-".join(map(str, self.firing_order))
        size = self.geometry
        if size is not None and slider is not None:
            yield (
                "Bore, stroke, rod",
                " × ".join(f"{1e3 * one:.6g}" for one in (size.bore, size.stroke, size.rod_length))
                + " mm",
            )
            yield "Radius / rod", f"{slider.radius / slider.rod:.5g}"
            if size.offset:
                yield "Offset", f"{1e3 * size.offset:.6g} mm"
        if slider is not None:
            yield from self._estimates(slider)
        if self.masses is not None and slider is not None:
            mass, correction, turning = self._moving(slider)
            yield "Reciprocating mass of a cylinder", f"{mass:.6g} kg"
            if self.masses.rod is not None:
                yield "Correction of the rod, inertia", f"{correction:.5g} kg m²"
                yield "Rotating share of the rod, inertia", f"{turning:.5g} kg m²"

    def _estimates(self, slider: CrankSlider) -> Iterator[tuple[str, str]]:
        """The stiffness of a throw by formulas, where its dimensions are given."""
        if self.web is None or self.journal is None or self.pin is None:
            return
        ends = [(one.diameter, one.bore, one.length or 0.0) for one in (self.journal, self.pin)]
        throw = Throw(ends[0], ends[1], (self.web.thickness, self.web.width), slider.radius)
        both = (formula(throw, STEEL.shear_modulus) * 1e-6 for formula in (carter, ker_wilson))
        words = ", ".join(
            f"{k:.4g} MN m/rad ({name})"
            for k, name in zip(both, ("Carter", "Ker Wilson"), strict=True)
        )
        yield (
            "Stiffness of a throw, estimate, to be verified",
            f"{words}, of steel; used is the stiffness of the file",
        )

    def _torques(self, build: Lowering, owner: int, record: EngineRecord) -> None:
        """One primitive for every cylinder and order that is there."""
        station, load = record.load_says
        there = np.abs(record.inertia) > 0
        if record.gas is not None:
            there |= (np.abs(record.gas.firing) > 0).any(axis=0)
        path, name = build.parts[owner].path, build.parts[owner].name
        for one in record.cylinders:
            for harmonic in np.flatnonzero(there[1:]).tolist():
                order = Fraction(harmonic + 1, record.revolutions)
                law = CylinderOrder(
                    record.gas,
                    harmonic + 1,
                    complex(record.inertia[harmonic + 1]),
                    one.phasor(harmonic + 1),
                    station,
                    load,
                    one.state,
                    one.share,
                    owner,
                    record.by_chance,
                )
                build.add(
                    Torque(name, one.station, order, path=path, source=self.source, cylinder=law)
                )
