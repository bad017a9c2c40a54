"""Verdicts of `gear-hammer` at every mesh of a gear."""

import math

import numpy as np
import pytest

from torsion.analyses.response.amplitudes import Response
from torsion.findings import Results
from torsion.rules.strength import gear_hammer as gear

RPM = math.pi / 30.0


def line(**body):
    excited = {"inertia": 1.0, "ripple": [{"order": 4, "torque": 10.0}]}
    wheels = {"name": "gearbox", "teeth": [20, 40], **body}
    return [("motor", excited), ("gear", wheels), ("disc", {"inertia": 2.0})]


RPMS = np.array([250.0, 500.0, 900.0, 1100.0])
MEAN = 1000.0 * (RPMS / 1000.0) ** 2  # propeller law, 1000 N m at the rated speed


def verdicts(checks):
    return {check.clause: check for check in checks}


@pytest.mark.parametrize(
    ("body", "requested", "share"),
    [
        ({}, {}, 0.35),
        ({"application_factor": 1.25}, {}, 0.25),
        ({"application_factor": 1.25}, {"limit": 0.5}, 0.5),
    ],
)
def test_limit_comes_from_the_setting_else_the_gear_else_the_usual_factor(
    study, evidence, body, requested, share
) -> None:
    seen = evidence(
        study(line(**body)), RPMS, half={"gearbox": [10, 20, 200, 30]}, mean={"gearbox": MEAN}
    )
    found = verdicts(gear.GearHammer(gear.GearHammerSettings.model_validate(requested)).check(seen))
    check = found["(K_A - 1) T_rated"]
    assert check.limit == pytest.approx(1000.0 * share, rel=1e-12)
    assert (check.value, check.verdict, check.speed) == (200, "pass", pytest.approx(900 * RPM))
    assert check.standing == ("setting" if requested else "to be verified")
    assert found["torque reversal"].standing == "to be verified"


def test_vibratory_torque_above_its_share_of_the_rated_torque_is_not_kept(study, evidence) -> None:
    seen = evidence(
        study(line()), RPMS, half={"gearbox": [10, 20, 351, 30]}, mean={"gearbox": MEAN}
    )
    found = verdicts(gear.GearHammer(gear.GearHammerSettings()).check(seen))
    assert found["(K_A - 1) T_rated"].verdict == "not kept"
    assert found["(K_A - 1) T_rated"].fails
    assert (
        verdicts(gear.GearHammer(gear.GearHammerSettings(limit=0.35)).check(seen))[
            "(K_A - 1) T_rated"
        ].verdict
        == "fail"
    )
    assert found["torque reversal"].verdict == "pass"


def test_torque_reverses_where_vibration_exceeds_the_mean(study, evidence) -> None:
    seen = evidence(
        study(line()), RPMS, half={"gearbox": [63, 200, 300, 30]}, mean={"gearbox": MEAN}
    )
    check = verdicts(gear.GearHammer(gear.GearHammerSettings()).check(seen))["torque reversal"]
    assert (check.value, check.verdict) == (63, "not kept")
    assert check.limit == pytest.approx(62.5, rel=1e-12)
    requested = gear.GearHammerSettings.model_validate(
        {"continuous": {"from": "400 rpm", "to": "1100 rpm"}}
    )
    narrowed = verdicts(gear.GearHammer(requested).check(seen))["torque reversal"]
    assert (narrowed.value, narrowed.verdict, narrowed.speed) == (
        200,
        "restricted",
        pytest.approx(500 * RPM),
    )


def test_mean_torque_that_drives_backwards_counts_by_its_size(study, evidence) -> None:
    seen = evidence(
        study(line()), RPMS, half={"gearbox": [63, 20, 30, 40]}, mean={"gearbox": -MEAN}
    )
    found = verdicts(gear.GearHammer(gear.GearHammerSettings()).check(seen))
    assert found["(K_A - 1) T_rated"].limit == pytest.approx(350, rel=1e-12)
    assert found["torque reversal"].limit == pytest.approx(62.5, rel=1e-12)
    assert found["torque reversal"].verdict == "not kept"


