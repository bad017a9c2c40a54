"""The exact periodic response of a train with joints over speed, by harmonic balance."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum
from fractions import Fraction
from functools import partial

import numpy as np

from torsion.analyses.stability.common_period import harmonics_needed, period_too_long
from torsion.analyses.stability.equations_of_motion import (
    equations,
    mean_angle,
    spring_torques,
    state,
    torques,
    turning,
)
from torsion.analyses.stability.mechanism_loads import Operating, Scene, operating, rigid_deviation
from torsion.arrays import BoolArray, ComplexArray, FloatArray
from torsion.errors import SolveError
from torsion.kernels.periodic.harmonic_balance import (
    MOST_UNKNOWNS,
    Balance,
    balance,
    motion_of,
    points_in_time,
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

    operation: Operating
    balance: Balance


@reported
class PeriodicResponse:
    """Complex amplitudes of the exact periodic response (half ranges, phase at reference angle zero).

    NaN where no periodic solution was found.
    """

    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    orders: tuple[Fraction, ...] = result(
        "", "order", "per revolution of the reference, ascending, exact", record="order"
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
        "speed",
        "mean torque of all drives at the reference speed; null if the train is fixed",
    )
    harmonics: np.ndarray = result("", "speed", "of the common period")
    truncation: FloatArray = result(
        "1",
        "speed",
        "estimated largest omitted harmonic / largest included harmonic",
        key="left_out",
    )
    status: np.ndarray  # (speeds,) uint8: Found
    why: tuple[str, ...] = result("of every speed: why the periodic motion was not found, or empty")
    orbits: tuple[Orbit | None, ...]  # (speeds,)
    growth: FloatArray | None = result(
        "1/s", "speed", "of small deviations; null if not computed", default=None
    )
    others: "PeriodicResponse | None" = result(
        "further motions at the highest peaks, in the same orders; null for none",
        default=None,
    )

    @derived(
        "",
        "speed",
        "ok, coarse (omitted harmonics above 1e-10) or none (no motion found)",
        key="status",
    )
    def status_words(self) -> np.ndarray:
        """What was found at every speed, in words, (speeds,)."""
        return words(self.status, Found)

    @derived("", "speed", "small deviations grow: the train does not settle in this motion")
    def is_unstable(self) -> BoolArray:
        if self.growth is None:
            return np.zeros(len(self.speed), dtype=bool)
        w0 = [np.nan if orbit is None else orbit.operation.loading.w0 for orbit in self.orbits]
        return np.asarray(np.nan_to_num(self.growth * 2.0 * np.pi / np.array(w0)) > GROWS)


def continued(mechanism: Scene, speed: float, orbits: Iterable[Orbit]) -> tuple[Orbit | None, str]:
    """Return the orbit at a speed (rad/s) from the nearest one, else from the rigid motion, else by smaller steps.

    The text says why there is none.
    """
    near = min(orbits, key=lambda orbit: abs(orbit.operation.loading.speed - speed), default=None)
    for start in (None,) if near is None else (near, None):
        try:
            return orbit(mechanism, speed, start), ""
        except SolveError as fault:
            why = str(fault)
    if near is None:
        return None, why

    step = (speed - near.operation.loading.speed) / 2.0
    smallest = abs(step) / 2.0**SUBDIVISIONS
    while abs(step) > smallest:
        reached = near.operation.loading.speed
        ahead = reached + step if abs(speed - reached) > abs(step) * (1 + 1e-9) else speed
        try:
            near = orbit(mechanism, ahead, near)
        except SolveError as fault:
            step = step / 2.0
            why = str(fault)
            continue
        if ahead == speed:
            return near, ""
    return None, why


def orbit(mechanism: Scene, speed: float, start: Orbit | None = None) -> Orbit:
    """Return the periodic motion at a speed (rad/s), from the rigid motion or a neighbour; raises SolveError.

    The number of harmonics is raised until those left out are small.
    """
    operation = operating(mechanism, speed)
    if start is None:
        count = harmonics_at_least(mechanism)
        turned = mean_angle(operation.loading, points_in_time(count))
        rigid = rigid_deviation(
            mechanism.layout, operation.loading.steady, operation.twist[:, None], turned
        )
        solution = _solve(mechanism, operation, harmonics_of(rigid, count), operation.load)
    else:
        solution = _solve(mechanism, operation, start.balance.harmonic, start.balance.load)
    limit = min(MOST, 20_000 // max(1, mechanism.layout.free))
    while solution.truncation > ACCURACY and solution.count < limit:
        count = min(limit, int(np.ceil(GROWTH * solution.count)))
        more = count - solution.count
        wider = np.pad(solution.harmonic, ((0, 0), (more, more)))
        solution = _solve(mechanism, operation, wider, solution.load)

    # A load that stands for a drive which is not there must come out as nothing.
    imagined = np.abs(np.where(operation.load == 0.0, solution.load, 0.0))[1:]
    largest = float(np.abs(np.append(operation.loading.torque, solution.load)).max(initial=0.0))
    if np.any(imagined > SLIPS * largest):
        raise SolveError(
            "a coupling without stiffness would have to carry a mean torque; give it a stiffness"
        )
    return Orbit(operation, solution)


def harmonics_at_least(mechanism: Scene) -> int:
    """Return the harmonics with which to begin: enough for the joints' own errors and for the torques.

    Raises SolveError where these are more than can be dealt with.
    """
    uneven = max((abs(step.joint.unevenness) for step in mechanism.layout.steps), default=0.0)
    rank = int(np.ceil(np.log(1e-10) / np.log(uneven))) if 0 < uneven < 1 else 1
    first = harmonics_needed(
        rank, mechanism.layout.orders, [order for order, _ in mechanism.torques]
    )
    limit = min(MOST, (MOST_UNKNOWNS // max(1, mechanism.layout.free) - 1) // 2)
    if first > limit and mechanism.order < 1:
        raise period_too_long(
            mechanism.system.train, rank, limit, vibratory=bool(mechanism.torques)
        )
    return int(min(max(FEWEST, first), MOST))


def _solve(
    mechanism: Scene, operation: Operating, harmonic: ComplexArray, load: FloatArray
) -> Balance:
    """Return the balance near harmonics of the coordinates; the twists of dampers are unknowns beside them."""
    w0 = operation.loading.w0
    count = harmonic.shape[1] // 2
    if mechanism.layout.dampers.size.size:
        deviation = motion_of(harmonic, w0, points_in_time(count)).deviation
        moving = turning(
            mechanism.layout, deviation, mean_angle(operation.loading, deviation.shape[1])
        )
        twist = mechanism.layout.damper_twist @ moving.deviation
        harmonic = np.concatenate([harmonic, harmonics_of(twist, count)])
    at_speed = partial(equations, mechanism.layout, operation.loading)
    steady = operation.loading.steady
    solution = balance(at_speed, harmonic, load, steady, w0, mechanism.factors)
    return replace(solution, harmonic=solution.harmonic[: mechanism.layout.free])


def response_of(
    mechanism: Scene,
    orbits: Sequence[Orbit | None],
    speed: FloatArray,
    why: tuple[str, ...],
    orders: tuple[Fraction, ...] | None = None,
) -> PeriodicResponse:
    """Return the response at speeds (speeds,) rad/s whose orbits are known, in some orders, else in all that are felt.

    why: of every speed without an orbit.
    """
    ranks = [int(order / mechanism.order) for order in orders or ()]
    count_of_all = max(
        [*ranks, *(solved.balance.count for solved in orbits if solved is not None)], default=0
    )
    stations = len(mechanism.system.stations)
    spans = len(mechanism.system.spans)
    number = len(speed)
    angle = np.full((number, count_of_all, stations), np.nan, dtype=complex)
    torque = np.full((number, count_of_all, spans), np.nan, dtype=complex)
    mean, drive, truncation = np.full((number, spans), np.nan), *np.full((2, number), np.nan)
    harmonics = np.zeros(number, dtype=int)
    status = np.full(number, Found.NONE, dtype=np.uint8)
    for row, solved in enumerate(orbits):
        if solved is None:
            continue
        count = solved.balance.count
        courses = _course(mechanism, solved)
        # Amplitudes of cosines: twice the harmonic of the positive frequency.
        for amplitude, course in zip((angle, torque), courses, strict=True):
            amplitude[row] = 0.0
            amplitude[row, :count] = 2.0 * harmonics_of(course, count)[:, count + 1 :].T
        mean[row] = courses[1].mean(axis=1)
        drive[row] = solved.balance.load[0] if solved.balance.load.size else np.nan
        harmonics[row] = count
        truncation[row] = solved.balance.truncation
        status[row] = Found.OK if truncation[row] <= ACCURACY else Found.COARSE

    # Orders that no speed feels are left out: most of the many harmonics of the balance are rounding.
    kept = np.array(ranks, dtype=int) - 1
    if orders is None:
        felt = np.zeros(count_of_all, dtype=bool)
        for amplitude in (angle, torque):
            size = np.nan_to_num(np.abs(amplitude)).max(axis=(0, 2), initial=0.0)
            felt |= size > KEPT * size.max(initial=0.0)
        kept = np.flatnonzero(felt)
        orders = tuple(mechanism.order * int(rank + 1) for rank in kept)
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


def _course(mechanism: Scene, solved: Orbit) -> tuple[FloatArray, FloatArray]:
    """Over the common period: deviations of the stations (stations, times) rad at own speed, and torques of the spans.

    The torques, (spans, times) N m, are at the driving station's speed, positive when the driving side pushes.
    """
    layout = mechanism.layout
    system = mechanism.system
    loading = solved.operation.stations
    load = solved.balance.load
    times = points_in_time(solved.balance.count)
    turned = mean_angle(loading, times)
    motion = motion_of(solved.balance.harmonic, loading.w0, times)
    moving = state(layout, solved.operation.loading, motion, load, turned)
    ratio = system.speed_ratio[:, None]
    # What every station needs from its rigid spans, (stations, times) N m.
    inertia = np.where(system.held, 0.0, system.inertia)[:, None] * ratio**2
    need = (
        inertia * moving.acceleration[layout.body]
        + loading.damping[:, None] * moving.slip[layout.body]
        - torques(loading, turned, load)
    )
    torque = np.zeros((len(system.spans), times))
    torque[layout.spring] = spring_torques(layout, moving.turning.deviation, moving.slip)
    np.add.at(need, system.driving[layout.spring], torque[layout.spring])
    np.subtract.at(need, system.driven[layout.spring], torque[layout.spring])

    # The rigid spans and joints, from the leaves of the tree to its root; a station's need sums up on the way. A joint
    # takes power through: torque on either side times the speed there is the same. A span has the torque on its driven
    # side.
    first = moving.turning.first[layout.body]
    condensed = system.condensed
    spans = np.flatnonzero(condensed.span >= 0)
    span_of, station_of = np.full((2, condensed.tree.size), -1)
    span_of[condensed.span[spans]] = spans
    station_of[condensed.node] = np.arange(len(condensed.node))
    for node in range(condensed.tree.size - 1, -1, -1):
        span = int(span_of[node])
        if span < 0 or system.flexibility[span] != 0:
            continue
        driving, driven = int(system.driving[span]), int(system.driven[span])
        leaf, root = station_of[node], station_of[int(condensed.tree.parent[node])]
        if leaf < 0:
            leaf = driven if condensed.sign[span] > 0 else driving
        if root < 0:
            root = driving if leaf == driven else driven
        passed = need[leaf] * (first[leaf] / first[root])
        torque[span] = need[leaf] if leaf == driven else -passed
        need[root] = need[root] + passed
    return moving.turning.deviation[layout.body] * ratio, torque / system.span_ratio[:, None]


def further_motions(
    mechanism: Scene, response: PeriodicResponse, rows: list[int]
) -> PeriodicResponse | None:
    """Return further motions at the speeds of some rows of a response, in its orders; None where there are none.

    A speed stands once for every further motion. They are sought from the rigid motion, and from motions a little
    slower and faster that were found from it.
    """

    def carry(speed: float, start: Orbit | None) -> Orbit | None:
        """Return a motion at the speed, carried there in steps from another one; None where the way breaks off."""
        try:
            if start is None:
                return orbit(mechanism, speed)
            for ahead in np.linspace(start.operation.loading.speed, speed, STEPS + 1)[1:].tolist():
                start = orbit(mechanism, ahead, start)
        except SolveError:
            return None
        return start

    def differ(motion: Orbit, candidate: Orbit) -> bool:
        """Return whether the largest torques of two motions at a speed do."""
        both = response_of(mechanism, [motion, candidate], np.full(2, speed), ("", ""))
        size = np.abs(both.torque)
        return bool(np.abs(size[0] - size[1]).max(initial=0.0) > SAME * size.max(initial=0.0))

    speeds = list[float]()
    orbits = list[Orbit | None]()
    for row in rows:
        reported = response.orbits[row]
        speed = float(response.speed[row])
        if reported is None:
            continue
        motions = [reported]
        starts = [carry(speed * (1.0 + share), None) for share in ASIDE]
        for start in (None, *filter(None, starts)):
            candidate = carry(speed, start)
            if candidate and all(differ(motion, candidate) for motion in motions):
                motions.append(candidate)
        speeds += [speed] * (len(motions) - 1)
        orbits += motions[1:]
    if not orbits:
        return None
    return response_of(mechanism, orbits, np.array(speeds), ("",) * len(orbits), response.orders)
