"""Chapters: the response over speed (torque of every order and of all together, peaks, angles) and over frequency."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import FrequencyResponse, Response, Synthesis
from torsion.analyses.response.over_speed import requested_orders
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves_over_speed
from torsion.output.figures.figure import Figure
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import LESS, Scale, counted, exact, number, settled
from torsion.output.reported_values import (
    UNDAMPED,
    amplitude,
    harmonic_name,
    joint_model,
    mode_near,
    orders_together,
    reference,
    rounding,
    speed_axis,
    synthesis,
    unreliable,
    unstable_rpm,
    without,
    worth_a_figure,
)
from torsion.output.selection import (
    NO_VALUE,
    Element,
    elements,
    highest,
    largest,
    strongest,
    torques,
)
from torsion.results import listed
from torsion.rules import needed

TITLE = "Response over the speed range"
MOST_CURVES = 10  # in a figure over frequency
MOST_FIGURES = 3  # of couplings and cranks; shafts and gears have theirs in their own chapters
MOST_LIVE = 12  # figures of the live page
SMALLEST = 0.02  # of the element's largest torque of one line; a lower peak is not listed
MOST_PEAKS = 10
DEGREES = Scale("deg", 180.0 / np.pi)
NO_PERIOD = " The orders have no common period. The total is the sum of their magnitudes, which is an upper bound."
SINGULAR = (
    "the equations are singular or nearly singular (undamped resonance). The response has no reliable value there "
    "and no maximum over the range. The figures hatch these speeds; the table of peaks omits them."
)


@dataclass(frozen=True)
class Peak:
    """A local maximum of one line in one element."""

    element: Element
    line: int
    at: int  # position of the speed
    torque: float  # N m


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield nothing without a response over speed."""
    response = findings.get(Response)
    if response is None or not response.lines:
        return
    loaded = _loaded_elements(findings, response)
    yield Heading(TITLE)
    yield _introduction(findings, response)
    yield _status(findings, response)
    if loaded:
        unit = torques(amplitude(findings, element.spans) for element in loaded)
        yield _largest_torques(findings, response, loaded, unit)
        yield _peaks(findings, response, loaded, unit)
    yield from _figures(
        findings, [element for element in loaded if element.kind not in ("shaft", "gear")]
    )


def angles(findings: Findings) -> Iterator[Block]:
    """Yield the appendix of the full report: the largest angular amplitude of every station."""
    response = findings.get(Response)
    if response is not None and response.lines:
        yield Heading("Appendix: angular amplitudes")
        yield _largest_angles(findings, response)


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
    sizes = {element: highest(amplitude(findings, element.spans)) for element in loaded}
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
            f"{exact(total.turns)} revolution{'' if total.turns <= 1 else 's'} of {reference(findings)}."
        )
        text += period if total.turns else NO_PERIOD
    if response.left_out:
        names = listed([line.named(reference(findings)) for line in response.left_out], "; ")
        text += f" Not requested by orders and therefore omitted: {names}.".replace("`", "")
    elif requested_orders(findings.study) is not None:
        text += " The rules judge the total of all orders, so all orders are reported."
    return Paragraph(text + (f" Note on the speeds: {response.remark}." if response.remark else ""))


def _status(findings: Findings, response: Response) -> Paragraph:
    reliable = response.residual[(response.status == Status.OK) & np.isfinite(response.residual)]
    residual = number(float(reliable.max(initial=0.0)), 2)
    text = f"Largest relative residual of equilibrium: {residual}. {joint_model(findings)}".strip()
    if count := int(unreliable(findings).sum()):
        return Paragraph(f"{text} At {counted(count, 'speed')} {SINGULAR}", "note")
    return Paragraph(text)


