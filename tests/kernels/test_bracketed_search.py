"""Roots and minima between bounds, against scipy's step by step and closed forms."""

import math

import numpy as np
import pytest
from scipy.optimize import brentq, minimize_scalar
from tests.for_all import for_all

from torsion.kernels.bracketed_search import find_minimum, find_root

CURVES = [
    (lambda x: math.cos(x) - x, 0.0, 1.0),
    (lambda x: x**3 - 2.0 * x - 5.0, 2.0, 3.0),
    (lambda x: math.exp(-20.0 * x) - 1e-3, 0.0, 4.0),
    (lambda x: math.copysign(abs(x - 0.3) ** 0.2, x - 0.3), 0.0, 1.0),
    (lambda x: 1.0 if x > 0.7 else -2.0, 0.0, 1.0),
]


def _visited(search, curve):
    points = []

    def seen(x):
        points.append(float(x))
        return curve(float(x))

    search(seen)
    return points


@for_all("tolerance", [1e-3, 1e-13])
@for_all(("curve", "low", "high"), CURVES)
def test_a_root_is_sought_where_scipy_seeks_it(curve, low, high, tolerance):
    eps = 4.0 * np.finfo(float).eps
    peer = _visited(lambda f: brentq(f, low, high, xtol=tolerance, rtol=eps), curve)
    own = _visited(lambda f: find_root(f, low, high, tolerance=tolerance), curve)
    np.testing.assert_allclose(own, peer, rtol=1e-14)


@for_all("tolerance", [1e-2, 1e-9])
@for_all(("curve", "low", "high"), CURVES)
def test_a_minimum_is_sought_where_scipy_seeks_it(curve, low, high, tolerance):
    def squared(x):
        return curve(x) ** 2

    options = {"xatol": tolerance, "maxiter": 60}
    peer = _visited(
        lambda f: minimize_scalar(f, bounds=(low, high), method="bounded", options=options), squared
    )
    own = _visited(lambda f: find_minimum(f, low, high, tolerance=tolerance, most=60), squared)
    np.testing.assert_allclose(own, peer, rtol=1e-12)


def test_many_roots_side_by_side_are_those_of_each_alone():
    shift = np.linspace(-0.9, 0.9, 7)
    found = find_root(lambda x: np.cos(x) - x - shift, np.full(7, -3.0), np.full(7, 3.0))
    alone = [brentq(lambda x, s=s: math.cos(x) - x - s, -3.0, 3.0, xtol=1e-15) for s in shift]
    np.testing.assert_allclose(found, alone, atol=1e-14)


def test_bounds_without_a_change_of_sign_are_refused():
    with pytest.raises(ValueError, match="same sign"):
        find_root(lambda x: x * x + 1.0, -1.0, 1.0)


def test_a_bound_that_is_a_root_is_returned():
    assert find_root(lambda x: x - 1.0, 1.0, 2.0) == 1.0
    assert find_root(lambda x: x - 2.0, 1.0, 2.0) == 2.0
