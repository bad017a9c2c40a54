"""One decomposition gives the same modes as the certified way."""

import numpy as np
import pytest

from torsion.kernels.factors import plain_modes
from torsion.kernels.mode_shapes import shape_sign
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.tree import Tree


@pytest.mark.parametrize("capsule", [True, False])
@pytest.mark.parametrize("shape", ["chain", "branched", "bushy"])
def test_frequencies_to_rounding_shapes_to_rounding_in_the_norm(random_tree, monkeypatch, shape, capsule):
    if not capsule:
        monkeypatch.setattr("torsion.kernels.lapack.routine", lambda *_: None)
    tree = random_tree(31, size=20, shape=shape)
    right, found = tree_modes(tree), plain_modes(tree)
    np.testing.assert_allclose(found.frequency, right.frequency, rtol=1e-14 if capsule else 1e-12)
    sign = shape_sign(right.angle) * np.sign(np.sum(right.angle * found.angle * tree.inertia[:, None], axis=0))
    root = np.sqrt(tree.inertia)[:, None]
    assert np.abs(root * (sign * found.angle - right.angle * shape_sign(right.angle))).max() < 1e-11
    torque = sign * found.torque - right.torque * shape_sign(right.angle)
    assert (np.abs(torque).max(axis=0) / np.abs(right.torque).max(axis=0)).max() < 1e-11


def test_equal_branches_give_orthogonal_shapes():
    tree = Tree(np.array([-1, 0, 0, 0]), np.array([0, 1e-3, 1e-3, 1e-3]), np.array([2.0, 1, 1, 1]), np.zeros(4, bool))
    found = plain_modes(tree)
    np.testing.assert_allclose(found.angle.T @ (tree.inertia[:, None] * found.angle), np.eye(3), atol=1e-14)


def test_other_trees_are_refused():
    with pytest.raises(ValueError, match="rigid spans"):
        plain_modes(Tree(np.array([-1, 0]), np.array([0.0, 0.0]), np.array([1.0, 1.0]), np.zeros(2, bool)))
