"""Damped natural frequencies and damping ratios."""

import math
from dataclasses import dataclass

import numpy as np

from torsion.analyses.modes import modes, span_torques
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import Steady
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.tree import ComplexArray, FloatArray

LARGEST_FOR_ALL = 150  # tree stations up to which all roots are found at once; beyond, those near undamped modes


@dataclass(frozen=True)
class DampedModes:
    """Oscillating modes of the damped train at one operating point."""

    frequency: FloatArray  # (modes,) Hz, imaginary part / 2 pi, ascending
    damping_ratio: FloatArray  # (modes,)
    eigenvalue: ComplexArray  # (modes,) 1/s
    shape: ComplexArray  # (stations, modes) rad at own speed
    torque: ComplexArray  # (spans, modes) N m
    overdamped: FloatArray  # (roots,) 1/s: real roots, which are no frequencies
    speed: float  # rad/s of the reference station, at which speed-dependent damping was taken


def damped(system: System, *, speed: float, steady: Steady | None = None, count: int | None = 6) -> DampedModes:
    """The lowest `count` oscillating modes (None: all) at a reference speed (rad/s); `steady` holds that speed.

    Raises SolveError for a train with closed loops or shafts of distributed inertia, InputError where a damping needs a
    mean torque that is not known.
    """
    from torsion.kernels.damping.damped_tree_modes import damped_modes

    if system.bars is not None:
        message = f"damped modes of the model {system.model} are not built"
        raise SolveError(f"{message}; use the lumped model, the response is right with all of them")
    folded = system.folded
    if folded.extra.size:
        message = "damped modes of a train with closed loops, or held behind rigid spans at several points"
        raise SolveError(f"{message}, are not built; ask for `modes: {{damped: false}}`, the response is right")
    own = ground_damping(system, np.array([speed]), steady)[:, 0]
    ground = np.zeros(folded.tree.size)
    ground[folded.node] = own * system.speed_ratio**2
    start = None
    if folded.tree.size > LARGEST_FOR_ALL:
        start = 2.0 * math.pi * modes(system, count).frequency
    found = damped_modes(
        folded.tree, ground_damping=ground, viscous=folded.viscous, loss_factor=folded.loss_factor, start=start
    )
    keep = np.argsort(found.eigenvalue.imag, kind="stable")[:count]
    eigenvalue = found.eigenvalue[keep]
    return DampedModes(
        eigenvalue.imag / (2.0 * math.pi),
        -eigenvalue.real / np.abs(eigenvalue),
        eigenvalue,
        found.angle[folded.node][:, keep] * system.speed_ratio[:, None],
        span_torques(system, found.torque[:, keep], np.empty(0, dtype=np.int64), np.empty((0, len(keep)))),
        found.real_root,
        speed,
    )
