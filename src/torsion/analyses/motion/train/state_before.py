"""How a train runs before its events: at rest, at a speed, in its steady state, or twisted and let go."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath

import numpy as np

from torsion.analyses.motion.events.event_kind import Lack, Point
from torsion.analyses.motion.events.events import Event, Stop
from torsion.analyses.motion.events.following_events import Load, SpeedProgram, Start
from torsion.analyses.motion.events.short_circuit import ShortCircuit
from torsion.analyses.motion.events.transient_settings import PATH, TransientSettings
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.over_speed import response
from torsion.analyses.steady import Steady, steady
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.kernels.trees.tree_response import Status
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
    # (components, stations) rad of its steady vibration, own shafts
    angle: ComplexArray | None = None
    # rad/s of points whose parts turn by themselves
    speeds: Mapping[str, float] = field(default_factory=dict)


def state_before(
    study: Study,
    system: System,
    settings: TransientSettings,
    path: Path = PATH,
    *,
    vibrates: bool = True,
    speed: float | None = None,
) -> State:
    """The state before the events; without its steady vibration where that is not `vibrates`.

    speed: rad/s of the steady state, in place of the operation's. Raises InputError where a steady state has no speed
    or an initial twist no span, SolveError where the steady vibration has no finite value.
    """
    operation, none = study.operation, np.zeros(len(system.spans))
    initial, path = settings.initial, (*path, "initial")
    if initial is None:
        initial = "steady" if operation.speed else "rest"
    standstill = State(0.0, None, none, none[:0], np.empty((0, len(none)), dtype=complex), none)
    if initial == "rest":
        return standstill
    if isinstance(initial, dict) and "torque" in initial:
        twist, names = none.copy(), [study.train.parts[part].name for part in system.span_part]
        for name, torque in initial["torque"].items():
            spans = [k for k, span in enumerate(system.spans) if name in (span.name, names[k])]
            if not spans:
                hint = ", ".join(dict.fromkeys(names))
                message = f"no span is called '{name}'"
                raise InputError([Fault((*path, "torque", name), message, hint)])
            twist[spans] = torque
        return replace(standstill, twist=twist)
    if isinstance(initial, dict):
        given = initial["speed"]
        return replace(standstill, **{"speeds" if isinstance(given, dict) else "speed": given})
    if not (speed or operation.speed):
        fault = Fault(path, "a steady state needs a speed", "give `operation: rated`")
        raise InputError([fault])
    speeds = np.array([speed or operation.speed])
    mean = steady(study.train, system, operation, speeds) if study.has_mean_torque else None
    torque = none if mean is None else mean.torque[:, 0]
    state = replace(standstill, speed=float(speeds[0]), mean=mean, torque=torque)
    if not (study.excites and vibrates):
        return state
    vibration = response(study, system, speeds=speeds, refine=False)
    if (vibration.status != Status.OK).any():
        message = "its steady vibration at the operating speed has no finite value"
        hint = "give the damping of the train, or `initial: {speed: ...}`"
        raise SolveError(message, hint, path)
    index = int(np.flatnonzero(vibration.speed == speeds[0])[0])
    return replace(
        state,
        frequency=2.0 * math.pi * vibration.frequency[index],
        amplitude=vibration.torque[index],
        angle=vibration.angle[index],
    )


def points_of_events(
    study: Study, system: System, events: Sequence[Event], before: State, path: Path, *, turns: bool
) -> list[Point]:
    """The train where every event acts; raises InputError for events that it cannot have.

    turns: torques follow the motion.
    """
    points, faults = list[Point](), list[Fault]()
    for number, event in enumerate(events):
        where = replace(point(study, system, before.speed, event.at, before.mean), turns=turns)
        points.append(where)
        lack = (
            _lack_of_freedom(study, system, event)
            or _lack_of_order(events, event, where.mean)
            or event.body.lacks(where)
        )
        if lack is not None:
            faults.append(Fault((*path, "events", number, event.body.key), *lack))
    if faults:
        raise InputError(faults)
    return points


def _lack_of_order(events: Sequence[Event], event: Event, mean: float) -> Lack:
    """A mean torque that ends where a start or a load has taken its place, or that comes back after it.

    mean: N m at the point, positive where it drives.
    """
    name, body, at_point = event.at, event.body, [other for other in events if other.at == event.at]
    drivers = [other.time for other in at_point if other.body.drives]
    if isinstance(body, Load) and mean > 0.0:
        # A brake whose point is driven, unless that torque has ended before, or a start has taken its place.
        earlier = [other for other in at_point if other.time <= event.time]
        stopped = sum(
            other.body.taken(event.time - other.time)
            for other in earlier
            if isinstance(other.body, Stop)
        )
        has_start = any(isinstance(other.body, Start) for other in earlier)
        if has_start or math.isclose(stopped, 1.0, rel_tol=1e-9):
            return None
        hint = f"add `{{at: {name}, time: {event.time:g} s, stop: {{}}}}`, or put the load at another point"
        return f"the mean torque of '{name}' drives, and a load would take its place", hint
    if isinstance(body, ShortCircuit) and body.load == "falls" and drivers:
        message = f"a start or a load takes the place of the mean torque of '{name}'"
        return message, "`load: stays`"
    if not isinstance(body, Stop) or not drivers:
        return None
    begins = min(drivers)
    if event.time + body.ramp <= begins and math.isinf(body.lasts):
        return None
    message = (
        f"from {begins:g} s on a start or a load takes the place of the mean torque of '{name}'"
    )
    return message, "end that by its `off`, or stop before, without `until`"


def _lack_of_freedom(study: Study, system: System, event: Event) -> Lack:
    """A program of speed where nothing is fixed or more is, a torque at a fixed point, a start that cannot turn."""
    is_fixed = bool(system.held[study.train[event.at].stations[0]])
    fixed = np.flatnonzero(system.held)
    if isinstance(event.body, SpeedProgram):
        if is_fixed and len(fixed) == 1:
            return None
        why = "other points are fixed" if is_fixed else "it turns freely"
        message = f"the speed of '{event.at}' is prescribed, and {why}"
        return message, "`held: true` there, and nowhere else"
    if is_fixed:
        return f"'{event.at}' is fixed, and no torque moves it", "name a point that turns"
    if isinstance(event.body, Start) and len(fixed):
        name = system.stations[int(fixed[0])].name
        return f"a start turns the train, and it is fixed at {name}", "leave `held` out"
    return None


def point(
    study: Study, system: System, speed: float, name: str, mean: Steady | None = None
) -> Point:
    """The train where an event acts, at a reference speed (rad/s) and with the mean torques before it."""
    part, rated = study.train[name], study.operation.rated
    station = part.stations[0]
    ratio = abs(float(system.speed_ratio[station]))
    rated_speed = 0.0 if rated is None else rated.speed * ratio
    torque = None if part.machine is None else part.machine.rated_torque(rated_speed)
    if torque is None and rated is not None and study.has_mean_torque:
        # Its share of the torque when every cylinder fires.
        balance = power_balance(study.train, study.operation)
        if balance.delivered:
            applied = abs(float(balance.applied(station, np.array([rated.speed]))[0]))
            torque = applied / float(balance.delivered) / ratio
    if not torque:
        torque = 0.0 if rated is None or rated.power is None else rated.power / rated_speed
    return Point(
        name,
        speed * ratio,
        0.0 if mean is None else float(mean.applied[station, 0]),
        torque,
        0 if part.propeller is None else part.propeller.blades or 0,
        FilePath(study.file).parent,
        rated_speed,
        is_clutch=part.is_clutch,
        propeller=part.propeller,
    )
