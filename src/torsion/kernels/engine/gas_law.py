"""Harmonics of the torque of a cylinder over its load and speed, and what becomes of them when it misfires."""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from torsion.arrays import ComplexArray, FloatArray

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
            return np.zeros(len(speed), dtype=np.complex128)
        where = speed if self.over == "speed" else load
        if where is None:
            where = np.full(len(speed), self.at[-1] if self.stated is None else self.stated)
        motored = None if self.motored is None else self._along(self.motored, number, where)
        if state == "motored":
            if motored is None:
                raise ValueError("the motored harmonics are not known")
            return motored
        torque = self._along(self.firing, number, where)
        if share == 1.0:
            return torque
        none = 0.0 if motored is None else motored
        return none + share * (torque - none)

    def _along(self, values: ComplexArray, number: int, where: FloatArray) -> ComplexArray:
        """(places,) one harmonic of values (points or 1, harmonics), straight between the points."""
        harmonic = values[:, number]
        if len(harmonic) == 1 or self.over == "nothing":
            return np.full(len(where), harmonic[-1])
        inside = np.interp(where, self.at, harmonic)
        if self.goes_on:
            for beyond, edge, two in ((where < self.at[0], 0, 1), (where > self.at[-1], -1, -2)):
                slope = (harmonic[two] - harmonic[edge]) / (self.at[two] - self.at[edge])
                inside = np.where(beyond, harmonic[edge] + slope * (where - self.at[edge]), inside)
        return np.asarray(inside, dtype=np.complex128)


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
        return self.turned * (self.of_gas(speed, mean) + self.inertia * speed**2)

    def of_gas(self, speed: FloatArray, mean: FloatArray | None) -> ComplexArray:
        """(speeds,) N m of the gas alone, its phase from firing top dead centre of the cylinder."""
        if self.gas is None:
            return np.zeros(len(speed), dtype=np.complex128)
        load = None if mean is None else self.load * mean
        return self.gas.harmonic(self.number, load, speed, state=self.state, share=self.share)
