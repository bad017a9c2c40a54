"""The figure of error against run time: one curve a method, one point a discretisation, on logarithmic axes."""

from collections.abc import Sequence

import numpy as np

from torsion.analyses.compare.timing import TimedRow
from torsion.output.figures.figure import Axis, Band, Line, Panel, Symbol

LEAST = 1.2e-16  # an error below half the rounding unit is drawn there: it is rounding
SYMBOLS: tuple[Symbol, ...] = ("disc", "square", "triangle", "diamond")
FAMILIES: dict[
    str, tuple[Symbol, float]
] = {  # start of a method's name: symbol, and weight of the line
    "modes, exact": ("star", 0.0),
    "dense": ("cross", 1.2),
    "lumped": ("disc", 1.4),
    "fem": ("dot", 0.8),
    "exact": ("star", 0.0),
    "two-sided": ("star", 0.0),
    "": ("square", 1.0),  # another program
}


def drawn_error(values: np.ndarray) -> np.ndarray:
    """Return rounding as the lowest drawn error, and NaN for what is no number or infinite."""
    return np.where(np.isfinite(values), np.maximum(values, LEAST), np.nan)


def error_over_time(x: Axis, quantity: str, rows: Sequence[TimedRow]) -> Panel:
    """Return the plot of errors over median run times, the middle half of the runs as a level line."""
    lines, largest = list[Line](), 0.1
    for pen, name in enumerate(dict.fromkeys(row.curve for row in rows)):
        of_method = [row for row in rows if row.curve == name and np.isfinite(row.error)]
        if not of_method:
            continue
        totals = [row.total for row in of_method]
        median, low, high = (
            1e3 * np.array([getattr(total, key) for total in totals])
            for key in ("median", "quarter", "three_quarters")
        )
        error = np.array([row.error for row in of_method])
        largest = max(largest, float(error.max()))
        symbol, weight = next(look for start, look in FAMILIES.items() if name.startswith(start))
        label = name.replace(", elimination", "")
        lines.append(Line(label, median, drawn_error(error), pen, symbol=symbol, weight=weight))
        spread = np.column_stack([low, high, np.full_like(low, np.nan)]).ravel()
        lines.append(Line("", spread, np.repeat(drawn_error(error), 3), pen, weight=0.5))
    least = LEAST / 3.0
    doubt = Band("below the bound of the reference", least, LEAST, "doubt", "y")
    y = Axis(quantity, "", least, 10.0 * largest, is_log=True, is_error=True)
    return Panel(x, y, tuple(lines), bands=(doubt,), height=270.0)
