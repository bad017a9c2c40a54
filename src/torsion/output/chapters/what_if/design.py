"""Chapter: what a design chose, the best choices with their margins, and what they are over what may be chosen."""

from collections.abc import Iterator

import numpy as np

from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Axis, Cells, Figure, Level, Line, Marks, Panel, Symbol
from torsion.output.numbers import counted, number
from torsion.results import listed
from torsion.what_if.design.design_results import Design

FILE = "designed.yaml"
WHAT = (
    "The margin is ln(limit / value) for a maximum and ln(value / limit) for a minimum. The minimum over all "
    "checks with a limit counts. The program solves and checks the chosen candidate with the full method."
)
NEAR = 1e-4  # logarithm of a frequency over the aim, from which that is not reached


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the choice, the best candidates and figures of all that were tried."""
    design = findings.need(Design)
    yield Heading("Design")
    kept = f"; constraints: {'; '.join(design.kept)}" if design.kept else ""
    trains = f", {design.solves:,} trains" if design.solves != design.evaluations else ""
    over = _over_cases(design, findings).removeprefix("; ")
    is_margin = not design.best or design.best[0].frequency is None
    yield Paragraph(
        (f"{over[:1].upper()}{over[1:]}. " if over else "")
        + f"Objective: {design.aim}{kept}. {counted(design.evaluations, 'candidate')}{trains}: {design.method}."
        + (f" {WHAT}" if is_margin else "")
    )
    chosen = None if design.chosen is None else design.best[design.chosen - 1]
    numbered = list(enumerate(design.best, start=1))
    words = f"Chosen: {conclusion(design)} ({design.verdict})."
    if chosen is not None:
        words += f" The file with these values is {FILE}."
    if failed := [str(k) for k, candidate in numbered if candidate.proven == "disagrees"]:
        words += (
            f" The full method disagrees with the search on candidate {listed(failed)}. The next best "
            "candidate was taken."
        )
    is_good = chosen is not None and chosen.proven == "kept" and chosen.is_allowed
    yield Paragraph(words, "pass" if is_good else "note")
    if design.unsolved:
        why = "; ".join(design.faults)
        yield Paragraph(f"{counted(design.unsolved, 'candidate')} not solved: {why}", "note")
    if design.uncounted:
        yield Paragraph(
            f"Unconfirmed limits do not enter the objective: {listed(design.uncounted, '; ')}. Candidates that exceed "
            "one rank last.",
            "note",
        )
    titles = "name: < Variable | range: < Range | before: < Nominal | chosen: < Chosen"
    yield table(titles, design.figures, "Design variables")
    yield table(
        "Candidate -> | < Values | margin: Minimum margin:4? -> margin | utilisation: Utilisation [%]:4? | "
        "decides: < Governing check:? | worst_at: < At:? | frequency: Frequency [Hz]:7? -> Hz | mass: Mass [kg]:? -> kg | "
        "cost: Cost:? | is_allowed: < Constraints met -> met | proven: < Full method:? -> | proven_margin: Its margin:4?",
        [(candidate, k, ", ".join(candidate.values)) for k, candidate in numbered],
        "Best candidates",
        marks=["pass" if k == design.chosen else "" for k, _ in numbered],
        short="Best candidates",
    )
    yield from _figures(design, is_margin=is_margin)


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


def _figures(design: Design, *, is_margin: bool) -> Iterator[Figure]:
    """Yield the objective over one variable, as a map over two, and against mass or cost."""
    title = "minimum margin" if is_margin else "distance from the target, −|ln(f / target)|"
    objective, name = Axis(title), design.aim[0].upper() + design.aim[1:]
    limit = (Level("limit", 0.0, is_reached=True),) if is_margin else ()
    picked = (design.values == design.picked).all(axis=1) if design.picked.size else np.array([])
    chosen, kept = np.flatnonzero(picked)[:1], design.allowed

    def marked(x: FloatArray, y: FloatArray) -> tuple[Marks, ...]:
        return (Marks("chosen", x[chosen], y[chosen], "star", "best"),) if chosen.size else ()

    axes = []
    for figure, rows, unit in zip(design.figures, design.rows, design.unit, strict=True):
        places = tuple((float(k), label) for k, label in enumerate(rows))
        axes.append(Axis(figure.name, "" if places else unit, places=places))
    names = " and ".join(axis.quantity for axis in axes)
    if len(axes) == 1:
        x, order = design.values[:, 0], np.argsort(design.values[:, 0], kind="stable")
        symbol: Symbol | None = "disc" if axes[0].places else None
        line = Line(title, x[order], design.aims[order], "first", symbol=symbol)
        out = ~kept & np.isfinite(design.aims)
        broken = Marks("constraint violated", x[out], design.aims[out], "cross", "unstable")
        marks = (*([broken] if broken.x.size else []), *marked(x, design.aims))
        panel = Panel(axes[0], objective, (line,), limit, marks=marks, height=240.0)
        yield Figure("design_curve", f"{name} over {names}", (panel,))
    elif len(axes) == 2 and (cells := _cells(design, title)) is not None:
        x, y = design.values.T
        panel = Panel(axes[0], axes[1], marks=marked(x, y), cells=cells, height=300.0)
        yield Figure("design_map", f"{name} over {names}", (panel,))

    if design.against and design.front_amount.size:
        x, unit = design.amounts, "kg" if design.against == "mass" else ""
        front = design.front_amount, design.front_margin
        line = Line(f"best up to this {design.against}", *front, "best", symbol="ring")
        known = np.isfinite(x) & np.isfinite(design.aims)
        met, out = known & kept, known & ~kept
        marks = (
            Marks("constraints met", x[met], design.aims[met], "dot"),
            Marks("constraint violated", x[out], design.aims[out], "cross", "pale"),
            *marked(x, design.aims),
        )
        panel = Panel(
            Axis(design.against, unit), objective, (line,), limit, marks=marks, height=240.0
        )
        yield Figure("design_front", f"{name} against {design.against}, all candidates", (panel,))


def _cells(design: Design, title: str) -> Cells | None:
    """Return the values of the grid without those of refinements; None if there was no grid."""
    axes = [np.unique(values, return_counts=True) for values in design.values.T]
    x, y = (values[counts >= max(2, int(counts.max()) // 2)] for values, counts in axes)
    if min(len(x), len(y)) < 2 or len(x) * len(y) > 1.2 * len(design.values):
        return None
    values = np.full((len(y), len(x)), np.nan)
    for (along, up), aim in zip(design.values, design.aims, strict=True):
        values[np.ix_(y == up, x == along)] = aim
    known = np.abs(values[np.isfinite(values)])
    if not known.size:
        return None
    return Cells(x, y, values, title, "", float(np.quantile(known, 0.98)) or 1.0)
