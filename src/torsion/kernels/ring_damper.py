"""Optimum of a ring on one undamped mode: the damper seen from the inertia that the mode has at its housing.

A ring of inertia mu J, by a stiffness mu J (f w)^2 and a damping 2 mu J w z, on an inertia J that vibrates at w alone.
Its greatest angle over the static one is that of X(g), g the frequency in w, with g^2 = x (Den Hartog 1956, 3.20):
    |X|^2 = ((f^2 - x)^2 + 4 z^2 x) / (((1 - x)(f^2 - x) - mu f^2 x)^2 + 4 z^2 x (1 - x - mu x)^2)
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.polynomial import Polynomial

from torsion.sources import source


class Optimum(NamedTuple):
    """Settings of a ring that make the greatest magnification of the mode smallest."""

    tuning: float  # f: frequency of the ring by itself / that of the mode; 0 without stiffness
    damping: float  # z = c / (2 J_ring w)
    magnification: float


@source("DenHartog1956", "eq. 3.21")
def viscous(ratio: float) -> Optimum:
    """Of a ring without stiffness, of `ratio` = its inertia / that of the mode (Den Hartog 1956, 3.21).

    >>> round(viscous(1.0).damping, 9), viscous(1.0).magnification
    (0.288675135, 3.0)
    """
    return Optimum(0.0, 1.0 / math.sqrt(2.0 * (1.0 + ratio) * (2.0 + ratio)), (2.0 + ratio) / ratio)


@source("NishiharaAsami2002")
def tuned(ratio: float) -> Optimum:
    """Of a ring on a spring: the exact minimum of the greatest magnification (Nishihara and Asami 2002)."""
    root = math.sqrt(4.0 + 3.0 * ratio)
    above = 16.0 + 23.0 * ratio + 9.0 * ratio**2 + 2.0 * (2.0 + ratio) * root
    tuning = (
        2.0
        / (1.0 + ratio)
        * math.sqrt(2.0 * above / (3.0 * (64.0 + 80.0 * ratio + 27.0 * ratio**2)))
    )
    damping = tuning / 4.0 * math.sqrt((8.0 + 9.0 * ratio - 4.0 * root) / (1.0 + ratio))
    return Optimum(tuning, damping, magnification(ratio, tuning, damping))


def magnification(ratio: float, tuning: float, damping: float, loss_factor: float = 0.0) -> float:
    """Greatest angle of the mode over its static one; infinite without damping.

    The loss factor is that of the ring's stiffness: k (1 + i eta).
    """
    square = tuning**2
    if damping == 0.0 and square * loss_factor == 0.0:
        return math.inf
    g = Polynomial([0.0, 1.0])
    x, imaginary = g * g, square * loss_factor + 2.0 * damping * g
    above = (square - x) ** 2 + imaginary**2
    below = ((1.0 - x) * (square - x) - ratio * square * x) ** 2 + (
        imaginary * (1.0 - x - ratio * x)
    ) ** 2
    roots = (above.deriv() * below - above * below.deriv()).roots()
    real = np.append(
        roots[(np.abs(roots.imag) < 1e-6 * np.abs(roots)) & (roots.real > 0)].real, 1.0
    )
    with np.errstate(divide="ignore"):  # of a seized ring, whose damping is less than rounding
        return float(np.sqrt(np.max(above(real) / below(real))))
