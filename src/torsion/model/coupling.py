"""A coupling: an elastic (or rigid) link with its damping, its limits, and what makes it nonlinear."""

import math
from itertools import pairwise
from typing import Annotated

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.fields import (
    Declared,
    OneOrMany,
    Quantity,
    excludes,
    exclusive,
    given,
    needs,
    or_value,
    refuse,
    required,
)
from torsion.model.component import Component, Lowering
from torsion.model.elastic_element import (
    DAMPINGS,
    HYSTERESES,
    MAGNIFIER,
    MISFIRE,
    PSI,
    CouplingTable,
    CouplingWarming,
    FractionalSpring,
    Magnifier,
    MisfireLimit,
    PowerLimit,
    PronySpring,
    Psi,
    VibratoryLimit,
    given_damping,
    heat_ratings,
    loss_factor,
)
from torsion.model.parts import CouplingRatings, NonlinearRecord
from torsion.primitives import Spring, tabled_spring

Pair = Annotated[tuple[fields.Inertia, fields.Inertia], Field(min_length=2, max_length=2)]


Angle = Annotated[float, Quantity("rad", above=0, usual="clearance")]
Torque = fields.PositiveTorque
NONLINEAR = ("clearance", "hysteresis_torque", "stages", "capacity")
TABLES = ("table", "prony", "fractional")  # what gives stiffness and damping over something
ONE_STIFFNESS = exclusive(
    "stiffness", "flexibility", *TABLES, hint="a flexibility of 0 is rigid", needed=True
)
STIFF = 100.0  # times the stiffness beside it: that of a friction whose own stiffness the file does not give


class Play(Declared):
    """The play of a coupling, and what it is beyond it."""

    angle: Angle = required("total backlash, from face to face")
    stiffness: fields.Stiffness | None = given(
        "of the contact (default: stiffness of the coupling)"
    )
    viscous: fields.Damping | None = given(
        "viscous damping of the contact (default: stiffness of the coupling)"
    )


class DryFriction(Declared):
    """Friction beside a spring: a spring in series with a slider."""

    torque: Torque = required(
        "torque at which it slips: half the width of the loop of torque over twist"
    )
    stiffness: fields.Stiffness | None = given(
        "until it slips (default: 100 times the stiffness parallel to it)"
    )


class Stage(Declared):
    """A stage that takes part beyond a twist."""

    first: Angle = required("twist to either side at which it begins", alias="from")
    stiffness: fields.Stiffness = required("stiffness that it adds")
    hysteresis_torque: Torque | None = given("friction that takes part with it")


Clearance = Annotated[Play, or_value(Play, "angle")]
Frictions = Annotated[
    tuple[Annotated[DryFriction, or_value(DryFriction, "torque")], ...], OneOrMany
]


def _text(value: object) -> object:
    return str(value) if isinstance(value, int | float) and not isinstance(value, bool) else value


