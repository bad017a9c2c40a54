"""What several chapters read from the findings, of amplitudes that were made up."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Any

import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.component_loads import rounding
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output import reported_values as reported
from torsion.output.numbers import NONE
from torsion.output.stored.scene import elements
from torsion.rules.verdict_line import BarredRange, Check, Checks

TRAIN = """
name: x
operation: {speeds: {from: 10 rad/s, to: 30 rad/s, steps: 3}, rated: {speed: 25 rad/s, power: 1 kW}}
train:
- motor: {name: drive, inertia: 2}
- coupling: {name: soft, stiffness: 3000, viscous: 5}
- disc: {name: hub, inertia: 1}
- gear: {name: wheels, teeth: [40, 20], inertia: [1, 0.5]}
- coupling: {name: stiff, stiffness: 0.4, viscous: 3}
- disc: {name: tail, inertia: 1}
"""
EXCITED = (
    TRAIN + "excitations: [{at: tail, order: 1, torque: 1}, {at: drive, order: 3, torque: 2}]\n"
)
PER_RPM = math.pi / 30.0
OK, NEAR, SINGULAR = Status.OK, Status.NEAR_SINGULAR, Status.SINGULAR
STATUS = np.array([[OK, OK], [OK, NEAR], [SINGULAR, SINGULAR], [OK, OK]])  # (speeds, lines)
TORQUE = np.array(  # (speeds, lines, spans) N m
    [
        [[0.1, -0.3j, 0.05], [0.3, 0.01, 0.0]],
        [[-0.2, 0.04, 0.3], [9.0, 9.0, 9.0]],
        [[8.0, 8.0, 8.0], [7.0, 7.0, 7.0]],
        [[0.1, 0.2, 0.1], [0.03 + 0.04j, 0.4j, 0.0]],
    ]
)
RATIO = np.array([1.0, 2.0, 1.0])  # of soft, stiff and the mesh


@pytest.fixture(scope="module")
def solved() -> Findings:
    """Two lines of excitation and three spans, one behind a gear that doubles the speed."""
    return torsion.run(torsion.parse(EXCITED))


@pytest.fixture(scope="module")
def silent() -> Findings:
    """The same train without excitation."""
    return torsion.run(torsion.parse(TRAIN))


@pytest.fixture(scope="module")
def found(solved: Findings) -> Findings:
    """With the amplitudes above."""
    return with_response(solved, torque=TORQUE, status=STATUS, mean=np.zeros((4, 3)))


def with_response(findings: Findings, **values: Any) -> Findings:
    return findings.having(response=replace(findings.need(Response), **values))


def barred_by(findings: Findings, *bands: tuple[float, float]) -> Findings:
    ranges = tuple(
        BarredRange(lower * PER_RPM, upper * PER_RPM, 0.0, "tail") for lower, upper in bands
    )
    line = Check("r", "c", "tail", "x", 1.0, 1.0, "", "pass", "setting", barred=ranges)
    return findings.having(checks=Checks((line,)))


def test_the_reference_is_the_first_component_or_the_one_that_is_named(silent: Findings) -> None:
    assert silent.study.reference == "drive"
    named = torsion.run(torsion.parse(TRAIN.replace("operation: {", "operation: {at: tail, ")))
    assert named.study.reference == "tail"
    assert reported.rated(silent) == 25.0
    assert reported.rated_rpm(silent) == pytest.approx(25.0 / PER_RPM)


def test_a_train_without_operation_has_no_rated_speed(bare: Findings) -> None:
    assert reported.rated(bare) is None
    assert reported.rated_rpm(bare) is None


def test_barred_ranges_stand_in_the_order_of_their_lower_and_then_their_upper_end(
    silent: Findings,
) -> None:
    found = barred_by(silent, (20.0, 30.0), (10.0, 40.0), (10.0, 15.0), (20.0, 30.0))
    ends = [(one.lower / PER_RPM, one.upper / PER_RPM) for one in reported.barred(found)]
    assert ends == [pytest.approx(band) for band in ((10.0, 15.0), (10.0, 40.0), (20.0, 30.0))]


def test_barred_ranges_that_overlap_or_touch_are_one(silent: Findings) -> None:
    found = barred_by(
        silent, (4.0, 5.0), (1.0, 4.0), (2.0, 3.0), (6.0, 7.0), (9.0, 11.0), (8.0, 10.0)
    )
    assert [pytest.approx(band) for band in ((1.0, 5.0), (6.0, 7.0), (8.0, 11.0))] == list(
        reported.barred_rpm(found)
    )


def test_a_range_is_widened_to_tenths_but_not_beyond_the_speeds_requested() -> None:
    band = (298.46, 368.41)
    assert reported.widened(band) == ("298.4", "368.5")
    assert reported.widened(band, (298.4, 368.5)) == ("298.4", "368.5")
    assert reported.widened(band, (298.45123, 368.4432167)) == ("298.451", "368.443")
    assert reported.widened((300.0, 900.0), (300.0, 900.0)) == ("300.0", "900.0")
    assert reported.widened(band, (300.0, 360.0)) == ("300", "360")


def test_a_speed_is_unreliable_where_one_harmonic_component_is(
    found: Findings, bare: Findings
) -> None:
    assert found.need(Response).unreliable.tolist() == [False, True, True, False]


def test_the_amplitude_is_the_largest_of_the_spans_where_it_is_known(
    found: Findings, bare: Findings
) -> None:
    nan = math.nan
    np.testing.assert_allclose(
        found.need(Response).amplitude([0, 2]), [[0.1, 0.3], [0.3, nan], [nan, nan], [0.1, 0.05]]
    )
    np.testing.assert_allclose(
        found.need(Response).amplitude([1]), [[0.3, 0.01], [0.04, nan], [nan, nan], [0.2, 0.4]]
    )


def test_all_lines_together_are_the_largest_half_range_where_every_line_is_known(
    found: Findings, bare: Findings
):
    half = np.array([[1.0, 9.0, 4.0], [2.0, 9.0, 1.0], [7.0, 7.0, 7.0], [3.0, 9.0, 6.0]])
    together = found.having(synthesis=replace(found.need(Synthesis), half_range=half))
    np.testing.assert_allclose(reported.synthesis(together, [0, 2]), [4.0, math.nan, math.nan, 6.0])
    assert reported.synthesis(bare, [0]).shape == (0,)


def test_figures_are_of_the_largest_torques_at_one_speed_and_rigid_elements_only_of_gears(
    silent: Findings,
) -> None:
    soft, wheels, stiff = elements(silent.system)
    assert (soft.ratio, wheels.ratio, stiff.ratio) == (1.0, 1.0, 2.0)

    def worth(torques: tuple[float, float, float], most: int) -> list[str]:
        given = dict(zip((soft, wheels, stiff), torques, strict=True))
        return [one.name for one in reported.worth_a_figure(silent, given, most)]

    assert worth((3.0, 1.0, 2.0), 1) == ["stiff"]
    assert worth((5.0, 1.0, 2.0), 1) == ["soft"]
    assert worth((3.0, 1.0, 2.0), 2) == ["soft", "stiff"]
    assert worth((3.0, 5.0, 2.0), 1) == ["wheels"]
    rigid = silent.having(system=replace(silent.system, flexibility=np.array([0.0, 0.4, 0.0])))
    assert [
        one.name
        for one in reported.worth_a_figure(rigid, dict.fromkeys((soft, wheels, stiff), 1.0), 9)
    ] == [
        "wheels",
        "stiff",
    ]


def test_something_responds_where_a_line_excites_over_speed(
    solved: Findings, silent: Findings, bare: Findings
) -> None:
    assert [reported.responds(one) for one in (solved, silent, bare)] == [True, False, False]


def test_the_orders_of_the_synthesis_are_all_or_those_requested(
    solved: Findings, bare: Findings
) -> None:
    left = with_response(solved, left_out=solved.need(Response).lines[1:])
    assert [reported.orders_together(one) for one in (solved, left, bare)] == [
        "all orders",
        "the orders requested",
        "all orders",
    ]


def test_rounding_is_a_share_of_the_largest_torque_at_one_speed(
    found: Findings, silent: Findings, bare: Findings
):
    """The largest of the reliable ones are 0.3, 0.4 and 0.3 N m; at the reference 0.3, 0.8 and 0.3 N m."""
    np.testing.assert_allclose(rounding(found), 1e-10 * 0.8 / RATIO, rtol=1e-12)
    mean = np.zeros((4, 3))
    mean[1], mean[3, 0] = [0.7, 0.1, -0.9], math.nan
    np.testing.assert_allclose(
        rounding(with_response(found, mean=mean)), 1e-10 * 0.9 / RATIO, rtol=1e-12
    )
    smaller = with_response(found, mean=mean / 2.0)
    np.testing.assert_allclose(rounding(smaller), 1e-10 * 0.8 / RATIO, rtol=1e-12)
    unknown = with_response(found, status=np.full_like(STATUS, SINGULAR))
    assert rounding(unknown).tolist() == [0.0] * 3
    assert rounding(silent).tolist() == [0.0] * 3
    assert rounding(bare).tolist() == [0.0]


def test_unstable_ranges_in_rpm(silent: Findings) -> None:
    assert reported.unstable_rpm(silent) == ()
    ranges = tuple(
        UnstableRange(1, (1,), "", first * PER_RPM, last * PER_RPM, (False, False), 1.0, first)
        for first, last in ((100.0, 110.0), (300.0, 305.0))
    )
    none = np.empty(0)
    stable = Stability(none, none, none, none, none, ranges, none, "hill", 0.0, none, True)
    assert list(reported.unstable_rpm(silent.having(stability=stable))) == [
        pytest.approx((100.0, 110.0)),
        pytest.approx((300.0, 305.0)),
    ]


def test_the_mode_of_a_barred_range_is_that_at_its_critical_speed() -> None:
    undamped = TRAIN.replace(", viscous: 5", "").replace(", viscous: 3", "")
    found = torsion.run(torsion.parse(undamped))
    first, second = 2.0 * math.pi * found.need(Modes).frequency
    band = BarredRange(first / 2.0, second, second / 2.0, "tail", order=Fraction(2))
    assert reported.mode_of(found, band) == "2"
    assert reported.mode_of(found, replace(band, critical=first / 2.0)) == "1"
    assert reported.mode_of(found, replace(band, order=None)) == NONE


@pytest.mark.parametrize(
    ("error", "words"),
    [
        (0.0, None),
        (0.03449, "relative error as at most 3.4 %."),
        (1.0, "relative error as at most 100 %."),
        (1.5, "error of the first-order joint model exceeds 100 %"),
    ],
)
def test_the_joint_model_states_its_largest_error(
    solved: Findings, error: float, words: str | None
) -> None:
    size = np.zeros((3, 2))
    size[1], size[2, 0] = (error, error / 2.0), math.nan
    stated = reported.joint_model(with_response(solved, joint_error=size))
    assert words in stated if words else stated == ""


def test_without_a_response_nothing_is_said_of_the_joint_model(bare: Findings) -> None:
    assert reported.joint_model(bare) == ""
