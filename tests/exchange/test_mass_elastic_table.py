"""Mass-elastic tables of engine makers and openTorsion-Editor files as model files."""

import json
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import torsion
from torsion.cli import app
from torsion.errors import InputError
from torsion.exchange.mass_elastic_table import TEMPLATE, import_table

TABLE = Path(__file__).with_name("mass_elastic.csv")


def frequencies(text: str, count: int = 6) -> np.ndarray:
    return torsion.modes(torsion.assemble(torsion.parse(text).train), count=count).frequency


def written(folder: Path, text: str, name: str = "table.csv") -> Path:
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return file


def test_the_frequencies_of_a_makers_table_are_those_of_its_matrices() -> None:
    """Ten masses, a damper and a gear; the mass and stiffness matrix written out by hand, the gear condensed."""
    ratio = 23 / 71
    inertia = np.array(
        [1.62, 0.41, 0.286, 0.286, 0.286, 0.286, 6.4, 0.32 + 0.05 * ratio**2, 5.8 * ratio**2]
    )
    stiffness = 1e6 * np.array([0.055, 2.35, 1.87, 1.87, 1.87, 2.61, 0.012, 0.31 * ratio**2])
    matrix = np.zeros((9, 9))
    for span, value in enumerate(stiffness):
        matrix[span : span + 2, span : span + 2] += value * np.array([[1, -1], [-1, 1]])
    root = np.sqrt(inertia)
    expected = np.sqrt(np.linalg.eigvalsh(matrix / np.outer(root, root))[1:7]) / (2 * np.pi)
    published = [17.38349, 30.70473, 67.44987, 130.39229, 350.64924, 560.41491]
    assert expected == pytest.approx(published, rel=4e-7)
    assert frequencies(import_table(TABLE)) == pytest.approx(expected, rel=1e-11)


def test_decimal_points_commas_and_other_titles_give_the_same_file(tmp_path: Path) -> None:
    german = "Nr;Benennung;Theta [kgm2];Drehsteifigkeit [kNm/rad]\n1;a;1,5;20,5\n2;b;2,25;\n"
    english = "name,moment of inertia [kg m2],k [kN m/rad]\na,1.5,20.5\nb,2.25,-\n"
    first, second = (
        frequencies(import_table(written(tmp_path, text)), 1) for text in (german, english)
    )
    assert (
        first
        == second
        == pytest.approx(np.sqrt(20500 * (1 / 1.5 + 1 / 2.25)) / (2 * np.pi), rel=1e-12)
    )


@pytest.mark.parametrize(
    ("title", "value", "inertia"),
    [
        ("GD2 [kgf m2]", 8, 2.0),
        ("GD2 [kgm2]", 8, 2.0),
        ("WR2 [lb ft2]", 100, 100 * 0.45359237 * 0.3048**2),
        ("J [lb in2]", 1000, 1000 * 0.45359237 * 0.0254**2),
    ],
)
def test_inertias_of_other_conventions(
    tmp_path: Path, title: str, value: float, inertia: float
) -> None:
    text = import_table(written(tmp_path, f"no;{title};k [Nm/rad]\n1;{value};1000\n2;{value};\n"))
    assert frequencies(text, 1) == pytest.approx(
        np.sqrt(1000 * 2 / inertia) / (2 * np.pi), rel=1e-12
    )


def test_a_table_referred_to_the_first_mass_has_the_modes_of_the_chain_without_gear(
    tmp_path: Path,
) -> None:
    rows = "no;J [kgm2];k [Nm/rad];ratio\n1;1;1000;1\n2;0.5;;1\n3;0.25;500;{0}\n4;2;;{0}\n"
    geared = import_table(written(tmp_path, rows.format("23/71")), referred=True)
    chain = "name: chain\ntrain:\n- disc: {inertia: 1}\n- coupling: {stiffness: 1000}\n- disc: {inertia: 0.75}\n"
    chain += "- coupling: {stiffness: 500}\n- disc: {inertia: 2}\n"
    assert frequencies(geared, 2) == pytest.approx(frequencies(chain, 2), rel=1e-12)


def test_what_is_not_read_stays_as_a_comment(tmp_path: Path) -> None:
    text = import_table(
        written(tmp_path, "no;J [kgm2];k [Nm/rad];crank angle\n1;1;1000;120\n2;1;;240\n")
    )
    assert "# not read of mass 1: crank angle: 120" in text


def test_all_faults_are_quoted_with_line_and_column(tmp_path: Path) -> None:
    table = "no;J [furlong];k [Nm/rad];ratio\n1;one;;0\n2;2;5;1\n"
    with pytest.raises(InputError) as caught:
        import_table(written(tmp_path, table))
    text = str(caught.value)
    for words in (
        "table.csv:1:4",
        "furlong",
        "table.csv:2:3",
        "`one` is not a number",
        "not a speed ratio",
        "last mass",
    ):
        assert words in text


@pytest.mark.parametrize(
    "text",
    ["", "no;J\n", "a\tb", "[]", "{", '{"components": [{"name": 1}]}', "\x00", "1;2\n;;;;;;\n"],
)
@pytest.mark.parametrize("name", ["table.csv", "table.json"])
def test_no_table_ends_in_a_traceback(tmp_path: Path, text: str, name: str) -> None:
    run = CliRunner().invoke(app, ["import", str(written(tmp_path, text, name))])
    assert run.exit_code == 2
    assert name in run.output


def test_an_editor_file_of_three_disks(tmp_path: Path) -> None:
    """Published frequencies of the editor's example."""
    disks = [3430.0, 95200.0, 9.2e6]
    elements = [
        {"name": f"disk {k}", "type": "Disk", "inertia": disk, "damping": 0.0}
        for k, disk in enumerate(disks)
    ]
    for place, stiffness in ((1, 5.55e9), (3, 3.68e8)):
        elements.insert(
            place,
            {"name": f"s{place}", "type": "ShaftDiscrete", "stiffness": stiffness, "damping": 0},
        )
    data = {"components": [{"name": "turbine", "elements": elements}], "structure": []}
    file = written(tmp_path, json.dumps(data), "editor.json")
    found = frequencies(import_table(file), 2)
    masses, springs = np.diag(np.array(disks) ** -0.5), np.array([[1, -1, 0], [0, 1, -1]])
    stiffness = springs.T @ np.diag([5.55e9, 3.68e8]) @ springs
    expected = np.sqrt(np.linalg.eigvalsh(masses @ stiffness @ masses)[1:]) / (2 * np.pi)
    assert found == pytest.approx(expected, rel=1e-10)


def test_the_command_writes_a_file_that_solves_and_never_writes_over_one(tmp_path: Path) -> None:
    out = tmp_path / "train.yaml"
    made = CliRunner().invoke(app, ["import", str(written(tmp_path, TEMPLATE)), "-o", str(out)])
    assert made.exit_code == 0, made.output
    assert torsion.read(out).name == "Imported from table.csv"
    again = CliRunner().invoke(app, ["import", str(tmp_path / "table.csv"), "-o", str(out)])
    assert (again.exit_code, "exists already" in again.output) == (2, True)
    assert CliRunner().invoke(app, ["import", "--template"]).output == TEMPLATE
    assert CliRunner().invoke(app, ["import"]).exit_code == 2
