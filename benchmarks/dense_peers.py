"""What an engineer writes with numpy and scipy: assembled matrices, eigh, eigsh, solve, the companion matrix."""

from typing import Any

import numpy as np
from scipy import linalg, sparse
from scipy.sparse.linalg import eigsh

from benchmarks.cases import Case, condensed

EIGH, EIGSH, SOLVE, COMPANION = "numpy eigh", "scipy eigsh", "numpy solve", "numpy eig (companion)"


def matrices(case: Case) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Stiffness, damping and the diagonal of inertia, at the speed of the root."""
    flat = condensed(case)
    stiffness, damping = np.zeros((case.size,) * 2), np.diag(np.array(flat.damping))
    for i in range(1, case.size):
        ends = np.ix_([flat.parent[i], i], [flat.parent[i], i])
        pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
        stiffness[ends] += flat.stiffness[i] * pair
        damping[ends] += flat.viscous[i] * pair
    return stiffness, damping, np.array(flat.inertia)


def dense_frequencies(case: Case) -> np.ndarray:
    """Elastic frequencies, rad/s: numpy's eigh of J^-1/2 K J^-1/2, the lowest taken for the rigid motion."""
    stiffness, _, inertia = matrices(case)
    root = np.sqrt(inertia)
    return np.sqrt(np.abs(np.linalg.eigvalsh(stiffness / np.outer(root, root))))[1:]


def dense_modes(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Elastic frequencies, rad/s, and shapes (stations, modes), by scipy's eigh of K and J."""
    stiffness, _, inertia = matrices(case)
    square, shape = linalg.eigh(stiffness, np.diag(inertia))
    return np.sqrt(np.abs(square))[1:], shape[:, 1:]


def sparse_frequencies(case: Case, count: int, shift: float) -> np.ndarray:
    """The lowest elastic frequencies, rad/s: eigsh by shift and invert, with a shift (rad2/s2) below zero."""
    stiffness, _, inertia = matrices(case)
    return _lowest(
        sparse.csc_array(stiffness), count, shift, M=sparse.diags_array(inertia, format="csc")
    )


def chain_frequencies(size: int, count: int, shift: float) -> np.ndarray:
    """The same of a uniform chain of unit inertias and stiffnesses, never a full matrix."""
    diagonal = np.full(size, 2.0)
    diagonal[[0, -1]] = 1.0
    stiffness = sparse.diags_array(
        [diagonal, np.full(size - 1, -1.0), np.full(size - 1, -1.0)], offsets=[0, 1, -1]
    )
    return _lowest(stiffness.tocsc(), count, shift)


def _lowest(stiffness: Any, count: int, shift: float, **inertia: Any) -> np.ndarray:
    start = np.random.default_rng(0).uniform(size=stiffness.shape[0])
    square = eigsh(
        stiffness, count + 1, sigma=shift, v0=start, return_eigenvectors=False, **inertia
    )
    return np.sqrt(np.abs(np.sort(square)))[1:]


def span_torque(case: Case, force: np.ndarray, w: float) -> np.ndarray:
    """Torque in span i on station i (0 at the root) from the dynamic stiffness, by numpy's solve; chains and trees."""
    stiffness, damping, inertia = matrices(case)
    angle = np.linalg.solve(stiffness + 1j * w * damping - w * w * np.diag(inertia), force)
    flat = condensed(case)
    spring = np.array(flat.stiffness) + 1j * w * np.array(flat.viscous)
    torque = spring * (angle[np.maximum(np.array(flat.parent), 0)] - angle)
    torque[0] = 0.0
    return np.asarray(torque)


def eigenvalues(case: Case) -> np.ndarray:
    """All eigenvalues 1/s of the damped train, by numpy's eig of the companion matrix."""
    stiffness, damping, inertia = matrices(case)
    size, scale = case.size, inertia[:, None]
    lower = np.hstack([-stiffness / scale, -damping / scale])
    return np.linalg.eigvals(np.vstack([np.hstack([np.zeros((size, size)), np.eye(size)]), lower]))
