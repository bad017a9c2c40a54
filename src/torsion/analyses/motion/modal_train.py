"""A train as rigid motions and modes for its motion over time: their shapes, what damps them, where they begin."""

import math
from dataclasses import replace
from typing import Literal

import numpy as np

from torsion.analyses.modes.modal_basis import massless, rigid_shapes
from torsion.analyses.motion.direct_torques import direct_torques
from torsion.analyses.motion.state_before import State
from torsion.analyses.motion.transient_settings import PATH
from torsion.analyses.response.solver import ground_damping
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Path, SolveError
from torsion.kernels.motion.damped_motion import ModalTrain
from torsion.study import Study

MOST_MODES = 3000
BAND = 50  # modes kept of a train of finite elements, where the file names no number


def kept_modes(
    system: System, count: int | Literal["all"], place: Path = PATH
) -> tuple[Modes, Modes]:
    """The certified elastic modes that are kept, and twice as many; both are the same where all are kept.

    A train with finite elements has no last mode: where all are requested, BAND of them are kept. Raises SolveError for
    a train too large for all.
    """
    if system.groups is not None:
        raise SolveError(
            "a shaft has too many segments for a transient response",
            "give it fewer `segments`",
            place,
        )
    size = system.condensed.tree.size
    if count == "all" and system.bars is None:
        if size > MOST_MODES:
            message = f"the transient response needs all modes, and the train has {size} stations, more than {MOST_MODES}"
            raise SolveError(message, "keep the lowest, for example `modes: 100`", place)
        found = modes_as_discretised(system, None)
        return found, found
    number = BAND if count == "all" else count
    found = modes_as_discretised(system, 2 * number)
    return lowest(found, number), found


def lowest(found: Modes, number: int) -> Modes:
    """The lowest modes alone."""
    rows = {name: getattr(found, name)[:number] for name in ("frequency", "lower", "upper")}
    columns = {name: getattr(found, name)[:, :number] for name in ("shape", "torque")}
    shafts = found.distributed
    if shafts is not None:
        shafts = replace(
            shafts, **{name: values[:, :number] for name, values in vars(shafts).items()}
        )
    return replace(found, **rows, **columns, distributed=shafts)


def shapes(system: System, found: Modes) -> FloatArray:
    """(stations, rigid motions + modes) rad at own speed, generalised inertia 1."""
    return np.concatenate([rigid_shapes(system), found.shape], axis=1)


def modal_train(
    study: Study,
    system: System,
    found: Modes,
    shape: FloatArray,
    before: State,
    *,
    turns: bool = False,
) -> ModalTrain:
    """The modes with what damps them: loss factors by their shares of the energy, viscous damping as it is.

    turns: the speed changes by itself; dampers to ground then damp the deviation from the motion of the train as one.
    """
    ratio = 0.5 * system.loss_factor @ found.elastic + system.modal_ratios(len(found.frequency))
    damping = np.zeros((shape.shape[1],) * 2)
    damped = np.flatnonzero(system.viscous > 0)
    if damped.size:
        twist = twists(system, found, shape, damped)
        damping += (system.viscous[damped, None] * twist).T @ twist
    if system.dampers:
        ground = ground_damping(system, np.array([before.speed]), before.mean)[:, 0]
        deviation = deviations(system, shape) if turns else shape
        damping += (ground[:, None] * deviation).T @ deviation
    return ModalTrain(2.0 * math.pi * found.frequency, ratio, damping)


def deviations(system: System, shape: FloatArray) -> FloatArray:
    """The shapes without the motion of the whole train as one, from which dampers to ground count."""
    return shape if system.held.any() else np.column_stack([np.zeros(len(shape)), shape[:, 1:]])


def twists(system: System, found: Modes, shape: FloatArray, spans: IntArray) -> FloatArray:
    """(spans, rigid motions + modes) rad at the driving station's speed: from torques, as angles would cancel."""
    rigid = shape.shape[1] - found.torque.shape[1]
    slips = np.isinf(system.flexibility[spans])
    twist = np.zeros((len(spans), shape.shape[1]))
    whole = 0 if system.held.any() else 1
    twist[:, rigid:] = (
        np.where(slips, 0.0, system.flexibility[spans])[:, None] * found.torque[spans]
    )
    ends = system.twist(shape / system.speed_ratio[:, None])[spans]
    ends[:, :whole] = 0.0
    return np.where(slips[:, None], ends, twist)


def start(
    system: System, found: Modes, before: State, shape: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Places and speeds of rigid motions and modes that deviate from the steady motion at time 0."""
    rigid = shape.shape[1] - found.torque.shape[1]
    place, speed = np.zeros(shape.shape[1]), np.zeros(shape.shape[1])
    if before.twist.any():
        flexibility = np.where(np.isfinite(system.flexibility), system.flexibility, 0.0)
        place[rigid:] = (
            found.torque.T @ (flexibility * before.twist) / (2.0 * math.pi * found.frequency) ** 2
        )
    return place, speed


def slowed_torques(
    study: Study,
    system: System,
    found: Modes,
    shape: FloatArray,
    before: State,
    *,
    turns: bool = False,
) -> FloatArray:
    """(spans, rigid motions + modes) N m s/rad: viscous torques in their spans, and what others carry of them at once.

    The loss factor of a span adds its share of the torque of every mode, as of a vibration at the mode's frequency.

    Raises SolveError for viscous damping at a point without inertia.
    """
    slowed, damped = (
        np.zeros((len(system.spans), shape.shape[1])),
        np.flatnonzero(system.viscous > 0),
    )
    slowed[damped] = system.viscous[damped, None] * twists(system, found, shape, damped)
    grounded = np.array([one.station for one in system.dampers], dtype=np.int64)
    without, ends = (
        massless(system),
        np.concatenate([system.driving[damped], system.driven[damped], grounded]),
    )
    if without[ends].any():
        name = study.train.parts[system.station_part[ends[without[ends]][0]]].name
        message = f"viscous damping acts at '{name}', a point without inertia"
        raise SolveError(message, "give the point an inertia, or use `loss_factor`", PATH)
    acting, ratio = np.zeros((len(system.stations), len(damped))), system.speed_ratio
    acting[system.driving[damped], np.arange(len(damped))] -= 1.0
    acting[system.driven[damped], np.arange(len(damped))] += (
        ratio[system.driving[damped]] / ratio[system.driven[damped]]
    )
    slowed += direct_torques(system, found, acting) @ slowed[damped]
    if grounded.size:
        stations, moves = np.unique(grounded), deviations(system, shape) if turns else shape
        ground = ground_damping(system, np.array([before.speed]), before.mean)[stations, 0]
        slowed -= direct_torques(system, found, np.eye(len(without))[:, stations]) @ (
            ground[:, None] * moves[stations]
        )
    rigid = shape.shape[1] - found.torque.shape[1]
    slowed[:, rigid:] += (
        system.loss_factor[:, None] * found.torque / (2.0 * math.pi * found.frequency)
    )
    return slowed
