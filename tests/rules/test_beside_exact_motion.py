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
