"""Chapters: the response over speed (torque of every order and of all together, peaks, angles) and over frequency."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import FrequencyResponse, Response, Synthesis
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.analyses.response.over_speed import requested_orders
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.curves import (
    SPEED,
    TOTAL,
    amplitudes,
    barred_bands,
    rated_level,
    span,
    unanswered,
)
from torsion.output.figures.curves import orders as lines_of_orders
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.numbers import LESS, RPM, cell, counted, number
from torsion.output.reported_values import (
    UNDAMPED,
    barred_rpm,
    harmonic_name,
    joint_model,
    of_torsion,
    orders_together,
    rated_rpm,
    synthesis,
    unstable_rpm,
    worth_a_figure,
)
from torsion.output.stored.scene import (
    Element,
    elements,
    highest,
    strongest,
    torques,
)
from torsion.results import listed
from torsion.rules import needed

TITLE = "Response over the speed range"
MOST_CURVES = 10  # in a figure over frequency
MOST_FIGURES = 3  # of couplings and cranks; shafts and gears have theirs in their own chapters
MOST_LIVE = 12  # figures of the live page
MOST_PEAKS = 10
NEAR = 4.0  # times the largest value: a limit up to there is on the axis
NO_PERIOD = " The orders have no common period. The total is the sum of their magnitudes, which is an upper bound."
SINGULAR = (
    "the equations are singular or nearly singular (undamped resonance). The response has no reliable value there "
    "and no maximum over the range. The figures hatch these speeds; the table of peaks omits them."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield nothing without a response over speed."""
    response = findings.get(Response)
    if response is None or not response.lines:
        return
    loaded = _loaded_elements(findings, response)
    yield Heading(TITLE)
    yield _introduction(findings, response)
    yield _status(findings, response)
    if (loads := findings.get(ComponentLoads)) is not None and loads.elements:
        together = orders_together(findings)
        yield table(
            "component: < Component -> | torque: Total vibratory torque [~N m]:u -> ~ | speed: Speed [rpm] -> rpm | "
            "order: < Largest order | order_torque: Torque of this order [~N m] | rms: RMS [~N m] | "
            "bound: Sum of magnitudes [~N m] | mean: Mean [~N m]",
            loads.elements,
            f"Maximum vibratory torque of every component over the speed range, {together}",
            short=f"Maximum vibratory torque, {together}",
        )
        if loads.peaks:  # those that are largest if referred to one speed
            largest = sorted(loads.peaks, key=lambda peak: -peak.referred)[:MOST_PEAKS]
            caption = "Resonance peaks of single orders in the speed range"
            if len(loads.peaks) > MOST_PEAKS:
                caption += f" (the {MOST_PEAKS} largest of {len(loads.peaks)})"
            yield table(
                "component: < Component | order: < Order | torque: Torque amplitude [~N m] | speed: Speed [rpm] | "
                "frequency: Frequency [Hz] | mode: Mode",
                [peak for peak in loads.peaks if peak in largest],
                caption,
            )
        else:
            yield Paragraph("No order has a resonance peak in the speed range.")
    yield from _figures(
        findings, [element for element in loaded if element.kind not in ("shaft", "gear")]
    )


def angles(findings: Findings) -> Iterator[Block]:
    """Yield the appendix of the full report: the largest angular amplitude of every station."""
    if (loads := findings.get(ComponentLoads)) is not None:
        yield Heading("Appendix: angular amplitudes")
        yield table(
            "station: < Station | angle: Maximum amplitude [deg]:gu | angle: Amplitude [rad] | order: < Order | "
            "speed: Speed [rpm] | rate: Speed amplitude [rpm]",
            loads.stations,
            f"Maximum angular amplitude of single orders, each at the component's speed; 0: {LESS}",
        )


def without_tables(findings: Findings) -> Iterator[Block]:
    """Yield the figures and the notes of the chapter, as the live page shows them."""
    response = findings.get(Response)
    if response is not None and response.lines:
        yield Heading(TITLE)
        yield _status(findings, response)
        yield from _figures(findings, _loaded_elements(findings, response), MOST_LIVE)


def _loaded_elements(findings: Findings, response: Response) -> list[Element]:
    return [
        element
        for element in elements(findings.system)
        if np.any(np.abs(response.torque[:, :, list(element.spans)]) > 0)
    ]


def _figures(
    findings: Findings, loaded: list[Element], count: int = MOST_FIGURES
) -> Iterator[Block]:
    """Yield the curves of the elements that are worth a figure, and the names of the others."""
    response = findings.need(Response)
    sizes = {element: highest(response.amplitude(element.spans)) for element in loaded}
    drawn = worth_a_figure(findings, sizes, count)
    yield from (curves(findings, element) for element in drawn)
    if len(drawn) < len(loaded):
        omitted = listed([element.name for element in loaded if element not in drawn])
        yield Paragraph(f"No figure, because the torque is smaller: {omitted}.")


