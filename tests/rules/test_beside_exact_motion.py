"""A verdict on a response by harmonic balance is never below the exact motion beside it."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion import rules
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.transient.nonlinear_peaks import NonlinearPeaks
from torsion.findings import Findings
from torsion.rules.coupling_maker import heat
from torsion.rules.verdict_line import Check

SCENE = Path(__file__).parents[2] / "shafting_specs" / "toothed_coupling.yaml"


@pytest.fixture(scope="module")
def found() -> Findings:
    return torsion.run(torsion.read(SCENE))


def judged(found: Findings, peaks: NonlinearPeaks) -> dict[str, Check]:
    return {one.clause: one for one in rules.verdicts(found.having(nonlinear_peaks=peaks))}


def test_a_verdict_takes_the_exact_motion_where_it_is_larger(found: Findings) -> None:
    peaks = found.need(NonlinearPeaks).each
    first = peaks[0]
    assert first.response == pytest.approx(np.abs(found.need(Response).torque).max(), rel=1e-12)
    larger = replace(first, half_ranges=np.array([2.0 * first.response]), greatests=np.array([1500.0]))
    checks = judged(found, NonlinearPeaks((larger, *peaks[1:])))
    assert checks["T_KW"].value == pytest.approx(2.0 * first.response, rel=1e-9)
    assert checks["T_KW"].verdict == "fail"
    assert checks["T_Kmax"].value == pytest.approx(1500.0, rel=1e-9)
    assert checks["T_KN"].note == ""  # a mean torque
    assert "the play of 'toothed coupling' opens" in checks["T_KW"].note


def test_an_exact_motion_that_is_smaller_takes_nothing_away(found: Findings) -> None:
    peaks = found.need(NonlinearPeaks).each
    none = np.zeros(1)
    checks = judged(found, NonlinearPeaks(tuple(replace(one, half_ranges=none, greatests=none) for one in peaks)))
    largest = np.abs(found.need(Response).torque).max()
    assert checks["T_KW"].value == pytest.approx(largest, rel=1e-9)


@pytest.mark.parametrize("known", [True, False])
def test_what_no_exact_motion_stands_beside_does_not_pass(found: Findings, known: bool) -> None:
    peaks = found.need(NonlinearPeaks).each
    unsettled = NonlinearPeaks(tuple(replace(one, exact=None) for one in peaks) if known else ())
    checks = judged(found, unsettled)
    assert checks["T_KN"].verdict == "pass"
    for clause in ("T_KW", "T_Kmax"):
        assert checks[clause].verdict == "fail"
        assert "compute the motion over time" in checks[clause].note


def test_the_heat_of_friction_is_the_area_of_its_loop() -> None:
    text = """name: x
operation: {speeds: {from: 112 rad/s, to: 118 rad/s, steps: 3}}
train:
- disc: {name: d, inertia: 1}
- coupling: {name: dry, stiffness: 1e4, viscous: 2, hysteresis_torque: {torque: 20, stiffness: 4e3}}
- disc: {held: true}
excitations: [{at: d, order: 1, torque: 10}]
analyses: {response: }
"""
    findings = torsion.run(torsion.parse(text))
    response = findings.need(Response)
    amplitude, w = np.abs(response.angle[:, 0, 0]), response.speed
    known = w / (2.0 * math.pi) * 4.0 * 20.0 * (amplitude - 20.0 / 4e3) + 0.5 * 2.0 * (w * amplitude) ** 2
    assert heat(response, findings.system, np.array([0])) == pytest.approx(known, rel=1e-9)


TRAIN = """
name: x
operation: {{speeds: {{from: 300 rpm, to: 660 rpm}}, rated: {{speed: 640 rpm, power: 6.70206 kW}}, load: constant}}
train:
- motor: {{held: true}}
- coupling:
    {{name: c, stiffness: 2e4, viscous: 20, {more}, vibratory_torque: 900, heat_limit: 1 kW, max_torque: 1900,
     rated_torque: 200}}
- propeller: {{name: p, inertia: {inertia}}}
excitations: [{{at: p, order: 1, torque: {torque}}}{second}]
analyses: {{response: {{}}}}
rules: [coupling-maker]
"""


@pytest.mark.parametrize(
    ("more", "torque", "second", "passes"),
    [
        ("clearance: 2 deg", 80, "", True),  # 81 of 100 N m at most: the play stays closed, and the answer is exact
        ("clearance: 2 deg", 100, "", False),  # 101
        ("clearance: 2 deg", 88, ", {at: p, order: 3, torque: 15}", False),  # neither opens it alone, both do
        ("clearance: 2 deg", 65, ", {at: p, order: 3, torque: 15}", False),  # near its end beside a second component
        ("clearance: 2 deg", 30, ", {at: p, order: 3, torque: 15}", True),
        ("stages: [{from: 0.5 deg, stiffness: 2e4}]", 50, "", True),  # 175 N m at the begin of the second
        ("stages: [{from: 0.5 deg, stiffness: 2e4}]", 100, "", False),
        ("hysteresis_torque: {torque: 20, stiffness: 2e4}", 100, "", True),  # friction alone takes energy away
    ],
)
def test_no_verdict_passes_where_a_play_or_stage_leaves_its_linear_range(more, torque, second, passes) -> None:
    text = TRAIN.format(more=more, inertia=0.05, torque=torque, second=second)
    checks = {one.clause: one for one in rules.verdicts(torsion.run(torsion.parse(text)))}
    assert checks["T_KN"].verdict == "pass"  # the mean torque is known whatever vibrates
    for clause in ("T_KW", "T_Kmax", "P_KW"):
        assert checks[clause].value < checks[clause].limit
        assert (checks[clause].verdict == "pass") is passes
        assert ("leaves its linear range" in checks[clause].note) is not passes


def test_a_play_that_carries_no_mean_torque_never_passes() -> None:
    text = """
name: it rattles for good once it does, and harmonic balance finds it open
operation: {speeds: {from: 950 rpm, to: 1500 rpm}}
train:
- motor: {inertia: 2}
- coupling: {name: c, stiffness: 2e4, clearance: {angle: 0.5 deg, viscous: 2000}, viscous: 1, vibratory_torque: 36}
- disc: {name: p, inertia: 0.5}
excitations: [{at: p, order: 1, torque: 20}]
analyses: {response: {}}
rules: [coupling-maker]
"""
    (only,) = rules.verdicts(torsion.run(torsion.parse(text)))
    assert only.value < 1e-6
    assert only.verdict == "fail"
