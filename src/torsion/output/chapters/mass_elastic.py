"""Appendix: the mass-elastic system."""

import math
from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction
from typing import Any

from torsion.analyses.discretisation import has_inertia
from torsion.assembly.section.solved_sections import stress_modulus
from torsion.errors import without_controls
from torsion.findings import Findings
from torsion.output.blocks import Block, Heading, Paragraph, Table, table
from torsion.output.numbers import NONE, exact, given, number, scale, symbols
from torsion.output.selection import elements
from torsion.primitives import Bar, Inertia, SectionMesh, Station
from torsion.results import listed

MM = 1e-3  # m
DIGITS, SUMMED = (
    8,
    7,
)  # significant digits of a figure as given, and of what follows from such figures
HELD = "fixed"  # in place of an inertia, where the motion is exactly the mean one


def chapter(findings: Findings) -> Iterator[Block]:
    """Inertias, elastic elements, dimensions of shafts."""
    where = (
        "The inertia of a shaft is lumped at the ends of its segments."
        if findings.system.bars is None
        else "The inertia of a shaft is distributed. The tables give half of each segment to each end, and the static "
        "flexibility."
    )
    yield Heading("Appendix: mass-elastic system")
    yield Paragraph(
        "Own: at the speed of the component. Referred: to the reference speed, J i² and k i² with the speed ratio i. "
        "Given: as in the model file, if a value is referred there. "
        f"{where}"
    )
    yield from _remarks(findings)
    if has_inertia(findings.system):
        yield _inertias(findings)
        if water := " ".join(_water(findings)):
            yield Paragraph(water)
    yield _springs(findings)
    if findings.study.train.bars:
        yield _shafts(findings)


def _remarks(findings: Findings) -> Iterator[Paragraph]:
    """What components stand for, where that is not what the file says alone."""
    named: dict[str, list[str]] = {}
    for part in findings.study.train.parts:
        if part.remark:
            named.setdefault(part.remark, []).append(part.name)
    for remark, names in named.items():
        yield Paragraph(f"{listed(names)}: {symbols(remark)}.", "note")


def _inertias(findings: Findings) -> Table:
    """The inertias of every station as given, one a row, and their sum; then the inertia inside of shafts."""
    system, given_by = findings.system, _given_by_station(findings)
    rows: list[tuple[Any, ...]] = []
    referred: list[float] = []  # kg m2 of every row but the sums
    for index, station in enumerate(system.train.stations):
        mine = [] if station.is_ground else given_by.get(index, [])
        rows += [_inertia(findings, station, lump) for lump in mine]
        referred += [lump.inertia * float(station.ratio) ** 2 for lump in mine]
        if len(mine) > 1:
            rows.append(
                (
                    station.name,
                    "sum",
                    *_given_columns(findings),
                    *_both(system.inertia[index], station),
                )
            )
    for bar, (_, inner, _) in _lumps(findings):
        if inner:
            inside = replace(system.train.stations[bar.driving], name=f"{bar.name}, inside")
            referred.append(inner * float(inside.ratio) ** 2)
            rows.append(
                _inertia(findings, inside, Inertia(bar.driving, inner, bar.part, "between ends"))
            )
    total = number(sum(filter(math.isfinite, referred)), SUMMED)
    rows.append(("whole train", "sum", *_given_columns(findings), NONE, NONE, total))
    columns = "J given [kg m²] | Given at i | " if findings.study.train.has_referred_figures else ""
    return table(
        f"< Station | < Inertia of | {columns}J own [kg m²] | Speed ratio i | J referred [kg m²]",
        rows,
        "Inertias as given, and their sums",
    )


def _inertia(findings: Findings, station: Station, lump: Inertia) -> tuple[Any, ...]:
    """A row of an inertia that a component gives a station."""
    part = findings.study.train.parts[lump.part]
    given_ratio = (
        part.ratio if part.referred_to is None else part.referred_to
    )  # of the driven wheel of a gear: its driving side
    given_ratio = station.ratio if lump.given == lump.inertia else given_ratio
    name = f"{part.name}, {lump.what}" if lump.what else part.name
    figure = _given_columns(findings, lump.given, given_ratio)
    return station.name, name, *figure, *_both(lump.inertia, station)


def _both(inertia: float, station: Station) -> tuple[str, Fraction, str]:
    """An inertia (kg m2) at its own speed, the speed ratio, and the inertia referred."""
    if math.isinf(inertia):
        return HELD, station.ratio, HELD
    return (
        given(inertia, DIGITS),
        station.ratio,
        number(inertia * float(station.ratio) ** 2, SUMMED),
    )


def _given_columns(
    findings: Findings, figure: float = math.nan, ratio: Fraction = Fraction(1)
) -> tuple[str, ...]:
    """An inertia, or stiffness, of the file and the speed ratio at which it is given; of a sum or a fixed end none."""
    if not findings.study.train.has_referred_figures:
        return ()
    return (given(figure, DIGITS), exact(ratio)) if math.isfinite(figure) else (NONE, NONE)


