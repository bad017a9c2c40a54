"""No control character of a file, or of its name, reaches a terminal or a report; names need not be UTF-8."""

import os
import shutil
import sys
from pathlib import Path

import pytest
from tests.contracts.frozen import SCENES
from tests.for_all import for_all
from typer.testing import CliRunner

import torsion
from torsion.cli import app
from torsion.errors import BAD_INPUT, SOLVED
from torsion.schema.scene_reader import parse

PAIR = """name: pair
train: [disc: {name: first, inertia: 2}, coupling: {name: rubber, stiffness: 120}, disc: {name: last, inertia: 3}]
"""
RED = "\x1b[31m"
SIGNS = (
    "\\e",
    "\\x1b",
    "\\u001b",
    "\\U0000001b",
    "\\b",
    "\\r",
    "\\x7f",
    "\\x9b",
    "\\N",
    "\\ud800",
    "\\0",
)
posix = pytest.mark.skipif(sys.platform != "linux", reason="names of files are bytes")


@for_all("sign", SIGNS)
@for_all("given", ["name: pair", "name: rubber", "disc:"])
def test_an_escape_for_a_control_character_is_refused_where_it_stands(
    given: str, sign: str
) -> None:
    key, _, value = given.partition(": ")
    text = PAIR.replace(given, f'{key}: "{value}{sign}[31m"' if value else f'"disc{sign}":', 1)
    with pytest.raises(torsion.InputError) as caught:
        parse(text)
    fault = caught.value.faults[0]
    assert (
        "is not allowed" in fault.message
        or "the backslash stands for no character" in fault.message
    )
    line = text.splitlines()[fault.line - 1]
    assert (
        line[fault.column - 1] == '"' or sign == "\\ud800"
    )  # which YAML itself refuses, at the escape
    assert sign in line


def test_line_breaks_and_tabs_may_stand_in_a_text() -> None:
    assert parse(PAIR + 'description: "first\\n\\tsecond"\n').description == "first\n\tsecond"


@pytest.mark.parametrize("sign", ["\x1b", "\x9b", "\x7f"])
def test_a_control_character_in_a_table_is_refused_where_it_stands(
    sign: str, tmp_path: Path
) -> None:
    rows = f"kind,name,inertia [kg*m**2]\ndisc,a{sign}[31m,1\n"
    (tmp_path / "rows.csv").write_text(rows, encoding="utf-8")
    (tmp_path / "scene.yaml").write_text("name: x\ntrain: {table: rows.csv}\n", encoding="utf-8")
    with pytest.raises(torsion.InputError, match="is not allowed") as caught:
        torsion.read(tmp_path / "scene.yaml")
    assert (caught.value.faults[0].line, caught.value.faults[0].column) == (2, 7)
    assert sign not in str(caught.value)


@posix
@pytest.mark.parametrize("command", ["solve", "plan", "sketch", "check", "report", "joint"])
def test_the_name_of_a_file_is_printed_without_control_characters(
    command: str, tmp_path: Path
) -> None:
    scene = tmp_path / f"{RED}scene.yaml"
    for text in (PAIR, PAIR.replace("inertia", "inertial"), None):
        scene.unlink() if text is None else scene.write_text(text, encoding="utf-8")
        target = tmp_path / f"{RED}out{'.svg' if command == 'sketch' else ''}"
        more = [] if command == "plan" else ["-o", str(target)]
        done = CliRunner().invoke(app, [command, str(scene), *more])
        assert done.exception is None or isinstance(done.exception, SystemExit)
        assert "\x1b" not in done.output
        assert "\x1b" not in "".join(path.read_text("utf-8") for path in tmp_path.rglob("*.html"))
        assert "\x1b" not in "".join(path.read_text("utf-8") for path in tmp_path.rglob("*.json"))


