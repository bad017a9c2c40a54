"""The nonlinear couplings of a train as elements between its linear parts, and the train with them at its begin."""

import math
from collections.abc import Iterator
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from torsion.analyses.modes.mode_nodes import massless
from torsion.analyses.motion.events.events import Clutch, ramps
from torsion.analyses.motion.events.transient_settings import PATH, TransientSettings
from torsion.analyses.motion.train.following_torques import (
    carried_by_joints,
)
from torsion.analyses.motion.train.loaded_train import (
    Built,
    Coupling,
    Load,
    LoadedTrain,
    Standing,
    in_modes,
    load_train,
)
from torsion.analyses.motion.train.state_before import state_before, without_excluded_torques
from torsion.analyses.response.harmonic_components import amplitude, excitations
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.kernels.motion.loaded_modes import Piece
from torsion.kernels.motion.piecewise_elements import (
    OPEN,
    Clearance,
    DelayedFriction,
    Friction,
)
from torsion.kernels.trees.tree import connected
from torsion.model.parts import NonlinearRecord
from torsion.study import Study
from torsion.train import Train

LARGEST_ANGLE = 2e7  # rad of the fastest mode within the duration, up to which all modes are kept


def couplings(train: Train, system: System) -> tuple[Coupling, ...]:
    """Return the nonlinear couplings of a train."""
    return tuple(
        Coupling(part, int(np.flatnonzero(system.span_part == number)[0]), part.nonlinear)
        for number, part in enumerate(train.parts)
        if part.nonlinear is not None
    )


def opened(system: System, nonlinear: tuple[Coupling, ...]) -> System:
    """The system without the couplings that can part or slip.

    Raises SolveError where an end of a nonlinear coupling has no inertia.
    """
    # Nothing linear is left of a coupling with play, and of a clutch.
    spans = [
        coupling.span
        for coupling in nonlinear
        if coupling.record.play or coupling.record.capacity is not None
    ]
    changed = dict[str, Any]()
    for name, value in (("flexibility", math.inf), ("viscous", 0.0), ("loss_factor", 0.0)):
        changed[name] = getattr(system, name).copy()
        changed[name][spans] = value
    bare = replace(system, **changed)
    without = massless(bare)
    for coupling in nonlinear:
        if without[system.driving[coupling.span]] or without[system.driven[coupling.span]]:
            name = coupling.part.name
            message = f"'{name}' ends at a point without inertia, and its backlash or friction needs an inertia"
            hint = "give the point, or a half of the coupling, an inertia"
            raise SolveError(message, hint, coupling.part.path)
    return bare


def capacity_pieces(settings: TransientSettings, coupling: Coupling) -> tuple[Piece, ...] | None:
    """The capacity of a clutch over time; None where no event changes it."""
    clutches = [
        (event.time, event.body)
        for event in sorted(settings.events, key=lambda event: event.time)
        if isinstance(event.body, Clutch) and event.at == coupling.part.name
    ]
    if not clutches:
        return None
    full = coupling.record.capacity or 0.0
    times = [time for time, _ in clutches]
    # A clutch that closes first has no capacity before.
    pieces = [Piece(0.0, times[0], 0.0 if clutches[0][1].open is None else full)]
    for (begin, clutch), end in zip(clutches, [*times[1:], math.inf], strict=True):
        rows = clutch.rows(begin, full)
        after = [*ramps(rows), Piece(rows[-1][0], math.inf, rows[-1][1])]
        pieces += [replace(piece, end=min(piece.end, end)) for piece in after]
    return tuple(
        piece for piece in pieces if piece.end > piece.begin and (piece.level or piece.slope)
    )


def standing(
    number: int,
    coupling: Coupling,
    ends: FloatArray,
    torque: float,
    speed: FloatArray,
    signal: tuple[int, bool] | None,
) -> tuple[float, list[Standing]]:
    """The torque that the linear spring of a coupling carries before the events, and its elements.

    ends: (rigid motions + modes,) of its relative angle. torque: N m that it carries in all. speed: of all motions.
    signal: of a clutch that events change, its capacity over time, and whether that is zero at first.
    """
    record, side = coupling.record, int(np.sign(torque))
    if record.capacity is None:
        twist = side * _twist_under(record, abs(torque))
        linear = 0.0 if record.play else record.stiffness * twist
        return linear, list(_elements(number, record, ends, twist))

    slipping = float(ends @ speed)
    slips = abs(slipping) > 1e-9 * float(np.abs(ends) @ np.abs(speed))
    regime = OPEN if signal is not None and signal[1] else int(np.sign(slipping)) if slips else 0
    if torque and (abs(torque) >= record.capacity or regime):
        name = coupling.part.name
        message = (
            f"the mean torque of {abs(torque):.6g} N m slips the clutch '{name}' before the events"
        )
        hint = "begin with `initial: rest` or `{speed: ...}`, or give it more `capacity`"
        raise InputError([Fault((*PATH, "initial"), message, hint)])
    element = Friction(ends, record.stiffness, record.capacity, signal and signal[0])
    return 0.0, [Standing(element, number, torque / record.stiffness, regime)]


def _elements(
    number: int, record: NonlinearRecord, ends: FloatArray, twist: float
) -> Iterator[Standing]:
    """What stands beside, or in place of, the spring of a coupling that is twisted so; friction carries nothing yet."""

    def contact(stiffness: float, half: float, viscous: float = 0.0) -> Standing:
        touches = int(np.sign(twist)) if abs(twist) > half else 0
        return Standing(Clearance(ends, stiffness, half, viscous), number, twist, touches)

    if record.play:
        yield contact(record.stiffness, record.play, record.viscous)
    for torque, stiffness in record.friction:
        yield Standing(Friction(ends, stiffness, torque), number, 0.0, 0)
    for begin, stiffness, (torque, friction) in record.stages:
        yield contact(stiffness, begin)
        if torque:
            yield Standing(DelayedFriction(ends, friction, torque, begin), number, 0.0, 0)


