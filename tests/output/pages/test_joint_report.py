"""The joints in the report, in JSON, in the table of numbers and on the terminal."""

import csv
import io
import json
import math
from collections.abc import Callable

import numpy as np
import pytest
from docs.site.results_manual import documented
from rich.console import Console
from tests.output.drawn import titles as titles_of

import torsion
from torsion.analyses.joints.joint_lines import Joints
from torsion.findings import Findings
from torsion.output.blocks import Figure, Heading, Points, Table
from torsion.output.chapters.joint_motion import chapter
from torsion.output.document import Document, document
from torsion.output.files.data_tables import report_columns
from torsion.output.numbers import number
from torsion.output.pages.html import html
from torsion.output.pages.terminal import show
from torsion.output.reports import REPORTS
from torsion.output.stored.results_json import KEYS, text

JOINTS = KEYS["joint"]
KEYS = {key.path: key.meaning for key in documented()}
JOINT_KEYS = {path.rstrip("[]") for path in KEYS if path.startswith("joints")}

NAME = '"a <b> & $x$, [i](j)"'
SCENES = {
    "bare": """
name: joints alone
train:
  - joint: {angle: 15 deg}
  - shaft: {length: 1 m, diameter: 60 mm}
  - joint: {angle: 20 deg, plane: 10 deg, phase: 55 deg}
""",
    "full": f"""
name: a line of three
operation: {{rated: {{speed: 60 rad/s}}}}
train:
  - joint: {{name: {NAME}, angle: 15 deg}}
  - shaft: {{length: 1 m, diameter: 60 mm}}
  - joint: {{angle: 20 deg, phase: 100 deg}}
  - shaft: {{length: 1 m, diameter: 60 mm}}
  - joint: {{angle: 10 deg, plane: 30 deg}}
analyses:
  joints: {{optimise: phase, torque: 800 N*m, turns: 2, steps: 36, bearings: {{joint-2: 0.25 m}}}}
""",
    "even": """
name: a line that cancels
operation: {rated: {speed: 60 rad/s}}
train: [joint: {angle: 15 deg}, shaft: {length: 1 m, diameter: 60 mm}, joint: {angle: 15 deg}]
analyses: {joints: {optimise: phase}}
""",
    "mixed": """
name: a tripod and a joint of constant velocity
train:
  - joint: {kind: tripod, angle: 30 deg, radius: 30 mm, arm: 600 mm}
  - shaft: {length: 1 m, diameter: 60 mm}
  - joint: {kind: cv, angle: 20 deg}
analyses: {joints: {torque: 200 N*m}}
""",
}
Solve = Callable[[str], Findings]


@pytest.fixture(scope="module")
def solve() -> Solve:
    known: dict[str, Findings] = {}

    def findings(name: str) -> Findings:
        if name not in known:
            known[name] = torsion.run(torsion.parse(SCENES[name], f"{name}.yaml"))
        return known[name]

    return findings


def table(findings: Findings, caption: str) -> Table:
    return next(b for b in chapter(findings) if isinstance(b, Table) and caption in b.caption)


def figures(findings: Findings) -> dict[str, Figure]:
    return {block.name: block for block in chapter(findings) if isinstance(block, Figure)}


def titles(findings: Findings) -> list[str]:
    return [block.text for block in chapter(findings) if isinstance(block, Heading)]


def joint_document(findings: Findings) -> Document:
    return document(findings, report=REPORTS["joint"])


def terminal(findings: Findings, width: int = 80) -> str:
    stream = io.StringIO()
    show(joint_document(findings), None, Console(file=stream, width=width, color_system=None))
    return stream.getvalue()


def table_of_numbers(findings: Findings) -> tuple[list[str], list[str], np.ndarray]:
    """Comments, titles and values of the CSV."""
    lines = report_columns(joint_document(findings), findings).splitlines()
    comments = [line for line in lines if line.startswith("#")]
    head, *rows = csv.reader(lines[len(comments) :])
    return comments, head, np.array(rows, dtype=float)


def test_angles_stand_in_the_table_as_the_file_gives_them(solve: Solve) -> None:
    rows = table(solve("full"), "Single joints").rows
    assert [row[2:5] for row in rows] == [("15", "0", "0"), ("20", "0", "100"), ("10", "30", "0")]


def test_two_joints_as_one_are_the_printed_result(solve: Solve) -> None:
    """Ma, Yu and Han 2011: 15 and 20 degrees, 55 degrees of phase: 64.4292 and 55.8753 at 60."""
    row = table(solve("bare"), "as one cross joint").rows[0]
    assert row[4] == f"{64.4291789399247 / 60:.6f}"
    assert row[5] == "30.415"
    assert row[6] == f"{55.8753046248925 / 60:.7f}"
    assert row[8] == number(14.2564571917204)


def test_without_speed_and_torque_there_are_ratios_and_no_couples_and_it_is_said(
    solve: Solve,
) -> None:
    found = solve("bare")
    assert "Secondary couples" not in titles(found)
    assert [
        block
        for block in chapter(found)
        if isinstance(block, Table) and "acceleration" in block.caption
    ] == []
    axes = titles_of(figures(found)["joint-motion-1"])
    assert "speed ratio" in axes
    assert not any("rpm" in says or "rad/s" in says for says in axes)
    said = " ".join(
        item for block in chapter(found) if isinstance(block, Points) for item in block.items
    )
    assert "speed" in said
    assert "torque" in said
    assert all(
        "torque" in terminal(found) and word in terminal(found) for word in ("speed", "couples")
    )


