"""The page of `torsion live` in a browser: it follows the file, its sliders and its faults, and breaks no policy."""

import subprocess
import sys
from collections.abc import Iterator
from math import pi, sqrt
from pathlib import Path
from typing import Any

import pytest
from tests.output.browser.opened import until

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
        command = [sys.executable, "-m", "torsion", "live", str(file), "--no-browser", "--edit"]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        assert self.process.stdout is not None
        self.address = self.process.stdout.readline().split()[-1]
        self.page = browser.new_page(viewport={"width": 1500, "height": 900})
        self.page.on("console", lambda message: self.messages.append(message.text))
        self.page.on("pageerror", lambda error: self.messages.append(str(error)))
        self.page.goto(self.address)
        self.modes, self.report = self.page.frame_locator("#modes"), self.page.frame_locator("#report")

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
    made.page.close()
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
    assert live.report.locator("figure[id^=torque-] .scale text").count() > 1  # of the part that is shown


def test_a_fault_stands_above_the_last_picture(live: Live) -> None:
    live.save(3.0)
    live.until(live.modes, shown(12e3, 3.0))
    live.save(3.0, stiffness="stifness")
    faults = live.page.get_by_role("alert")
    faults.wait_for()
    assert faults.inner_text().startswith(f"{live.file}:6:28: unknown key `stifness` (did you mean `stiffness`?)")
    assert live.modes.get_by_text(shown(12e3, 3.0), exact=True).count() == 1
    live.save(4.0)
    live.until(live.modes, shown(12e3, 4.0))
    faults.wait_for(state="hidden")


def test_a_text_is_read_while_it_is_typed_and_saved_as_it_stands(live: Live) -> None:
    live.save(4.0)
    live.until(live.modes, shown(12e3, 4.0))
    text = live.page.get_by_role("textbox", name="text of the file")
    text.fill(SCENE.format(inertia=4.5).replace("stiffness", "stifness"))
    fault = live.page.get_by_role("button", name="6:28 unknown key")
    fault.click()
    place = text.evaluate("area => area.value.slice(area.selectionStart, area.selectionStart + 8)")
    assert place == "stifness"
    assert live.page.locator("#rows").inner_text().split("\n")[4:6] == ["5", "✗ 6"]
    assert live.file.read_text(encoding="utf-8") == SCENE.format(inertia=4.0)  # nothing is saved by typing
    text.fill(SCENE.format(inertia=4.5))
    live.page.get_by_text("not saved", exact=True).wait_for()
    text.press("Control+s")
    live.until(live.modes, shown(12e3, 4.5))
    assert live.file.read_text(encoding="utf-8") == SCENE.format(inertia=4.5)
    live.page.locator("#found li").first.wait_for(state="detached")


def test_keys_are_completed_where_they_fit(live: Live) -> None:
    text = live.page.get_by_role("textbox", name="text of the file")
    before = text.input_value()
    text.fill("")
    text.press_sequentially("operation: {spee")
    assert live.page.locator("#keys button").all_inner_texts() == ["speeds"]
    text.press("Tab")
    text.press_sequentially("{fr")
    text.press("Tab")
    assert text.input_value() == "operation: {speeds: {from: "
    text.fill("train:\n  - coupling:\n      name: a\n      sti")
    text.press("End")
    text.press_sequentially("f")
    assert live.page.locator("#keys button").all_inner_texts() == ["stiffness"]
    text.fill(before)


def test_a_text_is_never_saved_over_what_has_changed_on_the_disk(live: Live) -> None:
    text = live.page.get_by_role("textbox", name="text of the file")
    text.fill(SCENE.format(inertia=7.0))
    live.save(6.0)
    live.until(live.page, "the file has changed on the disk meanwhile")
    live.page.get_by_role("button", name="save", exact=True).click()
    live.until(live.page, "the file has changed on the disk meanwhile: nothing was written")
    assert live.file.read_text(encoding="utf-8") == SCENE.format(inertia=6.0)
    assert text.input_value() == SCENE.format(inertia=7.0)
    live.page.get_by_role("button", name="take the text of the disk").click()
    assert text.input_value() == SCENE.format(inertia=6.0)


def test_a_moved_slider_is_written_into_the_file(live: Live) -> None:
    live.save(2.0)
    live.until(live.modes, shown(12e3, 2.0))
    until(live.page, "document.getElementById('text').value.includes('inertia: 2.0')")
    live.page.get_by_role("slider", name="link.stiffness").fill("1.07")
    live.until(live.page, "12.84 kN*m/rad (+7 %)")
    live.page.get_by_role("button", name="write into the file").click()
    live.until(live.page, "12.84 kN*m/rad")
    live.until(live.page, "The figures of the file.")
    assert live.file.read_text(encoding="utf-8") == SCENE.format(inertia=2.0).replace("12 kN", "12.84 kN")
    live.until(live.modes, shown(1.07 * 12e3, 2.0))


def test_a_page_without_the_token_shows_nothing(live: Live, browser: Any) -> None:
    page = browser.new_page()
    page.goto(live.address.partition("#")[0])
    page.wait_for_selector("#state.lost")
    assert "no valid token" in page.locator("#state").inner_text()
    assert page.locator("#name").inner_text() == "torsion live"
    page.close()
