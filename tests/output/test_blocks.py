"""Blocks and their numbers."""

import dataclasses
import importlib
import pkgutil

import pytest

from torsion import output
from torsion.output import chapters, figures
from torsion.output.blocks import (
    Column,
    Figure,
    Heading,
    Paragraph,
    Points,
    Table,
    head,
    on_terminal,
)
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
        Figure("f", "c", ()),
        table,
    ]
    wanted = ["1", "Table 1.1", "", "1.1", "Table 1.2", "2", "Figure 2.1", "Table 2.1"]
    assert [item.number for item in numbered(blocks)] == wanted


def test_a_table_refuses_a_row_of_another_length() -> None:
    with pytest.raises(ValueError, match="does not have 2 cells"):
        Table((Column("a"), Column("b")), (("1", "2"), ("1",)), "crooked")


def test_a_paragraph_has_no_number() -> None:
    assert [item.number for item in numbered([Paragraph("x")])] == [""]


def test_titles_hold_unit_side_and_the_title_of_the_terminal() -> None:
    assert head("< Shaft -> | Critical speed [rpm] -> rpm | Bore [mm] | < Its Note | Order ->") == (
        Column("Shaft", "", "left", "shaft"),
        Column("Critical speed", "rpm", "right", "rpm"),
        Column("Bore", "mm", "right", ""),
        Column("Its Note", "", "left", ""),
        Column("Order", "", "right", "order"),
    )


def test_sentences_stand_on_the_terminal_only_where_it_is_said() -> None:
    table = Table((Column("a"),), (("1",),))
    blocks = [Paragraph("x", "note"), Points(("y",)), table, Heading("z")]
    assert not any(one.brief for one in blocks[:2])
    assert not blocks[3].at_end
    assert on_terminal(blocks) == [
        Paragraph("x", "note", brief=True),
        Points(("y",), brief=True),
        *blocks[2:],
    ]


def test_what_a_report_is_made_of_cannot_be_changed() -> None:
    """A block that one renderer changed would differ in the next."""
    folders = {f"{folder.__name__}.": folder.__path__ for folder in (output, chapters, figures)}
    names = [
        one.name for prefix, path in folders.items() for one in pkgutil.iter_modules(path, prefix)
    ]
    kinds = {
        kind
        for name in names
        for kind in vars(importlib.import_module(name)).values()
        if isinstance(kind, type)
    }
    own = {kind for kind in kinds if kind.__module__ in names and dataclasses.is_dataclass(kind)}
    assert {Column, Figure, Heading, Paragraph, Table} < own
    assert [kind.__name__ for kind in own if not kind.__dataclass_params__.frozen] == []
