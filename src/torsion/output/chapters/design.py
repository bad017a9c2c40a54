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
    """Yield the choice, the best candidates and figures of all that were tried."""
    design = findings.need(Design)
    yield Heading("Design")
    kept = f"; constraints: {'; '.join(design.kept)}" if design.kept else ""
    trains = f", {design.solves:,} trains" if design.solves != design.evaluations else ""
    over = _over_cases(design, findings).removeprefix("; ")
    yield Paragraph(
        (f"{over[:1].upper()}{over[1:]}. " if over else "")
        + f"Objective: {design.aim}{kept}. {counted(design.evaluations, 'candidate')}{trains}: {design.method}."
        + (f" {WHAT}" if not _is_frequency(design) else "")
    )
    yield _choice(design)
    if design.unsolved:
        why = "; ".join(design.faults)
        yield Paragraph(f"{counted(design.unsolved, 'candidate')} not solved: {why}", "note")
    if design.uncounted:
        yield Paragraph(
            f"Unconfirmed limits do not enter the objective: {listed(design.uncounted, '; ')}. Candidates that exceed "
            "one rank last.",
            "note",
        )
    rows = [
        (figure.name, figure.range, figure.before or "another value", figure.chosen)
        for figure in design.figures
    ]
    yield table("< Variable | < Range | < Nominal | < Chosen", rows, "Design variables")
    yield _best_candidates(design)
    if len(design.figures) == 1 or (len(design.figures) == 2 and any(design.rows)):
        yield _curves(design)
    elif len(design.figures) == 2 and (drawn := _map(design)) is not None:
        yield drawn
    if design.against and design.front_amount.size:
        yield _front(design)


def conclusion(design: Design) -> str:
    """Return in one sentence what is chosen."""
    if design.chosen is None:
        return f"no candidate passes: {design.verdict}"
    best = design.best[design.chosen - 1]
    words = ", ".join(f"{figure.name} {figure.chosen}" for figure in design.figures)
    nominal = reached = ""
    if best.frequency is not None:
        if design.before_frequency is not None:
            nominal = f" (nominal {number(design.before_frequency)} Hz)"
        missed = design.aims[(design.values == design.picked).all(axis=1)]
        if missed.size and missed[0] < -NEAR:
            words = f"{words}: {design.aim} is not reached"
        reached = f"{number(best.frequency)} Hz{nominal}"
    elif best.utilisation is not None:
        if design.before is not None:
            nominal = f" (nominal {number(100.0 * float(np.exp(-design.before)), 4)} %)"
        reached = f"utilisation at most {number(100.0 * best.utilisation, 4)} %{nominal}"
    broken = "" if best.is_allowed else "; no candidate meets all constraints"
    return f"{words}: {reached}; full method: {best.proven}{broken}"


def design_line(findings: Findings) -> Iterator[tuple[str, str]]:
    """Yield the row of the first page."""
    design = findings.get(Design)
    if design is not None:
        yield "Design", f"{conclusion(design)}{_over_cases(design, findings)}"


def _over_cases(design: Design, findings: Findings) -> str:
    """Return of which cases the search and the solution are; empty if the file has none."""
    case, cases = findings.study.case, findings.study.cases
    if case is not None:
        return f"; case {case.name} only"
    if not cases:
        return ""
    unjudged = [name for name in cases if name not in design.cases]
    without = f"; not judged: {listed(unjudged)}" if unjudged else ""
    plural = "s" * (len(design.cases) > 1)
    judged = f" and its case{plural} {listed(design.cases)}" if design.cases else ""
    names = f"the nominal case{judged}"
    if design.is_over_cases or not design.cases:
        return f"; searched and solved over {names}{without}"
    return f"; searched for the nominal case, solved over {names}{without}"


def _choice(design: Design) -> Paragraph:
    """Return what is chosen, and what the ordinary solution gives."""
    numbered = enumerate(design.best, start=1)
    failed = [str(k) for k, candidate in numbered if candidate.proven == "disagrees"]
    words = f"Chosen: {conclusion(design)} ({design.verdict})."
    if design.chosen is not None:
        words += f" The file with these values is {FILE}."
    if failed:
        words += (
            f" The full method disagrees with the search on candidate {listed(failed)}. The next best "
            "candidate was taken."
        )
    chosen = None if design.chosen is None else design.best[design.chosen - 1]
    is_good = chosen is not None and chosen.proven == "kept" and chosen.is_allowed
    return Paragraph(words, "pass" if is_good else "note")


