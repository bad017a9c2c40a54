"""The speeds of the first page under the cursor: the ranges that one lies in, and the nearest critical speed."""

import math
from collections.abc import Callable

import pytest
from tests.output.browser.opened import Opened, number
from tests.output.browser.test_cursor import CRITICAL, RPM, criticals, digits

from torsion.output.figures.figure import Panel

NAME = "speeds"


def plot(page: Opened) -> Panel:
    return page.report.figures[NAME].plots[0]


def across(page: Opened, speed: float) -> float:
    """Share of the axis at a speed, rpm."""
    low, high = plot(page).x.low, plot(page).x.high
    assert low is not None
    assert high is not None
    return (speed - low) / (high - low)


def read(page: Opened) -> tuple[float, set[str]]:
    """Speed, rpm, and what it lies in."""
    head, _, rest = page.values(NAME).partition(" rpm: ")
    return number(head), set(rest.split(", "))


@pytest.mark.parametrize("scene", ["six_stations", "usv"])
def test_the_cursor_names_the_ranges_that_a_speed_lies_in(
    opens: Callable[..., Opened], scene: str
) -> None:
    page, free = opens(scene), {"in none of the ranges"}
    bands = plot(page).bands
    inside = [(one.low + one.high) / 2 for one in bands]
    beside = [end + way * 6.0 for one in bands for end, way in ((one.low, -1.0), (one.high, 1.0))]
    for wanted in (*inside, *beside):
        if not 0.0 < across(page, wanted) < 1.0:
            continue
        page.hover(NAME, across(page, wanted))
        speed, found = read(page)
        assert speed == pytest.approx(wanted, abs=0.5)
        assert found == (
            {one.label or one.name for one in bands if one.low <= speed <= one.high} or free
        )
    page.page.mouse.move(2, 2)
    assert page.values(NAME) == page.near(NAME) == ""


def test_the_unstable_range_of_the_results_is_read_there(opens: Callable[..., Opened]) -> None:
    page = opens("six_stations")
    (unstable,) = [one for one in plot(page).bands if one.kind == "unstable"]
    page.hover(NAME, across(page, (unstable.low + unstable.high) / 2))
    assert read(page)[1] == {
        "speeds of the operation",
        f"unstable {math.floor(10 * unstable.low) / 10:.1f} to {math.ceil(10 * unstable.high) / 10:.1f}",
    }


def test_the_nearest_critical_speed_is_named_as_in_the_diagram(usv: Opened) -> None:
    every = [
        digits(one["speed_rad_per_s"] * RPM) for one in criticals(usv.report) if one["is_in_range"]
    ]
    for share in (0.1, 0.5, 0.9):
        usv.hover(NAME, share)
        match = CRITICAL.search(usv.near(NAME))
        assert match is not None
        speed = read(usv)[0]
        assert abs(number(match[1]) - speed) <= min(abs(one - speed) for one in every)
        assert usv.near(NAME) == usv.near("campbell")
        assert usv.values("campbell").startswith(f"{usv.values(NAME).partition(':')[0]}:")


def test_p_goes_from_critical_speed_to_critical_speed_and_round_again(usv: Opened) -> None:
    every = sorted(one["speed_rad_per_s"] * RPM for one in criticals(usv.report))
    wanted = [digits(one) for one in every if 0.0 <= across(usv, one) <= 1.0]
    assert wanted
    for speed in (*wanted, wanted[0]):
        usv.press(NAME, "p")
        assert read(usv)[0] == speed
        assert usv.near(NAME).endswith("at it")
