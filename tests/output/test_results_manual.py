"""The manual of the results, as it is written in docs."""

import runpy
import sys
from pathlib import Path

import pytest
from docs.site import results_manual
from docs.site.results_manual import documented

from torsion.output.stored.results_json import LEGEND

FOLDER = Path(__file__).parents[2] / "docs" / "reference" / "results"


def test_the_module_writes_the_pages(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", ["results_manual", str(tmp_path)])
    runpy.run_path(results_manual.__file__)
    assert not list(tmp_path.iterdir())
    runpy.run_path(results_manual.__file__, run_name="__main__")
    assert {
        path.name: path.read_text("utf-8") for path in tmp_path.iterdir()
    } == results_manual.pages()


def test_every_key_stands_once_on_the_page_of_its_result() -> None:
    pages = {path.stem: path.read_text(encoding="utf-8") for path in FOLDER.glob("*.md")}
    sections = pages | {part.split("`", 1)[0]: part for part in pages["index"].split("\n## `")[1:]}
    for key in documented():
        row = f"| `{key.path}` | {key.unit} | {', '.join(key.axes)} | {key.meaning.replace('|', chr(92) + '|')} |\n"
        assert sections[key.path.split(".")[0].removesuffix("[]")].count(row) == 1
    for name, words in LEGEND.items():
        assert f"- {name.replace('_', ' ')}: {words}\n" in pages["index"]
