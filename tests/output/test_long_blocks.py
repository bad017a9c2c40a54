"""What is too long for a page: tables, input, sentences, sketches and tables of Holzer, each said in the report."""

import csv
import io
import zipfile
from collections.abc import Callable, Iterable
from pathlib import Path

import pytest

import torsion
from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Figure, Paragraph, Table, Verbatim, table
from torsion.output.chapters import plant, verdict
from torsion.output.chapters.modes.natural_frequencies import all_modes, appendix, chapter
from torsion.output.document import FIRST, GAP, LAST, MOST_LINES, MOST_ROWS, document, shortened
from torsion.output.files.data_tables import report_tables as archive
from torsion.output.pages.html import html
from torsion.output.write import write
from torsion.results import listed

COLUMNS = (Column("No."), Column("Name", align="left"), Column("Torque", "N m"), Column("Ratio"))


def chain(number: int, between: str = "coupling: {stiffness: 1e6}") -> str:
    """A scene of so many equal discs."""
    train = "".join(f"  - {between}\n  - disc: {{inertia: 1}}\n" for _ in range(number - 1))
    return f"name: long\ntrain:\n  - disc: {{name: first, inertia: 1}}\n{train}analyses: {{modes: {{count: 4}}}}\n"


@pytest.fixture(scope="module")
def long() -> Findings:
    """A train of more stations than a table has rows."""
    return torsion.run(torsion.parse(chain(1_100), "long.yaml"))


@pytest.mark.parametrize("number", [MOST_ROWS, MOST_ROWS + 1, 3_000])
def test_a_long_table_has_its_first_and_last_rows_and_says_how_many_more(number: int) -> None:
    whole = table(COLUMNS, [(k, f"c{k}", 1.0 * k, 1) for k in range(1, number + 1)], "Torques")
    made, beside = shortened(whole, "Table 3.2", "report")
    if number == MOST_ROWS:
        assert made is whole
        assert not beside
        return
    assert isinstance(made, Table)
    places = [*range(1, FIRST + 1), *range(number - LAST + 1, number + 1)]
    assert [row for row in made.rows if row[0] != GAP] == [whole.rows[k - 1] for k in places]
    assert made.rows[FIRST] == (GAP,) * 4
    assert len(made.rows) == FIRST + 1 + LAST
    assert f"{number - len(places):,} more rows in report-table-3.2.csv" in made.caption
    ((name, text),) = beside.items()
    assert name == "report-table-3.2.csv"
    caption, *lines = text().splitlines()
    assert caption == "# Table 3.2: Torques"
    assert [row[0] for row in csv.reader(lines)] == ["No.", *(str(k) for k in range(1, number + 1))]


def test_rows_that_do_not_pass_are_counted_where_they_are_left_out() -> None:
    marks = ["pass", "fail", "not kept"] * 130
    whole = table(COLUMNS, [(k, "c", 1.0, 1) for k in range(390)], "Checks", marks=marks)
    made, _ = shortened(whole, "Table 1.1", "report")
    assert isinstance(made, Table)
    hidden = 260 - MOST_ROWS - sum(one != "pass" for one in marks[-LAST:])
    assert f"more rows in report-table-1.1.csv, {hidden} of them not passed" in made.caption
    assert f"the first {MOST_ROWS} that do not pass" in made.caption
    assert len(made.marks) == len(made.rows)


def test_every_row_that_does_not_pass_is_printed_up_to_the_most_rows() -> None:
    marks = ["pass"] * 100 + ["fail"] * 40 + ["not kept"] * 50 + ["pass"] * 110
    whole = table(COLUMNS, [(k, "c", 1.0, 1) for k in range(300)], "Checks", marks=marks)
    made, _ = shortened(whole, "Table 1.1", "report")
    assert isinstance(made, Table)
    assert (made.marks.count("fail"), made.marks.count("not kept")) == (40, 50)
    assert "all 90 that do not pass" in made.caption
    assert "of them not passed" not in made.caption


@pytest.mark.parametrize("text", ["a: 1\n" * (MOST_LINES + 1), "a: " + "1" * 300_000])
def test_a_long_input_stands_beside_the_report(text: str) -> None:
    made, beside = shortened(Verbatim(text), "", "report")
    assert isinstance(made, Paragraph)
    assert "report-input.yaml" in made.text
    assert beside["report-input.yaml"]() == text
    short = Verbatim("a: 1\n" * MOST_LINES)
    assert shortened(short, "", "report") == (short, {})


def test_the_page_of_a_long_train_is_small_and_its_files_hold_every_row(
    long: Findings, tmp_path: Path
) -> None:
    write(long, tmp_path)
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert len(page) < 400_000
    names = sorted(path.name for path in tmp_path.iterdir())
    tables = [name for name in names if "-table-" in name]
    assert names == sorted([*tables, "report-input.yaml", "report.html", "results.json"])
    assert len(tables) == 4
    for name in names[:-2]:
        assert name in page
    assert (tmp_path / "report-input.yaml").read_text(encoding="utf-8") == chain(1_100)
    components = next(
        name for name in tables if "Components" in (tmp_path / name).read_text(encoding="utf-8")
    )
    assert (
        len((tmp_path / components).read_text(encoding="utf-8").splitlines()) == 2 + 2 * 1_100 - 1
    )
    write(torsion.run(torsion.parse(chain(3))), tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["report.html", "results.json"]


def test_the_archive_of_tables_is_whole(long: Findings) -> None:
    made = document(long)
    with zipfile.ZipFile(io.BytesIO(archive(made))) as files:
        lengths = {name: files.read(name).count(b"\n") for name in files.namelist()}
    assert max(lengths.values()) == 2 + 2 * 1_100 - 1
    assert "long" not in html(made)[:10]


def test_of_a_long_train_the_first_modes_have_a_holzer_table_and_the_report_says_so(
    long: Findings,
) -> None:
    def count(chapter: Callable[[Findings], Iterable[Block]], found: Findings) -> int:
        return sum(
            isinstance(one, Table) and one.caption.startswith("Holzer") for one in chapter(found)
        )

    assert (count(appendix, long), count(all_modes, long)) == (1, 2)
    assert "The first 3 modes have a Holzer table." in sentences(list(all_modes(long)))
    few = torsion.run(torsion.parse(chain(20)))
    assert (count(appendix, few), count(all_modes, few)) == (2, 2)


def sentences(blocks: list[Block]) -> list[str]:
    return [one.text for one in blocks if isinstance(one, Paragraph)]


def test_a_mode_of_a_long_train_has_no_dot_for_each_station(long: Findings) -> None:
    figure = next(one for one in chapter(long) if isinstance(one, Figure))
    assert all(marks.x.size == 0 for panel in figure.plots for marks in panel.marks)


def test_names_in_a_sentence_are_bounded() -> None:
    assert listed(["a"] * 13) == ", ".join(["a"] * 13)
    assert listed([f"n{k}" for k in range(10_000)]).endswith("n11 and 9,988 more")


def test_a_train_too_long_for_a_page_has_no_sketch_on_the_cover(long: Findings) -> None:
    short = torsion.run(torsion.parse(chain(plant.MOST_LINKS + 1)))
    for findings, names in ((short, ["utilisation"]), (long, [])):
        figures = [block for block in verdict.blocks(findings) if isinstance(block, Figure)]
        assert [figure.name for figure in figures] == names
    assert len(plant.sketch(long).links) == 1099
