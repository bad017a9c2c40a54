"""The torques of cylinders at one throw while they follow its angle: many orders, each over the speed."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.motion.collocation import Conditions, Points
from torsion.kernels.motion.torque_laws import BySpeed, Parts

SAME = 1e-12  # of the largest value: polynomials of two parts that differ less are one


@dataclass(frozen=True)
class OrdersByAngle:
    """Re sum size_k(speed) exp(i order_k angle), every size a complex polynomial of degree 2 by parts of the speed."""

    interface: int
    order: FloatArray  # (orders,) per rad of the own shaft
    edges: FloatArray  # (parts - 1,) rad/s, ascending
    polynomial: ComplexArray  # (parts, 3, orders): constant, by speed, by its square; N m
    scale: float  # rad/s

    at = BySpeed.at
    still = BySpeed.still

    @property
    def cuts(self) -> tuple[float, ...]:
        """It acts throughout."""
        return ()

    @property
    def _parts(self) -> Parts:
        return Parts(self.edges, np.zeros((len(self.polynomial), 3)), self.scale)

    def first(self, points: Points) -> int:
        """The part of its speed."""
        return self._parts.part(float(points.speed[0, 0]))

    def conditions(self, regime: int, points: Points) -> Conditions:
        """What must be 0, with its derivatives."""
        level, slope, square = self.polynomial[regime]
        speed = points.speed[0][:, None]
        wave = np.exp(1j * np.outer(points.angle[0], self.order))
        size, grows = level + speed * (slope + speed * square), slope + 2.0 * square * speed
        return Conditions(
            (size * wave).real.sum(axis=1) - points.torque,
            by_angle=(1j * self.order * size * wave).real.sum(axis=1)[None, None],
            by_speed=(grows * wave).real.sum(axis=1)[None, None],
        )

    def limits(self, regime: int, points: Points) -> list[tuple[FloatArray, int]]:
        """Margins to the other parts of the speed."""
        return self._parts.limits(regime, points.speed[0])


def quadratics(edges: FloatArray, values: ComplexArray) -> ComplexArray:
    """(parts, 3, orders) coefficients through values (parts, 3, orders) at both edges and the middle of every part.

    edges: (parts + 1,) rad/s, ascending.
    """
    speed = np.stack([edges[:-1], (edges[:-1] + edges[1:]) / 2.0, edges[1:]], axis=1)
    powers = speed[:, :, None] ** np.arange(3)
    return np.asarray(np.linalg.solve(powers.astype(complex), values))


def without_equal_parts(
    edges: FloatArray, polynomial: ComplexArray
) -> tuple[FloatArray, ComplexArray]:
    """The edges (parts + 1,) and polynomials (parts, 3, orders) of parts that differ from the part before.

    A march ends a step at every edge that a speed crosses: an edge where the law does not change costs steps alone.
    """
    kept = [0]
    speed = np.stack([edges[:-1], (edges[:-1] + edges[1:]) / 2.0, edges[1:]], axis=1)[:, :, None]
    powers = np.concatenate([np.ones_like(speed), speed, speed**2], axis=2)
    largest = np.abs(powers @ polynomial).max(initial=0.0)
    for part in range(1, len(polynomial)):
        difference = np.abs(powers[[kept[-1], part]] @ (polynomial[part] - polynomial[kept[-1]]))
        if difference.max(initial=0.0) > SAME * largest:
            kept.append(part)
    return edges[[*kept, -1]], polynomial[kept]
