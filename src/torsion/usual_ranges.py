"""The usual range of every quantity of an input file, in one table: a value outside is a slip, or said to be meant.

A range is wider than all that is built. A quantity names its row; one that names none has that of its unit.
"""

import math
from dataclasses import dataclass

from torsion import units

WIDEST = 3.0  # m; the shafts of the largest water turbines
SMALLEST, LARGEST = (
    1e-60,
    1e60,
)  # in SI, of any number but 0: squares and cubes of these are numbers too


@dataclass(frozen=True)
class UsualRange:
    """From `low` to `high` in SI; of the size alone, whatever the sign, where `low` is above 0; 0 is never unusual.

    The units of `slip` are those that a writer may have had in mind; `below` and `above` name another quantity that a
    value beyond that end may have been meant for.
    """

    low: float = -math.inf
    high: float = math.inf
    slip: tuple[str, ...] = ()
    below: str = ""
    above: str = ""

    def holds(self, number: float) -> bool:
        """The number (SI) is usual."""
        return number == 0 or self.low <= self._size(number) <= self.high

    def likely(self, number: float, unit: str) -> str:
        """What a number may have been meant for: the first unit of `slip` that makes it usual, or another quantity."""
        for meant in self.slip:
            value = number * units.to_si(f"1 {meant}", unit)
            if value and self.holds(value):
                return meant
        return ""

    def other_quantity(self, number: float) -> str:
        """The quantity that a number (SI) beyond an end may have been meant for; empty where none is known."""
        return self.below if self._size(number) < self.low else self.above

    @property
    def ends(self) -> list[float | None]:
        """Both ends; None where the range is open."""
        return [end if math.isfinite(end) else None for end in (self.low, self.high)]

    def words(self, size: float = 1.0) -> str:
        """The range in words, in a unit of that size."""
        low, high = self.low / size, self.high / size
        if math.isinf(low):
            return f"at most {high:.5g}"
        return f"at least {low:.5g}" if math.isinf(high) else f"{low:.5g} to {high:.5g}"

    def _size(self, number: float) -> float:
        return abs(number) if self.low > 0.0 else number


_MODULI = ("GPa", "MPa", "kPa", "Pa")
_DENSITIES = ("g/cm**3", "kg/mm**3", "t/mm**3", "g/m**3")

