"""Forced response of trees against closed forms and laws."""

import numpy as np
import pytest
from tests.for_all import for_all

from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import (
    Status,
    complex_compliance,
    equilibrium_residual,
    pose,
    status,
    tree_response,
)


def tree(parent, flexibility, inertia, held=()):
    fixed = np.zeros(len(parent), dtype=bool)
    fixed[list(held)] = True
    return Tree(
        np.array(parent), np.array(flexibility, dtype=float), np.array(inertia, dtype=float), fixed
    )


def random_damped_tree(seed, size=12):
    rng = np.random.default_rng(seed)
    parent = [-1, *(int(rng.integers(max(0, station - 3), station)) for station in range(1, size))]
    train = tree(parent, 10 ** rng.uniform(-6, -3, size), 10 ** rng.uniform(-1, 1, size))
    w = rng.uniform(1, 300, 7)
    hc = complex_compliance(
        train.flexibility, rng.uniform(0, 5, size), rng.uniform(0, 0.1, size), w
    )
    return train, w, hc, rng.uniform(0, 2, size)


def test_two_discs_under_opposite_torques_move_and_wind_as_in_closed_form():
    answer = tree_response(
        tree([-1, 0], [0, 1 / 120], [2, 3]), np.array([5.0]), np.array([1.0, -1.0])
    )
    np.testing.assert_allclose(answer.angle[:, 0], [1 / 150, -1 / 225], rtol=1e-15)
    np.testing.assert_allclose(answer.torque[1, 0], 4 / 3, rtol=1e-15)
    assert answer.residual[0] < 1e-15
    assert status(answer.amplification, answer.residual).tolist() == [Status.OK]


@pytest.mark.parametrize("held_is_root", [True, False])
def test_a_viscous_link_carries_the_share_of_its_damper(held_is_root):
    k, c, w, J = 100.0, 20.0, 10.0, 3.0
    train = tree(
        [-1, 0], [0, 1 / k], [0, J] if held_is_root else [J, 0], held=[0] if held_is_root else [1]
    )
    hc = complex_compliance(train.flexibility, np.array([0, c]), np.zeros(2), np.array([w]))
    answer = tree_response(
        train, np.array([w]), np.array([0, 5.0] if held_is_root else [5.0, 0]), compliance=hc
    )
    x = 5 / (k + 1j * w * c - w * w * J)
    np.testing.assert_allclose(answer.angle[1 if held_is_root else 0, 0], x, rtol=1e-15)
    np.testing.assert_allclose(
        answer.torque[1, 0], (-x if held_is_root else x) * (k + 1j * w * c), rtol=1e-15
    )


def test_lanchester_damper_at_its_optimum_peaks_at_the_published_height():
    mu = 0.2
    c = 2 * mu / np.sqrt(2 * (1 + mu) * (2 + mu))
    train = tree([-1, 0, 1], [0, 1, np.inf], [0, 1, mu], held=[0])
    w = np.sqrt(2 / (2 + mu)) * np.array([0.99, 1, 1.01])
    hc = complex_compliance(train.flexibility, np.array([0, 0, c]), np.zeros(3), w)
    height = np.abs(tree_response(train, w, np.array([0, 1.0, 0]), compliance=hc).angle[1])
    np.testing.assert_allclose(height[1], (2 + mu) / mu, rtol=1e-14)
    assert height[0] < height[1] > height[2]


def test_cardan_joint_between_a_driven_shaft_at_constant_speed_and_one_inertia():
    q = np.tan(np.deg2rad(5)) ** 2
    train = tree([-1, 0, 1], [0, 0, 1e-5], [0, 0, 2.5], held=[0])
    w = 2 * np.array([50.0, 95, 100, 150])
    answer = tree_response(
        train,
        w,
        np.zeros(3),
        twist=np.array([0, q, 0]),
        ground_damping=np.array([0, 0, 5.0]),
    )
    published = [0.0102054615, 0.0781352725, 0.7654266246, 0.0061229722]
    np.testing.assert_allclose(np.abs(answer.angle[2]), published, rtol=0, atol=6e-11)
    exact = q / (1 + 1e-5 * (5j * w - 2.5 * w * w))
    np.testing.assert_allclose(answer.angle[2], exact, rtol=1e-12)
    np.testing.assert_allclose(answer.torque[2], exact * (5j * w - 2.5 * w * w), rtol=1e-12)
    np.testing.assert_allclose(answer.torque[1], answer.torque[2], rtol=1e-15)
    assert (answer.residual < 1e-14).all()


