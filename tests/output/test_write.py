"""A report is written whole or not at all."""

import os
import shutil
from datetime import date
from pathlib import Path

import pytest

from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.pages import html, pdf
from torsion.output.stored import stored_report as json
from torsion.output.stored.stored_report import naming
from torsion.output.write import write, write_texts


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

    def fail(*args: object, **settings: object) -> str:
        raise RuntimeError("in the middle")

    monkeypatch.setattr(module, "html" if module is html else "write_json", fail)
    with pytest.raises(RuntimeError, match="in the middle"):
        write(bare, tmp_path)
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_a_pdf_is_written_when_asked(undamped: Findings, tmp_path: Path) -> None:
    write(undamped, tmp_path, also=("pdf",))
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "report.html",
        "report.pdf",
        "results.json",
    ]
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF-")


def test_where_a_pdf_cannot_be_made_all_else_is_written_and_its_fault_told(
    undamped: Findings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*args: object) -> bytes:
        raise InputError([Fault(("document", "logo"), "odd", "other")])

    monkeypatch.setattr(pdf, "pdf", fail)
    with pytest.raises(
        InputError, match="the pdf cannot be made: odd; all other files are written"
    ):
        write(undamped, tmp_path, also=("pdf", "figures"))
    names = {path.name for path in tmp_path.iterdir()}
    assert {"report.html", "results.json", "figure-campbell.csv"} <= names
    assert "report.pdf" not in names


def earlier_names(folder: Path, *names: str) -> None:
    """Name these files in the results of a folder, with their checksum, as a report that has them does."""
    file = folder / "results.json"
    file.write_text(
        naming(file.read_text(encoding="utf-8"), ["results.json", *names]), encoding="utf-8"
    )


@pytest.mark.parametrize(
    "name", ["notes.txt", "thesis.yaml", "data.csv", "results.json.bak", "cases/notes.txt"]
)
def test_no_file_that_a_report_cannot_have_is_removed_though_the_results_name_it(
    name: str, bare: Findings, tmp_path: Path
) -> None:
    write(bare, tmp_path)
    (tmp_path / "cases").mkdir()
    (tmp_path / name).write_text("a user's", encoding="utf-8")
    earlier_names(tmp_path, name)
    write(bare, tmp_path)
    assert (tmp_path / name).read_text(encoding="utf-8") == "a user's"


def test_nothing_is_removed_through_a_symbolic_link(bare: Findings, tmp_path: Path) -> None:
    own, out = tmp_path / "own", tmp_path / "out"
    own.mkdir()
    (own / "report.pdf").write_bytes(b"a user's")
    write(bare, out)
    (out / "warm").symlink_to(own)
    (out / "modes.vtu").symlink_to(own / "report.pdf")
    earlier_names(out, "warm/report.pdf", "modes.vtu")
    write(bare, out)
    assert (own / "report.pdf").read_bytes() == b"a user's"
    assert (out / "modes.vtu").is_symlink()


def test_results_behind_a_symbolic_link_name_no_file_to_remove(
    bare: Findings, tmp_path: Path
) -> None:
    own, out = tmp_path / "own", tmp_path / "out"
    write(bare, own)
    earlier_names(own, "report.pdf")
    out.mkdir()
    (out / "results.json").symlink_to(own / "results.json")
    (out / "report.pdf").write_bytes(b"a user's")
    write(bare, out)
    assert (out / "report.pdf").read_bytes() == b"a user's"


@pytest.mark.parametrize("earlier", ["5", "null", "1.5", '"report.pdf"', '{"report.pdf": 1}'])
def test_earlier_results_without_a_list_of_names_name_no_file_to_remove(
    earlier: str, bare: Findings, tmp_path: Path
) -> None:
    (tmp_path / "report.pdf").write_bytes(b"a user's")
    (tmp_path / "results.json").write_text(earlier, encoding="utf-8")
    write(bare, tmp_path)
    assert (tmp_path / "report.pdf").read_bytes() == b"a user's"
    assert (tmp_path / "report.html").exists()


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the system has no named pipes")
def test_a_pipe_that_is_named_as_the_results_is_replaced(bare: Findings, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "results.json")
    write(bare, tmp_path)
    assert (tmp_path / "results.json").is_file()


def test_nothing_is_written_where_a_folder_has_the_name_of_a_file(
    bare: Findings, tmp_path: Path
) -> None:
    (tmp_path / "results.json").mkdir()
    with pytest.raises(IsADirectoryError):
        write(bare, tmp_path)
    assert [path.name for path in tmp_path.rglob("*")] == ["results.json"]


def test_the_series_of_an_earlier_report_do_not_stay_beside_a_later_one(
    bare: Findings, tmp_path: Path
) -> None:
    write(bare, tmp_path)
    earlier_names(tmp_path, "series.npz")
    (tmp_path / "series.npz").write_bytes(b"earlier")
    write(bare, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "results.json"]


def test_texts_and_bytes_are_written_into_a_new_or_an_old_folder(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "folder"
    for number in range(2):
        paths = write_texts({"a.txt": f"Größe {number}\n", "b.bin": b"\x00\xff"}, folder)
        assert paths == [folder / "a.txt", folder / "b.bin"]
        assert paths[0].read_bytes() == f"Größe {number}\n".encode()
        assert paths[1].read_bytes() == b"\x00\xff"
        assert sorted(folder.iterdir()) == paths


def test_series_that_belong_to_a_report_are_kept_with_it(tmp_path: Path) -> None:
    def both(path: Path) -> list[Path]:
        beside = path.with_name("series.npz")
        path.write_text("{}")
        beside.write_bytes(b"new")
        return [path, beside]

    write_texts({"results.json": both, "page.html": "x"}, tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "page.html",
        "results.json",
        "series.npz",
    ]


def test_the_cause_of_a_failure_is_what_is_raised(tmp_path: Path) -> None:
    def broken(path: Path) -> list[Path]:
        shutil.rmtree(path.parent)
        raise OSError("disk is gone")

    with pytest.raises(OSError, match="disk is gone"):
        write_texts({"a.txt": broken}, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_without_a_date_the_report_bears_that_of_today(bare: Findings, tmp_path: Path) -> None:
    before = date.today()
    facts = dict(write(bare, tmp_path).cover.facts)
    assert before.isoformat() <= facts["Date"] <= date.today().isoformat()
    assert dict(write(bare, tmp_path, today=date(2024, 1, 1)).cover.facts)["Date"] == "2024-01-01"
