"""The page in a real browser: cursor, key, keyboard, print. Skipped where playwright or Chromium is not installed."""

import contextlib
import shutil
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import torsion
from torsion.commands import solved
from torsion.output.document import document
from torsion.output.figures.figure import Figure
from torsion.output.html import html

playwright = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install .[browser]")
CHROMIUM = shutil.which("chromium") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on the path")
SCENE = Path(torsion.__file__).parents[2] / "shafting_specs" / "usv.yaml"


@pytest.fixture(scope="module")
def made() -> tuple[str, dict[str, Figure]]:
    """The page and its figures."""
    whole = document(solved(SCENE))
    return html(whole), {item.block.name: item.block for item in whole.body if isinstance(item.block, Figure)}


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as running:
        opened = running.chromium.launch(executable_path=CHROMIUM, args=["--no-sandbox"])
        yield opened
        opened.close()


@pytest.fixture
def page(browser: Any, made: Any, tmp_path: Path) -> Iterator[Any]:
    """The page opened from a file; no error, and no request but its own."""
    file = tmp_path / "report.html"
    file.write_text(made[0], encoding="utf-8")
    opened, messages, requests = browser.new_page(viewport={"width": 900, "height": 900}), [], []
    opened.on("console", lambda message: messages.append(message.text))
    opened.on("pageerror", lambda error: messages.append(str(error)))
    opened.on("request", lambda request: requests.append(request.url))
    opened.goto(file.as_uri())
    yield opened
    assert messages == []
    assert requests == [file.as_uri()]
    opened.close()


def values(page: Any, name: str) -> str:
    """What the cursor says below a figure."""
    return page.locator(f"figure#{name} .values").inner_text()


def hover(page: Any, name: str, share: float) -> None:
    """The pointer at a share of the width of the first plot."""
    area = page.locator(f"figure#{name} rect.area").first
    area.scroll_into_view_if_needed()
    box = area.bounding_box()
    page.mouse.move(box["x"] + share * box["width"], box["y"] + box["height"] / 2)


def said(text: str) -> tuple[float, dict[str, float]]:
    """Coordinate, and values by the name of their line."""
    head, _, rest = text.partition(": ")
    found = {}
    for word in rest.split(", "):
        *name, value, unit, last = word.split(" ")
        found[" ".join(name)] = float(value.replace("−", "-"))
        assert (unit, last) == ("N", "m")
    return float(head.removesuffix(" rpm")), found


@pytest.mark.parametrize("share", [0.01, 0.3, 0.62, 0.99])
def test_the_cursor_says_the_values_of_every_line_at_a_speed_that_was_solved(
    page: Any, made: Any, share: float
) -> None:
    lines = made[1]["torque-1-0"].lines
    hover(page, "torque-1-0", share)
    speed, found = said(values(page, "torque-1-0"))
    assert set(found) == set(lines)
    x = next(iter(lines.values())).x
    at = int(np.argmin(np.abs(x - speed)))
    assert speed == pytest.approx(x[at], rel=1e-4)
    assert abs(x[at] - (x[0] + share * np.ptp(x))) <= np.diff(x).max()
    for name, value in found.items():
        assert value == pytest.approx(lines[name].y[at], rel=1e-4)


def test_one_cursor_stands_in_all_plots_over_the_speed_and_goes_with_the_pointer(page: Any) -> None:
    hover(page, "torque-1-0", 0.4)
    speed = values(page, "torque-1-0").partition(":")[0]
    for other in ("torque-6-50", "stress-2", "steady", "campbell"):
        assert values(page, other).partition(":")[0] == speed
    assert values(page, "joint-motion-1") == ""
    page.mouse.move(2, 2)
    assert values(page, "torque-1-0") == values(page, "campbell") == ""


def test_the_campbell_diagram_says_the_frequencies_of_the_orders(page: Any) -> None:
    hover(page, "campbell", 0.5)
    head, _, rest = values(page, "campbell").partition(": ")
    speed = float(head.removesuffix(" rpm"))
    for word in rest.split(", "):
        _, order, hertz, unit = word.split(" ")
        assert float(hertz) == pytest.approx(float(order) * speed / 60.0, rel=1e-4)
        assert unit == "Hz"


def test_arrows_step_from_speed_to_speed_and_escape_ends_it(page: Any, made: Any) -> None:
    x = made[1]["torque-1-0"].lines["order 4"].x
    area = page.locator("figure#torque-1-0 rect.area").first
    area.focus()
    for key, place in (
        ("ArrowRight", 0),
        ("ArrowRight", 1),
        ("PageDown", 0),
        ("End", -1),
        ("ArrowLeft", -2),
        ("Home", 0),
    ):
        page.keyboard.press(key)
        assert said(values(page, "torque-1-0"))[0] == pytest.approx(x[place], rel=1e-4), key
        assert area.get_attribute("aria-valuetext") == values(page, "torque-1-0")
    page.keyboard.press("Escape")
    assert values(page, "torque-1-0") == ""


