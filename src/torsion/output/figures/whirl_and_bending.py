"""Bending of a shaft over speed: whirl frequencies with the orders that meet them, and the answer to the couples."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from torsion.output.figures.style import (
    BAD,
    COLOURS,
    GREY,
    INK,
    PALE,
    amplitude_axis,
    legend_below,
    page,
    pens,
    rated_line,
)

Array = NDArray[np.float64]
Crossing = tuple[float, float, bool]  # rpm, Hz, inside the speed range
SENSES: tuple[
    tuple[float, str, dict[str, Any]], ...
] = (  # least direction, label, pen; an orbit between the limits is nearly a straight line
    (0.1, "forward", {"color": COLOURS[0], "linestyle": "-", "zorder": 2.0}),
    (-0.1, "nearly in a plane", {"color": COLOURS[2], "linestyle": "-.", "zorder": 2.1}),
    (-2.0, "backward", {"color": COLOURS[1], "linestyle": "--", "zorder": 2.2}),
)
AHEAD = 1.6  # times the highest frequency that an order reaches: so far up a mode is shown though no order meets it
STANDING = "nearly singular: next to a resonance that nothing damps"
NO_ANSWER = "singular: no answer"


def whirl(
    name: str, *, speed: Array, frequency: Array, direction: Array, unstable: NDArray[np.bool_],
    orders: Sequence[tuple[float, str]], crossings: Sequence[Crossing], rated: float | None,
) -> str:  # fmt: skip
    """speed: (speeds,) rpm; frequency, Hz, direction and unstable: (speeds, modes).

    orders: (frequency of the order at the last speed, Hz; label).
    """
    right = 1.08 * float(speed[-1])
    top = _top(frequency, max(at for at, _ in orders), crossings)
    with page(name, 3.6) as sheet:
        axes = sheet.axes[0]
        axes.axvspan(float(speed[0]), float(speed[-1]), facecolor=PALE, linewidth=0, label="speed range", zorder=0)
        for column, sense in zip(frequency.T, direction.T, strict=True):
            _whirling(axes, speed, column, sense)
        if np.any(unstable):
            rows, columns = np.nonzero(unstable)
            axes.plot(
                speed[rows], frequency[rows, columns], "x", color=BAD, linestyle="none", label="UNSTABLE", zorder=6
            )
        for at, label in orders:
            end = right / float(speed[-1])
            axes.plot([0.0, right], [0.0, at * end], color=GREY, linewidth=0.9, linestyle="-")
            share = min(1.0, top / (at * end))
            axes.annotate(label, (share * right, share * at * end), xytext=(-8, 2), textcoords="offset points",
                          ha="right", fontsize=7.5, color=INK)  # fmt: skip
        _met(axes, [c for c in crossings if c[0] <= right and c[1] <= top])
        rated_line(axes, rated)
        axes.set_xlim(0.0, right)
        axes.set_ylim(0.0, top)
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel("frequency of bending, Hz")
        legend_below(sheet)
    return sheet.svg


def bending(
    name: str, *, speed: Sequence[Array], orders: Sequence[str], panels: Sequence[tuple[str, Sequence[Array]]],
    near: Sequence[NDArray[np.bool_]], singular: Sequence[NDArray[np.bool_]], rated: float | None,
    crossings: Sequence[float],
) -> str:  # fmt: skip
    """Curves of every order over its own speeds, rpm; panels: (quantity with its unit, a curve for each order).

    near, singular: of every order (speeds,), its lines that are not to be trusted. crossings: rpm of critical speeds.
    """
    with page(name, 1.2 + 1.45 * len(panels), len(panels), sharex=True) as sheet:
        for axes, (quantity, curves) in zip(sheet.axes, panels, strict=True):
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
        sheet.axes[-1].set_xlim(min(float(one[0]) for one in speed), max(float(one[-1]) for one in speed))
        sheet.axes[-1].set_xlabel("speed of the reference component, rpm")
        legend_below(sheet)
    return sheet.svg


def _whirling(axes: Axes, speed: Array, frequency: Array, sense: Array) -> None:
    """One mode in the pens of its senses; a piece reaches to the next speed, so that no gap stands between two."""
    above = np.inf
    for least, label, pen in SENSES:
        here = (sense >= least) & (sense < above)
        above = least
        if here.any():
            shown = here | np.append(False, here[:-1])
            axes.plot(speed, np.where(shown, frequency, np.nan), label=label, **pen)


def _met(axes: Axes, crossings: Sequence[Crossing]) -> None:
    for inside, marker, colour, label in ((True, "o", INK, "critical speed in the range"),
                                          (False, "o", "#999999", "critical speed outside the range")):  # fmt: skip
        met = np.array([(rpm, hertz) for rpm, hertz, is_inside in crossings if is_inside == inside])
        if len(met):
            axes.plot(met[:, 0], met[:, 1], marker, color=colour, linestyle="none", label=label, zorder=5)


def _top(frequency: Array, reached: float, crossings: Sequence[Crossing]) -> float:
    """What the orders meet, and of the modes above it those near."""
    inside = max((hertz for _, hertz, is_inside in crossings if is_inside), default=0.0)
    known = frequency[np.isfinite(frequency)]
    lowest = float(known.min()) if known.size else 0.0
    near = known[known <= AHEAD * reached]
    return 1.1 * max(inside, float(near.max()) if near.size else 1.2 * lowest, reached)
