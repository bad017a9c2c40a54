"""A viscous, silicone, rubber or tuned damper: a housing on the train and a ring that it carries."""

import math

from torsion import fields
from torsion.fields import given, refuse, required
from torsion.model.component import Component
from torsion.model.coupling_limits import MISFIRE, MisfireLimit, PowerLimit, heat_ratings
from torsion.model.elastic_element import (
    MAGNIFIER,
    PSI,
    CouplingTable,
    Magnifier,
    Psi,
    given_damping,
    loss_factor,
)
from torsion.model.lowering import CouplingRatings, Lowering
from torsion.model.silicone import Silicone
from torsion.primitives import Spring, tabled_spring

BY_HYSTERESIS = ("loss_factor", "psi", "magnifier")
LAWS = ("table", "silicone")
AT = (
    2.0 * math.pi * 100.0
)  # rad/s at which a law's figures stand for it where no frequency is named


class RingDamper(Component, keyword="damper", sort="point"):
    """A torsional vibration damper."""

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
        laws = [key for key in LAWS if getattr(self, key) is not None]
        if laws:
            others = ("stiffness", "damping", *BY_HYSTERESIS, *laws[1:])
            beside = [key for key in others if getattr(self, key) is not None]
            if beside:
                hint = f"`{laws[0]}` gives stiffness and damping"
                raise refuse(f"`{laws[0]}` and `{beside[0]}` exclude each other", hint, beside[0])
            if self.table is not None and self.table.over != "frequency":
                raise refuse(
                    "a ring carries no mean torque", "give its table `over: frequency`", "table"
                )
        lost = given_damping(self, BY_HYSTERESIS)
        heat_ratings(self.heat_limit, self.heat_limit_misfire)
        if laws:
            return
        if lost and self.stiffness is None:
            raise refuse(
                f"`{lost[0]}` is of a stiffness, and there is none", "give `stiffness`", lost[0]
            )
        if lost is None and self.damping is None:
            hint = (
                "give `damping`, `silicone`, `stiffness` and `loss_factor` of rubber, or a `table`"
            )
            raise refuse("nothing takes energy out: `damping` is missing", hint)

    def lower(self, build: Lowering) -> None:
        lost = given_damping(self, BY_HYSTERESIS)
        viscous = ("damping", self.damping) if self.damping is not None else None
        ratings = CouplingRatings(**heat_ratings(self.heat_limit, self.heat_limit_misfire))
        build.record(damping=lost or viscous, ratings=ratings)
        here = build.point()
        ring = build.station(f"{build.name} ring")
        build.inertia(here, self.housing, "housing")
        build.inertia(ring, self.ring, "ring")
        name, law = f"{build.name} ring", self.silicone or self.table
        if law is not None:
            build.add(
                tabled_spring(name, build.part, (here, ring), law.lowered(build.at.scale), AT)
            )
            return
        flexibility = math.inf if self.stiffness is None else 1.0 / build.own(self.stiffness)
        damping = build.own(self.damping or 0.0)
        build.add(Spring(name, build.part, here, ring, flexibility, damping, loss_factor(lost)))
