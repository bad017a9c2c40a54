"""Chapter: the conclusion, the restrictions of speed, and what to measure."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points
from torsion.output.headline import MOST_LISTED, notes, overall_headline, restrictions
from torsion.output.numbers import number, order, rpm
from torsion.output.reported_values import reference, speed_range
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
    stated = speed_range(findings)
    ends = f"from {stated}" if stated else "over the speed range"
    orders = ", ".join(
        order(line.order) for line in response.lines[:MOST_LISTED] if line.order is not None
    )
    yield (
        f"Run up and down slowly {ends} (speed of {reference(findings)}) and at steps of constant speed. Analyse the "
        f"orders{f' ({orders})' if orders else ''} and the natural frequencies."
    )
    loads = findings.get(ComponentLoads)
    shafts = () if loads is None else loads.shafts
    if shaft := max(shafts, key=lambda shaft: shaft.stress or 0.0, default=None):
        peak = f"the largest amplitude is expected at {rpm(shaft.speed)} rpm"
        if shaft.stress:
            yield f"Torque by strain gauges with telemetry on {shaft.shaft}; {peak}."
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