class Coupling(Component, keyword="coupling", sort="link"):
    """A coupling is an elastic or rigid connection without length, or any other massless spring of the train."""

    title = "elastic or rigid coupling, spring, clutch, backlash"
    example = """\
- coupling: {stiffness: 40 kN*m/rad, psi: 0.9}
- coupling: {stiffness: 40 kN*m/rad, inertia: [0.9, 0.6], psi: 0.9, vibratory_torque: 1.2 kN*m}
- coupling: {stiffness: 70 kN*m/rad, psi: 1.1, max_torque: 15 kN*m, max_torque_rare: 45 kN*m}
- coupling: {stiffness: 2 MN*m/rad, clearance: {angle: 0.2 deg, viscous: 40}}
- coupling: {stiffness: 950, hysteresis_torque: 7 N*m, stages: [{from: 12 deg, stiffness: 4000}]}
- coupling: {stiffness: 80 kN*m/rad, capacity: 400 N*m}"""
    groups = (
        ("Stiffness", "stiffness flexibility table prony fractional temperature"),
        ("Inertia and damping", "inertia viscous loss_factor psi magnifier"),
        (
            "Ratings of the manufacturer",
            (
                "rated_torque vibratory_torque max_torque max_torque_rare max_torque_range "
                "heat_limit heat_limit_misfire tolerance"
            ),
        ),
        ("Backlash, friction, stages, clutch", "clearance hysteresis_torque stages capacity"),
        ("Library", "from size"),
    )

    clashes = (
        *(excludes(law, *DAMPINGS, hint=f"`{law}` gives the damping") for law in TABLES),
        *(excludes(law, *NONLINEAR, hint="give a `stiffness` in its place") for law in TABLES),
        excludes(
            "capacity",
            *NONLINEAR[:3],
            *DAMPINGS,
            hint="give the clutch and its damper as two couplings with an inertia between them",
        ),
        excludes("temperature", *NONLINEAR, hint="leave `temperature` out"),
        excludes("hysteresis_torque", *HYSTERESES, hint="they count the same loss twice"),
        excludes("clearance", *HYSTERESES, hint="a contact that opens and closes takes `viscous`"),
        needs("max_torque_rare", "max_torque", hint="T_Kmax1 for normal operation"),
        exclusive(
            "clearance", "stages", hint="give the backlash as a first stage of low stiffness"
        ),
    )

    file: str | None = given(
        "CSV file of a series of couplings, whose row of that `size` gives keys", alias="from"
    )
    size: Annotated[str, BeforeValidator(_text, str | float)] | None = given(
        "of the series: which row of `from`"
    )
    stiffness: fields.Stiffness | None = given("dynamic torsional stiffness")
    flexibility: fields.Flexibility | None = given("1/stiffness; 0 is rigid")
    table: CouplingTable | None = given(
        "stiffness and damping over frequency or mean torque, in place of `stiffness`"
    )
    prony: PronySpring | None = given(
        "relaxing springs parallel to a static spring, in place of `stiffness` and damping"
    )
    fractional: FractionalSpring | None = given(
        "a power of the frequency parallel to a static spring, in place of `stiffness` and damping"
    )
    temperature: CouplingWarming | None = given(
        "what its own heat takes of its stiffness, and how far it may warm"
    )
    inertia: Pair | None = given("[driving, driven] halves")
    viscous: fields.Damping | None = given("viscous damping")
    loss_factor: fields.LossFactor | None = given("loss factor eta: k (1 + i eta)")
    psi: Psi | None = given(PSI)
    magnifier: Magnifier | None = given(MAGNIFIER)
    rated_torque: fields.Rating | None = given("T_KN of the maker")
    vibratory_torque: VibratoryLimit | None = given(
        "T_KW of the manufacturer: permissible vibratory torque, amplitude (zero to peak); over frequency {torque, "
        "at, above}, or rows [frequency, torque]"
    )
    max_torque: fields.Rating | None = given(
        "T_Kmax of the manufacturer; of two values, T_Kmax1 for normal operation: starts, resonances, clutching, ice"
    )
    max_torque_rare: fields.Rating | None = given(
        "T_Kmax2 of the maker, of rare events: short circuit, emergency, misoperation (default: `max_torque`)"
    )
    max_torque_range: fields.Rating | None = given(
        "dT_max of the maker: range of the torque, from peak to peak, in a motion of normal operation"
    )
    heat_limit: PowerLimit | None = given(
        "P_KW of the maker: permissible power loss; over frequency rows [frequency, power]"
    )
    heat_limit_misfire: MisfireLimit | None = given(MISFIRE)
    tolerance: fields.Tolerance | None = given("tolerance of the stiffness, for example 15 %")
    clearance: Clearance | None = given(
        "backlash: the total angle, or {angle, stiffness, viscous} with stiffness and damping of the contact"
    )
    hysteresis_torque: Frictions = given(
        "dry friction parallel to the spring: torque, {torque, stiffness}, or a list of friction elements that slip "
        "one after another",
        (),
    )
    stages: tuple[Stage, ...] = given(
        "list of {from, stiffness, hysteresis_torque} that add to it", ()
    )
    capacity: Torque | None = given("torque at which it slips; the coupling is then a clutch")

    def refuse_clashes(self) -> None:
        if (self.file is None) != (self.size is None):
            lacks, has = ("from", "size") if self.file is None else ("size", "from")
            raise refuse(
                f"`{has}` needs `{lacks}`", 'for example {from: series.csv, size: "40"}', has
            )
        ONE_STIFFNESS.check(self)
        if self.temperature is not None:
            if self.flexibility == 0:
                message = "a rigid coupling makes no heat"
                raise refuse(message, "leave `temperature` out", "flexibility")
            lost = self.temperature.keys_given(*HYSTERESES)
            dampings = self.keys_given(*HYSTERESES, *TABLES)
            if lost and dampings:
                message = f"`{dampings[0]}` and `temperature` both say what the coupling loses"
                raise refuse(message, f"`temperature` gives it as `{lost[0]}`", dampings[0])
        damping = given_damping(self)
        if damping and self.flexibility == 0:
            message = "a rigid coupling has no damping"
            raise refuse(message, "leave it out, or give a stiffness", damping[0])
        normal, rare = self.max_torque, self.max_torque_rare
        if rare is not None and normal is not None and rare < normal:
            message = f"{rare:g} N m is below the {normal:g} N m of `max_torque`"
            raise refuse(message, "T_Kmax2 of rare events is at least T_Kmax1", "max_torque_rare")
        heat_ratings(self.heat_limit, self.heat_limit_misfire)
        rigid = self.flexibility == 0
        play, friction, stages = self.clearance, self.hysteresis_torque, self.stages
        if play is not None and rigid and play.stiffness is None:
            message = "a clearance in a rigid coupling needs the stiffness of its contact"
            raise refuse(message, "clearance: {angle: 0.5 deg, stiffness: 2 MN*m/rad}", "clearance")
        if rigid and (friction or stages):
            key = "stages" if stages else "hysteresis_torque"
            raise refuse(
                f"a rigid coupling has no `{key}`: it does not twist", "give a stiffness", key
            )
        total = sum(element.torque for element in friction)
        if friction and self.max_torque is not None and total >= self.max_torque:
            message = f"the friction of {total:g} N m is not below the maximum torque, {self.max_torque:g} N m"
            raise refuse(message, "it would never slip", "hysteresis_torque")
        if any(before.first >= after.first for before, after in pairwise(stages)):
            message = "stages come in the order of the twists at which they begin"
            raise refuse(message, "rising `from`", "stages")

    def lower(self, build: Lowering) -> None:
        damping, temperature = given_damping(self), self.temperature
        vibratory, over = (
            (None, None) if self.vibratory_torque is None else self.vibratory_torque.lowered()
        )
        ratings = CouplingRatings(
            self.rated_torque,
            vibratory,
            self.max_torque,
            tolerance=self.tolerance,
            max_torque_rare=self.max_torque_rare,
            max_torque_range=self.max_torque_range,
            temperature_rise=None if temperature is None else temperature.to - temperature.now,
            vibratory_over_frequency=over,
            **heat_ratings(self.heat_limit, self.heat_limit_misfire),
        )
        factor, eta = 1.0, loss_factor(damping)
        if temperature is not None:
            warming, factor, eta_now = temperature.lowered()
            if eta_now is not None:
                damping, eta = ("loss_factor", eta_now), eta_now
            build.record(warming)
        build.record(ratings)
        build.place(damping=damping)
        driving, driven = build.link(halves=self.inertia)

        scale = build.arrival.scale
        law = self.table or self.prony or self.fractional
        if law is not None:
            table = law.lowered(scale).times(factor)
            build.add(tabled_spring(build.name, build.part, (driving, driven), table))
            return
        contact = None if self.clearance is None else self.clearance.stiffness
        if contact is not None:
            flexibility = 1.0 / build.to_own_speed(contact)
        elif self.flexibility is not None:
            flexibility = self.flexibility * scale / factor
        else:
            flexibility = 1.0 / build.to_own_speed(self.stiffness or 1.0) / factor
        viscous = build.to_own_speed(self.viscous or 0.0)
        nonlinear = _nonlinear_record(self, 1.0 / flexibility if flexibility else math.inf, scale)
        if nonlinear is not None:
            build.record(nonlinear)
            viscous = nonlinear.viscous if nonlinear.play else viscous
        build.add(Spring(build.name, build.part, driving, driven, flexibility, viscous, eta))


def _nonlinear_record(coupling: Coupling, stiffness: float, scale: float) -> NonlinearRecord | None:
    """The record of a coupling of that stiffness; None where it is linear.

    scale: (own speed / speed at which its figures are given)**2. A torque is divided by its root, an angle multiplied.
    """
    play, root = coupling.clearance, scale**0.5
    if not coupling.keys_given(*NONLINEAR):
        return None
    friction = tuple(
        (
            element.torque / root,
            element.stiffness / scale if element.stiffness else STIFF * stiffness,
        )
        for element in coupling.hysteresis_torque
    )
    stages = tuple(
        (
            stage.first * root,
            stage.stiffness / scale,
            ((stage.hysteresis_torque or 0.0) / root, STIFF * stage.stiffness / scale),
        )
        for stage in coupling.stages
    )
    capacity = None if coupling.capacity is None else coupling.capacity / root
    if play is None:
        return NonlinearRecord(stiffness, friction=friction, stages=stages, capacity=capacity)
    viscous = play.viscous if play.viscous is not None else coupling.viscous or 0.0
    return NonlinearRecord(stiffness, play.angle * root / 2.0, viscous / scale, friction, stages)