def test_rated_torque_of_a_constant_load_lies_between_its_neighbours(study, evidence) -> None:
    seen = evidence(
        study(line(), load="constant"),
        RPMS,
        half={"gearbox": [1, 1, 1, 1]},
        mean={"gearbox": [77.0] * 4},
    )
    assert verdicts(gear.GearHammer(gear.GearHammerSettings()).check(seen))[
        "(K_A - 1) T_rated"
    ].limit == pytest.approx(0.35 * 77, rel=1e-12)


def test_every_wheel_is_a_mesh_and_an_idle_one_hammers(study, evidence) -> None:
    scene = study(line(branches=[{"teeth": 30, "inertia": 0.1}]))
    half = {"gearbox": [1, 1, 1, 1], "gearbox wheel 2": [5, 0, 0, 0]}
    found = gear.GearHammer(gear.GearHammerSettings()).check(
        evidence(scene, RPMS, half=half, mean={"gearbox": MEAN, "gearbox wheel 2": 1e-13})
    )
    assert [(check.where, check.verdict) for check in found] == [
        ("gearbox", "pass"),
        ("gearbox", "pass"),
        ("gearbox wheel 2", "not kept"),
    ]
    assert "carries no mean torque" in found[2].note


@pytest.mark.parametrize(
    ("whole", "side", "loaded"),
    [
        (1e6, 0.9e-3, False),
        (1e6, 1.1e-3, True),
        (1e-3, 0.9e-12, False),
        (1e-3, 1.1e-12, True),
        (0.5, 0.25, True),
    ],
)
def test_a_mesh_with_less_than_a_billionth_of_the_greatest_torque_is_unloaded(
    study, evidence, whole, side, loaded
) -> None:
    scene = study(line(branches=[{"teeth": 30, "inertia": 0.1}]), load="constant")
    mean = {"gearbox": whole, "gearbox wheel 2": side}
    found = gear.GearHammer(gear.GearHammerSettings()).check(
        evidence(scene, RPMS, half={}, mean=mean)
    )
    of_side = {check.clause: check for check in found if check.where == "gearbox wheel 2"}
    assert set(of_side) == {"torque reversal", *(["(K_A - 1) T_rated"] if loaded else [])}
    assert ("the mesh carries no mean torque" in of_side["torque reversal"].note) == (not loaded)
    if loaded:
        assert of_side["(K_A - 1) T_rated"].limit == pytest.approx(0.35 * side, rel=1e-12)


def test_speeds_outside_continuous_use_count_for_the_rating_alone(study, evidence) -> None:
    seen = evidence(
        study(line()), RPMS, half={"gearbox": [400, 200, 300, 30]}, mean={"gearbox": MEAN}
    )
    requested = gear.GearHammerSettings.model_validate(
        {"continuous": {"from": "400 rpm", "to": "1000 rpm"}}
    )
    found = verdicts(gear.GearHammer(requested).check(seen))
    of_rating, reversal = found["(K_A - 1) T_rated"], found["torque reversal"]
    assert (of_rating.value, of_rating.verdict, of_rating.speed) == (
        400,
        "not kept",
        pytest.approx(250 * RPM),
    )
    assert of_rating.note == "0.35 (usual K_A 1.35) x 1000 N m; mostly 4 × screw"
    assert reversal.note == "in continuous use, 400 rpm to 1000 rpm; mostly 4 × screw"
    assert (reversal.value, reversal.verdict) == (200, "restricted")


