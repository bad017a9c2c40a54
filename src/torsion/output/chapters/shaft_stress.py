"""Chapter: shear stress of every shaft over the speed, with the limits of the class rule where it has a role."""

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.arrays import FloatArray
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table, head
from torsion.output.numbers import NONE, RPM, number, rpm
from torsion.output.reported_values import NO_VALUE, barred, largest, orders_together, rated_rpm, unreliable
from torsion.primitives import Bar

PA = 1e-6  # N/mm2 of 1 Pa
MOST_FIGURES = 12
LIMITS = head("τ_{C} there [N/mm²] | τ_{T} there [N/mm²] | Largest τ / τ_{C} | At speed [rpm]")


def chapter(findings: Findings) -> list[Block]:
    """Nothing without shafts or without a response."""
    if findings.get(Response) is None or findings.get(Synthesis) is None or not findings.study.train.bars:
        return []
    if not findings.need(Response).lines:
        return []
    blocks: list[Block] = [Heading("Stress of the shafts")]
    of = f"half range of the synthesis of {orders_together(findings)}"
    text = f"Nominal shear stress on the plain section, τ = torque / W_{{p}}, {of}."
    curves = {bar.name: Curves(findings, bar) for bar in findings.study.train.bars}
    if any(curve.continuous is not None for curve in curves.values()):
        text += " τ_{C} limits continuous operation, τ_{T} the stress while a barred range is passed (IACS UR M68)."
    blocks.extend([Paragraph(text), _table(findings, curves)])
    drawn = sorted(curves, key=lambda name: -curves[name].top())[:MOST_FIGURES]
    blocks.extend(_figure(findings, name, curves[name]) for name in curves if name in drawn)
    if len(drawn) < len(curves):
        blocks.append(Paragraph(f"The {len(drawn)} most stressed of {len(curves)} shafts have a figure."))
    return blocks


class Curves:
    """Stress and limits of one shaft over the speed, N/mm2."""

    def __init__(self, findings: Findings, bar: Bar) -> None:
        self.speed = findings.need(Response).speed if findings.get(Response) is not None else np.zeros(0)
        self.continuous: FloatArray | None = None
        self.transient: FloatArray | None = None
        limits = _limits(findings, bar.name)
        if limits is not None:
            self.speed, self.continuous, self.transient, stress = limits
        else:
            stress = _stress(findings, bar)
        self.stress = np.where(unreliable(findings), np.nan, stress)

    def top(self) -> float:
        """The largest stress, or the largest share of the limit."""
        return float(np.nanmax(np.append(self.stress, 0.0)))


def _limits(findings: Findings, shaft: str) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray] | None:
    """The rule's own curves, where the rule was asked and the shaft has a role."""
    if not any(rule == "iacs-m68" for rule, _ in findings.study.rules):
        return None
    from torsion.rules.m68 import limits

    try:
        return limits(findings, shaft)
    except KeyError:
        return None


def _stress(findings: Findings, bar: Bar) -> FloatArray:
    """(speeds,) N/mm2, on the smallest section modulus of the shaft."""
    synthesis = findings.get(Synthesis)
    if synthesis is None:
        return np.zeros(0)
    spans = [k for k, span in enumerate(findings.system.spans) if span.part == bar.part]
    modulus = next(stress_modulus(own) for own in findings.system.train.bars if own.part == bar.part)
    return np.asarray(synthesis.half_range[:, spans].max(axis=1) / modulus * PA)


def _table(findings: Findings, curves: dict[str, Curves]) -> Table:
    limited = any(curve.continuous is not None for curve in curves.values())
    columns = (
        *head("< Shaft | < Role | Largest stress [N/mm²] | At speed [rpm]"),
        *(LIMITS if limited else ()),
    )  # fmt: skip
    rows = []
    for name, curve in curves.items():
        shaft = findings.study.train.part(name).shaft
        role = shaft.role if shaft is not None and shaft.role is not None else NONE
        at = largest(curve.stress)
        if at is None:
            rows.append((name, role, NO_VALUE, *[NONE] * (len(columns) - 3)))
            continue
        limits = (_at(curve.continuous, at), _at(curve.transient, at), *_utilisation(curve)) if limited else ()
        rows.append((name, role, number(float(curve.stress[at])), rpm(float(curve.speed[at])), *limits))
    return Table(columns, tuple(rows), "Largest stress amplitude of every shaft over the speed range")


def _at(limit: FloatArray | None, at: int) -> str:
    return NONE if limit is None else number(float(limit[at]))


def _utilisation(curve: Curves) -> tuple[str, str]:
    if curve.continuous is None:
        return NONE, NONE
    share = curve.stress / curve.continuous
    at = largest(np.where(np.isnan(curve.continuous), -np.inf, share))
    return (NONE, NONE) if at is None else (number(float(share[at]), 4), rpm(float(curve.speed[at])))


def _figure(findings: Findings, name: str, curve: Curves) -> Figure:
    bands = tuple((b.lower * RPM, b.upper * RPM) for b in barred(findings) if b.shaft == name)
    values = {
        "speed": curve.speed * RPM, "synthesis": curve.stress, "bad": unreliable(findings),
        "continuous": curve.continuous, "transient": curve.transient, "rated": rated_rpm(findings), "barred": bands,
    }  # fmt: skip
    part = findings.study.train.part(name)
    position = findings.study.train.parts.index(part)
    return Figure(f"stress-{position}", f"Vibratory shear stress of {name}", "stress", values)
