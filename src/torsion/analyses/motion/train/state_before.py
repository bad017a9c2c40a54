"""How a train runs before its events: at rest, at a speed, in its steady state, or twisted and let go."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import groupby
from pathlib import Path as FilePath
from typing import TYPE_CHECKING

import numpy as np

from torsion.analyses.motion.events.event_kind import Lack, Point
from torsion.analyses.motion.events.events import Event, Stop
from torsion.analyses.motion.events.machine_events import Load, ShortCircuit, SpeedProgram, Start
from torsion.analyses.motion.events.transient_settings import PATH, ROUNDING, TransientSettings
from torsion.arrays import ComplexArray, FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.primitives import Torque
from torsion.study import Study

if TYPE_CHECKING:
    from torsion.analyses.steady import Steady


@dataclass(frozen=True)
class State:
    """How the train runs before its events."""

    speed: float  # rad/s, reference
    mean: "Steady | None"
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
    from torsion.analyses.steady import steady_if_known

    speeds = np.array([speed or operation.speed])
    mean = steady_if_known(study, system, speeds)
    torque = none if mean is None else mean.torque[:, 0]
    state = replace(standstill, speed=float(speeds[0]), mean=mean, torque=torque)
    if not (study.excites and vibrates):
        return state
    from torsion.analyses.response.over_speed import response
    from torsion.kernels.trees.tree_response import Status

    # Not refined: its spans must be those of the motion.
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
    study: Study, system: System, speed: float, name: str, mean: "Steady | None" = None
) -> Point:
    """The train where an event acts, at a reference speed (rad/s) and with the mean torques before it."""
    part, rated = study.train[name], study.operation.rated
    station = part.stations[0]
    ratio = abs(float(system.speed_ratio[station]))
    rated_speed = 0.0 if rated is None else rated.speed * ratio
    torque = None if part.machine is None else part.machine.rated_torque(rated_speed)
    if torque is None and rated is not None and study.has_mean_torque:
        from torsion.analyses.power_balance import power_balance

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


# orders of one component that are named with their amplitudes; of more their number is
MOST_AMOUNTS = 4
STEPS_PER_PERIOD = 8.0  # of the highest order, at most about, at a tolerance of 1e-6
SECONDS_PER_STEP = 3e-4  # of one station at which orders act
# end of the words of a periodic torque that the file leaves out
LEFT_OUT = "(left out by `torques`)"


@dataclass(frozen=True)
class ActingTorques:
    """The torques of a motion in words."""

    acting: tuple[str, ...]
    not_acting: tuple[str, ...]

    @property
    def words(self) -> str:
        """Both lists in one line for a reader."""
        without = f" Not acting: {'; '.join(self.not_acting)}." if self.not_acting else ""
        return f"Acting: {'; '.join(self.acting) or 'no torque'}.{without}"


def without_excluded_torques(
    study: Study, system: System, settings: TransientSettings
) -> tuple[Study, System]:
    """The study and the system without the periodic torques that do not act in the motion."""
    names = settings.torques
    if names is None:
        return study, system
    trains = []
    for train in (study.train, system.train):
        torques = tuple(torque for name in names for torque in train.periodic_torques[name])
        trains.append(replace(train, torques=torques))
    return replace(study, train=trains[0]), replace(system, train=trains[1])


def acting_torques(study: Study, settings: TransientSettings) -> ActingTorques:
    """All torques of a motion, and all that are not part of it with the reason."""
    acting, not_acting = list[str](), list[str]()
    for name, torques in study.train.periodic_torques.items():
        if settings.torques is None or name in settings.torques:
            acting += _in_words(name, torques, has_amounts=True)
        else:
            words = _in_words(name, torques, has_amounts=False)
            not_acting += (f"{text} {LEFT_OUT}" for text in words)

    reason = _reason_without_mean(study, settings)
    if reason:
        not_acting.append(f"mean torques ({reason})")
    else:
        bodies = [(event.at, event.body) for event in settings.events]
        ended = dict.fromkeys(at for at, body in bodies if body.drives or isinstance(body, Stop))
        but = f", but for those at {', '.join(ended)} that events end or replace" if ended else ""
        acting.append(
            f"mean torques (they stay at their initial values{but}; the law of a load acts by an event `load`)"
        )

    torques = study.train.torques
    swept = [torque.name for torque in torques if torque.order is None and torque.frequency is None]
    for name in dict.fromkeys(swept):
        not_acting.append(f"excitation at {name} (of the response over frequency only)")
    for event in settings.events:
        torque = getattr(event.body, "torque", None)
        amount = f" {torque:g} N m" if isinstance(torque, float) else ""
        acting.append(f"{event.body.key}{amount} at {event.at} from {event.time:g} s")
        last = event.time + event.body.changes(Point(folder=FilePath(study.file).parent))[-1]
        if last > settings.duration * (1.0 + ROUNDING):
            span = f"from {settings.duration:g} to {last:g} s (after the end)"
            not_acting.append(f"{event.body.key} at {event.at} {span}")
    return ActingTorques(tuple(acting), tuple(not_acting))


def expected_steps(study: Study, system: System, settings: TransientSettings) -> str:
    """How many steps orders take and how long that lasts, by the speed that is known; empty where it is short."""
    given = settings.initial.get("speed") if isinstance(settings.initial, dict) else None
    speed = given if isinstance(given, float) else study.operation.speed or 0.0
    _, acting = without_excluded_torques(study, system, settings)
    orders = {
        torque.station: float(torque.order) * abs(float(system.speed_ratio[torque.station]))
        for torque in sorted(acting.train.torques, key=lambda torque: torque.order or 0)
        if torque.order is not None
    }
    per_period = STEPS_PER_PERIOD * (1e-6 / settings.tolerance) ** (1.0 / 6.0)
    fastest = speed * max(orders.values(), default=0.0)
    steps = settings.duration * fastest / (2.0 * math.pi) * per_period
    lasts = SECONDS_PER_STEP * steps * len(orders)
    return f" At most about {steps:.1g} steps, {lasts:.1g} s of computing." if lasts >= 1.0 else ""


def _reason_without_mean(study: Study, settings: TransientSettings) -> str:
    """Why no mean torque acts; empty where it does."""
    if isinstance(settings.initial, dict):
        is_speed = "speed" in settings.initial
        return "the initial speed is given" if is_speed else "a twist is released"
    if settings.initial == "rest" or not study.operation.speed:
        return "the motion begins at rest"
    return "" if study.has_mean_torque else "no power is stated"


def _in_words(name: str, torques: Sequence[Torque], *, has_amounts: bool) -> Iterator[str]:
    """The periodic torques of one component: by order one after the other, or their number where there are many."""
    for is_order, group in groupby(torques, key=lambda torque: torque.order is not None):
        alike = list(group)
        if len(alike) > MOST_AMOUNTS or any(torque.cylinder for torque in alike):
            number = len({torque.order if is_order else torque.frequency for torque in alike})
            words = f"{number} {'orders' if is_order else 'frequencies'} at {name}"
            yield f"{words} (by its angle)" if is_order and has_amounts else words
            continue
        for torque in alike:
            what = f"order {torque.order}" if is_order else f"{torque.frequency:g} Hz"
            law = ", by its angle" if is_order else ""
            share = f"{100.0 * torque.of_mean:g} % of its mean torque" if torque.of_mean else ""
            amount = "a table over its speed" if torque.table else share
            amount = amount or f"{torque.torque:g} N m"
            yield f"{what} at {name}" + (f" ({amount}{law})" if has_amounts else "")
