"""What fails stands on the first page, whatever its kind, its name, its room and its place in the train."""

import math
import xml.etree.ElementTree as ET
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Box, Figure, Points
from torsion.output.chapters import verdict
from torsion.output.check_words import rank
from torsion.output.drawing.pens import BAD
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Sketch
from torsion.rules.verdict_line import BarredRange, Check, Checks

RPM = 30.0 / math.pi
SVG = "{http://www.w3.org/2000/svg}"
SPEEDS = "operation: {speeds: {from: 300 rpm, to: 600 rpm, steps: 4}, rated: {speed: 600 rpm, power: 40 kW}}\n"
NAMES = """
- motor: {inertia: 2}
- coupling: {name: tail, stiffness: 200 kN*m/rad}
- disc: {inertia: 0.1}
- coupling: {name: "tail, aft", stiffness: 20 kN*m/rad}
- disc: {inertia: 1}
"""
JOINTS = """
- motor: {inertia: 2}
- joint: {name: first, angle: 2 deg}
- shaft: {name: tube, length: 1 m, diameter: 60 mm}
- joint: {name: second, angle: 9 deg}
- shaft: {name: after, length: 1 m, diameter: 60 mm}
- disc: {inertia: 1}
"""


def run(train: str, more: str = "") -> Findings:
    return torsion.run(torsion.parse(f"name: x\n{SPEEDS}train:{train}{more}"))


def check(verdict: str = "pass", **changed: object) -> Check:
    made = Check(
        "rule", "clause", "tail", "what", 12.5, 50.0, "N m", verdict, "setting", 30.0, Fraction(2)
    )
    return replace(made, **changed)


def judged(findings: Findings, *checks: Check) -> Findings:
    return findings.having(checks=Checks(checks))


def figure(findings: Findings, name: str) -> Figure:
    return next(
        one for one in verdict.chapter(findings) if isinstance(one, Figure) and one.name == name
    )


def lines(findings: Findings) -> dict[str, str]:
    return dict(next(one for one in verdict.chapter(findings) if isinstance(one, Box)).lines)


def texts(drawing: str) -> list[tuple[str, str | None]]:
    """Texts and their colours."""
    every = ET.fromstring(drawing).iter(f"{SVG}text")
    return [("".join(one.itertext()).replace("\u200b", ""), one.get("fill")) for one in every]


def test_unstable_speeds_of_a_tilting_shaft_stand_in_the_box_and_the_bar() -> None:
    found = torsion.run(
        torsion.parse(Path("shafting_specs/tilting_tail.yaml").read_text(encoding="utf-8"))
    )
    zones = [
        zone
        for shaft in found.results["lateral"].shafts
        if shaft.tilting
        for zone in shaft.tilting.zones
    ]
    bands = [
        (one.low, one.high)
        for one in figure(found, "speeds").plots[0].bands
        if one.kind == "unstable"
    ]
    np.testing.assert_allclose(
        bands, [(zone.first * RPM, zone.last * RPM) for zone in zones], rtol=1e-14
    )
    said = lines(found)["Restrictions"]
    assert said.count("Unstable range") == len(zones) == 3
    for zone in zones:
        low, high = (
            math.floor(10.0 * zone.first * RPM) / 10.0,
            math.ceil(10.0 * zone.last * RPM) / 10.0,
        )
        assert (
            f"Unstable range: {low:.1f} to {high:.1f} rpm, tilt of tail shaft, {zone.kind}" in said
        )


def many(number: int) -> Findings:
    pairs = "".join(
        f"- shaft: {{name: intermediate shaft {k}, length: 1 m, diameter: 80 mm}}\n- disc: {{inertia: 0.1}}\n"
        for k in range(number)
    )
    return run(f"\n- motor: {{inertia: 5}}\n{pairs}")


def test_every_part_that_does_not_keep_a_limit_has_an_outline_where_its_words_have_no_room() -> (
    None
):
    diameter = check(
        "not kept", value=90.0, limit=99.0, unit="mm", at_least=True, clause="minimum diameter"
    )
    bad = [replace(diameter, where=f"intermediate shaft {k}") for k in range(20)]
    fine = [check(where=f"intermediate shaft {k}", unit="N/mm2", value=0.01) for k in range(20)]
    fails = check("fail", where="intermediate shaft 17", unit="1", value=70.0, clause="damage")
    findings = judged(many(20), *fine, *bad, fails)
    found = texts(svg(figure(findings, "utilisation")))
    alone = [text for text, _ in found]
    with_words = sum(text.startswith("✗ FAIL") for text in alone)
    note = next(text for text in alone if "want of room" in text)
    assert f"of these {20 - with_words} fail" in note
    assert "low utilisation first" not in note
    assert "✗ FAIL 140 %:" in alone
    colours = {colour for text, colour in found if text.startswith("✓ PASS")}
    assert BAD not in colours
    assert {colour for text, colour in found if text.startswith("✗ FAIL")} == {BAD}
    outlines = [
        one
        for one in ET.fromstring(svg(figure(findings, "utilisation"))).iter(f"{SVG}path")
        if one.get("stroke") == BAD and one.get("fill") == "none"
    ]
    assert outlines
    passing = judged(many(20), *fine)
    assert not {text for text, _ in texts(svg(figure(passing, "utilisation")))} & {"✗"}


