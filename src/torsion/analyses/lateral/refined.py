"""Damped whirl to full accuracy from roots among a few modes at rest, by Rayleigh's quotient iteration."""

import numpy as np

from torsion.analyses.lateral.planes import Planes
from torsion.arrays import ComplexArray

OVERDAMPED = 1e-7  # |Im s|/|s| below which a motion does not oscillate
SETTLED = 1e-8  # relative step after which a root is found: convergence is cubic, so that the next would be rounding
STEPS = 8
REACH = 0.05  # relative: a root that moves farther than this was not among the few modes
APART = 1e-9  # relative: roots nearer than this may be one found twice


def refined(
    planes: Planes, speed: float, rough: tuple[ComplexArray, ComplexArray], modes: int
) -> tuple[ComplexArray, ComplexArray] | None:
    """The `modes` lowest oscillating roots of either sense, refined, by modulus; None where they are in doubt.

    The equation (1 + s2 M + s C - i s Omega G) p = 0 has complex symmetric matrices, so that p is also its left vector.
    """
    root, shape = rough
    chosen = np.concatenate([
        np.flatnonzero(sense * root.imag > OVERDAMPED * np.abs(root))[:modes] for sense in (-1, 1)
    ])  # fmt: skip
    start, root, shape = root[chosen], root[chosen].copy(), shape[:, chosen].copy()
    open_roots = np.arange(len(root))
    for _ in range(STEPS):
        step = _improve(planes, speed, root, shape, open_roots)
        open_roots = open_roots[np.abs(step) > SETTLED * np.abs(root[open_roots])]
        if not open_roots.size:
            break
    apart = np.abs(root[:, None] - root) + np.diag(np.abs(root))
    if open_roots.size or (np.abs(root - start) > REACH * np.abs(start)).any():
        return None
    if not np.isfinite(root).all() or (apart < APART * np.abs(root)).any():
        return None
    order = np.argsort(np.abs(root), kind="stable")
    return root[order], shape[:, order]


def _improve(planes: Planes, speed: float, root: ComplexArray, shape: ComplexArray, which: np.ndarray) -> ComplexArray:
    """One step for the roots numbered `which`, in place; the changes of the roots."""
    s, p = root[which][:, None, None], shape[:, which].T[:, :, None]
    index = np.arange(len(planes.square))
    first = planes.damping - 1j * speed * planes.gyroscopic
    matrix = s * first
    matrix[:, index, index] += 1.0 + s[:, :, 0] ** 2 * planes.square
    turned = first @ p + 2.0 * s * planes.square[:, None] * p
    try:
        better = np.linalg.solve(matrix, turned)
    except np.linalg.LinAlgError:  # a root to the last digit
        return np.zeros(len(which), dtype=np.complex128)
    better /= np.linalg.norm(better, axis=1, keepdims=True)
    slope = np.swapaxes(better, 1, 2) @ (first @ better + 2.0 * s * planes.square[:, None] * better)
    step = (np.swapaxes(better, 1, 2) @ (matrix @ better) / slope)[:, 0, 0]
    root[which] -= step
    shape[:, which] = better[:, :, 0].T
    return np.asarray(step)
