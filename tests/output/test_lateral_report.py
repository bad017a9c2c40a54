"""The bending of the shafts in report, JSON and terminal: nothing unstable or singular without a mark."""

import io
import json
import math
import subprocess
import sys
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from docs.site.results_manual import documented
from rich.console import Console
from tests.contracts.frozen import solved as scene_solved
from tests.output.drawn import marks

import torsion
from torsion.analyses.lateral.couple_response import extent
from torsion.analyses.lateral.shaft_bending import Lateral
from torsion.analyses.lateral.whirl import sense
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Figure, Paragraph, Table
from torsion.output.chapters.shaft_bending import chapter
from torsion.output.document import document
from torsion.output.drawing.svg import svg
from torsion.output.pages.terminal import screen
from torsion.output.stored.results_json import results, text
from torsion.rules.stable_motion import bending_checks
from torsion.rules.verdict_line import Checks
from torsion.runner import run

KEYS = {key.path: key.meaning for key in documented()}
LATERAL = {path for path in KEYS if path.startswith("lateral.")}
RPM = 30.0 / math.pi
TUBE = "length: 1.5 m, diameter: 60 mm, bore: 50 mm"
SCENE = """
name: Cardan shaft
operation: {{speeds: {{from: {first} rpm, to: {last} rpm, steps: 31}}, rated: {{speed: {last} rpm, power: 50 kW}}}}
train:
  - motor: {{inertia: 1}}
{before}
  - joint: {{name: first joint, angle: 8 deg}}
  - shaft: {{name: tube, {tube}, loss_factor: {loss}}}
  - joint: {{name: second joint, angle: 5 deg}}
  - disc: {{name: pump, inertia: 2}}
analyses: {{lateral: {{modes: 2}}}}
"""
LIGHT = """
import sys, torsion
torsion.run(torsion.parse({scene!r}))
print([name for name in sys.modules if name == "skfem" or "lateral" in name])
"""


def solved(
    *, loss: float = 0.0, first: float = 300.0, last: float = 3000.0, before: str = ""
) -> Findings:
    return torsion.run(
        torsion.parse(SCENE.format(loss=loss, first=first, last=last, before=before, tube=TUBE))
    )


@pytest.fixture(scope="module")
def undamped() -> Findings:
    """The order 2 of the couples meets the tube in the range, and nothing damps."""
    return solved()


@pytest.fixture(scope="module")
def tilting() -> Findings:
    """A tail shaft on one soft bearing, unstable in three ranges of its speeds."""
    return scene_solved("tilting_tail")


@pytest.fixture(scope="module")
def fast() -> Findings:
    """A tube with a loss factor, above its first critical speed."""
    return solved(loss=0.02, first=3000.0, last=8000.0)


def table(findings: Findings, words: str) -> Table:
    return next(b for b in chapter(findings) if isinstance(b, Table) and words in b.caption)


def figure(findings: Findings, name: str) -> Figure:
    return next(b for b in chapter(findings) if isinstance(b, Figure) and b.name.startswith(name))


def paths(value: Any, at: str) -> set[str]:
    """Every path down to the documented leaves."""
    if at in KEYS:
        return {at}
    if isinstance(value, dict):
        return set().union(*(paths(v, f"{at}.{k}") for k, v in value.items()))
    return set().union(*(paths(v, f"{at}[]") for v in value)) if isinstance(value, list) else {at}


def test_a_shaft_that_grows_by_itself_is_marked_in_table_text_map_and_terminal(
    fast: Findings,
) -> None:
    whirl = table(fast, "Whirl over")
    grown = [row for row, mark in zip(whirl.rows, whirl.marks, strict=True) if mark == "fail"]
    assert [row[4] for row in grown] == ["forward"]
    assert grown[0][-1].startswith("UNSTABLE from")
    critical = next(
        c for c in fast.need(Lateral).shafts[0].critical if c.order == 1 and c.direction > 0
    )
    onset = float(grown[0][-1].split()[2])
    assert (
        critical.speed * RPM < onset < critical.speed * RPM + 200.0
    )  # the next speed of the range
    assert [block.kind for block in chapter(fast) if isinstance(block, Paragraph)][1] == "fail"
    assert marks(figure(fast, "whirl"), "UNSTABLE")
    assert "UNSTABLE" in svg(figure(fast, "whirl"))
    shown = Console(record=True, width=80, file=io.StringIO())
    for item in screen(document(fast)):
        shown.print(item)
    assert "UNSTABLE" in shown.export_text()


def test_without_damping_no_mode_is_called_stable_and_none_unstable(undamped: Findings) -> None:
    assert {row[-1] for row in table(undamped, "Whirl over").rows} == {"undamped"}


def test_a_resonance_without_damping_has_no_maximum_and_is_marked(undamped: Findings) -> None:
    (shaft,) = undamped.need(Lateral).shafts
    second = shaft.answers[1]
    bad = second.status != Status.OK
    assert (second.status == Status.SINGULAR).any()
    found = table(undamped, "Response")
    row, mark = next(
        both for both in zip(found.rows, found.marks, strict=True) if both[0][1] == "2"
    )
    assert row[2] == row[5] == "no reliable value"
    assert {row[4] for row in table(undamped, "Forces").rows if row[3] == "2"} == {
        "no reliable value"
    }
    assert row[-1] == str(bad.sum())
    assert mark
    drawn = svg(figure(undamped, "bending"))
    assert "singular: no answer" in drawn
    assert "nearly singular" in drawn


