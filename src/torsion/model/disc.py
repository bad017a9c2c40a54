"""A disc: a point with an inertia, or a fixed end."""

import math

from torsion import fields
from torsion.fields import given, refuse
from torsion.model.component import Component
from torsion.model.lowering import Lowering
from torsion.primitives import Damper, Spring


class Rotor(Component, sort="point"):
    """What every point with one inertia has: `inertia`, or `held: true`."""

    inertia: fields.Inertia | None = given("polar mass moment of inertia")
    held: bool = given("turns at exactly its mean speed: a fixed end", False)
    tolerance: fields.Tolerance | None = given("tolerance of the inertia, for example 5 %")

    def refuse_clashes(self) -> None:
        if self.held and self.inertia is not None:
            raise refuse(
                "`inertia` and `held: true` exclude each other",
                "a fixed point needs no inertia",
                "inertia",
            )
        if not self.held and self.inertia is None:
            raise refuse("`inertia` is missing", "give `inertia`, or `held: true` for a fixed end")
        if self.held and self.tolerance is not None:
            raise refuse(
                "a fixed point has no inertia that could vary", "leave it out", "tolerance"
            )

    def place(self, build: Lowering, what: str = "") -> int:
        """The station of this point, with its inertia; `what` says what that is where there is another one."""
        here = build.point()
        build.record(inertia_tolerance=self.tolerance)
        build.inertia(here, math.inf if self.held else self.inertia or 0.0, what)
        return here


class Disc(Rotor, keyword="disc"):
    """A disc, flange, wheel or any other lumped inertia."""

    damping: fields.Damping | None = given(
        "viscous damping to ground of the deviation from the mean motion"
    )
    stiffness: fields.GroundStiffness | None = given("stiffness to ground")

    def lower(self, build: Lowering) -> None:
        here = self.place(build)
        if self.damping:
            build.add(Damper(here, constant=build.own(self.damping)))
        if self.stiffness:
            ground = build.station(f"{build.name} ground", is_ground=True)
            build.inertia(ground, math.inf)
            name = f"{build.name} to ground"
            build.add(Spring(name, build.part, here, ground, 1.0 / build.own(self.stiffness)))
