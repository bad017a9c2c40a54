"""The look of every figure: A4 width, small type, thin grid, colours that the colour-blind distinguish."""

import io
import warnings
from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, NullFormatter

Item = TypeVar("Item")
WIDTH = 6.9  # inch: the text of an A4 page
# Okabe and Ito (2008), without the yellow, which is too light on paper
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00", "#444444")
DASHES = ("-", "--", "-.", ":")
INK, GREY, PALE, BAD = "#222222", "#777777", "#e8eef4", "#b3261e"
MOST_LINES = 12  # in one figure
HATCHED: dict[str, Any] = {"facecolor": "#f6d9d6", "edgecolor": BAD, "hatch": "////", "linewidth": 0.3, "zorder": 0}
LOGARITHMIC = 30.0  # times the median: a larger peak makes the axis logarithmic
MOST_DECADES = 1e7  # from the lowest to the highest value of a logarithmic axis
LEGEND_LETTERS = 130  # in one row of a legend, its samples included
SETTINGS: dict[Any, Any] = {
    "font.family": "sans-serif",
    "font.sans-serif": ["Arial", "Liberation Sans", "Helvetica", "DejaVu Sans"],
    "font.size": 8.5,
    "axes.titlesize": 9,
    "axes.labelsize": 8.5,
    "axes.edgecolor": GREY,
    "axes.linewidth": 0.6,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "#d5d5d5",
    "grid.linewidth": 0.4,
    "xtick.labelsize": 8,
    "ytick.labelsize": 8,
    "xtick.color": INK,
    "ytick.color": INK,
    "legend.fontsize": 8,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "lines.markersize": 4,
    "hatch.linewidth": 0.5,
    "svg.fonttype": "none",
    "axes.formatter.useoffset": False,
    "axes.unicode_minus": True,
    "text.parse_math": False,
}


def page(name: str, draw: Callable[..., None], **values: Any) -> str:
    """What `draw(sheet, **values)` puts on a sheet of the page's width, with its legend, as an SVG element."""
    with mpl.rc_context({**SETTINGS, "svg.hashsalt": name}), warnings.catch_warnings():
        # text stays text, and who shows it has fonts of his own for what these have no sign for
        warnings.filterwarnings("ignore", message="Glyph .* missing from font")
        warnings.filterwarnings("ignore", message="constrained_layout not applied")  # names too long for their sheet
        sheet = Figure(layout="constrained")
        canvas: Any = FigureCanvasSVG(sheet)
        draw(sheet, **values)
        _legend_below(sheet)
        buffer = io.StringIO()
        canvas.print_svg(buffer, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def plots(sheet: Figure, height: float, rows: int = 1, **grid: Any) -> list[Axes]:
    """`rows` plots above each other, which fill a sheet of that height in inches."""
    sheet.set_size_inches(WIDTH, height)
    return list(sheet.subplots(rows, 1, squeeze=False, **grid)[:, 0])


def pens(count: int) -> list[dict[str, Any]]:
    """Colour and dashes of `count` lines, all different up to MOST_LINES and beyond."""
    turns = (divmod(k, len(COLOURS)) for k in range(count))
    return [{"color": COLOURS[colour], "linestyle": DASHES[turn % len(DASHES)]} for turn, colour in turns]


def thinned(items: Sequence[Item], most: int) -> Sequence[Item]:
    """About `most` of the items in even steps, the first among them; all where there are no more."""
    return items[:: max(1, -(-len(items) // most))] if most else items


def _legend_below(sheet: Figure) -> None:
    """One legend under the figure, where it covers no data, in as many columns as its words leave room for."""
    samples: dict[str, Any] = {}
    for axes in sheet.axes:
        for sample, label in zip(*axes.get_legend_handles_labels(), strict=True):
            samples.setdefault(label, sample)
    if samples:
        columns = max(1, min(len(samples), LEGEND_LETTERS // (max(map(len, samples)) + 7)))
        sheet.legend(list(samples.values()), list(samples), loc="outside lower center", ncols=columns)


def hatch(axes: Axes, x: np.ndarray, bad: np.ndarray, label: str = "no reliable answer here") -> np.ndarray:
    """Hatch where `bad` holds, from neighbour to neighbour; returns (points,) bool, those inside, to be left blank."""
    inside = np.array(bad, dtype=bool)
    low, high = float(x[0]), float(x[-1])
    least = (high - low) * 2e-3  # so that a single speed can still be seen
    edges = np.diff(inside.astype(np.int8), prepend=0, append=0)  # 1 where a run of bad ones starts, -1 behind its end
    for start, end in zip(*(np.flatnonzero(edges == sign).tolist() for sign in (1, -1)), strict=True):
        left, right = float(x[max(start - 1, 0)]), float(x[min(end, len(x) - 1)])
        if right - left < least:
            middle = (left + right) / 2
            left, right = middle - least / 2, middle + least / 2
        inside |= (x > left) & (x < right)
        axes.axvspan(left, right, label=label, **HATCHED)
    return inside


def ranges(axes: Axes, bands: tuple[tuple[float, float], ...], label: str = "barred range") -> None:
    """Shade ranges of speed."""
    for low, high in bands:
        axes.axvspan(low, high, facecolor="#f7e3b5", alpha=0.6, linewidth=0, label=label, zorder=0)


def amplitude_axis(axes: Axes, values: Sequence[np.ndarray]) -> None:
    """Start the amplitudes at zero, or take logarithms where a resonance would leave all else on the axis."""
    known = np.concatenate([np.ravel(v)[np.isfinite(np.ravel(v)) & (np.ravel(v) > 0)] for v in values] or [np.zeros(0)])
    if known.size == 0 or known.max() <= LOGARITHMIC * np.median(known):
        axes.set_ylim(bottom=0.0)
        return
    axes.set_yscale("log")
    lowest = max(float(known.min()), float(known.max()) / MOST_DECADES)
    axes.set_ylim(lowest / 1.5, float(known.max()) * 2.0)
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_formatter(NullFormatter())


def rated_line(axes: Axes, rated: float | None) -> None:
    """Mark the rated speed."""
    if rated is not None:
        axes.axvline(rated, color=INK, linewidth=0.8, linestyle=(0, (6, 2, 1, 2)), label="rated speed")
