"""What stands in the frame of a plot as SVG: ranges, colours, lines, levels, symbols and words."""

from collections.abc import Iterator

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
    Word,
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
    if panel.bands or panel.cells is not None:
        yield "</svg>"
    yield grid(frame)
    yield inside
    yield from (_level(frame, level) for level in panel.levels if is_on(frame, level))
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
    along = np.arange(0.0, frame.high, STEP)
    upright = [level for level in frame.panel.levels if level.axis == "x" and is_on(frame, level)]
    samples = [
        np.zeros((0, 2)),
        *(
            np.column_stack([np.full(len(along), frame.across(level.value)), along])
            for level in upright
        ),
    ]
    for line in frame.panel.lines:
        x, y = frame.across(line.x), frame.down(line.y)
        length = np.cumsum(
            np.nan_to_num(
                np.hypot(np.diff(x, prepend=x[:1]), np.diff(y, prepend=y[:1])), posinf=0.0
            )
        )
        if length.size and length[-1] > 0:
            steps = np.linspace(0.0, length[-1], min(int(length[-1] / STEP) + 2, SAMPLES))
            samples.append(
                np.column_stack([np.interp(steps, length, x), np.interp(steps, length, y)])
            )
    return np.concatenate(samples)


def _tip(text: str) -> str:
    return f"<title>{clean(plain(text))}</title>" if text else ""


def _band(frame: Frame, band: Band) -> str:
    """Return a range, hatched by its kind."""
    fill, colour, distance, sign = BANDS[band.kind]
    wide, high = round(TENTH * frame.wide), round(TENTH * frame.high)
    ends = TENTH * (frame.across if band.axis == "x" else frame.down)(
        np.array([band.low, band.high])
    )
    low, top = np.clip(
        np.sort(np.nan_to_num(ends, nan=0.0)), 0, wide if band.axis == "x" else high
    ).tolist()
    if not top > low:
        return ""
    low, top = round(low), max(round(top), round(low) + LEAST)
    box = (low, 0, top, high) if band.axis == "x" else (0, low, wide, top)
    area_ = f'<rect x="{box[0]}" y="{box[1]}" width="{box[2] - box[0]}" height="{box[3] - box[1]}" fill="{fill}"/>'
    lines = hatching(box, distance, sign)
    inside = (
        f'<path d="{lines}" stroke="{colour}" stroke-width="6" stroke-opacity=".6"/>'
        if colour
        else ""
    )
    named = f'class="{band.kind.replace(" ", "-")}" data-name="{clean(plain(band.name))}"'
    return f"<g {named}>{_tip(band.name)}{area_}{inside}</g>"


def hatching(box: tuple[float, float, float, float], distance: float, sign: int) -> str:
    """Return oblique lines that fill a box in tenths of px, and its upright edges."""
    if not distance:
        return ""
    left, top, right, foot = box
    wide, high, lines = (
        right - left,
        foot - top,
        [f"M{left:.0f} {top:.0f}V{foot:.0f}M{right:.0f} {top:.0f}V{foot:.0f}"],
    )
    for start in np.arange(-high, wide, distance * TENTH * 2**0.5).tolist():
        first, last = max(0.0, start), min(wide, start + high)
        ends = [
            (left + start_x, top + start_x - start if sign < 0 else foot - start_x + start)
            for start_x in (first, last)
        ]
        lines.append("M{:.0f} {:.0f}L{:.0f} {:.0f}".format(*ends[0], *ends[1]))
    return "".join(lines)


def _level(frame: Frame, level: Level) -> str:
    """Return the line of a level across the plot."""
    across = level.axis == "x"
    offset = round(TENTH * float((frame.across if across else frame.down)(level.value)))
    line = (
        f"M{offset} 0v{round(TENTH * frame.high)}"
        if across
        else f"M0 {offset}h{round(TENTH * frame.wide)}"
    )
    named = f' data-name="{clean(plain(level.name))}"' if level.name else ""
    return f'<path{named} d="{line}" {stroke(level.pen).attributes(TENTH)}/>'


