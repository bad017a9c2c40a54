"""How a train runs before its events: at rest, at a speed, in its steady state, or twisted and let go."""

import math
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.response.over_speed import response
from torsion.analyses.steady import Steady, steady
from torsion.analyses.transient.events import Event, Point
from torsion.analyses.transient.following_events import RatedPoint
from torsion.analyses.transient.transient_settings import PATH, TransientSettings
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
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
    angle: ComplexArray | None = None  # (components, stations) rad of its steady vibration, own shafts


def state_before(study: Study, system: System, settings: TransientSettings) -> State:
    """The state before the events."""
    spans, operation = len(system.spans), study.operation
    initial = settings.initial if settings.initial is not None else "steady" if operation.speed else "rest"
    none = State(0.0, None, np.zeros(spans), np.empty(0), np.empty((0, spans), dtype=complex), np.zeros(spans))
    if initial == "rest":
        return none
    if isinstance(initial, dict) and "torque" in initial:
        names = [span.name for span in system.spans]
        twist = np.zeros(spans)
        for name, torque in initial["torque"].items():
            if name not in names:
                raise InputError([Fault((*PATH, "initial"), f"no span is called '{name}'", ", ".join(names))])
            twist[names.index(name)] = torque
        return replace(none, twist=twist)
    if isinstance(initial, dict):
        return replace(none, speed=initial["speed"])
    if not operation.speed:
        fault = Fault((*PATH, "initial"), "a steady state needs a speed", "give `operation: rated`")
        raise InputError([fault])
    at = np.array([operation.speed])
    mean = steady(study.train, system, operation, at) if operation.has_mean_torque else None
    state = replace(none, speed=float(at[0]), mean=mean, torque=none.torque if mean is None else mean.torque[:, 0])
    if not study.excites:
        return state
    vibration = response(study, system, speeds=at, refine=False)
    if (vibration.status != Status.OK).any():
        message = "its steady vibration at the operating speed has no finite value"
        raise SolveError(message, "give the damping of the train, or `initial: {speed: ...}`", (*PATH, "initial"))
    own = int(np.flatnonzero(vibration.speed == at[0])[0])
    frequency, amplitude = 2.0 * math.pi * vibration.frequency[own], vibration.torque[own]
    return replace(state, frequency=frequency, amplitude=amplitude, angle=vibration.angle[own])


def points_of_events(study: Study, system: System, settings: TransientSettings, before: State) -> list[Point]:
    """The train where every event acts; raises InputError for one that it cannot have."""
    return [_point(study, system, before, event, number) for number, event in enumerate(settings.events)]


def _point(study: Study, system: System, before: State, event: Event, number: int) -> Point:
    """The train where an event acts."""
    part = study.train.part(event.at)
    station = part.stations[0]
    ratio = abs(float(system.speed_ratio[station]))
    rated = study.operation.rated
    power = part.power if part.power is not None else None if rated is None else rated.power
    blades = 0 if part.propeller is None or part.propeller.blades is None else part.propeller.blades
    path = (*PATH, "events", number, event.kind)
    if event.short_circuit is not None and (rated is None or power is None):
        raise InputError([Fault(path, "a short circuit needs the rated torque", "give `operation: rated`")])
    if event.ice is not None and not (blades and before.speed):
        raise InputError([Fault(path, "ice needs a turning propeller with `blades`", "give `blades` and a speed")])
    if event.speed is not None and not math.isclose(event.speed.program[0][1], before.speed * ratio, abs_tol=1e-12):
        found, runs = (
            f"{value * 30.0 / math.pi:.6g} rpm" for value in (event.speed.program[0][1], before.speed * ratio)
        )
        message = f"the program begins at {found}, and '{event.at}' runs at {runs}"
        raise InputError([Fault(path, message, "begin with that speed, or give `initial`")])
    mean = 0.0 if before.mean is None else float(before.mean.applied[station, 0])
    if event.stop is not None and not mean:
        raise InputError(
            [Fault(path, f"no mean torque acts at '{event.at}'", "name a motor or a load of a steady train")]
        )
    torque = 0.0 if rated is None or power is None else power / (rated.speed * ratio)
    at = Point(before.speed * ratio, mean, torque, blades, 0.0 if rated is None else rated.speed * ratio)
    if event.load is not None and event.load.lacks(RatedPoint(at.rated, at.rated_speed)):
        hint = "give `torque` and `speed` of the load, or `operation: {rated: {speed, power}}`"
        raise InputError([Fault(path, "the load has no size", hint)])
    return at
