"""Chapter: engines: data sheet, pressures, harmonics of a cylinder, sums of phasors, varying inertia, misfires."""

import cmath
import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.compressor.compressor_results import CompressorFound
from torsion.analyses.engine.engine_results import EngineFound, Engines, MisfireFound
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Table, table
from torsion.output.figures import engine_curves
from torsion.output.numbers import RPM, given, number, rpm, scale, settled
from torsion.output.selection import Element, elements, worst
from torsion.results import listed

BAR = 1e-5  # of 1 Pa
MODES = ("first", "second", "third")
SAME_LOAD = 0.05  # relative: how far the mean pressure of the load may be from that at which the gas torque is given
REACHED = 1.2  # of the speed of the tables: ranges that begin above it are not listed
MOST_CURVES = 13  # in the figure, the first with every cylinder firing
STATES = {"motored": "motored (misfire)", "cut out": "cut out"}
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
    yield table(
        "number: < Cylinder | station: < Throw | firing: Fires at [deg]:g | state: < State | "
        "share: Heat input / balanced cylinder [%]",
        engine.cylinders,
        f"Cylinders of {engine.name}; crank angle from reference angle zero",
    )
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


def _balance(engine: EngineFound) -> Iterator[Block]:
    """Mean torque and mean pressure that go together, and what they differ from the figures of the file."""
    if engine.speed is not None and engine.mean_torque is not None:
        gas = "Indicated mean effective pressure"
        rows = [
            ("Mean torque", engine.mean_torque, "N m"),
            ("Mean torque with equal firing of all cylinders", engine.balanced_torque, "N m"),
            ("Mean gas torque of a firing cylinder", engine.gas_mean, "N m"),
            (gas, engine.imep and engine.imep * BAR, "bar"),
            (f"{gas} of the gas data", engine.stated and engine.stated * BAR, "bar"),
        ]
        caption = f"Balance of mean torque of {engine.name} at {rpm(engine.speed)} rpm"
        known = [row for row in rows if row[1] is not None]
        yield table("< Quantity | Value | < Unit", known, caption)
    if engine.speed is not None and engine.mean_torque is None:
        yield Paragraph(
            "The operation has no mean torque. The gas torque of the file applies at every speed.",
            "note",
        )
    for curve in engine.curves:
        if curve.stated is not None and curve.name.partition(" at ")[0] != "cycle":
            text = f"{curve.name}: imep of the diagram {number(curve.imep * BAR)} bar, "
            yield Paragraph(f"{text}stated {number(curve.stated * BAR)} bar.")
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
    largest = max(abs(one.total) for one in engine.harmonics)
    rows = [
        (
            one.order,
            *_polar(one.gas, largest),
            *_polar(one.masses, largest),
            *_polar(one.total, largest),
            one.tangential,
        )
        for one in engine.harmonics
    ]
    at = "" if engine.speed is None else f" at {rpm(engine.speed)} rpm"
    each = "amplitude [N m] | phase [deg]:g"
    titles = f"Order:o | Gas, {each} | Masses, {each} | Sum, {each} | Sum, tangential [bar]"
    load = "" if engine.gas_mean is None else f" and {number(engine.gas_mean)} N m mean gas torque"
    return table(
        titles,
        rows,
        f"Harmonics of a firing cylinder of {engine.name}{at}{load}; phase at its firing TDC",
    )


def _polar(value: complex, largest: float) -> tuple[float, float | None]:
    """Return amplitude and phase (rad); no phase of what is rounding beside the largest."""
    size = settled(abs(value), largest)
    return size, cmath.phase(value) if size else None


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
    rows = [
        (
            one.order,
            *(settled(value, whole) for value in (one.rigid, *one.by_mode)),
            "major" if one.rigid > (1.0 - SMALL) * whole else "",
        )
        for one in engine.harmonics
    ]
    named = "".join(f" | {word.capitalize()} mode" for word in MODES[:modes])
    return table(
        f"Order:o | Rigid{named} | < ",
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
    reached = [one for one in known if one.lower <= top]
    if not reached:
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
            one.share,
            one.lower,
            one.upper,
            one.damping,
            one.share / 4.0,
            "stable" if one.is_stable else "check",
        )
        for one in reached
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


