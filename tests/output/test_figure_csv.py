"""The numbers of a figure as CSV are those that it draws, to the last digit."""

import csv
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all
from tests.output.drawing.kinds import BUMP, KINDS, SPEED

import torsion
from torsion.output.figures.figure import Figure
from torsion.output.report_figures import csv_of
from torsion.output.write import write
from torsion.runner import solved

SCENES = Path(torsion.__file__).parents[2] / "shafting_specs"


def parts(figure: Figure) -> tuple[list[str], list[tuple[list[str], np.ndarray]]]:
    """Comments, and titles with values of every table; NaN where a cell is empty."""
    head, *pieces = csv_of(figure).split("\n\n")
    found, comments = [], head.splitlines()
    for piece in pieces:
        lines = [line for line in piece.splitlines() if not line.startswith("#")]
        comments += [line for line in piece.splitlines() if line.startswith("#")]
        titles, *rows = csv.reader(lines)
        found.append((titles, np.array([[float(cell or "nan") for cell in row] for row in rows])))
    return comments, found


def test_lines_over_one_coordinate_are_columns_of_one_table() -> None:
    comments, ((titles, values),) = parts(KINDS["torque"])
    assert titles == [
        "speed of the reference component [rpm]",
        "total vibratory torque [N m]",
        "order 1 [N m]",
        "order <2> [N m]",
    ]
    np.testing.assert_array_equal(values[:, 0], SPEED)
    shown = KINDS["torque"].lines["order 1"].y
    assert np.isnan(shown).any()
    np.testing.assert_array_equal(values[:, 2], shown)
    np.testing.assert_array_equal(values[~np.isnan(shown), 2], BUMP[~np.isnan(shown)])
    assert comments[0] == "# torque in <a> & b"
    assert "# T_{KW}: 80.0 N m" in comments
    assert "# rated speed: 1500.0 rpm" in comments
    assert "# barred range: 800.0 to 1000.0 rpm" in comments


@for_all("kind", KINDS)
def test_every_named_line_and_mark_of_every_kind_stands_in_a_table(kind: str) -> None:
    _, tables = parts(KINDS[kind])
    found = [
        (title, values[:, 0], values[:, k])
        for titles, values in tables
        for k, title in enumerate(titles[1:], start=1)
    ]
    for panel in KINDS[kind].plots:
        for one in (*panel.lines, *panel.marks):
            assert (
                not one.name
                or any(
                    title.startswith(one.name)
                    and title.endswith(f"[{panel.y.unit}]" if panel.y.unit else title)
                    and np.array_equal(x, one.x, equal_nan=True)
                    and np.array_equal(y, one.y, equal_nan=True)
                    for title, x, y in found
                )
                or one.x.size == 0
            )


def test_a_map_is_a_row_for_each_point() -> None:
    _, ((titles, values),) = parts(KINDS["stability map"])
    assert titles == [
        "speed of the reference component [rpm]",
        "joint angle [deg]",
        "growth rate [1/s]",
    ]
    cells = KINDS["stability map"].plots[0].cells
    np.testing.assert_array_equal(values[:, 2].reshape(cells.values.shape), cells.values)
    assert (values[0, :2], values[-1, :2]) == (
        pytest.approx([300.0, 5.0]),
        pytest.approx([1800.0, 15.0]),
    )


def test_on_request_every_figure_with_axes_has_a_file(tmp_path: Path) -> None:
    made = write(solved(SCENES / "three_discs.yaml"), tmp_path, also=("figures",))
    figures = [
        item.block for item in made.body if isinstance(item.block, Figure) and item.block.plots
    ]
    names = {f"figure-{figure.name}.csv".replace(" ", "-") for figure in figures}
    assert names == {path.name for path in tmp_path.glob("*.csv")} != set()
    write(solved(SCENES / "three_discs.yaml"), tmp_path / "plain")
    assert not list((tmp_path / "plain").glob("*.csv"))
