"""The answer of a train with damping by mode to one harmonic: a sum over all modes, and the exact static rest.

A mode answers with force / (w_i**2 - w**2 + 2 i zeta_i w_i w), a rigid motion with -force / w**2. What rigid spans and
points without inertia carry beside that is the same at every frequency: the exact undamped answer at one, less the sum.
"""

import math
from collections.abc import Callable

import numpy as np

from torsion.analyses.modes.modal_basis import beside_modes, rigid_shapes
from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError

MOST_STATIONS = 3000  # of a train whose modes are all taken
PATH = ("damping",)


def modal_sums(
    system: System,
    w: FloatArray,
    sources: Sources,
    still: Callable[[FloatArray], tuple[ComplexArray, ComplexArray]],
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """Return angles (stations, frequencies), torques (spans, frequencies), how errors of data grow (frequencies,).

    At circular frequencies `w` (frequencies,) rad/s; still: angles and torques of the undamped train at others.

    Raises SolveError for a train of too many stations, or with distributed shafts or joints that excite.
    """
    modes, rigid = _basis(system)
    if sources.twist is not None or sources.loop_twist is not None:
        raise SolveError(
            "damping by mode does not support joints or meshes that excite",
            "give the components their damping",
            PATH,
        )
    mode_w = np.concatenate([np.zeros(rigid.shape[1]), 2.0 * math.pi * modes.frequency])[:, None]
    ratio = np.concatenate([np.zeros(rigid.shape[1]), system.modal_ratios(len(modes.frequency))])[
        :, None
    ]
    shape = np.concatenate([rigid, modes.shape], axis=1)
    torque = np.pad(modes.torque, ((0, 0), (rigid.shape[1], 0)))
    on_tree = np.zeros((system.condensed.tree.size, len(mode_w)))
    on_tree[system.condensed.node] = shape / system.speed_ratio[:, None]
    force = on_tree.T @ sources.force
    with np.errstate(divide="ignore", invalid="ignore"):
        denominator = mode_w**2 - w**2 + 2j * ratio * mode_w * w
        moved = force / denominator
        amplification = ((mode_w**2 + w**2) / np.abs(denominator)).max(axis=0, initial=1.0)
    angle = shape @ moved
    carried = torque @ moved
    stations, spans = beside_modes(system)
    if stations.any() or spans.any():
        far = 0.5 * float(mode_w[mode_w > 0.0].min(initial=2.0))  # rad/s, far from every mode
        all_angles, all_torques = still(np.full(len(w), far))
        slow = force / (mode_w**2 - far**2)
        angle[stations] += all_angles[stations] - shape[stations] @ slow
        carried[spans] += all_torques[spans] - torque[spans] @ slow
    return angle, carried, amplification


def _basis(system: System) -> tuple[Modes, FloatArray]:
    """Return all modes and the rigid motions of a system; computed once."""
    basis: tuple[Modes, FloatArray] | None = vars(system).get("modal_basis")
    if basis is None:
        if system.bars is not None or system.condensed.tree.size > MOST_STATIONS:
            message = f"damping by mode is for lumped trains of at most {MOST_STATIONS} stations"
            raise SolveError(message, "model: lumped, with fewer `segments`", PATH)
        vars(system)["modal_basis"] = basis = (
            modes_as_discretised(system, None),
            rigid_shapes(system),
        )
    return basis
