"""Unstable ranges of speed: where they end, how fast small deviations grow within, and what they are called."""

from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
from operator import attrgetter, itemgetter
from typing import Literal

import numpy as np

from torsion.analyses.stability.floquet_exponents import UNSTABLE, Multipliers, Search
from torsion.analyses.stability.straight_modes import Basis
from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.findings import Progress
from torsion.kernels.bracketed_search import find_minimum, find_root
from torsion.results import derived, reported, result

TAKES_PART = 0.02  # of the largest modal energy
ALONE = 0.1  # of the largest: a second mode with less makes no zone of two modes where one alone explains it
DETUNED = 0.35  # of w0: no combination explains a growth farther away
# Of w0: where two modes take part, a zone of both is believed before one of either alone.
MIXED_COSTS = 0.05
# Of w0, per rank: a near miss of a low rank is believed before a hit of a high one.
RANK_COSTS = 0.02
WITHIN = 1e-10  # relative: boundaries are sought this closely
NEAR_BOUNDARY = 10.0 * WITHIN  # relative: a speed so near belongs to the range
# Bisections before a boundary of a train without damping is sought by the gap of its multipliers.
BISECTIONS = 10
PARTS = 8  # of a range: in each of them the growth is evaluated before the greatest is sought
PEAK = 1e-4  # of the interval in which the greatest growth is sought; at a smooth peak its growth is then far closer

Kind = Literal["principal", "sum", "difference", "unexplained"]
# Modes, what is to be a multiple of w0 (rad/s), and its cost.
Combination = tuple[Kind, tuple[int, ...], float, float]


@reported
class Zone:
    """A parametric resonance."""

    kind: Kind = result("principal, sum, difference or unexplained")
    modes: tuple[int, ...] = result(
        "elastic modes that take part, counted from 1"
    )  # 0: free turning
    rank: int = result("k of k times the common frequency = combination of the modes")

    @derived("its type in words")
    def name(self) -> str:
        """The name of the resonance as the report prints it."""
        if self.kind == "unexplained":
            return f"unstable in mode {self.modes[0]}" if self.modes else "unstable"
        if self.kind == "principal":
            share = "" if self.rank == 1 else f"/{self.rank}"
            return f"principal of mode {self.modes[0]} (2 w{self.modes[0]}{share})"
        i, j = self.modes
        pair = f"w{i} + w{j}" if self.kind == "sum" else f"w{j} - w{i}"
        return f"{self.kind} of modes {i} and {j} " + (
            f"({pair})" if self.rank == 1 else f"(({pair})/{self.rank})"
        )


def zone(energy: FloatArray, shapes: Basis, w0: float) -> Zone:
    """Return the combination of the modes that take part which lies nearest to a multiple of w0 (rad/s)."""
    w = shapes.frequency
    taking = [int(k) for k in np.argsort(-energy) if energy[k] > TAKES_PART]
    strong = [k for k in taking if energy[k] > ALONE]
    mixed = MIXED_COSTS if len(strong) > 1 else 0.0
    single: list[Combination] = [("principal", (k,), 2.0 * w[k], mixed) for k in strong]
    pairs: list[Combination] = []
    for i, j in combinations(sorted(taking), 2):
        pairs += [("sum", (i, j), w[i] + w[j], 0.0), ("difference", (i, j), w[j] - w[i], 0.0)]

    def choose(resonances: list[Combination]) -> Zone | None:
        """Return the resonance that costs least; None where all are too far away."""
        choices = []
        for kind, modes, combination, cost in resonances:
            rank = max(1, round(combination / w0))
            away = abs(combination / w0 - rank)
            if away < DETUNED:
                numbers = tuple(max(0, k - shapes.rigid + 1) for k in modes)
                choices.append((away + RANK_COSTS * rank + cost, Zone(kind, numbers, rank)))
        return min(choices, key=itemgetter(0), default=(0.0, None))[1]

    # One mode that explains it alone is believed before any two.
    alone = choose(single) if len(strong) < 2 else None
    unexplained = tuple(max(0, k - shapes.rigid + 1) for k in taking[:1])
    return alone or choose([*single, *pairs]) or Zone("unexplained", unexplained, 0)


