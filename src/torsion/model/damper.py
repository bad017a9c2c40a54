"""A viscous, silicone, rubber or tuned damper: a housing on the train and a ring that it carries."""

import math

from torsion import fields
from torsion.fields import excludes, exclusive, given, needs, refuse, required
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
from torsion.model.silicone import Silicone
from torsion.primitives import Spring, tabled_spring

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
