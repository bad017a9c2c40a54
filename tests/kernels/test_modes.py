"""Modes of trees against closed forms, published trains and many digits."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.modes.natural_modes import tree_modes
from torsion.kernels.trees.tree import Tree

HERTZ = 2 * np.pi


def _tree(parent, flexibility, inertia, held=()):
    stations = np.arange(len(parent))
    return Tree(
        np.array(parent),
        np.array(flexibility, float),
        np.array(inertia, float),
        np.isin(stations, held),
    )


def _overlap(tree, modes):
    weighted = np.sqrt(tree.moving_inertia)[:, None] * np.column_stack(
        [modes.rigid_angle, modes.angle]
    )
    return weighted.T @ weighted


def _brackets(modes, exact):
    return [
        mp.mpf(low) <= w <= mp.mpf(high)
        for low, w, high in zip(
            modes.lower.tolist(), exact.frequency, modes.upper.tolist(), strict=True
        )
    ]


def _relative(found, exact):
    """Componentwise relative error; what rounds to 0 in 120 digits is 0."""
    smallest = mp.mpf(10) ** -95 * max(abs(e) for e in exact)
    assert all(f == 0.0 for f, e in zip(found.tolist(), exact, strict=True) if abs(e) < smallest)
    errors = [
        abs(mp.mpf(f) / e - 1)
        for f, e in zip(found.tolist(), exact, strict=True)
        if abs(e) >= smallest
    ]
    return float(max(errors, default=0))


PUBLISHED = {  # inertia kg m2, stiffness N m/rad, frequencies in Hz to the digits given
    "B1 two discs": ([211.4, 8.3], [9.775e6], [176.076747]),
    "B2 Friswell 9.7.1": (
        [3.5e-3, 3.5e-3, 3.5e-3, 0.15, 0.05],
        [12e3, 12e3, 14e3, 10e3],
        [81.207629, 141.214071, 378.952954, 536.363283],
    ),
    "B6 wind turbine": (
        [1e7, 5770, 97030],
        [3.67e8, 5.496e9],
        [58.3401619 / HERTZ, 1034.11472 / HERTZ],
    ),
    "B10 six-cylinder diesel": (
        [0.0170, 0.0090, 0.0467, 0.0327, 0.0467, 0.0467, 0.0327, 0.0487, 2.0750],
        [1.106e6, 1.631e6, 1.253e6, 1.253e6, 1.678e6, 1.253e6, 1.253e6, 1.976e6],
        [216.5836, 592.7405, 984.9230, 1171.017, 1415.995, 1660.044, 1794.388, 2993.474],
    ),
    "B12 motorcycle crank": (
        [1.99e-5, 1.6958e-3, 2.1595e-3, 1.8157e-3, 1.2602e-3, 1.54e-5],
        [k * 180 / np.pi for k in (3014, 2562, 2430, 2636, 2562)],
        [1168.90761, 2084.56541, 2618.70295, 14913.6919, 15634.4075],
    ),
    "B15a": ([1, 2, 3], [1, 2], [8.91381197 / 60, 14.4675267 / 60]),
    "B16 Rao": ([8, 6, 4], [4e6, 2e6], [500 * 2**0.5 / HERTZ, 500 * 6**0.5 / HERTZ]),
}


@pytest.mark.parametrize("case", PUBLISHED)
def test_published_chains(chain, case):
    inertia, stiffness, hertz = PUBLISHED[case]
    modes = tree_modes(chain(inertia, stiffness))
    np.testing.assert_allclose(modes.frequency / HERTZ, hertz, rtol=1e-6 if "B10" in case else 1e-8)


def test_ferry_train_with_rigid_spans_b9(chain):
    inertia = [3.1600, 0.3050, 1.2511, 0.0609, 0.0527, 0.0180, 0.0180, 0.0273, 0.0438, 0.6593]
    soft = [5128.2051, 277777.7778, 7352.9412, 0, 1142.8571, 0, 0, 23596.0359, 621118.0124]
    tree = _tree(range(-1, 9), 1e-10 * np.array([0, *soft]), inertia)
    published = [21.4181, 35.6279, 383.4036, 424.6482, 619.7428, 2382.44]
    np.testing.assert_allclose(tree_modes(tree).frequency / HERTZ, published, rtol=3e-6)


@pytest.mark.parametrize("size", [2, 3, 10, 41])
def test_uniform_free_chain_is_exact_in_frequency_and_shape(chain, size):
    mode, station = np.arange(1, size), np.arange(size)[:, None]
    modes = tree_modes(chain([1.0] * size, [1.0] * (size - 1)))
    np.testing.assert_allclose(modes.frequency, 2 * np.sin(mode * np.pi / (2 * size)), rtol=1e-15)
    shape = np.cos(mode * np.pi * (station + 0.5) / size) * np.sqrt(2 / size)
    sign = np.sign(np.sum(shape * modes.angle, axis=0))
    np.testing.assert_allclose(modes.angle, sign * shape, atol=2e-13)
    np.testing.assert_allclose(modes.torque[1:], -np.diff(sign * shape, axis=0), atol=2e-13)


@pytest.mark.parametrize("held", [(0,), (12,), (0, 12)])
def test_uniform_held_chain_is_exact(chain, held):
    modes = tree_modes(chain([1.0] * 13, [1.0] * 12, held))
    quarter_waves = 2 * np.arange(12) + 1 if len(held) == 1 else 2 * np.arange(1, 12)
    length = 2 * 25 if len(held) == 1 else 2 * 24
    np.testing.assert_allclose(
        modes.frequency, 2 * np.sin(quarter_waves * np.pi / length), rtol=1e-15
    )
    assert modes.rigid == 0
    assert np.all(modes.angle[list(held)] == 0.0)


@pytest.mark.parametrize("shape", ["chain", "branched", "bushy"])
@pytest.mark.parametrize("held", ["none", "root", "leaves"])
@pytest.mark.parametrize("size", [5, 11, 30])
def test_every_frequency_is_right_to_1e_14_and_its_enclosure_holds(
    random_tree, exact_count, shape, held, size
):
    tree = random_tree(100 + size, size=size, shape=shape, held=held)
    modes = tree_modes(tree)
    assert len(modes.frequency) == exact_count(tree, 1e40) - modes.rigid
    for mode, (w, low, high) in enumerate(
        zip(modes.frequency, modes.lower, modes.upper, strict=True), modes.rigid
    ):
        assert exact_count(tree, low) <= mode < exact_count(tree, high)
        assert exact_count(tree, w * (1 - 1e-15)) <= mode < exact_count(tree, w * (1 + 1e-15))
        assert low < w < high < low * (1 + 3e-14)


def _special(name):
    if name == "one very stiff span":
        stiffness = np.array([1e3, 2e3, 1e15, 3e3, 1e3, 5e3])
        return _tree(range(-1, 6), np.append(0, 1 / stiffness), [1, 2, 0.5, 3, 1, 4, 2])
    if name == "nearly massless stations":
        return _tree(
            [-1, 0, 1, 1, 3, 4], [0, 1e-3, 2e-3, 3e-4, 1e-3, 1e-2], [1, 1e-15, 2, 1e-15, 3, 1e-15]
        )
    if name == "massless stations":
        return _tree([-1, 0, 1, 1, 3, 4], [0, 1e-3, 2e-3, 3e-4, 1e-3, 1e-2], [1, 0, 2, 0, 3, 0])
    if name == "massless junction of three":
        return _tree([-1, 0, 0, 0, 3], [0, 1e-3, 2e-3, 3e-4, 1e-3], [0, 1, 2, 0.5, 3])
    if name == "rigid spans":
        return _tree([-1, 0, 1, 1, 3, 4], [0, 0, 2e-3, 0, 1e-3, 0], [1, 4, 2, 0, 3, 0.5])
    if name == "massless, rigid and fixed":
        return _tree(
            [-1, 0, 1, 2, 2, 4, 4],
            [0, 1e-3, 0, 2e-4, 1e-5, 0, 1e-2],
            [3, 0, 2, 1, 0, 5, 0],
            held=[3],
        )
    return _tree(
        [-1, 0, 0, 1, 1, 2, 2], [0, 1, 2, 3, 4, 5, 6], [1, 2, 3, 4, 5, 6, 7], held=[3, 5, 6]
    )


SPECIAL = [
    "one very stiff span",
    "nearly massless stations",
    "massless stations",
    "massless junction of three",
    "rigid spans",
    "massless, rigid and fixed",
    "fixed three times",
]


def _check_against(tree, exact, *, componentwise):
    modes = tree_modes(tree)
    assert all(_brackets(modes, exact))
    for mode, w in enumerate(exact.frequency):
        assert abs(mp.mpf(modes.frequency[mode]) / w - 1) < 1e-15
        sign = mp.sign(
            mp.fsum(
                a * b for a, b in zip(exact.angle[mode], modes.angle[:, mode].tolist(), strict=True)
            )
        )
        assert (
            _relative(modes.angle[:, mode], [sign * a for a in exact.angle[mode]]) < componentwise
        )
        assert (
            _relative(modes.torque[:, mode], [sign * t for t in exact.torque[mode]]) < componentwise
        )


@pytest.mark.parametrize("name", SPECIAL)
def test_special_trains_have_every_angle_and_torque_right_componentwise(exact_modes, name):
    _check_against(_special(name), exact_modes(_special(name)), componentwise=1e-13)


@pytest.mark.parametrize(
    ("shape", "held"), [("chain", "none"), ("branched", "root"), ("bushy", "leaves")]
)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_stiff_trains_have_every_angle_and_torque_right_componentwise(
    random_tree, exact_modes, shape, held, seed
):
    tree = random_tree(seed, size=10, shape=shape, held=held)
    _check_against(tree, exact_modes(tree), componentwise=1e-11)


def test_rigid_motion_is_constant_to_the_last_digit_and_no_elastic_mode(random_tree):
    tree = random_tree(4, size=30)
    modes = tree_modes(tree)
    assert modes.rigid == 1
    assert len(modes.frequency) == 29
    assert modes.frequency[0] > 0.0
    assert np.ptp(modes.rigid_angle) == 0.0
    np.testing.assert_allclose(modes.rigid_angle[0, 0] ** 2 * tree.inertia.sum(), 1.0, rtol=1e-15)


@pytest.mark.parametrize("branches", [3, 4, 6])
@pytest.mark.parametrize("length", [1, 2])
def test_equal_branches_on_a_hub_give_orthogonal_shapes(branches, length):
    parent = [-1] + [0] * branches + list(range(1, branches * (length - 1) + 1))
    tree = _tree(parent, [0] + [1e-3] * (len(parent) - 1), [2.0] + [1.0] * (len(parent) - 1))
    modes = tree_modes(tree)
    np.testing.assert_allclose(_overlap(tree, modes), np.eye(len(parent)), atol=1e-14)
    branch = _tree(range(-1, length), [0] + [1e-3] * length, [1.0] * (length + 1), held=[0])
    for w in tree_modes(branch).frequency:
        assert np.count_nonzero(np.abs(modes.frequency / w - 1) < 1e-14) == branches - 1
    moved = tree.inertia[:, None] * modes.angle * modes.frequency**2 + modes.torque
    np.add.at(moved, tree.parent[1:], -modes.torque[1:])
    np.testing.assert_allclose(moved, 0.0, atol=1e-11)


def test_two_identical_trains_are_told_apart():
    tree = _tree([-1, 0, 1, -1, 3, 4], [0, 1, 2, 0, 1, 2], [1, 2, 3, 1, 2, 3])
    modes = tree_modes(tree)
    assert modes.rigid == 2
    np.testing.assert_allclose(_overlap(tree, modes), np.eye(6), atol=1e-15)
    share = np.sum(tree.inertia[:3, None] * modes.angle[:3] ** 2, axis=0)
    np.testing.assert_allclose(np.sort(share), [0, 0, 1, 1], atol=1e-15)


@pytest.mark.parametrize("difference", [1e-6, 1e-9, 1e-11, 1e-12, 1e-13, 1e-15])
def test_nearly_equal_branches_give_orthogonal_shapes(difference):
    tree = _tree(
        [-1, 0, 0, 0], [0, 1e-3, 1e-3 * (1 + difference), 1e-3 * (1 + 3 * difference)], [2, 1, 1, 1]
    )
    modes = tree_modes(tree)
    np.testing.assert_allclose(_overlap(tree, modes), np.eye(4), atol=1e-13)


@pytest.mark.parametrize("branches", [2, 5])
def test_long_equal_branches_are_orthogonal_above_the_size_for_jacobi(branches):
    parent = [-1] + [0 if i % 20 == 0 else i for i in range(branches * 20)]
    tree = _tree(parent, np.ones(len(parent)), np.ones(len(parent)))
    modes = tree_modes(tree)
    np.testing.assert_allclose(_overlap(tree, modes), np.eye(len(parent)), atol=1e-12)
    assert np.all(modes.upper - modes.lower < 5e-14 * modes.frequency)


def test_lowest_modes_are_those_of_the_whole(random_tree):
    tree = random_tree(9, size=20)
    whole, lowest = tree_modes(tree), tree_modes(tree, 4)
    np.testing.assert_allclose(lowest.frequency, whole.frequency[:4], rtol=1e-15)
    np.testing.assert_allclose(lowest.angle, whole.angle[:, :4], rtol=1e-12)
    assert tree_modes(tree, 99).frequency.shape == (19,)
    assert tree_modes(tree, 0).angle.shape == (20, 0)


def test_renumbering_from_the_other_end_gives_the_same_modes(random_tree, chain):
    tree = random_tree(12, size=12, shape="chain")
    turned = Tree(
        np.arange(-1, 11),
        np.append(0.0, tree.flexibility[:0:-1]),
        tree.inertia[::-1].copy(),
        tree.held[::-1].copy(),
    )
    one, other = tree_modes(tree), tree_modes(turned)
    np.testing.assert_allclose(one.frequency, other.frequency, rtol=1e-15)
    np.testing.assert_allclose(np.abs(one.angle), np.abs(other.angle[::-1]), rtol=1e-11)
    np.testing.assert_allclose(np.abs(one.torque[1:]), np.abs(other.torque[:0:-1]), rtol=1e-11)


def test_reactions_in_rigid_spans_to_ground_balance_the_rest():
    tree = _tree([-1, 0, 1, 2, 2, 4], [0, 1e-3, 0, 1e-3, 0, 1e-4], [2, 1, 1, 1, 3, 0], held=[4])
    modes = tree_modes(tree)
    np.testing.assert_allclose(modes.frequency, [500**0.5, 1000**0.5], rtol=1e-15)
    np.testing.assert_array_equal(modes.angle[[1, 2, 4]], 0.0)
    np.testing.assert_allclose(modes.torque[2], modes.torque[1], rtol=1e-15)
    np.testing.assert_allclose(modes.torque[4], modes.torque[2] - modes.torque[3], rtol=1e-15)


def test_first_of_the_largest_components_is_positive(random_tree):
    modes = tree_modes(random_tree(3, size=15))
    largest = np.argmax(np.abs(modes.angle), axis=0)
    assert np.all(modes.angle[largest, np.arange(len(modes.frequency))] > 0.0)


@pytest.mark.parametrize("missed", [0, 4, 13])
def test_a_start_that_misses_a_mode_is_found_out_and_mended(random_tree, monkeypatch, missed):
    tree = random_tree(23, size=15)
    right = tree_modes(tree)
    start = right.frequency.copy()
    start[missed] = start[missed - 1]
    start.sort()
    monkeypatch.setattr(
        "torsion.kernels.modes.natural_modes.start_frequencies",
        lambda *_: (start.copy(), start * 0.99, start * 1.01),
    )
    mended = tree_modes(tree)
    np.testing.assert_allclose(mended.frequency, right.frequency, rtol=1e-15)
    np.testing.assert_allclose(mended.angle, right.angle, rtol=1e-11)
    np.testing.assert_allclose(mended.torque, right.torque, rtol=1e-11)


def test_bisection_alone_finds_every_frequency(random_tree):
    from torsion.kernels.modes.natural_modes import brackets

    tree = random_tree(21, size=15)
    low, high = brackets(tree, np.arange(1, 15), tolerance=2.0**-52)
    np.testing.assert_allclose((low + high) / 2, tree_modes(tree).frequency, rtol=2e-15)


def test_a_wrong_frequency_is_never_proven(random_tree):
    from torsion.kernels.modes.natural_modes import enclose

    tree = random_tree(22, size=12)
    right = tree_modes(tree).frequency
    wrong = right * (1 + np.where(np.arange(11) % 2, 1e-11, 0.0))
    np.testing.assert_array_equal(enclose(tree, wrong, 1)[2], np.arange(11) % 2 == 0)
