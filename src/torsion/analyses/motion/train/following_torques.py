"""Torques that follow the motion: starts and loads by the speed of a point, orders and ice by its angle, and joints.

They are there where an event changes the speed by itself, a joint does, or a periodic torque has an order.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from torsion.analyses.motion.events.event_kind import Point
from torsion.analyses.motion.events.events import Event
from torsion.analyses.motion.events.machine_events import Load
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.train.joints import JointCut
from torsion.analyses.motion.train.state_before import State
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import Steady, steady_if_known
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.kernels.motion import torque_laws as laws
from torsion.kernels.motion.collocation import Law, Marched
from torsion.kernels.motion.torque_laws import DryFriction
from torsion.primitives import Torque
from torsion.study import Study

AS_ONE = 1e-9  # relative: shapes of stations that turn as one differ by rounding
PARTS = 64  # of a load by tables, between whose rows the harmonics are no polynomials of the speed
LOWEST = 0.02  # of the highest speed: down to it a load that is no polynomial of the speed is followed by parts


@dataclass(frozen=True)
class Follower:
    """A law with the stations of its interfaces, and what it is."""

    law: Law
    stations: tuple[int, ...]
    words: str
    event: int = -1  # number of its event
    cut: JointCut | None = None  # at which it joins the parts of the train


def carried_by_joints(
    system: System, followers: Sequence[Follower]
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """What joints carry at once, (spans, interfaces) for 1 N m, and of mean torques (spans,); those at (stations,)."""
    interfaces = sum(len(follower.stations) for follower in followers)
    carried = np.zeros((len(system.spans), interfaces))
    mean_carried, mean = np.zeros(len(system.spans)), np.zeros(len(system.stations))
    for follower in followers:
        if (cut := follower.cut) is not None:
            mean[[cut.front, cut.behind]] += -cut.mean, cut.mean
            for span, side, factor in cut.carried(system):
                carried[span, follower.law.interface + side] += factor
                mean_carried[span] += factor * (cut.mean if side else -cut.mean)
    return carried, mean_carried, mean


def following(
    study: Study,
    system: System,
    events: Sequence[Event],
    points: Sequence[Point],
    before: State,
    cuts: tuple[JointCut, ...],
    shape: FloatArray,
    speeds: FloatArray,
) -> tuple[Follower, ...]:
    """Return the laws of all that follows the motion, those of joints last.

    shape: (stations, rigid motions + modes); speeds: (stations,) rad/s at time 0.
    """
    followers, frictions = list[Follower](), list[Follower]()
    for number, (event, point) in enumerate(zip(events, points, strict=True)):
        station, words = _station(study, event), f"{event.body.key} at {event.at}"
        for law in event.body.laws(event.time, point):
            group = frictions if isinstance(law, DryFriction) else followers
            group.append(Follower(law, (station,), words, number))

    orders = [torque for torque in system.train.torques if torque.order is not None]
    for throw in dict.fromkeys(torque.station for torque in orders if torque.cylinder):
        torques = [torque for torque in orders if torque.cylinder and torque.station == throw]
        staying = _staying_mean(study, torques[0], events, before)
        law = _cylinder_law(study, system, torques, staying)
        followers.append(Follower(law, (throw,), f"cylinders at {system.stations[throw].name}"))
    for torque in (torque for torque in orders if torque.cylinder is None):
        staying = _staying_mean(study, torque, events, before)
        size = _size(study, system, torque, before.speed, staying)
        law = laws.Wave(0, size, float(torque.order or 0), torque.phase)
        words = f"order {torque.order} at {torque.name}"
        followers.append(Follower(law, (torque.station,), words))

    while frictions:  # those at stations that turn in a constant ratio in every mode stand together
        row = shape[frictions[0].stations[0]]
        group = [friction for friction in frictions if _as_one(shape[friction.stations[0]], row)]
        frictions = [friction for friction in frictions if friction not in group]
        interfaces = (station for follower in followers for station in follower.stations)
        alike = (
            number for number, station in enumerate(interfaces) if _as_one(shape[station], row)
        )
        followers.append(_joined_friction(group, tuple(alike), shape, speeds))
    for cut in cuts:
        # The inertia as both sides take a sudden torque.
        inertia = 1.0 / float((shape[[cut.front, cut.behind]] ** 2).sum())
        words = f"joint {system.spans[cut.span].name}"
        law = cut.law(system, inertia)
        followers.append(Follower(law, (cut.front, cut.behind), words, cut=cut))

    numbered, interface = list[Follower](), 0
    for follower in followers:
        law = replace(follower.law, interface=interface)  # type: ignore[type-var]
        numbered.append(replace(follower, law=law))
        interface += law.count
    return tuple(numbered)


def _station(study: Study, event: Event) -> int:
    return study.train[event.at].stations[0]


def _as_one(row: FloatArray, reference: FloatArray) -> bool:
    """Two stations turn in a constant ratio, by their rows of the shapes."""
    difference = row - reference * (row @ reference) / (reference @ reference)
    return bool(np.abs(difference).max() <= AS_ONE * np.abs(row).max())


def _joined_friction(
    group: Sequence[Follower], neighbours: tuple[int, ...], shape: FloatArray, speeds: FloatArray
) -> Follower:
    """One law of frictions that stand together."""
    frictions = [follower.law for follower in group if isinstance(follower.law, DryFriction)]
    stations = tuple(follower.stations[0] for follower in group)
    row = shape[stations[0]]
    square = float(row @ row)
    law = DryFriction(
        0,
        tuple(friction.torque[0] for friction in frictions),
        max(frictions[0].scale, abs(float(speeds[stations[0]]))),
        tuple(friction.windows[0] for friction in frictions),
        tuple(float(shape[station] @ row) / square for station in stations),
        1.0 / square,  # as it takes a sudden torque
        neighbours,
    )
    return Follower(law, stations, ", ".join(dict.fromkeys(follower.words for follower in group)))


def refuse_beyond_tables(
    follows: Sequence[Follower], events: Sequence[Event], marched: Marched, path: Path
) -> None:
    """Raises SolveError where a point outruns the table of its load while that acts."""
    for time, number, regime in sorted((*marched.begun, *marched.changes)):
        follower = follows[number]
        law, event = follower.law, events[follower.event] if follower.event >= 0 else None
        if event is None or not isinstance(event.body, Load) or isinstance(event.body.law, str):
            continue
        acts = event.time <= time < event.time + (event.body.off or math.inf)
        if acts and isinstance(law, laws.BySpeed) and regime in (0, len(law.parts.edges)):
            ends = f"{event.body.law[-1][0] * 30.0 / math.pi:.6g} rpm"
            raise SolveError(
                f"at {time:.6g} s the load at '{event.at}' is outrun: its table ends at {ends}",
                "extend the table; nothing is extrapolated",
                (*path, "events", follower.event, "load"),
            )


def replaced_dampers(
    study: Study, system: System, settings: TransientSettings, path: Path
) -> dict[int, str]:
    """Stations whose damper to ground stands for the slope of a load that acts over the whole motion, with its point.

    path: of the settings in the file. Raises InputError for such a load that acts at times only.
    """
    damped = {damper.station for damper in system.dampers}
    loads = [
        (number, event, event.time == 0.0 and (event.body.off or math.inf) >= settings.duration)
        for number, event in enumerate(settings.events)
        if isinstance(event.body, Load) and event.body.damps and _station(study, event) in damped
    ]
    replaced = {_station(study, event): event.at for _, event, throughout in loads if throughout}
    faults = [
        Fault(
            (*path, "events", number, "load"),
            f"the damping of '{event.at}' stands for the slope of this load, which its law has while it acts",
            "give the load from time 0 on without `off`, or no `damping` there",
        )
        for number, event, _ in loads
        if _station(study, event) not in replaced
    ]
    if faults:
        raise InputError(faults)
    return replaced


def _staying_mean(
    study: Study, torque: Torque, events: Sequence[Event], before: State
) -> Steady | None:
    """The mean torques of the begin where the one that a torque is a share of stays; None where it does not."""
    replaced = {_station(study, event) for event in events if event.body.drives}
    station = torque.station if torque.cylinder is None else torque.cylinder.station
    if before.mean is None or station in replaced:
        return None
    # A point where no mean torque is applied has that of its spans, and it changes with any that is replaced.
    return None if replaced and not before.mean.applied[station].any() else before.mean


def _cylinder_law(
    study: Study, system: System, torques: Sequence[Torque], staying: Steady | None
) -> laws.Wave:
    """The torques of the cylinders of a throw; beyond the speeds of tables their first and last parts go on.

    staying: mean torques that do not change with the speed, in place of those of the laws of load.
    """
    ratio = abs(float(system.speed_ratio[torques[0].station]))
    highest = (study.operation.speed or math.pi) * ratio
    cylinders = [torque.cylinder for torque in torques if torque.cylinder]
    gases = [cylinder.gas for cylinder in cylinders if cylinder.gas is not None]
    ends = {0.5 * highest, highest}
    for gas in gases:
        ends = set(gas.at.tolist()) if gas.over == "speed" else ends
    ends = _with_corners_of_loads(study, ends, ratio)
    if any(gas.over == "load" and len(gas.at) > 2 for gas in gases):
        ends |= set(np.linspace(min(ends), max(ends), PARTS + 1).tolist())
    order = np.array([float(torque.order or 0) for torque in torques])
    return laws.Wave(0, _by_parts(study, system, torques, ends, ratio, staying), order)


def _with_corners_of_loads(study: Study, ends: set[float], ratio: float) -> set[float]:
    """Ends of parts (rad/s of the own shaft) between which mean torques are polynomials of the speed.

    Where a table ends the parts end too; a law of another power is followed by many parts.
    """
    if not study.has_mean_torque:
        return ends
    balance = power_balance(study.train, study.operation)
    if tables := [load.law.table for load in balance.loads if load.law.table]:
        first = max(table[0][0] for table in tables) * ratio
        last = min(table[-1][0] for table in tables) * ratio
        ends = ends | {corner * ratio for corner in balance.corners}
        ends = {end for end in ends if first <= end <= last}
    if any(
        not load.law.table and load.law.exponent not in (0.0, 1.0, 2.0) for load in balance.loads
    ):
        lowest = min(ends) if tables else LOWEST * max(ends)
        ends |= set(np.geomspace(lowest, max(ends), PARTS + 1).tolist()[:-1])
    return ends


def _by_parts(
    study: Study,
    system: System,
    torques: Sequence[Torque],
    ends: set[float],
    ratio: float,
    staying: Steady | None = None,
) -> laws.Parts:
    """Complex amplitudes of torques by parts over the speed of their own shaft, which have ends (rad/s)."""
    edges = np.array(sorted(ends))
    speed = laws.ends_and_middles(edges).ravel() / ratio
    if staying is None:
        mean = steady_if_known(study, system, speed)
    else:
        mean = replace(staying, applied=np.repeat(staying.applied, len(speed), axis=1))
    values = np.stack([amplitude(system, torque, speed, mean) for torque in torques], axis=-1)
    polynomial = laws.quadratics(edges, values.reshape(-1, 3, len(torques)))
    edges, polynomial = laws.without_equal_parts(edges, polynomial)
    return laws.Parts(edges[1:-1], polynomial, float(edges[-1]))


def _size(
    study: Study, system: System, torque: Torque, begins: float, staying: Steady | None
) -> laws.Parts:
    """Amplitude of a periodic torque over the speed of its own shaft; begins: rad/s of the reference.

    staying: mean torques that do not change with the speed. Raises InputError where the mean torque of which it is a
    share is not known at the speed at which the motion begins.
    """
    if begins:  # known there, or refused
        speed = np.array([begins])
        mean = steady_if_known(study, system, speed) if torque.of_mean else None
        amplitude(system, torque, speed, mean)
    ratio = abs(float(system.speed_ratio[torque.station]))
    if torque.table:
        return laws.table(torque.table)
    if not torque.of_mean:
        return laws.constant(torque.torque)
    highest = (study.operation.speed or 1.0) * ratio
    ends = {0.5 * highest, highest}
    if staying is None:
        ends = _with_corners_of_loads(study, ends, ratio)
    share = replace(torque, torque=0.0, phase=0.0)
    parts = _by_parts(study, system, [share], ends, ratio, staying)
    return replace(parts, polynomial=parts.polynomial[:, :, 0].real)
