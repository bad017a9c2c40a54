"""Modes with their damping as first-order coordinates: each by itself, or all together where damping couples them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.modal_motion import (
    FirstOrder,
    RigidMotion,
    first_order,
    rigid_motion,
)
from torsion.kernels.motion.torque_history import Piece, history, value

ROUNDS = 2  # of inverse iteration: it converges with the square of the error
LARGEST_SETTLED = 150  # coordinates up to which every root is settled, which costs their number to the fourth power
NEARLY_CRITICAL = 0.999  # damping ratio up to which a mode is taken by itself


@dataclass(frozen=True)
class ModalTrain:
    """Rigid motions and elastic modes of generalised inertia 1, and what damps them."""

    w: FloatArray  # (modes,) rad/s
    ratio: FloatArray  # (modes,) damping ratio of what damps every mode by itself
    viscous: FloatArray  # (rigid motions + modes, the same) 1/s, of speeds: what may couple them

    @property
    def rigid(self) -> int:
        """How many rigid motions stand before the modes."""
        return len(self.viscous) - len(self.w)

    @property
    def w_of_all(self) -> FloatArray:
        """Natural frequencies, 0 for rigid motions: (rigid motions + modes,) rad/s."""
        return np.concatenate([np.zeros(self.rigid), self.w])

    @property
    def damping(self) -> FloatArray:
        """(rigid motions + modes, the same) 1/s, all of it."""
        ratio = np.concatenate([np.zeros(self.rigid), self.ratio])
        return self.viscous + np.diag(2.0 * ratio * self.w_of_all)


@dataclass(frozen=True)
class Motion:
    """Rigid motions and modes over time: to be read at any times."""

    train: ModalTrain
    force: FloatArray  # (rigid motions + modes, loads)
    loads: Sequence[Sequence[Piece]]
    rigid: RigidMotion | None  # of the first of them, up to one that damping takes hold of
    coordinates: FirstOrder
    # rows of position and of speed; None: modes by themselves
    read: tuple[np.ndarray, np.ndarray] | None

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Positions and speeds (rigid motions + modes, times) at times >= 0 (s) that ascend."""
        position, speed = self.modal(self.coordinates.at(time))
        if self.rigid is None:
            return position, speed
        turned, turning = self.rigid.at(time)
        return np.concatenate([turned, position]), np.concatenate([turning, speed])

    def modal(self, y: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Positions and speeds (modes, or all that damping takes hold of, times) of coordinates (coordinates, times)."""
        if self.read is not None:
            parts = np.concatenate([y.real, -y.imag])
            position, speed = (np.concatenate([row.real, row.imag], axis=1) for row in self.read)
            return position @ parts, speed @ parts
        root = self.coordinates.root
        position = y.imag / root.imag[:, None]
        return position, y.real + root.real[:, None] * position

    @property
    def reading(self) -> tuple[ComplexArray, ComplexArray]:
        """Rows (modes or all, coordinates) of which the real parts times the coordinates are positions and speeds."""
        if self.read is not None:
            return self.read
        root = self.coordinates.root
        position: ComplexArray = np.diag(-1j / root.imag)
        return position, np.eye(len(root), dtype=complex) + root.real * position

    @property
    def cuts(self) -> FloatArray:
        """(cuts,) s, where the torques have kinks."""
        return self.coordinates.history.begin

    def loads_at(self, time: FloatArray) -> FloatArray:
        """Torques of the loads at times, (loads, times) N m."""
        return np.array([value(pieces, time) for pieces in self.loads]).reshape(-1, len(time))

    def load_rates_at(self, time: FloatArray) -> FloatArray:
        """Rates of the torques of the loads, (loads, times) N m/s."""
        rates = [[piece.rate_of_change() for piece in pieces] for pieces in self.loads]
        return np.array([value(pieces, time) for pieces in rates]).reshape(-1, len(time))

    def acceleration(self, time: FloatArray, position: FloatArray, speed: FloatArray) -> FloatArray:
        """(rigid motions + modes, times) by the balance of torques, of what `at` returned."""
        held = self.train.w_of_all[:, None] ** 2 * position
        return np.asarray(self.force @ self.loads_at(time) - self.train.damping @ speed - held)


def motion(
    train: ModalTrain,
    force: FloatArray,
    loads: Sequence[Sequence[Piece]],
    position: FloatArray,
    speed: FloatArray,
) -> Motion:
    """The motion of rigid motions and modes under `force` (both, loads) from a position and speed (both,) at time 0."""
    intervals = history(loads)
    # Rigid motions that nothing damps are kept apart.
    count = int(np.argmax(np.append(train.viscous[: train.rigid].any(axis=1), True)))
    rigid = None
    if count:
        rigid = rigid_motion(force[:count], intervals, position[:count], speed[:count])
    w, damping = train.w_of_all[count:], train.damping[count:, count:]
    q, v, f = position[count:], speed[count:], force[count:]
    half = np.diag(damping) / 2.0
    is_coupled = bool((damping - np.diag(np.diag(damping))).any())
    if count == train.rigid and not is_coupled and (half < NEARLY_CRITICAL * w).all():
        root = -half + 1j * np.sqrt(w**2 - half**2)
        start = v - root.conj() * q
        return Motion(
            train, force, loads, rigid, first_order(root, f.astype(complex), intervals, start), None
        )
    root, shape = _coupled_shapes(w, damping)
    start = ((v + q @ damping.T) @ shape) + root * (q @ shape)
    coordinates = first_order(root, shape.T @ f, intervals, start)
    twice = np.where(root.imag != 0.0, 2.0, 1.0)
    return Motion(train, force, loads, rigid, coordinates, (shape * twice, shape * twice * root))


def _coupled_shapes(w: FloatArray, damping: FloatArray) -> tuple[ComplexArray, ComplexArray]:
    """Roots and shapes x, in columns, that answer (r**2 + r damping + w**2) x = 0, scaled to x (2 r + damping) x = 1.

    Their rough values are eigenvalues of the first-order form in speeds and w times positions; each is then settled by
    inverse iteration with the Rayleigh quotient of the second-order form, which keeps the digits of slow ones.
    """
    size, scale = len(w), np.where(w > 0.0, w, 1.0)
    first_order_form = np.block([[-damping, -np.diag(w)], [np.diag(scale), np.zeros((size, size))]])
    roots, vectors = np.linalg.eig(first_order_form)
    pairs = []
    for k in np.flatnonzero(np.imag(roots) >= 0.0):
        shape = np.asarray(vectors[size:, k] / scale, dtype=vectors.dtype)
        pairs.append(_settle(complex(roots[k]), shape, w, damping))
    return np.array([root for root, _ in pairs]), np.array([shape for _, shape in pairs]).T


def _settle(
    root: complex, shape: ComplexArray, w: FloatArray, damping: FloatArray
) -> tuple[complex, ComplexArray]:
    """One root with its shape, scaled."""
    for _ in range(ROUNDS if len(w) <= LARGEST_SETTLED else 0):
        matrix = np.diag(w.astype(complex) ** 2) + root * damping
        matrix[np.diag_indices_from(matrix)] += root**2
        try:
            shape = np.asarray(np.linalg.solve(matrix, (2.0 * root) * shape + damping @ shape))
        except np.linalg.LinAlgError:
            break  # the root is exact
        shape = np.asarray(shape / np.abs(shape).max())
        sums = shape @ shape, shape @ damping @ shape, (w * shape) @ (w * shape)
        root = _nearest_root(root, *map(complex, sums))
    return root, shape / np.sqrt(shape @ (2.0 * root * shape + damping @ shape))


def _nearest_root(root: complex, a: complex, b: complex, c: complex) -> complex:
    """The solution of a r**2 + b r + c = 0 that is nearest to `root`, without cancellation; real where it was."""
    split = np.sqrt(complex(b * b - 4.0 * a * c))
    far = -(b + split if abs(b + split) >= abs(b - split) else b - split) / 2.0
    solutions = [far / a, c / far] if far != 0 else [root]
    nearest = complex(min(solutions, key=lambda solution: abs(solution - root)))
    return complex(nearest.real) if root.imag == 0.0 else nearest
