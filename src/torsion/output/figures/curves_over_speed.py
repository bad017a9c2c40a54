"""Torques, stresses, bending and growth rates as curves over the speed, or over the frequency."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.style import (
    BAD,
    COLOURS,
    GREY,
    INK,
    MOST_LINES,
    amplitude_axis,
    hatch,
    pens,
    plots,
    ranges,
    rated_line,
)

Bands = tuple[tuple[float, float], ...]
Lines = Sequence[tuple[str, FloatArray]]
SPEED = "speed of the reference component, rpm"
FIRST = ("--", ":", "-.")  # dashes of the first order
LIMIT: dict[str, Any] = {"color": BAD, "linewidth": 1.0, "linestyle": (0, (5, 2))}
STANDING = "nearly singular: next to a resonance that nothing damps"
NO_ANSWER = "singular: no answer"
NO_MOTION = "no periodic motion found"
GROWTH_COLOURS = "RdBu_r"
HEAD = 0.25  # of the height: room above the growth rate for the names of the ranges
SHARE = 0.98  # of the points lie within the colours of a map; the others have the last one


@contextmanager
def over(
    sheet: Figure, height: float, x: FloatArray, y: str, *, quantity: str = SPEED, rated: float | None = None,
    barred: Bands = (), unstable: Bands = (),
) -> Iterator[Axes]:  # fmt: skip
    """One plot over x, with ranges of speed behind its curves."""
    (axes,) = plots(sheet, height)
    ranges(axes, barred)
    ranges(axes, unstable, "unstable range")
    yield axes
    rated_line(axes, rated)
    axes.set_xlim(float(x.min()), float(x.max()))
    axes.set_xlabel(quantity)
    axes.set_ylabel(y)


def torque(
    sheet: Figure, *, speed: FloatArray, lines: Lines, synthesis: FloatArray | None, bad: BoolArray, unit: str,
    limits: Sequence[tuple[str, float]] = (), rated: float | None = None, barred: Bands = (), unstable: Bands = (),
) -> None:  # fmt: skip
    """speed, bad: (speeds,) rpm; lines: (label, (speeds,)) and synthesis in `unit`, NaN where there is no answer."""
    y = f"torque amplitude, {unit}"
    with over(sheet, 2.75, speed, y, rated=rated, barred=barred, unstable=unstable) as axes:
        hidden = hatch(axes, speed, bad)
        drawn = [np.where(hidden, np.nan, values) for _, values in lines]
        for (label, _), values, pen in zip(lines, drawn, pens(len(lines)), strict=True):
            axes.plot(speed, values, label=label, linewidth=1.0, **pen)
        if synthesis is not None:
            drawn = [np.where(hidden, np.nan, synthesis)]
            axes.plot(speed, drawn[0], color=INK, linewidth=1.7, label="synthesis (half range)")
        for label, limit in limits:
            if limit <= 4.0 * axes.get_ylim()[1]:
                axes.axhline(limit, label=label, **LIMIT)
        amplitude_axis(axes, drawn)


def stress(
    sheet: Figure, *, speed: FloatArray, synthesis: FloatArray, bad: BoolArray, continuous: FloatArray | None = None,
    transient: FloatArray | None = None, rated: float | None = None, barred: Bands = (),
) -> None:  # fmt: skip
    """Shear stress of one shaft; speed: (speeds,) rpm; stresses (speeds,) N/mm2, NaN where there is no limit."""
    with over(sheet, 2.75, speed, "shear stress amplitude, N/mm²", rated=rated, barred=barred) as axes:
        good = np.where(hatch(axes, speed, bad), np.nan, synthesis)
        axes.plot(speed, good, color=INK, linewidth=1.6, label="stress (synthesis)")
        if continuous is not None:
            axes.plot(speed, continuous, color=BAD, label="limit τ_C, continuous")
        if transient is not None and np.any(np.isfinite(transient)):
            axes.plot(speed, transient, color=COLOURS[1], linestyle="--", label="limit τ_T, passing rapidly")
        amplitude_axis(axes, [good])


def gear(
    sheet: Figure, *, speed: FloatArray, vibratory: FloatArray, mean: FloatArray | None, bad: BoolArray, unit: str,
    limit: float | None = None, rated: float | None = None, barred: Bands = (),
) -> None:  # fmt: skip
    """Vibratory against mean torque in one gear mesh; speed: (speeds,) rpm; torques (speeds,) in `unit`."""
    with over(sheet, 2.75, speed, f"mesh torque, {unit}", rated=rated, barred=barred) as axes:
        good = np.where(hatch(axes, speed, bad), np.nan, vibratory)
        axes.plot(speed, good, color=INK, linewidth=1.6, label="vibratory torque (synthesis)")
        if mean is not None:
            axes.plot(speed, mean, color=COLOURS[0], label="mean torque")
            reverses: dict[str, Any] = {"color": BAD, "alpha": 0.25, "linewidth": 0, "label": "torque reverses"}
            axes.fill_between(speed, mean, good, where=good > mean, **reverses)
        if limit is not None:
            axes.axhline(limit, label="limit of the vibratory torque", **LIMIT)
        amplitude_axis(axes, [good])


def steady(sheet: Figure, *, speed: FloatArray, lines: Lines, unit: str, rated: float | None = None) -> None:
    """Mean torque of the elements; speed: (speeds,) rpm; lines: (label, (speeds,)) in `unit`."""
    with over(sheet, 2.6, speed, f"mean torque, {unit}", rated=rated) as axes:
        for (label, values), pen in zip(lines[:MOST_LINES], pens(MOST_LINES), strict=False):
            axes.plot(speed, values, label=label, **pen)


def frequency(
    sheet: Figure, *, frequency: FloatArray, lines: Lines, bad: BoolArray, quantity: str, natural: Sequence[float] = ()
) -> None:
    """frequency: (frequencies,) Hz; lines: (label, (frequencies,)); quantity: what the axis says, with its unit."""
    with over(sheet, 3.0, frequency, quantity, quantity="frequency, Hz") as axes:
        hidden = hatch(axes, frequency, bad)
        for at in natural:
            if frequency[0] <= at <= frequency[-1]:
                axes.axvline(at, color=GREY, linewidth=0.5, linestyle=":", label="natural frequencies")
        drawn = [np.where(hidden, np.nan, values) for _, values in lines]
        for (label, _), values, pen in zip(lines[:MOST_LINES], drawn, pens(MOST_LINES), strict=False):
            axes.plot(frequency, np.where(values <= 0, np.nan, values), label=label, linewidth=1.0, **pen)
        amplitude_axis(axes, drawn)


def periodic(
    sheet: Figure, *, first_speed: FloatArray, speed: FloatArray,
    lines: Sequence[tuple[str, FloatArray | None, FloatArray]], unit: str, none: BoolArray, coarse: BoolArray,
    grows: BoolArray, unstable: Bands = (), rated: float | None = None,
) -> None:  # fmt: skip
    """Speeds in rpm; lines: (label, (first speeds,) or None, (speeds,)) in `unit`, NaN where there is no answer.

    none, coarse, grows: (speeds,) no periodic motion, not resolved, unstable.
    """
    both = np.append(first_speed, speed)
    with over(sheet, 2.9, both, f"torque amplitude, {unit}", rated=rated, unstable=unstable) as axes:
        if np.any(none):
            hatch(axes, speed, none, NO_MOTION)
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
        amplitude_axis(axes, [value for _, first, exact in lines for value in (first, exact) if value is not None])


def bending(
    sheet: Figure, *, speed: Sequence[FloatArray], orders: Sequence[str],
    panels: Sequence[tuple[str, Sequence[FloatArray]]], near: Sequence[BoolArray], singular: Sequence[BoolArray],
    rated: float | None, crossings: Sequence[float],
) -> None:  # fmt: skip
    """Curves of every order over its own speeds, rpm; panels: (quantity with its unit, a curve for each order).

    near, singular: of every order (speeds,), its lines that are not to be trusted. crossings: rpm of critical speeds.
    """
    every = plots(sheet, 1.2 + 1.45 * len(panels), len(panels), sharex=True)
    for axes, (quantity, curves) in zip(every, panels, strict=True):
        for at in crossings:
            axes.axvline(at, color=GREY, linewidth=0.5, linestyle=":", label="critical speeds of these orders")
        for k, (label, pen) in enumerate(zip(orders, pens(len(orders)), strict=True)):
            sound = ~(near[k] | singular[k])
            axes.plot(speed[k], np.where(sound, curves[k], np.nan), label=label, **pen)
            axes.plot(speed[k][near[k]], curves[k][near[k]], "x", color=BAD, linestyle="none",
                      label=STANDING if near[k].any() else "_")  # fmt: skip
            if singular[k].any():
                axes.plot(speed[k][singular[k]], np.ones(int(singular[k].sum())), "v", color=BAD, linestyle="none",
                          transform=axes.get_xaxis_transform(), clip_on=False, label=NO_ANSWER)  # fmt: skip
        rated_line(axes, rated)
        amplitude_axis(axes, curves)
        if axes.get_yscale() == "linear":
            axes.yaxis.set_major_locator(MaxNLocator(4))
        axes.set_ylabel(quantity)
    every[-1].set_xlim(min(float(one[0]) for one in speed), max(float(one[-1]) for one in speed))
    every[-1].set_xlabel(SPEED)


def stability(
    sheet: Figure, *, speed: FloatArray, growth: FloatArray, unstable: Sequence[tuple[float, float, str]],
    rated: float | None = None,
) -> None:  # fmt: skip
    """speed: (speeds,) rpm; growth: (speeds,) 1/s, NaN where there is no periodic motion; unstable: rpm and name."""
    missing, bands = ~np.isfinite(growth), tuple((low, high) for low, high, _ in unstable)
    with over(sheet, 3.0, speed, "growth rate, 1/s", rated=rated, unstable=bands) as axes:
        if np.any(missing):
            hatch(axes, speed, missing, NO_MOTION)
        axes.axhline(0.0, color=GREY, linewidth=0.9)
        axes.plot(speed, growth, color=INK, linewidth=1.1, marker=".", markersize=3, label="growth rate")
        inside = np.array([any(low <= n <= high for low, high in bands) for n in speed.tolist()], dtype=bool)
        grows = inside & (growth > 0)
        if np.any(grows):
            axes.plot(speed[grows], growth[grows], ".", color=BAD, markersize=4, label="unstable")
        low_end, top = axes.get_ylim()
        if unstable:
            top += HEAD * (top - low_end)
            axes.set_ylim(low_end, top)
        for k, (low, high, words) in enumerate(unstable):
            axes.annotate(words, ((low + high) / 2.0, top), xytext=(0, -2 - 10 * (k % 3)), textcoords="offset points",
                          fontsize=7.5, ha="center", va="top", color=BAD)  # fmt: skip


def stability_map(
    sheet: Figure, *, speed: FloatArray, value: FloatArray, growth: FloatArray, quantity: str,
    rated: float | None = None,
) -> None:  # fmt: skip
    """speed: (speeds,) rpm; value: (values,); growth: (speeds, values) 1/s, NaN where there is no periodic motion."""
    shown = np.ma.masked_invalid(growth.T)
    known = shown.compressed()
    limit = float(np.quantile(np.abs(known), SHARE)) if known.size else 1.0
    (axes,) = plots(sheet, 3.6)
    axes.patch.set(facecolor="white", edgecolor=BAD, hatch="////")  # seen where there is no value
    axes.grid(visible=False)
    colours: dict[str, Any] = {"cmap": GROWTH_COLOURS, "vmin": -limit, "vmax": limit}
    drawn = axes.pcolormesh(speed, value, shown, shading="nearest", rasterized=True, **colours)
    if known.size and known.min() < 0 < known.max():
        axes.contour(speed, value, shown, levels=[0.0], colors=INK, linewidths=1.1)
    rated_line(axes, rated)
    axes.set_xlabel(SPEED)
    axes.set_ylabel(quantity)
    sheet.colorbar(drawn, ax=axes, extend="both").set_label("growth rate, 1/s (red: unstable)")
