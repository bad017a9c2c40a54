"""Data sheets of motors, couplings, gears and propellers, against the file and the rated power."""

import math

import pytest

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.data_sheets import NO_FORCE, chapter
from torsion.output.numbers import number

TEXT = """
name: all that has a data sheet
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}, rated: {speed: 900 rpm, power: 60 kW}}
train:
- motor: {name: m, inertia: 1.25, power: 60 kW, ripple: [{order: 2, torque: 3}, {order: 4, torque: 1}], source: maker}
- coupling:
    {name: soft, stiffness: 20 kN*m/rad, psi: 0.8, tolerance: 15 %, rated_torque: 1 kN*m, vibratory_torque: 300,
     max_torque: 3 kN*m, heat_limit: 400 W, source: catalogue}
- gear:
    {name: g, teeth: [21, 63], mesh_stiffness: 5 MN*m/rad, application_factor: 1.4,
     branches: [{teeth: 42, inertia: 0.2}]}
- coupling: {name: stiff, flexibility: 0}
- propeller:
    {name: screw, inertia: 4, entrained: 25 %, blades: 4, diameter: 1.2 m, pitch_ratio: 0.9, area_ratio: 0.6,
     damping: {model: frahm, factor: 3}}
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def sheets(findings: Findings) -> dict[str, Table]:
    return {block.caption.split(":")[0]: block for block in chapter(findings) if isinstance(block, Table)}


def test_data_sheets_say_what_the_file_says_and_the_torque_at_the_rated_point(found: Findings) -> None:
    mean = 60e3 / (900 * math.pi / 30)  # N m
    made = sheets(found)
    assert list(made) == ["Motors", "Couplings", "Gears", "Propellers and other absorbers"]
    assert made["Motors"].rows == (("m", "1.25", "60", "900", number(mean), "2", "maker"),)
    assert made["Couplings"].rows == (
        ("soft", "1000", "300", "3000", "400", "20000", "15", "0.80000", "–", "catalogue"),
    )
    assert made["Gears"].rows == (
        ("g", "21", "63", "3", "1.4", number(mean), "5000000", "not stated"),
        ("g wheel 2", "21", "42", "2", "1.4", "0", "rigid", "not stated"),
    )
    assert made["Propellers and other absorbers"].rows == (
        ("screw", "4", "1.2", "0.9", "0.6", "4", "1", "5", "frahm", "3", "not stated"),
    )
    assert list(chapter(found))[-1] == Paragraph(NO_FORCE)
    assert next(iter(chapter(found))) == Heading("Data sheets")


def test_a_train_of_discs_has_no_data_sheets() -> None:
    text = "name: x\ntrain: [disc: {inertia: 1}, shaft: {length: 1, diameter: 0.1}, disc: {inertia: 2}]\n"
    assert list(chapter(torsion.run(torsion.parse(text)))) == []


def test_without_a_rated_point_there_is_no_torque() -> None:
    text = "name: x\ntrain: [motor: {inertia: 1}, gear: {ratio: 5/2}, disc: {inertia: 2}]\n"
    made = sheets(torsion.run(torsion.parse(text)))
    assert made["Motors"].rows == (("motor-1", "1", "–", "–", "–", "0", "not stated"),)
    assert made["Gears"].rows == (("gear-1", "–", "–", "5/2", "–", "–", "rigid", "not stated"),)
