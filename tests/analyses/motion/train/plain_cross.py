"""The motion of a cross joint in plain numbers, for references that ask for it at every step."""

import math
from typing import NamedTuple


class Turned(NamedTuple):
    """Driven angle less driving angle, speed ratio and its slope over the driving angle."""

    error: float
    ratio: float
    curvature: float


def turn_cross(angle: float, bend: float, *, driving_yoke_in_plane: bool = True) -> Turned:
    """tan(driven) = c tan(driving), c = 1/cos(bend) or cos(bend) by the yoke that stands in the plane at 0."""
    c = 1.0 / math.cos(bend) if driving_yoke_in_plane else math.cos(bend)
    sine, cosine = math.sin(angle), math.cos(angle)
    divisor = cosine**2 + (c * sine) ** 2
    error = math.atan2((c - 1.0) * sine * cosine, cosine**2 + c * sine**2)
    return Turned(error, c / divisor, -2.0 * c * (c**2 - 1.0) * sine * cosine / divisor**2)
