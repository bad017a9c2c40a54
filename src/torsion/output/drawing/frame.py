"""The frame of a plot as SVG: scales, grid, numbers and titles."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.drawing.pens import GREY, GRID, INK
from torsion.output.drawing.words import GROWTH, SIZE, shown, width, words
from torsion.output.figures.figure import Axis, Panel
from torsion.output.numbers import SUPERSCRIPT

FLAT = 1e-9  # of the values: a smaller range is a level line
ROUND = 1e-9  # of a step, by which a number may miss it
PLAIN = (1e-4, 1e6)  # numbers from here to there stand without a power of ten
LEAST_SHARE, WHOLE = 0.9e-4, 1.1  # relative errors between them stand in per cent
FEW_DECADES = 2  # from here on only whole decades have numbers
DEGREES = (5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0)

Tick = tuple[float, str]


@dataclass(frozen=True)
class Scale:
    """An axis on paper: its ends, its numbers, and small marks between them."""

    low: float
    high: float
    is_log: bool
    ticks: tuple[Tick, ...]
    small: tuple[float, ...] = ()
    is_reversed: bool = False

    def share(self, values: FloatArray | float) -> FloatArray:
        """Return 0 at the low end, 1 at the high end; NaN where a logarithm has no value."""
        numbers = np.asarray(values, dtype=float)
        if self.is_log:
            logarithms = np.log(np.where(numbers > 0, numbers, np.nan))
            share = (logarithms - math.log(self.low)) / math.log(self.high / self.low)
        else:
            share = (numbers - self.low) / (self.high - self.low)
        return 1.0 - share if self.is_reversed else share


def scale(axis: Axis, data: Sequence[FloatArray], most: int, *, is_rounded: bool = True) -> Scale:
    """Return the axis over finite data with about `most` numbers.

    is_rounded: an end that is not stated lies at a number, or half way between two.
    """
    low, high = _ends(axis, data)
    if axis.places:
        return Scale(low, high, False, axis.places, is_reversed=axis.is_reversed)
    if axis.is_log:
        ticks, small = log_ticks(low, high, most)
        # Relative errors stand in per cent; if one exceeds 100 %, all of them in powers of ten.
        is_whole = axis.is_error and max(ticks, default=0.0) > WHOLE
        words = [
            f"{100.0 * tick:g} %"
            if axis.is_error and not is_whole and tick > LEAST_SHARE
            else _power(tick, (1.0, 10.0) if is_whole else PLAIN)
            for tick in ticks
        ]
        pairs = tuple(zip(ticks, words, strict=True))
        return Scale(low, high, True, pairs, small, axis.is_reversed)
    step = degree_step(high - low, most) if axis.unit == "deg" else step_of(high - low, most)
    step = max(step, 1.0) if axis.is_whole else step
    if axis.low is None and is_rounded:
        low = math.floor(low / step * 2 + ROUND) * step / 2
    if axis.high is None and is_rounded:
        high = math.ceil(high / step * 2 - ROUND) * step / 2
    multiples = ticks_of(low, high, step)
    pairs = tuple(zip(multiples, texts(multiples, step), strict=True))
    return Scale(low, high, False, pairs, is_reversed=axis.is_reversed)


def _ends(axis: Axis, data: Sequence[FloatArray]) -> tuple[float, float]:
    """Return the stated ends, or those of the data; a range without width is widened."""
    values = np.concatenate([np.zeros(0), *map(np.ravel, data)])
    values = values[np.isfinite(values) & ((values > 0) | (not axis.is_log))]
    least, most = 1.0, 10.0 if axis.is_log else 1.0
    if values.size:
        least, most = float(values.min()), float(values.max())
    if axis.is_log:
        low, high = (axis.low or least / 1.5), (axis.high or most * 1.5)
        return low, max(high, 1.1 * low)
    low = least if axis.low is None else axis.low
    high = most if axis.high is None else axis.high
    if high - low <= FLAT * max(abs(high), abs(low)):
        room = 0.1 * max(abs(low), abs(high)) or 1.0
        low = low - room if axis.low is None else low
        high = max(high, low) + room
    return low, high


def step_of(span: float, most: int) -> float:
    """Return the smallest step 1, 2 or 5 times a power of ten that a span holds at most `most` times.

    >>> step_of(100.0, 6), step_of(0.7, 5)
    (20.0, 0.2)
    """
    decade = 10.0 ** math.floor(math.log10(span / most))
    return next(
        k * decade for k in (1.0, 2.0, 5.0, 10.0, 20.0) if span <= most * k * decade * (1.0 + ROUND)
    )


def degree_step(span: float, most: int) -> float:
    """Return a step of an angle that a revolution holds a whole number of times."""
    revolution_step = next((step for step in DEGREES if span <= most * step * (1.0 + ROUND)), 0.0)
    return (revolution_step if span > 2 * DEGREES[0] else 0.0) or (
        360.0 * step_of(span / 360.0, most) if span > 360.0 else step_of(span, most)
    )


def ticks_of(low: float, high: float, step: float) -> list[float]:
    """Return the multiples of the step from low to high."""
    first, last = math.ceil(low / step - 1e-6), math.floor(high / step + 1e-6)
    digits = max(0, 2 - math.floor(math.log10(step)))
    return [round(k * step, digits) + 0.0 for k in range(first, last + 1)]


def log_ticks(low: float, high: float, most: int) -> tuple[list[float], tuple[float, ...]]:
    """Return numbers and small marks of a logarithmic axis: decades, with 2 and 5 between them if there is room."""
    first, last = math.floor(math.log10(low) + ROUND), math.ceil(math.log10(high) - ROUND)
    candidates = [
        (digit, digit * 10.0**power) for power in range(first, last + 1) for digit in range(1, 10)
    ]
    inside = [pair for pair in candidates if low * (1 - ROUND) <= pair[1] <= high * (1 + ROUND)]
    for digits in (range(1, 10), (1, 2, 5), (1, 3), (1,)):
        stated = [tick for digit, tick in inside if digit in digits]
        if len(stated) <= most:
            break
    else:
        jump = -(-len(stated) // most)
        stated = [tick for tick in stated if round(math.log10(tick)) % jump == 0]
    if len(stated) < FEW_DECADES:  # less than a decade
        step = step_of(high - low, most)
        return ticks_of(low, high, step), ()
    small = [tick for digit, tick in inside if digit == 1 or last - first <= 6]
    return stated, tuple(tick for tick in small if tick not in stated)


def texts(values: Sequence[float], step: float) -> list[str]:
    """Return numbers with the decimals that the step needs; very large and small ones with one power of ten.

    >>> texts([0.0, 0.5, 1.0], 0.5), texts([0.0, 2e6], 2e6)
    (['0', '0.5', '1'], ['0', '2·10⁶'])
    """
    largest = max((abs(value) for value in values), default=0.0)
    power = math.floor(math.log10(largest) + ROUND) if largest else 0
    plain = largest < PLAIN[1] and step >= PLAIN[0]
    unit = 1.0 if plain else 10.0**power
    decimals = max(0, -math.floor(math.log10(step / unit) + 1e-6))
    behind = "" if plain else f"·10{str(power).translate(SUPERSCRIPT)}"
    decimals_text = [
        f"{value / unit:.{decimals}f}".rstrip("0").rstrip(".")
        if decimals
        else f"{value / unit:.0f}"
        for value in values
    ]
    return [
        "0" if not value else f"{text}{behind}".replace("-", "−")
        for value, text in zip(values, decimals_text, strict=True)
    ]


def _power(value: float, plain: tuple[float, float]) -> str:
    """Return a number of a logarithmic axis: 0.001, 20, 10⁻⁷, 5·10⁶."""
    power = math.floor(math.log10(value) + ROUND)
    if plain[0] <= value < plain[1]:
        return f"{value:.6g}"
    mantissa = f"{value / 10.0**power:.3g}·"
    return f"{'' if mantissa == '1·' else mantissa}10{str(power).translate(SUPERSCRIPT)}"


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
    data = _data(panel, "y") + [line.base for line in panel.lines if line.base is not None]
    most = max(3, round(panel.height / APART[1]))
    return scale(panel.y, data, most, is_rounded=panel.cells is None)


def horizontal(panel: Panel, wide: float) -> Scale:
    """Return the x axis of a plot."""
    data = _data(panel, "x")
    if not (panel.x.places or panel.x.is_log or panel.x.low is not None):
        # An axis of numbers leaves room for the symbols of lines.
        x = np.concatenate([np.zeros(0), *(line.x for line in panel.lines if line.symbol)])
        x = x[np.isfinite(x)]
        if x.size:
            room = 7.0 / wide * np.ptp(x)  # px, half of the largest symbol
            data.append(np.array([x.min() - room, x.max() + room]))
    return scale(panel.x, data, round(wide / APART[0]), is_rounded=False)


def _data(panel: Panel, axis: str) -> list[FloatArray]:
    """Return what an axis shows: lines, marks, cells, and the levels as far as which it goes."""
    levels = (level for level in panel.levels if level.is_reached and level.axis == axis)
    data = [np.array([level.value]) for level in levels]
    drawn = (*panel.lines, *panel.marks, *([panel.cells] if panel.cells else []))
    return data + [getattr(part, axis) for part in drawn]


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
    left, top, wide, high = map(shown, (frame.left, frame.top, frame.wide, frame.high))
    upright = () if frame.panel.x.places else frame.x.ticks
    lines = [f"M{shown(frame.left + float(frame.across(x)))} {top}v{high}" for x, _ in upright]
    lines += [f"M{left} {shown(frame.top + float(frame.down(y)))}h{wide}" for y, _ in frame.y.ticks]
    look = f'class="grid" stroke="{GRID}" stroke-width=".6" fill="none"'
    return f'<path {look} d="{"".join(lines)}"/>'


def axes(frame: Frame, *, has_numbers: bool) -> str:
    """Return two edges with numbers and titles; has_numbers: below the plot too."""
    left, top, foot = frame.left, frame.top, frame.top + frame.high
    y_small, x_small = frame.down(np.array(frame.y.small)), frame.across(np.array(frame.x.small))
    small = [f"M{shown(left - 3)} {shown(top + y)}h3" for y in y_small.tolist()]
    small += [f"M{shown(left + x)} {shown(foot)}v3" for x in x_small.tolist()]
    edges = f"M{shown(left)} {shown(top)}V{shown(foot)}h{shown(frame.wide)}{''.join(small)}"
    parts = [
        f'<path d="{edges}" fill="none" stroke="{GREY}" stroke-width=".8"/>',
        f'<g class="axis" fill="{INK}" font-size="{SIZE:g}">',
    ]
    for value, text in frame.y.ticks:
        parts.append(words(left - 5, top + float(frame.down(value)) + 3.6, text, END))
    if has_numbers:
        is_slanted = frame.is_slanted
        for value, text in frame.x.ticks:
            x = left + float(frame.across(value))
            if is_slanted:
                parts.append(_turned(x + 3, foot + 11, text, -SLANT, END))
            else:
                parts.append(words(x, foot + 13, text, MIDDLE + ACROSS))
        title = frame.panel.x.title
        parts.append(words(left + frame.wide / 2, foot + frame.below - 4.5, title, MIDDLE))
    for row, text in enumerate(title_rows(frame.panel)):
        parts.append(_turned(10 + ROW * row, top + frame.high / 2, text, -90.0, MIDDLE))
    return "".join(parts) + "</g>"


def _turned(x: float, y: float, text: str, angle: float, anchor: str) -> str:
    return words(x, y, text, f'{anchor} transform="rotate({angle:g} {shown(x)} {shown(y)})"')