@pytest.mark.parametrize(
    ("body", "requested", "words"),
    [
        ({"application_factor": 1.25}, {}, "0.25 (K_A 1.25) x 1000 N m"),
        ({}, {"limit": 0.5}, "0.5 (setting `limit`)"),
    ],
)
def test_note_says_which_share_of_which_torque_is_permissible(
    study, evidence, body, requested, words
) -> None:
    seen = evidence(study(line(**body)), RPMS, half={"gearbox": 1.0}, mean={"gearbox": MEAN})
    check = verdicts(gear.GearHammer(gear.GearHammerSettings(**requested)).check(seen))[
        "(K_A - 1) T_rated"
    ]
    assert check.note.startswith(words)


@pytest.mark.parametrize(
    ("top", "words"), [(1100.0, ""), (950.0, "judged up to 950 rpm only, 0.95 of the rated speed")]
)
def test_rating_says_where_the_speeds_end_below_the_rated_one(study, evidence, top, words) -> None:
    """The mean torque is computed up to the rated speed, the response up to the last speed alone."""
    seen = evidence(study(line()), RPMS, half={"gearbox": 1.0}, mean={"gearbox": MEAN})
    short = evidence(study(line()), [*RPMS[:3], top], half={"gearbox": 1.0}, mean={"gearbox": 9.0})
    together = Results(seen.study, {**seen.results, "response": short.need(Response)})
    check = verdicts(gear.GearHammer(gear.GearHammerSettings()).check(together))[
        "(K_A - 1) T_rated"
    ]
    assert check.note == "; ".join(
        text for text in ("0.35 (usual K_A 1.35) x 1000 N m", words, "mostly 4 × screw") if text
    )


def test_a_limit_may_be_used_up(study, evidence) -> None:
    seen = evidence(
        study(line(), load="constant"), RPMS, half={"gearbox": 50.0}, mean={"gearbox": 100.0}
    )
    used = verdicts(gear.GearHammer(gear.GearHammerSettings(limit=0.5)).check(seen))
    assert (used["(K_A - 1) T_rated"].value, used["(K_A - 1) T_rated"].verdict) == (50.0, "pass")
    level = evidence(
        study(line(), load="constant"), RPMS, half={"gearbox": 100.0}, mean={"gearbox": 100.0}
    )
    assert (
        verdicts(gear.GearHammer(gear.GearHammerSettings()).check(level))["torque reversal"].verdict
        == "pass"
    )


def test_mesh_without_any_torque_passes(study, evidence) -> None:
    found = gear.GearHammer(gear.GearHammerSettings()).check(
        evidence(study(line()), RPMS, half={}, mean={})
    )
    assert [(check.clause, check.verdict) for check in found] == [("torque reversal", "pass")]


def test_response_that_is_not_ok_never_passes(study, evidence) -> None:
    seen = evidence(
        study(line()), RPMS, half={"gearbox": 1.0}, mean={"gearbox": MEAN}, status=[0, 0, 2, 0]
    )
    found = gear.GearHammer(gear.GearHammerSettings()).check(seen)
    assert [check.verdict for check in found] == ["fail", "fail"]
    assert all("is singular at 900 rpm" in check.note for check in found)


@pytest.mark.parametrize(
    ("operation", "path"),
    [
        ({"rated": None}, ("operation", "rated")),
        ({"rated": {"speed": "900 rpm"}}, ("operation", "rated", "power")),
        ({"speeds": None}, ("operation", "speeds")),
    ],
)
def test_rated_torque_and_speeds_must_be_known(study, operation, path) -> None:
    requested = gear.GearHammerSettings()
    assert (
        list(gear.GearHammer(requested).faults(study(line(), [("gear-hammer", requested)]))) == []
    )
    assert [
        fault.path
        for fault in gear.GearHammer(requested).faults(
            study(line(), [("gear-hammer", requested)], **operation)
        )
    ] == [path]


def test_train_without_a_gear_cannot_be_judged(study) -> None:
    requested = gear.GearHammerSettings()
    parts = [line()[0], ("coupling", {"stiffness": 1.0}), line()[2]]
    assert [
        fault.path
        for fault in gear.GearHammer(requested).faults(study(parts, [("gear-hammer", requested)]))
    ] == [("rules", 0)]