def _largest_torques(
    findings: Findings, response: Response, loaded: list[Element], unit: Scale
) -> Table:
    total, mean_unit = findings.get(Synthesis), torques([np.abs(response.mean)])
    rows, zero = list[tuple[object, ...]](), rounding(findings)
    for element in loaded:
        spans = list(element.spans)
        torque, orders = (
            without(values(findings, spans), zero[spans]) for values in (synthesis, amplitude)
        )
        speed = largest(torque)
        if speed is None or total is None:
            rows.append((element.name, NO_VALUE, *[None] * 6))
            continue
        line = int(np.nanargmax(orders[speed]))
        span = spans[int(np.argmax(total.half_range[speed, spans]))]
        mean = response.mean[speed, span] * mean_unit.factor
        if torque[speed] == 0.0:
            rows.append((element.name, 0.0, None, None, 0.0, 0.0, 0.0, mean))
            continue
        sums = orders[speed, line], total.rms[speed, span], total.bound[speed, span]
        rows.append(
            (
                element.name,
                torque[speed] * unit.factor,
                response.speed[speed],
                response.lines[line].named(reference(findings)),
                *(value * unit.factor for value in sums),
                mean,
            )
        )
    together = orders_together(findings)
    return table(
        f"< Component -> | Total vibratory torque [{unit.unit}] -> {unit.unit} | Speed [rpm] -> rpm | "
        f"< Largest order | Torque of this order [{unit.unit}] | RMS [{unit.unit}] | Sum of magnitudes [{unit.unit}] | "
        f"Mean [{mean_unit.unit}]",
        rows,
        f"Maximum vibratory torque of every component over the speed range, {together}",
        short=f"Maximum vibratory torque, {together}",
    )


def _peaks(findings: Findings, response: Response, loaded: list[Element], unit: Scale) -> Block:
    """Return the table of peaks; of too many the largest ones referred to one speed."""
    peaks = found_peaks(findings, loaded)
    if not peaks:
        return Paragraph("No order has a resonance peak in the speed range.")
    by_size = sorted(range(len(peaks)), key=lambda k: -peaks[k].torque * peaks[k].element.ratio)
    rows = []
    for peak in (peaks[k] for k in sorted(by_size[:MOST_PEAKS])):
        frequency = float(response.frequency[peak.at, peak.line])
        rows.append(
            (
                peak.element.name,
                response.lines[peak.line].named(reference(findings)),
                peak.torque * unit.factor,
                response.speed[peak.at],
                frequency,
                mode_near(findings, frequency),
            )
        )
    omitted = f" (the {len(rows)} largest of {len(peaks)})" if len(rows) < len(peaks) else ""
    return table(
        f"< Component | < Order | Torque amplitude [{unit.unit}] | Speed [rpm] | Frequency [Hz] | Mode",
        rows,
        f"Resonance peaks of single orders in the speed range{omitted}",
    )


def found_peaks(findings: Findings, elements: list[Element]) -> list[Peak]:
    """Return all peaks worth listing, by element, the largest first."""
    peaks: list[Peak] = []
    for element in elements:
        orders = amplitude(findings, element.spans)
        smallest = SMALLEST * highest(orders)
        of_element = [
            Peak(element, line, speed, float(values[speed]))
            for line, values in enumerate(orders.T)
            for speed in local_maxima(values)
            if values[speed] >= smallest
        ]
        peaks += sorted(of_element, key=lambda peak: -peak.torque)
    return peaks


def local_maxima(values: FloatArray) -> list[int]:
    """Return inner places where the values exceed both sides; a place without a value is no neighbour."""
    filled = np.where(np.isfinite(values), values, np.inf)
    inner = (filled[1:-1] > filled[:-2]) & (filled[1:-1] >= filled[2:]) & np.isfinite(values[1:-1])
    return (np.flatnonzero(inner) + 1).tolist()


