"""Chapters: what the response over speed means for shafts (stress), gear meshes and couplings (torque, heat)."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import ComponentLoads, stress_of
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Heading, Paragraph, table
from torsion.output.figures.curves import (
    SPEED,
    TOTAL,
    amplitudes,
    barred_bands,
    rated_level,
    span,
    unanswered,
)
from torsion.output.figures.curves import orders as lines_of_orders
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel, Role
from torsion.output.numbers import RPM, number, rpm
from torsion.output.reported_values import (
    barred,
    barred_rpm,
    harmonic_name,
    of_torsion,
    orders_together,
    rated_rpm,
    responds,
    synthesis,
)
from torsion.output.stored.scene import elements, highest, torques
from torsion.primitives import Bar
from torsion.rules.verdict_line import Checks

PA = 1e-6  # N/mm² of 1 Pa
MOST_FIGURES = 3  # of shafts
SMALL = 0.1  # of the limit: a smaller stress has a plot of its own, as it would lie on the axis
STRESS = ("shear stress amplitude", "N/mm²")


@dataclass(frozen=True)
class Curves:
    """Stress and limits of one shaft over the speed, N/mm2."""

    speed: FloatArray  # (speeds,) rad/s
    stress: FloatArray  # (speeds,) NaN where the response has no reliable value
    orders: FloatArray  # (speeds, lines) the same of single orders
    continuous: FloatArray | None = None  # (speeds,)
    transient: FloatArray | None = None
    rule: str = ""  # whose limits these are


def shafts(findings: Findings) -> Iterator[Block]:
    """Yield shear stresses, with the limits of the class rule where a shaft has a role; nothing without a response."""
    if not responds(findings) or not findings.study.train.bars:
        return
    text = f"Nominal shear stress of the plain section, τ = torque / W_{{p}}: amplitude of {orders_together(findings)}."
    curves = {bar.name: stress_curves(findings, bar) for bar in findings.system.train.bars}
    if rules := ", ".join(dict.fromkeys(curve.rule for curve in curves.values() if curve.rule)):
        text += (
            f" τ_{{C}} limits continuous operation, τ_{{T}} limits passing through a barred range ({rules}); "
            "the checks compare the stress with both."
        )
    drawn = sorted(curves, key=lambda name: -highest(curves[name].stress))[:MOST_FIGURES]
    if len(drawn) < len(curves):
        text += f" The figures show the {len(drawn)} shafts with the highest stress of {len(curves)} shafts."
    yield Heading("Stress of the shafts")
    yield Paragraph(text)
    yield table(
        "shaft: < Shaft | role: < Role:? | stress: Maximum stress [N/mm²]:u | speed: Speed [rpm]",
        findings.need(ComponentLoads).shafts,
        "Maximum stress amplitude of every shaft over the speed range",
    )
    loads = {load.shaft: load for load in findings.need(ComponentLoads).shafts}
    for shaft, sections in findings.study.train.sectioned.items():
        load = max((loads[bar.name] for bar in sections), key=lambda load: load.stress or 0.0)
        if load.stress:
            words = (
                f"{load.shaft} has the highest stress of the {len(sections)} sections of {shaft}"
            )
            value = f"{number(load.stress * PA)} N/mm² at {rpm(load.speed)} rpm"
            yield Paragraph(f"{words}: {value}.")
    yield from (_stress_figure(findings, name, curves[name]) for name in curves if name in drawn)


def _stress_figure(findings: Findings, name: str, curve: Curves) -> Figure:
    """Draw the stress of one shaft; a stress far below its limit has a plot of its own below the other."""
    response, speed = findings.need(Response), curve.speed * RPM
    hidden, bands = unanswered(speed, response.unreliable)
    total = Line("total stress", speed, np.where(hidden, np.nan, curve.stress), "synthesis")
    orders = [
        (harmonic_name(response, line, "order "), stress)
        for line, stress in enumerate(curve.orders.T)
    ]
    stresses = (total, *lines_of_orders(speed, orders, hidden))
    given: tuple[tuple[str, FloatArray | None, Role], ...] = (
        ("limit τ_{C}, continuous", curve.continuous, "limit"),
        ("limit τ_{T}, passing rapidly", curve.transient, "second limit"),
    )
    limits = tuple(
        Line(words, speed, values, pen)
        for words, values, pen in given
        if values is not None and np.any(np.isfinite(values))
    )
    own_bands = (band for band in barred(findings) if band.shaft == name)
    ranges = tuple((band.lower * RPM, band.upper * RPM) for band in own_bands)
    x, levels = span(SPEED, speed), rated_level(rated_rpm(findings))
    behind = barred_bands(ranges) + bands
    lowest = min((float(np.nanmin(line.y)) for line in limits), default=0.0)
    y = amplitudes(*STRESS, [total.y], [highest(line.y) for line in limits])
    panels = [Panel(x, y, stresses + limits, levels, behind)]
    if highest(total.y) < SMALL * lowest:
        both, y = Axis("stress and limits", "N/mm²", low=0.0), amplitudes(*STRESS, [total.y])
        panels = [
            Panel(x, both, (total, *limits), levels, behind, height=75.0),
            Panel(x, y, stresses, levels, behind, height=105.0),
        ]
    figure_name = f"stress-{findings.study.train.positions[name]}"
    figure = Figure(figure_name, f"Vibratory shear stress of {name}", tuple(panels))
    return of_torsion(findings, figure)


def stress_curves(findings: Findings, bar: Bar) -> Curves:
    """Return stress and limits of a shaft: those of the first rule that judges it, if there is one."""
    response, total = findings.need(Response), findings.need(Synthesis)
    stress = stress_of(bar, findings.system, total.half_range) * PA
    orders = stress_of(bar, findings.system, np.abs(response.torque)) * PA
    orders = np.where(response.status == Status.OK, orders, np.nan)
    stress = np.where(response.unreliable, np.nan, stress)
    curves = Curves(response.speed, stress, orders)
    if findings.study.rules:
        from torsion.rules.class_rules import m68, shaft_limits

        with suppress(KeyError):
            rule, shaft = m68.judging(findings, bar.name)
            limits = shaft_limits.limits_of(findings, shaft)
            return replace(curves, continuous=limits.tau_c, transient=limits.tau_t, rule=rule.title)
    return curves


def gears(findings: Findings) -> Iterator[Block]:
    """Yield vibratory against mean torque in every mesh; nothing without gears or without a response."""
    loads = findings.get(ComponentLoads)
    if loads is None or not loads.meshes:
        return
    yield Heading("Gear meshes")
    has_mean = findings.get(Steady) is not None
    if not has_mean:
        text = "The input has no mean torque. Torque reversal in the meshes is not checked."
        yield Paragraph(text, "note")
    yield table(
        "mesh: < Mesh | torque: Maximum vibratory torque [~N m]:u | speed: Speed [rpm] | mean: Mean torque [~N m]:? | "
        "ratio: Maximum vibratory / mean:4? | ratio_speed: Speed [rpm]:? | reverses: < Torque reversal | "
        "reversal@1: From [rpm]:? | reversal@2: To [rpm]:?",
        loads.meshes,
        f"Vibratory torque ({orders_together(findings)}) and mean torque in the meshes",
        marks=["fail" if mesh.reversal else "" for mesh in loads.meshes],
    )
    limits_by_mesh = {
        check.where: [check.limit]
        for check in reversed(findings.need(Checks).lines)
        if check.rule == "gear-hammer" and check.unit == "N m" and np.isfinite(check.limit)
    }
    response = findings.need(Response)
    speed = response.speed * RPM
    hidden, bands = unanswered(speed, response.unreliable)
    for mesh in (mesh for mesh in elements(findings.system) if mesh.kind == "gear"):
        torque, mean = synthesis(findings, mesh.spans), np.abs(response.mean[:, mesh.spans[0]])
        unit = torques([torque, mean] if has_mean else [torque])
        total, mean = np.where(hidden, np.nan, torque * unit.factor), mean * unit.factor
        lines = [Line(TOTAL, speed, total, "synthesis")]
        if has_mean:
            lines.append(Line("mean torque", speed, mean, 0))
            over = np.where(total > mean, total, np.nan)
            if np.isfinite(over).any():
                lines.append(Line("torque reverses", speed, over, "limit", weight=0.0, base=mean))
        limits = [limit * unit.factor for limit in limits_by_mesh.get(mesh.name, ())]
        words = "limit of the vibratory torque"
        levels = [Level(words, limit, is_reached=True) for limit in limits]
        panel = Panel(
            span(SPEED, speed),
            amplitudes("mesh torque", unit.unit, [total], limits),
            tuple(lines),
            (*levels, *rated_level(rated_rpm(findings))),
            barred_bands(barred_rpm(findings)) + bands,
        )
        name, caption = f"gear-{mesh.part}-{mesh.spans[0]}", "Vibratory and mean torque in "
        yield of_torsion(findings, Figure(name, caption + mesh.name, (panel,)))


def couplings(findings: Findings) -> Iterator[Block]:
    """Yield torque and heat of couplings with damping or limits of their maker; nothing without a response."""
    loads = findings.get(ComponentLoads)
    if loads is None or not loads.couplings:
        return
    yield Heading("Couplings")
    yield Paragraph(
        f"The power loss is the sum over {orders_together(findings)}, for relative damping ψ: ψ ω T²/(4 π k). "
        "Each value is a maximum over the speed range."
    )
    yield table(
        "coupling: < Coupling | torque: Vibratory torque [~N m]:u | speed: Speed [rpm] | "
        "vibratory_limit: T_{KW} [~N m]:? | mean: Mean torque [~N m]:? | rated_torque: T_{KN} [~N m]:? | "
        "peak: Peak torque [~N m]:u | max_torque: T_{Kmax} [~N m]:? | heat: Power loss [W]:u | "
        "heat_speed: Speed [rpm] | heat_limit: P_{KW} [W]:?",
        loads.couplings,
        "Torque and power loss of the couplings with the manufacturer's limits",
    )
