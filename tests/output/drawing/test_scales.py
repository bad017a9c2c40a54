"""Numbers on axes: steps 1, 2 and 5, as many as there is room for, from end to end of the data."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from torsion.output.drawing.frame import (
    GROWTH,
    degree_step,
    horizontal,
    log_ticks,
    scale,
    step_of,
    texts,
    ticks_of,
    vertical,
)
from torsion.output.drawing.svg import svg
from torsion.output.drawing.words import width
from torsion.output.figures.figure import Axis, Figure, Level, Line, Panel

SIZES = st.floats(-12.0, 12.0).map(lambda power: 10.0**power)
MOST = st.integers(3, 12)


def read(text: str) -> float:
    """A number as it is written on an axis."""
    if text.endswith(" %"):
        return float(text[:-2]) / 100.0
    plain = text.replace("−", "-").translate(str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789"))
    if not set(text) & set("⁻⁰¹²³⁴⁵⁶⁷⁸⁹"):
        return float(plain)
    mantissa, _, power = plain.partition("·10") if "·" in plain else ("1", "", plain[2:])
    return float(mantissa) * 10.0 ** int(power)


@given(low=st.floats(-1.0, 1.0), span=st.floats(0.01, 2.0), size=SIZES, most=MOST)
def test_numbers_cover_the_data_in_steps_of_one_two_and_five(
    low: float, span: float, size: float, most: int
) -> None:
    data = np.array([low, low + span]) * size
    found = scale(Axis("x"), [data], most)
    at = np.array([place for place, _ in found.ticks])
    assert found.low <= data[0] + 1e-9 * size
    assert found.high >= data[1] - 1e-9 * size
    assert 1 <= at.size <= most + 2
    step = step_of(float(np.ptp(data)), most)
    assert np.allclose(np.diff(at), step, rtol=1e-6)
    assert round(step / 10.0 ** math.floor(math.log10(step) + 1e-9)) in (1, 2, 5, 10)
    assert at[0] - step < found.low + 1e-6 * step
    assert at[-1] + step > found.high - 1e-6 * step
    assert (at[0], at[-1]) >= (found.low - 1e-6 * step, found.low)
    for place, text in found.ticks:
        assert read(text) == pytest.approx(place, rel=1e-9, abs=1e-9 * step)
    assert len({text for _, text in found.ticks}) == at.size


@given(low=st.floats(-9.0, 6.0), decades=st.floats(0.05, 12.0), most=MOST)
def test_numbers_of_a_logarithmic_axis_are_few_and_lie_within_it(
    low: float, decades: float, most: int
) -> None:
    ends = 10.0**low, 10.0 ** (low + decades)
    found = scale(Axis("x", low=ends[0], high=ends[1], is_log=True), [], most)
    at = [place for place, _ in found.ticks]
    assert 1 <= len(at) <= max(most, 4)
    assert min(at) >= ends[0] * (1 - 1e-6)
    assert max(at) <= ends[1] * (1 + 1e-6)
    assert (np.diff(at) > 0).all()
    for place, text in found.ticks:
        assert read(text) == pytest.approx(place, rel=1e-3)
    assert not set(found.small) & set(at)
    np.testing.assert_allclose(found.share(np.array(ends)), [0.0, 1.0], atol=1e-12)
    assert np.isnan(found.share(0.0))


def test_a_few_decades_have_their_twos_and_fives() -> None:
    assert log_ticks(1.0, 100.0, 8)[0] == [1, 2, 5, 10, 20, 50, 100]
    assert log_ticks(1e-9, 1e-3, 4)[0] == pytest.approx([1e-8, 1e-6, 1e-4])


@pytest.mark.parametrize(
    ("values", "step", "written"),
    [
        ([0.0, 0.05, 0.1], 0.05, ["0", "0.05", "0.1"]),
        ([-200.0, 0.0], 200.0, ["−200", "0"]),
        ([0.0, 2e6, 1.2e7], 2e6, ["0", "0.2·10⁷", "1.2·10⁷"]),
        ([1490.0, 1495.0], 5.0, ["1490", "1495"]),
        ([0.0, 5e-6], 5e-6, ["0", "5·10⁻⁶"]),
    ],
)
def test_numbers_have_the_decimals_of_their_step(values: list, step: float, written: list) -> None:
    assert texts(values, step) == written


def test_errors_above_a_hundredth_of_a_per_cent_are_in_per_cent() -> None:
    found = scale(Axis("error", low=1e-7, high=2.0, is_log=True, is_error=True), [], 9)
    assert [text for _, text in found.ticks] == [
        "10⁻⁷",
        "10⁻⁶",
        "10⁻⁵",
        "0.01 %",
        "0.1 %",
        "1 %",
        "10 %",
        "100 %",
    ]


def test_errors_beyond_the_whole_stand_in_powers_of_ten() -> None:
    found = scale(Axis("error", low=1e-16, high=2e3, is_log=True, is_error=True), [], 8)
    assert [text for _, text in found.ticks] == [
        "10⁻¹⁵",
        "10⁻¹²",
        "10⁻⁹",
        "10⁻⁶",
        "10⁻³",
        "1",
        "10³",
    ]


def test_a_revolution_is_marked_in_whole_steps_and_so_are_many() -> None:
    assert degree_step(360.0, 12) == 30.0
    assert degree_step(360.0, 9) == 45.0
    assert ticks_of(0.0, 7200.0, degree_step(7200.0, 9))[:3] == [0.0, 1800.0, 3600.0]


def test_values_that_do_not_vary_and_no_values_have_an_axis() -> None:
    for data in ([np.full(3, 5.0)], [np.zeros(2)], [np.full(2, np.nan)], []):
        found = scale(Axis("x"), data, 5)
        assert found.high > found.low
        assert found.ticks
    pinned = scale(Axis("x", low=0.0), [np.zeros(3)], 5)
    assert pinned.low == 0.0 < pinned.high


def test_modes_have_whole_numbers() -> None:
    found = scale(Axis("mode", low=0.5, high=3.5, is_whole=True), [], 9)
    assert [text for _, text in found.ticks] == ["1", "2", "3"]


def test_an_axis_goes_as_far_as_the_levels_on_it_that_it_must_reach() -> None:
    line, limit = (
        Line("a", np.array([0.0, 8.0]), np.array([0.0, 2.0])),
        Level("limit", 100.0, is_reached=True),
    )
    panel = Panel(Axis("x"), Axis("y"), (line,), (limit, replace(limit, axis="x", value=40.0)))
    assert (horizontal(panel, 600.0).high, vertical(panel).high) == (40.0, 100.0)
    aside = replace(panel, levels=(replace(limit, axis="x", is_reached=False),))
    assert (horizontal(aside, 600.0).high, vertical(aside).high) == (8.0, 2.0)


def test_symbols_at_the_ends_of_a_line_have_room() -> None:
    line = Line("a", np.array([10.0, 20.0]), np.array([0.0, 2.0]), symbol="ring")
    found = horizontal(Panel(Axis("x"), Axis("y"), (line,)), 600.0)
    assert (20.0 - 10.0) / (found.high - found.low) * 600.0 <= 600.0 - 2 * 6.5
    assert horizontal(Panel(Axis("x", low=10.0), Axis("y"), (line,)), 600.0).low == 10.0


def test_slanted_names_begin_within_the_figure() -> None:
    names = tuple((float(k), f"a name that is long and needs much room {k}") for k in range(8))
    line = Line("a", np.arange(8.0), np.arange(8.0))
    text = svg(Figure("a", "", (Panel(Axis("x", places=names), Axis("y"), (line,)),)))
    first = re.search(r'<text x="([\d.]+)"[^>]*rotate\(-30[^>]*>([^<]*)<', text)
    assert first is not None
    assert float(first[1]) - math.cos(math.pi / 6) * GROWTH * width(first[2]) >= 0.0
