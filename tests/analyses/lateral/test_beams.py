"""Bending shafts against closed forms of beams, without rotation."""

import math

import mpmath
import numpy as np
import pytest
from scipy.linalg import eigh

from torsion.analyses.lateral.beam_matrices import (
    LONGEST_PHASE,
    Beam,
    Point,
    Segment,
    assemble_lateral,
    places,
)

E, RHO, G, LENGTH = 210e9, 7850.0, 80e9, 1.5
OUTER, BORE = 0.120, 0.108
MOMENT = math.pi / 64 * (OUTER**4 - BORE**4)
AREA = math.pi / 4 * (OUTER**2 - BORE**2)
UNIT = math.sqrt(E * MOMENT / (RHO * AREA)) / LENGTH**2  # rad/s: frequency = UNIT * (beta L)^2
TUBE = Segment(LENGTH, (OUTER, OUTER), (BORE, BORE), E, RHO, G)
PINNED = (Point(0.0, fixation="pinned"), Point(LENGTH, fixation="pinned"))
RATIO = 2.0  # end mass / mass of the shaft


def frequencies_at_rest(system, plane=0):
    """rad/s, ascending; 0 for every rigid motion. A spring on the inertia holds a shaft that nothing else holds."""
    at = np.ix_(system.free, system.free)
    stiffness = (system.stiffness + system.support("stiffness", plane))[at]
    rigid, inertia = system.beam.rigid_motions(plane), system.inertia[at]
    shift = UNIT**2 * 100.0 if rigid else 0.0
    scale = 1.0 / np.sqrt(np.diagonal(stiffness + shift * inertia))
    held, inert = (
        scale[:, None] * matrix * scale for matrix in (stiffness + shift * inertia, inertia)
    )
    inverse = eigh(inert, held, eigvals_only=True)[::-1]  # the largest keep all their digits
    elastic = inverse[rigid:][inverse[rigid:] > len(inverse) * np.finfo(float).eps * inverse[0]]
    return np.concatenate([np.zeros(rigid), np.sqrt(1.0 / elastic - shift)])


def _roots(equation, starts):
    return np.array([float(mpmath.findroot(equation, start)) for start in starts])


def _cantilever(x):
    return mpmath.cos(x) * mpmath.cosh(x) + 1


def _free(x):
    return mpmath.cos(x) * mpmath.cosh(x) - 1


def _end_mass(x):
    c, s, ch, sh = mpmath.cos(x), mpmath.sin(x), mpmath.cosh(x), mpmath.sinh(x)
    return 1 + c * ch + RATIO * x * (c * sh - s * ch)


