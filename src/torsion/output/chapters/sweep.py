"""Chapter: what varies, how frequencies spread, and with which probability a check fails."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.modes.tolerances import Tolerances
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.chapters import sweep_grid
from torsion.output.figures import variants
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Marks, Panel, Role
from torsion.output.numbers import counted, number, unit_words
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
    """Laws, frequencies, checks and figures."""
    found = findings.need(Sweep)
    yield Heading("Sweep")
    is_grid = found.method == "grid"
    said = f"({METHODS[found.method]})" + ("." if is_grid else f", seed {found.seed}. {WHAT}")
    yield Paragraph(f"{counted(found.samples, 'variant')} {said}")
    if found.unsolved:
        why = "; ".join(found.faults)
        yield Paragraph(f"{counted(found.unsolved, 'variant')} not solved: {why}", "note")
    rows = [(one.name, one.law, one.together) for one in found.figures]
    yield table(
        "< Parameter | < Distribution about the nominal value | Group", rows, "Varied parameters"
    )
    if is_grid:
        yield from sweep_grid.sections(found)
        return
    if found.nominal.size:
        yield _frequencies(found)
        yield _spread(findings, found)
    if found.any_fails is not None:
        yield _checks(found, found.any_fails)
        used, levels = Axis("maximum utilisation", "%"), [Level("limit", 100.0, axis="x")]
        spread = [(used, 100.0 * found.any_fails.utilisation, levels, ())]
        yield variants.spread("sweep_use", "Maximum utilisation of all variants", spread)
        yield _shares(found)
        yield from _failing(found)
    if found.indices:
        yield _indices(found)


def _spread(findings: Findings, found: Sweep) -> Figure:
    """How often each frequency lies where, with the band of the tolerances where that is proven."""
    proven = findings.get(Tolerances)
    panels = []
    for mode, values in enumerate(found.frequency[:MOST_MODES], start=1):
        bands = [
            Band(
                "95 % of the variants",
                float(found.low[mode - 1]),
                float(found.high[mode - 1]),
                "spread",
            )
        ]
        levels = [Level("nominal", float(found.nominal[mode - 1]), "rated", "x")]
        if proven is not None and mode <= proven.lower.size:
            ends = (float(proven.lower[mode - 1]), float(proven.upper[mode - 1]))
            levels += [
                Level("guaranteed bound of the tolerances", end, "limit", "x") for end in ends
            ]
        panels.append((Axis(f"frequency of mode {mode}", "Hz"), values, levels, bands))
    return variants.spread("sweep_frequencies", "Natural frequencies of all variants", panels)


def _indices(found: Sweep) -> Block:
    rows = [
        (
            one.of,
            one.figure,
            *(_share(value) for value in (one.first, one.first_error, one.total, one.total_error)),
        )
        for one in found.indices
    ]
    return table(
        "< Result -> | < Parameter -> | First index -> first | ± | Total index -> total | ±",
        rows,
        "Sensitivity: share of the variance due to a parameter (Sobol's first and total index), ± half of the 95 % CI",
        short="Sensitivity (Sobol indices)",
    )


def _share(value: float) -> str:
    """Of a variance, to thousandths: an index has no more digits than its interval."""
    return f"{value:.3f}".replace("-", "−") if abs(value) >= 0.0005 else "< 0.001"


def _frequencies(found: Sweep) -> Block:
    columns = (
        found.nominal,
        found.mean,
        found.deviation,
        found.low,
        found.high,
        found.least,
        found.greatest,
    )
    rows = [
        (mode, *(number(value, 4 if place == 2 else 7) for place, value in enumerate(row)))
        for mode, row in enumerate(np.transpose(columns).tolist(), start=1)
    ]
    return table(
        "Mode -> | Nominal [Hz] -> Hz | Mean [Hz] -> mean | Standard deviation [Hz] | 2.5 % quantile [Hz] -> 2.5 % | "
        "97.5 % quantile [Hz] -> 97.5 % | Minimum [Hz] | Maximum [Hz]",
        rows,
        "Natural frequencies of all variants",
        short="Natural frequencies of the variants",
    )


def _checks(found: Sweep, whole: SweptCheck) -> Block:
    rows = [
        (
            "any check" if one is whole else f"{one.rule} {one.clause}: {one.what}",
            one.where,
            one.failing,
            *(
                number(100.0 * (share or 0.0), 3)
                for share in (one.probability, one.lower, one.upper)
            ),
            None if one.median is None else number(100.0 * one.median, 4),
            None if one.worst is None else number(100.0 * one.worst, 4),
            one.decides,
            None if one.correlation is None else number(one.correlation, 2),
        )
        for one in (whole, *found.checks[:MOST_CHECKS])
    ]
    rest = (
        f" (the first {MOST_CHECKS} of {len(found.checks)})"
        if len(found.checks) > MOST_CHECKS
        else ""
    )
    return table(
        "< Check -> | < Component -> | Variants that fail -> | Probability [%] -> fails, % | From [%] -> from | "
        "To [%] -> to | Median utilisation [%] | Maximum utilisation [%] -> maximum, % | < Correlates with | "
        "Rank correlation",
        rows,
        f"Failure probability of each check (95 % CI){rest}",
        short="Failure probability",
    )


def _shares(found: Sweep) -> Figure:
    """The share of the variants that stay below a share of the limit, of the checks nearest to failing."""
    shown = [one for one in found.checks if np.isfinite(one.utilisation).any()][:MOST_LINES]
    lines = []
    for pen, one in enumerate(shown):
        used = np.sort(np.where(np.isfinite(one.utilisation), one.utilisation, np.nan)) * 100.0
        below = np.arange(1, used.size + 1) / used.size * 100.0
        lines.append(Line(f"{one.clause}: {one.where}", used, below, pen))
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


def _failing(found: Sweep) -> Iterator[Block]:
    """The variants over the two figures that decide most, and over all."""
    names = [one.name for one in found.figures]
    if found.any_fails is None or len(names) < 2 or not 0 < found.any_fails.failing < found.samples:
        return
    ranked = sorted(
        (one for one in found.checks if one.correlation is not None),
        key=lambda one: -one.probability,
    )
    decisive = list(dict.fromkeys(one.decides for one in ranked if one.failing))
    pair = list(dict.fromkeys([*decisive, *names]))[:2]
    (x, across), (y, down) = (_over(found, names.index(name)) for name in pair)
    fails = found.any_fails.fails
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
        low, wide = found.factor.min(axis=0), np.ptp(found.factor, axis=0)
        share = (found.factor - low) / np.where(wide > 0.0, wide, 1.0)
        groups: list[tuple[str, Role, FloatArray]] = [
            ("every check passes", "pale", share[~fails][:MOST_THROUGH]),
            ("a check fails", "unstable", share[fails][:MOST_THROUGH]),
        ]
        caption = "Parameters of the variants that pass and of the variants that fail, each from minimum to maximum"
        yield variants.through("sweep_values", caption, axes=names, groups=groups)


def _over(found: Sweep, place: int) -> tuple[FloatArray, Axis]:
    """The values of a figure, and their axis: of a law relative to the file."""
    one = found.figures[place]
    if one.unit is None:
        return 100.0 * found.factor[:, place], Axis(f"{one.name} / nominal", "%")
    return found.factor[:, place], Axis(one.name, unit_words(one.unit))
