"""Colours on a dark screen, computed: what stands out on paper stands out there, what lies behind lies behind."""

from functools import lru_cache

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.drawing.pens import GRADES

WHITE, PAPER = "#ffffff", "#151a1f"  # on paper, on a dark screen
BEHIND = 0.77  # lightness from which a colour is a tint or a thin line that lies behind
AREAS = frozenset(
    pattern.fill for pattern in GRADES.values() if not pattern.slopes
)  # plain: what is drawn on them is ink
CONTRAST = 4.6  # at least, of what stands out against the dark paper
# Björn Ottosson, "A perceptual color space for image processing" (2020): linear sRGB to cone responses to Oklab
CONES = np.array(
    [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ]
)
OKLAB = np.array(
    [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ]
)


@lru_cache
def dark(colour: str) -> str:
    """The counterpart of a colour.

    >>> dark("#ffffff"), contrast(dark("#222222"), PAPER) > CONTRAST
    ('#151a1f', True)
    """
    if colour == WHITE:
        return PAPER
    light, *hue = _oklab(colour).tolist()
    if light >= BEHIND or colour in AREAS:
        return _word(np.array([0.24 + 0.75 * (1.0 - light), *hue]))
    light = max(light, 1.15 - light)
    while contrast(lighter := _word(np.array([light, *hue])), PAPER) < CONTRAST:
        light += 0.01
    return lighter


def contrast(first_colour: str, background: str) -> float:
    """Of two colours, from 1 to 21 (W3C, WCAG 2.1, relative luminance and contrast ratio).

    >>> round(contrast("#ffffff", "#000000"), 6)
    21.0
    """
    low, high = sorted(
        float(_linear(colour) @ [0.2126, 0.7152, 0.0722]) for colour in (first_colour, background)
    )
    return (high + 0.05) / (low + 0.05)


def _linear(colour: str) -> FloatArray:
    """(3,) linear red, green and blue of #rrggbb."""
    parts = np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)]) / 255.0
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def _oklab(colour: str) -> FloatArray:
    lab: FloatArray = OKLAB @ np.cbrt(CONES @ _linear(colour))
    return lab


def _word(lab: FloatArray) -> str:
    linear = np.clip(np.linalg.solve(CONES, np.linalg.solve(OKLAB, lab) ** 3), 0.0, 1.0)
    parts = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1.0 / 2.4) - 0.055)
    return "#" + "".join(f"{round(part):02x}" for part in (255.0 * parts).tolist())
