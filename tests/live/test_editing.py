"""What an editor writes: the file as it was but for what changed, whole or not at all."""

import json
import os
from pathlib import Path

import pytest

from torsion.live import editing
from torsion.live.editor import Editor
from torsion.schema.json_schema import json_schema

SCENE = """name: Größe 1  # a comment
train:
  - disc: {name: ü, inertia: 2, tolerance: 5 %}
  - coupling: {name: link, stiffness: 12 kN*m/rad, tolerance: 10 %}
  - disc: {name: end, inertia: 3}
"""
LOOSE = {"link.stiffness": 0.93, "ü.inertia": 1.05}


@pytest.fixture
def file(tmp_path: Path) -> Path:
    made = tmp_path / "Wärme.yaml"
    made.write_bytes(SCENE.encode())
    return made


def of(file: Path) -> str:
    return str(editing.opened(str(file))["of"])


def test_sliders_change_their_figures_alone(file: Path) -> None:
    answer = editing.put(str(file), LOOSE, of(file), None)
    assert answer == {"of": of(file)}
    assert file.read_bytes().decode() == SCENE.replace("inertia: 2", "inertia: 2.1").replace("12 kN", "11.16 kN")
    assert [path.name for path in file.parent.iterdir()] == [file.name]


@pytest.mark.parametrize("begin", ["", "\ufeff"])
def test_line_ends_and_mark_of_the_file_stay(file: Path, begin: str) -> None:
    before = (begin + SCENE).replace("\n", "\r\n")
    file.write_bytes(before.encode())
    seen = editing.opened(str(file))
    assert (seen["text"], seen["faults"]) == (SCENE, [])
    editing.saved(str(file), SCENE.replace("3}", "4}"), seen["of"])
    assert file.read_bytes().decode() == before.replace("3}", "4}")
    editing.put(str(file), {"link.stiffness": 0.93}, of(file), None)
    assert file.read_bytes().decode() == before.replace("3}", "4}").replace("12 kN", "11.16 kN")


def test_a_link_and_the_rights_of_a_file_stay(file: Path, tmp_path: Path) -> None:
    link = tmp_path / "link.yaml"
    link.symlink_to(file)
    file.chmod(0o640)
    editing.saved(str(link), "name: b\n", of(link))
    assert link.is_symlink()
    assert (file.read_text(encoding="utf-8"), file.stat().st_mode & 0o777) == ("name: b\n", 0o640)


def test_nothing_is_written_over_what_has_changed(file: Path) -> None:
    before = of(file)
    file.write_text("name: other\n", encoding="utf-8")
    assert editing.saved(str(file), SCENE, before) == {"refused": editing.CHANGED}
    assert editing.put(str(file), LOOSE, before, None) == {"refused": editing.CHANGED}
    assert file.read_text(encoding="utf-8") == "name: other\n"


LINK = "  - coupling: {name: link, stiffness: 12 kN*m/rad, tolerance: 10 %}\n"
IN_A_TABLE = SCENE.replace(LINK, "").replace("  - disc: {name: end, inertia: 3}", "  - table: a.csv")
REPEATED = SCENE.replace("12 kN*m/rad", "&k 12 kN*m/rad") + "  - coupling: {stiffness: *k}\n  - disc: {inertia: 1}\n"


@pytest.mark.parametrize(("text", "case", "words"), [
    (SCENE, "cold", editing.NOT_IN_TEXT), (IN_A_TABLE, None, editing.NOT_IN_TEXT),
    (REPEATED, None, editing.NOT_IN_TEXT),
    (SCENE.replace("10 %", "100 %"), None, "is out of range"), (SCENE + "x", None, ":6:"),
])  # fmt: skip
def test_what_cannot_be_changed_in_its_place_is_refused(file: Path, text: str, case: str | None, words: str) -> None:
    file.with_name("a.csv").write_text(
        "kind,name,stiffness [kN*m/rad],inertia [kg*m**2],tolerance [%]\ncoupling,link,12,,10\ndisc,end,,3,\n",
        encoding="utf-8",
    )
    file.write_text(text, encoding="utf-8")
    position = 0.0 if "100 %" in text else 0.93
    answer = editing.put(str(file), {"link.stiffness": position}, of(file), case)
    assert words in answer["refused"]
    assert file.read_text(encoding="utf-8") == text


def test_a_process_answers_and_what_it_cannot_read_is_refused(file: Path) -> None:
    editor = Editor(str(file))
    try:
        assert editor.checked(SCENE.replace("inertia: 3", "inerta: 3"))["faults"][0]["line"] == 5
        assert "surrogates" in editor.saved("\ud800", editor.opened()["of"])["refused"]
        file.write_bytes(b"name: Gr\xf6\xdfe\n")
        assert "decode" in editor.opened()["refused"]
        file.unlink()
        assert "No such file" in editor.opened()["refused"]
        assert os.listdir(file.parent) == []
    finally:
        editor.end()


def test_the_keys_below_every_key_are_those_of_the_schema() -> None:
    keys = editing.keys(json_schema())
    assert {"stiffness", "tolerance"} <= set(keys["coupling"])
    assert {"train", "operation"} <= set(keys[""])
    assert keys["modes"] == ["count", "damped"]
    json.dumps(keys)