def candidates(
    shapes: Basis, orders: tuple[Fraction, ...], first: float, last: float, most_rank: int = 2
) -> FloatArray:
    """Return the speeds (rad/s) in a range at which a combination of two modes meets a multiple of a joint's frequency.

    orders: frequencies of the joints / reference speed.
    """
    w = shapes.frequency[shapes.rigid :]
    i, j = np.triu_indices(len(w))
    resonances = np.concatenate([w[i] + w[j], np.abs(w[i] - w[j])[i != j], w])
    multiples = np.outer([float(order) for order in orders], np.arange(1, most_rank + 1)).ravel()
    speed = resonances / multiples[:, None]
    return np.unique(speed[(speed > first) & (speed < last)])


@reported
class UnstableRange(Zone):
    """Speeds between which small deviations grow, by a parametric resonance."""

    first: float = result("rad/s", "lower boundary, reference speed", key="from_rad_per_s")
    last: float = result("rad/s", "upper boundary", key="to_rad_per_s")
    is_open: tuple[bool, bool] = result(
        "[below, above] the range continues beyond the requested speeds", key="goes_on"
    )
    growth: float = result("1/s", "largest growth found within")
    at: float = result("rad/s", "where")
    unknown: tuple[float | None, float | None] = result(
        "rad/s",
        "[below, above] from the end to there nothing is known; null elsewhere",
        key="unknown_to_rad_per_s",
        default=(None, None),
    )

    @property
    def grows_at_end(self) -> tuple[bool, bool]:
        """The end itself is unstable: the last speed requested, or the last that has a periodic motion."""
        (below, above), (under, over) = self.is_open, self.unknown
        return below or under is not None, above or over is not None

    def meets(self, first: float, last: float) -> bool:
        """Return whether some unstable speed of it lies between two speeds (rad/s); a boundary is none."""
        below, above = self.grows_at_end
        begins = self.first <= last if below else self.first < last
        return begins and (self.last >= first if above else self.last > first)


class NoMotion(SolveError):
    """A speed without a periodic motion lies between two that have one."""


@dataclass(frozen=True)
class End:
    """One end of a range."""

    inner: float  # rad/s: the outermost unstable speed that is known
    speed: float  # rad/s: the boundary, else the same
    is_open: bool = False
    unknown: float | None = None


def unstable_ranges(search: Search, report: Progress) -> tuple[UnstableRange, ...]:
    """Return every range around the unstable speeds that are known; speeds without a periodic motion part them."""
    ranges = list[UnstableRange]()

    def is_new(speed: float) -> bool:
        """Return whether a speed is unstable, and in none of the ranges."""
        near = 1.0 - NEAR_BOUNDARY, 1.0 + NEAR_BOUNDARY
        within = (band.first * near[0] <= speed <= band.last * near[1] for band in ranges)
        return search.is_unstable(speed) and not any(within)

    while (seed := next(filter(is_new, speeds := sorted(search.known)), None)) is not None:
        report("boundaries", 0.8 + 0.2 * speeds.index(seed) / len(speeds))
        ranges.append(_find_range(search, seed))
    return tuple(sorted(ranges, key=attrgetter("first")))


def _find_range(search: Search, seed: float) -> UnstableRange:
    """The range of an unstable speed (rad/s); where the search for its fastest growth meets a gap, the part before."""
    while True:
        low = _end(search, seed, -1)
        high = _end(search, seed, 1)
        worst = _fastest(search, low.speed, high.speed)
        inside = [speed for speed in search.known if low.inner < speed < high.inner]
        if all(search.is_unstable(speed) for speed in inside):
            break
    multipliers = _multipliers(search, worst)

    # The energy of the fastest growing motion in each mode at reference angle zero, largest 1.
    shapes = search.shapes
    onto = shapes.shape.T * shapes.inertia
    if search.reduced is not None:
        onto = onto @ search.reduced.shape
    angle, speed = (
        onto @ part[: onto.shape[1], 0] for part in (multipliers.vector, multipliers.speed)
    )
    energy = (shapes.frequency * np.abs(angle)) ** 2 + np.abs(speed) ** 2
    energy = energy / max(float(energy.max()), np.finfo(float).tiny)
    named = zone(energy, shapes, 2.0 * np.pi / multipliers.period)
    return UnstableRange(
        named.kind,
        named.modes,
        named.rank,
        low.speed,
        high.speed,
        (low.is_open, high.is_open),
        multipliers.growth,
        worst,
        (low.unknown, high.unknown),
    )


