"""Axes: which values they reach, which numbers stand on them, and where a value lies."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import Axis
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
        words = error_texts(ticks) if axis.is_error else [_power(tick) for tick in ticks]
        return Scale(
            low, high, True, tuple(zip(ticks, words, strict=True)), small, axis.is_reversed
        )
    step = degree_step(high - low, most) if axis.unit == "deg" else step_of(high - low, most)
    step = max(step, 1.0) if axis.is_whole else step
    if axis.low is None and is_rounded:
        low = math.floor(low / step * 2 + ROUND) * step / 2
    if axis.high is None and is_rounded:
        high = math.ceil(high / step * 2 - ROUND) * step / 2
    multiples = ticks_of(low, high, step)
    return Scale(
        low,
        high,
        False,
        tuple(zip(multiples, texts(multiples, step), strict=True)),
        is_reversed=axis.is_reversed,
    )


def _ends(axis: Axis, data: Sequence[FloatArray]) -> tuple[float, float]:
    """Return the stated ends, or those of the data; a range without width is widened."""
    finite = [
        column[np.isfinite(column) & (column > 0)] if axis.is_log else column[np.isfinite(column)]
        for column in data
    ]
    all_values = np.concatenate([column.ravel() for column in finite]) if finite else np.zeros(0)
    least, most = (
        (float(all_values.min()), float(all_values.max()))
        if all_values.size
        else (1.0, 10.0 if axis.is_log else 1.0)
    )
    if axis.is_log:
        low, high = (axis.low or least / 1.5), (axis.high or most * 1.5)
        return low, max(high, 1.1 * low)
    low, high = (
        (least if axis.low is None else axis.low),
        (most if axis.high is None else axis.high),
    )
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
    candidates = [digit * 10.0**power for power in range(first, last + 1) for digit in range(1, 10)]
    inside = [tick for tick in candidates if low * (1 - ROUND) <= tick <= high * (1 + ROUND)]
    for digits in (range(1, 10), (1, 2, 5), (1, 3), (1,)):
        stated = [tick for tick in inside if _digit(tick) in digits]
        if len(stated) <= most:
            break
    else:
        jump = -(-len(stated) // most)
        stated = [tick for tick in stated if round(math.log10(tick)) % jump == 0]
    if len(stated) < FEW_DECADES:  # less than a decade
        step = step_of(high - low, most)
        return ticks_of(low, high, step), ()
    small = inside if last - first <= 6 else [tick for tick in inside if _digit(tick) == 1]
    return stated, tuple(tick for tick in small if tick not in stated)


def _digit(value: float) -> int:
    return round(value / 10.0 ** math.floor(math.log10(value) + ROUND))


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


def _power(value: float, plain: tuple[float, float] = PLAIN) -> str:
    """Return a number of a logarithmic axis: 0.001, 20, 10⁻⁷, 5·10⁶."""
    power = math.floor(math.log10(value) + ROUND)
    if plain[0] <= value < plain[1]:
        return f"{value:.6g}"
    mantissa = f"{value / 10.0**power:.3g}·"
    return f"{'' if mantissa == '1·' else mantissa}10{str(power).translate(SUPERSCRIPT)}"


def error_texts(values: Sequence[float]) -> list[str]:
    """Return relative errors: above 1e-4 in per cent; if one exceeds 100 %, all of them in powers of ten.

    >>> error_texts([1e-5, 0.001, 0.1]), error_texts([1e-12, 1e-4, 1.0, 1000.0])
    (['10⁻⁵', '0.1 %', '10 %'], ['10⁻¹²', '10⁻⁴', '1', '10³'])
    """
    if max(values, default=0.0) > WHOLE:
        return [_power(value, (1.0, 10.0)) for value in values]
    return [f"{100.0 * value:g} %" if value > LEAST_SHARE else _power(value) for value in values]
