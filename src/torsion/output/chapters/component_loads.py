"""Chapters: what the response over speed means for shafts (stress), gear meshes and couplings (torque, heat)."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import ComponentLoads, MeshLoad
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.model.parts import CouplingRatings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves_over_speed
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import RPM, number, rpm
from torsion.output.reported_values import (
    barred,
    harmonic_name,
    mode_near,
    orders_together,
    reference,
    responds,
    speed_axis,
    synthesis,
    unreliable,
)
from torsion.output.selection import (
    NO_VALUE,
    elements,
    highest,
    largest,
    strongest,
    torques,
    worst,
)
from torsion.primitives import Bar
from torsion.rules.verdict_line import Checks

PA = 1e-6  # N/mm² of 1 Pa
MOST_FIGURES = 3  # of shafts
MOST_ORDERS = 3  # of a shaft, in the table of stress by order
SMALLEST = 0.01  # of the shaft's largest stress of one order; less is not listed
LIMITS = " | τ_{C} [=N/mm²] | τ_{T} [=N/mm²] | Maximum τ / τ_{C}:4 | Speed [rpm]"


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
    curves = {bar.name: stress_curves(findings, bar) for bar in findings.study.train.bars}
    if rules := ", ".join(dict.fromkeys(curve.rule for curve in curves.values() if curve.rule)):
        text += f" τ_{{C}} limits continuous operation, τ_{{T}} limits passing through a barred range ({rules})."
    yield Heading("Stress of the shafts")
    yield Paragraph(text)
    yield _largest_stresses(findings, curves)
    if weakest := " ".join(_weakest_sections(findings, curves)):
        yield Paragraph(weakest)
    yield _by_order(findings, curves)

    drawn = sorted(curves, key=lambda name: -highest(curves[name].stress))[:MOST_FIGURES]
    for name in (name for name in curves if name in drawn):
        curve, response = curves[name], findings.need(Response)
        bands = (
            (band.lower * RPM, band.upper * RPM) for band in barred(findings) if band.shaft == name
        )
        figure = curves_over_speed.stress(
            f"stress-{findings.study.train.position(name)}",
            f"Vibratory shear stress of {name}",
            **{**speed_axis(findings), "barred": tuple(bands)},
            synthesis=curve.stress,
            continuous=curve.continuous,
            transient=curve.transient,
            lines=[
                (harmonic_name(response, line, "order "), stress)
                for line, stress in enumerate(curve.orders.T)
            ],
        )
        yield of_torsion(findings, figure)
    if len(drawn) < len(curves):
        text = f"The figures show the {len(drawn)} shafts with the highest stress of {len(curves)} shafts."
        yield Paragraph(text)


def stress_curves(findings: Findings, bar: Bar) -> Curves:
    """Return stress and limits of a shaft: those of the first rule that judges it, if there is one."""
    response, total = findings.need(Response), findings.need(Synthesis)
    spans, modulus, continuous, transient, rule = _section(findings, bar)
    stress = (total.half_range[:, spans] / modulus).max(axis=1) * PA
    orders = (np.abs(response.torque[:, :, spans]) / modulus).max(axis=2) * PA
    orders = np.where(response.status == Status.OK, orders, np.nan)
    stress = np.where(unreliable(findings), np.nan, stress)
    return Curves(response.speed, stress, orders, continuous, transient, rule)


def _section(
    findings: Findings, bar: Bar
) -> tuple[IntArray, FloatArray, FloatArray | None, FloatArray | None, str]:
    """Return spans of a shaft, W_p of each (m3), limits and their rule; without a rule the smallest W_p."""
    if findings.study.rules:
        from torsion.rules import shaft_limits, shaft_stress

        try:
            rule, shaft = shaft_stress.judging(findings, bar.name)
        except KeyError:
            pass
        else:
            _, continuous, transient, _ = shaft_stress.limits_of(findings, shaft)
            section = shaft_limits.stress_modulus(findings.system, shaft.part)
            return *section, continuous, transient, rule.title
    spans = np.flatnonzero(findings.system.span_part == bar.part)
    bars = {bar.part: bar for bar in findings.system.train.bars}
    return spans, np.full(len(spans), stress_modulus(bars[bar.part])), None, None, ""


def _largest_stresses(findings: Findings, curves: dict[str, Curves]) -> Table:
    is_limited = any(curve.continuous is not None for curve in curves.values())
    rows = []
    for name, curve in curves.items():
        shaft = findings.study.train.part(name).shaft
        speed, limits = largest(curve.stress), [None] * 4
        if speed is not None and curve.continuous is not None and curve.transient is not None:
            limits[:2] = curve.continuous[speed], curve.transient[speed]
            shares = np.where(np.isnan(curve.continuous), -np.inf, curve.stress / curve.continuous)
            if (highest_share := largest(shares)) is not None:
                limits[2:] = shares[highest_share], curve.speed[highest_share]
        role = None if shaft is None else shaft.role
        rows.append((name, role, *worst(curve.stress, curve.speed), *limits[: 4 * is_limited]))
    return table(
        f"< Shaft | < Role | Maximum stress [=N/mm²] | Speed [rpm]{LIMITS * is_limited}",
        rows,
        "Maximum stress amplitude of every shaft over the speed range",
    )


def _weakest_sections(findings: Findings, curves: dict[str, Curves]) -> Iterator[str]:
    """Yield a sentence on the section with the largest stress, of every shaft of sections."""
    for shaft, bars in findings.study.train.sectioned.items():
        name = max((bar.name for bar in bars), key=lambda name: highest(curves[name].stress))
        if highest(curves[name].stress):
            stress, speed = worst(curves[name].stress, curves[name].speed)
            value = stress if isinstance(stress, str) else number(stress)
            words = f"{name} has the highest stress of the {len(bars)} sections of {shaft}"
            yield f"{words}: {value} N/mm² at {rpm(speed)} rpm."


def _by_order(findings: Findings, curves: dict[str, Curves]) -> Table:
    """Return the largest stress of single harmonic components, the strongest of every shaft."""
    response, rows = findings.need(Response), []
    for name, curve in curves.items():
        top = highest(curve.orders)
        for line in strongest(curve.orders, MOST_ORDERS):
            speed = largest(curve.orders[:, line])
            if speed is not None and curve.orders[speed, line] >= SMALLEST * top:
                rows.append(
                    (
                        name,
                        response.lines[line].named(reference(findings)),
                        *worst(curve.orders[:, line], curve.speed),
                        response.frequency[speed, line],
                        mode_near(findings, float(response.frequency[speed, line])),
                    )
                )
    return table(
        "< Shaft | < Order | Maximum stress [=N/mm²] | Speed [rpm] | Frequency [Hz] | Mode",
        rows,
        f"Maximum stress amplitude of single orders (the {MOST_ORDERS} largest of each shaft)",
    )


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
        "< Mesh | Maximum vibratory torque [~N m] | Speed [rpm] | Mean torque [~N m] | "
        "Maximum vibratory / mean:4 | Speed [rpm] | < Torque reversal",
        [
            (
                mesh.mesh,
                NO_VALUE if mesh.torque is None else mesh.torque,
                mesh.speed,
                mesh.mean,
                mesh.ratio,
                mesh.ratio_speed,
                _reversal_words(mesh),
            )
            for mesh in loads.meshes
        ],
        f"Vibratory torque ({orders_together(findings)}) and mean torque in the meshes",
        marks=["fail" if mesh.reversal else "" for mesh in loads.meshes],
    )
    limits = {
        check.where: check.limit
        for check in reversed(findings.need(Checks).lines)
        if check.rule == "gear-hammer" and check.unit == "N m" and np.isfinite(check.limit)
    }
    for mesh in (mesh for mesh in elements(findings.system) if mesh.kind == "gear"):
        torque, limit = synthesis(findings, mesh.spans), limits.get(mesh.name)
        mean = np.abs(findings.need(Response).mean[:, mesh.spans[0]])
        unit = torques([torque, mean] if has_mean else [torque])
        figure = curves_over_speed.gear(
            f"gear-{mesh.part}-{mesh.spans[0]}",
            f"Vibratory and mean torque in {mesh.name}",
            **speed_axis(findings),
            vibratory=torque * unit.factor,
            mean=mean * unit.factor if has_mean else None,
            unit=unit.unit,
            limit=None if limit is None else limit * unit.factor,
        )
        yield of_torsion(findings, figure)


def _reversal_words(mesh: MeshLoad) -> str:
    if mesh.ratio is None:
        return "not known"
    if mesh.reverses_everywhere:
        return "yes, everywhere"
    return "yes, between {} and {} rpm".format(*map(rpm, mesh.reversal)) if mesh.reversal else "no"


def couplings(findings: Findings) -> Iterator[Block]:
    """Yield torque and heat of couplings with damping or limits of their maker; nothing without a response."""
    loads = findings.get(ComponentLoads)
    if loads is None or not loads.couplings:
        return
    parts, rows = findings.study.train.parts, []
    part_of = {element.name: parts[element.part] for element in elements(findings.system)}
    for load in loads.couplings:
        limits = part_of[load.coupling].ratings or CouplingRatings()
        torque, peak, heat = (
            NO_VALUE if value is None else value for value in (load.torque, load.peak, load.heat)
        )
        rows.append(
            (
                load.coupling,
                torque,
                load.speed,
                limits.vibratory_torque,
                load.mean,
                limits.rated_torque,
                peak,
                limits.max_torque,
                heat,
                load.heat_speed,
                limits.heat_limit,
            )
        )
    yield Heading("Couplings")
    yield Paragraph(
        f"The power loss is the sum over {orders_together(findings)}, for relative damping ψ: ψ ω T²/(4 π k). "
        "Each value is a maximum over the speed range."
    )
    yield table(
        "< Coupling | Vibratory torque [~N m] | Speed [rpm] | T_{KW} [~N m] | "
        "Mean torque [~N m] | T_{KN} [~N m] | Peak torque [~N m] | T_{Kmax} [~N m] | "
        "Power loss [W] | Speed [rpm] | P_{KW} [W]",
        rows,
        "Torque and power loss of the couplings with the manufacturer's limits",
    )
