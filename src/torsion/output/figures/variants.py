"""Figures of variants: curves over one parameter, maps over two, histograms, and what passes and what fails."""

from collections.abc import Iterator, Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.figures.figure import (
    Axis,
    Band,
    Cells,
    Figure,
    Level,
    Line,
    Marks,
    Panel,
    Symbol,
    runs,
)
from torsion.output.numbers import unit_words
from torsion.what_if.sweep.sweep_results import Grid, GridAxis, Sweep, SweptCheck

MOST_MODES, MOST_CHECKS = 3, 6  # in one figure
MOST_BINS = 40
SAME = 1e-12  # relative: values that differ by less are one
LEAST_RANGE = 200.0  # % beyond the limit up to which colours differ, at most
UTILISATION = Axis("utilisation", "%", low=0.0)


def curve(grid: Grid, checks: Sequence[SweptCheck]) -> Figure:
    """Draw utilisations and frequencies over the one parameter of a grid, and where a check fails."""
    x, axis, nominal = _coordinate(grid.axes[0])
    levels = () if nominal is None else (Level("the file", nominal, "rated", "x"),)
    ends = (axis.low, axis.high) if axis.places else (x[0], x[-1])
    edges = np.array([ends[0], *(x[1:] + x[:-1]) / 2.0, ends[1]], dtype=float)
    bands = tuple(
        Band("a check fails", float(edges[first]), float(edges[last + 1]), "unstable")
        for first, last in runs(grid.fails)
    )
    symbol: Symbol | None = "dot" if axis.places or x.size <= MOST_BINS else None
    known = [check for check in checks if np.isfinite(check.utilisation).any()]
    most_used = sorted(known, key=lambda check: -(check.worst or 0.0))[:MOST_CHECKS]
    used = tuple(
        Line(f"{check.clause}: {check.where}", x, 100.0 * check.utilisation, pen, symbol=symbol)
        for pen, check in enumerate(most_used)
    )
    modes = tuple(
        Line(f"mode {mode}", x, hertz, mode - 1, f"mode {mode}", label_at="end", symbol=symbol)
        for mode, hertz in enumerate(grid.frequency[:MOST_MODES], start=1)
    )
    limit = Level("limit", 100.0, is_reached=True)
    panels = [Panel(axis, UTILISATION, used, (limit, *levels), bands, height=250.0)] if used else []
    if modes:
        panels.append(Panel(axis, Axis("natural frequency", "Hz"), modes, levels, bands))
    caption = f"Limits and natural frequencies over {grid.axes[0].name}"
    return Figure("sweep_curve", caption, tuple(panels))


def maps(grid: Grid) -> Iterator[Figure]:
    """Draw the maximum utilisation, and every frequency, over the two parameters of a grid."""
    (y, down, nominal_y), (x, across, nominal_x) = map(_coordinate, grid.axes)
    names = f"{grid.axes[0].name} and {grid.axes[1].name}"
    marks = []
    if nominal_x is not None and nominal_y is not None:
        place = np.array([nominal_x]), np.array([nominal_y])
        marks.append(Marks("the file", *place, "star", "rated", labels=("the file",)))
    rows, columns = np.nonzero((grid.fails & ~(grid.greatest > 1.0)).reshape(grid.shape))
    if rows.size:
        words = "no answer, or not wholly judged"
        marks.append(Marks(words, x[columns], y[rows], "cross", "unstable"))

    def drawn(name: str, caption: str, cells: Cells) -> Figure:
        panel = Panel(across, down, cells=cells, marks=tuple(marks), height=325.0)
        return Figure(name, f"{caption} over {names}", (panel,))

    used = 100.0 * grid.greatest.reshape(grid.shape) - 100.0
    if np.isfinite(used).any():
        largest = float(np.clip(used[np.isfinite(used)].max(), 100.0, LEAST_RANGE))
        title = "beyond the limit (below zero: met)"
        cells = Cells(x, y, np.minimum(used, largest), title, "%", largest)
        yield drawn("sweep_map", "Maximum utilisation − 100 %", cells)
    for mode, values in enumerate(grid.frequency[:MOST_MODES], start=1):
        finite = values[np.isfinite(values)]
        if finite.size and np.ptp(finite) > 1e-9 * finite.max():
            largest, decades = float(finite.max()), float(np.log10(finite.max() / finite.min()))
            hertz, title = values.reshape(grid.shape), "natural frequency"
            cells = Cells(x, y, hertz, title, "Hz", largest, decades)
            yield drawn(f"sweep_map_mode_{mode}", f"Natural frequency of mode {mode}", cells)


