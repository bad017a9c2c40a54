"""The report as one self-contained HTML page: style, figures and their script are in the page, which prints on A4."""

import re
from base64 import b64encode
from collections.abc import Callable, Sequence
from functools import cache
from hashlib import sha256
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from torsion.output.blocks import Heading
from torsion.output.document import Document, Numbered
from torsion.output.drawing.page_data import Page
from torsion.output.drawing.svg import framed
from torsion.output.drawing.words import SUBSCRIPT
from torsion.output.figures.figure import Figure
from torsion.output.numbers import NONE
from torsion.output.table_text import figures

TEMPLATES = Path(__file__).parent / "templates"
SCRIPTS = tuple(
    f"report_{part}.js" for part in ("numbers", "plots", "cursor", "input", "modes", "page")
)


def style() -> str:
    """Return the style of the page on a screen and on paper, and of its drawings on a dark screen."""
    return f"{template_text('report.css')}\n{template_text('report_dark.css')}"


def script() -> str:
    """Return the scripts of the page in one text, without indents."""
    return "\n".join(re.sub(r"\n\s+", "\n", template_text(name)) for name in SCRIPTS)


def template_text(name: str, folder: Path = TEMPLATES) -> str:
    """Return the text of a file of the page without the blank space around it."""
    return (folder / name).read_text(encoding="utf-8").strip()


LONG_WORD = 20  # characters


def html(document: Document) -> str:
    """Return the page of a report."""
    (drawn, numbers), page_script = _draw(document.body), Markup(script())
    blocks = [(item, item.block) for item in document.body]
    return (
        environment()
        .get_template("report.html")
        .render(
            drawn=drawn,
            cover=document.cover,
            body=document.body,
            chapters=[
                item for item, block in blocks if isinstance(block, Heading) and block.level == 1
            ],
            style=Markup(style()),
            script=page_script,
            digest=b64encode(sha256(f"\n{page_script}\n".encode()).digest()).decode(),
            numbers=numbers,
            has_first_page=document.has_first_page,
        )
    )


def fragment(body: Sequence[Numbered]) -> dict[str, str]:
    """Return blocks without cover and contents for a page that exists already: `main` and its `numbers`."""
    (drawn, numbers), template = _draw(body, 1), environment().get_template("report_main.html")
    main = template.render(drawn=drawn, body=body, chapters=(), has_first_page=False)
    return {"main": main, "numbers": str(numbers)}


def _draw(body: Sequence[Numbered], level: int = 9) -> tuple[Callable[[Figure], Markup], Markup]:
    """Draw every figure; return the drawing of each, as the templates call it, and JSON of all their numbers.

    level: of zlib, 1 if speed matters more than length.
    """
    page, drawings = Page(), dict[str, Markup]()
    for figure in (item.block for item in body):
        if isinstance(figure, Figure):
            text, frames = framed(figure)
            data = page.figure(figure, frames)
            drawings[figure.name] = Markup(f'{text}<script type="application/json">{data}</script>')
    return lambda figure: drawings[figure.name], Markup(page.numbers(level))


@cache
def environment() -> Environment:
    """Return the environment of the templates: all text is escaped but the drawings of figures."""
    templates = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    for function in (words, css_text, anchor, has_long_word, linked, figures):
        templates.filters[function.__name__] = function
    templates.filters["kind"] = lambda block: type(block).__name__
    return templates


def words(text: str) -> Markup:
    """Return a text escaped, with its subscripts."""
    return Markup(SUBSCRIPT.sub(r"<sub>\1</sub>", str(escape(text))))


def linked(text: str) -> Markup:
    """Return the name of a file as a link to it; the sign for none unchanged."""
    return escape(text) if text == NONE else Markup('<a href="{0}">{0}</a>').format(text)


def css_text(text: str) -> Markup:
    """Return a string of a style sheet: whatever could end it is written by its code point."""
    return Markup("".join(c if c.isalnum() or c in " -.,:()" else f"\\{ord(c):x} " for c in text))


def has_long_word(text: str) -> bool:
    """Return whether a word would push a table over the edge of the page, and may be broken anywhere."""
    return any(len(word) > LONG_WORD for word in text.split())


def anchor(item: Numbered) -> str:
    """Return a stable name to link to."""
    return "s" + item.number.replace(" ", "-").replace(".", "-").lower()
