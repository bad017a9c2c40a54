"""The pressures of an end of a compressor's cylinder, as the file gives them, as a diagram over the crank angle."""

import math
from dataclasses import dataclass
from pathlib import Path as FilePath

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.engine.gas_torque import Cylinder, Diagram
from torsion.kernels.engine.pressure_volume import NoLoop, of_loop
from torsion.model.compressor.record import End, EndRecord
from torsion.model.engine.gas_laws import (
    COLUMNS,
    ENDS_MEET,
    GasFault,
    absolute_pressures,
    over_cycle,
)
from torsion.two_columns import Columns, named

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


@dataclass(frozen=True)
class Pressures:
    """What the file says to all ends."""

    folder: FilePath
    is_absolute: bool
    around: float  # Pa, absolute, outside of the cylinders
    tdc: float | None  # rad, in files over the angle
    count: int  # harmonics


def end_of(end: End, given: str | float, cylinder: Cylinder, pressures: Pressures) -> EndRecord:
    """An end with its diagram and harmonics; raises GasFault."""
    clearance: float | None = None
    if not isinstance(given, str):
        ends = np.full(2, given + (0.0 if pressures.is_absolute else pressures.around))
        diagram = Diagram(np.array([0.0, 2.0 * math.pi]), ends)
    else:
        diagram, clearance = _of_file(end, given, cylinder, pressures)
    sense = 1.0 if end == "head end" else -1.0
    torque = sense * diagram.torque(cylinder, pressures.count, pressures.around)
    if not isinstance(given, str):
        torque[0] = 0.0  # what it takes it gives back
    words = given if isinstance(given, str) else f"constant {given / 1e5:g} bar"
    return EndRecord(end, words, isinstance(given, str), cylinder, diagram, clearance, torque)


def _of_file(
    end: End, name: str, cylinder: Cylinder, pressures: Pressures
) -> tuple[Diagram, float | None]:
    """Return the diagram of a file of pressures, and the clearance where the file has volumes; raises GasFault."""
    file = pressures.folder / name
    columns = named(file, (ANGLE, VOLUME, TRAVEL, SHARE))
    first, pressure = absolute_pressures(
        file, columns, is_absolute=pressures.is_absolute, around=pressures.around
    )
    if columns is ANGLE:
        if pressures.tdc is None:
            message = f"'{file}' is over the angle, and `tdc` is missing"
            raise GasFault(message, "angle of the dead centre of the head end")
        angle = first - pressures.tdc
        return over_cycle(file, angle, pressure, 2.0 * math.pi, "revolution"), None
    travel, clearance = _travel(file, first, columns, cylinder)
    if end == "crank end":
        travel = cylinder.crank.stroke - travel
    try:
        return of_loop(cylinder.crank, travel, pressure, ENDS_MEET), clearance
    except NoLoop as fault:
        row = "" if fault.row is None else f", row {fault.row + 1} below the units"
        raise GasFault(f"'{file}'{row}: {fault.message}", fault.hint) from None


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
