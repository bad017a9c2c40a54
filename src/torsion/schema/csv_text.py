"""The text of a CSV file as cells, each with its line and column, as spreadsheets write them.

Columns are parted by tabs, semicolons or commas, which the first line shows or says (`sep=;`). Empty lines, and lines
that begin with `#`, say nothing. Cells in double quotes may hold separators, breaks of lines, and quotes written twice.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path as FilePath

from torsion.errors import REORDERING, Fault, printable
from torsion.schema.fault_text import Source, end_of
from torsion.user_files import LARGEST_TABLE, read_file

MOST_ROWS = 100_000
_NO_VALUE = r"#(?:[A-Z]+[!?]|DIV/0!|N/A|NV)"  # what a spreadsheet writes for a formula without one
FORMULA_ERROR = re.compile(rf"{_NO_VALUE}|Err:\d+|##+")
_COMMENT = re.compile(rf' *"?#(?!(?:{_NO_VALUE[1:]})"?[ \t]*(?:[\t;,\r\n]|$))')
_STATED = re.compile(r'"?sep=(.)"?[ \t]*(?:\r\n?|\n)', re.IGNORECASE)
_QUOTED = re.compile(r' *"((?:[^"]|"")*)" *')
_BREAK = re.compile(r"\r\n?|\n")
_NUL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f]")


@dataclass(frozen=True, slots=True)
class Cell:
    """What stands between two separators, where it stands, and whether it stood in quotes."""

    text: str
    line: int
    column: int


def table_text(file: FilePath) -> tuple[str, Fault | None]:
    """The text of a file without a byte order mark, and what is wrong with its encoding; raises OSError."""
    content = read_file(file, LARGEST_TABLE)
    if content[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return "", Fault((), "the file is UTF-16 text", "save it as `CSV UTF-8`", line=1, column=1)
    try:
        text = content.decode().removeprefix("\ufeff")
    except UnicodeDecodeError as error:
        line, column = end_of(content[: error.start].decode())
        fault = Fault(
            (), "the file is not UTF-8 text", "save it as `CSV UTF-8`", line=line, column=column
        )
        return content.decode(errors="replace"), fault
    if found := _NUL.search(text) or REORDERING.search(text):
        line, column = end_of(text[: found.start()])
        message = f"the character U+{ord(found[0]):04X} is not allowed"
        return text, Fault(
            (), message, "save the sheet as CSV, not as a workbook", line=line, column=column
        )
    return text, None


def rows_of(source: Source, faults: list[Fault]) -> tuple[str, list[list[Cell]]]:
    """The separator, and every row that says something as cells without blanks around them; faults are noted."""
    text = source.text
    stated = _STATED.match(text)
    begin = 0 if stated is None else stated.end()
    separator = stated[1] if stated else _separator(text)
    rows: list[list[Cell]] = []
    for cells in _rows(text, begin, separator, faults):
        if any(cell.text for cell in cells):
            rows.append(cells)
        if len(rows) > MOST_ROWS:
            faults.append(
                Fault((), f"the table has more than {MOST_ROWS} rows", "", line=1, column=1)
            )
            break
    return separator, rows


def first_comment(text: str) -> str:
    """What the first line says that begins with `#`; empty where none does."""
    found = next((line for line in _BREAK.split(text) if _COMMENT.match(line)), "")
    return found.strip(' "#\t,;').strip()


def _separator(text: str) -> str:
    """Of the first line that says something: a tab, else a semicolon, else a comma."""
    for line in _BREAK.split(text):
        plain = re.sub(r'"[^"]*"', "", line)
        if plain.strip(" \t,;") and not _COMMENT.match(line):
            return next((sign for sign in "\t;" if sign in plain), ",")
    return ","


def _rows(text: str, begin: int, separator: str, faults: list[Fault]) -> Iterator[list[Cell]]:
    """Every row with its cells; a comment is one cell. Places follow from the breaks of lines met so far."""
    plain = re.compile(rf"[^{re.escape(separator)}\r\n]*")
    line, start, place, row = 1 + len(_BREAK.findall(text[:begin])), begin, begin, list[Cell]()
    while place <= len(text):
        here = line, place - start + 1
        if not row and _COMMENT.match(text, place):
            end = _BREAK.search(text, place)
            place = end.start() if end else len(text)
        elif quoted := _QUOTED.match(text, place):
            row.append(Cell(_BREAK.sub(" ", quoted[1].replace('""', '"')).strip(), *here))
            breaks = list(_BREAK.finditer(text, place, quoted.end()))
            line, start, place = (
                line + len(breaks),
                breaks[-1].end() if breaks else start,
                quoted.end(),
            )
            if place < len(text) and text[place] not in f"{separator}\r\n":
                faults.append(
                    _fault(
                        "text follows the closing quote", "quotes within a cell are doubled", *here
                    )
                )
                place = (plain.match(text, place) or quoted).end()
        else:
            found = plain.match(text, place)
            words = "" if found is None else found[0]
            if words.lstrip().startswith('"'):
                faults.append(_fault("this quote is not closed", "", *here))
            row.append(Cell(words.strip(), here[0], here[1] + len(words) - len(words.lstrip())))
            place += len(words)
        end = _BREAK.match(text, place)
        if end or place >= len(text):
            yield row
            place = start = end.end() if end else len(text) + 1
            line, row = line + 1, []
        else:
            place += 1


def _fault(message: str, hint: str, line: int, column: int) -> Fault:
    return Fault((), printable(message, 200), hint, line=line, column=column)
