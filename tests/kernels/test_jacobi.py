"""One decomposition of the factor of a tree gives the same modes as the certified way."""

import numpy as np
import pytest

from torsion.kernels.modes.loops import jacobi_svd, star_mesh_factor
from torsion.kernels.modes.mode_shapes import shape_sign
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import rigidity


@pytest.mark.parametrize("shape", ["chain", "branched", "bushy"])
def test_frequencies_to_rounding_shapes_to_rounding_in_the_norm(random_tree, shape):
    tree = random_tree(31, size=20, shape=shape)
    right, bodies = tree_modes(tree), rigidity(tree)
    factor = star_mesh_factor(tree, bodies)[2][:, : bodies.elastic]
    left, values, _ = jacobi_svd(factor, "U")
    np.testing.assert_allclose(values[::-1], right.frequency, rtol=1e-12)
    root = np.sqrt(tree.inertia)[:, None]
    angle = left[:, ::-1] / root
    assert np.abs(root * (shape_sign(angle) * angle - right.angle)).max() < 1e-11
