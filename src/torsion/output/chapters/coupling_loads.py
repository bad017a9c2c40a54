"""Chapter: torque and heat of the couplings that have damping or limits of their maker."""

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import NONE, Scale
from torsion.output.reported_values import orders_together, responds, synthesis, unreliable
from torsion.output.selection import torques, worst

WATT = Scale("W", 1.0)


def chapter(findings: Findings) -> list[Block]:
    """Nothing without elastic couplings or without a response."""
    if not responds(findings):
        return []
    found = [e for e in elements(findings.system) if _is_shown(findings, e)]
    if not found:
        return []
    text = (
        "Heat is the mean power that the internal damping takes from the vibration, the sum over all harmonic "
        f"components ({orders_together(findings)}); for damping by hysteresis it is ψ ω T²/(4 π k) of the elastic "
        "torque T. Values stand at their own worst speed."
    )
    return [Heading("Couplings"), Paragraph(text), _table(findings, found)]


def _is_shown(findings: Findings, element: Element) -> bool:
    system, first = findings.system, element.spans[0]
    ratings = system.train.parts[element.part].ratings
    damps = system.loss_factor[first] > 0 or system.viscous[first] > 0
    return ratings is not None and bool(damps or ratings.limit_anything)


def _table(findings: Findings, found: list[Element]) -> Table:
    torque = [synthesis(findings, element.spans) for element in found]
    unit, speed, steady = torques(torque), findings.need(Response).speed, findings.get(Steady)
    made, bad = findings.need(Synthesis), unreliable(findings)
    columns = head(
        f"< Coupling | Vibratory torque [{unit.unit}] | At speed [rpm] | T_{{KW}} [{unit.unit}] | "
        f"Mean torque [{unit.unit}] | T_{{KN}} [{unit.unit}] | Peak torque [{unit.unit}] | T_{{Kmax}} [{unit.unit}] | "
        "Heat [W] | At speed [rpm] | P_{KW} [W]"
    )
    rows = []
    for element, values in zip(found, torque, strict=True):
        spans = list(element.spans)
        limits = findings.study.train.parts[element.part].ratings
        if limits is None:
            continue
        peak, _ = worst(np.where(bad, np.nan, made.peak[:, spans].max(axis=1)), speed, unit)
        mean = NONE if steady is None else unit.text(float(np.abs(steady.torque[spans]).max()))
        rows.append((
            element.name, *worst(values, speed, unit), unit.text(limits.vibratory_torque), mean,
            unit.text(limits.rated_torque), peak,
            unit.text(limits.max_torque), *worst(_heat(findings, spans), speed, WATT), WATT.text(limits.heat_limit),
        ))  # fmt: skip
    return Table(columns, tuple(rows), "Torque and heat of the couplings (limits of the maker where given)")


def _heat(findings: Findings, spans: list[int]) -> FloatArray:
    """(speeds,) W; NaN where the response has no reliable value."""
    from torsion.rules.coupling_maker import heat

    with np.errstate(all="ignore"):
        power = heat(findings.need(Response), findings.system, np.array(spans))
    return np.where(unreliable(findings), np.nan, power)
