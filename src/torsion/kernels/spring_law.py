"""Springs of a viscoelastic law, K(s) at any complex s: relaxing terms beside a static spring (Prony), or a power of s.

K(s) = k0 + sum k s tau/(1 + s tau), or K(s) = k0 + k1 (s tau)^a with |arg s| < pi (Bagley and Torvik, J. Rheol. 27
(1983) 201). On the real axis of frequency either is a table over frequency of any number of points.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Self

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.stiffness_table import StiffnessTable
from torsion.sources import source

SAMPLES = 13  # points of the law as a table, for readers
AROUND = 10.0  # times the extreme relaxation times, to either side: between them the law changes
FAR = 1e12  # times 1/tau: no train has modes beyond


@dataclass(frozen=True)
class SpringLaw(StiffnessTable):
    """A law in the place of a table; what the table says are samples of it.

    >>> law = prony(15e3, ((6e3, 0.05), (9e3, 0.005)))
    >>> complex(law.at_root(0j)[0]), round(float(law.values(np.array(1e9))[0]) / 1e3, 9)
    ((15000+0j), 30.0)
    >>> fractional(10e3, 6e3, 0.01, 0.35).steepest
    0.35
    """

    static: float = 0.0  # N m/rad, k0
    terms: tuple[
        tuple[float, float], ...
    ] = ()  # (N m/rad, s) each, relaxing, or the one of a power of s
    exponent: float | None = None  # of the power; None: the terms relax

    def at_root(self, s: ComplexArray | complex) -> tuple[ComplexArray, ComplexArray]:
        """K (N m/rad) and dK/ds (N m s/rad) at complex s (rad/s), of its shape."""
        point = np.asarray(s, dtype=np.complex128)
        k = np.full(point.shape, self.static, dtype=np.complex128)
        slope = np.zeros(point.shape, dtype=np.complex128)
        for stiffness, tau in self.terms:
            if self.exponent is None:
                k = k + stiffness * point * tau / (1.0 + point * tau)
                slope = slope + stiffness * tau / (1.0 + point * tau) ** 2
            else:
                power = stiffness * (point * tau) ** self.exponent
                k = k + power
                slope = slope + np.divide(
                    self.exponent * power, point, out=np.zeros_like(point), where=point != 0
                )
        return np.asarray(k), np.asarray(slope)

    def poles(self, s: ComplexArray) -> ComplexArray:
        """Sum of tau/(1 + s tau), of its shape: what p'/p of a determinant lacks for the poles of K."""
        terms = self.terms if self.exponent is None else ()
        return sum((tau / (1.0 + s * tau) for _, tau in terms), np.zeros_like(s))

    def values(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Stiffness (N m/rad), loss factor, and no viscous damping, at x (rad/s)."""
        k = self.at_root(np.asarray(1j * np.asarray(x, dtype=np.float64), dtype=np.complex128))[0]
        return k.real, k.imag / k.real, np.zeros(k.shape)

    def slope(self, x: float) -> float:
        """d ln k'/d ln w at x (rad/s)."""
        k, slope = self.at_root(1j * x)
        return float(x * (1j * slope).real / k.real)

    @cached_property
    def steepest(self) -> float:
        """An upper bound of the slope, below 2: of one relaxing term the largest itself, of a power its exponent.

        With a share of k0 for every term in proportion to its k, the quotient of the sums is at most the largest
        quotient of two parts, 2 y/((1 + y)(c + (1 + c) y)), y = (w tau)^2, c = k0/sum k: largest at y^2 = c/(1 + c).
        """
        if self.exponent is not None:
            return self.exponent
        c = self.static / sum(k for k, _ in self.terms)
        return 2.0 / (math.sqrt(c) + math.sqrt(1.0 + c)) ** 2

    @property
    def is_complex(self) -> bool:
        """It holds at every complex s."""
        return True

    @property
    def first(self) -> float:
        """rad/s: its static stiffness stands for it where no frequency is meant."""
        return 0.0

    @property
    def words(self) -> str:
        """The law with its figures, N m/rad and s."""
        form = (
            "{:.8g} s τ/(1 + s τ), τ = {:.8g} s"
            if self.exponent is None
            else f"{{:.8g}} (s τ)^{self.exponent:.8g}, τ = {{:.8g}} s"
        )
        return " + ".join(
            [f"K(s) = {self.static:.8g}", *(form.format(*term) for term in self.terms)]
        )

    @property
    def ends(self) -> tuple[float, float]:
        """Lowest and highest frequency (rad/s) of any use: the law holds everywhere."""
        times = [tau for _, tau in self.terms]
        return 1.0 / (FAR * max(times)), FAR / min(times)

    def times(self, factor: float) -> Self:
        """The law with all its stiffnesses multiplied."""
        terms = tuple((k * factor, tau) for k, tau in self.terms)
        stiffness = tuple(k * factor for k in self.stiffness)
        return replace(self, static=self.static * factor, terms=terms, stiffness=stiffness)


def prony(static: float, terms: tuple[tuple[float, float], ...]) -> SpringLaw:
    """A static spring (N m/rad) with springs (N m/rad) beside it that relax, each in its time (s)."""
    return _sampled(SpringLaw("frequency", (), (), (), (), True, "prony", static, terms))


@source("BagleyTorvik1983")
def fractional(static: float, stiffness: float, tau: float, exponent: float) -> SpringLaw:
    """A static spring (N m/rad) and a springpot beside it, stiffness (s tau)^exponent."""
    return _sampled(
        SpringLaw(
            "frequency", (), (), (), (), True, "fractional", static, ((stiffness, tau),), exponent
        )
    )


def _sampled(law: SpringLaw) -> SpringLaw:
    times = [tau for _, tau in law.terms]
    frequency = np.geomspace(1.0 / (AROUND * max(times)), AROUND / min(times), SAMPLES)
    k, eta, c = (tuple(values.tolist()) for values in law.values(frequency))
    return replace(law, at=tuple(frequency.tolist()), stiffness=k, loss_factor=eta, viscous=c)
