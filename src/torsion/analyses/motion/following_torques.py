"""Torques that follow the motion: starts and loads by the speed of a point, orders and ice by its angle, and joints.

They are there where an event changes the speed by itself, a joint does, or a periodic torque has an order.
"""

import math
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from torsion.analyses.motion.carrier import Carrier
from torsion.analyses.motion.cylinder_torques import cylinder_law, with_corners_of_loads
from torsion.analyses.motion.event_kind import Point
from torsion.analyses.motion.events import Event
from torsion.analyses.motion.following_events import Load, SpeedProgram
from torsion.analyses.motion.joint_cuts import JointCut, joint_spans, standing
from torsion.analyses.motion.joint_laws import RigidJoint
from torsion.analyses.motion.state_before import State
from torsion.analyses.motion.transient_settings import TransientSettings
from torsion.analyses.power_balance import power_balance
from torsion.analyses.response.harmonic_components import amplitude
from torsion.analyses.steady import Steady, steady_if_known
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, Path, SolveError
from torsion.findings import Progress
from torsion.kernels.motion import torque_laws as laws
from torsion.kernels.motion.collocation import Collocated, Law, Marched, Scheme, march
from torsion.kernels.motion.cylinder_torques import quadratics, without_equal_parts
from torsion.kernels.motion.damped_motion import Motion
from torsion.kernels.motion.driven_motion import DrivenMotion, driven
from torsion.kernels.motion.dry_friction import DryFriction
from torsion.kernels.motion.interface_motion import interfaces
from torsion.primitives import Torque
from torsion.study import Study

FIRST, LONGEST = 2.0**-10, 2.0**-3  # steps, of the duration
AS_ONE = 1e-9  # relative: shapes of stations that turn as one differ by rounding
Friction = tuple[DryFriction, int, str]  # of one event, its station, and what it is