def misfires(findings: Findings, engine: EngineFound, place: int) -> Iterator[Block]:
    """The worst cylinder for every element, and the curves of the most loaded element."""
    if not engine.misfires:
        return
    system = findings.need(Response).system
    each = [one for one in elements(system) if system.flexibility[one.spans[0]] > 0]
    if not each:
        return
    unit = scale("N m", [float(case.half_range.max()) for case in engine.misfires])
    yield Heading(f"Misfire of each cylinder of {engine.name}", 2)
    yield Paragraph(
        "Each cylinder is motored in turn: it compresses without combustion, and its masses keep moving. The other "
        "cylinders keep their gas torque. Damping that depends on the mean torque is unchanged."
    )
    yield _by_element(engine, each)
    speed = engine.misfires[0].speed * RPM
    for drawn, element in enumerate(_drawn(engine, each)):
        curves = [
            (_named(case), element.largest(case.half_range) * unit.factor)
            for case in engine.misfires
        ]
        caption = (
            f"Vibratory torque in {element.name} with misfire of one cylinder of {engine.name}"
        )
        name = f"engine-{place + 1}-misfires-{drawn + 1}"
        yield engine_curves.misfires(name, caption, speed, curves[:MOST_CURVES], unit.unit)


def _drawn(engine: EngineFound, each: list[Element]) -> list[Element]:
    """The most loaded element, and the element with the largest increase by a misfire."""
    normal = {one: float(one.largest(engine.misfires[0].half_range).max()) for one in each}
    worst_of = {one: float(one.largest(_worst(engine, one).half_range).max()) for one in each}
    raised = max(each, key=lambda one: worst_of[one] / normal[one] if normal[one] else 0.0)
    return list(dict.fromkeys([max(each, key=lambda one: worst_of[one]), raised]))


def _named(case: MisfireFound) -> str:
    return f"cylinder {case.cylinder}" if case.cylinder else "all firing"


def _worst(engine: EngineFound, element: Element) -> MisfireFound:
    """Return the misfire with the largest torque in an element."""
    return max(engine.misfires[1:], key=lambda case: float(element.largest(case.half_range).max()))


def _by_element(engine: EngineFound, each: list[Element]) -> Table:
    """Return the worst misfire of every element, with the nominal stress of crank spans."""
    has_stress = engine.stress_modulus is not None and any(
        element.kind == "crank" for element in each
    )
    rows = []
    for element in each:
        normal, bad = engine.misfires[0], _worst(engine, element)
        torque, normal_torque = (element.largest(case.half_range) for case in (bad, normal))
        largest, normal_largest = float(torque.max()), float(normal_torque.max())
        modulus = engine.stress_modulus if element.kind == "crank" else None
        rows.append(
            (
                element.name,
                *worst(normal_torque, normal.speed),
                *worst(torque, bad.speed),
                f"no. {bad.cylinder}",
                largest / normal_largest if normal_largest else None,
                *[None if modulus is None else largest / modulus] * has_stress,
            )
        )
    return table(
        "< Component -> | All firing [~N m] -> all firing, ~ | Speed [rpm] | Worst misfire [~N m] -> worst misfire, ~ | "
        "Speed [rpm] -> rpm | < Cylinder -> | Ratio:4"
        + " | Nominal stress, worst misfire [N/mm²]"
        * has_stress,
        rows,
        f"Misfire of one cylinder of {engine.name}: maximum total vibratory torque of every component",
        short=f"Misfire of one cylinder of {engine.name}",
    )


def states(findings: Findings) -> Iterator[str]:
    """As what the engines are judged, where not every cylinder fires alike or a phase is any."""
    for part in findings.study.train.parts:
        if part.engine is None:
            continue
        words = [
            f"cylinder {one.number} {STATES[one.state]}"
            for one in part.engine.cylinders
            if one.state in STATES
        ]
        firing = [one for one in part.engine.cylinders if one.state == "firing"]
        for share in dict.fromkeys(one.share for one in firing if one.share != 1.0):
            numbers = [str(one.number) for one in firing if one.share == share]
            named = f"cylinder{'s' * (len(numbers) > 1)} {listed(numbers)}"
            who = "all others" if words and len(numbers) == len(firing) else named
            words.append(f"{who} with {100 * share:.4g} % of the heat")
        words += (
            ["any phase to the rest of the train (magnitudes are added)"]
            if part.engine.by_chance
            else []
        )
        words += ["each cylinder in turn (the worst of each check)"] * part.engine.tries_all
        if words:
            yield f"{part.name} with {listed(words)}"
