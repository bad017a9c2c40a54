"""The dense way of finite elements in any tree, its decomposition, scaled elements, and a start for counts."""

from dataclasses import replace

import numpy as np
import pytest

from torsion.kernels.distributed.finite_elements import (
    CondensedElements,
    condensed_elements,
    dense_modes,
    static_bends,
)
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.modes.mode_shapes import TreeModes
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree, rigidity


def _modes(tree: Tree, shafts: Shafts, count: int) -> TreeModes:
    return tree_modes(replace(tree, shafts=shafts), count)


def _part(modes: TreeModes, name: str) -> np.ndarray:
    return getattr(modes if hasattr(modes, name) else modes.shafts, name)


def _random_train(random_tree, trains, seed: int, held: str) -> tuple[Tree, Shafts]:
    """Elements of degree 5, springs, rigid spans and massless stations in a branched tree."""
    rng = np.random.default_rng(seed)
    plain = random_tree(seed, size=12, held=held)
    inertia = np.where(rng.random(12) < 0.4, 0.0, rng.uniform(0.1, 5.0, 12))
    kind = rng.integers(0, 4, 12)
    node = np.array([i for i in range(1, 12) if kind[i] > 1])
    flexibility = np.where((kind == 0) & ~plain.held, 0.0, 10.0 ** rng.uniform(-2, 1, 12))
    flexibility[node] = 0.0
    unit = condensed_elements(
        *(part[None] for part in trains.element(5, 1.0, np.exp, np.ones_like))
    )
    law = unit.scaled(10.0 ** rng.uniform(0, 2, len(node)), 10.0 ** rng.uniform(-1, 0, len(node)))
    return Tree(plain.parent, flexibility, inertia, plain.held), Shafts(node, (law,))


@pytest.mark.parametrize("held", ["none", "root", "leaves"])
@pytest.mark.parametrize("seed", range(6))
def test_in_any_tree_the_dense_way_finds_what_the_counts_find(
    random_tree, trains, seed: int, held: str
) -> None:
    train, bars = _random_train(random_tree, trains, seed, held)
    sure, dense = _modes(train, bars, 3), dense_modes(replace(train, shafts=bars), 3)
    assert sure.certified
    assert np.allclose(dense.frequency, sure.frequency, rtol=2e-14)
    for name in (
        "angle",
        "torque",
        "torque_outer",
        "kinetic",
        "elastic",
        "shaft_kinetic",
        "rigid_angle",
    ):
        one, other = _part(dense, name), _part(sure, name)
        assert np.allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max(initial=0.0)), name


@pytest.mark.parametrize("held", ["none", "root", "leaves"])
def test_angles_of_the_coordinates_leave_rigid_motions_and_held_stations_at_rest(
    random_tree, trains, held
) -> None:
    train, bars = _random_train(random_tree, trains, 3, held)
    whole, element = replace(train, shafts=bars), bars.laws[0]
    spring, root, bend, angle, inside = static_bends(whole, bars, element)
    twist = angle[spring] - angle[train.parent[spring]]
    scale = np.abs(angle).max()
    assert np.allclose(twist, root[:, None] * bend, rtol=0, atol=1e-14 * scale)
    assert np.all(angle[rigidity(whole.static).fixed] == 0.0)
    momentum = whole.static.moving_inertia @ angle
    momentum[inside.reshape(-1)] += element.coupling_turn.reshape(-1)
    if held == "none":
        assert np.abs(momentum).max() < 1e-13 * scale * whole.static.moving_inertia.sum()


@pytest.mark.parametrize("degree", [1, 2, 7])
def test_an_element_scales_with_its_stiffness_and_its_inertia(trains, degree: int) -> None:
    k, m = trains.element(degree, 1.0, np.exp, np.ones_like)
    stiffness, inertia = np.array([3e6, 20.0]), np.array([0.7, 5e3])
    scaled = condensed_elements(k[None], m[None]).scaled(stiffness, inertia)
    plain = condensed_elements(k * stiffness[:, None, None], m * inertia[:, None, None])
    s = 0.3 * np.array([1.0, 0.5]) * (plain.limit if degree > 1 else 1.0) ** 2
    for one, other in zip(scaled.at(s), plain.at(s), strict=True):
        assert np.allclose(one, other, rtol=2e-14)
    together = CondensedElements.joined([scaled, plain])
    assert np.array_equal(together.at(s)[0], np.concatenate([scaled.at(s)[0], plain.at(s)[0]]))


def test_many_equal_elements_have_the_values_of_few(trains) -> None:
    law = trains.elements(6, 80, rigidity=lambda x: 1.0 + np.floor(4 * x)).laws[0]
    s = np.linspace(0.0, 0.5, 40) * law.limit**2
    few = [law.at(s[k : k + 1]) for k in range(0, 40, 13)]
    for k, values in zip(range(0, 40, 13), few, strict=True):
        for one, other in zip(law.at(s), values, strict=True):
            assert np.allclose(one[:, k], other[:, 0], rtol=1e-14)
