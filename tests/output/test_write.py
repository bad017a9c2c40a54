"""A report is written whole or not at all."""

from datetime import date
from pathlib import Path

import pytest

from torsion.findings import Findings
from torsion.output import html
from torsion.output import results_json as json
from torsion.output.write import write


def test_the_folder_holds_the_report_and_nothing_else(bare: Findings, tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    write(bare, folder, today=date(2024, 1, 1))
    assert sorted(path.name for path in folder.iterdir()) == ["report.html", "results.json"]
    assert "2024-01-01" in (folder / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize("module", [html, json], ids=["page", "results"])
def test_a_failed_run_leaves_the_earlier_report_whole(
    module: object, bare: Findings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(bare, tmp_path)
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(*args: object) -> str:
        raise RuntimeError("in the middle")

    monkeypatch.setattr(module, "html" if module is html else "write_json", fail)
    with pytest.raises(RuntimeError, match="in the middle"):
        write(bare, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_pdf_is_written_when_asked(undamped: Findings, tmp_path: Path) -> None:
    write(undamped, tmp_path, also=("pdf",))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "report.pdf", "results.json"]
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF-")


def test_the_series_of_an_earlier_report_do_not_stay_beside_a_later_one(bare: Findings, tmp_path: Path) -> None:
    (tmp_path / "series.npz").write_bytes(b"earlier")
    write(bare, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "results.json"]
