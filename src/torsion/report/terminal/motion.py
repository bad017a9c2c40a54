"""The exact response and the stability on the terminal."""

import numpy as np
from rich.table import Table as Grid

from torsion.analyses.motion.periodic_orbits import PeriodicResponse
from torsion.analyses.motion.stability_over_speed import Stability
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.report.numbers import number, rpm
from torsion.report.terminal.grids import filled, grid


def largest_by_both(findings: Findings) -> Grid | None:
    """The largest torque of every element, to the first order and exactly."""
    if findings.get(PeriodicResponse) is None or findings.get(Response) is None:
        return None
    from torsion.report.motion import compared, flagged, signed

    exact, bad, rows = findings.need(PeriodicResponse), flagged(findings), compared(findings)
    together = [row for row in rows if row.order is None] or list(rows)
    made = grid("Exact periodic response, largest torque", ("element", "<"), ("order", ">"), ("first order, N m", ">"),
                ("exact, N m", ">"), ("at rpm", ">"), ("%", ">"), ("", "<"))  # fmt: skip
    cells = []
    for row in together:
        if row.exact is None:
            continue
        size, at = row.exact
        first = "–" if row.first is None else number(row.first[0], 4)
        mark = "" if not bad[at] else ("unstable" if exact.is_unstable[at] else "coarse")
        change = signed(row.excess) if np.isfinite(row.excess) else "–"
        cells.append([row.element.name, "all" if row.order is None else str(row.order), first, number(size, 4),
                      rpm(float(exact.speed[at])), change, mark])  # fmt: skip
    return filled(made, cells)


def unstable_ranges(findings: Findings) -> Grid | None:
    """The unstable ranges of speed."""
    if findings.get(Stability) is None:
        return None
    from torsion.report.unstable import ABOVE, BELOW, end, fastest, legend

    ranges = findings.need(Stability).ranges
    heads = (("from rpm", ">"), ("to rpm", ">"), ("growth, 1/s", ">"), ("at rpm", ">"), ("type", "<"))
    made = grid(f"Unstable ranges of speed{legend(ranges)}", *heads)
    return filled(made, [
        [end(one, BELOW, 7), end(one, ABOVE, 7), number(one.growth, 4), fastest(one), one.zone.name]
        for one in ranges
    ])  # fmt: skip
