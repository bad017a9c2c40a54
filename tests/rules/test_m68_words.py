"""What `iacs-m68` says beside its numbers: the note of every clause, and what it leaves out."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.for_all import for_all
from tests.rules.conftest import RPM

from torsion.rules.class_rules import m68
from torsion.rules.class_rules.m68_shafts import least_diameter, tau_c, tau_t
from torsion.rules.coupling_maker import CouplingSettings

BLADES = [{"blade_order": 1, "torque": 10.0}]
W_P = math.pi / 16 * 0.1**3  # m3, of a solid shaft of 100 mm
SPEED = np.linspace(100, 1050, 96)  # rpm, in steps of 10
MOSTLY = "mostly 4 × screw"
FACTORS = f"C_K 1 (flange), C_D {0.35 + 0.93 * 100**-0.2:.4g}, sigma_B 600 N/mm2"


def line(**shaft):
    body = {
        "name": "line",
        "length": 1.0,
        "diameter": 0.1,
        "role": "intermediate",
        "features": ["flange"],
        **shaft,
    }
    screw = {"name": "screw", "inertia": 5.0, "pitch": "fixed", "blades": 4, "excitation": BLADES}
    return [("motor", {"inertia": 3.0}), ("shaft", {"segments": 2, **body}), ("propeller", screw)]


@pytest.fixture
def judged(study, evidence):
    """Checks by clause, of a shaft whose stress is 0.3 of tau_C but at the speeds named; `outside` above 1.05."""

    def run(shares, rpm=SPEED, **settings):
        ratio = np.minimum(rpm, 1050.0) / 1000.0
        share = np.full(len(rpm), 0.3)
        for speed, value in shares.items():
            share[np.argmin(np.abs(rpm - speed))] = value
        half = {"line": share * tau_c(600, 100, 1.0, ratio) * 1e6 * W_P}
        requested = m68.M68Settings(**settings)
        found = m68.M68(requested).check(
            evidence(study(line(), [("iacs-m68", requested)]), rpm, half=half)
        )
        return {"outside" if math.isnan(check.limit) else check.clause: check for check in found}

    return run


def test_note_of_the_continuous_limit_without_a_barred_range(judged) -> None:
    check = judged({900: 0.7})["tau_C"]
    assert (check.rule, check.where, check.what) == (
        "iacs-m68",
        "line",
        "Torsional stress amplitude, continuous operation",
    )
    assert (check.note, check.standing) == (f"{MOSTLY}; {FACTORS}", "rule text")


def test_notes_of_two_barred_ranges_say_both_with_the_tolerance_of_the_tachometer(judged) -> None:
    """16/17.7 and 17.7/16 of 300 rpm, 16/17.5 and 17.5/16 of 500 rpm, each 1 % farther apart."""
    found = judged({300: 1.1, 500: 1.2}, tachometer=0.01)
    ends = [
        share * speed * (18 - speed / 1000) ** sign * 16.0**-sign
        for speed in (300, 500)
        for share, sign in ((0.99, -1), (1.01, 1))
    ]
    assert ends == pytest.approx([268.474, 335.194, 452.571, 552.344], rel=1e-5)
    ranges = "{:.5g} rpm to {:.5g} rpm and {:.5g} rpm to {:.5g} rpm".format(*ends)
    assert found["tau_C"].note == f"{MOSTLY}; outside the barred range {ranges}; {FACTORS}"
    assert found["tau_C"].verdict == "pass"
    passing = found["tau_T"]
    assert (
        passing.note
        == f"barred range {ranges}, to be passed rapidly; tachometer tolerance 1 % added; {MOSTLY}"
    )
    assert [end for one in passing.barred for end in (one.lower, one.upper)] == pytest.approx(
        np.array(ends) * RPM, rel=1e-12
    )
    assert [one.order for one in passing.barred] == [4, 4]
    assert (passing.what, passing.unit, passing.where) == (
        "Torsional stress amplitude, passing a barred range",
        "N/mm2",
        "line",
    )


def test_a_tachometer_without_a_tolerance_is_said_to_be_exact(judged) -> None:
    assert "; tachometer tolerance 0 % assumed; " in judged({500: 1.2})["tau_T"].note
    assert (
        "; tachometer tolerance 2.5 % added; " in judged({500: 1.2}, tachometer=0.025)["tau_T"].note
    )


def test_note_of_stress_that_cannot_be_barred_says_every_critical_speed_and_range(judged) -> None:
    check = judged({820: 1.1, 980: 1.2})["tau_C"]
    first, second = ((16 * n / (18 - n / 1000), n * (18 - n / 1000) / 16) for n in (820, 980))
    ranges = "{:.5g} rpm to {:.5g} rpm and {:.5g} rpm to {:.5g} rpm".format(*first, *second)
    refusal = "the stress exceeds tau_C about 820 rpm and 980 rpm: no barred range is permitted there (lambda >= 0.8): "
    assert check.note == f"{MOSTLY}; {refusal}detune; it would run from {ranges}; {FACTORS}"


def test_stress_above_1_05_has_no_limit(judged) -> None:
    """The limit ends but for rounding."""
    rpm = np.array([500.0, 1050.0 * (1 + 0.5e-9), 1050.0 * (1 + 3e-9), 1100.0])
    found = judged({1100: 0.5}, rpm=rpm)
    beyond = found["outside"]
    assert (beyond.what, beyond.clause) == (
        "Torsional stress amplitude above the last speed with a limit",
        "tau_C",
    )
    assert (
        beyond.note
        == "no continuous operation above 1050 rpm, 1.05 of the rated speed: the rule has no limit there"
    )
    assert (beyond.verdict, beyond.restrictions) == ("restricted", (beyond.note,))
    assert (beyond.standing, math.isnan(beyond.limit), beyond.speed / RPM) == (
        "rule text",
        True,
        pytest.approx(1100),
    )
    assert beyond.value == pytest.approx(0.5 * float(tau_c(600, 100, 1.0, 1.0)), rel=1e-12)
    assert "outside" not in judged({}, rpm=rpm[:2])
    assert judged({}, rpm=rpm[:3])["outside"].speed / RPM == pytest.approx(1050.0, rel=1e-8)
    assert judged({1050: 0.9}, rpm=rpm)["tau_C"].speed / RPM == pytest.approx(1050.0, rel=1e-8)


@pytest.mark.parametrize(
    ("highest", "last", "verdict"),
    [
        (None, None, "restricted"),
        ("1049 rpm", "1049 rpm", "restricted"),
        ("1060 rpm", None, "not judged"),
        (None, "1060 rpm", "not judged"),
    ],
)
def test_continuous_use_above_the_last_limit_is_not_judged(
    study, evidence, highest, last, verdict
) -> None:
    """Use is stated by the highest speed of the train, or by any rule with a range of continuous use."""
    rules = [("iacs-m68", m68.M68Settings())]
    if last is not None:
        use = {"continuous": {"from": "200 rpm", "to": last}}
        rules.append(("coupling-maker", CouplingSettings.model_validate(use)))
    rpm = np.array([500.0, 1000.0, 1100.0])
    half = {"line": 0.3 * tau_c(600, 100, 1.0, np.full(3, 1.0)) * 1e6 * W_P}
    speeds = {"from": "100 rpm", "to": "1040 rpm"}
    scene = study(line(), rules, speeds=speeds, highest=highest)
    checks = m68.M68(rules[0][1]).check(evidence(scene, rpm, half=half))
    (above,) = [check for check in checks if "above the last speed" in check.what]
    assert (above.verdict, math.isnan(above.limit)) == (verdict, True)


def test_stress_at_its_limits_passes(judged) -> None:
    at_limit = judged({900: 1.0})
    assert (at_limit["tau_C"].verdict, "tau_T" in at_limit) == ("pass", False)
    assert judged({900: 1 + 1e-9})["tau_C"].verdict == "fail"
    for share, verdict in ((1.7 * (1 - 1e-12), "restricted"), (1.7 * (1 + 1e-12), "fail")):
        passing = judged({500: share})["tau_T"]
        assert passing.verdict == verdict
        assert passing.limit == pytest.approx(float(tau_t(600, 100, 1.0, 0.5)), rel=1e-14)


TORQUE = 100e3 / (1000 * RPM)  # N m, rated


@pytest.mark.parametrize("greater", ["line [1]", "line [2]"])
@pytest.mark.parametrize(
    ("drive", "factor"), [("electric", 95), ("turbine", 95), ("slip coupling", 95), ("other", 100)]
)
def test_least_diameter_is_that_of_the_piece_with_the_greatest_torque(
    study, evidence, greater, drive, factor
) -> None:
    mean = {"line [1]": 0.5 * TORQUE, "line [2]": 0.5 * TORQUE, greater: -3.0 * TORQUE}
    scene = study(line(features=["radial hole"]), load="constant")
    found = m68.M68(m68.M68Settings(drive=drive)).check(
        evidence(scene, [500.0, 1100.0], half={}, mean=mean)
    )
    (check,) = [one for one in found if one.clause == "minimum diameter"]
    assert check.limit == pytest.approx(factor * 1.1 * (0.3 * 560 / 760) ** (1 / 3), rel=1e-12)
    assert check.note == f"F {factor} (drive: {drive}), k 1.1, 0.3 kW per rpm"
    assert (check.what, check.where, check.speed) == (
        "Outer diameter",
        "line",
        pytest.approx(1000 * RPM),
    )


def test_a_shaft_of_its_least_diameter_passes(study, evidence) -> None:
    needed = {
        torque: least_diameter(torque * RPM / 1e3, 600.0, 100.0, 1.0)
        for torque in np.linspace(2e4, 3e4, 50)
    }
    torque, least = next(
        (torque, least) for torque, least in needed.items() if least / 1e3 * 1e3 == least
    )
    for share, verdict in ((1.0, "pass"), (1 - 1e-9, "not kept")):
        scene = study(line(diameter=least / 1e3 * share), load="constant")
        found = m68.M68(m68.M68Settings()).check(
            evidence(scene, [500.0, 1100.0], half={}, mean={"line": torque})
        )
        (check,) = [one for one in found if one.clause == "minimum diameter"]
        assert check.value == pytest.approx(check.limit, rel=2e-9)
        assert check.verdict == verdict


def test_least_diameter_is_not_judged_without_a_mean_torque(study, evidence) -> None:
    seen = evidence(study(line(), rated={"speed": "900 rpm"}), [500.0, 700.0], half={})
    verdicts = {check.clause: check.verdict for check in m68.M68(m68.M68Settings()).check(seen)}
    assert verdicts == {"tau_C": "pass", "minimum diameter": "not judged"}


NO_ROLE = ("shaft", {"name": "stub", "length": 0.1, "diameter": 0.1})


@for_all(
    ("operation", "lines"),
    [
        ({}, []),
        ({"speeds": {"from": "100 rpm", "to": "1050 rpm"}}, []),
        ({"speeds": {"from": "100 rpm", "to": "1049 rpm"}}, []),
        ({"rated": {"speed": "1000 rpm"}}, []),
        ({"rated": None, "speeds": {"from": "1 rpm", "to": "2 rpm"}}, []),
        ({"speeds": None}, []),
    ],
)
def test_what_is_left_out_is_said(study, operation, lines) -> None:
    scene = study([line()[0], NO_ROLE, *line()[1:]], **operation)
    assert tuple(m68.M68(m68.M68Settings()).left_out(scene)) == (
        ("iacs-m68 for stub", "the shaft has no `role`"),
        *lines,
    )
    stub, judged = scene.train.bars
    meshed = replace(
        scene, train=replace(scene.train, bars=(stub, replace(judged, section=object())))
    )
    rows = list(m68.M68(m68.M68Settings()).demanded_rows(meshed))
    assert ("line", "not judged", m68.NOT_ROUND) in [
        (row.where, row.verdict, row.note) for row in rows
    ]


@pytest.mark.parametrize("role", ["thrust", "propeller"])
def test_a_smooth_drive_favours_intermediate_shafts_alone(study, evidence, role) -> None:
    found = m68.M68(m68.M68Settings(drive="electric")).check(
        evidence(
            study(line(role=role), load="constant"),
            [500.0, 1100.0],
            half={},
            mean={f"line [{piece}]": TORQUE for piece in (1, 2)},
        )
    )
    (check,) = [one for one in found if one.clause == "minimum diameter"]
    assert check.note.startswith("F 100 (drive: electric)")
