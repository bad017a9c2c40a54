"""Colours on a dark screen: legible, of the same hue, behind what lies behind."""

import re
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all
from tests.output.drawing import dark_colours as module
from tests.output.drawing.dark_colours import PAPER, contrast, dark

from torsion import output
from torsion.output.drawing.pens import BANDS, COLOURS, GRADES, GRID, INK, ROLES, Pattern
from torsion.output.drawing.sketch import FILLS, SOFT

OUTPUT = Path(output.__file__).parent
COLOUR = re.compile("#[0-9a-fA-F]{6}")
STANDING_OUT = sorted({*COLOURS, INK, SOFT, *(one.colour for one in ROLES.values())})
PLAIN = (one.fill for one in GRADES.values() if not one.slopes)
BEHIND = sorted({GRID, *FILLS.values(), *(fill for fill, *_ in BANDS.values()), *PLAIN})


def test_contrast_is_that_of_the_standard() -> None:
    """Grey of 119 of 255 on white: the least contrast of 4.5 is just missed (W3C, understanding 1.4.3)."""
    assert contrast("#777777", "#ffffff") == pytest.approx(4.48, abs=0.005)
    assert contrast("#ff0000", "#ffffff") == pytest.approx(1.05 / 0.2626, rel=1e-12)


def test_colours_of_the_perceptual_space_are_those_published() -> None:
    """Ottosson (2020): white is (1, 0, 0)."""
    np.testing.assert_allclose(module._oklab("#ffffff"), [1.0, 0.0, 0.0], atol=1e-7)
    assert all(module._word(module._oklab(one)) == one.lower() for one in (*STANDING_OUT, *BEHIND))


@for_all("colour", STANDING_OUT)
def test_what_stands_out_on_paper_stands_out_on_a_dark_screen(colour: str) -> None:
    assert contrast(dark(colour), PAPER) >= 4.5
    (_, *was), (_, *now) = module._oklab(colour), module._oklab(dark(colour))
    assert float(np.dot(was, now)) >= 0.8 * float(np.dot(was, was)) * (
        np.hypot(*was) > 0.02
    )  # the hue stays


@for_all("colour", BEHIND)
def test_what_lies_behind_leaves_ink_legible(colour: str) -> None:
    assert contrast(dark(INK), dark(colour)) >= 4.5
    assert contrast(dark(colour), PAPER) < 3.0


@pytest.mark.parametrize(
    "pattern", [one for one in GRADES.values() if one.slopes], ids=lambda one: one.words
)
def test_a_hatching_stands_out_from_its_area(pattern: Pattern) -> None:
    """W3C, WCAG 2.1, 1.4.11: what is no text has a contrast of 3 at least."""
    assert contrast(pattern.colour, pattern.fill) >= 3.0
    assert contrast(dark(pattern.colour), dark(pattern.fill)) >= 3.0


def test_every_colour_of_a_drawing_has_its_counterpart_in_the_style() -> None:
    """Of drawings and figures; the colours of maps are in images, which stay as they are."""
    folders = (OUTPUT / "drawing", OUTPUT / "figures")
    files = [path for folder in folders for path in folder.glob("*.py") if path.name != "image.py"]
    used = {colour for path in files for colour in COLOUR.findall(path.read_text("utf-8"))}
    rule = re.compile(r'figure \[(fill|stroke)="(#\w+)"\] { \1: light-dark\(\2, (#\w+)\); }')
    stated = rule.findall((OUTPUT / "pages" / "templates" / "report_dark.css").read_text("utf-8"))
    assert sorted(stated) == sorted(
        (attribute, colour, dark(colour)) for attribute in ("fill", "stroke") for colour in used
    )
