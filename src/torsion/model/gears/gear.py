"""A gear: a change of speed, with the inertias of its wheels and any further wheels on the same driving gear."""

import math
from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Any, Literal

from pydantic import Field

from torsion import fields
from torsion.fields import Declared, OneOrMany, Quantity, excludes, exclusive, given, needs, refuse
from torsion.model.component import Arrival, Component, Line, Lowering, lower_branch
from torsion.model.coupling import Pair
from torsion.model.gears.differential import Differential
from torsion.model.gears.planetary import Planetary, Star, Teeth
from torsion.model.parts import GearRating, Part, Symbol
from torsion.primitives import Constraint, Spring, Toothing

Helix = Annotated[float, Quantity("rad", at_least=0, below=math.pi / 2)]
Pressure = Annotated[float, Quantity("rad", above=0, below=math.pi / 2)]
Module = Annotated[float, Quantity("m", above=0, usual="module")]
ITS_OWN_KEYS = "its own keys say it"
PRESSURE_ANGLE = math.radians(20.0)  # of the basic rack, ISO 53
SAME_SIZE = 1e-3  # relative, of two diameters that drawings print to a tenth of a millimetre


ONE_RATIO = exclusive(
    "ratio",
    "teeth",
    hint="`teeth: [driving, driven]`, or `ratio: speed before / speed after`",
    needed=True,
)


class GearBranch(Declared):
    """A further wheel that meshes with the driving gear, and the train behind it."""

    teeth: Annotated[tuple[Teeth, ...], OneOrMany] | None = given(
        "teeth of the wheel, or [driving, driven]"
    )
    ratio: fields.Exact | None = given("speed of the driving gear / speed of the wheel")
    inertia: fields.Inertia = given("of the wheel", 0.0)
    mesh_stiffness: fields.Stiffness | None = given(
        "of this mesh, at the driving gear's speed (default: rigid)"
    )
    sense: Literal[-1, 1] = given("-1: turns against the driving gear", -1)
    train: Line = given("the train behind the wheel", ())
    clashes = (ONE_RATIO,)


