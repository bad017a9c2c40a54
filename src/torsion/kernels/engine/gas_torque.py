"""Harmonics of the gas torque of a cylinder: by quadrature over the pieces of its pressure, exact to rounding.

T(angle) = -(p - p_around) A x'(angle) with the crank angle from firing top dead centre, over a cycle of 720 or 360
degrees. Harmonics C_k = a_k - i b_k: T = C_0 + Re sum C_k exp(i k angle/revolutions), amplitude |C|, phase arg C.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.engine.crank_slider import CrankSlider

WIDEST = math.radians(
    1.0
)  # of a panel: with NODES the pressures of cycles and their harmonics are exact to rounding
NODES = 6
BLOCK = 4_000_000  # values of one exponential matrix


@dataclass(frozen=True)
class Cylinder:
    """A cylinder: its crank, the area of its piston (m2) and the revolutions of its cycle (2 of four strokes)."""

    crank: CrankSlider
    area: float
    revolutions: int

    @property
    def period(self) -> float:
        """Crank angle of a cycle, rad."""
        return 2.0 * math.pi * self.revolutions

    @property
    def swept(self) -> float:
        return self.area * self.crank.stroke

    @property
    def tangential(self) -> float:
        """Torque / tangential pressure, m3: A r with the stroke as 2 r."""
        return self.area * self.crank.stroke / 2.0

    def mean_torque(self, imep: float) -> float:
        """N m of an indicated mean effective pressure (Pa): its work over the angle of a cycle."""
        return imep * self.swept / self.period

    def imep(self, mean_torque: float) -> float:
        """Pa of a mean gas torque (N m)."""
        return mean_torque * self.period / self.swept

    def volume(self, angle: FloatArray, ratio: float) -> FloatArray:
        """m3 at crank angles, of a compression ratio."""
        top = self.crank.piston(0.0)[0]
        return self.swept / (ratio - 1.0) + self.area * (top - self.crank.piston(angle)[0])

    def lever(self, angle: FloatArray) -> FloatArray:
        """Torque / pressure at crank angles, m3."""
        return -self.area * self.crank.piston(angle)[1]


@dataclass(frozen=True)
class Panels:
    """Nodes and weights of a Gauss quadrature over pieces of a cycle."""

    edges: FloatArray  # (panels + 1,) rad, ascending
    angle: FloatArray  # (panels, NODES) rad
    weight: FloatArray  # (panels, NODES) rad

    @classmethod
    def between(cls, corners: FloatArray, widest: float = WIDEST) -> "Panels":
        """Panels no wider than `widest` (rad) between corners (rad, ascending), beyond which nothing is smooth."""
        pieces = [
            np.linspace(low, high, max(math.ceil((high - low) / widest), 1) + 1)[:-1]
            for low, high in zip(corners[:-1].tolist(), corners[1:].tolist(), strict=True)
        ]
        edges = np.append(np.concatenate(pieces), corners[-1])
        nodes, weights = np.polynomial.legendre.leggauss(NODES)
        half = np.diff(edges)[:, None] / 2.0
        return cls(edges, (edges[:-1, None] + half) + half * nodes, half * weights)


def harmonics(
    torque: Callable[[FloatArray], FloatArray], panels: Panels, revolutions: int, count: int
) -> ComplexArray:
    """(count + 1,) harmonics of a torque over a cycle: of four strokes number k is of order k/2, of two of order k."""
    angle, weighted = panels.angle.ravel(), (torque(panels.angle) * panels.weight).ravel()
    harmonics, number = np.zeros(count + 1, dtype=np.complex128), np.arange(count + 1)
    length = max(BLOCK // (count + 1), 1)
    for start in range(0, len(angle), length):
        part = slice(start, start + length)
        harmonics += np.exp(-1j / revolutions * np.outer(number, angle[part])) @ weighted[part]
    harmonics /= 2.0 * math.pi * revolutions
    harmonics[1:] *= 2.0
    return harmonics


@dataclass(frozen=True)
class Diagram:
    """An indicator diagram: pressures (Pa, absolute) at crank angles of one cycle, straight between them."""

    angle: FloatArray  # (points,) rad from firing top dead centre, ascending over one cycle
    pressure: FloatArray  # (points,) Pa; the last is the first of the next cycle

    def mirrored(self, cylinder: Cylinder) -> "Diagram":
        """The same cylinder motored: the pressures of compression again in expansion, until these are the lower ones.

        An estimate for where nothing else is known: no heat is lost, and the gas is exchanged as when it fires.
        """
        period, bottom = cylinder.period, cylinder.crank.bottom
        turned = (self.angle + period / 2.0) % period - period / 2.0
        back = self.at(-self.angle, period)
        expands = (turned > 0) & (turned < bottom)
        return Diagram(
            self.angle, np.where(expands, np.minimum(self.pressure, back), self.pressure)
        )

    def at(self, angle: FloatArray, period: float) -> FloatArray:
        """Return the pressure (Pa) at crank angles (rad) of any shape."""
        first = self.angle[0]
        return np.asarray(np.interp((angle - first) % period + first, self.angle, self.pressure))

    def torque(self, cylinder: Cylinder, count: int, around: float = 0.0) -> ComplexArray:
        """(count + 1,) N m: harmonics of its gas torque; around: Pa under the piston."""
        panels = Panels.between(self.angle)

        def acting(angle: FloatArray) -> FloatArray:
            pressure = np.interp(angle, self.angle, self.pressure) - around
            return pressure * cylinder.lever(angle)

        return harmonics(acting, panels, cylinder.revolutions, count)
