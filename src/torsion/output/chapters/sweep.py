"""Chapter: what varies, how frequencies spread, and with which probability a check fails."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.modes.tolerances import Tolerances
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.chapters import sweep_grid
from torsion.output.chapters.sweep_grid import by_mode
from torsion.output.figures import variants
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Marks, Panel, Role
from torsion.output.numbers import counted, unit_words
from torsion.what_if.sweep.sweep_results import Sweep, SweptCheck

MOST_LINES, MOST_CHECKS, MOST_MODES = 6, 60, 3
MOST_THROUGH = 60  # variants of a kind in parallel coordinates
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
    yield Heading("Sweep")
    is_grid = sweep.method == "grid"
    method = f"({METHODS[sweep.method]})" + ("." if is_grid else f", seed {sweep.seed}. {WHAT}")
    yield Paragraph(f"{counted(sweep.samples, 'variant')} {method}")
    if sweep.unsolved:
        why = "; ".join(sweep.faults)
        yield Paragraph(f"{counted(sweep.unsolved, 'variant')} not solved: {why}", "note")
    yield table(
        "name: < Parameter | law: < Distribution about the nominal value | together: Group",
        sweep.figures,
        "Varied parameters",
    )
    if is_grid:
        yield from sweep_grid.sections(sweep)
        return
    if sweep.nominal.size:
        columns = (sweep.nominal, sweep.mean, sweep.deviation, sweep.low, sweep.high)
        yield table(
            "Mode -> | Nominal [Hz]:7 -> Hz | Mean [Hz]:7 -> mean | Standard deviation [Hz]:4 | "
            "2.5 % quantile [Hz]:7 -> 2.5 % | 97.5 % quantile [Hz]:7 -> 97.5 % | Minimum [Hz]:7 | Maximum [Hz]:7",
            by_mode(*columns, sweep.least, sweep.greatest),
            "Natural frequencies of all variants",
            short="Natural frequencies of the variants",
        )
        yield _spread(findings, sweep)
    if sweep.any_fails is not None:
        yield _checks(sweep, sweep.any_fails)
        used, levels = Axis("maximum utilisation", "%"), [Level("limit", 100.0, axis="x")]
        panel = (used, 100.0 * sweep.any_fails.utilisation, levels, ())
        yield variants.spread("sweep_use", "Maximum utilisation of all variants", [panel])
        yield _shares(sweep)
        yield from _failing(sweep)
    if sweep.indices:
        yield table(
            "< Result -> | < Parameter -> | First index -> first | ± | Total index -> total | ±",
            [
                (
                    index.of,
                    index.figure,
                    _share(index.first),
                    _share(index.first_error),
                    _share(index.total),
                    _share(index.total_error),
                )
                for index in sweep.indices
            ],
            "Sensitivity: share of the variance due to a parameter (Sobol's first and total index), ± half of the "
            "95 % CI",
            short="Sensitivity (Sobol indices)",
        )


def _spread(findings: Findings, sweep: Sweep) -> Figure:
    """Return histograms of the frequencies with the guaranteed bounds of the tolerances."""
    tolerances = findings.get(Tolerances)
    panels = []
    for mode, values in enumerate(sweep.frequency[:MOST_MODES], start=1):
        bands = [
            Band(
                "95 % of the variants",
                float(sweep.low[mode - 1]),
                float(sweep.high[mode - 1]),
                "spread",
            )
        ]
        levels = [Level("nominal", float(sweep.nominal[mode - 1]), "rated", "x")]
        if tolerances is not None and mode <= tolerances.lower.size:
            ends = (float(tolerances.lower[mode - 1]), float(tolerances.upper[mode - 1]))
            levels += [
                Level("guaranteed bound of the tolerances", end, "limit", "x") for end in ends
            ]
        panels.append((Axis(f"frequency of mode {mode}", "Hz"), values, levels, bands))
    return variants.spread("sweep_frequencies", "Natural frequencies of all variants", panels)


def _share(value: float) -> str:
    """Return a share of a variance to thousandths: an index has no more digits than its interval."""
    return f"{value:.3f}".replace("-", "−") if abs(value) >= 0.0005 else "< 0.001"


def _checks(sweep: Sweep, any_fails: SweptCheck) -> Block:
    rows = [
        (
            sweep_grid.check_label(check),
            check.where,
            check.failing,
            check.probability,
            check.lower or 0.0,
            check.upper or 0.0,
            check.median,
            check.worst,
            check.decides,
            check.correlation,
        )
        for check in (any_fails, *sweep.checks[:MOST_CHECKS])
    ]
    count = len(sweep.checks)
    extent = f" (the first {MOST_CHECKS} of {count})" if count > MOST_CHECKS else ""
    return table(
        "< Check -> | < Component -> | Variants that fail -> | Probability [%]:3 -> fails, % | From [%]:3 -> from | "
        "To [%]:3 -> to | Median utilisation [%]:4 | Maximum utilisation [%]:4 -> maximum, % | < Correlates with | "
        "Rank correlation:2",
        rows,
        f"Failure probability of each check (95 % CI){extent}",
        short="Failure probability",
    )


def _shares(sweep: Sweep) -> Figure:
    """The share of the variants that stay below a share of the limit, of the checks nearest to failing."""
    shown = [check for check in sweep.checks if np.isfinite(check.utilisation).any()][:MOST_LINES]
    lines = []
    for pen, check in enumerate(shown):
        used = np.sort(np.where(np.isfinite(check.utilisation), check.utilisation, np.nan)) * 100.0
        below = np.arange(1, used.size + 1) / used.size * 100.0
        lines.append(Line(f"{check.clause}: {check.where}", used, below, pen))
    panel = Panel(
        Axis("utilisation", "%", low=0.0),
        Axis("variants below", "%", low=0.0, high=100.0),
        tuple(lines),
        (Level("limit", 100.0, axis="x", is_reached=True),),
        height=240.0,
    )
    return Figure(
        "sweep_shares",
        "Variants below a utilisation, for the checks with the highest utilisation",
        (panel,),
    )


def _failing(sweep: Sweep) -> Iterator[Block]:
    """The variants over the two figures that decide most, and over all."""
    names = [figure.name for figure in sweep.figures]
    if sweep.any_fails is None or len(names) < 2 or not 0 < sweep.any_fails.failing < sweep.samples:
        return
    ranked = sorted(
        (check for check in sweep.checks if check.correlation is not None),
        key=lambda one: -one.probability,
    )
    decisive = list(dict.fromkeys(check.decides for check in ranked if check.failing))
    pair = list(dict.fromkeys([*decisive, *names]))[:2]
    (x, across), (y, down) = (_over(sweep, names.index(name)) for name in pair)
    fails = sweep.any_fails.fails
    marks = (
        Marks("every check passes", x[~fails], y[~fails], "dot", "pale"),
        Marks("a check fails", x[fails], y[fails], "cross", "unstable"),
    )
    yield Figure(
        "sweep_variants",
        f"Variants by {pair[0]} and {pair[1]}",
        (Panel(across, down, marks=marks),),
    )
    if len(names) > 2:
        low, wide = sweep.factor.min(axis=0), np.ptp(sweep.factor, axis=0)
        share = (sweep.factor - low) / np.where(wide > 0.0, wide, 1.0)
        groups: list[tuple[str, Role, FloatArray]] = [
            ("every check passes", "pale", share[~fails][:MOST_THROUGH]),
            ("a check fails", "unstable", share[fails][:MOST_THROUGH]),
        ]
        caption = "Parameters of the variants that pass and of the variants that fail, each from minimum to maximum"
        yield variants.through("sweep_values", caption, axes=names, groups=groups)


def _over(sweep: Sweep, number: int) -> tuple[FloatArray, Axis]:
    """The values of a figure, and their axis: of a law relative to the file."""
    figure = sweep.figures[number]
    if figure.unit is None:
        return 100.0 * sweep.factor[:, number], Axis(f"{figure.name} / nominal", "%")
    return sweep.factor[:, number], Axis(figure.name, unit_words(figure.unit))
