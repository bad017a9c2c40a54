"""Dark and light, narrow and enlarged, without scripts, with the list of keys: the page stays legible and whole."""

from collections.abc import Callable
from typing import Any

import pytest
from tests.output.browser.opened import EVERY, Opened
from tests.output.drawing.dark_colours import PAPER

TEXTS = """() => {  // of every text that is seen: its words, colour, what lies behind it, and its box or figure
    const found = new Map();
    const behind = (one) => {
        for (let at = one; at; at = at.parentElement) {
            const colour = getComputedStyle(at).backgroundColor;
            if (colour !== 'rgba(0, 0, 0, 0)') return colour;
        }
        return 'rgb(255, 255, 255)';
    };
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const one = node.parentElement, look = getComputedStyle(one);
        const unseen = look.visibility === 'hidden' || !one.checkVisibility()
            || one.closest('script, style, title, desc');
        if (!node.data.trim() || unseen) continue;
        const paper = one.closest('svg')?.querySelector('.paper');
        const pair = paper ? [look.fill, getComputedStyle(paper).fill] : [look.color, behind(one)];
        const place = one.closest('figure, .box'), name = place?.id || place?.className || '';
        found.set([name, ...pair].join(), [node.data.trim().slice(0, 40), ...pair, name]);
    }
    return [...found.values()];
}"""
CONTRAST = """async () => {  // by axe, of the first text of every look in every table, figure and box
    const CLEAR = 'rgba(0, 0, 0, 0)', looks = new Map();
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
    const places = [...document.querySelectorAll('table, figure, .box')];
    for (let node = walker.nextNode(); node; node = walker.nextNode()) {
        const one = node.parentElement, { color, fill, fontSize, fontWeight } = getComputedStyle(one);
        const behind = [];  // what axe looks up to the first colour
        for (let at = one; at && (behind.at(-1) ?? CLEAR) === CLEAR; at = at.parentElement)
            behind.push(getComputedStyle(at).backgroundColor);
        const place = places.indexOf(one.closest('table, figure, .box'));
        const look = [place, color, fill, fontSize, fontWeight, behind.at(-1)].join();
        if (node.data.trim() && !looks.has(look)) looks.set(look, one);
    }
    const options = { resultTypes: ['violations'], runOnly: ['color-contrast'] };
    return [looks.size, (await axe.run({ include: [...looks.values()] }, options)).violations];
}"""
A4 = 680  # px of 210 mm without its margins of 15 mm
LEAST = 4.5  # W3C, WCAG 2.1, 1.4.3


