"""A propeller that mills ice: the greatest ice torque of its class, and what every blade takes of it.

Everything here is from memory of the Finnish-Swedish ice class rules (2017) and IACS UR I3: to be verified against the
edition in force. UR I3 of 2007 has the ramps of 270 degrees, the rules of 2017 one revolution, which is milder.
"""

import cmath
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise, product
from typing import TYPE_CHECKING, Annotated, Literal, get_args

import numpy as np

from torsion import fields
from torsion.analyses.motion.events.event_kind import Kind, Lack, Point
from torsion.fields import Quantity, given, refuse
from torsion.kernels.motion.loaded_modes import Piece, history
from torsion.model.parts import PropellerRecord
from torsion.results import reported, result

if TYPE_CHECKING:
    from torsion.kernels.motion.collocation import Law

CASES = {  # factor C_q, contact angle in deg by number of blades
    1: (0.75, {3: 90.0, 4: 90.0, 5: 72.0, 6: 60.0}),
    2: (1.0, {3: 135.0, 4: 135.0, 5: 135.0, 6: 135.0}),
    3: (0.5, {3: 45.0, 4: 45.0, 5: 36.0, 6: 30.0}),
    4: (0.5, {3: 45.0, 4: 45.0, 5: 36.0, 6: 30.0}),
}
TWO_BLOCKS = 3  # the case of two blocks at once
REVOLUTIONS = 6.0  # of the milling, where no class says them
ROUNDING = 1e-9  # rad, of the angles at which blades hit
PER_THICKNESS = 2.0  # revolutions of the milling for each metre of ice
IceClassName = Literal[
    "PC1", "PC2", "PC3", "PC4", "PC5", "PC6", "PC7", "IA Super", "IA", "IB", "IC"
]


@dataclass(frozen=True)
class IceClass:
    """The design ice of a class, and the factors of the torque that it takes."""

    thickness: float  # m, H_ice
    open_factor: float = 10.9  # k of an open propeller, kN m at lengths in m and a speed in 1/s
    ducted_factor: float = 7.7  # k of one in a duct


POLAR = (14.7, 10.4)  # k of PC1 to PC5
CLASSES: Mapping[IceClassName, IceClass] = {
    "PC1": IceClass(4.0, *POLAR),
    "PC2": IceClass(3.5, *POLAR),
    "PC3": IceClass(3.0, *POLAR),
    "PC4": IceClass(2.5, *POLAR),
    "PC5": IceClass(2.0, *POLAR),
    "PC6": IceClass(1.75),
    "PC7": IceClass(1.5),
    "IA Super": IceClass(1.75),
    "IA": IceClass(1.5),
    "IB": IceClass(1.2),
    "IC": IceClass(1.0),
}
SMALL = 1.8  # times the thickness: a propeller up to this diameter is wholly in the ice
# of k beyond it; 1.8^1.1 = 1.909 would meet the other formula, and the rules round
LARGE_FACTOR = 1.9


@reported
class IceTorque:
    """The greatest ice torque of a class: its formula's inputs and value."""

    at: str = result("the propeller")
    ice_class: str = result("its class")
    thickness: float = result("m", "H_ice, thickness of the ice")
    factor: float = result("k of the formula")
    diameter: float = result("m", "D of the propeller")
    hub_ratio: float = result("1", "d/D")
    pitch_ratio: float = result("1", "P/D at 0.7 of the radius")
    speed: float = result("rad/s", "n, speed of the propeller in the formula")
    revolutions: float = result("of the milling")
    is_ducted: bool = result("the propeller turns in a duct", key="ducted")
    torque: float = result("N*m", "Q_max, to be verified against the edition in force")

    @property
    def is_large(self) -> bool:
        """The propeller reaches beyond the ice: the torque depends on its thickness."""
        return self.diameter > SMALL * self.thickness


