"""The numbers of a figure as CSV: a table for each plot and each set of lines over one coordinate, all digits kept."""

import csv
import io
import math
import re
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.document import Document
from torsion.output.figures.figure import Axis, Cells, Figure, Line, Panel
from torsion.output.table_text import inert, one_line

Columns = list[tuple[str, FloatArray]]  # title with unit, values
Piece = str | tuple[FloatArray, ...] | Cells  # text as it stands, columns of numbers, a map


def csv_of(figure: Figure) -> str:
    """Comments with the caption, limits and ranges; then tables, apart by an empty line. A place without a value is
    empty; a figure without axes has no table."""
    return "".join(one if isinstance(one, str) else _written(_rows(one)) for one in pieces(figure))


def pieces(figure: Figure) -> Iterator[Piece]:
    """What the file consists of, one after another."""
    yield f"# {inert(one_line(figure.caption))}\n"
    for panel in figure.plots:
        for words in _comments(panel):
            yield f"# {inert(one_line(words))}\n"
        for titles, values in _tables(panel):
            yield "\n" + _written([list(map(inert, titles))])
            yield values


def tables(document: Document) -> Callable[[Path], list[Path]] | None:
    """What writes a file for every figure with axes, beside the place given; None where there is none."""
    figures = [
        item.block for item in document.body if isinstance(item.block, Figure) and item.block.plots
    ]
    return partial(_files, figures) if figures else None


def file_name(figure: Figure) -> str:
    """Of its file."""
    return "figure-" + re.sub(r"[^\w.-]+", "-", figure.name) + ".csv"


def _files(figures: list[Figure], target: Path) -> list[Path]:
    made = [target.with_name(file_name(figure)) for figure in figures]
    for path, figure in zip(made, figures, strict=True):
        path.write_text(csv_of(figure), encoding="utf-8")
    return made


def _comments(panel: Panel) -> Iterator[str]:
    """What is no table: limits and ranges."""
    axes = {"x": panel.x, "y": panel.y}
    yield f"{panel.y.title} over {panel.x.title}"
    for level in panel.levels:
        if level.name or level.label:
            yield f"{level.name or level.label}: {level.value!r} {axes[level.axis].unit}"
    for band in panel.bands:
        yield f"{band.label or band.name}: {band.low!r} to {band.high!r} {axes[band.axis].unit}"


def tables_of(panel: Panel) -> Iterator[Columns]:
    """The tables of the file as columns; NaN where there is no value."""
    for titles, values in _tables(panel):
        yield list(zip(titles, _columns(values), strict=True))


def _tables(panel: Panel) -> Iterator[tuple[list[str], tuple[FloatArray, ...] | Cells]]:
    """Lines by their coordinate, marks, and the cells of a map: the titles, and what is below them."""
    left = [line for line in panel.lines if line.name or panel.x.places]
    while left:
        x = left[0].x
        mine = [line for line in left if line.x is x or np.array_equal(line.x, x, equal_nan=True)]
        left = [line for line in left if not any(line is one for one in mine)]
        yield (
            [_title(panel.x), *(_column(line, panel.y) for line in mine)],
            (x, *(line.y for line in mine)),
        )
    for marks in panel.marks:
        if marks.name and marks.x.size:
            yield [_title(panel.x), f"{marks.name}: {_title(panel.y)}"], (marks.x, marks.y)
    if panel.cells is not None:
        cells = panel.cells
        yield [_title(panel.x), _title(panel.y), f"{cells.quantity} [{cells.unit}]"], cells


def _title(axis: Axis) -> str:
    return (f"{axis.quantity} [{axis.unit}]" if axis.unit else axis.quantity) or "place"


def _column(line: Line, axis: Axis) -> str:
    """The name of a line, with what is written beside it where that says more, and its unit."""
    own = line.name if line.label in line.name else f"{line.name}: {line.label}"
    return f"{own} [{axis.unit}]" if axis.unit else own or axis.quantity


def _rows(values: tuple[FloatArray, ...] | Cells) -> Iterator[list[Any]]:
    """Numbers with all their digits; nothing where there is no value."""
    for row in zip(*(column.tolist() for column in _columns(values)), strict=True):
        yield ["" if math.isnan(value) else value for value in row]


def _columns(values: tuple[FloatArray, ...] | Cells) -> tuple[FloatArray, ...]:
    """The columns themselves; of a map its coordinates and values."""
    if isinstance(values, Cells):
        x, y = np.meshgrid(values.x, values.y)
        return x.ravel(), y.ravel(), values.values.ravel()
    return tuple(np.asarray(column, dtype=float) for column in values)


def _written(rows: Iterable[list[Any]]) -> str:
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerows(rows)
    return target.getvalue()
