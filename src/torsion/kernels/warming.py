"""How a coupling softens as it warms, and the temperatures at which it gives off the heat that it makes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from torsion.arrays import ComplexArray, FloatArray, IntArray

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
        k = stiffness.real * _linear(self.factor, temperature)
        if not self.lost:
            return np.asarray(stiffness * _linear(self.factor, temperature))
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
