"""Chapters: engines and reciprocating compressors: data sheet, pressures, balance, harmonics, inertia, misfires."""

import cmath
import math
from collections.abc import Callable, Iterator
from typing import TypeVar

import numpy as np

from torsion.analyses.compressor.compressors import CompressorFound, Compressors
from torsion.analyses.engine.engine_results import EngineFound, Engines
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Table, table
from torsion.output.figures import crank_curves
from torsion.output.numbers import RPM, given, number, rpm, scale, settled
from torsion.output.selection import elements, worst
from torsion.results import listed

Machine = TypeVar("Machine", EngineFound, CompressorFound)
BAR = 1e-5  # of 1 Pa
MODES = ("first", "second", "third")
SAME_LOAD = (
    0.05  # relative: how far pressure or torque of the data may be from those of the operation
)
REACHED = 1.2  # of the speed of the tables: ranges that begin above it are not listed
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


def engines(findings: Findings) -> Iterator[Block]:
    """Yield the chapter of all engines; nothing without one."""
    result = findings.get(Engines)

    def engine_blocks(engine: EngineFound, number_of_machine: int) -> Iterator[Block]:
        yield KeyValues(tuple(_engine_sheet(engine)))
        yield table(
            "number: < Cylinder | station: < Throw | firing: Fires at [deg]:g | state: < State | "
            "share: Heat input / balanced cylinder [%]",
            engine.cylinders,
            f"Cylinders of {engine.name}; crank angle from reference angle zero",
        )
        yield from _engine_balance(engine)
        if engine.curves:
            caption = f"Pressure of a cylinder of {engine.name}, and tangential pressure of its gas (torque / A r)"
            yield crank_curves.diagram(
                f"engine-{number_of_machine}-pressure", caption, engine.curves
            )
        yield from _varying_inertia(engine)
        yield from _misfires(findings, engine, number_of_machine)
        if engine.remarks:
            yield Paragraph(" ".join(engine.remarks), "note")

    yield from _machines("Engine", () if result is None else result.each, engine_blocks)


def compressors(findings: Findings) -> Iterator[Block]:
    """Yield the chapter of all compressors; nothing without one."""
    result = findings.get(Compressors)
    yield from _machines("Compressor", () if result is None else result.each, _compressor_blocks)


def engine_harmonics(findings: Findings) -> Iterator[Block]:
    """Yield the appendix of the full report: harmonics of a cylinder, and the sums of phasors."""
    result = findings.get(Engines)
    excited = [engine for engine in (() if result is None else result.each) if engine.harmonics]
    if excited:
        yield Heading("Appendix: engine harmonics")
    for place, engine in enumerate(excited, 1):
        yield _cylinder_harmonics(engine)
        orders = np.array([float(harmonic.order) for harmonic in engine.harmonics])
        sizes = {
            name: np.abs([getattr(harmonic, quantity) for harmonic in engine.harmonics])
            for name, quantity in (("sum", "total"), ("gas", "gas"), ("masses", "masses"))
        }
        caption = f"Harmonics of the torque of a firing cylinder of {engine.name}"
        yield crank_curves.harmonics(f"engine-{place}-harmonics", caption, orders, sizes, "N m")
        yield _phasor_sums(engine)


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


def _machines(
    title: str, machines: tuple[Machine, ...], blocks: Callable[[Machine, int], Iterator[Block]]
) -> Iterator[Block]:
    """Yield the heading and the blocks of every machine, under its name where there are several."""
    if machines:
        yield Heading(title if len(machines) == 1 else f"{title}s")
    for number_of_machine, machine in enumerate(machines, 1):
        if len(machines) > 1:
            yield Heading(machine.name, 2)
        yield from blocks(machine, number_of_machine)


def _at_speed(machine: EngineFound | CompressorFound) -> str:
    return "" if machine.speed is None else f" at {rpm(machine.speed)} rpm"


def _balance(machine: EngineFound | CompressorFound, *rows: tuple[str, float | None, str]) -> Table:
    """Return the table of mean torques and pressures that are known."""
    return table(
        "< Quantity | Value | < Unit",
        [row for row in rows if row[1] is not None],
        f"Balance of mean torque of {machine.name}{_at_speed(machine)}",
    )


def _polar(value: complex, largest: float) -> tuple[float, float | None]:
    """Return amplitude and phase (rad); no phase of what is rounding compared with the largest."""
    size = settled(abs(value), largest)
    return size, cmath.phase(value) if size else None


def _engine_sheet(engine: EngineFound) -> Iterator[tuple[str, str]]:
    yield "Engine", engine.name
    yield from engine.words
    yield "Gas torque", engine.gas_words
    yield "Mechanical efficiency", f"{given(100 * engine.efficiency)} %"
    if engine.inertia:
        yield "Mean inertia of the moving masses of a cylinder", f"{given(engine.inertia)} kg m²"
    if engine.stress_modulus is not None:
        modulus = f"{given(engine.stress_modulus * 1e9)} mm³"
        yield "Minimum section modulus of journal and pin", modulus


