"""The formulas of M68 against the published check vectors, to every digit printed."""

import math

import numpy as np
import pytest
from pydantic import ValidationError
from tests.for_all import for_all

from torsion.model.shafts.shaft import Feature
from torsion.rules.class_rules import m68_shafts as m68
from torsion.rules.class_rules import shaft_limits
from torsion.rules.rule_over_speed import Curve

VECTORS = [  # sigma_B, d, C_K, lambda, C_D, tau_C, tau_T
    (600, 400, 1.0, 0.5, 0.63059, 66.56219, 113.15573),
    (600, 400, 1.0, 0.8, 0.63059, 45.79479, 77.85114),
    (600, 400, 1.0, 0.95, 0.63059, 36.74233, None),
    (520, 102, 1.0, 1.0, 0.71878, 37.47220, None),
    (520, 120, 0.55, 1.0, 0.70698, 20.27154, None),
    (600, 500, 0.55, 0.4, 0.61834, 38.48287, 88.21349),
    (560, 350, 0.45, 0.6, 0.63818, 26.19106, 66.37365),
]


@pytest.mark.parametrize(("strength", "diameter", "c_k", "ratio", "c_d", "tau_c", "tau_t"), VECTORS)
def test_limits_agree_with_the_check_vectors(
    strength, diameter, c_k, ratio, c_d, tau_c, tau_t
) -> None:
    assert round(m68.size_factor(diameter), 5) == c_d
    assert round(float(m68.tau_c(strength, diameter, c_k, ratio)), 5) == tau_c
    passing = float(m68.tau_t(strength, diameter, c_k, ratio))
    assert math.isnan(passing) if tau_t is None else round(passing, 5) == tau_t


@pytest.mark.parametrize(
    ("critical", "rated", "lower", "upper"),
    [(60, 100, 55.17241, 65.25), (45, 91, 41.12994, 49.23420)],
)
def test_barred_ranges_agree_with_the_check_vectors(critical, rated, lower, upper) -> None:
    assert [round(end, 5) for end in shaft_limits.barred_range(critical, rated)] == [lower, upper]


def test_least_diameter_agrees_with_the_check_vector() -> None:
    assert round(m68.least_diameter(10000 / 100, 500, 100, 1), 2) == 439.42


def test_slot_agrees_with_the_check_vector() -> None:
    scf = m68.slot_concentration(1.0, 0.5, 0.7, 0.2)
    assert round(scf, 5) == 3.66491
    assert round(m68.SLOT_FACTOR / scf, 5) == 0.39564


def test_slot_depends_on_shape_alone() -> None:
    assert m68.slot_concentration(300, 150, 210, 60) == pytest.approx(
        m68.slot_concentration(1, 0.5, 0.7, 0.2), rel=1e-14
    )


def test_limit_ends_at_1_05_and_has_no_step_at_0_9() -> None:
    below, at, above = m68.tau_c(600, 400, 1, [0.9 - 1e-9, 0.9, 1.0])
    assert below == pytest.approx(at, rel=1e-8)
    assert at == above
    last, beyond = m68.tau_c(600, 400, 1, [1575 / 1500, 1.0500001])
    assert last == at
    assert np.isnan(beyond)


def test_speed_ratio_of_1_05_survives_the_rounding_of_units() -> None:
    ratio = (1575 * 2 * math.pi / 60) / (1500 * 2 * math.pi / 60)
    assert np.isfinite(m68.tau_c(600, 400, 1, np.nextafter(ratio, 2)))


@pytest.mark.parametrize(
    ("role", "alloy", "given", "used"),
    [
        ("intermediate", False, 900, 600),
        ("intermediate", True, 900, 800),
        ("thrust", False, 700, 600),
        ("thrust", True, 700, 700),
        ("thrust", True, 801, 800),
        ("thrust", False, 600.5, 600),
        ("propeller", False, 700, 600),
        ("propeller", True, 700, 600),
        ("propeller", True, 520, 520),
    ],
)
def test_strength_is_capped_by_steel_and_role(role, alloy, given, used) -> None:
    assert m68.used_strength(given, role, alloy=alloy) == used


