"""Marks between thousands, decimal commas, lists and dates of a spreadsheet are read as they are meant, or refused."""

import re
from pathlib import Path

import pytest
from tests.for_all import for_all

import torsion
from torsion.study import Study

HEAD = "kind;name;inertia [kg*m**2];stiffness [N*m/rad];length [mm];diameter [mm]\n"
ENDS = "disc;a;2;;;\n", "disc;b;3;;;\n"


def study(folder: Path, rows: str, separator: str = ";") -> Study:
    text = re.sub(";(?! )", separator, HEAD + ENDS[0] + rows + ENDS[1])
    (folder / "line.csv").write_text(text, encoding="utf-8")
    return torsion.parse("name: x\ntrain: {table: line.csv}\n", str(folder / "scene.yaml"))


def refused(folder: Path, rows: str, separator: str = ";") -> str:
    with pytest.raises(torsion.InputError) as caught:
        study(folder, rows, separator)
    return str(caught.value).removeprefix(f"{folder}/").split("\n")[0]


@for_all("separator", [";", "\t"])
@for_all(
    ("rows", "words"),
    [
        (
            "coupling;;;40.000;;\n",
            "line.csv:3:12: `40.000` may be thousands or decimals: every such number",
        ),
        ("coupling;;;40.000;;\nshaft;;;;4.500;150\n", "(write 40000 or 40.0)"),
        ("coupling;;;1,234;;\n", "`1,234` may be thousands or decimals"),
        ("coupling;;;1,234;;\n", "(write 1234 or 1,2340)"),
        ("coupling;;;-1.250 N*m/rad;;\n", "(write -1250 or -1.25)"),
        ("coupling;;;1.250.000;;\ncoupling;;1e5;40.000;;\n", "write 1250000)"),
        ("shaft;;;;900;[150.000; 140.000]\n", "(write 150000 or 150.0)"),
    ],
)
def test_numbers_of_which_none_shows_what_its_mark_is_are_refused(
    tmp_path: Path, rows: str, words: str, separator: str
) -> None:
    """`40.000` is 40 in one language and 40 000 in another."""
    assert words in refused(
        tmp_path, rows.replace("[150.000; 140.000]", '"[150.000; 140.000]"'), separator
    )


@for_all(
    ("rows", "stiffness"),
    [
        ("coupling;;;1.250;;\ncoupling;;;12.75;;\n", 1.25),
        ("coupling;;;1.250;;\ndisc;;0.125;;;\ncoupling;;;4;;\n", 1.25),
        ("coupling;;;1.2500;;\n", 1.25),
        ("coupling;;;1.250e3;;\n", 1250.0),
        ("coupling;;;1234.500;;\n", 1234.5),
        ("coupling;;;1,250;;\ncoupling;;;0,5;;\n", 1.25),
        ("coupling;;;1250;;\n", 1250.0),
        ("coupling;1.250;;40;;\n", 40.0),
    ],
)
@for_all("separator", [";", "\t"])
def test_one_number_that_can_only_be_a_decimal_tells_what_all_are(
    tmp_path: Path, rows: str, stiffness: float, separator: str
) -> None:
    assert study(tmp_path, rows, separator).train.springs[0].flexibility == 1 / stiffness


@for_all(
    ("rows", "words"),
    [
        (
            "shaft;;;;4500,5;[150,5]\n",
            "line.csv:3:17: `[150,5]` may be one number or a list (write 150,5 for",
        ),
        ("coupling;;[1,2];40;;\n", "`[1,2]` may be one number or a list"),
        ('coupling;;"[0,9, 0,6]";40;;\n', '"[0,9; 0,6]" for a list'),
        ("coupling;;[0,9,0,6];40;;\n", '"[0; 9; 0; 6]" for a list'),
        (
            "coupling;;[0,9; 0,6];40;;\n",
            'put a list that holds the separator in quotes: "[0.9; 0.6]"',
        ),
    ],
)
def test_a_comma_in_brackets_that_may_be_a_decimal_sign_is_refused(
    tmp_path: Path, rows: str, words: str
) -> None:
    assert words in refused(tmp_path, rows)


@pytest.mark.parametrize(
    ("rows", "given"),
    [
        ('coupling;;"[0,9; 0,6]";40;;\n', [2, 0.9, 0.6, 3]),
        ("coupling;;[1, 2];40;;\n", [2, 1, 2, 3]),
        ('coupling;;"[1; 2]";40;;\n', [2, 1, 2, 3]),
        ("coupling;;[1,2];40.5;;\n", [2, 1, 2, 3]),
        ("coupling;;[1.5,2];40;;\n", [2, 1.5, 2, 3]),
        ('coupling;;"[1,5; 2]";40,5;;\n', [2, 1.5, 2, 3]),
        ("coupling;2.5;[1, 2];40,5;;\n", [2, 1, 2, 3]),
    ],
)
def test_lists_in_brackets_are_read_by_the_decimal_sign_of_their_table(
    tmp_path: Path, rows: str, given: list[float]
) -> None:
    assert [one.given for one in study(tmp_path, rows).train.inertias] == given


@for_all(
    ("cell", "words"),
    [
        ("1'234.5", "has a mark between its thousands (write 1234.5)"),
        ("1’234", "has a mark between its thousands (write 1234)"),
        ("1 234.5", "has a mark between its thousands (write 1234.5)"),
        ("1\u202f234.5", "has a mark between its thousands (write 1234.5)"),
        ("1\xa0234 567 N*m/rad", "has a mark between its thousands (write 1234567)"),
        ("1.234.567", "has a mark between its thousands (write 1234567)"),
        (
            "1,234.5",
            "'1,234.5' has a comma in its number (write a decimal point, and no mark between thousands)",
        ),
        (
            "01.02.2024",
            "'01.02.2024' looks like a date (write the number; a spreadsheet makes dates of cells",
        ),
        ("2024-02-01", "looks like a date"),
        ("1/2/2024", "looks like a date"),
        ("01. Feb", "looks like a date"),
        ("2-May", "looks like a date"),
    ],
)
def test_what_is_wrong_with_a_number_is_said(tmp_path: Path, cell: str, words: str) -> None:
    assert words in refused(tmp_path, f"coupling;;;{cell};;\n")
