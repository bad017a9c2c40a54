"""The report as PDF on A4, set by Typst from the same blocks."""

import json
import tempfile
from base64 import b64decode
from collections.abc import Iterable
from itertools import repeat
from pathlib import Path

from torsion.errors import Fault, InputError
from torsion.output.blocks import (
    Block,
    Box,
    Heading,
    KeyValues,
    PageEnd,
    Paragraph,
    Points,
    Table,
    Verbatim,
)
from torsion.output.document import Document, Numbered
from torsion.output.drawing.svg import svg
from torsion.output.drawing.text import SUBSCRIPT
from torsion.output.figures.figure import Figure

COLOURS = {
    "fail": "#b3261e",
    "pass": "#14693f",
    "not kept": "#b3261e",
    "not judged": "#8a6500",
    "restricted": "#8a6500",
    "note": "#8a6500",
}
WIDE = 8  # columns from which a table is set smaller


def pdf(document: Document) -> bytes:
    """Return the file; the figures are drawn beside its source for the time of its setting."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return _set(source(document, Path(folder)), Path(folder))
        except RuntimeError as error:
            _try_logo(Path(folder))
            raise InputError([Fault((), f"Typst cannot set it: {error}")]) from None


def _set(source: str, folder: Path) -> bytes:
    """Return the PDF of a source; raises RuntimeError where Typst cannot set it."""
    import typst

    path = folder / "report.typ"
    path.write_text(source, encoding="utf-8")
    made: bytes = typst.compile(str(path), root=str(folder))
    return made


def source(document: Document, folder: Path) -> str:
    """Return the source for Typst; the figures and the logo are written into the folder."""
    style, figures = (
        (Path(__file__).parent / "templates" / "report.typ").read_text(encoding="utf-8"),
        list[Path](),
    )
    body = [_block(item, document, folder, figures) for item in document.body]
    return "\n".join([_running_head(document), style, _cover(document, folder), *body])


def text(value: str) -> str:
    """Return a text of the scene as a Typst expression: a string literal, in which nothing is markup."""
    return json.dumps(value, ensure_ascii=False)


def words(value: str) -> str:
    """Return a text with its subscripts as a Typst expression."""
    pieces = SUBSCRIPT.split(value)
    parts = [f"sub({text(p)})" if k % 2 else f"text({text(p)})" for k, p in enumerate(pieces) if p]
    return " + ".join(parts) or '""'


def _try_logo(folder: Path) -> None:
    """Raise InputError where the logo is what cannot be set."""
    for logo in folder.glob("logo.*"):
        try:
            _set(f"#image({text(logo.name)})", folder)
        except RuntimeError as error:
            fault = Fault(
                ("document", "logo"),
                f"this picture cannot be set in a PDF: {error}",
                "save it again as PNG",
            )
            raise InputError([fault]) from None


def _running_head(document: Document) -> str:
    cover = document.cover
    return f"#let running = ({text(f'{cover.title} · {cover.identity}')}, {text(cover.origin)})"


def _cover(document: Document, folder: Path) -> str:
    """Return the cover, with its logo in a file beside the source."""
    cover, logo = document.cover, ""
    if cover.logo:
        kind, _, content = cover.logo.partition(";base64,")
        logo = "logo." + kind.removeprefix("data:image/").removesuffix("+xml")
        (folder / logo).write_bytes(b64decode(content))
    basis = "none" if document.has_first_page else _basis(document)
    return f"#cover({text(cover.title)}, {text(cover.subtitle)}, {text(logo)}, {basis})"


def _basis(document: Document) -> str:
    """Return what is stated of the report itself."""
    cover = document.cover
    pairs = (*cover.facts_by_length, cover.signatures)
    short, long, signed = (
        "".join(f"({text(key)}, {text(value)}), " for key, value in some) for some in pairs
    )
    return f"basis(({short}), ({long}), {text(cover.disclaimer)}, ({signed}))"


def _block(item: Numbered, document: Document, folder: Path, figures: list[Path]) -> str:
    block: Block = item.block
    match block:
        case Box(sign=sign, text=title, kind=kind, lines=lines):
            pairs_text = "".join(f"({text(head)}, {words(line)}), " for head, line in lines)
            return f"#verdict({text(kind)}, {text(sign)}, {words(title)}, ({pairs_text}))"
        case PageEnd():
            return f"#page-end({_basis(document)})"
        case Heading(text=title, level=level):
            return f"#title({level}, {text(item.number)}, {words(title)})"
        case Paragraph(text=sentences, kind=kind):
            return f"#sentences({text(kind)}, {words(sentences)})"
        case Points(items=items):
            return f"#points(({''.join(f'{words(point)}, ' for point in items)}))"
        case KeyValues(pairs=pairs):
            return f"#facts(({''.join(f'({text(key)}, {text(value)}), ' for key, value in pairs)}))"
        case Table():
            return _table(block, item.number)
        case Figure():
            path = folder / f"figure-{len(figures)}.svg"
            path.write_text(svg(block), encoding="utf-8")
            figures.append(path)
            return f"#drawing({text(path.name)}, {text(item.number)}, {words(block.caption)})"
        case Verbatim(text=lines):
            return f"#verbatim({text(lines)})"


def _longest(texts: Iterable[str]) -> str:
    """Return the longest word of all texts."""
    return max((word for sentence in texts for word in sentence.split()), key=len, default="")


def _table(table: Table, number: str) -> str:
    head = "".join(
        f"({words(c.title)}, {words(c.unit)}, {words(_longest([c.title]))}, {text(_longest(cells))}), "
        for c, cells in zip(
            table.columns, zip(*table.rows, strict=True) if table.rows else repeat(()), strict=False
        )
    )
    align = "".join(f"{c.align}, " for c in table.columns)
    marks = table.marks or ("",) * len(table.rows)
    cells = []
    for row, mark in zip(table.rows, marks, strict=True):
        colour = COLOURS.get(mark)
        *plain, last = (text(cell) for cell in row)
        cells.extend(plain)
        cells.append(f'marked("{colour}", {last})' if colour else last)
    size = "7pt" if len(table.columns) >= WIDE else "7.5pt"
    caption, content = words(table.caption), "".join(f"{c}, " for c in cells)
    return f"#grid-table({text(number)}, {caption}, ({head}), ({align}), {size}, ({content}))"
