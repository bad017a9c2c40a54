"""Chapter: shear stress of every shaft over the speed, with the limits of the class rule where it has a role."""

from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import FloatArray
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, head
from torsion.output.numbers import NONE, RPM, Scale, number
from torsion.output.reported_values import barred, orders_together, rated_rpm, responds, unreliable
from torsion.output.selection import highest, largest, worst
from torsion.primitives import Bar

PA = 1e-6  # N/mm2 of 1 Pa
STRESS = Scale("N/mm²", 1.0)
MOST_FIGURES = 12
LIMITS = "| τ_{C} there [N/mm²] | τ_{T} there [N/mm²] | Largest τ / τ_{C} | At speed [rpm]"


@dataclass(frozen=True)
class Curves:
    """Stress and limits of one shaft over the speed, N/mm2."""

    speed: FloatArray  # (speeds,) rad/s
    stress: FloatArray  # (speeds,) NaN where the response has no reliable value
    continuous: FloatArray | None = None  # (speeds,)
    transient: FloatArray | None = None


def chapter(findings: Findings) -> list[Block]:
    """Nothing without shafts or without a response."""
    if not responds(findings) or not findings.study.train.bars:
        return []
    of = f"half range of the synthesis of {orders_together(findings)}"
    text = f"Nominal shear stress on the plain section, τ = torque / W_{{p}}, {of}."
    curves = {bar.name: _curves(findings, bar) for bar in findings.study.train.bars}
    if any(curve.continuous is not None for curve in curves.values()):
        text += " τ_{C} limits continuous operation, τ_{T} the stress while a barred range is passed (IACS UR M68)."
    blocks: list[Block] = [Heading("Stress of the shafts"), Paragraph(text), _table(findings, curves)]
    drawn = sorted(curves, key=lambda name: -highest(curves[name].stress))[:MOST_FIGURES]
    blocks.extend(_figure(findings, name, curves[name]) for name in curves if name in drawn)
    if len(drawn) < len(curves):
        blocks.append(Paragraph(f"The {len(drawn)} most stressed of {len(curves)} shafts have a figure."))
    return blocks


def _curves(findings: Findings, bar: Bar) -> Curves:
    """With the rule's own limits, where the rule is named and the shaft has a role."""
    bad = unreliable(findings)
    if any(rule == "iacs-m68" for rule, _ in findings.study.rules):
        from torsion.rules.m68 import limits

        try:
            speed, continuous, transient, stress = limits(findings, bar.name)
            return Curves(speed, np.where(bad, np.nan, stress), continuous, transient)
        except KeyError:
            pass
    spans = [k for k, span in enumerate(findings.system.spans) if span.part == bar.part]
    modulus = next(stress_modulus(own) for own in findings.system.train.bars if own.part == bar.part)
    stress = findings.need(Synthesis).half_range[:, spans].max(axis=1) / modulus * PA
    return Curves(findings.need(Response).speed, np.where(bad, np.nan, stress))


def _table(findings: Findings, curves: dict[str, Curves]) -> Table:
    limited = any(curve.continuous is not None for curve in curves.values())
    columns = head("< Shaft | < Role | Largest stress [N/mm²] | At speed [rpm] " + (LIMITS if limited else ""))
    rows = []
    for name, curve in curves.items():
        shaft = findings.study.train.part(name).shaft
        role = shaft.role if shaft is not None and shaft.role is not None else NONE
        at = largest(curve.stress)
        limits = [NONE] * 4
        if at is not None:
            limits[:2] = (
                NONE if one is None else number(float(one[at])) for one in (curve.continuous, curve.transient)
            )
            limits[2:] = _utilisation(curve)
        rows.append((name, role, *worst(curve.stress, curve.speed, STRESS), *(limits if limited else ())))
    return Table(columns, tuple(rows), "Largest stress amplitude of every shaft over the speed range")


def _utilisation(curve: Curves) -> tuple[str, str]:
    if curve.continuous is None:
        return NONE, NONE
    share = np.where(np.isnan(curve.continuous), -np.inf, curve.stress / curve.continuous)
    at = largest(share)
    return (NONE, NONE) if at is None else (number(float(share[at]), 4), number(float(curve.speed[at]) * RPM))


def _figure(findings: Findings, name: str, curve: Curves) -> Figure:
    values = {
        "speed": curve.speed * RPM, "synthesis": curve.stress, "bad": unreliable(findings),
        "continuous": curve.continuous, "transient": curve.transient, "rated": rated_rpm(findings),
        "barred": tuple((b.lower * RPM, b.upper * RPM) for b in barred(findings) if b.shaft == name),
    }  # fmt: skip
    position = findings.study.train.parts.index(findings.study.train.part(name))
    return Figure(f"stress-{position}", f"Vibratory shear stress of {name}", "stress", values)
