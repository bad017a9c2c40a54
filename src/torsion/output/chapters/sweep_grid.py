"""Sections of a sweep over all combinations of values: a curve, a map or a table, and where checks fail."""

from collections.abc import Iterator, Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.blocks import Block, Column, Paragraph, head, table, texts
from torsion.output.figures import variants
from torsion.output.figures.figure import Role
from torsion.output.numbers import counted, number, unit_words
from torsion.what_if.sweep.sweep_results import Grid, Sweep, SweptCheck

MOST_LINES, MOST_CHECKS = 6, 60
MOST_ROWS, ENDS = 40, 10  # variants in the table: all, or those that use limits least and most
MOST_MODES = 3


def sections(found: Sweep) -> Iterator[Block]:
    """Checks, where they turn, the figures and the variants."""
    if found.nominal.size:
        yield _frequencies(found)
    if found.any_fails is not None:
        yield _checks(found, found.any_fails)
    grid = found.grid
    if grid is None:
        yield Paragraph(
            "The report does not list the variants, because there are too many.", "note"
        )
        return
    if grid.turns:
        yield _turns(found, grid)
    elif len(grid.axes) == 1 and found.any_fails is not None and grid.axes[0].is_numeric:
        every = "every" if found.any_fails.failing else "no"
        yield Paragraph(
            f"No check changes between pass and fail in this range: {every} variant fails."
        )
    if len(grid.axes) == 1:
        shown = [
            (f"{one.clause}: {one.where}", place)
            for place, one in enumerate(found.checks)
            if np.isfinite(one.utilisation).any()
        ]
        yield variants.curve(
            grid, sorted(shown, key=lambda one: -(found.checks[one[1]].worst or 0.0))[:MOST_LINES]
        )
    elif len(grid.axes) == 2:
        yield from variants.maps(grid)
    elif grid.utilisation.size:
        ranked = _ranked(grid)
        places = np.column_stack(np.unravel_index(np.arange(grid.fails.size), grid.shape)) / (
            np.array(grid.shape) - 1.0
        )
        groups: list[tuple[str, Role, FloatArray]] = [
            (f"{ENDS} variants with the highest utilisation", "unstable", places[ranked[-ENDS:]]),
            (f"{ENDS} variants with the lowest utilisation", "best", places[ranked[:ENDS]]),
        ]
        names = [axis.name for axis in grid.axes]
        yield variants.through(
            "sweep_best",
            "Variants with the lowest and highest utilisation",
            axes=names,
            groups=groups,
        )
    yield _variants(found, grid)


def _ranked(grid: Grid) -> list[int]:
    """The variants from the best to the worst; those without an answer stand last."""
    lost = np.zeros(grid.fails.size, dtype=np.bool_)
    lost[[place for place, _ in grid.why]] = True
    least = np.nan_to_num(grid.greatest, nan=0.0)
    return [int(place) for place in np.lexsort((least, grid.fails, lost))]


def _frequencies(found: Sweep) -> Block:
    rows = [
        (mode, *(number(value, 7) for value in row))
        for mode, row in enumerate(
            np.transpose([found.nominal, found.least, found.greatest]).tolist(), start=1
        )
    ]
    titles = "Mode -> | Nominal [Hz] -> Hz | Minimum [Hz] -> minimum | Maximum [Hz] -> maximum"
    return table(
        titles,
        rows,
        "Natural frequencies of all variants",
        short="Natural frequencies of the variants",
    )


def _checks(found: Sweep, whole: SweptCheck) -> Block:
    rows = [
        (
            "any check" if one is whole else f"{one.rule} {one.clause}: {one.what}",
            one.where,
            one.failing,
            None if one.best is None else number(100.0 * one.best, 4),
            None if one.worst is None else number(100.0 * one.worst, 4),
        )
        for one in (whole, *found.checks[:MOST_CHECKS])
    ]
    return table(
        "< Check -> | < Component -> | Variants that fail -> fail | Minimum utilisation [%] -> minimum, % | "
        "Maximum utilisation [%] -> maximum, %",
        rows,
        f"Checks over {counted(found.samples, 'variant')}",
        short="Checks over all variants",
    )


def _turns(found: Sweep, grid: Grid) -> Block:
    """In the unit of the figure."""
    unit = unit_words(grid.axes[0].unit)
    columns = [
        *head("< Check -> | < Component ->"),
        *(
            Column(title, unit, short=short)
            for title, short in (
                ("Passes at", "passes"),
                ("Fails at", "fails"),
                ("Limit at about", "limit at about"),
            )
        ),
    ]
    rows = [
        (
            f"{(check := found.checks[turn.check]).rule} {check.clause}: {check.what}",
            check.where,
            number(turn.kept, 6),
            number(turn.failing, 6),
            None if turn.between is None else number(turn.between, 5),
        )
        for turn in grid.turns
    ]
    caption = f"Changes between pass and fail over {grid.axes[0].name}"
    return table(tuple(columns), rows, caption, short="Changes between pass and fail")


def _variants(found: Sweep, grid: Grid) -> Block:
    """All variants in their order, or the best and the worst; one without an answer with its fault."""
    count = found.samples
    shown: Sequence[int] = range(count)
    if count > MOST_ROWS:
        ranked = _ranked(grid)
        shown = [*ranked[:ENDS], *ranked[-ENDS:]]
    why, modes = dict(grid.why), len(grid.frequency[:MOST_MODES])
    columns = [texts(axis.name, short=axis.name) for axis in grid.axes]
    columns += [
        Column(f"Mode {mode}", "Hz", short=f"mode {mode}, Hz") for mode in range(1, modes + 1)
    ]
    if found.checks:
        columns += head("Maximum utilisation [%] -> maximum, % | < Check | < Verdict -> verdict")
    elif why:
        columns += head("< Status -> status")
    rows, marks = [], []
    for place in shown:
        lost, check = why.get(place), int(grid.decisive[place])
        said = f"not solved: {lost}" if lost else "fails" if grid.fails[place] else "passes"
        cells = [
            *grid.words(place),
            *(number(value, 7) for value in grid.frequency[:modes, place].tolist()),
        ]
        if found.checks:
            of = f"{found.checks[check].clause}: {found.checks[check].where}" if check >= 0 else ""
            cells += [number(100.0 * float(grid.greatest[place]), 4), of, said]
        elif why:
            cells.append(f"not solved: {lost}" if lost else "")
        rows.append(cells)
        marks.append("fail" if grid.fails[place] else "")
    every = (
        "Variants"
        if count <= MOST_ROWS
        else f"The {ENDS} variants with the lowest and the {ENDS} with the highest utilisation"
    )
    return table(tuple(columns), rows, every, marks=marks, short="" if found.checks else every)
