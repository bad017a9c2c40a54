"""The page of the study of accuracy: figures, the best methods by tolerance, and the verdicts."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.accuracy_rows import Row, best, frontier
from benchmarks.log_axes import plain_numbers
from benchmarks.papers.writing import table
from torsion.output.figures.style import COLOURS, GREY, legend_below, page

TOLERANCES = (1e-1, 1e-2, 1e-3, 1e-4, 1e-6, 1e-9, 1e-12)
FASTER, MORE_ACCURATE, SHARE_OF_ERROR = 50.0, 1e10, 1e-10
ROUNDING = 2.0**-53  # a smaller error is drawn here
PEER, EXACT, LUMPED = "openTorsion", "exact", "lumped"
WHAT = {"modes": "ten frequencies, largest error", "torques": "torque at mid-shaft, largest error"}

HOW = """\
Every method solves the same line: torsion's lumped model (1 to 1024 segments a shaft), its finite elements (degree 1
to 10, from 1 element a shaft on), its exact model, and openTorsion's shaft elements (linear, consistent inertia; a
cone in steps of its mean section). Frequencies: the first ten; error: the largest of the ten, relative. Torque: at
the middle of every shaft, from 1 N m at the first disc with a damper at the last, at random frequencies up to the
tenth mode; error: the largest, over the largest torque of the same frequency; near a resonance a small shift of it
makes a large one. The exact model is told the highest frequency, which sets the length of its pieces. Where a method
tells one torque a segment, it is given the mean of the two that meet at the middle. References: closed-form two-ports
in mpmath with 60 digits, every frequency proven to 40 by a change of sign.

