"""Torsion constant, polar moment and stress modulus of cross-sections against closed forms and laws."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from scipy.integrate import quad


def ellipse(a, b):
    return lambda angle: np.array([a * np.cos(angle), b * np.sin(angle)])


circle = ellipse(1.0, 1.0)


def polar(radius):
    return lambda angle: radius(angle) * circle(angle)


@pytest.mark.parametrize("hole", [0.0, 0.5, 0.9])
def test_circle_and_ring(solved, draw, hole) -> None:
    found = solved(draw("around")(circle, 2, 64, hole))
    full = math.pi / 2.0 * (1.0 - hole**4)
    tolerance = 4e-7 / (1.0 - hole**4)  # (pi/64)^4/15: 64 parabolas around a circle
    assert found.torsion_constant == pytest.approx(full, rel=tolerance)
    assert found.moments.polar == pytest.approx(full, rel=tolerance)
    assert found.stress_modulus == pytest.approx(full, rel=1e-4)
    assert found.error < 1e-9


@pytest.mark.parametrize(("a", "b"), [(1.0, 0.8), (1.5, 0.5)])
@pytest.mark.parametrize("hole", [0.0, 0.6])
def test_ellipse_solid_and_with_a_hole_of_its_shape(solved, draw, a, b, hole) -> None:
    """Saint-Venant; a hole along a line of stress takes away the torsion constant of what was there."""
    found = solved(draw("around")(ellipse(a, b), 2, 64, hole))
    ring = 1.0 - hole**4
    assert found.torsion_constant == pytest.approx(
        math.pi * (a * b) ** 3 / (a * a + b * b) * ring, rel=1e-6
    )
    assert found.moments.polar == pytest.approx(
        math.pi / 4.0 * a * b * (a * a + b * b) * ring, rel=1e-6
    )
    assert found.stress_modulus == pytest.approx(math.pi / 2.0 * a * b * b * ring, rel=1e-3)
    x, y = found.levels[-1].at
    assert (abs(x), abs(y)) == (pytest.approx(0.0, abs=0.02 * a), pytest.approx(b, rel=1e-3)), (
        "at the short axis"
    )


def rectangle_by_series(a: float, b: float) -> tuple[float, float]:
    """Torsion constant and stress modulus of a x b, a >= b (Timoshenko & Goodier, Theory of Elasticity, art. 109)."""
    with mpmath.workdps(30):
        odd = lambda k: 2 * k + 1  # noqa: E731
        ratio = mpmath.pi * a / (2 * b)
        inner = mpmath.nsum(lambda k: mpmath.tanh(odd(k) * ratio) / odd(k) ** 5, [0, mpmath.inf])
        constant = a * b**3 / mpmath.mpf(3) * (1 - 192 * b / (mpmath.pi**5 * a) * inner)
        edge = mpmath.nsum(lambda k: mpmath.sech(odd(k) * ratio) / odd(k) ** 2, [0, mpmath.inf])
        return float(constant), float(constant / (b * (1 - 8 / mpmath.pi**2 * edge)))


@pytest.mark.parametrize(("rows", "cells"), [(1, 8), (2, 6), (4, 5)])
def test_square_and_rectangles(solved, draw, rows, cells) -> None:
    found = solved(draw("blocks")(["#"] * rows, cells))
    constant, modulus = rectangle_by_series(float(rows), 1.0)
    assert found.torsion_constant == pytest.approx(constant, rel=1e-7)
    assert found.stress_modulus == pytest.approx(modulus, rel=2e-6)
    assert found.moments.polar == pytest.approx(rows * (rows**2 + 1) / 12.0, rel=1e-13)
    assert all(level.lower <= constant <= level.upper for level in found.levels)
    if rows == 1:
        assert constant == pytest.approx(0.1405770, abs=5e-8)
        assert modulus == pytest.approx(0.208, abs=5e-4)


def test_equilateral_triangle(solved, draw) -> None:
    """phi is of degree 3, so that elements of degree 4 are exact."""
    height = math.sqrt(3.0)
    found = solved(
        (
            np.array([[-1.0, -height / 3], [1.0, -height / 3], [0.0, height / 1.5]]),
            np.array([[0, 1, 2]]),
        )
    )
    assert found.torsion_constant == pytest.approx(math.sqrt(3.0) / 80.0 * 16.0, rel=1e-13)
    assert found.stress_modulus == pytest.approx(8.0 / 20.0, rel=1e-12)


@pytest.mark.parametrize("b", [0.2, 0.5])
def test_shaft_with_a_semicircular_keyway(solved, draw, b) -> None:
    """phi = (b^2 - r^2)(1 - 2 cos(psi)/r)/2 about the middle of the keyway, largest stress 2 - b (Weber 1921)."""
    last, off = (
        math.acos(b / 2.0),
        0.35 * b * b,
    )  # the centroid, by which the section is moved to the axis

    def at(u, v):
        psi = last * (1.0 - 2.0 * u)
        r = b + (2.0 * np.cos(psi) - b) * v**1.5
        return np.array([r * np.cos(psi) - 1.0 - off, r * np.sin(psi)])

    def across(psi: float) -> float:  # int phi r dr from b to 2 cos(psi)
        c, d = math.cos(psi), 2.0 * math.cos(psi)
        return (
            b * b * (d * d - b * b) / 4.0
            - (d**4 - b**4) / 8.0
            + c * ((d**3 - b**3) / 3.0 - b * b * (d - b))
        )

    found = solved(draw("mapped")(at, 48, 5))
    constant = 2.0 * quad(across, -last, last, epsabs=0.0, epsrel=1e-13)[0]
    assert found.torsion_constant == pytest.approx(constant, rel=2e-6)
    assert found.torsion_constant / found.stress_modulus == pytest.approx(2.0 - b, rel=2e-3)
    assert found.levels[-1].at == pytest.approx((b - 1.0 - off, 0.0), abs=0.02)


def spline(depth: float, teeth: int):
    return polar(lambda angle: 1.0 + depth * np.tanh(3.0 * np.cos(teeth * angle)) / math.tanh(3.0))


def test_splined_shaft_lies_between_its_circles_and_stiffens_with_every_root_that_is_filled(
    solved, draw
) -> None:
    before = math.inf
    for depth in (0.02, 0.05, 0.1):
        found = solved(draw("around")(spline(depth, 6), 1, 60))
        assert math.pi / 2.0 * (1.0 - depth) ** 4 < found.levels[-1].lower
        assert found.levels[-1].upper < min(math.pi / 2.0 * (1.0 + depth) ** 4, found.moments.polar)
        inside = found.torsion_constant / (1.0 + depth) ** 4  # one outer circle, deeper roots
        assert inside < before
        before = inside


@pytest.mark.parametrize("outline", ["#", "plus", "spline"])
def test_refinement_narrows_the_bounds_from_both_sides(solved, draw, outline) -> None:
    drawn = {
        "#": draw("blocks")(["#"], 2),
        "plus": draw("blocks")([".#.", "###", ".#."], 2),
        "spline": draw("around")(spline(0.1, 6), 1, 36),
    }[outline]
    levels = solved(drawn).levels
    assert len(levels) == 3
    lower, upper = [one.lower for one in levels], [one.upper for one in levels]
    assert lower == sorted(lower)
    assert upper == sorted(upper, reverse=True)
    assert lower[-1] < upper[-1]


def test_bounds_of_a_square_close_with_the_fourth_power_of_the_size(solved, draw) -> None:
    """Its corners, where phi is r^2 log r, set the order."""
    gaps = [level.upper - level.lower for level in solved(draw("blocks")(["#"], 4)).levels]
    assert [math.log2(a / b) for a, b in pairwise(gaps)] == pytest.approx([4.0, 4.0], abs=0.1)


def test_sharp_inner_corner_has_a_torsion_constant_and_no_stress_modulus(solved, draw) -> None:
    found = solved(draw("blocks")([".#.", "###", ".#."], 3))
    assert found.error < 1e-3
    assert min(found.changes) > 0.2, "2^(1/3) - 1 by each refinement at a corner of 270 degrees"
    assert math.isnan(found.stress_modulus)
    assert "sharp inner corner" in found.words


def test_straight_triangles_are_solved_as_the_polygon_that_they_are(solved, draw) -> None:
    points, nodes = draw("around")(circle, 2, 24)
    found = solved((points, nodes[:, :3]))
    side = math.pi / 12.0
    moment = 24.0 / 12.0 * math.sin(side) * (2.0 + math.cos(side))
    assert found.moments.polar == pytest.approx(moment, rel=1e-12)
    assert found.levels[-1].upper < moment < math.pi / 2.0
    assert found.error < 1e-5 < 1.0 - found.torsion_constant / (math.pi / 2.0)


def test_constants_do_not_depend_on_how_the_section_is_turned_or_seen_or_on_its_unit(
    solved, draw
) -> None:
    points, nodes = draw("around")(
        polar(lambda angle: 1.0 + 0.1 * np.cos(3 * angle) + 0.05 * np.sin(5 * angle)), 1, 20
    )
    found = solved((points, nodes))
    c, s = math.cos(0.3), math.sin(0.3)
    turned = solved((points @ [[c, s], [-s, c]], nodes))
    mirrored = solved((points * [1.0, -1.0], nodes))
    small = solved((points * 1e3, nodes), 1e-3)
    for other in (turned, mirrored, small):
        assert other.torsion_constant == pytest.approx(found.torsion_constant, rel=1e-10)
        assert other.moments.polar == pytest.approx(found.moments.polar, rel=1e-12)
        assert other.stress_modulus == pytest.approx(found.stress_modulus, rel=1e-8)


def test_two_holes_side_by_side(solved, draw) -> None:
    """A square frame of four cells with the diagonal two open: by symmetry their constants agree, and bounds hold."""
    found = solved(draw("blocks")(["#####", "#.###", "#####", "###.#", "#####"], 2))
    assert found.error < 5e-3
    whole, _ = rectangle_by_series(5.0, 5.0)
    assert 0.8 * whole < found.torsion_constant < whole
    assert found.moments.polar == pytest.approx(625.0 / 6.0 - 2.0 * (1.0 / 6.0 + 2.0), rel=1e-13)


@pytest.mark.parametrize(
    ("ending", "how"),
    [
        ("msh", {"file_format": "gmsh22"}),
        ("msh", {"file_format": "gmsh"}),
        ("vtk", {}),
        ("vtu", {}),
        ("xml", {"file_format": "dolfin-xml"}),
        ("inp", {}),
        ("stl", {}),
    ],
)
def test_one_section_in_many_formats(tmp_path, draw, ending, how) -> None:
    from torsion.assembly.section.section_result import section_result
    from torsion.primitives import SectionMesh

    file = draw("write")(draw("blocks")(["#"], 3), tmp_path / f"square.{ending}", **how)
    assert section_result(SectionMesh(file)).torsion_constant == pytest.approx(
        0.140577015, rel=1e-6
    )


@pytest.mark.parametrize(
    ("stresses", "modulus"), [((1.0, 1.25, 1.28), 6.0 / 1.28), ((1.0, 1.02, 1.2), math.nan)]
)
def test_the_stress_modulus_is_known_where_the_last_refinement_changes_it_little(
    stresses: tuple[float, ...], modulus: float
) -> None:
    """By 2.4 % after 25 %; and not where 2 % come first and 18 % last, as at a corner."""
    from torsion.assembly.section.section_result import SectionResult
    from torsion.assembly.section.section_torsion import Level, Moments

    levels = tuple(Level(1, 5.9, 6.1, stress, (0.0, 0.0)) for stress in stresses)
    result = SectionResult("section.msh", Moments(1.0, (0.0, 0.0), 7.0), levels, 4)
    assert result.stress_modulus == pytest.approx(modulus, rel=1e-15, nan_ok=True)
    assert ("no W_t" in result.words) is math.isnan(modulus)
    assert result.error == pytest.approx(0.1 / 6.0, rel=1e-12)
