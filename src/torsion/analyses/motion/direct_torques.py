"""What a torque does at once, beside the modes: in rigid spans, and in those that end at points without inertia.

Modes say everything of an elastic span between inertias. A rigid span, or a point without inertia, carries its share of
a torque that acts there without any motion: the same at every frequency, and so the exact response at one frequency
less that of all modes.
"""

import math

import numpy as np

from torsion.analyses.modes.modal_basis import beside_modes
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.response.solver import swept, undamped
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.assembly.system import System


def direct_torques(
    system: System, modes: Modes, acting: FloatArray, *, is_band: bool = False
) -> FloatArray:
    """(spans, loads) N m at once under torques `acting` (stations, loads) N m at own speeds.

    is_band: higher modes are left out, and stand at once for what they carry, as far as they do so slowly.
    """
    found = np.zeros((len(system.spans), acting.shape[1]))
    rows = np.flatnonzero(is_band | beside_modes(system)[1])
    loads = np.flatnonzero(acting.any(axis=0))
    if not (rows.size and loads.size):
        return found
    w = 2.0 * math.pi * modes.frequency
    at = 0.5 * float(w.min(initial=2.0))  # rad/s, far from every mode
    condensed, ratio = system.condensed, system.speed_ratio[:, None]
    force = np.zeros((condensed.tree.size, len(loads)), dtype=complex)
    np.add.at(force, condensed.node, ratio * acting[:, loads])
    none = np.zeros((len(system.stations), len(loads)))
    whole = swept(
        undamped(system), np.full(len(loads), at), Sources(force, None), none
    ).torque.real.T
    moved = (modes.shape.T @ acting[:, loads]) / (w**2 - at**2)[:, None]
    found[np.ix_(rows, loads)] = whole[rows] - modes.torque[rows] @ moved
    return found
