"""The way over the stations of trains with very many of them."""

import numpy as np
import pytest

from torsion.kernels.trees.tree import connected, walk


@pytest.mark.parametrize("number", [300, 5000])
def test_every_part_is_walked_from_its_held_or_its_first_station_and_each_station_after_its_parent(
    number,
):
    random = np.random.default_rng(number)
    parts = 7
    inner = np.array(
        [-1] * parts + [int(random.integers(max(0, k - 40), k)) for k in range(parts, number)]
    )
    name = random.permutation(number)  # of the station that stands at each place
    far = np.arange(parts, number)
    ends = np.column_stack([name[inner[far]], name[far]])
    flip = random.random(len(far)) < 0.5
    ends[flip] = ends[flip, ::-1]
    held = sorted(int(name[k]) for k in (2, 5))
    found = walk(number, ends[:, 0], ends[:, 1], np.ones(len(far), dtype=bool), held)
    group = connected(number, ends[:, 0], ends[:, 1])
    roots = {
        next((h for h in held if group[h] == one), int(np.flatnonzero(group == one)[0]))
        for one in set(group)
    }
    assert sorted(found.order.tolist()) == list(range(number))
    assert set(np.flatnonzero(found.parent < 0).tolist()) == roots
    met = np.empty(number, dtype=int)
    met[found.order] = np.arange(number)
    reached = np.flatnonzero(found.parent >= 0)
    assert (met[found.parent[reached]] < met[reached]).all()
    assert (found.above[list(roots)] == -1).all()
    both = np.sort(ends[found.above[reached]], axis=1)
    np.testing.assert_array_equal(
        both, np.sort(np.column_stack([reached, found.parent[reached]]), axis=1)
    )


def test_spans_that_are_not_chosen_are_not_walked():
    number = 4001
    ends, chosen = np.arange(number - 1), np.ones(number - 1, dtype=bool)
    chosen[100] = False
    found = walk(number, ends, ends + 1, chosen, [])
    assert np.flatnonzero(found.parent < 0).tolist() == [0, 101]
