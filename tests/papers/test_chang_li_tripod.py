"""Chang and Li: couple ranges of tripods, and each printed equation against three arms on three lines in space."""

import numpy as np
import pytest

from torsion.kernels.joints import tripod

TORQUE, RADIUS, ARM = 200.0, 0.03, 0.6
SHARE, FORTY = RADIUS / ARM, np.radians(40.0)
HALF_TURN = np.linspace(0.0, np.pi, 13)
RANGES = {  # N m: couple of the single bearing least, greatest; twin bearing
    10: (17.3811593206, 17.6143296922, 17.4977327052),
    20: (34.7695184780, 35.7621162435, 35.2653961417),
    30: (52.3501360565, 54.8372731549, 53.5898384862),
    40: (70.2214996492, 75.4098489999, 72.7940468532),
}


def in_space(paper, name: str, angle: float, share: float = SHARE) -> np.ndarray:
    found = [paper["tripod_space"].tripod(float(x), float(angle), share) for x in HALF_TURN]
    return np.array([getattr(one, name) for one in found])


def apart(found: object, truth: np.ndarray) -> float:
    return float(np.abs(np.asarray(found) - truth).max() / np.abs(truth).max())


@pytest.mark.parametrize("degrees", RANGES)
def test_couple_ranges_of_figures_5_and_6(degrees: int, paper) -> None:
    """Corrected (10) and (12): M1 is V1 where sin 3 phi is 1 or -1, for U1 vanishes there."""
    g = np.radians(degrees)
    ends = TORQUE * paper["tripod_equations"].couple_right(g, np.radians([90.0, 30.0]), SHARE)
    twin = TORQUE * paper["tripod_equations"].twin_right(g)[0]
    np.testing.assert_allclose([*ends, twin], RANGES[degrees], rtol=1e-11)
    curve = paper["chang_li_tripod"].couple(degrees)
    np.testing.assert_allclose([curve.min(), curve.max()], RANGES[degrees][:2], rtol=1e-11)


def test_scene_has_the_couples_of_the_exact_mechanism(paper) -> None:
    joint = paper["scenes"].joints("chang_li_tripod").joints[0]
    largest = joint.couples[0].largest
    assert largest == pytest.approx(RANGES[40][1], rel=2e-4)
    assert largest == pytest.approx(TORQUE * in_space(paper, "inplane", FORTY).max(), rel=2e-4)


def test_scene_with_twin_bearings_has_a_couple_that_stands_still(paper) -> None:
    found = (
        paper["scenes"].joints("chang_li_tripod", ("bearing: single", "bearing: twin")).joints[0]
    )
    for side in found.couples:
        np.testing.assert_allclose(np.hypot(side.normal, side.inplane), RANGES[40][2], rtol=1e-11)
    np.testing.assert_allclose(found.speed_ratio, 1.0, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("degrees", RANGES)
def test_exact_mechanism_agrees_with_three_lines_in_space(degrees: int, paper) -> None:
    g = np.radians(degrees)
    ours = tripod.exact_statics(HALF_TURN, g, RADIUS, ARM, 1.0)
    moved = tripod.exact_motion(HALF_TURN, g, RADIUS, ARM)
    truth = {
        name: in_space(paper, name, g)
        for name in ("error", "driven_torque", "inplane", "normal", "force")
    }
    np.testing.assert_allclose(moved.error, truth["error"], rtol=0.0, atol=1e-14)
    for found, name in (
        (ours.torque, "driven_torque"),
        (ours.driving_inplane, "inplane"),
        (ours.driving_normal, "normal"),
    ):
        np.testing.assert_allclose(found, truth[name], rtol=0.0, atol=1e-13)
    np.testing.assert_allclose(np.hypot(*ours.force) * ARM, truth["force"], rtol=0.0, atol=1e-12)


@pytest.mark.parametrize(
    ("right", "wrong", "name", "sign"),
    [
        ("driven_torque_right", "driven_torque_printed", "driven_torque", -1.0),
        ("couple_right", "couple_printed", "inplane", 1.0),
    ],
)
def test_sign_of_the_denominators_of_9_and_10(
    right: str, wrong: str, name: str, sign: float, paper
) -> None:
    """As radius/arm goes to zero the right form's distance falls with its square, the printed form's with itself."""
    own, distances = paper["tripod_equations"], {}
    for share in (2e-3, 1e-3):
        truth = sign * in_space(paper, name, FORTY, share)
        distances[share] = [
            np.abs(getattr(own, form)(FORTY, HALF_TURN, share) - truth).max()
            for form in (right, wrong)
        ]
    falls = np.array(distances[2e-3]) / np.array(distances[1e-3])
    np.testing.assert_allclose(falls, [4.0, 2.0], rtol=0.02)
    truth = sign * in_space(paper, name, FORTY)
    assert apart(getattr(own, right)(FORTY, HALF_TURN, SHARE), truth) < 1e-3
    assert apart(getattr(own, wrong)(FORTY, HALF_TURN, SHARE), truth) > 1e-2


def test_corrected_10_is_the_power_balance(paper) -> None:
    """V1 = Ti (1/i - cos g)/sin g, i = dTo/dTi of the motion to the same order."""
    ratio = paper["tripod_first_order"].first_order_motion(HALF_TURN, FORTY, SHARE, 1.0).ratio
    expected = (1.0 / ratio - np.cos(FORTY)) / np.sin(FORTY)
    np.testing.assert_allclose(
        paper["tripod_equations"].couple_right(FORTY, HALF_TURN, SHARE), expected, rtol=1e-13
    )
    np.testing.assert_allclose(
        paper["tripod_equations"].couple_right(FORTY, HALF_TURN, 0.0), np.tan(FORTY / 2.0)
    )


def test_couples_of_14_are_both_half_the_angle(paper) -> None:
    """Each shaft bends by what a moment in the bisecting plane leaves: Ti tan(g/2)."""
    driving, driven = np.array([0.0, 0.0, 1.0]), np.array([0.0, -np.sin(FORTY), np.cos(FORTY)])
    moment = (driving + driven) / (1.0 + driving @ driven)
    truth = [np.linalg.norm(moment - (moment @ shaft) * shaft) for shaft in (driving, driven)]
    np.testing.assert_allclose(paper["tripod_equations"].twin_right(FORTY), truth, rtol=1e-14)
    assert np.all(np.abs(paper["tripod_equations"].twin_printed(FORTY)) > 5.0 * np.array(truth))


def test_single_bearing_pushes_the_shafts_sideways(paper) -> None:
    """About V1/L: 29.2 N at 10 degrees, 121 N at 40."""
    for degrees, force in ((10, 29.2), (40, 121.0)):
        found = TORQUE / ARM * in_space(paper, "force", np.radians(degrees))
        assert found.mean() == pytest.approx(force, rel=0.01)
