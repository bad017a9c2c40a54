"""Harmonics of the gas torque of a cylinder: by quadrature over the pieces of its pressure, exact to rounding.

T(angle) = -(p - p_around) A x'(angle) with the crank angle from firing top dead centre, over a cycle of 720 or 360
degrees. Harmonics C_k = a_k - i b_k: T = C_0 + Re sum C_k exp(i k angle/revolutions), amplitude |C|, phase arg C.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import Literal

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


def panels(
    corners: FloatArray, widest: float = WIDEST
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Edges (panels + 1,) rad, Gauss' points and weights (panels, NODES) rad, of pieces no wider than `widest` (rad).

    corners: rad, ascending, beyond which nothing is smooth.
    """
    pieces = [
        np.linspace(low, high, max(math.ceil((high - low) / widest), 1) + 1)[:-1]
        for low, high in pairwise(corners.tolist())
    ]
    edges = np.append(np.concatenate(pieces), corners[-1])
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    half = np.diff(edges)[:, None] / 2.0
    return edges, (edges[:-1, None] + half) + half * nodes, half * weights


def harmonics(
    torque: Callable[[FloatArray], FloatArray], corners: FloatArray, revolutions: int, count: int
) -> ComplexArray:
    """(count + 1,) harmonics of a torque over a cycle: of four strokes number k is of order k/2, of two of order k.

    corners: rad, from end to end of the cycle, between which the torque is smooth.
    """
    _, points, weight = panels(corners)
    angle, weighted = points.ravel(), (torque(points) * weight).ravel()
    harmonics, number = np.zeros(count + 1, dtype=complex), np.arange(count + 1)
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
        first = self.angle[0]
        back = np.interp((-self.angle - first) % period + first, self.angle, self.pressure)
        expands = (turned > 0) & (turned < bottom)
        return Diagram(
            self.angle, np.where(expands, np.minimum(self.pressure, back), self.pressure)
        )

    def torque(self, cylinder: Cylinder, count: int, around: float = 0.0) -> ComplexArray:
        """(count + 1,) N m: harmonics of its gas torque; around: Pa under the piston."""
        return harmonics(
            lambda angle: (
                (np.interp(angle, self.angle, self.pressure) - around) * cylinder.lever(angle)
            ),
            self.angle,
            cylinder.revolutions,
            count,
        )


State = Literal["firing", "motored", "cut out"]
SAME = 1e-9  # relative: a load or speed that lies outside by less was written in another unit


@dataclass(frozen=True, eq=False)
class GasLaw:
    """Harmonics 0, 1, .. of the gas torque of a cylinder at some loads or speeds, straight (complex) between them."""

    over: Literal["load", "speed", "nothing"]
    at: FloatArray  # (points,) rising: N m mean gas torque of the cylinder, or rad/s of its own shaft
    firing: ComplexArray  # (points, harmonics) N m
    motored: ComplexArray | None = None  # (points or 1, harmonics) N m; None where it is not known
    goes_on: bool = False  # in a straight line beyond its ends
    # N m mean gas torque at which it stands where the load is not known.
    stated: float | None = None

    def covers(self, values: FloatArray) -> bool:
        """Whether it is known at loads or speeds."""
        if self.goes_on or self.over == "nothing" or not values.size:
            return True
        slack = SAME * abs(float(self.at[-1]))
        return bool(values.min() >= self.at[0] - slack and values.max() <= self.at[-1] + slack)

    def harmonic(
        self,
        number: int,
        load: FloatArray | None,
        speed: FloatArray,
        *,
        state: State = "firing",
        share: float = 1.0,
    ) -> ComplexArray:
        """(speeds,) N m of harmonic `number` at mean gas torques (speeds,) N m and speeds (speeds,) rad/s.

        share: heat of this cylinder / that of the others; motored and cut out it has none.
        """
        if state == "cut out":
            return np.zeros(len(speed), dtype=complex)
        where = speed if self.over == "speed" else load
        if where is None:
            where = np.full(len(speed), self.at[-1] if self.stated is None else self.stated)
        if state == "firing" and share == 1.0:
            return self._along(self.firing, number, where)
        motored = None if self.motored is None else self._along(self.motored, number, where)
        if state == "motored":
            if motored is None:
                raise ValueError("the motored harmonics are not known")
            return motored
        none = 0.0 if motored is None else motored
        return none + share * (self._along(self.firing, number, where) - none)

    def _along(self, values: ComplexArray, number: int, where: FloatArray) -> ComplexArray:
        """(places,) one harmonic of values (points or 1, harmonics), straight between the points."""
        harmonic = values[:, number]
        if len(harmonic) == 1 or self.over == "nothing":
            return np.full(len(where), harmonic[-1])
        inside = np.interp(where, self.at, harmonic)
        if self.goes_on:
            for beyond, edge, two in ((where < self.at[0], 0, 1), (where > self.at[-1], -1, -2)):
                if not beyond.any():
                    continue
                slope = (harmonic[two] - harmonic[edge]) / (self.at[two] - self.at[edge])
                inside = np.where(beyond, harmonic[edge] + slope * (where - self.at[edge]), inside)
        return np.asarray(inside, dtype=complex)


@dataclass(frozen=True, eq=False)
class CylinderOrder:
    """One harmonic of the torque of one cylinder: of its gas and of its moving masses."""

    gas: GasLaw | None
    number: int
    inertia: complex  # N m s2: times the square of its own speed
    turned: complex  # exp(-i n firing angle)
    station: int  # whose mean torque says the load
    load: float  # mean gas torque of a firing cylinder / that mean torque
    state: State = "firing"
    share: float = 1.0
    engine: int = -1  # position of its engine in the train
    by_chance: bool = False  # the phase of that is any: magnitudes are added to those of all else

    def amplitude(self, speed: FloatArray, mean: FloatArray | None) -> ComplexArray:
        """(speeds,) N m at own speeds (rad/s) and mean torques applied at `station` (N m; None: not known)."""
        torque: ComplexArray = np.asarray(self.inertia * speed**2)
        if self.gas is not None:
            load = None if mean is None else self.load * mean
            torque = torque + self.gas.harmonic(
                self.number, load, speed, state=self.state, share=self.share
            )
        return self.turned * torque
