"""What is printed is the static figure in its light colours, whatever was done on the screen."""

import re
import shutil
import subprocess
import zlib
from collections.abc import Callable
from pathlib import Path

import pytest
from tests.output.browser.opened import EVERY, Opened


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
    first = next(name for name, figure in page.report.figures.items() if figure.plots and "mode" not in name)
    page.page.locator(".tools.page button").first.click()  # dark
    entry = page.page.locator(f"figure#{first} [role=checkbox]").first
    entry.click()
    page.drag(first, 0.2, 0.4)
    page.press(first, "+", "ArrowRight")
    page.page.locator("figure#mode-1 button", has_text="move").click()
    page.press("mode-1", "ArrowRight")
    page.hover(first, 0.6)


@pytest.mark.parametrize("scene", EVERY[:4])
def test_a_page_in_use_prints_as_an_untouched_one(opens: Callable[..., Opened], scene: str) -> None:
    clean = opens(scene).page.pdf(prefer_css_page_size=True)
    page = opens(scene, color_scheme="dark")
    used(page)
    printed = page.page.pdf(prefer_css_page_size=True)
    assert streams(printed) == streams(clean)
    assert len(streams(clean)) > 5
    first = next(name for name, figure in page.report.figures.items() if figure.plots and "mode" not in name)
    assert page.page.locator(f"figure#{first} .scale > *").count() > 0  # what was shown is shown again


@pytest.mark.parametrize("scene", EVERY)
def test_every_figure_is_printed_as_without_scripts(opens: Callable[..., Opened], scene: str, tmp_path: Path) -> None:
    for name, page in (("live", opens(scene)), ("bare", opens(scene, java_script_enabled=False))):
        page.page.emulate_media(media="print")
        seen = page.page.locator("figure > svg:not(.train)")
        assert seen.count() == len(page.report.figures)
        assert all(one.is_visible() for one in seen.all())
        (tmp_path / f"{name}.pdf").write_bytes(page.page.pdf(prefer_css_page_size=True))
    if shutil.which("pdftoppm") is None:
        pytest.skip("no pdftoppm to compare the pages with: apt install poppler-utils")
    for name in ("live", "bare"):
        subprocess.run(["pdftoppm", "-r", "40", "-gray", tmp_path / f"{name}.pdf", tmp_path / name], check=True)
    live, bare = (sorted(tmp_path.glob(f"{name}-*.pgm")) for name in ("live", "bare"))
    assert len(live) == len(bare) > 3
    assert [one.read_bytes() for one in live] == [one.read_bytes() for one in bare]
