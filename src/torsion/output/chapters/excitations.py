"""Chapter: what excites the train."""

import math

from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, head
from torsion.output.numbers import NONE, degrees, given, given_rpm, number, order, scale
from torsion.output.reported_values import reference
from torsion.primitives import Torque


def chapter(findings: Findings) -> list[Block]:
    """Torques, then the orders that come together; joints have a chapter of their own."""
    train = findings.study.train
    angled = [mesh for mesh in train.constraints if mesh.error]
    if not train.torques and not angled:
        return []
    blocks: list[Block] = [Heading("Excitations")]
    if train.torques:
        blocks.append(_torques(findings))
    if angled:
        names = ", ".join(f"{mesh.name} (order {mesh.error[0][0]})" for mesh in angled)
        blocks.append(Paragraph(f"Joints that excite by their angle, by order of their driving shaft: {names}."))
    if findings.get(Response) is not None and findings.need(Response).lines:
        blocks.append(_lines(findings))
    return blocks


def _torques(findings: Findings) -> Table:
    columns = head(
        "< At | Order, own shaft | Order, reference | Frequency [Hz] | < Amplitude (half range) | Phase [deg] | "
        "< Source"
    )
    rows = []
    for torque in findings.study.train.torques:
        station = findings.system.stations[torque.station]
        own = torque.order
        rows.append((
            torque.name, order(own), order(None if own is None else own * station.ratio), _frequency(torque),
            _amplitude(torque), degrees(torque.phase),
            findings.study.train.parts[station.part].source or "input",
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Harmonic torques")


def _frequency(torque: Torque) -> str:
    if torque.order is not None:
        return NONE
    return "every one requested" if torque.frequency is None else given(torque.frequency)


def _amplitude(torque: Torque) -> str:
    words = []
    if torque.table:
        unit = scale("N m", [t for _, t in torque.table])
        words.append("; ".join(f"{given(t * unit.factor)} {unit.unit} at {given_rpm(n)} rpm" for n, t in torque.table))
    if torque.torque or not (torque.of_mean or torque.table):
        unit = scale("N m", [torque.torque])
        words.append(f"{given(torque.torque * unit.factor)} {unit.unit}")
    if torque.of_mean:
        words.append(f"{100 * torque.of_mean:.6g} % of the mean torque")
    return " + ".join(words)


def _lines(findings: Findings) -> Table:
    response = findings.need(Response)
    columns = head("Order of the reference | Frequency over the range [Hz] | < Sources")
    rows = []
    for index, line in enumerate(response.lines):
        low, high = float(response.frequency[:, index].min()), float(response.frequency[:, index].max())
        span = number(low) if math.isclose(low, high) else f"{number(low)}–{number(high)}"
        rows.append((order(line.order), span, ", ".join(dict.fromkeys(line.sources))))
    per_revolution = f"orders per revolution of {reference(findings)}"
    caption = f"Harmonic components of the response, {per_revolution}; contributions of one order are added as phasors"
    return Table(columns, tuple(rows), caption)
