"""Chapter: vibratory against mean torque in every gear mesh."""

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import NONE, RPM, number, rpm
from torsion.output.reported_values import barred_rpm, orders_together, rated_rpm, responds, synthesis, unreliable
from torsion.output.selection import NO_VALUE, largest, torques
from torsion.rules.verdict_line import Checks


def chapter(findings: Findings) -> list[Block]:
    """Nothing without gears or without a response."""
    meshes = [e for e in elements(findings.system) if e.kind == "gear"] if responds(findings) else []
    if not meshes:
        return []
    blocks: list[Block] = [Heading("Gear meshes")]
    if findings.get(Steady) is None:
        text = "The mean torque is not known, so it cannot be said whether the tooth load reverses."
        blocks.append(Paragraph(text, "note"))
    torque = {mesh: synthesis(findings, mesh.spans) for mesh in meshes}
    return [*blocks, _table(findings, torque), *(_figure(findings, mesh, values) for mesh, values in torque.items())]


def _mean(findings: Findings, mesh: Element) -> FloatArray | None:
    """(speeds,) N m; None where it is not known."""
    known = findings.get(Steady) is not None
    return np.asarray(np.abs(findings.need(Response).mean[:, mesh.spans[0]])) if known else None


def _table(findings: Findings, torque: dict[Element, FloatArray]) -> Table:
    unit, speed = torques(torque.values()), findings.need(Response).speed
    columns = head(
        f"< Mesh | Largest vibratory torque [{unit.unit}] | At speed [rpm] | Mean torque there [{unit.unit}] | "
        "Largest vibratory / mean | At speed [rpm] | < Load reverses"
    )
    rows, marks = [], []
    for mesh, values in torque.items():
        at, mean = largest(values), _mean(findings, mesh)
        if at is None:
            row = mesh.name, NO_VALUE, *[NONE] * 4, "not known"
        else:
            there = NONE if mean is None else unit.text(float(mean[at]))
            reversal = _reversal(speed, values, mean)
            row = mesh.name, unit.text(float(values[at])), rpm(float(speed[at])), there, *reversal
        rows.append(row)
        marks.append("fail" if row[-1].startswith("yes") else "")
    caption = f"Vibratory torque (half range of {orders_together(findings)}) and mean torque in the meshes"
    return Table(columns, tuple(rows), caption, tuple(marks))


def _reversal(speed: FloatArray, values: FloatArray, mean: FloatArray | None) -> tuple[str, str, str]:
    """The largest vibratory / mean torque, its speed, and where the load reverses; a share is infinite without mean."""
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.full(len(values), np.nan) if mean is None else values / mean
    share[(values == 0) & (mean == 0 if mean is not None else False)] = 0.0
    known = ~np.isnan(share)
    if not known.any():
        return NONE, NONE, "not known"
    worst, over = int(np.nanargmax(share)), np.flatnonzero(share > 1.0)
    where = "no"
    if len(over):
        ends = rpm(float(speed[over[0]])), rpm(float(speed[over[-1]]))
        where = "yes, everywhere" if len(over) == known.sum() else "yes, between {} and {} rpm".format(*ends)
    return number(float(share[worst]), 4), NONE if np.isinf(share[worst]) else rpm(float(speed[worst])), where


def _figure(findings: Findings, mesh: Element, values: FloatArray) -> Figure:
    mean = _mean(findings, mesh)
    unit = torques([values] if mean is None else [values, mean])
    limits = [
        check.limit
        for check in findings.need(Checks).lines
        if (check.where, check.rule, check.unit) == (mesh.name, "gear-hammer", "N m") and np.isfinite(check.limit)
    ]
    drawn = {
        "speed": findings.need(Response).speed * RPM, "vibratory": values * unit.factor,
        "mean": None if mean is None else mean * unit.factor, "bad": unreliable(findings), "unit": unit.unit,
        "limit": limits[0] * unit.factor if limits else None, "rated": rated_rpm(findings),
        "barred": barred_rpm(findings),
    }  # fmt: skip
    return Figure(f"gear-{mesh.part}-{mesh.spans[0]}", f"Vibratory and mean torque in {mesh.name}", "gear", drawn)
