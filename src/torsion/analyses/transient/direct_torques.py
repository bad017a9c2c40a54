"""What a torque does at once, beside the modes: in rigid spans, and in those that end at points without inertia.

Modes say everything of an elastic span between inertias. A rigid span, or a point without inertia, carries its share of
a torque that acts there without any motion: the same at every frequency, and so the exact response at one frequency
less that of all modes.
"""

import math
from dataclasses import replace

import numpy as np

from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.response.solver import answer
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray
from torsion.assembly.system import System
from torsion.kernels.spanning_forest import connected


def massless(system: System) -> BoolArray:
    """(stations,) where nothing that is rigidly joined to the station has an inertia."""
    rigid = system.flexibility == 0.0
    group = connected(len(system.stations), system.driving[rigid], system.driven[rigid])
    total = np.zeros(len(group))
    np.add.at(total, group, system.inertia)
    return np.asarray(total[group] == 0.0)


def direct_torques(system: System, modes: Modes, acting: FloatArray, *, is_band: bool = False) -> FloatArray:
    """(spans, loads) N m at once under torques `acting` (stations, loads) N m at own speeds.

    is_band: higher modes are left out, and stand at once for what they carry, as far as they do so slowly.
    """
    found = np.zeros((len(system.spans), acting.shape[1]))
    without = massless(system)
    rows = np.flatnonzero(is_band | (system.flexibility == 0.0) | without[system.driving] | without[system.driven])
    loads = np.flatnonzero(acting.any(axis=0))
    if not (rows.size and loads.size):
        return found
    w = 2.0 * math.pi * modes.frequency
    at = 0.5 * float(w.min(initial=2.0))  # rad/s, far from every mode
    condensed, ratio = system.condensed, system.speed_ratio[:, None]
    force = np.zeros((condensed.tree.size, len(loads)), dtype=complex)
    np.add.at(force, condensed.node, ratio * acting[:, loads])
    none = np.zeros((len(system.stations), len(loads)))
    bare = replace(system, viscous=np.zeros(len(system.spans)), loss_factor=np.zeros(len(system.spans)), dampers=())
    whole = answer(bare, np.full(len(loads), at), Sources(force, None), none).torque.real.T
    moved = (modes.shape.T @ acting[:, loads]) / (w**2 - at**2)[:, None]
    found[np.ix_(rows, loads)] = whole[rows] - modes.torque[rows] @ moved
    return found
