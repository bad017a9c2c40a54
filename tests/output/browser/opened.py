"""A page in a browser, and what a reader does with it."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from time import monotonic
from typing import Any

from tests.contracts.frozen import SCENES, solved

import torsion
from torsion.findings import Findings
from torsion.output.document import Document, document
from torsion.output.figures.figure import Figure
from torsion.output.pages.html import html
from torsion.output.stored.results_json import results

EVERY = ("usv", "cardan_bearings", "six_cylinder")
# One script is a tenth of the work of a locator, which polls, waits for frames and asks for every element.
BOX = """async ([name, plot]) => {  // a plot in view, and drawn there: a finger is sent where it was drawn
    const area = document.querySelectorAll(`figure#${name} rect.area`)[plot], before = scrollY;
    area.scrollIntoViewIfNeeded();
    for (let k = 0; scrollY !== before && k < 2; k += 1) await new Promise(requestAnimationFrame);
    const { x, y, width, height } = area.getBoundingClientRect();
    return [x, y, width, height];
}"""
NUMBERS = """name => [...document.querySelectorAll(`figure#${name} :is(text.across, .scale text)`)]
    .filter((text) => text.checkVisibility({ visibilityProperty: true }) && text.getBoundingClientRect().width)
    .map((text) => text.textContent)"""
LOOK = r"""() => {  // all of the page but where its cursors and chosen parts were, and empty attributes; in few words
    const all = document.documentElement.outerHTML
        .replace(/ aria-value(now|text)="[^"]*"/g, '')
        .replace(/(visibility="hidden") (transform|x)="[^"]*"( y="[^"]*" width="[^"]*" height="[^"]*")?/g, '$1')
        .replace(/ (style|class)=""/g, '');
    let hash = 0;
    for (let k = 0; k < all.length; k += 1) hash = (31 * hash + all.charCodeAt(k)) | 0;
    return `${all.length} ${hash}`;
}"""
RESET = """() => {  // by the key of the reader, in every plot
    document.querySelectorAll("rect.area").forEach((area) =>
        area.dispatchEvent(new KeyboardEvent("keydown", { key: "Escape" })));
    document.activeElement?.blur();
    scrollTo(0, 0);
}"""


@dataclass(frozen=True)
class Report:
    """What was found, its report with the figures by name, and its page as a file."""

    findings: Findings
    document: Document
    file: Path

    @cached_property
    def figures(self) -> dict[str, Figure]:
        return {
            item.block.name: item.block
            for item in self.document.body
            if isinstance(item.block, Figure)
        }

    @cached_property
    def results(self) -> dict[str, Any]:
        """As in results.json."""
        return results(self.findings)


def report(scene: str, folder: Path) -> Report:
    """Solved and written."""
    findings = solved(scene) if scene in SCENES else torsion.run(torsion.read(f"{scene}.yaml"))
    made = document(findings, is_full=True)
    file = folder / f"{scene}.html"
    file.write_text(html(made), encoding="utf-8")
    return Report(findings, made, file)


class Opened:
    """A page with everything that a reader sees and does."""

    def __init__(self, tab: Any, report: Report) -> None:
        self.report, self.page = report, tab
        self.messages, self.requests = list[str](), list[str]()
        self._listeners = {
            "console": lambda message: self.messages.append(message.text),
            "pageerror": lambda error: self.messages.append(str(error)),
            "request": lambda request: self.requests.append(request.url),
        }
        for event, listener in self._listeners.items():
            tab.on(event, listener)
        tab.goto(report.file.as_uri())
        if tab.evaluate("typeof STORE") == "object":  # with scripts
            tab.wait_for_selector("html.live", state="attached")
        self._untouched = tab.evaluate(LOOK)

    def is_untouched(self) -> bool:
        """Whether a page that pointer, focus and Escape have left is as when it was opened."""
        self.page.keyboard.press("Escape")
        self.page.mouse.move(2, 2)
        self.page.evaluate(RESET)
        return bool(self.page.evaluate(LOOK) == self._untouched) and not self.messages

    def close(self) -> None:
        """Hear no more of the tab."""
        for event, listener in self._listeners.items():
            self.page.remove_listener(event, listener)

    def area(self, name: str, plot: int = 0) -> Any:
        """Where a plot of a figure answers."""
        return self.page.locator(f"figure#{name} rect.area").nth(plot)

    def text(self, name: str, selector: str) -> str:
        """Of an element of a figure."""
        script = "selector => document.querySelector(selector).textContent"
        return str(self.page.evaluate(script, f"figure#{name} {selector}"))

    def values(self, name: str) -> str:
        """What the cursor reads below a figure."""
        return self.text(name, ".values > span")

    def now(self, name: str) -> float:
        """Where the cursor of a figure stands, as it is told to a screen reader."""
        script = "name => document.querySelector(`figure#${name} rect.area`).ariaValueNow"
        return float(self.page.evaluate(script, name))

    def near(self, name: str) -> str:
        """What is said there of critical speeds and points."""
        return self.text(name, ".near")

    def read(self, name: str) -> tuple[float, dict[str, float]]:
        """Coordinate, and values by the name of their line."""
        head, _, rest = self.values(name).partition(": ")
        return number(head.rpartition(" ")[0] or head), {
            words: number(value)
            for words, value in (split(word) for word in rest.replace("; ", ", ").split(", "))
        }

    def spot(self, name: str, across: float, plot: int = 0) -> tuple[float, float]:
        """px of a share of the width of a plot."""
        left, top, wide, high = self.page.evaluate(BOX, [name, plot])
        return left + across * wide, top + high / 2

    def hover(self, name: str, across: float, plot: int = 0) -> None:
        self.page.mouse.move(*self.spot(name, across, plot))

    def drag(self, name: str, first: float, last: float) -> None:
        """From one share of the width to another."""
        self.hover(name, first)
        self.page.mouse.down()
        self.hover(name, (first + last) / 2)
        self.hover(name, last)
        self.page.mouse.up()

    def press(self, name: str, *keys: str) -> None:
        """In a plot with the focus."""
        self.page.evaluate(
            "name => document.querySelector(`figure#${name} rect.area`).focus()", name
        )
        for key in keys:
            self.page.keyboard.press(key)

    def numbers(self, name: str) -> list[float]:
        """What stands below the plots of a figure, as it is seen."""
        return [number(text) for text in self.page.evaluate(NUMBERS, name)]

    def shape(self, name: str) -> list[str]:
        """All paths and windows of a figure, but the cursor."""
        script = """s => [...s.querySelectorAll('path:not(.cursor), svg')]
            .map(e => e.getAttribute('d') || e.getAttribute('viewBox'))"""
        found: list[str] = self.page.locator(f"figure#{name} > svg:not(.train)").evaluate(script)
        return found

    def key(self, name: str, line: str) -> Any:
        """The name of a line in the key of a figure."""
        return self.page.locator(f"figure#{name} [role=checkbox][aria-label='{line}']")

    def button(self, name: str, words: str) -> Any:
        """Of a figure."""
        return self.page.locator(f"figure#{name} button", has_text=words)


def until(page: Any, script: str, arg: Any = None) -> None:
    """Wait until a script is true in a page. It is tried from here, as the page's policy lets it evaluate nothing.

    Playwright's own `wait_for_function` evaluates in the page from the second time on, and fails there.
    """
    end = monotonic() + 30.0
    while not page.evaluate(script, arg):
        assert monotonic() < end, script
        page.wait_for_timeout(20)


def number(text: str) -> float:
    return float(text.replace("−", "-"))


def split(word: str) -> tuple[str, str]:
    """'order 2 -1.25 kN m': the name, and the number behind it, which is the last word that is one."""
    parts = word.split(" ")
    at = max(
        k
        for k, part in enumerate(parts)
        if part.replace("−", "").replace(".", "").replace("e-", "").isdigit()
    )
    return " ".join(parts[:at]), parts[at]
