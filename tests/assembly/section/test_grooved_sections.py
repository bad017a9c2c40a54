"""Shear stress at keyways and splines against Weber's groove, a published chart and the general section."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad

from torsion.analyses.response.fillet_stresses import hole_factor, keyway_fit
from torsion.assembly.section.grooved_sections import (
    WIDEST,
    Grooved,
    Piece,
    graded,
    groove_stress,
    keyway,
    on_mesh,
    sector,
    splines,
)


def round_groove(radius: float) -> Grooved:
    """A groove of a circle centred on the circumference."""
    meeting = (radius * math.sqrt(1.0 - radius**2 / 4.0), 1.0 - radius**2 / 2.0)
    within = max(0.5 * (1.0 - radius), 1.05 * radius)
    turn = max(min(math.asin(radius / within), 1.0), 0.5)
    sides = graded(math.pi - math.atan2(*meeting), radius / 4.0, longest=WIDEST)
    groove = Piece(
        (0.0, 1.0 - radius), meeting, (0.0, turn), tuple(np.linspace(0.0, 1.0, 5)), (0.0, 1.0)
    )
    return Grooved(
        (groove, Piece(meeting, (0.0, -1.0), (turn, math.pi), sides, (0.0, 0.0))),
        1,
        within,
        0.0,
        min(radius / 2.0, 0.2),
    )


def weber(radius: float) -> float:
    """Torsion constant from Weber's stress function (r^2 - b^2)(2 cos t / r - 1)/2, from the groove's centre."""

    def ray(turn: float) -> float:
        far, c = 2.0 * math.cos(turn), 2.0 * math.cos(turn)
        whole = [
            c * r**3 / 3.0 - r**4 / 4.0 - radius**2 * (c * r - r**2 / 2.0) for r in (radius, far)
        ]  # of (r^2 - b^2)(c/r - 1) r
        return whole[1] - whole[0]

    return 2.0 * quad(ray, 0.0, math.acos(radius / 2.0), epsabs=0.0, epsrel=1e-12)[0]


@pytest.mark.parametrize("radius", [0.05, 0.1, 0.3])
def test_round_groove_is_that_of_weber_and_converges_from_both_fields(radius: float) -> None:
    off, constants = [], []
    for divided in (1, 2, 4):
        found = on_mesh(round_groove(radius), divided)
        low, high = found.constant
        assert low <= high * (1.0 + 1e-12)
        assert found.error < 2e-3 / divided**2
        off.append(abs(found.slope / (2.0 - radius) - 1.0))
        constants.append(abs((low + high) / 2.0 / weber(radius) - 1.0))
    assert off[2] < 7e-6
    assert constants[2] < 1e-6
    assert off[0] / off[2] > 4.0**3 / 1.2  # third order in the length of the sides


def test_small_groove_doubles_the_stress() -> None:
    found = on_mesh(round_groove(0.002), 2)
    assert found.factor == pytest.approx(2.0, rel=2e-3)


@pytest.mark.parametrize(
    ("radius", "above"), [(0.01, 0.019), (1.0 / 48.0, 0.019), (0.05, 0.055), (0.07, 0.069)]
)
def test_keyway_is_below_the_fit_of_peterson_by_more_than_its_mesh_explains(
    radius: float, above: float
) -> None:
    """Flanks of d/8. Halved sides move K_t by less than 2e-4; a depth of d/8 makes it smaller still."""
    depth = 0.25 + 1.0 - math.sqrt(1.0 - 0.25**2)
    fine, found = (on_mesh(keyway(0.5, depth, 2.0 * radius), divided) for divided in (4, 2))
    assert found.factor == pytest.approx(fine.factor, rel=2e-4)
    assert fine.error < 1e-5
    assert keyway_fit(radius) / fine.factor - 1.0 == pytest.approx(above, abs=1e-3)


def test_keyway_is_that_of_sources_in_its_groove() -> None:
    """A quarter of d wide, radius d/48, flanks of d/8, by a solution without a mesh: charges in the groove with their
    images in the circle, fitted to the outline within 1e-5 of the stress function; constant by quadrature.
    """
    found = on_mesh(keyway(0.5, 0.25 + 1.0 - math.sqrt(1.0 - 0.25**2), 1.0 / 24.0), 4)
    assert found.factor == pytest.approx(2.54573, rel=3e-4)
    assert found.constant == pytest.approx((1.33274119, 1.33274119), rel=1e-7)


@pytest.mark.parametrize(
    "section",
    [
        keyway(0.5, 0.25, 0.05),
        keyway(0.3, 0.2, 0.02, 4, 0.4),
        splines(0.8, 0.2, 0.02, 10, 0.3),
    ],
)
def test_sector_fills_the_section_and_its_bounds_meet(section: Grooved) -> None:
    mesh = sector(section, 2)
    corners = mesh.points[mesh.nodes[:, :3]]
    (x1, y1), (x2, y2) = (corners[:, k].T - corners[:, 0].T for k in (1, 2))
    turned = x1 * y2 - x2 * y1
    assert np.all(turned < 0.0) or np.all(turned > 0.0)  # none folded over
    low, high = on_mesh(section, 2).constant
    assert low == pytest.approx(high, rel=1e-5)


def test_slender_teeth_leave_the_core() -> None:
    """A tooth of width w and height h adds w^3 h / 3 at most, and its root and fillets a little."""
    low, high = on_mesh(splines(0.7, 0.1, 0.01, 6), 2).constant
    core = math.pi / 2.0 * 0.7**4
    assert core < low <= high < 1.02 * (core + 6 * 0.1**3 * 0.3 / 3.0)


def test_small_hole_stretches_its_edge_fourfold() -> None:
    assert hole_factor(0.0) * math.sqrt(3.0) == pytest.approx(4.0, rel=1e-15)


@pytest.mark.parametrize(
    ("root", "tooth", "fillet"), [(85.0, 1.0, 0.1), (86.0, 1.3, 0.05), (76.0, 1.0, 0.1)]
)
def test_hundred_teeth_have_an_answer(root: float, tooth: float, fillet: float) -> None:
    """The same at two depths of the circle within, which is an aid of the mesh alone."""
    section = splines(root / 90.0, tooth / 45.0, fillet / 45.0, 100)
    found = groove_stress(section)
    assert found.error < 1e-3
    assert on_mesh(replace(section, within=section.within - 0.02), 2).factor == pytest.approx(
        found.factor, rel=5e-3
    )
