"""The first page: its headline for every set of verdicts, what colours the train, its speeds, words beside colour."""

import itertools
import math
import xml.etree.ElementTree as ET
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.critical import CriticalSpeeds
from torsion.findings import Findings, Unanswered
from torsion.output.blocks import Box, Figure, PageEnd
from torsion.output.chapters import verdict
from torsion.output.check_words import NOT_JUDGED, percent, use, use_of_part
from torsion.output.drawing.pens import GRADES
from torsion.output.drawing.svg import svg
from torsion.output.drawing.words import GROWTH, width
from torsion.output.figures.figure import Disc, Link, Shares, Sketch, Use
from torsion.output.figures.figure import Figure as Drawing
from torsion.output.headline import headline
from torsion.rules.verdict_line import BarredRange, Check, Checks

RPM = 30.0 / math.pi
SVG = "{http://www.w3.org/2000/svg}"
TRAIN = """
name: two shafts with a gear between them
operation: {at: flywheel, speeds: {from: 100 rpm, to: 600 rpm, steps: 6}, rated: {speed: 450 rpm}}
train:
- disc: {name: flywheel, inertia: 2}
- shaft: {name: quick, length: 1 m, diameter: 40 mm}
- gear: {name: stage, ratio: 5/2, inertia: [0.5, 1.5], mesh_stiffness: 40 kN*m/rad}
- shaft: {name: slow, length: 1 m, diameter: 60 mm}
- propeller: {name: screw, inertia: 12, damping: 3}
excitations: [{at: flywheel, order: 2, torque: 3}]
"""
LOST = Unanswered(
    "lateral", "bending of the shafts", "it does not converge", "", None, False, False, ""
)


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TRAIN))


def check(verdict: str = "pass", **changed: object) -> Check:
    made = Check(
        "rule", "clause", "slow", "what", 12.5, 50.0, "N/mm2", verdict, "setting", 30.0, Fraction(2)
    )
    return replace(made, **changed)


def judged(findings: Findings, *checks: Check, unanswered: tuple[Unanswered, ...] = ()) -> Findings:
    made = findings.having(checks=Checks(checks))
    return replace(made, plan=replace(made.plan, unanswered=unanswered))


def page(findings: Findings) -> list[object]:
    blocks = list(verdict.chapter(findings))
    return blocks[: blocks.index(PageEnd())]


def figure(findings: Findings, name: str) -> Drawing:
    return next(
        one for one in verdict.chapter(findings) if isinstance(one, Figure) and one.name == name
    )


WORD = {
    "pass": "PASS",
    "restricted": "PASS with restrictions",
    "not judged": "NOT JUDGED",
    "fail": "FAIL",
    "not kept": "FAIL",
}
LOOK = {
    "PASS": ("pass", "✓"),
    "PASS with restrictions": ("note", "!"),
    "NOT JUDGED": ("note", "?"),
    "FAIL": ("fail", "✗"),
}


@for_all("verdicts", [rows for size in range(5) for rows in itertools.combinations(WORD, size)])
@for_all("is_answered", [True, False])
def test_the_headline_of_every_combination_of_verdicts(
    found: Findings, verdicts, *, is_answered: bool
) -> None:
    """The worst word of all rows and one clause; PASS alone is green."""
    lines = (
        check(one, restrictions=("kept below 90 rpm",) * (one == "restricted")) for one in verdicts
    )
    made = judged(found, *lines, unanswered=() if is_answered else (LOST,))
    (sign, words), kind = headline(made)
    every = {WORD[one] for one in verdicts} | (
        {"NOT JUDGED"} if not is_answered or not verdicts else set()
    )
    wanted = next(
        word for word in ("FAIL", "NOT JUDGED", "PASS with restrictions", "PASS") if word in every
    )
    word, _, clause = words.partition(": ")
    assert (word, kind, sign) == (wanted, *LOOK[wanted])
    assert clause
    assert not any(other in clause for other in ("PASS", "FAIL", "NOT"))
    (box,) = (one for one in page(made) if isinstance(one, Box))
    assert (box.sign, box.text, box.kind) == (sign, words, kind)
    lines = dict(box.lines)
    assert ("Not computed" in lines) == (not is_answered)
    if verdicts:
        counts = [
            one.split(" ", 1) for one in lines["Checks"].split(": ")[1].split(". ")[0].split(", ")
        ]
        assert {name: int(number) for number, name in counts} == Counter(
            WORD[one] for one in verdicts
        )


