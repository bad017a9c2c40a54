"""Liu et al. (2023), section 3: the closed model against bodies in space, energy, another integrator, the program."""

import re
from pathlib import Path

import numpy as np
import pytest

from torsion.kernels.joints import cross

PAGES = Path(__file__).parents[2] / "reports" / "papers"


def states(count: int) -> np.ndarray:
    rng = np.random.default_rng(7)
    still = np.zeros((count, 8))
    return np.hstack(
        [rng.uniform(0.0, 6.0, (count, 4)), rng.uniform(20.0, 80.0, (count, 4)), still]
    )


@pytest.mark.parametrize("angle", [8.0, 35.0])
def test_accelerations_and_joint_torques_are_those_of_pins_in_space(angle: float, paper) -> None:
    boat = paper["liu_bend_model"].Boat(angle=np.radians(angle))
    for state in states(20):
        moving = paper["liu_bend_model"].turning(boat, state)
        found, driving, driven = paper["liu_bend_space"].balance(boat, moving)
        np.testing.assert_allclose(
            moving.acceleration, found, rtol=0.0, atol=1e-12 * np.abs(found).max()
        )
        np.testing.assert_allclose(
            moving.joint, driving, rtol=0.0, atol=1e-12 * np.abs(driving).max()
        )
        power = driving * np.array(moving.speed)[[1, 3]] - driven * np.array(moving.speed)[[2, 4]]
        np.testing.assert_allclose(power, 0.0, rtol=0.0, atol=1e-9 * np.abs(driving).max())


def test_energy_is_kept_without_damping_and_torque(paper) -> None:
    model = paper["liu_bend_model"]
    boat = model.free(model.Boat(angle=np.radians(20.0)))
    start = paper["liu_bend"].twisted(boat)
    run = model.motion(boat, np.linspace(0.0, 0.06, 7), tolerance=1e-11, start=start).T
    energies = np.array([model.energy(boat, state) for state in run])
    np.testing.assert_allclose(energies, energies[0], rtol=1e-10)
    elastic = [np.abs(model.turning(boat, state).shaft).max() for state in run]
    assert np.ptp(elastic) > 100.0, "N m: energy goes to and fro"


def test_two_integrators_agree(paper) -> None:
    model = paper["liu_bend_model"]
    times = np.linspace(0.0, 0.02, 3)
    one = model.motion(model.Boat(), times, tolerance=1e-10)
    other = model.motion(model.Boat(), times, tolerance=1e-8, method="Radau")
    np.testing.assert_allclose(
        other, one, rtol=0.0, atol=1e-5 * np.abs(one).max(axis=1, keepdims=True).max()
    )
    for row in range(16):
        assert np.abs(other[row] - one[row]).max() < 1e-4 * np.abs(one[row]).max() + 1e-12


def test_bearings_are_pushed_by_the_couples_of_the_joints(paper) -> None:
    """By pins in space, and by the program's couples and reactions: the bearing beside the joint bears the negative."""
    model = paper["liu_bend_model"]
    boat = model.Boat(angle=np.radians(25.0))
    for state in states(10):
        moving = model.turning(boat, state)
        found = np.array(model.forces(boat, moving))
        bent = paper["liu_bend_space"].couples(boat, moving, np.array(moving.joint)) / boat.span
        expected = [bent[1], -bent[0], -bent[3], bent[2]]
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(bent).max())
        front = cross.couples(moving.angle[1], boat.angle, moving.joint[0], convention="N").driving
        rear = cross.couples(moving.angle[3], boat.angle, moving.joint[1], convention="P").driven
        ends = (front, -boat.span), (rear, boat.span)  # distance times force + couple = 0
        own = np.array([value / span for end, span in ends for value in (-end.inplane, end.normal)])
        np.testing.assert_allclose(found, own, rtol=0.0, atol=1e-12 * np.abs(own).max())


def test_forks_in_line_pass_an_even_speed_on(paper) -> None:
    model = paper["liu_bend_model"]
    for x in np.linspace(0.0, 7.0, 29):
        between, first, _ = model.front(x, 0.6)
        behind, second, _ = model.rear(between, 0.6)
        assert first * second == pytest.approx(1.0, rel=1e-14)
        assert behind == pytest.approx(x, abs=1e-14)


def test_natural_frequencies_are_the_programs_and_fall_with_the_root_of_stiffness(paper) -> None:
    model, page = paper["liu_bend_model"], paper["liu_bend"]
    found = paper["pump_lumped"].modes_of(paper["scenes"].solved(page.NAME)).frequency
    np.testing.assert_allclose(model.frequencies(model.Boat()), found, rtol=1e-12)
    np.testing.assert_allclose(
        model.frequencies(model.Boat().softer(0.5)), found * np.sqrt(0.5), rtol=1e-12
    )


@pytest.mark.parametrize("name", ["stiff shafts", "softer shafts"])
def test_spectra_have_the_natural_frequencies_and_twice_the_speed(name: str, paper) -> None:
    page, model = paper["liu_bend"], paper["liu_bend_model"]
    twist = page.run(name)[0] - page.run(name)[1]
    for frequency in model.frequencies(page.LINES[name])[:2]:
        line, size = page.peak(twist, frequency)
        assert abs(line - frequency) <= 1.0
        assert size > 3.0 * page.peak(twist, frequency + 15.0)[1]
    boat, twice = page.LINES[name], 60.0 / np.pi
    line, size = page.peak(page.run(name)[8], twice)
    assert abs(line - twice) <= 1.0
    static = boat.torque * np.tan(boat.angle) / (2.0 * boat.span * boat.bearing_stiffness)
    own = np.sqrt(boat.bearing_stiffness / boat.mass) / (2.0 * np.pi)
    assert size == pytest.approx(static / (1.0 - (twice / own) ** 2), rel=0.05)


def test_softer_shafts_twist_more(paper) -> None:
    stiff, soft = (
        np.abs(paper["liu_bend"].twist(name)).max() for name in ("stiff shafts", "softer shafts")
    )
    assert soft == pytest.approx(2.0 * stiff, rel=0.1)


def test_committed_page_is_what_the_program_says(paper) -> None:
    page = paper["liu_bend"].page()
    written = (PAGES / "liu_2023_section_3.md").read_text(encoding="utf-8")
    assert written == page.text(), "run python -m benchmarks.papers"
    assert [fault.where[:6] for fault in page.misprints] == ["(14) a", "(14) b", "(14) c", "(14) d"]
    shown = re.findall(r"\]\((\S+\.svg)\)", written)
    assert len(shown) == 2
    for file in shown:
        assert "</svg>" in (PAGES / file).read_text(encoding="utf-8")
