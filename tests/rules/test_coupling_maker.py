"""Verdicts of `coupling-maker`, and the heat of a coupling against its closed form."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.response import component_loads
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Line
from torsion.rules import coupling_maker as coupling

RPM = math.pi / 30.0
PSI, STIFFNESS, ELASTIC, FREQUENCY = 1.15, 36000.0, 500.0, 20.0  # B20
LOSS = 79.8611  # W, published
SETTINGS = coupling.CouplingSettings()


def line(**limits):
    body = {"name": "rubber", "stiffness": STIFFNESS, "psi": PSI, **limits}
    excited = {"inertia": 1.0, "ripple": [{"order": 4, "torque": 10.0}]}
    return [("motor", excited), ("coupling", body), ("disc", {"inertia": 2.0})]


def the(checks, clause):
    (found,) = [check for check in checks if check.clause == clause]
    return found


@pytest.mark.parametrize(
    "damping",
    [
        {"psi": PSI, "viscous": None},
        {"magnifier": 5.46364, "psi": None},
        {"loss_factor": 0.1830282, "psi": None},
        {"viscous": 52.43371, "psi": None},
    ],
    ids=["psi", "magnifier", "loss factor", "viscous"],
)
def test_heat_of_every_kind_of_damping_is_the_published_one(study, evidence, damping) -> None:
    scene = study(line(**damping, heat_limit=80.0))
    torque = ELASTIC * (1 + 1j * PSI / (2 * math.pi))
    seen = evidence(
        scene, [FREQUENCY * 15.0], half={"rubber": torque}
    )  # order 4 of 300 rpm is 20 Hz
    check = the(coupling.CouplingMaker(coupling.CouplingSettings()).check(seen), "P_KW")
    assert check.value == pytest.approx(LOSS, rel=1e-6)
    assert (check.verdict, check.unit) == ("pass", "W")


def test_heat_is_torque_times_twist_speed_averaged(study, evidence) -> None:
    scene = study(line(psi=None, viscous=700.0))
    omega, twist = 4 * 300.0 * RPM, 0.3 - 0.1j
    torque = (STIFFNESS + 1j * omega * 700.0) * twist
    seen = evidence(scene, [300.0], half={"rubber": torque})
    power = component_loads.harmonic_heat(seen.need(Response), seen.system, np.array([0])).sum(
        axis=1
    )
    assert power == pytest.approx(0.5 * (torque * np.conj(1j * omega * twist)).real, rel=1e-13)


def test_heat_of_a_soft_coupling_with_little_loss_counts_in_full(study, evidence) -> None:
    """k 2, eta 0.25 and c 0.001 at 125.66 rad/s: a loss of 0.62566 N m/rad, less than 1."""
    seen = evidence(
        study(line(stiffness=2.0, psi=math.pi / 2)), [300.0, 300.0], half={"rubber": [3.0, 6.0]}
    )
    omega = 4 * 300.0 * RPM
    system = replace(seen.system, viscous=np.array([0.001]))
    loss = 2.0 * 0.25 + 0.001 * omega
    power = component_loads.harmonic_heat(seen.need(Response), system, np.array([0])).sum(axis=1)
    assert power == pytest.approx(
        0.5 * omega * loss * np.array([9.0, 36.0]) / (4.0 + loss**2), rel=1e-13
    )


def test_damper_without_stiffness_heats_and_a_rigid_coupling_does_not(study, evidence) -> None:
    seen = evidence(study(line()), [300.0], half={"rubber": 40.0})

    def heat(flexibility: float, viscous: float) -> np.ndarray:
        law = {"flexibility": flexibility, "viscous": viscous, "loss_factor": 0.0}
        system = replace(seen.system, **{key: np.array([value]) for key, value in law.items()})
        return component_loads.harmonic_heat(seen.need(Response), system, np.array([0])).sum(axis=1)

    assert heat(math.inf, 20.0) == pytest.approx(40.0**2 / (2 * 20.0), rel=1e-14)
    assert heat(0.0, 0.0) == [0.0]
    assert heat(1e-4, 0.0) == [0.0]


def test_every_limit_that_is_given_is_judged_at_its_worst_speed(study, evidence) -> None:
    limits = {
        "rated_torque": 900.0,
        "vibratory_torque": 300.0,
        "max_torque": 1000.0,
        "heat_limit": 1e9,
    }
    rpm = np.array([300.0, 600.0, 900.0])
    seen = evidence(
        study(line(**limits)),
        rpm,
        half={"rubber": [10, 310, 250]},
        mean={"rubber": [100, 400, 850]},
    )
    found = coupling.CouplingMaker(coupling.CouplingSettings()).check(seen)
    assert [check.clause for check in found] == ["T_KN", "T_KW", "P_KW", "T_Kmax"]
    mean, vibratory, greatest = (the(found, clause) for clause in ("T_KN", "T_KW", "T_Kmax"))
    assert (mean.value, mean.verdict, mean.speed) == (850, "pass", pytest.approx(900 * RPM))
    assert (vibratory.value, vibratory.verdict, vibratory.speed) == (
        310,
        "fail",
        pytest.approx(600 * RPM),
    )
    assert (greatest.value, greatest.verdict, greatest.speed) == (
        1100,
        "fail",
        pytest.approx(900 * RPM),
    )
    assert {check.standing for check in found} == {"maker"}
    assert not any("to be verified" in check.note for check in found), (
        "a maker's rating is no rule from memory"
    )


def test_speeds_outside_continuous_use_count_for_the_greatest_torque_alone(study, evidence) -> None:
    limits = {"vibratory_torque": 300.0, "max_torque": 500.0, "heat_limit": 500.0}
    rpm = np.array([300.0, 600.0, 900.0])
    seen = evidence(study(line(**limits)), rpm, half={"rubber": [10, 600, 250]})
    requested = coupling.CouplingSettings.model_validate(
        {"continuous": {"from": "700 rpm", "to": "900 rpm"}}
    )
    found = coupling.CouplingMaker(requested).check(seen)
    assert (the(found, "T_KW").value, the(found, "T_KW").verdict) == (250, "restricted")
    assert the(found, "P_KW").speed == pytest.approx(900 * RPM)
    assert (the(found, "T_Kmax").value, the(found, "T_Kmax").verdict) == (600, "fail")
    assert "700 rpm to 900 rpm" in the(found, "T_KW").note


def test_response_that_is_not_ok_never_passes(study, evidence) -> None:
    seen = evidence(
        study(line(vibratory_torque=300.0)), [300.0, 600.0], half={"rubber": [1, 2]}, status=[0, 1]
    )
    (check,) = coupling.CouplingMaker(coupling.CouplingSettings()).check(seen)
    assert (check.verdict, check.value) == ("fail", math.inf)
    assert "near-singular at 600 rpm" in check.note


def test_fixed_frequency_heats_at_its_own_frequency(study, evidence) -> None:
    fixed = Line(None, FREQUENCY, ("grid",))
    torque = ELASTIC * (1 + 1j * PSI / (2 * math.pi))
    seen = evidence(study(line(heat_limit=70.0)), [777.0], half={"rubber": torque}, line=fixed)
    check = the(coupling.CouplingMaker(coupling.CouplingSettings()).check(seen), "P_KW")
    assert check.value == pytest.approx(LOSS, rel=1e-6)
    assert check.verdict == "fail"
    assert "20 Hz (grid)" in check.note


def test_tolerance_of_the_stiffness_is_said_not_to_be_varied(study, evidence) -> None:
    seen = evidence(
        study(line(vibratory_torque=1.0, tolerance=0.15)), [300.0], half={"rubber": [0.5]}
    )
    assert (
        "15 % was not varied"
        in coupling.CouplingMaker(coupling.CouplingSettings()).check(seen)[0].note
    )


def test_coupling_without_limits_gives_nothing_but_is_said_to_be_left_out(study, evidence) -> None:
    scene = study(line())
    assert (
        coupling.CouplingMaker(coupling.CouplingSettings()).check(
            evidence(scene, [300.0], half={"rubber": [9e9]})
        )
        == ()
    )
    assert tuple(coupling.CouplingMaker(coupling.CouplingSettings()).left_out(scene)) == (
        ("coupling-maker for rubber", "its maker's limits are not given"),
    )


def test_faults_are_told_where_they_stand(study) -> None:
    requested = coupling.CouplingSettings.model_validate(
        {"continuous": {"from": "50 rpm", "to": "900 rpm"}}
    )
    rules = [("coupling-maker", requested)]
    bare = list(coupling.CouplingMaker(requested).faults(study(line(), rules)))
    assert [fault.path for fault in bare] == [("rules", 0)]
    assert "rated_torque, vibratory_torque, max_torque, heat_limit" in bare[0].hint
    full = list(
        coupling.CouplingMaker(requested).faults(
            study(line(rated_torque=1.0, heat_limit=1.0), rules, rated=None)
        )
    )
    assert [fault.path for fault in full] == [
        ("rules", 0, "coupling-maker", "continuous"),
        ("operation", "rated", "power"),
    ]
    assert (
        list(
            coupling.CouplingMaker(coupling.CouplingSettings()).faults(
                study(line(vibratory_torque=1.0), rated=None)
            )
        )
        == []
    )
    quiet = [("disc", {"inertia": 1.0}), *line(vibratory_torque=1.0)[1:]]
    assert [
        fault.path
        for fault in coupling.CouplingMaker(requested).faults(study(quiet, rules, speeds=None))
    ] == [
        ("operation", "speeds"),
        ("rules", 0),
    ]


def test_what_is_judged_beside_a_mean_torque_must_be_excited(study) -> None:
    """Of two couplings one has a limit of its mean torque alone, the other one of its vibration."""
    requested = coupling.CouplingSettings()
    still = ("disc", {"inertia": 1.0})
    first, second = (
        line(rated_torque=9.0)[1],
        ("coupling", {"name": "second", "stiffness": 9.0, "max_torque": 7.0}),
    )
    parts = [still, first, ("disc", {"inertia": 3.0}), second, line()[2]]
    (fault,) = list(
        coupling.CouplingMaker(requested).faults(study(parts, [("coupling-maker", requested)]))
    )
    assert "nothing excites the train" in fault.message


@pytest.mark.parametrize("limits", [{"rated_torque": 9.0}, {"max_torque": 9.0}])
def test_mean_torque_must_be_known_where_it_is_compared(study, limits) -> None:
    requested = coupling.CouplingSettings()
    unknown = {"speed": "900 rpm"}
    (fault,) = list(coupling.CouplingMaker(requested).faults(study(line(**limits), rated=unknown)))
    assert fault.path == ("operation", "rated", "power")
    assert "compares that of 'rubber'" in fault.message
    assert (
        list(coupling.CouplingMaker(requested).faults(study(line(heat_limit=9.0), rated=unknown)))
        == []
    )


@pytest.mark.parametrize(("size", "verdict"), [(300.0, "pass"), (300.1, "fail")])
def test_a_maker_s_limit_may_be_used_up(study, evidence, size, verdict) -> None:
    limits = {"rated_torque": 300.0, "vibratory_torque": 300.0, "max_torque": 300.0}
    scene, rpm = study(line(**limits)), [300.0, 600.0]
    mean = coupling.CouplingMaker(SETTINGS).check(
        evidence(scene, rpm, half={}, mean={"rubber": -size})
    )
    assert {check.clause: (check.value, check.verdict) for check in mean} == {
        "T_KN": (size, verdict),
        "T_KW": (0.0, "pass"),
        "T_Kmax": (size, verdict),
    }
    vibratory = coupling.CouplingMaker(SETTINGS).check(evidence(scene, rpm, half={"rubber": size}))
    assert {check.clause: check.verdict for check in vibratory} == {
        "T_KN": "pass",
        "T_KW": verdict,
        "T_Kmax": verdict,
    }


def test_order_of_the_line_is_exact_in_the_note(study, evidence) -> None:
    half_order = Line(Fraction(21, 8), None, ("screw",))
    seen = evidence(
        study(line(vibratory_torque=9.0)), [300.0], half={"rubber": [1.0]}, line=half_order
    )
    assert (
        "2.625 × screw" in coupling.CouplingMaker(coupling.CouplingSettings()).check(seen)[0].note
    )


WARM = {"now": 30.0, "stiffness": [[30.0, 1.0], [90.0, 0.7]], "rise": 60.0, "at": 100.0, "to": 90.0}
TABLE = {"over": "frequency", "at": [1.0, 400.0], "stiffness": [STIFFNESS, STIFFNESS]}


@pytest.mark.parametrize(
    ("given", "key"),
    [
        ({"psi": None, "heat_limit": 80.0}, "heat_limit"),
        ({"psi": None, "temperature": WARM, "vibratory_torque": 80.0}, "temperature"),
        ({"psi": None, "stiffness": None, "table": TABLE, "heat_limit": 80.0}, "heat_limit"),
        ({"psi": 0.0, "heat_limit": 80.0}, ""),
        (
            {
                "psi": None,
                "stiffness": None,
                "table": {**TABLE, "psi": [1.0, 1.0]},
                "heat_limit": 80.0,
            },
            "",
        ),
    ],
    ids=["plain", "warming", "table", "none is stated", "table with psi"],
)
def test_heat_of_a_coupling_whose_damping_nothing_says_is_not_judged_as_none(
    study, given, key
) -> None:
    found = list(coupling.CouplingMaker(coupling.CouplingSettings()).faults(study(line(**given))))
    lossless = [one for one in found if "whose damping is not given" in one.message]
    assert [one.path[-1] for one in lossless] == ([key] if key else [])
