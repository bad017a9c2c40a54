"""Stiffness and damping of a coupling over what they follow: linear between the points of a table, as makers print.

Stiffness and loss factor are linear each by itself, so that a value between two points is the one read off the maker's
curve; the loss modulus k eta is then not linear.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from typing import ClassVar, Self

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray
from torsion.sources import source

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
    words: str = ""  # the law that it samples, with its figures; a table has none
    printed: tuple[float, ...] = ()  # points at which it is printed; () for those of the table
    is_complex: ClassVar[bool] = False  # it holds at every complex s, not at real frequencies alone

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

    is_complex: ClassVar[bool] = True
    static: float = 0.0  # N m/rad, k0
    terms: tuple[
        tuple[float, float], ...
    ] = ()  # (N m/rad, s) each, relaxing, or the one of a power of s
    exponent: float | None = None  # of the power; None: the terms relax

    def at_root(self, s: ComplexArray | FloatArray | complex) -> tuple[ComplexArray, ComplexArray]:
        """K (N m/rad) and dK/ds (N m s/rad) at complex s (rad/s), of its shape."""
        point = np.asarray(s, dtype=complex)
        k = np.full(point.shape, self.static, dtype=complex)
        slope = np.zeros(point.shape, dtype=complex)
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

    def values(self, x: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Stiffness (N m/rad), loss factor, and no viscous damping, at x (rad/s)."""
        k = self.at_root(np.asarray(1j * np.asarray(x, dtype=float), dtype=complex))[0]
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
    def ends(self) -> tuple[float, float]:
        """Lowest and highest frequency (rad/s) of any use: the law holds everywhere."""
        times = [tau for _, tau in self.terms]
        return 1.0 / (FAR * max(times)), FAR / min(times)

    def times(self, factor: float) -> Self:
        """The law with all its stiffnesses multiplied."""
        terms = tuple((k * factor, tau) for k, tau in self.terms)
        return replace(self, static=self.static * factor, terms=terms).sampled()

    def sampled(self) -> Self:
        """The same with its samples, and in words: its figures in N m/rad and s."""
        times = [tau for _, tau in self.terms]
        frequency = np.geomspace(1.0 / (AROUND * max(times)), AROUND / min(times), SAMPLES)
        k, eta, c = (tuple(values.tolist()) for values in self.values(frequency))
        form = (
            "{:.8g} s τ/(1 + s τ), τ = {:.8g} s"
            if self.exponent is None
            else f"{{:.8g}} (s τ)^{self.exponent:.8g}, τ = {{:.8g}} s"
        )
        words = [f"K(s) = {self.static:.8g}", *(form.format(*term) for term in self.terms)]
        at = tuple(frequency.tolist())
        return replace(
            self, at=at, stiffness=k, loss_factor=eta, viscous=c, words=" + ".join(words)
        )


_NOT_SAMPLED = SpringLaw("frequency", (), (), (), (), holds=True)


def prony(static: float, terms: tuple[tuple[float, float], ...]) -> SpringLaw:
    """A static spring (N m/rad) with springs (N m/rad) beside it that relax, each in its time (s)."""
    return replace(_NOT_SAMPLED, key="prony", static=static, terms=terms).sampled()


@source("BagleyTorvik1983")
def fractional(static: float, stiffness: float, tau: float, exponent: float) -> SpringLaw:
    """A static spring (N m/rad) and a springpot beside it, stiffness (s tau)^exponent."""
    law = replace(_NOT_SAMPLED, key="fractional", static=static, exponent=exponent)
    return replace(law, terms=((stiffness, tau),)).sampled()


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
        over, ends, k, (0.0, 0.0), c, True, key, words, printed, (stiffness[1], viscous[1])
    )


SCANNED = 65  # temperatures between the surroundings and the highest permissible one
HALVINGS = 50  # of a bracket: to rounding of the temperature

Power = Callable[[IntArray, FloatArray], FloatArray]  # W of (pairs,) cases at (pairs,) temperatures


@dataclass(frozen=True)
class Warming:
    """Stiffness and loss factor, or magnifier, linear between points over the temperature, and its rise by heat."""

    now: float  # degC of the surroundings, and of the coupling where its other figures hold
    highest: float  # degC, permissible
    rise: float  # K/W, of the heat made
    factor: tuple[tuple[float, float], ...]  # (degC, stiffness over that now)
    lost: tuple[
        tuple[float, float], ...
    ] = ()  # (degC, loss factor or magnifier); () for that of the coupling
    by_magnifier: bool = False  # it is the magnifier that is linear between the points

    def loss_factor(self, temperature: FloatArray) -> FloatArray:
        """Return the loss factor at temperatures (degC)."""
        values = _linear(self.lost, temperature)
        return 1.0 / values if self.by_magnifier else values

    def complex_stiffness(self, stiffness: ComplexArray, temperature: FloatArray) -> ComplexArray:
        """Of stiffness now, k (1 + i eta) + i w c in N m/rad; the viscous part stays as it is where eta is given."""
        factor = _linear(self.factor, temperature)
        if not self.lost:
            return np.asarray(stiffness * factor)
        k = stiffness.real * factor
        viscous_part = stiffness.imag - stiffness.real * self.loss_factor(np.array(self.now))
        return np.asarray(k * (1.0 + 1j * self.loss_factor(temperature)) + 1j * viscous_part)


def _linear(rows: tuple[tuple[float, float], ...], x: FloatArray) -> FloatArray:
    points, values = zip(*rows, strict=True)
    return np.asarray(np.interp(x, points, values))


def equilibria(warming: Warming, power: Power, cases: int) -> tuple[IntArray, FloatArray]:
    """Case and temperature (degC) of every root of now + rise * power - temperature, up to the highest permissible.

    They are sought between SCANNED temperatures, evenly spaced, and found by halving. From the surroundings up the
    first is stable, the second is not, and so on in turn.
    """
    grid = np.linspace(warming.now, warming.highest, SCANNED)

    def excess(case: IntArray, temperature: FloatArray) -> FloatArray:
        return warming.now + warming.rise * power(case, temperature) - temperature

    case, position = (index.ravel() for index in np.indices((cases, SCANNED)))
    above = (excess(case, grid[position]) > 0.0).reshape(cases, SCANNED)
    cold = np.flatnonzero(~above[:, 0])  # nothing is made: it stays as cold as it is
    above[cold, 0] = True
    row, left = np.nonzero(above[:, 1:] != above[:, :-1])
    low, high, rising = grid[left], grid[left + 1], ~above[row, left]
    for _ in range(HALVINGS if row.size else 0):
        middle = 0.5 * (low + high)
        is_before = (excess(row, middle) > 0.0) != rising
        low, high = np.where(is_before, middle, low), np.where(is_before, high, middle)
    return row, 0.5 * (low + high)
