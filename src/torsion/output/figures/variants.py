"""Figures of variants: curves over one figure, maps over two, spreads, and lines through the values of many."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.arrays import BoolArray, FloatArray
from torsion.output.figures.contours import level_line
from torsion.output.figures.figure import (
    Axis,
    Band,
    Cells,
    Figure,
    Level,
    Line,
    Marks,
    Panel,
    Role,
    Symbol,
    runs,
)
from torsion.output.numbers import number, unit_words
from torsion.what_if.sweep.sweep_results import Grid, GridAxis

MOST_MODES = 3  # in one figure
MOST_BINS = 40
SAME = 1e-12  # relative: values that differ by less are one
FEWEST_LINES = 5  # values along an axis between which lines are drawn
CONTOURS = 8  # of a frequency
LIMIT = 100.0  # % of a limit
LEAST_RANGE = 200.0  # % beyond the limit up to which colours differ, at most
TALL = 250.0


def curve(grid: Grid, lines: Sequence[tuple[str, int]]) -> Figure:
    """Shares of limits and frequencies over the one figure of a grid; lines: name and place of the checks shown."""
    x, axis, levels = _scale(grid.axes[0])
    bands = _not_kept(x, grid.fails, is_numeric=not axis.places)
    symbol: Symbol | None = "dot" if axis.places or x.size <= MOST_BINS else None
    panels = []
    if lines:
        used = [
            Line(words, x, 100.0 * grid.utilisation[check], pen, symbol=symbol)
            for pen, (words, check) in enumerate(lines)
        ]
        limit = Level("limit", LIMIT, is_reached=True)
        panels.append(
            Panel(
                axis,
                Axis("utilisation", "%", low=0.0),
                tuple(used),
                (limit, *levels),
                bands,
                height=TALL,
            )
        )
    modes = tuple(
        Line(f"mode {mode}", x, frequency, mode - 1, f"mode {mode}", label_at="end", symbol=symbol)
        for mode, frequency in enumerate(grid.frequency[:MOST_MODES], start=1)
    )
    if modes:
        panels.append(Panel(axis, Axis("natural frequency", "Hz"), modes, levels, bands))
    return Figure(
        "sweep_curve", f"Limits and natural frequencies over {grid.axes[0].name}", tuple(panels)
    )


def maps(grid: Grid) -> Iterator[Figure]:
    """The greatest share of all limits, and every frequency, over the two figures of a grid."""
    (y, down, _), (x, across, _) = (_scale(axis) for axis in grid.axes)
    names = f"{grid.axes[0].name} and {grid.axes[1].name}"
    marks = tuple(_points(grid, x, y))
    used = 100.0 * grid.greatest.reshape(grid.shape) - LIMIT
    if np.isfinite(used).any():
        largest = min(max(float(np.nanmax(used[np.isfinite(used)])), LIMIT), LEAST_RANGE)
        cells = Cells(
            x,
            y,
            np.where(np.isinf(used), largest, used),
            "beyond the limit (below zero: met)",
            "%",
            largest,
        )
        yield Figure(
            "sweep_map",
            f"Maximum utilisation − 100 % over {names}",
            (Panel(across, down, cells=cells, marks=marks, height=1.3 * TALL),),
        )
    for mode, values in enumerate(grid.frequency[:MOST_MODES], start=1):
        finite, frequency = values[np.isfinite(values)], values.reshape(grid.shape)
        if not finite.size or np.ptp(finite) <= 1e-9 * finite.max():
            continue
        caption = f"Natural frequency of mode {mode} over {names}"
        if across.places or down.places or min(grid.shape) < FEWEST_LINES:
            largest = float(finite.max())
            decades = float(np.log10(largest / finite.min()))
            cells = Cells(x, y, frequency, "natural frequency", "Hz", largest, decades)
            panel = Panel(across, down, cells=cells, marks=marks, height=1.3 * TALL)
        else:
            panel = Panel(
                across, down, tuple(_contours(x, y, frequency)), marks=marks, height=1.3 * TALL
            )
        yield Figure(f"sweep_map_mode_{mode}", caption, (panel,))


def spread(
    name: str,
    caption: str,
    panels: Sequence[tuple[Axis, FloatArray, Sequence[Level], Sequence[Band]]],
) -> Figure:
    """How often values (variants,) lie where, a panel for each quantity; in % of the variants."""
    up = Axis("variants", "%", low=0.0)
    return Figure(
        name,
        caption,
        tuple(
            Panel(
                _reaching(axis, values, levels),
                up,
                (_histogram(values),),
                tuple(levels),
                tuple(bands),
                height=130.0,
            )
            for axis, values, levels, bands in panels
        ),
    )


def _reaching(axis: Axis, values: FloatArray, levels: Sequence[Level]) -> Axis:
    """As far as the values and the levels."""
    extent = np.append(values[np.isfinite(values)], [level.value for level in levels])
    room = 0.03 * float(np.ptp(extent)) or 1e-3 * abs(float(extent[0])) or 1.0
    return replace(axis, low=float(extent.min()) - room, high=float(extent.max()) + room)


def through(
    name: str, caption: str, *, axes: Sequence[str], groups: Sequence[tuple[str, Role, FloatArray]]
) -> Figure:
    """Parallel coordinates: of every variant a line through its values, 0..1 of their ranges.

    groups: name, pen and values (variants, axes); the last lies on top.
    """
    places = np.arange(float(len(axes)))
    lines = []
    for words, pen, values in groups:
        x = np.tile(np.append(places, np.nan), len(values))
        y = 100.0 * np.column_stack([values, np.full(len(values), np.nan)]).ravel()
        lines.append(Line(words, x, y, pen, weight=0.7 if pen == "pale" else 1.0))
    across = Axis(
        "figure",
        low=-0.8,
        high=len(axes) - 0.2,
        places=tuple(zip(places.tolist(), axes, strict=True)),
    )
    return Figure(
        name,
        caption,
        (Panel(across, Axis("place in its range", "%", -3.0, 103.0), tuple(lines), height=TALL),),
    )


def _scale(axis: GridAxis) -> tuple[FloatArray, Axis, tuple[Level, ...]]:
    """The places of its values, the axis, and the value of the file on it; names where values are no numbers."""
    if axis.is_numeric:
        levels = tuple(
            Level("the file", value, "rated", "x") for value in [axis.in_file] if value is not None
        )
        return (
            axis.number,
            Axis(axis.name, unit_words(axis.unit), float(axis.number[0]), float(axis.number[-1])),
            levels,
        )
    positions = np.arange(float(len(axis.words)))
    places = tuple(zip(positions.tolist(), axis.words, strict=True))
    matches = (
        np.flatnonzero(axis.number == axis.in_file).tolist() if axis.in_file is not None else []
    )
    levels = tuple(Level("the file", float(position), "rated", "x") for position in matches[:1])
    return positions, Axis(axis.name, low=-0.5, high=len(positions) - 0.5, places=places), levels


def _not_kept(x: FloatArray, fails: BoolArray, *, is_numeric: bool) -> tuple[Band, ...]:
    """Where a check fails, half way to the neighbours that pass."""
    edges = np.concatenate([[x[0]], (x[1:] + x[:-1]) / 2.0, [x[-1]]])
    if not is_numeric:
        edges[0], edges[-1] = x[0] - 0.5, x[-1] + 0.5
    return tuple(
        Band("a check fails", float(edges[a]), float(edges[b + 1]), "unstable")
        for a, b in runs(fails)
    )


def _points(grid: Grid, x: FloatArray, y: FloatArray) -> Iterator[Marks]:
    """The file among the variants, and variants that fail without a share of a limit that shows it."""
    coordinates = []
    for axis, positions in zip(grid.axes, (y, x), strict=True):
        coordinate = None if axis.in_file is None else axis.in_file
        if coordinate is not None and not axis.is_numeric:
            rows = np.flatnonzero(axis.number == coordinate)
            coordinate = float(positions[rows[0]]) if rows.size else None
        coordinates.append(coordinate)
    if None not in coordinates:
        yield Marks(
            "the file",
            np.array([coordinates[1]]),
            np.array([coordinates[0]]),
            "star",
            "rated",
            labels=("the file",),
        )
    else:
        yield Marks("", np.empty(0), np.empty(0))
    hidden = np.argwhere((grid.fails & ~(grid.greatest > 1.0)).reshape(grid.shape))
    if hidden.size:
        yield Marks(
            "no answer, or not wholly judged", x[hidden[:, 1]], y[hidden[:, 0]], "cross", "unstable"
        )


def _contours(x: FloatArray, y: FloatArray, values: FloatArray) -> Iterator[Line]:
    """Lines of round values of a frequency, each with its value."""
    finite = values[np.isfinite(values)]
    step = float(np.ptp(finite)) / (CONTOURS + 1)
    power = 10.0 ** np.floor(np.log10(step))
    step = power * next(factor for factor in (1.0, 2.0, 5.0, 10.0) if factor * power >= step)
    for level in np.arange(np.ceil(finite.min() / step), finite.max() / step) * step:
        pieces = list(level_line(x, y, values, float(level)))
        if pieces:
            along, up = (
                np.concatenate([np.append(piece[k], np.nan) for piece in pieces]) for k in (0, 1)
            )
            yield Line("", along, up, "plain", f"{number(float(level), 4)} Hz", label_at="anywhere")


def _histogram(values: FloatArray) -> Line:
    """Steps (bins,) in % of the variants."""
    finite = values[np.isfinite(values)]
    if (
        finite.size and np.ptp(finite) <= SAME * np.abs(finite).max()
    ):  # between values that differ by rounding lie no bins
        finite = np.full_like(finite, finite[0])
    bins = int(np.clip(np.sqrt(finite.size), 5, MOST_BINS))
    count, edges = np.histogram(finite, bins)
    x, y = (
        np.repeat(edges, 2),
        np.concatenate([[0.0], np.repeat(100.0 * count / max(values.size, 1), 2), [0.0]]),
    )
    return Line("", x, y, 0, base=np.zeros(x.size))
