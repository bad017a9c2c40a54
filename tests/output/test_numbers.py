"""Numbers as an engineer reads them."""

import cmath
import math
from fractions import Fraction

import numpy as np
import pytest
from tests.for_all import for_all

from torsion.kernels.trees.tree_response import Status
from torsion.output import numbers
from torsion.output.blocks import table
from torsion.output.reported_values import band_words


@for_all(
    ("value", "text"),
    [
        (0.0, "0"),
        (1.0, "1.0000"),
        (123456.7, "123460"),
        (0.00012345678, "0.00012346"),
        (0.000012345678, "1.2346·10⁻⁵"),
        (12345678.0, "1.2346·10⁷"),
        (-2.5, "−2.5000"),
        (99999.6, "100000"),
        (math.inf, "∞"),
        (math.nan, "–"),
        (None, "–"),
        (-math.inf, "−∞"),
        (0.5, "0.50000"),
        (-0.00012345678, "−0.00012346"),
    ],
)
def test_five_significant_digits(value: float | None, text: str) -> None:
    assert numbers.number(value) == text


@for_all(
    ("value", "digits", "text"),
    [
        (123456.7, 2, "120000"),
        (999999.0, 6, "999999"),
        (1234567.0, 2, "1.2·10⁶"),
        (123456789.0, 8, "123456790"),
        (1234567890.0, 8, "1.2345679·10⁹"),
        (0.00012345, 2, "0.00012"),
        (0.000012345, 2, "1.2·10⁻⁵"),
        (7.0, 1, "7"),
    ],
)
def test_a_number_is_written_out_up_to_six_digits_or_one_more_than_are_significant(
    value, digits, text
) -> None:
    assert numbers.number(value, digits) == text


def test_a_speed_in_rad_per_second_reads_in_revolutions_per_minute() -> None:
    speed = 1234.56789 * math.pi / 30.0
    assert (numbers.rpm(speed), numbers.rpm(speed, 7), numbers.rpm(None)) == (
        "1234.6",
        "1234.568",
        "–",
    )
    assert [numbers.given_rpm(one * math.pi / 30.0) for one in (1234.56789, 1500.0)] == [
        "1234.57",
        "1500",
    ]


def test_an_angle_in_radians_reads_in_degrees() -> None:
    assert [numbers.degrees(math.radians(one), 4) for one in (40.0, -12.3456)] == ["40", "−12.35"]


@for_all(
    ("value", "text"),
    [
        (300.0, "300"),
        (2.5, "2.5"),
        (1e-9, "1·10⁻⁹"),
        (1.25e-9, "1.25·10⁻⁹"),
        (0.0, "0"),
        (100.0, "100"),
    ],
)
def test_a_given_figure_has_no_zeros_that_nobody_wrote(value: float, text: str) -> None:
    assert numbers.given(value) == text


@for_all(
    ("order", "text"),
    [(Fraction(2), "2"), (Fraction(1, 2), "0.5"), (Fraction(40, 21), "40/21 ≈ 1.9048")],
)
def test_an_order_is_exact_and_readable(order: Fraction, text: str) -> None:
    assert numbers.order(order) == text


@for_all(
    ("values", "unit"),
    [
        ([12.0], "N m"),
        ([999.0, 1000.0], "kN m"),
        ([3e6, math.inf], "MN m"),
        ([], "N m"),
        ([2.0, -1e6], "MN m"),
    ],
)
def test_one_prefix_suits_the_largest_value(values: list[float], unit: str) -> None:
    assert numbers.scale("N m", values).unit == unit


def test_a_prefix_does_not_change_the_value() -> None:
    assert 25e3 * numbers.scale("N m", [25e3]).factor == pytest.approx(25.0, rel=1e-15)
    assert 1.5e6 * numbers.scale("N m", [2e6]).factor == pytest.approx(1.5, rel=1e-15)
    assert numbers.scale("N m", [3.0]).factor == 1.0


def test_a_barred_range_is_rounded_outward() -> None:
    assert band_words((298.46, 368.41)) == "298.4 to 368.5 rpm"


def test_a_range_that_ends_at_a_round_speed_is_not_rounded_by_the_conversion_of_units() -> None:
    for speed in (300.0, 780.0, 900.0, 1234.5):
        there = speed * math.pi / 30.0 * numbers.RPM
        for near in (there, math.nextafter(there, 0.0), math.nextafter(there, 2.0 * there)):
            assert band_words((near, near)) == f"{speed} to {speed} rpm"


def test_a_count_has_its_noun_in_the_right_number() -> None:
    assert [numbers.counted(n, "line") for n in (0, 1, 2)] == ["0 lines", "1 line", "2 lines"]


@for_all(
    ("value", "text"),
    [
        ("screw", "screw"),
        (2, "2"),
        (np.int64(3), "3"),
        (2.5, "2.5000"),
        (np.float64(2.5), "2.5000"),
        (math.nan, "–"),
        (None, "–"),
        (Fraction(1, 2), "1/2"),
        (True, "yes"),
        (np.bool_(False), "no"),
        (3.0 * cmath.exp(1j * math.radians(40.0)), "3.0000 ∠ 40°"),
        (1 - 2j, "2.2361 ∠ −63.43°"),
        (Status.NEAR_SINGULAR, "near singular"),
    ],
)
def test_a_cell_shows_a_value_by_its_type(value: object, text: str) -> None:
    assert numbers.cell(value) == text


def test_a_table_shows_values_and_refuses_a_row_of_another_length() -> None:
    made = table(
        "< Mode -> | Frequency [Hz]", [("first", 12.5), ("second", None)], marks=["pass", ""]
    )
    assert made.rows == (("first", "12.500"), ("second", "–"))
    assert (made.columns[1].unit, made.marks) == ("Hz", ("pass", ""))
    with pytest.raises(ValueError, match="2 cells"):
        table("Mode | Frequency", [(1, 2.5, 3)])