def _is_frequency(design: Design) -> bool:
    return design.best[0].frequency is not None if design.best else False


def _best_candidates(design: Design) -> Block:
    rows = [
        (
            k,
            ", ".join(candidate.values),
            candidate.margin,
            candidate.utilisation,
            candidate.decides + (f"; at {candidate.worst_at}" if candidate.worst_at else ""),
            candidate.frequency,
            candidate.mass,
            candidate.cost,
            _verdict(candidate, is_chosen=k == design.chosen),
        )
        for k, candidate in enumerate(design.best, start=1)
    ]
    return filled(
        table(
            "Candidate -> | < Values | Minimum margin:4 -> margin | Utilisation [%]:4 | < Governing check | Frequency "
            "[Hz]:7 -> Hz | Mass [kg] -> kg | Cost | < Verdict",
            rows,
            "Best candidates",
            short="Best candidates",
        )
    )


def _verdict(candidate: Candidate, *, is_chosen: bool) -> str:
    kept = "constraints met" if candidate.is_allowed else "constraint violated"
    margin = candidate.proven_margin
    words = "" if margin is None else f", margin {number(margin, 4)}"
    proven = f"; full method: {candidate.proven}{words}" if candidate.proven else ""
    return f"{'chosen; ' if is_chosen else ''}{kept}{proven}"


def _objective(design: Design) -> Axis:
    return Axis(
        "distance from the target, −|ln(f / target)|" if _is_frequency(design) else "minimum margin"
    )


def _limit(design: Design) -> tuple[Level, ...]:
    return () if _is_frequency(design) else (Level("limit", 0.0, is_reached=True),)


def _titled(design: Design) -> str:
    return design.aim[0].upper() + design.aim[1:]


def _axis(design: Design, variable: int) -> Axis:
    """Return the axis of a variable; names of rows in place of numbers."""
    places = tuple((float(k), label) for k, label in enumerate(design.rows[variable]))
    return Axis(
        design.figures[variable].name, "" if places else design.unit[variable], places=places
    )


def _chosen_mark(design: Design, x: np.ndarray, y: np.ndarray) -> tuple[Marks, ...]:
    if not design.picked.size:
        return ()
    picked = np.flatnonzero((design.values == design.picked).all(axis=1))[:1]
    return (Marks("chosen", x[picked], y[picked], "star", "best"),)


def _curves(design: Design) -> Figure:
    """Draw the objective over one variable; of two, one with rows, a line for each of the best rows."""
    listed_place = next((k for k, rows in enumerate(design.rows) if rows), 0)
    is_single = len(design.figures) == 1
    variable = 0 if is_single else 1 - listed_place
    x, aims = design.values[:, variable], design.aims
    row = np.zeros(len(x)) if is_single else design.values[:, listed_place]

    def best_aim(number_of_row: float) -> float:
        return float(np.nanmax(np.append(aims[row == number_of_row], -np.inf)))

    best = sorted(set(row.tolist()), key=lambda number_of_row: -best_aim(number_of_row))
    symbol: Symbol | None = "disc" if not is_single or design.rows[0] else None
    lines = []
    for pen, number_of_row in enumerate(sorted(best[:MOST_ROWS])):
        along = np.flatnonzero(row == number_of_row)
        along = along[np.argsort(x[along], kind="stable")]
        label = (
            _objective(design).quantity
            if is_single
            else design.rows[listed_place][int(number_of_row)]
        )
        lines.append(
            Line(label, x[along], aims[along], "first" if is_single else pen, symbol=symbol)
        )
    broken = np.isin(row, best[:MOST_ROWS]) & ~design.allowed & np.isfinite(aims)
    marks = Marks("constraint violated", x[broken], aims[broken], "cross", "unstable")
    panel = Panel(
        _axis(design, variable),
        _objective(design),
        tuple(lines),
        _limit(design),
        marks=(*((marks,) if broken.any() else ()), *_chosen_mark(design, x, aims)),
        height=240.0 if is_single else 260.0,
    )
    over = f"{_titled(design)} over {design.figures[variable].name}"
    if is_single:
        return Figure("design_curve", over, (panel,))
    extent = f" (the best {MOST_ROWS} of {len(best)})" if len(best) > MOST_ROWS else ""
    listed_name = design.figures[listed_place].name
    return Figure("design_rows", f"{over}, by {listed_name}{extent}", (panel,))


