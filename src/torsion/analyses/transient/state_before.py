"""How a train runs before its events: at rest, at a speed, in its steady state, or twisted and let go."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath

import numpy as np

from torsion.analyses.response.over_speed import response
from torsion.analyses.steady import Steady, steady
from torsion.analyses.transient.events import Point
from torsion.analyses.transient.transient_settings import PATH, TransientSettings
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.kernels.transient.torque_history import Piece
from torsion.kernels.tree_response import Status
from torsion.study import Study


@dataclass(frozen=True)
class State:
    """How the train runs before its events."""

    speed: float  # rad/s, reference
    mean: Steady | None
    torque: FloatArray  # (spans,) N m of the mean torques
    frequency: FloatArray  # (components,) rad/s of its steady vibration
    amplitude: ComplexArray  # (components, spans) N m
    twist: FloatArray  # (spans,) N m that twist it at rest and are released
    speeds: Mapping[str, float] = field(default_factory=dict)  # rad/s of points whose parts turn by themselves


def state_before(
    study: Study, system: System, settings: TransientSettings, place: Path = PATH, *, vibrates: bool = True,
    speed: float | None = None,
) -> State:  # fmt: skip
    """The state before the events; without its steady vibration where that is not `vibrates`.

    speed: rad/s of the steady state, in place of the operation's.
    """
    spans, operation = len(system.spans), study.operation
    initial = settings.initial if settings.initial is not None else "steady" if operation.speed else "rest"
    none = State(0.0, None, np.zeros(spans), np.empty(0), np.empty((0, spans), dtype=complex), np.zeros(spans))
    if initial == "rest":
        return none
    if isinstance(initial, dict) and "torque" in initial:
        twist, names = np.zeros(spans), [study.train.parts[part].name for part in system.span_part.tolist()]
        for name, torque in initial["torque"].items():
            here = [k for k, span in enumerate(system.spans) if name in (span.name, names[k])]
            if not here:
                hint = ", ".join(dict.fromkeys(names))
                raise InputError([Fault((*place, "initial", "torque", name), f"no span is called '{name}'", hint)])
            twist[here] = torque
        return replace(none, twist=twist)
    if isinstance(initial, dict):
        each = initial["speed"]
        return replace(none, speeds=each) if isinstance(each, dict) else replace(none, speed=each)
    if not (speed or operation.speed):
        fault = Fault((*place, "initial"), "a steady state needs a speed", "give `operation: rated`")
        raise InputError([fault])
    at = np.array([speed or operation.speed])
    mean = steady(study.train, system, operation, at) if operation.has_mean_torque else None
    state = replace(none, speed=float(at[0]), mean=mean, torque=none.torque if mean is None else mean.torque[:, 0])
    if not (study.excites and vibrates):
        return state
    vibration = response(study, system, speeds=at, refine=False)
    if (vibration.status != Status.OK).any():
        message = "its steady vibration at the operating speed has no finite value"
        raise SolveError(message, "give the damping of the train, or `initial: {speed: ...}`", (*place, "initial"))
    own = int(np.flatnonzero(vibration.speed == at[0])[0])
    return replace(state, frequency=2.0 * math.pi * vibration.frequency[own], amplitude=vibration.torque[own])


def loads_of_events(
    study: Study, system: System, settings: TransientSettings, before: State, place: Path = PATH
) -> tuple[Sequence[Sequence[Piece]], FloatArray]:
    """The torque of every event, and where each acts, (stations, events) per N m.

    Raises InputError for an event that the train cannot have.
    """
    loads, acting = list[tuple[Piece, ...]](), np.zeros((len(system.stations), len(settings.events)))
    faults = list[Fault]()
    for number, event in enumerate(settings.events):
        at, path = point(study, system, before, event.at), (*place, "events", number)
        station = study.train.part(event.at).stations[0]
        lack = event.body.lacks(at)
        if system.held[station]:
            lack = f"'{event.at}' is fixed, and no torque moves it", "name a point that turns"
        if lack is not None:
            faults.append(Fault((*path, event.body.key), *lack))
        else:
            loads.append(event.pieces(at))
            acting[station, number] = 1.0
    if faults:
        raise InputError(faults)
    return loads, acting


def point(study: Study, system: System, before: State, name: str) -> Point:
    """The train where an event acts."""
    part = study.train.part(name)
    station, rated = part.stations[0], study.operation.rated
    ratio = abs(float(system.speed_ratio[station]))
    power = part.power if part.power is not None else None if rated is None else rated.power
    torque = 0.0 if rated is None or power is None else power / (rated.speed * ratio)
    mean = 0.0 if before.mean is None else float(before.mean.applied[station, 0])
    blades = 0 if part.propeller is None or part.propeller.blades is None else part.propeller.blades
    return Point(name, before.speed * ratio, mean, torque, blades, part.is_clutch, FilePath(study.file).parent)
