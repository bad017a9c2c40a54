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
from torsion.output.figures.figure import Cells, Figure, Line, Panel
from torsion.output.table_text import csv_rows, inert, one_line, write_beside

Values = tuple[FloatArray, ...] | Cells  # columns of numbers, or a map
Piece = str | Values  # a text stays unchanged


def csv_of(figure: Figure) -> str:
    """Return comments with the caption, limits and ranges, then tables separated by an empty line.

    A cell without a value is empty; a figure without axes has no table.
    """
    text = ""
    for piece in pieces(figure):
        if isinstance(piece, str):
            text += piece
        else:
            rows = zip(*(column.tolist() for column in _columns(piece)), strict=True)
            text += csv_rows(["" if math.isnan(value) else value for value in row] for row in rows)
    return text


def pieces(figure: Figure) -> Iterator[Piece]:
    """Yield the parts of the file in their order: what is no table, limits and ranges, as comments."""
    yield f"# {inert(one_line(figure.caption))}\n"
    for panel in figure.plots:
        units = {"x": panel.x.unit, "y": panel.y.unit}
        comments = [f"{panel.y.title} over {panel.x.title}"]
        comments += [
            f"{level.name or level.label}: {level.value!r} {units[level.axis]}"
            for level in panel.levels
            if level.name or level.label
        ]
        comments += [
            f"{band.label or band.name}: {band.low!r} to {band.high!r} {units[band.axis]}"
            for band in panel.bands
        ]
        yield from (f"# {inert(one_line(comment))}\n" for comment in comments)
        for titles, values in _tables(panel):
            yield "\n" + csv_rows([titles])
            yield values


def tables(document: Document) -> Callable[[Path], list[Path]] | None:
    """Return a writer of one file for every figure with axes, next to its argument; None if no figure has axes."""
    blocks = (item.block for item in document.body)
    figures = [block for block in blocks if isinstance(block, Figure) and block.plots]
    texts = {file_name(figure): partial(csv_of, figure) for figure in figures}
    return partial(write_beside, texts) if texts else None


def file_name(figure: Figure) -> str:
    """Return the name of the CSV file of a figure."""
    return "figure-" + re.sub(r"[^\w.-]+", "-", figure.name) + ".csv"


def _tables(panel: Panel) -> Iterator[tuple[list[str], Values]]:
    """Yield titles and values: lines by their coordinate, marks, and the cells of a map."""
    x_title, y_title = (
        (f"{axis.quantity} [{axis.unit}]" if axis.unit else axis.quantity) or "place"
        for axis in (panel.x, panel.y)
    )
    groups = dict[bytes, list[Line]]()  # by their coordinate
    for line in panel.lines:
        if line.name or panel.x.places:
            groups.setdefault((line.x + 0.0).tobytes(), []).append(line)

    for group in groups.values():
        titles = []
        for line in group:  # its name, with its label if that says more, and its unit
            name = line.name if line.label in line.name else f"{line.name}: {line.label}"
            unit = f" [{panel.y.unit}]" if panel.y.unit else ""
            titles.append(name + unit or panel.y.quantity)
        yield [x_title, *titles], (group[0].x, *(line.y for line in group))
    for marks in panel.marks:
        if marks.name and marks.x.size:
            yield [x_title, f"{marks.name}: {y_title}"], (marks.x, marks.y)
    if panel.cells is not None:
        quantity = f"{panel.cells.quantity} [{panel.cells.unit}]"
        yield [x_title, y_title, quantity], panel.cells


def _columns(values: Values) -> tuple[FloatArray, ...]:
    """Return the columns; those of a map are its coordinates and values."""
    if isinstance(values, Cells):
        x, y = np.meshgrid(values.x, values.y)
        return x.ravel(), y.ravel(), values.values.ravel()
    return tuple(np.asarray(column, dtype=float) for column in values)


@dataclass(frozen=True, eq=False)
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
        """The tables of the CSV: (points,) values by title with unit, NaN where there is none.

        Equal titles get numbers.
        """
        tables = list[dict[str, FloatArray]]()
        for titles, values in (table for panel in self.plots for table in _tables(panel)):
            by_title: dict[str, FloatArray] = {}
            for title, column in zip(titles, _columns(values), strict=True):
                count = sum(title == name or name.startswith(f"{title} (") for name in by_title)
                by_title[f"{title} ({count + 1})" if count else title] = column
            tables.append(by_title)
        return tuple(tables)

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
