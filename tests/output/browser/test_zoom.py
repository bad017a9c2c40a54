"""A part of an axis is shown in all plots over it: by mouse, wheel, keyboard and fingers; and the whole again."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from tests.output.browser.opened import Opened, until

FULL = (300.0, 1800.0)


@pytest.fixture
def phone(opens: Callable[..., Opened]) -> Opened:
    """A narrow screen that is touched."""
    return opens("usv", viewport={"width": 420, "height": 800}, has_touch=True, is_mobile=True)


def range_of(page: Opened, name: str = "torque-1-0") -> tuple[float, float]:
    """The first and the last value that is shown."""
    found = []
    for key in ("Home", "End"):
        page.press(name, key)
        found.append(page.read(name)[0])
    return found[0], found[1]


def width(page: Opened, name: str = "torque-1-0") -> float:
    """Share of the axis that is shown."""
    view = page.page.locator(f"figure#{name} svg.plot").last.get_attribute("viewBox").split(" ")
    whole = page.page.locator(f"figure#{name} svg.plot").last.evaluate(
        "one => one.original || null"
    )
    return float(view[2]) / float((whole or [0, 0, float(view[2])])[2])


def test_a_part_is_chosen_in_all_plots_over_the_speed_and_a_double_click_shows_the_whole(
    usv: Opened,
) -> None:
    before = {
        name: (usv.numbers(name), usv.shape(name))
        for name in ("torque-1-0", "stress-2", "campbell")
    }
    usv.drag("torque-1-0", 0.2, 0.4)  # of 300 to 1800 rpm
    for name in before:
        seen = usv.numbers(name)
        assert min(seen) >= 599.0
        assert max(seen) <= 901.0
        assert len(seen) > 3
        assert np.allclose(np.diff(seen), seen[1] - seen[0])
    usv.hover("torque-1-0", 0.5)
    speed, found = usv.read("torque-1-0")
    assert speed == pytest.approx(750.0, abs=10.0)
    lines = usv.report.figures["torque-1-0"].lines
    at = int(np.argmin(np.abs(lines["order 2"].x - speed)))
    assert found["order 2"] == pytest.approx(lines["order 2"].y[at], rel=1e-4)
    usv.page.locator("figure#torque-1-0 > svg").dblclick(position={"x": 300, "y": 60})
    usv.page.mouse.move(2, 2)
    for name, (seen, drawn) in before.items():
        assert usv.numbers(name) == seen
        assert usv.shape(name) == drawn


def test_plus_minus_brackets_and_nought_zoom_by_the_keyboard(usv: Opened) -> None:
    whole = usv.numbers("torque-1-0")
    usv.press("torque-1-0", "+")
    once = usv.numbers("torque-1-0")
    assert once[-1] - once[0] < 0.6 * (whole[-1] - whole[0])
    usv.press("torque-1-0", "+", "-")
    assert usv.numbers("torque-1-0") == once
    usv.press("torque-1-0", "]")
    assert usv.numbers("torque-1-0")[0] > once[0]
    usv.press("torque-1-0", "[")
    assert usv.numbers("torque-1-0") == once
    usv.press("torque-1-0", "0")
    assert usv.numbers("torque-1-0") == whole
    usv.press("torque-1-0", "+", "+", "Escape")
    assert usv.numbers("torque-1-0") == whole


def test_what_is_shown_goes_with_a_cursor_that_leaves_it(usv: Opened) -> None:
    usv.drag("torque-1-0", 0.2, 0.4)
    usv.press("torque-1-0", "End")
    assert usv.numbers("torque-1-0")[-1] == FULL[1]
    assert (
        usv.page.locator("figure#torque-1-0 path.cursor").get_attribute("visibility") == "visible"
    )
    assert width(usv) == pytest.approx(0.2, abs=0.01)


def test_the_wheel_zooms_with_control_or_focus_and_else_scrolls_the_page(usv: Opened) -> None:
    usv.hover("torque-1-0", 0.25)
    usv.page.mouse.wheel(0, -200)
    usv.page.wait_for_timeout(150)
    assert width(usv) == 1.0
    usv.hover("torque-1-0", 0.25)
    before = usv.page.evaluate("scrollY")
    usv.page.keyboard.down("Control")
    usv.page.mouse.wheel(0, -300)
    usv.page.keyboard.up("Control")
    until(usv.page, "document.querySelector('figure#torque-1-0 .scale').children.length > 0")
    assert 0.3 < width(usv) < 0.9
    speed = usv.read("torque-1-0")[0]
    assert speed == pytest.approx(
        0.75 * FULL[0] + 0.25 * FULL[1], abs=10.0
    )  # stays under the pointer
    usv.area("torque-1-0").focus()
    usv.page.mouse.wheel(0, 900)
    until(usv.page, "document.querySelector('figure#torque-1-0 .scale').children.length === 0")
    assert width(usv) == 1.0
    assert usv.page.evaluate("scrollY") == before


def test_critical_speeds_stay_on_their_lines_when_a_part_is_shown(usv: Opened) -> None:
    """Order 2 excites mode 1 at 663.21 rpm; of 302.4 to 907.2 rpm that is at 0.5966."""
    usv.drag("campbell", 0.15, 0.45)
    point = usv.page.locator("figure#campbell .point", has_text="order 2 excites mode 1")
    mark, area = point.locator("path").bounding_box(), usv.area("campbell").bounding_box()
    across = (mark["x"] + mark["width"] / 2 - area["x"]) / area["width"]
    assert across == pytest.approx((663.21 - 302.4) / (907.2 - 302.4), abs=0.01)


def fingers(page: Opened, *paths: tuple[tuple[float, float], tuple[float, float]]) -> None:
    """Fingers that go from places to places on the screen."""
    session = page.page.context.new_cdp_session(page.page)

    def points(at: float) -> Iterator[dict[str, Any]]:
        for number, ((x0, y0), (x1, y1)) in enumerate(paths):
            yield {"x": x0 + at * (x1 - x0), "y": y0 + at * (y1 - y0), "id": number}

    session.send(
        "Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": list(points(0.0))}
    )
    for at in (0.25, 0.5, 0.75, 1.0):
        session.send(
            "Input.dispatchTouchEvent", {"type": "touchMove", "touchPoints": list(points(at))}
        )
    session.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})


def test_a_tap_sets_the_cursor_two_fingers_zoom_and_one_drags_what_is_zoomed(phone: Opened) -> None:
    x = phone.report.figures["torque-1-0"].lines["order 4"].x
    phone.page.touchscreen.tap(*phone.spot("torque-1-0", 0.5))
    assert phone.read("torque-1-0")[0] == pytest.approx(1050.0, abs=np.diff(x).max())
    at = [phone.spot("torque-1-0", across) for across in (0.1, 0.4, 0.6, 0.9)]
    fingers(phone, (at[1], at[0]), (at[2], at[3]))
    assert width(phone) == pytest.approx(0.25, abs=0.02)  # 0.4 to 0.6 lie where 0.1 to 0.9 were
    seen = phone.numbers("torque-1-0")
    assert 860.0 < seen[0] < seen[-1] < 1240.0
    fingers(phone, (at[2], at[1]))
    moved = phone.numbers("torque-1-0")
    assert moved[-1] > seen[-1]
    assert width(phone) == pytest.approx(0.25, abs=0.02)
    fingers(phone, (at[0], at[1]), (at[3], at[2]))
    fingers(phone, (at[0], at[1]), (at[3], at[2]))
    assert width(phone) == 1.0


def test_a_finger_up_and_down_scrolls_the_page(phone: Opened) -> None:
    x, y = phone.spot("torque-1-0", 0.5)
    before = phone.page.evaluate("scrollY")
    fingers(phone, ((x, y), (x, y - 150.0)))
    until(phone.page, f"scrollY > {before + 50}")
    assert width(phone) == 1.0
