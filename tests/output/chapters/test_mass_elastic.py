"""Inertias, elastic elements and dimensions of shafts in the report, against the file and closed forms."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Paragraph, Table
from torsion.output.chapters.mass_elastic import chapter
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
        block.caption.split(" (")[0]: block
        for block in chapter(findings)
        if isinstance(block, Table)
    }


def inertia(outer: float, bore: float, length: float) -> float:
    return STEEL * math.pi / 32.0 * (outer**4 - bore**4) * length


def stiffness(outer: float, bore: float, length: float) -> float:
    return SHEAR * math.pi / 32.0 * (outer**4 - bore**4) / length


def test_inertias_as_given_with_their_sums(found: Findings) -> None:
    """A row each; a shaft of three segments gives a sixth of its inertia to either end.

    The grounded end has no row.
    """
    tube = inertia(0.06, 0.02, 0.8)
    rows = tables(found)["Inertias as given, and their sums"].rows
    of = [(row[0], row[1]) for row in rows]
    assert of == [
        ("a", "a"),
        ("a", "tube, driving end"),
        ("a", "sum"),
        ("tube end", "tube, driven end"),
        ("soft end", "g, driving wheel"),
        ("g end", "g, driven wheel"),
        ("b", "b"),
        ("b", "cone, driving end"),
        ("b", "sum"),
        ("screw", "screw, entrained water"),
        ("screw", "cone, driven end"),
        ("screw", "sum"),
        ("spare", "spare, dry"),
        ("spare", "spare, entrained water"),
        ("spare", "sum"),
        ("wall", "wall"),
        ("tube, inside", "tube, between ends"),
        ("cone, inside", "cone, between ends"),
        ("whole train", "sum"),
    ]
    assert rows[0] == ("a", "a", "1.2345678", "1", "1.234568")
    assert rows[1][2:] == (given(tube / 6, 8), "1", number(tube / 6, 7))
    assert rows[2][2:] == (given(1.2345678 + tube / 6, 8), "1", number(1.2345678 + tube / 6, 7))
    assert rows[5][2:] == ("2.25", "2/5", "0.3600000")
    assert rows[14][2:] == ("10.888889", "2/5", number((8.1234567 + 2.7654321) * 0.4**2, 7))
    assert rows[15][2:] == ("fixed", "2/5", "fixed")
    assert rows[16][2:4] == (given(tube * 2 / 3, 8), "1")
    whole = found.system.inertia * found.system.speed_ratio**2
    assert rows[-1][2:] == ("–", "–", number(float(whole[np.isfinite(whole)].sum()), 7))


def test_figures_that_are_referred_in_the_file_stand_as_given_and_at_their_own_speed() -> None:
    text = """
name: x
train: [disc: {name: a, inertia: 1}, gear: {name: g, ratio: 2, referred: true, inertia: [0.5, 0.25]},
  coupling: {name: k, stiffness: 3e6}, disc: {name: b, inertia: 4}]
