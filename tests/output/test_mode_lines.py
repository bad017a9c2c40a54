"""The mode shapes as a file of lines: what is read back, and what is refused."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

import torsion
from torsion.analyses.undamped_modes import Modes
from torsion.cli import app
from torsion.findings import Findings
from torsion.output.document import document
from torsion.output.files.mode_lines import vtu

TAPERED = """name: tapered shaft
analyses: {modes: {count: 2}}
materials: {steel: {shear_modulus: 80 GPa, density: 7850}}
train:
  - disc: {inertia: 2}
  - shaft: {length: 1.5 m, diameter: [60 mm, 80 mm], bore: 20 mm, segments: 8, material: steel}
  - disc: {inertia: 3}
"""


def read_back(findings: Findings, folder: Path) -> meshio.Mesh:
    file = folder / "modes.vtu"
    file.write_bytes(vtu(document(findings), findings))
    return meshio.read(file)


def test_a_shaft_has_its_length_and_its_radius_at_every_station(tmp_path: Path) -> None:
    mesh = read_back(torsion.run(torsion.parse(TAPERED)), tmp_path)
    x, radius = mesh.points[:, 0], mesh.point_data["radius"]
    assert len(mesh.cells_dict["line"]) == 8
    assert np.ptp(x) == pytest.approx(1.5, rel=1e-14)
    np.testing.assert_allclose(radius, 0.030 + 0.010 * (x - x.min()) / 1.5, rtol=1e-13)


def test_angles_and_torques_are_those_of_the_results(tmp_path: Path) -> None:
    findings = torsion.run(torsion.parse(TAPERED))
    mesh, modes = read_back(findings, tmp_path), findings.need(Modes)
    ends = np.column_stack([findings.system.driving, findings.system.driven]).ravel()
    for mode, name in enumerate(("mode_01", "mode_02")):
        angle, torque = modes.shape[ends, mode], modes.torque[:, mode]
        np.testing.assert_array_equal(mesh.point_data[f"{name}_angle"], angle)
        np.testing.assert_allclose(
            mesh.point_data[f"{name}_angle_relative"],
            angle / np.abs(modes.shape[:, mode]).max(),
            rtol=1e-14,
        )
        np.testing.assert_array_equal(mesh.cell_data[f"{name}_torque"][0], torque)


@pytest.mark.parametrize(
    ("rest", "what"),
    [
        (
            "disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\nanalyses: {joints: }",
            "modes",
        ),
        ("disc: {inertia: 2}]", "no elastic mode"),
    ],
)
def test_a_train_without_modes_is_a_located_fault(rest: str, what: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(f"name: x\ntrain: [{rest}\n")
    environment = {"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    done = CliRunner().invoke(
        app, ["solve", str(file), "--vtu", "-o", str(tmp_path / "out")], env=environment
    )
    assert done.exit_code == 2, done.output
    assert "scene.yaml:" in done.output
    assert what in done.output
