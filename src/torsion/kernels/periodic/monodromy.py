"""Floquet multipliers of linear equations with periodic coefficients by the monodromy matrix.

M(t) y'' + C(t) y' + K(t) y = 0 is taken through a period by collocation (Radau IIA): a coordinate without inertia is no
special case, and motions too fast for the step die out instead of growing.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.sources import source

STAGES = 7  # order 13
# rad: step times the highest frequency; damping of the method is then below 1e-13 a step.
ANGLE_PER_STEP = 1.5
FEWEST_STEPS = 16
MOST_STEPS = 4096
REAL = 1e-9  # of w0: an imaginary part of an exponent that is rounding
# Share of the whole train turning evenly beyond which a motion is one of its mean speed.
MOSTLY = 0.5
GONE = 1e-6  # factor over a period: what dies out so fast is no motion of the mean speed
CANDIDATES = 2  # fastest growing real exponents of which one may be that of the mean speed
MOST_NUMBERS = 4_000_000  # in memory at a time in the stage equations


@dataclass(frozen=True)
class Collocation:
    """Radau IIA: nodes in (0, 1], the last of them 1, and integrals of the Lagrange polynomials up to each node."""

    node: FloatArray  # (stages,)
    matrix: FloatArray  # (stages, stages)


@cache
def radau(stages: int = STAGES) -> Collocation:
    """Return the nodes (roots of P_{s-1} - P_s on (-1, 1], mapped to (0, 1]) and the matrix of the method."""
    from numpy.polynomial import legendre

    coefficients = np.zeros(stages + 1)
    coefficients[-2], coefficients[-1] = 1.0, -1.0
    root = np.sort(legendre.legroots(coefficients).real)
    slope = legendre.legder(coefficients)
    inner = root[:-1] - legendre.legval(root[:-1], coefficients) / legendre.legval(root[:-1], slope)
    node = (np.append(inner, 1.0) + 1.0) / 2.0
    x, weight = legendre.leggauss(stages)
    points = node[:, None] * (x + 1.0) / 2.0  # (upper limit, point)
    distance = node[:, None] - node + np.eye(stages)
    polynomials = np.empty((stages, stages, stages))
    for k in range(stages):
        other_nodes = np.delete(np.arange(stages), k)
        polynomials[k] = np.prod(
            (points[..., None] - node[other_nodes]) / distance[k, other_nodes], axis=-1
        )
    matrix = np.einsum("kip,p->ik", polynomials, weight) * node[:, None] / 2.0
    return Collocation(node, matrix)


def steps_for(period: float, highest: float) -> int:
    """Return the steps that resolve a highest frequency (rad/s) over the period (s), a multiple of FEWEST_STEPS."""
    needed = int(np.ceil(min(highest * period / ANGLE_PER_STEP, MOST_STEPS) / FEWEST_STEPS))
    return max(needed, 1) * FEWEST_STEPS


def at_times(samples: FloatArray, share: FloatArray) -> FloatArray:
    """Return (points, ...) a periodic function at shares of its period, from even samples (times, ...) by its Fourier sum."""
    times = len(samples)
    half = np.fft.rfft(samples.reshape(times, -1), axis=0) / times
    half[1:] *= 2.0
    if times % 2 == 0:
        half[-1] /= 2.0
    phase = 2.0 * np.pi * np.outer(share, np.arange(len(half)))
    out = np.cos(phase) @ half.real - np.sin(phase) @ half.imag
    return out.reshape(len(share), *samples.shape[1:])


@source("HairerWanner1996")
def monodromy(
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    period: float,
    steps: int,
    stages: int = STAGES,
    *,
    visited: list[FloatArray] | None = None,
) -> FloatArray:
    """Return (2 size, 2 size): what a period makes of (y, y'); M, C, K (times, size, size) at even times of the period (s).

    visited: as of `through_steps`.
    """
    rule, size = radau(stages), mass.shape[1]
    share = (np.arange(steps)[:, None] + rule.node).ravel() / steps
    samples = at_times(np.stack([mass, damping, stiffness], axis=1), share)
    at_nodes = samples.reshape(steps, stages, 3, size, size)
    mass, damping, stiffness = np.moveaxis(at_nodes, 2, 0)
    return through_steps(mass, damping, stiffness, period / steps, rule, visited=visited)


def through_steps(
    mass: FloatArray,
    damping: FloatArray,
    stiffness: FloatArray,
    h: float,
    rule: Collocation,
    *,
    visited: list[FloatArray] | None = None,
) -> FloatArray:
    """Return (..., 2 size, 2 size): what steps h (s) in a row make of (y, y'); M, C, K at the nodes of every step.

    Each is (..., steps, stages, size, size). visited: collects the same matrix at the beginning of each of FEWEST_STEPS
    equal parts of the steps, which must be a multiple of them.
    """
    steps = mass.shape[-4]
    unknowns = int(np.prod(mass.shape[:-4])) * (mass.shape[-3] * mass.shape[-1]) ** 2
    product, chunk = np.eye(2 * mass.shape[-1]), max(1, MOST_NUMBERS // unknowns)
    for first in range(0, steps, chunk):
        some = np.s_[..., first : first + chunk, :, :, :]
        step_products = step_matrices(mass[some], damping[some], stiffness[some], h, rule)
        for k in range(step_products.shape[-3]):
            if visited is not None and (first + k) % (steps // FEWEST_STEPS) == 0:
                visited.append(product)
            product = step_products[..., k, :, :] @ product
    return product


def step_matrices(
    mass: FloatArray, damping: FloatArray, stiffness: FloatArray, h: float, rule: Collocation
) -> FloatArray:
    """Return (..., 2 size, 2 size) of single steps h (s) from M, C, K at the nodes, each (..., stages, size, size).

    Unknown are the accelerations a at the nodes: v = v0 + h A a, y = y0 + h A v, M a + C v + K y = 0.
    """
    stages, size = mass.shape[-3], mass.shape[-1]
    lead, once = mass.shape[:-3], rule.matrix
    twice = once @ once
    blocks = h * once[:, None, :, None] * damping[..., :, :, None, :]
    blocks += h**2 * twice[:, None, :, None] * stiffness[..., :, :, None, :]
    diagonal = np.arange(stages)
    blocks[..., diagonal, :, diagonal, :] += np.moveaxis(mass, -3, 0)
    matrix = blocks.reshape(*lead, stages * size, stages * size)
    from_speed = damping + h * rule.node[:, None, None] * stiffness
    right = -np.concatenate([stiffness, from_speed], axis=-1).reshape(
        *lead, stages * size, 2 * size
    )
    accelerations = np.linalg.solve(matrix, right).reshape(*lead, stages, size, 2 * size)
    out = np.zeros((*lead, 2 * size, 2 * size))
    unit = np.eye(size)
    out[..., :size, :size], out[..., size:, size:] = unit, unit
    out[..., :size, size:] = h * unit
    out[..., :size, :] += h**2 * np.einsum("j,...jab->...ab", twice[-1], accelerations)
    out[..., size:, :] += h * np.einsum("j,...jab->...ab", once[-1], accelerations)
    return out


def rigid_motion(turns: FloatArray, share: Callable[[int], float]) -> int | None:
    """Return the position of the motion that is mostly an even turning of the whole train; None where there is none.

    turns: imaginary parts / w0 of the exponents, the fastest growing first; share: of such a turning in a motion.
    """
    real_motions = np.flatnonzero(np.abs(turns) <= REAL)[:CANDIDATES].tolist()
    share_of_best, best = max(((share(k), -k) for k in real_motions), default=(0.0, 0))
    return -best if share_of_best > MOSTLY else None


def exponents(multiplier: ComplexArray, period: float) -> ComplexArray:
    """Return (1/s) ln(multiplier)/period, imaginary part within pi/period of 0; a multiplier of 0 decays infinitely fast."""
    with np.errstate(divide="ignore"):
        return np.log(np.abs(multiplier)) / period + 1j * np.angle(multiplier) / period
