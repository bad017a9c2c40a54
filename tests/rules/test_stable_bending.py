"""The verdicts on whirl and tilt: the worst within the operation, and no pass where something was not looked at."""

import math
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.lateral.misaligned_shaft import MisalignedShaft
from torsion.analyses.lateral.shaft_bending import InPlanes, Lateral, ShaftFound
from torsion.analyses.lateral.tilt_stability import Tilting, TiltRange
from torsion.analyses.lateral.whirl import Whirl
from torsion.rules.stable_motion import bending_checks
from torsion.study import Operation

OPERATED = Operation(speeds={"from": "100 rad/s", "to": "200 rad/s"})
SPEEDS = np.array([80.0, 100.0, 130.0, 200.0, 220.0])
WHOLE = SPEEDS[1:4]
PART = "only a part of the operation's speeds was looked at"
CLEAN = [[0.3, 0.4], [0.5, math.nan], [0.2, 0.6], [0.7, 0.9], [0.1, 0.8]]


def bent(whirl=None, tilting=None):
    none = np.empty(0)
    at_rest = InPlanes(none, none)
    return Lateral(
        (ShaftFound("tail", (1,), Fraction(1), 1.0, none, (), at_rest, (), whirl, (), 3, tilting),),
        (),
    )


def whirled(decrement, speed=SPEEDS, operation=OPERATED):
    decrement = np.array(decrement)
    found = bent(Whirl(np.array(speed), 7.0 + decrement, decrement, decrement))
    (check,) = bending_checks(found, operation)
    return check


def tilted(growth, *, zones=(), speed=SPEEDS, operation=OPERATED, damping=(5.0, 6.0)):
    """zones: lower, upper, worst and rate."""
    shaft = MisalignedShaft(1.0, 0.5, 1.0, (1e4, 1e4), damping, 1.0, 0.1)
    named = tuple(
        TiltRange(low, high, (False, False), "several", at, rate) for low, high, at, rate in zones
    )
    tilting = Tilting(
        "hinge", shaft, {"y": 1.0, "z": 2.0}, np.array(speed), np.array(growth), named
    )
    (check,) = bending_checks(bent(tilting=tilting), operation)
    return check


def test_the_least_decrement_within_the_operation_is_compared_with_0() -> None:
    check = whirled(CLEAN)
    assert (check.rule, check.clause, check.where) == ("stability", "whirl", "tail")
    assert (check.value, check.limit, check.speed, check.verdict, check.at_least) == (
        0.2,
        0.0,
        130.0,
        "pass",
        True,
    )
    assert (check.note, check.unit, check.standing) == ("", "", "by definition")
    assert check.what == "Damping of the whirl (logarithmic decrement)"


@pytest.mark.parametrize(("row", "column"), [(1, 0), (2, 1), (3, 0), (3, 1)])
def test_whirl_that_grows_anywhere_in_the_operation_fails(row, column) -> None:
    decrement = [list(one) for one in CLEAN]
    decrement[row][column] = -0.01
    check = whirled(decrement)
    assert (check.value, check.speed, check.verdict) == (-0.01, SPEEDS[row], "fail")


@pytest.mark.parametrize("row", [0, 4])
def test_whirl_that_grows_outside_the_operation_passes_and_without_one_fails(row) -> None:
    decrement = [list(one) for one in CLEAN]
    decrement[row][1] = -0.5
    assert whirled(decrement).verdict == "pass"
    check = whirled(decrement, operation=Operation())
    assert (check.value, check.speed, check.verdict) == (-0.5, SPEEDS[row], "fail")


@pytest.mark.parametrize(
    ("least", "value", "verdict", "note"),
    [
        (0.0, 0.0, "pass", "nothing damps it"),
        (1e-9, 0.0, "pass", "nothing damps it"),
        (-1e-9, 0.0, "pass", "nothing damps it"),
        (2e-9, 2e-9, "pass", ""),
        (-2e-9, -2e-9, "fail", ""),
    ],
)
def test_a_decrement_of_0_but_for_rounding_passes_and_says_so(least, value, verdict, note) -> None:
    check = whirled([[1.0], [1.0], [least], [1.0], [1.0]])
    assert (check.value, check.verdict, check.note) == (value, verdict, note)
    undamped = whirled([[1.0], [1.0], [least]], speed=SPEEDS[:3])
    assert (undamped.value, undamped.verdict) == (value, "fail")
    assert undamped.note == "; ".join(text for text in (note, PART) if text)


ROUND = 1e-9  # relative
ENDS = [
    (100.0, 200.0, True),
    (100 * (1 + ROUND), 200 * (1 - ROUND), True),
    (100 * (1 + 2 * ROUND), 200.0, False),
    (100.0, 200 * (1 - 2 * ROUND), False),
    (150.0, 220.0, False),
    (80.0, 150.0, False),
]


