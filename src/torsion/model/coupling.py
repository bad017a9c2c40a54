"""A coupling: an elastic (or rigid) link with its damping, its limits, and what makes it nonlinear."""

import math
from itertools import pairwise
from typing import Annotated

from pydantic import BeforeValidator, Field

from torsion import fields
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required
from torsion.model.component import Component
from torsion.model.coupling_limits import (
    MISFIRE,
    MisfireLimit,
    PowerLimit,
    VibratoryLimit,
    heat_ratings,
)
from torsion.model.elastic_element import (
    DAMPINGS,
    MAGNIFIER,
    PSI,
    CouplingTable,
    CouplingWarming,
    FractionalSpring,
    Magnifier,
    PronySpring,
    Psi,
    given_damping,
    loss_factor,
)
from torsion.model.lowering import CouplingRatings, Lowering, NonlinearRecord
from torsion.primitives import Spring, tabled_spring

Pair = Annotated[tuple[fields.Inertia, fields.Inertia], Field(min_length=2, max_length=2)]


Angle = Annotated[float, Quantity("rad", above=0, usual="clearance")]
Torque = Annotated[float, Quantity("N*m", above=0)]
BESIDE_NO_CAPACITY = (
    "clearance",
    "hysteresis_torque",
    "stages",
    "viscous",
    "loss_factor",
    "psi",
    "magnifier",
)
BESIDE_NO_TABLE = (*DAMPINGS, "clearance", "hysteresis_torque", "stages", "capacity")
TABLES = ("table", "prony", "fractional")  # what gives stiffness and damping over something
STIFFNESSES = ("stiffness", "flexibility", *TABLES)
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


def _plain(key: str, kind: type[Declared]) -> BeforeValidator:
    """A value alone, in place of the mapping that has it under `key`."""
    return BeforeValidator(
        lambda value: value if isinstance(value, dict | kind) else {key: value}, float | str | kind
    )


Clearance = Annotated[Play, _plain("angle", Play)]
Frictions = Annotated[tuple[Annotated[DryFriction, _plain("torque", DryFriction)], ...], OneOrMany]


def _text(value: object) -> object:
    return str(value) if isinstance(value, int | float) and not isinstance(value, bool) else value


class Coupling(Component, keyword="coupling", sort="link"):
    """An elastic or rigid coupling, or any other massless spring of the train."""

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
        named = [key for key in STIFFNESSES if getattr(self, key) is not None]
        if len(named) != 1:
            what = f"{' and '.join(f'`{key}`' for key in named)} exclude each other"
            what = what if named else "`stiffness` or `flexibility` is missing"
            hint = "give one of `stiffness`, `flexibility` (0 = rigid), `table`, `prony` and `fractional`"
            raise refuse(what, hint, *named[1:2])
        if self.temperature is not None:
            _refuse_beside_temperature(self)
        if named[0] in TABLES:
            beside = [key for key in BESIDE_NO_TABLE if getattr(self, key) not in (None, ())]
            if beside:
                hint = (
                    f"`{named[0]}` gives the damping"
                    if beside[0] in DAMPINGS
                    else "give a `stiffness` in its place"
                )
                raise refuse(f"`{named[0]}` and `{beside[0]}` exclude each other", hint, beside[0])
        if (found := given_damping(self)) and self.flexibility == 0:
            raise refuse(
                "a rigid coupling has no damping", "leave it out, or give a stiffness", found[0]
            )
        if self.max_torque_rare is not None and self.max_torque is None:
            hint = "also give `max_torque`: T_Kmax1 for normal operation"
            raise refuse("`max_torque_rare` limits rare events alone", hint, "max_torque_rare")
        if self.max_torque_rare is not None and self.max_torque_rare < (self.max_torque or 0.0):
            message = (
                f"{self.max_torque_rare:g} N m is below the {self.max_torque:g} N m of `max_torque`"
            )
            raise refuse(message, "T_Kmax2 of rare events is at least T_Kmax1", "max_torque_rare")
        heat_ratings(self.heat_limit, self.heat_limit_misfire)
        _refuse_nonlinear_clashes(self)

    def lower(self, build: Lowering) -> None:
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
            temperature_rise=None
            if self.temperature is None
            else self.temperature.to - self.temperature.now,
            vibratory_over_frequency=over,
            **heat_ratings(self.heat_limit, self.heat_limit_misfire),
        )
        damping = given_damping(self)
        build.record(ratings=ratings, damping=damping)
        driving, driven = build.link(halves=self.inertia)
        given, scale = self.flexibility, build.at.scale
        warming, factor, lost = (
            (None, 1.0, None) if self.temperature is None else self.temperature.lowered()
        )
        if warming is not None:
            build.record(
                warming=warming, damping=damping if lost is None else ("loss_factor", lost)
            )
        if (given_table := self.table or self.prony or self.fractional) is not None:
            table = given_table.lowered(scale).times(factor)
            build.add(tabled_spring(build.name, build.part, (driving, driven), table))
            return
        flexibility = given * scale if given is not None else 1.0 / build.own(self.stiffness or 1.0)
        flexibility /= factor
        if self.clearance is not None and self.clearance.stiffness is not None:
            flexibility = 1.0 / build.own(self.clearance.stiffness)
        stiffness = 1.0 / flexibility if flexibility else math.inf
        nonlinear = _nonlinear_record(self, stiffness, scale)
        build.record(nonlinear=nonlinear)
        viscous = (
            build.own(self.viscous or 0.0)
            if nonlinear is None or not nonlinear.play
            else nonlinear.viscous
        )
        build.add(
            Spring(
                build.name,
                build.part,
                driving,
                driven,
                flexibility,
                viscous,
                lost or loss_factor(damping),
            )
        )


