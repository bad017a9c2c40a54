"""Chapters: the response over speed (torque of every order and of all together, peaks, angles) and over frequency."""

from collections.abc import Callable, Iterable, Iterator
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
from torsion.output.numbers import (
    LESS,
    NONE,
    RPM,
    Scale,
    counted,
    degrees,
    exact,
    number,
    rpm,
    settled,
)
from torsion.output.reported_values import (
    UNDAMPED,
    amplitude,
    barred_rpm,
    harmonic_name,
    joint_model,
    mode_near,
    orders_together,
    rated_rpm,
    reference,
    rounding,
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


@dataclass(frozen=True)
class Peak:
    """A local maximum of one line in one element."""

    element: Element
    line: int
    at: int  # position of the speed
    torque: float  # N m


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without a response over speed."""
    response = findings.get(Response)
    if response is None or not response.lines:
        return
    found = _carrying(findings, response)
    unit = torques(amplitude(findings, e.spans) for e in found)
    yield Heading(TITLE)
    yield _introduction(findings, response)
    yield _status(findings, response)
    if found:
        yield _summary(findings, found, unit)
        yield _peaks(findings, found, unit)
    yield from _figures(
        findings, [element for element in found if element.kind not in ("shaft", "gear")]
    )


def angles(findings: Findings) -> Iterator[Block]:
    """Appendix of the full report: the largest angular amplitude of every station."""
    response = findings.get(Response)
    if response is not None and response.lines:
        yield Heading("Appendix: angular amplitudes")
        yield _angles(findings, response)


def without_tables(findings: Findings) -> Iterator[Block]:
    """The same of its figures alone, and of what is to be noted."""
    response = findings.get(Response)
    if response is not None and response.lines:
        yield Heading(TITLE)
        yield _status(findings, response)
        yield from _figures(findings, _carrying(findings, response), MOST_LIVE)


def _carrying(findings: Findings, response: Response) -> list[Element]:
    """The elements with any torque."""
    return [
        e
        for e in elements(findings.system)
        if np.any(np.abs(response.torque[:, :, list(e.spans)]) > 0)
    ]


def _figures(findings: Findings, found: list[Element], most: int = MOST_FIGURES) -> Iterator[Block]:
    """The curves of the elements that are worth a figure, and which others there are."""
    drawn = worth_a_figure(
        findings, {e: highest(amplitude(findings, e.spans)) for e in found}, most
    )
    yield from (curves(findings, element) for element in drawn)
    if len(drawn) < len(found):
        rest = listed([e.name for e in found if e not in drawn])
        yield Paragraph(f"No figure, because the torque is smaller: {rest}.")


def _introduction(findings: Findings, response: Response) -> Paragraph:
    requested, extra = int(response.requested.sum()), int((~response.requested).sum())
    made = findings.get(Synthesis)
    components = "the requested orders" if response.left_out else "all orders"
    total = ""
    if made is not None:
        total = (
            f" The total vibratory torque is the phase-correct sum of {components} over the common period of "
            f"{exact(made.turns)} revolution{'' if made.turns <= 1 else 's'} of {reference(findings)}."
            if made.turns
            else " The orders have no common period. The total is the sum of their magnitudes, which is an upper bound."
        )
    limits = " and rule limits" if "response" in needed(findings.study) else ""
    text = (
        f"{counted(len(response.lines), 'harmonic component')} at {counted(requested, 'requested speed')}. The program "
        f"added {counted(extra, 'speed')} near resonances{limits}, so that the grid resolves every peak. Amplitudes "
        "are zero to peak; the amplitude of a total is half of its peak-to-peak value. A torque is the full "
        f"torque in the section (elastic plus damping) at the speed of the component.{total}"
    )
    if response.left_out:
        names = listed([line.named(reference(findings)) for line in response.left_out], "; ")
        text += f" Not requested by `orders` and therefore omitted: {names}.".replace("`", "")
    elif requested_orders(findings.study) is not None:
        text += " The rules judge the total of all orders, so all orders are reported."
    return Paragraph(text + (f" Note on the speeds: {response.remark}." if response.remark else ""))


def _status(findings: Findings, response: Response) -> Paragraph:
    reliable = response.residual[(response.status == Status.OK) & np.isfinite(response.residual)]
    bad = int(unreliable(findings).sum())
    text = (
        f"Largest relative residual of equilibrium: {number(float(reliable.max(initial=0.0)), 2)}."
    )
    text = f"{text} {joint_model(findings)}".strip()
    if bad == 0:
        return Paragraph(text)
    text += (
        f" At {counted(bad, 'speed')} the equations are singular or nearly singular (undamped resonance). The response "
        "has no reliable value there and no maximum over the range. The figures hatch these speeds; the table of peaks "
        "omits them."
    )
    return Paragraph(text, "note")


def _summary(findings: Findings, found: list[Element], unit: Scale) -> Table:
    response, made = findings.need(Response), findings.get(Synthesis)
    mean = torques([np.abs(response.mean)])
    rows, nothing = [], rounding(findings)
    for element in found:
        here = nothing[list(element.spans)]
        half, parts = (
            without(one(findings, element.spans), here) for one in (synthesis, amplitude)
        )
        at = largest(half)
        if at is None or made is None:
            rows.append((element.name, NO_VALUE, *[NONE] * 6))
            continue
        line = int(np.nanargmax(parts[at]))
        span = element.spans[int(np.argmax(made.half_range[at, list(element.spans)]))]
        steady = mean.text(float(response.mean[at, span]))
        if half[at] == 0.0:
            rows.append((element.name, "0", NONE, NONE, "0", "0", "0", steady))
            continue
        both = (unit.text(float(values[at, span])) for values in (made.rms, made.bound))
        rows.append(
            (
                element.name,
                unit.text(float(half[at])),
                rpm(float(response.speed[at])),
                _name(findings, line),
                unit.text(float(parts[at, line])),
                *both,
                steady,
            )
        )
    together = orders_together(findings)
    return table(
        f"< Component -> | Total vibratory torque [{unit.unit}] -> {unit.unit} | Speed [rpm] -> rpm | "
        f"< Largest order | Torque of this order [{unit.unit}] | RMS [{unit.unit}] | Sum of magnitudes [{unit.unit}] | "
        f"Mean [{mean.unit}]",
        rows,
        f"Maximum vibratory torque of every component over the speed range, {together}",
        short=f"Maximum vibratory torque, {together}",
    )


def _name(findings: Findings, index: int) -> str:
    """A harmonic component by its sources."""
    return findings.need(Response).lines[index].named(reference(findings))


def _peaks(findings: Findings, found: list[Element], unit: Scale) -> Block:
    """The peaks as a table; where there are too many, the largest referred to one speed."""
    response, peaks = findings.need(Response), found_peaks(findings, found)
    if not peaks:
        return Paragraph("No order has a resonance peak in the speed range.")
    size = [-peak.torque * peak.element.ratio for peak in peaks]
    kept = sorted(sorted(range(len(peaks)), key=size.__getitem__)[:MOST_PEAKS])
    rows = []
    for peak in (peaks[place] for place in kept):
        line, frequency = response.lines[peak.line], float(response.frequency[peak.at, peak.line])
        rows.append(
            (
                peak.element.name,
                line.named(reference(findings)),
                unit.text(peak.torque),
                rpm(float(response.speed[peak.at])),
                frequency,
                mode_near(findings, frequency),
            )
        )
    rest = f" (the {len(kept)} largest of {len(peaks)})" if len(kept) < len(peaks) else ""
    return table(
        f"< Component | < Order | Torque amplitude [{unit.unit}] | Speed [rpm] | Frequency [Hz] | Mode",
        rows,
        f"Resonance peaks of single orders in the speed range{rest}",
    )


def found_peaks(findings: Findings, elements: list[Element]) -> list[Peak]:
    """All peaks worth listing, by element, the largest first."""
    found: list[Peak] = []
    for element in elements:
        parts = amplitude(findings, element.spans)
        top = highest(parts)
        mine = [
            Peak(element, line, at, float(parts[at, line]))
            for line in range(parts.shape[1])
            for at in local_maxima(parts[:, line])
            if parts[at, line] >= SMALLEST * top
        ]
        found.extend(sorted(mine, key=lambda peak: -peak.torque))
    return found


def local_maxima(values: FloatArray) -> list[int]:
    """Inner places where the values are larger than on both sides; a place without a value is no neighbour."""
    filled = np.where(np.isfinite(values), values, np.inf)
    inner = (filled[1:-1] > filled[:-2]) & (filled[1:-1] >= filled[2:]) & np.isfinite(values[1:-1])
    return (np.flatnonzero(inner) + 1).tolist()


def _angles(findings: Findings, response: Response) -> Table:
    rows, known = [], (response.status == Status.OK)[:, :, None]
    sizes = np.where(known, np.abs(response.angle), np.nan)
    top = highest(sizes / findings.system.speed_ratio[: sizes.shape[2]])
    for index, name in _moving(findings):
        size = sizes[:, :, index]
        at = largest(size.ravel())
        if at is None:
            rows.append((name, NO_VALUE, *[NONE] * 4))
            continue
        speed, line = divmod(at, size.shape[1])
        angle = settled(float(size[speed, line]), top * float(findings.system.speed_ratio[index]))
        rows.append(
            (
                name,
                degrees(angle),
                number(angle),
                _name(findings, line),
                rpm(float(response.speed[speed])),
                number(angle * float(response.frequency[speed, line]) * 60.0),
            )
        )
    return table(
        "< Station | Maximum amplitude [deg] | Amplitude [rad] | < Order | Speed [rpm] | Speed amplitude [rpm]",
        rows,
        f"Maximum angular amplitude of single orders, each at the component's speed; 0: {LESS}",
    )


def _moving(findings: Findings) -> list[tuple[int, str]]:
    """Positions and names of the stations that are not the ground."""
    return [
        (k, station.name)
        for k, station in enumerate(findings.study.train.stations)
        if not station.is_ground
    ]


def curves(findings: Findings, element: Element) -> Figure:
    """The torque of an element over the speed: its strongest components, all together, and its limit."""
    response = findings.need(Response)
    parts, half = amplitude(findings, element.spans), synthesis(findings, element.spans)
    ratings = findings.study.train.parts[element.part].ratings
    limit = None if ratings is None else ratings.vibratory_torque
    unit = torques([parts])
    lines = [
        (harmonic_name(response, k, "order "), values * unit.factor)
        for k, values in enumerate(parts.T)
    ]
    return of_torsion(
        findings,
        curves_over_speed.torque(
            f"torque-{element.part}-{element.spans[0]}",
            f"Vibratory torque in {element.name}, {element.kind}",
            speed=response.speed * RPM,
            lines=lines,
            bad=unreliable(findings),
            unit=unit.unit,
            synthesis=half * unit.factor if len(response.lines) > 1 and len(half) else None,
            limits=[]
            if limit is None
            else [("permissible vibratory torque (manufacturer)", limit * unit.factor)],
            rated=rated_rpm(findings),
            barred=barred_rpm(findings),
            unstable=unstable_rpm(findings),
        ),
    )


def over_frequency(findings: Findings) -> Iterator[Block]:
    """Nothing where no frequencies were requested."""
    sweep = findings.get(FrequencyResponse)
    if sweep is None:
        return
    bad = sweep.status != Status.OK
    yield Heading("Response over the frequency range")
    text = "The excitation acts at every frequency, independent of the speed. Amplitudes are zero to peak."
    yield Paragraph(text)
    if bad.any():
        at = listed(dict.fromkeys(number(f, 5) for f in sweep.frequency[bad].tolist()))
        yield Paragraph(f"At {at} Hz {UNDAMPED}", "note")
    torque = {
        e.name: np.where(bad, np.nan, e.largest(np.abs(sweep.torque)))
        for e in elements(findings.system)
    }
    if torque:
        unit = torques(torque.values())
        titles = f"< Component | Amplitude [{unit.unit}] | Frequency [Hz]"
        yield _largest(titles, sweep, torque, (unit.text,), "torque amplitude")
        yield _curves(findings, "sweep-torque", "torque amplitude", torque, unit)
    angle = {
        name: np.where(bad, np.nan, np.abs(sweep.angle[:, k])) for k, name in _moving(findings)
    }
    titles = "< Station | Amplitude [rad] | Amplitude [deg] | Frequency [Hz]"
    yield _largest(titles, sweep, angle, (number, degrees), "angular amplitude")
    yield _curves(findings, "sweep-angle", "angular amplitude", angle, DEGREES)


def _largest(
    titles: str,
    sweep: FrequencyResponse,
    curves: dict[str, FloatArray],
    shown: Iterable[Callable[[float], str]],
    what: str,
) -> Table:
    """The largest of every curve, in each of the units that are shown, and its frequency."""
    rows = []
    for name, values in curves.items():
        at = largest(values)
        cells = (
            [NO_VALUE]
            if at is None
            else [*(one(float(values[at])) for one in shown), sweep.frequency[at]]
        )
        rows.append((name, *cells, *[NONE] * (titles.count("|") - len(cells))))
    return table(titles, rows, f"Maximum {what}")


def _curves(
    findings: Findings, name: str, what: str, curves: dict[str, FloatArray], unit: Scale
) -> Figure:
    sweep, modes = findings.need(FrequencyResponse), findings.get(Modes)
    values, names = np.array(list(curves.values())), list(curves)
    return curves_over_speed.frequency(
        name,
        f"{what.capitalize()} over the frequency",
        frequency=sweep.frequency,
        bad=sweep.status != Status.OK,
        lines=[(names[k], values[k] * unit.factor) for k in strongest(values.T, MOST_CURVES)],
        quantity=what,
        unit=unit.unit,
        natural=[] if modes is None else modes.frequency.tolist(),
    )
