"""Pages with files, commands and Python: each is run from top to bottom in an empty folder, as a reader would."""

import io
import re
import shlex
from contextlib import redirect_stdout
from pathlib import Path

import pytest
from typer.testing import CliRunner

from torsion.cli import app

DOCS = Path(__file__).parents[1] / "docs"
PAGES = (
    "tutorials/first-report", "tutorials/pump-train-api", "python", "how-to/drives/cardan-shaft",
    "how-to/drives/ship-cpp", "how-to/drives/motor-start", "how-to/drives/wind-turbine-gearbox",
)  # fmt: skip
FENCE = re.compile(r"^```(yaml|sh|python|text)\n(.*?)^```", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"# ([\w.]+\.yaml)\n")  # first line of a block: the file that it is
COMMAND = re.compile(r"torsion (.*?)(?:  # exit status (\d))?")


def command(line: str) -> str:
    """What a command prints; its exit status is 0 unless the page says another."""
    found = COMMAND.fullmatch(line)
    assert found, f"not a command of torsion: {line}"
    done = CliRunner().invoke(app, shlex.split(found[1]), env={"COLUMNS": "160", "NO_COLOR": "1", "TERM": "dumb"})
    assert done.exit_code == int(found[2] or 0), done.output
    return done.stdout


def ran(code: str, names: dict[str, object]) -> str:
    """What Python prints; its names go on in the next block."""
    with redirect_stdout(io.StringIO()) as printed:
        exec(compile(code, "<page>", "exec"), names)
    return printed.getvalue()


def lacking(shown: str, printed: str) -> list[str]:
    """The lines of a page that were not printed, or not in this order; spaces do not count."""
    left, missed = " ".join(printed.split()), []
    for line in (" ".join(line.split()) for line in shown.splitlines()):
        _, found, behind = left.partition(line)
        if not found and line:
            missed.append(line)
        left = behind if found else left
    return missed


@pytest.mark.parametrize("page", PAGES)
def test_a_page_does_what_it_says(page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    printed, names = "", dict[str, object]()
    for language, text in FENCE.findall((DOCS / f"{page}.md").read_text(encoding="utf-8")):
        if language == "yaml" and (named := FILE.match(text)):
            Path(named[1]).write_text(text, encoding="utf-8")
        elif language == "sh":
            printed = "".join(map(command, text.splitlines()))
        elif language == "python":
            printed = ran(text, names)
        elif language == "text":
            assert not lacking(text, printed), printed


def test_what_was_not_printed_is_found() -> None:
    assert lacking("a  b\nc\n", "x a b\ny c") == []
    assert lacking("c\na b\n", "a b\nc") == ["a b"]
    assert lacking("d\n", "a b\nc") == ["d"]
