"""Chapter: engines: data sheet, pressures, harmonics of a cylinder, sums of phasors, varying inertia, misfires."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.compressor.compressor_results import CompressorFound
from torsion.analyses.engine.engine_results import EngineFound, Engines, HarmonicFound
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Table, table
from torsion.output.chapters.engine_misfires import misfires
from torsion.output.figures import engine_curves
from torsion.output.numbers import NONE, RPM, degrees, given, number, order, rpm, settled

BAR = 1e-5  # of 1 Pa
MODES = ("first", "second", "third")
SAME_LOAD = 0.05  # relative: how far the mean pressure of the load may be from that at which the gas torque is given
REACHED = 1.2  # of the speed of the tables: ranges that begin above it are not listed
SMALL = 1e-3  # of the largest share of the inertia in a mode: less is not listed


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without an engine."""
    found = findings.get(Engines)
    if found is None or not found.each:
        return
    yield Heading("Engine" if len(found.each) == 1 else "Engines")
    for place, engine in enumerate(found.each):
        if len(found.each) > 1:
            yield Heading(engine.name, 2)
        yield from _one(findings, engine, place)


def _one(findings: Findings, engine: EngineFound, place: int) -> Iterator[Block]:
    yield KeyValues(tuple(_sheet(engine)))
    yield _cylinders(engine)
    yield from _balance(engine)
    if engine.curves:
        yield _diagram(engine, place)
    yield from varying(engine)
    yield from misfires(findings, engine, place)
    if engine.remarks:
        yield Paragraph(" ".join(engine.remarks), "note")


def details(findings: Findings) -> Iterator[Block]:
    """Appendix of the full report: harmonics of a cylinder, and the sums of phasors."""
    engines = findings.get(Engines)
    with_harmonics = (
        [engine for engine in engines.each if engine.harmonics] if engines is not None else []
    )
    if with_harmonics:
        yield Heading("Appendix: engine harmonics")
    for place, engine in enumerate(with_harmonics):
        yield _harmonics(engine)
        yield _spectrum(engine, place)
        yield _sums(engine)


def _sheet(engine: EngineFound) -> Iterator[tuple[str, str]]:
    """What the file says."""
    yield "Engine", engine.name
    yield from engine.words
    yield "Gas torque", engine.gas_words
    yield "Mechanical efficiency", f"{given(100 * engine.efficiency)} %"
    if engine.inertia:
        yield "Mean inertia of the moving masses of a cylinder", f"{given(engine.inertia)} kg m²"
    if engine.stress_modulus is not None:
        yield (
            "Minimum section modulus of journal and pin",
            f"{given(engine.stress_modulus * 1e9)} mm³",
        )


def _cylinders(engine: EngineFound) -> Table:
    rows = [
        (one.number, one.station, degrees(one.firing), one.state, 100 * one.share)
        for one in engine.cylinders
    ]
    return table(
        "< Cylinder | < Throw | Fires at [deg] | < State | Heat input / balanced cylinder [%]",
        rows,
        f"Cylinders of {engine.name}; crank angle from reference angle zero",
    )


def _balance(engine: EngineFound) -> Iterator[Block]:
    """Mean torque and mean pressure that go together, and what they differ from the figures of the file."""
    if engine.speed is not None and engine.mean_torque is not None:
        rows = [
            ("Mean torque", number(engine.mean_torque), "N m"),
            (
                "Mean torque with equal firing of all cylinders",
                number(engine.balanced_torque),
                "N m",
            ),
            ("Mean gas torque of a firing cylinder", number(engine.gas_mean), "N m"),
            ("Indicated mean effective pressure", _bar(engine.imep), "bar"),
            ("Indicated mean effective pressure of the gas data", _bar(engine.stated), "bar"),
        ]
        caption = f"Balance of mean torque of {engine.name} at {rpm(engine.speed)} rpm"
        yield table("< Quantity | Value | < Unit", [row for row in rows if row[1] != NONE], caption)
    if engine.speed is not None and engine.mean_torque is None:
        yield Paragraph(
            "The operation has no mean torque. The gas torque of the file applies at every speed.",
            "note",
        )
    for curve in engine.curves:
        if curve.stated is not None and curve.name.partition(" at ")[0] != "cycle":
            text = f"{curve.name}: imep of the diagram {_bar(curve.imep)} `bar`, stated {_bar(curve.stated)} `bar`."
            yield Paragraph(text.replace("`", ""))
    if engine.imep is not None and engine.stated is not None:
        off = engine.imep / engine.stated - 1.0
        if abs(off) > SAME_LOAD:
            yield Paragraph(
                f"The mean torque of the load needs {abs(100 * off):.3g} % {'more' if off > 0 else 'less'} mean "
                "pressure than the gas data. The harmonics follow the load as in the data sheet.",
                "note",
            )
    idle = [one for one in engine.cylinders if one.state != "firing"]
    if idle:
        rest = (
            "the other cylinders compensate"
            if engine.keeps_power
            else "the mean torque decreases by their share"
        )
        names = ", ".join(f"{one.number} ({one.state})" for one in idle)
        yield Paragraph(f"Cylinders without combustion: {names}; {rest}.")


