"""Every word, cell and curve of the chapter on stability, of results whose every value differs from every other.

Speeds are given in rpm, rates in 1/s; what is expected of them is written as an engineer would work it out.
"""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from tests.output.drawn import levels, plot

import torsion
from torsion.analyses.lateral.misaligned_shaft import MisalignedShaft
from torsion.analyses.lateral.shaft_bending import InPlanes, Lateral, ShaftFound
from torsion.analyses.lateral.tilt_stability import Tilting, TiltRange
from torsion.analyses.stability.stability_over_speed import Stability, StabilityMap
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.findings import Findings
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Table
from torsion.output.chapters.stability_ranges import MODEL, chapter, restrictions, tilt_section
from torsion.output.numbers import NONE
from torsion.output.reported_values import unstable_rpm
from torsion.rules.verdict_line import Check, Checks

RPM = 30.0 / math.pi
TRAIN = "train: [disc: {name: drive, inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
OPERATED = "operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}, rated: {speed: 750 rpm, power: 1 kW}}\n"
KIND = "principal of mode 3 (2 w3)"


@pytest.fixture(scope="module")
def bare() -> Findings:
    """A train without any speeds."""
    return torsion.run(torsion.parse(f"name: still\n{TRAIN}"))


@pytest.fixture(scope="module")
def operated() -> Findings:
    """The same between 300 and 900 rpm."""
    return torsion.run(torsion.parse(f"name: turning\n{OPERATED}{TRAIN}"))


def zone(first: float, at: float, last: float, growth: float, **ends: Any) -> UnstableRange:
    """An unstable range, speeds in rpm."""
    unknown = tuple(None if one is None else one / RPM for one in ends.get("unknown", (None, None)))
    is_open = ends.get("is_open", (False, False))
    return UnstableRange(
        "principal", (3,), 1, first / RPM, last / RPM, is_open, growth, at / RPM, unknown
    )


RANGE = zone(420.0, 450.0, 480.0, 1.5)
STABILITY = Stability(
    speed=np.array([300.0, 340.0, 420.0, 450.0, 480.0, 600.0, 900.0]) / RPM,
    requested=np.array([True, True, False, False, False, True, True]),
    growth=np.array([-0.5, -0.4, 0.3, 1.5, 0.2, -0.7, -0.8]),
    frequency=np.arange(7.0),
    amplitude_growth=np.arange(7.0),
    ranges=(RANGE,),
    modes=np.array([11.0, 22.0, 33.0, 44.0, 55.0, 66.0, 77.0]),
    method="monodromy",
    check=0.001234,
    unsolved=np.empty(0),
    loses=True,
)


def check(value: float, verdict: Any = "fail", clause: str = "stability", **more: Any) -> Check:
    """A verdict at 450 rpm."""
    where = more.pop("where", "whole train")
    return Check(
        "stability",
        clause,
        where,
        "growth",
        value,
        0.0,
        "1/s",
        verdict,
        "by definition",
        450.0 / RPM,
        note=more.get("note", ""),
    )


def with_stability(findings: Findings, line: Check | None = None, **changed: Any) -> Findings:
    """The findings with that stability, changed, and its verdict."""
    lines = (check(9.0, clause="another"), line or check(1.5))
    return findings.having(stability=replace(STABILITY, **changed), checks=Checks(lines))


def stated(blocks: list[Block]) -> list[tuple[str, str]]:
    """Paragraphs with their kind."""
    return [(block.text, block.kind) for block in blocks if isinstance(block, Paragraph)]


def tables(blocks: list[Block]) -> list[Table]:
    return [block for block in blocks if isinstance(block, Table)]


def grown(block: Block) -> dict[str, Any]:
    """What a figure of growth rates draws."""
    assert isinstance(block, Figure)
    line = block.lines["growth rate"]
    unstable = [
        (band.low, band.high, band.label) for band in plot(block).bands if band.kind == "unstable"
    ]
    return {
        "speed": line.x.tolist(),
        "growth": line.y.tolist(),
        "rated": levels(block)["rated speed"][0],
        "unstable": unstable,
    }


def test_without_stability_there_is_no_chapter(operated: Findings) -> None:
    assert list(chapter(operated)) == []


