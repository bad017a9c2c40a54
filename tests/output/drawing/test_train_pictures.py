"""Sketches and modes: every symbol, few words where there are many."""

import itertools
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from tests.output.drawn import plot

from torsion.output.drawing.svg import svg
from torsion.output.drawing.words import GROWTH, width
from torsion.output.figures.figure import Disc, Figure, Link, Sketch
from torsion.output.figures.mode_shape import MOST_TICKS, mode


def chain(number: int) -> str:
    """Discs with couplings between them."""
    discs = tuple(Disc(float(k), 0.0, 0.5, f"p{k}", "disc") for k in range(number))
    links = tuple(
        Link("coupling", (float(k), 0.0), (k + 1.0, 0.0), f"c{k}") for k in range(number - 1)
    )
    return svg(Figure("chain", "c", (Sketch(discs, links),)))


@pytest.mark.parametrize("number", [20, 500])
def test_a_sketch_has_every_symbol_and_says_how_many_components_have_no_label(number: int) -> None:
    text = chain(number)
    labels = re.findall(r">[pc](\d+)<", text)
    omitted = re.search(r"Not labelled for want of room: (\d+) component", text)
    assert len(labels) == 2 * number - 1 - int(omitted[1] if omitted else 0)
    assert (omitted is None) == (number == 20)
    assert {">p0<", f">p{number - 1}<"} <= set(re.findall(r">p\d+<", text))
    boxes = max(re.findall(r' d="([^"]*)"', text), key=lambda d: d.count("z"))
    assert boxes.count("z") == number


def test_words_of_a_sketch_do_not_overlap() -> None:
    discs = tuple(Disc(0.4 * k, 0.0, 0.5, f"{k} a rather long name", "disc") for k in range(12))
    root = ET.fromstring(svg(Figure("s", "c", (Sketch(discs, ()),))))
    boxes = []
    for one in root.iter("{http://www.w3.org/2000/svg}text"):
        x, y, half = float(one.get("x")), float(one.get("y")), GROWTH * width(one.text) / 2
        boxes.append((x - half, y - 10, x + half, y + 2))
    assert len(boxes) >= 8
    for one, other in itertools.combinations(boxes, 2):
        assert one[0] >= other[2] or other[0] >= one[2] or one[1] >= other[3] or other[1] >= one[3]


def test_a_mode_plot_of_many_stations_names_some() -> None:
    x = np.arange(500.0)
    ends = np.column_stack([np.arange(499), np.arange(1, 500)])
    figure = mode(
        "m",
        "c",
        x=x,
        row=0 * x,
        ends=ends,
        marked=x < 0,
        angle=np.cos(x),
        torque=np.sin(x[1:]),
        ticks=[(float(at), f"p{at:.0f}") for at in x],
    )
    named = [int(name[1:]) for _, name in plot(figure).x.places]
    assert named[0] == 0
    assert len(named) <= MOST_TICKS
    assert set(np.diff(named).tolist()) == {13}
    assert {f"p{k}" for k in named} <= set(re.findall(r">(p\d+)<", svg(figure)))


def test_a_mode_is_one_line_along_its_shaft_and_broken_at_a_branch() -> None:
    ends = np.array([[0, 1], [1, 2], [1, 3], [3, 4]])
    x = np.array([0.0, 1, 2, 1.5, 2.5])
    angle = np.array([1.0, 0.5, -1.0, 0.2, 0.3])
    figure = mode(
        "m",
        "c",
        x=x,
        row=np.zeros(5),
        ends=ends,
        marked=np.ones(5, dtype=bool),
        angle=angle,
        torque=np.array([1.0, 0.5, 0.2, 0.1]),
        ticks=[],
    )
    (line,) = plot(figure).lines
    np.testing.assert_array_equal(line.x, [0, 1, 2, np.nan, 1, 1.5, 2.5])
    np.testing.assert_array_equal(line.y, [1, 0.5, -1, np.nan, 0.5, 0.2, 0.3])


def test_the_drawing_of_a_damper_keeps_its_housing_in_front_of_its_ring() -> None:
    discs = tuple(
        Disc(float(k), 0.0, 0.5, "", "damper", ring=0.5, role="absorber") for k in range(2)
    )
    text = svg(Figure("dampers", "c", (Sketch(discs, ()),)))
    assert text.index("stroke-dasharray") < text.index("#ead2e0")