def test_the_headline_of_a_file_that_names_no_rule(found: Findings) -> None:
    bare = replace(judged(found), study=replace(found.study, rules=()))
    assert headline(bare) == (("?", "NOT JUDGED: no rule is named"), "note")


def test_models_that_do_not_agree_are_a_failure(found: Findings) -> None:
    class Differing:
        fails = True

    assert headline(judged(found, check()).having(check=Differing()))[0][1].startswith("FAIL: ")


def test_the_worst_check_stands_in_the_box_with_value_limit_and_speed(found: Findings) -> None:
    lines = (
        check(value=40.0),
        check("not kept", where="quick", value=55.0, clause="tau_C"),
        check(value=10.0),
    )
    (box,) = (one for one in page(judged(found, *lines)) if isinstance(one, Box))
    worst = dict(box.lines)["Worst check"]
    assert worst.startswith(
        "quick: what 55.000 N/mm², permissible 50 N/mm²: utilisation 110 %, at 286.48 rpm, mainly order 2 ×"
    )
    assert "τ_C, rule; basis: stated by user" in worst


@for_all(
    ("checks", "grade", "words"),
    [
        ([], "not judged", ""),
        ([check(value=10.0), check(value=30.0)], "middle", "✓ PASS 60.0 %"),
        ([check(value=24.0)], "low", "✓ PASS 48.0 %"),
        ([check(value=49.99)], "high", "✓ PASS 99.980 %"),
        ([check("fail", value=50.01)], "over", "✗ FAIL 100.02 %"),
        ([check("fail", value=51.0), check("not kept", value=99.0)], "over", "✗ FAIL 102 %"),
        ([check("not kept", value=60.0), check(value=45.0)], "over", "✗ FAIL 120 %"),
        ([check("fail", value=math.inf)], "no answer", "✗ FAIL"),
        ([check("restricted", limit=math.nan)], "not judged", ""),
        ([check("fail", value=5.0, limit=0.0)], "over", "✗ FAIL"),
        ([check(value=30.0, unit="N m"), check(value=20.0)], "middle", "✓ PASS 60.0 %"),
    ],
)
def test_a_part_has_the_grade_of_its_worst_stress_or_torque(
    checks: list[Check], grade: str, words: str
) -> None:
    for some in itertools.permutations(checks):
        made = use_of_part(some)
        assert (made.grade, made.words) == (grade, words)


@pytest.mark.parametrize("unit", ["mm", "rad/s2", "1", "1/s"])
def test_a_diameter_never_colours_and_is_stated_where_it_is_not_kept(unit: str) -> None:
    least = check(
        "not kept", value=90.0, limit=99.0, unit=unit, at_least=True, clause="minimum diameter"
    )
    assert use_of_part([least, check(value=5.0)]).grade == "low"
    assert (
        use_of_part([least, check(value=5.0)]).words
        == "✓ PASS 10.0 %\n✗ FAIL 110 %:\nminimum diameter"
    )
    assert use_of_part([least]).grade == "not judged"
    assert "FAIL" in use_of_part([least]).words
    assert use_of_part([replace(least, verdict="pass", value=100.0)]) == NOT_JUDGED


def test_no_share_over_the_limit_reads_as_the_limit() -> None:
    assert [percent(one) for one in (1.0004, 0.9996, 0.5, 0.0, 1.27)] == [
        "100.04 %",
        "99.960 %",
        "50.0 %",
        "0 %",
        "127 %",
    ]


def test_every_shaft_and_judged_gear_has_its_use_and_the_worst_is_pointed_at(
    found: Findings,
) -> None:
    checks = (
        check(value=20.0),
        check("fail", where="stage", value=60.0, unit="N m"),
        check(where="quick", value=45.0),
    )
    (drawn,) = figure(judged(found, *checks), "utilisation").panels
    assert isinstance(drawn, Sketch)
    uses = {link.label: link.use.grade for link in drawn.links if link.use is not None}
    assert uses == {"quick": "high", "stage": "over", "slow": "low"}
    place, said = drawn.worst
    gear = next(link for link in drawn.links if link.label == "stage")
    assert place == ((gear.start[0] + gear.end[0]) / 2, gear.end[1])
    assert said.words == "worst: FAIL 120 %, clause"
    (bare,) = figure(judged(found), "utilisation").panels
    assert {link.label: link.use.grade for link in bare.links if link.use} == {
        "quick": "not judged",
        "slow": "not judged",
    }
    assert bare.worst is None


