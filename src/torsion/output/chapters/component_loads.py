"""Chapters: what the response over speed means for shafts (stress), gear meshes and couplings (torque, heat)."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.figures import curves_over_speed
from torsion.output.figures.figure import Figure
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import RPM, number, rpm
from torsion.output.reported_values import (
    barred,
    barred_rpm,
    harmonic_name,
    mode_near,
    orders_together,
    rated_rpm,
    reference,
    responds,
    synthesis,
    unreliable,
)
from torsion.output.selection import (
    Element,
    damps,
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
    """Shear stress, with the limits of the class rule where a shaft has a role; nothing without shafts or response."""
    if not responds(findings) or not findings.study.train.bars:
        return
    text = f"Nominal shear stress of the plain section, τ = torque / W_{{p}}: amplitude of {orders_together(findings)}."
    curves = {bar.name: stress_curves(findings, bar) for bar in findings.study.train.bars}
    if any(curve.continuous is not None for curve in curves.values()):
        rules = ", ".join(dict.fromkeys(curve.rule for curve in curves.values() if curve.rule))
        text += f" τ_{{C}} limits continuous operation, τ_{{T}} limits passing through a barred range ({rules})."
    yield Heading("Stress of the shafts")
    yield Paragraph(text)
    yield _stresses(findings, curves)
    if said := " ".join(_weakest(findings, curves)):
        yield Paragraph(said)
    yield _by_order(findings, curves)
    drawn = sorted(curves, key=lambda name: -highest(curves[name].stress))[:MOST_FIGURES]
    for name, curve in curves.items():
        if name in drawn:
            position = findings.study.train.position(name)
            yield of_torsion(
                findings,
                curves_over_speed.stress(
                    f"stress-{position}",
                    f"Vibratory shear stress of {name}",
                    speed=curve.speed * RPM,
                    synthesis=curve.stress,
                    bad=unreliable(findings),
                    continuous=curve.continuous,
                    lines=[
                        (harmonic_name(findings.need(Response), k, "order "), curve.orders[:, k])
                        for k in range(curve.orders.shape[1])
                    ],
                    transient=curve.transient,
                    rated=rated_rpm(findings),
                    barred=tuple(
                        (b.lower * RPM, b.upper * RPM) for b in barred(findings) if b.shaft == name
                    ),
                ),
            )
    if len(drawn) < len(curves):
        yield Paragraph(
            f"The figures show the {len(drawn)} shafts with the highest stress of {len(curves)} shafts."
        )


def stress_curves(findings: Findings, bar: Bar) -> Curves:
    """With the rule's own limits, where the rule is named and the shaft has a role."""
    response, bad = findings.need(Response), unreliable(findings)
    spans, modulus, limited = _section(findings, bar)
    stress = (findings.need(Synthesis).half_range[:, spans] / modulus).max(axis=1) * PA
    orders = (np.abs(response.torque[:, :, spans]) / modulus).max(axis=2) * PA
    orders = np.where(response.status == Status.OK, orders, np.nan)
    return Curves(response.speed, np.where(bad, np.nan, stress), orders, *limited)


def _section(
    findings: Findings, bar: Bar
) -> tuple[IntArray, FloatArray, tuple[FloatArray, FloatArray, str] | tuple[()]]:
    """Spans of a shaft, W_p of each (m3) and limits: those of the first rule that judges it, else the smallest W_p."""
    if findings.study.rules:
        from torsion.rules import shaft_limits, shaft_stress

        try:
            rule, shaft = shaft_stress.judging(findings, bar.name)
            _, continuous, transient, _ = shaft_stress.limits_of(findings, shaft)
            return *shaft_limits.stress_modulus(findings.system, shaft.part), (
                continuous,
                transient,
                rule.title,
            )
        except KeyError:
            pass
    spans = np.flatnonzero(findings.system.span_part == bar.part)
    own = next(one for one in findings.system.train.bars if one.part == bar.part)
    return spans, np.full(len(spans), stress_modulus(own)), ()


def _stresses(findings: Findings, curves: dict[str, Curves]) -> Table:
    limited = any(curve.continuous is not None for curve in curves.values())
    rows = []
    for name, curve in curves.items():
        shaft = findings.study.train.part(name).shaft
        at, limits = largest(curve.stress), [None] * 4
        if at is not None and curve.continuous is not None and curve.transient is not None:
            limits[:2] = curve.continuous[at], curve.transient[at]
            shares = np.where(np.isnan(curve.continuous), -np.inf, curve.stress / curve.continuous)
            if (most := largest(shares)) is not None:
                limits[2:] = shares[most], curve.speed[most]
        role = None if shaft is None else shaft.role
        rows.append((name, role, *worst(curve.stress, curve.speed), *limits[: 4 * limited]))
    return table(
        f"< Shaft | < Role | Maximum stress [=N/mm²] | Speed [rpm]{LIMITS if limited else ''}",
        rows,
        "Maximum stress amplitude of every shaft over the speed range",
    )


def _weakest(findings: Findings, curves: dict[str, Curves]) -> Iterator[str]:
    """Of every shaft of sections the one with the largest stress, in a sentence."""
    for whole, bars in findings.study.train.sectioned.items():
        name = max((bar.name for bar in bars), key=lambda name: highest(curves[name].stress))
        if not highest(curves[name].stress):
            continue
        stress, speed = worst(curves[name].stress, curves[name].speed)
        yield (
            f"{name} has the highest stress of the {len(bars)} sections of {whole}: "
            f"{stress if isinstance(stress, str) else number(stress)} N/mm² at {rpm(speed)} rpm."
        )