def greatest_ice_torque(
    factor: float, thickness: float, record: PropellerRecord, speed: float
) -> float:
    """Q_max, N m, at a speed in rad/s: k (1 - d/D) (P/D)^0.16 (n D)^0.17 D^3 kN m up to D = 1.8 H (to be verified).

    Beyond it 1.9 k (1 - d/D) (P/D)^0.16 (n D)^0.17 D^1.9 H^1.1: lower by 0.5 % where the two meet.

    >>> screw = PropellerRecord(1.0, None, 4, 4.0, 0.8, None, 0.25)
    >>> round(greatest_ice_torque(10.9, 1.0, screw, 4.0 * math.pi) / 1e3, 3)
    297.286
    """
    diameter, pitch = record.diameter or 0.0, record.pitch_ratio or 0.0
    shape = (
        (1.0 - (record.hub_ratio or 0.0))
        * pitch**0.16
        * (speed / (2.0 * math.pi) * diameter) ** 0.17
    )
    if diameter <= SMALL * thickness:
        return float(1e3 * factor * shape * diameter**3)
    return float(1e3 * LARGE_FACTOR * factor * shape * diameter**1.9 * thickness**1.1)


Contact = Annotated[float, Quantity("rad", above=0, at_most=2.0 * math.pi)]
RampAngle = Annotated[float, Quantity("rad", at_least=0)]
Revolutions = Annotated[float, Quantity("1", at_least=1, at_most=1000)]
Thickness = Annotated[float, Quantity("m", above=0, usual="thickness of ice")]


