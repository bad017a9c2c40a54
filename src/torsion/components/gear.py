"""A gear: a change of speed, with the inertias of its wheels and any further wheels on the same driving gear."""

from dataclasses import replace
from fractions import Fraction
from typing import Annotated, Literal

from pydantic import Field

from torsion import fields
from torsion.components.component import Component, Line, lower_branch
from torsion.components.coupling import Pair
from torsion.components.lowering import Arrival, Lowering
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse
from torsion.primitives import Constraint

Teeth = Annotated[int, Field(ge=1, le=100_000)]


class GearBranch(Declared):
    """A further wheel that meshes with the driving gear, and the train behind it."""

    teeth: Annotated[tuple[Teeth, ...], OneOrMany] | None = given("teeth of the wheel, or [driving, driven]")
    ratio: fields.Exact | None = given("speed of the driving gear / speed of the wheel")
    inertia: fields.Inertia = given("of the wheel", 0.0)
    mesh_stiffness: fields.Stiffness | None = given("of this mesh, at the driving gear's speed (default: rigid)")
    sense: Literal[-1, 1] = given("-1: turns against the driving gear", -1)
    train: Line = given("the train behind the wheel", ())

    def refuse_clashes(self) -> None:
        _one_ratio(self)


class Gear(Component, keyword="gear", sort="link"):
    """A gear stage."""

    ratio: fields.Exact | None = given("speed before / speed after")
    teeth: Annotated[tuple[Teeth, ...], Field(min_length=2, max_length=2)] | None = given("[driving, driven]")
    inertia: Pair | None = given("[driving, driven] wheels")
    mesh_stiffness: fields.Stiffness | None = given("torsional, at the driving gear's speed (default: rigid)")
    sense: Literal[-1, 1] = given("-1: the driven shaft turns the other way", -1)
    referred: bool = given(
        "inertias, stiffnesses, flexibilities and dampings of its driven wheel and of everything after it, behind "
        "further gears too, are already referred to the speed before it (before the first such gear)",
        False,
    )
    branches: tuple[GearBranch, ...] = given("further wheels on the same driving gear", ())
    application_factor: Annotated[float, Quantity("1", at_least=1, usual=(None, 10.0), slip=("%",))] | None = given(
        "K_A of the gear rating"
    )
    max_torque: fields.Torque | None = given("greatest torque of its rating, at the driving gear, in motion over time")

    def refuse_clashes(self) -> None:
        _one_ratio(self)
        for branch in self.branches:
            if branch.teeth is not None and len(branch.teeth) == 1 and self.teeth is None:
                raise refuse("a branch with the teeth of its wheel alone needs `teeth` of the gear", key="branches")

    def lower(self, build: Lowering) -> None:
        build.record(application_factor=self.application_factor, max_torque=self.max_torque)
        before, part, gear = build.at, build.part, build.parts[-1]
        referred_to = before.ratio if self.referred and before.referred_to is None else before.referred_to
        driving, driven = build.link(
            self._speed(self), self.sense, self.inertia, "wheel", referred_to=referred_to, yoke=None
        )
        build.add(self._mesh(self, gear.name, part, (driving, driven), before))
        main = build.at
        for position, branch in enumerate(self.branches):
            ratio, name = before.ratio * self._speed(branch), f"{gear.name} wheel {position + 2}"
            build.at = replace(main, ratio=ratio, sense=before.sense * branch.sense)
            driven = build.station(name, part=part)
            build.inertia(driven, branch.inertia, f"wheel {position + 2}", part)
            build.add(self._mesh(branch, name, part, (driving, driven), before))
            path = (*gear.path, "branches", position, "train")
            lower_branch(build, replace(build.at, here=driven), branch.train, path)
        build.at = main

    def _mesh(self, wheel: "Gear | GearBranch", name: str, part: int, ends: tuple[int, int], at: Arrival) -> Constraint:
        """The mesh of a wheel with the driving gear, whose figures are those `at` its station."""
        flexibility = 0.0 if wheel.mesh_stiffness is None else at.scale / wheel.mesh_stiffness
        teeth = () if wheel.teeth is None else (self._driving_teeth(wheel), wheel.teeth[-1])
        return Constraint(name, part, *ends, self._speed(wheel), flexibility, teeth=teeth)

    def _speed(self, wheel: "Gear | GearBranch") -> Fraction:
        """Speed after / speed before, of a wheel on this gear."""
        if wheel.ratio is not None:
            return 1 / wheel.ratio
        return Fraction(self._driving_teeth(wheel), (wheel.teeth or (1,))[-1])

    def _driving_teeth(self, wheel: "Gear | GearBranch") -> int:
        """Of the driving gear, where it meshes with a wheel that has teeth."""
        teeth = wheel.teeth or (1,)
        return teeth[0] if len(teeth) == 2 else (self.teeth or (1, 1))[0]


def _one_ratio(gear: Gear | GearBranch) -> None:
    if (gear.ratio is None) == (gear.teeth is None):
        what = "`ratio` or `teeth` is missing" if gear.ratio is None else "`ratio` and `teeth` exclude each other"
        raise refuse(what, "`teeth: [driving, driven]`, or `ratio: speed before / speed after`")
