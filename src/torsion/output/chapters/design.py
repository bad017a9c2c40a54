"""Chapter: what a design chose, the best choices with their margins, and what they are over what may be chosen."""

from collections.abc import Iterator

import numpy as np

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, filled, table
from torsion.output.figures.contours import level_line
from torsion.output.figures.figure import (
    Axis,
    Cells,
    Figure,
    Level,
    Line,
    Marks,
    Panel,
    Pen,
    Symbol,
)
from torsion.output.numbers import counted, number
from torsion.results import listed
from torsion.what_if.design.design_results import Candidate, Design

FILE = "designed.yaml"
WHAT = (
    "The margin is ln(limit / value) for a maximum and ln(value / limit) for a minimum. The minimum over all "
    "checks with a limit counts. The program solves and checks the chosen candidate with the full method."
)
MOST_ROWS = 8  # of a list or a catalogue that are drawn
NEAR = 1e-4  # logarithm of a frequency over the aim, from which that is not reached
LEVELS = 8  # contours of a map, about
AMOUNTS = {"mass": ("mass", "kg"), "cost": ("cost", "")}


def chapter(findings: Findings) -> Iterator[Block]:
    """The choice, its rivals and figures of all that was tried."""
    found = findings.need(Design)
    yield Heading("Design")
    kept = f"; constraints: {'; '.join(found.kept)}" if found.kept else ""
    worst = f", {found.solves:,} trains" if found.solves != found.evaluations else ""
    over = _judged(found, findings).removeprefix("; ")
    yield Paragraph(
        (f"{over[:1].upper()}{over[1:]}. " if over else "")
        + f"Objective: {found.aim}{kept}. {counted(found.evaluations, 'candidate')}{worst}: {found.method}."
        + (f" {WHAT}" if not _is_frequency(found) else "")
    )
    yield _said(found)
    if found.unsolved:
        yield Paragraph(
            f"{counted(found.unsolved, 'candidate')} not solved: {'; '.join(found.faults)}", "note"
        )
    if found.uncounted:
        yield Paragraph(
            f"Unconfirmed limits do not enter the objective: {listed(found.uncounted, '; ')}. Candidates that exceed "
            "one rank last.",
            "note",
        )
    rows = [
        (one.name, one.range, one.before or "another value", one.chosen) for one in found.figures
    ]
    yield table("< Variable | < Range | < Nominal | < Chosen", rows, "Design variables")
    yield _best(found)
    yield from _figures(found)


def conclusion(found: Design) -> str:
    """What is chosen, in one sentence."""
    if found.chosen is None:
        return f"no candidate passes: {found.verdict}"
    one = found.best[found.chosen - 1]
    words = ", ".join(f"{figure.name} {figure.chosen}" for figure in found.figures)
    if one.frequency is not None:
        was = (
            ""
            if found.before_frequency is None
            else f" (nominal {number(found.before_frequency)} Hz)"
        )
        missed = found.aims[(found.values == found.picked).all(axis=1)]
        words = (
            f"{words}: {found.aim} is not reached" if missed.size and missed[0] < -NEAR else words
        )
        reached = f"{number(one.frequency)} Hz{was}"
    else:
        was = "" if found.before is None else f" (nominal {number(_share(found.before), 4)} %)"
        reached = (
            ""
            if one.utilisation is None
            else f"utilisation at most {number(100.0 * one.utilisation, 4)} %{was}"
        )
    broken = "" if one.is_allowed else "; no candidate meets all constraints"
    return f"{words}: {reached}; full method: {one.proven}{broken}"


def design_line(findings: Findings) -> Iterator[tuple[str, str]]:
    """The row of the first page."""
    found = findings.get(Design)
    if found is not None:
        yield "Design", f"{conclusion(found)}{_judged(found, findings)}"


def _judged(found: Design, findings: Findings) -> str:
    """Of which cases the search and the solution are; empty where the file has none."""
    case, cases = findings.study.case, findings.study.cases
    if case is not None:
        return f"; case {case.name} only"
    if not cases:
        return ""
    silent = [name for name in cases if name not in found.cases]
    without = f"; not judged: {listed(silent)}" if silent else ""
    own = (
        f" and its case{'s' * (len(found.cases) > 1)} {listed(found.cases)}" if found.cases else ""
    )
    names = f"the nominal case{own}"
    if found.is_over_cases or not found.cases:
        return f"; searched and solved over {names}{without}"
    return f"; searched for the nominal case, solved over {names}{without}"


