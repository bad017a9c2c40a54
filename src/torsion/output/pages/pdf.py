"""The report as PDF on A4, set by Typst from the same blocks."""

import itertools
import json
import tempfile
from base64 import b64decode
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from torsion.errors import Fault, InputError
from torsion.output.document import Document
from torsion.output.drawing.svg import svg
from torsion.output.drawing.words import SUBSCRIPT
from torsion.output.figures.figure import Figure
from torsion.output.pages.html import TEMPLATES, template_text

COLOURS = {
    "fail": "#b3261e",
    "pass": "#14693f",
    "not kept": "#b3261e",
    "not judged": "#8a6500",
    "restricted": "#8a6500",
    "note": "#8a6500",
}


def pdf(document: Document) -> bytes:
    """Return the file; the figures are drawn beside its source for the time of its setting."""
    with tempfile.TemporaryDirectory() as folder:
        try:
            return _set(source(document, Path(folder)), Path(folder))
        except RuntimeError as error:
            fault = Fault((), f"Typst cannot set it: {error}")
        # Perhaps the logo is what cannot be set.
        for logo in Path(folder).glob("logo.*"):
            try:
                _set(f"#image({text(logo.name)})", Path(folder))
            except RuntimeError as error:
                message = f"this picture cannot be set in a PDF: {error}"
                fault = Fault(("document", "logo"), message, "save it again as PNG")
        raise InputError([fault])


def _set(source: str, folder: Path) -> bytes:
    """Return the PDF of a source; raises RuntimeError where Typst cannot set it."""
    import typst

    path = folder / "report.typ"
    path.write_text(source, encoding="utf-8")
    made: bytes = typst.compile(str(path), root=str(folder))
    return made


def source(document: Document, folder: Path) -> str:
    """Return the source for Typst; the figures and the logo are written into the folder."""
    count, logo = itertools.count(), ""
    if document.cover.logo:  # a data URI, which becomes a file beside the source
        kind, _, content = document.cover.logo.partition(";base64,")
        logo = "logo." + kind.removeprefix("data:image/").removesuffix("+xml")
        (folder / logo).write_bytes(b64decode(content))

    def drawn(figure: Figure) -> str:
        file = folder / f"figure-{next(count)}.svg"
        file.write_text(svg(figure), encoding="utf-8")
        return file.name

    return (
        environment()
        .get_template("report_blocks.typ")
        .render(
            style=template_text("report.typ"),
            cover=document.cover,
            logo=logo,
            body=document.body,
            has_first_page=document.has_first_page,
            colours=COLOURS,
            drawn=drawn,
        )
    )


@cache
def environment() -> Environment:
    """Return the environment of the template, which is compiled once."""
    templates = Environment(
        loader=FileSystemLoader(TEMPLATES), undefined=StrictUndefined, trim_blocks=True
    )
    templates.filters |= {"quoted": text, "words": words, "longest": longest}
    templates.filters["kind"] = lambda block: type(block).__name__
    return templates


def text(value: str) -> str:
    """Return a text of the scene as a Typst expression: a string literal, in which nothing is markup."""
    return json.dumps(value, ensure_ascii=False)


def words(value: str) -> str:
    """Return a text with its subscripts as a Typst expression."""
    pieces = SUBSCRIPT.split(value)
    parts = [f"sub({text(p)})" if k % 2 else f"text({text(p)})" for k, p in enumerate(pieces) if p]
    return " + ".join(parts) or '""'


def longest(texts: Iterable[str]) -> str:
    """Return the longest word of all texts."""
    return max((word for sentence in texts for word in sentence.split()), key=len, default="")
