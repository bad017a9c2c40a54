"""Scenes of shafting_specs show the physics that they are there for."""

import math
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.contracts.frozen import SCENES, solved

import torsion
from torsion.analyses.motion.transient_motion import Transients
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.steady import Steady
from torsion.analyses.tooth_forces import ToothForces
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

TABLE = (Path(__file__).parents[2] / "shafting_specs" / "README.md").read_text(encoding="utf-8")
HERTZ = {"Hz": 1.0, "rad/s": 1.0 / (2.0 * math.pi), "/min": 1.0 / 60.0}
RPM = math.pi / 30.0
HEAVIEST = 2_000_000  # bytes of a page, of whatever scene and all of its cases
SECOND_JOINT = "  - joint: {angle: 5 deg}\n  - shaft: {name: tail shaft"  # of usv.yaml


def station(found: Findings, component: str) -> int:
    return found.study.train[component].stations[0]


def span(found: Findings, component: str) -> int:
    """The first span of a component."""
    return next(
        k for k, one in enumerate(found.system.spans) if one.name.split(" [")[0] == component
    )


def at_rated(found: Findings) -> int:
    return int(np.argmin(np.abs(found.need(Steady).speed - found.study.operation.rated.speed)))


@pytest.mark.parametrize(
    ("scene", "propeller"),
    [("haixun_06402", "propeller-1"), ("usv", "propeller-1"), ("pump_1200kw", "impeller")],
)
def test_blade_orders_of_the_reference_are_blades_times_speed_ratio_exactly(
    scene: str, propeller: str
) -> None:
    found = solved(scene)
    part = found.study.train[propeller]
    lines = {line.order for line in found.need(Response).lines if propeller in line.sources}
    assert lines == {k * part.impeller.blades * part.ratio for k in (1, 2)}


def test_ratios_of_the_scenes_are_those_of_their_gears() -> None:
    assert solved("haixun_06402").study.train["propeller-1"].ratio == Fraction(8, 21)  # 1/2.625
    assert solved("pump_1200kw").study.train["impeller"].ratio == Fraction(42, 125)


@pytest.mark.parametrize(
    ("scene", "propeller"),
    [("haixun_06402", "propeller-1"), ("usv", "propeller-1"), ("pump_1200kw", "impeller")],
)
def test_power_that_enters_at_the_motor_leaves_at_the_propeller(scene: str, propeller: str) -> None:
    found = solved(scene)
    ratio = float(found.study.train[propeller].ratio)
    motor, load = (
        found.need(Steady).applied[station(found, name)] for name in ("motor-1", propeller)
    )
    np.testing.assert_allclose(-load * ratio, motor, rtol=1e-14)


def test_haixun_propeller_carries_the_motor_torque_times_the_gear_ratio() -> None:
    found = solved("haixun_06402")
    motor, propeller = (
        found.need(Steady).torque[span(found, name)] for name in ("motor shaft", "propeller shaft")
    )
    np.testing.assert_allclose(propeller, 2.625 * motor, rtol=1e-14)
    rated = at_rated(found)
    assert motor[rated] == pytest.approx(400e3 / (1800.0 * RPM), rel=1e-13)
    np.testing.assert_allclose(
        motor, motor[rated] * (found.need(Steady).speed / (1800.0 * RPM)) ** 2, rtol=1e-13
    )


def test_pump_shaft_carries_the_rated_power_at_504_rpm() -> None:
    found = solved("pump_1200kw")
    pump = found.need(Steady).torque[span(found, "pump shaft"), at_rated(found)]
    assert pump == pytest.approx(1200e3 / (504.0 * RPM), rel=1e-13)


@pytest.mark.parametrize(
    ("scene", "failing"),
    [("twin_motor_ferry", []), ("dredge_pump_line", [("rubber coupling", "T_KW", "fail")])],
)
def test_scenes_of_many_checks_fail_as_they_say(
    scene: str, failing: list[tuple[str, str, str]]
) -> None:
    found = solved(scene)
    checks = found.need(Checks).lines
    assert len(checks) > 30
    assert [
        (one.where, one.clause, one.verdict)
        for one in checks
        if one.verdict not in ("pass", "restricted")
    ] == failing
    assert found.failed == bool(failing)


def test_two_motors_share_the_power_and_their_pinions_the_force() -> None:
    found = solved("twin_motor_ferry")
    rated, steady = at_rated(found), found.need(Steady)
    for motor in ("port motor", "starboard motor"):
        assert steady.applied[station(found, motor), rated] == pytest.approx(
            900e3 / (1200.0 * RPM), rel=1e-13
        )
    port, starboard = found.need(ToothForces).meshes
    assert starboard.tangential == pytest.approx(port.tangential, rel=1e-12)
    assert port.tangential == pytest.approx(
        900e3 / (1200.0 * RPM) * 2 * math.cos(math.radians(12)) / 0.168, rel=1e-13
    )
    assert {
        propeller.ratio for propeller in found.study.train.parts if propeller.kind == "propeller"
    } == {Fraction(21, 100)}


