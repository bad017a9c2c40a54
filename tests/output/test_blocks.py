"""Blocks and their numbers."""

import dataclasses
import importlib
import math
import pkgutil
from fractions import Fraction

import pytest

from torsion import output
from torsion.output import chapters, figures, table_text
from torsion.output.blocks import (
    Column,
    Figure,
    Heading,
    Paragraph,
    Points,
    Table,
    head,
    on_terminal,
    table,
)
from torsion.output.document import numbered
from torsion.results import reported, result


def test_numbers_follow_the_chapters_that_are_there() -> None:
    full = Table((Column("a"),), (("1",),), "caption")
    bare = Table((Column("a"),), (("1",),))
    blocks = [
        Heading("one"),
        full,
        bare,
        Heading("in it", 2),
        full,
        Heading("two"),
        Figure("f", "c", ()),
        full,
    ]
    wanted = ["1", "Table 1.1", "", "1.1", "Table 1.2", "2", "Figure 2.1", "Table 2.1"]
    assert [item.number for item in numbered(blocks)] == wanted


def test_a_table_refuses_a_row_of_another_length() -> None:
    with pytest.raises(ValueError, match="does not have 2 cells"):
        table((Column("a"), Column("b")), [("1", "2"), ("1",)], "crooked")


def test_a_paragraph_has_no_number() -> None:
    assert [item.number for item in numbered([Paragraph("x")])] == [""]


def test_titles_hold_unit_side_and_the_title_of_the_terminal() -> None:
    assert head("< Shaft -> | Critical speed [rpm] -> rpm | Bore [mm] | < Its Note | Order ->") == (
        Column("Shaft", "", "left", "shaft"),
        Column("Critical speed", "rpm", "right", "rpm", factor=30.0 / math.pi),
        Column("Bore", "mm", "right", "", factor=1e3),
        Column("Its Note", "", "left", ""),
        Column("Order", "", "right", "order"),
    )


def test_sentences_stand_on_the_terminal_only_where_it_is_said() -> None:
    plain = Table((Column("a"),), (("1",),))
    blocks = [Paragraph("x", "note"), Points(("y",)), plain, Heading("z")]
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


def test_a_table_keeps_values_and_shows_them_in_the_unit_of_its_head() -> None:
    made = table(
        "< Shaft | Speed [rpm]:6 | Stress [N/mm²]:4 | Limit [=N/mm²] | Order:o | Change [%]:3+",
        [
            ("a", math.pi, 31.25e6, 40.0, Fraction(1, 2), 0.25),
            ("b", None, math.inf, math.nan, None, 0.0),
        ],
    )
    assert made.values[0][:4] == ("a", math.pi, 31.25e6, 40.0)
    assert made.rows == (
        ("a", "30.0000", "31.25", "40.000", "0.5", "+25.0"),
        ("b", "–", "∞", "–", "–", "0"),
    )
    assert table_text.figures(made)[1] == ["b", "", "∞", "", "", "0.0"]


def test_torques_have_the_prefix_that_leaves_no_column_below_one() -> None:
    made = table(
        "Torque [~N m] -> ~ | Limit [~N m] | Speed [rpm]",
        [(1200.0, 2e6, 1.0), (0.5, None, 1.0)],
        short="in ~",
    )
    assert [column.unit for column in made.columns] == ["kN m", "kN m", "rpm"]
    assert (made.columns[0].short, made.short) == ("kN m", "in kN m")
    assert made.rows[0][:2] == ("1.2000", "2000.0")
    assert table("Torque [~N m] | Limit [~N m]", [(1200.0, 200.0)]).columns[0].unit == "N m"


def test_columns_of_records_are_declared_quantities_in_a_unit_that_they_have() -> None:
    mesh = Mesh(math.pi, 2.5)
    assert table("speed: Speed [rpm] | torque:", [mesh]).rows == (("30.000", "2.5000"),)
    assert table("speed: Speed [rpm]", [(mesh, mesh)]).columns[0].unit == "rpm"
    with pytest.raises(ValueError, match="declares no 'power'"):
        table("power: Power", [mesh])
    with pytest.raises(ValueError, match="declared in rad/s"):
        table("speed: Speed [deg]", [mesh])


@reported
class Mesh:
    """A result of two quantities."""

    speed: float = result("rad/s", (), "speed")
    torque: float = result("N*m", (), "torque")