def _introduction(findings: Findings, response: Response) -> Paragraph:
    requested, added = int(response.requested.sum()), int((~response.requested).sum())
    limits = " and rule limits" if "response" in needed(findings.study) else ""
    text = (
        f"{counted(len(response.lines), 'harmonic component')} at {counted(requested, 'requested speed')}. The program "
        f"added {counted(added, 'speed')} near resonances{limits}, so that the grid resolves every peak. Amplitudes "
        "are zero to peak; the amplitude of a total is half of its peak-to-peak value. A torque is the full "
        "torque in the section (elastic plus damping) at the speed of the component."
    )
    if (total := findings.get(Synthesis)) is not None:
        components = "the requested orders" if response.left_out else "all orders"
        period = (
            f" The total vibratory torque is the phase-correct sum of {components} over the common period of "
            f"{cell(total.turns)} revolution{'' if total.turns <= 1 else 's'} of {findings.study.reference}."
        )
        text += period if total.turns else NO_PERIOD
    if response.left_out:
        names = listed([line.named(findings.study.reference) for line in response.left_out], "; ")
        text += f" Not requested by orders and therefore omitted: {names}.".replace("`", "")
    elif requested_orders(findings.study) is not None:
        text += " The rules judge the total of all orders, so all orders are reported."
    return Paragraph(text + (f" Note on the speeds: {response.remark}." if response.remark else ""))


def _status(findings: Findings, response: Response) -> Paragraph:
    reliable = response.residual[(response.status == Status.OK) & np.isfinite(response.residual)]
    residual = number(float(reliable.max(initial=0.0)), 2)
    text = f"Largest relative residual of equilibrium: {residual}. {joint_model(findings)}".strip()
    if count := int(response.unreliable.sum()):
        return Paragraph(f"{text} At {counted(count, 'speed')} {SINGULAR}", "note")
    return Paragraph(text)


def curves(findings: Findings, element: Element) -> Figure:
    """Return the torque of an element over the speed: its strongest components, all together, and its limit."""
    response = findings.need(Response)
    orders, total = response.amplitude(element.spans), synthesis(findings, element.spans)
    ratings, unit = findings.study.train.parts[element.part].ratings, torques([orders])
    limit = None if ratings is None else ratings.vibratory_torque
    kind = "" if element.kind in element.name else f", {element.kind}"
    speed = response.speed * RPM
    hidden, bands = unanswered(speed, response.unreliable)
    named = [
        (harmonic_name(response, k, "order "), values * unit.factor)
        for k, values in enumerate(orders.T)
    ]
    drawn = lines_of_orders(speed, named, hidden)
    values = [line.y for line in drawn]
    if len(response.lines) > 1 and len(total):
        values = [np.where(hidden, np.nan, total * unit.factor)]
        drawn = (Line(TOTAL, speed, values[0], "synthesis"), *drawn)
    limits = [] if limit is None else [limit * unit.factor]
    near = [limit for limit in limits if limit <= NEAR * max(map(highest, values), default=0.0)]
    words = "permissible vibratory torque (manufacturer)"
    levels = tuple(Level(words, limit, is_reached=limit in near) for limit in limits)
    panel = Panel(
        span(SPEED, speed),
        amplitudes("torque amplitude", unit.unit, values, near),
        drawn,
        levels + rated_level(rated_rpm(findings)),
        barred_bands(barred_rpm(findings), unstable_rpm(findings)) + bands,
    )
    name = f"torque-{element.part}-{element.spans[0]}"
    caption = f"Vibratory torque in {element.name}{kind}"
    return of_torsion(findings, Figure(name, caption, (panel,)))


def over_frequency(findings: Findings) -> Iterator[Block]:
    """Yield nothing where no frequencies were requested."""
    sweep = findings.get(FrequencyResponse)
    if sweep is None:
        return
    bad = sweep.status != Status.OK
    yield Heading("Response over the frequency range")
    yield Paragraph(
        "The excitation acts at every frequency, independent of the speed. Amplitudes are zero to peak."
    )
    if bad.any():
        resonances = listed(dict.fromkeys(number(f, 5) for f in sweep.frequency[bad].tolist()))
        yield Paragraph(f"At {resonances} Hz {UNDAMPED}", "note")
    torque = {
        element.name: np.where(bad, np.nan, element.largest(np.abs(sweep.torque)))
        for element in elements(findings.system)
    }
    if torque:
        unit = torques(torque.values())
        curves = {name: values * unit.factor for name, values in torque.items()}
        titles = "component: < Component | torque: Amplitude [~N m]:u | frequency: Frequency [Hz]"
        yield table(titles, sweep.peaks, "Maximum torque amplitude")
        yield _curves_over_frequency(
            findings, "sweep-torque", "torque amplitude", curves, unit.unit
        )
    angle = {
        station.name: np.degrees(np.where(bad, np.nan, np.abs(sweep.angle[:, k])))
        for k, station in enumerate(findings.study.train.stations)
        if not station.is_ground
    }
    yield _curves_over_frequency(findings, "sweep-angle", "angular amplitude", angle, "deg")


def _curves_over_frequency(
    findings: Findings, name: str, quantity: str, curves: dict[str, FloatArray], unit: str
) -> Figure:
    """Draw the strongest curves over the frequency."""
    sweep, modes = findings.need(FrequencyResponse), findings.get(Modes)
    hertz, named = sweep.frequency, list(curves.items())
    hidden, bands = unanswered(hertz, sweep.status != Status.OK)
    shown = [named[k] for k in strongest(np.transpose(list(curves.values())), MOST_CURVES)]
    lines = tuple(
        Line(words, hertz, np.where(hidden | (values <= 0), np.nan, values), pen)
        for pen, (words, values) in enumerate(shown)
    )
    levels = tuple(
        Level("natural frequencies", frequency, "natural", "x")
        for frequency in (() if modes is None else modes.frequency.tolist())
        if hertz[0] <= frequency <= hertz[-1]
    )
    x = span(Axis("frequency", "Hz"), hertz)
    y = amplitudes(quantity, unit, [line.y for line in lines])
    panel = Panel(x, y, lines, levels, bands, height=150.0)
    return Figure(name, f"{quantity.capitalize()} over the frequency", (panel,))
