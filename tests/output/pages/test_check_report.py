"""The comparison of the models in the report, on the terminal and as JSON."""

import io
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from docs.site.results_manual import documented
from rich.console import Console

import torsion
from torsion.analyses.compare.side_by_side import Compared
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.model_comparison import chapter
from torsion.output.document import document
from torsion.output.pages.html import html
from torsion.output.pages.terminal import screen
from torsion.output.reports import REPORTS
from torsion.output.stored.results_json import results, text
from torsion.output.write import write

KEYS = {key.path: key.meaning for key in documented()}

SCENE = Path(__file__).parents[3] / "shafting_specs" / "geared_branch_check.yaml"
COARSE = ("length:", "segments: 1, length:")


def solved(*changes: tuple[str, str]) -> Findings:
    written = SCENE.read_text(encoding="utf-8").replace("steps: 181", "steps: 13")
    for old, new in changes:
        written = written.replace(old, new)
    return torsion.run(torsion.parse(written, "scene.yaml"))


@pytest.fixture(scope="module")
def good() -> Findings:
    """All models within the tolerance."""
    return solved()


@pytest.fixture(scope="module")
def coarse() -> Findings:
    """A lumped model of one segment a shaft, which lacks modes."""
    return solved(COARSE)


def printed(items: list[Any]) -> str:
    target = io.StringIO()
    console = Console(file=target, width=80, no_color=True)
    for item in items:
        console.print(item)
    return target.getvalue()


def leaves(value: Any, at: str) -> set[str]:
    """Every path down to the documented leaves."""
    if at in KEYS:
        return {at}
    if isinstance(value, dict):
        return set().union(*(leaves(v, f"{at}.{k}") for k, v in value.items()))
    if isinstance(value, list):
        return set().union(*(leaves(v, f"{at}[]") for v in value))
    return {at}


def test_every_key_is_documented_and_every_documented_key_is_there(good: Findings) -> None:
    assert leaves(results(good)["check"], "check") == {
        key for key in KEYS if key.startswith("check.")
    }


def test_what_a_model_does_not_have_is_null_in_strict_json(coarse: Findings) -> None:
    stated = json.loads(text(coarse), parse_constant=pytest.fail)["check"]
    lumped = stated["models"][1]
    assert stated["failed"] == ["lumped"]
    assert (
        lumped["frequency_Hz"][4:]
        == lumped["frequency_error"][4:]
        == lumped["shape_error"][4:]
        == [None, None]
    )
    assert lumped["modes_below"] == 4
    assert json.loads(text(coarse, ("check",)))["check"]["models"][1] == lumped


def test_numbers_come_back_to_the_last_digit(good: Findings) -> None:
    stated = json.loads(text(good))["check"]
    for model, back in zip(good.need(Compared).all_models, stated["models"], strict=True):
        np.testing.assert_array_equal(back["frequency_error"], model.frequency_error)
        np.testing.assert_array_equal(back["torques"]["error"], model.torques.error)


def test_the_chapter_has_verdict_and_errors(good: Findings) -> None:
    blocks = list(chapter(good))
    assert (
        next(block.text for block in blocks if isinstance(block, Heading))
        == "Comparison of the models"
    )
    tables_found = [block for block in blocks if isinstance(block, Table)]
    assert tables_found[0].marks == ("", "pass", "pass")
    assert [row[0] for row in tables_found[0].rows] == ["exact", "lumped", "fem"]
    assert len(tables_found[1].rows) == 6
    assert any(
        isinstance(b, Paragraph) and b.kind == "pass" and "within 0.1 %" in b.text for b in blocks
    )


def test_missing_modes_and_a_failed_model_stand_in_the_chapter(coarse: Findings) -> None:
    blocks = list(chapter(coarse))
    summary, by_mode = (block for block in blocks if isinstance(block, Table))
    assert summary.marks == ("", "fail", "pass")
    assert summary.rows[1][1] == "∞"
    assert [row[4] for row in summary.rows] == ["6", "4", "6"]
    assert by_mode.rows[5][2:5] == ("–", "∞", "∞")
    words = " ".join(block.text for block in blocks if isinstance(block, Paragraph))
    assert (
        "FAIL: the model lumped is not within 0.1 % of the exact model (torques: 1 %); fem is."
        in words
    )
    assert "within 0.1 %" in html(document(coarse, report=REPORTS["check"]))


def test_the_terminal_fits_eighty_columns_and_says_the_verdict(
    good: Findings, coarse: Findings
) -> None:
    assert (
        max(
            len(line)
            for line in printed(screen(document(coarse, report=REPORTS["check"]))).splitlines()
        )
        <= 80
    )
    assert "fem are within 0.1 % of the exact model" in printed(
        screen(document(good, report=REPORTS["check"]))
    ).replace("\n", " ")
    assert "lumped is not within" in printed(screen(document(coarse)))


def test_the_terminal_shows_columns_of_the_tables_of_the_report(good: Findings) -> None:
    _, by_mode = (block for block in chapter(good) if isinstance(block, Table))
    lines = printed(screen(document(good, report=REPORTS["check"]))).splitlines()
    assert ["mode", "exact,", "Hz", "lumped", "error,", "%", "fem", "error,", "%"] in [
        line.split() for line in lines
    ]
    for row in by_mode.rows:
        assert [row[0], row[1], row[3], row[6]] in [line.split() for line in lines]


def test_a_train_without_shafts_has_one_sentence() -> None:
    discs = "train: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]"
    found = torsion.run(torsion.parse(f"name: x\n{discs}\nanalyses:\n  check:\n"))
    _, sentence = chapter(found)
    assert "all models are the same" in sentence.text
    assert results(found)["check"]["models"] == []
    assert "all models are the same" in printed(screen(document(found)))


def test_a_study_that_does_not_ask_has_no_chapter() -> None:
    found = torsion.run(
        torsion.parse("name: x\ntrain: [disc: {inertia: 2}, shaft: {length: 1, diameter: 9 mm}]")
    )
    assert list(chapter(found)) == []
    assert results(found)["check"] is None
    assert "MAC" not in printed(screen(document(found, report=REPORTS["check"])))


def test_both_files_are_written_or_none(good: Findings, tmp_path: Path) -> None:
    write(good, tmp_path, "check")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["check.html", "check.json"]
    page = (tmp_path / "check.html").read_text(encoding="utf-8")
    assert "mathdefault" not in page
