"""Sweeps by layers and from the middle of a tree say the same as the tree as it is given."""

import numpy as np
import pytest

from torsion.kernels.layers import add_children, layers_of, of_the_rest
from torsion.kernels.mode_shapes import shapes_at
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.sturm import count_below, count_bounds
from torsion.kernels.tree import Tree, by_layers

PARENTS = {
    "comb": [-1, 0, 0, 1, 1, 2, 3, 3, 5, 5, 8, 8],
    "two trees": [-1, -1, 0, 1, 1, 2, 2, 2, 4, 7],
    "large families": [-1, *[0] * 7, 1, 1, 1, 1, 1, 3, 3, 12],
    "alone": [-1],
}


@pytest.mark.parametrize("name", PARENTS)
def test_a_layer_adds_its_children_and_gives_each_the_rest(name):
    parent, rng = np.array(PARENTS[name]), np.random.default_rng(7)
    passed = np.append(rng.integers(1, 100, (len(parent), 3)), np.zeros((1, 3)), axis=0)
    base = rng.integers(1, 100, (len(parent), 3)).astype(float)
    total, rest, layers = base.copy(), np.zeros_like(base), layers_of(parent)
    for layer in reversed(layers):
        add_children(layer, passed, total[layer.above])
    for layer in layers:
        if not layer.is_in_line:
            of_the_rest(layer, base[layer.above], passed, rest[layer.stations])
    for station, above in enumerate(parent):
        children = np.flatnonzero(parent == station)
        np.testing.assert_array_equal(total[station], base[station] + passed[children].sum(axis=0))
        brothers = np.flatnonzero((parent == above) & (np.arange(len(parent)) != station))
        if above >= 0 and rest[station].any():
            np.testing.assert_array_equal(rest[station], base[above] + passed[brothers].sum(axis=0))
    assert sum(layer.stations.stop - layer.stations.start for layer in layers) == np.count_nonzero(
        parent >= 0
    )


def test_stations_out_of_order_are_in_no_layers():
    assert layers_of(np.array([-1, 0, 1, 0])) is None
    with pytest.raises(ValueError, match="layer by layer"):
        shapes_at(
            Tree(np.array([-1, 0, 1, 0] + [2] * 20), np.ones(24), np.ones(24), np.zeros(24, bool)),
            np.ones(1),
        )


@pytest.mark.parametrize("held", ["none", "root", "leaves"])
@pytest.mark.parametrize("shape", ["branched", "bushy"])
def test_a_tree_numbered_by_layers_is_the_same_train(random_tree, shape, held):
    tree = random_tree(31, size=25, shape=shape, held=held)
    numbered = by_layers(tree)
    assert numbered.tree.layers is not None
    w = np.geomspace(1e-2, 1e9, 300)
    np.testing.assert_array_equal(count_below(numbered.tree, w), count_below(tree, w))
    np.testing.assert_array_equal(
        numbered.angles(numbered.tree.inertia[:, None])[:, 0], tree.inertia
    )
    np.testing.assert_array_equal(
        np.abs(numbered.torques(numbered.tree.flexibility[:, None])[:, 0]), tree.flexibility
    )


@pytest.mark.parametrize("way", [0, 99])
@pytest.mark.parametrize("shape", ["branched", "bushy"])
def test_sweeps_by_stations_and_by_layers_find_the_same_modes(random_tree, shape, way, monkeypatch):
    tree = random_tree(32, size=14, shape=shape)
    right = tree_modes(tree)
    monkeypatch.setattr("torsion.kernels.tree._STATIONS_WITHOUT_LAYERS", way)
    found = tree_modes(Tree(tree.parent, tree.flexibility, tree.inertia, tree.held))
    np.testing.assert_allclose(found.frequency, right.frequency, rtol=1e-15)
    np.testing.assert_allclose(found.angle, right.angle, rtol=1e-11)
    np.testing.assert_allclose(found.torque, right.torque, rtol=1e-11)


@pytest.mark.parametrize(
    ("shape", "held"), [("branched", "none"), ("branched", "root"), ("bushy", "leaves")]
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_sweeps_by_layers_have_every_angle_and_torque_right_componentwise(
    random_tree, exact_modes, monkeypatch, shape, held, seed
):
    monkeypatch.setattr("torsion.kernels.tree._STATIONS_WITHOUT_LAYERS", 0)
    tree = random_tree(seed, size=10, shape=shape, held=held)
    modes, exact = tree_modes(tree), exact_modes(tree)
    np.testing.assert_allclose(modes.frequency, np.array(exact.frequency, dtype=float), rtol=1e-15)
    angle, torque = (np.array(rows, dtype=float).T for rows in (exact.angle, exact.torque))
    sign = np.sign(np.sum(angle * modes.angle, axis=0))
    np.testing.assert_allclose(modes.angle, sign * angle, rtol=1e-11, atol=1e-90)  # of 120 digits
    np.testing.assert_allclose(modes.torque, sign * torque, rtol=1e-11, atol=1e-90)


SPECIAL = {  # flexibility, inertia, `held`
    "massless": ([0, 1e-3, 2e-3, 3e-4, 1e-3, 1e-2, 1e-3], [1, 0, 2, 0, 3, 0, 0], []),
    "massless root": ([0, 1e-3, 2e-3, 3e-4, 1e-3, 1e-2, 1e-3], [0, 1, 2, 1, 3, 1, 1], []),
    "rigid": ([0, 0, 2e-3, 0, 1e-3, 0, 1e-3], [1, 4, 2, 0, 3, 0.5, 1], []),
    "rigid, massless and fixed": ([0, 1e-3, 0, 2e-4, 1e-5, 0, 1e-2], [3, 0, 2, 1, 0, 5, 0], [3]),
    "fixed thrice": ([0, 1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6, 7], [3, 5, 6]),
    "fixed at the root": ([0, 1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6, 7], [0]),
}


@pytest.mark.parametrize("name", SPECIAL)
@pytest.mark.parametrize("parent", [[-1, 0, 0, 1, 1, 2, 2], [-1, 0, 1, 1, 1, 2, 4]])
def test_special_trains_have_the_same_modes_by_stations_and_by_layers(name, parent, monkeypatch):
    flexibility, inertia, held = SPECIAL[name]
    given = (
        np.array(parent),
        np.array(flexibility, float),
        np.array(inertia, float),
        np.isin(np.arange(7), held),
    )
    right = tree_modes(Tree(*given))
    monkeypatch.setattr("torsion.kernels.tree._STATIONS_WITHOUT_LAYERS", 0)
    found = tree_modes(Tree(*given))
    np.testing.assert_allclose(found.frequency, right.frequency, rtol=1e-15)
    np.testing.assert_allclose(found.angle, right.angle, rtol=1e-12, atol=1e-15)
    np.testing.assert_allclose(found.torque, right.torque, rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("shape", ["branched", "bushy"])
def test_large_families_are_bounded_by_counts(random_tree, exact_count, shape):
    tree = random_tree(33, size=60, shape=shape)
    tree.parent[40:] = 3
    w = np.sort(tree_modes(tree).frequency)
    at_most, at_least = count_bounds(tree, w * (1 - 1e-13), w * (1 + 1e-13))
    np.testing.assert_array_equal(at_most, np.arange(1, 60))
    np.testing.assert_array_equal(at_least, np.arange(2, 61))
    assert exact_count(tree, w[30] * (1 - 1e-13)) == 31
