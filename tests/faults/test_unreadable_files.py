"""What is no file, is too large or holds itself is refused where it is named, in bounded time and memory."""

import os
from pathlib import Path

import pytest
from tests.for_all import for_all

from torsion.errors import InputError
from torsion.schema.scene_reader import read
from torsion.user_files import LARGEST_SCENE

SHAFT = "name: a\noperation: {speeds: {from: 300 rpm, to: 900 rpm}}\ntrain:\n"
TRAIN = SHAFT + "  - disc: {inertia: 1}\n  - coupling: {stiffness: 1e4}\n  - disc: {inertia: 2}\n"
NAMED = {  # what a scene names a file for: its text
    "table": "name: a\ntrain: {table: FILE}\n",
    "logo": TRAIN + "document: {logo: FILE}\n",
    "mesh": SHAFT
    + "  - disc: {inertia: 1}\n  - shaft: {length: 1, section: {mesh: FILE}}\n  - disc: {inertia: 2}\n",
    "torque": TRAIN
    + "analyses: {transient: {duration: 1 s, events: [{at: disc-1, table: {file: FILE}}]}}\n",
    "signal": TRAIN + "excitations: [{at: disc-1, order: 1, torque: 5}]\nanalyses:\n  fit: {vary: "
    "{coupling-1.stiffness: 10 %}, measured: [{at: disc-1, signal: FILE, orders: [1], within: 1 %}]}\n",
}


@pytest.fixture(params=["device", "pipe", "folder", "large"])
def unreadable(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Path, str]:
    """A path that is no file to read, and a word of the refusal."""
    path = tmp_path / "unreadable"
    match request.param:
        case "device":
            return Path("/dev/zero"), "device"
        case "pipe":
            os.mkfifo(path)
            return path, "pipe"
        case "folder":
            path.mkdir()
            return path, "folder"
        case _:
            with path.open("wb") as file:
                file.truncate(10_000_000_000)  # holes take no room on the disk
            return path, "at most"


def refusal(path: Path) -> str:
    with pytest.raises(InputError) as caught:
        read(path)
    return str(caught.value)


def test_a_scene_that_is_no_file_or_too_large_is_refused_with_the_size(
    unreadable: tuple[Path, str],
) -> None:
    path, word = unreadable
    assert word in refusal(path)
    assert word != "at most" or "at most 10 MB" in refusal(path)


@for_all("use", NAMED)
def test_a_file_of_a_scene_that_is_none_is_refused_where_it_is_named(
    unreadable: tuple[Path, str], use: str, tmp_path: Path
) -> None:
    path, word = unreadable
    scene = tmp_path / "scene.yaml"
    scene.write_text(NAMED[use].replace("FILE", str(path)), encoding="utf-8")
    message = refusal(scene)
    line = next(
        number
        for number, text in enumerate(scene.read_text().splitlines(), start=1)
        if str(path) in text
    )
    assert message.startswith(f"{scene}:{line}:")
    assert word in message


def test_a_scene_of_the_stated_size_is_read_and_one_byte_more_is_not(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    comment = "#" * (LARGEST_SCENE - len(TRAIN) - 1) + "\n"
    scene.write_text(comment + TRAIN, encoding="utf-8")
    assert read(scene).name == "a"
    scene.write_text("#" + comment + TRAIN, encoding="utf-8")
    assert "at most 10 MB" in refusal(scene)


def test_a_table_within_a_table_is_refused_at_its_cell(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("kind,train\nbranch,{table: a.csv}\n", encoding="utf-8")
    scene = tmp_path / "scene.yaml"
    scene.write_text("name: a\ntrain: {table: a.csv}\n", encoding="utf-8")
    assert "a.csv:2:8: a row of a table names a table" in refusal(scene)


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("name: a\ntrain: &a [*a]\n", "2:12"),
        ("name: a\nx: &a {b: *a}\n", "2:11"),
        (
            "".join(
                f"x{k}: &x{k} [{', '.join([f'*x{k - 1}'] * 9) if k else 1}]\n" for k in range(40)
            ),
            "6:40",
        ),
    ],
    ids=["list", "mapping", "growth"],
)
def test_what_holds_itself_or_grows_without_end_is_refused_where_it_does(
    text: str, place: str, tmp_path: Path
) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(text, encoding="utf-8")
    assert refusal(scene).startswith(f"{scene}:{place}: ")
