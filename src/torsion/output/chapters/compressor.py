"""Chapter: reciprocating compressors: data sheet, balance of torque, pressures of their ends, harmonics of throws."""

import cmath
import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.compressor.compressor_results import CompressorFound, Compressors
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, KeyValues, Paragraph, Table, table
from torsion.output.chapters.engine import varying
from torsion.output.figures import compressor_curves
from torsion.output.numbers import given, rpm, scale, settled

BAR = 1e-5  # of 1 Pa
SAME_LOAD = 0.05  # relative: how far the torque of the pressures may be from that of the operation


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing without a compressor."""
    found = findings.get(Compressors)
    if found is None or not found.each:
        return
    yield Heading("Compressor" if len(found.each) == 1 else "Compressors")
    for place, compressor in enumerate(found.each):
        if len(found.each) > 1:
            yield Heading(compressor.name, 2)
        yield from _one(compressor, place)


def _one(found: CompressorFound, place: int) -> Iterator[Block]:
    words = (
        ("Compressor", found.name),
        *found.words,
        ("Mechanical efficiency", f"{given(100 * found.efficiency)} %"),
    )
    yield KeyValues(words)
    yield table(
        "number: < Throw | station: < Station | angle: Outer dead centre at [deg]:g | "
        "inertia: Moving masses, mean inertia [kg m²] | mean_torque: Mean gas torque [N m]",
        found.throws,
        f"Throws of {found.name}; the gas absorbs the mean torque",
    )
    if any(one.ends for one in found.throws):
        yield table(
            "< Throw | < End | < Pressures | Area [cm²] | Clearance [%] | Lowest [bar] | Highest [bar] | imep [bar] | "
            "Indicated power [kW]",
            [
                (
                    one.number,
                    end.end,
                    end.given,
                    end.area,
                    end.clearance,
                    end.pressure.min(),
                    end.pressure.max(),
                    end.imep,
                    end.power,
                )
                for one in found.throws
                for end in one.ends
            ],
            f"Ends of the cylinders of {found.name}; absolute pressures; positive imep: the gas absorbs work",
        )
        yield from _balance(found)
        yield compressor_curves.pressures(
            f"compressor-{place + 1}-pressure",
            f"Pressures of {found.name}",
            [
                (f"throw {one.number}, {end.end}", np.degrees(end.angle), end.pressure * BAR)
                for one in found.throws
                for end in one.ends
            ],
        )
    unit = scale("N m", [float(np.abs(found.effort).max())])
    each = {
        f"throw {one.number}": own * unit.factor
        for one, own in zip(found.throws, found.effort, strict=True)
    }
    caption = f"Torque of {found.name} on the crankshaft{_at(found)}, gas and moving masses"
    yield compressor_curves.effort(
        f"compressor-{place + 1}-effort", caption, np.degrees(found.turned), each, unit.unit
    )
    yield _harmonics(found)
    yield from varying(found)


def _at(found: CompressorFound) -> str:
    return "" if found.speed is None else f" at {rpm(found.speed)} rpm"


def _balance(found: CompressorFound) -> Iterator[Block]:
    """The torque of the pressures beside that of the operation."""
    rows = [
        ("Mean torque absorbed by the gas", found.indicated, "N m"),
        ("Shaft torque for it, with the mechanical efficiency", found.needed, "N m"),
        ("Mean torque of the operation", found.mean_torque, "N m"),
    ]
    yield table(
        "< Quantity | Value | < Unit",
        [row for row in rows if row[1] is not None],
        f"Balance of mean torque of {found.name}{_at(found)}",
    )
    if found.mean_torque is None:
        yield Paragraph("The operation has no mean torque to compare with the pressures.", "note")
        return
    off = found.mean_torque / found.needed - 1.0 if found.needed else math.inf
    more = "more" if off > 0 else "less"
    words = f"The torque of the operation is {abs(100 * off):.3g} % {more} than the pressures need"
    if abs(off) > SAME_LOAD:
        yield Paragraph(
            f"{words}. The harmonics follow the pressures, the mean torques follow the operation. One of "
            "them is for another load.",
            "note",
        )
    else:
        yield Paragraph(f"{words}.")


def _harmonics(found: CompressorFound) -> Table:
    """Gas, masses and sum of every throw; the sum of all throws as phasors."""
    largest = max(abs(one.total) for throw in found.throws for one in throw.harmonics)
    several = len(found.throws) > 1
    rows = []
    for place, (order, rigid) in enumerate(enumerate(found.rigid, 1)):
        each = [throw.harmonics[place] for throw in found.throws]
        sizes = [
            settled(abs(part), largest) for one in each for part in (one.gas, one.masses, one.total)
        ]
        size = settled(abs(rigid), largest)
        phase = cmath.phase(rigid) if size else None
        rows.append((order, *sizes, *([size, phase] if several else [])))
    titles = "Order" + "".join(
        f" | Throw {one.number}, gas [N m] | Throw {one.number}, masses [N m] | Throw {one.number}, both [N m]"
        for one in found.throws
    )
    whole = " | All throws [N m] | Phase [deg]:g" if several else ""
    caption = f"Harmonics of {found.name}{_at(found)}: amplitudes by throw"
    return table(
        titles + whole,
        rows,
        caption + (", sum as phasors from reference angle zero" if several else ""),
    )
