"""The figures of a report for Python: frozen data that draws itself, with its numbers as arrays and as CSV."""

from dataclasses import dataclass
from typing import Any

from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.chapters import chapters
from torsion.output.drawing.svg import svg
from torsion.output.figure_csv import csv_of, tables_of
from torsion.output.figures.figure import Figure


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
