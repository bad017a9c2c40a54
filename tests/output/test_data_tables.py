"""The results as tables of values: names, every digit of results.json, and the workbook."""

import csv
import io
import json
import zipfile
from pathlib import Path

import pytest
from tests.contracts.frozen import solved as scene_solved
from typer.testing import CliRunner

import torsion
from torsion.cli import app
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.files.data_tables import DataTable, archive, data_tables
from torsion.output.stored.results_json import results

TRAIN = """
name: "=1+1"
operation: {speeds: {from: 300 rpm, to: 1800 rpm}, rated: {speed: 1500 rpm, power: 100 kW}}
train:
- motor: {name: "=HYPERLINK(1)", inertia: 1}
- coupling: {name: soft, stiffness: 20 kN*m/rad, psi: 0.8, rated_torque: 1 kN*m}
- propeller: {inertia: 2, blades: 4, excitation: [{blade_order: 1, torque: 6 %}]}
rules: [coupling-maker]
"""


@pytest.fixture(scope="module")
def usv() -> Findings:
    return scene_solved("usv")


def by_name(findings: Findings) -> dict[str, DataTable]:
    return {table.name: table for table in data_tables(findings)}


def test_tables_have_stable_names(usv: Findings) -> None:
    assert {"stations", "spans", "modes", "damped_modes", "critical_speeds", "checks"} <= by_name(
        usv
    ).keys()


def test_every_cell_of_the_checks_and_modes_is_the_value_of_results_json(usv: Findings) -> None:
    stated, tables = results(usv), by_name(usv)
    checks = [
        dict(zip(tables["checks"].columns, row, strict=True)) for row in tables["checks"].rows
    ]
    assert len(checks) == len(stated["checks"])
    for row, check in zip(checks, stated["checks"], strict=True):
        for key in (
            "rule",
            "clause",
            "where",
            "what",
            "value",
            "limit",
            "unit",
            "verdict",
            "order",
            "note",
        ):
            assert row[key] == check[key]
        assert row["basis.kind"] == check["basis"]["kind"]
        speed = check["speed_rad_per_s"]
        assert row["speed_rpm"] == (
            None if speed is None else pytest.approx(speed * 30 / 3.141592653589793, rel=1e-15)
        )
    modes = tables["modes"]
    place = modes.columns.index("frequency_Hz")
    assert [row[place] for row in modes.rows] == stated["modes"]["frequency_Hz"]
    assert [row[0] for row in modes.rows] == [1, 2, 3, 4, 5, 6]


def test_csv_has_all_digits_one_number_a_cell_and_runs_no_formula() -> None:
    findings = torsion.run(torsion.parse(TRAIN))
    with zipfile.ZipFile(io.BytesIO(archive(document(findings), findings))) as files:
        modes, stations = (files.read(f"{name}.csv").decode() for name in ("modes", "stations"))
    rows = list(csv.DictReader(io.StringIO(modes)))
    assert float(rows[0]["frequency_Hz"]) == by_name(findings)["modes"].rows[0][1]
    names = [row["name"] for row in csv.DictReader(io.StringIO(stations))]
    assert names[0] == "'=HYPERLINK(1)"


def test_the_command_writes_both(tmp_path: Path) -> None:
    openpyxl = pytest.importorskip("openpyxl")
    scene, out = tmp_path / "train.yaml", tmp_path / "out"
    scene.write_text(TRAIN)
    run = CliRunner().invoke(app, ["solve", str(scene), "-o", str(out), "--csv", "--xlsx"])
    assert run.exit_code == 0, run.output
    with zipfile.ZipFile(out / "data.zip") as archive:
        assert {"checks.csv", "modes.csv", "critical_speeds.csv"} <= set(archive.namelist())
    book = openpyxl.load_workbook(out / "results.xlsx")
    stated = json.loads((out / "results.json").read_text())
    assert book["modes"]["B2"].value == pytest.approx(stated["modes"]["frequency_Hz"][0], rel=1e-15)
    assert book["modes"]["B1"].value == "frequency_Hz"
    assert book["stations"]["A2"].value == "'=HYPERLINK(1)"


def test_cases_have_folders() -> None:
    findings = torsion.run(
        torsion.parse(TRAIN + "cases: {heavy: {set: {propeller-1.inertia: 4}}}\n")
    )
    with zipfile.ZipFile(io.BytesIO(archive(document(findings), findings))) as made:
        assert {"checks.csv", "heavy/checks.csv"} <= set(made.namelist())
