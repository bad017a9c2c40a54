"""A sweep: the error of every method over one extreme parameter, where each ends, and what the figure shows."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from benchmarks.papers.writing import table
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Axis, Figure, Line, Marks, Panel

ROUNDING = 2.0**-53  # a smaller error is drawn here
USEFUL = 1e-6  # the error beyond which a method has ended
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
    limit: list[tuple[float, float]] = field(
        default_factory=list
    )  # what the next frequency in double changes

    def add(self, method: str, at: float, error: Callable[[], float]) -> None:
        """The error of one answer; an exception or no number is an answer that failed, and kept as such."""
        try:
            value, fault = error(), ""
            if not np.isfinite(value):
                value, fault = float("inf"), "no finite answer"
        except (
            Exception
        ) as failed:  # peers fail in ways of their own; the page states each in its words
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
    return ", ".join(
        f"{first:.2g} to {last:.2g}" if first != last else f"{first:.2g}" for first, last in found
    )


def reading(sweep: Sweep) -> str:
    """What the figure shows, in one sentence made from its numbers."""
    parts = [f"{method} {ranges_in_words(points)}" for method, points in sweep.points.items()]
    own = max(
        point.error
        for method, points in sweep.points.items()
        for point in points
        if _is_ours(method)
    )
    others = [
        point.error
        for method, points in sweep.points.items()
        for point in points
        if not _is_ours(method)
    ]
    return (
        f"Useful answers (error up to {USEFUL:g}): {'; '.join(parts)}; the largest error of torsion is {_size(own)}, "
        f"of the others {_size(max(others))}."
    )


def _is_ours(method: str) -> bool:
    return method.startswith("torsion")


def _pen(method: str) -> int:
    """A method keeps its pen from figure to figure."""
    if _is_ours(method):
        return 4 if "plain" in method else 0
    families = {"openTorsion": 1, "scipy": 3, "textbook": 6}
    return next((pen for start, pen in families.items() if method.startswith(start)), 2)


def _size(error: float) -> str:
    return f"{error:.1e}" if np.isfinite(error) else "beyond all bounds (no result)"


def ends_table(sweep: Sweep) -> str:
    """Where each method is useful, its largest error there, and the faults it met."""
    rows = []
    for method, points in sweep.points.items():
        worst = max(
            (point.error for point in points if point.error <= USEFUL), default=float("nan")
        )
        faults = dict.fromkeys(
            f"{point.fault} (at {point.at:.2g})" for point in points if point.fault
        )
        words = "; ".join(list(faults)[:2]) + (
            f"; {len(faults) - 2} more" if len(faults) > 2 else ""
        )
        largest = max(point.error for point in points)
        rows.append((method, ranges_in_words(points), f"{worst:.1e}", _size(largest), words))
    return table(
        (sweep.along, "useful", "largest error there", "largest error anywhere", "faults"), rows
    )


def figure(sweep: Sweep) -> str:
    """SVG: error over the parameter, one curve a method; crosses at the top are answers that failed."""
    lines, marks = [], []
    for rank, (method, points) in enumerate(sweep.points.items()):
        known = [point for point in points if np.isfinite(point.error)]
        values = [min(max(point.error, ROUNDING), HIGHEST) for point in known]
        at = np.array([point.at for point in known])
        weight = 1.3 if _is_ours(method) else 1.0
        lines.append(Line(method, at, np.array(values), _pen(method), symbol="dot", weight=weight))
        failed = np.array([point.at for point in points if not np.isfinite(point.error)])
        high = np.full(failed.size, HIGHEST / 2 ** (rank + 1))
        marks.append(Marks("no answer", failed, high, "cross", _pen(method)))
    if sweep.limit:
        at, error = np.array(sweep.limit).T
        lines.append(Line("what the next double of the frequency changes", at, error, "limit"))
    every = [point.at for points in sweep.points.values() for point in points]
    back = bool(every) and next(iter(sweep.points.values()))[0].at > min(every)
    x = Axis(
        sweep.along,
        "",
        min(every, default=1.0),
        max(every, default=10.0),
        is_log=True,
        is_reversed=back,
    )
    y = Axis("largest relative error", "", ROUNDING / 3, HIGHEST * 2, is_log=True, is_error=True)
    return svg(
        Figure(
            sweep.name, sweep.title, (Panel(x, y, tuple(lines), marks=tuple(marks), height=260.0),)
        )
    )
