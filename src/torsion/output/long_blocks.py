"""What is too long for a page: the page has its beginning, its end and its largest figures, a file beside it all."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import partial

from torsion.output.blocks import Block, Paragraph, Table, Value, Verbatim
from torsion.output.table_text import file_name, plain_figure, table_text

MOST_ROWS = 200  # of a table that is printed whole
FIRST, LAST, LARGEST = (
    20,
    5,
    3,
)  # rows printed of a longer one: its first, its last, those with largest of a column (and what does not pass)
MOST_LINES, MOST_SIGNS = 2_000, 200_000  # of a text that is printed
GAP = "⋮"  # in a row, in place of those left out
Texts = Mapping[str, Callable[[], str]]  # what makes the text of a file, by its name


def shortened(block: Block, number: str, stem: str) -> tuple[Block, Texts]:
    """A block as the page has it, and the files beside the page that it says; a block that is not long itself."""
    if isinstance(block, Table) and len(block.values) > MOST_ROWS and number:
        name = f"{stem}-{file_name(number)}"
        return _table(block, name), {name: partial(table_text, number, block)}
    if isinstance(block, Verbatim) and (
        block.text.count("\n") > MOST_LINES or len(block.text) > MOST_SIGNS
    ):
        name = f"{stem}-input.yaml"
        size = f"{block.text.count(chr(10)):,} lines, {len(block.text):,} characters"
        return Paragraph(f"The input is long ({size}): see {name}."), {name: lambda: block.text}
    return block, {}


def _table(table: Table, name: str) -> Table:
    """The rows that are printed, with a gap where some are left out, and a caption that says so."""
    kept = sorted(set(_kept(table)))
    order = [
        place
        for before, at in zip([-1, *kept], kept, strict=False)
        for place in ([None, at] if at > before + 1 else [at])
    ]
    gap = (GAP,) * len(table.columns)
    marks = [table.marks[at] if at is not None else "" for at in order] if table.marks else []
    hidden = set(range(len(table.values))) - set(kept)
    every, bad = _bad(table), len(hidden.intersection(_bad(table)))
    which = f"the first {MOST_ROWS}" if len(every) > MOST_ROWS else f"all {len(every)}"
    words = (
        f"{table.caption}; the first {FIRST} rows, the last {LAST}{f', {which} that do not pass' if every else ''} and "
        f"those with the {LARGEST} largest figures of a column, {len(hidden):,} more rows in {name}"
        f"{f', {bad:,} of them not passed' if bad else ''}"
    )
    rows = tuple(gap if at is None else table.values[at] for at in order)
    return replace(table, values=rows, marks=tuple(marks), caption=words)


def _kept(table: Table) -> Iterator[int]:
    """Positions of the rows that are printed."""
    yield from range(FIRST)
    yield from _bad(table)[:MOST_ROWS]
    yield from range(len(table.values) - LAST, len(table.values))
    for k, column in enumerate(table.columns):
        if column.align == "right":
            size = [_size(row[k]) for row in table.values]
            top = sorted(range(len(size)), key=lambda at: -size[at])[: LARGEST + 1]
            if size[top[0]] > size[top[-1]]:  # else the figures are all the same, or there is none
                yield from (at for at in top[:LARGEST] if size[at] > 0)


def _bad(table: Table) -> list[int]:
    """Positions of the rows of what does not pass."""
    return [at for at, mark in enumerate(table.marks) if mark in ("fail", "not kept", "not judged")]


def _size(value: Value) -> float:
    """Return the magnitude of a figure; -1 of what is none."""
    if isinstance(value, str):
        try:
            return abs(float(plain_figure(value.replace("∞", "inf"))))
        except ValueError:
            return -1.0
    return -1.0 if value is None else abs(value)
