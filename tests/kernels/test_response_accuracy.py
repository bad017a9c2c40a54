"""Torques and angles of the forced response against 60-digit arithmetic, on trains of unequal springs."""

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.trees.tree import Tree
from torsion.kernels.trees.tree_response import complex_compliance, status, tree_response

DIGITS = 60


def random_tree(rng, size, *, branched, held_leaf=False):
    parent = np.arange(-1, size - 1)
    if branched:
        parent[2:] = [rng.integers(max(0, station - 4), station) for station in range(2, size)]
    flexibility = 10 ** rng.uniform(-12, 0, size)
    inertia = 10 ** rng.uniform(-6, 4, size)
    held = np.zeros(size, dtype=bool)
    if held_leaf:
        held[-1] = True
        parent[-1] = 0
    return Tree(parent, flexibility, inertia, held)


@mp.workdps(DIGITS)
def reference(tree, w, force, twist, viscous, loss_factor, ground):
    """Angles and torques at one frequency by elimination with many digits; every input is taken as exact."""
    number, imaginary = mp.mpf, mp.mpc(0, 1)
    w, n = number(float(w)), tree.size
    z, f = [mp.mpc(0)] * n, [mp.mpc(complex(value)) for value in force]
    factor, hc = [mp.mpc(0)] * n, [mp.mpc(0)] * n
    x, t = [mp.mpc(0)] * n, [mp.mpc(0)] * n
    for i in reversed(range(n)):
        p, q = int(tree.parent[i]), mp.mpc(complex(twist[i]))
        h = number(float(tree.flexibility[i]))
        if p >= 0 and h > 0:
            hc[i] = 1 / (
                (1 + imaginary * number(float(loss_factor[i]))) / h
                + imaginary * w * number(float(viscous[i]))
            )
        if tree.held[i]:
            if p >= 0:
                z[p] += 1 / hc[i]
                f[p] -= q / hc[i]
            continue
        z[i] += imaginary * w * number(float(ground[i])) - w * w * number(float(tree.inertia[i]))
        if p >= 0:
            factor[i] = 1 / (1 + hc[i] * z[i])
            z[p] += z[i] * factor[i]
            f[p] += (f[i] - z[i] * q) * factor[i]
    for i in range(n):
        p, q = int(tree.parent[i]), mp.mpc(complex(twist[i]))
        if p < 0:
            x[i] = mp.mpc(0) if tree.held[i] else f[i] / z[i]
        elif tree.held[i]:
            t[i] = (x[p] + q) / hc[i]
        else:
            t[i] = (z[i] * (x[p] + q) - f[i]) * factor[i]
            x[i] = x[p] + q - hc[i] * t[i]
    return np.array([complex(value) for value in x]), np.array([complex(value) for value in t])


def lines(tree, rng, count):
    """Frequencies spread, on a logarithmic scale, over those at which single springs and discs resonate."""
    springs, discs = np.log10(tree.flexibility[1:]), np.log10(tree.inertia[~tree.held])
    return 10 ** rng.uniform(
        -(springs.max() + discs.max()) / 2, -(springs.min() + discs.min()) / 2, count
    )


@pytest.mark.parametrize("loss_factor", [1e-2, 1e-8])
@pytest.mark.parametrize("seed", range(6))
def test_torques_of_three_sources_on_unequal_springs_are_exact_to_1e_12_of_the_largest(
    seed, loss_factor
):
    rng = np.random.default_rng(seed)
    size = int(rng.integers(5, 41))
    tree = random_tree(rng, size, branched=bool(seed % 2), held_leaf=seed % 3 == 0)
    w = lines(tree, rng, 50)
    force = np.zeros(size, dtype=complex)
    force[rng.permutation(size)[:3]] = rng.normal(size=3) + 1j * rng.normal(size=3)
    twist, ground, loss = np.zeros(size), np.zeros(size), np.full(size, loss_factor)
    twist[rng.integers(1, size)] = 0.01 * (seed % 2)
    viscous = rng.uniform(0, 1e-6, size) * (seed % 3 == 1)
    hc = complex_compliance(tree.flexibility, viscous, loss, w)
    answer = tree_response(tree, w, force, twist=twist, ground_damping=ground, compliance=hc)
    for line in range(0, 50, 5):
        angle, torque = reference(tree, w[line], force, twist, viscous, loss, ground)
        assert np.abs(answer.torque[:, line] - torque).max() <= 1e-12 * np.abs(torque).max()
        assert np.abs(answer.angle[:, line] - angle).max() <= 1e-12 * np.abs(angle).max()
    assert answer.residual.max() <= 1e-12
    assert not status(answer.amplification, answer.residual).any()


@pytest.mark.parametrize("loss_factor", [1e-2, 1e-8])
@pytest.mark.parametrize("seed", range(4))
def test_torques_of_one_source_are_exact_to_1e_12_each_by_itself(seed, loss_factor):
    rng = np.random.default_rng(seed + 50)
    size = int(rng.integers(5, 41))
    tree = random_tree(rng, size, branched=bool(seed % 2))
    w = lines(tree, rng, 8)
    force, none, loss = np.zeros(size), np.zeros(size), np.full(size, loss_factor)
    force[rng.integers(size)] = 1
    answer = tree_response(
        tree, w, force, compliance=complex_compliance(tree.flexibility, none, loss, w)
    )
    for line in range(8):
        _, torque = reference(tree, w[line], force, none, none, loss, none)
        seen = np.abs(torque) > 1e-280
        np.testing.assert_allclose(answer.torque[seen, line], torque[seen], rtol=1e-12)


@pytest.mark.parametrize("distance", [1e-4, 1e-7, 1e-10])
@mp.workdps(DIGITS)
def test_amplification_bounds_the_error_near_an_undamped_resonance(distance):
    tree = Tree(
        np.array([-1, 0, 1]),
        np.array([0, 1 / 3e5, 1 / 7e3]),
        np.array([0.3, 0.7, 1.1]),
        np.zeros(3, dtype=bool),
    )
    a, b = (
        mp.mpf(1) / mp.mpf(0.3) + mp.mpf(1) / mp.mpf(0.7),
        mp.mpf(1) / mp.mpf(0.7) + mp.mpf(1) / mp.mpf(1.1),
    )
    k1, k2 = (1 / mp.mpf(float(h)) for h in tree.flexibility[1:])
    middle, product = k1 * a + k2 * b, k1 * k2 * (a * b - 1 / mp.mpf(0.7) ** 2)
    w = np.array([float(mp.sqrt((middle - mp.sqrt(middle**2 - 4 * product)) / 2)) * (1 + distance)])
    none, force = np.zeros(3), np.array([1.0, 0, 0])
    answer = tree_response(tree, w, force)
    _, torque = reference(tree, w[0], force, none, none, none, none)
    error = np.abs(answer.torque[:, 0] - torque).max() / np.abs(torque).max()
    assert error <= 4 * np.finfo(float).eps * answer.amplification[0]
    assert 0.1 < answer.amplification[0] * distance < 10