CASES = {
    "simply supported": (PINNED, np.pi * np.arange(1, 5)),
    "fixed-free": (
        (Point(0.0, fixation="clamped"),),
        _roots(_cantilever, (1.875, 4.694, 7.855, 10.9955)),
    ),
    "free-free": ((), _roots(_free, (4.73, 7.853, 10.9956, 14.137))),
    "end mass": (
        (Point(0.0, fixation="clamped"), Point(LENGTH, mass=RATIO * RHO * AREA * LENGTH)),
        _roots(_end_mass, (1.07, 3.98, 7.10, 10.23)),
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_frequencies_of_euler_beams(name: str) -> None:
    points, wave = CASES[name]
    system = assemble_lateral(
        Beam((TUBE,), points), frequency=UNIT * wave[-1] ** 2, rotary_inertia=False
    )
    found = frequencies_at_rest(system)
    rigid = 2 if name == "free-free" else 0
    np.testing.assert_array_equal(found[:rigid], 0.0)
    np.testing.assert_allclose(found[rigid : rigid + 4], UNIT * wave**2, rtol=1e-12)


def test_a_shaft_free_at_both_ends_hinged_at_one_keeps_one_rigid_motion() -> None:
    wave = _roots(lambda x: mpmath.tan(x) - mpmath.tanh(x), (3.927, 7.069))
    system = assemble_lateral(Beam((TUBE,), PINNED[:1]), elements=2, rotary_inertia=False)
    np.testing.assert_allclose(frequencies_at_rest(system)[:3], [0.0, *UNIT * wave**2], rtol=1e-11)


def test_tube_of_120_by_108_mm_bends_at_8744_rpm() -> None:
    system = assemble_lateral(Beam((TUBE,), PINNED), rotary_inertia=False)
    assert frequencies_at_rest(system)[0] * 30 / math.pi == pytest.approx(8744.0, rel=1e-3)


def test_rotary_inertia_lowers_as_rayleigh_says() -> None:
    k = np.pi * np.arange(1, 5) / LENGTH
    exact = np.sqrt(E * MOMENT * k**4 / (RHO * AREA + RHO * MOMENT * k**2))
    system = assemble_lateral(Beam((TUBE,), PINNED), frequency=exact[-1])
    np.testing.assert_allclose(frequencies_at_rest(system)[:4], exact, rtol=1e-12)


def test_shear_lowers_as_timoshenko_says() -> None:
    k = np.pi * np.arange(1, 5) / LENGTH
    poisson = E / (2 * G) - 1
    m = (BORE / OUTER) ** 2
    kappa = (
        6
        * (1 + poisson)
        * (1 + m) ** 2
        / ((7 + 6 * poisson) * (1 + m) ** 2 + (20 + 12 * poisson) * m)
    )
    a = RHO * RHO * MOMENT / (kappa * G)  # a w^4 - b w^2 + c = 0
    b = RHO * AREA + RHO * MOMENT * k**2 + E * MOMENT * RHO * k**2 / (kappa * G)
    c = E * MOMENT * k**4
    exact = np.sqrt(2 * c / (b + np.sqrt(b * b - 4 * a * c)))
    system = assemble_lateral(Beam((TUBE,), PINNED), frequency=exact[-1], shear=True)
    np.testing.assert_allclose(frequencies_at_rest(system)[:4], exact, rtol=1e-12)


def test_a_slender_shaft_with_shear_is_one_without() -> None:
    slender = Segment(LENGTH, (2e-4, 2e-4), (0.0, 0.0), E, RHO, G)
    both = [assemble_lateral(Beam((slender,), PINNED), shear=shear) for shear in (False, True)]
    assert frequencies_at_rest(both[1])[0] == pytest.approx(
        frequencies_at_rest(both[0])[0], rel=1e-7
    )


def test_cone_clamped_at_its_thick_end_against_bessel_functions() -> None:
    # Solid cone, x from its apex: u = {J2, Y2, I2, K2}(2 b sqrt x)/x (Naguleswaran 1994, J. Sound Vib. 172:289)
    near, far, diameter = 0.5, 1.5, 0.1
    start = diameter * near / far
    wave = math.sqrt(E / RHO) * diameter / 4 / far  # b^4 = (w/wave)^2
    kinds = (
        (mpmath.besselj, 1, -1),
        (mpmath.bessely, 1, -1),
        (mpmath.besseli, 1, 1),
        (mpmath.besselk, -1, -1),
    )

    def equation(w):
        b = mpmath.sqrt(w / wave)
        inner, outer = 2 * b * mpmath.sqrt(near), 2 * b * mpmath.sqrt(far)
        rows = [  # moment and shear where it is thin, displacement and slope where it is thick, each up to a factor
            [kind(4, inner) for kind, _, _ in kinds],
            [sense * kind(3, inner) for kind, sense, _ in kinds],
            [kind(2, outer) for kind, _, _ in kinds],
            [sense * kind(3, outer) for kind, _, sense in kinds],
        ]
        return mpmath.det(mpmath.matrix(rows))

    cone = Segment(far - near, (start, diameter), (0.0, 0.0), E, RHO, G)
    system = assemble_lateral(
        Beam((cone,), (Point(far - near, fixation="clamped"),)), rotary_inertia=False
    )
    found = frequencies_at_rest(system)[:2]
    exact = [
        float(mpmath.findroot(equation, (0.99 * w, 1.01 * w), solver="anderson")) for w in found
    ]
    np.testing.assert_allclose(found, exact, rtol=1e-11)


def test_pieces_of_one_shaft_are_the_shaft() -> None:
    pieces = tuple(
        Segment(part, (OUTER, OUTER), (BORE, BORE), E, RHO, G) for part in (0.2, 0.9, 0.4)
    )
    whole, cut = (
        frequencies_at_rest(assemble_lateral(Beam(s, PINNED), elements=3))
        for s in ((TUBE,), pieces)
    )
    np.testing.assert_allclose(cut[:4], whole[:4], rtol=1e-12)


def test_springs_at_the_ends_carry_a_rigid_shaft() -> None:
    stiffness = 1e4  # N/m, so soft that the shaft is rigid: w^2 = 2 k/m
    points = tuple(Point(at, stiffness=(stiffness, 2 * stiffness)) for at in (0.0, LENGTH))
    system = assemble_lateral(Beam((TUBE,), points), rotary_inertia=False)
    for plane in (0, 1):
        exact = math.sqrt(2 * (plane + 1) * stiffness / (RHO * AREA * LENGTH))
        assert frequencies_at_rest(system, plane)[0] == pytest.approx(exact, rel=1e-3)


def test_moment_along_a_cantilever_under_an_end_force() -> None:
    system = assemble_lateral(
        Beam((TUBE,), (Point(0.0, fixation="clamped"), Point(LENGTH))), elements=2
    )
    force = np.zeros(len(system.inertia))
    force[system.place[1]] = 1.0
    unknown = np.zeros_like(force)
    at = system.free
    unknown[at] = np.linalg.solve(system.stiffness[np.ix_(at, at)], force[at])
    rows = places(system)
    left = LENGTH - rows.position
    np.testing.assert_allclose(rows.moment @ unknown, left, atol=1e-9 * LENGTH)
    line = (LENGTH**3 / 3 - LENGTH**2 * left / 2 + left**3 / 6) / (E * MOMENT)
    np.testing.assert_allclose(rows.displacement @ unknown, line, atol=1e-11 * line.max())


def test_rigid_motions_are_counted_from_what_holds_the_shaft() -> None:
    spring = Point(0.3, stiffness=(1e6, 0.0))
    assert [
        Beam((TUBE,), points).rigid_motions(0) for points in ((), PINNED[:1], PINNED, (spring,))
    ] == [2, 1, 0, 1]
    assert Beam((TUBE,), (PINNED[0], spring)).rigid_motions(0) == 0
    assert Beam((TUBE,), (PINNED[0], spring)).rigid_motions(1) == 1


def test_elements_follow_the_phase_of_the_highest_frequency() -> None:
    beam = Beam((TUBE,), PINNED)
    for number in (1, 2, 5):
        # rotary inertia makes the phase a little longer than beta L
        frequency = UNIT * (0.98 * number * LONGEST_PHASE) ** 2
        assert len(assemble_lateral(beam, frequency=frequency).cells) in (number, number + 1)
    assert len(assemble_lateral(beam, frequency=0.0).cells) == 1


def test_a_point_beside_the_shaft_is_refused() -> None:
    with pytest.raises(ValueError, match="next to it"):
        assemble_lateral(Beam((TUBE,), (Point(LENGTH * 1.01),)))
