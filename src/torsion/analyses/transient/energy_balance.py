"""The balance of energy of a motion over time: what it lacks is the error of the whole computation."""

import math

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.transient.damped_motion import Motion

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
    worst, largest, greatest = 0.0, 0.0, np.zeros(moved.force.shape[1])
    cuts = moved.cuts
    for begin in starts.tolist():
        later = cuts[(cuts > begin)]
        end = min(begin + length, float(later[0]) if later.size else math.inf, float(time[-1]))
        at = np.concatenate([[begin], begin + (nodes + 1.0) / 2.0 * (end - begin), [end]])
        place, speed = moved.at(at)
        energy = 0.5 * (speed**2 + (w[:, None] * place) ** 2).sum(axis=0)
        loads = moved.loads_at(at)
        power = ((moved.force @ loads - damping @ speed) * speed).sum(axis=0)[1:-1]
        worst = max(worst, abs(energy[-1] - energy[0] - (end - begin) / 2.0 * float(weights @ power)))
        largest, greatest = max(largest, float(energy.max())), np.maximum(greatest, np.abs(loads).max(axis=1))
    lasts = 1.0 / np.maximum(w, 1.0 / length)  # s, in which a mode takes up a torque: a window, or its own time
    given = 0.5 * (np.abs(moved.force) * greatest * lasts[:, None]) ** 2
    largest = max(largest, float(given.max(initial=0.0)))
    return worst / largest if largest else 0.0
