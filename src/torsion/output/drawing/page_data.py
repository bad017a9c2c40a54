"""What the script of a page needs beside its drawings: plots with their axes, numbers, tables as CSV."""

import json
import zlib
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.output.drawing.curves import decimated
from torsion.output.drawing.frame import Frame, Scale
from torsion.output.drawing.words import plain
from torsion.output.figures.figure import Axis, Cells, Figure, Line, Panel
from torsion.output.report_figures import file_name, pieces

MOST_POINTS = 1200  # of a line; of a longer one first, least, greatest and last of equal bins
LEAST_BINS = 75  # of such lines over one coordinate
MOST_CELLS = 20_000  # of a map whose numbers are in the page
THINNED = "# long lines: first, minimum, maximum and last value of equal ranges; --csv writes all\n"
TOO_LONG = f"more than {MOST_POINTS:,} stations or elements"
LEFT_OUT = "# a map of more numbers than a page should hold is omitted; --csv writes all\n"


@dataclass(frozen=True)
class Page:
    """The numbers of all figures of a page, each list once and in full, and the names of their points."""

    _arrays: dict[bytes, int] = field(default_factory=dict)
    _names: dict[tuple[str, ...], int] = field(default_factory=dict)

    def figure(self, figure: Figure, frames: Sequence[Frame]) -> str:
        """Return JSON of the plots of a figure that a cursor reads, of its tables, and of the mode that it moves."""
        # Long lines keep the points that can be seen; lines over one coordinate keep the same ones.
        lines = [line for panel in figure.plots for line in panel.lines]
        plots = [
            replace(panel, lines=tuple(_thinned(line, lines) for line in panel.lines))
            for panel in figure.plots
        ]
        data: dict[str, Any] = {"plots": list(map(self._plot, frames, plots))}
        if plots:
            # The table as CSV, of the lighter figure where the whole is too large for a page.
            notes = [THINNED] if any(line.x.size > MOST_POINTS for line in lines) else []
            table = list[Any]()
            for piece in pieces(replace(figure, panels=tuple(plots))):
                if isinstance(piece, str):
                    table.append(piece)
                elif not isinstance(piece, Cells):
                    table.append([self.array(column) for column in piece])
                elif piece.values.size <= MOST_CELLS:
                    places = self._arrays_of(piece, "x", "y")
                    table.append({**places, "cells": self.array(piece.values)})
                elif LEFT_OUT not in notes:
                    notes.append(LEFT_OUT)
            data["file"], data["csv"] = file_name(figure), [*notes, *table]
        if (criticals := figure.criticals) is not None:
            data["criticals"] = {
                "of": criticals.of,
                "rated": criticals.rated,
                "orders": self._names.setdefault(criticals.orders, len(self._names)),
                **self._arrays_of(criticals, "x", "frequency", "mode", "order"),
            }
        lacks = []  # what the page does not do with so many points
        if any(panel.stops and len(panel.stops.names) > MOST_POINTS for panel in plots):
            lacks.append("no cursor")
        moving = figure.moving
        if moving is not None and moving.x.size > MOST_POINTS:
            lacks.append("no motion")
            moving = None
        if lacks:
            data["said"] = f"{' and '.join(lacks)} here: {TOO_LONG}"
        if moving is not None:
            data["moving"] = {
                **self._arrays_of(moving, "x", "row", "angle", "ends"),
                "marked": self.array(np.flatnonzero(moving.marked)),
            }
        return packed(data)

    def numbers(self, level: int = 9) -> str:
        """Return JSON of the lengths of all arrays, of their numbers one after another, and of all lists of names.

        The numbers are little-endian doubles; the first bytes of all come first, then the second and so on, which
        shortens them most (zlib, at that level), in base64.
        """
        doubles_text = b"".join(self._arrays)
        by_place = np.frombuffer(doubles_text, dtype=np.uint8).reshape(-1, 8).T.tobytes()
        lengths = [len(values) // 8 for values in self._arrays]
        doubles = b64encode(zlib.compress(by_place, level)).decode()
        return packed({"lengths": lengths, "names": list(self._names), "doubles": doubles})

    def array(self, values: FloatArray | IntArray) -> int:
        """Return the place of an array among those of the page."""
        return self._arrays.setdefault(np.asarray(values, dtype="<f8").tobytes(), len(self._arrays))

    def _arrays_of(self, record: Any, *names: str) -> dict[str, int]:
        """Return the places of the arrays of a record by their names."""
        return {name: self.array(getattr(record, name)) for name in names}

    def _plot(self, frame: Frame, panel: Panel) -> dict[str, Any]:
        box = [round(edge, 2) for edge in (frame.left, frame.top, frame.wide, frame.high)]
        plot: dict[str, Any] = {
            "box": box,
            "x": _axis(panel.x, frame.x),
            "y": _axis(panel.y, frame.y),
        }
        plot["lines"] = []
        for line in () if panel.x.places else panel.lines:
            # A cursor reads a line that has a name, goes on in its coordinate and has values.
            x = line.x[np.isfinite(line.x)]
            goes_on = x.size > 1 and np.all(np.diff(x) >= 0)
            if line.name and goes_on and np.isfinite(line.y).any():
                arrays = self._arrays_of(line, "x", "y")
                plot["lines"].append({"name": plain(line.name), **arrays})
        plot["marks"] = [
            {
                "name": plain(marks.name),
                "x": self.array(marks.x),
                "words": [plain(words) for words in marks.words],
            }
            for marks in panel.marks
            if marks.words
        ]
        if (stops := panel.stops) is not None and len(stops.names) <= MOST_POINTS:
            plot["stops"] = {
                **self._arrays_of(stops, "x", "y"),
                "names": self._names.setdefault(stops.names, len(self._names)),
            }
        if not panel.lines and panel.cells is None and not panel.x.places:
            ranges = [
                (plain(band.label or band.name), band.low, band.high)
                for band in panel.bands
                if band.axis == "x"
            ]
            plot.update({"ranges": ranges} if ranges else {})
        return plot


def _thinned(line: Line, lines: Sequence[Line]) -> Line:
    if line.x.size <= MOST_POINTS:
        return line
    like = [other for other in lines if np.array_equal(other.x, line.x, equal_nan=True)]
    bins = max(LEAST_BINS, MOST_POINTS // 4 // len(like))
    chosen = [decimated(np.nan_to_num(alike.x), np.nan_to_num(alike.y), bins) for alike in like]
    kept = np.unique(np.concatenate(chosen))
    base = None if line.base is None else line.base[kept]
    return replace(line, x=line.x[kept], y=line.y[kept], base=base)


def _axis(axis: Axis, scale: Scale) -> dict[str, Any]:
    return {
        "title": axis.title,
        "unit": axis.unit,
        "ends": [scale.low, scale.high],
        "log": scale.is_log,
        "reversed": scale.is_reversed,
        "places": bool(axis.places),
    }


def packed(value: Any) -> str:
    """Return JSON that may stand in a page: no sign in it can end its element."""
    return json.dumps(value, ensure_ascii=False, separators=(",", ":")).replace("<", "\\u003c")
