"""Chapter: the conclusion, the restrictions of speed, and what to measure."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points
from torsion.output.headline import MOST_LISTED, notes, overall_headline, restrictions
from torsion.output.numbers import given_rpm, number, order, rpm
from torsion.output.reported_values import amplitude, reference
from torsion.output.selection import elements, highest
from torsion.rules.verdict_line import Checks


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the conclusion, and the measurements that would confirm it, if anything was judged or excited."""
    response = findings.get(Response)
    if not findings.need(Checks).lines and response is None:
        return
    yield Heading("Conclusion and proposed measurements")
    yield from conclusion(findings)
    if response is not None and response.lines:
        yield Paragraph("Measurements on the plant that would confirm the calculation:")
        yield Points(tuple(_measurements(findings, response)))


def conclusion(findings: Findings) -> Iterator[Block]:
    """Yield the headline of the verdict, its notes, and the restrictions of operation."""
    (_, words), kind = overall_headline(findings)
    yield Paragraph(f"{words}.", kind)
    yield from notes(findings)
    if sentences := restrictions(findings):
        yield Points(sentences)


def _measurements(findings: Findings, response: Response) -> Iterator[str]:
    """Yield what to measure: orders over speed, torque of the most loaded shaft, angle where mode 1 is largest."""
    speeds = findings.study.operation.speeds
    ends = (
        "over the speed range"
        if speeds is None
        else f"from {given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"
    )
    orders = ", ".join(
        order(line.order) for line in response.lines[:MOST_LISTED] if line.order is not None
    )
    yield (
        f"Run up and down slowly {ends} (speed of {reference(findings)}) and at steps of constant speed. Analyse the "
        f"orders{f' ({orders})' if orders else ''} and the natural frequencies."
    )
    shafts = [
        (amplitude(findings, e.spans), e) for e in elements(findings.system) if e.kind == "shaft"
    ]
    if loaded := [(values, shaft) for values, shaft in shafts if highest(values) > 0]:
        values, shaft = max(loaded, key=lambda pair: highest(pair[0]) * pair[1].ratio)
        speed = int(np.argmax(np.nan_to_num(values, nan=0.0).max(axis=1)))
        peak = f"the largest amplitude is expected at {rpm(float(response.speed[speed]))} rpm"
        yield f"Torque by strain gauges with telemetry on {shaft.name}; {peak}."
    modes, stations = findings.get(Modes), findings.study.train.stations
    if modes is None or len(modes.frequency) == 0:
        return
    size = np.abs(modes.shape[: len(stations), 0] / findings.system.speed_ratio[: len(stations)])
    name = stations[int(np.argmax(size))].name
    yield f"Angular vibration by encoder or laser at {name}, where mode 1 has its largest amplitude."
    lowest = ", ".join(number(f, 4) for f in modes.frequency[:3].tolist())
    yield (
        f"Compare the measured natural frequencies with {lowest} Hz. If they differ by more than 5 %, correct the "
        "input data and repeat the calculation."
    )
