"""A disc: a point with an inertia, or a fixed end."""

import math

from torsion import fields
from torsion.fields import given
from torsion.model.component import Lowering, Rotor
from torsion.primitives import Damper, Spring


class Disc(Rotor, keyword="disc"):
    """A disc is a rigid inertia at one point of the train."""

    title = "flywheel, flange, wheel or other lumped inertia"
    example = "- disc: {name: flywheel, inertia: 2.075 kg*m**2, source: drawing}"

    damping: fields.Damping | None = given(
        "viscous damping to ground of the deviation from the mean motion"
    )
    stiffness: fields.GroundStiffness | None = given("stiffness to ground")

    def lower(self, build: Lowering) -> None:
        station = self.lower_rotor(build)
        if self.damping:
            build.add(Damper(station, constant=build.to_own_speed(self.damping)))
        if self.stiffness:
            ground = build.station(f"{build.name} ground", is_ground=True)
            build.inertia(ground, math.inf)
            name = f"{build.name} to ground"
            build.add(
                Spring(name, build.part, station, ground, 1.0 / build.to_own_speed(self.stiffness))
            )
