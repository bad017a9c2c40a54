"""A linear train under torques at a few interfaces that are polynomials of each step: exact, whatever its stiffness.

Only the deviation that these torques make is kept here, from nothing at time 0; given torques and the start add to it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.damped_motion import Motion
from torsion.kernels.motion.polynomial_torques import (
    ENDS,
    POINTS,
    SERIES,
    answers,
    integrals,
    value,
)

Known = tuple[
    FloatArray, FloatArray, FloatArray
]  # angle, speed and acceleration, each (interfaces, times)


@dataclass(frozen=True)
class Interfaces:
    """First-order coordinates and rigid motions as torques at the interfaces move them, and as the interfaces move."""

    root: ComplexArray  # (coordinates,) 1/s
    force: ComplexArray  # (coordinates, interfaces)
    angle: ComplexArray  # (interfaces, coordinates): the angle is the real part of angle @ y
    speed: ComplexArray  # (interfaces, coordinates)
    rigid: FloatArray  # (rigid motions, interfaces)

    @cached_property
    def at_once(self) -> FloatArray:
        """(interfaces, interfaces) 1/(kg m2): accelerations that torques make."""
        return np.asarray(np.real(self.speed @ self.force) + self.rigid.T @ self.rigid)

    @property
    def number(self) -> int:
        """Of interfaces."""
        return len(self.angle)


def interfaces(moved: Motion, shape: FloatArray) -> Interfaces:
    """Interfaces of a train whose last loads are the torques at them; shape: (interfaces, rigid motions + modes)."""
    number, coordinates = len(shape), moved.coordinates
    loose = 0 if moved.rigid is None else len(moved.rigid.force)
    place, speed = moved.reading
    rigid = np.zeros((0, number)) if moved.rigid is None else moved.rigid.force[:, -number:]
    kept = shape[:, loose:]
    return Interfaces(
        coordinates.root, coordinates.force[:, -number:], kept @ place, kept @ speed, rigid
    )


@dataclass(frozen=True)
class Place:
    """Rigid motions and coordinates at one time."""

    turned: FloatArray  # (rigid motions,)
    turning: FloatArray
    y: ComplexArray  # (coordinates,)

    @classmethod
    def still(cls, train: Interfaces) -> "Place":
        """Nothing moves."""
        none = np.zeros(len(train.rigid))
        return cls(none, none, np.zeros(len(train.root), dtype=complex))


@dataclass(frozen=True)
class Influence:
    """What torques at the nodes of a step of one length do, and how its start goes on."""

    length: float  # s
    decay: ComplexArray  # (coordinates, ends)
    answer: ComplexArray  # (coordinates, ends, nodes) s, of a force of 1 at one node
    once: FloatArray  # (ends, nodes) s, first integral
    twice: FloatArray  # (ends, nodes) s2
    moved: Known  # (interfaces, ends, interfaces, nodes) rad/(N m) and so on

    def after(self, train: Interfaces, start: Place, torque: FloatArray) -> Place:
        """At the end of the step, from torques (interfaces, nodes)."""
        acting = train.rigid @ torque
        turned = start.turned + self.length * start.turning + acting @ self.twice[-1]
        y = self.decay[:, -1] * start.y + ((train.force @ torque) * self.answer[:, -1]).sum(axis=1)
        return Place(turned, start.turning + acting @ self.once[-1], y)


def influence(train: Interfaces, length: float) -> Influence:
    """Of a step of that length."""
    root, rigid = train.root, train.rigid
    z = np.asarray(np.multiply.outer(root, length * ENDS), dtype=complex)
    every = np.repeat(SERIES, len(ENDS), axis=1)[
        :, None
    ]  # of a torque of 1 at each node, to every end
    ones = np.ones((len(root), 1))
    answer = np.tile(length * ENDS, POINTS) * answers(
        np.tile(z, POINTS), np.tile(ENDS, POINTS), ones, every
    )
    answer = answer.reshape(len(root), POINTS, len(ENDS)).transpose(0, 2, 1)
    once, twice = (
        np.array(rows)
        for rows in zip(*(integrals(one[:, None], ENDS) for one in SERIES.T), strict=True)
    )
    once, twice = length * once.T, length**2 * twice.T
    at_once = np.concatenate([np.eye(POINTS), value(SERIES[:, :, None], ENDS[-1:]).T])
    growth = root[:, None, None] * answer + at_once
    rates = [
        np.real(np.einsum("en,ncl,nf->ecfl", read, own, train.force, optimize=True))
        for read, own in ((train.angle, answer), (train.speed, answer), (train.speed, growth))
    ]
    turns = [
        np.einsum("me,cl,mf->ecfl", rigid, own, rigid, optimize=True)
        for own in (twice, once, at_once)
    ]
    angle, speed, acceleration = (rate + turn for rate, turn in zip(rates, turns, strict=True))
    return Influence(length, np.exp(z), answer, once, twice, (angle, speed, acceleration))


def going_on(train: Interfaces, start: Place, own: Influence) -> Known:
    """Angle, speed and acceleration (interfaces, ends) without torques in the step; speeds and so on in that order."""
    y = own.decay * start.y[:, None]
    turning = np.broadcast_to(start.turning[:, None], (len(start.turning), len(ENDS)))
    turned = start.turned[:, None] + own.length * start.turning[:, None] * ENDS
    angle, speed = (
        train.rigid.T @ turned + np.real(train.angle @ y),
        train.rigid.T @ turning + np.real(train.speed @ y),
    )
    return angle, speed, np.real(train.speed @ (train.root[:, None] * y))


@dataclass(frozen=True)
class Steps:
    """The whole motion: to be read at any time."""

    train: Interfaces
    begin: FloatArray  # (steps,) s
    length: FloatArray  # (steps,) s
    turned: FloatArray  # (steps, rigid motions) at the begin
    turning: FloatArray
    y: ComplexArray  # (steps, coordinates)
    series: FloatArray  # (steps, coefficients, interfaces) N m

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray, ComplexArray]:
        """Rigid motions and their speeds (rigid motions, times), coordinates (coordinates, times), at times (s)."""
        step, since, share, series = self._within(time)
        z = self.train.root[:, None] * since
        y = self.y[step].T * np.exp(z) + since * answers(z, share, self.train.force, series)
        once, twice = integrals(np.einsum("mr,krt->kmt", self.train.rigid, series), share)
        length, turning = self.length[step], self.turning[step].T
        return self.turned[step].T + turning * since + twice * length**2, turning + once * length, y

    def torque(self, time: FloatArray) -> FloatArray:
        """(interfaces, times) N m."""
        _, _, share, series = self._within(time)
        return value(series, share)

    def torque_rate(self, time: FloatArray) -> FloatArray:
        """(interfaces, times) N m/s."""
        step, _, share, series = self._within(time)
        return np.asarray(value(legendre.legder(series), share) * (2.0 / self.length[step]))

    def _within(self, time: FloatArray) -> tuple[np.ndarray, FloatArray, FloatArray, FloatArray]:
        """Step, time since its begin, share of it, and series (coefficients, interfaces, times) of its torques."""
        step = np.clip(np.searchsorted(self.begin, time, side="right") - 1, 0, None)
        since = time - self.begin[step]
        return step, since, since / self.length[step], np.moveaxis(self.series[step], 0, 2)


def steps(train: Interfaces, rows: list[tuple[float, float, Place, FloatArray]]) -> Steps:
    """From begin, length, start and torques at the nodes (interfaces, nodes) of every step."""
    begin, length, start, torque = zip(*rows, strict=True)
    series = np.array([SERIES @ one.T for one in torque])
    turned, turning = (
        np.array([getattr(one, name) for one in start]) for name in ("turned", "turning")
    )
    y = np.array([one.y for one in start])
    return Steps(train, np.array(begin), np.array(length), turned, turning, y, series)


@dataclass
class StepsTaken:
    """A linear train beside a given motion, moved step by step: a LinearTrain."""

    train: Interfaces
    given: Callable[[FloatArray], Known]
    rows: list[tuple[float, float, Place, FloatArray]] = field(default_factory=list)
    influences: dict[float, Influence] = field(default_factory=dict)
    start: Place = field(init=False)
    parts: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        self.start, self.parts = Place.still(self.train), np.zeros((self.number, 1))

    @property
    def number(self) -> int:
        return self.train.number

    @property
    def at_once(self) -> FloatArray:
        return self.train.at_once

    @property
    def whole(self) -> Steps:
        """All steps."""
        return steps(self.train, self.rows)

    def influence(self, length: float) -> Known:
        return self._of(length).moved

    def _of(self, length: float) -> Influence:
        """Kept by length."""
        if length not in self.influences:
            if len(self.influences) > 64:
                self.influences.clear()
            self.influences[length] = influence(self.train, length)
        return self.influences[length]

    def going_on(self, time: float, length: float) -> Known:
        own, given = (
            going_on(self.train, self.start, self._of(length)),
            self.given(time + length * ENDS),
        )
        self.parts = np.abs(given[1]).max(axis=1, keepdims=True)
        angle, speed, acceleration = (one + two for one, two in zip(own, given, strict=True))
        return angle, speed, acceleration

    def now(self, time: float) -> Known:
        place = self.start
        return self._beside(
            np.array([time]), place.turned[:, None], place.turning[:, None], place.y[:, None]
        )

    def inside(self, time: float, length: float, torque: FloatArray, share: FloatArray) -> Known:
        at = time + share * length
        return self._beside(at, *steps(self.train, [(time, length, self.start, torque)]).at(at))

    def _beside(
        self, time: FloatArray, turned: FloatArray, turning: FloatArray, y: ComplexArray
    ) -> Known:
        """With the given motion, of which alone the acceleration is."""
        train, (angle, speed, acceleration) = self.train, self.given(time)
        angle = angle + train.rigid.T @ turned + np.real(train.angle @ y)
        return angle, speed + train.rigid.T @ turning + np.real(train.speed @ y), acceleration

    def advance(self, time: float, length: float, end: float, torque: FloatArray) -> float:
        self.rows.append((time, length, self.start, torque))
        self.start = self._of(length).after(self.train, self.start, torque)
        return end
