"""Blocks on the terminal: which stand there, how many rows, and what a narrow one may cut."""

import io
import re
from collections.abc import Sequence
from pathlib import Path

import pytest
from rich.console import Console
from tests.contracts.frozen import solved

from torsion.findings import Findings
from torsion.output.blocks import Block, Column, Heading, Paragraph, Points, Table
from torsion.output.check_words import rank
from torsion.output.document import Cover, Document, document, numbered
from torsion.output.numbers import number
from torsion.output.pages.terminal import progress, screen, show, summary
from torsion.rules.verdict_line import Checks

COLUMNS = (
    Column("Shaft", short="shaft", align="left"),
    Column("Left out"),
    Column("Torque", "N m", short="N m"),
)


def printed(blocks: Sequence[Block], findings: Findings, width: int = 60) -> list[str]:
    """The lines of a console, without what is empty."""
    stream = io.StringIO()
    console = Console(file=stream, width=width, color_system=None)
    made = Document(Cover("title", "scene", ()), tuple(numbered(blocks)))
    for item in screen(made, width):
        console.print(item)
    return [line.rstrip() for line in stream.getvalue().splitlines() if line.strip()]


def table(rows: int) -> Table:
    return Table(
        COLUMNS,
        tuple((f"s{k}", "no", f"{k}.5") for k in range(rows)),
        "caption",
        short="All of tau_{C}",
    )


@pytest.mark.parametrize(("rows", "more"), [(12, None), (13, 1), (15, 3)])
def test_twelve_rows_of_a_table_are_shown_and_the_others_counted(
    bare: Findings, rows: int, more: int | None
) -> None:
    lines = printed([table(rows)], bare)
    assert lines[:2] == ["scene", "All of tau_C"]
    assert lines[2].split() == ["shaft", "N", "m"]
    shown = [line.split() for line in lines[3 : 3 + 12]]
    assert shown == [[f"s{k}", f"{k}.5"] for k in range(12)]
    behind = " ".join(word for line in lines[3 + 12 :] for word in line.split())
    assert behind == ("" if more is None else f"and {more} more rows in the report")


def test_a_table_begins_at_the_edge_with_words_to_the_left_and_numbers_to_the_right(
    bare: Findings,
) -> None:
    _, _, head, first, *_, last = printed([table(11)], bare)
    assert head.startswith("shaft")
    assert first.startswith("s0")
    assert last.startswith("s10")
    assert len(head) == len(first) == len(last)


def test_only_what_is_brief_stands_there_and_what_belongs_at_the_end_comes_last(
    bare: Findings,
) -> None:
    blocks = [
        Heading("Verdict", at_end=True),
        Paragraph("passed", "pass", brief=True),
        Heading("A section", 2),
        Paragraph("with care", brief=True),
        Heading("Loads"),
        Paragraph("not here"),
        Points(("nor here",)),
        Points(("one", "tau_{C} two"), brief=True),
        Table(COLUMNS, (), short="Empty"),
        Table(COLUMNS, (("x", "y", "1"),)),
    ]
    assert printed(blocks, bare) == ["scene", "- one", "- tau_C two", "passed", "with care"]


def test_a_narrow_terminal_folds_or_cuts_names_and_no_number(bare: Findings) -> None:
    columns = (Column("A", short="A", align="left"), Column("C", short="C"))
    rows = (("abcdefghijklmnopqrst", "≥ 12345678.90123"), ("x", "2 ∠ 40°"))
    *_, first, second, third, last = printed([Table(columns, rows, short="t")], bare, width=26)
    assert first.split() == ["abcdefgh", "≥", "12345678.90123"]
    assert (second, third) == ("ijklmnop", "qrst")
    assert last.split() == ["x", "2", "∠", "40°"]
    made = Document(
        Cover("title", "scene", ()), tuple(numbered([Table(columns, rows, rows_in_summary=2)]))
    )
    stream = io.StringIO()
    Console(file=stream, width=26, color_system=None).print(*summary(made, 26))
    first, second, _ = stream.getvalue().splitlines()[-3:]
    assert first.split() == ["abcdefgh", "≥", "12345678.90123"]
    assert second.strip() == "ijklmno…"


