"""Stiffness and damping that are powers of what they follow: silicone over the frequency, a pendulum over the speed."""

from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.stiffness_table import StiffnessTable


@dataclass(frozen=True)
class PowerLaw(StiffnessTable):
    """k = k_0 (x/x_0)^p and c = c_0 (x/x_0)^q with x_0 the first of two points `at`, beyond which both are as there.

    >>> law = power_law("frequency", (1.0, 100.0), stiffness=(50.0, 0.5), viscous=(2.0, -0.5))
    >>> law.values(np.array([4.0, 1000.0]))
    (array([100., 500.]), array([0., 0.]), array([1. , 0.2]))
    >>> law.steepest, law.slope(4.0), law.slope(1000.0)
    (0.5, 0.5, 0.0)
    """

    powers: tuple[float, float] = (0.0, 0.0)  # p and q
    printed: tuple[float, ...] = ()  # points at which it is printed
    formula: str = ""

    def values(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Stiffness (N m/rad), loss factor 0 and viscous damping (N m s/rad) at x, each of the shape of x."""
        over = np.clip(np.asarray(x, dtype=float), self.at[0], self.at[-1]) / self.at[0]
        k, c = (
            factors[0] * over**power
            for factors, power in zip((self.stiffness, self.viscous), self.powers, strict=True)
        )
        return k, np.zeros_like(over), c

    def slope(self, x: float) -> float:
        """d ln k/d ln x at x; 0 beyond the ends."""
        return self.powers[0] if self.at[0] <= x < self.at[-1] else 0.0

    @property
    def slopes(self) -> FloatArray:
        """(2, 1) d ln k/d ln x at both ends of its one piece."""
        return np.full((2, 1), self.powers[0])

    @property
    def words(self) -> str:
        """The law as a formula with its numbers."""
        return self.formula

    @property
    def points(self) -> tuple[float, ...]:
        """Those at which it is printed."""
        return self.printed or self.at


def power_law(
    over: str,
    ends: tuple[float, float],
    stiffness: tuple[float, float],
    viscous: tuple[float, float],
    *,
    key: str = "table",
    printed: tuple[float, ...] = (),
    words: str = "",
) -> PowerLaw:
    """Between two ends; stiffness, viscous: (factor, power), the factor as of x = 1."""
    k, c = (tuple(factor * end**power for end in ends) for factor, power in (stiffness, viscous))
    return PowerLaw(
        over, ends, k, (0.0, 0.0), c, True, key, (stiffness[1], viscous[1]), printed, words
    )
