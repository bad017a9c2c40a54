"""A figure as one SVG element: its plots below each other, and one key of all lines, ranges and symbols."""

from functools import lru_cache

import numpy as np

from torsion.output.drawing import grades, sketch
from torsion.output.drawing.frame import RIGHT, TOP, WIDTH, Frame, horizontal, margin, vertical
from torsion.output.drawing.image import palette
from torsion.output.drawing.pens import BANDS, stroke
from torsion.output.drawing.plot import drawn, hatching, is_on, symbols
from torsion.output.drawing.words import GROWTH, clean, plain, shown, width, words
from torsion.output.figures.figure import (
    Band,
    Figure,
    Level,
    Line,
    Marks,
    Panel,
    Shares,
    Sketch,
)
from torsion.output.numbers import number

FONTS = "Arial, Liberation Sans, Helvetica, sans-serif"
SAMPLE = 27.0  # px: length of a sample of a line
Keyed = Line | Level | Band | Marks


def svg(figure: Figure) -> str:
    """Return the SVG element of a figure; the same figure gives the same text."""
    return framed(figure)[0]


@lru_cache(maxsize=64)  # a page, a PDF and a file of a figure show one drawing
def framed(figure: Figure) -> tuple[str, list[Frame]]:
    """Return the element, and where its plots stand in it."""
    pieces, frames, foot = list[str](), list[Frame](), 0.0
    # Plots begin as far to the right as the widest numbers need, and names (of any length) that run over the edge.
    left = max((margin(plot, vertical(plot)) for plot in figure.plots), default=0.0)
    beyond = max((_frame(plot, left, 0.0).beyond for plot in figure.plots), default=0.0)
    left += min(beyond, WIDTH / 3.0)
    for panel, below in zip(figure.panels, (*figure.panels[1:], None), strict=False):
        if isinstance(panel, Panel):
            frames.append(frame := _frame(panel, left, foot))
            # The next plot has the numbers of an axis that is the same.
            has_numbers = not isinstance(below, Panel) or below.x != panel.x
            pieces += drawn(frame, has_numbers=has_numbers)
            foot = frame.top + frame.high + (frame.below if has_numbers else 6.0)
        else:
            if isinstance(panel, Sketch):
                high, text = sketch.drawn(panel, foot)
            else:
                high, text = grades.shares(panel, foot)
            pieces.append(text)
            foot += high
    key, foot = _key(frames, foot)
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {shown(WIDTH)} {shown(foot)}" width="{shown(WIDTH)}" '
        f'height="{shown(foot)}" role="img" '
        f'aria-label="{clean(plain(figure.caption))}" font-family="{FONTS}">'
    )
    paper = f'<rect class="paper" width="{shown(WIDTH)}" height="{shown(foot)}" fill="#ffffff"/>'
    text = "".join(
        [head, f"<desc>{clean(plain(description(figure)))}</desc>", paper, *pieces, key, "</svg>"]
    )
    return text, frames


def description(figure: Figure) -> str:
    """Return the plots in words: what runs over what, the largest value of every line, and how much of a limit is used."""
    sentences = []
    for panel in figure.panels:
        if isinstance(panel, Sketch):
            sentences += [
                f"{link.label}: {link.use.words}."
                for link in panel.links
                if link.use is not None and link.label
            ]
        if isinstance(panel, Shares):
            sentences += [f"{row.name}, {row.clause}: {row.use.words}." for row in panel.rows]
    for panel in figure.plots:
        sentences.append(f"{panel.y.title} over {panel.x.title}.")
        for line in panel.lines:
            finite = np.isfinite(line.y)
            if line.name and finite.any():
                peak = int(np.nanargmax(line.y))
                largest = f"{number(float(line.y[peak]), 3)} {panel.y.unit}".strip()
                where = f"{number(float(line.x[peak]), 4)} {panel.x.unit}."
                sentences.append(f"{line.name}: largest {largest} at {where}".replace(" .", "."))
    return " ".join(sentences)


def _frame(panel: Panel, left: float, foot: float) -> Frame:
    wide, top = WIDTH - RIGHT - left, foot + TOP
    scales = horizontal(panel, wide), vertical(panel)
    return Frame(panel, *scales, left, top, wide, panel.height)


def _key(frames: list[Frame], foot: float) -> tuple[str, float]:
    """Return samples with their names in rows below the plots, and where they end."""
    entries: dict[str, tuple[float, str]] = {}
    for frame in frames:
        panel = frame.panel
        keyed: tuple[Keyed, ...] = (*panel.lines, *panel.marks, *panel.levels, *panel.bands)
        for entry in keyed:
            if not entry.name or (isinstance(entry, Marks) and not entry.x.size):
                continue
            name = entry.name
            if isinstance(entry, Level) and not is_on(frame, entry):
                unit = (panel.y if entry.axis == "y" else panel.x).unit
                name = f"{name}: {number(entry.value, 4)} {unit}, not on this scale"
            entries.setdefault(name, (SAMPLE, _sample(entry)))
        if (cells := panel.cells) is not None:  # the scale of the colours of an image
            shades, step = palette(is_log=bool(cells.decades))[::2].tolist(), 4.0
            ends, low = number(cells.largest, 2), f"−{number(cells.largest, 2)}"
            if cells.decades:
                low = f"≤ {number(cells.largest * 10.0**-cells.decades, 2)}"
            left = 8 + GROWTH * width(low)
            parts = [  # rgb(), not #: colours that stay on a dark screen
                f'<rect x="{shown(left + k * step)}" y="-5" width="{step + 0.3}" height="10" fill="rgb({r},{g},{b})"/>'
                for k, (r, g, b) in enumerate(shades)
            ]
            long = left + step * len(shades)
            parts += [words(left - 4, 3.7, low, ' text-anchor="end"'), words(long + 4, 3.7, ends)]
            name = ", ".join(filter(None, (cells.quantity, cells.unit)))
            name += ", logarithmic" if cells.decades else ""
            entries.setdefault(name, (long + 8 + GROWTH * width(ends), "".join(parts)))
    if not entries:
        return "", foot + 2.0
    rows = [(wide, sample, name) for name, (wide, sample) in entries.items()]
    foot, text = grades.key_rows(rows, frames[0].left, foot + 11.0)
    return text, foot + 1.0


def _sample(entry: Keyed) -> str:
    """Return a sample of 27 px around the middle of a row."""
    if isinstance(entry, Band):
        fill, colour, distance, sign = BANDS[entry.kind]
        lines = hatching((0.0, -50.0, 10 * SAMPLE, 50.0), min(distance, 5.0), sign)
        area = f'<rect y="-50" width="{10 * SAMPLE:g}" height="100" fill="{fill}"/>'
        if colour:
            area += f'<path d="{lines}" stroke="{colour}" stroke-width="6" stroke-opacity=".6"/>'
        return f'<g transform="scale(.1)" fill="none">{area}</g>'
    text, look = "", stroke(entry.pen, entry.weight if isinstance(entry, Line) else 1.0)
    if isinstance(entry, Line) and entry.base is not None:
        box = f'y="-5" width="{SAMPLE:g}" height="10"'
        text = f'<rect {box} fill="{look.colour}" fill-opacity=".3"/>'
    if isinstance(entry, Level) or (isinstance(entry, Line) and entry.weight):
        text += f'<path d="M0 0h{SAMPLE:g}" fill="none" {look.attributes()}/>'
    if not isinstance(entry, Level) and entry.symbol:
        middle = np.array([5 * SAMPLE])
        dot = symbols(entry.symbol, entry.pen, middle, 0 * middle)
        text += f'<g transform="scale(.1)">{dot}</g>'
    return text
