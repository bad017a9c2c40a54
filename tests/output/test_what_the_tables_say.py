"""What single tables of the report say: the tooth load, the rows of a Holzer table, entrained water."""

import re
from collections.abc import Sequence

import pytest

import torsion
from torsion.analyses.joints.joint_lines import Joints
from torsion.analyses.system_data import SystemData
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Block, Table
from torsion.output.chapters import chapters
from torsion.output.chapters.joint_motion import in_short
from torsion.output.chapters.modes.natural_frequencies import holzer_tables
from torsion.output.chapters.response import component_loads
from torsion.output.stored.scene import elements
from torsion.rules.verdict_line import Checks

GEARED = """
name: a geared train
operation: {at: screw, speeds: {from: 60 rpm, to: 220 rpm, steps: 41}, rated: {speed: 200 rpm, power: 1.2 MW}}
train:
  - motor: {name: m, inertia: 30, ripple: [{order: 2, torque: 2 %}]}
  - gear:
      name: g
      teeth: [23, 101]
      inertia: [1.5, 60]
      mesh_stiffness: 20 MN*m/rad
      branches:
        - teeth: 37
          inertia: 2
          mesh_stiffness: 11 MN*m/rad
          train:
            - shaft: {name: pto, length: 1 m, diameter: 80 mm, segments: 3}
            - motor: {name: n, inertia: 10}
            - damper: {name: dmp, housing: 0.4, ring: 1.2, damping: 30, stiffness: 40 kN*m/rad}
        - ratio: 7/3
          train: [coupling: {name: c, stiffness: 1e5, psi: 0.9}, disc: {name: alt, inertia: 4, damping: 12}]
  - shaft: {name: tail, length: 4 m, diameter: 230 mm, segments: 5}
  - propeller:
      {name: screw, inertia: 900, entrained: 200, blades: 4, damping: 3e3, excitation: [{blade_order: 1, torque: 8 %}]}
"""


@pytest.fixture(scope="module")
def geared() -> Findings:
    return solved(GEARED)


def solved(text: str) -> Findings:
    return torsion.run(torsion.parse(text, "scene.yaml"))


def table(blocks: Sequence[Block]) -> Table:
    return next(block for block in blocks if isinstance(block, Table))


def test_load_of_an_unloaded_mesh_reverses_everywhere(geared) -> None:
    stated = table(component_loads.gears(geared))
    rows = {row[0]: (row, mark) for row, mark in zip(stated.rows, stated.marks, strict=True)}
    idle, mark = rows["g wheel 3"]
    assert (idle[3], idle[4], idle[6], mark) == ("0", "∞", "yes, everywhere", "fail")
    assert (rows["g"][0][6], rows["g"][1]) == ("no", "")


def test_load_of_a_mesh_without_any_torque_does_not_reverse() -> None:
    still = GEARED.replace("ripple: [{order: 2, torque: 2 %}]", "ripple: [{order: 2, torque: 0 %}]")
    stated = table(component_loads.gears(solved(still.replace("torque: 8 %", "torque: 0 %"))))
    assert {row[6] for row in stated.rows} == {"no"}


def test_holzer_table_names_the_elements_as_the_table_of_elements_does(geared) -> None:
    block = next(holzer_tables(geared, geared.need(Modes), 0))
    through = [row[6] for row in block.rows if row[6] != "–"]
    assert len(set(through)) == len(through)
    assert {element.name for element in elements(geared.system)} <= set(through)


@pytest.mark.parametrize(
    ("entrained", "water"), [("entrained: 200,", 200.0), ("entrained: 25 %,", 225.0), ("", None)]
)
def test_dry_inertia_and_entrained_water_are_told_apart(entrained, water) -> None:
    found = solved(GEARED.replace("entrained: 200,", entrained))
    (row,) = found.need(SystemData).impellers
    assert (row.dry, row.water) == (900.0, water)
    assert row.wet == (None if water is None else 900.0 + water)


def test_heat_at_an_undamped_resonance_has_no_value() -> None:
    text = """
name: undamped
operation: {speeds: {from: 5 rad/s, to: 15 rad/s, steps: 11}}
train:
  - disc: {inertia: 2}
  - coupling: {name: k, stiffness: 120, psi: 0, heat_limit: 5 W, vibratory_torque: 100}
  - disc: {name: far, inertia: 3}
excitations: [{at: far, order: 1, torque: 1}]
rules: [coupling-maker]
"""
    found = solved(text)
    values = {check.clause: (check.value, check.verdict) for check in found.need(Checks).lines}
    assert values == {"T_KW": (float("inf"), "fail"), "P_KW": (float("inf"), "fail")}
    assert not re.search(r"\b0 W", str(list(component_loads.couplings(found))))


def test_a_loop_whose_softest_span_is_a_segment_of_its_shaft_has_that_shaft_as_a_row_of_its_own() -> (
    None
):
    text = """
name: loop
train: [disc: {name: a, inertia: 1e-5}, coupling: {stiffness: 1e4}, disc: {name: b, inertia: 2e-5}]
links: [{between: [a, b], shaft: {length: 2 m, diameter: 10 mm, segments: 6}}]
"""
    found = torsion.run(torsion.parse(text))
    table = next(
        block for block in chapters(found) if isinstance(block, Table) and "Holzer" in block.caption
    )
    assert [row[1] for row in table.rows] == ["a", "b", "b, closing a loop"]
    assert [row[6] for row in table.rows] == ["–", "coupling-1", "shaft-1"]
    inertias = [float(row[2].replace("·10⁻⁵", "e-5")) for row in table.rows[:2]]
    assert inertias == pytest.approx(found.system.lumped_inertia[:2], rel=1e-6)


def test_a_line_that_turns_unevenly_is_stated_as_one_joint() -> None:
    text = "name: x\ntrain: [joint: {angle: 5 deg}, joint: {angle: 3 deg}]\n"
    found = torsion.run(torsion.parse(text)).need(Joints)
    assert "its cross joints act as one joint of" in " ".join(in_short(found, found.lines[0]))
