"""Equations of motion of a whole train with its joints at one mean speed, in arrays over time.

With every body's angle a function F of one coordinate q: sum over the bodies of F' R = 0, where
R = J (F' q'' + F'' q'^2) + damping + springs - torques. Linearised about any motion: mass J F'^2, and so on.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import product

import numpy as np

from torsion.analyses.stability.mechanism import Layout, error, gathered
from torsion.analyses.stability.straight_modes import at_coordinates
from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.kernels.periodic.harmonic_balance import Linearised, Motion
from torsion.kernels.periodic.hill import Couplings, toeplitz


@dataclass(frozen=True)
class Loading:
    """What acts at one mean speed, on the bodies and at one speed (torque times speed ratio)."""

    speed: float  # rad/s of the reference station
    damping: FloatArray  # (bodies,) N m s/rad to the mean motion
    torque: FloatArray  # (bodies,) N m, known and constant
    multiple: IntArray  # (lines,) order of each vibratory torque / order of the common period
    vibratory: ComplexArray  # (bodies, lines) N m
    drive: FloatArray  # (unknown loads, bodies) N m for a load of 1
    steady: IntArray  # (unknown loads,) the coordinate whose mean each load keeps
    order: float  # of the common period, per turn of the reference station

    @property
    def w0(self) -> float:
        """Frequency of the common period, rad/s."""
        return self.order * self.speed


@dataclass(frozen=True)
class Turning:
    """Deviation of a body's angle from the mean motion, and the derivatives of its angle over its coordinate.

    All at one speed (own angle / speed ratio).
    """

    deviation: FloatArray  # rad
    first: FloatArray
    second: FloatArray
    third: FloatArray


@dataclass(frozen=True)
class State:
    """A motion of all bodies: (bodies, times), all at one speed."""

    turning: Turning
    rate: FloatArray  # rad/s of the coordinate of each body
    gain: FloatArray  # rad/s2 of the coordinate of each body
    slip: FloatArray  # rad/s of each body, deviation from the mean speed
    acceleration: FloatArray  # rad/s2 of each body
    residual: FloatArray  # N m: what each body lacks for equilibrium


def turning(layout: Layout, deviation: FloatArray, turned: FloatArray) -> Turning:
    """Return every body's turning, arrays (bodies, times), from the coordinates' deviations (free or more, times).

    turned: (times,) rad, the mean angle of the reference station.
    """
    start = _of_bodies(layout, deviation)
    parts = np.array([start, np.ones_like(start), np.zeros_like(start), np.zeros_like(start)])
    for step in layout.steps:
        r, s = step.joint.driving_ratio, step.joint.driven_ratio
        before, f1, f2, f3 = parts[:, step.inner]
        e0, e1, e2, e3 = error(step.joint, r * (turned + before))
        g1 = 1.0 + e1 * r / s
        g2 = e2 * r * r / s
        g3 = e3 * r**3 / s
        third = g3 * f1**3 + 3.0 * g2 * f1 * f2 + g1 * f3
        parts[:, step.outer] = before + e0 / s, g1 * f1, g2 * f1**2 + g1 * f2, third
    return Turning(*parts)


def _of_bodies(layout: Layout, values: FloatArray) -> FloatArray:
    """(bodies, times) of the coordinate of each body, from those of the free ones (free or more, times)."""
    full = np.zeros((len(layout.root), values.shape[1]))
    full[: layout.free] = values[: layout.free]
    return full[layout.coordinate]


def mean_angle(loading: Loading, times: int) -> FloatArray:
    """Return (times,) rad of the reference station over the common period."""
    return 2.0 * np.pi / loading.order * np.arange(times) / times


def torques(loading: Loading, turned: FloatArray, load: FloatArray) -> FloatArray:
    """Return (bodies, times) N m that act on the bodies."""
    constant = loading.torque[:, None] + (loading.drive.T @ load)[:, None]
    phase = np.exp(1j * np.outer(loading.multiple, loading.order * turned))
    return np.asarray(constant + (loading.vibratory @ phase).real)


def state(
    layout: Layout, loading: Loading, motion: Motion, load: FloatArray, turned: FloatArray
) -> State:
    """Return the motion of all bodies, and what each lacks for equilibrium.

    Behind its coordinates a motion may hold the twists of the layout's dampers, which else follow from it.
    """
    where = turning(layout, motion.deviation, turned)
    slow = _of_bodies(layout, motion.speed)
    gain = _of_bodies(layout, motion.acceleration)
    rate = loading.speed + slow
    slip = slow * where.first + loading.speed * (where.first - 1.0)
    acceleration = where.first * gain + where.second * rate**2
    residual = (
        layout.inertia[:, None] * acceleration
        + loading.damping[:, None] * slip
        - torques(loading, turned, load)
    )
    force = spring_torques(layout, where.deviation, slip, motion.speed[layout.free :])
    residual += layout.incidence @ force
    return State(where, rate, gain, slip, acceleration, residual)


def spring_torques(
    layout: Layout, deviation: FloatArray, slip: FloatArray, dampers: FloatArray | None = None
) -> FloatArray:
    """Return (springs, times) N m, positive when the driving side pushes: elastic, viscous and hysteretic share.

    The hysteretic share is that of a steady vibration over the whole period: i eta k sign(frequency).
    dampers: (dampers, times) rad/s, rates of their twists where they are known beside the slip.
    """
    a = layout.driving
    b = layout.driven
    twist = deviation[a] - deviation[b]
    force = layout.stiffness[:, None] * twist + layout.viscous[:, None] * (slip[a] - slip[b])
    lossy = np.flatnonzero(layout.hysteretic)
    if lossy.size:
        spectrum = np.fft.rfft(twist[lossy], axis=1)
        spectrum[:, 0] = 0.0
        force[lossy] += layout.hysteretic[lossy, None] * np.fft.irfft(
            1j * spectrum, twist.shape[1], axis=1
        )
    acting = layout.dampers
    if acting.size.size:
        rate = (
            dampers if dampers is not None and len(dampers) else acting.onto.T @ (slip[a] - slip[b])
        )
        force += acting.onto @ (acting.size[:, None] * rate)
    return force


def equations(
    layout: Layout, loading: Loading, motion: Motion, load: FloatArray, count: int
) -> tuple[FloatArray, Callable[[], Linearised]]:
    """Return the residual of the equations at a motion over the common period, and what returns their derivatives.

    Dampers are in them where the motion holds their twists: those are then further unknowns, and the matrix stays
    sparse. Where it does not, the residual holds the dampers and the derivatives leave them out.
    """
    moving = state(layout, loading, motion, load, mean_angle(loading, motion.deviation.shape[1]))
    free = layout.free
    first = moving.turning.first
    # Of the dampers' twists, w0 size (twist - that of the bodies) = 0; their torque is size times the twist's rate.
    twist = motion.deviation[free:]
    number, times = twist.shape
    size = layout.dampers.size[:number, None]
    missing = (
        size * loading.w0 * (twist - (layout.damper_twist @ moving.turning.deviation)[:number])
    )
    residual = np.concatenate([gathered(layout, first * moving.residual), missing])

    def derivatives() -> Linearised:
        force = np.zeros((len(loading.drive), *residual.shape))
        for row, drive in zip(force, loading.drive, strict=True):
            row[:free] = -gathered(layout, first * drive[:, None])
        couplings = entries(layout, loading, moving)
        hysteretic = _hysteretic(layout, first, count)
        if not number:
            return Linearised(residual, couplings, force, hysteretic)
        pull = (size * at_coordinates(layout, first)).reshape(times, -1).T
        alone = free + np.arange(number)
        damper, coordinate = np.repeat(alone, free), np.tile(np.arange(free), number)
        none, nothing = np.zeros_like(pull), np.zeros_like(twist)
        back = [-loading.w0 * pull, size * loading.w0 + nothing]
        grown = Couplings(
            np.concatenate([couplings.row, coordinate, damper, alone]),
            np.concatenate([couplings.column, damper, coordinate, alone]),
            np.concatenate([couplings.mass, none, none, nothing]),
            np.concatenate([couplings.damping, pull, none, nothing]),
            np.concatenate([couplings.stiffness, none, *back]),
            np.append(couplings.hysteretic, np.zeros(2 * len(pull) + number)),
        )
        return Linearised(residual, grown, force, hysteretic)

    return residual, derivatives


def entries(layout: Layout, loading: Loading, moving: State) -> Couplings:
    """Return the mass, damping and stiffness entries: one for each free coordinate, then up to four for each spring."""
    f1 = moving.turning.first
    f2 = moving.turning.second
    f3 = moving.turning.third
    inertia = layout.inertia[:, None]
    ground = loading.damping[:, None]
    slip_slope = f2 * moving.rate  # of a body's speed over its coordinate
    mass = inertia * f1**2
    damping = f1 * (2.0 * inertia * slip_slope + ground * f1)
    stiffness = (
        f1 * (inertia * (f2 * moving.gain + f3 * moving.rate**2) + ground * slip_slope)
        + f2 * moving.residual
    )
    diagonal = np.arange(layout.free)
    coefficients = [gathered(layout, part) for part in (mass, damping, stiffness)]
    parts = [(diagonal, diagonal, *coefficients, np.zeros(layout.free))]
    steady = (f1 == f1[:, :1]).all(axis=1)
    ends = (layout.driving, 1.0), (layout.driven, -1.0)
    for (a, plus), (b, minus) in product(ends, ends):
        row = layout.coordinate[a]
        column = layout.coordinate[b]
        sign = plus * minus
        inside = (row < layout.free) & (column < layout.free)
        c = sign * layout.viscous[:, None]
        k = sign * layout.stiffness[:, None]
        between = (
            np.zeros((len(a), f1.shape[1])),
            c * f1[a] * f1[b],
            f1[a] * (k * f1[b] + c * slip_slope[b]),
            sign * layout.hysteretic * f1[a, 0] * f1[b, 0] * (steady[a] & steady[b]),
        )
        parts.append((row[inside], column[inside], *(part[inside] for part in between)))
    return Couplings(*(np.concatenate(part) for part in zip(*parts, strict=True)))


def _hysteretic(
    layout: Layout, first: FloatArray, count: int
) -> list[tuple[int, int, ComplexArray]]:
    """Blocks of the loss factors where a ratio varies: i eta k sign(frequency) between the angles of a spring's sides."""
    out = []
    wide = np.arange(-2 * count, 2 * count + 1)
    turn = 1j * np.sign(wide)[:, None]
    steady = (first == first[:, :1]).all(axis=1)
    lossy = (layout.hysteretic != 0) & ~(steady[layout.driving] & steady[layout.driven])
    for spring in np.flatnonzero(lossy).tolist():
        bodies = [int(end[spring]) for end in (layout.driving, layout.driven)]
        shapes = [toeplitz(first[body], count, wide) for body in bodies]
        for a, b in product(range(2), repeat=2):
            i, j = (int(layout.coordinate[bodies[side]]) for side in (a, b))
            is_steady = steady[bodies[a]] and steady[bodies[b]]  # among the entries
            if i < layout.free and j < layout.free and not is_steady:
                size = layout.hysteretic[spring] * (1.0 if a == b else -1.0)
                out.append((i, j, size * (shapes[a].conj().T @ (turn * shapes[b]))))
    return out
