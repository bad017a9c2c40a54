"""What the page's script reads: the numbers of all figures in full, each list once, no sign that ends its element."""

import json
import zlib
from base64 import b64decode
from itertools import pairwise
from typing import Any

import numpy as np
from tests.for_all import for_all
from tests.output.drawing import curves_by_hand
from tests.output.drawing.kinds import BUMP, KINDS, SPEED, torque, waterfall
from tests.output.drawn import named

from torsion.output.drawing.page_data import LEFT_OUT, MOST_POINTS, THINNED, Page
from torsion.output.drawing.svg import framed
from torsion.output.drawing.words import plain
from torsion.output.figures import mode_shape
from torsion.output.figures.curves import over_time
from torsion.output.figures.figure import Axis, Figure
from torsion.output.report_figures import Cells, csv_of, pieces


def read(*figures: Figure) -> tuple[list[dict[str, Any]], list[np.ndarray], list[list[str]]]:
    """The data of every figure, the arrays and the lists of names of the page."""
    page = Page()
    data = [json.loads(page.figure(figure, framed(figure)[1])) for figure in figures]
    numbers = json.loads(page.numbers())
    columns = np.frombuffer(zlib.decompress(b64decode(numbers["doubles"])), dtype=np.uint8).reshape(
        8, -1
    )
    doubles = np.ascontiguousarray(columns.T).view("<f8").ravel()
    ends = [0, *np.cumsum(numbers["lengths"]).tolist()]
    return data, [doubles[first:last] for first, last in pairwise(ends)], numbers["names"]


@for_all("kind", KINDS)
def test_values_are_those_of_the_lines_to_the_last_digit(kind: str) -> None:
    (data,), arrays, _ = read(KINDS[kind])
    assert len(data["plots"]) == len(KINDS[kind].plots)
    for plot, panel in zip(data["plots"], KINDS[kind].plots, strict=True):
        lines = {plain(name): line for name, line in named(panel).items()}
        for one in plot["lines"]:
            if one["name"] != "orders":  # several of one name
                np.testing.assert_array_equal(arrays[one["x"]], lines[one["name"]].x)
                np.testing.assert_array_equal(arrays[one["y"]], lines[one["name"]].y)
        left, top, wide, high = plot["box"]
        assert min(left, top, wide, high) > 0
        assert (plot["x"]["title"], plot["y"]["log"]) == (panel.x.title, panel.y.is_log)
        assert plot["x"]["ends"][0] < plot["x"]["ends"][1]


@for_all("kind", KINDS)
def test_the_tables_of_a_figure_are_those_of_its_file(kind: str) -> None:
    (data,), arrays, _ = read(KINDS[kind])
    wanted = list(pieces(KINDS[kind])) if KINDS[kind].plots else []
    for one, other in zip(data.get("csv", []), wanted, strict=True):
        match other:
            case str():
                assert one == other
            case Cells():
                assert [arrays[one[key]].size for key in ("x", "y", "cells")] == [
                    other.x.size,
                    other.y.size,
                    other.values.size,
                ]
                np.testing.assert_array_equal(arrays[one["cells"]], other.values.ravel())
            case _:
                for at, column in zip(one, other, strict=True):
                    np.testing.assert_array_equal(arrays[at], column)


def test_the_speeds_of_all_figures_are_written_once() -> None:
    data, arrays, _ = read(torque(), KINDS["stress"], KINDS["gear"])
    assert (
        len({line["x"] for figure in data for plot in figure["plots"] for line in plot["lines"]})
        == 1
    )
    assert sum(np.array_equal(one, SPEED) for one in arrays) == 1


def test_a_place_without_a_value_is_kept_and_names_cannot_end_the_element() -> None:
    page = Page()
    figure = torque(lines=[("</script><b>", np.where(SPEED < 400, np.nan, BUMP))])
    text = page.figure(figure, framed(figure)[1])
    assert "<" not in text
    assert "<" not in page.numbers()
    (data,), arrays, _ = read(figure)
    (line,) = [one for one in data["plots"][0]["lines"] if "script" in one["name"]]
    assert line["name"] == "</script><b>"
    assert np.isnan(arrays[line["y"]][0])


