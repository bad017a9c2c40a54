"""Where every station of the train stands in the sketch and in the plots over the train."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.components.lowering import Part
from torsion.errors import Path

WIDTH = {"shaft": 1.6, "coupling": 1.0, "gear": 0.45, "joint": 0.8}  # of a link in the sketch
NOWHERE = (math.inf, -math.inf)  # from where to where a row without components is filled
RIGID = 0.5  # between two points that are rigidly joined
MOST_NAMES = 14  # components up to which a picture bears their names, not their numbers alone


@dataclass(frozen=True)
class Layout:
    """Places of the stations: along the train, and the row that a branch is drawn on (0 is the main line)."""

    x: FloatArray  # (stations,)
    row: FloatArray  # (stations,)


def label(parts: Sequence[Part], position: int) -> str:
    """What a picture calls a component: its number in the table of components, and its name where there is room."""
    return f"{position + 1} {parts[position].name}" if len(parts) <= MOST_NAMES else str(position + 1)


def layout(system: System) -> Layout:
    """Stations in the order of the train; a branch gets the nearest free row beside the point that carries it."""
    number = len(system.stations)
    x, row = np.full(number, np.nan), np.zeros(number)
    rows = _Rows()
    for index, part in enumerate(system.train.parts):
        if part.stations:
            line = rows.of(part.path, x, row, part.stations[0])
            _place(system, index, x, row, line)
            rows.fill(line, *(float(x[station]) for station in (part.stations[0], part.stations[-1])))
    _along_shafts(system, x, row)
    _hanging(system, x, row)
    return Layout(x, row)


class _Rows:
    """Which row each branch of the file stands on, and from where to where every row is filled."""

    def __init__(self) -> None:
        self._row: dict[Path, int] = {}
        self._filled: dict[int, tuple[float, float]] = {}

    def of(self, path: Path, x: FloatArray, row: FloatArray, first: int) -> int:
        """The row of the branch in which a component stands."""
        branch = path[:-2]
        if branch not in self._row:
            start = 0.0 if np.isnan(x[first]) else float(x[first])
            self._row[branch] = self._free(int(row[first]), start) if self._row else 0
        return self._row[branch]

    def _free(self, beside: int, start: float) -> int:
        """The nearest row that is empty from `start` on, with nothing in the way to it; below is tried first."""
        for distance in range(1, len(self._row) + 2):
            for side in (1, -1):
                row = beside + side * distance
                between = (self._filled.get(k, NOWHERE) for k in range(beside + side, row, side))
                is_open = all(not first - 0.5 <= start <= last + 0.5 for first, last in between)
                if is_open and self._filled.get(row, NOWHERE)[1] < start - 0.5:
                    return row
        return max(self._filled) + 1

    def fill(self, row: int, first: float, last: float) -> None:
        """Note from where to where a component fills a row."""
        before = self._filled.get(row, NOWHERE)
        self._filled[row] = min(before[0], first), max(before[1], last)


def _place(system: System, index: int, x: FloatArray, row: FloatArray, line: int) -> None:
    part = system.train.parts[index]
    first, last = part.stations[0], part.stations[-1]
    if np.isnan(x[first]):
        touching = np.flatnonzero((system.driving == first) | (system.driven == first))
        near = np.where(system.driven == first, system.driving, system.driven)[touching].tolist()
        known = [float(x[s]) for s in near if not np.isnan(x[s])]
        wheel = system.train.parts[system.stations[first].part].kind == "gear"
        x[first] = known[0] + (WIDTH["gear"] if wheel else RIGID) if known else 0.0
        row[first] = line
    if np.isnan(x[last]):
        x[last] = x[first] + WIDTH.get(part.kind, 1.0)
        row[last] = line


def _along_shafts(system: System, x: FloatArray, row: FloatArray) -> None:
    """Inner stations of a shaft, evenly between its ends; the end whose torque is reported there at the driven end."""
    for bar in system.train.bars:
        inner = np.flatnonzero((system.station_part == bar.part) & np.isnan(x))
        if system.bars is not None and bar.density > 0:
            end, inner = inner[-1], inner[:-1]
            x[end], row[end] = x[bar.driven], row[bar.driven]
        share = np.arange(1, len(inner) + 1) / (len(inner) + 1)
        x[inner] = x[bar.driving] + share * (x[bar.driven] - x[bar.driving])
        row[inner] = row[bar.driven]


def _hanging(system: System, x: FloatArray, row: FloatArray) -> None:
    """Rings, grounds and wheels without a train: beside the station that carries them."""
    for span in system.own_spans:
        for near, far in ((span.driving, span.driven), (span.driven, span.driving)):
            if np.isnan(x[far]) and not np.isnan(x[near]):
                x[far], row[far] = x[near], row[near] + 0.5
    x[np.isnan(x)] = 0.0
