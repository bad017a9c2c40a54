"""The cursor reads off what results.json holds, in all plots over the speed at once, by pointer and by keyboard."""

import re
from collections.abc import Callable
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from tests.output.browser.opened import Opened, Report, number

RPM = 60.0 / (2.0 * np.pi)
CRITICAL = re.compile(
    r"critical speed ([\d.]+) rpm: order ([\d./]+)(?: ≈ [\d.]+)? excites mode (\d+) at ([\d.]+) Hz"
    r"(?:, (−?[\d.]+) % from rated)?"
)
WITH_RESPONSE = ("usv", "cardan_bearings")


def digits(value: float) -> float:
    """To the five digits that the page shows."""
    return float(f"{value:.5g}")


def torques(report: Report) -> dict[str, tuple[list[float], float]]:
    """Half ranges over the speed, N m, from results.json, by figure; with the factor to the unit of the figure.

    Of a single order they are its amplitude.
    """
    found, synthesis = {}, report.results["synthesis"]
    for name, figure in report.figures.items():
        words = figure.caption.removeprefix("Vibratory torque in ")
        element = words.rpartition(",")[0] or words
        if name.startswith("torque-") and element in synthesis["element"]:
            factor = {"N m": 1.0, "kN m": 1e-3, "MN m": 1e-6}[figure.plots[0].y.unit]
            found[name] = synthesis["half_range_Nm"][synthesis["element"].index(element)], factor
    return found


def criticals(report: Report) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = report.results["critical_speeds"]
    return found


