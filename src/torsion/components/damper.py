"""A viscous or tuned damper: a housing on the train and a ring that it carries."""

import math

from torsion import fields
from torsion.components.component import Component
from torsion.components.lowering import Lowering
from torsion.fields import given, required
from torsion.primitives import Spring


class RingDamper(Component, keyword="damper", sort="point"):
    """A torsional vibration damper."""

    housing: fields.Inertia = required("inertia of the housing, fixed to the train")
    ring: fields.Inertia = required("inertia of the ring")
    damping: fields.Damping = required("viscous damping between ring and housing")
    stiffness: fields.Stiffness | None = given("stiffness between ring and housing; none in a viscous damper")

    def lower(self, build: Lowering) -> None:
        build.record(damping=("damping", self.damping))
        here = build.point()
        ring = build.station(f"{build.name} ring")
        build.inertia(here, self.housing, "housing")
        build.inertia(ring, self.ring, "ring")
        flexibility = math.inf if self.stiffness is None else 1.0 / build.own(self.stiffness)
        name = f"{build.name} ring"
        build.add(Spring(name, build.part, here, ring, flexibility, viscous=build.own(self.damping)))
