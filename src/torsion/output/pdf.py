"""The report as PDF on A4, set by Typst from the same blocks."""

import json
import tempfile
from pathlib import Path

from torsion.output.blocks import Block, Box, Heading, KeyValues, PageEnd, Paragraph, Points, Table, Verbatim
from torsion.output.document import Document, Numbered
from torsion.output.drawing.svg import svg
from torsion.output.drawing.text import SUBSCRIPT
from torsion.output.figures.figure import Figure

COLOURS = {"fail": "#b3261e", "pass": "#14693f", "not kept": "#b3261e", "outside": "#8a6500", "note": "#8a6500"}
WIDE = 8  # columns from which a table is set smaller


def pdf(document: Document) -> bytes:
    """The file; the figures are drawn beside its source for the time of its setting."""
    import typst

    style = (Path(__file__).parent / "templates" / "report.typ").read_text(encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        source, figures = Path(folder) / "report.typ", list[Path]()
        body = [_block(item, document, Path(folder), figures) for item in document.body]
        source.write_text("\n".join([style, _cover(document), *body]), encoding="utf-8")
        made: bytes = typst.compile(str(source), root=folder)
    return made


def text(value: str) -> str:
    """A text of the scene as a Typst expression: a string literal, in which nothing is markup."""
    return json.dumps(value, ensure_ascii=False)


def words(value: str) -> str:
    """A text with its subscripts as a Typst expression."""
    pieces = SUBSCRIPT.split(value)
    parts = [f"sub({text(p)})" if k % 2 else f"text({text(p)})" for k, p in enumerate(pieces) if p]
    return " + ".join(parts) or '""'


def _cover(document: Document) -> str:
    cover = document.cover
    has_first_page = any(isinstance(item.block, PageEnd) for item in document.body)
    rest = '(), ""' if has_first_page else _facts(document)
    return f"#cover({text(cover.title)}, {text(cover.subtitle)}, {rest})"


def _facts(document: Document) -> str:
    """What is stated of the report itself."""
    cover = document.cover
    facts = "".join(f"({text(key)}, {text(value)}), " for key, value in cover.facts)
    return f"({facts}), {text(cover.disclaimer)}"


def _block(item: Numbered, document: Document, folder: Path, figures: list[Path]) -> str:
    block: Block = item.block
    match block:
        case Box(sign=sign, text=title, kind=kind, lines=lines):
            said = "".join(f"({text(head)}, {words(line)}), " for head, line in lines)
            return f"#verdict({text(kind)}, {text(sign)}, {words(title)}, ({said}))"
        case PageEnd():
            return f"#page-end({_facts(document)})"
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


def _table(table: Table, number: str) -> str:
    head = "".join(f"({words(c.title)}, {words(c.unit)}), " for c in table.columns)
    align = "".join(f"{c.align}, " for c in table.columns)
    marks = table.marks or ("",) * len(table.rows)
    cells = []
    for row, mark in zip(table.rows, marks, strict=True):
        colour = COLOURS.get(mark)
        *plain, last = (text(cell) for cell in row)
        cells.extend(plain)
        cells.append(f'marked("{colour}", {last})' if colour else last)
    size = "7pt" if len(table.columns) >= WIDE else "8pt"
    first = "27mm" if table.marks and len(table.columns) >= WIDE else "auto"  # the words of a check
    caption, every = words(table.caption), "".join(f"{c}, " for c in cells)
    return f"#grid-table({text(number)}, {caption}, ({head}), ({align}), {size}, {first}, ({every}))"
