"""Blocks and their numbers."""

import dataclasses
import importlib
import math
import pkgutil
from fractions import Fraction

import numpy as np
import pytest

from torsion import output
from torsion.arrays import FloatArray
from torsion.output import table_text
from torsion.output.blocks import (
    Column,
    Figure,
    Heading,
    Paragraph,
    Table,
    head,
    table,
)
from torsion.output.document import numbered
from torsion.output.records import along
from torsion.output.stored.scene import NO_VALUE
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


def test_what_a_report_is_made_of_cannot_be_changed() -> None:
    """A block that one renderer changed would differ in the next."""
    names = [module.name for module in pkgutil.walk_packages(output.__path__, "torsion.output.")]
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
    assert table_text.figures(made)[1] == ["b", "", "inf", "", "", "0.0"]


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


def test_records_stand_before_the_values_of_columns_that_name_no_quantity() -> None:
    mesh, wheel = Mesh(math.pi, 2.5), Wheel("w", np.array([0.1, 0.2]))
    made = table("torque: | < Remark | speed: Speed [rpm]", [(mesh, "none")])
    assert made.rows == (("2.5000", "none", "30.000"),)
    inner = table("name: < Wheel | speed: Speed [rpm] | Teeth", [(wheel, mesh, 21)])
    assert inner.rows == (("w", "30.000", "21"),)
    with pytest.raises(ValueError, match="has not 1 values beside"):
        table("torque: | < Remark", [mesh])


def test_a_row_can_be_a_place_of_the_arrays_of_a_result() -> None:
    wheel = Wheel("w", np.array([0.1, 0.2]))
    made = table("name: < Wheel | mode: Mode | share: Share [%]:3", along(wheel, "mode"))
    assert made.rows == (("w", "1", "10.0"), ("w", "2", "20.0"))
    assert table("mode: Mode", along(wheel, "mode", [1])).rows == (("2",),)


def test_an_axis_that_is_called_like_a_quantity_shows_the_quantity() -> None:
    curve = Curve(np.array([math.pi, 2.0 * math.pi]), np.array([[1.0, 2.0], [3.0, 4.0]]))
    titles = "speed: Speed [rpm]:3 | torque@2: Torque:2"
    made = table(titles, along(curve, "speed"))
    assert made.rows == (("30.0", "2.0"), ("60.0", "4.0"))
    assert table(titles, along(curve, "speed", [1])).rows == (("60.0", "4.0"),)


def test_complex_values_have_an_amplitude_and_a_phase_unless_they_may_be_rounding() -> None:
    made = table("Amplitude:3s | Phase [deg]:gp", [(-2.0 + 0j,) * 2, (1e-15j,) * 2])
    assert made.rows == (("2.00", "180"), ("0", "–"))


def test_a_column_without_values_is_left_out_and_no_value_is_said_in_words() -> None:
    made = table("< Shaft | Limit:? | Stress:u", [("a", None, 1.0), ("b", None, None)])
    assert made.rows == (("a", "1.0000"), ("b", NO_VALUE))


@reported
class Wheel:
    """A result over an axis."""

    name: str = result("", (), "name")
    share: FloatArray = result("1", ("mode",), "share of each mode")


@reported
class Mesh:
    """A result of two quantities."""

    speed: float = result("rad/s", (), "speed")
    torque: float = result("N*m", (), "torque")


@reported
class Curve:
    """A result over an axis that is called like one of its quantities."""

    speed: FloatArray = result("rad/s", ("speed",), "speeds")
    torque: FloatArray = result("N*m", ("speed", "mode"), "torque of each mode at each speed")
