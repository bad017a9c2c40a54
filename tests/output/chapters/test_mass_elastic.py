"""Inertias, elastic elements and dimensions of shafts in the report, against the file and closed forms."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion.analyses.system_data import SystemData
from torsion.findings import Findings
from torsion.output.blocks import Paragraph, Table
from torsion.output.chapters.modes.mass_elastic import chapter
from torsion.output.numbers import given, number

STEEL, SHEAR = 7812.5, 81.25e9  # kg/m3, N/m2
TEXT = """
name: geared
materials: {alloy: {shear_modulus: 81.25 GPa, density: 7812.5, loss_factor: 0.0125}}
train:
- disc: {name: a, inertia: 1.2345678, source: maker}
- shaft: {name: tube, length: 0.8 m, diameter: 60 mm, bore: 20 mm, segments: 3, material: alloy, source: drawing}
- coupling: {name: soft, stiffness: 1.2345678e6, viscous: 2.5}
- gear: {name: g, ratio: 5/2, inertia: [0.5, 2.25], mesh_stiffness: 4.5 MN*m/rad}
- coupling: {name: light, stiffness: 0.25, psi: 0.5}
- coupling: {name: stiff, flexibility: 0}
- disc: {name: b, inertia: 0.3, stiffness: 1e3}
- shaft: {name: cone, length: 2 m, diameter: [90 mm, 80 mm], bore: [10 mm, 20 mm], segments: 400, material: alloy}
- propeller: {name: screw, inertia: 0, entrained: 3.1234567}
- propeller: {name: spare, inertia: 8.1234567, entrained: 2.7654321}
- coupling: {name: slip, stiffness: 7e3}
- disc: {name: wall, held: true}
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def tables(findings: Findings) -> dict[str, Table]:
    return {
        block.caption.split(" (")[0].split(";")[0]: block
        for block in chapter(findings)
        if isinstance(block, Table)
    }


def inertia(outer: float, bore: float, length: float) -> float:
    return STEEL * math.pi / 32.0 * (outer**4 - bore**4) * length


def stiffness(outer: float, bore: float, length: float) -> float:
    return SHEAR * math.pi / 32.0 * (outer**4 - bore**4) / length


def test_inertias_as_given_with_their_sum(found: Findings) -> None:
    """A row each; a shaft of three segments gives a sixth of its inertia to either end.

    The grounded end has no row.
    """
    tube = inertia(0.06, 0.02, 0.8)
    rows = tables(found)["Inertias as given"].rows
    assert [(row[0], row[1]) for row in rows] == [
        ("a", "a"),
        ("a", "tube, driving end"),
        ("tube end", "tube, driven end"),
        ("soft end", "g, driving wheel"),
        ("g end", "g, driven wheel"),
        ("b", "b"),
        ("b", "cone, driving end"),
        ("screw", "screw, entrained water"),
        ("screw", "cone, driven end"),
        ("spare", "spare, dry"),
        ("spare", "spare, entrained water"),
        ("wall", "wall"),
        ("tube", "tube, between ends"),
        ("cone", "cone, between ends"),
    ]
    assert rows[0] == ("a", "a", "1.2345678", "1", "1.234568")
    assert rows[1][2:] == (given(tube / 6, 8), "1", number(tube / 6, 7))
    assert rows[4][2:] == ("2.25", "2/5", "0.3600000")
    assert rows[11][2:] == ("∞", "2/5", "∞")
    assert rows[12][2:4] == (given(tube * 2 / 3, 8), "1")
    whole = found.system.inertia * found.system.speed_ratio**2
    total = float(whole[np.isfinite(whole)].sum())
    data = found.need(SystemData)
    assert data.total == pytest.approx(total, rel=1e-13)
    at_b = sum(
        row.inertia
        for row in data.inertias
        if row.station == "b" and "between" not in row.component
    )
    names = [station.name for station in found.system.train.stations]
    assert at_b == pytest.approx(found.system.inertia[names.index("b")], rel=1e-13)


def test_figures_that_are_referred_in_the_file_stand_as_given_and_at_their_own_speed() -> None:
    text = """
name: x
train: [disc: {name: a, inertia: 1}, gear: {name: g, ratio: 2, referred: true, inertia: [0.5, 0.25]},
  coupling: {name: k, stiffness: 3e6}, disc: {name: b, inertia: 4}]
"""
    made = tables(torsion.run(torsion.parse(text)))
    rows = {row[1]: row[2:7] for row in made["Inertias as given"].rows}
    assert rows["g, driving wheel"] == ("0.5", "1", "0.5", "1", "0.5000000")
    assert rows["g, driven wheel"] == ("0.25", "1", "1", "1/2", "0.2500000")
    assert rows["b"] == ("4", "1", "16", "1/2", "4.000000")
    (spring,) = (row[3:8] for row in made["Elastic elements"].rows if row[0] == "k")
    assert spring == ("3", "1", "12", "1/2", "3")