def _largest_angles(findings: Findings, response: Response) -> Table:
    rows, ratio = list[tuple[object, ...]](), findings.system.speed_ratio
    sizes = np.where((response.status == Status.OK)[:, :, None], np.abs(response.angle), np.nan)
    top = highest(sizes / ratio[: sizes.shape[2]])
    for station, name in _moving_stations(findings):
        position = largest(sizes[:, :, station].ravel())
        if position is None:
            rows.append((name, NO_VALUE, *[None] * 4))
            continue
        speed, line = divmod(position, sizes.shape[1])
        angle = settled(float(sizes[speed, line, station]), top * float(ratio[station]))
        order = response.lines[line].named(reference(findings))
        speed_amplitude = 2.0 * np.pi * angle * response.frequency[speed, line]
        rows.append((name, angle, angle, order, response.speed[speed], speed_amplitude))
    return table(
        "< Station | Maximum amplitude [deg]:g | Amplitude [rad] | < Order | Speed [rpm] | Speed amplitude [rpm]",
        rows,
        f"Maximum angular amplitude of single orders, each at the component's speed; 0: {LESS}",
    )


def _moving_stations(findings: Findings) -> list[tuple[int, str]]:
    """Return positions and names of the stations that are not the ground."""
    return [
        (k, station.name)
        for k, station in enumerate(findings.study.train.stations)
        if not station.is_ground
    ]


def curves(findings: Findings, element: Element) -> Figure:
    """Return the torque of an element over the speed: its strongest components, all together, and its limit."""
    response = findings.need(Response)
    orders, total = amplitude(findings, element.spans), synthesis(findings, element.spans)
    ratings, unit = findings.study.train.parts[element.part].ratings, torques([orders])
    limit = None if ratings is None else ratings.vibratory_torque
    limits = [("permissible vibratory torque (manufacturer)", (limit or 0.0) * unit.factor)]
    return of_torsion(
        findings,
        curves_over_speed.torque(
            f"torque-{element.part}-{element.spans[0]}",
            f"Vibratory torque in {element.name}, {element.kind}",
            **speed_axis(findings),
            lines=[
                (harmonic_name(response, k, "order "), values * unit.factor)
                for k, values in enumerate(orders.T)
            ],
            unit=unit.unit,
            synthesis=total * unit.factor if len(response.lines) > 1 and len(total) else None,
            limits=[] if limit is None else limits,
            unstable=unstable_rpm(findings),
        ),
    )


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
        titles = f"< Component | Amplitude [{unit.unit}] | Frequency [Hz]"
        curves = {name: values * unit.factor for name, values in torque.items()}
        yield _maxima(titles, sweep, curves, "torque amplitude")
        yield _curves_over_frequency(
            findings, "sweep-torque", "torque amplitude", curves, unit.unit
        )
    angle = {
        name: np.where(bad, np.nan, np.abs(sweep.angle[:, station]))
        for station, name in _moving_stations(findings)
    }
    titles = "< Station | Amplitude [rad] | Amplitude [deg]:g | Frequency [Hz]"
    yield _maxima(titles, sweep, angle, "angular amplitude")
    curves = {name: values * DEGREES.factor for name, values in angle.items()}
    yield _curves_over_frequency(findings, "sweep-angle", "angular amplitude", curves, DEGREES.unit)


def _maxima(
    titles: str, sweep: FrequencyResponse, curves: dict[str, FloatArray], quantity: str
) -> Table:
    """Return the largest value of every curve, under as many titles as there are, and its frequency."""
    rows, copies = list[tuple[object, ...]](), titles.count("|") - 1
    for name, values in curves.items():
        position = largest(values)
        if position is None:
            rows.append((name, NO_VALUE, *[None] * copies))
        else:
            rows.append((name, *[values[position]] * copies, sweep.frequency[position]))
    return table(titles, rows, f"Maximum {quantity}")


def _curves_over_frequency(
    findings: Findings, name: str, quantity: str, curves: dict[str, FloatArray], unit: str
) -> Figure:
    sweep, modes = findings.need(FrequencyResponse), findings.get(Modes)
    lines = list(curves.items())
    return curves_over_speed.frequency(
        name,
        f"{quantity.capitalize()} over the frequency",
        frequency=sweep.frequency,
        bad=sweep.status != Status.OK,
        lines=[lines[k] for k in strongest(np.transpose(list(curves.values())), MOST_CURVES)],
        quantity=quantity,
        unit=unit,
        natural=[] if modes is None else modes.frequency.tolist(),
    )
