"""How a train runs before its events: at rest, at a speed, in its steady state, or twisted and let go."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path as FilePath

import numpy as np

from torsion.analyses.motion.event_kind import Lack, Point
from torsion.analyses.motion.events import Event, Stop
from torsion.analyses.motion.following_events import Load, SpeedProgram, Start
from torsion.analyses.motion.short_circuit import ShortCircuit
from torsion.analyses.motion.transient_settings import PATH, TransientSettings
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.over_speed import response
from torsion.analyses.steady import Steady, steady
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
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
    angle: ComplexArray | None = (
        None  # (components, stations) rad of its steady vibration, own shafts
    )
    speeds: Mapping[str, float] = field(
        default_factory=dict
    )  # rad/s of points whose parts turn by themselves


def state_before(
    study: Study,
    system: System,
    settings: TransientSettings,
    place: Path = PATH,
    *,
    vibrates: bool = True,
    speed: float | None = None,
) -> State:
    """The state before the events; without its steady vibration where that is not `vibrates`.

    speed: rad/s of the steady state, in place of the operation's.
    """
    spans, operation = len(system.spans), study.operation
    initial = (
        settings.initial
        if settings.initial is not None
        else "steady"
        if operation.speed
        else "rest"
    )
    none = State(
        0.0,
        None,
        np.zeros(spans),
        np.empty(0),
        np.empty((0, spans), dtype=complex),
        np.zeros(spans),
    )
    if initial == "rest":
        return none
    if isinstance(initial, dict) and "torque" in initial:
        twist, names = (
            np.zeros(spans),
            [study.train.parts[part].name for part in system.span_part.tolist()],
        )
        for name, torque in initial["torque"].items():
            here = [k for k, span in enumerate(system.spans) if name in (span.name, names[k])]
            if not here:
                hint = ", ".join(dict.fromkeys(names))
                raise InputError(
                    [
                        Fault(
                            (*place, "initial", "torque", name), f"no span is called '{name}'", hint
                        )
                    ]
                )
            twist[here] = torque
        return replace(none, twist=twist)
    if isinstance(initial, dict):
        each = initial["speed"]
        return replace(none, speeds=each) if isinstance(each, dict) else replace(none, speed=each)
    if not (speed or operation.speed):
        fault = Fault(
            (*place, "initial"), "a steady state needs a speed", "give `operation: rated`"
        )
        raise InputError([fault])
    at = np.array([speed or operation.speed])
    mean = steady(study.train, system, operation, at) if study.has_mean_torque else None
    state = replace(
        none,
        speed=float(at[0]),
        mean=mean,
        torque=none.torque if mean is None else mean.torque[:, 0],
    )
    if not (study.excites and vibrates):
        return state
    vibration = response(study, system, speeds=at, refine=False)
    if (vibration.status != Status.OK).any():
        message = "its steady vibration at the operating speed has no finite value"
        raise SolveError(
            message,
            "give the damping of the train, or `initial: {speed: ...}`",
            (*place, "initial"),
        )
    own = int(np.flatnonzero(vibration.speed == at[0])[0])
    frequency, amplitude = 2.0 * math.pi * vibration.frequency[own], vibration.torque[own]
    return replace(state, frequency=frequency, amplitude=amplitude, angle=vibration.angle[own])


def points_of_events(
    study: Study,
    system: System,
    events: Sequence[Event],
    before: State,
    place: Path,
    *,
    turns: bool,
) -> list[Point]:
    """The train where every event acts; raises InputError for events that it cannot have.

    turns: torques follow the motion.
    """
    found, faults = list[Point](), list[Fault]()
    for number, event in enumerate(events):
        at = replace(point(study, system, before.speed, event.at, before.mean), turns=turns)
        found.append(at)
        lack = (
            _lack_of_freedom(study, system, event)
            or _lack_of_order(events, event, at.mean)
            or event.body.lacks(at)
        )
        if lack is not None:
            faults.append(Fault((*place, "events", number, event.body.key), *lack))
    if faults:
        raise InputError(faults)
    return found


def _lack_of_stop(events: Sequence[Event], event: Event) -> Lack:
    """A brake whose point is driven, unless that torque has ended before, or a start has taken its place."""
    there = [one for one in events if one.at == event.at and one.time <= event.time]
    late = [one.body.taken(event.time - one.time) for one in there if isinstance(one.body, Stop)]
    if any(isinstance(one.body, Start) for one in there) or math.isclose(
        sum(late), 1.0, rel_tol=1e-9
    ):
        return None
    message = f"the mean torque of '{event.at}' drives, and a load would take its place"
    return (
        message,
        f"add `{{at: {event.at}, time: {event.time:g} s, stop: {{}}}}`, or put the load at another point",
    )


def _lack_of_order(events: Sequence[Event], event: Event, mean: float) -> Lack:
    """A mean torque that ends where a start or a load has taken its place, or that comes back after it.

    mean: N m at the point, positive where it drives.
    """
    others = [one for one in events if one.at == event.at and one.body.drives]
    if isinstance(event.body, Load) and mean > 0.0:
        return _lack_of_stop(events, event)
    if isinstance(event.body, ShortCircuit) and event.body.load == "falls" and others:
        return (
            f"a start or a load takes the place of the mean torque of '{event.at}'",
            "`load: stays`",
        )
    if not isinstance(event.body, Stop) or not others:
        return None
    begins = min(one.time for one in others)
    if event.time + event.body.ramp <= begins and math.isinf(event.body.lasts):
        return None
    message = (
        f"from {begins:g} s on a start or a load takes the place of the mean torque of '{event.at}'"
    )
    return message, "end that by its `off`, or stop before, without `until`"


def _lack_of_freedom(study: Study, system: System, event: Event) -> Lack:
    """A program of speed where nothing is fixed or more is, a torque at a fixed point, a start that cannot turn."""
    is_fixed = bool(system.held[study.train.part(event.at).stations[0]])
    if isinstance(event.body, SpeedProgram):
        if is_fixed and np.count_nonzero(system.held) == 1:
            return None
        why = "other points are fixed" if is_fixed else "it turns freely"
        return (
            f"the speed of '{event.at}' is prescribed, and {why}",
            "`held: true` there, and nowhere else",
        )
    if is_fixed:
        return f"'{event.at}' is fixed, and no torque moves it", "name a point that turns"
    if isinstance(event.body, Start) and system.held.any():
        name = system.stations[int(np.flatnonzero(system.held)[0])].name
        return f"a start turns the train, and it is fixed at {name}", "leave `held` out"
    return None


def point(
    study: Study, system: System, speed: float, name: str, mean: Steady | None = None
) -> Point:
    """The train where an event acts, at a reference speed (rad/s) and with the mean torques before it."""
    part = study.train.part(name)
    station, rated = part.stations[0], study.operation.rated
    ratio = abs(float(system.speed_ratio[station]))
    own_speed = 0.0 if rated is None else rated.speed * ratio
    torque = None if part.machine is None else part.machine.rated_torque(own_speed)
    if torque is None and rated is not None and study.has_mean_torque:
        torque = _share_of_full_torque(study, station, rated.speed) / ratio
    if not torque:
        torque = 0.0 if rated is None or rated.power is None else rated.power / own_speed
    driving = 0.0 if mean is None else float(mean.applied[station, 0])
    blades = 0 if part.propeller is None or part.propeller.blades is None else part.propeller.blades
    return Point(
        name,
        speed * ratio,
        driving,
        torque,
        blades,
        FilePath(study.file).parent,
        own_speed,
        is_clutch=part.is_clutch,
        propeller=part.propeller,
    )


def _share_of_full_torque(study: Study, station: int, speed: float) -> float:
    """Return the torque (N m, of the reference) at a station when every cylinder fires."""
    balance = power_balance(study.train, study.operation)
    if not balance.delivered:
        return 0.0
    return abs(float(balance.applied(station, np.array([speed]))[0])) / float(balance.delivered)
