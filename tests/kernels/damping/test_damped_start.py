"""All roots of small damped trains: right, and right in number."""

import numpy as np
import pytest

from torsion.kernels.modes.damped_tree_modes import (
    DampedTree,
    number_of_roots,
    polish_together,
    rough_roots,
)
from torsion.kernels.trees.tree import Tree


def roots_of(parent, flexibility, inertia, held=(), ground=None, viscous=None):
    """All roots but 0, and how often 0 is one and how many others there are."""
    fixed = np.zeros(len(parent), dtype=bool)
    fixed[list(held)] = True
    tree = Tree(
        np.array(parent), np.array(flexibility, dtype=float), np.array(inertia, dtype=float), fixed
    )
    none = np.zeros(len(parent))
    damping = (
        none if values is None else np.array(values, dtype=float) for values in (ground, viscous)
    )
    train = DampedTree(tree, *damping, none)
    zeros, number = number_of_roots(train)
    roots = polish_together(train, rough_roots(train, number), zeros)
    return np.sort_complex(roots), (zeros, number)


def test_a_massless_station_held_back_by_a_damper_has_its_own_root():
    roots, number = roots_of([-1, 0], [0, 1 / 50], [2, 0], ground=[0, 3])
    np.testing.assert_allclose(roots, [-15, -5 / 3], rtol=1e-13)
    assert number == (1, 2)


def test_massless_stations_that_a_damper_joins_move_by_the_balance_of_torques():
    roots, number = (
        roots_of(  # two discs; between them spring, damped spring of two massless ends, spring
            [-1, 0, 1, 2], [0, 0.01, 0.02, 0.01], [2, 0, 0, 3], viscous=[0, 0, 4.0, 0]
        )
    )
    assert number == (2, 3)
    k, c = 50.0, 4.0  # T = hc (1/2 + 1/3)^-1 s^2 .. : 0.02 + 1/(k + c s) = -(5/6)/s^2
    exact = np.roots([0.02 * c, 0.02 * k + 1, c * 5 / 6, k * 5 / 6])
    # Two real parts are equal but for rounding, by which they are not to be sorted.
    roots, exact = (values[np.argsort(values.imag)] for values in (roots, exact))
    np.testing.assert_allclose(roots, exact, rtol=1e-12)


def test_a_damper_alone_leaves_every_part_free_to_stand_anywhere():
    roots, number = roots_of([-1, 0], [0, np.inf], [2, 3], viscous=[0, 6.0])
    np.testing.assert_allclose(roots, [-5], atol=1e-14)
    assert number == (3, 1)


def test_rigid_spans_add_their_inertia():
    roots, _ = roots_of([-1, 0, 1], [0, 1 / 100, 0], [0, 1, 3], held=[0])
    np.testing.assert_allclose(roots, [-5j, 5j], atol=1e-14)


def test_a_part_without_inertia_or_support_is_refused():
    with pytest.raises(ValueError, match="neither inertia nor a support"):
        roots_of([-1, 0], [0, 1.0], [0, 0])


def test_a_disc_between_two_held_ends_can_lock_one_torque_in():
    roots, number = roots_of([-1, 0, 1], [0, 1 / 60, 1 / 40], [0, 4, 0], held=[0, 2])
    np.testing.assert_allclose(roots, [-5j, 5j], atol=1e-14)
    assert number == (0, 2)


def test_a_massless_end_of_a_damped_span_creeps_with_the_time_constant_of_that_span():
    roots, number = roots_of([-1, 0], [0, 1 / 50], [2, 0], viscous=[0, 3])
    np.testing.assert_allclose(roots, [-50 / 3], atol=1e-13)
    assert number == (2, 1)
