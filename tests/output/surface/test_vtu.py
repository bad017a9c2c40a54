"""The mode shapes as a file: what is read back, what is refused, and that nothing is loaded unless it is requested."""

import subprocess
import sys
from pathlib import Path

import meshio
import numpy as np
import pytest
from typer.testing import CliRunner

import torsion
from torsion.analyses.undamped_modes import Modes
from torsion.cli import app
from torsion.findings import Findings
from torsion.output.document import Document, document
from torsion.output.surface import vtu
from torsion.output.surface.vtu import AROUND
from torsion.output.write import write

SHAFT = """name: shaft
train:
  - disc: {inertia: 2}
  - shaft: {length: 1.5 m, diameter: 60 mm, segments: 8}
  - propeller: {inertia: 3, diameter: 0.5 m}
"""
LOADED = """
import sys, torsion.commands
torsion.commands.solve({file!r}, {out!r}, vtu={vtu})
print("meshio" in sys.modules)
"""


def back(findings: Findings, folder: Path) -> meshio.Mesh:
    file = folder / "modes.vtu"
    file.write_bytes(vtu.vtu(document(findings), findings))
    return meshio.read(file)


def call(*words: str):
    return CliRunner().invoke(app, ["solve", *words], env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"})


def test_a_file_holds_every_mode_and_says_what_is_to_scale(tmp_path: Path) -> None:
    mesh = back(torsion.run(torsion.parse(SHAFT)), tmp_path)
    assert {name[:7] for name in mesh.point_data} == {f"mode_{k:02}" for k in range(1, 7)}
    for name in ("to_scale", "component", "mode_01_torque", "mode_01_stress"):
        assert [len(values) for values in mesh.cell_data[name]] == [len(cells.data) for cells in mesh.cells]
    scale = {
        (int(part), int(value))
        for parts, values in zip(mesh.cell_data["component"], mesh.cell_data["to_scale"], strict=True)
        for part, value in zip(parts, values, strict=True)
    }
    assert scale == {(0, 0), (1, 1), (2, 1)}
    length = mesh.points[:, 0]
    across = np.hypot(mesh.points[:, 1], mesh.points[:, 2])
    assert across.max() == pytest.approx(0.25, rel=1e-14)
    assert np.ptp(length[np.isclose(across, 0.03, rtol=1e-12)]) >= 1.5


def test_points_and_cells_are_those_of_rings_and_strips(bare: Findings, tmp_path: Path) -> None:
    mesh = back(bare, tmp_path)
    bodies, rings = 3, 6 + 13 + 6  # two discs and a coupling, without the two points of each on the axis
    assert len(mesh.points) == rings * AROUND + 2 * bodies
    cells = {block.type: len(block.data) for block in mesh.cells}
    assert cells == {"quad": (rings - bodies) * AROUND, "triangle": 2 * bodies * AROUND}


def test_the_largest_displacement_is_radius_times_angle(train: Findings, tmp_path: Path) -> None:
    mesh = back(train, tmp_path)
    for mode in ("mode_01", "mode_03"):
        move, share = (mesh.point_data[f"{mode}_{what}"] for what in ("displacement", "angle_relative"))
        angle = mesh.point_data[f"{mode}_angle"]
        np.testing.assert_allclose(share, angle / np.abs(angle).max(), rtol=1e-14)
        assert np.abs(share).max() == 1.0
        assert not move[:, 0].any()
    alone = back(torsion.run(torsion.parse(SHAFT)), tmp_path)
    move, share = (alone.point_data[f"mode_02_{what}"] for what in ("displacement", "angle_relative"))
    radius = np.hypot(alone.points[:, 1], alone.points[:, 2])
    np.testing.assert_allclose(np.linalg.norm(move, axis=1), 0.5 * radius * np.abs(share), rtol=1e-13, atol=1e-18)
    turn = alone.points[:, 1] * move[:, 2] - alone.points[:, 2] * move[:, 1]  # about x
    np.testing.assert_allclose(turn, 0.5 * radius**2 * share, rtol=1e-12, atol=1e-18)


def test_angles_and_torques_are_those_of_the_results(bare: Findings, tmp_path: Path) -> None:
    mesh = back(bare, tmp_path)
    assert set(bare.need(Modes).shape[:, 0]) <= set(mesh.point_data["mode_01_angle"])
    torque = np.concatenate(mesh.cell_data["mode_01_torque"])
    assert set(torque[np.isfinite(torque)]) == {bare.need(Modes).torque[0, 0]}
    assert "mode_01_stress" not in mesh.cell_data  # no shaft: no diameter is known


def test_a_small_room_takes_fewer_points_and_a_smaller_one_is_refused(
    bare: Findings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = len(back(bare, tmp_path).points)
    monkeypatch.setattr(vtu, "MOST_NUMBERS", 31 * 10 * 20)
    assert len(back(bare, tmp_path).points) < whole
    monkeypatch.setattr(vtu, "MOST_NUMBERS", 31 * 10 * 11)
    with pytest.raises(torsion.InputError, match="fewer modes"):
        vtu.vtu(document(bare), bare)


def test_the_folder_holds_the_surface_with_the_report(bare: Findings, tmp_path: Path) -> None:
    write(bare, tmp_path / "new", also=("vtu",))
    names = ["modes.vtu", "report.html", "results.json"]
    assert sorted(path.name for path in (tmp_path / "new").iterdir()) == names
    page = (tmp_path / "new" / "report.html").read_text(encoding="utf-8")
    assert "The twisted train" in page
    assert "Hz, twisted (not to scale)" in page  # no component has a diameter


def test_a_failed_run_leaves_the_earlier_report_whole(
    bare: Findings, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write(bare, tmp_path, also=("vtu",))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}

    def fail(document: Document, findings: Findings) -> None:
        raise RuntimeError("in the middle")

    monkeypatch.setattr(vtu, "vtu", fail)
    with pytest.raises(RuntimeError, match="in the middle"):
        write(bare, tmp_path, also=("vtu",))
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_without_the_option_the_report_has_no_picture_of_it(train: Findings) -> None:
    def headings(also: tuple[str, ...]) -> list[str]:
        return [getattr(item.block, "text", "") for item in document(train, also=also).body]

    assert "The twisted train" not in headings(())
    assert "The twisted train" in headings(("vtu",))


@pytest.mark.parametrize("requested", [False, True])
def test_meshio_is_loaded_only_when_asked(requested: bool, tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text("name: x\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n")
    program = LOADED.format(file=str(file), out=str(tmp_path / "out"), vtu=requested)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(requested)


@pytest.mark.parametrize(
    ("rest", "what"),
    [
        ("disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\nanalyses: {joints: }", "modes"),
        ("disc: {inertia: 2}]", "no elastic mode"),
        ("joint: {angle: 5 deg}]", "no component has an inertia"),
    ],
)
def test_a_train_without_modes_is_a_located_fault_and_nothing_is_written(rest: str, what: str, tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(f"name: x\ntrain: [{rest}\n")
    done = call(str(file), "--vtu", "-o", str(tmp_path / "out"))
    assert done.exit_code == 2, done.output
    assert "scene.yaml:" in done.output
    assert what in done.output
    assert not list((tmp_path / "out").iterdir()) if (tmp_path / "out").exists() else True


def test_json_alone_and_a_file_exclude_each_other(tmp_path: Path) -> None:
    done = call(str(tmp_path / "none.yaml"), "--json", "--vtu")
    assert done.exit_code == 2
    assert "--vtu" in done.output


def test_the_command_writes_the_file(tmp_path: Path) -> None:
    file = tmp_path / "scene.yaml"
    file.write_text(SHAFT)
    done = call(str(file), "--vtu", "-o", str(tmp_path / "out"))
    assert done.exit_code == 0, done.output
    assert meshio.read(tmp_path / "out" / "modes.vtu").points.shape[1] == 3
