"""A disc: a point with an inertia, or a fixed end."""

import math

from torsion import fields
from torsion.fields import given, refuse
from torsion.model.component import Component, Lowering
from torsion.primitives import Damper, Spring


class Rotor(Component, sort="point"):
    """What every point with one inertia has: `inertia`, or `held: true`."""

    inertia: fields.Inertia | None = given("polar mass moment of inertia")
    held: bool = given("turns at exactly its mean speed: a fixed end", False)
    tolerance: fields.Tolerance | None = given("tolerance of the inertia, for example 5 %")

    def refuse_clashes(self) -> None:
        if self.held and self.inertia is not None:
            hint = "a fixed point needs no inertia"
            raise refuse("`inertia` and `held: true` exclude each other", hint, "inertia")
        if not self.held and self.inertia is None:
            raise refuse("`inertia` is missing", "give `inertia`, or `held: true` for a fixed end")
        if self.held and self.tolerance is not None:
            message = "a fixed point has no inertia that could vary"
            raise refuse(message, "leave it out", "tolerance")

    def lower_rotor(self, build: Lowering, what: str = "") -> int:
        """Add the station of this point with its inertia; `what` names the inertia where there is another one."""
        station = build.point()
        build.place(inertia_tolerance=self.tolerance)
        build.inertia(station, math.inf if self.held else self.inertia or 0.0, what)
        return station


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
