"""Bounds of counts of a train with a distributed shaft: apart by the margins of the square and of the stiffness."""

from dataclasses import replace

import numpy as np

from torsion.kernels.distributed.continuous_shafts import uniform_shafts
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.modes.natural_modes import count_below, margins
from torsion.kernels.trees.tree import Tree

STEP = 2.0**-52


def test_bounds_of_a_count_lean_by_both_margins_to_their_own_side():
    """A heavy and a light disc on a shaft that weighs next to nothing: its one frequency goes with sqrt(stiffness)."""
    tree = Tree(np.array([-1, 0]), np.zeros(2), np.array([1.0, 1e6]), np.zeros(2, dtype=bool))
    tree = replace(
        tree, shafts=Shafts(np.array([1]), (uniform_shafts(np.array([1.0]), 1.0, 1e-12),))
    )
    w = 1.0 + STEP * np.arange(-400, 401)  # rad/s; the frequency is 1 + 5e-7, less 2e-13
    frequency = np.sqrt(1.0 + 1e-6)
    w *= frequency * (1.0 - 1e-12 / 6.0)
    never_less, never_more = (count_below(tree, w, bound=side) for side in (1, -1))
    assert np.all(np.diff(never_less) >= 0)
    assert (never_less[0], never_less[-1], never_more[0], never_more[-1]) == (1, 2, 1, 2)
    apart = STEP * (np.argmax(never_more == 2) - np.argmax(never_less == 2))
    of_square, _, of_stiffness = margins(tree, np.ones(1))
    assert apart >= float(np.ravel(of_square)[0]) + 0.9 * of_stiffness
