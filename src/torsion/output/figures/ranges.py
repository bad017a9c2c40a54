"""What figures have in common: ranges without an answer, the rated speed, and an axis of amplitudes."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.figure import Axis, Band, Level, Line, runs

Bands = tuple[tuple[float, float], ...]
Lines = Sequence[tuple[str, FloatArray]]
SPEED = Axis("speed of the reference component", "rpm")
NO_RELIABLE_ANSWER = "no reliable answer here"
LEAST = 2e-3  # of the axis: the width of a range about a single speed, so that it can be seen
LOGARITHMIC = 30.0  # times the median: a larger peak makes the axis logarithmic
MOST_DECADES = 1e7  # from the lowest to the highest value of a logarithmic axis
MAIN = 1.8  # times the width of other lines: of the one that matters most
MOST_LINES = 12  # in one figure
MOST_ORDERS, LARGEST = (
    8,
    7,
)  # orders in one figure; of more the largest and the envelope of the others


def unanswered(
    x: FloatArray, bad: BoolArray, name: str = NO_RELIABLE_ANSWER
) -> tuple[BoolArray, tuple[Band, ...]]:
    """Return ranges where `bad` holds, from neighbour to neighbour, and (points,) those inside, which are left blank."""
    inside, bands = np.array(bad, dtype=bool), list[Band]()
    narrowest = float(x[-1] - x[0]) * LEAST
    for first, last in runs(inside.copy()):
        left, right = float(x[max(first - 1, 0)]), float(x[min(last + 1, len(x) - 1)])
        if right - left < narrowest:
            middle = (left + right) / 2
            left, right = middle - narrowest / 2, middle + narrowest / 2
        inside |= (x > left) & (x < right)
        bands.append(Band(name, left, right, "no answer"))
    return inside, tuple(bands)


def barred_bands(barred: Bands, unstable: Bands = ()) -> tuple[Band, ...]:
    """Return the bands of the barred and the unstable ranges of speed, rpm."""
    return (
        *(Band("barred range", low, high, "barred") for low, high in barred),
        *(Band("unstable range", low, high, "unstable") for low, high in unstable),
    )


def rated_level(rated: float | None) -> tuple[Level, ...]:
    """Return the rated speed, rpm, where there is one."""
    return () if rated is None else (Level("rated speed", rated, "rated", "x"),)


def amplitudes(
    quantity: str, unit: str, values: Sequence[FloatArray], limits: Sequence[float] = ()
) -> Axis:
    """Return an axis from zero, or in logarithms where a resonance would leave all else on the axis; as far as the limits."""
    positive = np.concatenate(
        [np.ravel(v)[np.isfinite(np.ravel(v)) & (np.ravel(v) > 0)] for v in values] or [np.zeros(0)]
    )
    if positive.size == 0 or positive.max() <= LOGARITHMIC * np.median(positive):
        return Axis(quantity, unit, low=0.0)
    lowest = max(float(positive.min()), float(positive.max()) / MOST_DECADES)
    return Axis(
        quantity,
        unit,
        low=lowest / 1.5,
        high=max([2.0 * float(positive.max()), *(1.5 * limit for limit in limits)]),
        is_log=True,
    )


def orders(x: FloatArray, lines: Lines, hidden: BoolArray) -> tuple[Line, ...]:
    """Return one line an order, its number at its peak; the order with the largest value is heavier.

    Of more than MOST_ORDERS the largest are drawn, and at every place the largest value of the others. An order of
    nothing is left out.
    """
    drawn = [(name, np.where(hidden, np.nan, values)) for name, values in lines]
    sizes = [float(np.max(values, where=np.isfinite(values), initial=0.0)) for _, values in drawn]
    ranked = [k for k in sorted(range(len(sizes)), key=lambda k: -sizes[k]) if sizes[k] > 0]
    shown = ranked if len(ranked) <= MOST_ORDERS else ranked[:LARGEST]
    drawn_lines = [
        Line(
            drawn[k][0],
            x,
            drawn[k][1],
            pen,
            drawn[k][0].removeprefix("order "),
            weight=MAIN if len(sizes) > 1 and k == ranked[0] else 1.0,
        )
        for pen, k in enumerate(sorted(shown))
    ]
    if remaining := ranked[len(shown) :]:
        largest = np.fmax.reduce([drawn[k][1] for k in remaining])
        drawn_lines.append(Line(f"envelope of the other {len(remaining)}", x, largest, "pale"))
    return tuple(drawn_lines)


def span(axis: Axis, x: FloatArray) -> Axis:
    """Return the axis from the first to the last value."""
    return Axis(axis.quantity, axis.unit, float(np.min(x)), float(np.max(x)))
