"""Chapter: figures of the file fitted to measurements, what they leave open, and measured curves over computed ones."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Axis, Figure, Line, Marks, Panel
from torsion.output.numbers import RPM, Scale, counted, given, number, order, scale
from torsion.output.records import along
from torsion.what_if.fit.fit_results import Fit, FittedCurve

MOST_POINTS, MOST_PAIRS = 60, 20
WHAT = (
    "Each parameter has a prior: the value of the file and a standard deviation. The fit moves it as far as "
    "the measurements outweigh the prior. Deviations are of the logarithm; intervals hold if model and "
    "deviations are correct. All other chapters are for the file before the fit. To compute the fitted train,"
    " solve report-fitted.yaml."
)
IDENTIFIED = (
    "Combinations of parameters, the best identified first. Information is the prior deviation over the "
    "deviation from the measurements: above 1 the measurements dominate, at 0 they do not identify the "
    "combination."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield updated parameters, agreement, measurements and what the measurements leave open."""
    fit = findings.need(Fit)
    yield Heading("Fit to measurements")
    for words in fit.warnings:
        yield Paragraph(words, "fail" if fit.fails else "note")
    yield Paragraph(WHAT)
    yield table(
        "name: < Parameter -> | given: < Nominal -> | fitted: < Fitted -> | factor: Factor | "
        "lower: 95 % from -> from | upper: 95 % to -> to | prior: Deviation before [%]:3 | "
        "deviation: Deviation after [%]:3 -> ± % | shift: Shift, in deviations:2 | from_data: Identified [%]:3",
        fit.figures,
        "Updated parameters (identified: share of the information from the measurements)",
        short="Updated parameters",
    )
    yield Paragraph(_agreement(fit))
    if fit.others:
        yield table(
            "words: < Parameters | chi2: Chi2:3 | prior_chi2: Squared shifts:3",
            fit.others,
            "Other solutions that agree nearly as well",
        )
    if fit.modes:
        yield table(
            "mode: Mode -> | measured: Measured [Hz]:6 -> measured, Hz | within: Deviation [%]:3 -> ± % | "
            "lower: Band from [Hz]:6 | upper: Band to [Hz]:6 | before: Before the fit [Hz]:6 -> before | "
            "after: Fitted [Hz]:6 -> fitted | residual: Residual, in deviations:2 -> residual | "
            "remark: < Remark ->",
            fit.modes,
            "Measured natural frequencies",
            short="Measured natural frequencies",
        )
    for position, curve in enumerate(fit.curves, start=1):
        yield from _curve(findings, curve, position)

    yield Paragraph(IDENTIFIED)
    titles = "information: Information:3 | words: < Combination | is_unidentified: < Not identified"
    yield table(titles, fit.directions, "Identified combinations of parameters")
    names = [figure.name for figure in fit.figures]
    pairs = sorted(
        combinations(range(len(names)), 2), key=lambda pair: -abs(float(fit.correlation[pair]))
    )
    if pairs:
        yield table(
            "< Parameter | < Parameter | Correlation:3",
            [(names[a], names[b], fit.correlation[a, b]) for a, b in pairs[:MOST_PAIRS]],
            "Correlation of updated parameters",
        )
    hertz = ", ".join(number(frequency, 7) for frequency in fit.frequency.tolist())
    yield Paragraph(f"The natural frequencies of the fitted file are {hertz} Hz.")


def conclusion(fit: Fit) -> Paragraph:
    """How model and measurements agree, for the verdict."""
    outside = [
        f"mode {mode.mode} at {number(mode.measured, 5)} Hz"
        for mode in fit.modes
        if mode.is_outside
    ]
    words = f" Measured outside its band: {', '.join(outside)}." if outside else ""
    if fit.others:
        several = (
            f"{counted(len(fit.others), 'other solution')} agree{'s' * (len(fit.others) == 1)}"
        )
        words += f" {several} nearly as well (chapter Fit)."
    return Paragraph(
        f"Fit to measurements: {_agreement(fit)}{words}", "fail" if fit.fails else "note"
    )


def _agreement(fit: Fit) -> str:
    """Chi2 over its degrees of freedom, and what that says."""
    summary = f"{counted(fit.measurements, 'measured value')}, χ² {number(fit.chi2, 3)}"
    if fit.reduced is None:
        left = "the measurements determine the parameters exactly and do not check the model"
        return f"{summary}: {'the fit does not reach the measurements' if fit.is_wrong else left}."
    words = "model and stated deviations agree with the measurements"
    if fit.is_wrong:
        words = "the model is incomplete, or the stated deviations are too small"
    elif fit.reduced < 0.25:
        words = "the measurements scatter less than their stated deviations"
    freedom = f"{given(fit.freedom, 3)} degrees of freedom, χ² per degree of freedom {number(fit.reduced, 3)}"
    return f"{summary} with {freedom}: {words}."


def _curve(findings: Findings, curve: FittedCurve, position: int) -> Iterator[Block]:
    """Yield the figure of a measured curve, and its points, of many those with the largest residuals."""
    scales = {"angle": Scale("deg", 180.0 / np.pi), "speed": Scale("rpm", RPM)}
    size = scales.get(curve.quantity) or scale("N m", [float(curve.measured.max())])
    title = (
        "angular amplitude" if curve.quantity == "angle" else f"amplitude of the {curve.quantity}"
    )
    title += f" at {curve.at}, order {order(curve.order)} of {findings.study.reference}"
    x = curve.curve_speed * RPM
    panel = Panel(
        Axis("speed", "rpm"),
        Axis(f"amplitude of {curve.quantity}", size.unit, low=0.0),
        (
            Line("fitted", x, curve.curve_after * size.factor, 0, weight=1.5),
            Line("before the fit", x, curve.curve_before * size.factor, 1),
        ),
        marks=(Marks("measured", curve.speed * RPM, curve.measured * size.factor, "cross"),),
    )
    yield Figure(f"fit_{position}", f"Measured and computed {title}", (panel,))

    largest = np.argsort(-np.abs(curve.residual), kind="stable")[:MOST_POINTS]
    shown = np.sort(largest).tolist()
    amplitudes = np.transpose([curve.measured, curve.before, curve.after]) * size.factor
    remark = ""
    if len(shown) < curve.speed.size:
        remark = f" (the {MOST_POINTS} largest residuals of {curve.speed.size})"
    if curve.unused:
        remark += f"; {counted(curve.unused, 'window')} outside the speed range or in noise omitted"
    phase = "" if curve.phase_residual is None else " | phase_residual: Residual of the phase:2"
    yield table(
        f"speed: Speed [rpm] | Measured [={size.unit}] | Before the fit [={size.unit}] -> before | "
        f"Fitted [={size.unit}] -> fitted | deviation: Deviation [%]:3 -> ± % | "
        f"residual: Residual, in deviations:2 -> residual{phase}",
        [(place, *amplitudes[place.index].tolist()) for place in along(curve, "point", shown)],
        f"Measured {title}{remark}",
    )