@pytest.mark.parametrize(("first", "last", "is_whole"), ENDS)
def test_a_part_of_the_operation_is_no_pass(first, last, is_whole) -> None:
    whirl = whirled([[0.5], [0.4], [0.6]], speed=[first, 160.0, last])
    tilt = tilted([-0.5, -0.4, -0.6], speed=[first, 160.0, last])
    for check in (whirl, tilt):
        assert (check.verdict, check.note) == (("pass", "") if is_whole else ("fail", PART))
        assert check.speed == 160.0


def test_a_shaft_whose_whirl_or_tilt_is_not_known_is_not_judged() -> None:
    assert bending_checks(bent(), OPERATED) == ()
    unknown = np.full((5, 2), math.nan)
    assert bending_checks(bent(Whirl(SPEEDS, unknown, unknown, unknown)), OPERATED) == ()


def test_the_fastest_growth_of_the_tilt_within_the_operation_is_compared_with_0() -> None:
    check = tilted([9.0, -2.0, -0.7, -3.0, 8.0])
    assert (check.clause, check.where, check.unit, check.at_least) == (
        "tilting",
        "tail",
        "1/s",
        False,
    )
    assert (check.value, check.limit, check.speed, check.verdict, check.note) == (
        -0.7,
        0.0,
        130.0,
        "pass",
        "",
    )
    assert check.what == "Growth of the tilt by the couple of hinge"
    alone = tilted(
        [9.0, -2.0, -0.7, -3.0, 8.0], operation=Operation(), zones=((80.0, 90.0, 80.0, 9.0),)
    )
    assert (alone.value, alone.speed, alone.verdict) == (9.0, 80.0, "fail")


def test_rounding_of_a_tilt_that_nothing_damps_is_no_growth() -> None:
    check = tilted([0.0, 0.0, 1e-12, 0.0, 0.0], damping=(0.0, 6.0))
    assert (check.value, check.verdict) == (0.0, "pass")
    assert check.note == "its supports do not damp it in both directions"
    part = tilted([-0.1, -0.2], speed=[100.0, 150.0], damping=(6.0, 0.0))
    assert (part.verdict, part.note) == (
        "fail",
        f"its supports do not damp it in both directions; {PART}",
    )


@pytest.mark.parametrize(
    ("zone", "growth", "value", "speed"),
    [
        ((120.0, 140.0, 130.0, 0.6), [-1, -1, 0.6, -1, -1], 0.6, 130.0),  # on a speed
        ((140.0, 141.0, 140.5, 0.6), [-1, -1, -0.2, -1, -1], 0.6, 140.5),  # between two speeds
        ((140.0, 141.0, 140.5, 0.6), [0, 0, 0, 0, 0], 0.6, 140.5),  # nothing damps it
        (
            (90.0, 100.5, 92.0, 0.6),
            [-1, -0.2, -0.1, -1, -1],
            0.6,
            100.0,
        ),  # its worst is below the operation
        (
            (199.5, 230.0, 210.0, 0.6),
            [-1, -0.3, -0.2, -0.5, -1],
            0.6,
            200.0,
        ),  # its worst is above it
        (
            (195.0, 230.0, 210.0, 0.6),
            [-1, -0.3, -0.2, 0.4, -1],
            0.4,
            200.0,
        ),  # of which a part is operated
    ],
)
def test_tilt_that_grows_in_a_range_of_the_operation_fails_however_narrow(
    zone, growth, value, speed
) -> None:
    check = tilted(growth, zones=(zone,))
    assert (check.value, check.speed, check.verdict) == (value, speed, "fail")


def test_the_fastest_of_several_ranges_is_stated() -> None:
    zones = ((140.0, 141.0, 140.5, 0.2), (150.0, 151.0, 150.5, 0.6), (160.0, 161.0, 160.5, 0.4))
    check = tilted([-1.0] * 5, zones=zones)
    assert (check.value, check.speed) == (0.6, 150.5)


@pytest.mark.parametrize(
    "zone", [(80.0, 100.0, 90.0, 0.6), (200.0, 220.0, 210.0, 0.6), (50.0, 60.0, 55.0, 0.6)]
)
def test_ranges_that_end_at_the_operation_are_none_of_it(zone) -> None:
    check = tilted([0.6, -1.0, -0.5, -0.8, 0.6], zones=(zone,))
    assert (check.value, check.speed, check.verdict) == (-0.5, 130.0, "pass")


def test_every_shaft_has_a_verdict_of_its_own() -> None:
    decrement = np.full((5, 1), 0.1)
    both = bent(Whirl(SPEEDS, decrement, decrement, decrement)).shafts[0]
    assert [check.clause for check in bending_checks(Lateral((both, both), ()), OPERATED)] == [
        "whirl",
        "whirl",
    ]