class Ice(Kind):
    """Blades that mill ice at the speed before the events: half sines against the rotation, between two ramps."""

    key = "ice"
    meaning = "{class or torque, case or angle and factor, turns, ramp}: a propeller that mills ice"

    ice_class: IceClassName | None = given(
        "ice class, which gives the maximum torque from diameter, hub_ratio, pitch_ratio and ducted of the "
        "propeller (to be verified)",
        alias="class",
    )
    torque: fields.Torque | None = given(
        "Q_max, the maximum ice torque at the propeller, without a class"
    )
    thickness: Thickness | None = given("H_ice of a class (default: the design ice of the class)")
    speed: fields.Speed | None = given(
        "n of a class: speed of the propeller in bollard condition (default: its rated speed, else the speed of the "
        "milling)"
    )
    case: Literal[1, 2, 3, 4] | None = given(
        "case of the ice rules: factor, angle and blocks (to be verified)"
    )
    factor: fields.Number = given("C_q, without a case", 1.0)
    angle: Contact | None = given("angle of contact alpha_i, without a case")
    turns: Revolutions | None = given(
        "revolutions of the milling (default: 6, of a class 2 for each metre of its ice, to be verified)"
    )
    ramp: RampAngle = given(
        "angle over which the torque rises at the begin, and falls at the end", 1.5 * math.pi
    )

    def refuse_clashes(self) -> None:
        if (self.torque is None) == (self.ice_class is None):
            what = "of a `class` has no separate `torque`"
            if self.torque is None:
                what = "has a `torque` or a `class`"
            hint = f"give one of them; the classes are {', '.join(get_args(IceClassName))}"
            raise refuse(f"ice {what}", hint)
        for key in ("thickness", "speed"):
            if self.ice_class is None and getattr(self, key) is not None:
                hint = "`class` in place of `torque`, or leave it out"
                raise refuse(f"`{key}` is of a class of ice", hint, key)
        if (self.case is None) == (self.angle is None):
            raise refuse("ice has a `case`, or an `angle` and a `factor`", "give one of them")
        if self.case is not None and "factor" in self.model_fields_set:
            hint = "leave `factor` out, or `case`"
            raise refuse("a case of ice contains its factor", hint, "factor")
        if self.ramp > math.pi * self.revolutions:
            hint = f"at most {180 * self.revolutions:g} deg for {self.revolutions:g} turns"
            raise refuse("the two ramps are longer than the milling", hint, "ramp")

    @property
    def revolutions(self) -> float:
        """Revolutions for which the propeller mills ice."""
        if self.turns is not None or self.ice_class is None:
            return self.turns or REVOLUTIONS
        return PER_THICKNESS * (self.thickness or CLASSES[self.ice_class].thickness)

    def of_class(self, point: Point) -> IceTorque | None:
        """The greatest torque of its class there; None where the file says the torque itself."""
        screw, speed = point.propeller, self.speed or point.rated_speed or point.speed
        if self.ice_class is None or screw is None:
            return None
        design = CLASSES[self.ice_class]
        thickness = self.thickness or design.thickness
        factor = design.ducted_factor if screw.is_ducted else design.open_factor
        return IceTorque(
            point.name,
            self.ice_class,
            thickness,
            factor,
            screw.diameter or 0.0,
            screw.hub_ratio or 0.0,
            screw.pitch_ratio or 0.0,
            speed,
            self.revolutions,
            screw.is_ducted,
            greatest_ice_torque(factor, thickness, screw, speed),
        )

    def laws(self, begin: float, point: Point) -> "Iterator[Law]":
        from torsion.kernels.motion import torque_laws

        over_angle = list(self.pieces(0.0, point, 1.0))
        yield torque_laws.ByAngle(0, history([over_angle]), torque_laws.Window(begin))

    def lacks(self, point: Point) -> Lack:
        if not (point.blades and (point.speed or point.turns)):
            return "ice needs a turning propeller with `blades`", "give `blades` and a speed"
        if self.case is not None and point.blades not in CASES[self.case][1]:
            message = f"the cases of the ice rules are of 3 to 6 blades, not {point.blades}"
            return message, "give `angle` and `factor`"
        if self.ice_class is None:
            return None
        needed = ("diameter", "pitch_ratio", "hub_ratio")
        missing = [f"`{key}`" for key in needed if getattr(point.propeller, key, None) is None]
        needs = f"the ice torque of class {self.ice_class} needs"
        if missing:
            hint = "give it in the train, or the `torque` of the ice in place of its `class`"
            return f"{needs} {' and '.join(missing)} of '{point.name}'", hint
        if not (self.speed or point.rated_speed or point.speed):
            hint = "give `speed` of the ice, or `operation: rated`"
            return f"{needs} the speed of '{point.name}'", hint
        return None

    def changes(self, point: Point) -> list[float]:
        """With its end at the speed of the point, where that is known."""
        end = [2.0 * math.pi * self.revolutions / point.speed] if point.speed else []
        return [0.0, *end]

    def pieces(self, begin: float, point: Point, speed: float | None = None) -> Iterator[Piece]:
        """All blades that hit, turning at a speed (rad/s; default: that of the point)."""
        speed, ice = point.speed if speed is None else speed, self.of_class(point)
        torque = (self.torque or 0.0) if ice is None else ice.torque
        factor, angle = self.factor, self.angle or 0.0
        if self.case is not None:
            factor, angles = CASES[self.case]
            angle = math.radians(angles[point.blades])
        torque *= factor
        blocks = (0.0, math.pi / point.blades) if self.case == TWO_BLOCKS else (0.0,)
        end = 2.0 * math.pi * self.revolutions
        corners, levels = [0.0], [1]
        if self.ramp:
            corners, levels = [0.0, self.ramp, end - self.ramp, end], [0, 1, 1, 0]
        for hit, block in product(range(math.ceil(point.blades * self.revolutions)), blocks):
            first = 2.0 * math.pi * hit / point.blades + block
            last = min(first + angle, end)
            if end - first <= ROUNDING:
                continue
            # In pieces over which the ramps have one slope.
            ramps = (self.ramp, end - self.ramp)
            kinks = [kink for kink in ramps if first + ROUNDING < kink < last - ROUNDING]
            for start, stop in pairwise(sorted({first, *kinks, last})):
                level, later = (float(np.interp(x, corners, levels)) for x in (start, stop))
                wave = 1j * torque * cmath.exp(1j * math.pi * (start - first) / angle)
                slope = (later - level) / (stop - start) * speed
                times = begin + start / speed, begin + stop / speed
                yield Piece(*times, wave * level, wave * slope, 1j * math.pi * speed / angle)
