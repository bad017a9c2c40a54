"""The report as one self-contained HTML page: style, figures and their script are in the page, which prints on A4."""

from base64 import b64encode
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup, escape

from torsion.output.blocks import Heading
from torsion.output.document import Document, Numbered
from torsion.output.drawing.dark import rules
from torsion.output.drawing.live import Page
from torsion.output.drawing.svg import framed
from torsion.output.drawing.text import SUBSCRIPT
from torsion.output.figures.figure import Figure
from torsion.output.numbers import NONE
from torsion.output.page_files import TEMPLATES, script, style
from torsion.output.table_text import figures

LONG_WORD = 20  # characters


@dataclass(frozen=True)
class Drawn:
    """The drawings of a page by the names of their figures, and what they need beside them."""

    drawings: Mapping[str, Markup]
    numbers: Markup  # JSON for the script of the page
    on_dark: Markup  # rules of style on a dark screen

    def __call__(self, figure: Figure) -> Markup:
        """The drawing of a figure, as the templates show it."""
        return self.drawings[figure.name]


def html(document: Document) -> str:
    """The page."""
    drawn, own = _drawn(document.body), Markup(script())
    chapters = [
        item for item in document.body if isinstance(item.block, Heading) and item.block.level == 1
    ]
    return (
        environment()
        .get_template("report.html")
        .render(
            drawn=drawn,
            cover=document.cover,
            body=document.body,
            chapters=chapters,
            style=Markup(style()),
            script=own,
            on_dark=drawn.on_dark,
            digest=b64encode(sha256(f"\n{own}\n".encode()).digest()).decode(),
            numbers=drawn.numbers,
            has_first_page=document.has_first_page,
        )
    )


def fragment(body: Sequence[Numbered]) -> dict[str, str]:
    """Blocks without cover and contents, as a page that is there already takes them: `main`, its `numbers`, `dark`."""
    drawn, template = _drawn(body, level=1), environment().get_template("report_main.html")
    main = template.render(drawn=drawn, body=body, chapters=(), has_first_page=False)
    return {"main": main, "numbers": str(drawn.numbers), "dark": str(drawn.on_dark)}


def _drawn(body: Sequence[Numbered], level: int = 9) -> Drawn:
    """Every figure drawn; level: of zlib, 1 where it is to be soon rather than short."""
    live = Page()
    figures = [item.block for item in body if isinstance(item.block, Figure)]
    drawings = {figure.name: _figure(live, figure) for figure in figures}
    dark = rules(drawings.values())
    return Drawn(drawings, Markup(live.numbers(level)), Markup(dark))


@cache
def environment() -> Environment:
    """Of the templates of pages: everything is escaped but what their `drawn` makes of a figure."""
    made = Environment(
        loader=FileSystemLoader(TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    made.filters.update(
        words=words, css_text=css_text, anchor=anchor, has_long_word=has_long_word, linked=linked
    )
    made.filters.update(kind=lambda block: type(block).__name__, figures=figures)
    return made


def _figure(live: Page, figure: Figure) -> Markup:
    """A drawing, with its numbers for the script of the page."""
    text, frames = framed(figure)
    return Markup(f'{text}<script type="application/json">{live.figure(figure, frames)}</script>')


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
