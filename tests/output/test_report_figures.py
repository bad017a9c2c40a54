"""The figures of a report in Python are those of its page, with their numbers."""

import csv
import dataclasses

import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Figure
from torsion.output.figures.variants import histogram
from torsion.output.numbers import RPM


def test_they_are_the_figures_of_the_page_in_its_order(train: Findings) -> None:
    drawn = [
        item.block for item in document(train, is_full=True).body if isinstance(item.block, Figure)
    ]
    found = torsion.figures(train)
    assert list(found) == [one.name for one in drawn]
    assert [one.svg for one in found.values()] == [svg(one) for one in drawn]
    assert all(one._repr_svg_() == one.svg for one in found.values())
    assert all(
        one._repr_mimebundle_()["text/plain"] == f"{one.name}: {one.caption}"
        for one in found.values()
    )


def test_a_figure_is_frozen(train: Findings) -> None:
    figure = next(iter(torsion.figures(train).values()))
    with pytest.raises(dataclasses.FrozenInstanceError):
        figure.name = "other"  # type: ignore[misc]


def test_tables_are_those_of_the_csv_with_every_digit(train: Findings) -> None:
    for figure in torsion.figures(train).values():
        pieces = [
            [line for line in piece.splitlines() if not line.startswith("#")]
            for piece in figure.csv.split("\n\n")[1:]
        ]
        assert len(pieces) == len(figure.tables)
        for lines, table in zip(pieces, figure.tables, strict=True):
            _, *rows = csv.reader(lines)
            written = np.array([[float(cell or "nan") for cell in row] for row in rows]).T
            np.testing.assert_array_equal(written, [*table.values()])


def test_a_torque_over_speed_is_that_of_the_response(train: Findings) -> None:
    figure = next(
        one for name, one in torsion.figures(train).items() if name.startswith("torque-1-")
    )
    response = train.need(Response)
    speed = figure.tables[0]["speed of the reference component [rpm]"]
    np.testing.assert_array_equal(speed, response.speed * RPM)


def test_values_that_differ_by_rounding_are_one_bar() -> None:
    values = 0.95 * (1.0 + np.finfo(float).eps * np.array([0.0, 1.0, 2.0, 0.0, 1.0, 2.0]))
    assert histogram(values).y.max() == pytest.approx(100.0)