def test_the_curves_are_ratios_over_the_turn(solve: Solve) -> None:
    """The greatest speed behind one joint is speed / cos(angle)."""
    found = solve("full")
    panels = {panel.y.title: panel.lines for panel in figures(found)["joint-motion-1"].plots}
    line = panels["speed ratio"][0]
    assert line.name == "downstream of " + NAME.strip('"')
    assert line.y.max() == pytest.approx(1.0 / math.cos(math.radians(15.0)), rel=1e-12)
    assert len(panels) == 4


def test_couples_of_a_cross_joint_have_the_closed_mean_and_amplitude(solve: Solve) -> None:
    rows = table(solve("full"), "Secondary couples").rows
    slope, tilt = (400.0 * f(math.radians(15.0)) for f in (math.tan, math.sin))
    assert rows[0][1:8] == (
        "driving",
        "800.00",
        number(slope),
        "2",
        number(slope),
        number(slope),
        number(2 * slope),
    )
    assert rows[1][3] == number(tilt)
    assert rows[2][8] == number(800.0 * math.tan(math.radians(20.0)) / 0.25)
    assert rows[0][8] == "–"


def test_a_couple_that_stands_still_has_no_figure_and_no_order(solve: Solve) -> None:
    found = solve("mixed")
    assert {"joint-couples-1"} == {name for name in figures(found) if "couples" in name}
    rows = table(found, "Secondary couples").rows
    assert [row[4] for row in rows] == ["3", "3", "–", "–"]
    assert rows[2][7] == number(200.0 * math.tan(math.radians(10.0)))


def test_the_best_choice_is_told_with_its_gain(solve: Solve) -> None:
    found = solve("full")
    assert [row[0] for row in table(found, "Optimum phase").rows] == ["joint-2", "joint-3"]
    assert "degree of non-uniformity decreases" in terminal(found, 200)


def test_a_line_that_turns_evenly_shows_no_rounding(solve: Solve) -> None:
    row = table(solve("even"), "as one cross joint").rows[0]
    assert (row[1], row[3], row[5], row[7], row[8]) == ("0", "–", "–", "–", "0")
    assert "already rotates uniformly" in terminal(solve("even"))
    assert table(solve("even"), "Speed and acceleration").rows[1][4] == "0"


@pytest.mark.parametrize("scene", SCENES)
def test_every_json_key_is_documented_and_numbers_are_finite(scene: str, solve: Solve) -> None:
    back = json.loads(text(solve(scene), JOINTS), parse_constant=pytest.fail)
    assert "modes" not in back
    joints = back["joints"]
    np.testing.assert_array_equal(
        joints["joints"][1]["error_rad"], solve(scene).need(Joints).joints[1].error
    )

    def paths(value: object, at: str) -> set[str]:
        if isinstance(value, dict):
            return set().union(*(paths(v, f"{at}.{k}") for k, v in value.items()))
        if isinstance(value, list):
            return set().union(*(paths(v, f"{at}[]") for v in value))
        return {at.rstrip("[]")} if value is not None else set()

    found = paths(joints, "joints")
    assert found <= JOINT_KEYS
    if scene == "full":
        assert found | {"joints.remarks"} == JOINT_KEYS


@pytest.mark.parametrize("scene", SCENES)
def test_the_table_of_numbers_has_one_row_an_angle_and_titles_with_units(
    scene: str, solve: Solve
) -> None:
    found = solve(scene)
    comments, head, values = table_of_numbers(found)
    assert found.study.name in comments[0]
    assert torsion.__version__ in comments[-1]
    assert values.shape == (found.need(Joints).angle.size, len(head))
    assert len(set(head)) == len(head)
    assert all(title.endswith("]") for title in head)
    np.testing.assert_array_equal(
        np.radians(values[:, 0]).round(12), found.need(Joints).angle.round(12)
    )
    for k, joint in enumerate(found.need(Joints).joints):
        column = (
            [title.endswith("speed ratio [1]") for title in head].index(True) if k == 0 else None
        )
        if column is not None:
            np.testing.assert_array_equal(values[:, column], joint.speed_ratio)


@pytest.mark.parametrize("scene", SCENES)
def test_the_page_of_the_joints_has_the_summary_first_and_its_names_escaped(
    scene: str, solve: Solve
) -> None:
    made = joint_document(solve(scene))
    heads = [
        item.block.text
        for item in made.body
        if isinstance(item.block, Heading) and item.block.level == 1
    ]
    assert heads == [
        "Summary",
        "Universal joints",
        "Appendix: what was computed",
        "Appendix: the input as read",
    ]
    page = html(made)
    assert "a <b>" not in page
    assert page.count("<figure") == sum(isinstance(item.block, Figure) for item in made.body)


@pytest.mark.parametrize("scene", SCENES)
def test_the_terminal_keeps_to_80_columns_and_reads_no_markup(scene: str, solve: Solve) -> None:
    text = terminal(solve(scene))
    assert max(len(line) for line in text.splitlines()) <= 80
    if scene == "full":
        assert "[i](j)" in "".join(terminal(solve(scene), 200).split())


def test_a_train_without_joints_has_no_chapter(bare: Findings) -> None:
    assert bare.get(Joints) is None
    assert list(chapter(bare)) == []
