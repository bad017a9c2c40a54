"""Loads and machines that drive, as the balance of power holds them: shares, laws, torques over speed.

Shares are exact fractions of a load's torque, referred to the reference speed.
"""

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property

import numpy as np

from torsion.analyses.speed_tables import interpolated, uncovered
from torsion.arrays import FloatArray
from torsion.errors import Fault, Path
from torsion.model.machine_torques import LoadLaw
from torsion.model.parts import Part

Shares = list[Fraction]
Shared = list[tuple[int, Fraction]]  # stations with their shares of a torque
OF_OPERATION = ("operation", "load")


@dataclass(frozen=True)
class Load:
    """The torque that a load, or several loads alike in equal parts, take from the train."""

    parts: tuple[Part, ...]  # empty: a station of the train absorbs
    stations: Shared
    law: LoadLaw  # a table is in speeds and torques of the reference
    torque: float = 0.0  # N m at the reference, at `speed`; of a table nothing
    speed: float = 1.0  # rad/s of the reference
    path: Path = OF_OPERATION
    is_free: bool = False  # it takes what is left

    def torque_at(self, speed: FloatArray) -> FloatArray:
        """Return the torque (speeds,) N m at the reference; raises InputError where a table ends before."""
        if self.law.table:
            return interpolated(self.law.table, speed, self._table).copy()
        return self.law.torque(speed, self.speed, self.torque)

    def faults(self, speed: FloatArray) -> list[Fault]:
        """Return the fault of a table of load that does not cover the speeds (rad/s)."""
        return uncovered(self.law.table, speed, self._table) if self.law.table else []

    @property
    def _table(self) -> Fault:
        whose = f" of '{self.parts[0].name}'" if self.path != OF_OPERATION else ""
        return Fault(self.path, f"the table of the load{whose}")


@dataclass(frozen=True)
class Driver:
    """A machine, or a station of the train, at which power enters."""

    part: Part | None
    stations: Shared  # with their shares of the torque of all loads when all cylinders fire
    is_free: bool


@dataclass(frozen=True)
class Balance:
    """All loads, and how those that drive share them."""

    loads: tuple[Load, ...]
    drivers: tuple[Driver, ...]
    stations: int
    sentence: str  # who drives and who absorbs

    @cached_property
    def delivered(self) -> Fraction:
        """Share of the loads that enters; cylinders that do not fire lack, and every load falls with them."""
        return sum((share for driver in self.drivers for _, share in driver.stations), Fraction(0))

    def shares(self, load: Load) -> Shares:
        """Return the shares (stations,) of the torque of one load: positive where it enters, negative where it leaves."""
        shares = [Fraction(0)] * self.stations
        for driver in self.drivers:
            for station, share in driver.stations:
                shares[station] += share
        for station, share in load.stations:
            shares[station] -= share * self.delivered
        return shares

    def applied(self, station: int, speed: FloatArray) -> FloatArray:
        """Return the mean torque (speeds,) N m that enters at a station, referred to the reference speed."""
        first, *others = (
            load.torque_at(speed) * float(self.shares(load)[station]) for load in self.loads
        )
        return sum(others, start=first)

    def full_torque(self, speed: FloatArray) -> FloatArray:
        """Return the torque (speeds,) N m of all loads at the reference, when every cylinder fires."""
        return np.asarray(sum(load.torque_at(speed) for load in self.loads))

    @property
    def corners(self) -> list[float]:
        """Speeds (rad/s of the reference) at which a table of load bends."""
        return [speed for load in self.loads for speed, _ in load.law.table]

    @property
    def is_polynomial(self) -> bool:
        """Every torque is a polynomial of at most second order of the speed, between the corners of tables."""
        return all(load.law.table or load.law.exponent in (0.0, 1.0, 2.0) for load in self.loads)
