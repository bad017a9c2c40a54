"""Modes of as long a chain as the program takes, against closed forms."""

import numpy as np
import pytest

from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree

LONG = 20_000


def _uniform(held=()):
    stations = np.arange(LONG)
    return Tree(stations - 1, np.ones(LONG), np.ones(LONG), np.isin(stations, held))


@pytest.mark.parametrize(
    ("held", "phase"),
    [((), "free"), ((0,), "quarter"), ((LONG - 1,), "quarter"), ((0, LONG - 1), "half")],
)
def test_long_uniform_chain_has_the_frequencies_2_sin(held, phase):
    modes = tree_modes(_uniform(held), 20)
    mode = np.arange(1, 21)
    turns = {
        "free": mode / (2 * LONG),
        "quarter": (2 * mode - 1) / (4 * LONG - 2),
        "half": mode / (2 * (LONG - 1)),
    }
    exact = 2 * np.sin(np.pi * turns[phase])
    np.testing.assert_allclose(modes.frequency, exact, rtol=1e-13)
    assert modes.certified
    assert modes.rigid == (phase == "free")
    assert np.all((modes.lower < exact) & (exact < modes.upper))
    assert np.all(modes.upper < modes.lower * (1 + 2e-11))


def test_long_uniform_chain_has_cosine_shapes_and_sine_torques():
    modes = tree_modes(_uniform(), 8)
    mode, station = np.arange(1, 9), np.arange(LONG)[:, None]
    largest = np.sqrt(2 / LONG)
    shape = largest * np.cos(mode * np.pi * (station + 0.5) / LONG)
    torque = largest * modes.frequency * np.sin(mode * np.pi * station / LONG)
    np.testing.assert_allclose(modes.angle, shape, atol=1e-10 * largest)
    np.testing.assert_allclose(
        modes.torque[1:] / modes.frequency, torque[1:] / modes.frequency, atol=1e-10 * largest
    )
    np.testing.assert_allclose(modes.angle.T @ modes.angle, np.eye(8), atol=1e-12)
    np.testing.assert_allclose(modes.rigid_angle, LONG**-0.5, rtol=1e-14)
