"""A verdict on a response by harmonic balance is never below the exact motion beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.contracts.frozen import solved as solved_scene

import torsion
from torsion import rules
from torsion.analyses.motion.derived.nonlinear_peaks import NonlinearPeak, NonlinearPeaks
from torsion.analyses.motion.derived.raised_synthesis import raised_synthesis
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import harmonic_heat
from torsion.findings import Findings
from torsion.output.blocks import Table
from torsion.output.chapters.response.component_loads import couplings
from torsion.rules.verdict_line import Check, Checks


@pytest.fixture(scope="module")
def found() -> Findings:
    return solved_scene("toothed_coupling")


def judged(found: Findings, *each: NonlinearPeak) -> dict[str, Check]:
    """The checks with other exact motions beside the same response."""
    evidence = found.having(nonlinear_peaks=replace(found.need(NonlinearPeaks), each=each))
    return {
        check.clause: check
        for check in rules.verdicts(evidence.having(synthesis=raised_synthesis(evidence)))
    }


def test_a_verdict_takes_the_exact_motion_where_it_is_larger(found: Findings) -> None:
    peaks = found.need(NonlinearPeaks).each
    first = peaks[0]
    assert first.response == pytest.approx(np.abs(found.need(Response).torque).max(), rel=1e-12)
    larger = replace(
        first, half_ranges=np.array([2.0 * first.response]), greatests=np.array([1500.0])
    )
    checks = judged(found, larger, *peaks[1:])
    assert checks["T_KW"].value == pytest.approx(2.0 * first.response, rel=1e-9)
    assert checks["T_KW"].verdict == "fail"
    assert checks["T_Kmax"].value == pytest.approx(1500.0, rel=1e-9)
    assert checks["T_KN"].note == ""  # a mean torque
    assert "the play of 'toothed coupling' opens" in checks["T_KW"].note


def test_an_exact_motion_that_is_smaller_takes_nothing_away(found: Findings) -> None:
    peaks = found.need(NonlinearPeaks).each
    none = np.zeros(1)
    checks = judged(found, *(replace(one, half_ranges=none, greatests=none) for one in peaks))
    largest = np.abs(found.need(Response).torque).max()
    assert checks["T_KW"].value == pytest.approx(largest, rel=1e-9)


@pytest.mark.parametrize("known", [True, False])
def test_what_no_exact_motion_stands_beside_does_not_pass(found: Findings, known: bool) -> None:
    peaks = found.need(NonlinearPeaks).each
    checks = judged(found, *(replace(peak, exact=None) for peak in peaks if known))
    assert checks["T_KN"].verdict == "pass"
    for clause in ("T_KW", "T_Kmax"):
        assert checks[clause].verdict == "not judged"
        assert "compute the transient response" in checks[clause].note


DRY = """
name: dry friction that slips, between two resonances
operation: {speeds: {from: 300 rpm, to: 1500 rpm, steps: 5}, rated: {speed: 1400 rpm, power: 6.7 kW}, load: constant}
train:
- motor: {inertia: 1.2}
- coupling:
    {name: dry, stiffness: 8e3, viscous: 2, hysteresis_torque: {torque: 100, stiffness: 1e6}, vibratory_torque: 900,
     max_torque: 1500, heat_limit: 40 kW}
- disc: {name: p, inertia: 0.4}
- shaft: {name: s, length: 1, diameter: 50 mm}
- propeller: {inertia: 0.5}
excitations: [{at: p, order: 1, torque: 250}]
analyses: {response: }
rules: [coupling-maker]
"""


@pytest.fixture(scope="module")
def slipping() -> Findings:
    return torsion.run(torsion.parse(DRY))


def test_synthesis_of_a_coupling_that_slips_is_at_least_the_exact_motion(
    slipping: Findings,
) -> None:
    """Harmonic balance has one harmonic of the friction, which alone is 46 % low at 966 rpm."""
    response, total = slipping.need(Response), slipping.need(Synthesis)
    peaks = [peak for peak in slipping.need(NonlinearPeaks).each if peak.exact is not None]
    assert max(peak.half_range / peak.response for peak in peaks) > 1.3
    for peak in peaks:
        speed = int(np.argmin(np.abs(response.speed - peak.speed)))
        assert (total.half_range[speed] >= peak.half_ranges * (1.0 - 1e-12)).all()
        assert (total.peak[speed] >= peak.greatests * (1.0 - 1e-12)).all()


def test_value_of_the_verdict_is_the_value_of_the_table(slipping: Findings) -> None:
    checks = {check.clause: check.value for check in slipping.need(Checks).lines}
    total, span = (
        slipping.need(Synthesis),
        [span.name for span in slipping.system.spans].index("dry"),
    )
    assert checks["T_KW"] == total.half_range[:, span].max()
    assert checks["T_Kmax"] == total.peak[:, span].max()
    (table,) = (block for block in couplings(slipping) if isinstance(block, Table))
    cells = dict(zip([column.name for column in table.columns], table.rows[0], strict=True))
    for clause, name in (("T_KW", "torque"), ("T_Kmax", "peak"), ("P_KW", "heat")):
        assert float(cells[name]) == pytest.approx(checks[clause], rel=1e-3)


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
    findings = torsion.run(torsion.parse(text), only=("response",))
    response = findings.need(Response)
    amplitude, w = np.abs(response.angle[:, 0, 0]), response.speed
    known = (
        w / (2.0 * math.pi) * 4.0 * 20.0 * (amplitude - 20.0 / 4e3)
        + 0.5 * 2.0 * (w * amplitude) ** 2
    )
    assert harmonic_heat(response, findings.system, np.array([0])).sum(axis=1) == pytest.approx(
        known, rel=1e-9
    )


TRAIN = """
name: x
operation: {{speeds: {{from: 300 rpm, to: 660 rpm, steps: 37}}, rated: {{speed: 640 rpm, power: 6.70206 kW}}, load: constant}}
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
        (
            "clearance: 2 deg",
            80,
            "",
            True,
        ),  # 81 of 100 N m at most: the play stays closed, and the answer is exact
        ("clearance: 2 deg", 100, "", False),  # 101
        (
            "clearance: 2 deg",
            88,
            ", {at: p, order: 3, torque: 15}",
            False,
        ),  # neither opens it alone, both do
        (
            "clearance: 2 deg",
            65,
            ", {at: p, order: 3, torque: 15}",
            False,
        ),  # near its end beside a second component
        ("clearance: 2 deg", 30, ", {at: p, order: 3, torque: 15}", True),
        (
            "stages: [{from: 0.5 deg, stiffness: 2e4}]",
            50,
            "",
            True,
        ),  # 175 N m at the begin of the second
        ("stages: [{from: 0.5 deg, stiffness: 2e4}]", 100, "", False),
        (
            "hysteresis_torque: {torque: 20, stiffness: 2e4}",
            100,
            "",
            True,
        ),  # friction alone takes energy away
    ],
)
def test_no_verdict_passes_where_a_play_or_stage_leaves_its_linear_range(
    more, torque, second, passes
) -> None:
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
operation: {speeds: {from: 950 rpm, to: 1500 rpm, steps: 56}}
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