def test_of_long_lines_the_extremes_are_kept_and_the_table_says_so() -> None:
    time, values = np.linspace(0.0, 1.0, 50_000), np.zeros(50_000)
    values[31_234], values[777] = 9.0, -8.0
    figure = over_time("m", "c", time, [("a", values), ("b", -values)], Axis("torque", "N m"))
    (data,), arrays, _ = read(figure)
    one, other = data["plots"][0]["lines"]
    assert one["x"] == other["x"]
    x, y = arrays[one["x"]], arrays[one["y"]]
    assert (y.max(), y.min()) == (9.0, -8.0)
    assert x.size == y.size <= MOST_POINTS
    assert x[y.argmax()] == time[31_234]
    assert data["csv"][0] == THINNED
    rows = {tuple(row) for row in np.transpose([arrays[at] for at in data["csv"][-1]]).tolist()}
    assert rows < {tuple(row) for row in np.transpose([time, values, -values]).tolist()}


def test_a_large_map_is_left_out_and_the_table_says_so() -> None:
    figure = waterfall(np.arange(1.0, 101.0), np.arange(300.0), np.ones((300, 100)))
    (data,), arrays, _ = read(figure)
    assert data["csv"][0] == LEFT_OUT
    assert sum(one.size for one in arrays) == 0
    assert csv_of(figure).count("\n") > 30_000


def test_a_mode_names_its_stations_and_says_what_moves() -> None:
    figure = KINDS["mode"]
    (data,), arrays, names = read(figure)
    upper, lower = data["plots"]
    assert upper["lines"] == lower["lines"] == []
    assert names[upper["stops"]["names"]] == ["motor", "<wheel>", "end", "ring"]
    np.testing.assert_array_equal(arrays[upper["stops"]["y"]], [1.0, 0.0, -1.0, -0.5])
    np.testing.assert_array_equal(arrays[lower["stops"]["x"]], [0.5, 1.5, 2.0])
    moving = {key: arrays[at].tolist() for key, at in data["moving"].items()}
    assert moving == {
        "x": [0.0, 1.0, 2.0, 2.0],
        "row": [0.0, 0.0, 0.0, 1.0],
        "angle": [1.0, 0.0, -1.0, -0.5],
        "ends": [0.0, 1.0, 1.0, 2.0, 2.0, 3.0],
        "marked": [0.0, 1.0, 2.0, 3.0],
    }


def test_a_mode_of_too_many_stations_says_that_it_has_neither_cursor_nor_motion() -> None:
    count = MOST_POINTS + 1
    x, link = np.arange(float(count)), np.ones(count - 1)
    figure = mode_shape.mode(
        "mode-1",
        "c",
        x=x,
        row=0 * x,
        ends=np.column_stack([np.arange(count - 1), np.arange(1, count)]),
        marked=np.ones(count, dtype=bool),
        angle=np.linspace(1.0, -1.0, count),
        torque=link,
        ticks=[(0.0, "a")],
        stations=[f"s{k}" for k in range(count)],
        spans=[f"e{k}" for k in range(count - 1)],
    )
    (data,), _, _ = read(figure)
    assert "moving" not in data
    assert data["said"] == "no cursor and no motion here: more than 1,200 stations or elements"
    assert "said" not in read(KINDS["mode"])[0][0]


def test_lines_over_one_coordinate_keep_the_same_points_in_all_plots_of_a_figure() -> None:
    speed = np.linspace(300.0, 1800.0, 3001)
    small = 1.0 / (1.0 + ((speed - 900.0) / 3.0) ** 2)
    figure = curves_by_hand.stress(
        "s",
        "c",
        speed=speed,
        synthesis=small,
        bad=speed < 0,
        continuous=np.full(3001, 50.0) + np.sin(speed),
    )
    (data,), _, _ = read(figure)
    assert len(data["plots"]) == 2
    assert len({line["x"] for plot in data["plots"] for line in plot["lines"]}) == 1


def test_pictures_without_axes_have_no_data() -> None:
    assert read(KINDS["sketch"])[0] == [{"plots": []}]
