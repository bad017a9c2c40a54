"""What makes a coupling nonlinear: play, dry friction, stages, and the capacity of a clutch."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Annotated, Any

from pydantic import BeforeValidator

from torsion import fields
from torsion.fields import Declared, OneOrMany, Quantity, given, refuse, required

Angle = Annotated[float, Quantity("rad", above=0)]
Torque = Annotated[float, Quantity("N*m", above=0)]
BESIDE_NO_CAPACITY = (
    "clearance", "hysteresis_torque", "stages", "viscous", "loss_factor", "psi", "magnifier"
)  # fmt: skip
STIFF = 100.0  # times the stiffness beside it: that of a friction whose own stiffness the file does not give


class Play(Declared):
    """The play of a coupling, and what it is beyond it."""

    angle: Angle = required("the whole play, from face to face")
    stiffness: fields.Stiffness | None = given("of the contact (default: that of the coupling)")
    viscous: fields.Damping | None = given("viscous damping of the contact (default: that of the coupling)")


class DryFriction(Declared):
    """Friction beside a spring: a spring in series with a slider."""

    torque: Torque = required("torque at which it slips: half the width of the loop of torque over twist")
    stiffness: fields.Stiffness | None = given("until it slips (default: 100 times that beside it)")


class Stage(Declared):
    """A stage that takes part beyond a twist."""

    first: Angle = required("twist to either side at which it begins", alias="from")
    stiffness: fields.Stiffness = required("stiffness that it adds")
    hysteresis_torque: Torque | None = given("friction that takes part with it")


def _plain(key: str, kind: type[Declared]) -> BeforeValidator:
    """A value alone, in place of the mapping that has it under `key`."""
    return BeforeValidator(lambda value: value if isinstance(value, dict | kind) else {key: value}, float | str | kind)


Clearance = Annotated[Play, _plain("angle", Play)]
Frictions = Annotated[tuple[Annotated[DryFriction, _plain("torque", DryFriction)], ...], OneOrMany]
Stages = tuple[Stage, ...]


@dataclass(frozen=True)
class NonlinearRecord:
    """The nonlinear parts of a coupling, of its own speed."""

    stiffness: float  # N m/rad beyond the play, of the first stage, of a clutch that is stuck; infinite: rigid
    play: float = 0.0  # rad, half of it
    viscous: float = 0.0  # N m s/rad of the contact
    friction: tuple[tuple[float, float], ...] = ()  # N m, N m/rad
    stages: tuple[tuple[float, float, float], ...] = ()  # rad, N m/rad, N m of its friction
    capacity: float | None = None  # N m, of a clutch

    @property
    def interrupts(self) -> bool:
        """Nothing linear is left of the coupling."""
        return bool(self.play) or self.capacity is not None

    @property
    def words(self) -> str:
        """How modes take it; the response takes its friction by harmonic balance."""
        taken = {
            "its play closed": self.play, "without its friction": self.friction, "in its first stage": self.stages,
            "as a clutch that is stuck": self.capacity is not None,
        }  # fmt: skip
        return ", ".join(word for word, there in taken.items() if there)


def refuse_clashes(coupling: Any) -> None:
    """Refuse what does not go together with the nonlinear keys of a coupling."""
    rigid = coupling.flexibility == 0
    play, friction, stages = coupling.clearance, coupling.hysteresis_torque, coupling.stages
    if play is not None and rigid and play.stiffness is None:
        hint = "clearance: {angle: 0.5 deg, stiffness: 2 MN*m/rad}"
        raise refuse("a clearance in a rigid coupling needs the stiffness of its contact", hint, "clearance")
    if play is not None and stages:
        hint = "give the play as a first stage of little stiffness"
        raise refuse("`clearance` and `stages` exclude each other", hint, "stages")
    if rigid and (friction or stages):
        key = "stages" if stages else "hysteresis_torque"
        raise refuse(f"a rigid coupling has no `{key}`: it does not twist", "give a stiffness", key)
    if coupling.capacity is not None:
        beside = [key for key in BESIDE_NO_CAPACITY if getattr(coupling, key) not in (None, ())]
        if beside:
            hint = "give the clutch and its damper as two couplings with an inertia between them"
            raise refuse(f"`capacity` and `{beside[0]}` exclude each other", hint, beside[0])
    lost = [key for key in ("loss_factor", "psi", "magnifier") if getattr(coupling, key) is not None]
    if friction and lost:
        raise refuse(f"`{lost[0]}` and `hysteresis_torque` count the same loss twice", "keep one of them", lost[0])
    if play is not None and lost:
        hint = "give `viscous`"
        raise refuse(f"`{lost[0]}` says nothing of a contact that opens and closes", hint, lost[0])
    total = sum(one.torque for one in friction)
    if friction and coupling.max_torque is not None and total >= coupling.max_torque:
        message = f"the friction of {total:g} N m is not below the greatest torque, {coupling.max_torque:g} N m"
        raise refuse(message, "it would never slip", "hysteresis_torque")
    if any(before.first >= after.first for before, after in pairwise(stages)):
        raise refuse("stages come in the order of the twists at which they begin", "rising `from`", "stages")


def record(coupling: Any, stiffness: float, scale: float) -> NonlinearRecord | None:
    """The record of a coupling of that stiffness; None where it is linear.

    scale: (own speed / speed at which its figures are given)**2. A torque is divided by its root, an angle multiplied.
    """
    play, root = coupling.clearance, scale**0.5
    if play is None and not coupling.hysteresis_torque and not coupling.stages and coupling.capacity is None:
        return None
    friction = tuple(
        (one.torque / root, one.stiffness / scale if one.stiffness else STIFF * stiffness)
        for one in coupling.hysteresis_torque
    )
    stages = tuple(
        (one.first * root, one.stiffness / scale, (one.hysteresis_torque or 0.0) / root) for one in coupling.stages
    )
    capacity = None if coupling.capacity is None else coupling.capacity / root
    if play is None:
        return NonlinearRecord(stiffness, friction=friction, stages=stages, capacity=capacity)
    viscous = play.viscous if play.viscous is not None else coupling.viscous or 0.0
    return NonlinearRecord(stiffness, play.angle * root / 2.0, viscous / scale, friction, stages)
