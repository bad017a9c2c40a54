"""Texts of the scene are nothing but text to Typst."""

from torsion.output.blocks import Column, Heading, Paragraph, Points, Table, Verbatim
from torsion.output.document import Cover, Document, numbered
from torsion.output.pdf import pdf, words
from torsion.output.reports import REPORTS


def test_names_that_look_like_markup_do_not_stop_the_pdf(nasty: str) -> None:
    table = Table((Column(nasty, "N m"), Column("b")), ((nasty, "1"),), nasty, ("fail",))
    blocks = [Heading(nasty), Paragraph(nasty, "note"), Points((nasty,)), table, Verbatim(nasty + "\n#let x = 1")]
    cover = Cover(nasty, nasty, ((nasty, nasty),))
    assert pdf(Document(cover, tuple(numbered(blocks)), None, REPORTS["solve"])).startswith(b"%PDF-")


def test_a_subscript_is_set_as_one() -> None:
    assert words("tau_{C} = 1") == 'text("tau") + sub("C") + text(" = 1")'