def _said(found: Design) -> Paragraph:
    """What is chosen, and what the ordinary solution says."""
    failed = [k for k, one in enumerate(found.best, start=1) if one.proven == "disagrees"]
    words = f"Chosen: {conclusion(found)} ({found.verdict})."
    if found.chosen is not None:
        words += f" The file with these values is {FILE}."
    if failed:
        words += (
            f" The full method disagrees with the search on candidate {listed(map(str, failed))}. The next best "
            "candidate was taken."
        )
    is_good = found.chosen is not None and found.best[found.chosen - 1].proven == "kept"
    return Paragraph(
        words, "pass" if is_good and found.best[(found.chosen or 1) - 1].is_allowed else "note"
    )


def _is_frequency(found: Design) -> bool:
    return found.best[0].frequency is not None if found.best else False


def _share(margin: float) -> float:
    """Of the limit, %."""
    return float(100.0 * np.exp(-margin))


def _best(found: Design) -> Block:
    rows = [
        (
            k,
            ", ".join(one.values),
            None if one.margin is None else number(one.margin, 4),
            None if one.utilisation is None else number(100.0 * one.utilisation, 4),
            one.decides + (f"; at {one.worst_at}" if one.worst_at else ""),
            None if one.frequency is None else number(one.frequency, 7),
            None if one.mass is None else number(one.mass),
            None if one.cost is None else number(one.cost),
            _words(one, is_chosen=k == found.chosen),
        )
        for k, one in enumerate(found.best, start=1)
    ]
    return filled(
        table(
            "Candidate -> | < Values | Minimum margin -> margin | Utilisation [%] | < Governing check | Frequency "
            "[Hz] -> Hz | "
            "Mass [kg] -> kg | Cost | < Verdict",
            rows,
            "Best candidates",
            short="Best candidates",
        )
    )


def _words(one: Candidate, *, is_chosen: bool) -> str:
    kept = "constraints met" if one.is_allowed else "constraint violated"
    margin = "" if one.proven_margin is None else f", margin {number(one.proven_margin, 4)}"
    proven = f"; full method: {one.proven}{margin}" if one.proven else ""
    return f"{'chosen; ' if is_chosen else ''}{kept}{proven}"


def _figures(found: Design) -> Iterator[Figure]:
    """A curve of one figure, a map of two, and the best of every mass or cost."""
    if len(found.figures) == 1:
        yield _curve(found)
    if len(found.figures) == 2:
        drawn = _rows(found) if any(found.rows) else _map(found)
        yield from () if drawn is None else (drawn,)
    if found.against and found.front_amount.size:
        yield _front(found)


def _quantity(found: Design) -> tuple[str, str]:
    return (
        ("distance from the target, −|ln(f / target)|", "")
        if _is_frequency(found)
        else ("minimum margin", "")
    )


def _titled(found: Design) -> str:
    return found.aim[0].upper() + found.aim[1:]


def _axis(found: Design, place: int) -> Axis:
    """Of a figure; names of rows in place of numbers."""
    places = tuple((float(k), label) for k, label in enumerate(found.rows[place]))
    return Axis(found.figures[place].name, "" if places else found.unit[place], places=places)


def _marks(found: Design, x: np.ndarray, y: np.ndarray) -> tuple[Marks, ...]:
    picked = (
        np.flatnonzero((found.values == found.picked).all(axis=1))[:1]
        if found.picked.size
        else np.zeros(0, dtype=int)
    )
    return (Marks("chosen", x[picked], y[picked], "star", "best"),) if picked.size else ()


def _curve(found: Design) -> Figure:
    x = found.values[:, 0]
    at = np.argsort(x, kind="stable")
    y = found.aims
    symbol: Symbol | None = "disc" if found.rows[0] else None
    lines = (Line(_quantity(found)[0], x[at], y[at], "first", symbol=symbol),)
    broken = ~found.allowed & np.isfinite(y)
    marks = (
        (Marks("constraint violated", x[broken], y[broken], "cross", "unstable"),)
        if broken.any()
        else ()
    )
    level = () if _is_frequency(found) else (Level("limit", 0.0, is_reached=True),)
    panel = Panel(
        _axis(found, 0),
        Axis(*_quantity(found)),
        lines,
        level,
        marks=(*marks, *_marks(found, x, y)),
        height=240.0,
    )
    return Figure("design_curve", f"{_titled(found)} over {found.figures[0].name}", (panel,))


