"""Torsion and bending of two joints and six inertias, section 3 of Liu et al. (2023) made consistent; plain numbers.

Both joints pass their power on: theta3 = f1(theta2), G3 = G2/i1, theta5 = f2(theta4), G5 = G4/i2. Four angles are free,
theta1, theta2, theta4, theta6. The forks of the intermediate shaft are in line, so that the joints cancel. Each outer
shaft lies in a bearing that the couple of its joint pushes; the bearings do not act back on the torsion.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ORDER8 = 1e-9  # relative tolerance of the integration
AT_REST = (0.0,) * 8


@dataclass(frozen=True)
class Boat:
    """Figures of the line; none is published, all are estimates."""

    inertia: tuple[float, ...] = (
        1.2,
        0.02,
        0.02,
        0.02,
        0.02,
        0.8,
    )  # kg m2: motor, four yokes, propeller
    stiffness: tuple[float, ...] = (1.2e5, 6.0e4, 5.0e4)  # N m/rad
    damping: tuple[float, ...] = (0.6, 0.3, 0.25)  # N m s/rad
    angle: float = math.radians(8.0)  # rad of both joints, as in the paper's curves
    torque: float = 800.0  # N m of the motor, as in the paper's curves
    speed: float = 60.0  # rad/s, as in the paper's curves
    mass: float = 20.0  # kg on each bearing
    bearing_stiffness: float = 5.0e6  # N/m, K4
    bearing_damping: float = 1.0e3  # N s/m, C4
    span: float = 0.4  # m between the two bearings of an outer shaft

    def softer(self, factor: float) -> "Boat":
        """Every shaft with `factor` of its stiffness."""
        return replace(self, stiffness=tuple(factor * one for one in self.stiffness))


def free(boat: Boat) -> Boat:
    """Without torques and damping: energy is kept."""
    return replace(boat, damping=(0.0, 0.0, 0.0), torque=0.0)


def front(x: float, angle: float) -> tuple[float, float, float]:
    """f, i, i' of the first joint: tan f = cos(angle) tan x."""
    s, c, q = math.sin(angle), math.cos(angle), math.tan(angle / 2.0) ** 2
    below = 1.0 - (s * math.sin(x)) ** 2
    lag = math.atan2(q * math.sin(2.0 * x), 1.0 + q * math.cos(2.0 * x))
    return x - lag, c / below, c * s * s * math.sin(2.0 * x) / below**2


def rear(x: float, angle: float) -> tuple[float, float, float]:
    """f, i, i' of the second joint, a quarter revolution away: tan f = tan x/cos(angle)."""
    turned, ratio, slope = front(x + math.pi / 2.0, angle)
    return turned - math.pi / 2.0, ratio, slope


@dataclass(frozen=True)
class Turning:
    """All six angles, speeds and accelerations, the torques of shafts and joints."""

    angle: tuple[float, ...]
    speed: tuple[float, ...]
    acceleration: tuple[float, ...]
    shaft: tuple[float, ...]  # N m in the three shafts
    joint: tuple[float, ...]  # N m: G2, G4 on the driving sides


def turning(boat: Boat, state: Array) -> Turning:
    """From theta1, theta2, theta4, theta6 and their speeds; the propeller's torque grows with its speed squared."""
    one, two, four, six, w1, w2, w4, w6 = (float(value) for value in state[:8])
    three, i1, k1 = front(two, boat.angle)
    five, i2, k2 = rear(four, boat.angle)
    w3, w5 = i1 * w2, i2 * w4
    pairs = ((one - two, w1 - w2), (three - four, w3 - w4), (five - six, w5 - w6))
    first, second, third = (
        k * twist + c * rate
        for k, c, (twist, rate) in zip(boat.stiffness, boat.damping, pairs, strict=True)
    )
    J = boat.inertia
    load = boat.torque * w6 * abs(w6) / boat.speed**2
    a1 = (boat.torque - first) / J[0]
    a2 = (first - i1 * second - i1 * k1 * J[2] * w2**2) / (J[1] + i1**2 * J[2])
    a4 = (second - i2 * third - i2 * k2 * J[4] * w4**2) / (J[3] + i2**2 * J[4])
    a6 = (third - load) / J[5]
    return Turning(
        (one, two, three, four, five, six),
        (w1, w2, w3, w4, w5, w6),
        (a1, a2, i1 * a2 + k1 * w2**2, a4, i2 * a4 + k2 * w4**2, a6),
        (first, second, third),
        (first - J[1] * a2, second - J[3] * a4),
    )