class Gear(Component, keyword="gear", sort="link", symbol=Symbol(width=0.45)):
    """A gear joins two or more shafts at a ratio."""

    title = "gear stage, planetary stage and differential"
    example = """\
- gear: {ratio: 3}
- gear: {teeth: [31, 93], inertia: [0.25, 14], branches: [{teeth: 62, train: [disc: {inertia: 2}]}]}
- gear: {teeth: [19, 57], module: 8 mm, helix_angle: 12 deg, pressure_angle: 20 deg}"""
    groups = (
        ("Ratio", "ratio teeth planetary sense referred"),
        ("Inertia and stiffness", "inertia mesh_stiffness"),
        ("Further wheels", "branches differential"),
        ("Ratings", "application_factor max_torque"),
        ("Tooth geometry", "module pitch_diameter helix_angle pressure_angle"),
    )

    clashes = (
        excludes("planetary", "branches", hint="give them a separate gear"),
        needs("module", "teeth", hint="or give `pitch_diameter: [driving, driven]`"),
        excludes(
            "planetary",
            "helix_angle",
            "inertia",
            "mesh_stiffness",
            "module",
            "pitch_diameter",
            "pressure_angle",
            "ratio",
            "teeth",
            hint=ITS_OWN_KEYS,
        ),
    )

    ratio: fields.Exact | None = given("speed before / speed after")
    teeth: Annotated[tuple[Teeth, ...], Field(min_length=2, max_length=2)] | None = given(
        "[driving, driven]"
    )
    planetary: Planetary | None = given("a planetary stage, in place of `ratio` or `teeth`")
    inertia: Pair | None = given("[driving, driven] wheels")
    mesh_stiffness: fields.Stiffness | None = given(
        "torsional, at the driving gear's speed (default: rigid)"
    )
    sense: Literal[-1, 1] = given("-1: the driven shaft turns the other way", -1)
    referred: bool = given(
        "the data downstream (inertia, stiffness, flexibility, damping) are already referred to the speed of the "
        "driving side; of several such gears, to the driving side of the first",
        False,
    )
    branches: tuple[GearBranch, ...] = given("further wheels on the same driving gear", ())
    differential: Differential | None = given(
        "two equal halves downstream of the driven wheel, which turns at their mean speed"
    )
    application_factor: (
        Annotated[float, Quantity("1", at_least=1, usual="application factor")] | None
    ) = given("K_A of the gear rating")
    max_torque: fields.Rating | None = given(
        "maximum rated torque at the driving gear, for transient analyses"
    )
    module: Module | None = given(
        "normal module m_n; with `teeth` it makes the pitch diameters m_n z/cos(beta)"
    )
    pitch_diameter: (
        Annotated[tuple[fields.Across, ...], Field(min_length=2, max_length=2)] | None
    ) = given(
        "pitch (reference) diameters d of the [driving, driven] wheels, for the forces on the teeth"
    )
    helix_angle: Helix | None = given("beta (default: 0 deg, spur teeth)")
    pressure_angle: Pressure | None = given("alpha_n, normal (default: 20 deg)")

    def refuse_clashes(self) -> None:
        if self.planetary is None:
            ONE_RATIO.check(self)
        elif self.sense != -1:
            raise refuse("`planetary` and `sense` exclude each other", ITS_OWN_KEYS, "sense")
        sizes = self.pitch_diameter
        for key in ("helix_angle", "pressure_angle"):
            if getattr(self, key) is not None and sizes is None and self.module is None:
                hint = "give `module`, or `pitch_diameter`"
                raise refuse(f"`{key}` says nothing alone", hint, key)
        if sizes is not None:
            ratio = self.ratio or Fraction(*reversed(self.teeth or (1, 1)))
            if abs(sizes[1] / sizes[0] - ratio) > SAME_SIZE * ratio:
                message = f"the pitch diameters are as 1 to {sizes[1] / sizes[0]:.6g}, the speeds as {float(ratio):.6g} to 1"
                hint = "reference diameters d = m_n z/cos(beta), not tip diameters"
                raise refuse(message, hint, "pitch_diameter")
        for teeth, size in zip(self.teeth or (), sizes or (), strict=False):
            diameter = (self.module or 0.0) * teeth / math.cos(self.helix_angle or 0.0)
            if self.module is not None and abs(diameter - size) > SAME_SIZE * size:
                message = f"m_n z/cos(beta) is {diameter * 1e3:.6g} mm for {teeth} teeth"
                message += f", the pitch diameter {size * 1e3:.6g} mm"
                hint = "mend one of module, teeth, helix angle and diameter"
                raise refuse(message, hint, "pitch_diameter")
        for branch in self.branches:
            if branch.teeth is not None and len(branch.teeth) == 1 and self.teeth is None:
                message = "a branch with only the teeth of its wheel needs `teeth` of the gear"
                raise refuse(message, key="branches")

    def lower(self, build: Lowering) -> None:
        build.record(GearRating(self.application_factor, self.max_torque))
        before, part, gear, stage = build.arrival, build.part, build.parts[-1], self.planetary
        referred_to = before.referred_to
        if self.referred and referred_to is None:
            referred_to = before.ratio
        behind: dict[str, Any] = {"referred_to": referred_to, "yoke": None}
        if stage is None:
            ends = build.link(self._speed(self), self.sense, self.inertia, "wheel", **behind)
            mesh = self._mesh(self, gear.name, part, ends, before)
        else:
            speed, sense = abs(stage.speed), 1 if stage.speed > 0 else -1
            ends = build.link(speed, sense, stage.halves, "member", **behind)
            wheel, flexibility = abs(stage.speeds[stage.meshing]), before.scale * stage.flexibility
            mesh = Constraint(gear.name, part, *ends, speed, flexibility, wheel=wheel)
            mesh = replace(mesh, meshings=stage.meshings)
        main = build.arrival
        if stage is not None and stage.star is not None:
            mesh = _with_planets(build, gear, mesh, stage, stage.star, before)
        build.add(mesh)
        build.arrival = main
        if self.differential is not None:
            self.differential.lower(build, gear, ends[1])
        for position, branch in enumerate(self.branches):
            ratio, name = before.ratio * self._speed(branch), f"{gear.name} wheel {position + 2}"
            build.arrival = replace(main, ratio=ratio, sense=before.sense * branch.sense)
            driven = build.station(name, part=part)
            build.inertia(driven, branch.inertia, f"wheel {position + 2}", part)
            build.add(self._mesh(branch, name, part, (ends[0], driven), before))
            path = (*gear.path, "branches", position, "train")
            lower_branch(build, replace(build.arrival, station=driven), branch.train, path)
        build.arrival = main

    def _mesh(
        self,
        wheel: "Gear | GearBranch",
        name: str,
        part: int,
        ends: tuple[int, int],
        arrival: Arrival,
    ) -> Constraint:
        """The mesh of a wheel with the driving gear, whose figures count at the station of `arrival`."""
        flexibility = 0.0 if wheel.mesh_stiffness is None else arrival.scale / wheel.mesh_stiffness
        teeth = self._teeth_with(wheel)

        # A driving gear of its own beside the first one has the size of the module alone.
        helix, toothing = self.helix_angle or 0.0, None
        angle = PRESSURE_ANGLE if self.pressure_angle is None else self.pressure_angle
        is_first = not teeth or self.teeth is None or teeth[0] == self.teeth[0]
        if self.pitch_diameter is not None and is_first:
            toothing = Toothing(self.pitch_diameter[0], helix, angle, self.module)
        elif self.module is not None and teeth:
            diameter = self.module * teeth[0] / math.cos(helix)
            toothing = Toothing(diameter, helix, angle, self.module)
        return Constraint(
            name,
            part,
            *ends,
            self._speed(wheel),
            flexibility,
            teeth=teeth,
            toothing=toothing,
            meshings=Fraction(teeth[0] if teeth else 0),
        )

    def _speed(self, wheel: "Gear | GearBranch") -> Fraction:
        """Speed after / speed before, of a wheel on this gear."""
        return Fraction(*self._teeth_with(wheel)) if wheel.ratio is None else 1 / wheel.ratio

    def _teeth_with(self, wheel: "Gear | GearBranch") -> tuple[int, ...]:
        """Return the teeth of the driving gear and of a wheel on it; none of a wheel by its ratio."""
        teeth = wheel.teeth or ()
        return ((self.teeth or (1, 1))[0], *teeth) if len(teeth) == 1 else teeth


