"""Natural frequencies over the speed with the orders that meet them: Campbell diagram, and whirl of a shaft."""

from collections.abc import Iterator, Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Line, Marks, Role

Crossing = tuple[float, float, bool, str]  # rpm, Hz, inside the speed range, what meets what
SENSES: tuple[
    tuple[float, Role], ...
] = (  # least direction; an orbit between is nearly a straight line
    (0.1, "forward"),
    (-0.1, "nearly in a plane"),
    (-2.0, "backward"),
)
AHEAD = 1.6  # times the highest frequency that an order reaches: so far up a mode is shown though no order meets it


def whirling(speed: FloatArray, frequency: FloatArray, sense: FloatArray) -> Iterator[Line]:
    """Yield one mode in the pens of its senses; a piece reaches to the next speed, so that there is no gap."""
    above = np.inf
    for lowest, role in SENSES:
        is_sense = (sense >= lowest) & (sense < above)
        above = lowest
        if is_sense.any():
            shown = is_sense | np.append(False, is_sense[:-1])
            yield Line(role, speed, np.where(shown, frequency, np.nan), role)


def met(crossings: Sequence[Crossing], right: float, top: float) -> Iterator[Marks]:
    """Yield the crossings that lie on the diagram, which goes from nothing to these two ends."""
    for inside, words in (
        (True, "critical speed in the range"),
        (False, "critical speed outside the range"),
    ):
        met = [
            crossing
            for crossing in crossings
            if crossing[2] == inside and crossing[0] <= right and crossing[1] <= top
        ]
        if met:
            x, y = np.array([crossing[:2] for crossing in met]).T
            words_of = tuple(crossing[3] for crossing in met)
            yield Marks(
                words,
                x,
                y,
                "disc" if inside else "cross",
                "plain" if inside else "outside",
                words=words_of,
            )


def highest_shown(frequency: FloatArray, reached: float, crossings: Sequence[Crossing]) -> float:
    """Return the highest frequency shown: what the orders meet, and the modes near above it."""
    inside = max((hertz for _, hertz, is_inside, _ in crossings if is_inside), default=0.0)
    finite = frequency[np.isfinite(frequency)]
    lowest = float(finite.min()) if finite.size else 0.0
    near = finite[finite <= AHEAD * reached]
    return 1.1 * max(inside, float(near.max()) if near.size else 1.2 * lowest, reached)
