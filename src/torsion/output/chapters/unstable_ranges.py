"""How unstable ranges are stated: by their boundaries, or by where the speeds requested or known end."""

from typing import TYPE_CHECKING

from torsion.output.numbers import RPM, distinct_texts, given_rpm, rpm
from torsion.output.reported_values import widened

if TYPE_CHECKING:
    from torsion.analyses.motion.stability_over_speed import Stability
    from torsion.analyses.motion.unstable_ranges import UnstableRange

BELOW, ABOVE = 0, 1
GOES_ON, UNKNOWN = "+", "?"  # beside a figure, on the terminal
LEGEND = {GOES_ON: "goes on beyond the speeds requested", UNKNOWN: "nothing is known beyond"}


def end(one: "UnstableRange", side: int, digits: int) -> str:
    """An end in rpm with its mark."""
    return rpm((one.first, one.last)[side], digits) + mark(one, side)


def mark(one: "UnstableRange", side: int) -> str:
    """'+' where the range goes on beyond the speeds requested, '?' where nothing is known beyond; '' of a boundary."""
    if one.unknown[side] is not None:
        return UNKNOWN
    return GOES_ON if one.is_open[side] else ""


def legend(found: "tuple[UnstableRange, ...]") -> str:
    """What the marks mean that occur: ' (+ goes on beyond the speeds requested)'; '' of boundaries alone."""
    marks = {mark(one, side) for one in found for side in (BELOW, ABOVE)}
    stated = [f"{sign} {text}" for sign, text in LEGEND.items() if sign in marks]
    return f" ({'; '.join(stated)})" if stated else ""


def fastest(one: "UnstableRange") -> str:
    """The speed of the greatest growth in rpm, in as many digits as set it apart from the ends."""
    return distinct_texts([one.first * RPM, one.at * RPM, one.last * RPM])[1]


def beyond(one: "UnstableRange") -> tuple[str, ...]:
    """What is said of the ends that are no boundaries, in sentences without their stop."""
    first, last = given_rpm(one.first), given_rpm(one.last)
    under, over = one.unknown
    said = []
    if under is not None:
        said.append(f"from {given_rpm(under)} to {first} rpm nothing is known")
    elif one.is_open[BELOW]:
        said.append(f"it goes on below {first} rpm, where stability was not requested")
    if over is not None:
        said.append(f"from {last} to {given_rpm(over)} rpm nothing is known")
    elif one.is_open[ABOVE]:
        said.append(f"it goes on above {last} rpm, where stability was not requested")
    return tuple(said)


def unanswered(found: "Stability") -> list[str]:
    """'from 780 to 900 rpm': the ranges of speed without a periodic motion at which no unstable range ends."""
    beside = [one.first for one in found.ranges if one.unknown[BELOW] is not None]
    beside += [one.last for one in found.ranges if one.unknown[ABOVE] is not None]
    return [
        f"from {given_rpm(low)} to {given_rpm(high)} rpm"
        for low, high in found.unknown
        if not any(low <= end <= high for end in beside)
    ]


def words(one: "UnstableRange", requested: tuple[float, float]) -> str:
    """The range for a restriction of speed: '772.3 to at least 780 rpm, principal of mode 1; from there ...'.

    Boundaries are rounded so that the range grows, but not beyond the speeds requested (rad/s).
    """
    stated = list(widened((one.first * RPM, one.last * RPM), (requested[0] * RPM, requested[1] * RPM)))
    for side, (speed, limit) in enumerate(((one.first, "at most"), (one.last, "at least"))):
        if one.grows_at_end[side]:
            stated[side] = given_rpm(speed)
        if one.unknown[side] is not None:
            stated[side] = f"{limit} {stated[side]}"
    band = f"at {given_rpm(one.first)} rpm" if one.last <= one.first else f"{stated[BELOW]} to {stated[ABOVE]} rpm"
    return "; ".join([f"{band}, {one.name}", *beyond(one)])
