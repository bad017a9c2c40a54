"""The balance of energy of a motion over time: what it lacks is the error of the whole computation."""

import math

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.damped_motion import Motion

CHECKED = 64  # windows in which the balance of energy is verified
GAUSS = 8


def residual(moved: Motion, time: FloatArray) -> float:
    """Largest error of energy + losses - work over short windows, by Gauss quadrature, of the largest energy.

    That is the largest of the motion's, and of what a torque by itself gives a mode: so a train that runs evenly, its
    torques against each other, has a scale too.
    """
    w, damping = moved.train.w_of_all, moved.train.damping
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    starts = np.linspace(0.0, float(time[-1]), CHECKED, endpoint=False)
    rates = [abs(term.rate) for terms in moved.coordinates.history.terms for term in terms]
    fastest = max(rates, default=0.0) + float(np.abs(moved.coordinates.root).max(initial=0.0))
    length = float(time[-1]) / max(CHECKED, fastest * float(time[-1]))
    later = np.append(moved.cuts, math.inf)[np.searchsorted(moved.cuts, starts, side="right")]
    ends = np.minimum(np.minimum(starts + length, np.append(starts[1:], float(time[-1]))), later)
    every = starts[:, None] + (ends - starts)[:, None] * np.concatenate(
        [[0.0], (nodes + 1.0) / 2.0, [1.0]]
    )
    every[:, -1] = ends
    at = every.ravel()
    place, speed = moved.at(at)
    loads = moved.loads_at(at)
    energy = 0.5 * (speed**2 + (w[:, None] * place) ** 2).sum(axis=0).reshape(CHECKED, -1)
    power = (
        ((moved.force @ loads - damping @ speed) * speed).sum(axis=0).reshape(CHECKED, -1)[:, 1:-1]
    )
    worst = float(
        np.abs(energy[:, -1] - energy[:, 0] - (ends - starts) / 2.0 * (power @ weights)).max()
    )
    largest, greatest = float(energy.max()), np.abs(loads).max(axis=1)
    lasts = 1.0 / np.maximum(
        w, 1.0 / length
    )  # s, in which a mode takes up a torque: a window, or its own time
    given = 0.5 * (np.abs(moved.force) * greatest * lasts[:, None]) ** 2
    largest = max(largest, float(given.max(initial=0.0)))
    return worst / largest if largest else 0.0
