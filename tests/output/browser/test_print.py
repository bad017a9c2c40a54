"""What is printed is the static figure in its light colours, whatever was done on the screen."""

import re
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tests.output.browser.opened import EVERY, Opened
from tests.output.conftest import BARE, solved
from tests.output.test_running_head import every_page_is_marked, needs_reader, pages, submitted

from torsion.output.document import document
from torsion.output.pages.html import html


def streams(pdf: bytes) -> list[bytes]:
    """All pages, fonts and pictures of a PDF, in their order."""
    found = []
    for match in re.finditer(rb"stream\r?\n", pdf):
        end = pdf.find(b"endstream", match.end())
        data = zlib.decompressobj()
        try:
            found.append(data.decompress(pdf[match.end() : end]))
        except zlib.error:
            continue
    return found


def used(page: Opened) -> None:
    """Leave nothing as it was."""
    plots = [name for name, figure in page.report.figures.items() if figure.plots]
    first = next((name for name in plots if "mode" not in name), plots[0])
    page.page.locator(".tools.page button").first.click()  # light, and dark again
    page.page.locator(".tools.page button").first.click()
    for entry in page.page.locator(f"figure#{first} [role=checkbox]").all()[:1]:
        entry.click()
    page.drag(first, 0.2, 0.4)
    page.press(first, "+", "ArrowRight")
    page.page.locator("figure#mode-1 button", has_text="move").click()
    page.press("mode-1", "ArrowRight")
    page.hover(first, 0.6)


@pytest.mark.parametrize("scene", EVERY)
def test_a_page_in_use_prints_as_an_untouched_one_and_as_without_scripts(
    opens: Callable[..., Opened], scene: str
) -> None:
    clean = streams(opens(scene).page.pdf(prefer_css_page_size=True))
    assert len(clean) > 5
    if scene in ("usv", "six_cylinder"):
        bare = opens(scene, java_script_enabled=False).page
        assert streams(bare.pdf(prefer_css_page_size=True)) == clean
    if scene == "cardan_bearings":  # opened on a dark screen; the others change to it
        page = opens(scene, color_scheme="dark")
    else:
        page = opens(scene)
        page.page.emulate_media(color_scheme="dark")
    used(page)
    assert streams(page.page.pdf(prefer_css_page_size=True)) == clean
    assert (
        page.page.locator(".scale > *").count() > 0 or scene == "six_cylinder"
    )  # what was shown is shown again
    page.page.emulate_media(media="print")
    seen = page.page.evaluate("""[...document.querySelectorAll('figure > svg:not(.train)')].map((figure) =>
        figure.checkVisibility({ visibilityProperty: true }) && figure.getBoundingClientRect().width > 0)""")
    assert seen == [True] * len(page.report.figures)


@needs_reader
def test_a_browser_prints_number_revision_origin_and_page_on_every_page(
    window: Any, tmp_path: Path
) -> None:
    page = window.new_page()
    for made, identity in (
        (submitted(tmp_path), "TVC_{1} 100 % · revision B"),
        (document(solved(BARE)), "two discs"),
    ):
        (tmp_path / "a.html").write_text(html(made), encoding="utf-8")
        page.goto((tmp_path / "a.html").as_uri())
        page.pdf(path=tmp_path / "a.pdf", prefer_css_page_size=True)
        every_page_is_marked(pages(tmp_path / "a.pdf"), made, identity)
    page.close()
