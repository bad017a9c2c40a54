"""Floquet multipliers of many variants of one train side by side."""

import numpy as np

from torsion.analyses.motion.batch import Solution, Stack
from torsion.arrays import FloatArray
from torsion.kernels.periodic.monodromy import radau, step_matrices, steps_for

BEYOND = 1.5  # times the highest mode kept: what the steps resolve
STAGES = 4  # order 7: growth rates of a map need no more


def growths(stack: Stack, solution: Solution) -> FloatArray:
    """(variants,) 1/s of the fastest growing motion; NaN where no periodic motion was found."""
    loading, modes = solution.loading, len(stack.reduced.frequency)
    period, rule = loading.period, radau(STAGES)
    steps = steps_for(period, BEYOND * stack.reduced.highest)
    share = (np.arange(steps)[:, None] + rule.node).ravel() / steps
    around = solution.around
    mass, damping, stiffness = (
        _between(part, share).reshape(-1, steps, STAGES, modes, modes)
        for part in (around.mass, around.damping, around.stiffness)
    )
    each = step_matrices(mass, damping, stiffness, period / steps, rule)
    scale = np.concatenate([np.ones(modes), np.full(modes, loading.w0)])
    whole = each[:, 0]
    for k in range(1, steps):
        whole = each[:, k] @ whole
    whole = whole / scale[:, None] * scale
    known = _repeated(stack, solution) / scale
    if known.shape[1]:
        whole = _without(whole, np.einsum("pij,pkj->pki", whole, known))
    value = np.abs(np.linalg.eigvals(np.where(np.isfinite(whole), whole, 0.0))).max(axis=1)
    with np.errstate(divide="ignore"):
        return np.where(solution.is_found, np.log(value) / period, np.nan)


def _between(samples: FloatArray, share: FloatArray) -> FloatArray:
    """(variants, shares, modes, modes) periodic functions between even samples (modes, modes, variants, times)."""
    modes, _, variants, times = samples.shape
    found = samples.reshape(-1, times) @ _kernel(times, share).T
    return np.ascontiguousarray(found.reshape(modes, modes, variants, -1).transpose(2, 3, 0, 1))


def _kernel(times: int, share: FloatArray) -> FloatArray:
    """(shares, times) weights of the trigonometric interpolation on an odd number of even points."""
    apart = np.pi * (share[:, None] - np.arange(times) / times)
    below = np.sin(apart)
    near = np.abs(below) < 1e-14
    with np.errstate(divide="ignore", invalid="ignore"):
        weight = np.sin(times * apart) / (times * below)
    return np.where(near, 1.0, weight)


def _repeated(stack: Stack, solution: Solution) -> FloatArray:
    """(variants, motions, 2 modes) what repeats itself: all that turns, turning further, and what turns loosely."""
    whole, modes = stack.at.layout, len(stack.reduced.frequency)
    found = [solution.turning] if whole.floating and whole.free == len(whole.root) else []
    for group in whole.loose:
        share = stack.reduced.share(group.astype(float))
        found.append(np.tile(np.append(share, np.zeros(modes)), (len(stack.values), 1)))
    return np.stack(found, axis=1) if found else np.zeros((len(stack.values), 0, 2 * modes))


def _without(matrix: FloatArray, known: FloatArray) -> FloatArray:
    """(variants, size - motions, ...): each matrix beside eigenvectors (variants, motions, size) that are known."""
    turned = np.linalg.qr(np.swapaxes(known, 1, 2), mode="complete")[0]
    number = known.shape[1]
    return np.asarray((np.swapaxes(turned, 1, 2) @ matrix @ turned)[:, number:, number:])
