"""Barred ranges from stress over speed, stated as its share of tau_C."""

import math

import numpy as np
import pytest
from tests.for_all import for_all

from torsion.rules.class_rules.shaft_limits import barred_range, barring
from torsion.rules.rule_over_speed import Curve

RATED = 1000.0
SPEED = np.linspace(100, 1050, 96)  # steps of 10; any unit of speed


def curve(shares, rest=0.3):
    """The share is `rest` but at the speeds named."""
    share = np.full(len(SPEED), rest)
    for speed, value in shares.items():
        share[np.argmin(np.abs(SPEED - speed))] = value
    return Curve(SPEED, share, np.ones(len(SPEED)), np.zeros(len(SPEED), dtype=np.int64))


def test_range_widens_to_every_speed_above_the_limit() -> None:
    wide = np.where(np.abs(SPEED - 500) < 95, 1.2, 0.8)
    wide[40] = 1.5
    (one,) = barring(
        Curve(SPEED, wide, np.ones(96), np.zeros(96, dtype=np.int64)), RATED, "line"
    ).permitted
    assert [one.lower, one.critical, one.upper] == pytest.approx([405, 500, 595], rel=1e-12)


def test_two_near_resonances_share_one_range_about_the_worse() -> None:
    (one,) = barring(curve({450: 1.1, 510: 1.2}), RATED, "line").permitted
    assert one.critical == pytest.approx(510, rel=1e-12)
    assert one.lower == pytest.approx(barred_range(450, RATED)[0], rel=1e-12)
    assert one.upper == pytest.approx(barred_range(510, RATED)[1], rel=1e-12)


def test_two_far_resonances_have_two_ranges() -> None:
    both = barring(curve({200: 1.1, 600: 1.2}), RATED, "line").permitted
    assert [one.critical for one in both] == pytest.approx([200, 600], rel=1e-12)


def test_tachometer_tolerance_widens_both_ends() -> None:
    (one,) = barring(curve({500: 1.1}), RATED, "line", 0.02).permitted
    lower, upper = barred_range(500, RATED)
    assert [one.lower, one.upper] == pytest.approx([0.98 * lower, 1.02 * upper], rel=1e-12)
    assert (one.formula_lower, one.formula_upper) == (lower, upper)


def test_resonance_at_the_end_of_the_speeds_keeps_the_rule_s_width() -> None:
    (one,) = barring(curve({100: 1.1}), RATED, "line").permitted
    assert [one.lower, one.upper] == pytest.approx(barred_range(100, RATED), rel=1e-12)


def test_speed_without_an_answer_is_the_critical_one() -> None:
    (one,) = barring(curve({490: 1.4, 500: math.nan, 510: 1.3}), RATED, "line").permitted
    assert one.critical == pytest.approx(500, rel=1e-12)


def test_nothing_is_barred_below_the_limit() -> None:
    nothing = barring(curve({500: 1.0, 800: 0.9}), RATED, "line")
    assert (nothing.permitted, nothing.refused) == ((), ())
    assert not nothing.passed.any()


@for_all("critical", [750, 780, 800, 820, 1050])
def test_range_that_reaches_0_8_is_refused_whole(critical) -> None:
    found = barring(curve({critical: 1.2}), RATED, "line")
    assert found.permitted == ()
    assert found.refused[0].critical == pytest.approx(critical)
    assert [found.refused[0].lower, found.refused[0].upper] == pytest.approx(
        barred_range(critical, RATED)
    )
    assert not found.passed.any()


def test_peak_above_0_8_is_the_critical_speed_of_its_flank_below() -> None:
    flank = 1.5 * np.exp(-(((SPEED - 820) / 60) ** 2))
    found = barring(Curve(SPEED, flank, np.ones(96), np.zeros(96, dtype=np.int64)), RATED, "line")
    assert found.permitted == ()
    assert [one.critical for one in found.refused] == pytest.approx([820])


