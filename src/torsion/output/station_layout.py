"""Where every station of the train stands in the sketch and in the plots over the train."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Path
from torsion.model.parts import Part
from torsion.output.stored.scene import by_part
from torsion.primitives import STEP

RIGID = 0.5  # between two points that are rigidly joined
CLEAR = 0.5  # between the end of a branch and one that begins behind it
MOST_NAMES = 14  # components up to which a picture bears their names, not their numbers alone


@dataclass(frozen=True)
class Layout:
    """Places of the stations: along the train, and the row that a branch is drawn on (0 is the main line)."""

    x: FloatArray  # (stations,)
    row: FloatArray  # (stations,)


def label(parts: Sequence[Part], position: int) -> str:
    """Return what a picture calls a component: its number in the table of components, and its name if there is room.

    A shaft of sections is named once, at the one in its middle.
    """
    name, number = parts[position].whole, str(position + 1)
    if name != parts[position].name:
        sections = [position for position, part in enumerate(parts) if part.whole == name]
        if position != sections[len(sections) // 2]:
            return ""
        number = f"{sections[0] + 1}–{sections[-1] + 1}" if len(sections) > 1 else number
    return f"{number} {name}" if len(parts) <= MOST_NAMES else number


def layout(system: System, lengths: Mapping[int, float] | None = None) -> Layout:
    """Place stations in the order of the train; a branch gets a free row beside the point that carries it.

    lengths: of parts, in place of those in the sketch.
    """
    number, train = len(system.stations), system.train
    x, row = np.full(number, np.nan), np.zeros(number)
    rows, of_path = _Rows(), dict[Path, int]()
    widths = dict[int, float]()
    for bars in train.sectioned.values():  # to scale, on the average half a shaft
        scale = train.parts[bars[0].part].symbol.width / 2.0 * len(bars)
        scale /= sum(bar.length for bar in bars)
        widths |= {bar.part: scale * bar.length for bar in bars}
    widths |= lengths or {}
    for number, part in enumerate(train.parts):
        if part.stations and part.kind != "planets":  # they stand beside their gear
            first, last = part.stations[0], part.stations[-1]
            is_new = np.isnan(x[first])
            if is_new:
                x[first], row[first] = _behind(system, first, x, row, of_path.get(part.path))
            line = rows.of(part.line, float(x[first]), int(row[first]))
            if is_new:
                row[first] = line
            if np.isnan(x[last]):
                x[last], row[last] = x[first] + widths.get(number, part.symbol.width), line
            rows.end[line] = max(rows.end.get(line, -math.inf), float(x[last]))
            of_path.setdefault(part.path, last)
    # Inner stations of a shaft stand evenly between its ends; the end whose torque is reported at the driven end.
    missing_stations = np.flatnonzero(np.isnan(x))
    inside = by_part(system.station_part[missing_stations])
    for bar in train.bars:
        inner = missing_stations[inside.get(bar.part, np.zeros(0, dtype=np.int64))]
        if system.bars is not None and bar.density > 0:
            end, inner = inner[-1], inner[:-1]
            x[end], row[end] = x[bar.driven], row[bar.driven]
        share = np.arange(1, len(inner) + 1) / (len(inner) + 1)
        x[inner] = x[bar.driving] + share * (x[bar.driven] - x[bar.driving])
        row[inner] = row[bar.driven]

    # Rings, grounds, planets and wheels without a train stand beside the station that they are joined to.
    missing = -1
    while missing != (missing := int(np.isnan(x).sum())):
        for span in system.own_spans:
            for near, far in ((span.driving, span.driven), (span.driven, span.driving)):
                if np.isnan(x[far]) and not np.isnan(x[near]):
                    x[far], row[far] = x[near], math.floor(row[near]) + 0.5
    return Layout(x, row)


@dataclass(frozen=True)
class _Rows:
    """Which row each branch of the file stands on, and how far every row is filled."""

    _row: dict[Path, int] = field(default_factory=dict)
    end: dict[int, float] = field(default_factory=dict)

    def of(self, branch: Path, start: float, beside: int) -> int:
        """Return the row of a branch, which begins at `start` beside a row.

        It is the next one below or above that no branch goes on in and that is empty from there on, or else a new one.
        """
        if not self._row:
            self._row[branch] = 0
        elif branch not in self._row:
            going_on = [row for other, row in self._row.items() if branch[: len(other)] == other]
            near = [row for row in (beside + 1, beside - 1) if row not in going_on]
            free = [row for row in near if self.end.get(row, -math.inf) < start - CLEAR]
            self._row[branch] = free[0] if free else max(self.end) + 1
        return self._row[branch]


def _behind(
    system: System, station: int, x: FloatArray, row: FloatArray, piece: int | None
) -> tuple[float, float]:
    """Place and row of a new station as seen from one that it is joined to and that stands; the first is at 0.

    piece: a station of the same component of the file, beside which it stands where it is joined to none.
    """
    ends = np.column_stack([system.driving, system.driven])
    near = ends[(ends == station).any(axis=1)]
    standing = near[~np.isnan(x[near])].tolist()
    if not standing and piece is not None:
        return float(x[piece]) + RIGID, float(row[piece])
    if not standing:
        return 0.0, float(row[station])
    part = system.train.parts[system.stations[station].part]
    is_step = any(
        spring.driven == station and spring.name.endswith(STEP) for spring in system.train.springs
    )
    gap = part.symbol.width if part.kind == "gear" else 0.0 if is_step else RIGID
    return float(x[standing[0]]) + gap, float(row[standing[0]])
