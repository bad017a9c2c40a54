"""Damped natural frequencies and damping ratios."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.modes import modes, span_torques
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.steady import Steady
from torsion.assembly.segment_groups import SegmentGroups
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.tree import ComplexArray, FloatArray

MOST_STATIONS = 30_000  # rounding along more of them keeps the roots from settling to the accuracy asked of them
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

    def condensed(self, groups: SegmentGroups) -> "DampedModes":
        """The same at the stations and spans that stand for segment groups."""
        return replace(self, shape=self.shape[groups.stations], torque=self.torque[groups.spans])


def damped(system: System, *, speed: float, steady: Steady | None = None, count: int | None = 6) -> DampedModes:
    """The lowest `count` oscillating modes (None: all) at a reference speed (rad/s); `steady` holds that speed.

    Raises SolveError for a train with closed loops, shafts of distributed inertia or more than MOST_STATIONS stations,
    InputError where a damping needs a mean torque that is not known.
    """
    from torsion.kernels.damping.modes import damped_modes

    if system.bars is not None:
        message = f"damped modes of the model {system.model} are not built"
        raise SolveError(f"{message}; use the lumped model, the response is right with all of them")
    folded = system.folded
    if folded.extra.size:
        message = "damped modes of a train with closed loops, or held behind rigid spans at several points"
        raise SolveError(f"{message}, are not built; ask for `modes: {{damped: false}}`, the response is right")
    if folded.tree.size > MOST_STATIONS:
        raise SolveError(too_many_stations(system))
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


def too_many_stations(system: System) -> str:
    """Why the roots would not settle, and what to change; empty where they do."""
    size = system.folded.tree.size
    if size <= MOST_STATIONS:
        return ""
    most = max(system.segments, key=lambda name: system.segments[name], default="")
    change = f"; give `{most}` fewer segments" if most else ""
    return f"{size} stations, and rounding along more than {MOST_STATIONS} keeps the roots from settling{change}"
