"""What stands in the frame of a plot as SVG: ranges, colours, lines, levels, symbols and words."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.drawing import image
from torsion.output.drawing.curves import area, path
from torsion.output.drawing.frame import Frame, axes, grid
from torsion.output.drawing.pens import BANDS, INK, SYMBOLS, Stroke, stroke
from torsion.output.drawing.words import (
    ELSEWHERE,
    HALO,
    SIZE,
    Room,
    clean,
    plain,
    shown,
    words,
)
from torsion.output.figures.figure import Band, Level, Line, Marks, Pen, Symbol

STEP, SAMPLES = (
    2.0,
    3000,
)  # px between the points of a curve of which words keep clear, and how many at most
MIDDLE = ' text-anchor="middle"'
INSIDE = 1e-9  # of a scale: so far outside a point is still on it
MOST_SYMBOLS, COVERED = (
    1_000,
    30,
)  # of one look that are all drawn; tenths of px, half the width of a symbol
TENTH = 10.0  # units of the plot in one px
LEAST = 8  # tenths of px that a range is wide at least
ANYWHERE = 1.0  # cost of another place of words that are to stand where there is most room
PLACES = 15  # along a line, where its words may stand
ABOVE_OR_BELOW, BELOW, BESIDE = (1, 0, 2, 6, 5), (5, 6, 7), (3, 4)  # directions of words


def drawn(frame: Frame, *, has_numbers: bool) -> Iterator[str]:
    """Yield the elements of a plot; has_numbers: its x axis has numbers and a title."""
    panel = frame.panel
    wide, high = round(TENTH * frame.wide), round(TENTH * frame.high)
    inside = (
        f'<svg class="plot" x="{shown(frame.left)}" y="{shown(frame.top)}" width="{shown(wide / TENTH)}" '
        f'height="{shown(high / TENTH)}" viewBox="0 0 {wide} {high}" preserveAspectRatio="none" fill="none">'
    )
    if panel.bands or panel.cells is not None:
        yield inside
        yield from (_band(frame, band) for band in panel.bands)
        if panel.cells is not None:
            yield from image.cells(panel.cells, frame.across, frame.down)
        yield "</svg>"
    yield grid(frame)
    yield inside
    for level in panel.levels:
        if is_on(frame, level):
            across = level.axis == "x"
            offset = round(TENTH * float((frame.across if across else frame.down)(level.value)))
            line = f"M{offset} 0v{high}" if across else f"M0 {offset}h{wide}"
            named = f' data-name="{clean(plain(level.name))}"' if level.name else ""
            yield f'<path{named} d="{line}" {stroke(level.pen).attributes(TENTH)}/>'
    yield from (_line(frame, line) for line in panel.lines)
    yield "</svg>"
    yield axes(frame, has_numbers=has_numbers)
    room = Room((0.0, 0.0, frame.wide, frame.high), _samples(frame))
    yield f'<g class="front" transform="translate({shown(frame.left)} {shown(frame.top)})">'
    yield from (_marks(frame, marks, room) for marks in panel.marks)
    yield f'<g class="words" font-size="{SIZE:g}" fill="{INK}">{"".join(_labels(frame, room))}</g></g>'


def is_on(frame: Frame, level: Level) -> bool:
    """Whether the level lies within its axis."""
    share = float((frame.y if level.axis == "y" else frame.x).share(level.value))
    return -INSIDE <= share <= 1.0 + INSIDE


def symbols(symbol: Symbol, pen: Pen, x: FloatArray, y: FloatArray, weight: float = 1.0) -> str:
    """Return a symbol at every place in tenths of px."""
    outline, is_filled = SYMBOLS[symbol]
    look = stroke(pen)
    finite = np.isfinite(x) & np.isfinite(y)
    places = np.rint(np.column_stack([x[finite], y[finite]])).astype(np.int64)
    if len(places) > MOST_SYMBOLS:  # of those that cover each other the first
        places = places[np.sort(np.unique(places // COVERED, axis=0, return_index=True)[1])]
    shape = "".join(f"M{across} {down}{outline}" for across, down in places.tolist())
    ink = Stroke(look.colour, 1.5 * weight).attributes(TENTH)
    fill = f'fill="{look.colour}" stroke="none"' if is_filled else f'fill="none" {ink}'
    return f'<path d="{shape}" {fill}/>' if shape else ""


def _samples(frame: Frame) -> FloatArray:
    """Return (points, 2) px along all lines and upright levels in even steps, of which words keep clear."""
    along, samples = np.arange(0.0, frame.high, STEP), [np.zeros((0, 2))]
    for level in frame.panel.levels:
        if level.axis == "x" and is_on(frame, level):
            across = np.full(len(along), frame.across(level.value))
            samples.append(np.column_stack([across, along]))
    for line in frame.panel.lines:
        x, y = frame.across(line.x), frame.down(line.y)
        pieces = np.hypot(np.diff(x, prepend=x[:1]), np.diff(y, prepend=y[:1]))
        length = np.cumsum(np.nan_to_num(pieces, posinf=0.0))
        if length.size and length[-1] > 0:
            steps = np.linspace(0.0, length[-1], min(int(length[-1] / STEP) + 2, SAMPLES))
            points = [np.interp(steps, length, x), np.interp(steps, length, y)]
            samples.append(np.column_stack(points))
    return np.concatenate(samples)


def _band(frame: Frame, band: Band) -> str:
    """Return a range, hatched by its kind."""
    fill, colour, distance, sign = BANDS[band.kind]
    wide, high, across = round(TENTH * frame.wide), round(TENTH * frame.high), band.axis == "x"
    ends = TENTH * (frame.across if across else frame.down)(np.array([band.low, band.high]))
    ends = np.clip(np.sort(np.nan_to_num(ends, nan=0.0)), 0, wide if across else high)
    if not ends[1] > ends[0]:
        return ""
    low = round(float(ends[0]))
    top = max(round(float(ends[1])), low + LEAST)
    x, y, right, foot = box = (low, 0, top, high) if across else (0, low, wide, top)
    inside = f'<rect x="{x}" y="{y}" width="{right - x}" height="{foot - y}" fill="{fill}"/>'
    if colour:
        lines = hatching(box, distance, sign)
        inside += f'<path d="{lines}" stroke="{colour}" stroke-width="6" stroke-opacity=".6"/>'
    name = clean(plain(band.name))
    tip = f"<title>{name}</title>" if name else ""
    return f'<g class="{band.kind.replace(" ", "-")}" data-name="{name}">{tip}{inside}</g>'


def hatching(box: tuple[float, float, float, float], distance: float, sign: int) -> str:
    """Return oblique lines that fill a box in tenths of px, and its upright edges."""
    if not distance:
        return ""
    left, top, right, foot = box
    wide, high = right - left, foot - top
    path = f"M{left:.0f} {top:.0f}V{foot:.0f}M{right:.0f} {top:.0f}V{foot:.0f}"
    for start in np.arange(-high, wide, distance * TENTH * 2**0.5).tolist():
        for letter, x in (("M", max(0.0, start)), ("L", min(wide, start + high))):
            y = top + x - start if sign < 0 else foot - x + start
            path += f"{letter}{left + x:.0f} {y:.0f}"
    return path


def _line(frame: Frame, line: Line) -> str:
    """Return a curve, with what lies between it and its base, and its symbols."""
    x, y = TENTH * frame.across(line.x), TENTH * frame.down(line.y)
    look, columns, inside = stroke(line.pen, line.weight), max(2, round(frame.wide)), ""
    if line.base is not None:
        between = area(x, y, TENTH * frame.down(line.base), columns)
        inside = f'<path d="{between}" fill="{look.colour}" fill-opacity=".3"/>'
    if line.weight and (curve := path(x, y, columns)):
        inside += f'<path d="{curve}" {look.attributes(TENTH)} stroke-linejoin="round"/>'
    if line.symbol:
        inside += symbols(line.symbol, line.pen, x, y)
    return f'<g class="line" data-name="{clean(plain(line.name))}">{inside}</g>'


def _marks(frame: Frame, marks: Marks, room: Room) -> str:
    """Return symbols that are not cut at the edges of the plot, each with its words."""
    x, y = frame.across(marks.x), frame.down(marks.y)
    is_inside = (x >= -1) & (x <= frame.wide + 1) & (y >= -1) & (y <= frame.high + 1)
    for across, down in zip(x[is_inside].tolist(), y[is_inside].tolist(), strict=True):
        room.taken.append((across - 4, down - 4, across + 4, down + 4))
    x, y, inside, content = TENTH * x, TENTH * y, np.flatnonzero(is_inside), ""
    for k in inside.tolist() if marks.words else ():
        tip = f"<title>{clean(plain(marks.words[k]))}</title>" if marks.words[k] else ""
        content += f"<g>{tip}{symbols(marks.symbol, marks.pen, x[[k]], y[[k]])}</g>"
    if not marks.words:
        content = symbols(marks.symbol, marks.pen, x[inside], y[inside])
    named = f' data-name="{clean(plain(marks.name))}"' if marks.name else ""
    return f'<g{named} transform="scale(.1)">{content}</g>'


def _labels(frame: Frame, room: Room) -> Iterator[str]:
    """Yield words beside lines, levels, ranges and marks; the heaviest lines first, as room may lack for all."""
    panel, options = frame.panel, dict[str, Any]()
    requests = list[tuple[str, FloatArray, FloatArray, dict[str, Any]]]()  # x and y in px
    for marks in panel.marks:
        x, y = frame.across(marks.x), frame.down(marks.y)
        for k, text in enumerate(marks.labels[: x.size]):
            requests.append((text, x[[k]], y[[k]], {"gap": 6.0}))
    for level in panel.levels:
        if level.label and is_on(frame, level):
            options = {"gap": 2.0, "ways": BESIDE, "elsewhere": 0.0}
            x, y = np.full(PLACES, frame.across(level.value)), np.linspace(0.0, frame.high, PLACES)
            if level.axis == "y":
                options["ways"] = ABOVE_OR_BELOW
                x = np.linspace(0.0, frame.wide, PLACES)
                y = np.full(PLACES, frame.down(level.value))
            requests.append((level.label, x, y, options))
    for band in panel.bands:
        if band.label:
            middle = (max(band.low, frame.x.low) + min(band.high, frame.x.high)) / 2
            x = frame.across(np.array([middle]))
            y = frame.down(np.array([panel.y.high or frame.y.high]))
            requests.append((band.label, x, y, {"ways": BELOW}))
    for line in sorted(panel.lines, key=lambda line: -line.weight):
        # At the largest value of a line on the plot, or at its last, else at some others.
        x, y = frame.across(line.x), frame.down(line.y)
        on_plot = (x >= 0) & (x <= frame.wide) & (y >= -1e-6) & (y <= frame.high + 1e-6)
        inside = np.flatnonzero(on_plot)
        if line.label and inside.size:
            best = inside[np.argmin(y[inside])] if line.label_at != "end" else inside[-1]
            further = inside[np.linspace(inside.size - 1, 0, PLACES).astype(np.int64)]
            chosen = np.append(best, further) if inside.size > PLACES else np.array([best])
            cost = ANYWHERE if line.label_at == "anywhere" else ELSEWHERE
            requests.append((line.label, x[chosen], y[chosen], {"elsewhere": cost}))

    for text, x, y, options in requests:
        if (word := room.place(text, np.column_stack([x, y]), **options)) is None:
            continue
        left, top, right, foot = word.box
        middle = (left + right) / 2
        if word.foot is not None:  # a line to what the words belong to
            start, begin = word.foot
            end = top if begin < top else foot
            path_ = f"M{shown(start)} {shown(begin)}L{shown(middle)} {shown(end)}"
            yield f'<path d="{path_}" stroke="#888888" stroke-width=".6"/>'
        yield words(middle, (top + foot) / 2 + 3.7, word.text, MIDDLE + HALO)
