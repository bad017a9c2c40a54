"""Campbell diagram: natural frequencies, orders and where they meet in the speed range."""

from collections.abc import Sequence

import numpy as np

from torsion.output.figures.style import COLOURS, DASHES, INK, MOST_LINES, PALE, legend_below, page, ranges, rated_line

Crossing = tuple[float, float, bool]  # rpm, Hz, inside the speed range
BACKGROUND = {"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 0.6}


def campbell(
    name: str, *, frequencies: Sequence[float], orders: Sequence[tuple[float, str]],
    crossings: Sequence[Crossing], speeds: tuple[float, float], rated: float | None,
    barred: tuple[tuple[float, float], ...] = (),
) -> str:  # fmt: skip
    """frequencies: Hz; orders: (per revolution, label); crossings: (rpm, Hz, inside the range); speeds, rated: rpm."""
    top = _top(frequencies, [order for order, _ in orders], speeds[1], crossings)
    right = speeds[1] * 1.12
    with page(name, 4.1) as sheet:
        axes = sheet.axes[0]
        axes.axvspan(*speeds, facecolor=PALE, linewidth=0, label="speed range", zorder=0)
        ranges(axes, barred)
        shown = [f for f in frequencies if f <= top][:MOST_LINES]
        for index, frequency in enumerate(shown):
            axes.axhline(frequency, color=INK, linewidth=1.0)
            axes.annotate(f"mode {index + 1}: {frequency:.5g} Hz", (0.0, frequency), xytext=(4, 2.5),
                          textcoords="offset points", fontsize=7.5, zorder=6, bbox=BACKGROUND)  # fmt: skip
        for index, (order, label) in enumerate(orders[:MOST_LINES]):
            colour = COLOURS[index % len(COLOURS)]
            end = min(right, 60.0 * top / order)
            dashes = DASHES[(index // len(COLOURS)) % len(DASHES)]
            axes.plot([0.0, end], [0.0, order * end / 60.0], color=colour, linewidth=1.0, linestyle=dashes)
            axes.annotate(label, (end, order * end / 60.0), xytext=(2, 1), textcoords="offset points",
                          fontsize=7.5, color=colour, annotation_clip=False)  # fmt: skip
        for inside, marker, label in ((True, "o", "critical speed in the range"), (False, "x", "outside the range")):
            met = np.array([(n, f) for n, f, is_inside in crossings if is_inside == inside and f <= top and n <= right])
            if len(met):
                colour = COLOURS[1] if inside else "#888888"
                axes.plot(met[:, 0], met[:, 1], marker, color=colour, linestyle="none", label=label, zorder=5)
        rated_line(axes, rated)
        axes.set_xlim(0.0, right)
        axes.set_ylim(0.0, top)
        axes.set_xlabel("speed of the reference component, rpm")
        axes.set_ylabel("frequency, Hz")
        legend_below(sheet)
    return sheet.svg


def _top(
    frequencies: Sequence[float],
    orders: Sequence[float],
    fastest: float,
    crossings: Sequence[tuple[float, float, bool]],
) -> float:
    """The frequency up to which the diagram goes: what matters in the range, and one mode above it."""
    reached = max(orders, default=1.0) * fastest / 60.0
    inside = [f for _, f, is_inside in crossings if is_inside]
    above = sorted(f for f in frequencies if f > max(inside, default=0.0))
    wanted = max([*inside, *above[:1]], default=reached)
    return 1.12 * max(min(wanted, 1.15 * reached), max(inside, default=0.0), 0.25 * reached, 1e-9)
