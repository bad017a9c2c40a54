"""The profile of a round shaft line as it is drawn: cylinders and cones with sharp, rounded or chamfered corners."""

import math
from dataclasses import dataclass, replace
from itertools import accumulate, pairwise
from typing import Literal

import numpy as np

from torsion.kernels.round_sections import polar_area_moment

CornerKind = Literal["fillet", "chamfer"]
REACH = 3.0  # walls of a shaft that are kept beyond a junction; a disturbance decays to 6e-9 or less along it and back


@dataclass(frozen=True)
class Length:
    """A cylinder or cone of the line; diameters at its two ends, all in one unit of length."""

    length: float
    outer: tuple[float, float]
    bore: tuple[float, float] = (0.0, 0.0)
    modulus: float = 1.0  # shear modulus / that of the whole

    @property
    def twist(self) -> float:
        """Angle at a torque of 1 and a shear modulus of 1, its sections plane: the integral of 1/I_p."""
        (first, last), (begin, end) = self.outer, self.bore
        if begin == end == 0.0:
            mean = (first * first + first * last + last * last) / (3.0 * (first * last) ** 3)
            return 32.0 / math.pi * self.length * mean / self.modulus
        if first == last and begin == end:
            return self.length / float(polar_area_moment(first, begin)) / self.modulus
        raise ValueError("a bored cone has no closed form here")


@dataclass(frozen=True)
class Corner:
    """What fills the corner between a shaft and the face of a larger one."""

    kind: CornerKind
    size: float  # radius, or leg of a chamfer of 45 degrees

    def legs(self, height: float) -> tuple[float, float]:
        """How far it reaches along the shaft and up the face of a step of some height."""
        up = min(self.size, height)
        if self.kind == "chamfer":
            return up, up
        return math.sqrt(up * (2.0 * self.size - up)), up

    def polar_moment(self, radius: float, height: float) -> float:
        """Integral of r^2 over what fills the corner of a step of some height on a radius: its inertia by its density.

        >>> round(Corner("chamfer", 1.0).polar_moment(2.0, 1.0), 9)  # pi/2 ((3^5 - 2^5)/5 - 2^4)
        41.154863762
        """
        point, weight = np.polynomial.legendre.leggauss(16)
        up = min(self.size, height)
        if self.kind == "chamfer":
            rise, along = 0.5 * up * (1.0 + point), np.full(16, 0.5 * up)
        else:
            half = 0.5 * math.acos(1.0 - up / self.size)
            turned = half * (1.0 + point)
            rise, along = self.size * (1.0 - np.cos(turned)), self.size * half * np.cos(turned)
        ring = (
            rise * (2.0 * radius + rise) * (radius**2 + (radius + rise) ** 2)
        )  # (radius + rise)^4 - radius^4
        return float(0.5 * math.pi * (weight * ring * along).sum())


@dataclass(frozen=True)
class Profile:
    """Lengths one after another, and what fills the corner between each and the next (None: sharp)."""

    lengths: tuple[Length, ...]
    corners: tuple[Corner | None, ...]
    # Last length a hub: its outer surface, or its face around the shaft.
    fixed: Literal["end", "rim", "face"] = "end"

    @property
    def seat(self) -> float:
        """Radius at which a hub of another material than its shaft begins; 0 where there is none."""
        shaft, hub = self.lengths[0], self.lengths[-1]
        return 0.0 if self.fixed == "end" or shaft.modulus == hub.modulus else shaft.outer[1] / 2.0

    @property
    def places(self) -> tuple[float, ...]:
        """Where the lengths end, from 0 on."""
        return tuple(accumulate((length.length for length in self.lengths), initial=0.0))

    @property
    def smaller(self) -> Length:
        """The end with the smaller outer diameter: its torsion is the measure of what is in excess."""
        first, last = self.lengths[0], self.lengths[-1]
        return first if first.outer[0] <= last.outer[1] else last


def junction(
    smaller: tuple[float, float],
    larger: tuple[float, float],
    corner: Corner | None = None,
    *,
    moduli: tuple[float, float] = (1.0, 1.0),
    between: tuple[Length, ...] = (),
) -> Profile:
    """Two long shafts (diameter, bore) that meet in a face; between: what stands there (undercut, cone, flange).

    The corner is the one at the last face upward, where the larger shaft begins.

    >>> profile = junction((1.0, 0.0), (2.0, 0.0), Corner("fillet", 0.1))
    >>> [one.outer for one in profile.lengths]
    [(1.0, 1.0), (2.0, 2.0)]
    """
    height = abs(larger[0] - (between[-1].outer[1] if between else smaller[0])) / 2.0
    legs = (corner.legs(height)[0] if corner is not None else 0.0), 0.0
    ends = [
        Length(REACH * (outer - bore) / 2.0 + leg, (outer, outer), (bore, bore), modulus)
        for (outer, bore), leg, modulus in zip((smaller, larger), legs, moduli, strict=True)
    ]
    lengths = (ends[0], *between, ends[1])
    corners: list[Corner | None] = [None] * (len(lengths) - 1)
    up = [
        joint
        for joint, (before, after) in enumerate(pairwise(lengths))
        if after.outer[0] > before.outer[1]
    ]
    if up:
        corners[up[-1]] = corner
    return Profile(lengths, tuple(corners))


def mirrored(profile: Profile) -> Profile:
    """The line from its other end."""
    turned = (
        replace(length, outer=length.outer[::-1], bore=length.bore[::-1])
        for length in reversed(profile.lengths)
    )
    return Profile(tuple(turned), profile.corners[::-1])
