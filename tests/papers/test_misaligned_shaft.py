"""Misaligned rigid shaft: Hill's matrix, monodromy and integration in time tell one story; zones and response."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from torsion.analyses.lateral.misaligned_shaft import (
    EXACT,
    MisalignedShaft,
    Model,
    growth,
    monodromies,
    small_angle_part,
)
from torsion.analyses.lateral.tilt_stability import zones

SHAFT = MisalignedShaft(4.597e-3, 3.96e-5, 0.46, (7.74, 23.22), (1e-3, 1e-3), 0.3, np.radians(5.0))
STEEP = replace(SHAFT, polar=0.3, tilt=0.6, damping=(2e-3, 5e-3))
STILL = replace(SHAFT, damping=(0.0, 0.0))
SPEEDS = np.array([7.0, 19.0, 25.9, 31.0])


@pytest.mark.parametrize("shaft", [SHAFT, STILL, STEEP])
@pytest.mark.parametrize("name", ["exact", "small angle", "driven speed uneven"])
def test_hill_and_monodromy_agree(shaft: MisalignedShaft, name: str, paper) -> None:
    small = paper["zhu_wang_theory"].SMALL_ANGLE
    model = {"exact": EXACT, "small angle": small, "driven speed uneven": Model(is_even=False)}[
        name
    ]
    rate = growth(shaft, SPEEDS, model).rate
    np.testing.assert_allclose(
        paper["zhu_wang_theory"].hill_growth(shaft, SPEEDS, model, 14), rate, rtol=0.0, atol=1e-10
    )


def test_monodromy_agrees_with_integration_in_time(paper) -> None:
    """The driven equations have the same free motion: two runs differ by what half a turn makes of their start."""
    speed = 25.9

    def after(start: np.ndarray) -> np.ndarray:
        found = solve_ivp(
            paper["zhu_wang_theory"].linear_rate,
            (0.0, np.pi / speed),
            start,
            "DOP853",
            rtol=1e-12,
            atol=1e-14,
            args=(STEEP, speed, EXACT),
        )
        return found.y[:, -1]

    still = after(np.zeros(4))
    whole = np.stack([after(way) - still for way in np.eye(4)], axis=-1)
    np.testing.assert_allclose(
        monodromies(STEEP, np.array([speed]))[0], whole, rtol=0.0, atol=1e-10
    )


def test_periodic_response_repeats_itself_in_time(paper) -> None:
    speed, shaft = 22.0, replace(STEEP, damping=(2e-2, 5e-2))
    found = paper["zhu_wang_theory"].response(shaft, np.array([speed]), count=14)
    assert found.status == ("ok",)
    start = np.concatenate(
        [found.angle[0].sum(axis=1).real, (1j * speed * found.angle[0] @ found.order).real]
    )
    run = solve_ivp(
        paper["zhu_wang_theory"].linear_rate,
        (0.0, np.pi / speed),
        start,
        "DOP853",
        rtol=1e-12,
        atol=1e-14,
        args=(shaft, speed, EXACT),
    )
    np.testing.assert_allclose(run.y[:, -1], start, rtol=0.0, atol=1e-10 * np.abs(start).max())


def test_small_motions_of_the_exact_equations_are_the_linear_ones(paper) -> None:
    """Their difference, relative to the motion, falls with the square of the tilt."""
    theory = paper["zhu_wang_theory"]
    for scale in (1e-1, 1e-2):
        shaft = replace(SHAFT, tilt=scale * SHAFT.tilt)
        runs = [
            solve_ivp(
                rate,
                (0.0, 0.2),
                np.zeros(4),
                "DOP853",
                rtol=1e-12,
                atol=1e-16,
                args=(shaft, 25.9, *more),
            ).y[:2, -1]
            for rate, more in ((theory.exact_rate, ()), (theory.linear_rate, (EXACT,)))
        ]
        assert np.abs(runs[0] - runs[1]).max() < 0.1 * scale**2 * np.abs(runs[1]).max()


def test_natural_frequencies_of_the_spinning_shaft_solve_the_closed_quadratic(paper) -> None:
    """Without damping (w1^2 - w^2)(w2^2 - w^2) = (p Om w)^2."""
    speed, shaft = 40.0, replace(STEEP, damping=(0.0, 0.0))
    natural_frequencies = paper["zhu_wang_theory"].natural_frequencies
    one, two = shaft.square
    spread = one + two + (shaft.polar * speed) ** 2
    closed = np.sqrt((spread + np.array([-1.0, 1.0]) * np.sqrt(spread**2 - 4.0 * one * two)) / 2.0)
    np.testing.assert_allclose(natural_frequencies(shaft, speed).frequency[0], closed, rtol=1e-13)
    np.testing.assert_allclose(
        natural_frequencies(shaft).frequency[0], np.sqrt(np.sort(shaft.square)), rtol=1e-13
    )
    heavy = replace(SHAFT, damping=(0.5, 1.0))
    np.testing.assert_allclose(heavy.frequency, natural_frequencies(heavy).frequency[0], rtol=1e-13)
    assert replace(SHAFT, damping=(9.0, 0.5)).frequency[0] == 0.0  # overdamped
    still = natural_frequencies(SHAFT)
    np.testing.assert_allclose(still.decay[0], SHAFT.decay / 2.0, rtol=1e-12)


def test_without_torque_nothing_grows() -> None:
    shaft = replace(SHAFT, torque=0.0)
    np.testing.assert_allclose(growth(shaft, SPEEDS).rate, -shaft.decay[0] / 2.0, rtol=1e-4)
    assert zones(shaft, 15.0, 30.0, points=40) == ()


def test_boundaries_without_circulation_and_damping_are_where_multipliers_collide() -> None:
    """Symplectic: x = m + 1/m solves x^2 - a x + b - 2 = 0 with the trace a; its discriminant changes sign there."""
    shaft = replace(STILL, polar=0.0)
    model = Model(lambda turned, tilt: small_angle_part(turned, sine=1.0, cosine=1.0, constant=0.0))
    (zone,) = zones(shaft, 24.0, 28.0, model, 60)

    def discriminant(speed: float) -> float:
        one = monodromies(shaft, np.array([speed]), model)[0]
        trace, second = np.trace(one), (np.trace(one) ** 2 - np.trace(one @ one)) / 2.0
        return float(trace**2 - 4.0 * (second - 2.0))

    for bound, way in ((zone.first, -1.0), (zone.last, 1.0)):
        assert discriminant(bound + way * 1e-8) > 0.0 > discriminant(bound - way * 1e-8)


def test_a_zone_that_leaves_the_range_is_told_as_open() -> None:
    (zone,) = zones(SHAFT, 25.9, 28.0, points=30)
    assert zone.is_open == (True, False)
    assert zone.first == 25.9


def test_response_in_an_unstable_range_is_marked(paper) -> None:
    response = paper["zhu_wang_theory"].response
    assert response(SHAFT, np.array([24.0, 25.9, 26.2])).status == ("ok", "unstable", "unstable")
