"""Hill's matrix: linear equations with periodic coefficients on a basis of harmonics, and their Floquet exponents.

M(t) y'' + C(t) y' + K(t) y = 0 with period 2 pi/w0; y = exp(s t) sum_k u_k exp(i k w0 t), k = -count..count.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray

# Mean harmonic of a vector: one copy of each lies here, and no symmetry puts one at the ends.
CENTRED = (-0.4863, 0.5137)
KEPT = 1e-7  # relative: by how much a motion that solves the equations may miss that, each coordinate alone
APART = 1e-10  # of a motion that others combine to, less is left
DOUBLE = 1e-6  # of w0: exponents nearer to the one taken out are the same, and their vectors have no share of its own


@dataclass(frozen=True)
class Couplings:
    """Periodic coefficients as entries of the matrices M, C, K; entries of one place add up."""

    row: IntArray  # (entries,)
    column: IntArray  # (entries,)
    mass: FloatArray  # (entries, times) at evenly spaced times of one period
    damping: FloatArray  # (entries, times)
    stiffness: FloatArray  # (entries, times)
    hysteretic: FloatArray  # (entries,) adds i sign(frequency) times it; 0 where the others vary

    def full(self, shape: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return M, C and K of motions `shape` (size, motions), each (times, motions, motions)."""
        number, times = shape.shape[1], self.mass.shape[1]
        parts = np.concatenate([self.mass, self.damping, self.stiffness], axis=1)
        left, right = shape[self.row], shape[self.column]
        rows = [(left[:, [motion]] * right).T @ parts for motion in range(number)]
        sums = np.reshape(rows, (number, number, 3, times)).transpose(2, 3, 0, 1)
        mass, damping, stiffness = np.ascontiguousarray(sums)
        return mass, damping, stiffness


