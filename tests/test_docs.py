"""What the documents say: the manual is that of the declarations, scenes can be read, equations and commands exist."""

import re
from functools import cache
from pathlib import Path
from types import ModuleType

import pytest
import yaml
from docs.site import model_file_manual, results_manual
from tests.for_all import for_all
from typer.testing import CliRunner

import torsion
from torsion.cli import app
from torsion.model import KINDS
from torsion.model.component import Component, component_class
from torsion.rules import RULES
from torsion.rules.class_rules.m68_shafts import DETAILS
from torsion.schema.declaration_reader import keys_of
from torsion.schema.scene_reader import Scene

ROOT = Path(__file__).parents[1]
SCENES = ROOT / "shafting_specs"  # whose files examples name
PAGES = [
    ROOT / "README.md",
    ROOT / "shafting_specs" / "README.md",
    *sorted((ROOT / "docs").rglob("*.md")),
]
LINKED = [
    *PAGES,
    ROOT / "CHANGELOG.md",
    ROOT / "CONTRIBUTING.md",
    *sorted((ROOT / "reports").glob("*.md")),
    *sorted((ROOT / "reports" / "papers").glob("*.md")),
]
THEORY = "\n".join(
    page.read_text(encoding="utf-8")
    for page in sorted((ROOT / "docs/explanation/theory").glob("*.md"))
)
# Equations of a method that is gone; the source cites the others by their numbers.
RETIRED = (67, 68, 69, 70)
EQUATION = re.compile(r"\((T\d+[a-z]?)\)")
NUMBERED = re.findall(
    r"^    .*\S +\(T(\d+)([a-z]?)\)$", THEORY, re.MULTILINE
)  # number and letter, in the order of files
AROUND = """
name: example
operation: {{speeds: {{from: 300 rpm, to: 1800 rpm}}, rated: {{speed: 1500 rpm, power: 100 kW}}}}
train:
- disc: {{name: before, inertia: 1}}
{}
- disc: {{name: after, inertia: 1}}
"""
STATED = (
    "generator",
    "pump",
    "fan",
    "machine",
)  # their examples state the power, and a motor drives them


def blocks(page: Path, language: str) -> list[str]:
    """The fenced blocks of a page in a language."""
    return re.findall(
        rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL
    )


def scenes() -> list[tuple[str, str]]:
    """Page and text of every block that is a whole scene."""
    found = [(page.name, text) for page in PAGES for text in blocks(page, "yaml")]
    found = [
        (page, text) for page, text in found if not re.match(r"# [\w.]+\.yaml\n", text)
    ]  # test_pages runs these
    return [
        (page, text)
        for page, text in found
        if isinstance(yaml.safe_load(text), dict) and "\ntrain:" in text
    ]


@pytest.mark.parametrize(
    "generator", [model_file_manual, results_manual], ids=["model file", "results"]
)
def test_the_pages_of_a_manual_are_those_of_the_declarations(generator: ModuleType) -> None:
    folder = ROOT / generator.FOLDER
    written = {
        path.relative_to(folder).as_posix(): path.read_text(encoding="utf-8")
        for path in folder.rglob("*.md")
    }
    assert written == generator.pages(), (
        f"write {generator.FOLDER} again: python -m {generator.__name__}"
    )


def test_writing_the_pages_of_a_manual_removes_pages_that_no_longer_exist(tmp_path: Path) -> None:
    (tmp_path / "components").mkdir()
    (tmp_path / "components" / "flux-capacitor.md").write_text("", encoding="utf-8")
    model_file_manual.write_pages(tmp_path, {"index.md": "# Index\n", "rules/lr.md": "# `lr`\n"})
    assert {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*.md")} == {
        "index.md",
        "rules/lr.md",
    }


def test_the_manual_has_every_section_and_kind() -> None:
    pages = model_file_manual.pages()
    assert all(component_class(kind).title and component_class(kind).example for kind in KINDS)
    assert {f"components/{kind}.md" for kind in KINDS} | {
        f"rules/{name}.md" for name in RULES
    } < set(pages)
    for name, field in Scene.model_fields.items():
        assert f"| `{field.alias or name}` |" in pages["index.md"]


@pytest.mark.parametrize("kind", [kind for kind in KINDS if component_class(kind).groups])
def test_groups_of_keys_have_every_key_of_the_kind_once(kind: str) -> None:
    grouped = [key for _, keys in component_class(kind).groups for key in keys.split()]
    assert sorted(grouped) == sorted(
        keys_of(component_class(kind)).keys() - keys_of(Component).keys()
    )