CRANK = """
name: two throws
operation: {at: engine, speeds: {from: 100 rpm, to: 600 rpm, steps: 6}}
train:
- engine: {name: engine, cylinders: 2, strokes: 2, firing_order: [1, 2], crank_inertia: 1, stiffness: 2e4,
           geometry: {bore: 0.1, stroke: 0.1, rod_length: 0.2}, masses: {reciprocating: 1}}
- shaft: {name: slow, length: 1 m, diameter: 60 mm}
- propeller: {name: screw, inertia: 12, damping: 3}
"""


def test_a_crank_is_drawn_with_its_webs_and_graded_where_a_rule_judges_it() -> None:
    found = torsion.run(torsion.parse(CRANK))
    (bare,) = figure(judged(found), "utilisation").panels
    (crank,) = (link for link in bare.links if link.kind == "crank")
    assert crank.use is None
    assert [disc.kind for disc in bare.discs] == ["throw", "throw", "propeller"]
    (drawn,) = figure(
        judged(found, check("fail", where="engine crank 1-2", value=60.0)), "utilisation"
    ).panels
    (crank,) = (link for link in drawn.links if link.kind == "crank")
    assert (crank.label, crank.use.grade) == ("engine crank 1-2", "over")
    assert drawn.worst[0] == ((crank.start[0] + crank.end[0]) / 2, crank.end[1])
    plain, coloured = (svg(Drawing("utilisation", "", (one,))) for one in (bare, drawn))
    boxes = [len(list(ET.fromstring(str(text)).iter(f"{SVG}path"))) for text in (plain, coloured)]
    assert boxes[1] > boxes[0]


def test_the_speeds_drawn_are_those_of_the_results(found: Findings) -> None:
    ranges = (
        BarredRange(20.0, 30.0, 24.0, "slow", 21.0, 29.0, Fraction(2)),
        BarredRange(40.0, 45.0, 43.0, "quick"),
    )
    (plot,) = figure(judged(found, check(barred=ranges)), "speeds").panels
    bands = [(one.kind, one.low, one.high) for one in plot.bands]
    assert bands[0][0] == "range"
    np.testing.assert_allclose(bands[0][1:], (100.0, 600.0), rtol=1e-14)
    assert [one[0] for one in bands[1:]] == ["barred", "barred"]
    np.testing.assert_allclose(
        [one[1:] for one in bands[1:]], np.array([[20, 30], [40, 45]]) * RPM, rtol=1e-14
    )
    (rated,) = (one.value for one in plot.levels if one.name == "rated speed")
    assert rated == pytest.approx(450.0, rel=1e-14)
    critical = [one.value for one in plot.levels if one.name == "critical speed"]
    inside = sorted(
        one.speed * RPM for one in found.need(CriticalSpeeds).crossings if one.is_inside
    )
    assert critical == inside
    bare = "name: x\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 5}, disc: {inertia: 2}]\n"
    names = [one.name for one in page(torsion.run(torsion.parse(bare))) if isinstance(one, Figure)]
    assert names == ["utilisation"]


def test_shares_stand_in_their_order_with_their_words(found: Findings) -> None:
    checks = (
        check(value=20.0),
        check("not kept", value=60.0),
        check("fail", value=math.inf),
        check("restricted", limit=math.nan),
    )
    (drawn,) = figure(judged(found, *checks), "shares").panels
    assert isinstance(drawn, Shares)
    assert [(one.share, one.use.words) for one in drawn.rows] == [
        (math.inf, "✗ FAIL"),
        (1.2, "✗ FAIL 120 %"),
        (0.4, "✓ PASS 40.0 %"),
    ]
    assert len(figure(judged(found, *[check()] * 40), "shares").panels[0].rows) == 5


def texts(drawing: str) -> list[str]:
    return [
        "".join(one.itertext()).replace("\u200b", "")
        for one in ET.fromstring(drawing).iter(f"{SVG}text")
    ]


def test_verdicts_and_shares_are_words_too(found: Findings) -> None:
    """What colour and pattern say stands in words in the drawing, and in its description."""
    checks = (
        check(value=20.0),
        check("fail", where="stage", value=60.0, unit="N m"),
        check(where="quick", value=45.0),
    )
    for name in ("utilisation", "shares"):
        drawing = svg(figure(judged(found, *checks), name))
        for words in ("✗ FAIL 120 %", "✓ PASS 40.0 %", "✓ PASS 90.0 %"):
            assert words in texts(drawing)
            assert words in ET.fromstring(drawing).find(f"{SVG}desc").text
    shown = texts(svg(figure(judged(found, *checks), "utilisation")))
    assert {GRADES[one].words for one in ("low", "high", "over")} <= set(shown)


