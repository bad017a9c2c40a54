"""The pi that stands for a piece of a shaft, against closed forms and condensation in many digits."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.distributed.continuous_shafts import (
    profile_points,
    profile_shafts,
    uniform_shafts,
)
from torsion.kernels.distributed.finite_elements import condensed_elements
from torsion.kernels.distributed.span_laws import Shafts

LENGTH, RIGIDITY, HEAVY = 1.3, 2e6, 0.7


def _uniform_pi(s):
    length, rigidity, heavy = map(mp.mpf, (LENGTH, RIGIDITY, HEAVY))
    mu = length * mp.sqrt(heavy / rigidity * s)
    end = heavy * length / 2 * mp.tan(mu / 2) / (mu / 2)
    return length / rigidity * mp.sin(mu) / mu, end, end


def _slopes(function, s):
    step = s * mp.mpf(10) ** -13
    high, low = function(s + step), function(s - step)
    return [(a - b) / (2 * step) for a, b in zip(high, low, strict=True)]


def _all(slopes):
    names = ("flexibility", "inner", "outer", "flexibility_slope", "inner_slope", "outer_slope")
    return [getattr(slopes, name)[0, 0] for name in names]


@pytest.mark.parametrize("law", ["uniform", "profile"])
@pytest.mark.parametrize("share", [1e-9, 1e-3, 0.1, 0.4, 0.62, 0.65, 0.8, 0.9])
def test_a_uniform_piece_has_the_closed_form_and_its_slopes(trains, law: str, share: float) -> None:
    exact = uniform_shafts(LENGTH, RIGIDITY, HEAVY)
    flat = np.ones((1, len(profile_points())))
    found = exact if law == "uniform" else profile_shafts(LENGTH, flat / RIGIDITY, flat * HEAVY)
    s = (share * exact.limit) ** 2
    expected = [*_uniform_pi(mp.mpf(s)), *_slopes(_uniform_pi, mp.mpf(s))]
    assert trains.off(_all(found.slopes(np.array([s]))), expected) < 6e-15
    assert trains.off([row[0, 0] for row in found.at(np.array([s]))], expected[:3]) < 4e-15
    assert found.rounding(np.array([s]))[0] > trains.off(
        [row[0, 0] for row in found.at(np.array([s]))], expected[:3]
    )


def _cone_pi(ratio):
    """Of a solid cone of length 1 whose diameter grows from 1 to `ratio`, G I = rho I = d^4."""

    def pi(s):
        w, slope = mp.sqrt(s), mp.mpf(ratio) - 1

        def basis(x):
            z = w * (x + 1 / slope)
            angle = [
                (mp.sin(z) / z**2 - mp.cos(z) / z) / z,
                (-mp.cos(z) / z**2 - mp.sin(z) / z) / z,
            ]
            turn = [
                -((3 / z**3 - 1 / z) * mp.sin(z) - 3 * mp.cos(z) / z**2) / z,
                ((3 / z**3 - 1 / z) * mp.cos(z) + 3 * mp.sin(z) / z**2) / z,
            ]
            factor = (1 + slope * x) ** 4 * w
            return mp.matrix([angle, [factor * t for t in turn]])

        step = basis(mp.mpf(1)) * basis(mp.mpf(0)) ** -1
        return step[0, 1], (1 - step[0, 0]) / (s * step[0, 1]), (1 - step[1, 1]) / (s * step[0, 1])

    return pi


@pytest.mark.parametrize("ratio", [1.05, 1.5, 3.0])
@pytest.mark.parametrize("share", [0.05, 0.4, 0.8])
def test_a_cone_has_the_elementary_solution(trains, ratio: float, share: float) -> None:
    section = (1.0 + (ratio - 1.0) * profile_points()) ** 4
    law = profile_shafts(1.0, 1.0 / section[None], section[None])
    s = (share * law.limit) ** 2
    exact = _cone_pi(ratio)
    assert (
        trains.off(_all(law.slopes(np.array([s]))), [*exact(mp.mpf(s)), *_slopes(exact, mp.mpf(s))])
        < 6e-15
    )
    turned = law.turned(np.array([True])).at(np.array([s]))
    assert (
        trains.off([row[0, 0] for row in turned], [exact(mp.mpf(s))[k] for k in (0, 2, 1)]) < 4e-15
    )


def test_the_limit_of_a_profile_is_at_most_the_lowest_frequency_with_both_ends_held() -> None:
    for ratio in (1.2, 3.0, 6.0):
        section = (1.0 + (ratio - 1.0) * profile_points(48)) ** 4
        law = profile_shafts(1.0, 1.0 / section[None], section[None])
        first = mp.findroot(
            lambda s, r=ratio: _cone_pi(r)(s)[0], mp.mpf(law.limit) ** 2 * mp.mpf("1.05")
        )
        assert 0.95 < law.limit / float(mp.sqrt(first)) < 1.0


def _condensed(k, m, s):
    """1/h and the end inertias by eliminating the unknowns inside, in many digits."""
    dynamic = mp.matrix(k.tolist()) - s * mp.matrix(m.tolist())
    size = len(k)
    inside = mp.matrix([[dynamic[i, j] for j in range(2, size)] for i in range(2, size)])
    to_ends = mp.matrix([[dynamic[i, j] for j in range(2)] for i in range(2, size)])
    ends = dynamic[:2, :2] - to_ends.T * (inside**-1) * to_ends
    return -1 / ends[0, 1], -(ends[0, 0] + ends[0, 1]) / s, -(ends[1, 1] + ends[0, 1]) / s


@pytest.mark.parametrize("degree", [2, 3, 5, 10])
@pytest.mark.parametrize("share", [0.3, 0.8])
def test_an_element_is_what_condensation_leaves(trains, degree: int, share: float) -> None:
    taper = lambda x: (1.0 + x) ** 4  # noqa: E731
    k, m = trains.element(degree, 0.8, taper, taper)
    law = condensed_elements(k[None], m[None])
    s = (share * law.limit) ** 2
    exact = lambda square: _condensed(k, m, square)  # noqa: E731
    found = _all(law.slopes(np.array([s])))
    assert (
        trains.off(found[:3], exact(mp.mpf(s))) < 2e-13
    )  # the matrices' own rounding moves the rigid turn by this much
    assert trains.off(found[3:], _slopes(exact, mp.mpf(s))) < 1e-12


def test_the_lowest_frequency_of_an_element_with_held_ends_is_its_limit(trains) -> None:
    k, m = trains.element(10, 2.0, np.ones_like, np.ones_like)
    assert condensed_elements(k[None], m[None]).limit == pytest.approx(np.pi / 2, rel=1e-13)
    k, m = trains.element(1, 2.0, np.ones_like, np.ones_like)
    assert condensed_elements(k[None], m[None]).limit == np.inf


def test_nodal_and_hierarchic_unknowns_give_the_same_element(trains) -> None:
    k, m = trains.element(2, 1.0, np.exp, np.exp)
    change = np.array([[1.0, 0, 0], [0, 1.0, 0], [-0.5, -0.5, 1.0]])
    change[2] /= -np.sqrt(1.5) / 2.0  # the hierarchic bubble in the middle
    nodal = [(change.T @ matrix @ change)[None] for matrix in (k, m)]
    s = np.array([0.0, 1.0, 4.0])
    for one, other in zip(
        condensed_elements(*nodal).at(s), condensed_elements(k[None], m[None]).at(s), strict=True
    ):
        assert np.allclose(one, other, rtol=2e-15)


def test_all_of_the_inertia_turns_with_an_element_that_turns_as_a_whole(trains) -> None:
    k, m = trains.element(7, 1.0, lambda x: 1e9 * (1.0 + x) ** 4, lambda x: (1.0 + x) ** 4)
    _, inner, outer = condensed_elements(k[None], m[None]).at(np.zeros(1))
    assert inner[0, 0] + outer[0, 0] == pytest.approx(31.0 / 5.0, rel=1e-15)


def test_a_stiffness_without_a_rigid_motion_is_refused(trains) -> None:
    k, m = trains.element(3, 1.0, np.ones_like, np.ones_like)
    k[2, 0] = k[0, 2] = 0.3
    with pytest.raises(ValueError, match="no rigid motion"):
        condensed_elements(k[None], m[None])


def test_a_profile_too_steep_for_its_points_is_refused() -> None:
    section = np.exp(200.0 * profile_points() ** 2)
    with pytest.raises(ValueError, match="too steep"):
        profile_shafts(1.0, 1.0 / section[None], section[None])


@pytest.mark.parametrize("eta", [0.0, 0.02, 0.3])
def test_a_lossy_material_is_a_complex_shear_modulus(trains, eta: float) -> None:
    """Of laws of all sorts side by side, each in its closed form or, for elements, by complex condensation."""
    flat = np.ones((1, len(profile_points())))
    k, m = trains.element(6, LENGTH, lambda x: RIGIDITY + 0 * x, lambda x: HEAVY + 0 * x)
    laws = (
        uniform_shafts(LENGTH, RIGIDITY, HEAVY),
        profile_shafts(LENGTH, flat / RIGIDITY, flat * HEAVY),
    )
    bars = Shafts(np.array([3, 1, 2]), (*laws, condensed_elements(k[None], m[None])))
    s = (0.5 * bars.limit) ** 2
    found = bars.lossy(np.array([s]), np.full(3, eta))
    turn = mp.mpc(1, eta)
    h, end, _ = _uniform_pi(mp.mpf(s) / turn)
    for row in range(2):
        for value, exact in zip(found, (h / turn, end, end), strict=True):
            assert abs(value[row, 0] / complex(exact) - 1) < 4e-15
    assert abs(found[0][2, 0] / complex(h / turn) - 1) < 1e-7
    exact = _condensed(k, m, mp.mpf(s) / turn)
    assert abs(found[1][2, 0] / complex(exact[1]) - 1) < 1e-12


def test_bars_of_a_wrong_number_are_refused() -> None:
    with pytest.raises(ValueError, match="laws are for 1 shafts; expected 2"):
        Shafts(np.array([1, 2]), (uniform_shafts(1.0, 1.0, 1.0),)).at(np.zeros(1))