def _lumps(findings: Findings) -> Iterator[tuple[Bar, tuple[float, float, float]]]:
    """Yield every shaft with its inertia (kg m2) at its driving end, between its ends and at its driven end."""
    from torsion.assembly.shafts import bar_segments

    for bar in findings.system.train.bars:
        lumps = bar_segments(bar, findings.system.segments[bar.name])[1]
        yield bar, (float(lumps[0]), float(lumps[1:-1].sum()), float(lumps[-1]))


def _given_by_station(findings: Findings) -> dict[int, list[Inertia]]:
    """By station: what components give it, then what the shafts that end there do."""
    lumps_by_station: dict[int, list[Inertia]] = {}
    for lump in findings.system.train.inertias:
        lumps_by_station.setdefault(lump.station, []).append(lump)
    for bar, (driving, _, driven) in _lumps(findings):
        for station, share, what in (
            (bar.driving, driving, "driving end"),
            (bar.driven, driven, "driven end"),
        ):
            if share:
                lumps_by_station.setdefault(station, []).append(
                    Inertia(station, share, bar.part, what)
                )
    return lumps_by_station


def _water(findings: Findings) -> Iterator[str]:
    """What entrained water adds to propellers, and to pumps and fans that have it, in a sentence each."""
    parts = findings.study.train.parts
    for name, dry, water in (
        (p.name, p.impeller.inertia, p.impeller.water)
        for p in parts
        if p.impeller is not None and (p.propeller is not None or p.impeller.water is not None)
    ):
        words = "dry, no entrained water in the input"
        if water is not None:
            share = f"{given(100 * water / dry, 4)} % of dry" if dry else "dry inertia 0"
            words = f"{given(dry, 6)} dry + {given(water, 6)} entrained water = {given(dry + water, 6)} kg m² ({share})"
        yield f"{name}: J {words}."


def _springs(findings: Findings) -> Table:
    system = findings.system
    springs = [
        (element, float(system.flexibility[list(element.spans)].sum()))
        for element in elements(system)
    ]
    unit = scale("N m/rad", [1 / h for _, h in springs if 0 < h < math.inf])
    rows = []
    for element, h in springs:
        first, last = system.spans[element.spans[0]], system.spans[element.spans[-1]]
        own_stiffness = referred = "rigid" if h == 0 else NONE
        if 0 < h < math.inf:
            own_stiffness, referred = (
                given(unit.factor / h, DIGITS),
                given(unit.factor * element.ratio**2 / h, SUMMED),
            )
        flexibility = given(h, DIGITS)
        tabled = system.tables.get(element.spans[0])
        if tabled is not None:
            own_stiffness = referred = tabled.follows
            flexibility = own_stiffness
        ratio, part = system.stations[first.driving].ratio, system.train.parts[element.part]
        given_ratio = ratio if part.referred_to is None else part.referred_to
        is_given = (
            0 < h < math.inf and not part.is_bar and tabled is None
        )  # of a shaft the file gives dimensions
        figure = _given_columns(
            findings,
            unit.factor / h * float(ratio / given_ratio) ** 2 if is_given else math.nan,
            given_ratio,
        )
        rows.append(
            (
                element.name,
                f"{system.stations[first.driving].name} – {system.stations[last.driven].name}",
                *figure,
                own_stiffness,
                flexibility,
                ratio,
                referred,
            )
        )
    columns = (
        f"k given [{unit.unit}] | Given at i | "
        if findings.study.train.has_referred_figures
        else ""
    )
    return table(
        f"< Component | < Between | {columns}k own [{unit.unit}] | Flexibility own [rad/(N m)] | i | "
        f"k referred [{unit.unit}]",
        rows,
        "Elastic elements",
    )


def _shafts(findings: Findings) -> Table:
    rows, inertias = [], [sum(lumps) for _, lumps in _lumps(findings)]
    for requested, bar, inertia in zip(
        findings.study.train.bars, findings.system.train.bars, inertias, strict=True
    ):
        material, pieces = (
            findings.study.train.shaft(requested).material,
            findings.system.segments[bar.name],
        )
        declared_material = findings.study.train.materials[
            material
        ]  # a hub or a step raises the G of the calculation
        modulus, is_round = stress_modulus(bar) / MM**3, requested.section is None
        section = requested.section
        rows.append(
            (
                bar.name,
                without_controls(section.file)
                if isinstance(section, SectionMesh)
                else _diameters(bar.outer),
                _diameters(bar.bore) if is_round else NONE,
                given(bar.length / MM, DIGITS),
                number(modulus, SUMMED),
                given(inertia, DIGITS),
                material,
                given(declared_material.shear_modulus * 1e-9, DIGITS),
                given(bar.density, DIGITS),
                str(pieces),
            )
        )
    divided = {"lumped": "Segments", "fem": "Elements"}.get(findings.system.model, "Pieces")
    return table(
        "< Shaft | d [mm] | d_{i} [mm] | Length [mm] | W_{p} [mm³] | J of the shaft [kg m²] | < Material | G [GPa] | "
        f"ρ [kg/m³] | {divided}",
        rows,
        "Dimensions of the shafts (for a cone, the smallest W_{p})",
    )


def _diameters(ends: tuple[float, float]) -> str:
    return "–".join(dict.fromkeys(given(end / MM, DIGITS) for end in ends))