def test_a_column_of_empty_words_is_printed(bare: Findings) -> None:
    columns = (Column("A", short="A", align="left"), Column("C", short="C"))
    assert printed([Table(columns, (("", "1.5"),), short="t")], bare)[-1].split() == ["1.5"]


def test_marks_colour_the_last_cell_of_their_row(bare: Findings) -> None:
    stream = io.StringIO()
    marked = Table(
        COLUMNS,
        (("a", "", "1"), ("b", "", "2"), ("c", "", "3")),
        short="t",
        marks=("", "fail", "pass"),
    )
    made = Document(Cover("title", "scene", ()), tuple(numbered([marked])))
    Console(file=stream, width=60, force_terminal=True, color_system="standard").print(
        *screen(made)[1:]
    )
    text = stream.getvalue()
    assert re.findall(r"\x1b\[([\d;]+)m +(\d)\x1b", text) == [("1;31", "2"), ("32", "3")]


def test_the_place_of_the_page_and_the_time_stand_last(
    bare: Findings, capsys: pytest.CaptureFixture[str]
) -> None:
    stream = io.StringIO()
    show(document(bare), Path("out"), Console(file=stream, width=100, color_system=None))
    *_, steps, place = stream.getvalue().splitlines()
    assert place == f"Report: {Path('out') / 'report.html'}"
    total = sum(line.seconds for line in bare.plan.done)
    assert steps == f"{len(bare.plan.done)} steps in {total:.2f} s"
    show(document(bare))
    assert "two discs" in capsys.readouterr().out
    assert "Report:" not in stream.getvalue().splitlines()[-2]


def test_progress_leaves_nothing_behind(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("FORCE_COLOR", "1")
    monkeypatch.setenv("COLUMNS", "100")
    with progress() as report:
        report("modes", 0.5)
    error = capsys.readouterr().err
    assert "modes" in error
    assert (
        error.rpartition("\x1b[2K")[2].strip() == ""
    )  # the line is erased, and nothing comes behind it
    assert "modes" in error.rpartition("\x1b[2K")[0]


def test_no_word_of_a_verdict_is_cut_at_80_columns(bare: Findings) -> None:
    heads = ("Rule", "Component", "What", "Clause")
    columns = (
        *(Column(head, short=head, align="left") for head in heads),
        Column("Value", "N/mm2", short="N/mm2"),
        Column("Limit", "N/mm2", short="limit"),
        Column("Verdict", short="verdict", align="left"),
    )
    long = "abcdefghijklmnop"
    row = (long, long, f"{long} {long} {long}", long, "1234.5678", "2345.6789")
    rows = ((*row, "PASS with restrictions"), (*row, "NOT JUDGED"))
    lines = printed(
        [Table(columns, rows, short="t", marks=("restricted", "not judged"))], bare, width=80
    )
    for word in ("PASS with", "restrictions", "NOT JUDGED"):
        assert any(line.endswith(word) for line in lines), lines


@pytest.mark.parametrize(
    "scene",
    [
        "usv",
        "haixun_06402",
        "v12_generator_set",
        "two_stroke_ship",
        "ferry_cases",
        "toleranced_drive",
        "fan_start",
        "rao",
    ],
)
def test_the_summary_has_at_most_25_lines_of_80_columns_with_the_verdict_first(scene: str) -> None:
    findings = solved(scene)
    stream = io.StringIO()
    show(
        document(findings),
        Path("out"),
        Console(file=stream, width=80, color_system=None),
        is_verbose=False,
    )
    lines = stream.getvalue().splitlines()
    assert len(lines) <= 25
    assert max(map(len, lines)) <= 80
    cover = document(findings).cover
    verdict = lines[1 + (cover.identity != cover.subtitle)]
    assert verdict.startswith(("✓", "!", "?", "✗"))
    assert lines[-1] == "Report: out/report.html"
    worst = sorted(findings.need(Checks).lines, key=rank)[:5] if not findings.cases else ()
    for check in worst:
        shown = [line for line in lines if number(check.value) in line]
        assert shown, check
