"""Many trains side by side: each as one train by itself, closed forms, and the counts that prove them."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsion.kernels.modes.natural_modes import count_below, tree_modes
from torsion.kernels.modes.variant_modes import variant_modes
from torsion.kernels.trees.tree import Tree


def layout(parent: list[int], held: tuple[int, ...] = ()) -> Tree:
    size = len(parent)
    fixed = np.zeros(size, dtype=bool)
    fixed[list(held)] = True
    return Tree(np.array(parent), np.zeros(size), np.zeros(size), fixed)


def one_by_one(
    tree: Tree, h: np.ndarray, j: np.ndarray, count: int, what: str = "frequency"
) -> np.ndarray:
    each = zip(h.T, j.T, strict=True)
    return np.array(
        [getattr(tree_modes(replace(tree, flexibility=a, inertia=b), count), what) for a, b in each]
    ).T


def test_two_discs_of_any_figures_are_their_closed_form() -> None:
    rng = np.random.default_rng(1)
    k, one, other = 10.0 ** rng.uniform(-3, 9, (3, 5000))
    found = variant_modes(layout([-1, 0]), np.stack([0 * k, 1 / k]), np.stack([one, other]), 1)
    exact = np.sqrt(k) * np.sqrt(1 / one + 1 / other)
    assert found.frequency[0] == pytest.approx(exact, rel=4e-15)
    assert (found.lower[0] < exact).all()
    assert (exact < found.upper[0]).all()


@settings(max_examples=30, deadline=None)
@given(
    st.integers(2, 24), st.booleans(), st.booleans(), st.floats(0.0, 1.0), st.integers(0, 2**32 - 1)
)
def test_random_trees_side_by_side_are_those_by_themselves(
    size: int, is_stiff: bool, is_held: bool, spread: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    tree = layout([-1, *(int(rng.integers(0, k)) for k in range(1, size))], (0,) if is_held else ())
    wide = 5.0 if is_stiff else 0.5
    h, j = (10.0 ** rng.uniform(-wide, wide, (size, 1)) for _ in range(2))
    h, j = (middle * np.exp(spread * rng.normal(size=(size, 6))) for middle in (h, j))
    count = min(4, size - 1)
    found, alone = variant_modes(tree, h, j, count), one_by_one(tree, h, j, count)
    assert found.frequency == pytest.approx(alone, rel=1e-13)
    assert (found.lower <= one_by_one(tree, h, j, count, "upper")).all()  # both enclose the same
    assert (one_by_one(tree, h, j, count, "lower") <= found.upper).all()
    assert ((found.upper - found.lower) < 2e-11 * found.upper).all()


def test_modes_that_change_places_are_counted_in_each_train() -> None:
    """A free chain of equal discs tuned so that two modes cross over the trains."""
    stiff = np.geomspace(0.2, 5.0, 401)
    h = np.stack([0 * stiff, np.ones(401), 1e3 * np.ones(401), 1 / stiff])
    found = variant_modes(layout([-1, 0, 1, 2]), h, np.ones((4, 401)), 3)
    assert found.frequency == pytest.approx(
        one_by_one(layout([-1, 0, 1, 2]), h, np.ones((4, 401)), 3), rel=1e-13
    )
    gap = (found.frequency[2] - found.frequency[1]) / found.frequency[1]
    assert gap.min() < 1e-3 < gap.max()


def test_rigid_spans_massless_stations_and_fixed_ones() -> None:
    tree, k = layout([-1, 0, 1, 2, 3], held=(4,)), np.linspace(0.5, 2.0, 50)
    ones, none = np.ones(50), np.zeros(50)
    h, j = np.stack([none, 1 / k, none, ones, ones]), np.stack([ones, 2 * ones, k, none, ones])
    found = variant_modes(tree, h, j, 2)
    assert found.frequency == pytest.approx(one_by_one(tree, h, j, 2), rel=1e-13)
    lean = [
        count_below(replace(tree, flexibility=h, inertia=j), found.lower[1], bound=1),
        (found.lower[1] > 0) * 1,
    ]
    assert (lean[0] == lean[1]).all()


def test_more_trains_than_stand_side_by_side_at_once() -> None:
    rng = np.random.default_rng(3)
    j, h = rng.uniform(0.5, 2.0, (2, 3, 5000))
    found = variant_modes(layout([-1, 0, 1]), h, j, 2)
    some = np.array([0, 2047, 2048, 4999])
    assert found.frequency[:, some] == pytest.approx(
        one_by_one(layout([-1, 0, 1]), h[:, some], j[:, some], 2), rel=1e-14
    )
    assert found.alone == 0


def test_arrays_of_other_shapes_and_too_many_modes_are_refused() -> None:
    with pytest.raises(ValueError, match="3 stations"):
        variant_modes(layout([-1, 0, 1]), np.ones((2, 4)), np.ones((2, 4)), 1)
    with pytest.raises(ValueError, match="2 elastic modes, not 3"):
        variant_modes(layout([-1, 0, 1]), np.ones((3, 4)), np.ones((3, 4)), 3)
