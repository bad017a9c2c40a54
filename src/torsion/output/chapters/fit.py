"""Chapter: figures of the file fitted to measurements, what they leave open, and measured curves over computed ones."""

from collections.abc import Iterator
from itertools import combinations

import numpy as np

from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.figure import Axis, Figure, Line, Marks, Panel
from torsion.output.numbers import RPM, Scale, counted, given, number, order, rpm, scale
from torsion.output.reported_values import reference
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
    """Figures, agreement, measurements and what cannot be known."""
    found = findings.need(Fit)
    yield Heading("Fit to measurements")
    for words in found.warnings:
        yield Paragraph(words, "fail" if found.fails else "note")
    yield Paragraph(WHAT)
    yield _figures(found)
    yield Paragraph(_agreement(found))
    if found.others:
        rows = [(one.words, number(one.chi2, 3), number(one.prior_chi2, 3)) for one in found.others]
        yield table(
            "< Parameters | Chi2 | Squared shifts",
            rows,
            "Other solutions that agree nearly as well",
        )
    if found.modes:
        yield _modes(found)
    for place, curve in enumerate(found.curves, start=1):
        yield _drawn(findings, curve, place)
        yield _points(findings, curve)
    yield from _identified(found)
    hertz = ", ".join(number(one, 7) for one in found.frequency.tolist())
    yield Paragraph(f"The natural frequencies of the fitted file are {hertz} Hz.")


def conclusion(found: Fit) -> Paragraph:
    """How model and measurements agree, for the verdict."""
    outside = [
        f"mode {one.mode} at {number(one.measured, 5)} Hz" for one in found.modes if one.is_outside
    ]
    words = f" Measured outside its band: {', '.join(outside)}." if outside else ""
    if found.others:
        several = (
            f"{counted(len(found.others), 'other solution')} agree{'s' * (len(found.others) == 1)}"
        )
        words += f" {several} nearly as well (chapter Fit)."
    return Paragraph(
        f"Fit to measurements: {_agreement(found)}{words}", "fail" if found.fails else "note"
    )


def _agreement(found: Fit) -> str:
    """Chi2 over its degrees of freedom, and what that says."""
    known = f"{counted(found.measurements, 'measured value')}, χ² {number(found.chi2, 3)}"
    if found.reduced is None:
        left = "the measurements determine the parameters exactly and do not check the model"
        return f"{known}: {'the fit does not reach the measurements' if found.is_wrong else left}."
    words = "model and stated deviations agree with the measurements"
    if found.is_wrong:
        words = "the model is incomplete, or the stated deviations are too small"
    elif found.reduced < 0.25:
        words = "the measurements scatter less than their stated deviations"
    freedom = f"{given(found.freedom, 3)} degrees of freedom, χ² per degree of freedom {number(found.reduced, 3)}"
    return f"{known} with {freedom}: {words}."


def _figures(found: Fit) -> Block:
    rows = [
        (
            one.name,
            one.given,
            one.fitted,
            number(one.factor),
            number(one.lower),
            number(one.upper),
            number(100.0 * one.prior, 3),
            number(100.0 * one.deviation, 3),
            number(one.shift, 2),
            number(100.0 * one.from_data, 3),
        )
        for one in found.figures
    ]
    return table(
        "< Parameter -> | < Nominal -> | < Fitted -> | Factor | 95 % from -> from | 95 % to -> to | "
        "Deviation before [%] | Deviation after [%] -> ± % | Shift, in deviations | Identified [%]",
        rows,
        "Updated parameters (identified: share of the information from the measurements)",
        short="Updated parameters",
    )


def _modes(found: Fit) -> Block:
    rows = [
        (
            one.mode,
            number(one.measured, 6),
            number(100.0 * one.within, 3),
            number(one.lower, 6),
            number(one.upper, 6),
            number(one.before, 6),
            number(one.after, 6),
            number(one.residual, 2),
            "OUTSIDE its band" if one.is_outside else "" if one.is_given else "paired by its band",
        )
        for one in found.modes
    ]
    return table(
        "Mode -> | Measured [Hz] -> measured, Hz | Deviation [%] -> ± % | Band from [Hz] | Band to [Hz] | "
        "Before the fit [Hz] -> before | Fitted [Hz] -> fitted | Residual, in deviations -> residual | < Remark ->",
        rows,
        "Measured natural frequencies",
        short="Measured natural frequencies",
    )


def _scale(curve: FittedCurve) -> Scale:
    """In which unit its amplitudes are read."""
    known = {"angle": Scale("deg", 180.0 / np.pi), "speed": Scale("rpm", RPM)}
    return known.get(curve.quantity) or scale("N m", [float(curve.measured.max())])


def _title(findings: Findings, curve: FittedCurve) -> str:
    what = {
        "angle": "angular amplitude",
        "speed": "amplitude of the speed",
        "torque": "amplitude of the torque",
    }
    return (
        f"{what[curve.quantity]} at {curve.at}, order {order(curve.order)} of {reference(findings)}"
    )


def _drawn(findings: Findings, curve: FittedCurve, place: int) -> Figure:
    size = _scale(curve)
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
    return Figure(f"fit_{place}", f"Measured and computed {_title(findings, curve)}", (panel,))


def _points(findings: Findings, curve: FittedCurve) -> Block:
    size, shown, varies = (
        _scale(curve),
        np.arange(curve.speed.size),
        bool((curve.deviation > curve.within).any()),
    )
    if shown.size > MOST_POINTS:
        shown = np.sort(np.argsort(-np.abs(curve.residual), kind="stable")[:MOST_POINTS])
    rows = [
        (
            rpm(float(curve.speed[k])),
            *(
                number(float(one[k] * size.factor))
                for one in (curve.measured, curve.before, curve.after)
            ),
            *([number(100.0 * float(curve.deviation[k]), 3)] if varies else []),
            number(float(curve.residual[k]), 2),
            *([] if curve.phase_residual is None else [number(float(curve.phase_residual[k]), 2)]),
        )
        for k in shown.tolist()
    ]
    rest = (
        ""
        if shown.size == curve.speed.size
        else f" (the {MOST_POINTS} largest residuals of {curve.speed.size})"
    )
    if curve.unused:
        rest += f"; {counted(curve.unused, 'window')} outside the speed range or in noise omitted"
    phase = "" if curve.phase_residual is None else " | Residual of the phase -> of phase"
    unit, each = size.unit, f"Residual, in deviations of {number(100.0 * curve.within, 3)} %"
    if varies:
        each = "Deviation [%] -> ± % | Residual, in deviations"
    return table(
        f"Speed [rpm] | Measured [{unit}] | Before the fit [{unit}] -> before | Fitted [{unit}] -> fitted | "
        f"{each} -> residual{phase}",
        rows,
        f"Measured {_title(findings, curve)}{rest}",
    )


def _identified(found: Fit) -> Iterator[Block]:
    """What the measurements say of combinations of figures, and how the figures go together."""
    yield Paragraph(IDENTIFIED)
    rows = [
        (number(0.0 if one.is_unidentified else one.information, 3), one.words.replace(" -", " −"))
        for one in found.directions
    ]
    yield table("Information | < Combination", rows, "Identified combinations of parameters")
    names = [one.name for one in found.figures]
    pairs = sorted(
        combinations(range(len(names)), 2), key=lambda pair: -abs(float(found.correlation[pair]))
    )
    if pairs:
        each = [
            (names[a], names[b], number(float(found.correlation[a, b]), 3))
            for a, b in pairs[:MOST_PAIRS]
        ]
        yield table(
            "< Parameter | < Parameter | Correlation", each, "Correlation of updated parameters"
        )
