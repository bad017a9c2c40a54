"""Blocks and their numbers."""

import pytest

from torsion.output.blocks import Column, Figure, Heading, Paragraph, Table
from torsion.output.document import numbered


def test_numbers_follow_the_chapters_that_are_there() -> None:
    table = Table((Column("a"),), (("1",),), "caption")
    bare = Table((Column("a"),), (("1",),))
    blocks = [
        Heading("one"),
        table,
        bare,
        Heading("in it", 2),
        table,
        Heading("two"),
        Figure("f", "c", "sketch"),
        table,
    ]
    wanted = ["1", "Table 1.1", "", "1.1", "Table 1.2", "2", "Figure 2.1", "Table 2.1"]
    assert [item.number for item in numbered(blocks)] == wanted


def test_a_table_refuses_a_row_of_another_length() -> None:
    with pytest.raises(ValueError, match="does not have 2 cells"):
        Table((Column("a"), Column("b")), (("1",),), "crooked")


def test_a_paragraph_has_no_number() -> None:
    assert [item.number for item in numbered([Paragraph("x")])] == [""]
