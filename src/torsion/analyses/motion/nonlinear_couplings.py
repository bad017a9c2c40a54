"""The nonlinear couplings of a train as elements between its linear parts, and how they stand before the events."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.modes.modal_basis import massless
from torsion.analyses.motion.events import Clutch, ramps
from torsion.analyses.motion.transient_settings import PATH, TransientSettings
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.kernels.motion.piecewise_elements import (
    OPEN,
    Clearance,
    DelayedFriction,
    Element,
    Friction,
)
from torsion.kernels.motion.torque_history import Piece
from torsion.model.lowering import NonlinearRecord, Part
from torsion.train import Train


@dataclass(frozen=True)
class Coupling:
    """A nonlinear coupling: its part, its span, its record."""

    part: Part
    span: int
    record: NonlinearRecord


@dataclass(frozen=True)
class Standing:
    """An element with how it stands at time 0."""

    element: Element
    coupling: int
    twist: float  # rad
    regime: int


def couplings(train: Train, system: System) -> tuple[Coupling, ...]:
    """Of a train."""
    return tuple(
        Coupling(part, int(np.flatnonzero(system.span_part == number)[0]), part.nonlinear)
        for number, part in enumerate(train.parts)
        if part.nonlinear is not None
    )


def opened(system: System, found: tuple[Coupling, ...]) -> System:
    """The system without the couplings that can part or slip.

    Raises SolveError where an end of a nonlinear coupling has no inertia.
    """
    flexibility, viscous, loss = (
        one.copy() for one in (system.flexibility, system.viscous, system.loss_factor)
    )
    spans = [one.span for one in found if one.record.interrupts]
    flexibility[spans], viscous[spans], loss[spans] = math.inf, 0.0, 0.0
    bare = replace(system, flexibility=flexibility, viscous=viscous, loss_factor=loss)
    without = massless(bare)
    for one in found:
        if without[system.driving[one.span]] or without[system.driven[one.span]]:
            message = f"'{one.part.name}' ends at a point without inertia, and its backlash or friction needs an inertia"
            raise SolveError(
                message, "give the point, or a half of the coupling, an inertia", one.part.path
            )
    return bare


def capacity_pieces(settings: TransientSettings, one: Coupling) -> tuple[Piece, ...] | None:
    """The capacity of a clutch over time; None where no event changes it."""
    events = sorted(
        (
            (event.time, event.body)
            for event in settings.events
            if isinstance(event.body, Clutch) and event.at == one.part.name
        ),
        key=lambda pair: pair[0],
    )
    if not events:
        return None
    full = one.record.capacity or 0.0
    pieces = [Piece(0.0, events[0][0], 0.0 if events[0][1].begins_open else full)]
    for (begin, event), end in zip(
        events, [*(time for time, _ in events[1:]), math.inf], strict=True
    ):
        rows = event.rows(begin, full)
        after = [*ramps(rows), Piece(rows[-1][0], math.inf, rows[-1][1])]
        pieces += [replace(piece, end=min(piece.end, end)) for piece in after]
    return tuple(
        piece for piece in pieces if piece.end > piece.begin and (piece.level or piece.slope)
    )


def standing(
    number: int,
    one: Coupling,
    ends: FloatArray,
    torque: float,
    speed: FloatArray,
    signal: tuple[int, bool] | None,
) -> tuple[float, Iterator[Standing]]:
    """The torque that the linear spring of a coupling carries before the events, and its elements.

    ends: (rigid motions + modes,) of its relative angle. torque: N m that it carries in all. speed: of all motions.
    signal: of a clutch that events change, its capacity over time, and whether that is zero at first.
    """
    record, side = one.record, int(np.sign(torque))
    if record.capacity is not None:
        return 0.0, iter([_clutch(number, one, ends, torque, speed, signal)])
    twist = side * _twist_under(record, abs(torque))
    linear = 0.0 if record.play else record.stiffness * twist
    return linear, _elements(number, record, ends, twist)


def _clutch(
    number: int,
    one: Coupling,
    ends: FloatArray,
    torque: float,
    speed: FloatArray,
    signal: tuple[int, bool] | None,
) -> Standing:
    record, capacity = one.record, one.record.capacity or 0.0
    slipping = float(ends @ speed)
    slips = abs(slipping) > 1e-9 * float(np.abs(ends) @ np.abs(speed))
    regime = OPEN if signal is not None and signal[1] else int(np.sign(slipping)) if slips else 0
    if abs(torque) >= capacity or (torque and regime):
        message = f"the mean torque of {abs(torque):.6g} N m slips the clutch '{one.part.name}' before the events"
        hint = "begin with `initial: rest` or `{speed: ...}`, or give it more `capacity`"
        if torque:
            raise InputError([Fault((*PATH, "initial"), message, hint)])
    element = Friction(ends, record.stiffness, capacity, None if signal is None else signal[0])
    return Standing(element, number, torque / record.stiffness, regime)


def _elements(
    number: int, record: NonlinearRecord, ends: FloatArray, twist: float
) -> Iterator[Standing]:
    """What stands beside, or in place of, the spring of a coupling that is twisted so; friction carries nothing yet."""
    side = int(np.sign(twist))
    if record.play:
        touches = side if abs(twist) > record.play else 0
        yield Standing(
            Clearance(ends, record.stiffness, record.play, record.viscous), number, twist, touches
        )
    for torque, stiffness in record.friction:
        yield Standing(Friction(ends, stiffness, torque), number, 0.0, 0)
    for begin, stiffness, (torque, friction) in record.stages:
        yield Standing(
            Clearance(ends, stiffness, begin), number, twist, side if abs(twist) > begin else 0
        )
        if torque:
            yield Standing(DelayedFriction(ends, friction, torque, begin), number, 0.0, 0)


def _twist_under(record: NonlinearRecord, torque: float) -> float:
    """rad, of a torque > 0 on the springs alone; 0 under none."""
    if not torque:
        return 0.0
    begins = [
        (0.0, record.stiffness),
        *((begin, stiffness) for begin, stiffness, _ in record.stages),
    ]
    at, carried, total = 0.0, 0.0, 0.0
    for (begin, stiffness), (end, _) in zip(begins, [*begins[1:], (math.inf, 0.0)], strict=True):
        total += stiffness
        if carried + total * (end - begin) >= torque or math.isinf(end):
            at = begin + (torque - carried) / total
            break
        carried += total * (end - begin)
    return record.play + at
