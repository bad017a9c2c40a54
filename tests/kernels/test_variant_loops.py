"""Many trains with closed loops side by side: each as one train by itself, and rings in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from torsion.kernels import variant_loops
from torsion.kernels.loops import graph_modes
from torsion.kernels.tree import Tree
from torsion.kernels.variant_loops import looped_variant_modes


@settings(max_examples=30, deadline=None)
@given(
    st.integers(3, 18), st.integers(1, 2), st.booleans(), st.booleans(), st.floats(0.0, 0.6), st.integers(0, 2**32 - 1)
)
def test_random_trains_with_loops_are_those_by_themselves(
    size: int, loops: int, is_stiff: bool, is_held: bool, spread: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    parent, held = np.array([-1, *(int(rng.integers(0, k)) for k in range(1, size))]), np.zeros(size, dtype=bool)
    held[0], wide = is_held, 5.0 if is_stiff else 0.5
    h, j, c = (10.0 ** rng.uniform(-wide, wide, (rows, 1)) for rows in (size, size, loops))
    h, j, c = (middle * np.exp(spread * rng.normal(size=(len(middle), 5))) for middle in (h, j, c))
    ends = tuple(np.array([rng.choice(size, 2, replace=False) for _ in range(loops)]).T)
    tree, count = Tree(parent, np.zeros(size), np.zeros(size), held), min(4, size - 1)
    found = looped_variant_modes(tree, h, j, ends, c, count)
    for k in range(5):
        own = replace(tree, flexibility=h[:, k], inertia=j[:, k])
        alone = graph_modes(own, *ends, c[:, k], count)
        assert found.frequency[:, k] == pytest.approx(alone.frequency, rel=1e-13)
        assert (found.lower[:, k] <= alone.upper).all()  # both enclose the same
        assert (alone.lower <= found.upper[:, k]).all()


def test_counts_say_which_mode_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """A start at another mode is not taken: its train is solved by itself."""
    rng = np.random.default_rng(2)
    tree = Tree(np.arange(-1, 7), np.zeros(8), np.zeros(8), np.zeros(8, dtype=bool))
    h, j, c = (rng.uniform(0.8, 1.2, (rows, 40)) for rows in (8, 8, 1))
    ends = np.array([1]), np.array([6])
    right = looped_variant_modes(tree, h, j, ends, c, 3)
    assert ((right.upper - right.lower) < 1e-10 * right.frequency).all()
    true = variant_loops._settled

    def elsewhere(trains, start, shape):
        return true(trains, 1.9 * start, shape[::-1] ** 3)

    monkeypatch.setattr(variant_loops, "_settled", elsewhere)
    again = looped_variant_modes(tree, h, j, ends, c, 3)
    assert again.alone > right.alone
    assert again.frequency == pytest.approx(right.frequency, rel=1e-14)
    assert (again.lower <= right.frequency).all()
    assert (right.frequency <= again.upper).all()


def test_rings_have_their_pairs_of_equal_frequencies() -> None:
    stiff, size = np.array([0.25, 1.0, 3.0]), 6
    tree = Tree(np.arange(-1, size - 1), np.zeros(size), np.zeros(size), np.zeros(size, dtype=bool))
    h = np.repeat(1 / stiff[None], size, axis=0)
    found = looped_variant_modes(tree, h, np.ones((size, 3)), (np.array([0]), np.array([size - 1])), h[:1], size - 1)
    exact = np.sort(2 * np.sin(np.pi * np.arange(1, size) / size))[:, None] * np.sqrt(stiff)
    assert found.frequency == pytest.approx(exact, rel=4e-15)
    assert (found.lower <= exact).all()
    assert (exact <= found.upper).all()


def test_loops_through_fixed_rigid_and_massless_stations() -> None:
    parent, ones = np.array([-1, 0, 1, 2]), np.ones(20)
    tree = Tree(parent, np.zeros(4), np.zeros(4), np.array([True, False, False, False]))
    k = np.linspace(0.5, 2.0, 20)
    h, j = np.stack([0 * k, 1 / k, 0 * k, ones]), np.stack([ones, ones, k, 0 * k])
    found = looped_variant_modes(tree, h, j, (np.array([0, 1]), np.array([2, 3])), np.stack([ones, 1 / k]), 1)
    assert found.frequency[0] == pytest.approx(np.sqrt((k + 1.0) / (1.0 + k)), rel=4e-15)  # as one body on both springs
    through_ground = looped_variant_modes(tree, h[:, :3], j[:, :3], (np.array([0]), np.array([2])), ones[None, :3], 1)
    assert through_ground.frequency[0] == pytest.approx(np.ones(3), rel=4e-15)
    with pytest.raises(ValueError, match="positive flexibility"):
        looped_variant_modes(tree, h, j, (np.array([0]), np.array([2])), 0.0 * ones[None], 1)
    with pytest.raises(ValueError, match="1 elastic modes, not 2"):
        looped_variant_modes(tree, h, j, (np.array([1]), np.array([3])), ones[None], 2)
