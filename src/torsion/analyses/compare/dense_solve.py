"""The response as it is commonly computed: one dense dynamic stiffness a frequency, torques from differences."""

from dataclasses import dataclass

import numpy as np

from torsion.analyses.compare.loads import Load, Loaded
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.matrices import Matrices, matrices
from torsion.assembly.system import System


@dataclass(frozen=True)
class Dense:
    """A lumped system in full matrices."""

    given: Loaded
    view: Matrices
    node: FloatArray  # (tree stations, free) angle referred to one speed, of every free angle
    across: FloatArray  # (spans, free) twist of each span at its driving station's speed
    stiffness: ComplexArray  # (spans,) N m/rad with loss; 0 where rigid, for rigid spans have no such torque


def dense(given: Loaded) -> Dense:
    """The matrices of a lumped system, without damping to ground, which follows the speed."""
    system = given.system
    view = matrices(system, ground_damping=np.zeros(len(system.stations)))
    referred = view.basis / system.speed_ratio[:, None]
    node = np.zeros((system.folded.tree.size, referred.shape[1]))
    node[system.folded.node] = referred
    elastic = (system.flexibility > 0) & np.isfinite(system.flexibility)
    stiffness = np.divide(1.0, system.flexibility, out=np.zeros(len(elastic)), where=elastic)
    return Dense(given, view, node, system.twist(referred), stiffness * (1.0 + 1j * system.loss_factor))


def solved(full: Dense) -> list[ComplexArray]:
    """Torques (speeds, ends) N m of every harmonic, from `numpy.linalg.solve` at each frequency."""
    return [_of_line(full, load) for load in full.given.loads]


def _of_line(full: Dense, load: Load) -> ComplexArray:
    system, view = full.given.system, full.view
    turned = _imposed(system, load)
    force = full.node.T @ load.sources.force
    constant = view.stiffness + 1j * view.loss
    angle = np.empty((len(load.w), len(system.stations)), dtype=np.complex128)
    torque = np.empty((len(load.w), len(system.spans)), dtype=np.complex128)
    inertia = np.where(system.held, 0.0, system.inertia)
    for k, w in enumerate(load.w.tolist()):
        ground = load.ground[:, k]
        stiffness = constant - w * w * view.inertia + 1j * w * (view.damping + (view.basis.T * ground) @ view.basis)
        spring = full.stiffness + 1j * w * system.viscous
        own = turned[:, k] * system.speed_ratio
        twist = system.twist(turned[:, k, None])[:, 0]
        acting = force[:, k] + view.basis.T @ ((w * w * inertia - 1j * w * ground) * own)
        free = np.linalg.solve(stiffness, acting - full.across.T @ (spring * twist))
        angle[k] = view.basis @ free + own
        torque[k] = spring * (full.across @ free + twist)
    return full.given.ends.torque(load.w, angle, torque)


def _imposed(system: System, load: Load) -> ComplexArray:
    """(stations, frequencies) rad referred to one speed: how far joints displace what stands behind them, at rest."""
    folded, twist = system.folded, load.sources.twist
    angle = np.zeros((folded.tree.size, len(load.w)), dtype=np.complex128)
    if twist is not None:
        for station, parent in enumerate(folded.tree.parents):
            if parent >= 0:
                angle[station] = angle[parent] + twist[station]
    return np.asarray(angle[folded.node])
