"""The gas torque of a cylinder, as the file gives it, as harmonics over load and speed."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from pathlib import Path as FilePath

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.engine.gas_torque import Cylinder, Diagram, GasLaw
from torsion.kernels.engine.pressure_cycles import Cycle, UnreachablePressure, fitted
from torsion.model.engine.declarations import Gas, Row, Stated
from torsion.model.engine.record import PressureCurve
from torsion.sources import source
from torsion.tables import Columns, pairs

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

    law: GasLaw | None  # None: the file gives none
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
        """Number of the highest harmonic of a cycle."""
        return self.highest * self.revolutions

    def load(self, stated: Stated) -> float:
        """Return the mean gas torque (N m) of a cylinder at a stated load."""
        if stated.torque is not None:
            return stated.torque / self.cylinders / self.efficiency
        return self.require_cylinder("an imep").mean_torque(stated.imep or 0.0)

    def require_cylinder(self, what: str) -> Cylinder:
        """The cylinder, which something needs; raises GasFault."""
        if self.cylinder is None:
            hint = "geometry: {bore, stroke, rod_length}"
            raise GasFault(f"{what} needs the `geometry` of the cylinder", hint)
        return self.cylinder


def law_of(gas: Gas, frame: Frame) -> Law:
    """The harmonics of the gas torque; raises GasFault."""
    if gas.table is not None or gas.tables:
        return _of_tables(gas, frame)
    if not gas.diagram:
        return _of_cycle(gas, frame)
    try:
        return _of_diagrams(gas, frame, frame.require_cylinder("a diagram"))
    except GasFault as fault:
        raise GasFault(fault.message, fault.hint, *(fault.key or ("diagram",))) from None


def _harmonics(rows: Sequence[Row], frame: Frame, mean: float, *key: str | int) -> ComplexArray:
    """(harmonics + 1,) N m of the rows of a table, which stands at `key`, up to the highest order."""
    harmonics = np.zeros(frame.harmonics + 1, dtype=np.complex128)
    harmonics[0] = mean
    if all(order > frame.highest for order, _, _ in rows):
        message = f"every row lies above order {frame.highest}, the highest of `orders`"
        raise GasFault(message, "raise `orders`", *key)
    for row, (order, amplitude, unit) in enumerate(rows):
        number = order * frame.revolutions
        if number.denominator != 1:
            message = f"order {order} is not a multiple of {Fraction(1, frame.revolutions)}"
            strokes = "four" if frame.revolutions == 2 else "two"
            raise GasFault(message, f"those of {strokes} strokes are", *key, row)
        size = frame.require_cylinder("a tangential pressure").tangential if unit == "Pa" else 1.0
        if number <= frame.harmonics:
            harmonics[int(number)] = amplitude * size
    return harmonics


def _of_tables(gas: Gas, frame: Frame) -> Law:
    """The law of one table or of several over load or speed, and of the rows of a cylinder without fuel."""
    motored = None
    if gas.motored is not None:
        motored = _harmonics(gas.motored, frame, 0.0, "motored")[None, :]
    if gas.table is not None:
        mean = 0.0 if gas.at is None else frame.load(gas.at)
        harmonics = _harmonics(gas.table, frame, mean, "table")
        if gas.at is None:
            law = GasLaw("nothing", np.zeros(1), harmonics[None, :], motored)
            return Law(law, "table, the same at every load")
        none = np.zeros_like(harmonics) if motored is None else motored[0]
        between = "in a straight line from the motored rows"
        between = "in proportion to the load" if motored is None else between
        values = np.stack([none, harmonics])
        law = GasLaw("load", np.array([0.0, mean]), values, motored, True, mean)
        return Law(law, f"table at one load, at others {between}")
    orders = [{order for order, _, _ in table.rows} for table in gas.tables]
    if incomplete := set.union(*orders) - set.intersection(*orders):
        message = f"order {min(incomplete)} is missing in some of the tables"
        raise GasFault(message, "the same orders in each", "tables")
    over_speed = gas.tables[0].key == "speed"
    loads = [0.0 if over_speed else frame.load(table) for table in gas.tables]
    rows = [
        _harmonics(table.rows, frame, load, "tables", number, "rows")
        for number, (table, load) in enumerate(zip(gas.tables, loads, strict=True))
    ]
    if over_speed:
        speeds = np.array([table.speed for table in gas.tables], dtype=np.float64)
        law = GasLaw("speed", speeds, np.stack(rows), motored)
        return Law(law, "tables over the speed, each with its own load")
    if motored is not None:
        loads, rows = [0.0, *loads], [motored[0], *rows]
    law = GasLaw("load", np.array(loads), np.stack(rows), motored, stated=loads[-1])
    return Law(law, "tables over the load, interpolated as complex numbers")


def absolute_pressures(
    file: FilePath, columns: Columns, *, is_absolute: bool, around: float
) -> tuple[FloatArray, FloatArray]:
    """Return both columns of a file of pressures, the second absolute (Pa); raises GasFault."""
    try:
        rows = np.array(pairs(file, columns))
    except ValueError as error:
        raise GasFault(str(error.args[0]), str(error.args[-1])) from None
    pressure = rows[:, 1] + (0.0 if is_absolute else around)
    if pressure.min() <= 0:
        hint = "for gauge pressures write `absolute: false`" if is_absolute else "of a vacuum?"
        raise GasFault(f"'{file}' has a pressure that is not above 0", hint)
    return rows[:, 0], pressure


def over_cycle(
    file: FilePath, angle: FloatArray, pressure: FloatArray, period: float, name: str
) -> Diagram:
    """Return the diagram of pressures (Pa) over one whole period (rad), called `name`; raises GasFault."""
    if not math.isclose(angle[-1] - angle[0], period, rel_tol=1e-6):
        covered, degrees = math.degrees(angle[-1] - angle[0]), round(math.degrees(period))
        hint = f"the last row repeats the first, {degrees} deg later"
        raise GasFault(f"'{file}' covers {covered:g} deg, a {name} has {degrees}", hint)
    if abs(pressure[-1] - pressure[0]) > ENDS_MEET * pressure.max():
        ends = f"{pressure[0] / BAR:.5g} and {pressure[-1] / BAR:.5g} `bar`"
        message = f"'{file}' begins and ends with other pressures, {ends}"
        raise GasFault(message, f"both are of one angle of the {name}")
    angle = angle.copy()
    angle[-1] = angle[0] + period
    return Diagram(angle, pressure)


def _of_diagrams(gas: Gas, frame: Frame, cylinder: Cylinder) -> Law:
    diagrams = []
    for given in gas.diagram:
        file = frame.folder / given.file
        angle, pressure = absolute_pressures(
            file, COLUMNS, is_absolute=bool(gas.absolute), around=gas.crankcase
        )
        angle = angle - (gas.tdc or 0.0)  # from firing top dead centre
        diagrams.append(over_cycle(file, angle, pressure, cylinder.period, "cycle"))
    mirrored = [diagram.mirrored(cylinder) for diagram in diagrams]
    firing, motored = (
        np.stack([diagram.torque(cylinder, frame.harmonics, gas.crankcase) for diagram in row])
        for row in (diagrams, mirrored)
    )
    curves = tuple(
        PressureCurve(
            given.file,
            diagram.angle,
            diagram.pressure,
            compression.pressure,
            cylinder.imep(row[0].real),
            gas.imep[0] if gas.imep and len(diagrams) == 1 else None,
            gas.crankcase,
            True,
        )
        for given, diagram, compression, row in zip(
            gas.diagram, diagrams, mirrored, firing, strict=True
        )
    )
    remarks = ("Motored pressures are the compression mirrored: an estimate.",)
    speeds = [diagram.speed for diagram in gas.diagram]
    if len(diagrams) > 1 and None not in speeds:
        law = GasLaw("speed", np.array(speeds, dtype=np.float64), firing, motored)
        words = "indicator diagrams over the speed, each with its own load"
        return Law(law, words, curves, remarks)
    law = _over_load(firing, motored[:1])
    if np.any(np.diff(law.at[1:]) <= 0):
        message = "list several diagrams without a speed in order of rising load"
        raise GasFault(message, "lowest imep first")
    if law.at[0] >= law.at[1]:
        message = "the diagram gives no more torque than its compression mirrored"
        raise GasFault(message, "is `tdc` right?")
    words = "indicator diagram, at other loads in a straight line from the motored one"
    return Law(law, words, curves, remarks)


def _over_load(firing: ComplexArray, motored: ComplexArray) -> GasLaw:
    """Return the law of harmonics (loads, harmonics) N m over their mean torque, from the motored ones on."""
    loads = np.append(motored[0, 0].real, firing[:, 0].real)
    rows = np.concatenate([motored[:1], firing])
    return GasLaw("load", loads, rows, motored, len(firing) == 1, float(loads[-1]))


_cycle = lru_cache(maxsize=32)(fitted)


@source("Wiebe1970")
def _of_cycle(gas: Gas, frame: Frame) -> Law:
    cylinder = frame.require_cylinder("a cycle")
    ports = gas.exhaust_opens or math.pi, gas.scavenge_opens or gas.exhaust_opens or math.pi
    keys = {2: ("exhaust",), 1: ("exhaust_opens", "scavenge_opens")}  # by revolutions of a cycle
    needed = keys[frame.revolutions][0]
    for key in keys[3 - frame.revolutions]:
        if getattr(gas, key):
            strokes = "two" if frame.revolutions == 1 else "four"
            raise GasFault(
                f"an engine of {strokes} strokes has no `{key}`", f"give `{needed}`", key
            )
    if not 0 < ports[0] <= ports[1] <= math.pi:
        message = "the exhaust opens before the scavenge ports and bottom dead centre"
        raise GasFault(message, "below 180 deg", "exhaust_opens")
    cycles = [_fitted(gas, cylinder, load, ports) for load in range(len(gas.imep))]
    firing, none = (
        np.stack([cycle.torque(frame.harmonics, gas.crankcase) for cycle in row])
        for row in (cycles, [cycle.motored for cycle in cycles])
    )
    several = len(cycles) > 1
    angle: FloatArray = np.linspace(cycles[0].closes, cycles[0].closes + cylinder.period, DRAWN)
    curves = tuple(
        PressureCurve(
            f"cycle at {imep / BAR:.4g} `bar` imep" if several else "cycle",
            angle,
            cycle.pressure(angle),
            cycle.motored.pressure(angle),
            imep,
            imep,
            gas.crankcase,
        )
        for cycle, imep in zip(cycles, gas.imep, strict=True)
    )
    law = _over_load(firing, np.concatenate([none[:1], none]) if several else none)
    if law.at[0] >= law.at[1]:
        message = "the imep is below the imep of the motored cycle"
        raise GasFault(message, "the cycle would take heat away", "imep")
    ends = dict.fromkeys((cycles[0], cycles[-1]))
    heat = " to ".join(f"{cycle.heat / 1e3:.5g} kJ" for cycle in ends)
    start = " to ".join(f"{math.degrees(cycle.start):.4g}" for cycle in ends)
    words = f"closed cycle, heat from {start} deg on, {heat}; at other loads with the same timing, linear in the heat"
    if several:
        words = f"closed cycles at {len(cycles)} loads, heat from {start} deg on, {heat}; at others straight lines"
    return Law(law, words, curves)


def _fitted(gas: Gas, cylinder: Cylinder, load: int, ports: tuple[float, float]) -> Cycle:
    """The cycle at one of the loads; raises GasFault."""
    charge, exhaust, imep, peak = (
        values[min(load, len(values) - 1)] if values else 0.0
        for values in (gas.charge, gas.exhaust, gas.imep, gas.p_max)
    )
    cycle = Cycle(
        cylinder,
        gas.compression_ratio or 0.0,
        charge,
        exhaust or charge,
        gas.gamma,
        gas.shape,
        gas.duration or 0.0,
        *ports,
    )
    try:
        return _cycle(cycle, imep, peak)
    except UnreachablePressure as error:
        reach = f"{error.lowest / BAR:.5g} to {error.highest / BAR:.5g} `bar`"
        at_load = f" at {imep / BAR:.4g} `bar` imep" if len(gas.imep) > 1 else ""
        message = f"no begin of the heat release gives a peak of {peak / BAR:.5g} `bar`{at_load}"
        raise GasFault(message, f"with these figures it can be {reach}", "p_max") from None
    except ValueError:
        message = "the cycle has no solution with these data"
        raise GasFault(message, "is the duration too long?", "duration") from None
