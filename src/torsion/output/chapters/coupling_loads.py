"""Chapter: torque and heat of the couplings that have damping or limits of their maker."""

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray
from torsion.components.part_records import CouplingRatings
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import NONE, Scale, rpm, scale
from torsion.output.reported_values import NO_VALUE, largest, orders_together, synthesis, unreliable


def chapter(findings: Findings) -> list[Block]:
    """Nothing without elastic couplings or without a response."""
    if findings.get(Response) is None or findings.get(Synthesis) is None or not findings.need(Response).lines:
        return []
    system = findings.system
    rated = [(e, r) for e in elements(system) if (r := system.train.parts[e.part].ratings) is not None]
    rows = [(e, r, synthesis(findings, e.spans)) for e, r in rated if _damps(findings, e) or r.limit_anything]
    if not rows:
        return []
    unit = scale("N m", [float(np.nanmax(np.append(torque, 0.0))) for _, _, torque in rows])
    text = (
        "Heat is the mean power that the internal damping takes from the vibration, the sum over all lines "
        f"({orders_together(findings)}); for damping by hysteresis it is ψ ω T²/(4 π k) of the elastic torque T. "
        "Values stand at their own worst speed."
    )
    return [Heading("Couplings"), Paragraph(text), _table(findings, rows, unit)]


def _damps(findings: Findings, element: Element) -> bool:
    return bool(findings.system.loss_factor[element.spans[0]] > 0 or findings.system.viscous[element.spans[0]] > 0)


def _table(findings: Findings, couplings: list[tuple[Element, CouplingRatings, FloatArray]], unit: Scale) -> Table:
    columns = head(
        f"< Coupling | Vibratory torque [{unit.unit}] | At speed [rpm] | T_{{KW}} [{unit.unit}] | "
        f"Mean torque [{unit.unit}] | T_{{KN}} [{unit.unit}] | Peak torque [{unit.unit}] | "
        f"T_{{Kmax}} [{unit.unit}] | Heat [W] | At speed [rpm] | P_{{KW}} [W]"
    )  # fmt: skip
    rows = []
    for element, limits, values in couplings:
        rows.append((
            element.name, *_worst(findings, values, unit), _limit(limits.vibratory_torque, unit),
            _mean(findings, element, unit), _limit(limits.rated_torque, unit),
            _peak(findings, element, unit), _limit(limits.max_torque, unit),
            *_worst(findings, _heat(findings, element), Scale("W", 1.0)), _limit(limits.heat_limit, Scale("W", 1.0)),
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Torque and heat of the couplings (limits of the maker where given)")


def _worst(findings: Findings, values: FloatArray, unit: Scale) -> tuple[str, str]:
    at = largest(values)
    if at is None or findings.get(Response) is None:
        return NO_VALUE, NONE
    return unit.text(float(values[at])), rpm(float(findings.need(Response).speed[at]))


def _limit(value: float | None, unit: Scale) -> str:
    return NONE if value is None else unit.text(value)


def _mean(findings: Findings, element: Element, unit: Scale) -> str:
    if findings.get(Steady) is None:
        return NONE
    return unit.text(float(np.abs(findings.need(Steady).torque[list(element.spans)]).max()))


def _peak(findings: Findings, element: Element, unit: Scale) -> str:
    made = findings.get(Synthesis)
    if made is None:
        return NONE
    peak = np.where(unreliable(findings), np.nan, made.peak[:, list(element.spans)].max(axis=1))
    at = largest(peak)
    return NO_VALUE if at is None else unit.text(float(peak[at]))


def _heat(findings: Findings, element: Element) -> FloatArray:
    """(speeds,) W; NaN where the response has no reliable value."""
    from torsion.rules.coupling_maker import heat

    response, system = findings.get(Response), findings.system
    if response is None:
        return np.zeros(0)
    data = [
        (float(system.flexibility[s]), float(system.viscous[s]), float(system.loss_factor[s]), s) for s in element.spans
    ]
    with np.errstate(all="ignore"):
        power = np.sum([heat(response, *row) for row in data], axis=0)
    return np.where(unreliable(findings), np.nan, power)
