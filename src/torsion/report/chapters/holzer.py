"""The Holzer table of a mode as a block: inner segments of a shaft are summed into the row of its end."""

import math

import numpy as np

from torsion.analyses.holzer import HolzerTable, holzer
from torsion.analyses.modes import Modes
from torsion.findings import Findings
from torsion.report.blocks import Block, Column, Table
from torsion.report.numbers import NONE, number

MOST_TIMES_FIRST = 1e3  # an amplitude larger than so many times the first: then the largest is 1
COLUMNS = (
    Column("Station", align="left"), Column("J referred", "kg m²"), Column("Angle", "rad"),
    Column("ω² J × angle", "N m"),
    Column("Through", align="left"), Column("Torque", "N m"), Column("Flexibility", "rad/(N m)"),
    Column("Twist", "rad"),
)  # fmt: skip


def holzer_table(findings: Findings, modes: Modes, mode: int) -> list[Block]:
    """One table; of a train with loops the rows of its tree."""
    table = holzer(findings.system, modes, mode)
    largest = float(np.abs(table.angle).max())
    scale, first = (largest, "largest") if largest > MOST_TIMES_FIRST else (1.0, "first")
    own = len(findings.system.train.stations)
    rows, summed = [], _Sum()
    for row, station in enumerate(table.station.tolist()):
        if station >= own:
            summed.add(table, row)
            continue
        rows.append(_row(findings, table, row, summed, scale))
        summed = _Sum()
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


class _Sum:
    """What the inner segments of a shaft add to the row of its end."""

    def __init__(self) -> None:
        self.flexibility = self.twist = self.torque = self.inertia = 0.0

    def add(self, table: HolzerTable, row: int) -> None:
        """Add one inner segment."""
        self.flexibility += float(table.flexibility[row])
        self.twist += float(table.twist[row])
        self.torque += float(table.inertia_torque[row])
        self.inertia += float(table.referred_inertia[row])


def _row(findings: Findings, table: HolzerTable, row: int, inner: _Sum, scale: float) -> tuple[str, ...]:
    system, span = findings.system, int(table.span[row])
    inertia = float(table.referred_inertia[row]) + inner.inertia
    cells = [
        system.stations[int(table.station[row])].name, "held" if math.isinf(inertia) else number(inertia),
        number(float(table.angle[row]) / scale, 6),
        number((float(table.inertia_torque[row]) + inner.torque) / scale),
    ]  # fmt: skip
    if span < 0:
        return (*cells, NONE, NONE, NONE, NONE)
    name = system.train.parts[system.spans[span].part].name
    flexibility = float(table.flexibility[row]) + inner.flexibility
    twist = float(table.twist[row]) + inner.twist
    through = "rigid" if flexibility == 0 else number(flexibility)
    return (*cells, name, number(float(table.torque[row]) / scale), through, number(twist / scale))
