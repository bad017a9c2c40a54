"""A sweep: the error of every method over one extreme parameter, where each ends, and what the figure shows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

from benchmarks.papers.writing import table
from torsion.output.figures.error_curves import error_axis
from torsion.output.figures.style import BAD, COLOURS, page, plots

ROUNDING = 2.0**-53  # a smaller error is drawn here
USEFUL = 1e-6  # the error beyond which a method has ended
DECADES = 10  # on the axis of the parameter, at most
HIGHEST = 1e3  # errors are drawn up to here


@dataclass(frozen=True)
class Point:
    """One answer of one method."""

    at: float  # of the parameter
    error: float  # infinite where there is none
    fault: str = ""


@dataclass
class Sweep:
    """The answers of all methods over one parameter."""

    name: str  # of the file
    title: str
    what: str  # what is solved, and what the error is
    along: str  # the parameter, for the axis
    points: dict[str, list[Point]] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    limit: list[tuple[float, float]] = field(default_factory=list)  # what the next frequency in double changes

    def add(self, method: str, at: float, error: Callable[[], float]) -> None:
        """The error of one answer; an exception or no number is an answer that failed, and kept as such."""
        try:
            value, fault = error(), ""
            if not np.isfinite(value):
                value, fault = float("inf"), "no finite answer"
        except Exception as failed:  # peers fail in ways of their own; the page states each in its words
            value, fault = float("inf"), f"{type(failed).__name__}: {failed}".splitlines()[0][:120]
        self.points.setdefault(method, []).append(Point(at, value, fault))


def ranges(points: Sequence[Point], useful: float = USEFUL) -> list[tuple[float, float]]:
    """First and last parameter of every range of the sweep in which the answers are useful."""
    found: list[tuple[float, float]] = []
    before = False
    for point in points:
        good = point.error <= useful
        if good:
            found.append((found.pop()[0] if before else point.at, point.at))
        before = good
    return found


def ranges_in_words(points: Sequence[Point], useful: float = USEFUL) -> str:
    """The ranges in words."""
    found = ranges(points, useful)
    if not found:
        return "nowhere"
    if found == [(points[0].at, points[-1].at)]:
        return "throughout"
    return ", ".join(f"{first:.2g} to {last:.2g}" if first != last else f"{first:.2g}" for first, last in found)


def reading(sweep: Sweep) -> str:
    """What the figure shows, in one sentence made from its numbers."""
    parts = [f"{method} {ranges_in_words(points)}" for method, points in sweep.points.items()]
    own = max(point.error for method, points in sweep.points.items() for point in points if _is_ours(method))
    others = [point.error for method, points in sweep.points.items() for point in points if not _is_ours(method)]
    return (
        f"Useful answers (error up to {USEFUL:g}): {'; '.join(parts)}; the largest error of torsion is {_size(own)}, "
        f"of the others {_size(max(others))}."
    )


def _is_ours(method: str) -> bool:
    return method.startswith("torsion")


def _pen(method: str) -> dict[str, Any]:
    """A method keeps its colour from figure to figure."""
    if _is_ours(method):
        return {"color": COLOURS[4 if "plain" in method else 0], "linewidth": 1.6}
    families = {"openTorsion": (1, "-"), "scipy": (3, "-."), "textbook": (6, "-")}
    colour, dashes = next((pen for start, pen in families.items() if method.startswith(start)), (2, "--"))
    return {"color": COLOURS[colour], "linestyle": dashes}


def _size(error: float) -> str:
    return f"{error:.1e}" if np.isfinite(error) else "beyond all bounds (no answer)"


def ends_table(sweep: Sweep) -> str:
    """Where each method is useful, its largest error there, and the faults it met."""
    rows = []
    for method, points in sweep.points.items():
        worst = max((point.error for point in points if point.error <= USEFUL), default=float("nan"))
        faults = dict.fromkeys(f"{point.fault} (at {point.at:.2g})" for point in points if point.fault)
        words = "; ".join(list(faults)[:2]) + (f"; {len(faults) - 2} more" if len(faults) > 2 else "")
        largest = max(point.error for point in points)
        rows.append((method, ranges_in_words(points), f"{worst:.1e}", _size(largest), words))
    return table((sweep.along, "useful", "largest error there", "largest error anywhere", "faults"), rows)


def figure(sweep: Sweep) -> str:
    """SVG: error over the parameter, one curve a method; crosses at the top are answers that failed."""
    return page(sweep.name, _curves, sweep=sweep)


def _curves(sheet: Figure, sweep: Sweep) -> None:
    (axes,) = plots(sheet, 3.5)
    at = sorted({point.at for points in sweep.points.values() for point in points})
    for rank, (method, points) in enumerate(sweep.points.items()):
        pen = _pen(method)
        known = [point for point in points if np.isfinite(point.error)]
        values = [min(max(point.error, ROUNDING), HIGHEST) for point in known]
        axes.plot([point.at for point in known], values, marker=".", label=method, zorder=4 - 0.1 * rank, **pen)
        failed = [point.at for point in points if not np.isfinite(point.error)]
        axes.plot(failed, [HIGHEST / 2 ** (rank + 1)] * len(failed), "x", color=pen["color"], zorder=5)
    if sweep.limit:
        axes.plot(*zip(*sweep.limit, strict=True), color=BAD, linewidth=1.4, linestyle=(0, (1, 2)),
                  label="what the next double of the frequency changes")  # fmt: skip
    axes.set_xscale("log")
    error_axis(axes, ROUNDING / 3, HIGHEST * 2)
    if sweep.points and next(iter(sweep.points.values()))[0].at > at[0]:
        axes.invert_xaxis()
    axes.xaxis.set_major_locator(LogLocator(numticks=DECADES))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_xlabel(sweep.along)
    axes.set_ylabel("largest relative error")
