"""How far the first-order model of universal joints can be trusted: its own estimate of its error."""

import numpy as np

from torsion.analyses.response.harmonic_components import Excitation
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System


def joint_errors(system: System, excitation: Excitation, angle: ComplexArray) -> FloatArray:
    """(frequencies,) estimated relative error of a line that joints excite, from its angles (frequencies, stations).

    The model evaluates a joint's error e at the mean angle of its yokes. Terms of second order are left out: a joint
    changes the stiffness seen through it by 4 q at twice its speed, and a yoke that swings by x changes e by its slope
    times x. Acting twice, they come back at the same order with the square of both together, (2 q + 2 |x|)^2, of the
    largest joint. It is an estimate and no bound; in 40 cases of a train of two joints (3 to 30 degrees, off and at
    resonance, cancelling and adding) it was 1.3 to 32 times the error against the full non-linear solution.
    """
    worst = np.zeros(len(angle))
    for error in excitation.errors:
        swing = np.abs(angle[:, system.spans[error.span].driving])
        worst = np.maximum(worst, (2.0 * abs(error.amplitude) + error.order * swing) ** 2)
    return worst
