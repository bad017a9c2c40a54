"""The report as one self-contained HTML page: style, figures and their script are in the page, which prints on A4."""

from base64 import b64encode
from functools import partial
from hashlib import sha256
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from torsion.output.blocks import Heading, Link
from torsion.output.document import Document, Numbered
from torsion.output.drawing.live import Page
from torsion.output.drawing.svg import framed
from torsion.output.drawing.text import SUBSCRIPT
from torsion.output.figures.figure import Figure

LONG_WORD = 20  # characters


def html(document: Document) -> str:
    """The page."""
    environment = Environment(
        loader=FileSystemLoader(Path(__file__).parent / "templates"), autoescape=True, undefined=StrictUndefined,
        trim_blocks=True,
    )  # fmt: skip
    environment.filters.update(
        words=words, css_text=css_text, anchor=anchor, has_long_word=has_long_word, linked=linked
    )
    live = Page()
    environment.filters.update(drawn=partial(_figure, live), kind=lambda block: type(block).__name__)
    style, script = (
        Markup((Path(__file__).parent / "templates" / f"report.{kind}").read_text(encoding="utf-8").strip())
        for kind in ("css", "js")
    )
    chapters = [item for item in document.body if isinstance(item.block, Heading) and item.block.level == 1]
    return environment.get_template("report.html").render(
        cover=document.cover, body=document.body, chapters=chapters, style=style, script=script,
        digest=b64encode(sha256(f"\n{script}\n".encode()).digest()).decode(),
        coordinates=lambda: Markup(live.coordinates()),
    )  # fmt: skip


def _figure(live: Page, figure: Figure) -> Markup:
    """A drawing, with the values of its lines for the script of the page."""
    text, frames = framed(figure)
    return Markup(f'{text}<script type="application/json">{live.figure(frames)}</script>')


def words(text: str) -> Markup:
    """Text escaped, with its subscripts."""
    return Markup(SUBSCRIPT.sub(r"<sub>\1</sub>", str(escape(text))))


def linked(text: str) -> Markup:
    """A cell of a table, which may name a file."""
    return Markup('<a href="{0}">{0}</a>').format(text) if isinstance(text, Link) else escape(text)


def css_text(text: str) -> Markup:
    """A string of a style sheet: whatever could end it is written by its code point."""
    return Markup("".join(c if c.isalnum() or c in " -.,:()" else f"\\{ord(c):x} " for c in text))


def has_long_word(text: str) -> bool:
    """A word that would push a table over the edge of the page, and may be broken anywhere."""
    return any(len(word) > LONG_WORD for word in text.split())


def anchor(item: Numbered) -> str:
    """A stable name to link to."""
    return "s" + item.number.replace(" ", "-").replace(".", "-").lower()