def _bar(pressure: float | None) -> str:
    return NONE if pressure is None else number(pressure * BAR)


def _diagram(engine: EngineFound, place: int) -> Block:
    curves = [
        (
            one.name.replace("`", ""),
            np.degrees(one.angle),
            one.pressure * BAR,
            one.motored * BAR,
            one.tangential * BAR,
        )
        for one in engine.curves
    ]
    caption = f"Pressure of a cylinder of {engine.name}, and tangential pressure of its gas (torque / A r)"
    return engine_curves.diagram(f"engine-{place + 1}-pressure", caption, curves)


def _harmonics(engine: EngineFound) -> Table:
    """Gas, masses and their sum of every order."""
    rows = []
    largest = max(abs(one.total) for one in engine.harmonics)
    for one in engine.harmonics:
        rows.append(
            (
                order(one.order),
                *_polar(one.gas, largest),
                *_polar(one.masses, largest),
                *_polar(one.total, largest),
                None if one.tangential is None else one.tangential * BAR,
            )
        )
    at = "" if engine.speed is None else f" at {rpm(engine.speed)} rpm"
    each = "amplitude [N m] | phase [deg]"
    titles = f"Order | Gas, {each} | Masses, {each} | Sum, {each} | Sum, tangential [bar]"
    load = "" if engine.gas_mean is None else f" and {number(engine.gas_mean)} N m mean gas torque"
    return table(
        titles,
        rows,
        f"Harmonics of a firing cylinder of {engine.name}{at}{load}; phase at its firing TDC",
    )


def _polar(value: complex, largest: float) -> tuple[str, str]:
    """Amplitude and phase in degrees."""
    size = settled(abs(value), largest)
    return number(size), degrees(float(np.angle(value)), 5) if size else NONE


def _spectrum(engine: EngineFound, place: int) -> Block:
    orders = np.array([float(one.order) for one in engine.harmonics])
    parts = {
        "sum": [one.total for one in engine.harmonics],
        "gas": [one.gas for one in engine.harmonics],
        "masses": [one.masses for one in engine.harmonics],
    }
    sizes = [(words, np.abs(np.array(values))) for words, values in parts.items()]
    caption = f"Harmonics of the torque of a firing cylinder of {engine.name}"
    return engine_curves.harmonics(f"engine-{place + 1}-harmonics", caption, orders, sizes, "N m")


def _sums(engine: EngineFound) -> Table:
    """Sums of phasors over the cylinders, rigid and by mode."""
    modes = len(engine.harmonics[0].by_mode)
    whole = len(engine.cylinders)

    def mark(one: HarmonicFound) -> str:
        return "major" if one.rigid > (1.0 - SMALL) * whole else ""

    rows = [
        (
            order(one.order),
            *(number(settled(value, whole)) for value in (one.rigid, *one.by_mode)),
            mark(one),
        )
        for one in engine.harmonics
    ]
    named = "".join(f" | {word.capitalize()} mode" for word in MODES[:modes])
    return table(
        f"Order | Rigid{named} | < ",
        rows,
        f"Sums of phasors over the cylinders of {engine.name}; by mode, weighted with the angle of the throws / its "
        "maximum",
    )


def varying(engine: EngineFound | CompressorFound) -> Iterator[Block]:
    """The estimate of parametric resonance, of modes that vary at all."""
    known = [one for one in engine.varying if one.share > SMALL]
    if not known:
        return
    top = math.inf if engine.speed is None else REACHED * engine.speed
    listed = [one for one in known if one.lower <= top]
    if not listed:
        first = min(one.lower for one in known)
        yield Paragraph(
            "The inertia of crank and rod varies over the revolution; the analyses use its mean. The estimated lowest "
            f"speed of parametric instability of an undamped mode is {rpm(first)} rpm."
        )
        return
    rows = [
        (
            one.mode,
            one.harmonic,
            100 * one.share,
            one.lower * RPM,
            one.upper * RPM,
            NONE if one.damping is None else number(100 * one.damping),
            25 * one.share,
            "stable" if one.is_stable else "check",
        )
        for one in listed
    ]
    yield Paragraph(
        "The inertia of crank and rod varies over the revolution; the analyses use its mean. If a harmonic of the "
        "variation has twice the frequency of a mode, divided by a whole number, the undamped mode is unstable "
        "near this "
        "speed. A damping ratio above a quarter of the variation prevents the instability (first-order estimate)."
    )
    yield table(
        "Mode | Harmonic of the revolution | Variation [%] | From [rpm] | To [rpm] | Damping ratio of the mode [%] | "
        "Required damping ratio [%] | < Estimate",
        rows,
        f"Varying inertia of {engine.name}: speed ranges of parametric instability of an undamped mode",
    )
