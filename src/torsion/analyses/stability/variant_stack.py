"""Periodic motions and Floquet multipliers of many variants of one train side by side, on a few modes.

The variants lie behind one another on the axis of time: the equations of motion are those of one train.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.stability.equations_of_motion import (
    Loading,
    State,
    damper_matrices,
    entries,
    mean_angle,
    scaled,
    state,
)
from torsion.analyses.stability.mechanism import Layout, gathered
from torsion.analyses.stability.mechanism_loads import Scene, operating, rigid_deviation
from torsion.analyses.stability.straight_modes import Basis
from torsion.arrays import FloatArray
from torsion.kernels.periodic.harmonic_balance import Motion, motion_of
from torsion.kernels.periodic.hill import (
    from_real_parts,
    harmonics_of,
    real_blocks,
    real_parts,
    toeplitz,
)
from torsion.kernels.periodic.monodromy import (
    at_times,
    radau,
    rigid_motion,
    steps_for,
    through_steps,
)

SMALL = 1e-5  # relative step of Newton's method after which the next would be rounding
FOUND = 1e-3  # relative step at the end that is still a solution
MOST_STEPS = 16
SLOW = 0.1  # shrinking of the steps from which the matrix is renewed
FARTHEST = 10.0  # a larger step is none (rad, with inertias of the order of 1 kg m2)
LEFT_OUT = 1e-7  # q^harmonics
SAMPLES = 4  # points in time per harmonic
BEYOND = 1.5  # times the highest mode kept: what the steps resolve
STAGES = 4  # order 7: growth rates of a map need no more


Factors = list[tuple[float, FloatArray, FloatArray]]


@dataclass(frozen=True)
class Stack:
    """A train, its reduced modes, and how its variants differ."""

    at: Scene
    reduced: Basis
    vary: Callable[[FloatArray], Scene]
    values: FloatArray  # (variants,)
    uneven: float  # largest of all joints

    @property
    def count(self) -> int:
        """Harmonics kept."""
        share = float(max(self.at.layout.orders) / self.at.order)
        rank = np.log(LEFT_OUT) / np.log(self.uneven) if 0 < self.uneven < 1 else 1.0
        return int(max(5, np.ceil(rank * share) + 2))

    @property
    def times(self) -> int:
        """Points in time of a period, odd."""
        return SAMPLES * self.count + 1


@dataclass(frozen=True)
class Periodic:
    """Coefficients of the linearised equations of all variants on the modes, (modes, modes, variants, times)."""

    mass: FloatArray
    damping: FloatArray
    stiffness: FloatArray
    force: FloatArray  # (variants, modes * harmonics, loads) real parts: of the residual over each unknown load


@dataclass(frozen=True)
class Solution:
    """Periodic motions of all variants at one speed."""

    loading: Loading
    harmonic: FloatArray  # (variants, modes, 2 count + 1) real parts, of the share beside the rigid motion
    load: FloatArray  # (variants, loads)
    is_found: np.ndarray  # (variants,)
    around: Periodic
    turning: FloatArray  # (variants, 2 modes) the motion itself at time 0: rate and acceleration
    amplitude: FloatArray  # (variants,) rad, largest vibration of a coordinate, half range; NaN where none was found


def solve_stack(stack: Stack, speed: float, before: Solution | None) -> Solution:
    """The motions at a speed (rad/s), from those of a neighbouring speed.

    One matrix serves several steps as long as they shrink quickly; the first is that of the neighbouring speed.
    """
    variants, count, modes = len(stack.values), stack.count, len(stack.reduced.frequency)
    plain = operating(stack.at, speed)
    there = stack.vary(np.repeat(stack.values, stack.times))
    damping, torque = (
        scaled(plain.loading.damping, there.damping),
        scaled(plain.loading.torque, there.mean),
    )
    loading = replace(plain.loading, damping=damping, torque=torque)
    turned = np.tile(mean_angle(loading, stack.times), variants)
    rigid = rigid_deviation(there.layout, loading.steady, plain.twist[:, None] * there.mean, turned)
    base = motion_of(
        harmonics_of(rigid.reshape(-1, variants, stack.times), stack.times // 2),
        loading.w0,
        stack.times,
    )
    if before is None:
        mean = np.broadcast_to(there.mean, len(turned))[:: stack.times, None]
        harmonic, load, around = np.zeros((variants, modes, 2 * count + 1)), plain.load * mean, None
    else:
        harmonic, load, around = before.harmonic, before.load, before.around
    size, factors = np.full(variants, np.inf), None

    def moving() -> tuple[Motion, State]:
        motion = _motion(stack, base, harmonic, loading.w0)
        return motion, state(
            there.layout, loading, motion, np.repeat(load, stack.times, axis=0).T, turned
        )

    for _ in range(MOST_STEPS):
        motion, now = moving()
        if np.all(size < SMALL):
            break
        if factors is None:
            around = around or _periodic(stack, there.layout, loading, now)
            factors = _factored(stack, loading, around)
        lacking = _on_modes(stack, there.layout, now.turning.first * now.residual)
        move, change = _step(stack, factors, lacking)
        is_near = np.abs(move).max(axis=(1, 2)) < FARTHEST
        harmonic = harmonic + np.where(is_near[:, None, None], move, 0.0)
        load = load + np.where(is_near[:, None], change, 0.0)
        amplitude, shift = np.abs(harmonic).max(axis=(1, 2)), np.abs(move).max(axis=(1, 2))
        reached = np.where(amplitude > 0, shift / np.where(amplitude > 0, amplitude, 1.0), 0.0)
        if np.any((reached > SLOW * size) & (reached > SMALL)) or not is_near.all():
            factors, around = None, None
        size = np.where(is_near, reached, np.inf)
    found = size < FOUND
    if not found.all():
        harmonic, load = (
            np.where(found[:, None, None], harmonic, 0.0),
            np.where(found[:, None], load, plain.load),
        )
        motion, now = moving()
    around = _periodic(stack, there.layout, loading, now)
    first = [
        one.reshape(-1, variants, stack.times)[:, :, 0]
        for one in (speed + motion.speed, motion.acceleration)
    ]
    start = [stack.reduced.share(one).T for one in first]
    amplitude = np.where(
        found, half_range(motion.deviation.reshape(-1, variants, stack.times)), np.nan
    )
    return Solution(
        loading, harmonic, load, found, around, np.concatenate(start, axis=1), amplitude
    )


def half_range(deviation: FloatArray) -> FloatArray:
    """(...) rad: half of the largest range of a coordinate over the period, from (coordinates, ..., times)."""
    return np.asarray(np.ptp(deviation, axis=-1).max(axis=0) / 2.0)


def _motion(stack: Stack, base: Motion, harmonic: FloatArray, w0: float) -> Motion:
    """Rigid motion (coordinates, variants, times) and modes together, (coordinates, variants * times)."""
    modal = motion_of(
        from_real_parts(harmonic).swapaxes(0, 1), w0, stack.times
    )  # (modes, variants, times)
    shape, parts = stack.reduced.shape, zip(vars(base).values(), vars(modal).values(), strict=True)
    return Motion(
        *(rigid.reshape(len(rigid), -1) + shape @ one.reshape(len(one), -1) for rigid, one in parts)
    )


def _on_modes(stack: Stack, layout: Layout, onto: FloatArray) -> FloatArray:
    """(variants, modes * harmonics) real parts of what acts on the modes, from (bodies, variants * times)."""
    variants = len(stack.values)
    modal = (stack.reduced.shape.T @ gathered(layout, onto)).reshape(-1, variants, stack.times)
    return real_parts(harmonics_of(modal, stack.count)).transpose(1, 0, 2).reshape(variants, -1)


def _periodic(stack: Stack, layout: Layout, loading: Loading, now: State) -> Periodic:
    """The linearised equations on the modes."""
    shape, variants = stack.reduced.shape, len(stack.values)
    modes = shape.shape[1]
    whole = entries(layout, loading, now)
    outer = (
        (shape[whole.row][:, :, None] * shape[whole.column][:, None, :])
        .reshape(len(whole.row), -1)
        .T
    )
    free = layout.free  # the first entries are the coordinates' own, and they alone have mass
    form = (modes, modes, variants, stack.times)
    mass = (outer[:, :free] @ whole.mass[:free]).reshape(form)
    damping, stiffness = (
        (outer @ whole.damping).reshape(form),
        (outer @ whole.stiffness).reshape(form),
    )
    if layout.dampers.size.size:
        damp, stiff = (
            part.transpose(1, 2, 0).reshape(form) for part in damper_matrices(layout, now, shape)
        )
        damping, stiffness = damping + damp, stiffness + stiff
    force = np.empty((variants, modes * (2 * stack.count + 1), len(loading.drive)))
    for k, drive in enumerate(loading.drive):
        force[:, :, k] = -_on_modes(stack, layout, now.turning.first * drive[:, None])
    return Periodic(mass, damping, stiffness, force)


def _factored(stack: Stack, loading: Loading, around: Periodic) -> Factors:
    """The matrices of Newton's step, each with the largest element by which it is scaled."""
    from scipy.linalg.lapack import dgetrf

    variants, count = len(stack.values), stack.count
    number, modes, loads = 2 * count + 1, around.mass.shape[0], around.force.shape[2]
    w, upper = 1j * loading.w0 * np.arange(-count, count + 1), np.arange(count + 1)
    complex_blocks = toeplitz(around.stiffness, count, upper)
    complex_blocks += w * toeplitz(around.damping, count, upper)
    complex_blocks += w**2 * toeplitz(around.mass, count, upper)
    blocks = real_blocks(complex_blocks)
    total = modes * number
    factors = []
    for k in range(variants):
        whole = np.zeros((total + loads, total + loads), order="F")
        whole[:total, :total] = blocks[:, :, k].transpose(0, 2, 1, 3).reshape(total, total)
        scale = np.abs(whole).max()
        whole[:total, :total] /= scale
        whole[:total, total:] = around.force[k]
        for load in range(loads):
            whole[total + load, np.arange(modes) * number] = stack.reduced.shape[
                loading.steady[load]
            ]
        factors.append((scale, *dgetrf(whole, overwrite_a=True)[:2]))
    return factors