def harmonics_of(samples: FloatArray, count: int) -> ComplexArray:
    """Return (..., 2 count + 1) Fourier coefficients of a function sampled over its period (..., times).

    Those beyond what the samples resolve are 0, and all but the mean of a constant, to the last bit: the matrices that
    are made of them are as sparse as the train is where it does not change over the period.
    """
    times, rank = samples.shape[-1], np.arange(-count, count + 1)
    harmonic = np.zeros((*samples.shape[:-1], 2 * count + 1), dtype=complex)
    harmonic[..., count] = samples[..., 0]
    varies = (samples != samples[..., :1]).any(axis=-1)
    harmonic[varies] = (np.fft.fft(samples[varies]) / times)[..., rank % times]
    harmonic[..., np.abs(rank) > (times - 1) // 2] = 0.0
    return harmonic


def toeplitz(samples: FloatArray, count: int, rows: IntArray | None = None) -> ComplexArray:
    """Return (..., rows, 2 count + 1): multiplication by a periodic function, from -count..count to the harmonics `rows`.

    samples: (..., times), evenly spaced over the period; rows: the same harmonics unless given.
    """
    columns = np.arange(-count, count + 1)
    between = (columns if rows is None else rows)[:, None] - columns
    widest = int(np.abs(between).max())
    return np.asarray(harmonics_of(samples, widest)[..., between + widest])


def real_blocks(upper: ComplexArray) -> FloatArray:
    """Return (..., 2 count + 1, 2 count + 1) acting on what `real_parts` makes, from rows 0..count (..., rows, harmonics)."""
    count = upper.shape[-1] // 2
    right, left = upper[..., count:], upper[..., count::-1]
    out = np.empty((*upper.shape[:-2], 2 * count + 1, 2 * count + 1))
    out[..., : count + 1, 0], out[..., count + 1 :, 0] = (
        upper[..., count].real,
        upper[..., 1:, count].imag,
    )
    np.add(right[..., 1:].real, left[..., 1:].real, out=out[..., : count + 1, 1 : count + 1])
    np.add(
        right[..., 1:, 1:].imag, left[..., 1:, 1:].imag, out=out[..., count + 1 :, 1 : count + 1]
    )
    np.subtract(left[..., 1:].imag, right[..., 1:].imag, out=out[..., : count + 1, count + 1 :])
    np.subtract(
        right[..., 1:, 1:].real, left[..., 1:, 1:].real, out=out[..., count + 1 :, count + 1 :]
    )
    return out


def real_parts(harmonic: ComplexArray) -> FloatArray:
    """Return (..., 2 count + 1) mean, real parts and imaginary parts of harmonics -count..count of real functions."""
    count = harmonic.shape[-1] // 2
    return np.concatenate([harmonic[..., count:].real, harmonic[..., count + 1 :].imag], axis=-1)


Scattered = tuple[FloatArray, IntArray, IntArray]  # values, rows and columns of a sparse matrix


def scattered_apart(row: IntArray, column: IntArray, factors: ComplexArray) -> Scattered:
    """Return blocks that multiply each harmonic 0..count by a factor (entries, count + 1), on what `real_parts` makes."""
    count = factors.shape[1] - 1
    number = 2 * count + 1
    cosine, sine = np.arange(count + 1), np.arange(count + 1, number)
    above = np.concatenate([cosine, sine, cosine[1:], sine])
    along = np.concatenate([cosine, sine, sine, cosine[1:]])
    real, imaginary = factors.real, factors.imag[:, 1:]
    values = np.concatenate([real, real[:, 1:], -imaginary, imaginary], axis=1)
    entry, rank = np.nonzero(values)
    return (
        values[entry, rank],
        row[entry] * number + above[rank],
        column[entry] * number + along[rank],
    )


def hill_matrices(
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray, w0: float, count: int
) -> tuple[ComplexArray, ComplexArray, ComplexArray]:
    """Return H0, H1, H2, each (size (2 count + 1),) square: (H0 + s H1 + s^2 H2) u = 0 for harmonics -count..count.

    M, C, K: (times, size, size) at even times of the period.
    """
    w = 1j * w0 * np.arange(-count, count + 1)
    stiff, damp, inert = (
        toeplitz(np.moveaxis(part, 0, -1), count) for part in (stiffness, damping, mass)
    )
    total = len(w) * len(stiff)
    constant, linear, square = (
        blocks.swapaxes(1, 2).reshape(total, total)
        for blocks in (stiff + w * damp + w**2 * inert, damp + 2.0 * w * inert, inert)
    )
    return constant, linear, square


def hill_exponents(
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    w0: float,
    count: int,
    repeated: ComplexArray | None = None,
) -> tuple[ComplexArray, ComplexArray]:
    """Return the Floquet exponents (exponents,) 1/s by the eigenvalues of Hill's matrix, quadratic in s.

    And their vectors (exponents, size, harmonics).

    repeated: (motions, size, 2 count + 1) harmonics of what may solve the equations with s = 0. Those that do, to KEPT,
    and no combinations of others, are taken out beforehand: the exponent 0 is often a double one, that splits.

    Of the copies s + i k w0 of each, the one with its vector centred in the middle is kept: the truncation leaves it
    accurate.
    """
    number, size = 2 * count + 1, mass.shape[1]
    total = size * number
    constant, linear, inert = hill_matrices(mass, damping, stiffness, w0, count)
    left = np.zeros((2 * total, 2 * total), dtype=complex)
    left[:total, total:] = w0 * np.eye(total)
    left[total:, :total], left[total:, total:] = -constant / w0, -linear
    solving = _solving(
        constant, np.abs(np.diag(constant)) + w0**2 * np.abs(np.diag(inert)), repeated
    )
    right: ComplexArray | None = None
    if np.all(np.diagonal(mass, axis1=1, axis2=2) > 0):
        left[total:] = np.linalg.solve(inert, left[total:])
    else:  # a coordinate without inertia has infinite exponents
        right = np.eye(2 * total, dtype=complex)
        right[total:, total:] = inert
    value, vector = _eigen(np.asarray(left / w0, dtype=complex), right, solving, number)
    scale = np.abs(value) < 10.0 * number  # of w0; what lies beyond is infinite or not resolved
    value, shape = value[scale] * w0, vector[:total, scale].T.reshape(-1, size, number)
    weight = (np.abs(shape) ** 2).sum(axis=1)
    centre = weight @ np.arange(-count, count + 1) / weight.sum(axis=1)
    kept = (centre > CENTRED[0]) & (centre <= CENTRED[1])
    return value[kept], shape[kept]


def _solving(
    constant: ComplexArray, size: FloatArray, repeated: ComplexArray | None
) -> ComplexArray:
    """(2 total, motions) orthonormal: those of the known motions that solve the equations constant u = 0.

    size: (total,) of each equation's own coefficient, by which what a motion leaves becomes a deviation.
    """
    total = len(constant)
    basis = np.zeros((2 * total, 0), dtype=complex)
    for motion in [] if repeated is None else repeated.reshape(-1, total):
        if (np.abs(constant @ motion) / size).max() > KEPT * np.abs(motion).max():
            continue
        vector = np.append(motion, np.zeros(total)) / np.linalg.norm(motion)
        vector = vector - basis @ (basis.conj().T @ vector)
        if np.linalg.norm(vector) > APART:
            basis = np.column_stack([basis, vector / np.linalg.norm(vector)])
    return basis


def _eigen(
    left: ComplexArray, right: ComplexArray | None, solving: ComplexArray, harmonics: int
) -> tuple[ComplexArray, ComplexArray]:
    """Values and vectors (columns) of left x = value right x (right None: 1), without the null vectors `solving`.

    The equations are of real functions: in cosines and sines, in place of harmonics, the matrices are real, and their
    eigenvalues take a third of the time.
    """
    from scipy.linalg import eig

    of_cosines = _of_cosines(harmonics)
    of_harmonics = of_cosines.conj().T

    def turn(basis: ComplexArray, vectors: ComplexArray) -> ComplexArray:
        """Return vectors (columns), the harmonics of each coordinate in another basis."""
        parts = vectors.reshape(-1, harmonics, vectors.shape[1])
        return np.asarray((basis @ parts).reshape(vectors.shape))

    def in_cosines(matrix: ComplexArray) -> FloatArray:
        turned = turn(of_harmonics, matrix).reshape(-1, harmonics) @ of_cosines
        return np.ascontiguousarray(turned.reshape(matrix.shape).real)

    number = solving.shape[1]
    left_real, right_real = in_cosines(left), None if right is None else in_cosines(right)
    if not number:
        value, vector = eig(left_real, right_real, check_finite=False)
        return value, turn(of_cosines, np.asarray(vector, dtype=complex))
    null = turn(of_harmonics, solving).real
    turned = onto = np.linalg.qr(null, mode="complete")[0]
    weight = np.eye(len(left))
    if right_real is not None:
        onto = np.linalg.qr(right_real @ null, mode="complete")[0]
        weight = onto.T @ right_real @ turned
    left_real = onto.T @ left_real @ turned
    inner = np.s_[number:, number:]
    value, vector = eig(
        left_real[inner], None if right is None else weight[inner], check_finite=False
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.linalg.solve(
            weight[:number, :number],
            left_real[:number, number:] @ vector / value - weight[:number, number:] @ vector,
        )
    # A double one has none of its own.
    share = np.where(np.isfinite(share) & (np.abs(value) > DOUBLE), share, 0.0)
    return value, turn(of_cosines, turned @ np.concatenate([share, vector]))


@lru_cache(maxsize=8)
def _of_cosines(number: int) -> ComplexArray:
    """(number, number), unitary: harmonics -count..count of 1 and of each cosine and sine, all of one norm."""
    count = number // 2
    turning: ComplexArray = np.zeros((number, number), dtype=complex)
    turning[count, 0] = 1.0
    for rank in range(1, count + 1):
        turning[[count - rank, count + rank], 2 * rank - 1] = math.sqrt(0.5)
        turning[[count - rank, count + rank], 2 * rank] = 1j * math.sqrt(0.5), -1j * math.sqrt(0.5)
    return turning
