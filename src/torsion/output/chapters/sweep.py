"""Chapter: what varies, how frequencies spread, and with which probability a check fails."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.sweep.sweep_results import Sweep, SweptCheck
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Axis, Figure, Level, Line, Marks, Panel
from torsion.output.numbers import counted, number

MOST_LINES, MOST_CHECKS = 6, 60
METHODS = {
    "sobol": "eight scrambled Sobol sequences; intervals by Student's t over the eight",
    "latin": "a latin hypercube; intervals as of independent samples (Wilson), which is on the wide side",
    "random": "independent random samples; intervals by Wilson",
}
WHAT = (
    "Probabilities are those of the laws stated here. A tolerance of a maker is an interval and no law: where one is "
    "varied uniformly, that is an assumption. A variant without an answer counts as failing."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Laws, frequencies, checks and figures."""
    found = findings.need(Sweep)
    yield Heading("Sweep")
    yield Paragraph(f"{counted(found.samples, 'variant')} ({METHODS[found.method]}), seed {found.seed}. {WHAT}")
    if found.unsolved:
        why = "; ".join(found.faults)
        yield Paragraph(f"{counted(found.unsolved, 'variant')} without an answer: {why}", "note")
    rows = [(one.name, one.law, one.together) for one in found.figures]
    yield table("< Figure | < Law about the figure of the file | Varies as one with its number", rows, "What varies")
    if found.nominal.size:
        yield _frequencies(found)
    if found.any_fails is not None:
        yield _checks(found, found.any_fails)
        yield _shares(found)
        yield from _failing(found)


def _frequencies(found: Sweep) -> Block:
    columns = (found.nominal, found.mean, found.deviation, found.low, found.high, found.least, found.greatest)
    rows = [
        (mode, *(number(value, 4 if place == 2 else 7) for place, value in enumerate(row)))
        for mode, row in enumerate(np.transpose(columns).tolist(), start=1)
    ]
    return table(
        "Mode -> | As in the file [Hz] -> Hz | Mean [Hz] -> mean | Standard deviation [Hz] | 2.5 % lie below [Hz] -> "
        "2.5 % below | 2.5 % lie above [Hz] -> 2.5 % above | Least [Hz] | Greatest [Hz]",
        rows,
        "Natural frequencies of all variants",
        short="Natural frequencies of the variants",
    )


def _checks(found: Sweep, whole: SweptCheck) -> Block:
    rows = [
        (
            "any check" if one is whole else f"{one.rule} {one.clause}: {one.what}", one.where, one.failing,
            number(100.0 * one.probability, 3), number(100.0 * one.lower, 3), number(100.0 * one.upper, 3),
            None if one.median is None else number(100.0 * one.median, 4),
            None if one.worst is None else number(100.0 * one.worst, 4), one.decides,
            None if one.correlation is None else number(one.correlation, 2),
        )
        for one in (whole, *found.checks[:MOST_CHECKS])
    ]  # fmt: skip
    rest = f" (the first {MOST_CHECKS} of {len(found.checks)})" if len(found.checks) > MOST_CHECKS else ""
    return table(
        "< Check -> | < Component -> | Variants that fail -> | Probability [%] -> fails, % | From [%] -> from | "
        "To [%] -> to | Median of limit [%] | Worst of limit [%] -> worst, % | < Goes most with | Rank correlation",
        rows,
        f"Probability that a check fails, with its 95 % interval{rest}",
        short="Probability that a check fails",
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
        Axis("share of the limit", "%", low=0.0), Axis("variants below", "%", low=0.0, high=100.0), tuple(lines),
        (Level("limit", 100.0, axis="x", is_reached=True),), height=240.0,
    )  # fmt: skip
    return Figure("sweep_shares", "Variants that stay below a share of the limit, of the checks most used", (panel,))


def _failing(found: Sweep) -> Iterator[Block]:
    """The variants over the two figures that decide most."""
    names = [one.name for one in found.figures]
    ranked = sorted((one for one in found.checks if one.correlation is not None), key=lambda one: -one.probability)
    decisive = list(dict.fromkeys(one.decides for one in ranked if one.failing))
    pair = list(dict.fromkeys([*decisive, *names]))[:2]
    if found.any_fails is None or len(pair) < 2 or not 0 < found.any_fails.failing < found.samples:
        return
    x, y = (100.0 * found.factor[:, names.index(name)] for name in pair)
    fails = found.any_fails.fails
    marks = (
        Marks("every check passes", x[~fails], y[~fails], "dot", "pale"),
        Marks("a check fails", x[fails], y[fails], "cross", "unstable"),
    )
    panel = Panel(Axis(f"{pair[0]}, of the file's", "%"), Axis(f"{pair[1]}, of the file's", "%"), marks=marks)
    yield Figure("sweep_variants", f"Variants by {pair[0]} and {pair[1]}", (panel,))
