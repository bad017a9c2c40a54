"""The table of scenes lists every scene; tests/scenes compares its values with what the program computes."""

import re
from pathlib import Path

SCENES = Path(__file__).parents[2] / "shafting_specs"


def test_the_table_lists_every_scene_once_and_no_other() -> None:
    listed = re.findall(
        r"^\| `(\w+)` \|", (SCENES / "README.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    assert sorted(listed) == sorted(path.stem for path in SCENES.glob("**/*.yaml"))


def test_every_row_of_the_table_is_filled() -> None:
    rows = re.findall(
        r"^\| `\w+` \|.*$", (SCENES / "README.md").read_text(encoding="utf-8"), re.MULTILINE
    )
    for row in rows:
        cells = [cell.strip() for cell in row.strip("|").split("|")]
        assert len(cells) == 5, row
        assert all(cells), row
