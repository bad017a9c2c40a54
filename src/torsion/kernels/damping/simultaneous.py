"""All roots of the determinant of a damped tree at once, by simultaneous iteration (Ehrlich 1967, Aberth 1973)."""

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.damping.first_order_form import DampedTree
from torsion.kernels.sweeps import EPS

CONVERGED = 1e-13  # step relative to the root
DOUBLE = 1e-6  # a double root is no better than the root of the precision: steps and gaps of such pairs, relative
SWEEPS = 300


def log_derivative(train: DampedTree, root: ComplexArray, lossy: float = 1.0) -> ComplexArray:
    """p'/p at each root, (roots,) s, of p = det(l^2 J + l C + K(1 + i eta)); `lossy` scales the loss factors.

    Leaf-to-root elimination and its derivative side by side; rigid spans merge, fixed stations take no part.
    """
    tree, plan, size = train.tree, train.plan, train.plan.size
    total = np.zeros(len(root), dtype=np.complex128)
    stiffness = [train.ground[i] * root + tree.inertia[i] * root * root for i in range(size)]
    slope = [train.ground[i] + 2 * tree.inertia[i] * root for i in range(size)]
    for station in range(size - 1, -1, -1):
        parent = plan.parent[station]
        if plan.prescribed[station] and not (plan.held[station] and parent >= 0):
            continue
        a, da = stiffness[station], slope[station]
        if parent < 0:
            total += da / a
        elif plan.rigid[station]:
            stiffness[parent] += a
            slope[parent] += da
        else:
            c = train.viscous[station]
            k = (1 + 1j * lossy * train.loss_factor[station]) / tree.flexibility[station] + c * root
            if plan.held[station]:
                stiffness[parent] += k
                slope[parent] += c
                continue
            pivot = a + k
            total += (da + c) / pivot
            share, turned = k / pivot, a / pivot
            stiffness[parent] += a * share
            slope[parent] += da * share * share + c * turned * turned
    return total


def polish_together(
    train: DampedTree, start: ComplexArray, zeros: int, *, lossy: float = 1.0, mirrored: bool = False
) -> ComplexArray:
    """Roots (roots,) to about eps, each start led to a root of its own; `zeros` is how often 0 is a root.

    mirrored: the conjugates are roots as well and are kept away from. Raises SolveError if some do not settle.
    """
    root = _apart(start)
    active = np.ones(len(root), dtype=bool)
    step = np.full(len(root), np.inf, dtype=np.complex128)
    for _ in range(SWEEPS):
        moving = np.flatnonzero(active)
        step[moving] = _steps(train, root, moving, zeros, lossy, mirrored)
        root[moving] += step[moving]
        active[moving] = ~(np.abs(step[moving]) <= CONVERGED * np.abs(root[moving]))
        if not active.any():
            return root
    _check_doubles(root, step, active)
    return root


def _steps(
    train: DampedTree, root: ComplexArray, moving: IntArray, zeros: int, lossy: float, mirrored: bool
) -> ComplexArray:
    here = root[moving]
    with np.errstate(all="ignore"):
        slope = log_derivative(train, here, lossy)
        lost = ~np.isfinite(slope)
        if lost.any():  # exactly on a pole of the elimination: a few eps aside there is none
            slope[lost] = log_derivative(train, here[lost] * (1 + 8 * EPS), lossy)
        gap = here[:, None] - root
        gap[gap == 0] = np.inf
        others = (1 / gap).sum(axis=1) + zeros / here
        if mirrored:
            gap = here[:, None] - root.conj()
            gap[gap == 0] = np.inf
            others += (1 / gap).sum(axis=1)
        step: ComplexArray = -1 / (slope - others)
    step[np.isinf(slope)] = 0
    step[~np.isfinite(step)] = 0.01 * np.abs(here[~np.isfinite(step)])
    return step


def _apart(start: ComplexArray) -> ComplexArray:
    """Starts of which no two are equal, none is zero: equal ones are moved by some 1e-7 of themselves."""
    root = np.array(start, dtype=np.complex128)
    root[root == 0] = 1e-3 * np.abs(root[root != 0]).min() if root.any() else 1.0
    same = np.abs(root[:, None] - root) <= 1e-9 * np.abs(root)
    copies = np.tril(same, -1).sum(axis=1)
    root *= 1 + 1e-7 * copies * np.exp(0.7j * copies)
    return root


def _check_doubles(root: ComplexArray, step: ComplexArray, active: np.ndarray) -> None:
    """What has not settled must be a double root (a coupling damped just critically)."""
    for number in np.flatnonzero(active):
        gap = np.abs(np.delete(root, number) - root[number]).min(initial=np.inf)
        if not (abs(step[number]) <= DOUBLE * abs(root[number]) and gap <= DOUBLE * abs(root[number])):
            raise SolveError(
                f"damped modes: no convergence in {SWEEPS} sweeps near {root[number]:.6g} rad/s; "
                "try undamped frequencies as start, or check the damping for misplaced powers of ten"
            )


def doubled(value: FloatArray | ComplexArray, tolerance: float) -> list[np.ndarray]:
    """Numbers of the values, ordered by modulus, in groups of neighbours closer than `tolerance` of themselves."""
    groups: list[list[int]] = []
    for number in np.argsort(np.abs(value), kind="stable"):
        home = next(
            (g for g in reversed(groups[-4:]) if abs(value[g[-1]] - value[number]) <= tolerance * abs(value[number])),
            None,
        )
        if home is None:
            groups.append([int(number)])
        else:
            home.append(int(number))
    return [np.array(group) for group in groups]
