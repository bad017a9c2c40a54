"""Temperatures of couplings against an independent solution of two masses, root by root."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq
from tests.for_all import for_all

import torsion
from torsion.analyses.response.coupling_temperatures import (
    CouplingTemperature,
    CouplingTemperatures,
)
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

RPM = math.pi / 30.0
WARM = (
    "temperature: {now: 30 degC, stiffness: [[30, 1], [100 degC, 60 %], [130, 0.6]], "
    "magnifier: [[30, 8], [100, 10.67], [130, 10.67]], rise: 70 K, at: 400 W, to: 130 degC}"
)
TEXT = """name: test
train:
  - disc: {{name: a, inertia: 10}}
  - coupling: {{name: c, {coupling}}}
  - disc: {{name: b, inertia: 40}}
operation: {{speeds: {{from: 390 rpm, to: 540 rpm, steps: 2}}}}
excitations: [{{at: a, order: 1, torque: {torque}}}]
{rest}
"""


def solved(
    torque: float, coupling: str = f"stiffness: 20e3, {WARM}", rest: str = "rules: [coupling-maker]"
) -> Findings:
    return torsion.run(torsion.parse(TEXT.format(coupling=coupling, torque=torque, rest=rest)))


def of(found: Findings) -> CouplingTemperature:
    return found.need(CouplingTemperatures).each[0]


def heat(theta: float, hertz: float, torque: float, viscous: float = 0.0) -> float:
    """W of two masses by their equations of motion, k and the magnifier linear between 30 and 100 degC."""
    share, w = (min(theta, 100.0) - 30.0) / 70.0, 2.0 * math.pi * hertz
    k, eta = 20e3 * (1.0 - 0.4 * share), 1.0 / (8.0 + 2.67 * share)
    stiffness = k * (1.0 + 1j * eta) + 1j * w * viscous
    motion = np.array(
        [[stiffness - 10.0 * w**2, -stiffness], [-stiffness, stiffness - 40.0 * w**2]]
    )
    twist = np.array([1.0, -1.0]) @ np.linalg.solve(motion, [torque, 0.0])
    return float(0.5 * w * stiffness.imag * abs(twist) ** 2)


def roots(hertz: float, torque: float) -> list[float]:
    """By brentq between 1001 temperatures."""

    def excess(theta: float) -> float:
        return 30.0 + 70.0 / 400.0 * heat(theta, hertz, torque) - theta

    grid = np.linspace(30.0, 130.0, 1001).tolist()
    signs = [excess(theta) > 0.0 for theta in grid]
    places = [k for k in range(1000) if signs[k] != signs[k + 1]]
    return [float(brentq(excess, grid[k], grid[k + 1], xtol=1e-13)) for k in places]


def test_three_equilibria_are_found_and_the_middle_one_is_unstable() -> None:
    found = of(solved(250.0))
    assert found.number[0] == 3
    listed = [one for one in found.equilibria if one.speed == found.speed[0]]
    assert [one.temperature for one in listed] == pytest.approx(roots(6.5, 250.0), rel=1e-12)
    assert [one.temperature for one in listed] == pytest.approx(
        [38.766455592, 74.066734624, 97.467898674], abs=1e-9
    )
    assert [one.heat for one in listed] == pytest.approx(
        [50.094031954, 251.809912135, 385.530849568], abs=1e-8
    )
    assert [one.is_stable for one in listed] == [True, False, True]
    assert (found.lowest[0], found.highest[0]) == (listed[0].temperature, listed[2].temperature)


def test_one_equilibrium_at_9_hz_has_its_stiffness_and_loss_factor() -> None:
    found = of(solved(700.0))
    assert found.lowest[-1] == found.highest[-1] == pytest.approx(61.553800369, abs=1e-9)
    only = next(iter(of(solved(50.0)).equilibria))
    share = (only.temperature - 30.0) / 70.0
    assert only.stiffness == pytest.approx(20e3 * (1.0 - 0.4 * share), rel=1e-13)
    assert only.loss_factor == pytest.approx(1.0 / (8.0 + 2.67 * share), rel=1e-13)


def test_temperatures_over_the_speed_are_those_of_the_equations_of_motion() -> None:
    found = of(solved(250.0))
    for k in np.linspace(0, len(found.speed) - 1, 7).astype(int):
        every = roots(found.speed[k] / (2.0 * math.pi), 250.0)
        assert found.number[k] == len(every)
        assert (found.lowest[k], found.highest[k]) == pytest.approx(
            (every[0], every[-1]), rel=1e-11
        )


def test_all_equilibria_of_the_first_and_of_the_last_speed_with_several_are_listed() -> None:
    found = of(solved(250.0))
    several = found.speed[found.number > 1]
    assert several[0] < several[-1]
    for speed in several[[0, -1]].tolist():
        listed = [state.temperature for state in found.equilibria if state.speed == speed]
        assert listed == pytest.approx(roots(speed / (2.0 * math.pi), 250.0), rel=1e-10)


def test_viscous_damping_beside_a_magnifier_warms_the_coupling_too() -> None:
    """At 9 Hz 20 N m s/rad lose 1131 of the 2500 N m/rad that the magnifier loses at 30 degC."""
    found = of(solved(700.0, f"stiffness: 20e3, viscous: 20, {WARM}"))
    warm = float(found.lowest[-1])
    assert warm == pytest.approx(30.0 + 70.0 / 400.0 * heat(warm, 9.0, 700.0, 20.0), rel=1e-11)
    assert warm > 62.0  # 61.55 degC without it


def test_coupling_that_runs_away_fails_the_rule_of_its_maker() -> None:
    found = solved(350.0)
    assert roots(6.5, 350.0) == []
    assert of(found).number[0] == 0
    assert np.isnan(of(found).lowest[0])
    (check,) = found.need(Checks).lines
    assert (check.clause, check.verdict, check.value) == ("ΔT", "fail", math.inf)
    assert found.exit_status == 1


def test_the_worst_speed_is_one_without_an_equilibrium() -> None:
    """It has no equilibria to list, and only the speeds with several are listed with it: here there are none."""
    found = of(solved(350.0))
    for k in np.linspace(0, len(found.speed) - 1, 5).astype(int).tolist():
        assert found.number[k] == len(roots(float(found.speed[k]) / (2.0 * math.pi), 350.0))
    assert (found.number.min(), found.number.max()) == (0, 1)
    assert found.equilibria == ()


def test_coupling_that_warms_little_passes_and_one_that_makes_no_heat_stays_cold() -> None:
    (check,) = solved(50.0).need(Checks).lines
    assert check.verdict == "pass"
    still = of(solved(1e-9))
    assert (still.number == 1).all()
    assert still.highest == pytest.approx(30.0, abs=1e-12)


@pytest.mark.parametrize(
    ("rest", "why"),
    [
        ("links: [{between: [a, b], coupling: {name: d, stiffness: 30e3}}]", "closes a loop"),
        (
            "links: [{between: [a, b], coupling: {name: d, stiffness: 30e3, clearance: 0.1 deg}}]",
            "not balanced again",
        ),
    ],
)
def test_coupling_whose_temperature_has_no_answer_does_not_pass(rest: str, why: str) -> None:
    found = solved(50.0, f"stiffness: 20e3, {WARM}", f"rules: [coupling-maker]\n{rest}")
    assert found.get(CouplingTemperatures) is None
    assert [why in one.why for one in found.plan.unanswered] == [True]
    (check,) = [one for one in found.need(Checks).lines if one.rule == "coupling-maker"]
    assert (check.clause, check.verdict, check.limit) == ("ΔT", "not judged", 100.0)
    assert math.isnan(check.value)
    assert "were not solved" in check.note


def test_other_results_are_of_a_coupling_as_cold_as_its_surroundings() -> None:
    """Now 65 degC: factor 0.8 on the stiffness, and the loss factor of psi = 0.5."""
    warm = "temperature: {now: 65, stiffness: [[30, 1], [100, 0.6]], psi: [[30, 0.6], [100, 0.4]], rise: 1, at: 1e3, "
    warm += "to: 90}"
    plain = "stiffness: 16e3, psi: 0.5"
    first, second = (solved(100.0, one, "") for one in (f"stiffness: 20e3, {warm}", plain))
    assert first.results["modes"].frequency == pytest.approx(
        second.results["modes"].frequency, rel=1e-14
    )
    ends = [found.results["response"].torque[[0, -1]] for found in (first, second)]
    assert np.abs(ends[0] - ends[1]).max() <= 1e-12 * np.abs(ends[1]).max()


def test_table_over_frequency_warms_by_its_factor() -> None:
    """A table of one stiffness and loss factor has the equilibria of the plain coupling."""
    warm = "temperature: {now: 30, stiffness: [[30, 1], [100, 0.6]], rise: 70, at: 400 W, to: 100}"
    flat = "table: {over: frequency, at: [1, 50], stiffness: [20e3, 20e3], loss_factor: [0.1, 0.1]}"
    first, second = (
        of(solved(200.0, f"{one}, {warm}")) for one in (flat, "stiffness: 20e3, loss_factor: 0.1")
    )
    assert first.number[[0, -1]].tolist() == second.number[[0, -1]].tolist()
    assert first.lowest[[0, -1]] == pytest.approx(second.lowest[[0, -1]], rel=1e-10)


@for_all(
    ("good", "bad", "words"),
    [
        ("to: 130 degC", "to: 20 degC", "20 degC is not above the 30 degC of `now`"),
        ("to: 130 degC", "to: 140 degC", "the rows run from 30 to 130 degC"),
        (
            "[[30, 1], [100 degC, 60 %], [130, 0.6]]",
            "[[30, 1], [20, 0.6]]",
            "two rows or more, rising",
        ),
        ("[[30, 1], [100 degC, 60 %], [130, 0.6]]", "[1, 0.6]", "not a table over temperature"),
        ("rise: 70 K", "rise: 343 K", "outside the usual range"),
        ("at: 400 W", "at: 400 K", "a difference of temperature"),
        (
            "stiffness: 20e3, ",
            "stiffness: 20e3, psi: 1, ",
            "`psi` and `temperature` both say what the coupling loses",
        ),
        ("stiffness: 20e3, ", "flexibility: 0, ", "a rigid coupling"),
        (
            "stiffness: 20e3, ",
            "stiffness: 20e3, clearance: 1 deg, ",
            "`temperature` and `clearance` exclude each other",
        ),
    ],
)
def test_faulty_temperature_is_refused_in_its_line(good: str, bad: str, words: str) -> None:
    coupling = f"stiffness: 20e3, {WARM}".replace(good, bad)
    with pytest.raises(InputError, match=words) as caught:
        torsion.parse(TEXT.format(coupling=coupling, torque=1, rest=""))
    assert caught.value.faults[0].line == 4
