"""The frame of a plot as SVG: scales, grid, numbers and titles."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.drawing.pens import GREY, GRID, INK
from torsion.output.drawing.scales import Scale, scale
from torsion.output.drawing.text import shown, words
from torsion.output.drawing.words import GROWTH, SIZE, width
from torsion.output.figures.figure import Panel

WIDTH = 620.0  # px of a figure: its lines and letters are for this width
TOP, RIGHT, NUMBERS, TITLE = (
    9.0,
    14.0,
    18.0,
    18.0,
)  # px: free above and beside a plot; heights below it
ROW = 13.0  # px from one row of letters to the next
APART = (62.0, 30.0)  # px: numbers on the axes are about so far apart
SLANT = 30.0  # degrees of names that would meet otherwise
ACROSS = ' class="across"'  # numbers that a zoom changes
MIDDLE, END = ' text-anchor="middle"', ' text-anchor="end"'


@dataclass(frozen=True)
class Frame:
    """Where a plot stands, and its scales."""

    panel: Panel
    x: Scale
    y: Scale
    left: float
    top: float
    wide: float
    high: float

    def across(self, values: FloatArray | float) -> FloatArray:
        """Return px from the left edge of the plot."""
        return self.x.share(values) * self.wide

    def down(self, values: FloatArray | float) -> FloatArray:
        """Return px from the upper edge of the plot."""
        return (1.0 - self.y.share(values)) * self.high

    @property
    def names(self) -> list[tuple[float, float]]:
        """Of every name below the plot the px from the left edge of the plot, and its width."""
        places = self.panel.x.places
        across = self.across(np.array([value for value, _ in places])).tolist()
        return [(x, GROWTH * width(text)) for x, (_, text) in zip(across, places, strict=True)]

    @property
    def is_slanted(self) -> bool:
        """Whether names below the plot would meet, or leave the figure, if they stood level."""
        ends = [(x - wide / 2 - 3, x + wide / 2 + 3) for x, wide in self.names]
        leaves = any(left < -self.left or right > self.wide + RIGHT for left, right in ends)
        return leaves or any(before[1] > after[0] for before, after in pairwise(ends))

    @property
    def beyond(self) -> float:
        """px by which slanted names run over the left edge of the figure."""
        edges = [self.left + x - 0.87 * wide for x, wide in self.names]
        return max(0.0, -min(edges, default=0.0)) if self.is_slanted else 0.0

    @property
    def below(self) -> float:
        """px below a plot for the numbers and the title of its x axis."""
        slanted = 14.0 + max((0.5 * wide for _, wide in self.names), default=0.0)
        title = TITLE if self.panel.x.title else 0.0
        return (slanted if self.is_slanted else NUMBERS) + title


def vertical(panel: Panel) -> Scale:
    """Return the y axis of a plot."""
    data = [line.y for line in panel.lines] + [
        line.base for line in panel.lines if line.base is not None
    ]
    data += reached(panel, "y")
    data += [marks.y for marks in panel.marks] + ([panel.cells.y] if panel.cells else [])
    return scale(
        panel.y, data, max(3, round(panel.height / APART[1])), is_rounded=panel.cells is None
    )


def horizontal(panel: Panel, wide: float) -> Scale:
    """Return the x axis of a plot."""
    data = (
        [line.x for line in panel.lines] + [marks.x for marks in panel.marks] + reached(panel, "x")
    )
    data += _beside_symbols(panel, wide)
    return scale(
        panel.x,
        data + ([panel.cells.x] if panel.cells else []),
        round(wide / APART[0]),
        is_rounded=False,
    )


def _beside_symbols(panel: Panel, wide: float) -> list[FloatArray]:
    """Return the ends of an axis of numbers that leave room for the symbols of lines."""
    columns = [line.x[np.isfinite(line.x)] for line in panel.lines if line.symbol and line.x.size]
    if (
        not any(x.size for x in columns)
        or panel.x.places
        or panel.x.is_log
        or panel.x.low is not None
    ):
        return []
    x = np.concatenate(columns)
    room = 7.0 / wide * np.ptp(x)  # px, half of the largest symbol
    return [np.array([x.min() - room, x.max() + room])]


def reached(panel: Panel, axis: str) -> list[FloatArray]:
    """Return the levels as far as which an axis goes."""
    return [
        np.array([level.value]) for level in panel.levels if level.is_reached and level.axis == axis
    ]


def title_rows(panel: Panel) -> list[str]:
    """Return the title of the y axis in one row, or in two if the plot is low."""
    title = panel.y.title
    if width(title) * GROWTH <= panel.height + TOP:
        return [title]
    gaps = [k for k, sign in enumerate(title) if sign == " "]
    middle = min(gaps, key=lambda k: abs(k - len(title) / 2), default=len(title))
    return [title[:middle], title[middle + 1 :]]


def margin(panel: Panel, y: Scale) -> float:
    """Return the px that title and numbers need to the left of a plot."""
    numbers = max((width(text) for _, text in y.ticks), default=0.0)
    return ROW * len(title_rows(panel)) + GROWTH * numbers + 9.0


def grid(frame: Frame) -> str:
    """Return thin lines at the numbers of both axes."""
    left, top, wide, high = (
        shown(length) for length in (frame.left, frame.top, frame.wide, frame.high)
    )
    upright = (
        []
        if frame.panel.x.places
        else frame.across(np.array([value for value, _ in frame.x.ticks])).tolist()
    )
    level = frame.down(np.array([value for value, _ in frame.y.ticks])).tolist()
    lines = [f"M{shown(frame.left + x)} {top}v{high}" for x in upright]
    lines += [f"M{left} {shown(frame.top + y)}h{wide}" for y in level]
    return (
        f'<path class="grid" stroke="{GRID}" stroke-width=".6" fill="none" d="{"".join(lines)}"/>'
    )


def axes(frame: Frame, *, has_numbers: bool) -> str:
    """Return two edges with numbers and titles; has_numbers: below the plot too."""
    left, foot = frame.left, frame.top + frame.high
    down = frame.down(np.array([value for value, _ in frame.y.ticks])).tolist()
    parts = [_edges(frame), f'<g class="axis" fill="{INK}" font-size="{SIZE:g}">']
    parts += [
        words(left - 5, frame.top + y + 3.6, text, END)
        for y, (_, text) in zip(down, frame.y.ticks, strict=True)
    ]
    if has_numbers:
        parts += _below(frame)
        parts.append(
            words(left + frame.wide / 2, foot + frame.below - 4.5, frame.panel.x.title, MIDDLE)
        )
    for row, text in enumerate(title_rows(frame.panel)):
        parts.append(_turned(10 + ROW * row, frame.top + frame.high / 2, text, -90.0, MIDDLE))
    return "".join(parts) + "</g>"


def _edges(frame: Frame) -> str:
    """Return the left and the lower edge with their small marks."""
    left, top, foot = frame.left, frame.top, shown(frame.top + frame.high)
    small = [
        f"M{shown(left - 3)} {shown(top + y)}h3"
        for y in frame.down(np.array(frame.y.small)).tolist()
    ]
    small += [
        f"M{shown(left + x)} {foot}v3" for x in frame.across(np.array(frame.x.small)).tolist()
    ]
    line = f"M{shown(left)} {shown(top)}V{foot}h{shown(frame.wide)}{''.join(small)}"
    return f'<path d="{line}" fill="none" stroke="{GREY}" stroke-width=".8"/>'


def _below(frame: Frame) -> list[str]:
    """Return numbers or names below the plot."""
    foot, made = frame.top + frame.high, []
    slanted = frame.is_slanted
    for value, text in frame.x.ticks:
        x = frame.left + float(frame.across(value))
        level = MIDDLE + ACROSS
        made.append(
            _turned(x + 3, foot + 11, text, -SLANT, END)
            if slanted
            else words(x, foot + 13, text, level)
        )
    return made


def _turned(x: float, y: float, text: str, angle: float, anchor: str) -> str:
    return words(x, y, text, f'{anchor} transform="rotate({angle:g} {shown(x)} {shown(y)})"')