Time: assembly and solution of one call, the median of the calls after one to warm up, in which the methods take turns
(what takes long is called once more); it is the processor's time of the one thread, which other load lengthens only
through shared caches and memory. The scene's text is read, and openTorsion's elements are listed, outside the time.
torsion gives frequencies, shapes, torques and enclosures; openTorsion `undamped_modal_analysis` and
`vibratory_torque`."""


@dataclass(frozen=True)
class Study:
    """All rows of one line."""

    name: str
    modes: list[Row]
    torques: list[Row]


def text(studies: Sequence[Study], stepped: Sequence[Row], about: Sequence[str], how: str) -> str:
    """The page; its figures lie beside it under `figure_name`."""
    parts = ["# Error against run time: lumped, finite elements, exact, openTorsion", how, HOW]
    parts += ["\n".join(f"- {line}" for line in about)]
    for study in studies:
        parts += [f"## {study.name.capitalize()}", f"![{study.name}]({figure_name(study)})", _reading(study)]
        for quantity, rows in (("Frequencies", study.modes), ("Torque", study.torques)):
            parts += [f"{quantity}: the fastest within a tolerance, and the methods that none beats.", _best(rows)]
            parts += [_frontier(rows), *_unanswered(rows)]
    parts += ["## Stepped shaft with three discs, ten modes, one run", _stepped(stepped), _verdicts(stepped)]
    return "\n\n".join(parts) + "\n"


def figure_name(study: Study) -> str:
    """File name of the figure of a study."""
    return f"accuracy_{study.name.replace(' ', '_')}.svg"


def figure(study: Study) -> str:
    """SVG: error over time of both quantities, one curve a family."""
    with page(study.name, 6.6, 2, sharex=True) as sheet:
        for axes, (quantity, rows) in zip(
            sheet.axes, (("modes", study.modes), ("torques", study.torques)), strict=True
        ):
            for family in dict.fromkeys(row.family for row in rows):
                known = [row for row in rows if row.family == family and np.isfinite(row.error)]
                time, error = [row.seconds * 1e3 for row in known], [max(row.error, ROUNDING) for row in known]
                axes.plot(time, error, label=_label(family), **_pen(family))
            axes.set_xscale("log")
            axes.set_yscale("log")
            axes.set_ylim(ROUNDING / 3, 3.0)
            plain_numbers(axes.xaxis, axes.yaxis)
            axes.set_ylabel(WHAT[quantity])
        sheet.axes[-1].set_xlabel("assembly and solution, ms (median)")
        sheet.figure.align_ylabels()
        legend_below(sheet)
    return sheet.svg


def _label(family: str) -> str:
    return {PEER: "openTorsion", EXACT: "torsion exact", LUMPED: "torsion lumped"}.get(family, f"torsion {family}")


def _pen(family: str) -> dict[str, Any]:
    """Finite elements in shades from light to dark, all else in a colour of its own."""
    if family == PEER:
        return {"color": COLOURS[1], "marker": "s", "linestyle": "-"}
    if family == EXACT:
        return {"color": COLOURS[2], "marker": "*", "markersize": 11, "linestyle": "none", "zorder": 5}
    if family == LUMPED:
        return {"color": GREY, "marker": "o", "linestyle": "--"}
    degree = int(family.rpartition(" ")[2])
    share = (degree - 1) / 9
    return {"color": (0.62 - 0.62 * share, 0.80 - 0.60 * share, 0.95 - 0.45 * share), "marker": ".", "linewidth": 0.9}


def _reading(study: Study) -> str:
    """One sentence from the numbers."""
    exact = next(row for row in study.modes if row.family == EXACT)
    torque = next(row for row in study.torques if row.family == EXACT)
    finest = min((row for row in study.modes if row.family == PEER), key=lambda row: row.error)
    return (
        f"The exact model gives ten frequencies to {exact.error:.1e} in {_ms(exact.seconds)} and the torques to "
        f"{torque.error:.1e} in {_ms(torque.seconds)}; openTorsion's best is {finest.error:.1e} with {finest.name} "
        f"elements a shaft in {_ms(finest.seconds)}."
    )


def _best(rows: Sequence[Row]) -> str:
    found = []
    for tolerance in TOLERANCES:
        own = best([row for row in rows if row.family != PEER], tolerance)
        peer = best([row for row in rows if row.family == PEER], tolerance)
        found.append((f"{tolerance:g}", _told(own), _told(peer)))
    return table(("tolerance", "torsion", "openTorsion"), found)


def _told(row: Row | None) -> str:
    if row is None:
        return "none"
    name = row.name if row.name.startswith(("degree", EXACT)) else f"{row.family}, {row.name} a shaft"
    return f"{name}: {_ms(row.seconds)}"


def _frontier(rows: Sequence[Row]) -> str:
    head = ("method", "fineness", "error", "assembly", "solution", "both: median (least to most)")
    return table(head, [_cells(row) for row in frontier(rows)])


def _cells(row: Row) -> tuple[str, ...]:
    total = row.total
    parts = (_ms(statistics.median(times)) for times in (row.assembly, row.solution))
    spread = f"{_ms(row.seconds)} ({_ms(min(total))} to {_ms(max(total))}, {len(total)})"
    return _label(row.family), row.name, f"{row.error:.1e}", *parts, spread


def _unanswered(rows: Sequence[Row]) -> list[str]:
    """One line of the rows without an answer, where there are any."""
    left: dict[str, list[str]] = {}
    for row in rows:
        if not np.isfinite(row.error):
            left.setdefault(_label(row.family), []).append(row.name.rpartition(" ")[2])
    told = (f"{family} with {', '.join(names)}" for family, names in left.items())
    return [f"Fewer than ten modes, or no answer (elements a shaft): {'; '.join(told)}."] if left else []


def _stepped(rows: Sequence[Row]) -> str:
    head = ("method", "elements a shaft", "error", "assembly", "solution", "both: median (least to most, calls)")
    return table(head, [_cells(row) for row in rows])


def _verdicts(rows: Sequence[Row]) -> str:
    """What the study was to show, from the rows of the stepped shaft with five shafts."""
    exact = next(row for row in rows if row.family == EXACT)
    peer = {row.name: row for row in rows if row.family == PEER}
    fine, coarse = peer["100"], peer["8"]
    faster, closer = fine.seconds / exact.seconds, fine.error / max(exact.error, ROUNDING)
    at_least = min(fine.total) / min(exact.total)
    tenth = best([row for row in rows if row.family == "FE degree 10"], SHARE_OF_ERROR * coarse.error)
    lines = [
        f"- exact against 500 elements, times faster: {faster:.3g} by the medians, {at_least:.3g} by the least times, "
        f"both meant >= {FASTER:g}: " + _verdict(min(faster, at_least) >= FASTER),
        f"- exact against 500 elements, times more accurate: {closer:.2g}, meant >= {MORE_ACCURATE:g}: "
        + _verdict(closer >= MORE_ACCURATE),
    ]
    if tenth is None:
        return "\n".join([*lines, f"- FE degree 10 with {SHARE_OF_ERROR:g} of the error of 40 elements: none, MISSED"])
    lines.append(
        f"- FE degree 10 ({tenth.name.rpartition(' ')[2]} a shaft) has {tenth.error / coarse.error:.1e} of the error "
        f"of 40 elements, in {_ms(tenth.seconds)} against {_ms(coarse.seconds)}, meant no more: "
        f"{_verdict(tenth.seconds <= coarse.seconds)}"
    )
    return "\n".join(lines)


def _verdict(is_met: bool) -> str:
    return "met" if is_met else "MISSED"


def _ms(seconds: float) -> str:
    return f"{seconds * 1e3:.3g} ms"
