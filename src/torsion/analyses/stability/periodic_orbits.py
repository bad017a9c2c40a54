"""The exact periodic response of a train with joints over speed, by harmonic balance."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from fractions import Fraction

import numpy as np

from torsion.analyses.stability.common_period import harmonics_needed, too_long
from torsion.analyses.stability.equations_of_motion import (
    linearised,
    mean_angle,
    spring_torques,
    state,
    torques,
    turning,
)
from torsion.analyses.stability.mechanism_loads import Operating, Scene, operating, rigid_deviation
from torsion.analyses.stability.straight_modes import at_bodies
from torsion.arrays import BoolArray, ComplexArray, FloatArray
from torsion.assembly.spans import SegmentGroups
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.kernels.periodic.harmonic_balance import (
    MOST_UNKNOWNS,
    Balance,
    Linearised,
    Motion,
    balance,
    motion_of,
    points_in_time,
    resized,
)
from torsion.kernels.periodic.hill import harmonics_of
from torsion.results import derived, reported, result, words

ACCURACY = 1e-10  # harmonics left out / largest kept
FEWEST, MOST = 6, 400  # harmonics of the common period
GROWTH = 1.4  # of the number of harmonics from one trial to the next
KEPT = 1e-14  # of the largest amplitude: orders that stay smaller at every speed are rounding
SUBDIVISIONS = 6  # halvings of a step of speed before a solution is given up
GROWS = 1e-5  # over one common period: less may be the error of few modes
SLIPS = 1e-6  # of the drive's torque: what a coupling without stiffness may be required to carry
ASIDE = (-0.02, 0.02)  # of the speed: from so far away a motion is carried to it
STEPS = 4  # of the way
SAME = 1e-5  # of the largest amplitude: motions that differ by less are one


class Found(IntEnum):
    """What there is at a speed."""

    OK = 0
    COARSE = 1  # periodic, but the harmonics that were left out exceed ACCURACY
    NONE = 2  # no periodic solution found


@dataclass(frozen=True)
class Orbit:
    """A periodic motion at one speed."""

    now: Operating
    found: Balance

    @property
    def status(self) -> Found:
        """OK or COARSE."""
        return Found.OK if self.found.truncation <= ACCURACY else Found.COARSE


@reported
class PeriodicResponse:
    """Complex amplitudes of the exact periodic response (half ranges, phase at reference angle zero).

    NaN where no periodic solution was found.
    """

    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    orders: tuple[Fraction, ...] = result(
        "", ("order",), "per revolution of the reference, ascending, exact", record="order"
    )
    angle: ComplexArray = result(
        "rad",
        ("speed", "order", "station"),
        "complex amplitude at own speed; null without a periodic motion",
        printed=("speed", "named station"),
    )
    torque: ComplexArray = result(
        "N*m",
        ("speed", "order", "span"),
        "complex amplitude, elastic and damping share together",
        printed=("speed", "end span"),
    )
    mean: FloatArray = result(
        "N*m", ("speed", "span"), "mean torque", key="mean_torque_Nm", printed=("speed", "end span")
    )
    drive: FloatArray = result(
        "N*m",
        ("speed",),
        "mean torque of all drives at the reference speed; null if the train is fixed",
    )
    harmonics: np.ndarray = result("", ("speed",), "of the common period")
    truncation: FloatArray = result(
        "1",
        ("speed",),
        "estimated largest omitted harmonic / largest included harmonic",
        key="left_out",
    )
    status: np.ndarray  # (speeds,) uint8: Found
    why: tuple[str, ...] = result(
        "", (), "of every speed: why the periodic motion was not found, or empty"
    )
    orbits: tuple[Orbit | None, ...]  # (speeds,)
    growth: FloatArray | None = result(
        "1/s", ("speed",), "of small deviations; null if not computed", default=None
    )
    others: "PeriodicResponse | None" = result(
        "",
        (),
        "further motions at the highest peaks, in the same orders; null for none",
        default=None,
    )

    def condensed(self, groups: SegmentGroups) -> "PeriodicResponse":
        """The same at the stations and spans that stand for segment groups."""
        return replace(
            self,
            angle=self.angle[..., groups.stations],
            torque=self.torque[..., groups.spans],
            mean=self.mean[..., groups.spans],
            others=self.others and self.others.condensed(groups),
        )

    @derived(
        "",
        ("speed",),
        "ok, coarse (omitted harmonics above 1e-10) or none (no motion found)",
        key="status",
    )
    def status_words(self) -> np.ndarray:
        """(speeds,)."""
        return words(self.status, Found)

    @derived("", ("speed",), "small deviations grow: the train does not settle in this motion")
    def is_unstable(self) -> BoolArray:
        """(speeds,)."""
        if self.growth is None:
            return np.zeros(len(self.speed), dtype=bool)
        periods = np.array(
            [np.nan if one is None else one.now.loading.period for one in self.orbits]
        )
        return np.asarray(np.nan_to_num(self.growth * periods) > GROWS)


def nearest(speed: float, orbits: Iterable[Orbit]) -> Orbit | None:
    """The one of the speed nearest to a speed, rad/s; None of none."""
    return min(orbits, key=lambda one: abs(one.now.loading.speed - speed), default=None)


def continued(at: Scene, speed: float, before: Orbit | None) -> tuple[Orbit | None, str]:
    """The orbit at a speed (rad/s) from its neighbour, else from the rigid motion, else by smaller steps of speed."""
    for start in (None,) if before is None else (before, None):
        try:
            return orbit(at, speed, start), ""
        except SolveError as fault:
            why = str(fault)
    if before is None:
        return None, why
    here, reached, step = before, before.now.loading.speed, (speed - before.now.loading.speed) / 2.0
    least = abs(step) / 2.0**SUBDIVISIONS
    while abs(step) > least:
        ahead = reached + step if abs(speed - reached) > abs(step) * (1 + 1e-9) else speed
        try:
            here, reached = orbit(at, ahead, here), ahead
        except SolveError as fault:
            step, why = step / 2.0, str(fault)
            continue
        if reached == speed:
            return here, ""
    return None, why


def orbit(at: Scene, speed: float, start: Orbit | None = None) -> Orbit:
    """The periodic motion at a speed (rad/s), from the rigid motion or a neighbour; raises SolveError.

    The number of harmonics is raised until those left out are small.
    """
    now = operating(at, speed)
    if start is None:
        count = harmonics_at_least(at)
        turned = mean_angle(now.loading, points_in_time(count))
        rigid = rigid_deviation(at.layout, now.loading.steady, now.twist[:, None], turned)
        found = _solved(at, now, harmonics_of(rigid, count), now.load)
    else:
        found = _solved(at, now, start.found.harmonic, start.found.load)
    most = min(MOST, 20_000 // max(1, at.layout.free))
    while found.truncation > ACCURACY and found.count < most:
        more = min(most, int(np.ceil(GROWTH * found.count)))
        found = _solved(at, now, resized(found.harmonic, more), found.load)
    _refuse_slipping(found, now)
    return Orbit(now, found)


def harmonics_at_least(at: Scene) -> int:
    """Harmonics of the common period with which to begin: enough for the joints' own errors and for the torques.

    Raises SolveError where these are more than can be dealt with.
    """
    uneven = max((abs(step.joint.unevenness) for step in at.layout.steps), default=0.0)
    rank = int(np.ceil(np.log(1e-10) / np.log(uneven))) if 0 < uneven < 1 else 1
    first = harmonics_needed(rank, at.layout.orders, [order for order, _ in at.torques])
    most = min(MOST, (MOST_UNKNOWNS // max(1, at.layout.free) - 1) // 2)
    if first > most and at.order < 1:
        raise too_long(at.system.train, rank, most, vibratory=bool(at.torques))
    return int(min(max(FEWEST, first), MOST))


def _solved(at: Scene, now: Operating, harmonic: ComplexArray, load: FloatArray) -> Balance:
    def equations(motion: Motion, loads: FloatArray, count: int) -> Linearised:
        return linearised(at.layout, now.loading, motion, loads, count)

    free, w0, count = at.layout.free, now.loading.w0, (harmonic.shape[1] - 1) // 2
    if at.layout.dampers.size.size:
        deviation = motion_of(harmonic, w0, points_in_time(count)).deviation
        moving = turning(at.layout, deviation, mean_angle(now.loading, deviation.shape[1]))
        twist = at_bodies(at.layout) @ moving.deviation
        harmonic = np.concatenate([harmonic, harmonics_of(twist, count)])
    found = balance(equations, harmonic, load, now.loading.steady, w0)
    return replace(found, harmonic=found.harmonic[:free])


def _refuse_slipping(found: Balance, now: Operating) -> None:
    """A load that stands for a drive which is not there must come out as nothing."""
    known = float(np.abs(now.loading.torque).max(initial=0.0))
    others = np.abs(np.where(now.load == 0.0, found.load, 0.0))[1:]
    if np.any(others > SLIPS * max(known, float(np.abs(found.load).max(initial=0.0)))):
        raise SolveError(
            "a coupling without stiffness would have to carry a mean torque; give it a stiffness"
        )


def response_of(
    at: Scene,
    orbits: Sequence[Orbit | None],
    speed: FloatArray,
    why: tuple[str, ...],
    orders: tuple[Fraction, ...] | None = None,
) -> PeriodicResponse:
    """The response at speeds (speeds,) rad/s whose orbits are known, in some orders: all that are more than rounding.

    why: of every speed without an orbit.
    """
    ranks = [int(order / at.order) for order in orders or ()]
    most = max([*ranks, *(one.found.count for one in orbits if one is not None)], default=0)
    stations, spans, number = len(at.system.stations), len(at.system.spans), len(speed)
    angle = np.full((number, most, stations), np.nan, dtype=complex)
    torque = np.full((number, most, spans), np.nan, dtype=complex)
    mean, drive, truncation = (
        np.full((number, spans), np.nan),
        np.full(number, np.nan),
        np.full(number, np.nan),
    )
    harmonics, status = np.zeros(number, dtype=int), np.full(number, Found.NONE, dtype=np.uint8)
    for k, one in enumerate(orbits):
        if one is None:
            continue
        count, courses = one.found.count, _course(at, one)
        for part, course in zip((angle, torque), courses, strict=True):
            part[k] = 0.0
            part[k, :count] = 2.0 * harmonics_of(course, count)[:, count + 1 :].T
        mean[k] = courses[1].mean(axis=1)
        drive[k] = one.found.load[0] if one.found.load.size else np.nan
        harmonics[k], truncation[k], status[k] = count, one.found.truncation, one.status
    kept = np.array(ranks, dtype=int) - 1
    if orders is None:
        sizes = (
            np.nan_to_num(np.abs(part)).max(axis=(0, 2), initial=0.0) for part in (angle, torque)
        )
        kept = np.flatnonzero(
            np.any([size > KEPT * size.max(initial=0.0) for size in sizes], axis=0)
        )
        orders = tuple(at.order * int(rank + 1) for rank in kept)
    return PeriodicResponse(
        speed,
        orders,
        angle[:, kept],
        torque[:, kept],
        mean,
        drive,
        harmonics,
        truncation,
        status,
        why,
        tuple(orbits),
    )


def _course(at: Scene, there: Orbit) -> tuple[FloatArray, FloatArray]:
    """Over the common period: deviations of the stations (stations, times) rad at own speed, and torques of the spans.

    The torques, (spans, times) N m, are at the driving station's speed, positive when the driving side pushes.
    """
    whole, system, now, found = at.layout, at.system, there.now, there.found
    loading, times = now.stations, points_in_time(found.count)
    turned = mean_angle(loading, times)
    moving = state(
        whole, now.loading, motion_of(found.harmonic, loading.w0, times), found.load, turned
    )
    ratio = system.speed_ratio[:, None]
    inertia = np.where(system.held, 0.0, system.inertia)[:, None] * ratio**2
    need = (
        inertia * moving.acceleration[whole.body]
        + loading.damping[:, None] * moving.slip[whole.body]
    )
    need -= torques(loading, turned, found.load)
    torque = np.zeros((len(system.spans), times))
    torque[whole.spring] = spring_torques(whole, moving.turning.deviation, moving.slip)
    np.add.at(need, system.driving[whole.spring], torque[whole.spring])
    np.subtract.at(need, system.driven[whole.spring], torque[whole.spring])
    _rigid_torques(system, torque, need, moving.turning.first[whole.body])
    return moving.turning.deviation[whole.body] * ratio, torque / system.span_ratio[:, None]


def _rigid_torques(system: System, torque: FloatArray, need: FloatArray, first: FloatArray) -> None:
    """Fill in the torques (spans, times) of the rigid spans and joints, from the leaves of the tree to its root.

    need: (stations, times) N m that a station needs from its rigid spans; summed up here on the way. A joint takes
    power through: torque on either side times the speed there is the same, and the speeds go as `first`.
    Returned is the torque on its driven side.
    """
    condensed = system.condensed
    above = np.full(condensed.tree.size, -1)
    above[condensed.span[condensed.span >= 0]] = np.flatnonzero(condensed.span >= 0)
    station = np.full(condensed.tree.size, -1)
    station[condensed.node] = np.arange(len(condensed.node))
    for node in range(condensed.tree.size - 1, -1, -1):
        span, parent = int(above[node]), int(condensed.tree.parent[node])
        if span < 0 or system.flexibility[span] != 0:
            continue
        driving, driven = int(system.driving[span]), int(system.driven[span])
        here = (
            station[node]
            if station[node] >= 0
            else (driven if condensed.sign[span] > 0 else driving)
        )
        near_root = (
            station[parent] if station[parent] >= 0 else (driving if here == driven else driven)
        )
        passed = need[here] * (first[here] / first[near_root])
        torque[span] = need[here] if here == driven else -passed
        need[near_root] = need[near_root] + passed


def others(at: Scene, found: PeriodicResponse, rows: list[int]) -> PeriodicResponse | None:
    """What else was found at the speeds of some rows of a response, in its orders; None where nothing was.

    A speed stands once for every further motion. They are sought from the rigid motion (None), and from motions a
    little slower and faster that were found from it.
    """
    speeds, orbits = list[float](), list[Orbit | None]()
    for row in rows:
        here = found.orbits[row]
        if here is None:
            continue
        known = [here]
        aside = (_reached(at, float(found.speed[row]) * (1.0 + share), None) for share in ASIDE)
        for start in (None, *(one for one in aside if one is not None)):
            other = _reached(at, float(found.speed[row]), start)
            if other is not None and all(_differ(at, one, other) for one in known):
                known.append(other)
        speeds += [float(found.speed[row])] * (len(known) - 1)
        orbits += known[1:]
    if not orbits:
        return None
    return response_of(at, orbits, np.array(speeds), ("",) * len(orbits), found.orders)


def _reached(at: Scene, speed: float, start: Orbit | None) -> Orbit | None:
    """A motion at the speed, carried there in steps from another one; None where the way breaks off."""
    try:
        if start is None:
            return orbit(at, speed)
        for ahead in np.linspace(start.now.loading.speed, speed, STEPS + 1)[1:].tolist():
            start = orbit(at, ahead, start)
    except SolveError:
        return None
    return start


def _differ(at: Scene, one: Orbit, other: Orbit) -> bool:
    """Two motions at one speed are not the same."""
    both = response_of(at, [one, other], np.full(2, one.now.loading.speed), ("", ""))
    size = np.abs(both.torque)
    return bool(np.abs(size[0] - size[1]).max(initial=0.0) > SAME * size.max(initial=0.0))
