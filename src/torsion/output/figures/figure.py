"""A figure as data: axes, lines, limits, ranges, marks and words. Drawings and tables are made of it."""

from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np

from torsion.output.stored.stored_data import BY_NAME, StoredFlags, StoredFloats, StoredIntegers

Role = Literal[
    "synthesis",
    "limit",
    "second limit",
    "rated",
    "natural",
    "zero",
    "plain",
    "pale",
    "first",
    "forward",
    "backward",
    "nearly in a plane",
    "unstable",
    "best",
    "outside",
    "at rest",
]
Pen = (
    int | Role
)  # number of a line among its like, each with a colour and dashes of its own, or what it stands for
Symbol = Literal[
    "disc",
    "ring",
    "square",
    "box",
    "triangle",
    "down",
    "diamond",
    "cross",
    "plus",
    "star",
    "dot",
    "open triangle",
    "open diamond",
]
Place = tuple[float, float]
Grade = Literal["low", "middle", "high", "over", "no answer", "not judged"]


@dataclass(frozen=True)
class Axis:
    """A quantity with its unit. Where an end is None the data set it, rounded to the next number on the axis."""

    quantity: str
    unit: str = ""
    low: float | None = None
    high: float | None = None
    is_log: bool = False
    is_whole: bool = False  # whole numbers alone
    is_error: bool = (
        False  # relative: above 1e-4 in per cent, but in powers of ten where it goes beyond 100 %
    )
    places: tuple[tuple[float, str], ...] = ()  # names that stand in place of numbers
    is_reversed: bool = False

    @property
    def title(self) -> str:
        """The quantity with its unit, as a reader sees it."""
        return f"{self.quantity}, {self.unit}" if self.unit else self.quantity


@dataclass(frozen=True)
class Line:
    """Values over a coordinate; NaN breaks the line."""

    name: str  # in the key; '' where it belongs to another line
    x: StoredFloats  # (points,)
    y: StoredFloats  # (points,)
    pen: Pen = 0
    label: str = ""  # beside its largest value, its end, or where there is most room
    label_at: Literal["peak", "end", "anywhere"] = "peak"
    weight: float = 1.0  # times the usual width; the line that matters is heavier
    base: StoredFloats | None = None  # (points,) values down to which it is filled
    symbol: Symbol | None = None  # at every point


@dataclass(frozen=True)
class Level:
    """One value of an axis, drawn across the plot: a limit, a rated speed, a natural frequency."""

    name: str
    value: float
    pen: Pen = "limit"
    axis: Literal["x", "y"] = "y"
    label: str = ""
    is_reached: bool = False  # its axis goes as far as it


@dataclass(frozen=True)
class Band:
    """A range of an axis."""

    name: str
    low: float
    high: float
    kind: Literal["range", "barred", "unstable", "no answer", "doubt", "spread"]
    axis: Literal["x", "y"] = "x"
    label: str = ""


@dataclass(frozen=True)
class Marks:
    """Single points; `words` says of each what it is."""

    name: str
    x: StoredFloats  # (points,)
    y: StoredFloats  # (points,)
    symbol: Symbol = "disc"
    pen: Pen = "plain"
    words: tuple[str, ...] = ()
    labels: tuple[str, ...] = ()  # written beside them


@dataclass(frozen=True)
class Stops:
    """Points that the cursor of a page goes to, and their names; not drawn."""

    x: StoredFloats  # (points,)
    y: StoredFloats  # (points,)
    names: tuple[str, ...]


@dataclass(frozen=True)
class Cells:
    """Values on a grid, as colours: below zero pale, above it dark, with a line where they are zero; or logarithms."""

    x: StoredFloats  # (columns,)
    y: StoredFloats  # (rows,)
    values: StoredFloats  # (rows, columns), NaN where there is none
    quantity: str
    unit: str
    largest: float  # magnitude with the last colour
    decades: float = 0.0  # if any, colours are logarithms from so many below the largest on


@dataclass(frozen=True)
class Panel:
    """One plot; plots with the same x axis below each other share its numbers."""

    x: Axis
    y: Axis
    lines: tuple[Line, ...] = ()
    levels: tuple[Level, ...] = ()
    bands: tuple[Band, ...] = ()
    marks: tuple[Marks, ...] = ()
    cells: Cells | None = None
    stops: Stops | None = None
    height: float = 130.0  # px of 1/96 inch on a sheet as wide as the text of A4