def luminance(colour: str) -> float:
    parts = [int(colour[k : k + 2], 16) / 255.0 for k in (1, 3, 5)]
    each = [one / 12.92 if one <= 0.04045 else ((one + 0.055) / 1.055) ** 2.4 for one in parts]
    return 0.2126 * each[0] + 0.7152 * each[1] + 0.0722 * each[2]


def test_grades_differ_in_gray_or_by_their_hatching() -> None:
    looks = list(GRADES.values())
    for one, other in itertools.combinations(looks, 2):
        light = sorted((luminance(one.fill), luminance(other.fill)))
        contrast = (light[1] + 0.05) / (light[0] + 0.05)
        assert contrast > 1.3 or (one.slopes, one.dash) != (other.slopes, other.dash)


def crowded(number: int, rows: int) -> Sketch:
    """Links with long names beside each other, on several axes, with the share of each in words."""
    uses = itertools.cycle(
        [Use("low", "✓ PASS 5.12 %", (2.0, -0.05)), Use("over", "✗ FAIL 117 %", (0.0, -1.17))]
    )
    places = [(k % (number // rows), -(k // (number // rows))) for k in range(number)]
    links = tuple(
        Link("shaft", (1.6 * x, row), (1.6 * (x + 1), row), f"intermediate shaft {k}", use=use)
        for (k, (x, row)), use in zip(enumerate(places), uses, strict=False)
    )
    discs = tuple(
        Disc(1.6 * x, row, 0.8, f"flange of the shaft {k}", "disc")
        for k, (x, row) in enumerate(places)
    )
    return Sketch(discs, links, ((4.0, 0.0), Use("over", "worst: FAIL 117 %", mark="✗")), 190.0)


def boxes(drawing: str) -> Iterable[tuple[float, float, float, float]]:
    for group in ET.fromstring(drawing).iter(f"{SVG}g"):
        if group.get("class") == "sketch":
            for one in group.iter(f"{SVG}text"):
                wide, x, y = GROWTH * width(one.text), float(one.get("x")), float(one.get("y"))
                left = x if one.get("text-anchor") is None else x - wide / 2
                yield left, y - 9.5, left + wide, y + 2.5


@pytest.mark.parametrize(("number", "rows"), [(5, 1), (20, 1), (40, 1), (40, 2), (39, 3)])
def test_words_of_a_graded_sketch_overlap_neither_each_other_nor_the_edges(
    number: int, rows: int
) -> None:
    drawing = svg(Drawing("s", "c", (crowded(number, rows),)))
    found = list(boxes(drawing))
    assert len(found) > 2 * min(number, 8)
    for left, _, right, _ in found:
        assert left >= -1e-6
        assert right <= 620.0 + 1e-6
    for one, other in itertools.combinations(found, 2):
        assert one[0] >= other[2] or other[0] >= one[2] or one[1] >= other[3] or other[1] >= one[3]
    kept, said = texts(drawing), [one for one in texts(drawing) if "want of room" in one]
    fails, passes = kept.count("✗ FAIL 117 %"), kept.count("✓ PASS 5.12 %")
    left_out = 2 * number - fails - passes - sum(one.startswith("flange") for one in kept)
    assert (f": {left_out} component" in said[0]) if left_out else not said
    assert fails >= min(passes, number // 2)


def test_a_check_in_words() -> None:
    assert use(check("restricted", limit=math.nan)).grade == "not judged"
    assert use(check(value=0.0)).words == "✓ PASS 0 %"


@pytest.mark.parametrize(("number", "words"), [(1, "critical speed"), (2, "2 critical speeds")])
def test_the_caption_of_the_speeds_names_only_what_is_drawn(
    found: Findings, number: int, words: str
) -> None:
    crossings = [one for one in found.need(CriticalSpeeds).crossings if one.is_inside][:1] * number
    one = found.having(
        critical_speeds=replace(found.need(CriticalSpeeds), crossings=tuple(crossings))
    )
    assert (
        figure(judged(one), "speeds").caption
        == f"Operating speeds of flywheel: {words} with the largest torque"
    )
    barred = check(barred=(BarredRange(20.0, 30.0, 24.0, "slow"),))
    assert figure(judged(one, barred), "speeds").caption.startswith(
        f"Operating speeds of flywheel: barred range, {words} "
    )
