"""The speeds that rules add: bounds of their limits, and the worst between two computed speeds."""

import math

import numpy as np
import pytest

import torsion
from torsion.analyses.response.grid import apart
from torsion.rules import coupling_maker as coupling
from torsion.rules.class_rules import m68
from torsion.rules.rule_over_speed import (
    FEWEST_JUDGED,
    Curve,
    between,
    judged_speeds,
    speeds_between,
)
from torsion.rules.strength import gear_hammer as gear
from torsion.study import Operation

RPM = math.pi / 30.0
PARTS = [
    ("motor", {"inertia": 3.0}),
    ("shaft", {"name": "line", "length": 1.0, "diameter": 0.1, "role": "intermediate"}),
    ("gear", {"ratio": 2}),
    (
        "propeller",
        {"inertia": 5.0, "blades": 4, "excitation": [{"blade_order": 1, "torque": 10.0}]},
    ),
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
    assert (
        between([(curve(speed, resonance(speed)), np.array([True, True, False, False]))]).size == 0
    )
    assert between([(curve(speed, 1e3 * resonance(speed)), np.ones(4, dtype=bool))]).size == 0
    assert between([(curve(speed, resonance(speed), status=2), np.ones(4, dtype=bool))]).size == 0
    assert between([]).size == 0


def test_m68_needs_the_speeds_where_its_limits_bend_or_end(study) -> None:
    scene = study(PARTS, [("iacs-m68", m68.M68Settings())])
    found = judged_speeds(scene) / RPM
    assert all(np.min(np.abs(found / bound - 1)) < 1e-12 for bound in (800, 900, 1000, 1050))


def test_speeds_out_of_the_range_are_not_added(study) -> None:
    requested = gear.GearHammerSettings.model_validate(
        {"continuous": {"from": "200 rpm", "to": "600 rpm"}}
    )
    scene = study(
        PARTS,
        [("gear-hammer", requested)],
        speeds={"from": "200 rpm", "to": "700 rpm", "steps": 900},
    )
    assert judged_speeds(scene) / RPM == pytest.approx([200, 600])


def test_few_speeds_are_made_as_many_as_the_default(study) -> None:
    scene = study(
        PARTS,
        [("iacs-m68", m68.M68Settings())],
        speeds={"from": "100 rpm", "to": "1100 rpm", "steps": 2},
    )
    even = np.linspace(100, 1100, FEWEST_JUDGED) * RPM
    found = judged_speeds(scene)
    assert apart(found, even).size == 0
    assert np.all(np.diff(found) > 1e-9 * found[1:])


def test_range_without_a_number_of_speeds_is_judged_at_as_many_as_one_that_names_none(
    study,
) -> None:
    assert Operation(speeds={"from": "1 rpm", "to": "2 rpm"}).speeds.steps == FEWEST_JUDGED


def test_range_of_as_many_speeds_is_not_made_finer(study) -> None:
    ends = {"from": "100 rpm", "to": "1100 rpm"}
    rules = [("coupling-maker", coupling.CouplingSettings())]
    fine, coarse = (
        judged_speeds(study(PARTS, rules, speeds={**ends, "steps": n})) / RPM for n in (201, 200)
    )
    assert fine == pytest.approx([1000])
    assert coarse == pytest.approx(np.linspace(100, 1100, 201))


def test_range_without_a_speed_of_its_own_is_made_even(study) -> None:
    rules = [("coupling-maker", coupling.CouplingSettings())]
    ends = {"from": "100 rpm", "to": "1100 rpm", "steps": 2}
    assert judged_speeds(study(PARTS, rules, speeds=ends, rated=None)) / RPM == pytest.approx(
        np.linspace(100, 1100, 201)
    )


def test_study_without_speeds_has_none_to_judge(study) -> None:
    assert judged_speeds(study(PARTS, [("iacs-m68", m68.M68Settings())], speeds=None)).size == 0


def test_corners_of_every_table_of_torque_are_computed_at_the_reference_speed(study) -> None:
    """The table of a component counts its own speed, half that of the reference; the load's that of the reference."""
    text = """
name: a table behind a gear
train: [motor: {inertia: 3}, gear: {ratio: 2}, coupling: {stiffness: 3e4}, disc: {name: end, inertia: 5}]
excitations: [{at: end, order: 4, torque: [[0 rpm, 1], [210 rpm, 1], [280 rpm, 5], [900 rpm, 6]]}]
operation: {speeds: {from: 100 rpm, to: 1100 rpm, steps: 300}, load: LOAD}
"""
    for load, corners in (
        ("[[0 rpm, 5], [150 rpm, 50], [777 rpm, 70], [1200 rpm, 9]]", [150, 420, 560, 777]),
        ("constant", [420, 560]),
    ):
        scene = torsion.parse(text.replace("LOAD", load), "scene.yaml")
        assert judged_speeds(scene) / RPM == pytest.approx(corners, rel=1e-12)


def test_share_that_is_a_hundredfold_of_its_limit_is_sought_no_nearer() -> None:
    speed = np.array([98.0, 99.3, 101.1, 103.0])
    for height, sought in ((100.0, 1), (np.nextafter(100.0, 200.0), 0)):
        value = resonance(speed) / resonance(speed).max() * height
        assert between([(curve(speed, value), np.ones(4, dtype=bool))]).size == sought


def test_only_a_vibration_is_sought_between_the_speeds(study, evidence) -> None:
    """The mean torque has a peak there too; of the vibration the peak of every curve counts, and each once."""
    rpm = np.array([294.0, 297.9, 303.3, 309.0])
    peak = resonance(rpm / 3)
    parts = [
        ("motor", {"inertia": 1.0, "ripple": [{"order": 4, "torque": 1.0}]}),
        ("coupling", {"name": "rubber", "stiffness": 3e4, "rated_torque": 2.0}),
        ("disc", {"inertia": 2.0}),
    ]
    rule = coupling.CouplingMaker(coupling.CouplingSettings())
    mean = evidence(study(parts), rpm, half={}, mean={"rubber": peak})
    assert rule.speeds_between(mean).size == 0
    limited = [parts[0], (parts[1][0], {**parts[1][1], "vibratory_torque": 2.0}), parts[2]]
    assert rule.speeds_between(
        evidence(study(limited), rpm, half={"rubber": peak})
    ) / RPM == pytest.approx([300.0], abs=0.02 * 6)


@pytest.mark.parametrize(
    ("first", "last", "sought"), [(460, 540, 2), (480, 540, 1), (460, 520, 1), (480, 520, 0)]
)
def test_ends_of_a_barred_range_are_computed_where_they_lie_in_the_range(
    study, evidence, first, last, sought
) -> None:
    """About 500 of 1000 rpm: 16/17.5 and 17.5/16 times 500 rpm, 457.1 and 546.9."""
    ends = 500.0 * np.array([16 / 17.5, 17.5 / 16])
    whole = np.array([ends[0] - 1, 480.0, 500.0, 520.0, ends[1] + 1])
    rpm = whole[None if first == 460 else 1 : None if last == 540 else 4]
    torque = np.where(rpm == 500.0, 1e5, 1.0)
    scene = study(PARTS, [("iacs-m68", m68.M68Settings())])
    found = speeds_between(evidence(scene, rpm, half={"line": torque})) / RPM
    inside = [end for end in ends if rpm[0] < end < rpm[-1]]
    assert len(inside) == sought
    assert sorted(one for one in found if np.min(np.abs(ends - one)) < 1e-6) == pytest.approx(
        inside, rel=1e-12
    )
    assert ((found > rpm[0]) & (found < rpm[-1])).all()


def test_point_within_rounding_of_a_known_one_is_not_apart() -> None:
    known, more = np.array([1.0, 2.0, 3.0]), np.array([0.5, 1.0 + 1e-12, 2.5, 3.0 - 1e-12, 4.0])
    assert apart(known, more).tolist() == [0.5, 2.5, 4.0]
    assert apart(np.array([2.0]), np.array([1.0, 2.0])).tolist() == [1.0]