def _refuse_beside_temperature(coupling: Coupling) -> None:
    """Refuse what does not go together with the temperature of a coupling."""
    warming, rigid = coupling.temperature, coupling.flexibility == 0
    beside = [
        key for key in BESIDE_NO_TABLE[len(DAMPINGS) :] if getattr(coupling, key) not in (None, ())
    ]
    if rigid or beside:
        key = beside[0] if beside else "flexibility"
        what = (
            "a rigid coupling makes no heat"
            if rigid
            else f"`temperature` and `{key}` exclude each other"
        )
        raise refuse(what, "leave `temperature` out", key)
    lost = [
        key for key in DAMPINGS[1:] if warming is not None and getattr(warming, key) is not None
    ]
    own = [key for key in (*DAMPINGS[1:], *TABLES) if getattr(coupling, key) is not None]
    if lost and own:
        hint = f"`temperature` gives it as `{lost[0]}`"
        raise refuse(f"`{own[0]}` and `temperature` both say what the coupling loses", hint, own[0])


def _refuse_nonlinear_clashes(coupling: Coupling) -> None:
    """Refuse what does not go together with the nonlinear keys of a coupling."""
    rigid = coupling.flexibility == 0
    play, friction, stages = coupling.clearance, coupling.hysteresis_torque, coupling.stages
    if play is not None and rigid and play.stiffness is None:
        hint = "clearance: {angle: 0.5 deg, stiffness: 2 MN*m/rad}"
        raise refuse(
            "a clearance in a rigid coupling needs the stiffness of its contact", hint, "clearance"
        )
    if play is not None and stages:
        hint = "give the backlash as a first stage of low stiffness"
        raise refuse("`clearance` and `stages` exclude each other", hint, "stages")
    if rigid and (friction or stages):
        key = "stages" if stages else "hysteresis_torque"
        raise refuse(f"a rigid coupling has no `{key}`: it does not twist", "give a stiffness", key)
    if coupling.capacity is not None:
        beside = [key for key in BESIDE_NO_CAPACITY if getattr(coupling, key) not in (None, ())]
        if beside:
            hint = "give the clutch and its damper as two couplings with an inertia between them"
            raise refuse(f"`capacity` and `{beside[0]}` exclude each other", hint, beside[0])
    lost = [
        key for key in ("loss_factor", "psi", "magnifier") if getattr(coupling, key) is not None
    ]
    if friction and lost:
        raise refuse(
            f"`{lost[0]}` and `hysteresis_torque` count the same loss twice",
            "keep one of them",
            lost[0],
        )
    if play is not None and lost:
        hint = "give `viscous`"
        raise refuse(
            f"`{lost[0]}` has no meaning for a contact that opens and closes", hint, lost[0]
        )
    total = sum(one.torque for one in friction)
    if friction and coupling.max_torque is not None and total >= coupling.max_torque:
        message = f"the friction of {total:g} N m is not below the maximum torque, {coupling.max_torque:g} N m"
        raise refuse(message, "it would never slip", "hysteresis_torque")
    if any(before.first >= after.first for before, after in pairwise(stages)):
        raise refuse(
            "stages come in the order of the twists at which they begin", "rising `from`", "stages"
        )


def _nonlinear_record(coupling: Coupling, stiffness: float, scale: float) -> NonlinearRecord | None:
    """The record of a coupling of that stiffness; None where it is linear.

    scale: (own speed / speed at which its figures are given)**2. A torque is divided by its root, an angle multiplied.
    """
    play, root = coupling.clearance, scale**0.5
    if (
        play is None
        and not coupling.hysteresis_torque
        and not coupling.stages
        and coupling.capacity is None
    ):
        return None
    friction = tuple(
        (one.torque / root, one.stiffness / scale if one.stiffness else STIFF * stiffness)
        for one in coupling.hysteresis_torque
    )
    stages = tuple(
        (
            one.first * root,
            one.stiffness / scale,
            ((one.hysteresis_torque or 0.0) / root, STIFF * one.stiffness / scale),
        )
        for one in coupling.stages
    )
    capacity = None if coupling.capacity is None else coupling.capacity / root
    if play is None:
        return NonlinearRecord(stiffness, friction=friction, stages=stages, capacity=capacity)
    viscous = play.viscous if play.viscous is not None else coupling.viscous or 0.0
    return NonlinearRecord(stiffness, play.angle * root / 2.0, viscous / scale, friction, stages)