def _with_planets(
    build: Lowering, gear: Part, mesh: Constraint, stage: Planetary, star: Star, before: Arrival
) -> Constraint:
    """Lower the planets of a stage as a point of their own; the mesh from, or to, where the arms of the star meet."""
    after, carrier = build.arrival, mesh.driven
    if not star.is_mesh_driving:
        carrier, build.arrival = (
            mesh.driving,
            replace(build.arrival, ratio=before.ratio, sense=before.sense),
        )
    build.member(gear, "planets", "planets", is_point=True)
    speed = build.arrival.ratio / before.ratio  # of the centre over that of the driving member
    to_centre, centre = before.scale * float(speed) ** 2, carrier
    if star.other:
        centre = build.station(f"{gear.name} centre")
        ends = (centre, carrier) if star.is_mesh_driving else (carrier, centre)
        build.add(Spring(f"{gear.name} carrier", build.part, *ends, star.other * to_centre))
    spin = stage.speeds["planet"]
    sense = before.sense if spin > 0 else -before.sense
    build.arrival = replace(build.arrival, ratio=before.ratio * abs(spin), sense=sense)
    planets, name = build.station(build.name), f"{gear.name} planets"
    build.place(stations=(planets,), ratio=build.arrival.ratio, depth=gear.depth + 1)
    build.inertia(planets, stage.planets * stage.planet_inertia, f"{stage.planets} planets")
    flexibility = star.planets * to_centre
    build.add(Constraint(name, build.part, centre, planets, abs(spin) / speed, flexibility))
    build.arrival = after
    ends = (mesh.driving, centre) if star.is_mesh_driving else (centre, mesh.driven)
    return replace(mesh, driving=ends[0], driven=ends[1], flexibility=star.mesh * before.scale)