def test_introduction_counts_speeds_and_lists_the_first_six_modes(operated: Findings) -> None:
    blocks = list(chapter(with_stability(operated)))
    assert [type(block) for block in blocks] == [Heading, Paragraph, Paragraph, Table, Figure]
    assert stated(blocks)[0] == (
        (
            f"{MODEL} 4 speeds of drive as requested, 3 more near unstable ranges. Monodromy matrix and "
            "Hill matrix differ by at most 0.0012 1/s. Elastic modes with straight joints: w1 = 11.000, w2 = 22.000, "
            "w3 = 33.000, w4 = 44.000, w5 = 55.000, w6 = 66.000 rad/s and higher."
        ),
        "plain",
    )


@pytest.mark.parametrize(
    ("changed", "words"),
    [
        ({"modes": np.arange(1.0, 7.0)}, "w6 = 6.0000 rad/s."),
        (
            {"check": math.nan},
            "near unstable ranges. The second method is too large for this train. The growth rates are from one method.",
        ),
        (
            {"check": math.nan, "growth": np.full(7, np.nan)},
            "near unstable ranges. No periodic motion was found at any speed, so that no growth rate is known.",
        ),
        (
            {"check": math.nan, "growth": np.array([np.nan, -1.0, *[np.nan] * 5])},
            "near unstable ranges. The second method is too",
        ),
        (
            {"kept": 3, "left_out": 0.005678},
            (
                "1/s. The model has 3 of 7 elastic modes. With twice as many modes the growth rates change by at most "
                "0.0057 1/s."
            ),
        ),
        ({"loses": False}, "1/s. The train has no damping: the minimum growth is 0. Elastic"),
    ],
)
def test_introduction_says_how_sure_the_rates_are(
    operated: Findings, changed: dict[str, Any], words: str
) -> None:
    assert words in stated(list(chapter(with_stability(operated, **changed))))[0][0]


@pytest.mark.parametrize(
    ("line", "text", "kind"),
    [
        (check(-0.4, "pass"), "No deviation grows at any speed in {}.", "pass"),
        (
            check(math.inf, note="no motion"),
            "Stability is not known at every speed in {}: no motion.",
            "fail",
        ),
        (
            check(0.0, note="a part"),
            "No unstable range was found, but {} is not covered completely: a part.",
            "fail",
        ),
        (
            check(0.5),
            "The train is unstable in {}: maximum growth 0.5000 1/s at 450.00 rpm.",
            "fail",
        ),
    ],
)
def test_verdict_in_words(
    operated: Findings, bare: Findings, line: Check, text: str, kind: str
) -> None:
    for findings, where in ((operated, "the operation"), (bare, "the speeds requested")):
        assert stated(list(chapter(with_stability(findings, line))))[1] == (
            text.format(where),
            kind,
        )


def test_ranges_with_growth_per_revolution_and_what_lies_in_the_operation(
    operated: Findings, bare: Findings
) -> None:
    ranges = (
        zone(599.999, 600.0, 610.0, 2.0),
        zone(590.0, 600.0, 600.001, 2.0),
        zone(910.0, 920.0, 930.0, 3e5, is_open=(True, False)),
        zone(700.0, 705.0, 710.0, 1.5, unknown=(None, 720.0)),
        zone(870.0, 880.0, 890.0, 2.5, is_open=(False, True)),
        zone(820.0, 825.0, 830.0, 3.5, unknown=(810.0, None)),
    )
    rows = (
        ("599.999000", "610.000000", KIND, "2.0000", "600.0000", "UNSTABLE", NONE),
        ("590.000000", "600.001000", KIND, "2.0000", "600.0000", "UNSTABLE", NONE),
        (
            "910.000000",
            "930.000000",
            KIND,
            "300000",
            "920.0000",
            "outside",
            "continues below 910 rpm (not requested)",
        ),
        (
            "700.000000",
            "710.000000",
            KIND,
            "1.5000",
            "705.0000",
            "UNSTABLE",
            "710 to 720 rpm not known",
        ),
        (
            "870.000000",
            "890.000000",
            KIND,
            "2.5000",
            "880.0000",
            "UNSTABLE",
            "continues above 890 rpm (not requested)",
        ),
        (
            "820.000000",
            "830.000000",
            KIND,
            "3.5000",
            "825.0000",
            "UNSTABLE",
            "810 to 820 rpm not known",
        ),
    )
    found = tables(list(chapter(with_stability(operated, ranges=ranges))))[0]
    assert found.rows == rows
    assert found.marks == ("fail", "fail", "note", "fail", "fail", "fail")
    assert found.caption == found.short == "Unstable ranges of speed"
    assert [column.title for column in found.columns][3:] == [
        "Maximum growth",
        "Speed",
        "In the operating range",
        "Beyond the range",
    ]
    assert {
        row[5] for row in tables(list(chapter(with_stability(bare, ranges=ranges))))[0].rows
    } == {"UNSTABLE"}
    plain = tables(list(chapter(with_stability(operated))))[0]
    assert plain.rows == (("420.000000", "480.000000", KIND, "1.5000", "450.0000", "UNSTABLE"),)
    assert plain.caption == "Unstable ranges of speed"


