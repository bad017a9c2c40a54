"""Chapter: what excites the train."""

import math
from collections.abc import Iterator

from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, degrees, given, given_rpm, number, order, scale
from torsion.output.reported_values import NOT_STATED, reference
from torsion.primitives import Torque


def chapter(findings: Findings) -> Iterator[Block]:
    """Torques, then the orders that come together; joints have a chapter of their own."""
    train, response = findings.study.train, findings.get(Response)
    angled = [mesh for mesh in train.constraints if mesh.error]
    if not train.torques and not angled:
        return
    yield Heading("Excitations")
    if train.torques:
        yield _torques(findings)
    if angled:
        names = ", ".join(f"{mesh.name} (order {mesh.error[0][0]})" for mesh in angled)
        yield Paragraph(f"Joints that excite by their angle, by order of their driving shaft: {names}.")
    if response is not None and response.lines:
        yield _lines(findings, response)


def _torques(findings: Findings) -> Table:
    rows = []
    for torque in findings.study.train.torques:
        station, own = findings.system.stations[torque.station], torque.order
        frequency = "every one requested" if torque.frequency is None else given(torque.frequency)
        rows.append((
            torque.name, order(own), order(None if own is None else own * station.ratio),
            NONE if own is not None else frequency, _amplitude(torque), degrees(torque.phase),
            torque.source or NOT_STATED,
        ))  # fmt: skip
    return table(
        "< At | Order, own shaft | Order, reference | Frequency [Hz] | < Amplitude (half range) | Phase [deg] | "
        "< Source",
        rows,
        "Harmonic torques",
    )


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


def _lines(findings: Findings, response: Response) -> Table:
    rows = []
    for place, line in enumerate(response.lines):
        low, high = float(response.frequency[:, place].min()), float(response.frequency[:, place].max())
        span = number(low) if math.isclose(low, high) else f"{number(low)}–{number(high)}"
        rows.append((line.named(reference(findings)), order(line.order), span))
    return table(
        "< Harmonic component | Order of the reference | Frequency over the range [Hz]",
        rows,
        f"Harmonic components of the response, orders per revolution of {reference(findings)}; contributions of one "
        "order are added as phasors",
    )
