"""A linear train under torques at a few interfaces that are polynomials of each step: exact, whatever its stiffness.

Only the deviation that these torques make is kept here, from nothing at time 0; given torques and the start add to it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.polynomial import legendre

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.collocation import Turning
from torsion.kernels.motion.damped_motion import Motion
from torsion.kernels.motion.polynomial_torques import (
    ENDS,
    POINTS,
    SERIES,
    answers,
    integrals,
    value,
)

MOST_KEPT = 64  # influences


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


def interfaces(motion: Motion, shape: FloatArray) -> Interfaces:
    """Interfaces of a train whose last loads are the torques at them; shape: (interfaces, rigid motions + modes)."""
    number, coordinates = len(shape), motion.coordinates
    position, speed = motion.reading
    rigid = np.zeros((0, number)) if motion.rigid is None else motion.rigid.force[:, -number:]
    kept = shape[:, len(rigid) :]
    force = coordinates.force[:, -number:]
    return Interfaces(coordinates.root, force, kept @ position, kept @ speed, rigid)


@dataclass(frozen=True)
class Place:
    """Rigid motions and coordinates at one time."""

    turned: FloatArray  # (rigid motions,)
    turning: FloatArray
    y: ComplexArray  # (coordinates,)


@dataclass(frozen=True)
class Influence:
    """What torques at the nodes of a step of one length do, and how its start goes on."""

    decay: ComplexArray  # (coordinates, ends)
    answer: ComplexArray  # (coordinates, ends, nodes) s, of a force of 1 at one node
    once: FloatArray  # (ends, nodes) s, first integral
    twice: FloatArray  # (ends, nodes) s2
    turning: Turning  # each (interfaces, ends, interfaces, nodes), rad/(N m) and so on


def influence(train: Interfaces, length: float) -> Influence:
    """Return the influence of torques on a step of a length (s)."""
    root, rigid = train.root, train.rigid
    z = np.asarray(np.multiply.outer(root, length * ENDS), dtype=complex)
    series = np.repeat(SERIES, len(ENDS), axis=1)[
        :, None
    ]  # a torque of 1 at each node, to all ends
    shares, unit = np.tile(ENDS, POINTS), np.ones((len(root), 1))
    answer = length * shares * answers(np.tile(z, POINTS), shares, unit, series)
    answer = answer.reshape(len(root), POINTS, len(ENDS)).transpose(0, 2, 1)
    pairs = zip(*(integrals(column[:, None], ENDS) for column in SERIES.T), strict=True)
    once, twice = (np.array(rows).T for rows in pairs)
    once, twice = length * once, length**2 * twice
    at_once = np.concatenate([np.eye(POINTS), value(SERIES[:, :, None], ENDS[-1:]).T])
    growth = root[:, None, None] * answer + at_once
    rows = (
        (train.angle, answer, twice),
        (train.speed, answer, once),
        (train.speed, growth, at_once),
    )
    angle, speed, acceleration = (
        np.real(np.einsum("en,ncl,nf->ecfl", read, elastic, train.force, optimize=True))
        + np.einsum("me,cl,mf->ecfl", rigid, turned, rigid, optimize=True)
        for read, elastic, turned in rows
    )
    return Influence(np.exp(z), answer, once, twice, (angle, speed, acceleration))


@dataclass(frozen=True)
class Steps:
    """All steps of a motion: to be read at any time."""

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
        """Torques at the interfaces, (interfaces, times) N m."""
        _, _, share, series = self._within(time)
        return value(series, share)

    def torque_rate(self, time: FloatArray) -> FloatArray:
        """Rates of the torques at the interfaces, (interfaces, times) N m/s."""
        step, _, share, series = self._within(time)
        return np.asarray(value(legendre.legder(series), share) * (2.0 / self.length[step]))

    def _within(self, time: FloatArray) -> tuple[np.ndarray, FloatArray, FloatArray, FloatArray]:
        """Step, time since its begin, share of it, and series (coefficients, interfaces, times) of its torques."""
        step = np.clip(np.searchsorted(self.begin, time, side="right") - 1, 0, None)
        since = time - self.begin[step]
        return step, since, since / self.length[step], np.moveaxis(self.series[step], 0, 2)


@dataclass
class StepsTaken:
    """A linear train beside a given motion, moved step by step: a LinearTrain of `collocation`.

    given: angle, speed, acceleration of the interfaces at times.
    """

    train: Interfaces
    given: Callable[[FloatArray], Turning]
    # begin, length, start and torques at the nodes (interfaces, nodes) of every step
    rows: list[tuple[float, float, Place, FloatArray]] = field(default_factory=list)
    influences: dict[float, Influence] = field(default_factory=dict)
    start: Place = field(init=False)
    parts: FloatArray = field(init=False)

    def __post_init__(self) -> None:
        still = np.zeros(len(self.train.rigid))
        self.start = Place(still, still, np.zeros(len(self.train.root), dtype=complex))
        self.parts = np.zeros((self.number, 1))

    @property
    def number(self) -> int:
        return len(self.train.angle)

    @property
    def at_once(self) -> FloatArray:
        return self.train.at_once

    def steps(self, rows: list[tuple[float, float, Place, FloatArray]] | None = None) -> Steps:
        """All steps, or those of some rows."""
        begin, length, position, torque = zip(*(rows or self.rows), strict=True)
        turned, turning = (
            np.array([getattr(start, name) for start in position]) for name in ("turned", "turning")
        )
        y = np.array([start.y for start in position])
        series = np.array([SERIES @ nodes.T for nodes in torque])
        return Steps(self.train, np.array(begin), np.array(length), turned, turning, y, series)

    def influence(self, length: float) -> Turning:
        return self._influence(length).turning

    def _influence(self, length: float) -> Influence:
        """Return the influence on steps of a length, kept for the next."""
        if length not in self.influences:
            if len(self.influences) > MOST_KEPT:
                self.influences.clear()
            self.influences[length] = influence(self.train, length)
        return self.influences[length]

    def going_on(self, time: float, length: float) -> Turning:
        train, start = self.train, self.start
        given = self.given(time + length * ENDS)
        self.parts = np.abs(given[1]).max(axis=1, keepdims=True)
        y = self._influence(length).decay * start.y[:, None]
        turning = start.turning[:, None]
        turned = start.turned[:, None] + length * turning * ENDS
        moved = (
            train.rigid.T @ turned + np.real(train.angle @ y),
            train.rigid.T @ turning + np.real(train.speed @ y),
            np.real(train.speed @ (train.root[:, None] * y)),
        )
        return moved[0] + given[0], moved[1] + given[1], moved[2] + given[2]

    def at_begin(self, time: float) -> Turning:
        turned, turning, y = self.start.turned, self.start.turning, self.start.y
        return self._with_given(np.array([time]), turned[:, None], turning[:, None], y[:, None])

    def inside(self, time: float, length: float, torque: FloatArray, share: FloatArray) -> Turning:
        times = time + share * length
        return self._with_given(times, *self.steps([(time, length, self.start, torque)]).at(times))

    def _with_given(
        self, time: FloatArray, turned: FloatArray, turning: FloatArray, y: ComplexArray
    ) -> Turning:
        """Together with the given motion, whose acceleration is the only one known."""
        train, (angle, speed, acceleration) = self.train, self.given(time)
        angle = angle + train.rigid.T @ turned + np.real(train.angle @ y)
        return angle, speed + train.rigid.T @ turning + np.real(train.speed @ y), acceleration

    def advance(self, time: float, length: float, end: float, torque: FloatArray) -> float:
        start, effect = self.start, self._influence(length)
        self.rows.append((time, length, start, torque))
        acting = self.train.rigid @ torque
        turned = start.turned + length * start.turning + acting @ effect.twice[-1]
        driven = ((self.train.force @ torque) * effect.answer[:, -1]).sum(axis=1)
        y = effect.decay[:, -1] * start.y + driven
        self.start = Place(turned, start.turning + acting @ effect.once[-1], y)
        return end


@dataclass(frozen=True)
class DrivenMotion(Motion):
    """The motion of a train under given torques and under such as follow it, which are the last loads."""

    steps: Steps

    @property
    def cuts(self) -> FloatArray:
        """(cuts,) s, where the torques have kinks."""
        return np.union1d(super().cuts, self.steps.begin)

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and speeds (rigid motions + modes, times) at times >= 0 (s) that ascend."""
        position, speed = super().at(time)
        turned, turning, y = self.steps.at(time)
        elastic, vibrating = self.modal(y)
        return (
            position + np.concatenate([turned, elastic]),
            speed + np.concatenate([turning, vibrating]),
        )

    def loads_at(self, time: FloatArray) -> FloatArray:
        """Torques of the loads, with those that follow the motion: (loads, times) N m."""
        return self._with_steps(super().loads_at(time), self.steps.torque(time))

    def load_rates_at(self, time: FloatArray) -> FloatArray:
        """Rates of these torques, (loads, times) N m/s."""
        return self._with_steps(super().load_rates_at(time), self.steps.torque_rate(time))

    def _with_steps(self, given: FloatArray, following: FloatArray) -> FloatArray:
        given[len(given) - len(following) :] = following
        return given
