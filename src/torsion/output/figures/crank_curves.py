"""Engines and compressors: pressures over the crank angle, harmonics of a cylinder, misfires, torque of the throws."""

from collections.abc import Mapping, Sequence

import numpy as np

from torsion.analyses.engine.engine_results import CurveFound
from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel
from torsion.output.figures.ranges import span

BAR = 1e-5  # of 1 Pa
MOST_NAMED = 3  # diagrams whose motored pressures have names of their own
PRESSURE = Axis("pressure, absolute", "bar", low=0.0)


def diagram(name: str, caption: str, curves: Sequence[CurveFound]) -> Figure:
    """Return pressures and tangential pressures over the crank angle."""
    pressures, tangential = list[Line](), list[Line]()
    for pen, curve in enumerate(curves):
        title = curve.name.replace("`", "") if len(curves) > 1 else "firing"
        motored = f"{title}, motored" if 1 < len(curves) <= MOST_NAMED else "motored"
        angle = np.degrees(curve.angle)
        pressures += [
            Line(title, angle, curve.pressure * BAR, pen, weight=1.5),
            Line(motored, angle, curve.motored * BAR, "pale"),
        ]
        tangential.append(Line(title, angle, curve.tangential * BAR, pen, weight=1.5))
    angles = np.degrees(np.concatenate([curve.angle for curve in curves]))
    x = span(Axis("crank angle from firing top dead centre", "deg"), angles)
    lower, zero = Axis("tangential pressure", "bar"), (Level("", 0.0, "zero"),)
    return Figure(
        name,
        caption,
        (
            Panel(x, PRESSURE, tuple(pressures)),
            Panel(x, lower, tuple(tangential), zero, height=70.0),
        ),
    )


def misfires(
    name: str, caption: str, speed: FloatArray, curves: Mapping[str, FloatArray], unit: str
) -> Figure:
    """Return amplitudes over the speed (rpm): the first with every cylinder firing, each other without a cylinder."""
    lines = tuple(
        Line(
            words,
            speed,
            torque,
            pen,
            weight=1.0 if pen else 2.0,
            label=words if pen else "",
            label_at="anywhere",
        )
        for pen, (words, torque) in enumerate(curves.items())
    )
    panel = Panel(span(Axis("speed", "rpm"), speed), Axis("torque amplitude", unit, low=0.0), lines)
    return Figure(name, caption, (panel,))


def pressures(
    name: str, caption: str, curves: Sequence[tuple[str, FloatArray, FloatArray]]
) -> Figure:
    """Return the pressures of cylinder ends, each a name, angles [deg] and pressures [bar]."""
    angles = np.concatenate([angle for _, angle, _ in curves])
    x = span(Axis("crank angle from the dead centre of the head end", "deg"), angles)
    lines = tuple(
        Line(title, angle, pressure, pen, weight=1.5)
        for pen, (title, angle, pressure) in enumerate(curves)
    )
    return Figure(name, caption, (Panel(x, PRESSURE, lines),))


def effort(
    name: str, caption: str, angle: FloatArray, throws: Mapping[str, FloatArray], unit: str
) -> Figure:
    """Return the torques (angles,) of every throw, and their sum with its mean, over the crank angle (deg)."""
    lines = [
        Line(title, angle, torque, pen) for pen, (title, torque) in enumerate(throws.items(), 1)
    ]
    total = np.sum(list(throws.values()), axis=0)
    if len(lines) > 1:
        lines.insert(0, Line("all throws", angle, total, 0, weight=2.0))
    mean = Level("mean", float(total[:-1].mean()), "rated", label="mean")
    x = span(Axis("crank angle from reference angle zero", "deg"), angle)
    panel = Panel(x, Axis("torque", unit), tuple(lines), (Level("", 0.0, "zero"), mean))
    return Figure(name, caption, (panel,))
