"""The balance of energy of a motion over time: what it lacks is the error of the whole computation."""

import math

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.motion.damped_motion import Motion

CHECKED = 64  # windows in which the balance of energy is verified
GAUSS = 8


def residual(motion: Motion, time: FloatArray) -> float:
    """Largest error of energy + losses - work over short windows, by Gauss quadrature, of the largest energy.

    That is the largest of the motion's, and of what a torque by itself gives a mode: so a train that runs evenly, its
    torques against each other, has a scale too.
    """
    w, damping, last = motion.train.w_of_all, motion.train.damping, float(time[-1])
    nodes, weights = np.polynomial.legendre.leggauss(GAUSS)
    starts = np.linspace(0.0, last, CHECKED, endpoint=False)
    rates = [abs(term.rate) for terms in motion.coordinates.history.terms for term in terms]
    fastest = max(rates, default=0.0) + float(np.abs(motion.coordinates.root).max(initial=0.0))
    length = last / max(CHECKED, fastest * last)
    cuts = np.append(motion.cuts, math.inf)[np.searchsorted(motion.cuts, starts, side="right")]
    ends = np.minimum(np.minimum(starts + length, np.append(starts[1:], last)), cuts)
    shares = np.concatenate([[0.0], (nodes + 1.0) / 2.0, [1.0]])
    times = starts[:, None] + (ends - starts)[:, None] * shares
    times[:, -1] = ends
    position, speed = motion.at(times.ravel())
    loads = motion.loads_at(times.ravel())
    energy = 0.5 * (speed**2 + (w[:, None] * position) ** 2).sum(axis=0).reshape(CHECKED, -1)
    power = ((motion.force @ loads - damping @ speed) * speed).sum(axis=0).reshape(CHECKED, -1)
    work = (ends - starts) / 2.0 * (power[:, 1:-1] @ weights)
    error = float(np.abs(energy[:, -1] - energy[:, 0] - work).max())
    # A mode takes up a torque in a window, or in its own time.
    lasts = 1.0 / np.maximum(w, 1.0 / length)
    impulse = np.abs(motion.force) * np.abs(loads).max(axis=1) * lasts[:, None]
    largest = max(float(energy.max()), float(0.5 * np.square(impulse).max(initial=0.0)))
    return error / largest if largest else 0.0
