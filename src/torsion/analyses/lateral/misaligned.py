"""Rigid shaft of two angles on an elastic bearing, driven by a universal joint: frequencies, growth, response.

The joint's secondary couple shakes the shaft at twice its speed and, as it follows the shaft's own angles, makes its
stiffness vary: the shaft can become unstable. The driving shaft turns evenly and carries a constant torque, which may
be another one at every speed.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels import misaligned_joint as kernel
from torsion.kernels.periodic.harmonic_balance import harmonics_of
from torsion.kernels.periodic.hill import Couplings, couplings_of, hill_blocks, hill_exponents, scattered
from torsion.kernels.periodic.monodromy import ANGLE_PER_STEP, FEWEST_STEPS, radau, step_matrices

HARMONICS = 8  # of the coefficients' period: those beyond are below rounding, as the coefficients have one
NEUTRAL = 1e-10  # growth / speed that counts as none: rounding of a monodromy matrix moves it by 1e-12
MOST_STEPS_AT_A_TIME = 2000
SPINNING = np.array([[0.0, 1.0], [-1.0, 0.0]])


@dataclass(frozen=True)
class MisalignedShaft:
    """A rigid shaft from the joint's centre to its bearing; axes i, j of `kernels.misaligned_joint`."""

    inertia: float  # kg m2 transverse, about the joint's centre
    polar: float  # polar / transverse inertia
    length: float  # m from joint to bearing
    stiffness: tuple[float, float]  # N/m of the bearing along i and j
    damping: tuple[float, float]  # N s/m along i and j
    torque: float  # N m of the driving shaft
    tilt: float  # rad between the shafts
    load: Callable[[FloatArray], FloatArray] = np.ones_like  # of speeds, rad/s: the torque there / `torque`

    @property
    def square(self) -> FloatArray:
        """(2,) rad2/s2 of the two angles at rest, without torque: the angle about i moves the end along j."""
        return self.length**2 * np.array(self.stiffness[::-1]) / self.inertia

    @property
    def decay(self) -> FloatArray:
        """(2,) 1/s, twice the decay rate of each angle."""
        return self.length**2 * np.array(self.damping[::-1]) / self.inertia

    @property
    def pull(self) -> float:
        """Torque / inertia, rad/s2."""
        return self.torque / self.inertia

    def pull_at(self, speeds: FloatArray) -> FloatArray:
        """(speeds,) rad/s2, the same at speeds in rad/s."""
        return self.pull * self.load(np.asarray(speeds, dtype=float))


@dataclass(frozen=True)
class Model:
    """What of the couple is kept: its matrix, and whether the driven shaft turns as unevenly as its joint makes it."""

    couple: kernel.Couple = field(default=kernel.linearised)
    is_even: bool = True


EXACT = Model()
SMALL_ANGLE = Model(kernel.small_angle)


@dataclass(frozen=True)
class Whirl:
    """Natural frequencies without torque, over speed."""

    speed: FloatArray  # (speeds,) rad/s
    frequency: FloatArray  # (speeds, 2) rad/s, ascending; 0 where the motion does not oscillate
    decay: FloatArray  # (speeds, 2) 1/s


@dataclass(frozen=True)
class Growth:
    """Fastest growth of a small motion, over speed."""

    speed: FloatArray  # (speeds,) rad/s
    rate: FloatArray  # (speeds,) 1/s, negative where every motion dies out
    frequency: FloatArray  # (speeds,) rad/s of the motion that grows fastest, 0 .. speed (up to multiples of 2 speed)

    @property
    def is_unstable(self) -> np.ndarray:
        """(speeds,) by more than rounding."""
        return self.rate > NEUTRAL * self.speed


@dataclass(frozen=True)
class Response:
    """Periodic answer to the couple; orders 0, 2, 4, ... of the driving speed."""

    speed: FloatArray  # (speeds,) rad/s
    order: np.ndarray  # (orders,)
    angle: ComplexArray  # (speeds, 2, orders) rad; angle = Re sum over orders of angle exp(i order speed t)
    status: tuple[str, ...]  # (speeds,) "ok" or "unstable": there the periodic answer is never reached


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


def coefficients(
    shaft: MisalignedShaft, turned: FloatArray, speeds: FloatArray, model: Model = EXACT
) -> tuple[FloatArray, FloatArray]:
    """Damping and stiffness, each (speeds, angles, 2, 2), of y'' + C y' + K y = pull * forcing at driving angles."""
    pull = shaft.pull_at(speeds)[:, None, None, None]
    stiffness = np.diag(shaft.square) + pull * model.couple(turned, shaft.tilt)
    ratio = np.ones_like(turned) if model.is_even else _ratio(turned, shaft.tilt)
    spin = np.asarray(speeds)[:, None, None, None] * ratio[:, None, None]
    damping = np.diag(shaft.decay) + shaft.polar * spin * SPINNING
    return damping, stiffness


def _ratio(turned: FloatArray, tilt: float) -> FloatArray:
    """Driven / driving speed in convention N."""
    return np.asarray(np.cos(tilt) / (1.0 - (np.sin(tilt) * np.sin(turned)) ** 2))


