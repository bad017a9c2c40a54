"""The quick ways to the modes of a tree lead to the same modes: by the size, the shape and the start."""

import numpy as np
import pytest

from torsion.kernels.modes.mode_shapes import shapes_at
from torsion.kernels.modes.natural_modes import count_below, enclose, expected_width, tree_modes
from torsion.kernels.trees.tree import Tree


@pytest.mark.parametrize("shape", ["chain", "branched", "bushy"])
def test_shapes_found_in_blocks_are_those_found_at_once(random_tree, monkeypatch, shape):
    tree = random_tree(27, size=20, shape=shape)
    right = tree_modes(tree)
    monkeypatch.setattr("torsion.kernels.modes.mode_shapes._LARGEST_BLOCK", 0)
    monkeypatch.setattr("torsion.kernels.modes.mode_shapes._LEAST_COLUMNS", 7)
    found = tree_modes(tree)
    np.testing.assert_allclose(found.frequency, right.frequency, rtol=1e-15)
    np.testing.assert_allclose(found.torque, right.torque, rtol=1e-14)


@pytest.mark.parametrize("held", ["none", "root", "leaves"])
def test_a_chain_has_the_modes_of_the_same_train_hung_from_its_middle(random_tree, held):
    tree = random_tree(28, size=11, shape="chain", held=held)
    order = [5, 4, 6, 3, 7, 2, 8, 1, 9, 0, 10]
    parent = [-1, 0, 0, *range(1, 9)]
    soft = [
        0.0,
        *(tree.flexibility[max(i, order[p])] for i, p in zip(order[1:], parent[1:], strict=True)),
    ]
    hung = Tree(np.array(parent), np.array(soft), tree.inertia[order], tree.held[order])
    chain, other = tree_modes(tree), tree_modes(hung)
    np.testing.assert_allclose(chain.frequency, other.frequency, rtol=1e-15)
    np.testing.assert_allclose(np.abs(chain.angle[order]), np.abs(other.angle), rtol=1e-11)
    np.testing.assert_allclose(
        np.abs(chain.torque[6:]), np.abs(other.torque[[2, 4, 6, 8, 10]]), rtol=1e-11
    )


@pytest.mark.parametrize("shape", ["chain", "branched"])
def test_most_frequencies_are_enclosed_by_the_first_width_tried(random_tree, shape):
    tree = random_tree(29, size=60, shape=shape)
    modes = tree_modes(tree)
    passed = shapes_at(tree, modes.frequency).passed
    width = expected_width(tree, modes.frequency, passed)
    lower, upper, proven = enclose(tree, modes.frequency, 1, passed)
    assert proven.all()
    assert np.mean((upper - lower) / modes.frequency < 2.1 * width) > 0.9


def test_the_few_lowest_modes_of_a_large_tree_are_the_first_of_all(random_tree):
    tree = random_tree(30, size=320, shape="branched")
    few, every = tree_modes(tree, 5), tree_modes(tree)
    np.testing.assert_allclose(few.frequency, every.frequency[:5], rtol=1e-15)
    np.testing.assert_allclose(few.angle, every.angle[:, :5], rtol=1e-9)
    assert few.certified


@pytest.mark.parametrize(
    ("shape", "held"), [("branched", "none"), ("branched", "root"), ("bushy", "leaves")]
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_trees_have_every_angle_and_torque_right_componentwise(
    random_tree, exact_modes, shape, held, seed
):
    tree = random_tree(seed, size=10, shape=shape, held=held)
    modes, exact = tree_modes(tree), exact_modes(tree)
    np.testing.assert_allclose(modes.frequency, np.array(exact.frequency, dtype=float), rtol=1e-15)
    angle, torque = (np.array(rows, dtype=float).T for rows in (exact.angle, exact.torque))
    sign = np.sign(np.sum(angle * modes.angle, axis=0))
    np.testing.assert_allclose(modes.angle, sign * angle, rtol=1e-11, atol=1e-90)  # of 120 digits
    np.testing.assert_allclose(modes.torque, sign * torque, rtol=1e-11, atol=1e-90)


@pytest.mark.parametrize("shape", ["branched", "bushy"])
def test_large_families_are_bounded_by_counts(random_tree, exact_count, shape):
    tree = random_tree(33, size=60, shape=shape)
    tree.parent[40:] = 3
    w = np.sort(tree_modes(tree).frequency)
    np.testing.assert_array_equal(count_below(tree, w * (1 - 1e-13), bound=1), np.arange(1, 60))
    np.testing.assert_array_equal(count_below(tree, w * (1 + 1e-13), bound=-1), np.arange(2, 61))
    assert exact_count(tree, w[30] * (1 - 1e-13)) == 31
