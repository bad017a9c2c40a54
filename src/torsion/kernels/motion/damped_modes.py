"""Modes with their damping as first-order coordinates: each by itself, or all together where damping couples them."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from torsion.arrays import ComplexArray, FloatArray

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

    @cached_property
    def w_of_all(self) -> FloatArray:
        """Natural frequencies, 0 for rigid motions: (rigid motions + modes,) rad/s."""
        return np.concatenate([np.zeros(self.rigid), self.w])

    @cached_property
    def damping(self) -> FloatArray:
        """(rigid motions + modes, the same) 1/s, all of it."""
        ratio = np.concatenate([np.zeros(self.rigid), self.ratio])
        return self.viscous + np.diag(2.0 * ratio * self.w_of_all)


@dataclass(frozen=True)
class Roots:
    """Coordinates y' = root y + of_speed f of modes under generalised forces f, y = of_speed v + of_position q.

    Each stands for a pair where its root is complex. q is the real part of shape y, v that of shape (root y). Modes that
    no damping couples have factors (modes,) in place of matrices.
    """

    root: ComplexArray  # (coordinates,) 1/s
    shape: ComplexArray  # (modes, coordinates)
    of_speed: ComplexArray  # (coordinates, modes)
    of_position: ComplexArray  # (coordinates, modes)


def roots_of(w: FloatArray, damping: FloatArray, *, settles: bool = True) -> Roots:
    """The roots of modes of natural frequencies w (modes,) rad/s under a damping (modes, modes) 1/s.

    Where damping couples modes, roots r and shapes x answer (r**2 + r damping + w**2) x = 0. Their rough values are
    eigenvalues of the first-order form in speeds and w times positions; each is then settled by inverse iteration with
    the Rayleigh quotient of the second-order form, which keeps the digits of slow ones. settles: shapes are improved too;
    else only the roots, which takes less time.
    """
    half = np.diag(damping) / 2.0
    is_coupled = bool((damping - np.diag(2.0 * half)).any())
    if not is_coupled and (half < NEARLY_CRITICAL * w).all():
        vibrating = np.sqrt(w**2 - half**2)
        root = -half + 1j * vibrating
        return Roots(root, -1j / vibrating, np.ones_like(root), -root.conj())

    size, scale = len(w), np.where(w > 0.0, w, 1.0)
    first_order_form = np.block([[-damping, -np.diag(w)], [np.diag(scale), np.zeros((size, size))]])
    roots, vectors = np.linalg.eig(first_order_form)
    pairs = []
    for k in np.flatnonzero(np.imag(roots) >= 0.0):
        shape = np.asarray(vectors[size:, k] / scale, dtype=vectors.dtype)
        pairs.append(_settle(complex(roots[k]), shape, w, damping, settles=settles))
    root, shape = np.array([root for root, _ in pairs]), np.array([shape for _, shape in pairs]).T
    vibrates = root.imag != 0.0
    roots = np.concatenate([root, root[vibrates].conj()])
    shapes = np.concatenate([shape, shape[:, vibrates].conj()], axis=1)
    states = np.concatenate([shapes * roots, scale[:, None] * shapes])
    left = np.linalg.solve(states, np.eye(2 * size))[: len(root)]
    twice = np.where(vibrates, 2.0, 1.0)
    return Roots(root, shape * twice, left[:, :size], left[:, size:] * scale)


def _settle(
    root: complex, shape: ComplexArray, w: FloatArray, damping: FloatArray, *, settles: bool
) -> tuple[complex, ComplexArray]:
    """One root with its shape, whose largest component is 1."""
    shape = np.asarray(shape / np.abs(shape).max(), dtype=complex)
    for _ in range(ROUNDS if len(w) <= LARGEST_SETTLED else 0):
        if settles:
            matrix = np.diag(w.astype(complex) ** 2) + root * damping
            matrix[np.diag_indices_from(matrix)] += root**2
            try:
                shape = np.asarray(np.linalg.solve(matrix, (2.0 * root) * shape + damping @ shape))
            except np.linalg.LinAlgError:
                break  # the root is exact
            shape = np.asarray(shape / np.abs(shape).max())
        # The solution of a r**2 + b r + c = 0 that is nearest to the root, without cancellation; real where it was.
        a, b = complex(shape @ shape), complex(shape @ damping @ shape)
        c = complex((w * shape) @ (w * shape))
        split = np.sqrt(complex(b * b - 4.0 * a * c))
        far = -(b + split if abs(b + split) >= abs(b - split) else b - split) / 2.0
        solutions, real = [far / a, c / far] if far != 0 else [root], root.imag == 0.0
        distances = [abs(solution - root) for solution in solutions]
        root = complex(solutions[int(np.argmin(distances))])
        root = complex(root.real) if real else root
    return root, shape
