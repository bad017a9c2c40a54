"""Chapter: the conclusion, and the measurements that would confirm it."""

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Points
from torsion.output.chapters.verdict import conclusion
from torsion.output.elastic_elements import elements
from torsion.output.numbers import given_rpm, number, order, rpm
from torsion.output.reported_values import amplitude, reference
from torsion.output.selection import highest
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
    ends = (
        "over the speed range" if speeds is None else f"from {given_rpm(speeds.first)} to {given_rpm(speeds.last)} rpm"
    )
    orders = ", ".join(order(line.order) for line in response.lines[:8] if line.order is not None)
    run = (
        f"Run up and down slowly {ends} (speed of {reference(findings)}) and at steps of constant speed, with an "
        f"analysis by orders{f' ({orders})' if orders else ''} and of the frequencies below."
    )
    found = [run, *_strain(findings), *_angle(findings)]
    modes = findings.get(Modes)
    if modes is not None and len(modes.frequency):
        values = ", ".join(number(f, 4) for f in modes.frequency[:3].tolist())
        found.append(
            f"Compare the measured natural frequencies with {values} Hz; a difference above 5 % calls for new data."
        )
    return tuple(found)


def _strain(findings: Findings) -> list[str]:
    """Where torque is best measured: the shaft with the largest vibratory torque at one speed."""
    shafts = [(amplitude(findings, e.spans), e) for e in elements(findings.system) if e.kind == "shaft"]
    values, shaft = max(shafts, key=lambda pair: highest(pair[0]) * pair[1].ratio, default=(np.zeros(0), None))
    if shaft is None or highest(values) == 0:
        return []
    at = int(np.argmax(np.nan_to_num(values, nan=0.0).max(axis=1)))
    speed = rpm(float(findings.need(Response).speed[at]))
    where = f"the largest amplitude is expected at {speed} rpm"
    return [f"Torque by strain gauges with telemetry on {shaft.name}; {where}."]


def _angle(findings: Findings) -> list[str]:
    """Where the first mode moves most and can be seen."""
    modes, train = findings.get(Modes), findings.study.train
    if modes is None or len(modes.frequency) == 0:
        return []
    size = np.abs(modes.shape[: len(train.stations), 0] / findings.system.speed_ratio[: len(train.stations)])
    station = train.stations[int(np.argmax(size))]
    return [f"Angular vibration by encoder or laser at {station.name}, where mode 1 has its largest amplitude."]