def forces(boat: Boat, moving: Turning) -> tuple[float, float, float, float]:
    """N of the shaft on the bearing next to each joint, front (y, z) and rear (y, z): couple of the joint / span.

    y is along the normal of the plane of the shafts, z square to it and to the shaft. The couples are those of a cross
    without friction: on the driving shaft of the first joint -T tan/2 sin 2x about y, T tan/2 (1 + cos 2x) about z; on
    the driven shaft of the second, T at its driving side, x 90 degrees later, T tan/2 sin 2x, T sin/2 (1 - cos 2x).
    """
    T, x = moving.joint[0], 2.0 * moving.angle[1]
    half = math.tan(boat.angle) / 2.0
    about_y, about_z = -T * half * math.sin(x), T * half * (1.0 + math.cos(x))
    G, u = moving.joint[1], 2.0 * (moving.angle[3] + math.pi / 2.0)
    behind_y, behind_z = (
        G * half * math.sin(u),
        G * math.sin(boat.angle) / 2.0 * (1.0 - math.cos(u)),
    )
    return about_z / boat.span, -about_y / boat.span, -behind_z / boat.span, behind_y / boat.span


def rate(_: float, state: Array, boat: Boat) -> list[float]:
    """(16,): four angles, four speeds, four bearing displacements, four bearing speeds."""
    moving = turning(boat, state)
    pushed = forces(boat, moving)
    bent = [
        (pushed[k] - boat.bearing_damping * state[12 + k] - boat.bearing_stiffness * state[8 + k])
        / boat.mass
        for k in range(4)
    ]
    free_ones = [moving.acceleration[k] for k in (0, 1, 3, 5)]
    return [*state[4:8], *free_ones, *state[12:16], *bent]


def untwisted(boat: Boat) -> Array:
    """Start: every shaft without twist, driving shaft at rated speed, bearings at rest: the load comes on at once."""
    three, i1, _ = front(0.0, boat.angle)
    five, i2, _ = rear(three, boat.angle)
    w = boat.speed
    return np.array([0.0, 0.0, three, five, w, w, i1 * w, i2 * i1 * w, *AT_REST])


def motion(
    boat: Boat,
    times: Array,
    *,
    tolerance: float = ORDER8,
    method: str = "DOP853",
    start: Array | None = None,
) -> Array:
    """(16, times) from `start`, else `untwisted`."""
    from scipy.integrate import solve_ivp

    scale = np.array([1.0] * 4 + [boat.speed] * 4 + [1e-4] * 4 + [1e-2] * 4)
    found = solve_ivp(
        rate,
        (0.0, float(times[-1])),
        untwisted(boat) if start is None else start,
        method,
        t_eval=times,
        rtol=tolerance,
        atol=1e-3 * tolerance * scale,
        args=(boat,),
    )
    if not found.success:
        raise ArithmeticError(found.message)
    result: Array = found.y
    return result


def energy(boat: Boat, state: Array) -> float:
    """J of torsion: kinetic and elastic."""
    moving = turning(boat, state)
    kinetic = sum(J * w * w for J, w in zip(boat.inertia, moving.speed, strict=True))
    angle = moving.angle
    twist = (angle[0] - angle[1], angle[2] - angle[3], angle[4] - angle[5])
    return 0.5 * (kinetic + sum(k * x * x for k, x in zip(boat.stiffness, twist, strict=True)))


def frequencies(boat: Boat) -> Array:
    """(3,) Hz of small torsional motion with ratio 1 in both joints, without damping."""
    J = boat.inertia
    root = np.sqrt([J[0], J[1] + J[2], J[3] + J[4], J[5]])
    strain = np.diff(np.eye(4), axis=0) / root * np.sqrt(np.array(boat.stiffness))[:, None]
    return np.sort(np.linalg.svd(strain, compute_uv=False)) / (2.0 * np.pi)
