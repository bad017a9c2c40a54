"""Engines: pressure and tangential pressure over the cycle, harmonics of a cylinder, and misfires over the speed."""

from collections.abc import Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import span

MOST_NAMED = 3  # diagrams whose motored pressures have names of their own
Curve = tuple[
    str, FloatArray, FloatArray, FloatArray, FloatArray
]  # name; deg; absolute, motored, tangential [bar]


def diagram(name: str, caption: str, curves: Sequence[Curve]) -> Figure:
    """Pressures over the crank angle."""
    angle = np.concatenate([curve[1] for curve in curves])
    x = span(Axis("crank angle from firing top dead centre", "deg"), angle)
    several = len(curves) > 1
    upper = [
        line
        for k, (own, at, firing, motored, _) in enumerate(curves)
        for line in (
            Line(own if several else "firing", at, firing, k, weight=1.5),
            Line(
                f"{own}, motored" if 1 < len(curves) <= MOST_NAMED else "motored",
                at,
                motored,
                "pale",
            ),
        )
    ]
    lower = [
        Line(own if several else "firing", at, t, k, weight=1.5)
        for k, (own, at, _, _, t) in enumerate(curves)
    ]
    return Figure(
        name,
        caption,
        (
            Panel(x, Axis("pressure, absolute", "bar", low=0.0), tuple(upper)),
            Panel(
                x,
                Axis("tangential pressure", "bar"),
                tuple(lower),
                (Level("", 0.0, "zero"),),
                height=70.0,
            ),
        ),
    )


def harmonics(
    name: str, caption: str, order: FloatArray, sizes: Sequence[tuple[str, FloatArray]], unit: str
) -> Figure:
    """Amplitudes (orders,) of the torque of a cylinder over the order."""
    lines = tuple(
        Line(words, order, size, k, weight=1.5 if k == 0 else 1.0, symbol="dot")
        for k, (words, size) in enumerate(sizes)
    )
    return Figure(
        name, caption, (Panel(span(Axis("order"), order), Axis("amplitude", unit, low=0.0), lines),)
    )


def misfires(
    name: str, caption: str, speed: FloatArray, curves: Sequence[tuple[str, FloatArray]], unit: str
) -> Figure:
    """Half ranges over the speed (rpm): the first curve with every cylinder firing, then each without one."""
    lines = tuple(
        Line(
            words,
            speed,
            half,
            k,
            weight=2.0 if k == 0 else 1.0,
            label="" if k == 0 else words,
            label_at="anywhere",
        )
        for k, (words, half) in enumerate(curves)
    )
    panel = Panel(span(Axis("speed", "rpm"), speed), Axis("torque amplitude", unit, low=0.0), lines)
    return Figure(name, caption, (panel,))