def test_speeds_are_those_of_the_reference_behind_a_gear() -> None:
    direct, geared = solved(), solved(last=6000.0, before="  - gear: {ratio: 2}")
    one, other = (results(f)["lateral"]["shafts"][0] for f in (direct, geared))
    assert other["ratio"] == "1/2"
    slow, fast = (
        np.array([c["speed_rad_per_s"] for c in shaft["critical_speeds"]]) for shaft in (one, other)
    )
    np.testing.assert_allclose(fast, 2.0 * slow, rtol=1e-9)
    rows = [table(f, "Critical bending").rows[0] for f in (direct, geared)]
    assert float(rows[1][3]) == pytest.approx(2.0 * float(rows[0][3]), rel=1e-4)
    assert rows[0][4] == rows[1][4]


def test_forces_are_told_at_every_joint_with_its_name(undamped: Findings) -> None:
    rows = table(undamped, "Forces").rows
    assert [(row[1], row[3]) for row in rows] == [
        (name, order) for name in ("first joint", "second joint") for order in "02"
    ]
    (shaft,) = undamped.need(Lateral).shafts
    first = shaft.answers[0]
    assert float(rows[0][4]) == pytest.approx(extent(first.force)[:, 0].max(), rel=1e-4)


def test_every_key_is_documented_and_there(undamped: Findings, tilting: Findings) -> None:
    absent = {"lateral.shafts[].tilting"}  # null
    found = paths(results(undamped)["lateral"], "lateral") | paths(
        results(tilting)["lateral"], "lateral"
    )
    assert found - absent == set(LATERAL)
    assert json.loads(text(undamped))["lateral"]["shafts"][0]["name"] == "tube"


def test_ranges_in_which_the_tilt_grows_are_marked_in_table_verdict_and_figure(
    tilting: Findings,
) -> None:
    (shaft,) = tilting.need(Lateral).shafts
    found = table(tilting, "Unstable ranges of the tilt")
    assert [row[3] for row in found.rows] == [zone.kind for zone in shaft.tilting.zones]
    assert [row[-1] for row in found.rows] == ["UNSTABLE"] * 3
    assert set(found.marks) == {"fail"}
    first = shaft.tilting.zones[0]
    assert float(found.rows[0][1]) == pytest.approx(first.first * 30.0 / np.pi, rel=1e-8)
    assert tilting.failed
    drawn = svg(figure(tilting, "tilting"))
    assert "principal of 2" in drawn
    assert "unstable" in drawn
    shown = results(tilting)["lateral"]["shafts"][0]["tilting"]["unstable"]
    assert shown[0]["from_rad_per_s"] == pytest.approx(first.first, rel=1e-12)


def test_tilt_that_was_examined_at_a_part_of_the_speeds_alone_fails_without_a_word_of_growth(
    tilting: Findings,
) -> None:
    (shaft,) = tilting.need(Lateral).shafts
    lateral = replace(
        tilting.need(Lateral), shafts=(replace(shaft, tilting=replace(shaft.tilting, zones=())),)
    )
    slower = tilting.study.operation.speeds.model_copy(update={"first": 1.0})
    checks = bending_checks(lateral, tilting.study.operation.model_copy(update={"speeds": slower}))
    assert {check.verdict for check in checks} == {"fail"}
    blocks = list(chapter(tilting.having(lateral=lateral, checks=Checks(checks))))
    (said,) = (
        block.text for block in blocks if isinstance(block, Paragraph) and block.kind == "fail"
    )
    assert said.startswith("No tilting motion of tail shaft grows")
    assert "only a part of the operation's speeds" in said


def test_a_support_alone_asks_for_the_bending_and_joints_alone_leave_it_out() -> None:
    scene = SCENE.format(
        loss=0.01,
        first=300,
        last=3000,
        before="",
        tube=f"{TUBE}, support: {{at: 0.7, stiffness: 1e7}}",
    )
    study = torsion.parse(scene.replace("analyses: {lateral: {modes: 2}}", "analyses: {joints: }"))
    assert [point.name for point in run(study).need(Lateral).shafts[0].point] == [
        "first joint",
        "second joint",
        "support of tube",
    ]
    assert run(study, only=("joints",)).get(Lateral) is None


def test_without_speeds_the_critical_speeds_are_told_all_the_same() -> None:
    scene = "name: a\ntrain: [disc: {inertia: 1}, joint: {angle: 1 deg}, shaft: {name: b, length: 1, diameter: 0.05}, "
    found = torsion.run(
        torsion.parse(scene + "joint: {angle: 1 deg}]\nanalyses: {lateral: {modes: 1}}")
    )
    assert [type(block).__name__ for block in chapter(found)].count("Table") == 2
    assert {row[-1] for row in table(found, "Critical").rows} == {"no"}
    assert results(found)["lateral"]["shafts"][0]["whirl"] is None


def test_progress_is_told_of_every_shaft() -> None:
    stated: list[tuple[str, float]] = []
    study = torsion.parse(SCENE.format(loss=0, first=300, last=3000, before="", tube=TUBE))
    run(study, progress=lambda what, share: stated.append((what, share)))
    assert ("bending of the shafts", 0.0) in stated


def test_a_nearly_straight_orbit_is_neither_forward_nor_backward() -> None:
    words = [sense(value) for value in (1.0, 0.5, 0.05, -0.5, -1.0)]
    assert words == [
        "forward",
        "forward, ellipse",
        "nearly in a plane",
        "backward, ellipse",
        "backward",
    ]


def test_a_scene_without_bending_loads_nothing_of_it() -> None:
    shaft = "shaft: {length: 1, diameter: 0.05}"
    scene = f"name: a\ntrain: [disc: {{inertia: 2}}, joint: {{angle: 3 deg}}, {shaft}, disc: {{inertia: 3}}]\n"
    done = subprocess.run(
        [sys.executable, "-c", LIGHT.format(scene=scene)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"