"""
    made = tables(torsion.run(torsion.parse(text)))
    rows = {row[1]: row[2:7] for row in made["Inertias as given, and their sums"].rows}
    assert rows["g, driving wheel"] == ("0.5", "1", "0.5", "1", "0.5000000")
    assert rows["g, driven wheel"] == ("0.25", "1", "1", "1/2", "0.2500000")
    assert rows["b"] == ("4", "1", "16", "1/2", "4.000000")
    (spring,) = (row[2:7] for row in made["Elastic elements"].rows if row[0] == "k")
    assert spring == ("3", "1", "12", "8.3333333·10⁻⁸", "1/2")


def test_entrained_water_of_a_propeller_without_inertia_of_its_own(found: Findings) -> None:
    said = " ".join(block.text for block in chapter(found) if isinstance(block, Paragraph))
    assert "screw: J 0 dry + 3.12346 entrained water = 3.12346 kg m² (dry inertia 0)." in said
    assert (
        "spare: J 8.12346 dry + 2.76543 entrained water = 10.8889 kg m² (34.04 % of dry)." in said
    )


def test_elastic_elements_own_and_referred(found: Findings) -> None:
    made = tables(found)["Elastic elements"]
    rows = {row[0]: row for row in made.rows}
    tube = stiffness(0.06, 0.02, 0.8)
    assert rows["tube"][1:] == (
        "a – tube end",
        given(tube / 1e6, 8),
        given(1 / tube, 8),
        "1",
        given(tube / 1e6, 7),
    )
    assert rows["soft"][2:] == ("1.2345678", given(1 / 1.2345678e6, 8), "1", "1.234568")
    assert rows["g"][2:] == ("4.5", "2.2222222·10⁻⁷", "1", "4.5")
    assert rows["light"][2:] == ("2.5·10⁻⁷", "4", "2/5", "4·10⁻⁸")
    assert rows["stiff"][2:] == ("rigid", "0", "2/5", "rigid")
    assert (rows["cone"][1], rows["slip"][1]) == ("b – screw", "spare – wall")
    assert made.columns[2].unit == made.columns[5].unit == "MN m/rad"


def test_a_damper_without_stiffness_has_none() -> None:
    text = "name: x\ntrain: [damper: {housing: 2, ring: 3, damping: 3}]\n"
    (row,) = tables(torsion.run(torsion.parse(text)))["Elastic elements"].rows
    assert row[2:] == ("–", "∞", "1", "–")


def test_stiffnesses_have_the_prefix_of_the_largest() -> None:
    text = "name: x\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 6e5}, disc: {inertia: 3}]\n"
    (row,) = tables(torsion.run(torsion.parse(text)))["Elastic elements"].rows
    assert row[2] == "600"


def test_dimensions_of_shafts(found: Findings) -> None:
    tube, cone = tables(found)["Dimensions of the shafts"].rows
    modulus = math.pi / 16.0 * (0.06**4 - 0.02**4) / 0.06
    assert tube == (
        "tube",
        "60",
        "20",
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
    assert cone[:5] == ("cone", "90–80", "10–20", "2000", number(thin * 1e9, 7))
    assert float(cone[5]) == pytest.approx(whole, rel=1e-7)
    assert cone[6:] == ("alloy", "81.25", "7812.5", "400")


@pytest.mark.parametrize(
    ("model", "title", "said"),
    [
        ("lumped", "Segments", "lumped at the ends"),
        ("fem", "Elements", "half of each segment"),
        ("exact", "Pieces", "half of each segment"),
    ],
)
def test_what_a_shaft_is_divided_into(model: str, title: str, said: str) -> None:
    made = torsion.run(
        replace(torsion.parse(TEXT.replace("segments: 400", "segments: 7")), model=model)
    )
    table = tables(made)["Dimensions of the shafts"]
    assert table.columns[9].title == title
    assert table.rows[1][9] == str(made.system.segments["cone"])
    assert said in next(block.text for block in chapter(made) if isinstance(block, Paragraph))


def test_a_meshed_section_names_its_file() -> None:
    scene = Path(__file__).parents[3] / "shafting_specs" / "keyed_shaft.yaml"
    study = torsion.read(scene)
    (row,) = tables(torsion.run(replace(study, analyses={}, rules=())))[
        "Dimensions of the shafts"
    ].rows
    assert row[1].endswith("keyed_60_mm.msh")
    assert row[2] == "–"


def test_shafts_of_another_train_are_refused(found: Findings) -> None:
    train = found.study.train
    other = replace(found, study=replace(found.study, train=replace(train, bars=train.bars[:1])))
    with pytest.raises(ValueError, match="longer"):
        list(chapter(other))


def test_a_train_that_cannot_vibrate_has_no_inertias() -> None:
    text = "name: x\ntrain: [disc: {inertia: 0}, coupling: {stiffness: 5}, disc: {held: true}]\n"
    assert "Inertias as given, and their sums" not in tables(torsion.run(torsion.parse(text)))


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
