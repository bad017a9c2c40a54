"""Chapter: the conclusion, and the measurements that would confirm it."""

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points
from torsion.output.chapters.verdict import conclusion
from torsion.output.elastic_elements import elements
from torsion.output.numbers import given_rpm, number, order, rpm
from torsion.output.reported_values import amplitude, largest, reference
from torsion.rules.verdict_line import Checks


def chapter(findings: Findings) -> list[Block]:
    """Only where something was judged or excited."""
    if not findings.need(Checks).lines and findings.get(Response) is None:
        return []
    blocks: list[Block] = [Heading("Conclusion and proposed measurements"), *conclusion(findings)]
    proposals = _proposals(findings)
    if proposals:
        blocks.append(Paragraph("Measurements on the plant that would confirm the calculation:"))
        blocks.append(Points(proposals))
    return blocks


def _proposals(findings: Findings) -> tuple[str, ...]:
    response = findings.get(Response)
    if response is None or not response.lines:
        return ()
    speeds = findings.study.operation.speeds
    span = (
        f"from {given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"
        if speeds is not None
        else "over the speed range"
    )
    orders = ", ".join(order(line.order) for line in response.lines[:8] if line.order is not None)
    run = (
        f"Run up and down slowly {span} (speed of {reference(findings)}) and at steps of constant speed, with an "
        f"analysis by orders{f' ({orders})' if orders else ''} and of the frequencies below."
    )
    found = [run, *_strain(findings), *_angle(findings)]
    if findings.get(Modes) is not None and len(findings.need(Modes).frequency):
        values = ", ".join(number(f, 4) for f in findings.need(Modes).frequency[:3].tolist())
        found.append(
            f"Compare the measured natural frequencies with {values} Hz; a difference above 5 % calls for new data."
        )
    return tuple(found)


def _strain(findings: Findings) -> list[str]:
    """Where torque is best measured: the shaft with the largest vibratory torque at one speed."""
    shafts = [e for e in elements(findings.system) if e.kind == "shaft"]
    sized = [(float(np.nanmax(np.append(amplitude(findings, e.spans), 0.0))) * e.ratio, e) for e in shafts]
    if not sized or max(size for size, _ in sized) == 0:
        return []
    shaft = max(sized, key=lambda pair: pair[0])[1]
    values = amplitude(findings, shaft.spans)
    at = largest(np.nanmax(np.where(np.isfinite(values), values, 0.0), axis=1))
    where = (
        f"; the largest amplitude is expected at {rpm(float(findings.need(Response).speed[at]))} rpm"
        if findings.get(Response) and at is not None
        else ""
    )
    return [f"Torque by strain gauges with telemetry on {shaft.name}{where}."]


def _angle(findings: Findings) -> list[str]:
    """Where the first mode moves most and can be seen."""
    modes, train = findings.get(Modes), findings.study.train
    if modes is None or len(modes.frequency) == 0:
        return []
    size = np.abs(modes.shape[: len(train.stations), 0] / findings.system.speed_ratio[: len(train.stations)])
    station = train.stations[int(np.argmax(size))]
    return [f"Angular vibration by encoder or laser at {station.name}, where mode 1 has its largest amplitude."]