@pytest.mark.parametrize("scene", WITH_RESPONSE)
def test_the_torque_below_the_pointer_is_that_of_the_results(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    speeds = np.array(page.report.results["response"]["speed_rad_per_s"]) * RPM
    known = torques(page.report)
    assert known
    for name, (half, factor) in list(known.items())[:3]:
        for across in (0.02, 0.37, 0.8):
            page.hover(name, across)
            speed, found = page.read(name)
            at = int(np.argmin(np.abs(speeds - speed)))
            assert speed == digits(speeds[at])
            assert found.get("total vibratory torque", next(iter(found.values()))) == digits(
                half[at] * factor
            )
            assert abs(speeds[at] - (speeds[0] + across * np.ptp(speeds))) <= np.diff(speeds).max()


@pytest.mark.parametrize("across", [0.01, 0.62, 0.99])
def test_every_line_is_read_at_a_speed_that_was_solved(usv: Opened, across: float) -> None:
    lines = usv.report.figures["torque-1-0"].lines
    usv.hover("torque-1-0", across)
    speed, found = usv.read("torque-1-0")
    assert set(found) == set(lines)
    x = next(iter(lines.values())).x
    at = int(np.argmin(np.abs(x - speed)))
    assert found == {name: digits(line.y[at]) for name, line in lines.items()}


def test_one_cursor_stands_in_all_plots_over_the_speed_and_goes_with_the_pointer(
    usv: Opened,
) -> None:
    usv.hover("torque-1-0", 0.4)
    speed = usv.values("torque-1-0").partition(":")[0]
    for other in ("stress-2", "campbell"):
        assert usv.values(other).partition(":")[0] == speed
    assert usv.values("joint-motion-1") == ""
    usv.page.mouse.move(2, 2)
    assert usv.values("torque-1-0") == usv.values("campbell") == usv.near("campbell") == ""


@pytest.mark.parametrize("scene", WITH_RESPONSE)
def test_the_nearest_critical_speed_is_named_with_its_order_mode_and_margin(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    every = criticals(page.report)
    rated = page.report.results["scene"]["rated_speed_rad_per_s"]
    name = next(iter(torques(page.report)))
    for across in (0.1, 0.55, 0.9):
        page.hover(name, across)
        speed, _ = page.read(name)
        match = CRITICAL.search(page.near(name))
        assert match is not None
        at, order, mode, hertz, margin = match.groups()
        (own,) = [
            one
            for one in every
            if Fraction(one["order"]) == Fraction(order) and one["mode"] == int(mode)
        ]
        assert number(at) == digits(own["speed_rad_per_s"] * RPM)
        assert number(hertz) == digits(own["frequency_Hz"])
        if rated:
            assert number(margin) == float(f"{100 * (own['speed_rad_per_s'] / rated - 1):.3g}")
        drawn = [
            x for marks in page.report.figures["campbell"].plots[0].marks for x in marks.x.tolist()
        ]
        assert abs(number(at) - speed) == pytest.approx(
            min(abs(x - speed) for x in drawn), abs=1e-3 * speed
        )
        inside = [one["speed_rad_per_s"] * RPM for one in every if one["is_in_range"]]
        assert (
            abs(number(at) - speed)
            <= min((abs(x - speed) for x in inside), default=np.inf) + 1e-4 * speed
        )
        away = 100 * (speed / number(at) - 1)
        said = re.search(r"the cursor is (?:at it|([\d.]+) % (above|below) it)", page.near(name))
        assert said is not None
        assert number(said[1] or "0") * (-1 if said[2] == "below" else 1) == pytest.approx(
            away, rel=0.02, abs=0.02
        )


def test_the_campbell_diagram_reads_the_frequencies_of_the_orders(usv: Opened) -> None:
    usv.hover("campbell", 0.5)
    speed, found = usv.read("campbell")
    assert set(found) == {"order 2", "order 4", "order 8"}
    for name, hertz in found.items():
        assert hertz == pytest.approx(float(name.removeprefix("order ")) * speed / 60.0, rel=1e-4)


@pytest.mark.parametrize("scene", WITH_RESPONSE)
def test_a_point_of_the_campbell_diagram_says_what_it_is_to_pointer_and_focus(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    points = page.page.locator("figure#campbell .point")
    in_page = [str(one.locator("title").text_content()) for one in points.all()]
    said = sorted(in_page, key=lambda words: number(words.split(" ")[2]))
    for k in (0, len(said) - 1):
        points.nth(k).locator("path").hover()
        assert page.near("campbell") == in_page[k]
    page.page.mouse.move(2, 2)
    points.nth(in_page.index(said[0])).focus()
    for words in said:
        assert page.near("campbell") == words
        match = CRITICAL.fullmatch(words)
        assert match is not None
        assert page.page.evaluate("document.activeElement.getAttribute('aria-label')") == words
        page.page.keyboard.press("ArrowRight")
    assert points.evaluate_all("all => all.filter(one => one.tabIndex === 0).length") == 1
    page.page.keyboard.press("Home")
    assert page.near("campbell") == said[0]
    page.page.keyboard.press("Escape")
    assert page.near("campbell") == ""
    every = {
        (Fraction(one["order"]), one["mode"])
        for one in criticals(page.report)
        if one["is_in_range"]
    }
    assert every <= {
        (Fraction(m[2]), int(m[3])) for m in map(CRITICAL.fullmatch, said) if m
    }  # none in the range is missing


def test_arrows_step_from_speed_to_speed_and_escape_ends_it(usv: Opened) -> None:
    x = usv.report.figures["torque-1-0"].lines["order 4"].x
    steps = (
        ("ArrowRight", 0),
        ("ArrowRight", 1),
        ("ArrowUp", 2),
        ("ArrowDown", 1),
        ("PageUp", 11),
        ("PageDown", 1),
        ("End", -1),
        ("ArrowRight", -1),
        ("ArrowLeft", -2),
        ("Home", 0),
        ("ArrowLeft", 0),
    )
    for key, place in steps:
        usv.press("torque-1-0", key)
        assert usv.read("torque-1-0")[0] == digits(x[place]), key
        text = usv.area("torque-1-0").get_attribute("aria-valuetext")
        assert text == f"{usv.values('torque-1-0')}; {usv.near('torque-1-0')}"
    usv.press("torque-1-0", "Escape")
    assert usv.values("torque-1-0") == ""


@pytest.mark.parametrize("scene", WITH_RESPONSE[:1])
def test_p_goes_from_peak_to_peak_and_round_again(opens: Callable[..., Opened], scene: str) -> None:
    page = opens(scene)
    name, (half, factor) = next(iter(torques(page.report).items()))
    speeds, y = np.array(page.report.results["response"]["speed_rad_per_s"]) * RPM, np.array(half)
    peaks = np.flatnonzero((y[1:-1] > y[:-2]) & (y[1:-1] >= y[2:])) + 1
    assert peaks.size
    for at in (*peaks.tolist(), peaks[0]):
        page.press(name, "p")
        speed, found = page.read(name)
        assert (speed, found["total vibratory torque"]) == (
            digits(speeds[at]),
            digits(y[at] * factor),
        )
    page.press(name, "Shift+P")
    assert page.read(name)[0] == digits(speeds[peaks[-1]])


def test_p_in_the_campbell_diagram_goes_to_the_next_critical_speed(usv: Opened) -> None:
    usv.press("campbell", "p", "p")
    x = sorted(
        x for marks in usv.report.figures["campbell"].plots[0].marks for x in marks.x.tolist()
    )
    assert usv.read("campbell")[0] == digits(x[1])
    assert usv.near("campbell").endswith("at it")


def test_the_key_switches_lines_off_and_on_by_pointer_and_keyboard(usv: Opened) -> None:
    entry = usv.key("torque-1-0", "order 4")
    line = usv.page.locator("figure#torque-1-0 g.line[data-name='order 4']")
    for use in (entry.click, lambda: (entry.focus(), usv.page.keyboard.press(" "))):
        use()
        assert entry.get_attribute("aria-checked") == "false"
        assert not line.is_visible()
        usv.hover("torque-1-0", 0.5)
        assert "order 4" not in usv.values("torque-1-0")
        assert "order 4" in usv.values("stress-2")
        use()
        assert entry.get_attribute("aria-checked") == "true"
        assert line.is_visible()
    entry.click()
    usv.press("torque-1-0", "Escape")
    assert entry.get_attribute("aria-checked") == "true"


def test_limits_and_ranges_are_switched_too(usv: Opened) -> None:
    entry = usv.key("torque-1-0", "rated speed")
    level = usv.page.locator("figure#torque-1-0 svg.plot path[data-name='rated speed']")
    entry.click()
    assert level.evaluate("one => getComputedStyle(one).visibility") == "hidden"
    entry.press("Enter")
    assert level.evaluate("one => getComputedStyle(one).visibility") == "visible"