def _twist_under(record: NonlinearRecord, torque: float) -> float:
    """rad, of a torque > 0 on the springs alone; 0 under none."""
    if not torque:
        return 0.0
    springs = [(0.0, record.stiffness), *((begin, k) for begin, k, _ in record.stages)]
    ends = [*(begin for begin, _ in springs[1:]), math.inf]
    carried = total = 0.0
    for (begin, stiffness), end in zip(springs, ends, strict=True):
        total += stiffness
        if math.isinf(end) or carried + total * (end - begin) >= torque:
            break
        carried += total * (end - begin)
    return record.play + begin + (torque - carried) / total


def build(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path,
    *,
    damping_ratio: float | None = None,
    halved: bool = False,
    speed: float | None = None,
) -> Built:
    """The train with its nonlinear couplings in modes of its linear parts.

    halved: with half the band of modes that would be kept. speed: of a steady state (rad/s of the reference station),
    in place of the operation's.
    """
    study, system = without_excluded_torques(study, system, settings)
    nonlinear = couplings(study.train, system)
    if speed is not None and (settings.changes_speed or system.uneven_joints.size):
        message = "the joints of the train turn unevenly, and a settled vibration with them is not supported yet"
        raise SolveError(message)
    before = state_before(study, system, settings, path, vibrates=False, speed=speed)
    loaded = load_train(
        study,
        system,
        settings,
        path,
        before,
        opened=partial(opened, nonlinear=nonlinear),
        damping_ratio=damping_ratio,
        is_settled=speed is not None,
    )
    if loaded.cuts and before.speeds:
        message = "parts at different speeds together with uneven joints are not supported yet"
        hint = "begin with `initial: rest` or `{speed: ...}`"
        raise SolveError(message, hint, (*path, "initial"))
    loads = [*loaded.loads, *_steady_torques(system, loaded, has_orders=speed is not None)]
    nothing, capacities = np.zeros(len(system.stations)), dict[int, tuple[int, bool]]()
    for number, coupling in enumerate(nonlinear):
        capacity = capacity_pieces(settings, coupling)
        if capacity is not None:
            begins_at_zero = not any(piece.begin == 0.0 for piece in capacity)
            capacities[number] = len(loads), begins_at_zero
            loads.append(Load(capacity, nothing))
    loaded = replace(loaded, loads=tuple(loads))

    turning = _speeds_of_parts(study, loaded)
    twists = loaded.twists(np.array([coupling.span for coupling in nonlinear]))
    torques, elements = before.torque + before.twist, list[Standing]()
    for number, coupling in enumerate(nonlinear):
        torque = float(torques[coupling.span])
        torques[coupling.span], stands = standing(
            number, coupling, twists[number], torque, turning, capacities.get(number)
        )
        elements += stands
    flexibility = loaded.system.flexibility
    start = loaded.positions(np.where(np.isfinite(flexibility), flexibility, 0.0) * torques)
    # As many modes as requested, and as the duration allows.
    highest = np.array([1.0, 0.5]) * LARGEST_ANGLE / settings.duration
    kept, half = np.searchsorted(loaded.w, highest).tolist()
    if settings.modes != "all":
        kept, half = min(kept, settings.modes), min(half, settings.modes // 2)
    kept = max(min(half, kept - 1), 0) if halved else kept
    # Inside finite elements the torque is not that of the modes alone.
    is_fem = loaded.system.bars is not None
    return in_modes(loaded, start, turning, nonlinear, tuple(elements), kept=kept, is_band=is_fem)


def _steady_torques(system: System, loaded: LoadedTrain, *, has_orders: bool) -> Iterator[Load]:
    """The mean torques before the events, and of a train that vibrates steadily its periodic ones.

    has_orders: it turns at one speed, at which orders have frequencies.
    """
    before = loaded.before
    if before.mean is not None:
        _, carried, of_joints = carried_by_joints(system, loaded.follows or ())
        acting = before.mean.applied[:, 0] + of_joints
        yield Load((Piece(0.0, math.inf, 1.0),), acting, carried)
    speed = np.array([before.speed])
    for excitation in excitations(system) if has_orders else ():
        vibrating = np.zeros(len(system.stations), dtype=complex)
        for torque in excitation.torques:
            vibrating[torque.station] += amplitude(system, torque, speed, before.mean)[0]
        rate = 1j * float(excitation.line.circular_frequency(speed)[0])
        for factor, column in ((1.0, vibrating.real), (1j, vibrating.imag)):
            yield Load((Piece(0.0, math.inf, factor, rate=rate),), column)


def _speeds_of_parts(study: Study, loaded: LoadedTrain) -> FloatArray:
    """(rigid motions + modes,) of parts that turn at speeds of their own, those of their named points."""
    bare, turning = loaded.system, np.zeros(len(loaded.shape))
    finite = np.isfinite(bare.flexibility)
    part = connected(len(turning), bare.driving[finite], bare.driven[finite])
    for name, speed in loaded.before.speeds.items():
        station = study.train[name].stations[0]
        members = part == part[station]
        turning[members] = speed * bare.speed_ratio[members] / bare.speed_ratio[station]
    inertia = np.where(bare.held, 0.0, bare.lumped_inertia)
    return np.asarray(loaded.shape.T @ (inertia * turning))
