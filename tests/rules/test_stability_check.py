"""The verdict on stability: never a pass where something grows, is not known or was not looked at."""

import math
from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.rules.stable_motion import mean_speed_check, stability_check
from torsion.study import Operation

OPERATED = Operation(speeds={"from": "100 rad/s", "to": "200 rad/s"})


def found(
    growth: list[float],
    *,
    ranges: tuple[tuple[float, float, float], ...] = (),
    loses: bool = True,
    first: float = 80.0,
    last: float = 220.0,
) -> Stability:
    """Growth rates at even speeds; ranges: first, last, growth in the middle."""
    speed, rate = np.linspace(first, last, len(growth)), np.array(growth)
    zone = "principal", (1,), 1
    named = tuple(
        UnstableRange(*zone, a, b, (False, False), g, (a + b) / 2.0) for a, b, g in ranges
    )
    return Stability(
        speed,
        np.ones(len(speed), dtype=bool),
        rate,
        rate,
        rate,
        named,
        np.array([50.0]),
        "monodromy",
        0.0,
        speed[np.isnan(rate)],
        loses,
    )


def test_train_whose_deviations_die_out_passes_with_its_slowest_decay():
    check = stability_check(found([-1.0, -3.0, -2.0, -5.0, -1.0]), OPERATED)
    assert (check.verdict, check.value, check.limit, check.speed) == ("pass", -2.0, 0.0, 150.0)


@pytest.mark.parametrize("where", [(140.0, 141.0), (90.0, 101.0), (199.0, 230.0)])
def test_range_that_touches_the_operation_fails_however_narrow(where):
    check = stability_check(found([-1.0] * 5, ranges=((*where, 0.3),)), OPERATED)
    assert (check.verdict, check.value) == ("fail", 0.3)
    assert 100.0 <= check.speed <= 200.0


@pytest.mark.parametrize("where", [(80.0, 100.0), (200.0, 220.0)])
def test_without_speeds_of_an_operation_all_that_were_looked_at_are_judged(where):
    """The ranges end at the first and at the last of the speeds, 80 and 220 rad/s, at which nothing grows yet."""
    check = stability_check(found([-1.0] * 5, ranges=((*where, 0.3),)), Operation())
    assert (check.verdict, check.value) == ("fail", 0.3)
    slow = stability_check(found([-0.5, -3.0, -3.0, -3.0, -0.2]), Operation())
    assert (slow.verdict, slow.value, slow.speed) == ("pass", -0.2, 220.0)
    assert stability_check(found([-0.1, -3.0, -3.0, -3.0, -0.2]), Operation()).speed == 80.0


def test_range_outside_the_operation_passes_and_its_distance_is_told():
    check = stability_check(
        found([0.5, -1.0, -1.0, -1.0, 0.4], ranges=((80.0, 90.0, 0.5), (210.0, 220.0, 0.4))),
        OPERATED,
    )
    assert (check.verdict, check.value) == ("pass", -1.0)
    assert "10 % below the lowest speed" in check.note
    assert "5 % above the highest speed" in check.note


def test_speed_without_a_periodic_motion_is_no_pass():
    check = stability_check(found([-1.0, -1.0, math.nan, -1.0, -1.0]), OPERATED)
    assert (check.verdict, check.value, check.speed) == ("fail", math.inf, 150.0)
    assert "no periodic motion" in check.note
    assert "from 1098.2 to 1766.6 rpm" in check.note


@pytest.mark.parametrize(
    ("growth", "verdict"), [([math.nan, -1.0, -1.0], "fail"), ([math.nan, *[-1.0] * 8], "pass")]
)
def test_nothing_is_known_as_far_as_the_next_speed_with_a_periodic_motion(growth, verdict):
    check = stability_check(found(growth), OPERATED)
    assert check.verdict == verdict
    assert ("nothing is known" in check.note) == (verdict == "fail")


def test_train_without_any_periodic_motion_says_so():
    check = stability_check(found([math.nan] * 3), OPERATED)
    assert (check.verdict, check.value, check.speed) == ("fail", math.inf, 150.0)
    assert "at any of the 3 speeds" in check.note


def test_range_that_is_unstable_at_the_first_speed_operated_fails():
    one = UnstableRange("principal", (1,), 1, 90.0, 100.0, (False, False), 0.3, 95.0, (None, 100.5))
    known = replace(found([-1.0] * 5), ranges=(one,))
    check = stability_check(known, OPERATED)
    assert (check.verdict, check.value, check.speed) == ("fail", 0.3, 100.0)


def test_part_of_the_operation_that_was_not_looked_at_is_no_pass():
    check = stability_check(found([-1.0] * 5, first=100.0, last=190.0), OPERATED)
    assert check.verdict == "fail"
    assert "not requested" in check.note


