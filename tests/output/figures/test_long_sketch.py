"""Sketches and mode plots of trains with many components: every symbol, few labels and few elements of the figure."""

import re

import numpy as np
import pytest

from torsion.output.figures.mode_shape import MOST_TICKS, mode
from torsion.output.figures.sketch import MOST_LABELS, sketch
from torsion.output.figures.style import page


def chain(number: int) -> str:
    """Discs with couplings between them."""
    points = [{"x": float(k), "row": 0.0, "size": 0.5, "label": f"p{k}", "kind": "disc"} for k in range(number)]
    links = [
        {"kind": "coupling", "start": (float(k), 0.0), "end": (k + 1.0, 0.0), "label": f"c{k}"}
        for k in range(number - 1)
    ]
    return page("chain", sketch, points=points, links=links)


@pytest.mark.parametrize("number", [30, 31, 500])
def test_a_sketch_of_many_components_has_every_symbol_and_labels_in_even_steps(number):
    text = chain(number)
    named = [int(found) for found in re.findall(r">p(\d+)<", text)]
    whole = 2 * number - 1 <= 60
    assert len(named) == number if whole else len(named) <= MOST_LABELS
    assert len(set(np.diff(named).tolist())) == 1
    boxes = max(re.findall(r'd="([^"]*)"', text), key=lambda d: d.count("z"))
    assert boxes.count("z") == number
    assert text.count("<path") < 12


def test_a_mode_plot_of_many_stations_names_some():
    x = np.arange(500.0)
    ends = np.column_stack([np.arange(499), np.arange(1, 500)])
    text = page("m", mode, x=x, row=0 * x, ends=ends, marked=x < 0, angle=np.cos(x), torque=np.sin(x[1:]),
                ticks=[(float(at), f"p{at:.0f}") for at in x])  # fmt: skip
    named = [int(found) for found in re.findall(r">p(\d+)<", text)]
    assert named[0] == 0
    assert len(named) <= MOST_TICKS
    assert set(np.diff(named).tolist()) == {13}


def test_the_drawing_of_a_damper_keeps_its_housing_in_front_of_its_ring():
    points = [{"x": float(k), "row": 0.0, "size": 0.5, "label": "", "kind": "damper", "ring": 0.5} for k in range(2)]
    text = page("dampers", sketch, points=points, links=[])
    assert text.index("stroke-dasharray") < text.index("#ead2e0")
