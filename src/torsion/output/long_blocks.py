"""What is too long for a page: the page has its beginning, its end and its largest figures, a file beside it all."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from torsion.output.blocks import Block, Paragraph, Table, Value, Verbatim
from torsion.output.table_text import file_name, plain_figure, table_text

MOST_ROWS = 200  # of a table that is printed whole
# Rows printed of a longer table: its first, its last, those with the largest values of a column, and what fails.
FIRST, LAST, LARGEST = 20, 5, 3
MOST_LINES, MOST_SIGNS = 2_000, 200_000  # of a text that is printed
GAP = "⋮"  # in a row, in place of omitted rows
Texts = Mapping[str, Callable[[], str]]  # what makes the text of a file, by its name


def shortened(block: Block, number: str, stem: str) -> tuple[Block, Texts]:
    """Return a block as the page has it, and the files beside the page that it names; a short block unchanged."""
    if isinstance(block, Table) and len(block.values) > MOST_ROWS and number:
        name = f"{stem}-{file_name(number)}"
        return _shorten_table(block, name), {name: partial(table_text, number, block)}
    if isinstance(block, Verbatim):
        lines, signs = block.text.count("\n"), len(block.text)
        if lines > MOST_LINES or signs > MOST_SIGNS:
            name, size = f"{stem}-input.yaml", f"{lines:,} lines, {signs:,} characters"
            sentence = f"The input is long ({size}): see {name}."
            return Paragraph(sentence), {name: lambda: block.text}
    return block, {}


def _shorten_table(table: Table, name: str) -> Table:
    """Return the rows that are printed, with a gap in place of omitted rows, and a caption that says so."""
    failed = [
        row for row, mark in enumerate(table.marks) if mark in ("fail", "not kept", "not judged")
    ]
    kept = {*range(FIRST), *failed[:MOST_ROWS], *range(len(table.values) - LAST, len(table.values))}
    kept.update(_largest_rows(table))
    values: list[tuple[Value, ...]] = []
    marks: list[str] = []
    for row, cells in enumerate(table.values):
        if row in kept:
            values.append(cells)
            marks += table.marks[row : row + 1]
        elif row - 1 in kept:
            values.append((GAP,) * len(table.columns))
            marks += [""] if table.marks else []

    omitted, failures = len(table.values) - len(kept), len(set(failed) - kept)
    which = f"the first {MOST_ROWS}" if len(failed) > MOST_ROWS else f"all {len(failed)}"
    caption = (
        f"{table.caption}; the first {FIRST} rows, the last {LAST}{f', {which} that do not pass' if failed else ''} and "
        f"those with the {LARGEST} largest figures of a column, {omitted:,} more rows in {name}"
        f"{f', {failures:,} of them not passed' if failures else ''}"
    )
    return replace(table, values=tuple(values), marks=tuple(marks), caption=caption)


def _largest_rows(table: Table) -> Iterator[int]:
    """Yield the rows with the largest values of each column of figures, unless all of them are the same."""
    for position, column in enumerate(table.columns):
        if column.align == "right":
            sizes = [_magnitude(row[position]) for row in table.values]
            first, *_, last = top = sorted(range(len(sizes)), key=lambda row: -sizes[row])[
                : LARGEST + 1
            ]
            if sizes[first] > sizes[last]:
                yield from (row for row in top[:LARGEST] if sizes[row] > 0)


def _magnitude(value: Value) -> float:
    """Return the magnitude of a figure; -1 of what is none."""
    if isinstance(value, str):
        try:
            return abs(float(plain_figure(value.replace("∞", "inf"))))
        except ValueError:
            return -1.0
    return -1.0 if value is None else abs(value)