def monodromies(shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT) -> FloatArray:
    """(speeds, 4, 4): what half a turn of the driving shaft, the period of the couple, makes of angles and rates."""
    at, rule = np.atleast_1d(np.asarray(speeds, dtype=float)), radau()
    highest = float(np.sqrt(shaft.square.max() + np.abs(shaft.pull_at(at)).max()))
    steps = max(FEWEST_STEPS, int(np.ceil(2.0 * np.pi * highest / (ANGLE_PER_STEP * at.min()))))
    turned = (np.pi * (np.arange(steps)[:, None] + rule.node) / steps).ravel()
    parts = np.array_split(at, -(-at.size * steps // MOST_STEPS_AT_A_TIME))
    return np.concatenate([_half_turns(shaft, turned, part, model) for part in parts if part.size])


def _half_turns(shaft: MisalignedShaft, turned: FloatArray, at: FloatArray, model: Model) -> FloatArray:
    """(speeds, 4, 4) from steps whose nodes stand at driving angles `turned`; the angle is taken for time."""
    rule = radau()
    steps = turned.size // rule.node.size
    shape = (at.size, steps, rule.node.size, 2, 2)
    damping, stiffness = coefficients(shaft, turned, at, model)
    each = at[:, None, None, None]
    parts = (damping / each).reshape(shape), (stiffness / each**2).reshape(shape)
    every = step_matrices(np.broadcast_to(np.eye(2), shape), *parts, np.pi / steps, rule)
    whole = every[:, 0]
    for k in range(1, steps):
        whole = every[:, k] @ whole
    rate = np.concatenate([np.ones((at.size, 2)), np.repeat(at[:, None], 2, axis=1)], axis=1)
    return np.asarray(rate[:, :, None] * whole / rate[:, None, :])


def growth(shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT) -> Growth:
    """Growth over positive speeds (rad/s) by the eigenvalues of the monodromy matrix."""
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    multiplier = np.linalg.eigvals(monodromies(shaft, at, model))
    rank = np.abs(multiplier).argmax(axis=1)[:, None]
    leading = np.take_along_axis(multiplier, rank, axis=1)[:, 0]
    return Growth(at, np.log(np.abs(leading)) * at / np.pi, np.abs(np.angle(leading)) * at / np.pi)


def hill_growth(shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT, count: int = HARMONICS) -> FloatArray:
    """(speeds,) 1/s by the eigenvalues of Hill's matrix: a check of `growth`."""
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    turned = _instants(count)
    rates = []
    for speed in at.tolist():
        exponents = hill_exponents(_entries(shaft, turned, speed, model), 2.0 * speed, count, 2)
        rates.append(exponents.exponent.real.max())
    return np.array(rates)


def response(shaft: MisalignedShaft, speeds: FloatArray, model: Model = EXACT, count: int = HARMONICS) -> Response:
    """Periodic answer of the linear equations to the couple's forcing by Hill's matrix; unstable speeds are marked."""
    at = np.atleast_1d(np.asarray(speeds, dtype=float))
    turned = _instants(count)
    force, pull = harmonics_of(kernel.forcing(turned, shaft.tilt).T, count), shaft.pull_at(at)
    angle = np.empty((at.size, 2, count + 1), dtype=complex)
    for k, speed in enumerate(at.tolist()):
        entries = _entries(shaft, turned, speed, model)
        matrix = scattered(entries.row, entries.column, hill_blocks(entries, 2.0 * speed, count), 2).toarray()
        angle[k] = np.linalg.solve(matrix, pull[k] * force.ravel()).reshape(2, -1)[:, count:]
    angle[..., 1:] *= 2.0
    unstable = growth(shaft, at, model).is_unstable
    status = tuple("unstable" if bad else "ok" for bad in unstable.tolist())
    return Response(at, 2 * np.arange(count + 1), angle, status)


def _instants(count: int) -> FloatArray:
    """Driving angles over half a turn, enough for the coefficients' harmonics up to twice `count`."""
    return np.pi * np.arange(4 * count + 1) / (4 * count + 1)


def _entries(shaft: MisalignedShaft, turned: FloatArray, speed: float, model: Model) -> Couplings:
    damping, stiffness = coefficients(shaft, turned, np.array([speed]), model)
    return couplings_of(np.broadcast_to(np.eye(2), stiffness[0].shape), damping[0], stiffness[0])


def linear_rate(time: float, state: FloatArray, shaft: MisalignedShaft, speed: float, model: Model) -> FloatArray:
    """(4,) derivative of (angles, rates) of the linear equations, driven: for integration in time."""
    turned = np.array([speed * time])
    damping, stiffness = coefficients(shaft, turned, np.array([speed]), model)
    force = shaft.pull_at(np.array([speed])) * kernel.forcing(turned[0], shaft.tilt)
    return np.concatenate([state[2:], force - damping[0, 0] @ state[2:] - stiffness[0, 0] @ state[:2]])


def exact_rate(time: float, state: FloatArray, shaft: MisalignedShaft, speed: float) -> FloatArray:
    """(4,) derivative of (angles, rates) of the exact equations at an even driven speed: for integration in time."""
    angles, rates = state[:2], state[2:]
    own = shaft.pull_at(np.array([speed])) * kernel.moment(speed * time, shaft.tilt, angles[0], angles[1])[:2]
    held = kernel.bearing(angles, rates, shaft.stiffness, shaft.damping, shaft.length) / shaft.inertia
    return np.concatenate([rates, kernel.accelerations(angles, rates, own + held, speed, shaft.polar)])


def undamped(shaft: MisalignedShaft) -> MisalignedShaft:
    """The same shaft in a bearing without damping."""
    return replace(shaft, damping=(0.0, 0.0))
