"""A row of a coupling library stands for the keys of the coupling, as if they were written there."""

import re

import pytest

import torsion
from torsion.errors import InputError
from torsion.output.chapters.closing import input_file
from torsion.output.write import inputs
from torsion.runner import run
from torsion.schema.json_schema import json_schema
from torsion.schema.yaml_source import parse_source

SERIES = """# Maker M, catalogue 7, page 3
# a second line
size;stiffness [kN*m/rad];psi;inertia [kg*m**2];rated_torque [kN*m];tolerance [%]
1,6;5,5;1,0;"[0,12; 0,07]";1,25;15
R4;22;;;4;10
"""
SCENE = """name: set
train:
  - motor: {name: engine, inertia: 4.5}
  - coupling: {name: flex, from: sub/series.csv, size: 1.6}
  - disc: {name: generator, inertia: 12}
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 3}}
excitations: [{at: engine, order: 1, torque: 100 N*m}]
"""
WRITTEN = SCENE.replace(
    "from: sub/series.csv, size: 1.6",
    "stiffness: 5.5 kN*m/rad, psi: 1.0, inertia: [0.12, 0.07], rated_torque: 1.25 kN*m, tolerance: 15 %",
)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "series.csv").write_text(
        SERIES.replace("1,6;", "1.6;", 1), encoding="utf-8"
    )
    return tmp_path


def read(folder, text: str):
    (folder / "scene.yaml").write_text(text, encoding="utf-8")
    return torsion.read(folder / "scene.yaml")


def refused(folder, text: str) -> InputError:
    with pytest.raises(InputError) as error:
        read(folder, text)
    return error.value


def test_a_row_of_a_library_is_the_same_train_as_its_figures_written_out(folder):
    from_library, written = read(folder, SCENE).train, read(folder, WRITTEN).train
    assert (from_library.springs, from_library.inertias) == (written.springs, written.inertias)
    assert from_library.parts[1].ratings == written.parts[1].ratings
    assert from_library.parts[1].source == "sub/series.csv, size 1.6: Maker M, catalogue 7, page 3"


def test_the_library_is_told_with_its_checksum_and_is_no_file_to_be_overwritten(folder):
    study = read(folder, SCENE)
    assert folder / "sub" / "series.csv" in inputs(study)
    words = " ".join(str(block) for block in input_file(run(study)))
    assert "Table sub/series.csv, SHA-256" in words


def test_a_library_may_stand_in_a_branch_a_link_and_a_table_of_the_train(folder):
    (folder / "line.csv").write_text(
        'kind,name,inertia [kg*m**2],from,size\nmotor,engine,4.5,,\ncoupling,flex,"",sub/series.csv,1.6\n'
        "disc,generator,12,,\n",
        encoding="utf-8",
    )
    text = re.sub(r"train:\n(  - .*\n)+", "train: {table: line.csv}\n", SCENE)
    assert read(folder, text).train.springs == read(folder, WRITTEN).train.springs
    link = "links: [{between: [engine, generator], coupling: {from: sub/series.csv, size: R4}}]\n"
    assert read(folder, SCENE + link).train.springs[-1].flexibility == 1.0 / 22e3


def test_a_case_sets_and_scales_what_the_row_gives_and_its_tolerance_has_two_ends(folder):
    study = read(
        folder, SCENE + "cases: {from: tolerances, cold: {set: {flex.stiffness: 6 kN*m/rad}}}\n"
    )
    stiffness = {
        name: 1.0 / case.train.springs[0].flexibility for name, case in study.cases.items()
    }
    assert stiffness == pytest.approx(
        {"soft": 0.85 * 5500.0, "stiff": 1.15 * 5500.0, "cold": 6000.0}, rel=1e-15
    )


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "words"),
    [
        ("size: 1.6", "size: 1.7", 4, 56, ["no size '1.7'", "there is 1.6, R4"]),
        ("size: 1.6", "size: 1.6, psi: 2", 4, 61, ["`psi`", "1.0 by size 1.6", "keep one"]),
        ("sub/series.csv", "sub/serie.csv", 4, 34, ["does not exist", "counts from the folder"]),
        (", size: 1.6", "", 4, 34, ["`from` needs `size`"]),
        ("from: sub/series.csv, ", "", 4, 34, ["`size` needs `from`"]),
        ("size: 1.6", "size: [1.6]", 4, 56, ["a list is not text"]),
    ],
)
def test_what_a_scene_says_wrongly_of_a_library_is_located(folder, old, new, line, column, words):
    fault = refused(folder, SCENE.replace(old, new)).faults[0]
    assert (fault.line, fault.column) == (line, column)
    assert all(word in f"{fault.message} {fault.hint}" for word in words), fault


@pytest.mark.parametrize(
    ("old", "new", "line", "column", "words"),
    [
        ("R4;22", "1.6;22", 5, 1, ["'1.6' is in line 4"]),
        ("R4;22", ";22", 5, 2, ["has no size"]),
        ("psi;", "psy;", 3, 27, ["unknown column `psy`", "did you mean `psi`"]),
        ("[kN*m/rad]", "[kN]", 3, 6, ["`stiffness`", "force"]),
        ("size;", "name;", 3, 1, ["`size` is missing"]),
        ("5,5;1,0", "-5,5;1,0", 4, 5, ["more than 0"]),
        ("5,5;1,0", "5,5;one", 4, 9, ["one"]),
        (";10\n", ";10;3\n", 5, 1, ["this row has 7 cells"]),
        ("5,5;", "#N/A;", 4, 5, ["error of the spreadsheet"]),
    ],
)
def test_what_a_library_says_wrongly_is_quoted_from_its_own_file(
    folder, old, new, line, column, words
):
    file = folder / "sub" / "series.csv"
    file.write_text(file.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    fault = refused(folder, SCENE).faults[0]
    assert (fault.file, fault.line, fault.column) == (str(file), line, column), fault
    assert all(word in f"{fault.message} {fault.hint}" for word in words), fault


def test_a_case_takes_no_other_row(folder):
    error = refused(folder, SCENE + "cases: {big: {set: {flex.size: R4}}}\n")
    assert "changes the row" in str(error)
    assert error.faults[0].line == 8


def test_the_schema_takes_a_library(folder):
    jsonschema = pytest.importorskip("jsonschema")
    validator = jsonschema.Draft202012Validator(json_schema())
    for size in ("R4", "1.6"):
        assert not list(validator.iter_errors(parse_source(SCENE.replace("1.6", size), "f").data))