def test_entrained_water_of_a_propeller_without_inertia_of_its_own(found: Findings) -> None:
    made = tables(found)["Propellers, pumps and fans"]
    columns = [column.title for column in made.columns]
    dry, water, wet = (columns.index(title) for title in ("J dry", "Entrained water", "J wet"))
    assert [(row[dry], row[water], row[wet]) for row in made.rows] == [
        ("0", "3.1234567", "3.1234567"),
        ("8.1234567", "2.7654321", "10.888889"),
    ]


def test_elastic_elements_own_and_referred(found: Findings) -> None:
    made = tables(found)["Elastic elements"]
    rows = {row[0]: row for row in made.rows}
    tube = stiffness(0.06, 0.02, 0.8)
    unit = 1e6
    assert made.columns[3].unit == "MN m/rad"
    assert rows["tube"][1:6] == (
        "a",
        "tube end",
        given(tube / unit, 8),
        "1",
        given(tube / unit, 7),
    )
    assert (rows["cone"][1:3], rows["slip"][1:3]) == (("b", "screw"), ("spare", "wall"))
    assert rows["stiff"][3:6] == ("∞", "2/5", "∞")
    elastic = {row.component: row for row in found.need(SystemData).elements}
    assert (elastic["soft"].stiffness, elastic["g"].stiffness) == (
        pytest.approx(1.2345678e6, rel=1e-15),
        pytest.approx(4.5e6, rel=1e-15),
    )
    light = elastic["light"]
    assert (light.stiffness, light.referred) == pytest.approx((0.25, 0.04), rel=1e-15)
    assert light.loss_factor == pytest.approx(0.5 / (2 * math.pi), rel=1e-15)
    sources = {name: row.source for name, row in elastic.items() if row.source}
    assert sources == {
        "tube": "material alloy",
        "soft": "c = 2.5",
        "light": "ψ = 0.5",
        "cone": "material alloy",
    }
    assert (elastic["soft"].viscous, elastic["soft"].loss_factor) == (2.5, None)


def test_a_damper_without_stiffness_has_none() -> None:
    text = "name: x\ntrain: [damper: {housing: 2, ring: 3, damping: 3}]\n"
    (row,) = torsion.run(torsion.parse(text)).need(SystemData).elements
    assert (row.stiffness, row.referred, row.viscous) == (None, None, 3.0)


def test_dimensions_of_shafts(found: Findings) -> None:
    tube, cone = tables(found)["Dimensions of the shafts"].rows
    modulus = math.pi / 16.0 * (0.06**4 - 0.02**4) / 0.06
    assert tube == (
        "tube",
        "60",
        "–",
        "20",
        "–",
        "800",
        number(modulus * 1e9, 7),
        given(inertia(0.06, 0.02, 0.8), 8),
        "alloy",
        "81.25",
        "7812.5",
        "3",
    )
    thin = math.pi / 16.0 * (0.08**4 - 0.02**4) / 0.08
    means = [
        sum(a**k * b ** (4 - k) for k in range(5)) / 5 for a, b in ((0.09, 0.08), (0.01, 0.02))
    ]
    whole = STEEL * math.pi / 32.0 * (means[0] - means[1]) * 2.0
    assert cone[:7] == ("cone", "90", "80", "10", "20", "2000", number(thin * 1e9, 7))
    assert float(cone[7]) == pytest.approx(whole, rel=1e-7)
    assert cone[8:] == ("alloy", "81.25", "7812.5", "400")


@pytest.mark.parametrize(
    ("model", "said"),
    [
        ("lumped", "lumped at the ends"),
        ("fem", "half of each segment"),
        ("exact", "half of each segment"),
    ],
)
def test_what_a_shaft_is_divided_into(model: str, said: str) -> None:
    made = torsion.run(
        replace(torsion.parse(TEXT.replace("segments: 400", "segments: 7")), model=model)
    )
    table = tables(made)["Dimensions of the shafts"]
    assert table.rows[1][-1] == str(made.system.segments["cone"])
    assert said in next(block.text for block in chapter(made) if isinstance(block, Paragraph))


def test_a_meshed_section_names_its_file() -> None:
    scene = Path(__file__).parents[3] / "shafting_specs" / "keyed_shaft.yaml"
    study = torsion.read(scene)
    (row,) = tables(torsion.run(replace(study, analyses={}, rules=())))[
        "Dimensions of the shafts"
    ].rows
    assert row[1].endswith("keyed_60_mm.msh")
    assert row[2] == "900"


def test_a_shaft_in_a_hub_keeps_the_modulus_of_its_material() -> None:
    hub = "hub: {length: 60 mm, diameter: 120 mm, fit: shrink, end: first}"
    text = f"""
name: shrunk
train:
- disc: {{name: a, inertia: 1}}
- shaft: {{name: line, length: 0.2 m, diameter: 60 mm, {hub}}}
- disc: {{name: b, inertia: 1}}
"""
    made = tables(torsion.run(torsion.parse(text)))["Dimensions of the shafts"]
    column = [one.title for one in made.columns].index("G")
    assert [row[column] for row in made.rows] == ["79.3"]
