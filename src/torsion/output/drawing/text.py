"""Texts in SVG: escaped, with subscripts, on numbers without needless digits."""

import re
from html import escape

SUBSCRIPT = re.compile(r"_\{([^{}]*)\}")
HALO = ' stroke="#ffffff" stroke-width="2.6" stroke-linejoin="round" paint-order="stroke"'  # of words over lines
FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")  # in XML 1.0


def shown(value: float) -> str:
    """Return a length in px, to a hundredth.

    >>> shown(12.5), shown(3.0), shown(-0.001)
    ('12.5', '3', '0')
    """
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text


def clean(text: str) -> str:
    """Return a text for an attribute or an element: escaped, and without the signs that XML forbids."""
    return escape(FORBIDDEN.sub("�", text))


def plain(text: str) -> str:
    """Return a text without the marks of subscripts."""
    return SUBSCRIPT.sub(r"\1", text)


def words(x: float, y: float, text: str, more: str = "") -> str:
    """Return a text at a place, its subscripts lowered; more: further attributes."""
    inside = SUBSCRIPT.sub(
        r'<tspan dy="2.5" font-size="75%">\1</tspan><tspan dy="-2.5">&#8203;</tspan>', clean(text)
    )
    return f'<text x="{shown(x)}" y="{shown(y)}"{more}>{inside}</text>'