def test_the_key_switches_lines_off_and_on_by_pointer_and_keyboard(page: Any) -> None:
    entry = page.locator("figure#torque-1-0 [role=checkbox][aria-label='order 4']")
    line = page.locator("figure#torque-1-0 g.line[data-name='order 4']")
    for use in (entry.click, lambda: (entry.focus(), page.keyboard.press(" "))):
        use()
        assert entry.get_attribute("aria-checked") == "false"
        assert not line.is_visible()
        hover(page, "torque-1-0", 0.5)
        assert "order 4" not in values(page, "torque-1-0")
        assert "order 4" in values(page, "torque-6-50")
        use()
        assert entry.get_attribute("aria-checked") == "true"
        assert line.is_visible()


def numbers(page: Any, name: str) -> list[float]:
    """What stands below the plots of a figure, as it is seen."""
    found = page.locator(f"figure#{name} text.across, figure#{name} .scale text").all()
    return [float(one.text_content()) for one in found if one.is_visible()]


def shape(page: Any, name: str) -> list[str]:
    """All paths and windows of a figure, but the cursor."""
    script = """s => [...s.querySelectorAll('path:not(.cursor), svg')]
        .map(e => e.getAttribute('d') || e.getAttribute('viewBox'))"""
    return page.locator(f"figure#{name} > svg").evaluate(script)


def drag(page: Any, name: str, first: float, last: float) -> None:
    """Choose a part of the width of the first plot."""
    hover(page, name, first)
    page.mouse.down()
    hover(page, name, (first + last) / 2)
    hover(page, name, last)
    page.mouse.up()


def test_a_part_is_chosen_in_all_plots_over_the_speed_and_a_double_click_shows_the_whole(page: Any, made: Any) -> None:
    before = {name: (numbers(page, name), shape(page, name)) for name in ("torque-1-0", "stress-2", "campbell")}
    drag(page, "torque-1-0", 0.2, 0.4)  # of 300 to 1800 rpm
    for name in before:
        seen = numbers(page, name)
        assert min(seen) >= 599.0
        assert max(seen) <= 901.0
        assert len(seen) > 3
        assert np.allclose(np.diff(seen), seen[1] - seen[0])
    hover(page, "torque-1-0", 0.5)
    speed, found = said(values(page, "torque-1-0"))
    assert speed == pytest.approx(750.0, abs=10.0)
    lines = made[1]["torque-1-0"].lines
    at = int(np.argmin(np.abs(lines["order 2"].x - speed)))
    assert found["order 2"] == pytest.approx(lines["order 2"].y[at], rel=1e-4)
    page.locator("figure#torque-1-0 > svg").dblclick(position={"x": 300, "y": 60})
    page.mouse.move(2, 2)
    for name, (seen, drawn) in before.items():
        assert numbers(page, name) == seen
        assert shape(page, name) == drawn


def test_plus_minus_and_nought_zoom_by_the_keyboard(page: Any) -> None:
    whole = numbers(page, "torque-1-0")
    page.locator("figure#torque-1-0 rect.area").focus()
    page.keyboard.press("+")
    once = numbers(page, "torque-1-0")
    assert once[-1] - once[0] < 0.6 * (whole[-1] - whole[0])
    page.keyboard.press("+")
    page.keyboard.press("-")
    assert numbers(page, "torque-1-0") == once
    page.keyboard.press("0")
    assert numbers(page, "torque-1-0") == whole


def test_critical_speeds_stay_on_their_lines_when_a_part_is_shown(page: Any) -> None:
    """Order 2 meets mode 1 at 663.21 rpm; of 302.4 to 907.2 rpm that is at 0.5966."""
    drag(page, "campbell", 0.15, 0.45)
    title = page.locator("figure#campbell .front g:has(> title)", has_text="order 2 meets mode 1")
    mark, area = title.locator("path").bounding_box(), page.locator("figure#campbell rect.area").bounding_box()
    share = (mark["x"] + mark["width"] / 2 - area["x"]) / area["width"]
    assert share == pytest.approx((663.21 - 302.4) / (907.2 - 302.4), abs=0.01)


def test_without_scripts_and_in_print_there_is_the_static_figure(browser: Any, page: Any, made: Any) -> None:
    bare = browser.new_context(java_script_enabled=False).new_page()
    bare.set_content(made[0])
    assert bare.locator("figure svg[role=img]").count() == len(made[1])
    assert bare.locator("rect.area").count() == 0
    drag(page, "torque-1-0", 0.2, 0.4)
    hover(page, "torque-1-0", 0.5)
    page.locator("figure#torque-1-0 [role=checkbox][aria-label='order 4']").click()
    page.emulate_media(media="print")
    assert not page.locator("figure#torque-1-0 .values").is_visible()
    assert not page.locator("figure#torque-1-0 .cursor").first.is_visible()
    assert page.locator("figure#torque-1-0 g.line[data-name='order 4']").is_visible()
    printed, plain = page.pdf(), bare.pdf()
    assert numbers(page, "torque-1-0")[-1] == 1800.0  # the whole is printed
    assert abs(strokes(printed) - strokes(plain)) <= 0.01 * strokes(plain)


def strokes(pdf: bytes) -> int:
    """Lines that are drawn on all pages."""
    found, place = 0, 0
    while (start := pdf.find(b"stream", place)) >= 0:
        place = pdf.find(b"endstream", start)
        with contextlib.suppress(zlib.error):
            found += zlib.decompress(pdf[start + 6 : place].strip(b"\r\n")).count(b"\nS\n")
        place += 9
    return found
