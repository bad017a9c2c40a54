"""Pages with files, commands and Python: each is run from top to bottom in an empty folder, as a reader would.

`python -m tests.test_pages` replaces every line of output that is not printed any more by the most similar new one.
"""

import contextlib
import difflib
import io
import re
import shlex
import shutil
import sys
import tempfile
from collections.abc import Iterator
from contextlib import redirect_stdout
from pathlib import Path
from typing import Any

import pytest
from typer.testing import CliRunner

from torsion.analyses import ANALYSES
from torsion.cli import app
from torsion.model import KINDS
from torsion.output.renderers import OUTPUTS
from torsion.rules import RULES

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
TABLES = sorted((ROOT / "shafting_specs").glob("*.csv"))  # files that pages name
PAGES = tuple(
    path.relative_to(DOCS).with_suffix("").as_posix()
    for path in sorted(DOCS.rglob("*.md"))
    if re.search(r"^```(?:sh|python)$", path.read_text(encoding="utf-8"), re.MULTILINE)
)
FENCE = re.compile(
    r"(?:^<!-- ([\w.]+\.csv) -->\n)?^```([a-z]*)\n(.*?)^```", re.MULTILINE | re.DOTALL
)
FILE = re.compile(r"# ([\w.]+\.(?:yaml|py))\n")  # first line of a block: the file that it is
COMMAND = re.compile(r"torsion (.*?)(?:  # exit status (\d))?")


def command(line: str) -> str:
    """What a command prints; its exit status is 0 unless the page says another."""
    found = COMMAND.fullmatch(line)
    assert found, f"not a command of torsion: {line}"
    done = CliRunner().invoke(
        app, shlex.split(found[1]), env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )
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


def outputs(page: str) -> list[tuple[str, str]]:
    """Run a page in the present folder: each output that it shows, and what was printed."""
    for source in TABLES:
        shutil.copy(source, source.name)
    printed, names, shown = "", dict[str, object](), []
    for table, language, text in FENCE.findall((DOCS / f"{page}.md").read_text(encoding="utf-8")):
        if table:
            Path(table).write_text(text, encoding="utf-8")
        elif language in ("yaml", "python") and (named := FILE.match(text)):
            Path(named[1]).write_text(text, encoding="utf-8")
        elif language == "sh":
            printed = "".join(map(command, text.splitlines()))
        elif language == "python":
            printed = ran(text, names)
        elif language == "text":
            shown.append((text, printed))
    return shown


def example_of_the_readme() -> tuple[str, str]:
    """The output that the README shows of its example, and what is printed, in the present folder."""
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    (model,), (shown,) = (
        re.findall(rf"^```{word}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)
        for word in ("yaml", "text")
    )
    Path("train.yaml").write_text(model, encoding="utf-8")
    return shown, command("torsion solve train.yaml")


def test_the_readme_shows_what_is_printed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    shown, printed = example_of_the_readme()
    assert not lacking(shown, printed), printed


@contextlib.contextmanager
def registries_restored() -> Iterator[None]:
    """The pages of docs/develop add an entry to a registry; it goes when they end."""
    registries: tuple[dict[str, Any], ...] = (KINDS, RULES, ANALYSES, OUTPUTS)
    before = [dict(registry) for registry in registries]
    try:
        yield
    finally:
        for registry, entries in zip(registries, before, strict=True):
            registry.clear()
            registry.update(entries)


@pytest.mark.parametrize("page", PAGES)
def test_a_page_does_what_it_says(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    with registries_restored():
        for text, printed in outputs(page):
            assert not lacking(text, printed), printed


def test_what_was_not_printed_is_found() -> None:
    assert lacking("a  b\nc\n", "x a b\ny c") == []
    assert lacking("c\na b\n", "a b\nc") == ["a b"]
    assert lacking("d\n", "a b\nc") == ["d"]


def renewed(shown: str, printed: str) -> str:
    """The output that a page shows, each line replaced by the most similar printed line, in the order of printing."""
    lines = {" ".join(line.split()): line.rstrip() for line in printed.splitlines() if line.strip()}
    similar = {
        difflib.get_close_matches(" ".join(line.split()), lines, 1, 0.0)[0]
        for line in shown.splitlines()
    }
    return "".join(f"{line}\n" for key, line in lines.items() if key in similar)


def renew(path: Path) -> None:
    """Write a page anew with the output of today, and print what is to be read again."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder), registries_restored():
        sys.path.insert(0, folder)
        page = path.relative_to(ROOT).with_suffix("").as_posix().removeprefix("docs/")
        shown = [example_of_the_readme()] if page == "README" else outputs(page)
    text = path.read_text(encoding="utf-8")
    for old, printed in shown:
        if lacking(old, printed):
            print(f"{path}:\n{old}{renewed(old, printed)}")
            text = text.replace(f"```text\n{old}```", f"```text\n{renewed(old, printed)}```", 1)
    path.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    for name in PAGES:
        renew(DOCS / f"{name}.md")
    renew(ROOT / "README.md")
