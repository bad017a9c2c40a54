"""Torques that follow how their station turns: by parts over its speed, motors, waves of its angle, dry friction.

Angles and speeds are whole and of the own shaft, torques positive in the sense of rotation.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.collocation import AT_LIMIT, Conditions, Law, Limits, Points
from torsion.kernels.motion.loaded_modes import History

BACKWARD, STANDS, FORWARD, FREE = range(4)  # FREE: none of it acts
# of the speed scale: what the accuracy of a step may leave of the speed of a station that stands
STANDING = 1e-9
# of the friction: a torque that exceeds it by less breaks nothing away, as rounding may
MORE = 1e-9
RETURN = 1e3  # 1/s, rate at which that is taken back
SAME = 1e-12  # of the largest value: polynomials of two parts that differ less are one


class Window(NamedTuple):
    """The time in which a law acts."""

    begin: float = 0.0  # s
    end: float = math.inf

    def holds(self, time: Any) -> Any:
        """Whether it acts at a time or at times; a step ends where it does, and acts as at its first time."""
        return (time >= self.begin) & (time < self.end)


ALWAYS = Window()


@dataclass(frozen=True)
class Parts:
    """A function of speed by parts, or several in columns, each a polynomial of degree 2."""

    edges: FloatArray  # (parts - 1,) rad/s, ascending
    polynomial: np.ndarray  # (parts, 3) or (parts, 3, functions): constant, by speed, by its square
    scale: float  # rad/s

    def part(self, speed: float) -> int:
        """Return the number of the part in which a speed lies."""
        return int(np.searchsorted(self.edges, speed, side="right"))

    def value(self, part: int, speed: FloatArray) -> tuple[np.ndarray, np.ndarray]:
        """Value and slope, also a little beyond the part; of several functions at speeds (speeds, 1)."""
        level, slope, square = self.polynomial[part]
        return level + speed * (slope + speed * square), slope + 2.0 * square * speed


def constant(level: float) -> Parts:
    """Return a torque (N m) that is the same at every speed."""
    return Parts(np.empty(0), np.array([[level, 0.0, 0.0]]), 1.0)


def quadratic(torque: float, speed: float) -> Parts:
    """Return the law torque (n/speed) |n/speed|, of a propeller or pump."""
    square = torque / speed**2
    return Parts(np.zeros(1), np.array([[0.0, 0.0, -square], [0.0, 0.0, square]]), speed)


def table(rows: Sequence[tuple[float, float]]) -> Parts:
    """Straight lines between rows (rad/s, torque), the first and the last of them continued."""
    speed, torque = np.array(rows, dtype=float).T
    slope = np.diff(torque) / np.diff(speed)
    lines = np.stack([torque[:-1] - slope * speed[:-1], slope, np.zeros_like(slope)], axis=1)
    return Parts(speed[1:-1], lines, float(np.abs(speed).max()))


def marked(rows: Sequence[tuple[float, float]], beyond: float) -> list[tuple[float, float]]:
    """The rows with their last line continued to a share `beyond` their end, where another part of it begins."""
    (speed, torque), (last_speed, last_torque) = rows[-2:]
    slope = (last_torque - torque) / (last_speed - speed)
    ends = (last_speed * (1.0 + beyond), 2.0 * last_speed)
    return [*rows[:-1], *((end, last_torque + slope * (end - last_speed)) for end in ends)]


def mirrored(rows: Sequence[tuple[float, float]], *, sign: float) -> list[tuple[float, float]]:
    """The rows from 0 rad/s up with those of the other sense of rotation, whose torque is `sign` times theirs."""
    return [*((-speed, sign * torque) for speed, torque in reversed(rows[1:])), *rows]


def ends_and_middles(edges: FloatArray) -> FloatArray:
    """(parts, 3) speeds of parts between edges (parts + 1,): both ends and the middle."""
    return np.stack([edges[:-1], (edges[:-1] + edges[1:]) / 2.0, edges[1:]], axis=1)


def quadratics(edges: FloatArray, values: ComplexArray) -> ComplexArray:
    """(parts, 3, functions) coefficients through values (parts, 3, functions) at `ends_and_middles` of the edges."""
    powers = ends_and_middles(edges)[:, :, None] ** np.arange(3)
    return np.asarray(np.linalg.solve(powers.astype(complex), values))


def without_equal_parts(
    edges: FloatArray, polynomial: ComplexArray
) -> tuple[FloatArray, ComplexArray]:
    """The edges (parts + 1,) and polynomials (parts, 3, functions) of parts that differ from the part before.

    A march ends a step at every edge that a speed crosses: an edge where the law does not change costs steps and gains
    nothing.
    """
    kept = [0]
    powers = ends_and_middles(edges)[:, :, None] ** np.arange(3)
    largest = np.abs(powers @ polynomial).max(initial=0.0)
    for part in range(1, len(polynomial)):
        difference = np.abs(powers[[kept[-1], part]] @ (polynomial[part] - polynomial[kept[-1]]))
        if difference.max(initial=0.0) > SAME * largest:
            kept.append(part)
    return edges[[*kept, -1]], polynomial[kept]


class StationLaw(Law):
    """A torque at one station while its window lasts."""

    window: Window

    def __post_init__(self) -> None:
        self.cuts = self.window


class ByParts(StationLaw):
    """A torque by parts over the speed of its station."""

    parts: Parts

    def first(self, points: Points) -> int:
        return self.parts.part(float(points.speed[0, 0]))

    def limits(self, regime: int, points: Points) -> Limits:
        # Margins to both edges of the part, with the part beyond.
        edges, scale, speed = self.parts.edges, self.parts.scale, points.speed[0]
        limits: Limits = []
        if regime < len(edges):
            limits.append(((edges[regime] - speed) / scale, regime + 1))
        if regime > 0:
            limits.append(((speed - edges[regime - 1]) / scale, regime - 1))
        return limits


@dataclass
class BySpeed(ByParts):
    """A torque by the speed of its station: a load, a motor by table."""

    interface: int
    parts: Parts
    window: Window = ALWAYS

    def conditions(self, regime: int, points: Points) -> Conditions:
        acts = self.window.holds(points.time[0])
        torque, slope = self.parts.value(regime, points.speed[0])
        return Conditions(acts * torque - points.torque, by_speed=(acts * slope)[None, None])


@dataclass
class InductionMotor(StationLaw):
    """Kloss: 2 pull_out / (s/slip + slip/s), s = 1 - speed/synchronous."""

    interface: int
    pull_out: float  # N m
    slip: float  # at which it pulls out
    synchronous: float  # rad/s
    window: Window = ALWAYS

    def conditions(self, regime: int, points: Points) -> Conditions:
        acts, s = self.window.holds(points.time[0]), 1.0 - points.speed[0] / self.synchronous
        squares = s * s + self.slip**2
        factor = 2.0 * self.pull_out * self.slip * acts
        slope = -factor * (self.slip**2 - s * s) / squares**2 / self.synchronous
        return Conditions(factor * s / squares - points.torque, by_speed=slope[None, None])


@dataclass
class Wave(ByParts):
    """size(speed) Re exp(i phase + rate (t - begin) + i order (angle - origin)): orders, and pulsations by the slip.

    With several orders it is the sum of as many sizes, complex ones: the cylinders of a throw.
    """

    interface: int
    parts: Parts  # size
    order: float | FloatArray  # per rad of the own shaft; (orders,) of several
    phase: float = 0.0  # rad
    rate: complex = 0.0  # 1/s
    window: Window = ALWAYS
    from_begin: bool = False  # the angle counts from where the station stands when the wave begins
    origin: float = field(default=0.0, init=False)  # rad

    def first(self, points: Points) -> int:
        if self.from_begin and points.time[0] <= self.window.begin:
            self.origin = float(points.angle[0, 0])
        return super().first(points)

    def conditions(self, regime: int, points: Points) -> Conditions:
        acts, since = self.window.holds(points.time[0]), points.time - self.window.begin
        size, slope = self.parts.value(regime, points.speed[0][:, None])
        turned = np.multiply.outer(points.angle[0] - self.origin, np.atleast_1d(self.order))
        growth = (self.rate * since)[:, None]
        wave: ComplexArray = acts * np.exp(1j * (self.phase + turned) + growth)
        return Conditions(
            (size * wave).real.sum(axis=1) - points.torque,
            by_angle=(1j * self.order * size * wave).real.sum(axis=1)[None, None],
            by_speed=(slope * wave).real.sum(axis=1)[None, None],
        )


@dataclass
class ByAngle(StationLaw):
    """A torque over the angle since its begin, a history whose time is that angle: blades that mill ice."""

    interface: int
    history: History
    window: Window = ALWAYS
    origin: float = field(default=0.0, init=False)  # rad

    def first(self, points: Points) -> int:
        if points.time[0] <= self.window.begin:
            self.origin = float(points.angle[0, 0])
        since = float(points.angle[0, 0]) - self.origin
        return max(int(np.searchsorted(self.history.begin, since, side="right")) - 1, 0)

    def conditions(self, regime: int, points: Points) -> Conditions:
        acts = self.window.holds(points.time[0])
        since = points.angle[0] - self.origin - self.history.begin[regime]
        acting = self.history.acting[regime]
        level, gain = acting.later(since)
        torque = level.sum(axis=0).real
        slope = (gain + acting.rate[:, None] * level).sum(axis=0).real
        return Conditions(acts * torque - points.torque, by_angle=(acts * slope)[None, None])

    def limits(self, regime: int, points: Points) -> Limits:
        since, begin = points.angle[0] - self.origin, self.history.begin
        limits = [(begin[regime + 1] - since, regime + 1)] if regime + 1 < len(begin) else []
        return [*limits, (since - begin[regime], regime - 1)] if regime else limits


@dataclass
class DryFriction(Law):
    """A torque against the rotation that does not depend on its speed, and holds while it suffices.

    Stations that turn as one, whatever their ratios, slip and stand together. While they stand, the acceleration of the
    first is 0, and each carries its share, as of the friction.
    """

    interface: int  # of the first station
    torque: tuple[float, ...]  # N m of each
    scale: float  # rad/s of the first
    windows: tuple[Window, ...] = (ALWAYS,)
    ratio: tuple[float, ...] = (1.0,)  # speed of each by that of the first
    inertia: float = 1.0  # kg m2 of the first, that makes a torque of its acceleration
    neighbours: tuple[int, ...] = ()  # interfaces of other laws at these stations

    def __post_init__(self) -> None:
        self.count = len(self.torque)
        self.cuts = tuple(cut for window in self.windows for cut in window)

    def first(self, points: Points) -> int:
        speed = float(points.speed[0, 0])
        if not self._acting(points.time[0]).any():
            return FREE
        if abs(speed) <= STANDING * self.scale:
            return STANDS
        return FORWARD if speed > 0.0 else BACKWARD

    def conditions(self, regime: int, points: Points) -> Conditions:
        ratio, acting = np.array(self.ratio), self._acting(points.time[0])
        forward = (np.sign(ratio) * acting)[:, None]
        if regime != STANDS:
            sense = 0 if regime == FREE else BACKWARD + 1 - regime
            return Conditions(sense * forward - points.torque)
        number = len(ratio)
        share = forward / (np.abs(ratio) @ acting)
        lack = share * (ratio @ points.torque) - points.torque
        by_torque = share[:, None] * ratio[:, None] - np.eye(number)[:, :, None]
        by_speed, by_acceleration = np.zeros((2, number, number, len(points.time)))
        by_torque[0] = 0.0
        by_speed[0, 0], by_acceleration[0, 0] = -RETURN * self.inertia, -self.inertia
        lack[0] = -self.inertia * (points.acceleration[0] + RETURN * points.speed[0])
        return Conditions(lack, by_torque, by_speed=by_speed, by_acceleration=by_acceleration)

    def limits(self, regime: int, points: Points) -> Limits:
        if regime == FREE:
            return []
        if regime != STANDS:
            share = points.speed[0] * (AT_LIMIT / (STANDING * self.scale))
            return [(share if regime == FORWARD else -share, STANDS)]
        ratio = np.array(self.ratio)
        share = (ratio @ points.torque) / (np.abs(ratio) @ self._acting(points.time[0]))
        factor = AT_LIMIT / MORE
        return [((1.0 + share) * factor, FORWARD), ((1.0 - share) * factor, BACKWARD)]

    def still(self, regime: int) -> tuple[int, ...]:
        return self.neighbours if regime == STANDS else ()

    def _acting(self, time: float) -> FloatArray:
        """Friction that acts at each interface, (interfaces,) N m."""
        pairs = zip(self.torque, self.windows, strict=True)
        return np.array([torque * window.holds(time) for torque, window in pairs])