USUAL = {
    # By unit: of a quantity without a row of its own.
    "1": UsualRange(1e-12, 1e12),
    "rad": UsualRange(1e-9, 1e3),
    "rad/s": UsualRange(1e-6, 1e9),
    "rad/s**2": UsualRange(1e-9, 1e12),
    "Hz": UsualRange(1e-6, 1e7, ("Hz", "kHz")),
    "s": UsualRange(1e-18, 1e5, ("s", "ms")),
    "K": UsualRange(1e-6, 1e6),
    "degC": UsualRange(-60.0, 250.0),
    "N*m/rad": UsualRange(1e-3, 1e18, below="a flexibility"),
    "rad/(N*m)": UsualRange(1e-18, 1e3, above="a stiffness"),
    "N*m*s/rad": UsualRange(1e-12, 1e12),
    "kg*m**2": UsualRange(1e-11, 1e10, ("kg*mm**2", "kg*cm**2")),
    "kg": UsualRange(1e-9, 1e9, ("g",)),
    "N*m": UsualRange(1e-30, 1e10),
    "W": UsualRange(1e-6, 5e9, ("kW", "W")),
    "m": UsualRange(1e-7, 20e3, ("m", "mm")),
    "m**2": UsualRange(1e-12, 1e4, ("mm**2",)),
    "m**3": UsualRange(1e-15, 1e6, ("mm**3",)),
    "m/s": UsualRange(1e-6, 1e4, ("mm/s",)),
    "m**2/s": UsualRange(1e-4, 10.0, ("cSt", "St")),
    "N/m": UsualRange(1e-9, 1e15, ("N/mm",)),
    "N*s/m": UsualRange(1e-6, 1e12, ("N*s/mm",)),
    "Pa": UsualRange(1e-3, 1e13, _MODULI),
    "rating": UsualRange(1e-9, 1e10, ("kN*m",)),
    # Lengths
    "length of a shaft": UsualRange(1e-6, 20e3, ("m", "mm")),
    "diameter of a shaft": UsualRange(1e-5, WIDEST, ("mm", "m")),
    "detail of a shaft": UsualRange(1e-6, 1.0, ("mm",)),
    "length of a detail": UsualRange(1e-6, 20.0, ("m", "mm")),
    "size of a gear": UsualRange(1e-5, 10.0, ("mm",)),
    "module": UsualRange(1e-6, 0.2, ("mm",)),
    "error of a gear": UsualRange(1e-10, 2e-3, ("um",)),
    "size of an engine": UsualRange(1e-4, 10.0, ("mm",)),
    "offset of a crank": UsualRange(-1.0, 1.0, ("mm",)),
    "piston rod": UsualRange(1e-4, 1.0, ("mm",)),
    "length of a pendulum": UsualRange(1e-5, WIDEST, ("mm",)),
    "distance of bearings": UsualRange(1e-4, 100.0, ("mm",)),
    "diameter of a propeller": UsualRange(1e-3, 400.0, ("mm",)),
    "thickness of ice": UsualRange(1e-3, 10.0, ("mm", "cm")),
    # Angles
    "clearance": UsualRange(1e-8, 2.0 * math.tau),
    "crank angle of an event": UsualRange(math.radians(0.5), 2.0 * math.tau, ("deg",)),
    # Materials
    "modulus": UsualRange(1e9, 1e12, _MODULI),
    "strength": UsualRange(1e6, 1e10, _MODULI),
    "density": UsualRange(500.0, 25e3, _DENSITIES),
    # Stresses and pressures
    "pressure of a gas": UsualRange(5e3, 5e8, ("bar", "MPa")),
    "pressure of a fit": UsualRange(1e6, 1e9, ("MPa", "kPa")),
    "permissible stress": UsualRange(1e5, 1e9, ("MPa", "kPa")),
    "stress": UsualRange(1.0, 1e9, ("MPa", "kPa")),
    # Temperatures
    "temperature of silicone": UsualRange(0.0, 150.0),
    "rise of temperature": UsualRange(1e-3, 200.0, above="a temperature"),
    # Shares and factors
    "psi": UsualRange(-math.inf, 4.0 * math.pi, ("%",)),
    "loss factor": UsualRange(-math.inf, 2.0, ("%",)),
    "magnifier": UsualRange(0.5, below="a loss factor"),
    "damping ratio": UsualRange(-math.inf, 0.2, ("%",)),
    "tolerance": UsualRange(-math.inf, 1.0, ("%",)),
    "exponent of a load": UsualRange(-1.0, 4.0),
    "deviation of a law": UsualRange(-math.inf, 0.6, ("%",)),
    "deviation of a measurement": UsualRange(-math.inf, 0.5, ("%",)),
    "share of a value": UsualRange(0.005, 50.0, ("%",)),
    "factor of a case": UsualRange(0.01, 50.0, ("%",)),
    "share of the mean torque": UsualRange(-math.inf, 5.0, ("%",)),
    "factor of a stiffness": UsualRange(0.05, 3.0, ("%",)),
    "application factor": UsualRange(-math.inf, 10.0, ("%",)),
    "ratio of a propeller": UsualRange(1e-6, 5.0, ("%",)),
    "efficiency": UsualRange(0.5, 1.0, ("%",)),
    "share of a cylinder": UsualRange(0.5, 1.5, ("%",)),
    "compression ratio": UsualRange(3.0, 40.0),
    "ratio of heats": UsualRange(1.2, 1.67),
    "shape of a heat release": UsualRange(0.1, 5.0),
    "friction": UsualRange(0.05, 0.4, ("%",)),
    "safety": UsualRange(-math.inf, 5.0),
    "fluctuation": UsualRange(-math.inf, 2.0, above="degrees"),
    "limit of tooth separation": UsualRange(-math.inf, 5.0, ("%",)),
    "coefficient of a short circuit": UsualRange(1e-6, 100.0, ("%",)),
    # Of whole shafts
    "length over diameter": UsualRange(1e-5, 5e4),
    "entrained water over inertia": UsualRange(1e-6, 5.0),
}
