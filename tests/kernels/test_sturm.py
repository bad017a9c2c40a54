"""Sturm counts against closed forms and against the same counts in many digits."""

from dataclasses import replace

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.modes.natural_modes import count_below
from torsion.kernels.trees.tree import Tree


def _tree(parent, flexibility, inertia, held=()):
    stations = np.arange(len(parent))
    return Tree(
        np.array(parent),
        np.array(flexibility, float),
        np.array(inertia, float),
        np.isin(stations, held),
    )


@pytest.mark.parametrize("size", [1, 2, 5, 30])
def test_count_of_a_uniform_free_chain_steps_at_2_sin(chain, size):
    frequency = 2 * np.sin(np.arange(size) * np.pi / (2 * size))
    tree = chain([1.0] * size, [1.0] * (size - 1))
    between = np.append(frequency[1:] * (1 - 1e-12), 100.0)
    np.testing.assert_array_equal(count_below(tree, between), np.arange(1, size + 1))
    np.testing.assert_array_equal(
        count_below(tree, frequency[1:] * (1 + 1e-12)), np.arange(2, size + 1)
    )


@pytest.mark.parametrize("shape", ["chain", "branched", "bushy"])
@pytest.mark.parametrize("held", ["none", "root", "leaves"])
@pytest.mark.parametrize("size", [6, 40])
def test_bounds_enclose_the_exact_count_even_beside_a_frequency(
    random_tree, exact_count, shape, held, size
):
    tree = random_tree(11, size=size, shape=shape, held=held)
    rng = np.random.default_rng(1)
    w = 10 ** rng.uniform(-4, 9, 12)
    for _ in range(60):  # close in on a step of the count until neighbouring doubles
        middle = np.sqrt(w[:-1] * w[1:])
        step = np.flatnonzero(np.diff(count_below(tree, w)))
        if len(step) == 0:
            break
        pick = step[0]
        w = np.sort(np.concatenate([w[pick : pick + 2], middle[pick : pick + 1]]))
    exact = np.array([exact_count(tree, x) for x in w])
    assert np.all(count_below(tree, w, bound=-1) <= exact)
    assert np.all(count_below(tree, w, bound=1) >= exact)
    assert np.all(np.abs(count_below(tree, w) - exact) <= 1)


@pytest.mark.parametrize("bound", [-1, 0, 1])
def test_a_bound_differs_from_the_count_only_within_rounding_of_a_frequency(
    random_tree, exact_count, bound
):
    tree = random_tree(5, size=12)
    w = 10 ** np.random.default_rng(2).uniform(-4, 9, 40)
    np.testing.assert_array_equal(
        count_below(tree, w, bound=bound), [exact_count(tree, x) for x in w]
    )


def test_bounds_may_differ_from_one_frequency_to_the_next(random_tree):
    tree = random_tree(6, size=10)
    w = np.array([1.0, 1e3, 1e6])
    mixed = count_below(tree, w, bound=[1, -1, 0])
    single = [count_below(tree, x, bound=b)[0] for x, b in zip(w, (1, -1, 0), strict=True)]
    np.testing.assert_array_equal(mixed, single)


def test_wide_and_long_trees_are_counted_alike(random_tree, exact_count):
    bushy = random_tree(
        8, size=60, shape="bushy"
    )  # swept by levels; many frequencies at once by stations
    w = 10 ** np.random.default_rng(3).uniform(-3, 8, 400)
    at_once = count_below(bushy, w)
    np.testing.assert_array_equal(at_once[:100], count_below(bushy, w[:100]))
    np.testing.assert_array_equal(at_once[:20], [exact_count(bushy, x) for x in w[:20]])
    np.testing.assert_array_equal(
        count_below(bushy, w[:100], bound=1), count_below(bushy, w, bound=1)[:100]
    )