def test_of_more_than_thirty_ranges_thirty_are_listed_and_all_counted(operated: Findings) -> None:
    ranges = tuple(zone(300.0 + k, 300.2 + k, 300.4 + k, 1.0) for k in range(31))
    found = tables(list(chapter(with_stability(operated, ranges=ranges))))[0]
    assert (len(found.rows), found.caption) == (30, "Unstable ranges of speed; the first 30 of 31")
    found = tables(list(chapter(with_stability(operated, ranges=ranges[1:]))))[0]
    assert (len(found.rows), found.caption) == (30, "Unstable ranges of speed")


def test_speeds_without_an_answer_and_the_curve_of_growth(operated: Findings) -> None:
    speed = np.arange(301.0, 332.0) / RPM
    blocks = list(chapter(with_stability(operated, ranges=(), unsolved=speed)))
    assert [type(block) for block in blocks] == [Heading, *[Paragraph] * 3, Figure]
    words = "No periodic motion was found at 31 speeds; stability is not known there."
    assert stated(blocks)[-1] == (words, "fail")
    assert grown(list(chapter(with_stability(operated)))[-1]) == {
        "speed": pytest.approx([300.0, 340.0, 420.0, 450.0, 480.0, 600.0, 900.0]),
        "growth": STABILITY.growth.tolist(),
        "rated": pytest.approx(750.0),
        "unstable": [(pytest.approx(420.0), pytest.approx(480.0), KIND)],
    }


def test_restrictions_name_the_ranges_and_where_nothing_is_known(operated: Findings) -> None:
    """Speeds without a motion are not repeated where a range ends at them, below or above."""
    growth = np.array(
        [-0.5, np.nan, 0.3, np.nan, 0.2, np.nan, -0.8]
    )  # unknown: 300 to 420, 420 to 480, 480 to 900
    words = "No periodic motion was found from {} rpm; stability is not known there."
    for ends, missing in (
        ({}, ["300 to 420", "420 to 480", "480 to 900"]),
        ({"unknown": (300.0, None)}, ["480 to 900"]),
        ({"unknown": (None, 900.0)}, ["300 to 420", "420 to 480"]),
    ):
        one = zone(420.0, 421.0, 422.0, 1.5, **ends)
        if ends.get("unknown", (None,))[0] is None:
            one = replace(one, last=850.0 / RPM)
        found = with_stability(operated, growth=growth, ranges=(one,))
        lines = restrictions(found, found.need(Stability))
        assert lines[0].startswith("Unstable range: ")
        assert lines[0].endswith("Not for operation.")
        assert lines[1:] == [words.format(band) for band in missing]
    silent = with_stability(operated, check(math.inf, note="no motion at all"), growth=growth)
    assert restrictions(silent, silent.need(Stability)) == [
        f"Unstable range: 420.0 to 480.0 rpm, {KIND}. Not for operation.",
        "Stability of the whole train not computed: no motion at all.",
    ]


def test_boundaries_of_a_restriction_are_not_rounded_beyond_the_speeds_requested(
    operated: Findings,
) -> None:
    speed = np.array([300.04, 340.0, 700.0, 899.96]) / RPM
    wide = zone(300.07, 500.0, 899.93, 1.5)
    found = with_stability(operated, speed=speed, growth=np.full(4, 1.0), ranges=(wide,))
    assert restrictions(found, found.need(Stability)) == [
        f"Unstable range: 300.04 to 899.96 rpm, {KIND}. Not for operation."
    ]


def mapped(findings: Findings, growth: np.ndarray, **changed: Any) -> list[Block]:
    """The map over 300, 500 and 700 rpm."""
    value = np.linspace(0.2, 0.4, growth.shape[1])
    found = StabilityMap(
        "angle", np.array([300.0, 500.0, 700.0]) / RPM, value, growth, 4, 9, 0.001234, 5, 0
    )
    return list(chapter(findings.having(stability_map=replace(found, **changed))))


