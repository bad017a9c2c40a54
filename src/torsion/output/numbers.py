"""Numbers as an engineer reads them: significant digits, one scale a column, signs of what is no number."""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Any

import numpy as np

DIGITS = 5  # significant digits of a figure in a table
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
SIGNS = (
    (r"\btau_", "τ_"),
    (r"\bsigma_", "σ_"),
    (r"\blambda\b", "λ"),
    (r"\b(mm|cm|m|s)([2-4])\b", r"\1^\2"),
    (r"\^2", "²"),
    (r"\^3", "³"),
    (r"\^4", "⁴"),
)
ROUNDING = 1e-12  # of the largest of a column or curve: a smaller figure may be the rounding of its computation
LESS = "less than 10⁻¹² of the largest, which may be rounding"
NONE = "–"
PREFIXES = ((1e6, "M"), (1e3, "k"))
RPM = 60.0 / (2.0 * math.pi)


def number(value: float | None, digits: int = DIGITS) -> str:
    """Return a value to so many significant digits: 0.012346, 1234.6, 1.2346·10⁷; '–' for none, '∞' if infinite."""
    if value is None or math.isnan(value):
        return NONE
    if math.isinf(value):
        return str(value).replace("inf", "∞").replace("-", "−")
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = int(exponent)
    if -4 <= power < max(digits + 1, 6):
        decimals = digits - 1 - power
        text = f"{value:.{decimals}f}" if decimals >= 0 else f"{float(f'{mantissa}e{power}'):.0f}"
        return text.replace("-", "−")
    return f"{mantissa}{_power(power)}".replace("-", "−")


def symbols(text: str) -> str:
    """Return words of a rule, or of the plan, with the signs of the report: τ_C, N/mm², 1.9·10⁶.

    >>> symbols("sigma_B 600 N/mm2, 1.9e+06 N m")
    'σ_B 600 N/mm², 1.9·10⁶ N m'
    """
    for letters, sign in SIGNS:
        text = re.sub(letters, sign, text)
    return re.sub(r"(?<=\d)e([+-])0*(\d+)", lambda found: _power(int(found[1] + found[2])), text)


def unit_words(unit: str) -> str:
    """Return a unit of the file as the report writes it.

    >>> unit_words("kN*m/rad"), unit_words("kg*m**2")
    ('kN m/rad', 'kg m²')
    """
    return symbols(unit.replace("**", "^").replace("*", " "))


def _power(exponent: int) -> str:
    return f"·10{str(exponent).translate(SUPERSCRIPT)}"


def counted(count: int, noun: str) -> str:
    """Return a number with its noun: '1 line', '4 lines', '1,000 lines'."""
    return f"{count:,} {noun}{'' if count == 1 else 's'}"


def given(value: float | None, digits: int = DIGITS) -> str:
    """Return a figure of the input: as `number`, without the zeros that nobody wrote."""
    mantissa, dot, power = number(value, digits).partition("·")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + dot + power


def order(value: Fraction | None) -> str:
    """Return an order as people read it: '2', '0.5', or the fraction with its value where the decimals do not end."""
    if value is None:
        return NONE
    if value.denominator == 1:
        return str(value.numerator)
    text = f"{float(value):.4f}".rstrip("0")
    return text if Fraction(text) == value else f"{value} ≈ {float(value):.4f}"


def rpm(speed: float | None, digits: int = DIGITS) -> str:
    """Return a speed in rad/s as revolutions per minute."""
    return NONE if speed is None else number(speed * RPM, digits)


def given_rpm(speed: float) -> str:
    """Return a speed of the input, in rad/s, as revolutions per minute."""
    return given(speed * RPM, 6)


def degrees(angle: float, digits: int = DIGITS) -> str:
    """Return an angle in rad as degrees."""
    return given(math.degrees(angle), digits)


def cell(value: Any) -> str:
    """Return a single value: words with the units of the report, 2.5, 3 ∠ 40°, 1/2, yes, '–' for none.

    >>> cell("1 kg*m**2 to 2 kg*m**2, 7 values"), cell("*.inertia")
    ('1 kg m² to 2 kg m², 7 values', '*.inertia')
    """
    if isinstance(value, str):
        return re.sub(r"(?<=\d )[A-Za-z]+\*[\w*/]+", lambda unit: unit_words(unit[0]), value)
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, complex):
        return f"{number(abs(value))} ∠ {degrees(float(np.angle(value)), 4)}°"
    if isinstance(value, float):
        return number(value)
    if value is None:
        return NONE
    return value.name.lower().replace("_", " ") if isinstance(value, Enum) else str(value)


@dataclass(frozen=True)
class Scale:
    """A unit with its prefix, and what an SI value is multiplied with."""

    unit: str
    factor: float


def scale(unit: str, values: Iterable[float]) -> Scale:
    """Return the prefix that suits the largest finite value of a column or a figure: 'N m', 'kN m', 'MN m'."""
    sizes = [abs(v) for v in values if math.isfinite(v)]
    for factor, prefix in PREFIXES:
        if any(size >= factor for size in sizes):
            return Scale(prefix + unit, 1.0 / factor)
    return Scale(unit, 1.0)