@posix
@pytest.mark.parametrize(
    ("command", "scene"),
    [
        ("solve", "keyed_shaft"),
        ("solve", "reciprocating_compressor"),
        ("solve", "measured_drive"),
        ("joint", "usv"),
        ("check", "keyed_shaft"),
        ("plan", "reciprocating_compressor"),
        ("sketch", "keyed_shaft"),
        ("sweep", "usv"),
    ],
)
def test_a_file_whose_name_is_not_utf_8_is_solved_and_reported(
    command: str, scene: str, tmp_path: Path
) -> None:
    """Also with a mesh, pressures and a signal in files beside it, whose paths the report shows."""
    folder = Path(os.fsdecode(os.fsencode(tmp_path) + b"/m\xff"))
    folder.mkdir()
    for path in SCENES[scene].parent.glob(f"{scene}*.csv"):
        shutil.copy(path, folder)
    shutil.copy(SCENES[scene].with_name("keyed_60_mm.msh"), folder)
    file = folder / os.fsdecode(b"s\xff.yaml")
    shutil.copy(SCENES[scene], file)
    target = folder / ("out.svg" if command == "sketch" else "out")
    more = ["--csv"] if command == "solve" else []
    if scene != "reciprocating_compressor":  # four PDFs, one for each case
        more += ["--pdf"] * len(more)
    done = CliRunner().invoke(
        app, [command, str(file), *([] if command == "plan" else ["-o", str(target)]), *more]
    )
    assert isinstance(done.exception, SystemExit | None), done.exception
    if command == "solve":
        assert done.exit_code in (SOLVED, 1)
        assert "s?.yaml" in (target / "report.html").read_text(encoding="utf-8")
        assert CliRunner().invoke(app, ["report", str(target)]).exit_code == done.exit_code
    else:
        assert done.exit_code in (SOLVED, 1, BAD_INPUT)


REORDERING = (
    "\u202e",
    "\u2066",
    "\u200f",
    "\u061c",
    "\u2028",
    "\u200b",
    "\u2060",
    "\u00ad",
    "\U000e0041",
)


@for_all("sign", REORDERING)
@for_all("old", ["name: pair", "name: rubber", "disc:", "train:"])
def test_a_character_that_reorders_or_hides_text_is_refused_where_it_stands(
    old: str, sign: str
) -> None:
    """Both as itself, also within a comment, and as an escape in quotes."""
    key, _, value = old.partition(": ")
    escape = f"\\U{ord(sign):08x}"
    raw = (
        f"{key}: {value}{sign}x"
        if value
        else f"# {sign}\n{old}"
        if old == "train:"
        else f'"disc{sign}":'
    )
    quoted = f'{key}: "{value}{escape}x"' if value else f'"{key.rstrip(":")}{escape}":'
    for text in (PAIR.replace(old, raw, 1), PAIR.replace(old, quoted, 1)):
        with pytest.raises(torsion.InputError) as caught:
            parse(text)
        fault = caught.value.faults[0]
        assert fault.message == f"the character U+{ord(sign):04X} is not allowed"
        assert fault.line is not None
        assert sign not in str(caught.value)


def test_a_character_that_reorders_text_is_refused_in_a_table_too(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text(
        "kind,name,inertia [kg*m**2]\ndisc,a\u202eb,1\n", encoding="utf-8"
    )
    (tmp_path / "scene.yaml").write_text("name: x\ntrain: {table: rows.csv}\n", encoding="utf-8")
    with pytest.raises(torsion.InputError, match="U\\+202E is not allowed") as caught:
        torsion.read(tmp_path / "scene.yaml")
    assert (caught.value.faults[0].line, caught.value.faults[0].column) == (2, 7)


@pytest.mark.parametrize("sign", ["\\n", "\\t", "\\x85"])
@pytest.mark.parametrize("old", ["name: pair", "name: rubber", "disc:"])
def test_a_name_and_a_key_stand_on_one_line(old: str, sign: str) -> None:
    key, _, value = old.partition(": ")
    with pytest.raises(torsion.InputError, match="is not allowed") as caught:
        parse(PAIR.replace(old, f'{key}: "{value}{sign}PASS"' if value else f'"disc{sign}":', 1))
    assert caught.value.faults[0].line is not None


def test_a_break_of_a_line_in_a_cell_is_a_blank(tmp_path: Path) -> None:
    (tmp_path / "rows.csv").write_text(
        'kind,name,inertia [kg*m**2]\ndisc,"a\nPASS",1\n', encoding="utf-8"
    )
    (tmp_path / "scene.yaml").write_text("name: x\ntrain: {table: rows.csv}\n", encoding="utf-8")
    assert torsion.read(tmp_path / "scene.yaml").train.parts[0].name == "a PASS"


def test_words_of_scripts_that_join_letters_are_names() -> None:
    """Persian, Hebrew and Indic words keep their letters and their joiners."""
    for word in (
        "\u0645\u06cc\u200c\u0634\u0648\u062f",
        "\u05e9\u05dc\u05d5\u05dd",
        "\u0915\u094d\u200d\u0937",
    ):
        assert parse(PAIR.replace("name: rubber", f"name: {word}")).train.parts[1].name == word
