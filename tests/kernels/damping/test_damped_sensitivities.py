"""Derivatives of damped roots against differences in many digits."""

from functools import partial

import mpmath as mp
import numpy as np
import pytest

from torsion.kernels.damping.damped_sensitivities import root_sensitivity
from torsion.kernels.damping.damped_tree_modes import damped_modes
from torsion.kernels.sensitivities import compliance_slopes
from torsion.kernels.tree import Tree

STEP = mp.mpf(10) ** -25
SPANS = [(0, 1), (1, 2), (1, 3), (3, 4)]


def _determinant(figures, root):
    """det(l^2 J + l C + K) at stiffness, viscous, loss factor, inertia and ground damping."""
    k, c, eta, inertia, ground = figures
    matrix = mp.diag([root * root * j + root * g for j, g in zip(inertia, ground, strict=True)])
    for (a, b), *own in zip(SPANS, k, c, eta, strict=True):
        stiffness = own[0] * mp.mpc(1, own[2]) + root * own[1]
        for row, column, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
            matrix[row, column] += sign * stiffness
    return mp.det(matrix)


@pytest.mark.parametrize("damped", ["ground viscous loss", "viscous loss"])
def test_a_damped_root_moves_with_every_figure_by_its_derivative(damped) -> None:
    """dl/dp = -(d det/dp)/(d det/dl), differences at the root in 60 digits."""
    rng = np.random.default_rng(3)
    parent, inertia = np.array([-1, 0, 1, 1, 3]), 10 ** rng.uniform(-1, 1, 5)
    tree = Tree(
        parent, np.append(0.0, 10 ** -rng.uniform(3, 5, 4)), inertia, np.zeros(5, dtype=bool)
    )
    ground, viscous = (
        10.0 * rng.uniform(0, 1, 5) * ("ground" in damped),
        20.0 * rng.uniform(0, 1, 5),
    )
    loss = rng.uniform(0.02, 0.2, 5)
    damping = {"ground_damping": ground, "viscous": viscous, "loss_factor": loss}
    modes = damped_modes(tree, **damping)
    found = root_sensitivity(tree, modes, **damping)
    stiffness = 1.0 / tree.flexibility[1:]
    by_k, by_eta, by_c = (
        slope * found.compliance[1:]
        for slope in compliance_slopes(stiffness, viscous[1:], loss[1:], modes.eigenvalue)
    )
    by_figure = np.vstack(
        [by_k / stiffness[:, None], by_c, by_eta, found.inertia, found.ground_damping]
    )
    with mp.workdps(60):
        given = [
            [mp.mpf(float(v)) for v in one]
            for one in (stiffness, viscous[1:], loss[1:], inertia, ground)
        ]
        for mode, start in enumerate(modes.eigenvalue):
            near = mp.mpc(complex(start))
            root = mp.findroot(
                partial(_determinant, given),
                (near, near * (1 + mp.mpf(10) ** -12)),
                tol=1e-90,
                verify=False,
            )
            by_root = _determinant(given, root + STEP) - _determinant(given, root - STEP)
            exact = []
            for values in given:
                for place, value in enumerate(values):
                    values[place] = value + STEP
                    above = _determinant(given, root)
                    values[place] = value - STEP
                    exact.append(complex((_determinant(given, root) - above) / by_root))
                    values[place] = value
            assert np.abs(by_figure[:, mode] / np.array(exact) - 1.0).max() < 1e-12
