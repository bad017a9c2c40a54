"""The page of `torsion live` in a browser: it follows the file, its sliders and its faults, and breaks no policy."""

import subprocess
import sys
from collections.abc import Iterator
from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest

from torsion.output.numbers import number

SCENE = """
name: pair
operation: {{speeds: {{from: 100 rpm, to: 900 rpm, steps: 21}}}}
train:
  - motor: {{name: motor, inertia: {inertia}, ripple: [{{order: 1, torque: 1 N*m}}]}}
  - coupling: {{name: link, stiffness: 12 kN*m/rad, tolerance: 10 %, loss_factor: 0.1}}
  - disc: {{name: end, inertia: 3}}
analyses: {{modes: {{count: 1}}, response: }}
"""


def shown(stiffness: float, one: float, other: float = 3.0) -> str:
    """The frequency of two discs on a spring as the report prints it."""
    return number(sqrt(stiffness * (1 / one + 1 / other)) / 2 / pi, 7)


class Live:
    """The command under way, and its page."""

    def __init__(self, browser: Any, file: Path) -> None:
        self.file, self.messages = file, list[str]()
        self.save()
        command = [sys.executable, "-m", "torsion", "live", str(file), "--no-browser"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().split()[-1]
        self.page = browser.new_context(viewport={"width": 1500, "height": 900}).new_page()
        self.page.on("console", lambda message: self.messages.append(message.text))
        self.page.on("pageerror", lambda error: self.messages.append(str(error)))
        self.page.goto(self.address)
        self.modes, self.report = (
            self.page.frame_locator("#modes"),
            self.page.frame_locator("#report"),
        )

    def save(self, inertia: float = 2.0, **words: str) -> None:
        text = SCENE.format(inertia=inertia)
        for before, after in words.items():
            text = text.replace(before, after)
        self.file.write_text(text, encoding="utf-8")

    def until(self, frame: Any, words: str) -> None:
        """Wait until a frame shows the words."""
        frame.get_by_text(words, exact=True).first.wait_for(timeout=60_000)


@pytest.fixture(scope="module")
def live(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Live]:
    made = Live(browser, tmp_path_factory.mktemp("live") / "pair.yaml")
    yield made
    made.page.context.close()
    made.process.terminate()
    made.process.communicate()
    assert made.messages == []


def test_a_saved_file_is_drawn(live: Live) -> None:
    live.until(live.modes, shown(12e3, 2.0))
    live.save(2.5)
    live.until(live.modes, shown(12e3, 2.5))
    live.modes.locator("figure#campbell > svg").wait_for()
    live.report.locator("figure[id^=torque-] > svg").wait_for()
    live.report.locator("section.box .head").wait_for()


def test_a_slider_shows_the_frequency_of_the_changed_file(live: Live) -> None:
    live.save(2.0)
    live.until(live.modes, shown(12e3, 2.0))
    slider = live.page.get_by_role("slider", name="link.stiffness")
    assert [slider.get_attribute(key) for key in ("min", "max")] == ["0.9", "1.1"]
    slider.fill("1.07")
    live.until(live.modes, shown(1.07 * 12e3, 2.0))
    live.until(live.page, "12.84 kN*m/rad (+7 %)")
    live.until(live.page, "Not the file: link.stiffness is moved.")
    live.page.get_by_role("button", name="as in the file").click()
    live.until(live.modes, shown(12e3, 2.0))
    live.until(live.page, "The figures of the file.")


def test_a_cursor_and_a_zoom_outlast_a_new_picture(live: Live) -> None:
    area = live.report.locator("figure[id^=torque-] rect.area")
    area.press("End")
    area.press("+")
    assert "900 rpm" in live.report.locator(".values > span").first.inner_text()
    live.save(3.0)
    live.until(live.modes, shown(12e3, 3.0))
    live.page.wait_for_selector("#state:text('solved and drawn')")
    assert "900 rpm" in live.report.locator(".values > span").first.inner_text()
    assert (
        live.report.locator("figure[id^=torque-] .scale text").count() > 1
    )  # of the part that is shown


def test_a_fault_stands_above_the_last_picture(live: Live) -> None:
    live.save(3.0)
    live.until(live.modes, shown(12e3, 3.0))
    live.save(3.0, stiffness="stifness")
    faults = live.page.get_by_role("alert")
    faults.wait_for()
    assert faults.inner_text().startswith(
        f"{live.file}:6:28: unknown key `stifness` (did you mean `stiffness`?)"
    )
    assert live.modes.get_by_text(shown(12e3, 3.0), exact=True).count() == 1
    live.save(4.0)
    live.until(live.modes, shown(12e3, 4.0))
    faults.wait_for(state="hidden")


def test_a_page_without_the_token_shows_nothing(live: Live) -> None:
    page = live.page.context.new_page()  # in which nothing of the other page is kept either
    page.goto(live.address.partition("#")[0])
    page.wait_for_selector("#state.lost")
    assert "no valid token" in page.locator("#state").inner_text()
    assert page.locator("#name").inner_text() == "torsion live"
    page.close()
