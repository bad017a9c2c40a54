"""A viscous, silicone, rubber or tuned damper: a housing on the train and a ring that it carries."""

import math
from typing import Annotated

from torsion import fields
from torsion.fields import Declared, Quantity, excludes, exclusive, given, needs, refuse, required
from torsion.kernels.stiffness_laws import PowerLaw, power_law
from torsion.model.component import Component, Lowering
from torsion.model.elastic_element import (
    HYSTERESES,
    MAGNIFIER,
    MISFIRE,
    PSI,
    CouplingTable,
    Magnifier,
    MisfireLimit,
    PowerLimit,
    Psi,
    given_damping,
    heat_ratings,
    loss_factor,
)
from torsion.model.parts import CouplingRatings, Symbol
from torsion.primitives import Spring, tabled_spring

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


KNOWN = {  # by m2/s: Navitorq, manual
    0.15: tuple(
        ModulusLaw(factor=factor, activation=activation, power=power, power_slope=power_slope)
        for factor, activation, power, power_slope in (
            (21e-4, 3791.0, 2.35, 504.0),
            (1.01, 2353.0, 1.50, 321.0),
        )
    )
}


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
        kelvin = self.temperature + KELVIN
        (g1, p), (g2, q) = (  # Pa at 1 Hz, and the power of the frequency
            (law.factor * math.exp(law.activation / kelvin), law.power - law.power_slope / kelvin)
            for law in (self.storage or laws[0], self.loss or laws[1])
        )
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


# rad/s at which the values of a law stand for it where no frequency is named
NOMINAL_FREQUENCY = 2.0 * math.pi * 100.0


class RingDamper(Component, keyword="damper", sort="point", symbol=Symbol("absorber")):
    """A damper is a housing with a ring, joined by damping and stiffness."""

    title = "viscous, silicone or spring damper"
    example = """\
- damper: {housing: 1.5, ring: 4, damping: 600 N*m*s/rad}
- damper: {housing: 1.5, ring: 4, silicone: {viscosity: 0.15 m**2/s, shape: 5 m**3, temperature: 75 degC}}"""

    clashes = (
        exclusive("table", "silicone"),
        *(
            excludes(law, "stiffness", "damping", *HYSTERESES, hint=f"`{law}` gives both")
            for law in ("table", "silicone")
        ),
        *(needs(key, "stiffness", hint="it is of a stiffness") for key in HYSTERESES),
    )

    housing: fields.Inertia = required("inertia of the housing, fixed to the train")
    ring: fields.Inertia = required("inertia of the ring")
    damping: fields.Damping | None = given("viscous damping between ring and housing")
    stiffness: fields.Stiffness | None = given(
        "stiffness between ring and housing; none in a viscous damper"
    )
    loss_factor: fields.LossFactor | None = given(
        "loss factor eta of that stiffness, of rubber: k (1 + i eta)"
    )
    psi: Psi | None = given(PSI)
    magnifier: Magnifier | None = given(MAGNIFIER)
    silicone: Silicone | None = given(
        "silicone whose stiffness and damping follow frequency and temperature"
    )
    table: CouplingTable | None = given(
        "stiffness and damping over frequency as the maker gives them (leaf springs)"
    )
    heat_limit: PowerLimit | None = given(
        "permissible power loss of the maker; over frequency rows [frequency, power]"
    )
    heat_limit_misfire: MisfireLimit | None = given(MISFIRE)

    def refuse_clashes(self) -> None:
        lost = given_damping(self, HYSTERESES)
        heat_ratings(self.heat_limit, self.heat_limit_misfire)
        if self.table is not None and self.table.over != "frequency":
            message = "a ring carries no mean torque"
            raise refuse(message, "give its table `over: frequency`", "table")
        if self.silicone is not None or self.table is not None:
            return
        if lost is None and self.damping is None:
            hint = (
                "give `damping`, `silicone`, `stiffness` and `loss_factor` of rubber, or a `table`"
            )
            raise refuse("nothing takes energy out: `damping` is missing", hint)

    def lower(self, build: Lowering) -> None:
        lost = given_damping(self, HYSTERESES)
        viscous = None if self.damping is None else ("damping", self.damping)
        ratings = CouplingRatings(**heat_ratings(self.heat_limit, self.heat_limit_misfire))
        build.record(ratings)
        build.place(damping=lost or viscous)
        name, law = f"{build.name} ring", self.silicone or self.table
        housing, ring = build.point(), build.station(name)
        build.inertia(housing, self.housing, "housing")
        build.inertia(ring, self.ring, "ring")
        if law is not None:
            table = law.lowered(build.arrival.scale)
            build.add(tabled_spring(name, build.part, (housing, ring), table, NOMINAL_FREQUENCY))
            return
        flexibility = (
            math.inf if self.stiffness is None else 1.0 / build.to_own_speed(self.stiffness)
        )
        damping = build.to_own_speed(self.damping or 0.0)
        build.add(Spring(name, build.part, housing, ring, flexibility, damping, loss_factor(lost)))
