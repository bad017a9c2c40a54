"""References for lines of shafts: two-ports in closed form, in mpmath.

The state is the angle and the torque with which the driving side pushes the driven one, at own speed. A cone follows
theta'' + 4 theta'/z + kappa^2 theta = 0, z the distance from its tip, whose solutions are j1(u)/u and y1(u)/u with
u = kappa z (Abramowitz and Stegun 1964, 10.1.11 and 10.1.21).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from mpmath import mp, mpf

from benchmarks.accuracy_scenes import Coupling, Disc, Gear, Line, Shaft, halved

DIGITS = 60  # of the arithmetic; some are lost along the line
PROVEN = 40  # digits of a frequency, by a change of sign
POINTS = 20_000  # at which a line's free end is looked at for changes of sign


class Passed(NamedTuple):
    """What one sweep along a line leaves."""

    angle: Any  # rad at the last station
    torque: Any  # N m, on what would follow the last disc: zero at a natural frequency
    behind: list[Any]  # N m, torque behind every shaft


def passed(
    line: Line, w: Any, angle: Any, torque: Any, m: Any = mp, *, damped: bool = False
) -> Passed:
    """Passes from an angle and a torque applied at the first disc to the last, in the arithmetic of `m`."""
    behind, number = [], mpf if m is mp else float
    for item in line.items:
        match item:
            case Disc():
                torque = torque + w * w * number(item.inertia) * angle
                if damped:
                    torque = torque - 1j * w * number(item.damping) * angle
            case Coupling():
                angle = angle - torque / number(item.stiffness)
            case Gear():
                ratio = number(item.teeth[0]) / number(item.teeth[1])
                torque = (torque + w * w * number(item.inertia[0]) * angle) / ratio
                angle = angle * ratio
                torque = torque + w * w * number(item.inertia[1]) * angle
            case Shaft():
                angle, torque = _through(item, w, angle, torque, m)
                behind.append(torque)
    return Passed(angle, torque, behind)


def _through(shaft: Shaft, w: Any, angle: Any, torque: Any, m: Any) -> tuple[Any, Any]:
    """The state at the driven end of a shaft from that at its driving end."""
    number = mpf if m is mp else float
    modulus, density, length = (
        number(v) for v in (shaft.shear_modulus, shaft.density, shaft.length)
    )
    first, last = (number(v) for v in shaft.diameter)
    kappa = w * m.sqrt(density / modulus)
    if first == last:
        area = m.pi / 32 * (first**4 - number(shaft.bore) ** 4)
        phase, impedance = kappa * length, kappa * modulus * area
        cosine, sine = m.cos(phase), m.sin(phase)
        return (
            cosine * angle - sine / impedance * torque,
            impedance * sine * angle + cosine * torque,
        )
    slope = (last - first) / length  # of the diameter
    rising = 1 if slope > 0 else -1
    sizes = [kappa * d / abs(slope) for d in (first, last)]
    push = [
        -modulus * m.pi / 32 * d**4 * kappa * rising for d in (first, last)
    ]  # torque over d theta/du
    (f, df, g, dg), (f2, df2, g2, dg2) = (_cone(u, m) for u in sizes)
    slope_u = torque / push[0]
    wronskian = f * dg - g * df
    a, b = (angle * dg - slope_u * g) / wronskian, (f * slope_u - df * angle) / wronskian
    return a * f2 + b * g2, push[1] * (a * df2 + b * dg2)


def _cone(u: Any, m: Any) -> tuple[Any, Any, Any, Any]:
    """j1(u)/u and its derivative, y1(u)/u and its derivative."""
    sine, cosine = m.sin(u), m.cos(u)
    j1, y1 = sine / u**2 - cosine / u, -cosine / u**2 - sine / u
    j2 = (3 / u**3 - 1 / u) * sine - 3 / u**2 * cosine
    y2 = -(3 / u**3 - 1 / u) * cosine - 3 / u**2 * sine
    return j1 / u, -j2 / u, y1 / u, -y2 / u


def frequencies(line: Line, count: int) -> list[Any]:
    """The lowest elastic frequencies in Hz, each proven to 40 digits by a change of sign.

    None is missed: the modes of a chain are simple, and the grid is far finer than their distances. Raises
    ArithmeticError where fewer lie below the line's `highest`, or one is not proven.
    """
    grid = np.linspace(line.highest / POINTS, line.highest, POINTS)
    torque = passed(line, grid, 1.0, 0.0, np).torque
    starts = np.flatnonzero(np.sign(torque[1:]) != np.sign(torque[:-1]))[:count]
    if len(starts) < count:
        raise ArithmeticError(f"{len(starts)} modes below {line.highest} rad/s, {count} wanted")
    with mp.workdps(DIGITS):
        return [_frequency(line, float(grid[i]), float(grid[i + 1])) for i in starts]


def _frequency(line: Line, low: float, high: float) -> Any:
    def end(w: Any) -> Any:
        return passed(line, w, mpf(1), mpf(0)).torque

    w = mp.findroot(
        end, (mpf(low), mpf(high)), solver="illinois", tol=mpf(10) ** (-2 * PROVEN), verify=False
    )
    margin = mpf(10) ** -PROVEN
    if end(w * (1 - margin)) * end(w * (1 + margin)) >= 0:
        raise ArithmeticError(f"the frequency near {mp.nstr(w, 6)} rad/s is not proven")
    return w / (2 * mp.pi)


def middle_torques(line: Line, w: Sequence[float]) -> np.ndarray:
    """(frequencies, shafts) N m, complex: torque at the middle of every shaft from 1 N m at the first disc, damped."""
    halves, rows = halved(line), []
    with mp.workdps(DIGITS):
        for value in w:
            free = passed(halves, mpf(value), mpf(1), mpf(0), damped=True)
            driven = passed(halves, mpf(value), mpf(0), mpf(1), damped=True)
            angle = -driven.torque / free.torque
            pairs = zip(driven.behind[::2], free.behind[::2], strict=True)
            rows.append([complex(torque + angle * alone) for torque, alone in pairs])
    return np.array(rows)