GROWN = np.array(
    [[-3.0, 2e-5, np.nan, 5e-6], [-1.0, 0.5, np.nan, -5.0], [-2.0, np.nan, np.nan, -6.0]]
)


def test_map_by_value(operated: Findings) -> None:
    """A growth below 1e-5 /s is rounding: deviations grow at 20 degrees alone, where 2e-5 and 0.5 are found."""
    blocks = mapped(operated, GROWN, value=np.radians([10.0, 20.0, 30.0, 40.0]))
    assert [type(block) for block in blocks] == [Heading, Heading, Paragraph, Figure]
    assert [block.text for block in blocks if isinstance(block, Heading)] == [
        "Stability",
        "Map over speed and joint angle",
    ]
    assert [block.level for block in blocks if isinstance(block, Heading)] == [1, 2]
    assert stated(blocks) == [
        (
            (
                "Growth over speed and joint angle, on 4 of 9 elastic modes. At 5 points the full model was also "
                "computed: maximum difference 0.0012 1/s. Small deviations grow at 1 of 4 values of the joint "
                "angle. At 4 of 12 points no periodic motion was found; they are "
                "hatched."
            ),
            "note",
        )
    ]
    cells = plot(blocks[-1]).cells
    np.testing.assert_array_equal(cells.values, GROWN.T)
    assert cells.x == pytest.approx([300.0, 500.0, 700.0])
    assert cells.y == pytest.approx([10.0, 20.0, 30.0, 40.0])
    assert plot(blocks[-1]).y.title == "joint angle, deg"
    assert levels(blocks[-1]) == {"rated speed": [pytest.approx(750.0)]}


def test_map_over_a_factor_has_no_unit_and_says_where_it_found_another_motion(
    operated: Findings,
) -> None:
    blocks = mapped(
        operated,
        np.full((3, 2), -1.0),
        over="torque",
        value=np.array([0.5, 2.0]),
        elsewhere=1,
        checked=1,
    )
    assert stated(blocks) == [
        (
            (
                "Growth over speed and factor on the mean torque, on 4 of 9 elastic modes. At 1 point the full model was "
                "also computed: maximum difference 0.0012 1/s. Small deviations grow at 0 of 2 values of the factor on "
                "the mean torque. At 1 point it settled in another periodic motion."
            ),
            "plain",
        )
    ]
    assert plot(blocks[-1]).y.title == "factor on the mean torque"
    assert plot(blocks[-1]).cells.y.tolist() == [0.5, 2.0]


@pytest.mark.parametrize(
    ("ranges", "words"),
    [
        ((zone(320, 330, 480, 1),), " 1 of the 1 unstable range above, between its speeds."),
        (
            (zone(320, 330, 480, 1), zone(300, 310, 320, 1), zone(510, 530, 550, 1)),
            " 2 of the 3 unstable ranges above, between its speeds.",
        ),
        (
            (zone(320, 330, 480, 1), zone(450, 460, 500, 1), zone(490, 500, 600, 1)),
            " 1 of the 3 unstable ranges above, between its speeds.",
        ),
        ((zone(290, 295, 310, 1), zone(690, 700, 710, 1)), ""),
    ],
)
def test_map_says_how_many_ranges_fall_between_its_speeds(
    operated: Findings, ranges: tuple[UnstableRange, ...], words: str
) -> None:
    both = with_stability(operated, ranges=ranges)
    text = stated(mapped(both, np.full((3, 2), -1.0)))[-1][0]
    said = f" The map has 3 speeds only. It does not show{words}"
    assert text.endswith(f"joint angle.{said if words else ''}")


SHAFT = MisalignedShaft(
    4.0, 0.25, 1.0, (3.0, 5.0), (24.0, 56.0), 1.0, 0.1
)  # decays 56/4/2 and 24/4/2 1/s


def tilting(name: str, *zones: TiltRange) -> ShaftFound:
    """A shaft that tilts."""
    over = Tilting(
        f"joint of {name}",
        SHAFT,
        {"y": 7.5, "z": 8.5},
        np.array([300.0, 900.0]) / RPM,
        np.array([-0.5, 0.6]),
        zones,
    )
    none = np.empty(0)
    return ShaftFound(name, (0,), 1, 1.0, none, (), InPlanes(none, none), (), None, (), 3, over)  # type: ignore[arg-type]


def tilt_zone(lower: float, worst: float, upper: float, kind: str, **ends: Any) -> TiltRange:
    """An unstable range of the tilt, speeds in rpm."""
    return TiltRange(
        lower / RPM, upper / RPM, ends.get("is_open", (False, False)), kind, worst / RPM, 0.125
    )


