"""Rebuilding the house changes no digit: every bit, or 1e-12 of the sums, which processors add in unlike orders."""

import json
from xml.etree import ElementTree

import pytest
from tests.contracts.frozen import FILE, of_scene, of_trains, reported, written

from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Figure

KNOWN = json.loads(FILE.read_text(encoding="utf-8"))


def _equal(found: dict, known: dict) -> None:
    assert found.keys() == known.keys()
    for name, digits in found.items():
        if digits == known[name]:
            continue
        assert isinstance(digits[1], int), name
        assert digits[1] == known[name][1], name
        assert digits[2] == pytest.approx(known[name][2], rel=1e-12, abs=1e-12 * known[name][3]), (
            name
        )
        assert digits[3] == pytest.approx(known[name][3], rel=1e-12), name


def digits_are_the_frozen_ones(scene: str) -> None:
    _equal(of_scene(written(scene)), KNOWN[scene])


def every_figure_is_an_element_with_all_its_lines_and_a_name_of_its_own(scene: str) -> None:
    report = reported(scene)
    figures = [item.block for item in report.body if isinstance(item.block, Figure)]
    assert len({figure.name for figure in figures}) == len(figures)
    for figure in figures:
        root = ElementTree.fromstring(svg(figure))
        lines = [
            one for one in root.iter("{http://www.w3.org/2000/svg}g") if one.get("class") == "line"
        ]
        assert len(lines) == sum(len(plot.lines) for plot in figure.plots)
        assert "nan" not in {
            word for one in root.iter() for value in one.attrib.values() for word in value.split()
        }


def test_digits_of_random_trains_are_the_frozen_ones() -> None:
    _equal(of_trains(), KNOWN["random trains"])