def test_tachometer_decides_whether_a_range_reaches_0_8() -> None:
    assert barred_range(730, RATED)[1] < 800 < 1.02 * barred_range(730, RATED)[1]
    assert barring(curve({730: 1.2}), RATED, "line").permitted
    assert barring(curve({730: 1.2}), RATED, "line", 0.02).refused


def test_permitted_range_does_not_excuse_what_is_refused_within_it() -> None:
    found = barring(curve({720: 1.4, 750: 1.2}), RATED, "line")
    assert [one.critical for one in found.permitted] == pytest.approx([720])
    assert found.permitted[0].upper > 750
    assert [one.critical for one in found.refused] == pytest.approx([750])
    assert list(SPEED[found.passed]) == pytest.approx(
        [670, 680, 690, 700, 710, 720, 730, 740, 760, 770]
    )


def test_ends_of_a_range_are_speeds_of_continuous_use() -> None:
    lower, upper = barred_range(500, RATED)
    speed = np.array([400, lower, 500, upper, 600])
    found = barring(
        Curve(speed, np.array([0.1, 0.9, 1.1, 0.9, 0.1]), np.ones(5), np.zeros(5, dtype=int)),
        RATED,
        "x",
    )
    assert found.passed.tolist() == [False, False, True, False, False]


def test_range_ends_where_its_flanks_meet_the_limit_even_beside_the_first_and_the_last_speed() -> (
    None
):
    """At 400 and 700 the share is 0.6, between them above 1: straight lines cross it at 3/4 and 1/3 of a step."""
    speed = np.array([400.0, 500.0, 600.0, 700.0])
    found = barring(
        Curve(speed, np.array([0.6, 2.2, 1.2, 0.6]), np.ones(4), np.zeros(4, dtype=int)),
        2000.0,
        "x",
    )
    (one,) = found.permitted
    assert [one.lower, one.critical, one.upper] == pytest.approx(
        [425.0, 500.0, 600.0 + 100.0 / 3.0], rel=1e-12
    )
    assert found.passed.tolist() == [False, True, True, False]


@pytest.mark.parametrize("beyond", [math.nan, math.inf])
def test_range_reaches_to_the_neighbour_that_has_no_limit(beyond) -> None:
    """A limit that is not there makes its speed no part of the run, but the line to it is unknown too."""
    speed = np.array([400.0, 500.0, 600.0])
    limit = np.array([math.nan, 1.0, math.nan])
    found = barring(
        Curve(speed, np.array([beyond, 1.2, 0.5]), limit, np.zeros(3, dtype=int)), 2000.0, "x"
    )
    assert [(one.lower, one.upper) for one in found.permitted] == [(400.0, 600.0)]


def test_three_refused_ranges_that_overlap_are_one_about_the_worst() -> None:
    found = barring(curve({900: 1.1, 930: 1.4, 960: 1.2}), RATED, "line")
    (one,) = found.refused
    assert [one.lower, one.critical, one.upper] == pytest.approx(
        [barred_range(900, RATED)[0], 930, barred_range(960, RATED)[1]], rel=1e-12
    )
    assert (one.shaft, found.permitted) == ("line", ())


def test_ranges_that_touch_are_one_and_those_apart_stay_two() -> None:
    """400: to 440; 484 with its own lower end of 442.06: apart; 480: from 438.4: together."""
    assert barred_range(400, RATED)[1] == pytest.approx(440.0, rel=1e-12)
    for second, number in ((470, 1), (480, 1), (490, 2)):
        found = barring(curve({400: 1.1, second: 1.1}), RATED, "line").permitted
        assert len(found) == number
        assert (barred_range(second, RATED)[0] > 440.0) == (number == 2)


def test_the_worse_of_two_infinite_shares_is_the_greater_stress() -> None:
    value = np.full(len(SPEED), 0.3)
    value[[35, 41]] = 5.0, 7.0  # 450 and 510, where the limit is 0
    limit = np.where(value > 1, 0.0, 1.0)
    (one,) = barring(Curve(SPEED, value, limit, np.zeros(96, dtype=int)), RATED, "line").permitted
    assert one.critical == pytest.approx(510)
