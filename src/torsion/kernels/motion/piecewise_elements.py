"""Elements that are linear between events: clearance, dry friction, and dry friction behind a clearance.

Every element has one coordinate x of its own, a twist in rad that moves with the relative angle u of its ends or stands
still, and in every regime one law of its torque:
    free   T = 0
    parted T = 0 while its spring, which the damping outruns, gives up its energy
    spring T = k (x - offset) + c u'
    given  T = sign * capacity
    stuck  the torque that keeps u' = 0 (friction without elasticity)
A regime lasts while its switching functions, factor * quantity + level + share * capacity, stay positive. In contact
the torque never pulls: with damping a contact ends before the faces part, so that "leaving" (open beyond the play) is
a regime; without it the march would switch without end.
"""

import math
from dataclasses import dataclass
from typing import ClassVar, Literal

import numpy as np

from torsion.arrays import FloatArray

OPEN = 9  # regime of friction that has no capacity at present
Quantity = Literal["twist", "speed", "torque", "contact"]


@dataclass(frozen=True)
class Switch:
    """One switching function of a regime, and the regime that begins where it falls below zero."""

    of: Quantity
    factor: float
    to: int
    level: float = 0.0  # in the unit of the quantity
    share: float = 0.0  # of the capacity


@dataclass(frozen=True)
class Law:
    """What gives the torque in a regime, whether x moves with the ends, and the conditions that end the regime."""

    kind: Literal["free", "parted", "spring", "given", "stuck"]
    moves: bool
    switches: tuple[Switch, ...]
    offset: float = 0.0  # rad
    sign: int = 0


@dataclass(frozen=True)
class Clearance:
    """A spring with play: T = k (x - s half) + c u' in contact on side s, 0 between.

    Regimes: 0 open, +-1 contact, +-2 leaving.
    """

    ends: FloatArray  # (rigid motions + modes,) rad, relative angle of its ends in every motion
    stiffness: float  # N m/rad
    half: float  # rad, half the play
    viscous: float = 0.0  # N m s/rad
    slips: ClassVar[bool] = False
    capacity: ClassVar[float] = 0.0
    signal: ClassVar[int | None] = None

    def law(self, regime: int) -> Law:
        """What gives its torque in a regime."""
        side = int(np.sign(regime))
        if regime == 0:
            return Law("free", True, _closing(self.half))
        if abs(regime) == 1:
            limit = Switch("torque", side, 2 * side if self.viscous else 0)
            return Law("spring", True, (limit,), side * self.half)
        limit = Switch("twist", side, 0, -self.half)
        return Law("parted", True, (limit, Switch("contact", -side, side)), side * self.half)

    def switch(self, old: int, new: int) -> tuple[str, float | None]:
        """What a switch is called, empty for one that nobody needs to know of; x (rad) there where it is known exactly."""
        word = "contact" if abs(new) == 1 else "separation" if abs(old) == 1 else ""
        is_inside = 2 in (abs(old), abs(new)) and 0 not in (old, new)
        return word, None if is_inside else float(np.sign(old + new)) * self.half


@dataclass(frozen=True)
class Friction:
    """A spring in series with a slider: T = k x, |T| <= capacity; k infinite: the slider alone.

    Regimes: 0 stick, +-1 slip, OPEN without capacity.
    """

    ends: FloatArray
    stiffness: float
    capacity: float = 0.0  # N m
    signal: int | None = None  # the signal that is its capacity over time, in place of a constant
    viscous: ClassVar[float] = 0.0
    slips: ClassVar[bool] = True

    def law(self, regime: int) -> Law:
        if regime == OPEN:
            return Law("free", False, ())
        if regime:
            return Law("given", False, (Switch("speed", regime, 0),), sign=regime)
        slips = Switch("torque", -1.0, 1, share=1.0), Switch("torque", 1.0, -1, share=1.0)
        is_rigid = math.isinf(self.stiffness)
        return Law("stuck" if is_rigid else "spring", not is_rigid, slips)

    def switch(self, old: int, new: int) -> tuple[str, float | None]:
        # Sticking begins with the torque of slipping.
        return "stuck" if new == 0 else "open" if new == OPEN else "slip", None


@dataclass(frozen=True)
class DelayedFriction:
    """Friction that takes part beyond a play: x counts from the middle of the play, which slipping carries along.

    Regimes: 0 open, +-1 stick in contact, +-2 slip.
    """

    ends: FloatArray
    stiffness: float
    capacity: float
    half: float
    viscous: ClassVar[float] = 0.0
    slips: ClassVar[bool] = True
    signal: ClassVar[int | None] = None

    def law(self, regime: int) -> Law:
        side = int(np.sign(regime))
        if regime == 0:
            return Law("free", True, _closing(self.half))
        if abs(regime) == 2:
            return Law("given", False, (Switch("speed", side, side),), sign=side)
        limits = Switch("torque", -side, 2 * side, share=1.0), Switch("torque", side, 0)
        return Law("spring", True, limits, side * self.half)

    def switch(self, old: int, new: int) -> tuple[str, float | None]:
        stays = "stuck" if abs(old) == 2 else "contact"
        word = "slip" if abs(new) == 2 else "separation" if new == 0 else stays
        return word, float(np.sign(old + new)) * self.half if 0 in (old, new) else None


def _closing(half: float) -> tuple[Switch, ...]:
    """Switches of an open play, to contact on either side."""
    return Switch("twist", -1.0, 1, half), Switch("twist", 1.0, -1, half)


Element = Clearance | Friction | DelayedFriction
