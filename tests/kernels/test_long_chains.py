"""Modes of as long a chain as the program takes, against closed forms."""

from functools import cache

import numpy as np
import pytest

from torsion.kernels.modes.natural_modes import TreeModes, tree_modes
from torsion.kernels.trees.tree import Tree

LONG = 20_000
FIXED = 4_000  # of a chain with a fixed end: its middle is that of the long one


@cache
def uniform_modes(count: int, held: tuple[int, ...]) -> TreeModes:
    stations = np.arange(count)
    return tree_modes(
        Tree(stations - 1, np.ones(count), np.ones(count), np.isin(stations, held)), 20
    )


@pytest.mark.parametrize(
    ("count", "held", "phase"),
    [
        (LONG, (), "free"),
        (FIXED, (0,), "quarter"),
        (FIXED, (FIXED - 1,), "quarter"),
        (FIXED, (0, FIXED - 1), "half"),
    ],
)
def test_long_uniform_chain_has_the_frequencies_2_sin(count, held, phase):
    modes = uniform_modes(count, held)
    mode = np.arange(1, 21)
    turns = {
        "free": mode / (2 * count),
        "quarter": (2 * mode - 1) / (4 * count - 2),
        "half": mode / (2 * (count - 1)),
    }
    exact = 2 * np.sin(np.pi * turns[phase])
    np.testing.assert_allclose(modes.frequency, exact, rtol=1e-13)
    assert modes.certified
    assert modes.rigid == (phase == "free")
    assert np.all((modes.lower < exact) & (exact < modes.upper))
    assert np.all(modes.upper < modes.lower * (1 + 2e-11))


def test_long_uniform_chain_has_cosine_shapes_and_sine_torques():
    modes = uniform_modes(LONG, ())
    angle, torques, frequency = modes.angle[:, :8], modes.torque[1:, :8], modes.frequency[:8]
    mode, station = np.arange(1, 9), np.arange(LONG)[:, None]
    largest = np.sqrt(2 / LONG)
    shape = largest * np.cos(mode * np.pi * (station + 0.5) / LONG)
    torque = largest * frequency * np.sin(mode * np.pi * station / LONG)
    np.testing.assert_allclose(angle, shape, atol=1e-10 * largest)
    np.testing.assert_allclose(torques / frequency, torque[1:] / frequency, atol=1e-10 * largest)
    np.testing.assert_allclose(modes.angle.T @ modes.angle, np.eye(20), atol=1e-12)
    np.testing.assert_allclose(modes.rigid_angle, LONG**-0.5, rtol=1e-14)