def sketch(findings: Findings) -> Sketch:
    return next(one for one in figure(findings, "utilisation").panels if isinstance(one, Sketch))


def middle(drawn: Sketch, label: str) -> tuple[float, float]:
    link = next(link for link in drawn.links if link.label == label)
    return (link.start[0] + link.end[0]) / 2, link.end[1]


def test_the_worst_is_pointed_at_where_one_name_begins_with_another() -> None:
    made = judged(run(NAMES), check(), check("fail", where="tail, aft", value=60.0))
    drawn = sketch(made)
    assert drawn.worst[0] == middle(drawn, "tail, aft") != middle(drawn, "tail")
    assert {link.label: link.use.grade for link in drawn.links if link.use} == {
        "tail": "low",
        "tail, aft": "over",
    }


def test_joints_that_fail_are_marked_and_the_worst_of_their_line_is_pointed_at() -> None:
    rules = "rules: [{universal-joints: {unevenness: 1e-6, speed_angle: 1e9, torsional: 1e9, inertial: 1e9}}]\n"
    drawn = sketch(run(JOINTS, rules))
    joints = [link for link in drawn.links if link.kind == "joint"]
    assert [link.label for link in joints] == ["first", "second"]
    assert {link.use.grade for link in joints} == {"over"}
    assert all(
        link.use.mark and "FAIL" in link.use.words and "\nU" in link.use.words for link in joints
    )
    assert drawn.worst[0] == middle(drawn, "second")
    fine = sketch(run(JOINTS, rules.replace("1e-6", "1")))
    assert {(link.label, link.use) for link in fine.links if link.kind == "joint"} == {("", None)}


def test_the_clause_of_a_long_name_is_whole_in_the_shares() -> None:
    name = (
        "the very long intermediate shaft between the gearbox and the bulkhead of the engine room"
    )
    made = judged(run(NAMES), check(where=name, clause="minimum diameter"))
    found = [text for text, _ in texts(svg(figure(made, "shares")))]
    (row,) = [text for text in found if text.startswith("the very")]
    assert row.endswith("…, minimum diameter")


def test_one_rounding_of_a_barred_range_in_box_and_bar() -> None:
    band = BarredRange(
        380.04 / RPM, 440.06 / RPM, 400.0 / RPM, "tail", 385.04 / RPM, 435.06 / RPM, Fraction(2)
    )
    made = judged(run(NAMES), check(barred=(band,)))
    said = lines(made)["Barred ranges"]
    assert said.startswith("380.0 to 440.1 rpm")
    (label,) = [one.label for one in figure(made, "speeds").plots[0].bands if one.kind == "barred"]
    assert label == "barred 380.0 to 440.1"


def test_a_value_that_is_not_finite_has_no_share_in_words() -> None:
    worst = lines(judged(run(NAMES), check("fail", value=math.inf)))["Worst check"]
    assert "no finite value, permissible 50 N m" in worst
    assert "∞" not in worst
    assert "utilisation" not in worst


def test_names_with_commas_are_quoted_in_lists() -> None:
    made = judged(
        run(NAMES),
        *(check("fail", where=name, value=60.0, note="n") for name in ("tail", "tail, aft")),
    )
    (remarks,) = (one for one in verdict.chapter(made) if isinstance(one, Points))
    assert remarks.items == ('tail, "tail, aft": what: n',)


@pytest.mark.parametrize("verdict", ["fail", "not kept"])
def test_those_tied_without_a_finite_share_rank_by_verdict_and_then_by_excess(verdict: str) -> None:
    nothing, much, little = (
        check(verdict, value=math.inf),
        *(check(verdict, value=v, limit=0.0) for v in (5.0, 0.1)),
    )
    finite, passed = check(verdict, value=1e6), check("pass", value=-3.0, limit=0.0)
    wanted = [nothing, much, little, finite, check(value=49.0), check(value=1.0), passed]
    for some in (wanted, wanted[::-1]):
        assert sorted(some, key=rank) == wanted
    assert rank(check("fail", value=0.1, limit=0.0)) < rank(check("not kept", value=math.inf))