def order_two(second_joint: str) -> np.ndarray:
    """(speeds, elastic spans) complex N m of order 2 of the unmanned boat, its second joint rewritten."""
    text = SCENES["usv"].read_text(encoding="utf-8")
    assert SECOND_JOINT in text
    study = torsion.parse(
        text.replace(SECOND_JOINT, SECOND_JOINT.replace("{angle: 5 deg}", second_joint))
    )
    system = torsion.assemble(study.train, frequency=60.0)
    requested = np.linspace(300.0, 1800.0, 16) * RPM
    answer = torsion.response(study, system, speeds=requested)
    line = [one.order for one in answer.lines].index(Fraction(2))
    assert set(answer.lines[line].sources) == {"joint-1", "joint-2"}
    return answer.torque[answer.requested, line][:, answer.system.flexibility > 0]


def test_yokes_in_line_cancel_and_crossed_yokes_add() -> None:
    in_line, crossed = order_two("{angle: 5 deg}"), order_two("{angle: 5 deg, phase: 90 deg}")
    assert np.all(np.abs(in_line) < 0.1 * np.abs(crossed))


def test_a_turned_plane_undoes_a_phase_of_the_same_size() -> None:
    in_line, both = (
        order_two("{angle: 5 deg}"),
        order_two("{angle: 5 deg, phase: 30 deg, plane: 30 deg}"),
    )
    np.testing.assert_allclose(both, in_line, rtol=0, atol=1e-12 * np.abs(in_line).max())


def test_the_clutch_of_the_power_take_off_slips_until_both_sides_turn_alike() -> None:
    (motion,) = solved("pto_clutch_in").need(Transients).each
    assert motion.switching is not None
    events = [
        (event.time, event.what) for event in motion.switching.events if event.coupling == "clutch"
    ]
    assert [what for _, what in events] == ["slip", "stuck"]
    assert motion.greatest[0] == pytest.approx(520.0, rel=1e-12)  # its capacity, and no more
    assert motion.greatest[2:].max() < 1.06 * 1600.0  # the safety clutch gives way at 1.6 kN m
    assert motion.following == ("start at engine", "load at flywheel of the baler")
    assert motion.system is not None
    names = [station.name for station in motion.system.stations]
    engine, baler = (
        motion.speed[names.index(name)] * 30.0 / math.pi
        for name in ("engine", "flywheel of the baler")
    )
    assert (
        motion.changes[0].time > 0.1 + 0.4 * 60.0 * 17.0 / 66.0 / 520.0
    )  # the load holds what the clutch carries less
    assert np.abs(baler[motion.time < motion.changes[0].time]).max() < 1e-9
    assert engine.min() > 1950.0  # on the droop of its governor
    assert motion.residual < 1e-11


def test_the_idler_of_the_gearbox_hits_both_flanks_in_every_firing() -> None:
    (motion,) = solved("idling_gearbox").need(Transients).each
    assert motion.switching is not None
    works = {one.coupling: one for one in motion.switching.couplings}
    firings = 2 * 800 / 60 * motion.time[-1]
    assert works["teeth of third gear"].contacts > 3 * firings
    assert motion.greatest[1] > 0.0 > motion.least[1]
    assert works["clutch"].heat > 0.0
    assert motion.residual < 1e-8


def test_the_play_of_the_toothed_coupling_opens_at_a_resonance_that_bends() -> None:
    found = solved("toothed_coupling")
    response, checks = found.need(Response), found.need(Checks).lines
    balanced, speed = response.balanced, response.speed * 30.0 / math.pi
    assert balanced is not None
    opens, several = speed[balanced.share[:, 0] < 1.0], speed[balanced.number[:, 0] > 1]
    mean, resonance = 15e3 / (1800.0 * RPM), 20.0 * found.need(Modes).frequency[0]
    assert opens.max() == pytest.approx(
        1579.4, abs=2.0
    )  # the closed play carries 79.6 N m of vibration there
    assert np.abs(response.torque[speed > opens.max(), 0, 0]).max() < mean
    assert several.max() < opens.max() < 1.07 * resonance
    each = found.results["nonlinear_peaks"].each
    assert len(each) >= 4
    assert all(one.exact is not None for one in each)
    kept = [one for one in each if one.response < 1.2 * one.exact]
    assert all(abs(one.difference) < 0.06 for one in kept)
    assert [one.from_rest for one in kept[-1:]] == [None]  # one solution alone
    (judged,) = (check for check in checks if check.clause == "T_KW")
    assert judged.value >= max(*(one.half_range for one in each), np.abs(response.torque).max())
    assert "the play of 'toothed coupling' opens" in judged.note