def test_tilting_shafts_by_title_and_their_verdicts(operated: Findings) -> None:
    lines = (
        check(-0.5, "pass", "tilting", where="front"),
        check(0.0, "fail", "tilting", where="tail", note="in part"),
        check(0.75, "fail", "tilting", where="end"),
        check(0.25, "fail", "tilting", where="stub", note="short"),
        check(3.0, "fail"),
    )
    found = operated.having(checks=Checks(lines))
    still = replace(tilting("still"), tilting=None)
    blocks = list(tilt_section(found, (still, tilting("front"), tilting("tail"))))
    assert [type(block) for block in blocks] == [
        Heading,
        Paragraph,
        Table,
        *[Paragraph] * 4,
        Figure,
        Figure,
    ]
    assert (blocks[0].text, blocks[0].level) == ("Parametric stability of the tilt", 2)
    numbers = ("4.0000", "1.0000", "7.5000", "8.5000", "3.0000", "7.0000")
    assert tables(blocks)[0].rows == (
        ("front", "joint of front", *numbers),
        ("tail", "joint of tail", *numbers),
    )
    assert stated(blocks)[1:] == [
        ("No tilting motion of front grows at the computed speeds.", "pass"),
        ("No tilting motion of tail grows at the computed speeds (in part).", "fail"),
        ("end is unstable: its tilt grows by up to 0.7500 1/s at 450.00 rpm.", "fail"),
        ("stub is unstable: its tilt grows by up to 0.2500 1/s at 450.00 rpm (short).", "fail"),
    ]
    assert [block.name for block in blocks if isinstance(block, Figure)] == [
        "tilting-1",
        "tilting-2",
    ]
    assert grown(blocks[-1]) == {
        "speed": pytest.approx([300.0, 900.0]),
        "growth": [-0.5, 0.6],
        "rated": pytest.approx(750.0),
        "unstable": [],
    }
    assert list(tilt_section(found, (still,))) == []


def test_unstable_ranges_in_rpm_are_those_of_the_train_and_of_the_tilt_of_shafts(
    operated: Findings,
) -> None:
    shafts = (
        replace(tilting("still"), tilting=None),
        tilting("tail", tilt_zone(310, 320, 340, "several")),
    )
    found = with_stability(operated, ranges=(RANGE,)).having(lateral=Lateral(shafts, ()))
    assert list(unstable_rpm(found)) == [
        pytest.approx((RANGE.first * RPM, RANGE.last * RPM)),
        pytest.approx((310.0, 340.0)),
    ]


def test_ranges_of_the_tilt_within_and_outside_the_operation(
    operated: Findings, bare: Findings
) -> None:
    zones = (
        tilt_zone(250, 260, 299, "several"),
        tilt_zone(310, 320, 340, "mean couple", is_open=(True, False)),
        tilt_zone(890, 895, 910, "sum of 1 and 2", is_open=(False, True)),
        tilt_zone(901, 905, 910, "principal of 2"),
    )
    shafts = (tilting("calm"), tilting("tail", *zones))
    blocks = list(tilt_section(operated.having(checks=Checks(())), shafts))
    found = tables(blocks)[1]
    assert found.rows == (
        (
            "tail",
            "250.000000",
            "299.000000",
            "several resonances together",
            "0.12500",
            "260.0000",
            "outside",
            NONE,
        ),
        (
            "tail",
            "310.000000",
            "340.000000",
            "excited by the mean couple",
            "0.12500",
            "320.0000",
            "UNSTABLE",
            "continues below 310 rpm (not requested)",
        ),
        (
            "tail",
            "890.000000",
            "910.000000",
            "sum of 1 and 2",
            "0.12500",
            "895.0000",
            "UNSTABLE",
            "continues above 910 rpm (not requested)",
        ),
        (
            "tail",
            "901.000000",
            "910.000000",
            "principal of 2",
            "0.12500",
            "905.0000",
            "outside",
            NONE,
        ),
    )
    assert found.marks == ("note", "fail", "fail", "note")
    assert grown(blocks[-1])["unstable"][0] == (
        pytest.approx(250.0),
        pytest.approx(299.0),
        "several resonances together",
    )
    blocks = list(tilt_section(bare.having(checks=Checks(())), shafts))
    assert {row[6] for row in tables(blocks)[1].rows} == {"UNSTABLE"}
