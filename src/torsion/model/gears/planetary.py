"""A planetary stage with one member fixed: its exact ratio, what its planets weigh, and how its meshes yield."""

import math
from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property
from typing import Annotated, Literal, get_args

from pydantic import Field

from torsion import fields
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.sources import source

Member = Literal["sun", "ring", "carrier"]
Teeth = Annotated[int, Field(ge=1, le=100_000)]
Radius = Annotated[float, Quantity("m", above=0, usual="size of a gear")]
# Teeth, and share of the teeth that fit, by which profile shift may change those of a planet.
PROFILE_SHIFT = 2, 0.1
ROUNDING = 2.0**-50  # relative, of the difference of two flexibilities of a few roundings each


@dataclass(frozen=True)
class Star:
    """Elastic meshes as a star of three flexibilities (rad/(N m) at the driving member) about a centre of no inertia.

    Its arms lead to the member of the `mesh`, to the other member that turns, and to the planets.
    """

    mesh: float
    other: float
    planets: float
    is_mesh_driving: bool  # the arm of the mesh leads to the driving member


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
        "teeth of a planet, of a stepped one [with the sun, with the ring] (default: (ring - sun)/2)",
        (),
    )
    sun_inertia: fields.Inertia = given("of the sun", 0.0)
    ring_inertia: fields.Inertia = given("of the ring", 0.0)
    carrier_inertia: fields.Inertia = given("of the carrier, without the planets", 0.0)
    planet_inertia: fields.Inertia = given("of one planet about its own axis", 0.0)
    planet_mass: fields.Mass = given("of one planet", 0.0)
    radius: Radius | None = given("of the circle of the planets' axes, for their mass")
    sun_mesh: fields.Stiffness | None = given(
        "of the sun's meshes together, torsional at the sun (default: rigid)"
    )
    ring_mesh: fields.Stiffness | None = given(
        "of the ring's meshes together, torsional at the ring (default: rigid)"
    )

    def refuse_clashes(self) -> None:
        if self.fixed == self.driving:
            message = f"the {self.fixed} is fixed and cannot drive"
            raise refuse(message, "choose another `driving` or `fixed`", "driving")
        if len(self.planet) > 2:
            message = "a planet has one number of teeth, or [with the sun, with the ring]"
            raise refuse(message, key="planet")
        if self.ring <= self.sun and len(self.planet) < 2:
            message = f"a ring of {self.ring} teeth has no room for a sun of {self.sun}"
            raise refuse(message, key="ring")
        if not self.planet and (self.ring - self.sun) % 2:
            hint = f"ring - sun = {self.ring - self.sun} is odd: give `planet`"
            raise refuse("the teeth of the planets do not follow", hint, "ring")
        between = (self.ring - self.sun) / 2.0
        shift = max(PROFILE_SHIFT[0], PROFILE_SHIFT[1] * between)
        if len(self.planet) == 1 and abs(self.planet[0] - between) > shift:
            message = f"a planet of {self.planet[0]} teeth does not fit between sun and ring"
            hint = f"near (ring - sun)/2 = {between:g}; of a stepped planet [with the sun, with the ring]"
            raise refuse(message, hint, "planet")
        if self.planet and self.planet[-1] >= self.ring:
            message = f"a planet of {self.planet[-1]} teeth does not turn in a ring of {self.ring}"
            raise refuse(message, key="planet")
        # Pitch circles overlap, with z teeth of a planet, Z of the sun and N planets: (Z + z) sin(pi/N) > z; of the ring
        # Z - z. Where `most` is whole, so many circles touch.
        with_sun, with_ring = (float(teeth) for teeth in self.teeth)
        share = max(with_sun / (self.sun + with_sun), with_ring / max(self.ring - with_ring, 1.0))
        most = math.pi / math.asin(share) if share < 1.0 else 1.0
        room = max(math.ceil(most * (1.0 - ROUNDING)) - 1, 1)
        if self.planets > room:
            message = f"{self.planets} planets of these teeth overlap"
            raise refuse(message, f"at most {room} on their circle", "planets")
        if self.planet_mass and self.radius is None:
            message = "`planet_mass` moves on a circle whose `radius` is missing"
            raise refuse(message, "give `radius`", "planet_mass")
        # Planets with inertia whose mesh with the fixed member is the softer one: no springs represent them. Their dynamic
        # stiffness between the member of the other mesh and the carrier has a negative coupling of inertia, which no network
        # of positive springs and inertias has.
        if self._softness_of_mesh >= 0.0:
            return
        fixed, mesh = self.fixed, self.meshing
        stiffness = {"sun": self.sun_mesh, "ring": self.ring_mesh}[mesh]
        hint = "leave out `planet_inertia` (the planets then have no inertia about their axes) or both meshes (rigid)"
        if stiffness is None:
            hint = f"give `{mesh}_mesh` too, or {hint}"
        else:
            # The rounding to five digits leads no lower.
            enough = 1.000051 * stiffness * self._mesh_ratio
            hint = f"at least {enough:.5g} N*m/rad with this `{mesh}_mesh`, or {hint}"
        message = (
            f"the mesh of the fixed {fixed} is softer at the teeth than the mesh of the {mesh}"
        )
        message += ": the program has no model of such planets"
        raise refuse(message, hint, f"{fixed}_mesh")

    @property
    def driven(self) -> Member:
        """The member at the end behind it."""
        return next(
            term for term in ("sun", "ring", "carrier") if term not in (self.fixed, self.driving)
        )

    @cached_property
    def teeth(self) -> tuple[Fraction, Fraction]:
        """Teeth of a planet with the sun and with the ring; of a plain one both are the same."""
        if not self.planet:
            return (Fraction(self.ring - self.sun, 2),) * 2
        return Fraction(self.planet[0]), Fraction(self.planet[-1])

    @property
    @source("Willis1841")
    def weights(self) -> dict[str, Fraction]:
        """The torques of the members over that of the sun: their speeds, each times this, add up to 0."""
        with_sun, with_ring = self.teeth
        inner = with_sun * self.ring / (with_ring * self.sun)
        return {"sun": Fraction(1), "ring": inner, "carrier": -1 - inner}

    @property
    def speed(self) -> Fraction:
        """Speed of the driven over the driving member, negative where it turns the other way."""
        return -self.weights[self.driving] / self.weights[self.driven]

    @cached_property
    def speeds(self) -> dict[str, Fraction]:
        """Speeds of the members, and of a planet about its own axis, over the speed of the driving member."""
        speeds = {self.driving: Fraction(1), self.driven: self.speed, self.fixed: Fraction(0)}
        carrier = speeds["carrier"]
        spin = carrier - Fraction(self.sun) / self.teeth[0] * (speeds["sun"] - carrier)
        return speeds | {"planet": spin}

    @property
    def meshing(self) -> Literal["sun", "ring"]:
        """The member whose mesh with the planets is that of the stage."""
        is_ring = self.fixed == "sun" or (self.fixed == "carrier" and self.driving == "ring")
        return "ring" if is_ring else "sun"

    @property
    def meshings(self) -> Fraction:
        """Meshings of its teeth per revolution of the driving member."""
        teeth = self.ring if self.meshing == "ring" else self.sun
        return teeth * abs(self.speeds[self.meshing] - self.speeds["carrier"])

    @property
    def flexibility(self) -> float:
        """Flexibility (rad/(N m)) of the meshes in series, at the driving member, of planets without inertia."""
        weights = self.weights
        return sum(
            float(weights[member] / weights[self.driving]) ** 2 * flexibility
            for member, flexibility in self._yields.items()
        )

    @cached_property
    def _coefficients(self) -> tuple[Fraction, Fraction, Fraction]:
        """The twist of the stage's mesh by its planets and by its carrier, that of the fixed member's by its planets.

        Each over the angle that the body has in the rigid motion; the fixed member's mesh has (u, -u).
        """
        speeds, (with_sun, with_ring) = self.speeds, self.teeth
        steps = {"sun": with_sun / self.sun, "ring": -with_ring / self.ring}
        step = steps[self.meshing]
        return (
            step * speeds["planet"],
            -(1 + step) * speeds["carrier"],
            steps[self.fixed] * speeds["planet"],
        )

    @property
    def _mesh_ratio(self) -> float:
        """Stiffness of the fixed member's mesh over that of the other one where both are equal at the teeth."""
        planets, carrier, fixed = self._coefficients
        return float(planets * carrier / fixed**2)

    @property
    def _yields(self) -> dict[str, float]:
        """Flexibilities (rad/(N m)) of the meshes at their own members, 0 where they are rigid."""
        return {
            "sun": 1.0 / (self.sun_mesh or math.inf),
            "ring": 1.0 / (self.ring_mesh or math.inf),
        }

    @property
    def _softness_of_mesh(self) -> float:
        """Flexibility (rad/(N m), at its member) of the stage's mesh less that of the fixed member's, at the teeth.

        Infinite for a fixed carrier, where both meshes are in a row, and for planets without inertia.
        """
        if self.fixed == "carrier" or not self.planet_inertia:
            return math.inf
        mesh, fixed = self._yields[self.meshing], self._mesh_ratio * self._yields[self.fixed]
        return 0.0 if abs(mesh - fixed) <= ROUNDING * mesh else mesh - fixed

    @cached_property
    def star(self) -> Star | None:
        """The meshes with planets that have an inertia between them; None where they have no star.

        The twist of a mesh is a sum over its member, the planets and the carrier, of coefficients v that add up to 0 in
        the rigid motion. The mesh with the fixed member has but two of them, u and -u, and the triangle of stiffnesses
        that both make is a star with one arm that would be negative where the fixed member's mesh is the softer one.
        """
        if not self.planet_inertia or not any(self._yields.values()):
            return None  # else they move against the members
        speeds, yields = self.speeds, self._yields
        if self.fixed == "carrier":
            other_mesh = yields[self.driven] * float(1 / self.speed) ** 2
            return Star(yields[self.driving], other_mesh, 0.0, is_mesh_driving=True)
        planets, carrier, fixed = self._coefficients
        to_carrier, to_planets = (
            float(-share / (speeds[self.meshing] * fixed**2)) * yields[self.fixed]
            for share in (planets, carrier)
        )
        mesh = self._softness_of_mesh / float(speeds[self.meshing]) ** 2
        return Star(mesh, to_carrier, to_planets, is_mesh_driving=self.driving == self.meshing)

    @property
    def halves(self) -> tuple[float, float]:
        """Inertias (kg m2) at the driving and the driven member, the planets at the carrier, else at the driven.

        Of planets in a `star` their mass alone.
        """
        inertias = {member: getattr(self, f"{member}_inertia") for member in get_args(Member)}
        speeds, member = self.speeds, self.driven if self.fixed == "carrier" else "carrier"
        spinning = 0.0 if self.star is not None else self.planet_inertia
        orbit = (self.radius or 0.0) * float(speeds["carrier"] / speeds[member])
        inertias[member] += self.planets * (
            spinning * float(speeds["planet"] / speeds[member]) ** 2 + self.planet_mass * orbit**2
        )
        return inertias[self.driving], inertias[self.driven]
