"""What the script of a page needs beside its drawings: plots with their axes, numbers, tables as CSV."""

import json
import zlib
from base64 import b64encode
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.output.drawing.curves import decimated
from torsion.output.drawing.frame import Frame, Scale
from torsion.output.drawing.words import plain
from torsion.output.figures.figure import Axis, Cells, Criticals, Figure, Line, Panel, Stops
from torsion.output.report_figures import Piece, file_name, pieces

MOST_POINTS = 1200  # of a line; of a longer one first, least, greatest and last of equal bins
LEAST_BINS = 75  # of such lines over one coordinate
MOST_CELLS = 20_000  # of a map whose numbers are in the page
THINNED = "# long lines: first, minimum, maximum and last value of equal ranges; --csv writes all\n"
TOO_LONG = f"more than {MOST_POINTS:,} stations or elements"
LEFT_OUT = "# a map of more numbers than a page should hold is omitted; --csv writes all\n"


class Page:
    """The numbers of all figures of a page, each list once and in full, and the names of their points."""

    def __init__(self) -> None:
        self._arrays: dict[bytes, int] = {}
        self._names: dict[tuple[str, ...], int] = {}

    def figure(self, figure: Figure, frames: Sequence[Frame]) -> str:
        """Return JSON of the plots of a figure that a cursor reads, of its tables, and of the mode that it moves."""
        light = _light(figure)
        data: dict[str, Any] = {
            "plots": [
                self._plot(frame, panel) for frame, panel in zip(frames, light.plots, strict=True)
            ]
        }
        if light.plots:
            data["file"], data["csv"] = (
                file_name(figure),
                [self._piece(piece) for piece in _pieces(figure, light)],
            )
        if figure.criticals is not None:
            data["criticals"] = self._criticals(figure.criticals)
        if lacks := _lacking(light):
            data["said"] = f"{' and '.join(lacks)} here: {TOO_LONG}"
        if (moving := figure.moving) is not None and moving.x.size <= MOST_POINTS:
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

    def _criticals(self, criticals: Criticals) -> dict[str, Any]:
        return {
            "of": criticals.of,
            "rated": criticals.rated,
            "orders": self._listed(criticals.orders),
            **self._arrays_of(criticals, "x", "frequency", "mode", "order"),
        }

    def _listed(self, names: tuple[str, ...]) -> int:
        return self._names.setdefault(names, len(self._names))

    def _plot(self, frame: Frame, panel: Panel) -> dict[str, Any]:
        box = [round(edge, 2) for edge in (frame.left, frame.top, frame.wide, frame.high)]
        plot: dict[str, Any] = {
            "box": box,
            "x": _axis(panel.x, frame.x),
            "y": _axis(panel.y, frame.y),
        }
        plot["lines"] = [
            {"name": plain(line.name), **self._arrays_of(line, "x", "y")}
            for line in panel.lines
            if _is_read(line) and not panel.x.places
        ]
        plot["marks"] = [
            {
                "name": plain(marks.name),
                "x": self.array(marks.x),
                "words": [plain(words) for words in marks.words],
            }
            for marks in panel.marks
            if marks.words
        ]
        if (stops := panel.stops) is not None and _is_short(stops):
            plot["stops"] = {
                **self._arrays_of(stops, "x", "y"),
                "names": self._listed(stops.names),
            }
        if not panel.lines and panel.cells is None and not panel.x.places:
            ranges = [
                (plain(band.label or band.name), band.low, band.high)
                for band in panel.bands
                if band.axis == "x"
            ]
            plot.update({"ranges": ranges} if ranges else {})
        return plot

    def _piece(self, piece: Piece) -> Any:
        match piece:
            case str():
                return piece
            case Cells():
                return {
                    **self._arrays_of(piece, "x", "y"),
                    "cells": self.array(piece.values),
                }
        return [self.array(column) for column in piece]


def _pieces(figure: Figure, light: Figure) -> list[Piece]:
    """Return the table of a figure as CSV, of the lighter one where the whole is too large for a page."""
    made = list(pieces(light))
    notes = (
        [THINNED]
        if any(line.x.size > MOST_POINTS for panel in figure.plots for line in panel.lines)
        else []
    )
    large = [piece for piece in made if isinstance(piece, Cells) and piece.values.size > MOST_CELLS]
    notes += [LEFT_OUT] if large else []
    return [*notes, *(piece for piece in made if not any(piece is dropped for dropped in large))]


def _is_short(stops: Stops) -> bool:
    return len(stops.names) <= MOST_POINTS


def _lacking(figure: Figure) -> list[str]:
    """Return what the page does not do with a figure, as it has too many points."""
    lacks = (
        ["no cursor"]
        if any(panel.stops and not _is_short(panel.stops) for panel in figure.plots)
        else []
    )
    return [*lacks, "no motion"] if figure.moving and figure.moving.x.size > MOST_POINTS else lacks


def _light(figure: Figure) -> Figure:
    """Return a figure with the points of long lines that can be seen; lines over one coordinate keep the same ones."""
    lines = [line for panel in figure.plots for line in panel.lines]
    return replace(
        figure,
        panels=tuple(
            replace(panel, lines=tuple(_thinned(line, lines) for line in panel.lines))
            if isinstance(panel, Panel)
            else panel
            for panel in figure.panels
        ),
    )


def _thinned(line: Line, lines: Sequence[Line]) -> Line:
    if line.x.size <= MOST_POINTS:
        return line
    like = [
        other_line
        for other_line in lines
        if other_line.x is line.x or np.array_equal(other_line.x, line.x, equal_nan=True)
    ]
    bins = max(LEAST_BINS, MOST_POINTS // 4 // len(like))
    kept = np.unique(
        np.concatenate(
            [decimated(np.nan_to_num(alike.x), np.nan_to_num(alike.y), bins) for alike in like]
        )
    )
    return replace(
        line, x=line.x[kept], y=line.y[kept], base=None if line.base is None else line.base[kept]
    )


def _is_read(line: Line) -> bool:
    """Whether a cursor reads the line: it has a name, goes on in its coordinate and has values."""
    x = line.x[np.isfinite(line.x)]
    return (
        bool(line.name)
        and x.size > 1
        and bool(np.all(np.diff(x) >= 0))
        and bool(np.isfinite(line.y).any())
    )


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
