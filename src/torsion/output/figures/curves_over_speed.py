"""Torques, stresses and amplitudes as curves over the speed, or over the frequency."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from torsion.output.figures import style
from torsion.output.figures.style import BAD, COLOURS, GREY, INK, MOST_LINES, hatch, pens

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Bands = tuple[tuple[float, float], ...]
Lines = Sequence[tuple[str, Array]]
SPEED = "speed of the reference component, rpm"
FIRST = ("--", ":", "-.")  # dashes of the first order
LIMIT: dict[str, Any] = {"color": BAD, "linewidth": 1.0, "linestyle": (0, (5, 2))}


@contextmanager
def over(
    name: str, height: float, x: Array, y: str, *, quantity: str = SPEED, rated: float | None = None,
    bands: Sequence[tuple[Bands, str]] = (), amplitudes: list[Array] | None = None,
) -> Iterator[style.Page]:  # fmt: skip
    """A sheet with ranges of speed behind its curves; `amplitudes`, which the caller fills, set the vertical axis."""
    with style.page(name, height) as sheet:
        axes = sheet.axes[0]
        for ranges, label in bands:
            style.ranges(axes, ranges, label)
        yield sheet
        style.rated_line(axes, rated)
        axes.set_xlim(float(x.min()), float(x.max()))
        if amplitudes is not None:
            style.amplitude_axis(axes, amplitudes)
        axes.set_xlabel(quantity)
        axes.set_ylabel(y)
        style.legend_below(sheet)


def torque(
    name: str, *, speed: Array, lines: Lines, synthesis: Array | None, bad: Flags, unit: str,
    limits: Sequence[tuple[str, float]] = (), rated: float | None = None, barred: Bands = (), unstable: Bands = (),
) -> str:  # fmt: skip
    """speed, bad: (speeds,) rpm; lines: (label, (speeds,)) and synthesis in `unit`, NaN where there is no answer."""
    bands, drawn = [(barred, "barred range"), (unstable, "unstable range")], list[Array]()
    with over(name, 2.75, speed, f"torque amplitude, {unit}", rated=rated, bands=bands, amplitudes=drawn) as sheet:
        axes = sheet.axes[0]
        hidden = hatch(axes, speed, bad)
        good = [np.where(hidden, np.nan, values) for _, values in lines]
        for (label, _), values, pen in zip(lines, good, pens(len(lines)), strict=True):
            axes.plot(speed, values, label=label, linewidth=1.0, **pen)
        drawn += good if synthesis is None else [np.where(hidden, np.nan, synthesis)]
        if synthesis is not None:
            axes.plot(speed, drawn[0], color=INK, linewidth=1.7, label="synthesis (half range)")
        for label, limit in limits:
            if limit <= 4.0 * axes.get_ylim()[1]:
                axes.axhline(limit, label=label, **LIMIT)
    return sheet.svg


def stress(
    name: str, *, speed: Array, synthesis: Array, bad: Flags, continuous: Array | None = None,
    transient: Array | None = None, rated: float | None = None, barred: Bands = (),
) -> str:  # fmt: skip
    """Shear stress of one shaft; speed: (speeds,) rpm; stresses (speeds,) N/mm2, NaN where there is no limit."""
    bands, drawn = [(barred, "barred range")], list[Array]()
    with over(name, 2.75, speed, "shear stress amplitude, N/mm²", rated=rated, bands=bands, amplitudes=drawn) as sheet:
        axes = sheet.axes[0]
        drawn.append(np.where(hatch(axes, speed, bad), np.nan, synthesis))
        axes.plot(speed, drawn[0], color=INK, linewidth=1.6, label="stress (synthesis)")
        if continuous is not None:
            axes.plot(speed, continuous, color=BAD, label="limit τ_C, continuous")
        if transient is not None and np.any(np.isfinite(transient)):
            axes.plot(speed, transient, color=COLOURS[1], linestyle="--", label="limit τ_T, passing rapidly")
    return sheet.svg


def gear(
    name: str, *, speed: Array, vibratory: Array, mean: Array | None, bad: Flags, unit: str,
    limit: float | None = None, rated: float | None = None, barred: Bands = (),
) -> str:  # fmt: skip
    """Vibratory against mean torque in one gear mesh; speed: (speeds,) rpm; torques (speeds,) in `unit`."""
    bands, drawn = [(barred, "barred range")], list[Array]()
    with over(name, 2.75, speed, f"mesh torque, {unit}", rated=rated, bands=bands, amplitudes=drawn) as sheet:
        axes = sheet.axes[0]
        good = np.where(hatch(axes, speed, bad), np.nan, vibratory)
        drawn.append(good)
        axes.plot(speed, good, color=INK, linewidth=1.6, label="vibratory torque (synthesis)")
        if mean is not None:
            axes.plot(speed, mean, color=COLOURS[0], label="mean torque")
            reverses: dict[str, Any] = {"color": BAD, "alpha": 0.25, "linewidth": 0, "label": "torque reverses"}
            axes.fill_between(speed, mean, good, where=good > mean, **reverses)
        if limit is not None:
            axes.axhline(limit, label="limit of the vibratory torque", **LIMIT)
    return sheet.svg


def steady(name: str, *, speed: Array, lines: Lines, unit: str, rated: float | None = None) -> str:
    """Mean torque of the elements; speed: (speeds,) rpm; lines: (label, (speeds,)) in `unit`."""
    with over(name, 2.6, speed, f"mean torque, {unit}", rated=rated) as sheet:
        for (label, values), pen in zip(lines[:MOST_LINES], pens(len(lines[:MOST_LINES])), strict=True):
            sheet.axes[0].plot(speed, values, label=label, **pen)
    return sheet.svg


def frequency(
    name: str, *, frequency: Array, lines: Lines, bad: Flags, quantity: str, natural: Sequence[float] = ()
) -> str:
    """frequency: (frequencies,) Hz; lines: (label, (frequencies,)); quantity: what the axis says, with its unit."""
    drawn = list[Array]()
    with over(name, 3.0, frequency, quantity, quantity="frequency, Hz", amplitudes=drawn) as sheet:
        axes = sheet.axes[0]
        hidden = hatch(axes, frequency, bad)
        for at in natural:
            if frequency[0] <= at <= frequency[-1]:
                axes.axvline(at, color=GREY, linewidth=0.5, linestyle=":", label="natural frequencies")
        drawn += [np.where(hidden, np.nan, values) for _, values in lines]
        for (label, _), values, pen in zip(lines[:MOST_LINES], drawn, pens(len(lines[:MOST_LINES])), strict=False):
            axes.plot(frequency, np.where(values <= 0, np.nan, values), label=label, linewidth=1.0, **pen)
    return sheet.svg


def periodic(
    name: str, *, first_speed: Array, speed: Array, lines: Sequence[tuple[str, Array | None, Array]], unit: str,
    none: Flags, coarse: Flags, grows: Flags, unstable: Bands = (), rated: float | None = None,
) -> str:  # fmt: skip
    """Speeds in rpm; lines: (label, (first speeds,) or None, (speeds,)) in `unit`, NaN where there is no answer.

    none, coarse, grows: (speeds,) no periodic motion, not resolved, unstable.
    """
    bands, both = [(unstable, "unstable range")], np.append(first_speed, speed)
    drawn = [value for _, first, exact in lines for value in (first, exact) if value is not None] or [np.zeros(1)]
    with over(name, 2.9, both, f"torque amplitude, {unit}", rated=rated, bands=bands, amplitudes=drawn) as sheet:
        axes = sheet.axes[0]
        if np.any(none):
            hatch(axes, speed, none, "no periodic motion found")
        for k, ((label, first, exact), pen) in enumerate(zip(lines, pens(len(lines)), strict=True)):
            axes.plot(speed, exact, color=pen["color"], linewidth=2.2, alpha=0.45, label=f"{label}, exact")
            axes.plot(speed, exact, ".", color=pen["color"], markersize=3, label="speeds solved")
            if first is not None:
                axes.plot(first_speed, first, color=INK, linewidth=0.9, linestyle=FIRST[k % len(FIRST)],
                          label=f"{label}, first order", zorder=4)  # fmt: skip
            for flags, marker, words in ((grows, "x", "unstable motion"), (coarse, "s", "not resolved")):
                if np.any(flags):
                    flag: dict[str, Any] = {"fillstyle": "none", "linestyle": "none", "label": words, "zorder": 5}
                    axes.plot(speed[flags], exact[flags], marker, color=BAD, **flag)
    return sheet.svg
