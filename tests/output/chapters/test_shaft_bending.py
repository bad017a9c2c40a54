"""Every cell, word and curve of the chapter on bending, of two shafts whose every value differs from every other."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from tests.output.drawn import bands, levels, marks, named, plot, titles

import torsion
from torsion.analyses.lateral.couple_response import Answer
from torsion.analyses.lateral.misaligned_shaft import MisalignedShaft
from torsion.analyses.lateral.shaft_bending import (
    Holding,
    InPlanes,
    Lateral,
    LateralSettings,
    ShaftFound,
)
from torsion.analyses.lateral.tilt_stability import Tilting, TiltRange
from torsion.analyses.lateral.whirl import Critical, Whirl, sense
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Figure, Heading, Paragraph, Points, Table
from torsion.output.chapters.shaft_bending import AXES, STANDING, chapter
from torsion.rules.verdict_line import Checks
from torsion.study import SpeedRange

RPM = 30.0 / math.pi
TRAIN = "train: [disc: {name: drive, inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
SPEEDS = "speeds: {from: 30 rad/s, to: 90 rad/s, steps: 3}, rated: {speed: 750 rpm, power: 1 kW}"
NONE = np.empty(0)
SPEED = np.array([30.0, 60.0, 90.0])  # rad/s of the reference


@pytest.fixture(scope="module")
def operated() -> Findings:
    """A train between 30 and 90 rad/s."""
    return torsion.run(torsion.parse(f"name: turning\noperation: {{{SPEEDS}}}\n{TRAIN}"))


@pytest.fixture(scope="module")
def bare() -> Findings:
    """The same without any speeds."""
    return torsion.run(torsion.parse(f"name: still\n{TRAIN}"))


def critical(order: int, speed: float, direction: float = 1.0) -> Critical:
    """A critical speed (rad/s) with a mode, a frequency and a damping ratio of its own."""
    return Critical(order, order + 3, speed, speed / 8.0, direction, speed / 1e4)


CRITICAL = (
    critical(1, 29.0),
    critical(2, 30.0, -0.99),
    critical(1, 90.0, 0.5),
    critical(4, 91.0, -0.5),
    critical(1, 180.0, 0.05),
    critical(1, 181.0),
    critical(2, 185.0, -1.0),
    critical(2, 190.0),
)
WHIRL = Whirl(
    SPEED,
    np.array([[7.0, 5.0, np.nan, 11.0], [8.0, 9.0, np.nan, 12.0], [13.0, 3.0, np.nan, 9.0]]),
    np.array([[0.3, -1e-9, np.nan, 1e-9], [0.2, -0.1, np.nan, 0.5], [0.4, -0.2, np.nan, np.nan]]),
    np.array([[1.0, -1.0, np.nan, 0.5], [1.0, -1.0, np.nan, 0.5], [0.05, 0.5, np.nan, -0.5]]),
)


def pairs(*rows: list[float]) -> np.ndarray:
    """Amplitudes in y and z of (speeds, places): on an ellipse whose short axis is a third of the long one."""
    size = np.array(rows)
    return np.stack([size * 1j, size / 3.0], axis=-1)


def answer(order: int, moment: float, force: float, *status: Status) -> Answer:
    """At three speeds and places: displacements of 1 to 9 µm, moments and forces that many times the two values."""
    spread = np.array([[1.0, 2.0, 3.0], [4.0, 8.0, 9.0], [5.0, 7.0, 6.0]])
    return Answer(
        order,
        SPEED + order,
        pairs(*(1e-6 * spread)),
        pairs(*(moment * spread[:, ::-1])),
        pairs(*(force * spread[:, :2])),
        np.ones(3),
        np.array(status or [Status.OK] * 3, dtype=np.uint8),
    )


def shaft(name: str, **changed: Any) -> ShaftFound:
    """A shaft at half of the reference speed."""
    made = ShaftFound(
        name,
        (0,),
        Fraction(1, 2),
        1.5,
        np.array([0.25, 0.75, 1.25]),
        (Holding("front", 0.1), Holding("rear", 1.4)),
        InPlanes(np.array([6.5, 70.0]), NONE),
        CRITICAL,
        WHIRL,
        (answer(0, 20.0, 2.0), answer(2, 300.0, 30.0)),
        5,
    )
    return replace(made, **changed)


def blocks(findings: Findings, *shafts: ShaftFound, remarks: tuple[str, ...] = ()) -> list[Block]:
    return list(chapter(findings.having(lateral=Lateral(shafts, remarks), checks=Checks(()))))


def table(found: list[Block], words: str) -> Table:
    return next(block for block in found if isinstance(block, Table) and words in block.caption)


def figures(found: list[Block], plot: str) -> list[Figure]:
    return [block for block in found if isinstance(block, Figure) and block.name.startswith(plot)]


def texts(found: list[Block]) -> list[str]:
    return [block.text for block in found if isinstance(block, Heading | Paragraph)]


def test_without_bending_there_is_no_chapter(operated: Findings) -> None:
    assert list(chapter(operated)) == []


def test_blocks_of_the_chapter_in_their_order(operated: Findings) -> None:
    still = shaft("still", whirl=None, answers=())
    found = blocks(operated, still, shaft("tube"), remarks=("one", "two"))
    kinds = [
        Heading,
        Paragraph,
        Table,
        Table,
        Heading,
        Paragraph,
        Table,
        Figure,
        Heading,
        Table,
        Table,
        Figure,
    ]
    assert [type(block) for block in found] == [*kinds, Heading, Points]
    assert [block.level for block in found if isinstance(block, Heading)] == [1, 2, 2, 2]
    assert texts(found) == [
        "Bending of the shafts",
        f"Speeds are speeds of drive. {AXES}",
        "Whirl over the speed",
        "1 of the modes below are unstable in the speed range.",
        "Response to the secondary couples",
        "Not computed for the bending",
    ]
    assert [block.name for block in found if isinstance(block, Figure)] == ["whirl-2", "bending-2"]
    assert found[-1] == Points(("one", "two"))
    assert [type(block) for block in blocks(operated, still)] == kinds[:4]
    assert not figures(blocks(operated, still, still), "whirl")


def test_supports_and_lowest_frequencies_at_rest(operated: Findings) -> None:
    found = table(blocks(operated, shaft("tube")), "and their supports")
    assert found.rows == (
        ("tube", "1.5000", "1/2", "front at 0.1000 m, rear at 1.400 m", "6.50000", "–"),
    )
    other = shaft("tube", at_rest=InPlanes(NONE, np.array([8.5])))
    assert table(blocks(operated, other), "and their supports").rows[0][4:] == ("–", "8.50000")


def test_critical_speeds_up_to_twice_the_range_and_two_of_every_order(operated: Findings) -> None:
    found = table(blocks(operated, shaft("tube", whirl=None)), "Critical bending")
    words = (
        "forward",
        "backward",
        "forward, ellipse",
        "backward, ellipse",
        "nearly in a plane",
        "backward",
    )
    shown = [one for one in CRITICAL if one.speed not in (181.0, 190.0)]
    assert len(found.rows) == len(words)
    for row, one, whirl in zip(found.rows, shown, words, strict=True):
        assert row[:3] == ("tube", str(one.order), str(one.order + 3))
        assert [float(cell) for cell in (row[3], row[4], row[6])] == pytest.approx(
            [one.speed * RPM, one.speed / 8.0, one.speed / 1e4], rel=1e-3
        )
        assert row[5] == whirl
    assert found.rows[0][6] == "0.00290"
    assert [row[7] for row in found.rows] == ["no", "yes", "yes", "no", "no", "no"]
    assert found.marks == ("", "note", "note", "", "", "")
    assert found.caption.endswith("; above 1718.9 rpm the lowest two of each order")


def test_without_speeds_every_critical_speed_is_listed_and_none_lies_in_a_range(
    bare: Findings,
) -> None:
    found = table(blocks(bare, shaft("tube", whirl=None, answers=())), "Critical bending")
    assert [float(row[3]) for row in found.rows] == pytest.approx(
        [one.speed * RPM for one in CRITICAL], rel=1e-4
    )
    assert {row[7] for row in found.rows} == {"no"}
    assert found.caption.endswith("damping ratio 0: unbounded amplitude")


def test_speeds_of_the_bending_come_before_those_of_the_operation(operated: Findings) -> None:
    own = SpeedRange(**{"from": "29 rad/s", "to": "60 rad/s", "steps": 3})
    study = replace(operated.study, analyses={"lateral": LateralSettings(speeds=own)})
    found = table(blocks(replace(operated, study=study), shaft("tube")), "Critical bending")
    assert [row[7] for row in found.rows[:3]] == ["yes", "yes", "no"]
    study = replace(operated.study, analyses={"lateral": LateralSettings()})
    found = table(blocks(replace(operated, study=study), shaft("tube")), "Critical bending")
    assert [row[7] for row in found.rows[:3]] == ["no", "yes", "yes"]


STABLE = replace(WHIRL, log_decrement=np.abs(WHIRL.log_decrement))
SHAFT = MisalignedShaft(4.0, 0.25, 1.0, (3.0, 5.0), (24.0, 56.0), 1.0, 0.1)


@pytest.mark.parametrize(
    ("whirl", "zones", "name"),
    [
        (WHIRL, None, "tube (UNSTABLE)"),
        (STABLE, None, "tube"),
        (None, None, "tube"),
        (STABLE, (), "tube"),
        (None, (TiltRange(1.0, 2.0, (False, False), "several", 1.5, 0.1),), "tube (UNSTABLE)"),
    ],
)
def test_a_shaft_that_whirls_or_tilts_by_itself_is_named_unstable(
    operated: Findings, whirl, zones, name
) -> None:
    tilts = (
        None
        if zones is None
        else Tilting("joint", SHAFT, {"y": 7.5, "z": 8.5}, SPEED, SPEED, zones)
    )
    found = blocks(operated, shaft("tube", whirl=whirl, tilting=tilts), shaft("still", whirl=None))
    assert {row[0] for row in table(found, "Critical bending").rows} == {name, "still"}
    assert ("Parametric stability of the tilt" in texts(found)) == (tilts is not None)


def test_whirl_by_frequency_with_its_least_decrement(operated: Findings) -> None:
    """A decrement between -1e-9 and 1e-9 is rounding, and a mode that is not found has no row."""
    found = table(blocks(operated, shaft("tube")), "Whirl over")
    assert found.rows == (
        (
            "tube",
            "1",
            "5.0000",
            "3.0000",
            "forward, ellipse",
            "−0.200",
            "859.44",
            "UNSTABLE from 572.96 rpm",
        ),
        ("tube", "2", "11.000", "9.0000", "backward, ellipse", "0", "286.48", "undamped"),
        ("tube", "3", "7.0000", "13.000", "nearly in a plane", "0.200", "572.96", "stable"),
    )
    assert found.marks == ("fail", "", "")
    undamped = replace(WHIRL, log_decrement=np.tile([2e-9, 0.0, -1e-9, 0.3], (3, 1)))
    found = table(blocks(operated, shaft("tube", whirl=undamped)), "Whirl over")
    assert [(row[5], row[7]) for row in found.rows] == [
        ("0", "undamped"),
        ("0.300", "stable"),
        ("2.00·10⁻⁹", "stable"),
        ("0", "undamped"),
    ]
    assert not [
        text
        for text in texts(blocks(operated, shaft("tube", whirl=undamped)))
        if "by themselves" in text
    ]


def test_map_of_the_whirl_with_the_lines_of_every_order(operated: Findings) -> None:
    """At 90 rad/s of the reference the shaft turns 45/(2 pi) times a second."""
    (drawn,) = figures(
        blocks(operated, shaft("tube", critical=CRITICAL[1:2] + CRITICAL[3:4])), "whirl"
    )
    turns = 45.0 / (2.0 * math.pi)
    orders = {line.label: line for line in plot(drawn).lines if line.label}
    for n, name in ((1, "order 1"), (2, "order 2"), (4, "order 4")):
        line = orders.pop(name)
        assert line.y[-1] / line.x[-1] == pytest.approx(n * turns / SPEED[-1] / RPM)
    assert not orders
    assert marks(drawn, "critical speed in the range") == [pytest.approx((30.0 * RPM, 3.75))]
    assert marks(drawn, "critical speed outside the range") == [pytest.approx((91.0 * RPM, 11.375))]
    assert levels(drawn) == {"rated speed": [pytest.approx(750.0)]}
    found = {}
    for line in plot(drawn).lines:
        if not line.label:
            assert line.x == pytest.approx(SPEED * RPM)
            found.setdefault(line.name, []).append(line.y)
    for name, low, high in (
        ("forward", 0.1, 2.0),
        ("nearly in a plane", -0.1, 0.1),
        ("backward", -2.0, -0.1),
    ):
        here = (WHIRL.direction >= low) & (WHIRL.direction < high)
        columns = [WHIRL.frequency[:, k] for k in range(4) if here[:, k].any()]
        for shown, whole in zip(found.get(name, []), columns, strict=True):
            known = np.isfinite(shown)
            assert shown[known] == pytest.approx(whole[known])
    grown = [(SPEED[k] * RPM, WHIRL.frequency[k, 1]) for k in (1, 2)]
    assert marks(drawn, "UNSTABLE") == [pytest.approx(place) for place in grown]
    (drawn,) = figures(blocks(operated, shaft("tube")), "whirl")
    shown = [place for one in plot(drawn).marks if one.words for place in one.words]
    top, right = plot(drawn).y.high, plot(drawn).x.high
    assert len(shown) == sum(c.frequency <= top and c.speed * RPM <= right for c in CRITICAL) > 3


def test_largest_displacement_and_moment_of_every_order_with_place_and_speed(
    operated: Findings,
) -> None:
    """Moments are largest where displacements are smallest; at unreliable speeds there is none."""
    bad = answer(4, 7000.0, 700.0, Status.OK, Status.NEAR_SINGULAR, Status.SINGULAR)
    found = table(
        blocks(
            operated, shaft("tube", answers=(answer(0, 20.0, 2.0), answer(2, 300.0, 30.0), bad))
        ),
        "Response",
    )
    rows = (
        ("tube", "0", "9.0000", "1.250", "572.96", "0.18000", "0.2500", "572.96", "0"),
        ("tube", "2", "9.0000", "1.250", "592.06", "2.7000", "0.2500", "592.06", "0"),
        ("tube", "4", "no reliable value", "–", "–", "no reliable value", "–", "–", "2"),
    )
    assert found.rows == rows
    assert found.marks == ("", "", "note")
    assert found.columns[5].unit == "kN m"
    small = table(blocks(operated, shaft("tube", answers=(answer(0, 20.0, 2.0),))), "Response")
    assert (small.rows[0][5], small.columns[5].unit) == ("180.00", "N m")


def test_largest_force_of_every_order_on_every_joint_and_support(operated: Findings) -> None:
    """8 times the unit of the force at the rear, 5 times at the front, where the last speed is the worst."""
    found = table(
        blocks(operated, shaft("tube", answers=(answer(0, 20.0, 2.0), answer(2, 300.0, 300.0)))),
        "Forces",
    )
    assert found.rows == (
        ("tube", "front", "0.1000", "0", "0.010000", "859.44"),
        ("tube", "front", "0.1000", "2", "1.5000", "878.54"),
        ("tube", "rear", "1.400", "0", "0.016000", "572.96"),
        ("tube", "rear", "1.400", "2", "2.4000", "592.06"),
    )
    assert found.columns[4].unit == "kN"
    bad = answer(4, 7.0, 700.0, Status.OK, Status.SINGULAR, Status.OK)
    found = table(blocks(operated, shaft("tube", answers=(answer(0, 20.0, 2.0), bad))), "Forces")
    assert [row[4] for row in found.rows] == [
        "10.000",
        "no reliable value",
        "16.000",
        "no reliable value",
    ]


def test_curves_of_displacement_moment_and_force(operated: Findings) -> None:
    bad = answer(2, 200.0, 2000.0, Status.NEAR_SINGULAR, Status.OK, Status.SINGULAR)
    still = shaft("still", answers=())
    (drawn,) = figures(
        blocks(operated, still, shaft("tube", answers=(answer(0, 20.0, 2.0), bad))), "bending"
    )
    worst = np.array([3.0, 9.0, 7.0])
    assert titles(drawn) == [
        "displacement, µm",
        "bending moment, kN m",
        "force on a joint or support, kN",
    ]
    sizes = (np.ones(2), np.array([0.02, 0.2]), np.array([0.002, 2.0]))
    shapes = (worst, worst, np.array([2.0, 8.0, 7.0]))
    for panel, size, shape in zip(drawn.plots, sizes, shapes, strict=True):
        still_, moving = (named(panel)[name] for name in ("order 0, static", "order 2"))
        assert still_.x == pytest.approx(SPEED * RPM)
        assert moving.x == pytest.approx((SPEED + 2.0) * RPM)
        assert still_.y == pytest.approx(size[0] * shape)
        assert moving.y == pytest.approx([math.nan, size[1] * shape[1], math.nan], nan_ok=True)
    assert marks(drawn, STANDING) == [pytest.approx(((SPEED[0] + 2.0) * RPM, worst[0]))]
    assert bands(drawn, "no answer") == [
        pytest.approx(((SPEED[1] + 2.0) * RPM, (SPEED[2] + 2.0) * RPM))
    ]
    assert levels(drawn) == {
        "critical speeds of these orders": [pytest.approx(30.0 * RPM)],
        "rated speed": [pytest.approx(750.0)],
    }
    assert (drawn.name, drawn.caption[:26]) == ("bending-2", "tube: maximum amplitude of")
    (drawn,) = figures(
        blocks(operated, shaft("tube", answers=(replace(bad, status=bad.status[[0, 2, 0]]),))),
        "bending",
    )
    assert [panel.y.unit for panel in drawn.plots][1:] == ["N m", "N"]


@pytest.mark.parametrize(
    ("direction", "words"),
    [
        (0.99, "forward"),
        (0.98, "forward, ellipse"),
        (0.1, "forward, ellipse"),
        (0.099, "nearly in a plane"),
        (-0.099, "nearly in a plane"),
        (-0.1, "backward, ellipse"),
        (-0.98, "backward, ellipse"),
        (-0.99, "backward"),
    ],
)
def test_whirl_is_a_circle_from_99_percent_and_nearly_a_line_below_10(
    direction: float, words: str
) -> None:
    assert sense(direction) == words
