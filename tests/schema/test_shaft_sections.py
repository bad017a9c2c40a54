"""A shaft from a table of its drawing is the same as its sections written as shafts, and each fault has its place."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from tests.for_all import for_all

from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.output.blocks import Table
from torsion.output.chapters.plant import _links
from torsion.output.chapters.response.component_loads import shafts
from torsion.rules.verdict_line import Checks
from torsion.runner import run
from torsion.schema.json_schema import json_schema
from torsion.schema.scene_reader import parse, read

SCENE = """\
name: from a drawing
operation: {{speeds: {{from: 300 rpm, to: 1500 rpm, steps: 13}}, rated: {{speed: 1200 rpm, power: 1 MW}}}}
train:
  - motor: {{name: motor, inertia: 20, power: 1 MW}}
{shafts}
  - coupling: {{name: flex, stiffness: 1e6, psi: 0.5}}
  - disc: {{name: screw, inertia: 30}}
excitations:
  - {{at: motor, order: 4, torque: 1 kN*m}}
rules: [iacs-m68]
"""
SECTIONS = SCENE.format(
    shafts="""\
  - shaft:
      {name: line, role: intermediate, bore: 10 mm, sections: [
        [0.6 m, 100 mm],
        {length: 0.4 m, diameter: [120 mm, 140 mm], features: radial hole, step: {fillet: 8 mm}},
        [0.5 m, 200 mm, 80 mm]]}"""
)
WRITTEN = SCENE.format(
    shafts="""\
  - shaft: {name: a, role: intermediate, length: 0.6 m, diameter: 100 mm, bore: 10 mm}
  - shaft: {name: b, role: intermediate, length: 0.4 m, diameter: [120 mm, 140 mm], bore: 10 mm,
      features: radial hole, step: {fillet: 8 mm}}
  - shaft: {name: c, role: intermediate, length: 0.5 m, diameter: 200 mm, bore: 80 mm}"""
)
CSV = """\
length [mm];diameter [mm];bore [mm];features;step
600;100;;;
400;"[120; 140]";;radial hole;{fillet: 8 mm}
500;200;80;;
"""
jsonschema = pytest.importorskip("jsonschema")
NAMES = {"line [1]": "a", "line [2]": "b", "line [3]": "c"}


@pytest.mark.parametrize("model", ["lumped", "fem", "exact"])
def test_sections_are_shafts_one_after_the_other(model: str) -> None:
    found, expected = (
        modes(assemble(parse(text).train, model, frequency=3000.0), 5).frequency
        for text in (SECTIONS, WRITTEN)
    )
    assert np.asarray(found) == pytest.approx(np.asarray(expected), rel=1e-11)


def test_every_section_is_judged_with_its_own_features() -> None:
    """The sections have other limits; the table has a row for each, and the sketch has one scale."""
    findings = run(parse(SECTIONS))
    checks, expected = (
        {
            (NAMES.get(one.where, one.where), one.what): replace(one, where="")
            for one in each.need(Checks).lines
        }
        for each in (findings, run(parse(WRITTEN)))
    )
    assert checks.keys() == expected.keys()
    assert {where for where, _ in checks} >= {"a", "b", "c"}
    for key, one in checks.items():
        like = expected[key].limit, expected[key].value
        assert (one.limit, one.value) == pytest.approx(like, rel=1e-9, nan_ok=True)
    blocks = list(shafts(findings))
    rows = next(block for block in blocks if isinstance(block, Table)).rows
    assert [row[0] for row in rows] == ["line [1]", "line [2]", "line [3]"]
    drawn = [link for link in _links(findings) if link.kind == "shaft"]
    assert np.array([link.taper for link in drawn]) == pytest.approx(
        np.array([(0.5, 0.5), (0.6, 0.7), (1.0, 1.0)])
    )
    long = [link.end[0] - link.start[0] for link in drawn]
    assert long == pytest.approx([0.8 * 3 * share / 1.5 for share in (0.6, 0.4, 0.5)], rel=1e-12)


@pytest.mark.parametrize("said", ["shaft.csv", "{table: shaft.csv}"])
def test_the_table_may_be_a_file(tmp_path: Path, said: str) -> None:
    (tmp_path / "shaft.csv").write_text(CSV)
    text = re.sub(r"sections: \[.*?\]\]\}", f"sections: {said}}}", SECTIONS, flags=re.DOTALL)
    (tmp_path / "scene.yaml").write_text(text)
    assert read(tmp_path / "scene.yaml").train.bars == parse(SECTIONS).train.bars
    (tmp_path / "shaft.csv").write_text(CSV.replace("600;100", "600;-100"))
    with pytest.raises(InputError, match=r"shaft\.csv:2:5: -100 mm is out of range"):
        read(tmp_path / "scene.yaml")
    (tmp_path / "shaft.csv").write_text(CSV.replace("200;80", "200;210"))
    with pytest.raises(InputError, match=r"shaft\.csv:4:9: the bore is not smaller"):
        read(tmp_path / "scene.yaml")


@for_all(
    ("body", "fault"),
    [
        ("{name: l, sections: []}", "5:32: there is no section"),
        ("{name: l, sections: }", "5:32: nothing is not a list of sections"),
        ("{name: l, sections: 5}", "5:32: 5 is not a list of sections"),
        ("{sections: [[1, 0.1]]}", "5:12: a shaft of `sections` needs a name"),
        ("{name: l, length: 1, sections: [[1, 0.1]]}", "5:30: `length` belongs to one section"),
        ("{name: l, sections: [[1, 0.1], [1]]}", "5:43: a list is no section"),
        ("{name: l, sections: [[1, 0.1], [1, 3 kg]]}", "5:47: "),
        (
            "{name: l, sections: [{name: x, length: 1, diameter: 0.1}]}",
            "5:40: a section has no `name`",
        ),
        ("{name: l, sections: [{diameter: 0.1}]}", "5:33: `length` is missing"),
        ("{name: l, material: gold, sections: [[1, 0.1]]}", "5:32: no material is called 'gold'"),
        (
            "{name: l, sections: [[1, 0.1], {length: 1, diameter: 0.2, step: sharp}]}",
            "5:76: no shaft follows 'l [2]'",
        ),
        ("{name: l, sections: missing.csv}", "5:32: the table 'missing.csv' does not exist"),
    ],
)
def test_faults_have_their_place(body: str, fault: str) -> None:
    text = (
        f"name: s\ntrain:\n  - disc: {{inertia: 2}}\n  - disc: {{inertia: 1}}\n  - shaft: {body}\n"
    )
    with pytest.raises(InputError, match=re.escape(fault)):
        parse(text)


def test_sections_stand_in_a_train_alone() -> None:
    text = "name: s\ntrain: [disc: {name: a, inertia: 2}, shaft: {length: 1, diameter: 0.1}, disc: {name: b, inertia: 2}]"
    with pytest.raises(InputError, match="3:54: `sections` belong only in the list of a train"):
        parse(f"{text}\nlinks: [{{between: [a, b], shaft: {{name: l, sections: [[1, 0.1]]}}}}]")


def test_an_editor_takes_sections_in_place_of_a_length() -> None:
    from torsion.schema.yaml_source import parse_source

    validator = jsonschema.Draft202012Validator(json_schema())
    assert validator.is_valid(parse_source(SECTIONS, "").data)
    assert not validator.is_valid(
        parse_source(SECTIONS.replace("sections: [", "segments: 3, note: ["), "").data
    )


@pytest.mark.parametrize("text", ["", "length [mm];diameter [mm]\n"])
def test_table_without_rows_says_which_columns_it_has(text: str, tmp_path: Path) -> None:
    tmp_path.joinpath("line.csv").write_text(text)
    scene = tmp_path / "scene.yaml"
    scene.write_text(SCENE.format(shafts="  - shaft: {name: line, sections: line.csv}"))
    with pytest.raises(
        InputError, match=re.escape("first a row of `length [mm]`, `diameter [mm]`")
    ):
        read(scene)
