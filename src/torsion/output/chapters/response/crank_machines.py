"""Chapters: engines and reciprocating compressors: data sheet, pressures, balance, harmonics, inertia, misfires."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from torsion.analyses.compressor.compressors import CompressorFound, Compressors
from torsion.analyses.engine.engine_results import EngineFound, Engines, misfire_loads
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, table
from torsion.output.figures.curves import span
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.numbers import RPM, given, number, rpm, scale
from torsion.results import listed

BAR = 1e-5  # of 1 Pa
SAME_LOAD = (
    0.05  # relative: how far pressure or torque of the data may be from those of the operation
)
REACHED = 1.2  # of the speed of the tables: ranges that begin above it are not listed
MOST_NAMED = 3  # diagrams whose motored pressures have names of their own
PRESSURE = Axis("pressure, absolute", "bar", low=0.0)
MOST_CURVES = 13  # in the figure, the first with every cylinder firing
STATES = {"motored": "motored (misfire)", "cut out": "cut out"}
SMALL = 1e-3  # of the largest share of the inertia in a mode: less is not listed
INERTIA = "The inertia of crank and rod varies over the revolution; the analyses use its mean. "
INSTABILITY = (
    "If a harmonic of the variation has twice the frequency of a mode, divided by a whole number, the undamped "
    "mode is unstable near this speed. A damping ratio above a quarter of the variation prevents the instability "
    "(first-order estimate)."
)
MISFIRE = (
    "Each cylinder is motored in turn: it compresses without combustion, and its masses keep moving. The other "
    "cylinders keep their gas torque. Damping that depends on the mean torque is unchanged."
)
OTHER_LOAD = " The harmonics follow the pressures, the mean torques follow the operation. One of them is for another load."
NO_TORQUE = "The operation has no mean torque. The gas torque of the file applies at every speed."
HARMONICS = ("gas", "Gas"), ("masses", "Masses"), ("total", "Sum")
POLAR = "{0}: {1}, amplitude [N m]:s | {0}: phase [deg]:gsp"


def engines(findings: Findings) -> Iterator[Block]:
    """Yield the chapter of all engines; nothing without one."""
    result = findings.get(Engines)
    machines = () if result is None else result.each
    for number_of_machine, engine in enumerate(machines, 1):
        yield from _headings("Engine", machines, engine)
        pairs = [("Engine", engine.name), *engine.words, ("Gas torque", engine.gas_words)]
        pairs.append(("Mechanical efficiency", f"{given(100 * engine.efficiency)} %"))
        if engine.inertia:
            what = "Mean inertia of the moving masses of a cylinder"
            pairs.append((what, f"{given(engine.inertia)} kg m²"))
        if engine.stress_modulus is not None:
            modulus = f"{given(engine.stress_modulus * 1e9)} mm³"
            pairs.append(("Minimum section modulus of journal and pin", modulus))
        pairs += _balance(
            engine,
            ("Mean torque", engine.mean_torque, "N m"),
            ("Mean torque with equal firing of all cylinders", engine.balanced_torque, "N m"),
            ("Mean gas torque of a firing cylinder", engine.gas_mean, "N m"),
            ("Indicated mean effective pressure", engine.imep, "bar"),
            ("Indicated mean effective pressure of the gas data", engine.stated, "bar"),
        )
        yield KeyValues(tuple(pairs))
        yield table(
            "number: < Cylinder | station: < Throw | firing: Fires at [deg]:g | state: < State | "
            "share: Heat input / balanced cylinder [%]",
            engine.cylinders,
            f"Cylinders of {engine.name}; crank angle from reference angle zero",
        )
        yield from _engine_notes(engine)
        if engine.curves:
            yield _cycle(engine, number_of_machine)
        yield from _varying_inertia(engine)
        yield from _misfires(findings, engine, number_of_machine)
        if engine.remarks:
            yield Paragraph(" ".join(engine.remarks), "note")


def compressors(findings: Findings) -> Iterator[Block]:
    """Yield the chapter of all compressors; nothing without one."""
    result = findings.get(Compressors)
    machines = () if result is None else result.each
    for number_of_machine, compressor in enumerate(machines, 1):
        yield from _headings("Compressor", machines, compressor)
        balance = _balance(
            compressor,
            ("Mean torque absorbed by the gas", compressor.indicated, "N m"),
            ("Shaft torque for it, with the mechanical efficiency", compressor.needed, "N m"),
            ("Mean torque of the operation", compressor.mean_torque, "N m"),
        )
        efficiency = "Mechanical efficiency", f"{given(100 * compressor.efficiency)} %"
        yield KeyValues((("Compressor", compressor.name), *compressor.words, efficiency, *balance))
        yield table(
            "number: < Throw | station: < Station | angle: Outer dead centre at [deg]:g | "
            "inertia: Moving masses, mean inertia [kg m²] | mean_torque: Mean gas torque [N m]",
            compressor.throws,
            f"Throws of {compressor.name}; the gas absorbs the mean torque",
        )
        ends = [(throw, end) for throw in compressor.throws for end in throw.ends]
        if ends:
            yield table(
                "number: < Throw | end: < End | given: < Pressures | area: Area [cm²] | clearance: Clearance [%] | "
                "lowest: Lowest [bar] | highest: Highest [bar] | imep: imep [bar] | power: Indicated power [kW]",
                ends,
                f"Ends of the cylinders of {compressor.name}; absolute pressures; positive imep: the gas absorbs work",
            )
            # How the torque of the operation differs from the torque that the pressures need.
            if compressor.mean_torque is None:
                text = "The operation has no mean torque to compare with the pressures."
                yield Paragraph(text, "note")
            else:
                needed = compressor.needed
                excess = compressor.mean_torque / needed - 1.0 if needed else math.inf
                text = f"The torque of the operation is {abs(100 * excess):.3g} % "
                text += f"{'more' if excess > 0 else 'less'} than the pressures need."
                is_same = abs(excess) <= SAME_LOAD
                yield Paragraph(
                    text if is_same else text + OTHER_LOAD, "plain" if is_same else "note"
                )
            lines = []
            for pen, (throw, end) in enumerate(ends):
                angle, words = np.degrees(end.angle), f"throw {throw.number}, {end.end}"
                lines.append(Line(words, angle, end.pressure * BAR, pen, weight=1.5))
            x = Axis("crank angle from the dead centre of the head end", "deg")
            panel = Panel(
                span(x, np.concatenate([line.x for line in lines])), PRESSURE, tuple(lines)
            )
            caption = f"Pressures of {compressor.name}"
            yield Figure(f"compressor-{number_of_machine}-pressure", caption, (panel,))
        yield _effort(compressor, number_of_machine)
        yield table(
            "number: Throw | order: Order | gas: Gas [N m]:s | masses: Masses [N m]:s | total: Both [N m]:s | "
            "total: Phase [deg]:gsp",
            [(throw, harmonic) for throw in compressor.throws for harmonic in throw.harmonics],
            f"Harmonics of {compressor.name}{_at_speed(compressor)}: amplitudes by throw; phase from its dead centre",
        )
        yield from _varying_inertia(compressor)


def engine_harmonics(findings: Findings) -> Iterator[Block]:
    """Yield the appendix of the full report: harmonics of a cylinder, and the sums of phasors."""
    result = findings.get(Engines)
    excited = [engine for engine in (() if result is None else result.each) if engine.harmonics]
    if excited:
        yield Heading("Appendix: engine harmonics")
    for engine in excited:
        at_speed = _at_speed(engine)
        if engine.gas_mean is not None:
            at_speed += f" and {number(engine.gas_mean)} N m mean gas torque"
        yield table(
            " | ".join(["order: Order:o", *(POLAR.format(*pair) for pair in HARMONICS)])
            + " | tangential: Sum, tangential [bar]",
            engine.harmonics,
            f"Harmonics of a firing cylinder of {engine.name}{at_speed}; phase at its firing TDC",
        )
        modes = range(1, len(engine.harmonics[0].by_mode) + 1)
        yield table(
            "order: Order:o | rigid: Rigid:s"
            + "".join(f" | by_mode@{mode}: Mode {mode}:s" for mode in modes),
            engine.harmonics,
            f"Sums of phasors over the cylinders of {engine.name}; by mode, weighted with the angle of the throws / its "
            "maximum",
        )


def states(findings: Findings) -> Iterator[str]:
    """Yield the state in which each engine is judged, if not every cylinder fires alike or a phase is free."""
    for part in findings.study.train.parts:
        if part.engine is None:
            continue
        cylinders = part.engine.cylinders
        words = [
            f"cylinder {cylinder.number} {STATES[cylinder.state]}"
            for cylinder in cylinders
            if cylinder.state in STATES
        ]
        firing = [cylinder for cylinder in cylinders if cylinder.state == "firing"]
        for share in dict.fromkeys(cylinder.share for cylinder in firing if cylinder.share != 1.0):
            numbers = [str(cylinder.number) for cylinder in firing if cylinder.share == share]
            named = f"cylinder{'s' * (len(numbers) > 1)} {listed(numbers)}"
            subject = "all others" if words and len(numbers) == len(firing) else named
            words.append(f"{subject} with {100 * share:.4g} % of the heat")
        if part.engine.by_chance:
            words.append("any phase to the rest of the train (magnitudes are added)")
        if part.engine.tries_all:
            words.append("each cylinder in turn (the worst of each check)")
        if words:
            yield f"{part.name} with {listed(words)}"


def _at_speed(machine: EngineFound | CompressorFound) -> str:
    return "" if machine.speed is None else f" at {rpm(machine.speed)} rpm"


def _balance(
    machine: EngineFound | CompressorFound, *pairs: tuple[str, float | None, str]
) -> Iterator[tuple[str, str]]:
    """Yield the mean torques and pressures that are known, for the data sheet."""
    for name, value, unit in pairs:
        if value is not None:
            size = value * BAR if unit == "bar" else value
            yield name + _at_speed(machine), f"{number(size)} {unit}"


def _cycle(engine: EngineFound, number_of_machine: int) -> Figure:
    """Draw pressures and tangential pressures over the crank angle."""
    pressures, tangential = list[Line](), list[Line]()
    for pen, curve in enumerate(engine.curves):
        title = curve.name.replace("`", "") if len(engine.curves) > 1 else "firing"
        motored = f"{title}, motored" if 1 < len(engine.curves) <= MOST_NAMED else "motored"
        angle = np.degrees(curve.angle)
        pressures += [
            Line(title, angle, curve.pressure * BAR, pen, weight=1.5),
            Line(motored, angle, curve.motored * BAR, "pale"),
        ]
        tangential.append(Line(title, angle, curve.tangential * BAR, pen, weight=1.5))
    angles = np.concatenate([line.x for line in tangential])
    x = span(Axis("crank angle from firing top dead centre", "deg"), angles)
    lower, zero = Axis("tangential pressure", "bar"), (Level("", 0.0, "zero"),)
    panels = (
        Panel(x, PRESSURE, tuple(pressures)),
        Panel(x, lower, tuple(tangential), zero, height=70.0),
    )
    caption = f"Pressure of a cylinder of {engine.name}, and tangential pressure of its gas (torque / A r)"
    return Figure(f"engine-{number_of_machine}-pressure", caption, panels)


def _engine_notes(engine: EngineFound) -> Iterator[Paragraph]:
    """Yield how pressures and torques that go together differ from the values of the file."""
    if engine.mean_torque is None and engine.speed is not None:
        yield Paragraph(NO_TORQUE, "note")
    for curve in engine.curves:
        if curve.stated is not None and curve.name.partition(" at ")[0] != "cycle":
            text = f"{curve.name}: imep of the diagram {number(curve.imep * BAR)} bar, "
            yield Paragraph(f"{text}stated {number(curve.stated * BAR)} bar.")
    if engine.imep is not None and engine.stated is not None:
        excess = engine.imep / engine.stated - 1.0
        if abs(excess) > SAME_LOAD:
            yield Paragraph(
                f"The mean torque of the load needs {abs(100 * excess):.3g} % {'more' if excess > 0 else 'less'} mean "
                "pressure than the gas data. The harmonics follow the load as in the data sheet.",
                "note",
            )
    if any(cylinder.state != "firing" for cylinder in engine.cylinders):
        effect = "the mean torque decreases by the share of the cylinders without combustion"
        if engine.keeps_power:
            effect = "the other cylinders compensate those without combustion"
        yield Paragraph(f"{effect.capitalize()}.")


def _varying_inertia(machine: EngineFound | CompressorFound) -> Iterator[Block]:
    """Yield the estimate of parametric resonance, of modes whose inertia varies at all."""
    varying = [mode for mode in machine.varying if mode.share > SMALL]
    if not varying:
        return
    top = math.inf if machine.speed is None else REACHED * machine.speed
    reached = [mode for mode in varying if mode.lower <= top]
    if not reached:
        lowest = rpm(min(mode.lower for mode in varying))
        text = f"The estimated lowest speed of parametric instability of an undamped mode is {lowest} rpm."
        yield Paragraph(INERTIA + text)
        return
    yield Paragraph(INERTIA + INSTABILITY)
    yield table(
        "mode: Mode | harmonic: Harmonic of the revolution | share: Variation [%] | lower: From [rpm] | "
        "upper: To [rpm] | damping: Damping ratio of the mode [%] | is_stable: Stable",
        reached,
        f"Varying inertia of {machine.name}: speed ranges of parametric instability of an undamped mode",
    )


def _misfires(findings: Findings, engine: EngineFound, number_of_machine: int) -> Iterator[Block]:
    """Yield the worst misfire of every element, and curves of the most loaded and of the most raised element."""
    if not engine.misfires:
        return
    loads, torque = misfire_loads(engine, findings.need(Response).system)
    if not loads:
        return
    yield Heading(f"Misfire of each cylinder of {engine.name}", 2)
    yield Paragraph(MISFIRE)
    yield table(
        "component: < Component -> | firing: All firing [~N m]:u -> all firing, ~ | firing_speed: Speed [rpm] | "
        "worst: Worst misfire [~N m]:u -> worst misfire, ~ | speed: Speed [rpm] -> rpm | cylinder: Cylinder -> | "
        "ratio: Ratio:4 | stress: Nominal stress, worst misfire [N/mm²]:?",
        loads,
        f"Misfire of one cylinder of {engine.name}: maximum total vibratory torque of every component",
        short=f"Misfire of one cylinder of {engine.name}",
    )

    unit = scale("N m", [float(torque.max())])
    names = ["all firing", *(f"cylinder {case.cylinder}" for case in engine.misfires[1:])]
    speed = engine.misfires[0].speed * RPM
    most = [
        max(range(len(loads)), key=lambda k: getattr(loads[k], quantity) or 0.0)
        for quantity in ("worst", "ratio")
    ]
    x, y = span(Axis("speed", "rpm"), speed), Axis("torque amplitude", unit.unit, low=0.0)
    for number_drawn, k in enumerate(dict.fromkeys(most), 1):
        lines = [Line(names[0], speed, torque[k, 0] * unit.factor, 0, weight=2.0)]
        for pen, (words, values) in enumerate(
            zip(names[1:MOST_CURVES], torque[k, 1:], strict=False), 1
        ):
            lines.append(Line(words, speed, values * unit.factor, pen, words, label_at="anywhere"))
        name = f"engine-{number_of_machine}-misfires-{number_drawn}"
        caption = f"Vibratory torque in {loads[k].component} with misfire of one cylinder of {engine.name}"
        yield Figure(name, caption, (Panel(x, y, tuple(lines)),))


def _effort(compressor: CompressorFound, number_of_machine: int) -> Figure:
    """Draw the torque of every throw, and their sum with its mean, over the crank angle."""
    unit = scale("N m", [float(np.abs(compressor.effort).max())])
    angle, torques = np.degrees(compressor.turned), compressor.effort * unit.factor
    lines = [
        Line(f"throw {throw.number}", angle, torque, pen)
        for pen, (throw, torque) in enumerate(zip(compressor.throws, torques, strict=True), 1)
    ]
    total = torques.sum(axis=0)
    if len(lines) > 1:
        lines.insert(0, Line("all throws", angle, total, 0, weight=2.0))
    mean = Level("mean", float(total[:-1].mean()), "rated", label="mean")
    x = span(Axis("crank angle from reference angle zero", "deg"), angle)
    panel = Panel(x, Axis("torque", unit.unit), tuple(lines), (Level("", 0.0, "zero"), mean))
    name, words = f"compressor-{number_of_machine}-effort", _at_speed(compressor)
    caption = f"Torque of {compressor.name} on the crankshaft{words}, gas and moving masses"
    return Figure(name, caption, (panel,))


def _headings(
    title: str,
    machines: Sequence[EngineFound | CompressorFound],
    machine: EngineFound | CompressorFound,
) -> Iterator[Heading]:
    """Yield that of the chapter before the first machine, and its name where there are several."""
    if machine is machines[0]:
        yield Heading(title if len(machines) == 1 else f"{title}s")
    if len(machines) > 1:
        yield Heading(machine.name, 2)