@for_all(
    ("kind", "example"),
    [
        (kind, example)
        for kind in KINDS
        for example in re.split(r"\n(?=- )", component_class(kind).example)
    ],
)
def test_an_example_of_a_kind_is_read_without_faults(
    kind: str, example: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(SCENES)
    text = AROUND.format(example)
    if kind in STATED:
        text = text.replace(", power: 100 kW}}", "}}", 1).replace(
            "disc: {name: before", "motor: {name: before"
        )
    train = torsion.parse(text).train
    assert kind in {part.kind for part in train.parts}


@pytest.mark.parametrize(
    ("page", "text"), scenes(), ids=lambda value: value if value.endswith(".md") else ""
)
def test_a_scene_in_a_document_is_read_without_faults(
    page: str, text: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(SCENES)
    assert torsion.parse(text, page).name


def test_documents_hold_scenes() -> None:
    assert {"README.md", "index.md"} <= {page for page, _ in scenes()}


def test_equations_are_numbered_once_and_without_gaps() -> None:
    numbers = sorted(int(number) for number, letter in NUMBERED if not letter)
    assert numbers == [n for n in range(1, numbers[-1] + 1) if n not in RETIRED]
    for number in {number for number, letter in NUMBERED if letter}:
        letters = sorted(letter for other, letter in NUMBERED if letter and other == number)
        assert letters == list("abcdefghijklmnop"[: len(letters)]), number


@for_all("feature", DETAILS)
def test_the_factors_of_a_feature_are_those_of_the_rule(feature: str) -> None:
    row = next(
        line for line in THEORY.splitlines() if line.startswith("| ") and f"`{feature}`" in line
    )
    c_k, k = (float(cell.split(",")[0]) for cell in row.strip("| ").split(" | ")[1:])
    assert (c_k, k) == (DETAILS[feature].c_k, DETAILS[feature].k)


def test_equations_that_are_cited_exist() -> None:
    known = {f"T{number}{letter}" for number, letter in NUMBERED}
    cited = {
        path: set(EQUATION.findall(path.read_text("utf-8")))
        for path in [*PAGES, *(ROOT / "src").rglob("*.py")]
    }
    assert not {
        path.name: equations - known for path, equations in cited.items() if equations - known
    }


def anchors(page: Path) -> set[str]:
    """The places of a page that a link can name: its headings, as GitHub and the site name them."""
    prose = re.sub(
        r"^```.*?^```", "", page.read_text(encoding="utf-8"), flags=re.MULTILINE | re.DOTALL
    )
    headings = re.findall(r"^#+ (.*)$", prose, re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-") for heading in headings}


@for_all("path", LINKED)
def test_a_link_in_a_document_leads_to_a_file_and_a_heading(path: Path) -> None:
    for target, anchor in re.findall(
        r"\]\(([^)#:\s]*)(?:#([^)]*))?\)", path.read_text(encoding="utf-8")
    ):
        page = path.parent / target if target else path
        assert page.exists(), target
        assert not anchor or anchor in anchors(page), f"{target}#{anchor}"


@cache
def help_of(command: str) -> str:
    shown = CliRunner().invoke(
        app, [command, "--help"], env={"COLUMNS": "200", "NO_COLOR": "1", "TERM": "dumb"}
    )
    assert shown.exit_code == 0, command
    return shown.output


@for_all("path", PAGES)
def test_every_command_and_option_of_a_document_exists(path: Path) -> None:
    text = path.read_text(encoding="utf-8").replace(
        "\\\n", " "
    )  # a line goes on behind a backslash
    for line in map("".join, re.findall(r"`torsion ([^`\n]*)`|^torsion (.*)$", text, re.MULTILINE)):
        command, *rest = line.replace("\\|", " ").partition("  #")[0].split()
        options = [word.strip("[],.") for word in rest if re.match(r"\[?--?[a-z]", word)]
        if re.fullmatch("[a-z]+", command):
            assert not {option for option in options if option not in help_of(command)}, (
                f"torsion {line}"
            )


def test_the_reference_has_every_command() -> None:
    text = (ROOT / "docs" / "reference" / "command-line.md").read_text(encoding="utf-8")
    commands = {
        command.name or command.callback.__name__
        for command in app.registered_commands
        if command.callback
    }
    assert commands <= set(re.findall(r"^\| `torsion ([a-z]+)", text, re.MULTILINE))


def test_files_and_folders_of_the_readme_exist() -> None:
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    named = set(re.findall(r"\b(?:shafting_specs|docs|benchmarks|src/torsion)/[\w./-]*", text))
    for name in named:
        assert (ROOT / name.rstrip(".")).exists(), name


@pytest.mark.parametrize("page", ["a-number", "where-to-change"])
def test_a_page_of_the_source_names_files_that_there_are(page: str) -> None:
    text = (ROOT / "docs" / "develop" / f"{page}.md").read_text(encoding="utf-8")
    names = re.findall(r"`((?:[a-z_]+/)+(?:[a-z_0-9]+\.py)?|[a-z_]+\.py|tests/[a-z_/]+)`", text)
    assert len(names) > 10
    roots = (ROOT, ROOT / "src" / "torsion")
    assert [name for name in names if not any((root / name).exists() for root in roots)] == []
