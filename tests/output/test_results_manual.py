"""The manual of the results, as it is written in docs."""

import runpy
from pathlib import Path

import pytest

from torsion.output import results_manual
from torsion.output.results_json import LEGEND, documented

WRITTEN = (Path(__file__).parents[2] / "docs" / "results.md").read_text(encoding="utf-8")


def test_the_manual_of_results_is_that_of_the_declarations() -> None:
    assert results_manual.manual() == WRITTEN, "write docs/results.md anew: python -m torsion.output.results_manual"


def test_the_page_is_printed_by_the_module_itself(capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(results_manual.__file__)
    assert capsys.readouterr().out == ""
    runpy.run_path(results_manual.__file__, run_name="__main__")
    assert capsys.readouterr().out == WRITTEN


def test_every_key_stands_once_in_the_section_of_its_result() -> None:
    sections = {part.split("`", 1)[0]: part for part in WRITTEN.split("\n## `")[1:]}
    for key in documented():
        row = f"| `{key.path}` | {key.unit} | {', '.join(key.axes)} | {key.meaning.replace('|', chr(92) + '|')} |\n"
        assert sections[key.path.split(".")[0].removesuffix("[]")].count(row) == 1
    for name, words in LEGEND.items():
        assert f"- {name.replace('_', ' ')}: {words}\n" in WRITTEN
