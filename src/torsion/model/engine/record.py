"""What an engine leaves on its part for analyses and reports."""

import cmath
import math
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.engine.gas_torque import Cylinder, GasLaw, State


@dataclass(frozen=True, eq=False)
class PressureCurve:
    """Pressures over a cycle, as given or computed."""

    name: str  # of the file, or of the cycle
    angle: FloatArray  # (points,) rad from firing top dead centre
    pressure: FloatArray  # (points,) Pa, absolute
    motored: FloatArray  # (points,) Pa
    imep: float  # Pa, found
    stated: float | None  # Pa, as the file says it
    around: float  # Pa, under the piston
    is_file: bool = False  # else a cycle


@dataclass(frozen=True)
class CylinderRecord:
    """A cylinder with its place, its firing angle and its share of the heat."""

    number: int  # as the file counts, from 1
    station: int
    throw: int  # position of its throw
    cycle: Fraction  # at which it fires, of a cycle, from the engine's own angle zero
    phase: float  # rad, of the engine against the reference
    revolutions: int  # of a cycle
    state: State
    share: float  # of the heat, imbalance and raised power included

    def phasor(self, number: int) -> complex:
        """exp(-i n firing angle) of harmonic `number` of the cycle; what cancels in a whole engine cancels exactly."""
        return cmath.exp(
            -2j * math.pi * float(number * self.cycle % 1)
            - 1j * number / self.revolutions * self.phase
        )


@dataclass(frozen=True, eq=False)
class EngineRecord:
    """An engine as placed in the train."""

    part: int  # its position in the train
    revolutions: int  # of a cycle
    cylinders: tuple[CylinderRecord, ...]
    throws: tuple[int, ...]  # stations, from the first end of the crankshaft
    cranks: tuple[int, ...]  # parts of the crank spans between them
    efficiency: float  # mechanical
    gas: GasLaw | None
    gas_words: str  # how it was given
    inertia: ComplexArray  # (harmonics,) N m s2: of moving masses / speed^2
    inertia_over_angle: ComplexArray  # (harmonics of a revolution,) kg m2, of one cylinder
    cylinder: Cylinder | None  # None without geometry
    curves: tuple[PressureCurve, ...]
    modulus: float | None  # m3, least of journal and pin
    keeps_power: bool
    has_phase: bool  # against the reference, by the file
    by_chance: bool  # that phase is any, and the worst is meant
    tries_all: bool  # every cylinder misfires in turn, and the worst is meant
    remarks: tuple[str, ...]
    sizes: tuple[
        tuple[str, float, tuple[str, ...]], ...
    ]  # of a throw: key of `iacs-m53`, m, keys of the engine

    @property
    def gas_orders(self) -> tuple[Fraction, ...]:
        """Orders of the crankshaft that the gas of a firing cylinder has, ascending."""
        if self.gas is None:
            return ()
        harmonics = np.flatnonzero((np.abs(self.gas.firing) > 0).any(axis=0)).tolist()
        return tuple(Fraction(harmonic, self.revolutions) for harmonic in harmonics if harmonic)

    @property
    def files(self) -> tuple[str, ...]:
        """Names of its indicator diagrams, as the model file writes them."""
        return tuple(curve.name for curve in self.curves if curve.is_file)

    @property
    def drives(self) -> tuple[tuple[int, float], ...]:
        """Stations with their shares of the mean torque of the engine when every cylinder fires alike."""
        number = len(self.cylinders)
        return tuple(
            (cylinder.station, cylinder.share / number)
            for cylinder in self.cylinders
            if cylinder.state == "firing" and cylinder.share > 0
        )

    @property
    def load_says(self) -> tuple[int, float]:
        """The station whose mean torque says the load, and the mean gas torque of a firing cylinder / that."""
        drives, number = dict[int, float](), len(self.cylinders)
        for station, share in self.drives:
            drives[station] = drives.get(station, 0.0) + share
        station, share = next(iter(drives.items()), (self.throws[0], 1.0 / number))
        return station, 1.0 / (number * share * self.efficiency)
