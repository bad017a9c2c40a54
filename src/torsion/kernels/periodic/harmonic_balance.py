"""Harmonic balance: the periodic solution of non-linear equations by Newton's method with Hill's matrix as Jacobian."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.fft import next_fast_len

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.errors import SolveError
from torsion.kernels.periodic.hill import (
    Couplings,
    harmonics_of,
    real_blocks,
    real_parts,
    scattered_apart,
    toeplitz,
)

OVERSAMPLED = 6  # points in time per harmonic kept: products of up to six harmonics are not aliased
MOST_NEWTON = 40
KEPT = 1e-2  # of the residual: where a step leaves less, its factors serve the next one
GAINED = 0.1  # of the residual: what a step by the factors of another motion may leave of it
CLOSE = 1e-11  # of the amplitude: where less is missing, one more step reaches rounding
ROUNDING = 1e-14  # of the largest mean: smaller steps are rounding
HALVINGS = 12
MOST_UNKNOWNS = 40_000
SINGULAR = "the harmonic balance is singular; the train is in resonance without damping"


@dataclass(frozen=True)
class Motion:
    """Deviations of the coordinates at evenly spaced times of one period."""

    deviation: FloatArray  # (coordinates, times) rad
    speed: FloatArray  # (coordinates, times) rad/s
    acceleration: FloatArray  # (coordinates, times) rad/s2


@dataclass(frozen=True)
class Linearised:
    """Residual of the equations at a motion and its derivatives; `force` holds one load of unknown size a row."""

    residual: FloatArray  # (coordinates, times) N m
    entries: Couplings
    force: FloatArray  # (unknown loads, coordinates, times): derivative of the residual with respect to each
    extra: Sequence[
        tuple[int, int, ComplexArray]
    ] = ()  # (row, column, block): frequency-domain terms


@dataclass(frozen=True)
class Balance:
    """A periodic solution."""

    # (coordinates, 2 count + 1) rad; deviation = sum_k harmonic exp(i k w0 t)
    harmonic: ComplexArray
    load: FloatArray  # (unknown loads,)
    steps: int  # of Newton's method
    truncation: float  # estimated size of the harmonics left out / the largest one kept

    @property
    def count(self) -> int:
        """Highest harmonic that is kept."""
        return int(self.harmonic.shape[1] - 1) // 2


# Of a motion, the loads and how many harmonics are kept: the residual, and what returns it with its derivatives.
Equations = Callable[[Motion, FloatArray, int], tuple[FloatArray, Callable[[], Linearised]]]
Solve = Callable[[ComplexArray], tuple[ComplexArray, FloatArray]]


@dataclass
class Factors:
    """The factors of the last balance of a train: near that motion they serve the first steps to another one."""

    solve: Solve | None = None
    form: tuple[int, ...] = ()  # how many coordinates, harmonics and loads it changes


def motion_of(harmonic: ComplexArray, w0: float, times: int) -> Motion:
    """Return the deviation, speed and acceleration at `times` points of the period from harmonics (..., 2 count + 1)."""
    count = harmonic.shape[-1] // 2
    half = np.zeros((*harmonic.shape[:-1], times // 2 + 1), dtype=complex)
    half[..., : count + 1] = harmonic[..., count:]
    rate = 1j * w0 * np.arange(half.shape[-1])
    return Motion(*np.fft.irfft([half, half * rate, half * rate**2], times) * times)


def points_in_time(count: int) -> int:
    """Return the odd number of points of a period for harmonics up to `count`."""
    points = next_fast_len(OVERSAMPLED * count + 1)
    while points % 2 == 0:
        points = next_fast_len(points + 1)
    return int(points)


def balance(
    equations: Equations,
    start: ComplexArray,
    load: FloatArray,
    held: IntArray,
    w0: float,
    factors: Factors,
) -> Balance:
    """Return the periodic solution near `start` (coordinates, 2 count + 1) with frequency w0 (rad/s).

    load: first guess of the unknown loads; each goes with one coordinate of `held`, whose mean stays as it starts.
    factors: of another motion of the train; those of this one take their place. Raises SolveError where Newton's
    method finds no solution.
    """
    count = start.shape[1] // 2
    if start.size > MOST_UNKNOWNS:
        raise SolveError(
            f"a harmonic balance of {start.size} unknowns is too large; the common period is too long"
        )
    times = points_in_time(count)
    harmonic, load = np.array(start, dtype=complex), np.array(load, dtype=float)
    residual, derivatives = equations(motion_of(harmonic, w0, times), load, count)
    missing = harmonics_of(residual, count)
    size = np.linalg.norm(missing)
    last = False
    # Factors of another motion make a first guess at the least, and between close speeds every step.
    form = *harmonic.shape, len(load)
    solve = factors.solve if factors.form == form else None
    is_borrowed = solve is not None
    for step in range(1, MOST_NEWTON + 1):
        if solve is None:
            solve = _factorised(derivatives(), held, w0, count)
            is_borrowed = False
        move, change = solve(missing)
        for part in (0.5 ** np.arange(1 if is_borrowed else HALVINGS)).tolist():
            trial, trial_load = harmonic + part * move, load + part * change
            residual, slopes = equations(motion_of(trial, w0, times), trial_load, count)
            left = harmonics_of(residual, count)
            reached = np.linalg.norm(left)
            longest = float(np.abs(part * move).max())
            near = CLOSE * _amplitude(trial) + ROUNDING * float(np.abs(trial).max())
            is_close = bool(longest * reached <= near * size)  # if the next step gains as much
            if last or reached < (GAINED if is_borrowed else 1.0) * size or is_close:
                break
        else:
            if not is_borrowed:
                break
            solve = None
            continue
        last_size = size
        harmonic, load, size, missing, derivatives = trial, trial_load, reached, left, slopes
        if last:
            factors.solve, factors.form = solve, form
            return Balance(harmonic, load, step, _truncation(derivatives(), harmonic, w0, count))
        last = is_close and part == 1.0
        if part < 1.0 or (reached > KEPT * last_size and not last):
            solve = None
    raise SolveError(
        "no periodic solution found; smaller angles of the joints, more damping or closer speeds may lead to one"
    )


def _amplitude(harmonic: ComplexArray) -> float:
    """The largest of all harmonics but the means."""
    return float(np.abs(np.delete(harmonic, harmonic.shape[1] // 2, axis=1)).max(initial=0.0))


def _factorised(linear: Linearised, held: IntArray, w0: float, count: int) -> Solve:
    """Return what gives, of the harmonics of a residual, Newton's change of those of the motion and of the loads.

    The loads are further unknowns, the means of the coordinates `held` are fixed as further equations.
    """
    from scipy import sparse
    from scipy.sparse.linalg import splu

    size, number, loads = len(linear.residual), 2 * count + 1, len(held)
    entries = linear.entries

    # Coefficients that do not change over the period couple each harmonic with itself alone.
    coefficients = np.array([entries.mass, entries.damping, entries.stiffness])
    steady = (coefficients == coefficients[..., :1]).all(axis=(0, 2))
    mass, damping, stiffness = coefficients[:, steady, :1]
    harmonics = np.arange(count + 1)
    w = w0 * harmonics
    lossy = entries.hysteretic[steady, None] * np.sign(harmonics)
    factors = stiffness + 1j * (w * damping + lossy) - w**2 * mass
    matrix = [scattered_apart(entries.row[steady], entries.column[steady], factors)]

    # The others are full blocks, of which the rows of the harmonics 0..count report all.
    w = w0 * np.arange(-count, count + 1)
    inert, damp, stiff = toeplitz(coefficients[:, ~steady], count, harmonics)
    blocks = [*(stiff + 1j * w * damp - w**2 * inert)]
    blocks += [block[count:] for _, _, block in linear.extra]
    if blocks:
        row, column = (
            np.append(part[~steady], [block[side] for block in linear.extra]).astype(int)
            for side, part in enumerate((entries.row, entries.column))
        )
        full = real_blocks(np.array(blocks))
        entry, above, along = np.nonzero(full)
        places = row[entry] * number + above, column[entry] * number + along
        matrix.append((full[entry, above, along], *places))

    total = size * number
    force = real_parts(harmonics_of(linear.force, count)).reshape(loads, total).T
    values, row, column = (np.concatenate(part) for part in zip(*matrix, strict=True))
    largest = float(np.abs(values).max())
    rows, load = np.nonzero(force)
    values = np.concatenate([values / largest, force[rows, load], np.ones(loads)])
    row = np.concatenate([row, rows, total + np.arange(loads)])
    column = np.concatenate([column, total + load, held * number])
    form = total + loads, total + loads
    try:
        factor = splu(sparse.csc_matrix((values, (row, column)), shape=form), "MMD_AT_PLUS_A")
    except RuntimeError as error:
        raise SolveError(SINGULAR) from error

    def change_of(missing: ComplexArray) -> tuple[ComplexArray, FloatArray]:
        right = -real_parts(missing).ravel() / largest
        move = np.asarray(factor.solve(np.append(right, np.zeros(loads))))
        if not np.isfinite(move).all():
            raise SolveError(SINGULAR)
        parts = move[:total].reshape(size, number)
        above_mean = parts[:, 1 : count + 1] + 1j * parts[:, count + 1 :]
        change = np.concatenate([above_mean[:, ::-1].conj(), parts[:, :1], above_mean], axis=1)
        return change, move[total:] * largest

    return change_of


def _truncation(linear: Linearised, harmonic: ComplexArray, w0: float, count: int) -> float:
    """The largest harmonic left out / the largest kept, by what its residual moves each coordinate alone.

    A residual below the rounding of the forces it is the sum of says nothing and is left out.
    """
    size = len(linear.residual)
    spectrum = np.fft.rfft(linear.residual, axis=1)[:, count + 1 :] / linear.residual.shape[1]
    w = w0 * np.arange(count + 1, count + 1 + spectrum.shape[1])
    is_diagonal = linear.entries.row == linear.entries.column
    entries = linear.entries
    mass, damping, stiffness = (
        np.bincount(entries.row[is_diagonal], part[is_diagonal].mean(axis=1), size)
        for part in (entries.mass, entries.damping, entries.stiffness)
    )
    alone = np.abs(stiffness[:, None] - w**2 * mass[:, None] + 1j * w * damping[:, None])
    floor = np.maximum(alone, w**2 * mass[:, None] + 1e-3 * np.abs(stiffness)[:, None])
    # Rounding of the forces that each residual is the sum of.
    acts = np.abs(entries.stiffness).max(axis=1) * np.abs(harmonic).sum(axis=1)[entries.column]
    noise = np.bincount(entries.row, ROUNDING * acts, size)
    missed = (np.maximum(np.abs(spectrum) - noise[:, None], 0.0) / floor).max(initial=0.0)
    amplitude = _amplitude(harmonic)
    return float(missed / amplitude) if amplitude > 0 else 0.0
