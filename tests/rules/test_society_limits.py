"""Limits of crankshafts and generator shafts against their formulas by hand, at the edges of their speed ratios."""

import math

import numpy as np
import pytest

from torsion.rules.class_rules.m68_shafts import tau_c, tau_t
from torsion.rules.class_rules.society_limits import (
    CCS_CRANK,
    KR_IN_LINE,
    KR_OTHER,
    KR_SET_CRANK,
    KR_SET_SHAFT,
    NUMBERED,
    OWN,
    crank_curve,
    set_curve,
    strength_factor,
    yield_factor,
)

EDGE = 1 - 1e-12


def at(curve, *ratios):
    return curve.continuous(np.array(ratios))


def test_crankshafts_of_kr_at_the_given_vectors() -> None:
    in_line, other = (crank_curve(table, NUMBERED, 200.0) for table in (KR_IN_LINE, KR_OTHER))
    np.testing.assert_allclose(
        at(in_line, 0.5, 0.8, 0.9, 1.0), [39.0, 29.64, 25.56, 21.0], rtol=1e-14
    )
    np.testing.assert_allclose(
        at(other, 0.5, 0.8, 0.9, 1.0), [37.75, 26.44, 21.51, 16.0], rtol=1e-14
    )
    np.testing.assert_allclose(
        at(in_line, 1.05, 1.15), [21 + 59.25 * math.sqrt(0.05), 53.1263968569], rtol=3e-12
    )
    by_hand = 16.0 + 237.0 * 0.3 * math.sqrt(0.1)
    np.testing.assert_allclose(at(other, 1.1), [by_hand], rtol=1e-13)


def test_crankshafts_of_kr_end_at_1_15_and_pass_barred_ranges_at_twice_the_limit_up_to_0_8() -> (
    None
):
    curve = crank_curve(KR_IN_LINE, NUMBERED, 200.0)
    assert np.isfinite(at(curve, 1.15, 1.15 * (1 + 2e-9))).tolist() == [True, False]
    np.testing.assert_allclose(curve.while_passing(np.array([0.5, 0.8])), [78.0, 59.28], rtol=1e-14)
    assert np.isnan(curve.while_passing(np.array([0.8 * (1 + 2e-9), 1.0]))).all()
    ranges = curve.ranges(np.array([0.5, 1.0, 1.05, 1.15, 1.2]))
    assert {clause: within.tolist() for clause, within in ranges.items()} == {
        "tau_1": [True, True, False, False, False],
        "tau_3": [False, False, True, True, False],
    }


def test_factors_of_the_material_are_capped_and_never_below_one() -> None:
    assert strength_factor(600.0, alloy=True) == pytest.approx(1.24242424242, rel=1e-11)
    assert strength_factor(600.0, alloy=False) == strength_factor(590.0, alloy=False)
    assert strength_factor(590.0, alloy=False) == pytest.approx(
        1 + 2 / 3 * (590 / 440 - 1), rel=1e-14
    )
    assert strength_factor(900.0, alloy=True) == pytest.approx(
        1 + 2 / 3 * (835 / 440 - 1), rel=1e-14
    )
    assert strength_factor(None, alloy=True) == strength_factor(400.0, alloy=True) == 1.0
    assert yield_factor(350.0) == pytest.approx(1.55555555556, rel=1e-11)
    assert yield_factor(None) == yield_factor(200.0) == 1.0


def test_f_m_of_the_strength_is_that_of_tau_1_and_tau_3_and_of_the_yield_that_of_tau_2() -> None:
    plain, strong = (
        crank_curve(KR_OTHER, NUMBERED, 0.0),
        crank_curve(KR_OTHER, NUMBERED, 0.0, 1.2, 1.5),
    )
    np.testing.assert_allclose(at(strong, 0.4, 1.1), 1.2 * at(plain, 0.4, 1.1), rtol=1e-14)
    ratio = np.array([0.4])
    np.testing.assert_allclose(
        strong.while_passing(ratio), 1.5 * plain.while_passing(ratio), rtol=1e-14
    )


def test_shafts_of_a_generator_set_step_at_90_percent_and_end_at_110() -> None:
    for limits, use, below in (
        (KR_SET_CRANK["in-line"], 21, 90),
        (KR_SET_CRANK["other"], 16, 90),
        (KR_SET_SHAFT, 31, 118),
    ):
        curve = set_curve(limits, 1.0)
        np.testing.assert_array_equal(at(curve, 0.5, 0.9 * (1 - 2e-9)), [below, below])
        np.testing.assert_array_equal(at(curve, 0.9 * EDGE, 0.9, 1.0, 1.1, 1.1 / EDGE), [use] * 5)
        assert np.isnan(at(curve, 1.1 * (1 + 2e-9))).all()
        assert curve.passing is None
        assert {0.9, 1.0, 1.1} <= set(curve.corners)


def test_crankshafts_of_ccs_at_the_given_vectors() -> None:
    curve = crank_curve(CCS_CRANK, OWN, 300.0)
    np.testing.assert_allclose(at(curve, 0.5, 0.8, 1.0), [35.75, 24.908, 14.9], rtol=1e-13)
    np.testing.assert_allclose(curve.while_passing(np.array([0.8])), [49.816], rtol=1e-13)
    over = (18.1 - 0.0113 * 300) + (87.3 - 0.052 * 300) * math.sqrt(0.05)
    np.testing.assert_allclose(at(curve, 1.05), [over], rtol=1e-13)
    thicker = crank_curve(CCS_CRANK, OWN, 500.0)
    assert (at(thicker, 0.3, 0.8, 1.0, 1.1) < at(curve, 0.3, 0.8, 1.0, 1.1)).all()


def test_line_shafts_at_the_edges_of_m68() -> None:
    """(sigma_B + 160)/18 C_K C_D (3 - 2 l^2), and 1.38 from 0.9; C_D of 400 mm is 0.35 + 0.93 400^-0.2."""
    base = 760 / 18 * (0.35 + 0.93 * 400**-0.2)
    by_hand = base * np.array([1.72, 1.38, 1.38, 1.38])
    np.testing.assert_allclose(tau_c(600, 400, 1.0, [0.8, 0.9, 1.0, 1.05]), by_hand, rtol=1e-13)
    assert np.isnan(tau_c(600, 400, 1.0, [1.1, 1.15])).all()
    np.testing.assert_allclose(tau_t(600, 400, 1.0, [0.8]), [1.7 * by_hand[0]], rtol=1e-13)