def _engine_balance(engine: EngineFound) -> Iterator[Block]:
    """Yield mean torque and mean pressure that go together, and how they differ from the values of the file."""
    if engine.mean_torque is not None:
        gas = "Indicated mean effective pressure"
        yield _balance(
            engine,
            ("Mean torque", engine.mean_torque, "N m"),
            ("Mean torque with equal firing of all cylinders", engine.balanced_torque, "N m"),
            ("Mean gas torque of a firing cylinder", engine.gas_mean, "N m"),
            (gas, engine.imep and engine.imep * BAR, "bar"),
            (f"{gas} of the gas data", engine.stated and engine.stated * BAR, "bar"),
        )
    elif engine.speed is not None:
        text = (
            "The operation has no mean torque. The gas torque of the file applies at every speed."
        )
        yield Paragraph(text, "note")
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
    idle = [
        f"{cylinder.number} ({cylinder.state})"
        for cylinder in engine.cylinders
        if cylinder.state != "firing"
    ]
    if idle:
        effect = "the mean torque decreases by their share"
        if engine.keeps_power:
            effect = "the other cylinders compensate"
        yield Paragraph(f"Cylinders without combustion: {', '.join(idle)}; {effect}.")


def _cylinder_harmonics(engine: EngineFound) -> Table:
    largest = max(abs(harmonic.total) for harmonic in engine.harmonics)
    load = "" if engine.gas_mean is None else f" and {number(engine.gas_mean)} N m mean gas torque"
    polar = "amplitude [N m] | phase [deg]:g"
    return table(
        f"Order:o | Gas, {polar} | Masses, {polar} | Sum, {polar} | Sum, tangential [bar]",
        [
            (
                harmonic.order,
                *_polar(harmonic.gas, largest),
                *_polar(harmonic.masses, largest),
                *_polar(harmonic.total, largest),
                harmonic.tangential,
            )
            for harmonic in engine.harmonics
        ],
        f"Harmonics of a firing cylinder of {engine.name}{_at_speed(engine)}{load}; phase at its firing TDC",
    )


def _phasor_sums(engine: EngineFound) -> Table:
    count = len(engine.cylinders)
    modes = "".join(
        f" | {word.capitalize()} mode" for word in MODES[: len(engine.harmonics[0].by_mode)]
    )
    return table(
        f"Order:o | Rigid{modes} | < ",
        [
            (
                harmonic.order,
                *(settled(value, count) for value in (harmonic.rigid, *harmonic.by_mode)),
                "major" if harmonic.rigid > (1.0 - SMALL) * count else "",
            )
            for harmonic in engine.harmonics
        ],
        f"Sums of phasors over the cylinders of {engine.name}; by mode, weighted with the angle of the throws / its "
        "maximum",
    )


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
        "Mode | Harmonic of the revolution | Variation [%] | From [rpm] | To [rpm] | Damping ratio of the mode [%] | "
        "Required damping ratio [%] | < Estimate",
        [
            (
                mode.mode,
                mode.harmonic,
                mode.share,
                mode.lower,
                mode.upper,
                mode.damping,
                mode.share / 4.0,
                "stable" if mode.is_stable else "check",
            )
            for mode in reached
        ],
        f"Varying inertia of {machine.name}: speed ranges of parametric instability of an undamped mode",
    )


def _misfires(findings: Findings, engine: EngineFound, number_of_machine: int) -> Iterator[Block]:
    """Yield the worst misfire of every element, and curves of the most loaded and of the most raised element."""
    if not engine.misfires:
        return
    system = findings.need(Response).system
    elastic = [element for element in elements(system) if system.flexibility[element.spans[0]] > 0]
    if not elastic:
        return
    torque = np.array(
        [[element.largest(case.half_range) for element in elastic] for case in engine.misfires]
    )  # (cases, elements, speeds) N m
    peaks, speed = torque.max(axis=2), engine.misfires[0].speed
    bad = 1 + peaks[1:].argmax(axis=0)  # (elements,) case
    highest = peaks.max(axis=0, where=np.arange(len(peaks))[:, None] > 0, initial=0.0)
    ratio = np.divide(highest, peaks[0], out=np.zeros_like(highest), where=peaks[0] > 0)

    yield Heading(f"Misfire of each cylinder of {engine.name}", 2)
    yield Paragraph(MISFIRE)
    cranks = [element.kind == "crank" and engine.stress_modulus is not None for element in elastic]
    rows = []
    for k, element in enumerate(elastic):
        stress = highest[k] / engine.stress_modulus if cranks[k] and engine.stress_modulus else None
        rows.append(
            (
                element.name,
                *worst(torque[0, k], speed),
                *worst(torque[bad[k], k], speed),
                f"no. {engine.misfires[bad[k]].cylinder}",
                ratio[k] or None,
                *[stress] * any(cranks),
            )
        )
    yield table(
        "< Component -> | All firing [~N m] -> all firing, ~ | Speed [rpm] | Worst misfire [~N m] -> worst misfire, ~ | "
        "Speed [rpm] -> rpm | < Cylinder -> | Ratio:4"
        + " | Nominal stress, worst misfire [N/mm²]"
        * any(cranks),
        rows,
        f"Misfire of one cylinder of {engine.name}: maximum total vibratory torque of every component",
        short=f"Misfire of one cylinder of {engine.name}",
    )

    unit = scale("N m", [float(max(case.half_range.max() for case in engine.misfires))])
    names = ["all firing", *(f"cylinder {case.cylinder}" for case in engine.misfires[1:])]
    for number_drawn, k in enumerate(
        dict.fromkeys([int(highest.argmax()), int(ratio.argmax())]), 1
    ):
        yield crank_curves.misfires(
            f"engine-{number_of_machine}-misfires-{number_drawn}",
            f"Vibratory torque in {elastic[k].name} with misfire of one cylinder of {engine.name}",
            speed * RPM,
            dict(zip(names[:MOST_CURVES], torque[:MOST_CURVES, k] * unit.factor, strict=True)),
            unit.unit,
        )


