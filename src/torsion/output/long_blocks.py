"""What is too long for a page: the page has its beginning, its end and what fails, a file beside it all."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial

from torsion.output.blocks import Block, Paragraph, Table, Value, Verbatim
from torsion.output.table_text import file_name, table_text

MOST_ROWS = 200  # of a table that is printed whole
FIRST, LAST = 20, 5  # rows printed of a longer one, and those that do not pass
FAILED = ("fail", "not kept", "not judged")
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
    failed = [row for row, mark in enumerate(table.marks) if mark in FAILED]
    count = len(table.values)
    kept = {*range(FIRST), *failed[:MOST_ROWS], *range(count - LAST, count)}
    values: list[tuple[Value, ...]] = []
    marks: list[str] = []
    for row, cells in enumerate(table.values):
        if row in kept:
            values.append(cells)
            marks += table.marks[row : row + 1]
        elif row - 1 in kept:
            values.append((GAP,) * len(table.columns))
            marks += [""] if table.marks else []

    which = f"the first {MOST_ROWS}" if len(failed) > MOST_ROWS else f"all {len(failed)}"
    rows = f"the first {FIRST} rows, the last {LAST}"
    rows += f" and {which} that do not pass" if failed else ""
    caption = f"{table.caption}; {rows}, {count - len(kept):,} more rows in {name}"
    if failures := len(set(failed) - kept):
        caption += f", {failures:,} of them not passed"
    return replace(table, values=tuple(values), marks=tuple(marks), caption=caption)
