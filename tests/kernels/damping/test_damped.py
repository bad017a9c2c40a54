"""Damped modes of trees against closed forms, laws and many digits."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.modes.damped_tree_modes import damped_modes
from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import tree_response

DIGITS = 100


def tree(parent, flexibility, inertia, held=()):
    fixed = np.zeros(len(parent), dtype=bool)
    fixed[list(held)] = True
    return Tree(
        np.array(parent), np.array(flexibility, dtype=float), np.array(inertia, dtype=float), fixed
    )


def sizes(name, count, **places):
    """Damping arrays of one name: zero but at the given places, `at2=5.0`."""
    values = np.zeros(count)
    for place, value in places.items():
        values[int(place[2:])] = value
    return {name: values}


ONE_DISC = tree([-1, 0], [0, 1 / 100], [0, 4], held=[0])  # 5 rad/s


@pytest.mark.parametrize("zeta", [0, 1e-14, 1e-8, 1e-3, 0.02, 0.3, 0.7, 0.999])
@pytest.mark.parametrize("name", ["ground_damping", "viscous"])
def test_one_disc_has_exactly_its_damping_ratio(zeta, name):
    modes = damped_modes(ONE_DISC, **sizes(name, 2, at1=2 * zeta * 5 * 4))
    np.testing.assert_allclose(np.abs(modes.eigenvalue), [5], rtol=1e-13)
    np.testing.assert_allclose(
        -modes.eigenvalue.real / np.abs(modes.eigenvalue), [zeta], rtol=1e-13
    )
    np.testing.assert_allclose(modes.angle[:, 0], [0, 1], rtol=1e-15)
    stiffness = 100 + modes.eigenvalue * (2 * zeta * 5 * 4 if name == "viscous" else 0)
    np.testing.assert_allclose(modes.torque[1], -stiffness, rtol=1e-13)
    assert modes.real_root.size == 0


def test_an_overdamped_disc_has_two_real_roots_and_no_frequency():
    modes = damped_modes(ONE_DISC, **sizes("viscous", 2, at1=2 * 2 * 5 * 4))
    assert modes.eigenvalue.size == 0
    assert modes.angle.shape == (2, 0)
    np.testing.assert_allclose(
        modes.real_root, [-10 + 5 * np.sqrt(3), -10 - 5 * np.sqrt(3)], rtol=1e-14
    )


def test_a_critically_damped_disc_has_a_double_real_root():
    modes = damped_modes(ONE_DISC, **sizes("viscous", 2, at1=2 * 5 * 4))
    assert modes.eigenvalue.size == 0
    np.testing.assert_allclose(
        modes.real_root, [-5, -5], rtol=1e-7
    )  # a double root is good to the root of eps


@pytest.mark.parametrize("loss", [1e-10, 0.03, 0.3, 1.0])
def test_loss_factor_turns_the_square_of_the_root(loss):
    modes = damped_modes(ONE_DISC, **sizes("loss_factor", 2, at1=loss))
    exact = 5j * np.sqrt(1 + 1j * loss)
    np.testing.assert_allclose(modes.eigenvalue, [exact], rtol=1e-14)
    np.testing.assert_allclose(
        modes.eigenvalue.real, -5 * np.sin(np.arctan(loss) / 2) * (1 + loss**2) ** 0.25, rtol=1e-13
    )


def test_a_free_train_lists_neither_its_zero_roots_nor_its_slow_decay_as_frequencies():
    pair = tree([-1, 0], [0, 1 / 120], [2, 3])
    undamped = damped_modes(pair)
    np.testing.assert_array_equal(undamped.eigenvalue.real, 0)
    np.testing.assert_allclose(undamped.eigenvalue.imag, [10], rtol=1e-15)
    np.testing.assert_allclose(undamped.angle[:, 0], [1, -2 / 3], rtol=1e-14)
    assert undamped.real_root.size == 0
    slow = damped_modes(pair, **sizes("ground_damping", 2, at0=1e-9))
    assert slow.eigenvalue.size == 1
    np.testing.assert_allclose(slow.real_root, [-1e-9 / 5], rtol=1e-13)


def test_an_overdamped_coupling_keeps_its_real_roots_out_of_the_frequencies():
    train = tree([-1, 0, 1, 2], [0, 1 / 1e6, 1 / 2e3, 1 / 1e6], [1, 2, 2, 1])
    modes = damped_modes(train, **sizes("viscous", 4, at2=1e6))
    assert modes.eigenvalue.size == 2
    assert modes.real_root.size == 2
    assert (modes.real_root < 0).all()
    assert_roots_of(train, modes, np.zeros(4), np.array([0, 0, 1e6, 0]), np.zeros(4))


def test_three_equal_branches_give_both_copies_with_independent_balanced_shapes():
    train = tree([-1, 0, 0, 0], [0, 0.01, 0.01, 0.01], [5, 1, 1, 1])
    modes = damped_modes(train, viscous=np.array([0, 0.5, 0.5, 0.5]))
    np.testing.assert_allclose(modes.eigenvalue[:2], -0.25 + 1j * np.sqrt(100 - 0.0625), rtol=1e-14)
    np.testing.assert_allclose(modes.torque[1:, :2].sum(axis=0), 0, atol=1e-11)
    np.testing.assert_allclose(modes.angle[0, :2], 0, atol=1e-13)
    product = modes.angle[:, 0].conj() @ (train.inertia * modes.angle[:, 1])
    assert abs(product) < 1e-12


def test_equal_branches_with_unequal_loss_factors_part():
    train = tree([-1, 0, 0, 0], [0, 0.01, 0.01, 0.01], [5, 1, 1, 1])
    modes = damped_modes(train, loss_factor=np.array([0, 0.1, 0.3, 0.1]))
    assert modes.eigenvalue.size == 3
    assert_equations_hold(train, modes, np.zeros(4), np.zeros(4), np.array([0, 0.1, 0.3, 0.1]))
    np.testing.assert_allclose(modes.eigenvalue[0], 10j * np.sqrt(1 + 0.1j), rtol=1e-14)


def test_a_train_of_two_equal_parts_lists_every_mode_twice():
    train = tree([-1, 0, -1, 2], [0, 1 / 120, 0, 1 / 120], [2, 3, 2, 3])
    modes = damped_modes(train, viscous=np.array([0, 1.0, 0, 1.0]))
    exact = 0.5 * (-5 / 6 + 1j * np.sqrt(400 - 25 / 36))
    np.testing.assert_allclose(modes.eigenvalue, [exact, exact], rtol=1e-14)
    assert np.linalg.matrix_rank(modes.angle) == 2


def test_rigid_spans_and_massless_stations_give_the_roots_of_the_reduced_train():
    full = tree([-1, 0, 1, 2, 3], [0, 0.004, 0.006, 0, 0.01], [2, 0, 1, 3, 0])
    modes = damped_modes(full, **sizes("ground_damping", 5, at3=0.7))
    reduced = damped_modes(tree([-1, 0], [0, 0.01], [2, 4]), **sizes("ground_damping", 2, at1=0.7))
    np.testing.assert_allclose(modes.eigenvalue, reduced.eigenvalue, rtol=1e-14)
    np.testing.assert_allclose(modes.real_root, reduced.real_root, rtol=1e-13)
    np.testing.assert_allclose(modes.angle[[0, 2]], reduced.angle, rtol=1e-13)
    np.testing.assert_allclose(modes.torque[[1, 2]], reduced.torque[[1, 1]], rtol=1e-13)


def test_a_massless_station_between_spring_and_damper_adds_one_real_root():
    k, c, J = 50.0, 3.0, 2.0  # Maxwell element: disc, spring, massless station, damper to ground
    modes = damped_modes(tree([-1, 0], [0, 1 / k], [J, 0]), **sizes("ground_damping", 2, at1=c))
    assert modes.eigenvalue.size == 0
    np.testing.assert_allclose(
        modes.real_root, [-5 / 3, -15], rtol=1e-14
    )  # J c s^2 + J k s + k c = 0


def test_springs_and_dampers_to_held_leaves_add_to_those_of_a_held_root():
    train = tree([-1, 0, 1], [0, 1 / 60, 1 / 40], [0, 4, 0], held=[0, 2])
    modes = damped_modes(train, viscous=np.array([0, 1.5, 0.5]))
    np.testing.assert_allclose(modes.eigenvalue, [-0.25 + 1j * np.sqrt(25 - 0.0625)], rtol=1e-14)
    root = modes.eigenvalue[0]
    np.testing.assert_allclose(
        modes.torque[1:, 0], [-(60 + 1.5 * root), 40 + 0.5 * root], rtol=1e-14
    )


def test_motion_behind_a_rigid_span_to_a_held_root_is_that_of_the_held_station():
    train = tree([-1, 0, 1], [0, 0, 1 / 100], [0, 7, 4], held=[0])
    modes = damped_modes(train, **sizes("viscous", 3, at2=2.0))
    np.testing.assert_allclose(modes.eigenvalue, [-0.25 + 1j * np.sqrt(25 - 0.0625)], rtol=1e-14)
    np.testing.assert_allclose(modes.angle[:, 0], [0, 0, 1], atol=0)
    np.testing.assert_allclose(modes.torque[1], modes.torque[2], rtol=1e-15)


@pytest.mark.parametrize("seed", range(12))
def test_roots_of_unequal_trains_are_exact_to_1e_13(seed):
    rng = np.random.default_rng(seed)
    n = 4 + seed % 2
    parent = [-1, 0, *(int(rng.integers(max(0, i - 3), i)) for i in range(2, n))]
    held = [[], [0], []][seed % 3]
    train = tree(parent, 10 ** rng.uniform(-12, 0, n), 10 ** rng.uniform(-6, 4, n), held=held)
    amount = [1e-12, 1e-6, 0.02, 3.0][seed % 4]
    critical = amount * np.sqrt(train.inertia / train.flexibility)
    viscous, ground = critical * (rng.random(n) < 0.6), critical * (rng.random(n) < 0.3)
    viscous[0] = 0
    loss = rng.uniform(0, 0.3, n) * (seed % 4 == 2) * (seed > 5)
    modes = damped_modes(train, ground_damping=ground, viscous=viscous, loss_factor=loss)
    assert_roots_of(train, modes, ground, viscous, loss)
    assert_equations_hold(train, modes, ground, viscous, loss)


@pytest.mark.parametrize("size", [30, 400])
def test_roots_from_undamped_start_values_satisfy_the_equations_at_any_size(size):
    train = tree(range(-1, size - 1), np.full(size, 1e-4), np.ones(size))
    start = 2 * np.sqrt(1e4) * np.sin(np.pi * np.arange(1, 9) / (2 * size))
    viscous = np.full(size, 0.02)
    modes = damped_modes(train, viscous=viscous, start=start)
    decay = start**2 * 0.02 * 1e-4 / 2  # damping in proportion to stiffness
    np.testing.assert_allclose(
        modes.eigenvalue, -decay + 1j * np.sqrt(start**2 - decay**2), rtol=1e-12
    )
    np.testing.assert_allclose(modes.eigenvalue.real, -decay, rtol=1e-10)


@pytest.mark.parametrize(
    ("arrays", "fault"),
    [
        ({"viscous": np.zeros(3)}, "expected"),
        ({"viscous": np.array([0, -1.0])}, "none negative"),
        ({"start": np.array([0.0])}, "above 0"),
    ],
)
def test_arrays_that_do_not_fit_are_refused(arrays, fault):
    with pytest.raises(ValueError, match=fault):
        damped_modes(ONE_DISC, **arrays)


def test_the_response_to_a_growing_torque_peaks_where_the_modes_say():
    train = tree([-1, 0, 1], [0, 1e-3, 2e-3], [1, 2, 3])
    loss = np.array([0, 1e-3, 1e-3])
    modes = damped_modes(train, loss_factor=loss)
    resonances = np.abs(modes.eigenvalue)
    hc = train.flexibility / (1 + 1j * loss)
    shapes = tree_response(train, resonances, np.array([1.0, 0, 0]), compliance=hc).angle
    shapes /= shapes[np.argmax(np.abs(modes.angle), axis=0), range(2)]
    np.testing.assert_allclose(shapes, modes.angle, atol=5e-3)


@mp.workdps(DIGITS)
def exact_roots(train, ground, viscous, loss):
    """All roots by the companion form with many digits; the data are taken as exact."""
    moving = [i for i in range(train.size) if not train.held[i]]
    place, n = {i: p for p, i in enumerate(moving)}, len(moving)
    companion = mp.zeros(2 * n)
    for i in moving:
        companion[place[i], n + place[i]] = mp.mpf(1)
    entries = [(i, None, mp.mpf(0), mp.mpf(float(ground[i]))) for i in moving]
    for i in range(train.size):
        if train.parent[i] >= 0:
            k = mp.mpc(1, float(loss[i])) / mp.mpf(float(train.flexibility[i]))
            entries.append((i, int(train.parent[i]), k, mp.mpf(float(viscous[i]))))
    for i, parent, k, c in entries:
        for row, column, sign in ((i, i, 1), (parent, parent, 1), (i, parent, -1), (parent, i, -1)):
            if row in place and column in place:
                mass = mp.mpf(float(train.inertia[row]))
                companion[n + place[row], place[column]] -= sign * k / mass
                companion[n + place[row], n + place[column]] -= sign * c / mass
    return list(mp.eig(companion, left=False, right=False))


def assert_roots_of(train, modes, ground, viscous, loss):
    roots = exact_roots(train, ground, viscous, loss)
    largest = max(abs(root) for root in roots)
    left = [root for root in roots if abs(root) > largest * mp.mpf(10) ** (-DIGITS // 3)]
    for value in modes.eigenvalue:
        near = min(left, key=lambda root: abs(root - complex(value)))
        left.remove(near)
        assert abs(mp.mpc(complex(value)) - near) <= 1e-13 * abs(near)
        assert abs(mp.mpf(float(value.real)) - near.real) <= 1e-12 * abs(near.real) + 1e-25 * abs(
            near
        )
    if not loss.any():
        assert (
            sum(root.imag < -abs(root) * mp.mpf(10) ** -30 for root in left)
            == modes.eigenvalue.size
        )
        left = [root for root in left if abs(root.imag) <= abs(root) * mp.mpf(10) ** -30]
        assert len(left) == modes.real_root.size
        for value, exact in zip(modes.real_root, sorted(left, key=abs), strict=True):
            assert abs(mp.mpf(float(value)) - exact.real) <= 1e-13 * abs(exact)


def assert_equations_hold(train, modes, ground, viscous, loss):
    """Each mode balances every station, and its torques wind every span, to rounding of the terms."""
    root = modes.eigenvalue
    own = ground[:, None] * root + train.inertia[:, None] * root**2
    balance = [[own[i] * modes.angle[i], -modes.torque[i]] for i in range(train.size)]
    for i in range(train.size):
        parent = int(train.parent[i])
        if parent >= 0:
            balance[parent].append(modes.torque[i])
            wound = modes.torque[i] / (
                (1 + 1j * loss[i]) / train.flexibility[i] + viscous[i] * root
            )
            terms = np.array([modes.angle[i], -modes.angle[parent], wound])
            assert (np.abs(terms.sum(axis=0)) <= 1e-12 * np.abs(terms).sum(axis=0)).all()
    for i in np.flatnonzero(~train.held):
        terms = np.array(balance[i])
        assert (np.abs(terms.sum(axis=0)) <= 1e-12 * np.abs(terms).sum(axis=0)).all()