@pytest.mark.parametrize(
    ("tree", "rigid", "modes"),
    [
        (_tree([-1], [0], [2.0]), 1, 1),
        (_tree([-1], [0], [0.0]), 0, 0),
        (_tree([-1], [0], [2.0], held=[0]), 0, 0),
        (_tree([-1, 0], [0, 0], [2.0, 1.0]), 1, 1),
        (_tree([-1, 0], [0, 0], [2.0, 1.0], held=[1]), 0, 0),
        (_tree([-1, 0, 0], [0, 0, 0], [2.0, 1.0, 1.0], held=[1, 2]), 0, 0),
        (_tree([-1, 0, 1], [0, 1e-3, 0], [0.0, 1.0, 0.0]), 1, 1),
        (_tree([-1, 0, 1, 2], [0, 1e-3, 1e-3, 1e-3], [1.0, 0.0, 0.0, 1.0]), 1, 2),
        (_tree([-1, 0, 0, 0], [0, 1e-3, 1e-3, 1e-3], [0.0, 1.0, 1.0, 1.0]), 1, 3),
        (_tree([-1, 0, -1, 2], [0, 1e-3, 0, 1e-3], [1.0, 1.0, 1.0, 1.0]), 2, 4),
        (_tree([-1, 0, 1], [0, 1e-3, 1e-3], [7.0, 1.0, 7.0], held=[0, 2]), 0, 1),
    ],
)
def test_rigid_massless_and_held_parts_count_as_the_graph_says(tree, rigid, modes):
    for bound in (-1, 0, 1):
        np.testing.assert_array_equal(count_below(tree, [1e-40, 1e40], bound=bound), [rigid, modes])


def test_a_span_to_a_held_leaf_is_a_spring_to_ground():
    tree = _tree([-1, 0], [0, 0.25], [1.0, 9.0], held=[1])
    np.testing.assert_array_equal(
        count_below(tree, [2.0 * (1 - 1e-14), 2.0, 2.0 * (1 + 1e-14)]), [0, 0, 1]
    )


def test_numbering_from_another_root_does_not_change_a_count(chain):
    inertia, stiffness = [1.0, 5.0, 2.0, 7.0, 3.0], [10.0, 1e4, 3.0, 8.0]
    forward, backward = chain(inertia, stiffness), chain(inertia[::-1], stiffness[::-1])
    w = np.linspace(0.01, 200.0, 300)
    np.testing.assert_array_equal(count_below(forward, w), count_below(backward, w))


def test_a_held_station_inside_a_train_cuts_it(chain):
    whole = replace(chain([1.0, 2.0, 3.0], [5.0, 7.0]), held=np.array([False, True, False]))
    both = [(5.0 / 1.0) ** 0.5, (7.0 / 3.0) ** 0.5]
    np.testing.assert_array_equal(
        count_below(whole, [1.0, 2.0, 3.0]), [sum(f < w for f in both) for w in (1, 2, 3)]
    )


def _chain_rerooted(stations: int, root: int) -> Tree:
    """Equal discs and springs of 1, from `root` both ways."""
    order = sorted(range(stations), key=lambda i: (abs(i - root), i))
    place = {station: number for number, station in enumerate(order)}
    parent = [place[i + (i < root) - (i > root)] if i != root else -1 for i in order]
    return Tree(np.array(parent), np.ones(stations), np.ones(stations), np.zeros(stations, bool))


@pytest.mark.parametrize(
    ("stations", "root"), [(256, 0), (256, 128), (16, 8)], ids=["chain", "two arms", "few stations"]
)
def test_a_bound_never_errs_next_to_a_frequency(stations: int, root: int) -> None:
    """The exact ones are 2 sin(j pi/2n); a low mode of many stations feels the stiffness passed on the most."""
    tree = _chain_rerooted(stations, root)
    with mp.workdps(40):
        exact = [2 * mp.sin(j * mp.pi / (2 * stations)) for j in range(1, 6)]
        near = np.array([[float(w) * (1.0 + k * 2.0**-52) for k in range(-6, 7)] for w in exact])
        below = np.array(
            [[1 + sum(w < mp.mpf(x) for w in exact) for x in row] for row in near.tolist()]
        )
    assert np.all(count_below(tree, near.ravel(), bound=1).reshape(below.shape) >= below)
    assert np.all(count_below(tree, near.ravel(), bound=-1).reshape(below.shape) <= below)
