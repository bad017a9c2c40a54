"""Finite elements of shafts: chains of linear elements, published meshes, rates of convergence, the dense way."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from torsion.errors import SolveError
from torsion.kernels.distributed.finite_elements import condensed_elements, dense_modes
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.modes.mode_shapes import TreeModes
from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree


def _modes(tree: Tree, shafts: Shafts, count: int) -> TreeModes:
    return tree_modes(replace(tree, shafts=shafts), count)


def _part(modes: TreeModes, name: str) -> np.ndarray:
    return getattr(modes if hasattr(modes, name) else modes.shafts, name)


@pytest.mark.parametrize("number", [3, 20, 100])
def test_linear_elements_of_a_free_shaft_are_the_chain_in_closed_form(trains, number: int) -> None:
    """w^2 = 6 (c/l)^2 (1 - cos a)/(2 + cos a), a = j pi/n: all of them, and no more than there are."""
    modes = _modes(trains.chain(number), trains.elements(1, number), number + 5)
    angles = [mp.pi * j / number for j in range(1, number + 1)]
    exact = [number * mp.sqrt(12 * mp.sin(a / 2) ** 2 / (2 + mp.cos(a))) for a in angles]
    assert trains.off(modes.frequency, exact) < 1e-14
    assert (modes.lower <= exact).all()
    assert (modes.upper >= exact).all()


@pytest.mark.parametrize(
    ("number", "published"),
    [(5, [1.9417, 4.0719, 6.5437, 9.1547]), (50, [1.9106, 3.8232, 5.7394, 7.6613])],
)
def test_a_drill_string_of_linear_elements_has_its_published_frequencies(
    trains, number, published
) -> None:
    """Friswell et al. (2010) chapter 9, Hz."""
    area = np.pi / 32 * (0.78**4 - 0.65**4)
    bars = trains.elements(
        1, number, 800.0, lambda x: 75e9 * area + 0 * x, lambda x: 8000 * area + 0 * x
    )
    modes = _modes(trains.chain(number, {0: 200.0, number: 10.0}), bars, 4)
    assert np.allclose(modes.frequency / (2 * np.pi), published, rtol=0, atol=5.1e-5)


def test_degree_ten_is_exact_to_twelve_digits(trains) -> None:
    modes = _modes(trains.chain(12), trains.elements(10, 12), 10)
    assert trains.off(modes.frequency, [mp.pi * k for k in range(1, 11)]) < 1e-12
    taper = lambda x: (1.0 - 0.5 * x) ** 4  # noqa: E731
    cone = _modes(trains.chain(12), trains.elements(10, 12, rigidity=taper), 10)
    continuum = _modes(trains.chain(12), trains.tapered(taper, 12), 10)
    assert np.allclose(cone.frequency, continuum.frequency, rtol=1e-12)
    assert np.allclose(cone.angle, continuum.angle, rtol=0, atol=1e-9)


MESHES = {1: (48, 96), 2: (16, 32), 3: (10, 20), 4: (8, 14), 5: (5, 8), 6: (4, 6)}


@pytest.mark.parametrize("degree", MESHES)
@pytest.mark.parametrize("taper", [0.0, 0.5])
def test_frequencies_converge_with_twice_the_degree(trains, degree: int, taper: float) -> None:
    """Of the second mode, between meshes on which the error is neither rounding nor coarse."""
    section = lambda x: (1.0 - taper * x) ** 4  # noqa: E731
    exact = _modes(trains.chain(12), trains.tapered(section, 12), 2).frequency[1]
    error = []
    for number in MESHES[degree]:
        found = _modes(trains.chain(number), trains.elements(degree, number, rigidity=section), 2)
        error.append(found.frequency[1] / exact - 1.0)
    coarse, fine = MESHES[degree]
    assert np.log(error[0] / error[1]) / np.log(fine / coarse) == pytest.approx(
        2 * degree, rel=0.05
    )


def test_the_dense_way_finds_what_the_counts_find(trains) -> None:
    train, bars = (
        trains.chain(6, {0: 0.3, 3: 2.0}),
        trains.elements(5, 6, rigidity=lambda x: (1.0 + x) ** 4),
    )
    sure, dense = _modes(train, bars, 4), dense_modes(replace(train, shafts=bars), 4)
    assert sure.certified
    assert not dense.certified
    assert np.allclose(dense.frequency, sure.frequency, rtol=1e-13)
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
        assert np.allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max()), name


def test_the_dense_way_goes_above_the_elements_own_frequencies(trains) -> None:
    """One element of degree 10 along a free shaft: what bar_modes refuses, and all the modes there are."""
    train, bars = trains.chain(1), trains.elements(10, 1)
    with pytest.raises(SolveError, match="more finely"):
        _modes(train, bars, 3)
    modes = dense_modes(replace(train, shafts=bars), 99)
    assert len(modes.frequency) == 10
    assert np.allclose(modes.frequency[:4], np.pi * np.arange(1, 5), rtol=2e-5)
    assert modes.frequency[0] == pytest.approx(np.pi, rel=1e-13)
    assert np.all(np.diff(modes.frequency) > 0)
    assert np.allclose(modes.shafts.kinetic.sum(axis=0), 1.0, rtol=1e-12)
    assert np.allclose(modes.shafts.elastic.sum(axis=0), 1.0, rtol=1e-12)


def test_the_dense_way_takes_rigid_spans_massless_and_held_stations(trains) -> None:
    """0 fixed, 1 rigidly on it; 3 rigidly on 2; a massless station between a shaft and a spring to a disc."""
    parent, flexibility = np.arange(-1, 6), np.array([0, 0, 0, 0, 0, 0.7, 0])
    inertia = np.array([0, 0, 0, 0.2, 0, 1.5, 0.1])
    node = np.array([2, 4])
    train = Tree(parent, flexibility, inertia, np.arange(7) == 0)
    law = condensed_elements(
        *(np.stack([part] * 2) for part in trains.element(6, 0.5, np.ones_like, np.ones_like))
    )
    sure, dense = (
        _modes(train, Shafts(node, (law,)), 3),
        dense_modes(replace(train, shafts=Shafts(node, (law,))), 3),
    )
    assert np.allclose(dense.frequency, sure.frequency, rtol=1e-13)
    for name in ("angle", "torque", "torque_outer"):
        one, other = _part(dense, name), _part(sure, name)
        assert np.allclose(one, other, rtol=0, atol=1e-11 * np.abs(other).max()), name


def test_the_dense_way_is_for_elements(trains) -> None:
    with pytest.raises(ValueError, match="one law of elements"):
        dense_modes(replace(trains.chain(2), shafts=trains.pieces(1.0, 1.0, 1.0, 2)), 1)
