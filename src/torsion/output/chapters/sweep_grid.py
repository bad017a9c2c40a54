"""Sections of a sweep over all combinations of values: a curve, a map or a table, and where checks fail."""

from collections.abc import Iterator, Sequence

import numpy as np

from torsion.arrays import FloatArray
from torsion.output.blocks import Block, Column, Paragraph, head, table, texts
from torsion.output.figures import variants
from torsion.output.figures.figure import Role
from torsion.output.numbers import counted, unit_words
from torsion.what_if.sweep.sweep_results import Grid, Sweep, SweptCheck

MOST_LINES, MOST_CHECKS = 6, 60
MOST_ROWS, ENDS = 40, 10  # variants in the table: all, or those that use limits least and most
MOST_MODES = 3


def sections(sweep: Sweep) -> Iterator[Block]:
    """Yield checks, where they change, the figures and the variants."""
    if sweep.nominal.size:
        yield table(
            "Mode -> | Nominal [Hz]:7 -> Hz | Minimum [Hz]:7 -> minimum | Maximum [Hz]:7 -> maximum",
            by_mode(sweep.nominal, sweep.least, sweep.greatest),
            "Natural frequencies of all variants",
            short="Natural frequencies of the variants",
        )
    if sweep.any_fails is not None:
        yield table(
            "< Check -> | < Component -> | Variants that fail -> fail | Minimum utilisation [%]:4 -> minimum, % | "
            "Maximum utilisation [%]:4 -> maximum, %",
            [
                (check_label(check), check.where, check.failing, check.best, check.worst)
                for check in (sweep.any_fails, *sweep.checks[:MOST_CHECKS])
            ],
            f"Checks over {counted(sweep.samples, 'variant')}",
            short="Checks over all variants",
        )
    grid = sweep.grid
    if grid is None:
        yield Paragraph(
            "The report does not list the variants, because there are too many.", "note"
        )
        return
    if grid.turns:
        unit = unit_words(grid.axes[0].unit)
        changes = [(turn, sweep.checks[turn.check]) for turn in grid.turns]
        yield table(
            f"< Check -> | < Component -> | Passes at [={unit}]:6 -> passes | Fails at [={unit}]:6 -> fails | "
            f"Limit at about [={unit}] -> limit at about",
            [
                (check_label(check), check.where, turn.kept, turn.failing, turn.between)
                for turn, check in changes
            ],
            f"Changes between pass and fail over {grid.axes[0].name}",
            short="Changes between pass and fail",
        )
    elif len(grid.axes) == 1 and sweep.any_fails is not None and grid.axes[0].is_numeric:
        word = "every" if sweep.any_fails.failing else "no"
        yield Paragraph(
            f"No check changes between pass and fail in this range: {word} variant fails."
        )
    if len(grid.axes) == 1:
        places = [k for k, check in enumerate(sweep.checks) if np.isfinite(check.utilisation).any()]
        places.sort(key=lambda place: -(sweep.checks[place].worst or 0.0))
        names = {k: f"{sweep.checks[k].clause}: {sweep.checks[k].where}" for k in places}
        yield variants.curve(grid, [(names[k], k) for k in places[:MOST_LINES]])
    elif len(grid.axes) == 2:
        yield from variants.maps(grid)
    elif grid.utilisation.size:
        ranked = _ranked(grid)
        positions = np.column_stack(np.unravel_index(np.arange(grid.fails.size), grid.shape))
        shares = positions / (np.array(grid.shape) - 1.0)
        groups: list[tuple[str, Role, FloatArray]] = [
            (f"{ENDS} variants with the highest utilisation", "unstable", shares[ranked[-ENDS:]]),
            (f"{ENDS} variants with the lowest utilisation", "best", shares[ranked[:ENDS]]),
        ]
        caption = "Variants with the lowest and highest utilisation"
        names_of_axes = [axis.name for axis in grid.axes]
        yield variants.through("sweep_best", caption, axes=names_of_axes, groups=groups)
    yield _variants(sweep, grid)


def by_mode(*columns: FloatArray) -> list[tuple[float, ...]]:
    """Return rows of the number of a mode and its values of all columns (modes,)."""
    return [(mode, *row) for mode, row in enumerate(np.transpose(columns).tolist(), start=1)]


def check_label(check: SweptCheck) -> str:
    """Return the rule, clause and quantity of a check; the check over all has no rule."""
    return f"{check.rule} {check.clause}: {check.what}" if check.rule else "any check"


def _ranked(grid: Grid) -> list[int]:
    """The variants from the best to the worst; those without an answer stand last."""
    lost = np.zeros(grid.fails.size, dtype=np.bool_)
    lost[[variant for variant, _ in grid.why]] = True
    utilisation = np.nan_to_num(grid.greatest, nan=0.0)
    return [int(variant) for variant in np.lexsort((utilisation, grid.fails, lost))]


def _variants(sweep: Sweep, grid: Grid) -> Block:
    """Return all variants in their order, or the best and the worst; a variant without an answer with its fault."""
    shown: Sequence[int] = range(sweep.samples)
    caption = "Variants"
    if sweep.samples > MOST_ROWS:
        ranked = _ranked(grid)
        shown = [*ranked[:ENDS], *ranked[-ENDS:]]
        caption = f"The {ENDS} variants with the lowest and the {ENDS} with the highest utilisation"
    why, modes = dict(grid.why), len(grid.frequency[:MOST_MODES])
    columns = [texts(axis.name, short=axis.name) for axis in grid.axes]
    columns += [
        Column(f"Mode {mode}", "Hz", short=f"mode {mode}, Hz", digits=7)
        for mode in range(1, modes + 1)
    ]
    if sweep.checks:
        columns += head("Maximum utilisation [%]:4 -> maximum, % | < Check | < Verdict -> verdict")
    elif why:
        columns += head("< Status -> status")
    rows = []
    for variant in shown:
        fault = f"not solved: {why[variant]}" if variant in why else ""
        cells = [*grid.words(variant), *grid.frequency[:modes, variant].tolist()]
        if sweep.checks:
            decisive = int(grid.decisive[variant])
            check = sweep.checks[decisive] if decisive >= 0 else None
            label = "" if check is None else f"{check.clause}: {check.where}"
            verdict = fault or ("fails" if grid.fails[variant] else "passes")
            cells += [grid.greatest[variant], label, verdict]
        elif why:
            cells.append(fault)
        rows.append(cells)
    marks = ["fail" if grid.fails[variant] else "" for variant in shown]
    return table(tuple(columns), rows, caption, marks=marks, short="" if sweep.checks else caption)
