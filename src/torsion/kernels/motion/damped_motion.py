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
from torsion.kernels.motion.torque_history import History, Piece, value
from torsion.kernels.motion.torque_history import history as cut

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
        """Number of rigid motions."""
        return len(self.viscous) - len(self.w)

    @property
    def w_of_all(self) -> FloatArray:
        """(rigid motions + modes,) rad/s."""
        return np.concatenate([np.zeros(self.rigid), self.w])

    @property
    def damping(self) -> FloatArray:
        """(rigid motions + modes, the same) 1/s, all of it."""
        return self.viscous + np.diag(
            2.0 * np.concatenate([np.zeros(self.rigid), self.ratio]) * self.w_of_all
        )


@dataclass(frozen=True)
class Motion:
    """Rigid motions and modes over time: to be read at any times."""

    train: "ModalTrain"
    force: FloatArray  # (rigid motions + modes, loads)
    loads: Sequence[Sequence[Piece]]
    rigid: RigidMotion | None  # of the first of them, up to one that damping takes hold of
    coordinates: FirstOrder
    read: (
        tuple[np.ndarray, np.ndarray] | None
    )  # rows of place and of speed; None: modes by themselves

    @property
    def rigid_motions(self) -> int:
        """Number of rigid motions."""
        return self.train.rigid

    def at(self, time: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Places and speeds (rigid motions + modes, times) at times >= 0 (s) that ascend."""
        place, speed = self.modal(self.coordinates.at(time))
        if self.rigid is None:
            return place, speed
        turned, turning = self.rigid.at(time)
        return np.concatenate([turned, place]), np.concatenate([turning, speed])

    def modal(self, y: ComplexArray) -> tuple[FloatArray, FloatArray]:
        """Places and speeds (modes, or all that damping takes hold of, times) of coordinates (coordinates, times)."""
        if self.read is not None:
            parts = np.concatenate([y.real, -y.imag])
            place, speed = (
                np.concatenate([row.real, row.imag], axis=1) @ parts for row in self.read
            )
            return place, speed
        root = self.coordinates.root
        place = y.imag / root.imag[:, None]
        return place, y.real + root.real[:, None] * place

    @property
    def reading(self) -> tuple[ComplexArray, ComplexArray]:
        """Rows (modes or all, coordinates) of which the real parts times the coordinates are places and speeds."""
        if self.read is not None:
            return self.read
        place: ComplexArray = np.diag(-1j / self.coordinates.root.imag)
        return place, np.asarray(
            np.eye(len(place)) + self.coordinates.root.real * place, dtype=complex
        )

    @property
    def cuts(self) -> FloatArray:
        """(cuts,) s, where the torques have kinks."""
        return self.coordinates.history.begin

    def loads_at(self, time: FloatArray) -> FloatArray:
        """(loads, times)."""
        return np.array([value(pieces, time) for pieces in self.loads]).reshape(-1, len(time))

    def load_rates_at(self, time: FloatArray) -> FloatArray:
        """(loads, times) per second."""
        rates = [[piece.rate_of_change() for piece in pieces] for pieces in self.loads]
        return np.array([value(pieces, time) for pieces in rates]).reshape(-1, len(time))

    def force_at(self, time: FloatArray) -> FloatArray:
        """(rigid motions + modes, times) of all loads."""
        return np.asarray(self.force @ self.loads_at(time))

    def acceleration(self, time: FloatArray, place: FloatArray, speed: FloatArray) -> FloatArray:
        """(rigid motions + modes, times) by the balance of torques, of what `at` returned."""
        damped, held = self.train.damping @ speed, self.train.w_of_all[:, None] ** 2 * place
        return np.asarray(self.force_at(time) - damped - held)


def motion(
    train: ModalTrain,
    force: FloatArray,
    loads: Sequence[Sequence[Piece]],
    place: FloatArray,
    speed: FloatArray,
) -> Motion:
    """The motion of rigid motions and modes under `force` (both, loads) from a place and speed (both,) at time 0."""
    history = cut(loads)
    count = int(
        np.argmax(np.append(train.viscous[: train.rigid].any(axis=1), True))
    )  # rigid motions nothing damps
    rigid = rigid_motion(force[:count], history, place[:count], speed[:count]) if count else None
    kept = slice(count, None)
    w, damping = train.w_of_all[kept], train.damping[kept, kept]
    q, v, f = place[kept], speed[kept], force[kept]
    each = np.diag(damping) / 2.0
    if (
        count == train.rigid
        and not (damping - np.diag(np.diag(damping))).any()
        and (each < NEARLY_CRITICAL * w).all()
    ):
        root = -each + 1j * np.sqrt(w**2 - each**2)
        found = first_order(root, f.astype(complex), history, v - root.conj() * q)
        return Motion(train, force, loads, rigid, found, None)
    return Motion(train, force, loads, rigid, *_coupled(w, damping, f, history, q, v))


def _coupled(
    w: FloatArray,
    damping: FloatArray,
    force: FloatArray,
    history: History,
    q: FloatArray,
    v: FloatArray,
) -> tuple[FirstOrder, tuple[ComplexArray, ComplexArray]]:
    """Coordinates of the shapes x that answer (r**2 + r damping + w**2) x = 0, scaled to x (2 r + damping) x = 1.

    Their rough values are eigenvalues of the first-order form in speeds and w times places; each is then settled by
    inverse iteration with the Rayleigh quotient of the second-order form, which keeps the digits of slow ones.
    """
    size, scale = len(w), np.where(w > 0.0, w, 1.0)
    roots, vectors = np.linalg.eig(
        np.block([[-damping, -np.diag(w)], [np.diag(scale), np.zeros((size, size))]])
    )
    kept = np.flatnonzero(np.imag(roots) >= 0.0)
    pairs = [
        _settled(
            complex(roots[k]),
            np.asarray(vectors[size:, k] / scale, dtype=vectors.dtype),
            w,
            damping,
        )
        for k in kept
    ]
    root, shape = np.array([one for one, _ in pairs]), np.array([one for _, one in pairs]).T
    twice = np.where(root.imag != 0.0, 2.0, 1.0)
    start = ((v + q @ damping.T) @ shape) + root * (q @ shape)
    found = first_order(root, shape.T @ force, history, start)
    return found, (shape * twice, shape * twice * root)


def _settled(
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
        root = _nearest(root, *map(complex, sums))
    return root, shape / np.sqrt(shape @ (2.0 * root * shape + damping @ shape))


def _nearest(root: complex, a: complex, b: complex, c: complex) -> complex:
    """The solution of a r**2 + b r + c = 0 that is nearest to `root`, without cancellation; real where it was."""
    split = np.sqrt(complex(b * b - 4.0 * a * c))
    far = -(b + split if abs(b + split) >= abs(b - split) else b - split) / 2.0
    found = [far / a, c / far] if far != 0 else [root]
    best = complex(min(found, key=lambda one: abs(one - root)))
    return complex(best.real) if root.imag == 0.0 else best
