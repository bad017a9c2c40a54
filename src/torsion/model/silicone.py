"""Silicone between ring and housing of a damper: a storage and a loss modulus by frequency and temperature."""

import math
from typing import Annotated

from torsion.fields import Declared, Quantity, excludes, given, refuse, required
from torsion.kernels.power_law import PowerLaw, power_law

KELVIN = 273.0  # K of 0 degC as the law was fitted, not 273.15
REACH = (1e-3, 1e6)  # Hz between which the law is taken; far beyond what was measured
PRINTED = (10.0, 20.0, 50.0, 100.0, 200.0, 400.0)  # Hz
STATED = (55.0, 115.0)  # degC between which the source of the known coefficients prints figures
Viscosity = Annotated[float, Quantity("m**2/s", above=0)]
Shape = Annotated[float, Quantity("m**3", above=0)]
SiliconeTemperature = Annotated[
    float, Quantity("degC", at_least=-60.0, usual="temperature of silicone")
]
Number = Annotated[float, Quantity("1")]


class ModulusLaw(Declared):
    """G = factor exp(activation/T) f^(power - power_slope/T), Pa; f in Hz, T = temperature in degC + 273."""

    factor: Annotated[float, Quantity("Pa", above=0)] = required("of the modulus")
    activation: Annotated[float, Quantity("K")] = required("by which it falls with the temperature")
    power: Number = required("of the frequency in Hz, of an endless temperature")
    power_slope: Annotated[float, Quantity("K")] = required("by which that power falls with 1/T")

    def modulus_at(self, temperature: float) -> tuple[float, float]:
        """Pa at 1 Hz and the power of the frequency at a temperature (K)."""
        return self.factor * math.exp(
            self.activation / temperature
        ), self.power - self.power_slope / temperature


def _law(factor: float, activation: float, power: float, power_slope: float) -> ModulusLaw:
    return ModulusLaw(factor=factor, activation=activation, power=power, power_slope=power_slope)


KNOWN = {
    0.15: (_law(21e-4, 3791.0, 2.35, 504.0), _law(1.01, 2353.0, 1.50, 321.0))
}  # m2/s: Navitorq, manual


class Silicone(Declared):
    """Silicone; coefficients of 0.15 m2/s (150 000 cSt) are known, those of others are the maker's."""

    clashes = (excludes("viscosity", "storage", "loss"),)

    shape: Shape = required(
        "sum over all gaps of the integral of r^2 dA/gap: stiffness = shape * storage modulus"
    )
    temperature: SiliconeTemperature = required("of the silicone, all over")
    viscosity: Viscosity | None = given(
        "nominal kinematic viscosity, whose coefficients are known: 0.15 m2/s"
    )
    storage: ModulusLaw | None = given(
        "storage modulus, a law of the maker in place of `viscosity`"
    )
    loss: ModulusLaw | None = given("loss modulus, with the keys of `storage`")

    def refuse_clashes(self) -> None:
        if self.viscosity is None and None in (self.storage, self.loss):
            hint = "give `viscosity: 0.15 m**2/s`, whose coefficients are known, or `storage` and `loss`"
            raise refuse("the moduli of the silicone are not given", hint)
        if self.viscosity is not None and not any(
            math.isclose(self.viscosity, viscosity) for viscosity in KNOWN
        ):
            message = f"the coefficients of {self.viscosity:g} m2/s are not known"
            raise refuse(
                message,
                "an oil of 0.15 m2/s is; for another oil give `storage` and `loss` of the manufacturer",
                "viscosity",
            )

    def lowered(self, scale: float) -> PowerLaw:
        """Stiffness and damping at the damper's own speed; scale: as of `Arrival`, by which both are divided.

        k = S G' and c = S G''/w, of the moduli at the temperature.

        >>> law = Silicone(viscosity=0.15, shape=5.0, temperature=75.0).lowered(1.0)
        >>> k, _, c = law.values(200.0 * math.pi)
        >>> f"{k:.7g} {c:.7g}"
        '35950.25 99.25755'
        """
        laws = next(iter(KNOWN.values()))
        storage, loss = self.storage or laws[0], self.loss or laws[1]
        (g1, p), (g2, q) = (law.modulus_at(self.temperature + KELVIN) for law in (storage, loss))
        of_hertz = 2.0 * math.pi
        k, c = self.shape / scale * g1, self.shape / scale * g2 / of_hertz
        silicone = "silicone" if self.viscosity is None else f"silicone of {self.viscosity:g} m²/s"
        words = f"{silicone} at {self.temperature:g} °C, shape {self.shape:g} m³; "
        if self.viscosity is not None and not STATED[0] <= self.temperature <= STATED[1]:
            words += (
                f"outside the {STATED[0]:g} to {STATED[1]:g} °C that the source of its law covers; "
            )
        words += (
            f"k = {k:.6g} f^({p:.6g}) N m/rad, c = {c:.6g} f^({q - 1.0:.6g}) N m s/rad, f in Hz"
        )
        return power_law(
            "frequency",
            (REACH[0] * of_hertz, REACH[1] * of_hertz),
            (k / of_hertz**p, p),
            (c / of_hertz ** (q - 1.0), q - 1.0),
            key="silicone",
            printed=tuple(frequency * of_hertz for frequency in PRINTED),
            words=words,
        )
