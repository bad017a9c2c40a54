"""Chapter: what varies, how frequencies spread, which checks fail where, and with which probability."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.modes.tolerances import Tolerances
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Heading, Paragraph, Table, head, table
from torsion.output.figures import variants
from torsion.output.numbers import counted, unit_words
from torsion.output.records import along
from torsion.what_if.sweep.sweep_results import Grid, Sweep

MOST_CHECKS, MOST_MODES = 60, 3
MOST_ROWS, ENDS = 40, 10  # variants in the table: all, or those that use limits least and most
METHODS = {
    "sobol": "eight scrambled Sobol sequences; intervals by Student's t over the eight",
    "latin": "a latin hypercube; intervals as for independent samples (Wilson, conservative)",
    "random": "independent random samples; intervals by Wilson",
    "grid": "all combinations of the values",
}
WHAT = (
    "Probabilities follow from the distributions stated here. A manufacturer's tolerance is an interval "
    "without a distribution; a uniform distribution is an assumption. A variant that is not solved or not "
    "judged counts as failing."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield distributions, frequencies, checks and figures of all variants."""
    sweep = findings.need(Sweep)
    is_grid = sweep.method == "grid"
    yield Heading("Sweep")
    method = f"({METHODS[sweep.method]})" + ("." if is_grid else f", seed {sweep.seed}. {WHAT}")
    yield Paragraph(f"{counted(sweep.samples, 'variant')} {method}")
    if sweep.unsolved:
        why = "; ".join(sweep.faults)
        yield Paragraph(f"{counted(sweep.unsolved, 'variant')} not solved: {why}", "note")
    titles = "name: < Parameter | law: < Distribution about the nominal value | together: Group"
    yield table(titles, sweep.figures, "Varied parameters")
    if sweep.nominal.size:
        of_samples = (
            "mean: Mean:7 -> mean | deviation: Standard deviation:4 | low: 2.5 % quantile:7 -> 2.5 % | "
            "high: 97.5 % quantile:7 -> 97.5 % | "
        )
        yield table(
            f"mode: Mode -> | nominal: Nominal:7 -> Hz | {'' if is_grid else of_samples}"
            "least: Minimum:7 -> minimum | greatest: Maximum:7 -> maximum",
            along(sweep, "mode"),
            "Natural frequencies of all variants",
            short="Natural frequencies of the variants",
        )
    if sweep.any_fails is not None:
        of_samples = "lower: From [%]:3 | upper: To [%]:3 | median: Median utilisation [%]:4"
        yield table(
            "clause: < Clause | what: < Check -> | where: < Component -> | failing: Variants that fail -> fail | "
            "probability: Probability [%]:3 -> fails, % | "
            f"{'best: Minimum utilisation [%]:4' if is_grid else of_samples} | worst: Maximum [%]:4 -> maximum, % | "
            "decides: < Correlates with:? | correlation: Rank correlation:2?",
            (sweep.any_fails, *sweep.checks),
            f"Checks over {counted(sweep.samples, 'variant')}" + (" (95 % CI)" * (not is_grid)),
            most=MOST_CHECKS,
            short="Checks over all variants",
        )
    if is_grid:
        yield from _grid(sweep, sweep.grid)
    else:
        yield from _samples(findings, sweep)
    if sweep.indices:
        yield table(
            "of: < Result -> | figure: < Parameter -> | first: First index [%]:3 -> first, % | first_error: ± [%]:2 | "
            "total: Total index [%]:3 -> total, % | total_error: ± [%]:2",
            sweep.indices,
            "Sensitivity: share of the variance due to a parameter (Sobol's first and total index), ± half of the "
            "95 % CI",
            short="Sensitivity (Sobol indices)",
        )


def _samples(findings: Findings, sweep: Sweep) -> Iterator[Block]:
    """Yield the figures of samples: frequencies, utilisations, and the variants over the parameters that decide most."""
    if sweep.nominal.size:
        tolerances = findings.get(Tolerances)
        bounds = zip(*((tolerances.lower, tolerances.upper) if tolerances else ()), strict=True)
        yield variants.frequencies(sweep, [(float(low), float(high)) for low, high in bounds])
    if sweep.any_fails is None:
        return
    yield variants.shares(sweep)
    names = [figure.name for figure in sweep.figures]
    if len(names) > 1 and 0 < sweep.any_fails.failing < sweep.samples:
        decisive = [check.decides for check in sweep.checks if check.failing and check.decides]
        pair = list(dict.fromkeys([*decisive, *names]))[:2]
        yield variants.failing(sweep, sweep.any_fails.fails, [names.index(name) for name in pair])


def _grid(sweep: Sweep, grid: Grid | None) -> Iterator[Block]:
    """Yield where checks change, the figure of one or two parameters, and the variants."""
    if grid is None:
        text = "The report does not list the variants, because there are too many."
        yield Paragraph(text, "note")
        return
    axis = grid.axes[0]
    if grid.turns:
        yield table(
            "clause: < Clause | what: < Check -> | where: < Component -> | kept: Passes at:6 -> passes | "
            "failing: Fails at:6 -> fails | between: Limit at about -> limit at about",
            [(sweep.checks[turn.check], turn) for turn in grid.turns],
            f"Changes between pass and fail over {axis.name} [{unit_words(axis.unit)}]",
            short="Changes between pass and fail",
        )
    elif len(grid.axes) == 1 and sweep.any_fails is not None and axis.is_numeric:
        word = "every" if sweep.any_fails.failing else "no"
        text = "No check changes between pass and fail in this range"
        yield Paragraph(f"{text}: {word} variant fails.")
    if len(grid.axes) == 1:
        yield variants.curve(grid, sweep.checks)
    elif len(grid.axes) == 2:
        yield from variants.maps(grid)
    yield _variants(sweep, grid)


def _variants(sweep: Sweep, grid: Grid) -> Table:
    """Return all variants in their order, or the best and the worst; a variant without a solution with its fault."""
    shown, caption, why = list(range(sweep.samples)), "Variants", dict(grid.why)
    if sweep.samples > MOST_ROWS:
        lost = np.isin(shown, list(why))
        ranked = np.lexsort((np.nan_to_num(grid.greatest), grid.fails, lost)).tolist()
        shown = [*ranked[:ENDS], *ranked[-ENDS:]]
        caption = f"The {ENDS} variants with the lowest and the {ENDS} with the highest utilisation"
    modes = range(1, len(grid.frequency[:MOST_MODES]) + 1)
    titles = [f"frequency@{mode}: Mode {mode} [Hz]:7 -> mode {mode}, Hz" for mode in modes]
    if sweep.checks:
        titles += ["greatest: Maximum utilisation [%]:4? -> maximum, %", "< Check:?"]
    titles += ["< Verdict -> verdict"]
    rows = []
    for variant, place in zip(shown, along(grid, "variant", shown), strict=True):
        decisive = int(grid.decisive[variant])
        check = sweep.checks[decisive] if decisive >= 0 else None
        verdict = "fails" if grid.fails[variant] else "passes"
        if variant in why:
            verdict = f"not solved: {why[variant]}"
        elif not sweep.checks:
            verdict = "solved"
        decisive_words = [check and f"{check.clause}: {check.where}"] if sweep.checks else []
        rows.append((place, *grid.words(variant), *decisive_words, verdict))
    columns = (
        *(Column(axis.name, align="left", short=axis.name) for axis in grid.axes),
        *head(" | ".join(titles)),
    )
    marks = ["fail" if grid.fails[variant] else "" for variant in shown]
    return table(columns, rows, caption, marks=marks, short="" if sweep.checks else caption)
