"""Chapter: vibratory against mean torque in every gear mesh."""

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import NONE, RPM, Scale, number, rpm, scale
from torsion.output.reported_values import (
    NO_VALUE,
    barred_rpm,
    largest,
    orders_together,
    rated_rpm,
    synthesis,
    unreliable,
)
from torsion.rules.verdict_line import Checks


def chapter(findings: Findings) -> list[Block]:
    """Nothing without gears or without a response."""
    if findings.get(Response) is None or findings.get(Synthesis) is None or not findings.need(Response).lines:
        return []
    meshes = [e for e in elements(findings.system) if e.kind == "gear"]
    if not meshes:
        return []
    torque = {e: synthesis(findings, e.spans) for e in meshes}
    unit = scale("N m", [float(np.nanmax(np.append(row, 0.0))) for row in torque.values()])
    blocks: list[Block] = [Heading("Gear meshes")]
    if findings.get(Steady) is None:
        blocks.append(
            Paragraph("The mean torque is not known, so it cannot be said whether the tooth load reverses.", "note")
        )
    blocks.append(_table(findings, torque, unit))
    return [*blocks, *(_figure(findings, mesh, values) for mesh, values in torque.items())]


def _mean(findings: Findings, mesh: Element) -> FloatArray | None:
    """(speeds,) N m; None where it is not known."""
    if findings.get(Steady) is None or findings.get(Response) is None:
        return None
    return np.asarray(np.abs(findings.need(Response).mean[:, mesh.spans[0]]))


def _table(findings: Findings, torque: dict[Element, FloatArray], unit: Scale) -> Table:
    columns = head(
        f"< Mesh | Largest vibratory torque [{unit.unit}] | At speed [rpm] | "
        f"Mean torque there [{unit.unit}] | Largest vibratory / mean | At speed [rpm] | < Load reverses"
    )  # fmt: skip
    speed = findings.need(Response).speed if findings.get(Response) is not None else np.zeros(0)
    rows, marks = [], []
    for mesh, values in torque.items():
        at, mean = largest(values), _mean(findings, mesh)
        if at is None:
            rows.append((mesh.name, NO_VALUE, *[NONE] * 4, "not known"))
            marks.append("")
            continue
        share = np.full(len(values), np.nan) if mean is None else _share(values, mean)
        worst = None if np.all(np.isnan(share)) else int(np.nanargmax(share))
        turns = "" if worst is None else _reverses(speed, share)
        marks.append("fail" if turns not in ("", "no") else "")
        rows.append((
            mesh.name, unit.text(float(values[at])), rpm(float(speed[at])),
            NONE if mean is None else unit.text(float(mean[at])),
            NONE if worst is None else number(float(share[worst]), 4),
            NONE if worst is None or np.isinf(share[worst]) else rpm(float(speed[worst])),
            turns or "not known",
        ))  # fmt: skip
    caption = f"Vibratory torque (half range of {orders_together(findings)}) and mean torque in the meshes"
    return Table(columns, tuple(rows), caption, tuple(marks))


def _share(values: FloatArray, mean: FloatArray) -> FloatArray:
    """(speeds,) vibratory / mean torque: infinite where there is no mean torque, 0 where there is neither."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = values / mean
    share[(values == 0) & (mean == 0)] = 0.0
    return np.asarray(share)


def _reverses(speed: FloatArray, share: FloatArray) -> str:
    over = np.flatnonzero(share > 1.0)
    if len(over) == 0:
        return "no"
    if len(over) == np.count_nonzero(~np.isnan(share)):
        return "yes, everywhere"
    return f"yes, between {rpm(float(speed[over[0]]))} and {rpm(float(speed[over[-1]]))} rpm"


def _figure(findings: Findings, mesh: Element, values: FloatArray) -> Figure:
    mean = _mean(findings, mesh)
    unit = scale("N m", [float(np.nanmax(np.append(values, 0.0))), *([] if mean is None else [float(mean.max())])])
    drawn = {
        "speed": findings.need(Response).speed * RPM if findings.get(Response) is not None else np.zeros(0),
        "vibratory": values * unit.factor, "mean": None if mean is None else mean * unit.factor,
        "bad": unreliable(findings), "unit": unit.unit, "limit": None, "rated": rated_rpm(findings),
        "barred": barred_rpm(findings),
    }  # fmt: skip
    limit = [
        c.limit
        for c in findings.need(Checks).lines
        if c.where == mesh.name and c.rule == "gear-hammer" and c.unit == "N m"
    ]
    constant = [value for value in limit if np.isfinite(value)]
    drawn["limit"] = constant[0] * unit.factor if constant else None
    return Figure(f"gear-{mesh.part}-{mesh.spans[0]}", f"Vibratory and mean torque in {mesh.name}", "gear", drawn)
