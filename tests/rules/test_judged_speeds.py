"""The speeds that rules add: bounds of their limits, and the worst between two computed speeds."""

import math

import numpy as np
import pytest

from torsion.analyses.response.grid import apart
from torsion.rules import gear_hammer as gear
from torsion.rules import m68
from torsion.rules.judgement import FEWEST_JUDGED, Curve, between, judged_speeds

RPM = math.pi / 30.0
PARTS = [
    ("motor", {"inertia": 3.0}),
    ("shaft", {"name": "line", "length": 1.0, "diameter": 0.1, "role": "intermediate"}),
    ("gear", {"ratio": 2}),
    ("propeller", {"inertia": 5.0, "blades": 4, "excitation": [{"blade_order": 1, "torque": 10.0}]}),
]


def resonance(speed, at=100.0):
    """A curve whose inverse square is a parabola, of height 1 at its peak."""
    return 1.0 / np.sqrt(1.0 + (np.asarray(speed) - at) ** 2)


def curve(speed, value, status=0):
    return Curve(speed, value, np.ones(len(speed)), np.full(len(speed), status))


def test_peak_of_a_share_is_found_between_three_speeds() -> None:
    speed = np.array([98.0, 99.3, 101.1, 103.0])
    found = between([(curve(speed, resonance(speed)), np.ones(4, dtype=bool))])
    assert found == pytest.approx([100.0], abs=0.02 * 1.9)


def test_nothing_is_sought_outside_the_speeds_judged_or_where_the_limit_is_far_exceeded() -> None:
    speed = np.array([98.0, 99.3, 101.1, 103.0])
    assert between([(curve(speed, resonance(speed)), np.array([True, True, False, False]))]).size == 0
    assert between([(curve(speed, 1e3 * resonance(speed)), np.ones(4, dtype=bool))]).size == 0
    assert between([(curve(speed, resonance(speed), status=2), np.ones(4, dtype=bool))]).size == 0
    assert between([]).size == 0


def test_m68_needs_the_speeds_where_its_limits_bend_or_end(study) -> None:
    scene = study(PARTS, [("iacs-m68", m68.M68Settings())])
    found = judged_speeds(scene) / RPM
    assert all(np.min(np.abs(found / bound - 1)) < 1e-12 for bound in (800, 900, 1000, 1050))


def test_speeds_out_of_the_range_are_not_added(study) -> None:
    requested = gear.GearHammerSettings.model_validate({"continuous": {"from": "200 rpm", "to": "600 rpm"}})
    scene = study(PARTS, [("gear-hammer", requested)], speeds={"from": "200 rpm", "to": "700 rpm", "steps": 900})
    assert judged_speeds(scene) / RPM == pytest.approx([200, 600])


def test_few_speeds_are_made_as_many_as_the_default(study) -> None:
    scene = study(PARTS, [("iacs-m68", m68.M68Settings())], speeds={"from": "100 rpm", "to": "1100 rpm", "steps": 2})
    even = np.linspace(100, 1100, FEWEST_JUDGED) * RPM
    found = judged_speeds(scene)
    assert apart(found, even).size == 0
    assert np.all(np.diff(found) > 1e-9 * found[1:])


def test_point_within_rounding_of_a_known_one_is_not_apart() -> None:
    known, more = np.array([1.0, 2.0, 3.0]), np.array([0.5, 1.0 + 1e-12, 2.5, 3.0 - 1e-12, 4.0])
    assert apart(known, more).tolist() == [0.5, 2.5, 4.0]
    assert apart(np.array([2.0]), np.array([1.0, 2.0])).tolist() == [1.0]
