"""The nonlinear couplings of a train as elements between its linear parts, and how they stand before the events."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from torsion.analyses.modes.mode_nodes import massless
from torsion.analyses.motion.events.events import Clutch, ramps
from torsion.analyses.motion.events.transient_settings import PATH, TransientSettings
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
from torsion.model.parts import NonlinearRecord, Part
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