@pytest.mark.parametrize("seed", range(4))
def test_response_is_reciprocal(seed):
    train, w, hc, ground = random_damped_tree(seed)
    receptance = [
        tree_response(train, w, row, compliance=hc, ground_damping=ground).angle
        for row in np.eye(train.size)
    ]
    np.testing.assert_allclose(receptance, np.swapaxes(receptance, 0, 1), rtol=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_response_adds_over_torques_and_twists_that_vary_along_the_frequencies(seed):
    train, w, hc, ground = random_damped_tree(seed)
    rng = np.random.default_rng(seed + 100)
    force, twist = rng.normal(size=(2, train.size, w.size)) + 1j * rng.normal(
        size=(2, train.size, w.size)
    )
    twist[0] = 0
    given = {"compliance": hc, "ground_damping": ground}
    both = tree_response(train, w, force, twist=twist, **given)
    one, other = (
        tree_response(train, w, force, **given),
        tree_response(train, w, 0 * force, twist=twist, **given),
    )
    np.testing.assert_allclose(both.torque, one.torque + other.torque, rtol=1e-11)
    np.testing.assert_allclose(both.angle, one.angle + other.angle, rtol=1e-11)
    assert both.residual.max() < 1e-13


def test_a_rigid_span_carries_torque_and_prescribed_motion_passes_through_rigid_spans():
    train = tree([-1, 0, 1, 2, 2], [0, 0, 0, 0.01, 0], [0, 2, 3, 4, 5], held=[0])
    w, turn = np.array([3.0]), 0.5
    answer = tree_response(
        train, w, np.array([0, 0, 0, 0, 7.0]), twist=np.array([0, turn, 0, 0, 0])
    )
    leaf = -9 * 4 * turn / (1 - 0.01 * 9 * 4)
    np.testing.assert_allclose(answer.angle[[1, 2, 4], 0], turn, rtol=1e-15)
    np.testing.assert_allclose(answer.torque[4, 0], -9 * 5 * turn - 7, rtol=1e-15)
    np.testing.assert_allclose(answer.torque[3, 0], leaf, rtol=1e-14)
    np.testing.assert_allclose(answer.torque[1, 0], -9 * (2 + 3 + 5) * turn - 7 + leaf, rtol=1e-14)
    assert answer.residual[0] < 1e-15


def test_a_held_leaf_is_a_spring_to_ground_and_takes_its_twist():
    train = tree([-1, 0, 0], [0, 1 / 50, 1 / 30], [2, 0, 0], held=[1, 2])
    answer = tree_response(
        train, np.array([3.0]), np.array([4.0, 0, 0]), twist=np.array([0, 0, 0.1])
    )
    x = (4 - 30 * 0.1) / (50 + 30 - 18)
    np.testing.assert_allclose(answer.angle[:, 0], [x, 0, 0], rtol=1e-14)
    np.testing.assert_allclose(answer.torque[1:, 0], [50 * x, 30 * (x + 0.1)], rtol=1e-14)


def test_an_undamped_absorber_exactly_in_tune_stills_its_station():
    train = tree([-1, 0, 1], [0, 1.0, 1.0], [0, 5, 1], held=[0])
    answer = tree_response(train, np.array([0.5, 1.0]), np.array([0, 1.0, 0]))
    np.testing.assert_allclose(answer.torque[2, 1], 1.0, rtol=1e-14)
    np.testing.assert_allclose(answer.angle[2, 1], -1.0, rtol=1e-14)
    assert abs(answer.angle[1, 1]) < 1e-15
    assert status(answer.amplification, answer.residual).tolist() == [Status.OK, Status.OK]


def test_status_tells_resonance_from_its_neighbourhood_and_free_trains_at_rest():
    train = tree([-1, 0], [0, 1 / 120], [2, 3])  # resonant at 10 rad/s
    answer = tree_response(train, np.array([0, 5, 10, 10 * (1 + 1e-10), 20]), np.array([1.0, 0]))
    found = status(answer.amplification, answer.residual).tolist()
    assert found == [Status.SINGULAR, Status.OK, Status.SINGULAR, Status.NEAR_SINGULAR, Status.OK]


def test_trains_of_a_forest_do_not_feel_each_other():
    alone = tree([-1, 0], [0, 1 / 120], [2, 3])
    pair = tree([-1, 0, -1, 2], [0, 1 / 120, 0, 1 / 7], [2, 3, 1, 1])
    w = np.array([5.0, 11.0])
    one = tree_response(alone, w, np.array([1.0, 2.0]))
    both = tree_response(pair, w, np.array([1.0, 2.0, 0, 0]))
    np.testing.assert_array_equal(both.angle[:2], one.angle)
    np.testing.assert_array_equal(both.torque[2:], 0)


def test_many_frequencies_in_pieces_equal_each_by_itself():
    train, _, _, ground = random_damped_tree(9)
    w = np.linspace(1, 500, 5000)
    whole = tree_response(train, w, np.ones(train.size), ground_damping=ground)
    for line in (0, 2047, 2048, 4999):
        single = tree_response(
            train, w[line : line + 1], np.ones(train.size), ground_damping=ground
        )
        np.testing.assert_allclose(whole.torque[:, line], single.torque[:, 0], rtol=1e-13)


def test_compliance_of_a_lossy_viscous_span_is_the_reciprocal_of_its_stiffness():
    w = np.array([2.0, 3.0])
    hc = complex_compliance(
        np.array([0, 0.01, np.inf]), np.array([5.0, 6, 7]), np.array([0.1, 0.2, 0.0]), w
    )
    np.testing.assert_array_equal(hc[0], 0)
    np.testing.assert_allclose(hc[1], 1 / (100 * (1 + 0.2j) + 6j * w), rtol=1e-15)
    np.testing.assert_allclose(hc[2], 1 / (7j * w), rtol=1e-15)


@for_all(
    ("train", "arrays", "fault"),
    [
        (tree([-1, 0], [0, 1], [1, 1]), {"force": np.ones(3)}, "force has shape"),
        (tree([-1, 0], [0, 1], [1, 1]), {"ground_damping": np.ones(3)}, "ground_damping"),
        (tree([-1, 0], [0, 1], [1, 1]), {"twist": np.ones((2, 5))}, "twist has shape"),
        (tree([-1, 0], [0, 0], [1, 1], held=[1]), {}, "rigid span leads to a fixed leaf"),
        (
            tree([-1, 0], [0, 1], [1, 1]),
            {"compliance": np.array([[0, 0], [0, 1.0]])},
            "at some frequencies only",
        ),
    ],
)
def test_what_does_not_fit_is_refused_in_words(train, arrays, fault):
    with pytest.raises(ValueError, match=fault):
        tree_response(train, np.array([1.0, 2.0]), **({"force": np.ones(train.size)} | arrays))


def test_ground_damping_that_varies_along_the_frequencies_acts_line_by_line():
    train, w, hc, ground = random_damped_tree(5)
    varying = np.outer(ground, 1 + w / 100)
    whole = tree_response(train, w, np.ones(train.size), ground_damping=varying, compliance=hc)
    for line in range(w.size):
        given = {"ground_damping": varying[:, line], "compliance": hc[:, line]}
        single = tree_response(train, w[line : line + 1], np.ones(train.size), **given)
        np.testing.assert_allclose(whole.torque[:, line], single.torque[:, 0], rtol=1e-13)


def test_status_draws_its_lines_at_the_named_loss_and_at_no_digit_left():
    amplification = np.array([1.0, 1e7, 1e9, 1e9, 1e17, np.inf])
    residual = np.array([0, np.nan, 0, 1e-6, 0, np.nan])
    assert status(amplification, residual).tolist() == [0, 0, 1, 1, 2, 2]
    assert status(np.ones(2), np.array([1e-7, 2.0])).tolist() == [1, 2]


@pytest.mark.parametrize("distance", [1e-5, 1e-8])
def test_amplification_sees_the_resonance_of_a_branch_in_which_nothing_acts(distance):
    train = tree(
        [-1, 0, 1], [0, 1e9, 1 / 120], [50, 2, 3]
    )  # the branch alone is resonant at 10 rad/s
    answer = tree_response(train, np.array([10.0 * (1 + distance)]), np.array([1.0, 0, 0]))
    assert 0.1 < answer.amplification[0] * distance < 10


@pytest.mark.parametrize("seed", range(3))
def test_a_source_of_zero_at_every_frequency_is_no_source(seed):
    train, w, hc, ground = random_damped_tree(seed)
    force, twist = (np.zeros((train.size, w.size), dtype=complex) for _ in range(2))
    force[[3, 7], 1:], force[7, 0], twist[5] = 1 + 2j, 1, 0.01
    given = {"compliance": hc, "ground_damping": ground}
    some = tree_response(train, w, force, twist=twist, **given)
    tiny = [np.where(values == 0, 1e-200, values) for values in (force, twist)]
    every = tree_response(train, w, tiny[0], twist=tiny[1], **given)
    np.testing.assert_allclose(some.torque, every.torque, rtol=1e-12, atol=1e-180)
    np.testing.assert_allclose(some.angle, every.angle, rtol=1e-12, atol=1e-180)
    np.testing.assert_allclose(some.amplification, every.amplification, rtol=1e-10)


@pytest.mark.parametrize("seed", range(3))
def test_residual_sees_an_error_of_any_angle_and_of_any_torque(seed):
    train, w, hc, ground = random_damped_tree(seed, size=40)
    w = np.tile(w, 200)  # several blocks of stations
    given = {"compliance": np.tile(hc, 200), "ground_damping": ground}
    problem, answer = (
        solve(train, w, np.ones(train.size), **given) for solve in (pose, tree_response)
    )
    posed = problem.plan, problem.equations(slice(None)), answer.angle, answer.torque
    assert equilibrium_residual(*posed).max() < 1e-13
    for part, first in ((answer.angle, 0), (answer.torque, 1)):
        for station in range(first, train.size):
            part[station] *= 1 + 1e-3
            assert (equilibrium_residual(*posed) > 1e-6).any()
            part[station] /= 1 + 1e-3


def test_a_fixed_station_within_a_train_separates_its_sides():
    k, w, J = 7.0, 1.5, 2.0
    train = tree([-1, 0, 1], [0, 1 / k, 1 / k], [J, 1, J], held=[1])
    answer = tree_response(train, np.array([w]), np.array([3.0, 0.0, 5.0]))
    angle = np.array([3.0, 0.0, 5.0]) / (k - w * w * J)
    np.testing.assert_allclose(answer.angle[:, 0], angle, rtol=1e-15)
    np.testing.assert_allclose(answer.torque[1:, 0], [k * angle[0], -k * angle[2]], rtol=1e-15)