def test_rounding_of_a_train_that_nothing_damps_is_no_growth():
    check = stability_check(found([1e-13] * 5, loses=False), OPERATED)
    assert (check.verdict, check.value) == ("pass", 0.0)
    assert "nothing in the train damps" in check.note


@pytest.mark.parametrize(
    ("growth", "ranges", "value", "speed"),
    [
        ([-1, -2, 0.6, -3, -1], ((140.0, 160.0, 0.6),), 0.6, 150.0),  # on a speed
        ([-1, -2, 0.2, -3, -1], ((130.0, 160.0, 0.6),), 0.6, 145.0),  # its worst between two speeds
        (
            [-1, -2, 0.6, -3, -1],
            ((120.0, 121.0, 0.2), (140.0, 160.0, 0.6)),
            0.6,
            150.0,
        ),  # the smaller of two
        (
            [-1, -2, -3, -3, -1],
            ((120.0, 121.0, 0.2), (140.0, 142.0, 0.6)),
            0.6,
            141.0,
        ),  # the greater of two
        (
            [-1, -2, -3, 0.5, 9],
            ((180.0, 230.0, 0.8),),
            0.5,
            185.0,
        ),  # operated in a part that has less
        (
            [-1, -2, -3, -0.5, 9],
            ((199.0, 230.0, 0.8),),
            0.8,
            200.0,
        ),  # operated but for the speeds computed
        ([-1, -2, 0.0, -3, -1], ((199.0, 230.0, 0.8),), 0.8, 200.0),  # beside a growth of 0
        ([9, -2, -0.5, -3, -1], ((70.0, 101.0, 0.8),), 0.8, 100.0),
    ],
)
def test_the_fastest_growth_within_the_operation_is_stated(growth, ranges, value, speed):
    check = stability_check(found(growth, ranges=ranges), OPERATED)
    assert (check.value, check.speed, check.verdict) == (value, speed, "fail")


def test_a_check_says_what_it_compares_with_0():
    check = stability_check(found([-1.0] * 5), OPERATED)
    assert (check.rule, check.clause, check.where, check.unit) == (
        "stability",
        "stability",
        "whole train",
        "1/s",
    )
    assert (check.what, check.at_least, check.note) == ("Growth of small vibrations", False, "")
    assert (check.standing, check.limit) == ("by definition", 0.0)


def test_distance_is_that_of_the_nearest_range_on_either_side():
    """Below to 60, 90 and 95 rad/s of 100, above from 230, 212.5 and 250 of 200; what touches is 0 % away."""
    below, above = (
        ((50.0, 60.0, 0.1), (92.0, 95.0, 0.1), (70.0, 90.0, 0.1)),
        (
            (230.0, 235.0, 0.1),
            (212.5, 220.0, 0.1),
            (250.0, 260.0, 0.1),
        ),
    )
    note = stability_check(found([-1.0] * 5, ranges=(*below, *above)), OPERATED).note
    first = "the next unstable range ends 5 % below the lowest speed"
    last = "the next unstable range begins 6.25 % above the highest speed"
    assert note == f"{first}; {last}"
    assert stability_check(found([-1.0] * 5, ranges=below), OPERATED).note == first
    assert stability_check(found([-1.0] * 5, ranges=above), OPERATED).note == last
    touching = stability_check(
        found([-1.0] * 5, ranges=((90.0, 100.0, 0.1), (200.0, 210.0, 0.1))), OPERATED
    )
    assert touching.verdict == "pass"
    assert touching.note == first.replace("5 %", "0 %") + "; " + last.replace("6.25 %", "0 %")


def test_distance_counts_from_where_nothing_is_known():
    """The ranges end at 80 and 250 rad/s, beyond which nothing is known up to 92 and down to 215."""
    below = UnstableRange("principal", (1,), 1, 70.0, 80.0, (False, False), 0.3, 75.0, (61.0, 92.0))
    above = UnstableRange(
        "principal", (1,), 1, 250.0, 260.0, (False, False), 0.3, 255.0, (215.0, 270.0)
    )
    note = stability_check(replace(found([-1.0] * 5), ranges=(below, above)), OPERATED).note
    assert "ends 8 % below the lowest speed" in note
    assert "begins 7.5 % above the highest speed" in note


@pytest.mark.parametrize(
    ("doubtful", "growth", "verdict"),
    [
        ([150.0], -1.0, "not judged"),
        ([80.0], -1.0, "pass"),
        ([220.0], -1.0, "pass"),
        ([210.0], -1.0, "not judged"),
        ([90.0], -1.0, "not judged"),
        ([], -1.0, "pass"),
        ([150.0], 0.5, "fail"),
    ],
)
def test_exponent_that_was_not_distinguished_is_never_a_pass(doubtful, growth, verdict):
    """Speeds of 80, 90, ... rad/s: what is between 90 and 100 may hold at the first speed operated, 100,
    and what is between 200 and 210 at the last, 200.
    """
    ranges = ((140.0, 150.0, growth),) if growth > 0 else ()
    whole = replace(found([growth] * 15, ranges=ranges), doubtful=np.array(doubtful))
    check = stability_check(whole, OPERATED)
    assert check.verdict == verdict
    assert ("not distinguished" in check.note) == bool(doubtful)