def _coordinate(axis: GridAxis) -> tuple[FloatArray, Axis, float | None]:
    """Return the places of its values, the axis, and the place of the file's; names where values are no numbers."""
    if axis.is_numeric:
        ends = float(axis.number[0]), float(axis.number[-1])
        return axis.number, Axis(axis.name, unit_words(axis.unit), *ends), axis.in_file
    positions = np.arange(float(len(axis.words)))
    places = tuple(zip(positions.tolist(), axis.words, strict=True))
    nominal = [] if axis.in_file is None else positions[axis.number == axis.in_file].tolist()
    ends = -0.5, len(positions) - 0.5
    return positions, Axis(axis.name, "", *ends, places=places), nominal[0] if nominal else None


def frequencies(sweep: Sweep, bounds: Sequence[tuple[float, float]]) -> Figure:
    """Draw histograms of the lowest modes; bounds: Hz, those that are guaranteed of every mode, if they are known."""
    panels = []
    for mode, values in enumerate(sweep.frequency[:MOST_MODES]):
        levels = [Level("nominal", float(sweep.nominal[mode]), "rated", "x")]
        levels += [
            Level("guaranteed bound of the tolerances", end, "limit", "x")
            for end in (bounds[mode] if mode < len(bounds) else ())
        ]
        spread = float(sweep.low[mode]), float(sweep.high[mode])
        extent = np.append(values[np.isfinite(values)], [level.value for level in levels])
        room = 0.03 * float(np.ptp(extent)) or 1e-3 * abs(float(extent[0])) or 1.0
        ends = float(extent.min()) - room, float(extent.max()) + room
        axes = Axis(f"frequency of mode {mode + 1}", "Hz", *ends), Axis("variants", "%", low=0.0)
        band = Band("95 % of the variants", *spread, "spread")
        panels.append(Panel(*axes, (histogram(values),), tuple(levels), (band,)))
    return Figure("sweep_frequencies", "Natural frequencies of all variants", tuple(panels))


def histogram(values: FloatArray) -> Line:
    """Return steps (bins,) in % of the variants."""
    finite = values[np.isfinite(values)]
    # Between values that differ by rounding lie no bins.
    if finite.size and np.ptp(finite) <= SAME * np.abs(finite).max():
        finite = np.full_like(finite, finite[0])
    count, edges = np.histogram(finite, int(np.clip(np.sqrt(finite.size), 5, MOST_BINS)))
    share = np.pad(np.repeat(100.0 * count / max(values.size, 1), 2), 1)
    return Line("", np.repeat(edges, 2), share, base=np.zeros(2 * edges.size))


def shares(sweep: Sweep) -> Figure:
    """Draw which share of the variants stays below a utilisation, of the checks nearest to failing."""
    lines = []
    known = (check for check in sweep.checks if np.isfinite(check.utilisation).any())
    for pen, check in zip(range(MOST_CHECKS), known, strict=False):
        used = 100.0 * np.sort(np.where(np.isfinite(check.utilisation), check.utilisation, np.nan))
        below = np.arange(1, used.size + 1) / used.size * 100.0
        lines.append(Line(f"{check.clause}: {check.where}", used, below, pen))
    limit = Level("limit", 100.0, axis="x", is_reached=True)
    up = Axis("variants below", "%", low=0.0, high=100.0)
    panel = Panel(UTILISATION, up, tuple(lines), (limit,), height=240.0)
    caption = "Variants below a utilisation, for the checks with the highest utilisation"
    return Figure("sweep_shares", caption, (panel,))


def failing(sweep: Sweep, fails: np.ndarray, pair: Sequence[int]) -> Figure:
    """Draw the variants that pass and those that fail over two of the parameters."""
    values, axes = [], []
    for parameter in pair:
        figure, factor = sweep.figures[parameter], sweep.factor[:, parameter]
        if figure.unit is None:
            values.append(100.0 * factor)
            axes.append(Axis(f"{figure.name} / nominal", "%"))
        else:
            values.append(factor)
            axes.append(Axis(figure.name, unit_words(figure.unit)))
    x, y = values
    marks = (
        Marks("every check passes", x[~fails], y[~fails], "dot", "pale"),
        Marks("a check fails", x[fails], y[fails], "cross", "unstable"),
    )
    names = " and ".join(sweep.figures[parameter].name for parameter in pair)
    return Figure("sweep_variants", f"Variants by {names}", (Panel(axes[0], axes[1], marks=marks),))
