"""Texts of the scene are nothing but text to Typst."""

from pathlib import Path

from torsion.output.blocks import Column, Heading, Paragraph, Points, Table, Verbatim
from torsion.output.cover import Cover
from torsion.output.document import Document
from torsion.output.numbering import numbered
from torsion.output.pdf import words, write_pdf


def test_names_that_look_like_markup_do_not_stop_the_pdf(nasty: str, tmp_path: Path) -> None:
    table = Table((Column(nasty, "N m"), Column("b")), ((nasty, "1"),), nasty, ("fail",))
    blocks = [Heading(nasty), Paragraph(nasty, "note"), Points((nasty,)), table, Verbatim(nasty + "\n#let x = 1")]
    cover = Cover(nasty, nasty, ((nasty, nasty),))
    made = write_pdf(Document(cover, tuple(numbered(blocks))), tmp_path)
    assert made.read_bytes().startswith(b"%PDF-")
    assert [path.name for path in tmp_path.iterdir()] == ["report.pdf"]


def test_a_subscript_is_set_as_one() -> None:
    assert words("tau_{C} = 1") == 'text("tau") + sub("C") + text(" = 1")'
