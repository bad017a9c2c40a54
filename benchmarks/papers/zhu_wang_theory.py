"""What the study of Zhu and Wang needs next to the program: exact couple, motion in time, response, spinning modes."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike, NDArray

from torsion.analyses.lateral.misaligned_shaft import (
    EXACT,
    NEUTRAL,
    SPINNING,
    MisalignedShaft,
    Model,
    coefficients,
    growth,
    small_angle_part,
)
from torsion.kernels.periodic.hill import (
    harmonics_of,
    hill_exponents,
    hill_matrices,
)

FloatArray = NDArray[np.float64]
ComplexArray = NDArray[np.complex128]
HARMONICS = (
    8  # of the coefficients' period: those beyond are below rounding, as the coefficients have one
)


def small_angle(turned: ArrayLike, tilt: float = 0.0) -> FloatArray:
    """(..., 2, 2) the couple's matrix at no tilt: minus eq. 8, E0 sin 2x + E1 cos 2x + E2, in its right sign."""
    return small_angle_part(turned, sine=1.0, cosine=1.0, constant=1.0)


SMALL_ANGLE = Model(small_angle)


def frame(first: ArrayLike, second: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Axes of the driven shaft that turn with it but do not spin, each (..., 3): across, across, along."""
    a, b = np.broadcast_arrays(np.asarray(first, dtype=float), np.asarray(second, dtype=float))
    none = np.zeros_like(a)
    return (
        np.stack((np.cos(b), np.sin(a) * np.sin(b), -np.cos(a) * np.sin(b)), axis=-1),
        np.stack((none, np.cos(a), np.sin(a)), axis=-1),
        np.stack((np.sin(b), -np.sin(a) * np.cos(b), np.cos(a) * np.cos(b)), axis=-1),
    )


def moment(turned: ArrayLike, tilt: float, first: ArrayLike, second: ArrayLike) -> FloatArray:
    """(..., 3) on the driven shaft for a driving torque of 1, about its own axes of `frame`; the last is its torque.

    M = (z - (a.z) a)/(K.z) with the driven direction z, the driving pin a, the driving direction K (Zhu and Wang,
    eq. 3): the cross is without mass and friction, so that M is square to both of its pins.
    """
    x = np.asarray(turned, dtype=float)
    pin = np.stack((np.cos(x), np.sin(x) * np.cos(tilt), -np.sin(x) * np.sin(tilt)), axis=-1)
    axes = frame(first, second)
    lean = [np.sum(pin * axis, axis=-1) for axis in axes]
    along = np.sin(tilt) * axes[2][..., 1] + np.cos(tilt) * axes[2][..., 2]
    parts = np.broadcast_arrays(-lean[2] * lean[0], -lean[2] * lean[1], 1.0 - lean[2] ** 2)
    return np.asarray(np.stack(parts, axis=-1) / along[..., None])


def forcing(turned: ArrayLike, tilt: float) -> FloatArray:
    """(..., 2) couple / torque on the shaft at rest: tan/2 sin 2x and sin/2 (1 - cos 2x)."""
    twice = 2.0 * np.asarray(turned, dtype=float)
    return np.stack(
        (0.5 * np.tan(tilt) * np.sin(twice), 0.5 * np.sin(tilt) * (1.0 - np.cos(twice))), axis=-1
    )


def accelerations(
    angles: FloatArray, rates: FloatArray, moments: FloatArray, spin: ArrayLike, polar: float
) -> FloatArray:
    """(..., 2) second derivatives of the two angles of a rigid shaft turning about a fixed point, exact.

    moments: (..., 2) / transverse inertia, about the first two axes of `frame`; spin: speed about the third, rad/s;
    polar: polar / transverse inertia.
    """
    sine, cosine = np.sin(angles[..., 1]), np.cos(angles[..., 1])
    one, two = rates[..., 0], rates[..., 1]
    turning = polar * np.asarray(spin, dtype=float)
    first = (moments[..., 0] + 2.0 * one * two * sine - turning * two) / cosine
    second = moments[..., 1] - one**2 * sine * cosine + turning * one * cosine
    return np.stack((first, second), axis=-1)


def bearing(
    angles: FloatArray, rates: FloatArray, stiffness: ArrayLike, damping: ArrayLike, length: float
) -> FloatArray:
    """(..., 2) moment, N m, of a bearing `length` m from the joint; its stiffness N/m, damping N s/m along i and j."""
    a, b = angles[..., 0], angles[..., 1]
    across, over, _ = frame(a, b)
    place = length * np.stack((np.sin(b), -np.sin(a) * np.cos(b)), axis=-1)
    one, two = rates[..., 0], rates[..., 1]
    speed = length * np.stack(
        (np.cos(b) * two, -np.cos(a) * np.cos(b) * one + np.sin(a) * np.sin(b) * two), axis=-1
    )
    force = -np.asarray(stiffness) * place - np.asarray(damping) * speed
    return length * np.stack(
        (-np.sum(force * over[..., :2], axis=-1), np.sum(force * across[..., :2], axis=-1)), axis=-1
    )


@dataclass(frozen=True)
class Whirl:
    """Natural frequencies without torque, over speed."""

    speed: FloatArray  # (speeds,) rad/s
    frequency: FloatArray  # (speeds, 2) rad/s, ascending; 0 where the motion does not oscillate
    decay: FloatArray  # (speeds, 2) 1/s


@dataclass(frozen=True)
class Response:
    """Periodic answer to the couple; orders 0, 2, 4, ... of the driving speed."""

    speed: FloatArray  # (speeds,) rad/s
    order: np.ndarray  # (orders,)
    angle: ComplexArray  # (speeds, 2, orders) rad; angle = Re sum over orders of angle exp(i order speed t)
    status: tuple[
        str, ...
    ]  # (speeds,) "ok" or "unstable": there the periodic answer is never reached


def natural_frequencies(shaft: MisalignedShaft, speeds: FloatArray | float = 0.0) -> Whirl:
    """Frequencies of the spinning shaft on its bearing, joint without torque."""
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    state = np.zeros((at.size, 4, 4))
    state[:, :2, 2:] = np.eye(2)
    state[:, 2:, :2] = -np.diag(shaft.square)
    state[:, 2:, 2:] = -np.diag(shaft.decay) - shaft.polar * at[:, None, None] * SPINNING
    roots = np.linalg.eigvals(state)
    rank = np.argsort(np.abs(roots.imag), axis=1)[:, ::2]
    chosen = np.take_along_axis(roots, rank, axis=1)
    return Whirl(at, np.abs(chosen.imag), -chosen.real)


def hill_growth(
    shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT, count: int = HARMONICS
) -> FloatArray:
    """(speeds,) 1/s by the eigenvalues of Hill's matrix: a check of `growth`."""
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    turned = _instants(count)
    rates = []
    for speed in at.tolist():
        exponents, _ = hill_exponents(*_samples(shaft, turned, speed, model), 2.0 * speed, count)
        rates.append(exponents.real.max())
    return np.array(rates)


def response(
    shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT, count: int = HARMONICS
) -> Response:
    """Periodic answer of the linear equations to the couple's forcing by Hill's matrix; unstable speeds are marked."""
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    turned = _instants(count)
    force, pull = harmonics_of(forcing(turned, shaft.tilt).T, count), shaft.pull_at(at)
    angle = np.empty((at.size, 2, count + 1), dtype=complex)
    for k, speed in enumerate(at.tolist()):
        samples = _samples(shaft, turned, speed, model)
        matrix, _, _ = hill_matrices(*samples, 2.0 * speed, count)
        angle[k] = np.linalg.solve(matrix, pull[k] * force.ravel()).reshape(2, -1)[:, count:]
    angle[..., 1:] *= 2.0
    unstable = growth(shaft, at, model).rate > NEUTRAL * at
    status = tuple("unstable" if bad else "ok" for bad in unstable.tolist())
    return Response(at, 2 * np.arange(count + 1), angle, status)


def _instants(count: int) -> FloatArray:
    """Driving angles over half a revolution, enough for the coefficients' harmonics up to twice `count`."""
    return np.pi * np.arange(4 * count + 1) / (4 * count + 1)


def _samples(
    shaft: MisalignedShaft, turned: FloatArray, speed: float, model: Model
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """M, C and K (angles, 2, 2) of the linear equations."""
    damping, stiffness = coefficients(shaft, turned, np.array([speed]), model)
    return np.broadcast_to(np.eye(2), stiffness[0].shape), damping[0], stiffness[0]


def linear_rate(
    time: float, state: FloatArray, shaft: MisalignedShaft, speed: float, model: Model
) -> FloatArray:
    """(4,) derivative of (angles, rates) of the linear equations, driven: for integration in time."""
    turned = np.array([speed * time])
    damping, stiffness = coefficients(shaft, turned, np.array([speed]), model)
    force = shaft.pull_at(np.array([speed])) * forcing(turned[0], shaft.tilt)
    return np.concatenate(
        [state[2:], force - damping[0, 0] @ state[2:] - stiffness[0, 0] @ state[:2]]
    )


def exact_rate(time: float, state: FloatArray, shaft: MisalignedShaft, speed: float) -> FloatArray:
    """(4,) derivative of (angles, rates) of the exact equations at an even driven speed: for integration in time."""
    angles, rates = state[:2], state[2:]
    own = (
        shaft.pull_at(np.array([speed]))
        * moment(speed * time, shaft.tilt, angles[0], angles[1])[:2]
    )
    held = bearing(angles, rates, shaft.stiffness, shaft.damping, shaft.length) / shaft.inertia
    return np.concatenate([rates, accelerations(angles, rates, own + held, speed, shaft.polar)])


def undamped(shaft: MisalignedShaft) -> MisalignedShaft:
    """The same shaft in a bearing without damping."""
    return replace(shaft, damping=(0.0, 0.0))
