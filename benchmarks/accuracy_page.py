"""The page of the study of accuracy: figures, the best methods by tolerance, and the verdicts."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from benchmarks.accuracy_methods import PEER
from benchmarks.error_curves import error_over_time
from benchmarks.page_file import verdict
from benchmarks.papers.writing import table
from torsion.analyses.compare.timing import TimedRow, fastest, unbeaten
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Axis, Figure
from torsion.output.numbers import number
from torsion.output.run_time_study import cells

TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12)
FASTER, MORE_ACCURATE, SHARE_OF_ERROR = 50.0, 1e10, 1e-10
ROUNDING = 2.0**-53  # the least error that is counted
EXACT = "exact"
TITLE = "Error against run time: lumped, finite elements, exact, openTorsion"
HEAD = ("method", "discretisation", "error", "median, ms", "assembly, ms", "solution, ms")

HOW = """\
Every method solves the same line: torsion's lumped model (1 to 1024 segments a shaft), its finite elements (degree 1
to 10, from 1 element a shaft on), its exact model, and openTorsion's shaft elements (linear, consistent inertia; a
cone in steps of its mean section). Frequencies: the first ten; error: the largest of the ten, relative. Torque: at
the middle of every shaft, where two shafts of half its length meet, segments and elements being those of a half; from
1 N m at the first disc with a damper at the last, at random frequencies up to the tenth mode; error: the largest, over
the largest torque of the same frequency; near a resonance a small shift of it makes a large one. The exact model is
given the highest frequency, which sets the length of its pieces. Where lumped segments meet, the torque is that of the
last one and of the half inertia beyond it; of openTorsion's elements, the mean of the two that meet. References:
closed-form two-ports in mpmath with 60 digits, every frequency proven to 40 by a change of sign.

