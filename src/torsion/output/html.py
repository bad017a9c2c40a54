"""The report as one self-contained HTML page: style, figures and their script are in the page, which prints on A4."""

import re
from base64 import b64encode
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from torsion.output.blocks import Heading
from torsion.output.document import Document, Numbered
from torsion.output.drawing.dark import rules
from torsion.output.drawing.live import Page
from torsion.output.drawing.svg import framed
from torsion.output.drawing.text import SUBSCRIPT
from torsion.output.figures.figure import Figure, Twisted
from torsion.output.numbers import NONE

LONG_WORD = 20  # characters
SCRIPTS = tuple(f"report_{part}.js" for part in ("numbers", "plots", "cursor", "input", "modes", "page"))


def html(document: Document) -> str:
    """The page."""
    live = Page()
    figures = [item.block for item in document.body if isinstance(item.block, Figure)]
    drawings = {figure.name: _figure(live, figure) for figure in figures}
    surfaces = {figure.name for figure in figures if any(isinstance(panel, Twisted) for panel in figure.panels)}
    style, script = _template("report.css"), Markup("\n".join(map(_without_indents, map(_template, SCRIPTS))))
    chapters = [item for item in document.body if isinstance(item.block, Heading) and item.block.level == 1]
    return environment(drawn=lambda figure: drawings[figure.name]).get_template("report.html").render(
        cover=document.cover, body=document.body, chapters=chapters, style=style, script=script,
        on_dark=Markup(rules(text for name, text in drawings.items() if name not in surfaces)),  # theirs are a scale
        digest=b64encode(sha256(f"\n{script}\n".encode()).digest()).decode(),
        numbers=Markup(live.numbers()),
        has_first_page=document.has_first_page,
    )  # fmt: skip


def environment(drawn: Callable[[Figure], str]) -> Environment:
    """Of the templates of pages: everything is escaped but what `drawn` makes of a figure."""
    made = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True,
    )  # fmt: skip
    made.filters.update(words=words, css_text=css_text, anchor=anchor, has_long_word=has_long_word, linked=linked)
    made.filters.update(drawn=lambda figure: Markup(drawn(figure)), kind=lambda block: type(block).__name__)
    return made


def _figure(live: Page, figure: Figure) -> Markup:
    """A drawing, with its numbers for the script of the page."""
    text, frames = framed(figure)
    return Markup(f'{text}<script type="application/json">{live.figure(figure, frames)}</script>')


def _without_indents(script: str) -> str:
    return re.sub(r"\n\s+", "\n", script)


def _template(name: str) -> Markup:
    return Markup((Path(__file__).parent / "templates" / name).read_text(encoding="utf-8").strip())


def words(text: str) -> Markup:
    """Text escaped, with its subscripts."""
    return Markup(SUBSCRIPT.sub(r"<sub>\1</sub>", str(escape(text))))


def linked(text: str) -> Markup:
    """The name of a file, which leads there; of none its sign."""
    return escape(text) if text == NONE else Markup('<a href="{0}">{0}</a>').format(text)


def css_text(text: str) -> Markup:
    """A string of a style sheet: whatever could end it is written by its code point."""
    return Markup("".join(c if c.isalnum() or c in " -.,:()" else f"\\{ord(c):x} " for c in text))


def has_long_word(text: str) -> bool:
    """A word that would push a table over the edge of the page, and may be broken anywhere."""
    return any(len(word) > LONG_WORD for word in text.split())


def anchor(item: Numbered) -> str:
    """A stable name to link to."""
    return "s" + item.number.replace(" ", "-").replace(".", "-").lower()