@dataclass(frozen=True)
class Disc:
    """A point of the train in its sketch."""

    x: float
    row: float
    size: float  # 0..1 by the logarithm of the inertia
    label: str
    kind: str
    is_held: bool = False
    is_grounded: bool = False  # a spring to ground
    ring: float = 0.0  # size of a damper's ring
    role: str = ""  # of its symbol


@dataclass(frozen=True)
class Use:
    """How much of its limits something uses: the grade is its colour and pattern, the words say the same."""

    grade: Grade
    words: str
    rank: tuple[
        float, ...
    ] = ()  # where there is no room for all words, those of the highest are left out
    mark: str = ""  # sign of the worst limit that is exceeded, this one or another; "" for none


@dataclass(frozen=True)
class Link:
    """A link of the train in its sketch."""

    kind: str  # shaft, coupling, gear, joint, crank, rigid, tie (down to a branch)
    start: Place  # x, row
    end: Place
    label: str = ""
    bore: float = 0.0  # of a shaft: bore / diameter
    taper: Place = (1.0, 1.0)  # of a shaft: relative diameters at its ends
    ratio: float = 1.0  # of a gear: speed of the driven / speed of the driving wheel
    parts: tuple[int, ...] = ()  # positions of the components that it stands for
    use: Use | None = None


@dataclass(frozen=True)
class Sketch:
    """The train from its driving end, branches on lower rows, not to scale."""

    discs: tuple[Disc, ...]
    links: tuple[Link, ...]
    worst: tuple[Place, Use] | None = None  # x and row of what is pointed at
    height: float | None = None  # px from the lowest to the highest axis, at most


@dataclass(frozen=True)
class Share:
    """The share of a limit that is used."""

    name: str
    clause: str
    share: float  # infinite where no value is known
    use: Use


@dataclass(frozen=True)
class Shares:
    """Shares of limits below each other, with a line where the limit is."""

    rows: tuple[Share, ...]


@dataclass(frozen=True)
class Moving:
    """A mode that a page moves over the sketch of the train; not drawn."""

    x: StoredFloats  # (stations,) as in the sketch
    row: StoredFloats  # (stations,)
    angle: StoredFloats  # (stations,) relative to the largest
    ends: StoredIntegers  # (spans, 2) stations
    marked: StoredFlags  # (stations,) with a dot


@dataclass(frozen=True)
class Criticals:
    """Critical speeds of what a figure shows, on its axis or beyond: the cursor of a page names the nearest."""

    of: str  # critical speed, critical speed of bending of <shaft>
    x: StoredFloats  # (speeds,) rpm
    frequency: StoredFloats  # (speeds,) Hz
    mode: StoredIntegers  # (speeds,) counted from 1
    order: StoredIntegers  # (speeds,) its place among the orders
    orders: tuple[str, ...]  # as lines are named: one that is switched off has no critical speeds
    rated: float | None = None  # rpm


Picture = Panel | Sketch | Shares


@dataclass(frozen=True, eq=False)
class Figure:
    """Plots below each other under one caption."""

    name: str  # a stable identifier, the only one of its kind in a report
    caption: str
    panels: tuple[Annotated[Picture, BY_NAME], ...]
    moving: Moving | None = None
    criticals: Criticals | None = None

    @property
    def plots(self) -> tuple[Panel, ...]:
        """The panels that are plots with axes."""
        return tuple(panel for panel in self.panels if isinstance(panel, Panel))

    @property
    def lines(self) -> dict[str, Line]:
        """The lines of all plots by name; of several of one name the first."""
        by_name: dict[str, Line] = {}
        for panel in self.plots:
            for line in panel.lines:
                by_name.setdefault(line.name, line)
        return by_name


def runs(flags: np.ndarray) -> list[tuple[int, int]]:
    """Return first and last position of every run of true values.

    >>> runs(np.array([True, False, True, True]))
    [(0, 0), (2, 3)]
    """
    edges = np.diff(np.asarray(flags, dtype=np.int8), prepend=0, append=0)
    return list(
        zip(
            np.flatnonzero(edges == 1).tolist(),
            (np.flatnonzero(edges == -1) - 1).tolist(),
            strict=True,
        )
    )
