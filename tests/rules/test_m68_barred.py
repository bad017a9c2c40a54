"""Barred ranges from stress over speed, told as its share of tau_C."""

import math

import numpy as np
import pytest

from torsion.rules.judgement import Curve
from torsion.rules.m68_barred import barred_ranges, inside
from torsion.rules.m68_formulas import barred_range

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
    (one,) = barred_ranges(Curve(SPEED, wide, np.ones(96), np.zeros(96, dtype=np.int64)), RATED, "line")
    assert [one.lower, one.critical, one.upper] == pytest.approx([405, 500, 595], rel=1e-12)


def test_two_near_resonances_share_one_range_about_the_worse() -> None:
    (one,) = barred_ranges(curve({450: 1.1, 510: 1.2}), RATED, "line")
    assert one.critical == pytest.approx(510, rel=1e-12)
    assert one.lower == pytest.approx(barred_range(450, RATED)[0], rel=1e-12)
    assert one.upper == pytest.approx(barred_range(510, RATED)[1], rel=1e-12)


def test_two_far_resonances_have_two_ranges() -> None:
    both = barred_ranges(curve({200: 1.1, 600: 1.2}), RATED, "line")
    assert [one.critical for one in both] == pytest.approx([200, 600], rel=1e-12)


def test_tachometer_tolerance_widens_both_ends() -> None:
    (one,) = barred_ranges(curve({500: 1.1}), RATED, "line", 0.02)
    lower, upper = barred_range(500, RATED)
    assert [one.lower, one.upper] == pytest.approx([0.98 * lower, 1.02 * upper], rel=1e-12)


def test_resonance_at_the_end_of_the_speeds_keeps_the_rule_s_width() -> None:
    (one,) = barred_ranges(curve({100: 1.1}), RATED, "line")
    assert [one.lower, one.upper] == pytest.approx(barred_range(100, RATED), rel=1e-12)


def test_speed_without_an_answer_is_the_critical_one() -> None:
    (one,) = barred_ranges(curve({490: 1.4, 500: math.nan, 510: 1.3}), RATED, "line")
    assert one.critical == pytest.approx(500, rel=1e-12)


def test_nothing_is_barred_below_the_limit_or_from_0_8() -> None:
    assert barred_ranges(curve({500: 1.0, 800: 1.2, 900: 1.2}), RATED, "line") == ()


def test_speeds_inside_end_at_0_8() -> None:
    high = curve({780: 1.1})
    ranges = barred_ranges(high, RATED, "line")
    assert ranges[0].upper > 800
    assert list(SPEED[inside(ranges, high, RATED)]) == pytest.approx([730, 740, 750, 760, 770, 780, 790])
