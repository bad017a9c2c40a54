"""The response as a sum over modes of the undamped train, each damped by itself, with and without a static correction.

Craig and Kurdila, Fundamentals of Structural Dynamics (2006), chapter 11: mode displacement and mode acceleration.
"""

from dataclasses import dataclass

import numpy as np

from torsion.analyses.compare.loads import Load, Loaded, statically
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import ComplexArray, FloatArray

SLOW = 1e-7  # of the lowest frequency: its square is the relative error of the static torques


@dataclass(frozen=True)
class _Damped:
    """Modes with what damps each of them; what couples them is left out."""

    w: FloatArray  # (modes,) rad/s
    node: FloatArray  # (tree stations, modes) rad referred to one speed
    torque: FloatArray  # (spans, modes) N m
    loss_factor: FloatArray  # (modes,)
    viscous: FloatArray  # (modes,) 1/s, of the spans


def superposed(given: Loaded, count: int, *, corrected: bool) -> list[ComplexArray]:
    """Torques (speeds, ends) N m of every harmonic from the lowest `count` modes.

    corrected: the modes that are left out answer as slowly as they would to torques that do not change. Without it a
    line that joints excite has no answer (NaN): the modes alone do not add up to a twist that is imposed. Shafts of the
    system are exact: their torques at both ends are those of spans.
    """
    found = modes_as_discretised(given.system, count)
    damped = _damped(given, found)
    still = statically(given, SLOW * damped.w[0]) if corrected else [None] * len(given.loads)
    return [_of_line(given, damped, load, torque) for load, torque in zip(given.loads, still, strict=True)]


def _damped(given: Loaded, found: Modes) -> _Damped:
    system = given.system
    referred = found.shape / system.speed_ratio[:, None]
    node = np.zeros((system.folded.tree.size, referred.shape[1]))
    node[system.folded.node] = referred
    w = 2.0 * np.pi * found.frequency
    return _Damped(
        w, node, found.torque, system.loss_factor @ found.elastic, system.viscous @ system.twist(referred) ** 2
    )


def _of_line(given: Loaded, damped: _Damped, load: Load, still: ComplexArray | None) -> ComplexArray:
    system, (w, n), twist = given.system, (load.w, damped.w), load.sources.twist
    force = load.sources.force.T @ damped.node
    turned = np.zeros_like(force)
    if twist is not None:
        in_tree = np.flatnonzero(system.folded.span >= 0)
        factor = (system.folded.sign * system.span_ratio)[in_tree, None]
        turned = turned - twist[system.folded.span[in_tree]].T @ (factor * damped.torque[in_tree])
    angle = (damped.node[system.folded.node] * system.speed_ratio[:, None]).T
    viscous = damped.viscous + load.ground.T @ (angle.T**2)
    lossy = n**2 * (1.0 + 1j * damped.loss_factor)
    spring = lossy + 1j * np.outer(w, damped.viscous)  # a twist is resisted elastically and by damping
    amplitude = (force + spring * turned / n**2) / (lossy - (w * w)[:, None] + 1j * w[:, None] * viscous)
    at = given.ends
    share = 1.0 + 1j * (at.loss_factor + np.outer(w, at.delay))  # elastic and damping torque / elastic torque
    if still is not None:
        moved = amplitude - force / spring - turned / n**2
        return np.asarray(still[:, at.span] + share * (moved @ damped.torque[at.span].T))
    if twist is not None:
        return np.full((len(w), len(at.name)), np.nan, dtype=np.complex128)
    return np.asarray(share * (amplitude @ damped.torque[at.span].T))