def _rows(found: Design) -> Figure:
    """Of two figures, one with rows: a line for each of the rows, of which the best are drawn, over the other."""
    listed_at = 0 if found.rows[0] else 1
    other, row = found.values[:, 1 - listed_at], found.values[:, listed_at]
    best = sorted(
        set(row.tolist()), key=lambda one: -np.nanmax(np.append(found.aims[row == one], -np.inf))
    )
    lines = []
    for pen, one in enumerate(sorted(best[:MOST_ROWS])):
        at = np.flatnonzero(row == one)
        at = at[np.argsort(other[at], kind="stable")]
        lines.append(
            Line(found.rows[listed_at][int(one)], other[at], found.aims[at], pen, symbol="disc")
        )
    shown = np.isin(row, best[:MOST_ROWS]) & ~found.allowed & np.isfinite(found.aims)
    marks = (
        (Marks("constraint violated", other[shown], found.aims[shown], "cross", "unstable"),)
        if shown.any()
        else ()
    )
    level = () if _is_frequency(found) else (Level("limit", 0.0, is_reached=True),)
    panel = Panel(
        _axis(found, 1 - listed_at),
        Axis(*_quantity(found)),
        tuple(lines),
        level,
        marks=(*marks, *_marks(found, other, found.aims)),
        height=260.0,
    )
    rest = f" (the best {MOST_ROWS} of {len(best)})" if len(best) > MOST_ROWS else ""
    names = found.figures[1 - listed_at].name, found.figures[listed_at].name
    return Figure("design_rows", f"{_titled(found)} over {names[0]}, by {names[1]}{rest}", (panel,))


def _map(found: Design) -> Figure | None:
    """The values of the grid, those of refinements left out; None where there was no grid."""
    axes = [np.unique(found.values[:, k], return_counts=True) for k in (0, 1)]
    x, y = (values[counts >= max(2, counts.max() // 2)] for values, counts in axes)
    if min(len(x), len(y)) < 2 or len(x) * len(y) > 1.2 * len(found.values):
        return None
    values = np.full((len(y), len(x)), np.nan)
    column, row = np.searchsorted(x, found.values[:, 0]), np.searchsorted(y, found.values[:, 1])
    column, row = np.minimum(column, len(x) - 1), np.minimum(row, len(y) - 1)
    there = (x[column] == found.values[:, 0]) & (y[row] == found.values[:, 1])
    values[row[there], column[there]] = found.aims[there]
    known = values[np.isfinite(values)]
    if not known.size:
        return None
    cells = Cells(x, y, values, *_quantity(found), float(np.quantile(np.abs(known), 0.98)) or 1.0)
    panel = Panel(
        _axis(found, 0),
        _axis(found, 1),
        tuple(_contours(found, cells, known)),
        marks=_marks(found, found.values[:, 0], found.values[:, 1]),
        cells=cells,
        height=300.0,
    )
    return Figure(
        "design_map",
        f"{_titled(found)} over {found.figures[0].name} and {found.figures[1].name}",
        (panel,),
    )


def _contours(found: Design, cells: Cells, known: np.ndarray) -> Iterator[Line]:
    """Lines of equal aim at round numbers, between ranges."""
    if any(found.rows) or np.ptp(known) == 0.0 or not np.isfinite(cells.values).all():
        return
    low, high = np.quantile(known, (0.02, 1.0))
    step = 10.0 ** np.floor(np.log10((high - low) / LEVELS))
    step *= next(factor for factor in (1, 2, 5, 10) if (high - low) / (factor * step) <= LEVELS)
    for level in np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step:
        parts = list(level_line(cells.x, cells.y, cells.values, level))
        if level == 0.0 or not parts:
            continue
        x, y = (np.concatenate([np.append(part[k], np.nan) for part in parts])[:-1] for k in (0, 1))
        yield Line("", x, y, "plain", label=number(float(level), 2), label_at="anywhere")


def _front(found: Design) -> Figure:
    """Every choice by its amount, and the line of the best."""
    x, y, (name, unit) = found.amounts, found.aims, AMOUNTS[found.against]
    kept, known = found.allowed, np.isfinite(found.amounts) & np.isfinite(found.aims)
    each: tuple[tuple[str, np.ndarray, Symbol, Pen], ...] = (
        ("constraints met", known & kept, "dot", "plain"),
        ("constraint violated", known & ~kept, "cross", "pale"),
    )
    marks = [Marks(words, x[at], y[at], symbol, pen) for words, at, symbol, pen in each if at.any()]
    line = Line(
        f"best up to this {name}", found.front_amount, found.front_margin, "best", symbol="ring"
    )
    level = () if _is_frequency(found) else (Level("limit", 0.0, is_reached=True),)
    panel = Panel(
        Axis(name, unit),
        Axis(*_quantity(found)),
        (line,),
        level,
        marks=(*marks, *_marks(found, x, y)),
        height=240.0,
    )
    return Figure("design_front", f"{_titled(found)} against {name}, all candidates", (panel,))
