"""The figure of errors against run times."""

import numpy as np

from torsion.output.figures.error_curves import LEAST, run_times
from torsion.output.figures.style import page

TIME = np.array([1.0, 2.0, 40.0])
CURVES = [
    ("lumped", "lumped", 0, TIME, 0.9 * TIME, 1.1 * TIME, np.array([1e-1, 1e-3, 1e-5])),
    ("fem, degree 3", "fem", 3, 2 * TIME, TIME, 3 * TIME, np.array([1e-2, 1e-8, 1e-14])),
    ("exact", "exact", 0, TIME[:1], TIME[:1], TIME[:1], np.array([0.0])),
]


def drawn(**changes: object) -> str:
    values = {"curves": CURVES, "tolerance": 1e-3, "bound": 1e-13, "best": (2.0, 1e-3), **changes}
    return page("figure", run_times, **values)


def test_every_method_the_tolerance_and_the_recommendation_are_named() -> None:
    text = drawn()
    for label in ("lumped", "fem, degree 3", "exact", "tolerance", "recommended", "below the bound of the reference"):
        assert f">{label}<" in text


def test_without_a_recommendation_none_is_drawn() -> None:
    assert ">recommended<" not in drawn(best=None)


def test_an_error_of_zero_is_drawn_as_half_the_rounding_unit() -> None:
    at_least = [(*curve[:6], np.maximum(curve[6], LEAST)) for curve in CURVES]
    assert drawn() == drawn(curves=at_least)
    assert drawn() != drawn(curves=CURVES[:2])


def test_errors_from_a_hundredth_of_a_per_cent_on_are_told_in_per_cent() -> None:
    text = drawn()
    assert ">100 %<" in text
    assert ">1e−06<" in text