def _line(frame: Frame, line: Line) -> str:
    """Return a curve, with what lies between it and its base, and its symbols."""
    x, y, look = (
        TENTH * frame.across(line.x),
        TENTH * frame.down(line.y),
        stroke(line.pen, line.weight),
    )
    columns, filled = max(2, round(frame.wide)), ""
    if line.base is not None:
        between = area(x, y, TENTH * frame.down(line.base), columns)
        filled = f'<path d="{between}" fill="{look.colour}" fill-opacity=".3"/>'
    curve = path(x, y, columns)
    drawn_ = (
        f'<path d="{curve}" {look.attributes(TENTH)} stroke-linejoin="round"/>'
        if line.weight and curve
        else ""
    )
    dots = symbols(line.symbol, line.pen, x, y) if line.symbol else ""
    return f'<g class="line" data-name="{clean(plain(line.name))}">{filled}{drawn_}{dots}</g>'


def _marks(frame: Frame, marks: Marks, room: Room) -> str:
    """Return symbols that are not cut at the edges of the plot, each with its words."""
    x, y = frame.across(marks.x), frame.down(marks.y)
    is_inside = (x >= -1) & (x <= frame.wide + 1) & (y >= -1) & (y <= frame.high + 1)
    for across, down in zip(x[is_inside].tolist(), y[is_inside].tolist(), strict=True):
        room.taken.append((across - 4, down - 4, across + 4, down + 4))
    x, y = TENTH * x, TENTH * y
    inside = np.flatnonzero(is_inside)
    if marks.words:
        content = "".join(
            f"<g>{_tip(marks.words[k])}{symbols(marks.symbol, marks.pen, x[[k]], y[[k]])}</g>"
            for k in inside.tolist()
        )
    else:
        content = symbols(marks.symbol, marks.pen, x[inside], y[inside])
    named = f' data-name="{clean(plain(marks.name))}"' if marks.name else ""
    return f'<g{named} transform="scale(.1)">{content}</g>'


def _labels(frame: Frame, room: Room) -> Iterator[str]:
    """Yield words beside lines, levels, ranges and marks; the heaviest lines first, as room may lack for all."""
    panel = frame.panel
    for marks in panel.marks:
        for text, x, y in zip(marks.labels, marks.x.tolist(), marks.y.tolist(), strict=False):
            yield from _word(room.place(text, _points(frame, x, y), gap=6.0))
    for level in panel.levels:
        if level.label and is_on(frame, level):
            is_level = level.axis == "y"
            along = np.linspace(0.0, frame.wide if is_level else frame.high, PLACES)
            across = np.full(PLACES, float((frame.down if is_level else frame.across)(level.value)))
            points = np.column_stack([along, across] if is_level else [across, along])
            ways = ABOVE_OR_BELOW if is_level else BESIDE
            yield from _word(room.place(level.label, points, gap=2.0, ways=ways, elsewhere=0.0))
    for band in panel.bands:
        if band.label:
            middle = (max(band.low, frame.x.low) + min(band.high, frame.x.high)) / 2
            yield from _word(
                room.place(
                    band.label, _points(frame, middle, panel.y.high or frame.y.high), ways=BELOW
                )
            )
    for line in sorted(panel.lines, key=lambda line: -line.weight):
        if line.label and (points := _along(frame, line)).size:
            cost = ANYWHERE if line.label_at == "anywhere" else ELSEWHERE
            yield from _word(room.place(line.label, points, elsewhere=cost))


def _points(frame: Frame, x: float, y: float) -> FloatArray:
    return np.array([[float(frame.across(x)), float(frame.down(y))]])


def _along(frame: Frame, line: Line) -> FloatArray:
    """Return (points, 2) px of the largest value of a line on the plot, or of its last, and of some others."""
    x, y = frame.across(line.x), frame.down(line.y)
    inside = np.flatnonzero((x >= 0) & (x <= frame.wide) & (y >= -1e-6) & (y <= frame.high + 1e-6))
    if inside.size == 0:
        return np.zeros((0, 2))
    best = inside[np.argmin(y[inside])] if line.label_at != "end" else inside[-1]
    further = inside[np.linspace(inside.size - 1, 0, PLACES).astype(np.int64)]
    chosen = np.append(best, further) if inside.size > PLACES else np.array([best])
    return np.column_stack([x[chosen], y[chosen]])


def _word(word: Word | None) -> Iterator[str]:
    """Yield a placed text, with a line to what it belongs to where that is apart."""
    if word is None:
        return
    left, top, right, foot = word.box
    middle, base = (left + right) / 2, (top + foot) / 2 + 3.7
    if word.foot is not None:
        x, y = word.foot
        end = top if y < top else foot
        yield f'<path d="M{shown(x)} {shown(y)}L{shown(middle)} {shown(end)}" stroke="#888888" stroke-width=".6"/>'
    yield words(middle, base, word.text, MIDDLE + HALO)
