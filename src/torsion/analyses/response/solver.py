"""The answer of the train to one harmonic at many frequencies, told at the stations' own speeds."""

from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.response.harmonic_components import Sources
from torsion.analyses.steady import Steady
from torsion.analyses.undamped_modes import bar_torques, span_torques
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.kernels.tree import Tree
from torsion.kernels.tree_response import TreeResponse, complex_compliance, status, tree_response


@dataclass(frozen=True)
class Answer:
    """Complex amplitudes of one harmonic."""

    angle: ComplexArray  # (frequencies, stations) rad at own speed
    torque: ComplexArray  # (frequencies, spans) N m at the driving station's speed, elastic and damping share
    residual: FloatArray  # (frequencies,) relative
    status: np.ndarray  # (frequencies,) uint8: kernels.tree_response.Status


def answer(system: System, w: FloatArray, sources: Sources, damping: FloatArray) -> Answer:
    """The response at circular frequencies `w` (frequencies,) rad/s, with the sources' amplitudes at each of them.

    damping: (stations, frequencies) N m s/rad to ground at own speed.
    """
    folded = system.folded
    tree, closing = _tree(system), _closing(system)
    ground = np.zeros((tree.size, len(w)))
    ground[folded.node] = damping * (system.speed_ratio**2)[:, None]
    compliance = complex_compliance(tree.flexibility, folded.viscous, folded.loss_factor, w)
    if system.folded_bars is not None:
        loss = folded.loss_factor[system.folded_bars.node]
        found = tree_response(
            replace(tree, shafts=system.folded_bars), w, sources.force, twist=sources.twist, ground_damping=ground,
            compliance=compliance, shaft_loss=loss,
        )  # fmt: skip
        torque = bar_torques(system, found.torque, found.torque_outer)
    elif closing.size:
        found = _with_loops(system, tree, closing, w, sources, ground, compliance)
        torque = span_torques(system, found.torque, closing, found.chord_torque)
    else:
        found = tree_response(tree, w, sources.force, twist=sources.twist, ground_damping=ground, compliance=compliance)
        torque = span_torques(system, found.torque, closing, found.chord_torque)
    angle = found.angle[folded.node] * system.speed_ratio[:, None]
    return Answer(angle.T, torque.T, found.residual, status(found.amplification, found.residual))


def ground_damping(system: System, speed: FloatArray, steady: Steady | None) -> FloatArray:
    """(stations, speeds) N m s/rad at reference speeds (speeds,) rad/s; `steady` holds the same speeds.

    Raises InputError where a damping follows from the mean torque and that is not known.
    """
    following = [damper for damper in system.dampers if damper.torque_factor]
    if following and steady is None:
        name = system.stations[following[0].station].name
        message = f"the damping of '{name}' follows from the mean torque, which is not known"
        raise InputError([Fault(("operation", "rated", "power"), message, "give the rated speed and power")])
    applied = np.zeros((len(system.stations), len(speed))) if steady is None else steady.applied
    return system.ground_damping(speed, applied)


def _tree(system: System) -> Tree:
    """The tree without spans that have neither stiffness nor damping."""
    folded = system.folded
    loose = np.isinf(folded.tree.flexibility) & (folded.viscous == 0)
    if not loose.any():
        return folded.tree
    parent = np.where(loose, -1, folded.tree.parent)
    return replace(folded.tree, parent=parent, flexibility=np.where(loose, 0.0, folded.tree.flexibility))


def _closing(system: System) -> IntArray:
    """Spans that close loops with a stiffness or a damping."""
    extra = system.folded.extra
    return extra[np.isfinite(system.flexibility[extra]) | (system.viscous[extra] > 0)]


def _with_loops(
    system: System,
    tree: Tree,
    closing: IntArray,
    w: FloatArray,
    sources: Sources,
    ground: FloatArray,
    compliance: ComplexArray,
) -> TreeResponse:
    """The response with the spans `closing` that close loops."""
    from torsion.kernels.loops.looped_response import Chords, looped_response

    folded, ratio = system.folded, system.span_ratio[closing]
    flexibility, viscous = system.flexibility[closing] / ratio**2, system.viscous[closing] * ratio**2
    closing_compliance = complex_compliance(flexibility, viscous, system.loss_factor[closing], w)
    ends = folded.node[system.driving[closing]], folded.node[system.driven[closing]]
    loops = Chords(*ends, closing_compliance, twist=np.zeros(len(closing)))
    return looped_response(
        tree, loops, w, sources.force, twist=sources.twist, ground_damping=ground, compliance=compliance
    )
