"""Many trains with closed loops or distributed shafts: each as one train by itself, and rings in closed form."""

from dataclasses import replace

import numpy as np
import pytest
from benchmarks.cases import chain
from hypothesis import given, settings
from hypothesis import strategies as st

from torsion.kernels import variant_networks
from torsion.kernels.distributed.span_laws import Shafts
from torsion.kernels.distributed.uniform_shaft import UniformShafts, uniform_shafts
from torsion.kernels.loops import graph_modes
from torsion.kernels.natural_modes import tree_modes
from torsion.kernels.tree import Tree
from torsion.kernels.variant_networks import network_modes


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
    found = network_modes(tree, h, j, count, ends, c)
    for k in range(5):
        own = replace(tree, flexibility=h[:, k], inertia=j[:, k])
        alone = graph_modes(own, *ends, c[:, k], count)
        assert found.frequency[:, k] == pytest.approx(alone.frequency, rel=2e-13)
        assert (found.lower[:, k] <= alone.upper).all()  # both enclose the same
        assert (alone.lower <= found.upper[:, k]).all()


def test_counts_say_which_mode_it_is(monkeypatch: pytest.MonkeyPatch) -> None:
    """A start at another mode is not taken: its train is solved by itself."""
    rng = np.random.default_rng(2)
    tree = Tree(np.arange(-1, 7), np.zeros(8), np.zeros(8), np.zeros(8, dtype=bool))
    h, j, c = (rng.uniform(0.8, 1.2, (rows, 10)) for rows in (8, 8, 1))
    ends = np.array([1]), np.array([6])
    right = network_modes(tree, h, j, 3, ends, c)
    assert right.alone == 0
    true = variant_networks._polished
    monkeypatch.setattr(variant_networks, "_polished", lambda trains, start, way: true(trains, 1.9 * start, way))
    again = network_modes(tree, h, j, 3, ends, c)
    assert again.alone > 0
    assert again.frequency == pytest.approx(right.frequency, rel=1e-14)


def test_frequencies_beside_a_pole_of_what_the_root_sees_settle() -> None:
    """Newton's first steps there double the way; bounds are wide enough to enclose what has not settled."""
    case, rng, size, trains = chain(10, stiff=False), np.random.default_rng(1), 10, 400
    j = np.array(case.inertia)[:, None] * rng.uniform(0.95, 1.05, (size, trains))
    soft = 1.0 / rng.uniform(0.85, 1.15, (size + 1, trains))
    h = np.concatenate([0 * j[:1], soft[1:size] / np.array(case.stiffness)[1:, None]])
    tree = Tree(np.arange(-1, 9), *np.zeros((2, size)), np.zeros(size, dtype=bool))
    ends = np.array([1]), np.array([8])
    c = soft[size:] / min(case.stiffness[1:])
    found = network_modes(tree, h, j, 6, ends, c)
    alone = graph_modes(replace(tree, flexibility=h[:, 23], inertia=j[:, 23]), *ends, c[:, 23], 6)
    assert found.frequency[:, 23] == pytest.approx(alone.frequency, rel=4e-15)


def test_pieces_of_shafts_are_those_by_themselves() -> None:
    rng, pieces, trains = np.random.default_rng(3), 4, 20
    size, node = pieces + 2, np.arange(1, pieces + 1)
    base = uniform_shafts(np.full(pieces, 0.5), np.full(pieces, 80.0), np.full(pieces, 0.02))
    held = np.zeros(size, dtype=bool)
    tree = Tree(np.arange(-1, size - 1), np.zeros(size), np.zeros(size), held, Shafts(node, (base,)))
    h, j = np.zeros((size, trains)), np.zeros((size, trains))
    h[-1], j[0], j[-1] = rng.uniform(0.005, 0.02, trains), rng.uniform(0.5, 1.5, trains), rng.uniform(0.1, 0.3, trains)
    length, across = rng.uniform(0.8, 1.2, (2, trains))
    factors = np.repeat([length / across, length * across, length**2], pieces, axis=0)
    found = network_modes(tree, h, j, 4, factors=factors)
    assert found.alone == 0
    for k in range(trains):
        law = UniformShafts(*np.split(base.figures * factors[:, k], 3))
        own = replace(tree, flexibility=h[:, k], inertia=j[:, k], shafts=Shafts(node, (law,)))
        alone = tree_modes(own, 4)
        assert found.frequency[:, k] == pytest.approx(alone.frequency, rel=4e-15)
        assert (found.lower[:, k] <= alone.upper).all()
        assert (alone.lower <= found.upper[:, k]).all()


def test_loops_through_fixed_rigid_and_massless_stations() -> None:
    parent, ones = np.array([-1, 0, 1, 2]), np.ones(20)
    tree = Tree(parent, np.zeros(4), np.zeros(4), np.array([True, False, False, False]))
    k = np.linspace(0.5, 2.0, 20)
    h, j = np.stack([0 * k, 1 / k, 0 * k, ones]), np.stack([ones, ones, k, 0 * k])
    found = network_modes(tree, h, j, 1, (np.array([0, 1]), np.array([2, 3])), np.stack([ones, 1 / k]))
    assert found.frequency[0] == pytest.approx(np.sqrt((k + 1.0) / (1.0 + k)), rel=4e-15)  # one body on both springs
    with pytest.raises(ValueError, match="positive flexibility"):
        network_modes(tree, h, j, 1, (np.array([0]), np.array([2])), 0.0 * ones[None])
    with pytest.raises(ValueError, match="1 elastic modes, not 2"):
        network_modes(tree, h, j, 2, (np.array([1]), np.array([3])), ones[None])


def test_rings_have_their_pairs_of_equal_frequencies() -> None:
    stiff, size = np.array([0.25, 1.0, 3.0]), 6
    tree = Tree(np.arange(-1, size - 1), np.zeros(size), np.zeros(size), np.zeros(size, dtype=bool))
    h = np.repeat(1 / stiff[None], size, axis=0)
    found = network_modes(tree, h, np.ones((size, 3)), size - 1, (np.array([0]), np.array([size - 1])), h[:1])
    exact = np.sort(2 * np.sin(np.pi * np.arange(1, size) / size))[:, None] * np.sqrt(stiff)
    assert found.frequency == pytest.approx(exact, rel=4e-15)
