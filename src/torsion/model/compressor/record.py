"""What a compressor leaves on its part for analyses and reports."""

import cmath
from dataclasses import dataclass
from typing import Literal

from torsion.arrays import ComplexArray
from torsion.kernels.engine.gas_torque import Cylinder, Diagram

End = Literal["head end", "crank end"]


@dataclass(frozen=True, eq=False)
class EndRecord:
    """One working side of a piston."""

    end: End
    given: str  # file, or constant pressure
    is_file: bool
    cylinder: Cylinder  # with the area of this side
    diagram: Diagram  # absolute pressures over the crank angle from the dead centre of the head end
    clearance: (
        float | None
    )  # volume / swept volume at its dead centre; None where the file has no volumes
    torque: ComplexArray  # (orders + 1,) N m of its gas, positive where it drives


@dataclass(frozen=True, eq=False)
class ThrowRecord:
    """One throw with its cylinder."""

    number: int  # from 1
    station: int
    angle: float  # rad, crank angle of its dead centre of the head end
    ends: tuple[EndRecord, ...]
    gas: ComplexArray  # (orders + 1,) N m, from its dead centre; of order 0 the mean torque, negative where absorbed
    inertia: ComplexArray  # (orders + 1,) N m s2: of the moving masses / speed^2
    inertia_over_angle: ComplexArray  # (harmonics of a revolution,) kg m2

    def phasor(self, order: int) -> complex:
        """Return exp(-i order angle), the phase of an order of this throw against the first."""
        return cmath.exp(-1j * order * self.angle)


@dataclass(frozen=True, eq=False)
class CompressorRecord:
    """A compressor as placed in the train."""

    part: int
    throws: tuple[ThrowRecord, ...]
    efficiency: float  # mechanical

    @property
    def files(self) -> tuple[str, ...]:
        """Names of its files of pressures, as the model file writes them."""
        return tuple(end.given for throw in self.throws for end in throw.ends if end.is_file)

    @property
    def absorbs(self) -> tuple[tuple[int, float], ...]:
        """Stations of the throws with the mean torque (N m) that each absorbs; equal ones where there is none."""
        absorbed = [(throw.station, -float(throw.gas[0].real)) for throw in self.throws]
        return tuple(
            absorbed
            if any(torque for _, torque in absorbed)
            else [(station, 1.0) for station, _ in absorbed]
        )
