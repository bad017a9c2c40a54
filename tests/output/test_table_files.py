"""Every table of a report as CSV: what stands on the page, as programs read it."""

import csv
import io
import zipfile
from pathlib import Path

import pytest
from tests.contracts.frozen import solved

import torsion
from torsion.output.blocks import Table, table
from torsion.output.chapters import chapters
from torsion.output.document import document
from torsion.output.files.data_tables import report_tables as archive
from torsion.output.numbers import number
from torsion.output.table_text import figures, one_line, table_text
from torsion.output.write import write

TEXT = """
name: two
train: [disc: {name: "a, b", inertia: 1.5e-9}, coupling: {stiffness: 6e5, source: list}, disc: {inertia: 3}]
"""


def test_every_table_with_a_number_is_a_file_with_its_rows(tmp_path: Path) -> None:
    found = torsion.run(torsion.parse(TEXT))
    made = document(found)
    stated = {
        item.number: item.block
        for item in made.body
        if isinstance(item.block, Table) and item.number
    }
    with zipfile.ZipFile(io.BytesIO(archive(made))) as files:
        assert sorted(files.namelist()) == sorted(
            f"{name.lower().replace(' ', '-')}.csv" for name in stated
        )
        for name, block in stated.items():
            caption, *lines = (
                files.read(f"{name.lower().replace(' ', '-')}.csv").decode().splitlines()
            )
            assert caption == f"# {name}: {block.caption}"
            head, *rows = csv.reader(lines)
            assert len(head) == len(block.columns)
            assert rows == figures(block)
    inertias = next(block for block in stated.values() if block.caption.startswith("Inertias"))
    assert (inertias.rows[0][0], figures(inertias)[0][2]) == ("a, b", "1.5e-09")
    assert archive(made) == archive(made)
    write(found, tmp_path)
    assert not (tmp_path / "tables.zip").exists()
    write(found, tmp_path, also=("tables",))
    assert zipfile.is_zipfile(tmp_path / "tables.zip")


@pytest.mark.parametrize(
    "scene", ["haixun_06402", "usv", "cardan_bearings", "twin_motor_ferry", "dredge_pump_line"]
)
def test_the_archive_of_a_report_holds_all_of_its_tables_and_all_of_their_cells(scene: str) -> None:
    found = solved(scene)
    tables = [block for block in chapters(found) if isinstance(block, Table)]
    with zipfile.ZipFile(io.BytesIO(archive(document(found)))) as files:
        written = [files.read(name).decode().splitlines() for name in files.namelist()]
    assert len(tables) == len(written) > 15
    for block, (caption, _, *lines) in zip(tables, written, strict=True):
        assert caption.endswith(f": {one_line(block.caption)}")
        assert list(csv.reader(lines)) == figures(block)


def test_a_number_in_a_column_of_words_is_a_number_of_the_csv_and_no_value_an_empty_cell() -> None:
    rows = [
        ("stiffness", number(-9.3381e-19)),
        ("limit", number(float("inf"))),
        ("mode", number(None)),
    ]
    _, *lines = table_text("Table 1", table("< What | < Value", rows)).splitlines()[1:]
    cells = [value for _, value in csv.reader(lines)]
    assert [float(value) for value in cells[:2]] == [-9.3381e-19, float("inf")]
    assert cells[2] == ""
    words = [("order", "2 ≈ 2.0000"), ("reason", "none – not requested"), ("phase", "3 ∠ 40°")]
    assert figures(table("< What | < Value", words)) == [list(row) for row in words]
