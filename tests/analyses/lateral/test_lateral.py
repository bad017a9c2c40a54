"""Turning shafts: gyroscopic split, critical speeds and the answer to end couples against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest

from torsion.analyses.lateral.beam_matrices import Beam, Point, Segment, assemble_lateral, places
from torsion.analyses.lateral.bending_shafts import planes
from torsion.analyses.lateral.couple_response import answer, speeds_for
from torsion.analyses.lateral.whirl import criticals, refined, roots_among, whirl
from torsion.errors import SolveError
from torsion.kernels.trees.tree_response import Status
from torsion.rules.universal_joints import critical_speed

E, RHO, G, LENGTH, OUTER, BORE = 210e9, 7850.0, 80e9, 1.5, 0.12, 0.108
MOMENT = math.pi / 64 * (OUTER**4 - BORE**4)
AREA = math.pi / 4 * (OUTER**2 - BORE**2)
MASS, ROTARY, STIFF = RHO * AREA, RHO * MOMENT, E * MOMENT  # kg/m, kg m, N m2
TUBE = Segment(LENGTH, (OUTER, OUTER), (BORE, BORE), E, RHO, G)
PINNED = (Point(0.0, fixation="pinned"), Point(LENGTH, fixation="pinned"))
LIGHT = Segment(1.0, (0.05, 0.05), (0.0, 0.0), E, 0.0, G)  # no mass
BEND = E * math.pi / 64 * 0.05**4
TWO_PI = 2 * math.pi


def _turning(points=PINNED, segment=TUBE, elements=3):
    return planes(assemble_lateral(Beam((segment,), tuple(points)), elements=elements))


def _rayleigh(order, sign):
    """Speeds at which order * speed is the whirl of a simply supported Rayleigh shaft: modes 1, 2."""
    k = np.arange(1, 3) * math.pi / LENGTH
    return np.sqrt(
        STIFF * k**4 / (order**2 * (MASS + ROTARY * k**2) - sign * order * 2 * ROTARY * k**2)
    )


def test_whirl_of_a_rayleigh_shaft_splits_as_its_quadratic_says() -> None:
    speed, k = 900.0, np.arange(1, 4) * math.pi / LENGTH
    a, b, c = MASS + ROTARY * k**2, 2 * ROTARY * k**2 * speed, STIFF * k**4  # a w^2 - b w - c = 0
    root = np.sqrt(b * b + 4 * a * c)
    found = whirl(_turning(), np.array([0.0, speed]), 3)
    exact = np.concatenate([2 * c / (b + root), (b + root) / (2 * a)]) / TWO_PI
    np.testing.assert_allclose(
        found.frequency[1], [*np.sort((root - b) / (2 * a)) / TWO_PI, *exact[3:]], rtol=1e-12
    )
    np.testing.assert_array_equal(found.direction[1], [-1, -1, -1, 1, 1, 1])
    np.testing.assert_array_equal(found.log_decrement, 0.0)
    np.testing.assert_allclose(found.frequency[0, :3], found.frequency[0, 3:], rtol=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_critical_speeds_of_a_rayleigh_shaft(order: int) -> None:
    found = criticals(_turning(), order, 4000.0 / order)
    for sign in (-1, 1):
        own = [crossing.speed for crossing in found if crossing.direction == pytest.approx(sign)]
        np.testing.assert_allclose(own, _rayleigh(order, sign)[: len(own)], rtol=1e-12)
    assert [crossing.mode for crossing in found] == [1, 2, 3, 4]


def test_critical_speeds_of_the_tube_lie_about_the_formula_of_the_joint_makers() -> None:
    # Rotary inertia adds r2 k2 = 0.71 % to the inertia; the gyroscopic moment turns that to -1 or 3 times as much
    formula = critical_speed(LENGTH, OUTER, BORE, E, RHO)
    assert formula * 30 / math.pi == pytest.approx(8744, rel=1e-3)
    share = MOMENT / AREA * (math.pi / LENGTH) ** 2
    backward, forward = criticals(_turning(), 1, 1.2 * formula)
    assert forward.speed / formula == pytest.approx((1 - share) ** -0.5, rel=1e-12)  # 0.36 % higher
    assert backward.speed / formula == pytest.approx(
        (1 + 3 * share) ** -0.5, rel=1e-12
    )  # 1.1 % lower


MASS_OF_DISC, DIAMETRAL, POLAR = 30.0, 0.6, 1.1


@pytest.mark.parametrize("speed", [50.0, 300.0, 2000.0])
def test_whirl_of_an_overhung_disc_on_a_light_shaft(speed: float) -> None:
    # Genta 2005: K = E I [[12, -6], [-6, 4]], M = diag(m, Jd), gyroscopic moment w Omega Jp on the slope
    disc = Point(1.0, mass=MASS_OF_DISC, diametral=DIAMETRAL, polar=POLAR)
    found = whirl(_turning((Point(0.0, fixation="clamped"), disc), LIGHT, 1), np.array([speed]), 2)
    # (12 B - m w2)(4 B - Jd w2 + Jp Omega w) - 36 B2 = 0
    one = np.array([-MASS_OF_DISC, 0.0, 12 * BEND])
    other = np.array([-DIAMETRAL, POLAR * speed, 4 * BEND])
    roots = np.sort(np.roots(np.polyadd(np.polymul(one, other), [-36 * BEND**2])).real)
    exact = [*(-roots[roots < 0][::-1]), *roots[roots > 0]]
    np.testing.assert_allclose(found.frequency[0] * TWO_PI, exact, rtol=1e-10)


def test_a_thin_disc_meets_no_forward_critical_speed_of_its_tilting() -> None:
    disc = Point(1.0, mass=MASS_OF_DISC, diametral=DIAMETRAL, polar=POLAR)
    found = criticals(_turning((Point(0.0, fixation="clamped"), disc), LIGHT, 1), 1, np.inf)
    assert [round(crossing.direction) for crossing in found] == [-1, 1, -1]


def _supported(stiffness, damping=(0.0, 0.0)):
    """A disc at the middle of a light shaft on two bearings."""
    ends = [Point(at, stiffness=stiffness, damping=damping) for at in (0.0, 1.0)]
    return _turning((*ends, Point(0.5, mass=MASS_OF_DISC)), LIGHT, 1)


def test_unequal_supports_part_the_planes_of_a_disc_at_the_middle() -> None:
    stiffness = (8e6, 3e6)
    exact = sorted(math.sqrt(1 / MASS_OF_DISC / (1 / (2 * k) + 1 / (48 * BEND))) for k in stiffness)
    found = whirl(_supported(stiffness), np.array([0.0, 100.0]), 1)
    np.testing.assert_allclose(found.frequency * TWO_PI, [exact, exact], rtol=1e-11)
    np.testing.assert_allclose(found.direction, 0.0, atol=1e-9)


@pytest.mark.parametrize("damping", [(2e3, 2e3), (2e3, 5e4)])
def test_damped_supports_decay_as_their_cubic_says(damping: tuple[float, float]) -> None:
    stiffness, light = (8e6, 8e6), 48 * BEND
    # m s2 + 2 (k + c s) light/(light + 2 (k + c s)) = 0
    exact = []
    for c in damping:
        bearing = np.array([2 * c, 2 * stiffness[0]])
        heavy = np.polymul([MASS_OF_DISC, 0, 0], bearing + np.array([0, light]))
        roots = np.roots(np.polyadd(heavy, light * bearing))
        exact.append(roots[np.argmax(roots.imag)])
    exact.sort(key=abs)
    found = whirl(_supported(stiffness, damping), np.array([40.0]), 1)
    np.testing.assert_allclose(
        found.frequency[0] * TWO_PI, [root.imag for root in exact], rtol=1e-10
    )
    decrement = [-TWO_PI * root.real / root.imag for root in exact]
    np.testing.assert_allclose(found.log_decrement[0], decrement, rtol=1e-9)


def test_heavily_damped_whirl_is_an_eigenvalue_of_the_whole_shaft() -> None:
    bearing = Point(0.5, stiffness=(2e7, 9e6), damping=(3e4, 8e3))
    both = _turning((PINNED[0], bearing, Point(1.4, stiffness=(1e7, 1e7), mass=20.0)), elements=2)
    speed = 700.0
    found = whirl(both, np.array([speed]), 4)
    # first-order form of the matrices as assembled, both planes, lowest roots by the inverse
    system = both.system
    at, n = np.ix_(system.free, system.free), len(system.free)
    stiff, damped, heavy, turning = (np.zeros((2 * n, 2 * n)) for _ in range(4))
    for plane in (0, 1):
        part = slice(plane * n, (plane + 1) * n)
        stiff[part, part] = (system.stiffness + system.support("stiffness", plane))[at]
        damped[part, part] = system.support("damping", plane)[at]
        heavy[part, part] = system.inertia[at]
    turning[:n, n:], turning[n:, :n] = system.gyroscopic[at], -system.gyroscopic[at]
    top = np.hstack(
        [-np.linalg.solve(stiff, damped + speed * turning), -np.linalg.solve(stiff, heavy)]
    )
    inverse = np.linalg.eigvals(np.vstack([top, np.eye(2 * n, 4 * n)]))
    roots = 1 / inverse[np.argsort(-np.abs(inverse))[:30]]
    exact = roots[roots.imag > 1.0][:8]
    np.testing.assert_allclose(found.frequency[0], exact.imag / TWO_PI, rtol=1e-6)
    np.testing.assert_allclose(found.log_decrement[0], -TWO_PI * exact.real / exact.imag, rtol=1e-5)


def test_damped_roots_among_few_modes_are_refined_to_those_of_all() -> None:
    bearing = Point(0.5, stiffness=(2e7, 9e6), damping=(3e3, 8e2))
    both = _turning((*PINNED, bearing), elements=3)
    found = refined(both, 700.0, 4)
    assert found is not None
    exact, _ = roots_among(both, 700.0, np.arange(len(both.square)))
    for root in found[0]:
        assert np.abs(exact / root - 1).min() < 1e-11


def test_a_loss_factor_drives_the_forward_whirl_above_its_critical_speed() -> None:
    eta, k = 1e-6, math.pi / LENGTH
    both = _turning(segment=replace(TUBE, loss_factor=eta))
    below, above = 0.5 * _rayleigh(1, 1)[0], 1.5 * _rayleigh(1, 1)[0]
    found = whirl(both, np.array([below, above]), 1)
    for row, speed in enumerate((below, above)):
        for column, sign in ((0, -1), (1, 1)):
            a, b = MASS + ROTARY * k**2, 2 * ROTARY * k**2 * speed
            w = found.frequency[row, column] * TWO_PI * sign
            stiff = STIFF * k**4 * (1 + 1j * eta * np.sign(w - speed))
            exact = w - (a * w * w - b * w - stiff) / (
                2 * a * w - b
            )  # Newton: the loss moves it by 1e-6
            assert found.log_decrement[row, column] == pytest.approx(
                TWO_PI * exact.imag / abs(w), rel=1e-5
            )
    assert found.log_decrement[1, 1] < 0 < found.log_decrement[1, 0]


def _line(stiff, w, speed, couple, x):
    """u and E I u'' of a simply supported Rayleigh shaft, u exp(i w t), under a couple at x = 0.

    E I u'''' + (rho I w2 - 2 rho I Omega w) u'' - rho A w2 u = 0, and E I u'' = i couple at the start.
    """
    a, b = np.sqrt(
        np.roots([stiff, ROTARY * w * w - 2 * ROTARY * speed * w, -MASS * w * w]).astype(complex)
    )
    shapes = [np.sinh(r * (LENGTH - x)) / np.sinh(r * LENGTH) for r in (a, b)]
    size = 1j * couple / (stiff * (a * a - b * b))
    return size * (shapes[0] - shapes[1]), size * stiff * (a * a * shapes[0] - b * b * shapes[1])


COUPLE = np.array([[120 + 30j, -40 + 90j], [10 - 5j, 70j]])  # N m: M_y, M_z at both ends


@pytest.mark.parametrize("speed", [60.0, 430.0, 700.0])
def test_answer_to_end_couples_is_that_of_the_differential_equation(speed: float) -> None:
    eta = 0.03
    both = _turning(segment=replace(TUBE, loss_factor=eta))
    found = answer(both, 2, np.array([speed]), COUPLE[None])
    x, w = places(both.system).position, 2 * speed
    parts = []  # forward: half of y + i z turns with exp(i w t); backward: the conjugate of half of y - i z
    for sign in (1, -1):
        stiff = STIFF * (1 + 1j * sign * eta)
        near, far = (0.5 * (couple[0] + 1j * sign * couple[1]) for couple in COUPLE)
        if sign < 0:
            near, far = np.conj(near), np.conj(far)
        first = _line(stiff, sign * w, speed, near, x)
        second = _line(stiff, sign * w, speed, far, LENGTH - x)
        total = [one - other for one, other in zip(first, second, strict=True)]
        parts.append([np.conj(t) if sign < 0 else t for t in total])
    for stated, forward, backward in zip((found.displacement, found.moment), *parts, strict=True):
        y, z = forward + backward, -1j * (forward - backward)
        exact = np.stack([y, z], axis=-1)
        np.testing.assert_allclose(stated[0], exact, rtol=0, atol=1e-11 * np.abs(exact).max())
    assert found.status[0] == Status.OK


def test_answer_to_a_couple_is_its_sum_over_the_modes() -> None:
    # without rotary inertia: y = -(2 M/L) sum k sin(k x)/(rho A (w_k^2 - w^2)), here with M about z = -1 at the start
    system = assemble_lateral(Beam((TUBE,), PINNED), elements=3, rotary_inertia=False)
    couple = np.array([[[0, 1.0], [0, 0]]], dtype=complex)
    w = 500.0
    found = answer(planes(system), 2, np.array([w / 2]), couple)
    k = np.arange(1, 20001) * math.pi / LENGTH
    x = np.unique(places(system).position)[[1, 4, 7]]
    terms = 2 / LENGTH * k * np.sin(np.outer(x, k)) / (STIFF * k**4 - MASS * w * w)
    at = [int(np.argmin(np.abs(places(system).position - place))) for place in x]
    np.testing.assert_allclose(found.displacement[0, at, 0], terms.sum(axis=1), rtol=1e-9)


def test_joints_bear_a_standing_couple_as_two_bearings_do() -> None:
    couple = np.array([[[50.0, -20.0], [0, 0]]], dtype=complex)
    found = answer(_turning(), 0, np.array([100.0]), couple)
    exact = (
        -np.array([20.0, 50.0]) / LENGTH
    )  # of the shaft on the farther bearing: x times force + couple = 0
    np.testing.assert_allclose(found.force[0, 1], exact, rtol=1e-10)
    np.testing.assert_allclose(found.force[0, 0], -exact, rtol=1e-10)


def test_forces_on_joints_and_supports_balance_the_inertia() -> None:
    spring = Point(0.4, stiffness=(2e7, 5e6), damping=(4e3, 1e3), mass=12.0)
    both = _turning((*PINNED, spring), replace(TUBE, loss_factor=0.02), elements=8)
    found = answer(both, 2, np.array([330.0]), np.concatenate([COUPLE, np.zeros((1, 2))])[None])
    boole = np.array([7, 32, 12, 32, 7]) / 90
    fine = found.displacement[0].reshape(len(both.system.cells), 5, 2)
    moved = sum(
        MASS * cell.section.length * (boole @ line)
        for cell, line in zip(both.system.cells, fine, strict=True)
    )
    at = int(np.argmin(np.abs(places(both.system).position - spring.at)))
    moved = moved + spring.mass * found.displacement[0, at]
    np.testing.assert_allclose(found.force[0].sum(axis=0), (2 * 330.0) ** 2 * moved, rtol=1e-7)


def test_a_resonance_that_nothing_damps_is_told_as_singular_and_marked_around() -> None:
    both = _turning()
    resonances = criticals(both, 2, 600.0)
    assert [crossing.damping_ratio for crossing in resonances] == [0.0, 0.0]
    speed = speeds_for(np.linspace(200.0, 600.0, 41), resonances)
    found = answer(both, 2, speed, np.tile(COUPLE, (len(speed), 1, 1)))
    near = np.min([np.abs(speed / crossing.speed - 1) for crossing in resonances], axis=0)
    np.testing.assert_array_equal(found.status == Status.SINGULAR, near == 0)
    np.testing.assert_array_equal(found.status != Status.OK, near <= 0.01)
    assert np.isnan(found.displacement[found.status == Status.SINGULAR]).all()
    assert np.isfinite(found.displacement[found.status != Status.SINGULAR]).all()
    assert (found.orbit[found.status == Status.OK] < 0.05).all()


def test_a_damped_resonance_is_met_at_its_peak() -> None:
    both = _turning((*PINNED, Point(0.7, damping=(300.0, 300.0))))
    resonances = criticals(both, 2, 600.0)
    speed = speeds_for(np.linspace(200.0, 600.0, 5), resonances)
    couple = np.concatenate([COUPLE, np.zeros((1, 2))])
    dense = np.linspace(0.97 * resonances[0].speed, 1.03 * resonances[1].speed, 301)
    few, many = (
        answer(both, 2, grid, np.tile(couple, (len(grid), 1, 1))).orbit.max()
        for grid in (speed, dense)
    )
    assert few == pytest.approx(many, rel=1e-2)
    assert all(crossing.damping_ratio > 0 for crossing in resonances)


def test_loss_in_the_shaft_damps_all_resonances_but_the_forward_one_of_unbalance() -> None:
    """k (1 + i eta) = Omega2 (n2 M - n G), and k alone where the bent shaft turns with its speed."""
    eta = 0.03
    both = _turning(segment=replace(TUBE, loss_factor=eta))
    for order, forward in ((1, 0.0), (2, eta / 2), (3, eta / 2)):
        for crossing in criticals(both, order, 4000.0 / order):
            ratio = forward if crossing.direction > 0 else eta / 2
            assert crossing.damping_ratio == pytest.approx(ratio, rel=1e-11, abs=1e-14)


def test_equal_supports_given_apart_answer_as_equal_ones() -> None:
    # the path of unequal planes against that of y + i z
    springs = [(1e7, 1e7), (1e7, 1e7 * (1 + 1e-13))]
    one, other = (
        _turning(
            (PINNED[0], Point(1.3, stiffness=pair, damping=(5e3, 5e3))),
            replace(TUBE, loss_factor=0.01),
        )
        for pair in springs
    )
    assert (one.is_isotropic, other.is_isotropic) == (True, False)
    stated = [answer(both, 2, np.array([300.0]), COUPLE[None]) for both in (one, other)]
    np.testing.assert_allclose(
        stated[1].displacement, stated[0].displacement, rtol=0, atol=1e-10 * stated[0].orbit.max()
    )
    rows = [whirl(both, np.array([300.0]), 2) for both in (one, other)]
    order = np.argsort(rows[0].frequency[0])
    np.testing.assert_allclose(rows[1].frequency[0], rows[0].frequency[0, order], rtol=1e-9)
    np.testing.assert_allclose(rows[1].log_decrement[0], rows[0].log_decrement[0, order], rtol=1e-8)


def test_a_shaft_that_nothing_holds_is_refused() -> None:
    with pytest.raises(SolveError, match="not supported"):
        _turning(PINNED[:1])


def test_joints_excite_no_first_order() -> None:
    with pytest.raises(ValueError, match="order 1"):
        answer(_turning(), 1, np.array([100.0]), COUPLE[None])
