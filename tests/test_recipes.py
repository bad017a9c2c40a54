"""The recipes: fourteen tasks, each with a file, its output, a check by hand and traps; test_pages.py runs them."""

import re
from pathlib import Path

import pytest
from tests.for_all import for_all
from tests.test_pages import PAGES

FOLDER = Path(__file__).parents[1] / "docs" / "recipes"
RECIPES = sorted(path.stem for path in FOLDER.glob("*.md") if path.stem != "index")
NUMBER = re.compile(r"\d+\.\d+")
BY_HAND = re.compile(r"(\d[\d.]*)(?: Hz| N m)? by hand, (\d[\d.]*)")


def test_there_is_a_recipe_for_each_of_fourteen_tasks() -> None:
    assert len(RECIPES) == 14
    assert {f"recipes/{name}" for name in RECIPES} <= set(PAGES), "test_pages runs each of them"


def test_the_index_lists_every_recipe_once() -> None:
    index = (FOLDER / "index.md").read_text(encoding="utf-8")
    assert sorted(re.findall(r"\((\w+)\.md\)", index)) == RECIPES
    assert sorted(index.partition("{toctree}")[2].split()[1:-1]) == RECIPES


@for_all("name", RECIPES)
def test_a_recipe_says_when_shows_its_file_its_output_a_check_and_traps(name: str) -> None:
    text = (FOLDER / f"{name}.md").read_text(encoding="utf-8")
    assert re.match(r"# .+\n\n\*\*When:\*\* ", text)
    assert re.search(r"^```yaml\n# [\w-]+\.yaml\n", text, re.MULTILINE) or re.search(
        r"^<!-- \w+\.csv -->$", text, re.MULTILINE
    )
    result, _, check = text.partition("\n## Check\n")
    assert "```sh\n" in result
    assert "```text\n" in result
    assert "```python\n" in check
    assert "```text\n" in check
    assert text.count("\n## Traps\n") == 1


@for_all("name", RECIPES)
def test_the_check_of_a_recipe_repeats_a_number_of_its_result(name: str) -> None:
    """Three digits at least: by hand and by the program, on one line or on both sides of `## Check`."""
    text = (FOLDER / f"{name}.md").read_text(encoding="utf-8")
    result, _, check = text.partition("\n## Check\n")
    shown, by_hand = (
        "\n".join(re.findall(r"^```text\n(.*?)^```", half, re.M | re.S)) for half in (result, check)
    )
    pairs = [(float(hand), float(program)) for hand, program in BY_HAND.findall(by_hand)]
    assert all(hand == pytest.approx(program, rel=1e-4, abs=1e-3) for hand, program in pairs)
    common = {f"{float(one):.3g}" for one in NUMBER.findall(shown)} & {
        f"{float(one):.3g}" for one in NUMBER.findall(by_hand)
    }
    assert pairs or common