@for_all(
    ("feature", "c_k", "k"),
    [
        ("flange", 1.0, 1.0),
        ("shrink fit", 1.0, 1.0),
        ("taper keyway", 0.6, 1.1),
        ("cylinder keyway", 0.45, 1.1),
        ("radial hole", 0.5, 1.1),
        ("slot", 0.3, 1.2),
        ("thrust collar", 0.85, 1.1),
        ("roller bearing", 0.85, 1.1),
        ("propeller flange", 0.55, 1.22),
        ("propeller keyless", 0.55, 1.22),
        ("propeller keyed", 0.55, 1.26),
        ("tube shaft", 0.8, 1.15),
    ],
)
def test_details_have_the_factors_of_the_table(feature, c_k, k) -> None:
    detail = m68.DETAILS[feature]
    assert (detail.c_k, detail.k) == (c_k, k)
    assert detail.c_k_mark == "rule text"
    assert detail.has_keyway == ("key" in feature and feature != "propeller keyless")


@pytest.mark.parametrize(
    ("role", "c_k", "k"),
    [("intermediate", 1.0, 1.0), ("thrust", 0.85, 1.1), ("propeller", 0.55, 1.26)],
)
def test_a_shaft_without_features_has_those_of_its_role(role, c_k, k) -> None:
    assert (m68.ASSUMED[role].c_k, m68.ASSUMED[role].k, m68.ASSUMED[role].has_keyway) == (
        c_k,
        k,
        False,
    )


def test_every_feature_of_a_shaft_is_in_the_table() -> None:
    assert set(m68.DETAILS) == set(Feature.__args__)


def test_bore_counts_from_0_4_of_the_diameter() -> None:
    solid = m68.least_diameter(100, 500, 100, 1)
    assert m68.least_diameter(100, 500, 100, 1, 0.4) == solid
    assert m68.least_diameter(100, 500, 100, 1, 0.5) == pytest.approx(
        solid * (16 / 15) ** (1 / 3), rel=1e-14
    )


def test_the_stress_of_passing_has_a_limit_up_to_0_8_of_the_rated_speed() -> None:
    at = np.array([0.8, np.nextafter(0.8, 1.0), 0.8 * (1.0 + 1e-6)])
    limits = m68.tau_t(600, 100, 1.0, at)
    assert np.isfinite(limits).tolist() == [True, True, False]
    assert limits[0] == pytest.approx(1.7 * float(m68.tau_c(600, 100, 1.0, 0.8)), rel=1e-14)


EDGE = 1 + 1e-9  # a speed ratio that near to a bound is at the bound


def test_bounds_of_the_speed_ratio_hold_but_for_rounding() -> None:
    last = m68.tau_c(600, 100, 1.0, [1.05 * EDGE, 1.05 * (1 + 2e-9)])
    assert np.isfinite(last).tolist() == [True, False]
    passing = m68.tau_t(600, 100, 1.0, [0.8 * EDGE, 0.8 * (1 + 2e-9)])
    assert np.isfinite(passing).tolist() == [True, False]
    for upper, is_permitted in ((0.4, 1), (0.8 * (1 - 2e-9), 1), (0.8 * (1 - 5e-10), 0), (0.8, 0)):
        critical = 9.0 - math.sqrt(81.0 - 16.0 * upper)  # of a range that ends at this speed ratio
        peak = Curve(
            critical * np.array([0.99, 1.0, 1.01]),
            np.array([0.0, 2.0, 0.0]),
            np.ones(3),
            np.zeros(3, dtype=int),
        )
        barred = shaft_limits.barring(peak, 1.0, "shaft")
        assert (len(barred.permitted), len(barred.refused)) == (is_permitted, 1 - is_permitted)


def test_a_slot_is_at_least_as_long_as_it_is_wide() -> None:
    assert m68.Slot(length=0.02, width=0.02).length == 0.02
    with pytest.raises(ValidationError, match="shorter than it is wide"):
        m68.Slot(length=0.02, width=0.021)