Time: assembly and solution of one call, the median of the calls after one to warm up, in which the methods take turns
(what takes long is called once more); it is the processor's time of the one thread, which other load lengthens only
through shared caches and memory. The model file's text is read, and openTorsion's elements are listed, outside the
time. torsion gives frequencies, shapes, torques and enclosures; openTorsion `undamped_modal_analysis` and
`vibratory_torque`."""


@dataclass(frozen=True)
class Study:
    """All rows of one line."""

    name: str
    modes: tuple[TimedRow, ...]
    torques: tuple[TimedRow, ...]
    remarks: tuple[str, ...]  # what was not run, and why


def parts(studies: Sequence[Study], stepped: Sequence[TimedRow]) -> list[str]:
    """Of the page; its figures lie next to it under `figure_name`."""
    made = [HOW]
    for study in studies:
        made += [
            f"## {study.name.capitalize()}",
            f"![{study.name}]({figure_name(study)})",
            _reading(study),
        ]
        for quantity, rows in (("Frequencies", study.modes), ("Torque", study.torques)):
            made += [
                f"{quantity}: the fastest within a tolerance, and the methods that none beats.",
                _best(rows),
            ]
            made += [
                table(
                    HEAD,
                    [_cells(row) for row in unbeaten([row for row in rows if row.error < 1.0])],
                )
            ]
            made += _unanswered(rows)
        made += ["\n".join(f"- {remark}" for remark in study.remarks)] if study.remarks else []
    made += [
        "## Stepped shaft with three discs, ten modes",
        table(HEAD, [_cells(row) for row in stepped]),
    ]
    return [*made, _verdicts(stepped)]


def _cells(row: TimedRow) -> list[str]:
    """Method, discretisation, error, and medians in ms."""
    return [cell if isinstance(cell, str) else number(1e3 * cell, 3) for cell in cells(row)]


def figure_name(study: Study) -> str:
    """File name of the figure of a study."""
    return f"accuracy_{study.name.replace(' ', '_')}.svg"


def figure(study: Study) -> str:
    """SVG: error over time of both quantities, one curve a method."""
    x = Axis("assembly and solution (median)", "ms", is_log=True)
    both = ((study.modes, "ten frequencies"), (study.torques, "torque at mid-shaft"))
    panels = tuple(error_over_time(x, f"{what}, largest error", rows) for rows, what in both)
    times = [line.x for panel in panels for line in panel.lines]
    ends = min(float(np.nanmin(one)) for one in times), max(float(np.nanmax(one)) for one in times)
    x = Axis(x.quantity, x.unit, ends[0] / 1.5, ends[1] * 1.5, is_log=True)
    return svg(Figure(study.name, study.name, tuple(replace(panel, x=x) for panel in panels)))


def _reading(study: Study) -> str:
    """One sentence from the numbers."""
    exact, torque = (_of(rows, EXACT)[0] for rows in (study.modes, study.torques))
    finest = min(_of(study.modes, PEER), key=lambda row: row.error)
    return (
        f"The exact model gives ten frequencies to {exact.error:.1e} in {_ms(exact)} and the torques to "
        f"{torque.error:.1e} in {_ms(torque)}; openTorsion's best is {finest.error:.1e} with {finest.division} a shaft "
        f"in {_ms(finest)}."
    )


def _of(rows: Sequence[TimedRow], curve: str) -> list[TimedRow]:
    return [row for row in rows if row.curve == curve]


def _best(rows: Sequence[TimedRow]) -> str:
    own = [row for row in rows if row.curve != PEER]
    both = [
        [fastest(some, tolerance) for some in (own, _of(rows, PEER))] for tolerance in TOLERANCES
    ]
    named = [
        ["none" if row is None else f"{row.curve}, {row.division}: {_ms(row)}" for row in pair]
        for pair in both
    ]
    return table(
        ("tolerance", "torsion", PEER),
        [(f"{goal:g}", *pair) for goal, pair in zip(TOLERANCES, named, strict=True)],
    )


def _unanswered(rows: Sequence[TimedRow]) -> list[str]:
    """One line of the rows without a result, where there are any."""
    lacking: dict[str, list[str]] = {}
    for row in rows:
        if not np.isfinite(row.error):
            lacking.setdefault(row.curve, []).append(str(row.size))
    words = (f"{curve} with {', '.join(sizes)}" for curve, sizes in lacking.items())
    return (
        [f"Fewer than ten modes (segments or elements a shaft): {'; '.join(words)}."]
        if lacking
        else []
    )


def _verdicts(rows: Sequence[TimedRow]) -> str:
    """What the study was to show, from the rows of the stepped shaft with five shafts."""
    (exact,) = _of(rows, EXACT)
    coarse, fine = _of(rows, PEER)
    faster, closer = fine.total.median / exact.total.median, fine.error / max(exact.error, ROUNDING)
    at_least = fine.total.least / exact.total.least
    tenth = fastest(_of(rows, "fem, degree 10"), SHARE_OF_ERROR * coarse.error)
    lines = [
        f"- exact against 500 elements, times faster: {faster:.3g} by the medians, {at_least:.3g} by the smallest "
        f"times, both meant >= {FASTER:g}: " + verdict(min(faster, at_least) >= FASTER),
        f"- exact against 500 elements, times more accurate: {closer:.2g}, meant >= {MORE_ACCURATE:g}: "
        + verdict(closer >= MORE_ACCURATE),
    ]
    if tenth is None:
        return "\n".join(
            [
                *lines,
                f"- FE degree 10 with {SHARE_OF_ERROR:g} of the error of 40 elements: none, MISSED",
            ]
        )
    lines.append(
        f"- FE degree 10 ({tenth.size} a shaft) has {tenth.error / coarse.error:.1e} of the error of 40 elements, in "
        f"{_ms(tenth)} against {_ms(coarse)}, meant no more: {verdict(tenth.total.median <= coarse.total.median)}"
    )
    return "\n".join(lines)


def _ms(row: TimedRow) -> str:
    return f"{row.total.median * 1e3:.3g} ms"