def luminance(colour: str) -> float:
    """Of rgb(r, g, b); W3C, WCAG 2.1."""
    parts = [float(one) / 255.0 for one in colour[colour.index("(") + 1 : -1].split(",")[:3]]
    red, green, blue = (p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def illegible(texts: list[Any]) -> list[Any]:
    """Those whose contrast is too small, with it."""
    found = []
    for words, one, other, _ in texts:
        low, high = sorted((luminance(one), luminance(other)))
        if (high + 0.05) / (low + 0.05) < LEAST:
            found.append((words, one, other, (high + 0.05) / (low + 0.05)))
    return found


def paper(page: Opened) -> str:
    script = "getComputedStyle(document.querySelector('figure > svg:not(.train) > .paper')).fill"
    return str(page.page.evaluate(script))


DARK = f"rgb({', '.join(str(int(PAPER[k : k + 2], 16)) for k in (1, 3, 5))})"
LIGHT = "rgb(255, 255, 255)"


@pytest.mark.parametrize("scene", EVERY)
def test_every_text_stands_out_from_what_lies_behind_it(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    for screen, behind in (("light", LIGHT), ("dark", DARK)):
        page.page.emulate_media(color_scheme=screen)
        assert paper(page) == behind
        texts = page.page.evaluate(TEXTS)
        assert illegible(texts) == []
        places = {place.split(" ")[0] for *_, place in texts}
        assert places > {"box", *(name for name in page.report.figures)}


def test_a_button_changes_the_screen_and_back(opens: Callable[..., Opened]) -> None:
    page = opens("usv", color_scheme="dark")
    button = page.page.locator(".tools.page button").first
    for words, after in (("light screen", LIGHT), ("dark screen", DARK), ("light screen", LIGHT)):
        assert button.text_content() == words
        button.click()
        assert paper(page) == after


def test_what_is_made_on_the_way_is_legible_on_a_dark_screen(opens: Callable[..., Opened]) -> None:
    page = opens("usv", color_scheme="dark")
    page.key("torque-1-0", "order 4").click()
    page.drag("torque-1-0", 0.2, 0.5)
    page.hover("torque-1-0", 0.5)
    page.area("torque-1-0").focus()
    page.page.keyboard.press("?")
    assert illegible(page.page.evaluate(TEXTS)) == []


def test_the_list_of_keys_opens_and_closes(usv: Opened) -> None:
    dialog = usv.page.locator("dialog")
    assert not dialog.is_visible()
    usv.press("torque-1-0", "?")
    assert dialog.is_visible()
    for key in ("Esc", "Space", "Home, End", "P, Shift P", "touch"):
        assert dialog.get_by_role("rowheader", name=key, exact=True).count() == 1
    usv.page.keyboard.press("Escape")
    assert not dialog.is_visible()
    usv.page.locator(".tools.page button", has_text="keys").click()
    assert dialog.is_visible()
    dialog.get_by_role("button").click()
    assert not dialog.is_visible()


@pytest.mark.parametrize("scene", EVERY)
def test_on_a_narrow_or_an_enlarged_screen_nothing_runs_over_its_edge(
    opens: Callable[..., Opened], scene: str
) -> None:
    """420 px; and 1280 px enlarged to 200 %, which is 640 px of twice the size."""
    page = opens(scene, device_scale_factor=2)
    first = next(name for name, figure in page.report.figures.items() if figure.plots)
    for wide, high in ((420, 800), (640, 450)):
        page.page.set_viewport_size({"width": wide, "height": high})
        assert page.page.evaluate("document.documentElement.scrollWidth <= innerWidth")
        page.hover(first, 0.5)
        assert page.values(first)
        box = page.page.locator(f"figure#{first}").bounding_box()
        assert box["x"] >= 0
        assert box["x"] + box["width"] <= wide
        cut = "one => one.getBoundingClientRect().right > innerWidth + 1 ? one.textContent : null"
        assert (
            page.page.locator("main caption").evaluate_all(
                f"each => each.map({cut}).filter(Boolean)"
            )
            == []
        )


@pytest.mark.parametrize("scene", EVERY)
def test_every_table_is_as_wide_as_the_page_on_screen_and_on_paper(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    for media in ("screen", "print"):
        page.page.emulate_media(media=media)
        page.page.set_viewport_size({"width": 900 if media == "screen" else A4, "height": 900})
        wider = "one => one.scrollWidth > one.parentElement.clientWidth ? one.caption.textContent : null"
        found = page.page.locator("main .table > table").evaluate_all(
            f"each => each.map({wider}).filter(Boolean)"
        )
        assert found == []


def test_without_scripts_there_is_the_static_figure(opens: Callable[..., Opened]) -> None:
    page = opens("usv", java_script_enabled=False)
    assert page.page.locator("figure > svg[role=img]").count() == len(page.report.figures)
    for made in ("rect.area", ".tools", "button", ".values", ".train", "dialog"):
        assert page.page.locator(made).count() == 0


@pytest.mark.parametrize("scene", ["usv"])
def test_axe_finds_nothing_to_mend(opens: Callable[..., Opened], scene: str) -> None:
    """Rules of accessibility that a program can check, by axe-core, on the page in use.

    Its rule of contrast takes 4 ms for each text, of which a page has thousands in a few looks;
    `test_every_text_stands_out_from_what_lies_behind_it` judges all of them.
    """
    axe = pytest.importorskip(
        "axe_playwright_python.sync_playwright", reason="no axe-playwright-python here"
    )
    page = opens(scene)
    options = {"resultTypes": ["violations"], "rules": {"color-contrast": {"enabled": False}}}
    found = axe.Axe().run(page.page, options=options).response["violations"]
    count, faint = page.page.evaluate(CONTRAST)
    assert count > 100
    assert [
        (one["id"], one["nodes"][0]["html"][:120], len(one["nodes"])) for one in found + faint
    ] == []
