"""Crank and connecting rod, exactly: motion of the piston, torques of moving masses, inertia that varies.

Crank angles count from firing top dead centre. With the offset of the cylinder axis that is not where the crank lies
in line with the axis: there the angle of the formulas is the crank angle plus `top`.
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from torsion.arrays import ComplexArray, FloatArray
from torsion.sources import source

SAMPLES = 4096  # of a revolution; harmonics fall like (radius / rod)^order, so that all that fit a double are there


@dataclass(frozen=True)
class CrankSlider:
    """A crank of a radius and a rod (m); offset of the cylinder axis, positive where the pin moves first.

    >>> crank = CrankSlider(0.05, 0.15, 0.01)
    >>> round(math.degrees(crank.top), 6), round(crank.stroke, 9)
    (2.865984, 0.1002511)
    """

    radius: float
    rod: float
    offset: float = 0.0

    def __post_init__(self) -> None:
        if not self.rod > self.radius + abs(self.offset):
            raise ValueError("the rod is not longer than crank radius and offset together")

    @classmethod
    def of_stroke(cls, stroke: float, rod: float, offset: float = 0.0) -> "CrankSlider":
        """The one of a stroke; with an offset the stroke is longer than twice the radius. Raises ValueError.

        Stroke s: (l + r)^2 - e^2 = (s + u)^2 with u^2 = (l - r)^2 - e^2, hence r in closed form.
        """
        square = (stroke / 2.0) ** 2
        inner = rod * rod - square - offset * offset
        radius = math.sqrt(square * inner / (rod * rod - square)) if inner > 0 else math.inf
        return cls(radius, rod, offset)

    @cached_property
    def top(self) -> float:
        """Angle of the formulas at top dead centre, rad."""
        return math.asin(self.offset / (self.rod + self.radius))

    @cached_property
    def bottom(self) -> float:
        """Crank angle from top to bottom dead centre, rad; pi without an offset."""
        return math.pi + math.asin(self.offset / (self.rod - self.radius)) - self.top

    @cached_property
    def stroke(self) -> float:
        return float(self.piston(0.0)[0] - self.piston(self.bottom)[0])

    def piston(self, angle: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Distance of the piston pin from the crank's centre along the axis, m, and its derivatives by the angle."""
        turned = np.asarray(angle, dtype=float) + self.top
        sine, cosine = self.radius * np.sin(turned), self.radius * np.cos(turned)
        across = sine - self.offset
        along = np.sqrt(self.rod**2 - across**2)
        first = -sine - across * cosine / along
        second = -cosine - (cosine**2 - across * sine) / along - (across * cosine) ** 2 / along**3
        return cosine + along, first, second

    def inertia_harmonics(
        self, count: int, reciprocating: float, correction: float = 0.0
    ) -> ComplexArray:
        """(count + 1,) kg m2 that moving masses add: J(angle) = J_0 + Re sum J_k exp(i k angle), k = 1 .. count.

        reciprocating: kg; correction: kg m2, of the rod, I_cg - m u (l - u), usually negative.
        """
        angle = 2.0 * math.pi / SAMPLES * np.arange(SAMPLES)
        inertia = reciprocating * self.piston(angle)[1] ** 2

        # The rod leans by the angle beta against the axis: sin(beta) = across/rod.
        turned = angle + self.top
        along = np.sqrt(self.rod**2 - (self.radius * np.sin(turned) - self.offset) ** 2)
        tilt_rate = self.radius * np.cos(turned) / along
        return of_samples(inertia + correction * tilt_rate**2, count)

    def inertia_torque(
        self, count: int, reciprocating: float, correction: float = 0.0
    ) -> ComplexArray:
        """(count + 1,) kg m2: harmonics 0 .. count of the torque of moving masses / speed^2, at constant speed.

        T = -(1/2) dJ/dangle speed^2: -m x' x'' of the piston with -J_c beta' beta'' of the rod.
        """
        order = np.arange(count + 1)
        return np.asarray(-0.5j * order * self.inertia_harmonics(count, reciprocating, correction))


def rod_as_masses(
    length: float, mass: float, centre: float, inertia: float
) -> tuple[float, float, float]:
    """Shares (kg) of a rod that turn with the pin and go with the piston, and J_c by which they differ from it.

    J_c = I_cg - m u (l - u), kg m2. mass: kg; centre: m, of mass from the big end; inertia: kg m2, about that centre.

    >>> rod_as_masses(0.25, 2.0, 0.125, 0.5)
    (1.0, 1.0, 0.46875)
    """
    rotating, reciprocating = mass * (length - centre) / length, mass * centre / length
    return rotating, reciprocating, inertia - mass * centre * (length - centre)


def of_samples(values: FloatArray, count: int) -> ComplexArray:
    """(count + 1,) harmonics C_k of evenly spaced samples of one period: C_0 + Re sum C_k exp(i k angle)."""
    harmonics = np.fft.rfft(values)[: count + 1] / len(values)
    harmonics[1:] *= 2.0
    return np.asarray(harmonics)


@dataclass(frozen=True)
class Throw:
    """Dimensions in m; journal and pin hollow or solid, web as a rectangle."""

    journal: tuple[float, float, float]  # diameter, bore, length
    pin: tuple[float, float, float]
    web: tuple[float, float]  # thickness along the shaft, width
    radius: float  # of the crank


@source("Carter")
def carter(throw: Throw, shear_modulus: float) -> float:
    """N m/rad after Carter (Nestorides, handbook; to be verified)."""
    (d_j, bore_j, l_j), (d_p, bore_p, l_p), (thick, wide) = throw.journal, throw.pin, throw.web
    length = (l_j + 0.8 * thick) / (d_j**4 - bore_j**4) + 0.75 * l_p / (d_p**4 - bore_p**4)
    return math.pi * shear_modulus / 32.0 / (length + 1.5 * throw.radius / (thick * wide**3))


@source("KerWilson")
def ker_wilson(throw: Throw, shear_modulus: float) -> float:
    """N m/rad after Ker Wilson (Nestorides, handbook; to be verified)."""
    (d_j, bore_j, l_j), (d_p, bore_p, l_p), (thick, wide) = throw.journal, throw.pin, throw.web
    length = (l_j + 0.4 * d_j) / (d_j**4 - bore_j**4) + (l_p + 0.4 * d_p) / (d_p**4 - bore_p**4)
    arm = throw.radius - 0.2 * (d_j + d_p)
    return math.pi * shear_modulus / 32.0 / (length + arm / (thick * wide**3))