def _compressor_blocks(compressor: CompressorFound, number_of_machine: int) -> Iterator[Block]:
    efficiency = "Mechanical efficiency", f"{given(100 * compressor.efficiency)} %"
    yield KeyValues((("Compressor", compressor.name), *compressor.words, efficiency))
    yield table(
        "number: < Throw | station: < Station | angle: Outer dead centre at [deg]:g | "
        "inertia: Moving masses, mean inertia [kg m²] | mean_torque: Mean gas torque [N m]",
        compressor.throws,
        f"Throws of {compressor.name}; the gas absorbs the mean torque",
    )
    ends = [(throw.number, end) for throw in compressor.throws for end in throw.ends]
    if ends:
        yield table(
            "< Throw | < End | < Pressures | Area [cm²] | Clearance [%] | Lowest [bar] | Highest [bar] | imep [bar] | "
            "Indicated power [kW]",
            [
                (
                    throw,
                    end.end,
                    end.given,
                    end.area,
                    end.clearance,
                    end.pressure.min(),
                    end.pressure.max(),
                    end.imep,
                    end.power,
                )
                for throw, end in ends
            ],
            f"Ends of the cylinders of {compressor.name}; absolute pressures; positive imep: the gas absorbs work",
        )
        yield from _compressor_balance(compressor)
        yield crank_curves.pressures(
            f"compressor-{number_of_machine}-pressure",
            f"Pressures of {compressor.name}",
            [
                (f"throw {throw}, {end.end}", np.degrees(end.angle), end.pressure * BAR)
                for throw, end in ends
            ],
        )
    unit = scale("N m", [float(np.abs(compressor.effort).max())])
    names = [f"throw {throw.number}" for throw in compressor.throws]
    yield crank_curves.effort(
        f"compressor-{number_of_machine}-effort",
        f"Torque of {compressor.name} on the crankshaft{_at_speed(compressor)}, gas and moving masses",
        np.degrees(compressor.turned),
        dict(zip(names, compressor.effort * unit.factor, strict=True)),
        unit.unit,
    )
    yield _throw_harmonics(compressor)
    yield from _varying_inertia(compressor)


def _compressor_balance(compressor: CompressorFound) -> Iterator[Block]:
    """Yield the torque that the pressures need, and how the torque of the operation differs from it."""
    yield _balance(
        compressor,
        ("Mean torque absorbed by the gas", compressor.indicated, "N m"),
        ("Shaft torque for it, with the mechanical efficiency", compressor.needed, "N m"),
        ("Mean torque of the operation", compressor.mean_torque, "N m"),
    )
    if compressor.mean_torque is None:
        yield Paragraph("The operation has no mean torque to compare with the pressures.", "note")
        return
    excess = compressor.mean_torque / compressor.needed - 1.0 if compressor.needed else math.inf
    text = f"The torque of the operation is {abs(100 * excess):.3g} % {'more' if excess > 0 else 'less'} than the "
    text += "pressures need."
    if abs(excess) <= SAME_LOAD:
        yield Paragraph(text)
        return
    text += " The harmonics follow the pressures, the mean torques follow the operation. One of them is for another load."
    yield Paragraph(text, "note")


def _throw_harmonics(compressor: CompressorFound) -> Table:
    """Return gas, masses and sum of every throw by order, and the sum of several throws as phasors."""
    throws, several = compressor.throws, len(compressor.throws) > 1
    largest = max(abs(harmonic.total) for throw in throws for harmonic in throw.harmonics)
    rows = []
    for k, rigid in enumerate(compressor.rigid):
        sizes = [
            settled(abs(part), largest)
            for harmonic in (throw.harmonics[k] for throw in throws)
            for part in (harmonic.gas, harmonic.masses, harmonic.total)
        ]
        rows.append((k + 1, *sizes, *(_polar(rigid, largest) if several else ())))
    titles = [
        f"Throw {throw.number}, {part} [N m]"
        for throw in throws
        for part in ("gas", "masses", "both")
    ]
    if several:
        titles += ["All throws [N m]", "Phase [deg]:g"]
    caption = f"Harmonics of {compressor.name}{_at_speed(compressor)}: amplitudes by throw"
    caption += ", sum as phasors from reference angle zero" if several else ""
    return table(" | ".join(["Order", *titles]), rows, caption)
