"""The Holzer table of a mode as a block: inner segments of a shaft are summed into the row of its end."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.analyses.holzer import HolzerTable, holzer
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray, IntArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Table, head
from torsion.output.numbers import NONE, number

MOST_TIMES_FIRST = 1e3  # an amplitude larger than so many times the first: then the largest is 1
COLUMNS = head(
    "< Station | J referred [kg m²] | Angle [rad] | ω² J × angle [N m] | < Through | Torque [N m] | "
    "Flexibility [rad/(N m)] | Twist [rad]"
)


def holzer_table(findings: Findings, modes: Modes, mode: int) -> list[Block]:
    """One table; of a train with loops the rows of its tree."""
    table = holzer(findings.system, modes, mode)
    largest = float(np.abs(table.angle).max())
    scale, first = (largest, "largest") if largest > MOST_TIMES_FIRST else (1.0, "first")
    own = len(findings.system.train.stations)
    stated = np.flatnonzero(table.station < own)
    sums = _Sums.of(table, stated)
    rows = [_row(findings, table, (row, line), sums, scale) for line, row in enumerate(stated.tolist())]
    segments = _summed(findings) if own < len(findings.system.stations) else ""
    caption = f"Holzer table of mode {mode + 1}, referred to the reference speed, {first} amplitude 1 rad.{segments}"
    return [Table(COLUMNS, tuple(rows), caption)]


def _summed(findings: Findings) -> str:
    """What became of the stations inside a shaft, in a sentence."""
    if findings.system.bars is None:
        return " A shaft's segments are summed up in the row of its end."
    return (
        " A shaft's pieces, each the spring between two inertias that it is at this frequency, are summed up in the "
        "row of its end."
    )


@dataclass(frozen=True)
class _Sums:
    """Sums over each printed row and the inner segments of a shaft before it; (printed rows,) each."""

    flexibility: FloatArray
    twist: FloatArray
    torque: FloatArray
    inertia: FloatArray

    @classmethod
    def of(cls, table: HolzerTable, printed: IntArray) -> "_Sums":
        """The sums up to each of the rows `printed` from the one before; what is behind the last belongs to none."""
        starts, end = np.append(0, printed[:-1] + 1), int(printed[-1]) + 1
        columns = table.flexibility, table.twist, table.inertia_torque, table.referred_inertia
        return cls(*(np.add.reduceat(column[:end], starts) for column in columns))


def _row(findings: Findings, table: HolzerTable, place: tuple[int, int], sums: _Sums, scale: float) -> tuple[str, ...]:
    """The line of the printed table for a row; place: row of the table and number of the line."""
    row, line = place
    system, span = findings.system, int(table.span[row])
    inertia = float(sums.inertia[line])
    cells = [
        system.stations[int(table.station[row])].name, "held" if math.isinf(inertia) else number(inertia),
        number(float(table.angle[row]) / scale, 6),
        number(float(sums.torque[line]) / scale),
    ]  # fmt: skip
    if span < 0:
        return (*cells, NONE, NONE, NONE, NONE)
    bars = {bar.part: bar.name for bar in system.train.bars}
    name = bars.get(system.spans[span].part, system.spans[span].name)
    flexibility, twist = float(sums.flexibility[line]), float(sums.twist[line])
    through = "rigid" if flexibility == 0 else number(flexibility)
    return (*cells, name, number(float(table.torque[row]) / scale), through, number(twist / scale))