def _step(stack: Stack, factors: Factors, residual: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Newton's step of all variants: change of the modes' harmonics and of the loads; not a number where singular."""
    from scipy.linalg.lapack import dgetrs

    variants, total = residual.shape
    scale = np.array([[one[0]] for one in factors])
    found = np.zeros((variants, len(factors[0][1])))
    found[:, :total] = -residual / scale
    for k, (_, matrix, pivots) in enumerate(factors):
        found[k] = dgetrs(matrix, pivots, found[k])[0]
    found[~np.isfinite(found).all(axis=1)] = FARTHEST
    return found[:, :total].reshape(variants, -1, 2 * stack.count + 1), found[:, total:] * scale


def growths(stack: Stack, solution: Solution) -> FloatArray:
    """(variants,) 1/s of the fastest growing motion beside a drift of the mean speed; NaN without a periodic motion."""
    loading, modes = solution.loading, len(stack.reduced.frequency)
    period, rule = loading.period, radau(STAGES)
    steps = steps_for(period, BEYOND * stack.reduced.highest)
    share = (np.arange(steps)[:, None] + rule.node).ravel() / steps
    form = (len(stack.values), steps, STAGES, modes, modes)
    around = (solution.around.mass, solution.around.damping, solution.around.stiffness)
    mass, damping, stiffness = (
        np.ascontiguousarray(
            np.moveaxis(at_times(part.transpose(3, 2, 0, 1), share), 0, 1)
        ).reshape(form)
        for part in around
    )
    scale = np.concatenate([np.ones(modes), np.full(modes, loading.w0)])
    visited = list[FloatArray]()
    full = through_steps(mass, damping, stiffness, period / steps, rule, visited=visited)
    whole = full / scale[:, None] * scale
    known = _repeated(stack, solution) / scale
    if known.shape[1]:
        whole = _without(whole, np.einsum("pij,pkj->pki", whole, known))
    multipliers = np.linalg.eigvals(np.where(np.isfinite(whole), whole, 0.0))
    value = np.abs(multipliers)
    if stack.at.layout.floating:
        turns = np.isin(np.arange(stack.at.layout.free), stack.at.layout.floating[0])
        turning, inertia = stack.reduced.share(turns.astype(float)), mass.mean(axis=(1, 2))
        seen = np.array([np.broadcast_to(part, full.shape) for part in visited])
        for k in np.flatnonzero(solution.is_found).tolist():
            order = np.argsort(-value[k], kind="stable")
            rigid = rigid_motion(
                full[k], seen[:, k], multipliers[k, order], inertia[k], turning, loading.w0
            )
            if rigid is not None:
                value[k, order[rigid]] = 0.0
    with np.errstate(divide="ignore"):
        return np.where(solution.is_found, np.log(value.max(axis=1)) / period, np.nan)


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
