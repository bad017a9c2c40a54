"""Modes over the train: a cursor names stations and elements; a button moves the mode, which never starts by itself."""

import re
from collections.abc import Callable

import numpy as np
import pytest
from tests.output.browser.opened import EVERY, Opened, number, until

POINT = re.compile(r"M(-?[\d.]+) (-?[\d.]+)m")


def dots(page: Opened, name: str) -> np.ndarray:
    """(marked stations, 2) px of the moving train."""
    text = page.page.locator(f"figure#{name} .train > path").last.get_attribute("d")
    return np.array([[float(one) for one in pair] for pair in POINT.findall(text)])


@pytest.mark.parametrize("scene", EVERY)
def test_the_cursor_names_every_station_with_the_angle_of_the_results(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    results = page.report.results
    ratio = [ratio_of(one["speed_ratio"]) for one in results["stations"]]
    for mode in (1, 2):
        shape = np.array(results["modes"]["shape_rad"][mode - 1]) / np.array(ratio)
        own = {
            one["name"]: angle / shape[np.argmax(np.abs(shape))]
            for one, angle in zip(results["stations"], shape, strict=True)
        }
        stops = page.report.figures[f"mode-{mode}"].plots[0].stops
        assert stops is not None
        seen = set()
        page.press(f"mode-{mode}", "Home")
        for _ in range(len(set(stops.x.tolist()))):
            text = (
                page.values(f"mode-{mode}")
                .partition("; torque")[0]
                .removeprefix("angle / largest: ")
            )
            for word in text.split(", "):
                name, _, value = word.rpartition(" ")
                assert number(value) == pytest.approx(own[name], rel=6e-5, abs=1e-12), name
                seen.add(name)
            page.page.keyboard.press("ArrowRight")
        assert seen == set(stops.names)


def ratio_of(text: str) -> float:
    over, _, under = str(text).partition("/")
    return float(over) / float(under or 1)


def test_the_torque_of_an_element_is_read_below(usv: Opened) -> None:
    results = usv.report.results
    torque = np.array(results["modes"]["torque_Nm"][0]) * [
        ratio_of(s["ratio"]) for s in results["spans"]
    ]
    usv.hover("mode-1", 0.12, plot=1)
    name, _, value = usv.values("mode-1").partition("torque / largest: ")[2].rpartition(" ")
    at = [one["name"] for one in results["spans"]].index(name)
    assert number(value) == pytest.approx(torque[at] / np.abs(torque).max(), rel=6e-5)


def test_a_cursor_along_the_train_stands_in_all_modes(usv: Opened) -> None:
    usv.press("mode-1", "Home")
    assert usv.values("mode-2").startswith("angle / largest: motor-1 ")
    assert usv.near("mode-1") == ""


@pytest.mark.parametrize("scene", EVERY)
def test_the_line_along_the_train_is_deflected_by_the_angles_as_plotted(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    for name in ("mode-1", "mode-3"):
        moving = page.report.figures[name].moving
        assert moving is not None
        places = dots(page, name)
        rest = moving.row[moving.marked] * 130.5
        np.testing.assert_allclose(
            rest - places[:, 1], 28.0 * moving.angle[moving.marked], atol=0.06
        )
        steps = np.diff(moving.x[moving.marked])
        across = np.diff(places[:, 0])
        scale = across[np.argmax(np.abs(steps))] / steps[np.argmax(np.abs(steps))]
        np.testing.assert_allclose(across, scale * steps, atol=0.15)
        line = page.page.locator(f"figure#{name} .deflected").get_attribute("d")
        assert line.count("L") == len(moving.ends)


def test_a_mode_moves_and_stops_by_its_button_and_by_space_and_never_by_itself(usv: Opened) -> None:
    still = dots(usv, "mode-1")
    usv.page.wait_for_timeout(120)
    assert np.array_equal(dots(usv, "mode-1"), still)
    button = usv.button("mode-1", "move")
    for start, stop in (
        (button.click, usv.button("mode-1", "stop").click),
        (_space(usv), _space(usv)),
    ):
        before = dots(usv, "mode-1")
        start()
        assert usv.page.locator("figure#mode-1 button[aria-pressed=true]").count() == 1
        until(
            usv.page,
            "was => document.querySelector('figure#mode-1 .train').dataset.phase !== was",
            usv.page.locator("figure#mode-1 .train").get_attribute("data-phase"),
        )
        stop()
        stopped = dots(usv, "mode-1")
        assert not np.array_equal(stopped, before)
        share = (stopped[:, 1] - 0.0) / np.where(still[:, 1] == 0, 1, still[:, 1])
        moving = np.abs(still[:, 1]) > 5.0
        assert np.ptp(share[moving]) < 0.05  # all move in one phase
        usv.page.wait_for_timeout(80)
        assert np.array_equal(dots(usv, "mode-1"), stopped)
    assert np.array_equal(dots(usv, "mode-2"), dots(usv, "mode-2"))


def _space(page: Opened) -> Callable[[], None]:
    return lambda: page.press("mode-1", " ")


def test_where_motion_is_to_be_reduced_a_mode_only_steps(opens: Callable[..., Opened]) -> None:
    page = opens("usv", reduced_motion="reduce")
    still, button = dots(page, "mode-1"), page.button("mode-1", "step")
    moved = np.abs(still[:, 1]) > 1.0
    for step in range(1, 9):
        button.click()
        share = np.cos(2.0 * np.pi * step / 8)
        np.testing.assert_allclose(
            dots(page, "mode-1")[moved, 1], share * still[moved, 1], atol=0.11
        )
    page.page.wait_for_timeout(100)
    np.testing.assert_array_equal(dots(page, "mode-1"), still)
    assert page.page.locator("button[aria-pressed=true]").count() == 0