def _by_order(findings: Findings, curves: dict[str, Curves]) -> Table:
    """Of every shaft the largest stress of each harmonic component by itself, the strongest of them."""
    response, rows = findings.need(Response), []
    for name, curve in curves.items():
        top = highest(curve.orders)
        for line in strongest(curve.orders, MOST_ORDERS):
            stress = curve.orders[:, line]
            at = largest(stress)
            if at is not None and stress[at] >= SMALLEST * top:
                frequency = float(response.frequency[at, line])
                component = response.lines[line].named(reference(findings))
                stated = *worst(stress, curve.speed), frequency, mode_near(findings, frequency)
                rows.append((name, component, *stated))
    return table(
        "< Shaft | < Order | Maximum stress [=N/mm²] | Speed [rpm] | Frequency [Hz] | Mode",
        rows,
        f"Maximum stress amplitude of single orders (the {MOST_ORDERS} largest of each shaft)",
    )


def gears(findings: Findings) -> Iterator[Block]:
    """Vibratory against mean torque in every mesh; nothing without gears or without a response."""
    meshes = (
        [e for e in elements(findings.system) if e.kind == "gear"] if responds(findings) else []
    )
    if not meshes:
        return
    yield Heading("Gear meshes")
    response, steady = findings.need(Response), findings.get(Steady)
    if steady is None:
        text = "The input has no mean torque. Torque reversal in the meshes is not checked."
        yield Paragraph(text, "note")
    found = [
        (
            mesh,
            synthesis(findings, mesh.spans),
            None if steady is None else np.abs(response.mean[:, mesh.spans[0]]),
        )
        for mesh in meshes
    ]
    rows = []
    for mesh, values, own in found:
        at = largest(values)
        mean = None if at is None or own is None else own[at]
        reversal = _reversal(response.speed, values, None if at is None else own)
        rows.append((mesh.name, *worst(values, response.speed), mean, *reversal))
    yield table(
        "< Mesh | Maximum vibratory torque [~N m] | Speed [rpm] | Mean torque [~N m] | "
        "Maximum vibratory / mean:4 | Speed [rpm] | < Torque reversal",
        rows,
        f"Vibratory torque ({orders_together(findings)}) and mean torque in the meshes",
        marks=["fail" if row[-1].startswith("yes") else "" for row in rows],
    )
    for mesh, values, own in found:
        yield _mesh(findings, mesh, values, own)


def _reversal(
    speed: FloatArray, values: FloatArray, mean: FloatArray | None
) -> tuple[float | None, float | None, str]:
    """The largest vibratory / mean torque, its speed, and where the load reverses; a share is infinite without mean."""
    if mean is None:
        return None, None, "not known"
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(values == 0, 0.0, values / mean)
    most, over, where = int(np.argmax(share)), np.flatnonzero(share > 1.0), "no"
    if len(over):
        ends = rpm(float(speed[over[0]])), rpm(float(speed[over[-1]]))
        where = (
            "yes, everywhere"
            if len(over) == len(share)
            else "yes, between {} and {} rpm".format(*ends)
        )
    return share[most], None if np.isinf(share[most]) else speed[most], where


def _mesh(findings: Findings, mesh: Element, values: FloatArray, mean: FloatArray | None) -> Figure:
    unit = torques([values] if mean is None else [values, mean])
    limits = [
        check.limit
        for check in findings.need(Checks).lines
        if (check.where, check.rule, check.unit) == (mesh.name, "gear-hammer", "N m")
        and np.isfinite(check.limit)
    ]
    return of_torsion(
        findings,
        curves_over_speed.gear(
            f"gear-{mesh.part}-{mesh.spans[0]}",
            f"Vibratory and mean torque in {mesh.name}",
            speed=findings.need(Response).speed * RPM,
            vibratory=values * unit.factor,
            mean=None if mean is None else mean * unit.factor,
            bad=unreliable(findings),
            unit=unit.unit,
            limit=limits[0] * unit.factor if limits else None,
            rated=rated_rpm(findings),
            barred=barred_rpm(findings),
        ),
    )


def couplings(findings: Findings) -> Iterator[Block]:
    """Torque and heat of those with damping or limits of their maker; nothing without them or without a response."""
    system, parts = findings.system, findings.study.train.parts
    found = [
        (element, ratings, synthesis(findings, element.spans))
        for element in (elements(system) if responds(findings) else ())
        if (ratings := parts[element.part].ratings) is not None
        and (damps(system, element) or ratings.limit_anything)
    ]
    if not found:
        return
    speed, steady, rows = findings.need(Response).speed, findings.get(Steady), []
    for element, limits, values in found:
        spans = list(element.spans)
        peak = element.largest(findings.need(Synthesis).peak)
        peak = np.where(unreliable(findings) | ~np.isfinite(peak), np.nan, peak)
        rows.append(
            (
                element.name,
                *worst(values, speed),
                limits.vibratory_torque,
                None if steady is None else np.abs(steady.torque[spans]).max(),
                limits.rated_torque,
                worst(peak, speed)[0],
                limits.max_torque,
                *worst(_heat(findings, spans), speed),
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


def _heat(findings: Findings, spans: list[int]) -> FloatArray:
    """(speeds,) W, as the rules judge it; NaN where the response has no reliable value."""
    from torsion.rules.coupling_maker import raised_heat

    with np.errstate(all="ignore"):
        power = raised_heat(findings, np.array(spans)).sum(axis=1)
    return np.where(unreliable(findings) | ~np.isfinite(power), np.nan, power)
