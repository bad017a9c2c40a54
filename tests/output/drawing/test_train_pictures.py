"""Sketches, modes and twisted trains: every symbol, few words where there are many, near bodies before far ones."""

import itertools
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from tests.output.drawing.kinds import TWISTED
from tests.output.drawn import plot

from torsion.output.drawing import twisted
from torsion.output.drawing.sketch import MOST_LABELS
from torsion.output.drawing.svg import svg
from torsion.output.drawing.words import GROWTH, width
from torsion.output.figures.figure import Disc, Figure, Link, Sketch, Twisted
from torsion.output.figures.mode_shape import MOST_TICKS, mode

TUBE = {"x": np.array([0.0, 0, 1, 1]), "radius": np.array([0.0, 0.1, 0.1, 0]), "strip": np.array([0, 1, 2])}


def chain(number: int) -> str:
    """Discs with couplings between them."""
    discs = tuple(Disc(float(k), 0.0, 0.5, f"p{k}", "disc") for k in range(number))
    links = tuple(Link("coupling", (float(k), 0.0), (k + 1.0, 0.0), f"c{k}") for k in range(number - 1))
    return svg(Figure("chain", "c", (Sketch(discs, links),)))


@pytest.mark.parametrize("number", [30, 31, 500])
def test_a_sketch_of_many_components_has_every_symbol_and_labels_in_even_steps(number: int) -> None:
    text = chain(number)
    named = [int(found) for found in re.findall(r">p(\d+)<", text)]
    whole = 2 * number - 1 <= 60
    assert len(named) == number if whole else len(named) <= MOST_LABELS
    assert len(set(np.diff(named).tolist())) == 1
    boxes = max(re.findall(r' d="([^"]*)"', text), key=lambda d: d.count("z"))
    assert boxes.count("z") == number
    assert text.count("<path") < 12 + 2 * 2 * MOST_LABELS


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
    figure = mode("m", "c", x=x, row=0 * x, ends=ends, marked=x < 0, angle=np.cos(x), torque=np.sin(x[1:]),
                  ticks=[(float(at), f"p{at:.0f}") for at in x])  # fmt: skip
    named = [int(name[1:]) for _, name in plot(figure).x.places]
    assert named[0] == 0
    assert len(named) <= MOST_TICKS
    assert set(np.diff(named).tolist()) == {13}
    assert {f"p{k}" for k in named} <= set(re.findall(r">(p\d+)<", svg(figure)))


def test_a_mode_is_one_line_along_its_shaft_and_broken_at_a_branch() -> None:
    ends = np.array([[0, 1], [1, 2], [1, 3], [3, 4]])
    x = np.array([0.0, 1, 2, 1.5, 2.5])
    angle = np.array([1.0, 0.5, -1.0, 0.2, 0.3])
    figure = mode("m", "c", x=x, row=np.zeros(5), ends=ends, marked=np.ones(5, dtype=bool), angle=angle,
                  torque=np.array([1.0, 0.5, 0.2, 0.1]), ticks=[])  # fmt: skip
    (line,) = plot(figure).lines
    np.testing.assert_array_equal(line.x, [0, 1, 2, np.nan, 1, 1.5, 2.5])
    np.testing.assert_array_equal(line.y, [1, 0.5, -1, np.nan, 0.5, 0.2, 0.3])


def test_the_drawing_of_a_damper_keeps_its_housing_in_front_of_its_ring() -> None:
    discs = tuple(Disc(float(k), 0.0, 0.5, "", "damper", ring=0.5) for k in range(2))
    text = svg(Figure("dampers", "c", (Sketch(discs, ()),)))
    assert text.index("stroke-dasharray") < text.index("#ead2e0")


def bodies(*moved: tuple[float, float, float]) -> tuple[np.ndarray, ...]:
    """x, place, strip and body of tubes moved along x, y and z."""
    x = np.concatenate([TUBE["x"] + m[0] for m in moved])
    place = np.repeat([m[1:] for m in moved], 4, axis=0)
    strip = np.concatenate([TUBE["strip"] + 4 * k for k in range(len(moved))])
    return x, place, strip, np.repeat(np.arange(len(moved)), 3)


def first_seen(*moved: tuple[float, float, float]) -> list[int]:
    """Bodies in the order in which they are drawn."""
    order = twisted.order(*bodies(*moved))
    return list(dict.fromkeys((order // 3).tolist()))


def test_the_driven_end_is_nearer() -> None:
    assert first_seen((1, 0, 0), (0, 0, 0), (2, 0, 0)) == [1, 0, 2]


def test_of_two_side_by_side_the_one_above_and_in_front_is_nearer() -> None:
    assert first_seen((0, 0, 1), (0, 0, 0)) == [1, 0]
    assert first_seen((0, 0, 0), (0, 1, 0)) == [1, 0]


def test_one_behind_the_end_of_another_is_drawn_after_it_wherever_it_lies() -> None:
    assert first_seen((0, 0, 0), (1, 5, -5)) == [0, 1]


def test_strips_of_a_body_stay_together_from_its_driving_end() -> None:
    order = twisted.order(*bodies((0.5, 0, 0), (0, 0, -1)))
    assert order.tolist() == [3, 4, 5, 0, 1, 2]


def test_the_eye_is_above_in_front_and_at_the_driven_end() -> None:
    x, y, z = twisted.EYE
    assert x > 0 > y
    assert z > 0
    np.testing.assert_allclose(np.linalg.norm([x, y, z]), 1.0, rtol=1e-14)


def test_half_of_a_tube_and_its_driven_end_are_seen() -> None:
    """Of AROUND sides of the wall one half; all of the end that faces the eye, none of the other."""
    tube = Twisted(**TUBE, place=np.zeros((4, 2)), turn=np.zeros(4), angle=np.zeros(4),
                   body=np.zeros(3, dtype=np.int64), labels=[])  # fmt: skip
    text = svg(Figure("t", "c", (tube,)))
    outlines = re.findall(r"M[^Mz]*z", text)
    assert abs(len(outlines) - 1.5 * twisted.AROUND) <= 2


def test_the_ends_of_the_scale_have_the_colours_of_the_angles() -> None:
    text = svg(Figure("t", "c", (TWISTED,)))
    assert "#0072b2" in text
    assert "#d55e00" in text
    assert ">angle / largest, each at its own speed<" in text