def _end(search: Search, seed: float, side: int) -> End:
    """Where a range ends above (side 1) or below (-1) an unstable speed of it (rad/s)."""
    speeds = sorted(
        (speed for speed in search.known if side * (speed - seed) >= 0), key=lambda w: side * w
    )
    number = next((k for k, w in enumerate(speeds) if not search.is_unstable(w)), len(speeds))
    inner = speeds[number - 1]
    beyond = speeds[number:]
    if not beyond:
        return End(inner, inner, is_open=True)
    if search(beyond[0]) is None:
        nearest_known = next((speed for speed in beyond if search(speed) is not None), beyond[-1])
        return End(inner, inner, unknown=nearest_known)
    try:
        return End(inner, _boundary(search, inner, beyond[0]))
    except NoMotion:
        return _end(search, seed, side)


def _boundary(search: Search, inner: float, outer: float) -> float:
    """The speed (rad/s) between an unstable and a stable one at which the growth begins; raises NoMotion."""
    if search.loses and _multipliers(search, outer).growth >= 0.0:
        return outer
    for _ in range(0 if search.loses else BISECTIONS):
        middle = (inner + outer) / 2.0
        _multipliers(search, middle)
        inner, outer = (middle, outer) if search.is_unstable(middle) else (inner, middle)
    meeting = np.exp(1j * np.angle(_multipliers(search, inner).multiplier[0]))

    def height(speed: float) -> float:
        return indicator(_multipliers(search, speed), meeting, loses=search.loses)

    try:
        return float(find_root(height, inner, outer, tolerance=WITHIN * inner))
    except ValueError:
        return (inner + outer) / 2.0


def _multipliers(search: Search, speed: float) -> Multipliers:
    """Of the motion at a speed (rad/s); raises NoMotion where there is none."""
    solved = search(speed)
    if solved is None:
        raise NoMotion(f"no periodic motion at {speed:.8g} rad/s")
    return solved[1]


def indicator(multipliers: Multipliers, meeting: complex | None = None, *, loses: bool) -> float:
    """Return what is smooth over speed and positive where unstable.

    That is the growth, or without damping the squared gap of two multipliers. meeting: unit complex number near which
    the two meet; None: wherever they lie closest.
    """
    if loses or (multipliers.growth * multipliers.period > UNSTABLE * 1e3 and meeting is None):
        return multipliers.growth
    value = multipliers.multiplier
    if meeting is None:
        distance = np.abs(value[:, None] - value) + 10.0 * np.eye(len(value))
        first, second = np.unravel_index(int(np.argmin(distance)), distance.shape)
    else:
        first, second = np.argsort(np.abs(value - meeting))[:2]
    gap = np.log(value[first] / value[second]) / (2.0 * multipliers.period)
    return float((gap * gap).real)


def _fastest(search: Search, lower: float, upper: float) -> float:
    """The speed (rad/s) of the fastest growth between two: of speeds in all parts, and about the best of them."""

    def inside() -> list[float]:
        return sorted(w for w, solved in search.known.items() if solved and lower <= w <= upper)

    for low, high in pairwise([lower, *inside(), upper]):
        parts = int(np.ceil(PARTS * (high - low) / (upper - lower))) if upper > lower else 1
        for speed in np.linspace(low, high, parts + 1)[1:-1].tolist():
            search(speed)
    speeds = inside()
    best = int(np.argmax([search.growth(speed) for speed in speeds]))
    low = speeds[max(best - 1, 0)]
    high = speeds[min(best + 1, len(speeds) - 1)]
    if high > low:
        find_minimum(
            lambda speed: -float(np.nan_to_num(search.growth(float(speed)))),
            low,
            high,
            tolerance=PEAK * (high - low),
        )
    return max(inside(), key=search.growth)
