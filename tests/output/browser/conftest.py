"""A browser for all tests of this folder, which are skipped where playwright or Chromium is not installed."""

import shutil
from collections.abc import Callable, Iterator
from typing import Any

import pytest
from tests.output.browser.opened import EVERY, Opened, Report, report

VIEW = {"width": 900, "height": 900}  # px


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    playwright = pytest.importorskip(
        "playwright.sync_api", reason="no playwright here: pip install .[browser]"
    )
    chromium = shutil.which("chromium") or shutil.which("google-chrome")
    if chromium is None:
        pytest.skip("no Chromium on the path: apt install chromium")
    with playwright.sync_playwright() as running:
        opened = running.chromium.launch(
            executable_path=chromium, args=["--no-sandbox", "--disable-gpu"]
        )
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def reports(browser: Any, tmp_path_factory: pytest.TempPathFactory) -> Callable[[str], Report]:
    """The report of a scene, solved once and written to a file."""
    folder, made = tmp_path_factory.mktemp("reports"), dict[str, Report]()

    def found(scene: str) -> Report:
        if scene not in made:
            made[scene] = report(scene, folder)
        return made[scene]

    return found


@pytest.fixture(scope="session")
def window(browser: Any) -> Any:
    """A window for all pages that need none of their own: its first tab starts processes."""
    return browser.new_context()


@pytest.fixture(scope="session")
def tabs(browser: Any, window: Any, reports: Callable[[str], Report]) -> Callable[..., Opened]:
    """The page of a scene in a browser set up in some way, as one that was never used.

    One tab of each way, and of each scene of many tests, as a new one is slow. So is opening a page: it stays where
    the test before left no trace in it. What a tab can be told needs no window of its own with its processes.
    """
    windows, tabs, shown = {"[]": window}, dict[str, Any](), dict[str, Opened]()

    def opened(scene: str, **context: Any) -> Opened:
        way = str(sorted(context.items())) if context or scene not in EVERY else scene
        told = {"viewport": VIEW, "color_scheme": "light", "reduced_motion": "no-preference"}
        told.update((key, context.pop(key)) for key in told if key in context)
        has_scripts = context.pop("java_script_enabled", True)
        if way not in tabs:
            kind = str(sorted(context.items()))
            if kind not in windows:
                windows[kind] = browser.new_context(**context)
            tabs[way] = windows[kind].new_page()
            windows[kind].new_cdp_session(tabs[way]).send(
                "Emulation.setScriptExecutionDisabled", {"value": not has_scripts}
            )
        tab = tabs[way]
        tab.bring_to_front()  # behind another it draws nothing and waits for its wheel
        tab.set_viewport_size(told.pop("viewport"))
        tab.emulate_media(media="null", **told)
        if (kept := shown.get(way)) is not None:
            if kept.report is reports(scene) and kept.is_untouched():
                return kept
            kept.close()
        shown[way] = Opened(tab, reports(scene))
        return shown[way]

    return opened


@pytest.fixture
def opens(tabs: Callable[..., Opened]) -> Iterator[Callable[..., Opened]]:
    """Opens the page of a scene from its file; in the end no page has said anything or requested anything else."""
    shown = list[Opened]()

    def opened(scene: str, **context: Any) -> Opened:
        shown.append(tabs(scene, **context))
        return shown[-1]

    yield opened
    for one in shown:
        assert one.messages == []
        assert {url for url in one.requests if not url.startswith("blob:")} == {
            one.report.file.as_uri()
        }


@pytest.fixture
def usv(opens: Callable[..., Opened]) -> Opened:
    return opens("usv")
