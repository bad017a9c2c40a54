"""Unstable ranges of speed: where they end, how fast small deviations grow within, and what they are called."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations, pairwise
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
MIXED_COSTS = (
    0.05  # of w0: where two modes take part, a zone of both is believed before one of either alone
)
RANK_COSTS = (
    0.02  # of w0, per rank: a near miss of a low rank is believed before a hit of a high one
)
WITHIN = 1e-10  # relative: boundaries are sought this closely
BISECTIONS = (
    10  # before a boundary of a train without damping is sought by the gap of its multipliers
)
PARTS = 8  # of a range: in each of them the growth is evaluated before the greatest is sought
PEAK = 1e-4  # of the interval in which the greatest growth is sought; at a smooth peak its growth is then far closer

Kind = Literal["principal", "sum", "difference", "unexplained"]
Combination = tuple[
    Kind, tuple[int, ...], float
]  # modes, and what is to be a multiple of w0 (rad/s)


@reported
class Zone:
    """A parametric resonance."""

    kind: Kind = result("", (), "principal, sum, difference or unexplained")
    modes: tuple[int, ...] = result(
        "", (), "elastic modes that take part, counted from 1"
    )  # 0: free turning
    rank: int = result("", (), "k of k times the common frequency = combination of the modes")

    @derived("", (), "its type in words")
    def name(self) -> str:
        """As the report prints it."""
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


def modal_energy(found: Multipliers, shapes: Basis, reduced: Basis | None = None) -> FloatArray:
    """(modes,) energy of the fastest growing motion in each mode at reference angle zero, largest 1.

    reduced: the basis of the motion, with more behind it; None: the coordinates.
    """
    onto = shapes.shape.T * shapes.inertia
    if reduced is not None:
        onto = onto @ reduced.shape
    number = onto.shape[1]
    angle, speed = onto @ found.vector[:number, 0], onto @ found.speed[:number, 0]
    energy = (shapes.frequency * np.abs(angle)) ** 2 + np.abs(speed) ** 2
    return np.asarray(energy / max(float(energy.max()), np.finfo(float).tiny))


def zone(energy: FloatArray, shapes: Basis, w0: float) -> Zone:
    """The combination of the modes that take part which lies nearest to a multiple of w0 (rad/s)."""
    w = shapes.frequency
    taking = [int(k) for k in np.argsort(-energy) if energy[k] > TAKES_PART]
    strong = [k for k in taking if energy[k] > ALONE]
    alone: list[Combination] = [("principal", (k,), 2.0 * w[k]) for k in strong]
    pairs: list[Combination] = []
    for i, j in combinations(sorted(taking), 2):
        pairs += [("sum", (i, j), w[i] + w[j]), ("difference", (i, j), w[j] - w[i])]

    def numbers(modes: Iterable[int]) -> tuple[int, ...]:
        return tuple(max(0, k - shapes.rigid + 1) for k in modes)

    def near(some: list[Combination], cost: float = 0.0) -> Iterator[tuple[float, Zone]]:
        for kind, modes, combination in some:
            rank = max(1, round(combination / w0))
            away = abs(combination / w0 - rank)
            if away < DETUNED:
                yield away + RANK_COSTS * rank + cost, Zone(kind, numbers(modes), rank)

    choices = list(near(alone)) if len(strong) < 2 else []
    choices = choices or [*near(alone, MIXED_COSTS), *near(pairs)]
    return (
        min(choices, key=lambda one: one[0])[1]
        if choices
        else Zone("unexplained", numbers(taking[:1]), 0)
    )


def candidates(
    shapes: Basis, orders: tuple[Fraction, ...], first: float, last: float, most_rank: int = 2
) -> FloatArray:
    """Reference speeds (rad/s) in a range at which a combination of two modes meets a multiple of a joint's frequency.

    orders: frequencies of the joints / reference speed.
    """
    w = shapes.frequency[shapes.rigid :]
    i, j = np.triu_indices(len(w))
    found = np.concatenate([w[i] + w[j], np.abs(w[i] - w[j])[i != j], w])
    speed = np.concatenate(
        [found / (float(order) * rank) for order in orders for rank in range(1, most_rank + 1)]
    )
    return np.unique(speed[(speed > first) & (speed < last)])


@reported
class UnstableRange(Zone):
    """Speeds between which small deviations grow, by a parametric resonance."""

    first: float = result("rad/s", (), "lower boundary, reference speed", key="from_rad_per_s")
    last: float = result("rad/s", (), "upper boundary", key="to_rad_per_s")
    is_open: tuple[bool, bool] = result(
        "", (), "[below, above] the range continues beyond the requested speeds", key="goes_on"
    )
    growth: float = result("1/s", (), "largest growth found within")
    at: float = result("rad/s", (), "where")
    unknown: tuple[float | None, float | None] = result(
        "rad/s",
        (),
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
        """Some unstable speed of it lies between two speeds (rad/s); a boundary is none."""
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
    """Every range around the unstable speeds that are known; speeds without a periodic motion part them."""
    out = list[UnstableRange]()
    while True:
        known = sorted(search.known)
        met = [(one.first * (1.0 - 10.0 * WITHIN), one.last * (1.0 + 10.0 * WITHIN)) for one in out]
        apart = (
            one
            for one in known
            if search.is_unstable(one) and not any(low <= one <= high for low, high in met)
        )
        seed = next(apart, None)
        if seed is None:
            return tuple(sorted(out, key=lambda one: one.first))
        report("boundaries", 0.8 + 0.2 * known.index(seed) / len(known))
        out.append(_around(search, seed))


def _around(search: Search, seed: float) -> UnstableRange:
    """The range of an unstable speed (rad/s); where the search for its greatest growth meets a gap, the part before."""
    while True:
        low, high = _end(search, seed, -1), _end(search, seed, 1)
        worst = _fastest(search, low.speed, high.speed)
        if all(
            search.is_unstable(one) for one in list(search.known) if low.inner < one < high.inner
        ):
            break
    found = _multipliers(search, worst)
    named = zone(
        modal_energy(found, search.shapes, search.reduced),
        search.shapes,
        2.0 * np.pi / found.period,
    )
    return UnstableRange(
        named.kind,
        named.modes,
        named.rank,
        low.speed,
        high.speed,
        (low.is_open, high.is_open),
        found.growth,
        worst,
        (low.unknown, high.unknown),
    )


def _end(search: Search, seed: float, side: int) -> End:
    """Where a range ends above (side 1) or below (-1) an unstable speed of it (rad/s)."""
    away = sorted(
        (one for one in search.known if side * (one - seed) >= 0), key=lambda one: side * one
    )
    number = next((k for k, one in enumerate(away) if not search.is_unstable(one)), len(away))
    inner, beyond = away[number - 1], away[number:]
    if not beyond:
        return End(inner, inner, is_open=True)
    if search(beyond[0]) is None:
        return End(
            inner,
            inner,
            unknown=next((one for one in beyond if search(one) is not None), beyond[-1]),
        )
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
    at = np.exp(1j * np.angle(_multipliers(search, inner).multiplier[0]))

    def height(speed: float) -> float:
        return indicator(_multipliers(search, speed), at, loses=search.loses)

    try:
        return float(find_root(height, inner, outer, tolerance=WITHIN * inner))
    except ValueError:
        return (inner + outer) / 2.0


def _multipliers(search: Search, speed: float) -> Multipliers:
    """Of the motion at a speed (rad/s); raises NoMotion where there is none."""
    found = search(speed)
    if found is None:
        raise NoMotion(f"no periodic motion at {speed:.8g} rad/s")
    return found[1]


def indicator(found: Multipliers, at: complex | None = None, *, loses: bool) -> float:
    """Smooth over speed, positive where unstable: growth, or without damping the squared gap of two multipliers.

    at: unit complex number near which the two meet; None: wherever they lie closest.
    """
    if loses or (found.growth * found.period > UNSTABLE * 1e3 and at is None):
        return found.growth
    value = found.multiplier
    if at is None:
        apart = np.abs(value[:, None] - value) + 10.0 * np.eye(len(value))
        first, second = np.unravel_index(int(np.argmin(apart)), apart.shape)
    else:
        first, second = np.argsort(np.abs(value - at))[:2]
    gap = np.log(value[first] / value[second]) / (2.0 * found.period)
    return float((gap * gap).real)


def _fastest(search: Search, lower: float, upper: float) -> float:
    """The speed (rad/s) of the greatest growth between two: of speeds in all parts, and about the best of them."""

    def growth(speed: float) -> float:
        return float(np.nan_to_num(search.growth(speed)))

    def inside() -> list[float]:
        return sorted(
            one
            for one, found in search.known.items()
            if found is not None and lower <= one <= upper
        )

    for low, high in pairwise([lower, *inside(), upper]):
        parts = int(np.ceil(PARTS * (high - low) / (upper - lower))) if upper > lower else 1
        for speed in np.linspace(low, high, parts + 1)[1:-1].tolist():
            search(speed)
    speeds = inside()
    best = int(np.argmax([growth(one) for one in speeds]))
    low, high = speeds[max(best - 1, 0)], speeds[min(best + 1, len(speeds) - 1)]
    if high > low:
        find_minimum(lambda speed: -growth(float(speed)), low, high, tolerance=PEAK * (high - low))
    return max(inside(), key=growth)
