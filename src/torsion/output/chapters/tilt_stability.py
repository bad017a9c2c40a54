"""Section: parametric stability of the tilt of driven shafts on bearings."""

from typing import TYPE_CHECKING

import numpy as np

from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, head
from torsion.output.numbers import RPM, number, rpm
from torsion.output.reported_values import rated_rpm
from torsion.rules.verdict_line import Checks

if TYPE_CHECKING:
    from torsion.analyses.lateral.shaft_bending import ShaftFound
    from torsion.analyses.lateral.tilt_stability import Tilting, Zone

MODEL = (
    "The secondary couple of a joint follows the tilt of the shaft that it drives and so makes its stiffness vary at "
    "twice the speed of the driving shaft: small tilting motions can grow by themselves. The shaft is taken for rigid, "
    "turning about the centre of its joint (Zhu and Wang), the driving shaft for evenly turning with the mean torque."
)
NAMES = {"mean couple": "the mean part of the couple feeds the motion", "several": "several resonances together"}


def section(findings: Findings, shafts: "tuple[ShaftFound, ...]") -> list[Block]:
    """Nothing where no driven shaft tilts on supports."""
    stated = [(shaft, shaft.tilting) for shaft in shafts if shaft.tilting is not None]
    if not stated:
        return []
    blocks: list[Block] = [Heading("Parametric stability of the tilt", 2), Paragraph(MODEL), _bodies(stated)]
    blocks += _verdict(findings)
    if any(tilting.zones for _, tilting in stated):
        blocks.append(_zones(findings, stated))
    return blocks + [_figure(findings, shaft, tilting, k) for k, (shaft, tilting) in enumerate(stated, start=1)]


def zone_name(zone: "Zone") -> str:
    """What meets in a zone, in words."""
    return NAMES.get(zone.kind, zone.kind)


def _bodies(stated: "list[tuple[ShaftFound, Tilting]]") -> Table:
    columns = head(
        "< Shaft | < Driven by | Transverse inertia [kg m²] | Polar inertia [kg m²] | Frequency of the tilt, y [Hz] | "
        "z [Hz] | Decay rate, y [1/s] | z [1/s]"
    )
    rows = []
    for shaft, tilting in stated:
        body = tilting.shaft
        decay = [number(float(rate) / 2.0) for rate in body.decay[::-1]]
        rows.append((
            shaft.name, tilting.joint, number(body.inertia), number(body.polar * body.inertia),
            *(number(hertz) for hertz in tilting.frequency.values()), *decay,
        ))  # fmt: skip
    caption = "Shafts that tilt as rigid bodies about the centre of their joint; at rest, without torque"
    return Table(columns, tuple(rows), caption)


def _verdict(findings: Findings) -> list[Block]:
    blocks: list[Block] = []
    for check in findings.need(Checks).lines:
        if check.clause == "tilting":
            end = f" ({check.note})" if check.note else ""
            if check.value > 0:
                at = f"{number(check.value, 4)} 1/s at {rpm(check.speed)} rpm"
                blocks.append(Paragraph(f"{check.where} is unstable: its tilt grows by up to {at}{end}.", "fail"))
            else:
                words = f"No tilting motion of {check.where} grows at the speeds that were looked at{end}."
                blocks.append(Paragraph(words, "fail" if check.fails else "pass"))
    return blocks


def _zones(findings: Findings, stated: "list[tuple[ShaftFound, Tilting]]") -> Table:
    speeds = findings.study.operation.speeds
    columns = head(
        "< Shaft | From [rpm] | To [rpm] | < Type | Largest growth [1/s] | At speed [rpm] | < Within the operation"
    )
    rows, marks = [], []
    for shaft, tilting in stated:
        for zone in tilting.zones:
            low, worst, up = zone.lower, zone.worst, zone.upper
            inside = speeds is None or (low < speeds.last and up > speeds.first)
            ends = [
                rpm(end, 9) + (" (open)" if open_ else "") for end, open_ in zip((low, up), zone.is_open, strict=True)
            ]
            rows.append((
                shaft.name, *ends, zone_name(zone), number(zone.rate), rpm(worst), "UNSTABLE" if inside else "outside",
            ))  # fmt: skip
            marks.append("fail" if inside else "note")
    caption = (
        "Unstable ranges of the tilt (open: the range goes on beyond the speeds looked at); 1 and 2 ascend in frequency"
    )
    return Table(columns, tuple(rows), caption, tuple(marks))


def _figure(findings: Findings, shaft: "ShaftFound", tilting: "Tilting", count: int) -> Figure:
    values = {
        "speed": tilting.speed * RPM, "growth": np.asarray(tilting.growth), "rated": rated_rpm(findings),
        "unstable": [(zone.lower * RPM, zone.upper * RPM, zone.kind) for zone in tilting.zones],
    }  # fmt: skip
    caption = f"{shaft.name}: growth rate of its tilt by the couple of {tilting.joint}"
    return Figure(f"tilting-{count}", caption, "stability", values)
