"""The verdict on stability: never a pass where something grows, is not known or was not looked at."""

import math
from dataclasses import replace

import numpy as np
import pytest

from torsion.analyses.motion.stability_over_speed import Stability
from torsion.analyses.motion.unstable_ranges import UnstableRange
from torsion.rules.stable_motion import stability_check
from torsion.study import Operation

OPERATED = Operation(speeds={"from": "100 rad/s", "to": "200 rad/s"})


def found(
    growth: list[float], *, ranges: tuple[tuple[float, float, float], ...] = (), loses: bool = True,
    first: float = 80.0, last: float = 220.0,
) -> Stability:  # fmt: skip
    """Growth rates at even speeds; ranges: first, last, growth in the middle."""
    speed, rate = np.linspace(first, last, len(growth)), np.array(growth)
    zone = "principal", (1,), 1
    named = tuple(UnstableRange(*zone, a, b, (False, False), g, (a + b) / 2.0) for a, b, g in ranges)
    return Stability(
        speed, np.ones(len(speed), dtype=bool), rate, rate, rate, named, np.array([50.0]), "monodromy", 0.0,
        speed[np.isnan(rate)], loses,
    )  # fmt: skip


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
        found([0.5, -1.0, -1.0, -1.0, 0.4], ranges=((80.0, 90.0, 0.5), (210.0, 220.0, 0.4))), OPERATED
    )
    assert (check.verdict, check.value) == ("pass", -1.0)
    assert "10 % below the lowest speed" in check.note
    assert "5 % above the highest speed" in check.note


def test_speed_without_a_periodic_motion_is_no_pass():
    check = stability_check(found([-1.0, -1.0, math.nan, -1.0, -1.0]), OPERATED)
    assert (check.verdict, check.value, check.speed) == ("fail", math.inf, 150.0)
    assert "no periodic motion" in check.note
    assert "from 1098.2 to 1766.6 rpm" in check.note


@pytest.mark.parametrize(("growth", "verdict"), [([math.nan, -1.0, -1.0], "fail"), ([math.nan, *[-1.0] * 8], "pass")])
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
