"""Chapter: the mass-elastic system, with the source of every figure."""

import math

import numpy as np

from torsion.analyses.discretisation import has_inertia
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, head
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import NONE, exact, given, number, scale
from torsion.primitives import Bar, SectionMesh


def chapter(findings: Findings) -> list[Block]:
    """Inertias, elastic elements, dimensions of shafts."""
    blocks: list[Block] = [
        Heading("Mass-elastic system"),
        Paragraph(
            "Own: at the component's own speed. Referred: to the speed of the reference component, that is J i² and "
            f"k i² with i the speed ratio of the table. {_distributed(findings)}"
        ),
        *([_inertias(findings), *_water(findings)] if has_inertia(findings.system) else []),
        _springs(findings),
    ]
    if findings.study.train.bars:
        blocks.append(_shafts(findings))
    return blocks


def _distributed(findings: Findings) -> str:
    """Where the tables put the inertia of the shafts, in a sentence."""
    if findings.system.bars is None:
        return "A shaft's distributed inertia is lumped at the ends of its segments."
    return (
        "A shaft's inertia is distributed along it; of each of its pieces these tables show half at either end, and "
        "the static flexibility."
    )


def _source(findings: Findings, part: int) -> str:
    return findings.study.train.parts[part].source or "input"


def _inertias(findings: Findings) -> Table:
    system = findings.system
    concentrated = np.zeros(len(system.stations))
    for lump in system.train.inertias:
        concentrated[lump.station] += lump.inertia
    rows: list[tuple[str, ...]] = []
    for index in range(len(system.train.stations)):
        station, inertia = system.stations[index], float(system.inertia[index])
        if station.is_ground or (inertia == 0 and not concentrated[index]):
            continue
        held = math.isinf(inertia)
        ratio = float(station.ratio)
        rows.append((
            str(len(rows) + 1), station.name, "held" if held else given(float(concentrated[index]), 6),
            "held" if held else number(inertia, 6), exact(station.ratio),
            "held" if held else number(inertia * ratio**2, 6), _source(findings, station.part),
        ))  # fmt: skip
    columns = head(
        "No. | < Station | J given, own [kg m²] | J with shaft share, own [kg m²] | Speed ratio i | "
        "J referred [kg m²] | < Source"
    )
    return Table(columns, tuple(rows), "Inertias")


def _water(findings: Findings) -> list[Block]:
    """What entrained water adds to the propellers, in a sentence each."""
    stated = []
    for part in findings.study.train.parts:
        if part.propeller is None:
            continue
        dry, entrained = part.propeller.inertia, part.propeller.water
        water = entrained or 0.0
        share = f"{given(100 * water / dry, 4)} % of dry" if dry else "dry inertia 0"
        sum_ = f"{given(dry, 6)} dry + {given(water, 6)} entrained water = {given(dry + water, 6)} kg m² ({share})"
        stated.append(f"{part.name}: J {sum_ if entrained is not None else 'dry, no entrained water is given'}.")
    return [Paragraph(" ".join(stated))] if stated else []


def _springs(findings: Findings) -> Table:
    system = findings.system
    found = elements(system)
    flexibility = [float(system.flexibility[list(element.spans)].sum()) for element in found]
    unit = scale("N m/rad", [1 / h for h in flexibility if 0 < h < math.inf])
    rows = []
    for element, h in zip(found, flexibility, strict=True):
        own = "rigid" if h == 0 else NONE if math.isinf(h) else unit.text(1 / h, 6)
        referred = "rigid" if h == 0 else NONE if math.isinf(h) else unit.text(element.ratio**2 / h, 6)
        ratio = system.stations[system.spans[element.spans[0]].driving].ratio
        rows.append((
            element.name, element.kind, _between(findings, element), own, "0" if h == 0 else number(h, 6), exact(ratio),
            referred, *_losses(findings, element), _source(findings, element.part),
        ))  # fmt: skip
    columns = head(
        f"< Element | < Kind | < Between | k own [{unit.unit}] | Flexibility own [rad/(N m)] | i | "
        f"k referred [{unit.unit}] | Loss factor | Viscous [N m s/rad] | < Source"
    )
    return Table(columns, tuple(rows), "Elastic elements")


def _between(findings: Findings, element: Element) -> str:
    system = findings.system
    first, last = system.spans[element.spans[0]], system.spans[element.spans[-1]]
    return f"{system.stations[first.driving].name} – {system.stations[last.driven].name}"


def _losses(findings: Findings, element: Element) -> tuple[str, str]:
    system, first = findings.system, element.spans[0]
    return tuple(given(float(v[first])) if v[first] else NONE for v in (system.loss_factor, system.viscous))  # type: ignore[return-value]


def _shafts(findings: Findings) -> Table:
    rows = []
    for requested, bar in zip(findings.study.train.bars, findings.system.train.bars, strict=True):
        material = findings.study.train.shaft(requested).material
        modulus, is_round = stress_modulus(bar) * 1e9, requested.section is None
        rows.append((
            bar.name, requested.section.file if isinstance(requested.section, SectionMesh) else _diameters(bar.outer),
            _diameters(bar.bore) if is_round else NONE, given(bar.length * 1e3), number(modulus),
            number(_inertia(findings, bar), 6), material, given(requested.shear_modulus / 1e9),
            given(bar.density), str(findings.system.segments.get(bar.name, 1)), _source(findings, bar.part),
        ))  # fmt: skip
    columns = head(
        "< Shaft | d [mm] | d_{i} [mm] | Length [mm] | W_{p} [mm³] | J of the shaft [kg m²] | < Material | G [GPa] | "
        f"ρ [kg/m³] | {_pieces(findings)} | < Source"
    )
    return Table(columns, tuple(rows), "Dimensions of the shafts (of a cone, the smallest W_{p})")


def _pieces(findings: Findings) -> str:
    return {"lumped": "Segments", "fem": "Elements"}.get(findings.system.model, "Pieces")


def _diameters(ends: tuple[float, float]) -> str:
    words = [given(1e3 * end) for end in ends]
    return words[0] if ends[0] == ends[1] else "–".join(words)


def _inertia(findings: Findings, bar: Bar) -> float:
    """kg m2, from the lumps of its segments."""
    from torsion.assembly.shafts import bar_segments

    return float(bar_segments(bar, findings.system.segments.get(bar.name, 1))[1].sum())