def _map(design: Design) -> Figure | None:
    """Draw the values of the grid without those of refinements; None if there was no grid."""
    axes = [np.unique(design.values[:, k], return_counts=True) for k in (0, 1)]
    x, y = (values[counts >= max(2, counts.max() // 2)] for values, counts in axes)
    if min(len(x), len(y)) < 2 or len(x) * len(y) > 1.2 * len(design.values):
        return None
    values = np.full((len(y), len(x)), np.nan)
    column = np.minimum(np.searchsorted(x, design.values[:, 0]), len(x) - 1)
    row = np.minimum(np.searchsorted(y, design.values[:, 1]), len(y) - 1)
    is_on_grid = (x[column] == design.values[:, 0]) & (y[row] == design.values[:, 1])
    values[row[is_on_grid], column[is_on_grid]] = design.aims[is_on_grid]
    finite = values[np.isfinite(values)]
    if not finite.size:
        return None
    largest = float(np.quantile(np.abs(finite), 0.98)) or 1.0
    cells = Cells(x, y, values, _objective(design).quantity, "", largest)
    panel = Panel(
        _axis(design, 0),
        _axis(design, 1),
        tuple(_contours(design, cells, finite)),
        marks=_chosen_mark(design, design.values[:, 0], design.values[:, 1]),
        cells=cells,
        height=300.0,
    )
    names = f"{design.figures[0].name} and {design.figures[1].name}"
    return Figure("design_map", f"{_titled(design)} over {names}", (panel,))


def _contours(design: Design, cells: Cells, finite: np.ndarray) -> Iterator[Line]:
    """Yield lines of equal objective at round numbers, between ranges."""
    if any(design.rows) or np.ptp(finite) == 0.0 or not np.isfinite(cells.values).all():
        return
    low, high = np.quantile(finite, (0.02, 1.0))
    step = 10.0 ** np.floor(np.log10((high - low) / LEVELS))
    step *= next(factor for factor in (1, 2, 5, 10) if (high - low) / (factor * step) <= LEVELS)
    for level in np.arange(np.ceil(low / step), np.floor(high / step) + 1) * step:
        parts = list(level_line(cells.x, cells.y, cells.values, level))
        if level == 0.0 or not parts:
            continue
        x, y = (np.concatenate([np.append(part[k], np.nan) for part in parts])[:-1] for k in (0, 1))
        yield Line("", x, y, "plain", label=number(float(level), 2), label_at="anywhere")


def _front(design: Design) -> Figure:
    """Draw every candidate by its amount, and the line of the best."""
    x, y, (name, unit) = design.amounts, design.aims, AMOUNTS[design.against]
    is_drawn = np.isfinite(x) & np.isfinite(y)
    kinds: tuple[tuple[str, np.ndarray, Symbol, Pen], ...] = (
        ("constraints met", is_drawn & design.allowed, "dot", "plain"),
        ("constraint violated", is_drawn & ~design.allowed, "cross", "pale"),
    )
    marks = [
        Marks(words, x[chosen], y[chosen], symbol, pen)
        for words, chosen, symbol, pen in kinds
        if chosen.any()
    ]
    best = f"best up to this {name}"
    line = Line(best, design.front_amount, design.front_margin, "best", symbol="ring")
    panel = Panel(
        Axis(name, unit),
        _objective(design),
        (line,),
        _limit(design),
        marks=(*marks, *_chosen_mark(design, x, y)),
        height=240.0,
    )
    return Figure("design_front", f"{_titled(design)} against {name}, all candidates", (panel,))
