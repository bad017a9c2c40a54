"""Chapter: the mass-elastic system, with the source of every figure."""

import math
from collections.abc import Iterator

import numpy as np

from torsion.analyses.discretisation import has_inertia
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, exact, given, number, scale
from torsion.output.selection import elements
from torsion.primitives import SectionMesh


def chapter(findings: Findings) -> Iterator[Block]:
    """Inertias, elastic elements, dimensions of shafts."""
    where = (
        "A shaft's distributed inertia is lumped at the ends of its segments."
        if findings.system.bars is None
        else "A shaft's inertia is distributed along it; of each of its pieces these tables show half at either end, "
        "and the static flexibility."
    )
    yield Heading("Mass-elastic system")
    yield Paragraph(
        "Own: at the component's own speed. Referred: to the speed of the reference component, that is J i² and "
        f"k i² with i the speed ratio of the table. {where}"
    )
    if has_inertia(findings.system):
        yield _inertias(findings)
        if water := " ".join(_water(findings)):
            yield Paragraph(water)
    yield _springs(findings)
    if findings.study.train.bars:
        yield _shafts(findings)


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
        own, whole, referred = ["held"] * 3
        if math.isfinite(inertia):
            own, whole = given(float(concentrated[index]), 6), number(inertia, 6)
            referred = number(inertia * float(station.ratio) ** 2, 6)
        source = _source(findings, station.part)
        rows.append((str(len(rows) + 1), station.name, own, whole, exact(station.ratio), referred, source))
    return table(
        "No. | < Station | J given, own [kg m²] | J with shaft share, own [kg m²] | Speed ratio i | "
        "J referred [kg m²] | < Source",
        rows,
        "Inertias",
    )


def _water(findings: Findings) -> Iterator[str]:
    """What entrained water adds to the propellers, in a sentence each."""
    for part in findings.study.train.parts:
        if part.propeller is None:
            continue
        dry, entrained = part.propeller.inertia, part.propeller.water
        water = entrained or 0.0
        share = f"{given(100 * water / dry, 4)} % of dry" if dry else "dry inertia 0"
        sum_ = f"{given(dry, 6)} dry + {given(water, 6)} entrained water = {given(dry + water, 6)} kg m² ({share})"
        yield f"{part.name}: J {sum_ if entrained is not None else 'dry, no entrained water is given'}."


def _springs(findings: Findings) -> Table:
    system = findings.system
    found = [(element, float(system.flexibility[list(element.spans)].sum())) for element in elements(system)]
    unit = scale("N m/rad", [1 / h for _, h in found if 0 < h < math.inf])
    rows = []
    for element, h in found:
        first, last = system.spans[element.spans[0]], system.spans[element.spans[-1]]
        own = referred = "rigid" if h == 0 else NONE
        if 0 < h < math.inf:
            own, referred = unit.text(1 / h, 6), unit.text(element.ratio**2 / h, 6)
        losses = (float(law[element.spans[0]]) for law in (system.loss_factor, system.viscous))
        rows.append((
            element.name, element.kind, f"{system.stations[first.driving].name} – {system.stations[last.driven].name}",
            own, number(h, 6), system.stations[first.driving].ratio, referred,
            *(given(value) if value else NONE for value in losses), _source(findings, element.part),
        ))  # fmt: skip
    return table(
        f"< Element | < Kind | < Between | k own [{unit.unit}] | Flexibility own [rad/(N m)] | i | "
        f"k referred [{unit.unit}] | Loss factor | Viscous [N m s/rad] | < Source",
        rows,
        "Elastic elements",
    )


def _shafts(findings: Findings) -> Table:
    from torsion.assembly.shafts import bar_segments

    rows = []
    for requested, bar in zip(findings.study.train.bars, findings.system.train.bars, strict=True):
        material, pieces = findings.study.train.shaft(requested).material, findings.system.segments.get(bar.name, 1)
        inertia = float(bar_segments(bar, pieces)[1].sum())  # kg m2, from the lumps of its segments
        modulus, is_round = stress_modulus(bar) * 1e9, requested.section is None
        rows.append((
            bar.name, requested.section.file if isinstance(requested.section, SectionMesh) else _diameters(bar.outer),
            _diameters(bar.bore) if is_round else NONE, given(bar.length * 1e3), number(modulus), number(inertia, 6),
            material, given(requested.shear_modulus / 1e9), given(bar.density), str(pieces),
            _source(findings, bar.part),
        ))  # fmt: skip
    divided = {"lumped": "Segments", "fem": "Elements"}.get(findings.system.model, "Pieces")
    return table(
        "< Shaft | d [mm] | d_{i} [mm] | Length [mm] | W_{p} [mm³] | J of the shaft [kg m²] | < Material | G [GPa] | "
        f"ρ [kg/m³] | {divided} | < Source",
        rows,
        "Dimensions of the shafts (of a cone, the smallest W_{p})",
    )


def _diameters(ends: tuple[float, float]) -> str:
    return "–".join(dict.fromkeys(given(1e3 * end) for end in ends))
