"""A viscous, rubber or tuned damper: a housing on the train and a ring that it carries."""

import math

from torsion import fields
from torsion.components.component import Component
from torsion.components.coupling_limits import MISFIRE, MisfireLimit, PowerLimit, heat_ratings
from torsion.components.elastic_element import MAGNIFIER, PSI, Magnifier, Psi, given_damping, loss_factor
from torsion.components.lowering import CouplingRatings, Lowering
from torsion.fields import given, refuse, required
from torsion.primitives import Spring

BY_HYSTERESIS = ("loss_factor", "psi", "magnifier")


class RingDamper(Component, keyword="damper", sort="point"):
    """A torsional vibration damper."""

    housing: fields.Inertia = required("inertia of the housing, fixed to the train")
    ring: fields.Inertia = required("inertia of the ring")
    damping: fields.Damping | None = given("viscous damping between ring and housing")
    stiffness: fields.Stiffness | None = given("stiffness between ring and housing; none in a viscous damper")
    loss_factor: fields.LossFactor | None = given("loss factor eta of that stiffness, of rubber: k (1 + i eta)")
    psi: Psi | None = given(PSI)
    magnifier: Magnifier | None = given(MAGNIFIER)
    heat_limit: PowerLimit | None = given("permissible power loss of the maker; over frequency rows [frequency, power]")
    heat_limit_misfire: MisfireLimit | None = given(MISFIRE)

    def refuse_clashes(self) -> None:
        lost = given_damping(self, BY_HYSTERESIS)
        if lost and self.stiffness is None:
            raise refuse(f"`{lost[0]}` is of a stiffness, and there is none", "give `stiffness`", lost[0])
        if lost is None and self.damping is None:
            hint = "give `damping` of oil or silicone, or `stiffness` and `loss_factor` of rubber"
            raise refuse("nothing takes energy out: `damping` is missing", hint)
        heat_ratings(self.heat_limit, self.heat_limit_misfire)

    def lower(self, build: Lowering) -> None:
        lost = given_damping(self, BY_HYSTERESIS)
        viscous = ("damping", self.damping) if self.damping is not None else None
        ratings = CouplingRatings(**heat_ratings(self.heat_limit, self.heat_limit_misfire))
        build.record(damping=lost or viscous, ratings=ratings)
        here = build.point()
        ring = build.station(f"{build.name} ring")
        build.inertia(here, self.housing, "housing")
        build.inertia(ring, self.ring, "ring")
        flexibility = math.inf if self.stiffness is None else 1.0 / build.own(self.stiffness)
        damping = build.own(self.damping or 0.0)
        build.add(Spring(f"{build.name} ring", build.part, here, ring, flexibility, damping, loss_factor(lost)))
