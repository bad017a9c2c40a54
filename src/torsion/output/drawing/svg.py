"""A figure as one SVG element: its plots below each other, and one key of all lines, ranges and symbols."""

from collections.abc import Iterator

import numpy as np

from torsion.output.drawing import grades, sketch
from torsion.output.drawing.frame import RIGHT, TOP, WIDTH, Frame, horizontal, margin, vertical
from torsion.output.drawing.image import palette
from torsion.output.drawing.pens import BANDS, stroke
from torsion.output.drawing.plot import drawn, hatching, is_on, symbols
from torsion.output.drawing.words import GROWTH, clean, plain, shown, width, words
from torsion.output.figures.figure import (
    Band,
    Cells,
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


def framed(figure: Figure) -> tuple[str, list[Frame]]:
    """Return the element, and where its plots stand in it."""
    pieces, frames, foot = list[str](), list[Frame](), 0.0
    for panel, has_numbers in _panels(figure):
        match panel:
            case Panel():
                frame = _frame(figure, panel, foot)
                frames.append(frame)
                pieces += drawn(frame, has_numbers=has_numbers)
                foot = frame.top + frame.high + (frame.below if has_numbers else 6.0)
            case Sketch():
                high, text = sketch.drawn(panel, foot)
                pieces.append(text)
                foot += high
            case Shares():
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
            sentences += [f"{row.label}: {row.use.words}." for row in panel.rows]
    for panel in figure.plots:
        sentences.append(f"{panel.y.title} over {panel.x.title}.")
        for line in panel.lines:
            finite = np.isfinite(line.y)
            if line.name and finite.any():
                peak = int(np.nanargmax(line.y))
                largest = f"{number(float(line.y[peak]), 3)} {panel.y.unit}".strip()
                sentences.append(
                    f"{line.name}: largest {largest} at {number(float(line.x[peak]), 4)} {panel.x.unit}.".replace(
                        " .", "."
                    )
                )
    return " ".join(sentences)


def _panels(figure: Figure) -> Iterator[tuple[Panel | Sketch | Shares, bool]]:
    """Yield every plot, and whether its x axis has numbers: not if the next one has the same."""
    for position, panel in enumerate(figure.panels):
        below = figure.panels[position + 1] if position + 1 < len(figure.panels) else None
        shares_axis = isinstance(panel, Panel) and isinstance(below, Panel) and panel.x == below.x
        yield panel, not shares_axis


def _frame(figure: Figure, panel: Panel, foot: float) -> Frame:
    """Return a plot under what stands already, as far to the right as the widest numbers of all need."""
    left = max(margin(plot, vertical(plot)) for plot in figure.plots)
    left += min(
        max(_framed(plot, left, foot).beyond for plot in figure.plots), WIDTH / 3.0
    )  # names of any length
    return _framed(panel, left, foot)


def _framed(panel: Panel, left: float, foot: float) -> Frame:
    wide = WIDTH - RIGHT - left
    return Frame(
        panel, horizontal(panel, wide), vertical(panel), left, foot + TOP, wide, panel.height
    )


def _key(frames: list[Frame], foot: float) -> tuple[str, float]:
    """Return samples with their names in rows below the plots, and where they end."""
    entries: dict[str, tuple[float, str]] = {}
    for frame in frames:
        panel = frame.panel
        keyed: tuple[Keyed, ...] = (*panel.lines, *panel.marks, *panel.levels, *panel.bands)
        for entry in keyed:
            if entry.name and (not isinstance(entry, Marks) or entry.x.size):
                entries.setdefault(_name(frame, entry), (SAMPLE, _sample(entry)))
        if panel.cells is not None:
            entries.setdefault(*_colours(panel.cells))
    if not entries:
        return "", foot + 2.0
    rows = [(wide, sample, name) for name, (wide, sample) in entries.items()]
    foot, text = grades.key_rows(rows, frames[0].left, foot + 11.0)
    return text, foot + 1.0


def _name(frame: Frame, entry: Keyed) -> str:
    """Return the name in the key; with the value of a limit that is off the scale."""
    if isinstance(entry, Level) and not is_on(frame, entry):
        axis = frame.panel.y if entry.axis == "y" else frame.panel.x
        return f"{entry.name}: {number(entry.value, 4)} {axis.unit}, not on this scale"
    return entry.name


def _sample(entry: Keyed) -> str:
    """Return a sample of 27 px around the middle of a row."""
    match entry:
        case Band():
            fill, colour, distance, sign = BANDS[entry.kind]
            lines = hatching((0.0, -50.0, 10 * SAMPLE, 50.0), min(distance, 5.0), sign)
            inside = (
                f'<path d="{lines}" stroke="{colour}" stroke-width="6" stroke-opacity=".6"/>'
                if colour
                else ""
            )
            area = f'<rect y="-50" width="{10 * SAMPLE:g}" height="100" fill="{fill}"/>'
            return f'<g transform="scale(.1)" fill="none">{area}{inside}</g>'
        case Marks():
            middle = np.array([5 * SAMPLE])
            return f'<g transform="scale(.1)">{symbols(entry.symbol, entry.pen, middle, 0 * middle)}</g>'
        case Level():
            return f'<path d="M0 0h{SAMPLE:g}" fill="none" {stroke(entry.pen).attributes()}/>'
        case Line():
            look, middle = stroke(entry.pen, entry.weight), np.array([5 * SAMPLE])
            fill = f'<rect y="-5" width="{SAMPLE:g}" height="10" fill="{look.colour}" fill-opacity=".3"/>'
            line = (
                f'<path d="M0 0h{SAMPLE:g}" fill="none" {look.attributes()}/>'
                if entry.weight
                else ""
            )
            dot = (
                f'<g transform="scale(.1)">{symbols(entry.symbol, entry.pen, middle, 0 * middle)}</g>'
                if entry.symbol
                else ""
            )
            return (fill if entry.base is not None else "") + line + dot


def _colours(cells: Cells) -> tuple[str, tuple[float, str]]:
    """Return the scale of the colours of an image as an entry of the key."""
    shades, step = palette(is_log=bool(cells.decades))[::2].tolist(), 4.0
    ends = number(cells.largest, 2)
    low = f"≤ {number(cells.largest * 10.0**-cells.decades, 2)}" if cells.decades else f"−{ends}"
    left = 8 + GROWTH * width(low)
    parts = [  # rgb(), not #: colours that stay on a dark screen
        f'<rect x="{shown(left + k * step)}" y="-5" width="{step + 0.3}" height="10" fill="rgb({r},{g},{b})"/>'
        for k, (r, g, b) in enumerate(shades)
    ]
    long = left + step * len(shades)
    parts += [words(left - 4, 3.7, low, ' text-anchor="end"'), words(long + 4, 3.7, ends)]
    how = ", logarithmic" if cells.decades else ""
    return f"{', '.join(filter(None, (cells.quantity, cells.unit)))}{how}", (
        long + 8 + GROWTH * width(ends),
        "".join(parts),
    )
