"""The tables of critical speeds and the Campbell diagram, of crossings written by hand."""

import math
from dataclasses import replace
from fractions import Fraction

import pytest
from tests.output.drawn import bands, levels, marks, plot

import torsion
from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.output.blocks import Figure, Heading, Paragraph, Table
from torsion.output.chapters.modes.critical_speeds import chapter, matrix
from torsion.rules.verdict_line import BarredRange, Check, Checks

RPM = 30.0 / math.pi
TEXT = """
name: two discs
operation: {speeds: {from: 5 rad/s, to: 15 rad/s, steps: 3}, rated: {speed: 12 rad/s}}
train: [disc: {name: a, inertia: 2}, coupling: {stiffness: 120}, disc: {name: far, inertia: 3}]
excitations: [{at: far, order: 1, torque: 1}]
"""


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.parse(TEXT))


def crossing(
    findings: Findings, order: object, mode: int, speed: float, inside: bool
) -> CriticalSpeed:
    made = findings.need(CriticalSpeeds).crossings[0]
    return replace(
        made,
        order=Fraction(order),
        mode=mode,
        speed=speed,
        frequency=50.0 - speed,
        is_inside=inside,
        margin=speed / 12.0 - 1.0,
        sources=("x", "far"),
        own_orders=(Fraction(order),) * 2,
    )


def having(findings: Findings, *found: CriticalSpeed) -> Findings:
    return findings.having(critical_speeds=CriticalSpeeds(found))


def tables(findings: Findings) -> list[Table]:
    return [block for block in chapter(findings) if isinstance(block, Table)]


def figure(findings: Findings) -> Figure:
    return next(block for block in chapter(findings) if isinstance(block, Figure))


def text(findings: Findings) -> str:
    return next(block.text for block in chapter(findings) if isinstance(block, Paragraph))


def test_order_by_mode_and_those_in_the_range(found: Findings) -> None:
    made = having(
        found,
        crossing(found, 3, 1, 13.0, True),
        crossing(found, "1/2", 1, 60.0, False),
        crossing(found, 3, 2, 20.0, False),
        crossing(found, "9/2", 2, 12.6, True),
    )
    (made_matrix,), (inside,) = list(matrix(made)), tables(made)
    assert [column.title for column in made_matrix.columns] == [
        "Order",
        "Excited by",
        "Mode 1",
        "Mode 2",
    ]
    assert made_matrix.caption.endswith("; the speed range is 47.7465 to 143.239 rpm")
    assert made_matrix.rows == (
        ("0.5", "0.5 × x, far", "572.96", "–"),
        ("3", "3 × x, far", "124.14", "190.99"),
        ("4.5", "4.5 × x, far", "–", "120.32"),
    )
    assert inside.rows == (
        ("120.32", "4.5", "2", "37.400", "5.00", "4.5 × x, far"),
        ("124.14", "3", "1", "37.000", "8.33", "3 × x, far"),
    )
    assert inside.caption == inside.short == "Critical speeds in the speed range"
    assert "The speed range 47.7465 to 143.239 rpm has 2 of 4 critical speeds." in text(made)
    assert next(iter(chapter(made))) == Heading("Critical speeds")


@pytest.mark.parametrize(
    ("inside", "said"),
    [
        ([True], "has 1 of 1 critical speed."),
        ([False, False], "has 0 of 2 critical speeds."),
        ([True, True, False], "has 2 of 3 critical speeds."),
    ],
)
def test_how_many_lie_in_the_range(found: Findings, inside: list[bool], said: str) -> None:
    made = having(found, *(crossing(found, k, 1, 10.0 + k, one) for k, one in enumerate(inside, 1)))
    assert said in text(made)


def test_without_a_rated_speed_there_is_no_distance() -> None:
    bare = torsion.run(torsion.parse(TEXT.replace(", rated: {speed: 12 rad/s}", "")))
    (row,) = tables(bare)[0].rows
    assert row == ("95.493", "1", "1", f"{10 / (2 * math.pi):.4f}", "1 × far")
    assert "rated speed" not in levels(figure(bare))


@pytest.mark.parametrize(("number", "rest"), [(60, ""), (61, " (the lowest 60 of 61)")])
def test_sixty_speeds_stand_in_the_list(found: Findings, number: int, rest: str) -> None:
    made = tables(
        having(found, *(crossing(found, k, 1, 200.0 - k, True) for k in range(1, number + 1)))
    )[0]
    assert made.caption == f"Critical speeds in the speed range{rest}"
    assert made.short == "Critical speeds in the speed range"
    assert [row[1] for row in made.rows] == [str(number - k) for k in range(60)]


def test_campbell_diagram(found: Findings) -> None:
    """Of more than twelve orders those that meet a mode in the range come first, then the lowest."""
    line = Check(
        "r",
        "c",
        "w",
        "w",
        1.0,
        2.0,
        "N m",
        "pass",
        "setting",
        barred=(BarredRange(6.0, 7.0, 6.5, "s"),),
    )
    made = having(found, *(crossing(found, k, 1, 10.0 + k, k in (14, 9)) for k in range(1, 15)))
    drawn = figure(made.having(checks=Checks((line,))))
    shown = [*range(1, 12), 14]
    assert list(drawn.lines) == [f"order {k}" for k in shown]
    assert drawn.caption == "Campbell diagram (lines of 12 of 14 orders)"
    for k in shown:  # a line of n times the speed in rpm / 60
        assert drawn.lines[f"order {k}"].y == pytest.approx(k * drawn.lines[f"order {k}"].x / 60.0)
    right, top = plot(drawn).x.high, plot(drawn).y.high
    for inside, name in (
        (True, "critical speed in the range"),
        (False, "critical speed outside the range"),
    ):
        places = [((10.0 + k) * RPM, 40.0 - k) for k in shown if (k in (14, 9)) == inside]
        met = [place for place in places if place[0] <= right and place[1] <= top]
        assert marks(drawn, name) == [pytest.approx(place) for place in met]
    said = next(one.words for one in plot(drawn).marks if one.name.endswith("outside the range"))
    assert (
        said[0]
        == "critical speed 152.79 rpm: order 6 excites mode 1 at 34.000 Hz, 33.3 % from rated"
    )  # 16 rad/s, 50 - 16 Hz
    for place, frequency in enumerate(made.need(Modes).frequency.tolist(), start=1):
        if frequency <= top:
            assert levels(drawn)[f"mode {place}: {frequency:.4f} Hz"] == [frequency]
    assert bands(drawn, "range") == [pytest.approx((5.0 * RPM, 15.0 * RPM))]
    assert levels(drawn)["rated speed"] == [pytest.approx(12.0 * RPM)]
    assert bands(drawn, "barred") == [pytest.approx((6.0 * RPM, 7.0 * RPM))]


def test_nothing_without_crossings_or_a_range(found: Findings) -> None:
    assert list(chapter(having(found))) == []
    alone = replace(
        found.study, operation=found.study.operation.model_copy(update={"speeds": None})
    )
    assert list(chapter(replace(found, study=alone))) == []
