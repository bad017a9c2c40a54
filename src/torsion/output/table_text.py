"""Tables as CSV text: figures as programs write them, texts that no spreadsheet runs, many tables in one archive."""

import csv
import io
import re
import zipfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from torsion.output.blocks import Table
from torsion.output.numbers import NONE, cell

_NUMBER = r"[+-]?(?:\d[\d.]*(?:e[+-]?\d+)?|inf)\s*(?:[,;\t]|$)"
_FORMULA = re.compile(
    rf"(^|[,;\t])(\s*)(?=[=+\-@])(?!{_NUMBER})"
)  # also behind what parts cells elsewhere
_WRITTEN_NUMBER = re.compile(r"−?(?:∞|\d[\d.]*(?:·10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?)")  # as `number` writes it
_PLAIN_SIGNS = str.maketrans("−⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "--0123456789")
WRITTEN = (1980, 1, 1, 0, 0, 0)  # date of every file in an archive: equal results, equal bytes


def csv_rows(rows: Iterable[Sequence[Any]]) -> str:
    """Return rows as CSV; a text is one line, and a spreadsheet does not run it as a formula."""
    target = io.StringIO()
    csv.writer(target, lineterminator="\n").writerows(map(inert_cells, rows))
    return target.getvalue()


def inert_cells(row: Iterable[Any]) -> list[Any]:
    """Return the cells of a row, every text among them as one line that no spreadsheet runs."""
    return [inert(one_line(value)) if isinstance(value, str) else value for value in row]


def packed(texts: Mapping[str, str]) -> bytes:
    """Return a .zip of texts by the names of their files; the same texts give the same bytes."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive_file:
        for name, text in texts.items():
            archive_file.writestr(zipfile.ZipInfo(name, WRITTEN), text, zipfile.ZIP_DEFLATED)
    return target.getvalue()


def write_beside(texts: Mapping[str, Callable[[], str]], target: Path) -> list[Path]:
    """Write texts, each made when its turn comes, into files of these names next to the target; return their paths."""
    paths = [target.with_name(name) for name in texts]
    for path, text in zip(paths, texts.values(), strict=True):
        path.write_text(text(), encoding="utf-8")
    return paths


def table_text(number: str, table: Table) -> str:
    """Return the rows of a table under their titles, after its number and caption as a comment."""
    titles = []
    for column in table.columns:  # without the marks of subscripts
        title = column.title.replace("_{", "_").replace("}", "")
        titles.append(f"{title} [{column.unit}]" if column.unit else title)
    return f"# {number}: {inert(one_line(table.caption))}\n{csv_rows([titles, *figures(table)])}"


def figures(table: Table) -> list[list[str]]:
    """Return the cells of every row as programs read them: numbers in the unit of their column, with all digits.

    >>> from torsion.output.blocks import table
    >>> figures(table("Speed [rpm] | < Remark", [(0.5, None)]))
    [['4.7746482927568605', '']]
    """
    return [
        [
            repr(value * column.factor) if isinstance(value, float) else parseable(cell(value))
            for column, value in zip(table.columns, row, strict=True)
        ]
        for row in table.values
    ]


def parseable(text: str) -> str:
    """Return a number in words of the report as programs read it, '' for none, and any other text on one line.

    >>> parseable("−9.3381·10⁻¹⁹"), parseable("–"), parseable("mode 2 at\\n3 Hz")
    ('-9.3381e-19', '', 'mode 2 at 3 Hz')
    """
    if _WRITTEN_NUMBER.fullmatch(text):
        text = text.replace("·10", "e").translate(_PLAIN_SIGNS).replace("∞", "inf")
    return "" if text == NONE else one_line(text)


def file_name(number: str) -> str:
    """Return the file of the table with that number: table-4.1.csv."""
    return number.lower().replace(" ", "-") + ".csv"


def inert(text: str) -> str:
    """Return a text as a cell that a spreadsheet does not run: an apostrophe stands in front of =, +, - and @.

    Numbers stay numbers. A cell may end at a comma, semicolon or tab, as the spreadsheet of each country has it.

    >>> inert("=1+1"), inert("-1.5e-7"), inert("rubber;@SUM(A1)"), inert("5 - 3")
    ("'=1+1", '-1.5e-7', "rubber;'@SUM(A1)", '5 - 3')
    """
    return _FORMULA.sub(r"\1\2'", text)


def one_line(text: str) -> str:
    """Return a text without line breaks."""
    return " ".join(text.split())
