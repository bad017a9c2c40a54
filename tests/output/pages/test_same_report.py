"""Two reports of one input differ in one line of times at most, and in nothing with SOURCE_DATE_EPOCH."""

import difflib
import re
from pathlib import Path

import pytest

from torsion.commands import solve

SCENE = Path(__file__).parents[3] / "shafting_specs" / "usv.yaml"


def page(folder: Path) -> list[str]:
    solve(SCENE, folder)
    return (folder / "report.html").read_text(encoding="utf-8").splitlines()


def test_two_reports_of_one_input_differ_in_one_line_of_times(tmp_path: Path) -> None:
    first, second = page(tmp_path / "a"), page(tmp_path / "b")
    changed = [line for line in difflib.ndiff(first, second) if line.startswith(("- ", "+ "))]
    assert len(first) == len(second)
    assert len(changed) in (0, 2)
    assert all("Computing time: " in line for line in changed)


def test_with_a_source_date_two_reports_of_one_input_are_the_same(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    first, second = page(tmp_path / "a"), page(tmp_path / "b")
    assert first == second
    assert re.search(r"2023-11-14", "\n".join(first))
    results = [(tmp_path / name / "results.json").read_bytes() for name in "ab"]
    assert results[0] == results[1]
