"""Stiffness and damping of a coupling over what they follow: linear between the points of a table, as makers print.

Stiffness and loss factor are linear each by itself, so that a value between two points is the one read off the maker's
curve; the loss modulus k eta is then not linear.
"""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from torsion.arrays import FloatArray

STEEPEST = 2.0  # d ln k/d ln w of a stiffness that rises as the square of the frequency: no longer one root a mode


@dataclass(frozen=True)
class StiffnessTable:
    """A table over frequency or mean torque.

    >>> import numpy as np
    >>> table = StiffnessTable("frequency", (10.0, 20.0), (2000.0, 3000.0), (0.1, 0.2), (0.0, 0.0))
    >>> table.values(np.array([15.0]))
    (array([2500.]), array([0.15]), array([0.]))
    >>> round(table.steepest, 3)  # d ln k/d ln x at the upper end: 100 * 20 / 3000
    0.667
    """

    over: str  # "frequency", "mean torque", or "speed" of the driving station
    at: tuple[float, ...]  # rad/s, or N m at the driving station's own speed; ascending
    stiffness: tuple[float, ...]  # N m/rad
    loss_factor: tuple[float, ...]
    viscous: tuple[float, ...]  # N m s/rad
    holds: bool = False  # the values at its ends beyond them; else it says nothing there
    # Of its component, under which the file gives it; empty: the component itself.
    key: str = "table"

    def values(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Stiffness (N m/rad), loss factor and viscous damping (N m s/rad) at x, each of the shape of x."""
        k, eta, c = (
            np.interp(x, self.at, column)
            for column in (self.stiffness, self.loss_factor, self.viscous)
        )
        return k, eta, c

    def complex_stiffness(self, x: FloatArray, w: FloatArray) -> np.ndarray:
        """K = k (1 + i eta) + i w c at x, N m/rad, for vibrations of w (rad/s)."""
        k, eta, c = self.values(x)
        return np.asarray(k * (1.0 + 1j * eta) + 1j * w * c)

    def slope(self, x: float) -> float:
        """d ln k/d ln x at x, of the piece that begins there; 0 beyond the ends."""
        piece = int(np.searchsorted(self.at, x, side="right")) - 1
        if not 0 <= piece < len(self.at) - 1:
            return 0.0
        rise = (self.stiffness[piece + 1] - self.stiffness[piece]) / (
            self.at[piece + 1] - self.at[piece]
        )
        return float(rise * x / np.interp(x, self.at, self.stiffness))

    @property
    def points(self) -> tuple[float, ...]:
        """Those at which it is printed."""
        return self.at

    @property
    def follows(self) -> str:
        """What stands in place of one value: by table, or by what a law is over."""
        return "by table" if self.key == "table" else f"by {self.over}"

    @property
    def is_complex(self) -> bool:
        """It holds at every complex s, not at real frequencies alone."""
        return False

    @property
    def first(self) -> float:
        """Where its stiffness stands for it where nothing else is said: its first point."""
        return self.at[0]

    @property
    def words(self) -> str:
        """The law that it samples; a table has none."""
        return ""

    @property
    def ends(self) -> tuple[float, float]:
        """Between which it says something by itself."""
        return self.at[0], self.at[-1]

    def times(self, factor: float) -> Self:
        """The same with its stiffness multiplied."""
        return replace(self, stiffness=tuple(k * factor for k in self.stiffness))

    @property
    def damps(self) -> bool:
        """Whether the table has a loss factor or viscous damping anywhere."""
        return any(self.loss_factor) or any(self.viscous)

    @property
    def slopes(self) -> FloatArray:
        """(2, pieces) d ln k/d ln x at both ends of every piece; between them it lies between (k = a + b x)."""
        points, k = np.array(self.at), np.array(self.stiffness)
        rise = np.diff(k) / np.diff(points)
        return np.stack([rise * points[:-1] / k[:-1], rise * points[1:] / k[1:]])

    @property
    def steepest(self) -> float:
        """The largest d ln k/d ln x anywhere; 0 of a stiffness that nowhere rises."""
        return float(self.slopes.max(initial=0.0))

    def uncovered(self, x: FloatArray) -> FloatArray:
        """Those of x that the table says nothing of; numbers beyond its ends by rounding alone are covered."""
        near = 1e-9  # relative: a value written in another unit
        low, high = self.at[0] * (1.0 - near), self.at[-1] * (1.0 + near)
        return np.empty(0) if self.holds else np.asarray(x[(x < low) | (x > high)])
