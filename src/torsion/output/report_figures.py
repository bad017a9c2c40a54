"""The figures of a report for Python: frozen data that draws itself, with its numbers as arrays and as CSV."""

import math
import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.chapters import chapters
from torsion.output.document import Document
from torsion.output.drawing.svg import svg
from torsion.output.figures.figure import Axis, Cells, Figure, Line, Panel
from torsion.output.table_text import csv_rows, inert, one_line

Values = tuple[FloatArray, ...] | Cells  # columns of numbers, or a map
Piece = str | Values  # a text stays unchanged


def csv_of(figure: Figure) -> str:
    """Return comments with the caption, limits and ranges, then tables separated by an empty line.

    A cell without a value is empty; a figure without axes has no table.
    """
    return "".join(
        piece if isinstance(piece, str) else csv_rows(_rows(piece)) for piece in pieces(figure)
    )


def pieces(figure: Figure) -> Iterator[Piece]:
    """Yield the parts of the file in their order."""
    yield f"# {inert(one_line(figure.caption))}\n"
    for panel in figure.plots:
        for comment in _comments(panel):
            yield f"# {inert(one_line(comment))}\n"
        for titles, values in _tables(panel):
            yield "\n" + csv_rows([titles])
            yield values


def tables(document: Document) -> Callable[[Path], list[Path]] | None:
    """Return a writer of one file for every figure with axes, next to its argument; None if no figure has axes."""
    figures = [
        item.block for item in document.body if isinstance(item.block, Figure) and item.block.plots
    ]
    return partial(_write_files, figures) if figures else None


def file_name(figure: Figure) -> str:
    """Return the name of the CSV file of a figure."""
    return "figure-" + re.sub(r"[^\w.-]+", "-", figure.name) + ".csv"


def _write_files(figures: list[Figure], target: Path) -> list[Path]:
    paths = [target.with_name(file_name(figure)) for figure in figures]
    for path, figure in zip(paths, figures, strict=True):
        path.write_text(csv_of(figure), encoding="utf-8")
    return paths


def _comments(panel: Panel) -> Iterator[str]:
    """Yield what is no table: limits and ranges."""
    axes = {"x": panel.x, "y": panel.y}
    yield f"{panel.y.title} over {panel.x.title}"
    for level in panel.levels:
        if level.name or level.label:
            yield f"{level.name or level.label}: {level.value!r} {axes[level.axis].unit}"
    for band in panel.bands:
        yield f"{band.label or band.name}: {band.low!r} to {band.high!r} {axes[band.axis].unit}"


def tables_of(panel: Panel) -> Iterator[list[tuple[str, FloatArray]]]:
    """Yield the tables of the file as columns (title, values); NaN if there is no value."""
    for titles, values in _tables(panel):
        yield list(zip(titles, _columns(values), strict=True))


def _tables(panel: Panel) -> Iterator[tuple[list[str], Values]]:
    """Yield titles and values: lines by their coordinate, marks, and the cells of a map."""
    x_title, y_title = map(_axis_title, (panel.x, panel.y))
    groups: list[list[Line]] = []
    for line in panel.lines:
        if line.name or panel.x.places:
            same_x = (
                group
                for group in groups
                if line.x is group[0].x or np.array_equal(line.x, group[0].x, equal_nan=True)
            )
            group = next(same_x, None)
            if group is None:
                groups.append([line])
            else:
                group.append(line)

    for group in groups:
        titles = [_line_title(line, panel.y) for line in group]
        yield [x_title, *titles], (group[0].x, *(line.y for line in group))
    for marks in panel.marks:
        if marks.name and marks.x.size:
            yield [x_title, f"{marks.name}: {y_title}"], (marks.x, marks.y)
    if panel.cells is not None:
        quantity = f"{panel.cells.quantity} [{panel.cells.unit}]"
        yield [x_title, y_title, quantity], panel.cells


def _axis_title(axis: Axis) -> str:
    return (f"{axis.quantity} [{axis.unit}]" if axis.unit else axis.quantity) or "place"


def _line_title(line: Line, axis: Axis) -> str:
    """Return the name of a line, with its label if that says more, and its unit."""
    name = line.name if line.label in line.name else f"{line.name}: {line.label}"
    return f"{name} [{axis.unit}]" if axis.unit else name or axis.quantity


def _rows(values: Values) -> Iterator[list[Any]]:
    """Yield rows of numbers with all their digits, and empty cells for NaN."""
    for row in zip(*(column.tolist() for column in _columns(values)), strict=True):
        yield ["" if math.isnan(value) else value for value in row]


def _columns(values: Values) -> tuple[FloatArray, ...]:
    """Return the columns; those of a map are its coordinates and values."""
    if isinstance(values, Cells):
        x, y = np.meshgrid(values.x, values.y)
        return x.ravel(), y.ravel(), values.values.ravel()
    return tuple(np.asarray(column, dtype=float) for column in values)


@dataclass(frozen=True)
class ReportFigure(Figure):
    """A figure of the report, the same data and the same drawing."""

    @property
    def svg(self) -> str:
        """The static drawing, one SVG element."""
        return svg(self)

    @property
    def csv(self) -> str:
        """Caption, limits and ranges as comments, then a table for each plot and coordinate, all digits kept."""
        return csv_of(self)

    @property
    def tables(self) -> tuple[dict[str, FloatArray], ...]:
        """The tables of the CSV: (points,) values by title with unit, NaN where there is none."""
        return tuple(_by_title(columns) for panel in self.plots for columns in tables_of(panel))

    def to_matplotlib(self, ax: Any = None) -> Any:
        """Draw its plots into axes of matplotlib, by default new ones; return the axes, one for each plot."""
        from torsion.output.figures.matplotlib_axes import draw_plots

        return draw_plots(self, ax)

    def _repr_svg_(self) -> str:
        """Return the drawing that a notebook shows."""
        return self.svg

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, str]:
        """Return the drawing, and the caption where text is shown in place of all numbers."""
        return {"text/plain": f"{self.name}: {self.caption}", "image/svg+xml": self.svg}


def figures(findings: Findings) -> dict[str, ReportFigure]:
    """Return the figures of the full report, by name, in their order.

    >>> import torsion
    >>> scene = "name: pair\\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]"
    >>> found = figures(torsion.run(torsion.parse(scene)))
    >>> list(found)
    ['utilisation', 'mode-1']
    >>> found["mode-1"].caption
    'Mode 1, 1.5915 Hz: angle and torque, referred to the reference speed and relative to their maximum'
    >>> [line.y.round(3).tolist() for line in found["mode-1"].plots[0].lines]  # angles of both discs
    [[1.0, -0.667]]
    >>> list(found["mode-1"].tables[0])
    ['place', 'angle / largest']
    >>> found["mode-1"].svg[:4]
    '<svg'
    """
    drawn = [block for block in chapters(findings, is_full=True) if isinstance(block, Figure)]
    return {figure.name: ReportFigure(**vars(figure)) for figure in drawn}


def _by_title(columns: list[tuple[str, FloatArray]]) -> dict[str, FloatArray]:
    """Return columns by their titles; equal titles get numbers."""
    by_title: dict[str, FloatArray] = {}
    for title, values in columns:
        count = sum(
            title == known_title or known_title.startswith(f"{title} (") for known_title in by_title
        )
        by_title[f"{title} ({count + 1})" if count else title] = values
    return by_title