@dataclass(frozen=True)
class Following:
    """The laws of torques with their interfaces, what they carry, and how the train turns."""

    laws: tuple[Law, ...]
    station: IntArray  # (interfaces,)
    carrier: Carrier
    cuts: tuple[JointCut, ...]
    first: tuple[int, ...]  # interface of every joint
    words: tuple[str, ...]  # what follows, of every law
    events: tuple[int, ...]  # of the first laws

    def carried(self, system: System, direct: FloatArray) -> None:
        """Add the torques at the interfaces, the last loads of `direct` (spans, loads), to spans that carry them."""
        behind = direct.shape[1] - len(self.station)
        for cut, first in zip(self.cuts, self.first, strict=True):
            for span, which, factor in cut.carried(system):
                direct[span, behind + first + which] += factor

    def solve(
        self,
        system: System,
        moved: Motion,
        shape: FloatArray,
        settings: TransientSettings,
        progress: Progress,
    ) -> tuple[DrivenMotion, Collocated]:
        """The motion; the last loads of `moved` are nothing, and stand for the interfaces."""
        column = shape[self.station]
        needed = any(isinstance(law, DryFriction | RigidJoint) for law in self.laws)

        def given(time: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
            place, speed = moved.at(time)
            rates = (
                place,
                speed,
                moved.acceleration(time, place, speed) if needed else np.zeros_like(place),
            )
            turns = (one[self.station] for one in self.carrier.at(time))
            angle, turning, gaining = (
                turn + column @ one for turn, one in zip(turns, rates, strict=True)
            )
            return angle, turning, gaining

        scheme = self.scheme(system, settings, moved.cuts)
        found = march(
            interfaces(moved, column),
            self.laws,
            given,
            scheme,
            partial(progress, "torques that follow"),
        )
        return driven(moved, found.steps), found

    def scheme(self, system: System, settings: TransientSettings, kinks: FloatArray) -> Scheme:
        """How finely the motion is found; kinks: (times,) s, of the torques that are given."""
        cuts = (*kinks.tolist(), *(end for line in self.carrier.rates for end in line[:2]))
        duration, weight = settings.duration, np.abs(system.speed_ratio[self.station])
        return Scheme(
            duration, settings.tolerance, FIRST * duration, LONGEST * duration, weight, cuts
        )


def changes_speed(system: System, events: Sequence[Event]) -> bool:
    """An event or a joint changes the speed by itself: dampers to ground then count from the motion as one."""
    return bool(joint_spans(system).size) or any(event.body.drives for event in events)


def torques_follow(study: Study, system: System, events: Sequence[Event]) -> bool:
    """Torques follow the motion: periodic ones by order, what changes the speed, or events by angle in a program."""
    if changes_speed(system, events) or any(
        torque.order is not None for torque in study.train.torques
    ):
        return True
    is_swept = any(isinstance(event.body, SpeedProgram) for event in events)
    return is_swept and any(event.body.by_angle for event in events)


def following(
    study: Study,
    system: System,
    events: Sequence[Event],
    points: Sequence[Point],
    before: State,
    cuts: tuple[JointCut, ...],
    shape: FloatArray,
) -> Following:
    """What follows the motion."""
    found, station, words, first = list[Law](), list[int](), list[str](), list[int]()
    offset, speed = standing(system, cuts, before.speed)
    frictions = list[Friction]()
    own = list[int]()
    for number, (event, point) in enumerate(zip(events, points, strict=True)):
        there, what = study.train.part(event.at).stations[0], f"{event.body.key} at {event.at}"
        for law in event.body.laws(event.time, point):
            if isinstance(law, DryFriction):
                frictions.append((law, there, what))
                continue
            found.append(replace(law, interface=len(station)))  # type: ignore[type-var]
            station.append(there)
            words.append(what)
            own.append(number)
    for throw, torques in _by_throw(system.train.torques).items():
        staying = _staying_mean(study, torques[0], events, before)
        found.append(cylinder_law(study, system, len(station), torques, staying))
        station.append(throw)
        words.append(f"cylinders at {system.stations[throw].name}")
    for torque in system.train.torques:
        if torque.order is not None and torque.cylinder is None:
            size = _size(
                study, system, torque, before.speed, _staying_mean(study, torque, events, before)
            )
            found.append(laws.Wave(len(station), size, float(torque.order), torque.phase))
            station.append(torque.station)
            words.append(f"order {torque.order} at {torque.name}")
    for together in _turning_as_one(frictions, shape):
        beside = tuple(
            k for k, there in enumerate(station) if _as_one(shape[there], shape[together[0][1]])
        )
        found.append(replace(_one_friction(together, len(station), shape, speed), beside=beside))
        station += [there for _, there, _ in together]
        words.append(", ".join(dict.fromkeys(what for _, _, what in together)))
    for cut in cuts:
        first.append(len(station))
        inertia = 1.0 / float(
            (shape[[cut.front, cut.behind]] ** 2).sum()
        )  # as they take a sudden torque
        found.append(cut.law(len(station), system, inertia))
        station += [cut.front, cut.behind]
        words.append(f"joint {system.spans[cut.span].name}")
    carrier = Carrier(offset, speed, np.abs(system.speed_ratio), rates_of(study, system, events))
    stations = np.array(station, dtype=np.int64)
    return Following(tuple(found), stations, carrier, cuts, tuple(first), tuple(words), tuple(own))


def _by_throw(torques: Sequence[Torque]) -> dict[int, list[Torque]]:
    """The torques of cylinders by their station."""
    found: dict[int, list[Torque]] = {}
    for torque in torques:
        if torque.cylinder is not None:
            found.setdefault(torque.station, []).append(torque)
    return found


def _turning_as_one(frictions: Sequence[Friction], shape: FloatArray) -> list[list[Friction]]:
    """Frictions at stations that turn in a constant ratio in every mode stand together."""
    groups = list[list[Friction]]()
    for one in frictions:
        group = next(
            (group for group in groups if _as_one(shape[one[1]], shape[group[0][1]])), None
        )
        if group is None:
            groups.append([one])
        else:
            group.append(one)
    return groups


def _as_one(row: FloatArray, other: FloatArray) -> bool:
    """Two stations turn in a constant ratio, by their rows of the shapes."""
    return bool(
        np.abs(row - other * (row @ other) / (other @ other)).max() <= AS_ONE * np.abs(row).max()
    )


def _one_friction(
    together: Sequence[Friction], interface: int, shape: FloatArray, speed: FloatArray
) -> DryFriction:
    """Their law; speed: (stations,) rad/s at time 0."""
    each, stations, _ = zip(*together, strict=True)
    row = shape[stations[0]]
    square = float(row @ row)
    return DryFriction(
        tuple(range(interface, interface + len(each))),
        tuple(one.torque[0] for one in each),
        max(each[0].scale, abs(float(speed[stations[0]]))),
        tuple(one.windows[0] for one in each),
        tuple(float(shape[station] @ row) / square for station in stations),
        1.0 / square,  # as it takes a sudden torque
    )


def carrier_of(
    study: Study,
    system: System,
    events: Sequence[Event],
    before: State,
    cuts: tuple[JointCut, ...] = (),
) -> Carrier:
    """How the train turns without any torque."""
    offset, speed = standing(system, cuts, before.speed)
    return Carrier(offset, speed, np.abs(system.speed_ratio), rates_of(study, system, events))


def refuse_beyond_tables(
    follows: Following, events: Sequence[Event], how: Marched, place: Path
) -> None:
    """Raises SolveError where a point outruns the table of its load while that acts."""
    for time, law, regime in sorted((*how.begun, *how.changes)):
        number = follows.events[law] if law < len(follows.events) else -1
        if number < 0 or not isinstance((event := events[number]).body, Load):
            continue
        if event.body.is_beyond(follows.laws[law], regime, time - event.time):
            ends = f"{event.body.law[-1][0] * 30.0 / math.pi:.6g} rpm"
            message = (
                f"at {time:.6g} s the load at '{event.at}' is outrun: its table ends at {ends}"
            )
            raise SolveError(
                message,
                "extend the table; nothing is extrapolated",
                (*place, "events", number, "load"),
            )


def replaced_dampers(
    study: Study, system: System, settings: TransientSettings, place: Path
) -> dict[int, str]:
    """Stations whose damper to ground stands for the slope of a load that acts over the whole motion, with its point.

    place: of the settings in the file. Raises InputError for such a load that acts at times only.
    """
    damped, found, faults = {one.station for one in system.dampers}, dict[int, str](), list[Fault]()
    each = [
        (number, one, one.body)
        for number, one in enumerate(settings.events)
        if isinstance(one.body, Load)
    ]
    for _, event, body in each:
        station = study.train.part(event.at).stations[0]
        if station in damped and body.damps and body.acts_throughout(event.time, settings.duration):
            found[station] = event.at
    for number, event, body in each:
        station = study.train.part(event.at).stations[0]
        if station in damped and body.damps and station not in found:
            message = f"the damping of '{event.at}' stands for the slope of this load, which its law has while it acts"
            hint = "give the load from time 0 on without `off`, or no `damping` there"
            faults.append(Fault((*place, "events", number, "load"), message, hint))
    if faults:
        raise InputError(faults)
    return found


def without_dampers(system: System, stations: Collection[int]) -> System:
    """The system but for the dampers to ground of stations."""
    return replace(
        system, dampers=tuple(one for one in system.dampers if one.station not in stations)
    )


def rates_of(
    study: Study, system: System, events: Sequence[Event]
) -> tuple[tuple[float, float, float], ...]:
    """Begin, end (s) and rate (rad/s2, of the reference) of every line of the programs of speed."""
    found = []
    for event in events:
        if isinstance(event.body, SpeedProgram):
            ratio = abs(float(system.speed_ratio[study.train.part(event.at).stations[0]]))
            found += [
                (begin, end, rate / ratio) for begin, end, rate in event.body.rates(event.time)
            ]
    return tuple(found)


def _staying_mean(
    study: Study, torque: Torque, events: Sequence[Event], before: State
) -> Steady | None:
    """The mean torques of the begin where the one that a torque is a share of stays; None where it does not."""
    replaced = {study.train.part(event.at).stations[0] for event in events if event.body.drives}
    station = torque.station if torque.cylinder is None else torque.cylinder.station
    if before.mean is None or station in replaced:
        return None
    # a point where no mean torque is applied has that of its spans, and it changes with any that is replaced
    return None if replaced and not before.mean.applied[station].any() else before.mean


def _size(
    study: Study, system: System, torque: Torque, begins: float, staying: Steady | None
) -> laws.Parts:
    """Amplitude of a periodic torque over the speed of its own shaft; begins: rad/s of the reference.

    staying: mean torques that do not change with the speed. Raises InputError where the mean torque of which it is a
    share is not known at the speed at which the motion begins.
    """
    operation, ratio = study.operation, abs(float(system.speed_ratio[torque.station]))
    if begins:  # known there, or refused
        at_begin = np.array([begins])
        amplitude(
            system,
            torque,
            at_begin,
            steady_if_known(study, system, at_begin) if torque.of_mean else None,
        )
    if torque.table:
        return laws.table(torque.table)
    if not torque.of_mean:
        return laws.constant(torque.torque)
    share = replace(torque, torque=0.0, phase=0.0)
    if staying is not None:
        return laws.constant(float(amplitude(system, share, np.array([begins]), staying)[0].real))
    balance = power_balance(study.train, operation)
    law = balance.loads[0].law
    if len(balance.loads) > 1 or not (
        law.table or (law.exponent in (0.0, 2.0) and not law.at_rest)
    ):
        return _by_parts(study, system, share, ratio)

    # The share is taken where the load is largest: at the lowest speed a table may give no load at all.
    rows = np.array(law.table, dtype=float)
    speed = rows[[rows[:, 1].argmax()], 0] if law.table else np.array([operation.speed or 1.0])
    size = float(amplitude(system, share, speed, steady_if_known(study, system, speed))[0].real)
    if law.table:
        return laws.table(
            [(at * ratio, size * mean / float(rows[:, 1].max())) for at, mean in rows.tolist()]
        )
    if law.exponent == 2.0:
        square = size / (float(speed[0]) * ratio) ** 2
        return laws.Parts(np.empty(0), np.array([[0.0, 0.0, square]]), float(speed[0]) * ratio)
    return laws.constant(size)


def _by_parts(study: Study, system: System, torque: Torque, ratio: float) -> laws.Parts:
    """A share of a mean torque that several laws of load make, by parts over the speed of its own shaft."""
    highest = (study.operation.speed or 1.0) * ratio
    edges = np.array(sorted(with_corners_of_loads(study, {0.5 * highest, highest}, ratio)))
    speed = (
        np.stack([edges[:-1], (edges[:-1] + edges[1:]) / 2.0, edges[1:]], axis=1).ravel() / ratio
    )
    size = amplitude(system, torque, speed, steady_if_known(study, system, speed))
    edges, polynomial = without_equal_parts(edges, quadratics(edges, size.reshape(-1, 3, 1)))
    return laws.Parts(edges[1:-1], polynomial[:, :, 0].real, float(edges[-1]))
