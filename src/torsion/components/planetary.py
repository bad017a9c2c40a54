"""A planetary stage with one member fixed: its exact ratio, what its planets weigh, and how its meshes yield."""

from fractions import Fraction
from functools import cached_property
from typing import Annotated, Literal

from pydantic import Field

from torsion import fields
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required

Member = Literal["sun", "ring", "carrier"]
Teeth = Annotated[int, Field(ge=1, le=100_000)]
Radius = Annotated[float, Quantity("m", above=0, usual=(None, 10.0), slip=("mm",))]
PROFILE_SHIFT = 2, 0.1  # teeth, and share of the teeth that fit, by which profile shift may change those of a planet
Mass = Annotated[float, Quantity("kg", at_least=0)]


class Planetary(Declared):
    """A planetary stage: sun and ring on planets that a carrier holds, one of the three fixed.

    Of speeds and torques (Willis 1841), with i = the ring's teeth over the sun's, of stepped planets times those with
    the sun over those with the ring:
        w_sun + i w_ring = (1 + i) w_carrier ,   T_sun : T_ring : T_carrier = 1 : i : -(1 + i)
    """

    sun: Teeth = required("teeth of the sun")
    ring: Teeth = required("teeth of the ring")
    fixed: Member = given("the member that stands still", "ring")
    driving: Member = given("the member at the end before it", "sun")
    planets: Annotated[int, Field(ge=1, le=100)] = given("how many planets", 3)
    planet: Annotated[tuple[Teeth, ...], OneOrMany] = given(
        "teeth of a planet, of a stepped one [with the sun, with the ring] (default: (ring - sun)/2)", ()
    )
    sun_inertia: fields.Inertia = given("of the sun", 0.0)
    ring_inertia: fields.Inertia = given("of the ring", 0.0)
    carrier_inertia: fields.Inertia = given("of the carrier, without the planets", 0.0)
    planet_inertia: fields.Inertia = given("of one planet about its own axis", 0.0)
    planet_mass: Mass = given("of one planet", 0.0)
    radius: Radius | None = given("of the circle of the planets' axes, for their mass")
    sun_mesh: fields.Stiffness | None = given("of the sun's meshes together, torsional at the sun (default: rigid)")
    ring_mesh: fields.Stiffness | None = given("of the ring's meshes together, torsional at the ring (default: rigid)")

    def refuse_clashes(self) -> None:
        if self.fixed == self.driving:
            raise refuse(
                f"the {self.fixed} is fixed and cannot drive", "choose another `driving` or `fixed`", "driving"
            )
        if len(self.planet) > 2:
            raise refuse("a planet has one number of teeth, or [with the sun, with the ring]", key="planet")
        if self.ring <= self.sun and len(self.planet) < 2:
            raise refuse(f"a ring of {self.ring} teeth has no room for a sun of {self.sun}", key="ring")
        if not self.planet and (self.ring - self.sun) % 2:
            hint = f"ring - sun = {self.ring - self.sun} is odd: give `planet`"
            raise refuse("the teeth of the planets do not follow", hint, "ring")
        between = (self.ring - self.sun) / 2.0
        if len(self.planet) == 1 and abs(self.planet[0] - between) > max(PROFILE_SHIFT[0], PROFILE_SHIFT[1] * between):
            hint = f"near (ring - sun)/2 = {between:g}; of a stepped planet [with the sun, with the ring]"
            raise refuse(f"a planet of {self.planet[0]} teeth does not fit between sun and ring", hint, "planet")
        if self.planet_mass and self.radius is None:
            raise refuse("`planet_mass` moves on a circle whose `radius` is missing", "give `radius`", "planet_mass")

    @property
    def driven(self) -> Member:
        """The member at the end behind it."""
        return next(one for one in ("sun", "ring", "carrier") if one not in (self.fixed, self.driving))

    @cached_property
    def teeth(self) -> tuple[Fraction, Fraction]:
        """Teeth of a planet with the sun and with the ring; of a plain one both are the same."""
        if not self.planet:
            return (Fraction(self.ring - self.sun, 2),) * 2
        return Fraction(self.planet[0]), Fraction(self.planet[-1])

    @property
    def weights(self) -> dict[str, Fraction]:
        """The torques of the members over that of the sun: their speeds, each times this, add up to 0."""
        with_sun, with_ring = self.teeth
        inner = with_sun * self.ring / (with_ring * self.sun)
        return {"sun": Fraction(1), "ring": inner, "carrier": -1 - inner}

    @property
    def speed(self) -> Fraction:
        """Speed of the driven over the driving member, negative where it turns the other way."""
        return -self.weights[self.driving] / self.weights[self.driven]

    @property
    def flexibility(self) -> float:
        """Of the meshes in series (rad/(N m)), at the driving member; planets taken as without inertia there."""
        weights, yields = self.weights, 0.0
        for member, stiffness in (("sun", self.sun_mesh), ("ring", self.ring_mesh)):
            if stiffness is not None:
                yields += float(weights[member] / weights[self.driving]) ** 2 / stiffness
        return yields

    @property
    def halves(self) -> tuple[float, float]:
        """Inertias (kg m2) at the driving and the driven member, the planets at the carrier, else at the driven."""
        own = {"sun": self.sun_inertia, "ring": self.ring_inertia, "carrier": self.carrier_inertia}
        speeds = {self.driving: Fraction(1), self.driven: self.speed, self.fixed: Fraction(0)}
        place = self.driven if self.fixed == "carrier" else "carrier"
        spin = speeds["carrier"] - Fraction(self.sun) / self.teeth[0] * (speeds["sun"] - speeds["carrier"])
        own[place] += self.planets * (
            self.planet_inertia * float(spin / speeds[place]) ** 2
            + self.planet_mass * ((self.radius or 0.0) * float(speeds["carrier"] / speeds[place])) ** 2
        )
        return own[self.driving], own[self.driven]
