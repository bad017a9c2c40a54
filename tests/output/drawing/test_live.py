"""What the page's script reads: the values of the lines to five digits, each coordinate once, no sign that ends it."""

import json

import numpy as np
import pytest
from tests.output.drawing.kinds import BUMP, KINDS, SPEED, torque
from tests.output.drawn import named

from torsion.output.drawing.live import MOST_POINTS, Page
from torsion.output.drawing.svg import framed
from torsion.output.drawing.text import plain
from torsion.output.figures.curves_over_time import over_time
from torsion.output.figures.figure import Figure


def read(*figures: Figure) -> tuple[list, list]:
    """Plots of every figure, and the coordinates."""
    page = Page()
    plots = [json.loads(page.figure(framed(figure)[1])) for figure in figures]
    return plots, json.loads(page.coordinates())


@pytest.mark.parametrize("kind", KINDS)
def test_values_are_those_of_the_lines_to_five_digits(kind: str) -> None:
    (plots,), places = read(KINDS[kind])
    panels = {panel.y.title: panel for panel in KINDS[kind].plots}
    for plot in plots:
        panel = panels[plot["y"]["title"]]
        lines = {plain(name): line for name, line in named(panel).items()}
        for one in plot["lines"]:
            x, y = np.array(places[one["x"]]), np.array(one["y"], dtype=float)
            if one["name"] != "orders":  # several of one name
                known = np.isfinite(lines[one["name"]].x)
                np.testing.assert_allclose(x, lines[one["name"]].x[known], rtol=1e-7)
                np.testing.assert_allclose(y, lines[one["name"]].y[known], rtol=6e-5)
        left, top, wide, high = plot["box"]
        assert min(left, top, wide, high) > 0
        assert (plot["x"]["title"], plot["y"]["log"]) == (panel.x.title, panel.y.is_log)
        assert plot["x"]["ends"][0] < plot["x"]["ends"][1]


def test_the_speeds_of_all_figures_are_written_once() -> None:
    plots, places = read(torque(), KINDS["stress"], KINDS["gear"])
    assert len(places) == 1
    assert {line["x"] for figure in plots for plot in figure for line in plot["lines"]} == {0}
    np.testing.assert_allclose(places[0], SPEED)


def test_a_place_without_a_value_is_null_and_names_cannot_end_the_element() -> None:
    page = Page()
    text = page.figure(framed(torque(lines=[("</script><b>", np.where(SPEED < 400, np.nan, BUMP))]))[1])
    assert "<" not in text
    (line,) = [one for one in json.loads(text)[0]["lines"] if "script" in one["name"]]
    assert line["name"] == "</script><b>"
    assert line["y"][0] is None


def test_of_a_long_line_the_extremes_are_kept() -> None:
    time, values = np.linspace(0.0, 1.0, 50_000), np.zeros(50_000)
    values[31_234], values[777] = 9.0, -8.0
    ((plot,),), places = read(over_time("m", "c", time=time, lines=[("a", values)], quantity="torque", unit="N m"))
    (line,) = plot["lines"]
    assert (max(line["y"]), min(line["y"])) == (9.0, -8.0)
    assert len(line["y"]) == len(places[line["x"]]) <= MOST_POINTS
    assert places[0][line["y"].index(9.0)] == pytest.approx(time[31_234], rel=1e-7)


def test_pictures_without_numbers_along_them_have_no_data() -> None:
    assert read(KINDS["sketch"], KINDS["twisted"], KINDS["mode"]) == ([[], [], []], [])
