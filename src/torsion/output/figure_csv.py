"""The numbers of a figure as CSV: a table for each plot and each set of lines over one coordinate, all digits kept."""

import csv
import io
import math
import re
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.document import Document
from torsion.output.figures.figure import Axis, Figure, Line, Panel
from torsion.output.table_text import one_line

Row = list[Any]


def csv_of(figure: Figure) -> str:
    """Comments with the caption, limits and ranges; then tables, apart by an empty line. A place without a value is
    empty; a figure without axes has no table."""
    target = io.StringIO()
    rows = csv.writer(target, lineterminator="\n")
    target.write(f"# {one_line(figure.caption)}\n")
    for panel in figure.plots:
        for words in _comments(panel):
            target.write(f"# {one_line(words)}\n")
        for table in _tables(panel):
            target.write("\n")
            rows.writerows(table)
    return target.getvalue()


def tables(document: Document) -> Callable[[Path], list[Path]] | None:
    """What writes a file for every figure with axes, beside the place given; None where there is none."""
    figures = [item.block for item in document.body if isinstance(item.block, Figure) and item.block.plots]
    return partial(_written, figures) if figures else None


def _written(figures: list[Figure], target: Path) -> list[Path]:
    made = [target.with_name("figure-" + re.sub(r"[^\w.-]+", "-", figure.name) + ".csv") for figure in figures]
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


def _tables(panel: Panel) -> Iterator[list[Row]]:
    """Lines by their coordinate, marks, and the cells of a map."""
    left = [line for line in panel.lines if line.name or panel.x.places]
    while left:
        x = left[0].x
        mine = [line for line in left if line.x is x or np.array_equal(line.x, x, equal_nan=True)]
        left = [line for line in left if not any(line is one for one in mine)]
        yield [[_title(panel.x), *(_column(line, panel.y) for line in mine)],
               *_rows([x, *(line.y for line in mine)])]  # fmt: skip
    for marks in panel.marks:
        if marks.name and marks.x.size:
            yield [[_title(panel.x), f"{marks.name}: {_title(panel.y)}"], *_rows([marks.x, marks.y])]
    if panel.cells is not None:
        cells = panel.cells
        x, y = np.meshgrid(cells.x, cells.y)
        head = [_title(panel.x), _title(panel.y), f"{cells.quantity} [{cells.unit}]"]
        yield [head, *_rows([x.ravel(), y.ravel(), cells.values.ravel()])]


def _title(axis: Axis) -> str:
    return (f"{axis.quantity} [{axis.unit}]" if axis.unit else axis.quantity) or "place"


def _column(line: Line, axis: Axis) -> str:
    """The name of a line, with what is written beside it where that says more, and its unit."""
    own = line.name if line.label in line.name else f"{line.name}: {line.label}"
    return f"{own} [{axis.unit}]" if axis.unit else own or axis.quantity


def _rows(columns: list[FloatArray]) -> Iterator[Row]:
    """Numbers with all their digits; nothing where there is no value."""
    for row in zip(*(column.tolist() for column in columns), strict=True):
        yield ["" if math.isnan(value) else value for value in row]
