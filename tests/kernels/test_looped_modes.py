"""Modes of trains with closed loops against many digits and closed forms."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.modes.loops import graph_modes
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree


def _worst(found, exact, sign):
    largest = max(abs(e) for e in exact)
    return float(
        max(abs(mp.mpf(f) - sign * e) for f, e in zip(found.tolist(), exact, strict=True)) / largest
    )


@pytest.mark.parametrize(
    ("shape", "held"), [("chain", "none"), ("branched", "root"), ("bushy", "leaves")]
)
@pytest.mark.parametrize(("seed", "loops"), [(1, 1), (2, 2), (3, 4)])
def test_stiff_trains_with_loops_are_right_in_frequency_angle_and_torque(
    random_tree, shuffled_loops, exact_modes, shape, held, seed, loops
):
    tree, first, second, flexibility = shuffled_loops(
        random_tree(seed, size=10, shape=shape, held=held), seed, loops
    )
    modes = graph_modes(tree, first, second, flexibility)
    exact = exact_modes(tree, first, second, flexibility)
    assert len(modes.frequency) == len(exact.frequency)
    assert not modes.certified
    weight = np.sqrt(tree.moving_inertia).tolist()
    for mode, w in enumerate(exact.frequency):
        assert abs(mp.mpf(modes.frequency[mode]) / w - 1) < 2e-15
        assert mp.mpf(modes.lower[mode]) <= w <= mp.mpf(modes.upper[mode])
        weighted = [a * s for a, s in zip(exact.angle[mode], weight, strict=True)]
        sign = mp.sign(
            mp.fsum(a * b for a, b in zip(weighted, modes.angle[:, mode].tolist(), strict=True))
        )
        assert _worst(modes.angle[:, mode] * weight, weighted, sign) < 1e-12
        torque = np.append(modes.torque[:, mode], modes.loop_torque[:, mode])
        assert _worst(torque, exact.torque[mode] + exact.loop_torque[mode], sign) < 1e-12


@pytest.mark.parametrize("size", [3, 4, 9])
def test_ring_of_equal_inertias_has_pairs_at_2_sin(size):
    tree = Tree(
        np.arange(-1, size - 1),
        np.append(0.0, np.ones(size - 1)),
        np.ones(size),
        np.zeros(size, bool),
    )
    modes = graph_modes(tree, np.array([0]), np.array([size - 1]), np.array([1.0]))
    expected = np.sort(2 * np.sin(np.pi * np.arange(1, size) / size))
    np.testing.assert_allclose(modes.frequency, expected, rtol=2e-15)
    width = 4.0 * 2.0**-52 * (size - 1)  # the stated bound: 4 rounding units a body
    for bound, sign in ((modes.lower, -1.0), (modes.upper, 1.0)):
        np.testing.assert_allclose(sign * (bound / modes.frequency - 1.0), width, rtol=0.25)
    assert ((modes.lower < expected) & (expected < modes.upper)).all()
    np.testing.assert_allclose(modes.angle.T @ modes.angle, np.eye(size - 1), atol=1e-14)
    np.testing.assert_allclose(modes.loop_torque[0], modes.angle[0] - modes.angle[-1], atol=1e-14)
    assert modes.rigid == 1


def test_a_parallel_span_adds_its_stiffness(chain):
    tree = chain([2.0, 3.0], [1 / 0.5])
    modes = graph_modes(tree, np.array([0]), np.array([1]), np.array([0.25]))
    np.testing.assert_allclose(modes.frequency, [np.sqrt(6 * 5 / 6)], rtol=2e-15)
    np.testing.assert_allclose(modes.loop_torque[0], 2 * modes.torque[1], rtol=1e-14)


def test_loops_through_massless_rigid_and_fixed_stations(exact_modes):
    tree = Tree(
        np.array([-1, 0, 1, 1, 3, 4, 4]),
        np.array([0, 1e-3, 2e-3, 3e-4, 0, 1e-2, 5e-3]),
        np.array([1.0, 0, 2, 1, 3, 0, 4]),
        np.array([False] * 6 + [True]),
    )
    first, second, flexibility = np.array([2, 0]), np.array([5, 6]), np.array([1e-4, 1e-3])
    modes, exact = (
        graph_modes(tree, first, second, flexibility),
        exact_modes(tree, first, second, flexibility),
    )
    np.testing.assert_allclose(modes.frequency, [float(w) for w in exact.frequency], rtol=2e-15)
    loop = np.array([[float(t) for t in row] for row in exact.loop_torque]).T
    np.testing.assert_allclose(np.abs(modes.loop_torque), np.abs(loop), rtol=1e-12)


def test_loops_through_held_stations_inside_the_train():
    tree = Tree(
        np.array([-1, 0, 0, 1]),
        np.array([0, 2.0, 7, 0]),
        np.array([3.0, 0.1, 0.04, 0.1]),
        np.arange(4) == 1,
    )
    first, second = np.array([2, 3, 1]), np.array([3, 0, 3])
    modes = graph_modes(tree, first, second, np.ones(3))
    a, b = modes.angle[0], modes.angle[2]
    np.testing.assert_allclose(modes.torque[1], a / 2, rtol=1e-13)
    np.testing.assert_allclose(modes.torque[2], (a - b) / 7, rtol=1e-13)
    np.testing.assert_allclose(modes.loop_torque[:2], [b, -a], rtol=1e-13)
    np.testing.assert_array_equal(modes.loop_torque[2], 0.0)
    np.testing.assert_allclose(modes.torque[3], -(a + b), rtol=1e-13)
    np.testing.assert_allclose(3 * modes.frequency**2 * a, a / 2 + (a - b) / 7 + a, rtol=1e-12)


def test_nearly_repeated_frequencies_of_a_graph_keep_equilibrium():
    inertia, held = np.array([2.0, 1, 1, 1, 1, 2]), np.arange(6) == 1
    tree = Tree(np.array([-1, 0, 1, 0, 0, 0]), np.array([0.0, 1, 1, 1, 1, 1]), inertia, held)
    modes = graph_modes(tree, np.array([1]), np.array([0]), np.array([1e-6]))
    rest = tree.moving_inertia[:, None] * modes.angle * modes.frequency**2 + modes.torque
    np.add.at(rest, tree.parent[1:], -modes.torque[1:])
    rest[0] += modes.loop_torque[0]
    largest = np.abs(np.vstack([modes.torque, modes.loop_torque])).max(axis=0)
    np.testing.assert_allclose((rest / largest)[~held], 0.0, atol=1e-12)


def test_rigid_span_to_ground_carries_the_reaction_of_a_loop():
    tree = Tree(
        np.array([-1, 0, 1]),
        np.array([0, 1.0, 0.0]),
        np.array([1.0, 1, 1]),
        np.array([False, False, True]),
    )
    modes = graph_modes(tree, np.array([0]), np.array([1]), np.array([1.0]))
    np.testing.assert_allclose(modes.frequency, [np.sqrt(2)], rtol=1e-15)
    np.testing.assert_allclose(modes.torque[2], modes.torque[1] + modes.loop_torque[0], rtol=1e-14)


def test_without_a_loop_the_modes_are_those_of_the_tree(random_tree):
    tree = random_tree(2, size=8)
    none = np.zeros(0, dtype=np.int64)
    np.testing.assert_array_equal(
        graph_modes(tree, none, none, np.zeros(0)).angle, tree_modes(tree).angle
    )


def test_lowest_modes_of_a_ring_only():
    tree = Tree(
        np.arange(-1, 5), np.append(0.0, np.ones(5)), np.arange(1.0, 7.0), np.zeros(6, bool)
    )
    loop = (np.array([0]), np.array([5]), np.array([2.0]))
    whole, lowest = graph_modes(tree, *loop), graph_modes(tree, *loop, 2)
    np.testing.assert_array_equal(lowest.frequency, whole.frequency[:2])
    assert lowest.angle.shape == (6, 2)
    assert lowest.loop_torque.shape == (1, 2)


def test_a_rigid_closing_span_is_refused(chain):
    with pytest.raises(ValueError, match="positive flexibility"):
        graph_modes(chain([1.0, 1.0], [1.0]), np.array([0]), np.array([1]), np.array([0.0]))
