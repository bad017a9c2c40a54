"""No cell of a CSV file is a formula to a spreadsheet, whatever the names of the file are; numbers stay numbers."""

import csv
import io
import re
import zipfile

import pytest
from tests.for_all import for_all
from typer.testing import CliRunner

from torsion.cli import app
from torsion.output.table_text import inert

SCENE = """name: "=cmd|'/c calc'!A1, =1+1"
description: text
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 5}, rated: {speed: 900 rpm, power: 10 kW}}
train:
- motor: {name: "=1+1", inertia: 1, ripple: [{order: 2, torque: 5 %}]}
- coupling: {name: "@SUM(A1);=A1", stiffness: 1e4, psi: 1, rated_torque: 1 kN*m, tolerance: 10 %}
- joint: {name: "-1+cmd|' /C calc'!A0", angle: 5 deg}
- shaft: {name: "+A1", length: 1 m, diameter: 60 mm}
- propeller: {name: "load, =HYPERLINK(1)", inertia: 2}
analyses:
  modes: {count: 2}
  response:
  sweep:
    vary: {"@SUM(A1);=A1.stiffness": {uniform: 5 %}, "+A1.diameter": {values: [55 mm, 60 mm]}}
    samples: 128
    results: [modes]
  transient: {duration: 0.1 s, samples: 100, export: csv, events: [{at: "=1+1", step: {torque: -500}}]}
rules: [coupling-maker]
"""


@pytest.fixture(scope="module")
def texts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """Every CSV file of every command that writes such files."""
    pytest.importorskip("pyarrow", reason="a sweep needs pip install -e '.[sweep]'")
    folder = tmp_path_factory.mktemp("formulas")
    (folder / "=scene.yaml").write_text(SCENE, encoding="utf-8")
    for command in (["sweep", "--csv"], ["solve", "--csv"], ["joint"]):
        done = CliRunner().invoke(
            app, [*command[:1], str(folder / "=scene.yaml"), "-o", str(folder), *command[1:]]
        )
        assert done.exit_code in (0, 1), done.output
    texts = {path.name: path.read_text(encoding="utf-8") for path in folder.rglob("*.csv")}
    with zipfile.ZipFile(folder / "tables.zip") as archive:
        texts |= {name: archive.read(name).decode() for name in archive.namelist()}
    assert {
        "variants.csv",
        "motion.csv",
        "joints.csv",
        "table-2.1.csv",
    } <= texts.keys()
    return texts


@for_all("separator", [",", ";", "\t"])
def test_no_cell_begins_as_a_formula(separator: str, texts: dict[str, str]) -> None:
    for name, text in texts.items():
        for row in csv.reader(io.StringIO(text), delimiter=separator):
            for cell in row:
                is_number = re.fullmatch(r"[+-]?(\d[\d.]*(e[+-]?\d+)?|inf)(,.*)?", cell.strip())
                assert is_number or not cell.lstrip(' \t\r"').startswith(("=", "+", "-", "@")), (
                    name,
                    cell,
                )


def test_numbers_below_zero_stay_numbers(texts: dict[str, str]) -> None:
    rows = list(csv.reader(io.StringIO(texts["motion.csv"])))[1:]
    values = [float(cell) for row in rows for cell in row]
    assert min(values) < 0.0


@for_all("number", ["-1.5", "+3", "-1.2346e-7", "1e5", "-inf", "0"])
def test_a_number_is_left_as_it_is(number: str) -> None:
    assert inert(number) == number
    assert inert(f"a,{number};b") == f"a,{number};b"


@for_all(
    "text",
    ["=1+1", "+A1", "-1+cmd|' /C calc'!A0", "@SUM(A1)", "\t=1", "a;=1", "a, =1", "-A1", "+-5 %"],
)
def test_a_text_that_a_spreadsheet_would_run_gets_an_apostrophe(text: str) -> None:
    assert inert(text).count("'") == text.count("'") + 1
    assert inert(inert(text)) == inert(text)
