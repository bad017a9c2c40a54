"""The critical bending speeds on the terminal."""

from typing import TYPE_CHECKING

from rich.table import Table as Grid

from torsion.report.lateral_tables import Range, critical_row, inside, near, unstable
from torsion.report.terminal.grids import filled, grid

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import Lateral


def bending_speeds(found: "Lateral", speeds: Range) -> Grid:
    """Those of every shaft in the range (*) and the next ones above it, and whether a shaft is unstable."""
    heads = (("shaft", "<"), ("order", ">"), ("rpm", ">"), ("Hz", ">"), ("whirl", "<"), ("damping ratio", ">"))
    made = grid("Critical bending speeds (* in the range)", *heads)
    rows = []
    for shaft in found.shafts:
        grows = shaft.whirl is not None and bool(unstable(shaft.whirl.log_decrement).any())
        grows |= shaft.tilting is not None and bool(shaft.tilting.zones)
        for one in near(shaft, speeds):
            name, order, _, speed, hertz, sense, ratio = critical_row(shaft, one)
            mark = "*" if inside(shaft, one, speeds) else ""
            rows.append([f"{name} (UNSTABLE)" if grows else name, order, speed + mark, hertz, sense, ratio])
    return filled(made, rows)
