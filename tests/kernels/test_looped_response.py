"""Response of trains with closed loops against closed forms, trees and 60-digit arithmetic."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import Chords, Status, status, tree_response


def closing(begin, end, compliance, twist=None):
    twist = np.zeros(len(begin)) if twist is None else np.array(twist)
    return Chords(np.array(begin), np.array(end), np.array(compliance), twist)


def test_two_parallel_springs_act_as_one_of_their_sum():
    pair = Tree(
        np.array([-1, 0]), np.array([0, 1 / 90]), np.array([2.0, 3.0]), np.zeros(2, dtype=bool)
    )
    answer = tree_response(
        pair, np.array([5.0]), np.array([1.0, -1.0]), chords=closing([0], [1], [1 / 30])
    )
    np.testing.assert_allclose(answer.angle[:, 0], [1 / 150, -1 / 225], rtol=1e-14)
    np.testing.assert_allclose(
        [answer.torque[1, 0], answer.chord_torque[0, 0]], [1, 1 / 3], rtol=1e-14
    )
    assert answer.residual[0] < 1e-14


def test_a_twist_in_a_loop_of_parallel_springs_locks_torque_in():
    pair = Tree(
        np.array([-1, 0]), np.array([0, 1 / 90]), np.array([2.0, 3.0]), np.array([True, False])
    )
    w, twist = np.array([2.0]), 0.1
    answer = tree_response(pair, w, np.zeros(2), chords=closing([0], [1], [1 / 30], [twist]))
    x = 30 * twist / (120 - 4 * 3)
    np.testing.assert_allclose(answer.angle[1, 0], x, rtol=1e-14)
    np.testing.assert_allclose(answer.torque[1, 0], -90 * x, rtol=1e-14)
    np.testing.assert_allclose(answer.chord_torque[0, 0], 30 * (twist - x), rtol=1e-14)


def test_a_loop_through_ground_equals_the_spring_to_ground_as_a_held_leaf():
    parent, held = np.array([-1, 0, 1, -1]), np.array([True, False, False, True])
    inertia, flexibility = np.array([0, 2.0, 3.0, 0]), np.array([0, 0.01, 0.02, 0])
    w, force = np.array([1.0, 4.0]), np.array([0, 1.0, 2.0, 0])
    open_tree = Tree(parent, flexibility, inertia, held)
    looped = tree_response(open_tree, w, force, chords=closing([2], [3], [0.05]))
    leaf = Tree(np.array([-1, 0, 1, 2]), np.array([0, 0.01, 0.02, 0.05]), inertia, held)
    plain = tree_response(leaf, w, force)
    np.testing.assert_allclose(looped.angle, plain.angle, rtol=1e-13)
    np.testing.assert_allclose(looped.chord_torque[0], plain.torque[3], rtol=1e-13)


@pytest.mark.parametrize("seed", range(6))
def test_torques_of_stiff_trains_with_two_loops_agree_with_many_digits(seed):
    rng = np.random.default_rng(seed)
    n, eta = 10, 1e-3
    parent = np.array([-1, *(int(rng.integers(max(0, i - 3), i)) for i in range(1, n))])
    stiffness = 10 ** rng.uniform(4, 12, n)
    soft = 10 ** rng.uniform(0, 4, 2)
    inertia = 10 ** rng.uniform(-4, 3, n)
    w = 10 ** rng.uniform(0, 5, 6)
    begin, end = [1, 2], [n - 1, n - 2]
    force, twist = rng.normal(size=n) + 1j * rng.normal(size=n), np.zeros(n)
    twist[3] = 1e-3
    tree = Tree(parent, np.r_[0, 1 / stiffness[1:]], inertia, np.zeros(n, dtype=bool))
    loops = closing(begin, end, 1 / (soft * (1 + 1j * eta)), [0.0, 1e-3])
    hc = tree.flexibility / (1 + 1j * eta)
    answer = tree_response(tree, w, force, twist=twist, compliance=hc, chords=loops)
    spans = [(int(parent[i]), i, complex(hc[i]), twist[i]) for i in range(1, n)]
    spans += [
        (a, b, complex(h), float(q))
        for a, b, h, q in zip(begin, end, loops.compliance, loops.twist, strict=True)
    ]
    found = np.concatenate([answer.torque[1:], answer.chord_torque])
    for line, frequency in enumerate(w):
        torque = dense_reference(inertia, spans, force, frequency)
        assert np.abs(found[:, line] - torque).max() <= 1e-11 * np.abs(torque).max()
    assert answer.residual.max() < 1e-8


@mp.workdps(60)
def dense_reference(inertia, spans, force, w):
    """Torques of the spans, (begin, end, compliance, twist) each, by the dense dynamic stiffness with many digits."""
    n = len(inertia)
    matrix, right = mp.zeros(n), mp.matrix([mp.mpc(complex(value)) for value in force])
    for station in range(n):
        matrix[station, station] -= mp.mpf(float(w)) ** 2 * mp.mpf(float(inertia[station]))
    for begin, end, compliance, twist in spans:
        k = 1 / mp.mpc(compliance)
        for one, other in ((begin, end), (end, begin)):
            matrix[one, one] += k
            matrix[one, other] -= k
        right[end] += k * mp.mpf(float(twist))
        right[begin] -= k * mp.mpf(float(twist))
    x = mp.lu_solve(matrix, right)
    return np.array([complex((x[b] - x[e] + mp.mpf(float(q))) / mp.mpc(h)) for b, e, h, q in spans])


def test_resonance_of_the_closed_train_is_marked():
    pair = Tree(
        np.array([-1, 0]), np.array([0, 1 / 64]), np.array([2.0, 2.0]), np.zeros(2, dtype=bool)
    )
    answer = tree_response(
        pair, np.array([0.0, 5, 10]), np.array([1.0, 0]), chords=closing([0], [1], [1 / 36])
    )
    assert status(answer.amplification, answer.residual).tolist() == [
        Status.SINGULAR,
        Status.OK,
        Status.SINGULAR,
    ]


def test_a_span_between_separate_parts_is_refused():
    two = Tree(np.array([-1, -1]), np.zeros(2), np.ones(2), np.zeros(2, dtype=bool))
    with pytest.raises(ValueError, match="only connection of two parts"):
        tree_response(two, np.array([1.0]), np.ones(2), chords=closing([0], [1], [1.0]))
