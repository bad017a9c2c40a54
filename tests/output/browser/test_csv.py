"""What the buttons save is, byte for byte, what --csv writes; nothing leaves the page for it."""

from collections.abc import Callable
from pathlib import Path

import pytest
from tests.output.browser.opened import EVERY, Opened

from torsion.output.blocks import Table
from torsion.output.report_figures import csv_of, file_name
from torsion.output.table_text import file_name as table_file
from torsion.output.table_text import table_text

SAVED = """async ([tables, figures]) => {  // what every button saves: name and text
    const saved = [], click = HTMLAnchorElement.prototype.click, make = URL.createObjectURL;
    let blob = null;
    URL.createObjectURL = (one) => { blob = one; return make(one); };
    HTMLAnchorElement.prototype.click = function () { saved.push([this.download, blob]); };
    document.querySelectorAll([tables, figures].join()).forEach((one) => one.click());
    HTMLAnchorElement.prototype.click = click;
    URL.createObjectURL = make;
    return Promise.all(saved.map(async ([name, one]) => [name, await one.text()]));
}"""
BUTTONS = ["caption button", "figure .tools button[aria-label^=CSV]"]


@pytest.mark.parametrize("scene", [*EVERY, "joint_run_up"])
def test_every_figure_and_table_is_saved_as_the_command_writes_it(
    opens: Callable[..., Opened], scene: str
) -> None:
    page = opens(scene)
    saved = dict(page.page.evaluate(SAVED, BUTTONS))
    wanted = {file_name(one): csv_of(one) for one in page.report.figures.values() if one.plots}
    for item in page.report.document.body:
        if isinstance(item.block, Table) and item.number:
            wanted[table_file(item.number)] = table_text(item.number, item.block)
    assert set(saved) == set(wanted)
    thinned = {name for name, text in saved.items() if text.startswith("# long lines:")}
    assert {name for name in wanted if saved[name] != wanted[name]} == thinned
    for name in thinned:
        comment, rest = saved[name].split("\n", 1)
        assert comment.endswith("--csv writes all")
        rows = set(wanted[name].splitlines())
        assert set(rest.splitlines()) <= rows | {""}
        assert len(rest) < len(wanted[name])


def test_a_click_saves_a_file(usv: Opened, tmp_path: Path) -> None:
    for button, name in (
        (usv.button("torque-1-0", "CSV"), "figure-torque-1-0.csv"),
        (usv.page.get_by_role("button", name="CSV of Table 2.1"), "table-2.1.csv"),
    ):
        with usv.page.expect_download() as waiting:
            button.click()
        assert waiting.value.suggested_filename == name
        waiting.value.save_as(tmp_path / name)
    figure = usv.report.figures["torque-1-0"]
    assert (tmp_path / "figure-torque-1-0.csv").read_text(encoding="utf-8") == csv_of(figure)
