"""A coupling: an elastic (or rigid) link with its damping, its end inertias and its maker's limits."""

import math
from typing import Annotated

from pydantic import Field

from torsion import fields
from torsion.components import nonlinear_coupling
from torsion.components.component import Component
from torsion.components.lowering import CouplingRatings, Lowering
from torsion.fields import Quantity, given, refuse
from torsion.primitives import Spring

Pair = Annotated[tuple[fields.Inertia, fields.Inertia], Field(min_length=2, max_length=2)]
DAMPINGS = ("viscous", "loss_factor", "psi", "magnifier")


class Coupling(Component, keyword="coupling", sort="link", unbuilt=("table",)):
    """An elastic or rigid coupling, or any other massless spring of the train."""

    stiffness: fields.Stiffness | None = given("dynamic torsional stiffness")
    flexibility: fields.Flexibility | None = given("1/stiffness; 0 is rigid")
    inertia: Pair | None = given("[driving, driven] halves")
    viscous: fields.Damping | None = given("viscous damping")
    loss_factor: fields.LossFactor | None = given("loss factor eta: k (1 + i eta)")
    psi: Annotated[float, Quantity("1", at_least=0, usual=(None, 4.0 * math.pi), slip=("%",))] | None = given(
        "relative damping: energy lost in a cycle / peak elastic energy; eta = psi/(2 pi)"
    )
    magnifier: Annotated[float, Quantity("1", above=0, usual=(0.5, None), mistaken="a loss factor")] | None = given(
        "dynamic magnifier M; eta = 1/M"
    )
    rated_torque: fields.Torque | None = given("T_KN of the maker")
    vibratory_torque: fields.Torque | None = given("T_KW of the maker: permissible vibratory torque, half range")
    max_torque: fields.Torque | None = given("T_Kmax of the maker")
    heat_limit: fields.Power | None = given("P_KW of the maker: permissible power loss")
    tolerance: fields.Tolerance | None = given("tolerance of the stiffness, for example 15 %")
    clearance: nonlinear_coupling.Clearance | None = given(
        "play: the whole angle, or {angle, stiffness, viscous} with those of the contact"
    )
    hysteresis_torque: nonlinear_coupling.Frictions = given(
        "dry friction beside the spring: torque, {torque, stiffness}, or a list of them that slip one after another", ()
    )
    stages: nonlinear_coupling.Stages = given("list of {from, stiffness, hysteresis_torque} that add to it", ())
    capacity: nonlinear_coupling.Torque | None = given("torque at which it slips; the coupling is then a clutch")

    def refuse_clashes(self) -> None:
        if (self.stiffness is None) == (self.flexibility is None):
            what = "`stiffness` or `flexibility` is missing" if self.stiffness is None else "both are given"
            raise refuse(what, "give one of `stiffness` and `flexibility` (0 = rigid)")
        found = [key for key in DAMPINGS if getattr(self, key) is not None]
        if len(found) > 1:
            raise refuse(f"{' and '.join(found)} exclude each other", "give one kind of damping", found[1])
        if self.flexibility == 0 and found:
            raise refuse("a rigid coupling has no damping", "leave it out, or give a stiffness", found[0])
        nonlinear_coupling.refuse_clashes(self)

    def lower(self, build: Lowering) -> None:
        ratings = CouplingRatings(
            self.rated_torque, self.vibratory_torque, self.max_torque, self.heat_limit, self.tolerance
        )
        damping = next(((key, value) for key in DAMPINGS if (value := getattr(self, key)) is not None), None)
        build.record(ratings=ratings, damping=damping)
        driving, driven = build.link(halves=self.inertia)
        given, scale = self.flexibility, build.at.scale
        flexibility = given * scale if given is not None else 1.0 / build.own(self.stiffness or 1.0)
        if self.clearance is not None and self.clearance.stiffness is not None:
            flexibility = 1.0 / build.own(self.clearance.stiffness)
        stiffness = 1.0 / flexibility if flexibility else math.inf
        build.record(nonlinear=nonlinear_coupling.record(self, stiffness, scale))
        loss = 1.0 / self.magnifier if self.magnifier is not None else self.loss_factor or 0.0
        loss = self.psi / (2.0 * math.pi) if self.psi is not None else loss
        build.add(Spring(build.name, build.part, driving, driven, flexibility, build.own(self.viscous or 0.0), loss))
