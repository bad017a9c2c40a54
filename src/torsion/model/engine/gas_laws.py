"""The gas torque of a cylinder, as the file gives it, as harmonics over load and speed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise
from pathlib import Path as FilePath

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.engine.gas_law import GasLaw
from torsion.kernels.engine.gas_torque import Cylinder, Diagram
from torsion.kernels.engine.wiebe_cycle import Cycle, UnreachablePressure, fitted
from torsion.model.engine.declarations import Gas, Row, Stated, TableAt
from torsion.model.engine.record import PressureCurve
from torsion.sources import source
from torsion.two_columns import Columns, pairs

COLUMNS = Columns(
    ("angle", "pressure"),
    ("rad", "Pa"),
    "angle [deg], pressure [bar]",
    "-360, 2.4",
    "a finite pressure at an angle",
)
ENDS_MEET = 0.01  # of the largest pressure: how far first and last of a cycle may differ in a measured diagram
BAR = 1e5
DRAWN = 721  # points of a computed cycle in its figure


@dataclass(frozen=True)
class Law:
    """The harmonics, and what a report says of them."""

    law: GasLaw
    words: str
    curves: tuple[PressureCurve, ...] = ()
    remarks: tuple[str, ...] = ()


class GasFault(ValueError):
    """What is wrong with the gas torque: message, hint, and the steps from `gas` to what is at fault."""

    def __init__(self, message: str, hint: str = "", *key: str | int) -> None:
        self.message, self.hint, self.key = message, hint, key
        super().__init__(message)


@dataclass(frozen=True)
class Frame:
    """What the engine says to it: revolutions of a cycle, highest order, cylinders, efficiency, geometry, folder."""

    revolutions: int
    highest: int
    cylinders: int
    efficiency: float
    cylinder: Cylinder | None
    folder: FilePath

    @property
    def harmonics(self) -> int:
        """Number of the highest harmonic."""
        return self.highest * self.revolutions

    def load(self, at: Stated | TableAt) -> float:
        """N m mean gas torque of a cylinder at a stated load."""
        if at.torque is not None:
            return at.torque / self.cylinders / self.efficiency
        return self.known("an imep").mean_torque(at.imep or 0.0)

    def known(self, what: str) -> Cylinder:
        """The cylinder, which something needs; raises GasFault."""
        if self.cylinder is None:
            raise GasFault(
                f"{what} needs the `geometry` of the cylinder",
                "geometry: {bore, stroke, rod_length}",
            )
        return self.cylinder


def law_of(gas: Gas, frame: Frame) -> Law:
    """The harmonics of the gas torque; raises GasFault."""
    if gas.table is not None:
        return _of_table(gas, frame)
    if gas.tables:
        return _of_tables(gas, frame)
    return _of_diagrams(gas, frame) if gas.diagram else _of_cycle(gas, frame)


def _harmonics(rows: Sequence[Row], frame: Frame, mean: float, *key: str | int) -> ComplexArray:
    """(harmonics + 1,) N m of the rows of a table, which stands at `key`, up to the highest order."""
    found = np.zeros(frame.harmonics + 1, dtype=np.complex128)
    found[0] = mean
    if all(order > frame.highest for order, _, _ in rows):
        raise GasFault(
            f"every row lies above order {frame.highest}, the highest of `orders`",
            "raise `orders`",
            *key,
        )
    for place, (order, amplitude, unit) in enumerate(rows):
        number = order * frame.revolutions
        if number.denominator != 1:
            least = Fraction(1, frame.revolutions)
            kind = "four" if frame.revolutions == 2 else "two"
            raise GasFault(
                f"order {order} is not a multiple of {least}",
                f"those of {kind} strokes are",
                *key,
                place,
            )
        size = frame.known("a tangential pressure").tangential if unit == "Pa" else 1.0
        if number <= frame.harmonics:
            found[int(number)] = amplitude * size
    return found


def _motored(gas: Gas, frame: Frame) -> ComplexArray | None:
    return None if gas.motored is None else _harmonics(gas.motored, frame, 0.0, "motored")[None, :]


def _of_table(gas: Gas, frame: Frame) -> Law:
    motored, rows = _motored(gas, frame), gas.table or ()
    if gas.at is None:
        law = GasLaw(
            "nothing", np.zeros(1), _harmonics(rows, frame, 0.0, "table")[None, :], motored
        )
        return Law(law, "table, the same at every load")
    mean = frame.load(gas.at)
    full = _harmonics(rows, frame, mean, "table")
    none = np.zeros_like(full) if motored is None else motored[0]
    law = GasLaw("load", np.array([0.0, mean]), np.stack([none, full]), motored, True, mean)
    between = (
        "in proportion to the load"
        if motored is None
        else "in a straight line from the motored rows"
    )
    return Law(law, f"table at one load, at others {between}")


def _of_tables(gas: Gas, frame: Frame) -> Law:
    motored, key = _motored(gas, frame), gas.tables[0].key
    orders = [frozenset(order for order, _, _ in one.rows) for one in gas.tables]
    odd = next(
        (
            order
            for order in sorted(frozenset.union(*orders))
            if any(order not in one for one in orders)
        ),
        None,
    )
    if odd is not None:
        raise GasFault(
            f"order {odd} is missing in some of the tables", "the same orders in each", "tables"
        )
    if key == "speed":
        at = np.array([one.speed for one in gas.tables], dtype=np.float64)
        each = enumerate(gas.tables)
        firing = np.stack(
            [_harmonics(one.rows, frame, 0.0, "tables", place, "rows") for place, one in each]
        )
        return Law(
            GasLaw("speed", at, firing, motored), "tables over the speed, each with its own load"
        )
    loads = [frame.load(one) for one in gas.tables]
    rows = [
        _harmonics(one.rows, frame, load, "tables", place, "rows")
        for place, (one, load) in enumerate(zip(gas.tables, loads, strict=True))
    ]
    if motored is not None:
        loads, rows = [0.0, *loads], [motored[0], *rows]
    law = GasLaw("load", np.array(loads), np.stack(rows), motored, stated=loads[-1])
    return Law(law, "tables over the load, interpolated as complex numbers")


def _diagram(gas: Gas, place: int, frame: Frame, cylinder: Cylinder) -> Diagram:
    """A file as absolute pressures over angles from firing top dead centre; raises GasFault."""
    file = frame.folder / gas.diagram[place].file
    try:
        rows = np.array(pairs(file, COLUMNS))
    except ValueError as error:
        raise GasFault(str(error.args[0]), str(error.args[-1]), "diagram") from None
    angle, pressure = (
        rows[:, 0] - (gas.tdc or 0.0),
        rows[:, 1] + (0.0 if gas.absolute else gas.crankcase),
    )
    if pressure.min() <= 0:
        hint = "for gauge pressures write `absolute: false`" if gas.absolute else "of a vacuum?"
        raise GasFault(f"'{file}' has a pressure that is not above 0", hint, "diagram")
    degrees = math.degrees(angle[-1] - angle[0])
    if not math.isclose(angle[-1] - angle[0], cylinder.period, rel_tol=1e-6):
        whole = 360 * cylinder.revolutions
        hint = f"the last row repeats the first, {whole} deg later"
        raise GasFault(f"'{file}' covers {degrees:g} deg, a cycle has {whole}", hint, "diagram")
    if abs(pressure[-1] - pressure[0]) > ENDS_MEET * pressure.max():
        ends = f"{pressure[0] / BAR:.5g} and {pressure[-1] / BAR:.5g} `bar`"
        raise GasFault(
            f"'{file}' begins and ends with other pressures, {ends}",
            "both are of one angle of the cycle",
            "diagram",
        )
    angle[-1] = angle[0] + cylinder.period
    return Diagram(angle, pressure)


def _of_diagrams(gas: Gas, frame: Frame) -> Law:
    cylinder, count, around = frame.known("a diagram"), frame.harmonics, gas.crankcase
    found = [_diagram(gas, place, frame, cylinder) for place in range(len(gas.diagram))]
    motored = [one.mirrored(cylinder) for one in found]
    firing, none = (
        np.stack([one.torque(cylinder, count, around) for one in each]) for each in (found, motored)
    )
    curves = tuple(
        PressureCurve(
            given.file,
            one.angle,
            one.pressure,
            other.pressure,
            cylinder.imep(row[0].real),
            gas.imep[0] if gas.imep and len(found) == 1 else None,
            around,
            True,
        )
        for given, one, other, row in zip(gas.diagram, found, motored, firing, strict=True)
    )
    remarks = ("Motored pressures are the compression mirrored: an estimate.",)
    speeds = [one.speed for one in gas.diagram]
    if len(found) > 1 and None not in speeds:
        law = GasLaw("speed", np.array(speeds, dtype=np.float64), firing, none)
        return Law(
            law, "indicator diagrams over the speed, each with its own load", curves, remarks
        )
    loads = firing[:, 0].real
    if any(before >= after for before, after in pairwise(loads)):
        raise GasFault(
            "list several diagrams without a speed in order of rising load",
            "lowest imep first",
            "diagram",
        )
    at, rows = np.append(none[0, 0].real, loads), np.concatenate([none[:1], firing])
    if at[0] >= at[1]:
        raise GasFault(
            "the diagram gives no more torque than its compression mirrored",
            "is `tdc` right?",
            "diagram",
        )
    law = GasLaw("load", at, rows, none[:1], len(found) == 1, float(loads[-1]))
    return Law(
        law,
        "indicator diagram, at other loads in a straight line from the motored one",
        curves,
        remarks,
    )


@lru_cache(maxsize=32)
def _cycle(cycle: Cycle, imep: float, peak: float) -> Cycle:
    return fitted(cycle, imep, peak)


@source("Wiebe1970")
def _of_cycle(gas: Gas, frame: Frame) -> Law:
    cylinder, needed = (
        frame.known("a cycle"),
        ("exhaust",) if frame.revolutions == 2 else ("exhaust_opens",),
    )
    ports = gas.exhaust_opens or math.pi, gas.scavenge_opens or gas.exhaust_opens or math.pi
    for key in ("exhaust",) if frame.revolutions == 1 else ("exhaust_opens", "scavenge_opens"):
        if getattr(gas, key):
            strokes = "two" if frame.revolutions == 1 else "four"
            raise GasFault(
                f"an engine of {strokes} strokes has no `{key}`", f"give `{needed[0]}`", key
            )
    if not getattr(gas, needed[0]):
        raise GasFault(f"`{needed[0]}` is missing", Gas.model_fields[needed[0]].description or "")
    if not 0 < ports[0] <= ports[1] <= math.pi:
        raise GasFault(
            "the exhaust opens before the scavenge ports and bottom dead centre",
            "below 180 deg",
            "exhaust_opens",
        )
    made = [_fitted(gas, cylinder, load, ports) for load in range(len(gas.imep))]
    firing, none = (
        np.stack([one.torque(frame.harmonics, gas.crankcase) for one in each])
        for each in (made, [one.motored for one in made])
    )
    several = len(made) > 1
    angle: FloatArray = np.linspace(made[0].closes, made[0].closes + cylinder.period, DRAWN)
    curves = tuple(
        PressureCurve(
            f"cycle at {imep / BAR:.4g} `bar` imep" if several else "cycle",
            angle,
            one.pressure(angle),
            one.motored.pressure(angle),
            imep,
            imep,
            gas.crankcase,
        )
        for one, imep in zip(made, gas.imep, strict=True)
    )
    at, rows = np.append(none[0, 0].real, firing[:, 0].real), np.concatenate([none[:1], firing])
    if at[0] >= at[1]:
        raise GasFault(
            "the imep is below the imep of the motored cycle",
            "the cycle would take heat away",
            "imep",
        )
    motored = np.concatenate([none[:1], none]) if several else none
    law = GasLaw("load", at, rows, motored, not several, float(at[-1]))
    ends = dict.fromkeys((made[0], made[-1]))
    heat = " to ".join(f"{one.heat / 1e3:.5g} kJ" for one in ends)
    start = " to ".join(f"{math.degrees(one.start):.4g}" for one in ends)
    words = f"closed cycle, heat from {start} deg on, {heat}; at other loads with the same timing, linear in the heat"
    if several:
        words = f"closed cycles at {len(made)} loads, heat from {start} deg on, {heat}; at others straight lines"
    return Law(law, words, curves)


def _fitted(gas: Gas, cylinder: Cylinder, load: int, ports: tuple[float, float]) -> Cycle:
    """The cycle at one of the loads; raises GasFault."""
    charge, exhaust, imep, peak = (
        None if not values else values[min(load, len(values) - 1)]
        for values in (gas.charge, gas.exhaust, gas.imep, gas.p_max)
    )
    plain = Cycle(
        cylinder,
        gas.compression_ratio or 0.0,
        charge or 0.0,
        exhaust or charge or 0.0,
        gas.gamma,
        gas.shape,
        gas.duration or 0.0,
        *ports,
    )
    try:
        return _cycle(plain, imep or 0.0, peak or 0.0)
    except UnreachablePressure as error:
        reach = f"{error.lowest / BAR:.5g} to {error.highest / BAR:.5g} `bar`"
        place = f" at {(imep or 0.0) / BAR:.4g} `bar` imep" if len(gas.imep) > 1 else ""
        message = (
            f"no begin of the heat release gives a peak of {(peak or 0.0) / BAR:.5g} `bar`{place}"
        )
        raise GasFault(message, f"with these figures it can be {reach}", "p_max") from None
    except ValueError:
        raise GasFault(
            "the cycle has no solution with these data", "is the duration too long?", "duration"
        ) from None