@pytest.mark.parametrize(("growth", "verdict"), [(-1.0, "pass"), (math.nan, "fail")])
def test_mean_speed_of_which_nothing_is_known_at_any_speed_never_passes(growth, verdict):
    text = "name: x\noperation: {speeds: {from: 100 rad/s, to: 200 rad/s}}\ntrain: [disc: {inertia: 1}]\n"
    check = mean_speed_check(found([growth] * 15), torsion.parse(text))
    assert check.verdict == verdict
    assert math.isnan(check.value)


RPM = math.pi / 30.0


@pytest.mark.parametrize("number", [1, 4, 5, 7])
def test_ranges_without_a_periodic_motion_are_stated_up_to_four(number):
    """Every other speed of 110, 115, 120, ... has none."""
    growth = [-1.0] * 29
    growth[7 : 7 + 2 * number : 2] = [math.nan] * number  # 80 + 5 k rad/s: 115, 125, ...
    check = stability_check(found(growth), OPERATED)
    ranges = [
        f"{(110 + 10 * k) / RPM:.5g} to {(120 + 10 * k) / RPM:.5g}" for k in range(min(number, 4))
    ]
    more = f", the first 4 of {number} ranges" if number > 4 else ""
    known = "no periodic motion was found, and so nothing is known, from"
    assert check.note == f"{known} {', '.join(ranges)} rpm{more}"
    assert (check.verdict, check.value, check.speed) == ("fail", math.inf, 115.0)


def without_motion(at):
    """Nothing grows from 80 to 220 rad/s, and at some speeds there is no periodic motion."""
    whole = found([-1.0] * 15)
    growth = np.where(np.isin(whole.speed, at), math.nan, -1.0)
    return stability_check(replace(whole, growth=growth, unsolved=np.array(at)), OPERATED)


@pytest.mark.parametrize(
    ("at", "speed"), [([100.0, 150.0], 100.0), ([90.0, 150.0, 160.0], 150.0), ([200.0], 200.0)]
)
def test_the_lowest_operated_speed_without_a_periodic_motion_is_stated(at, speed):
    check = without_motion(at)
    assert (check.value, check.speed, check.verdict) == (math.inf, speed, "fail")


def test_speeds_without_a_periodic_motion_whose_neighbours_end_the_operation_are_none_of_it():
    assert without_motion([90.0, 210.0]).verdict == "pass"


@pytest.mark.parametrize(("first", "last", "at"), [(40.0, 100.0, 100.0), (200.0, 260.0, 200.0)])
def test_a_speed_without_a_periodic_motion_at_the_end_of_the_operation_is_stated(first, last, at):
    """Of the speeds looked at only that one is operated; another without a motion lies outside."""
    bare = found([-1.0] * 7, first=first, last=last)
    missing = np.array([first, last])
    growth = np.where(np.isin(bare.speed, missing), math.nan, -1.0)
    check = stability_check(replace(bare, growth=growth, unsolved=missing), OPERATED)
    assert (check.value, check.speed, check.verdict) == (math.inf, at, "fail")
    assert (
        f"nothing is known, from {at / RPM:.5g} to {at / RPM:.5g} rpm; stability was not requested"
        in check.note
    )


ROUND = 1e-9  # relative


@pytest.mark.parametrize(
    ("first", "last", "verdict"),
    [
        (100.0, 200.0, "pass"),
        (100.0 * (1 + ROUND), 200.0 * (1 - ROUND), "pass"),
        (100.0 * (1 + 2 * ROUND), 200.0, "fail"),
        (100.0, 200.0 * (1 - 2 * ROUND), "fail"),
        (150.0, 220.0, "fail"),
    ],
)
def test_the_operation_is_looked_at_as_a_whole_but_for_rounding(first, last, verdict):
    check = stability_check(found([-1.0] * 5, first=first, last=last), OPERATED)
    assert check.verdict == verdict
    words = "stability was not requested at all speeds of the operation"
    assert check.note == ("" if verdict == "pass" else words)


def test_notes_stand_in_the_order_of_their_weight():
    check = stability_check(
        found([-1.0, math.nan, -1.0], first=100.0, last=190.0, loses=False), OPERATED
    )
    assert [note.split(",")[0] for note in check.note.split("; ")] == [
        "no periodic motion was found",
        "stability was not requested at all speeds of the operation",
        "nothing in the train damps",
    ]
