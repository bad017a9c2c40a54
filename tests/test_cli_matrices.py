"""`torsion solve --matrices`, and what `--json` goes with."""

from pathlib import Path

import numpy as np
import pytest
import scipy.linalg
from tests.for_all import for_all
from typer.testing import CliRunner

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.cli import app

RATED = "operation: {speeds: {from: 300 rpm, to: 1800 rpm, steps: 5}, rated: {speed: 1500 rpm, power: 100 kW}}\n"
TRAIN = """name: geared propeller
train:
  - motor: {inertia: 1.2, damping: 0.7}
  - coupling: {stiffness: 20 kN*m/rad, DAMPING}
  - gear: {teeth: [20, 50], inertia: [0.05, 0.4]}
  - disc: {inertia: 0.3}
  - coupling: {stiffness: 200 kN*m/rad}
  - propeller: {inertia: 4, blades: 4, damping: {model: archer, factor: 30}}
"""


def call(*words: str):
    return CliRunner().invoke(
        app, ["solve", *words], env={"COLUMNS": "100", "NO_COLOR": "1", "TERM": "dumb"}
    )


def roots(arrays: dict[str, np.ndarray], hysteretic: bool) -> np.ndarray:
    """Eigenvalues of J s^2 + C s + K + iH that oscillate, by ascending imaginary part."""
    stiffness = arrays["stiffness"] + (1j * arrays["loss"] if hysteretic else 0.0)
    one, nothing = np.eye(len(stiffness)), np.zeros_like(stiffness)
    left = np.block([[nothing, one], [-stiffness, -arrays["damping"]]])
    right = scipy.linalg.block_diag(one, arrays["inertia"])
    found = scipy.linalg.eig(left, right, right=False)
    kept = found[found.imag > 1e-3 * np.abs(found)]  # the others creep
    return kept[np.argsort(kept.imag)]


@pytest.mark.parametrize("damping", ["viscous: 90", "loss_factor: 0.2"])
def test_eigenvalues_of_the_exported_matrices_are_the_damped_modes(
    tmp_path: Path, damping: str
) -> None:
    scene, target = tmp_path / "scene.yaml", tmp_path / "m.npz"
    scene.write_text(RATED + TRAIN.replace("DAMPING", damping), encoding="utf-8")
    done = call(str(scene), "-o", str(tmp_path / "out"), "--matrices", str(target))
    assert done.exit_code == 0, done.output
    assert "1500 rpm and its mean torque" in done.output
    arrays = dict(np.load(target))
    stated = torsion.run(torsion.read(scene)).need(DampedModes)
    assert roots(arrays, "loss" in damping)[: stated.eigenvalue.size] == pytest.approx(
        stated.eigenvalue, rel=1e-9
    )
    assert float(arrays["speed"]) == pytest.approx(50.0 * np.pi, rel=1e-14)
    at = dict(zip(arrays["stations"].tolist(), arrays["mean_torque"].tolist(), strict=True))
    torque = 1e5 / (50.0 * np.pi)
    assert (at["motor-1"], at["propeller-1"]) == pytest.approx((torque, -2.5 * torque), rel=1e-13)
    archer = (
        30.0 * (2.5 * torque) * 2.0 * np.pi / 60.0 / (20.0 * np.pi)
    )  # A Q/n, at the propeller's own 600 rpm
    last = arrays["names"].tolist().index("propeller-1")
    assert arrays["damping"][last, last] == pytest.approx(archer / 2.5**2, rel=1e-13)


def test_matrices_that_follow_from_a_speed_that_is_not_given_are_refused(tmp_path: Path) -> None:
    scene = tmp_path / "scene.yaml"
    scene.write_text(TRAIN.replace(", DAMPING", ""), encoding="utf-8")
    done = call(str(scene), "-o", str(tmp_path / "out"), "--matrices", str(tmp_path / "m.npz"))
    assert done.exit_code == 2
    assert "the damping of 'propeller-1' follows from the speed" in done.stderr
    assert not (tmp_path / "m.npz").exists()


def test_matrices_of_a_train_without_speeds_tell_that_none_matters(tmp_path: Path) -> None:
    scene, target = tmp_path / "scene.yaml", tmp_path / "m.npz"
    scene.write_text(
        "name: x\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 4, viscous: 1}, disc: {inertia: 1}]\n"
    )
    done = call(str(scene), "-o", str(tmp_path / "out"), "--matrices", str(target))
    assert done.exit_code == 0, done.output
    assert "no damping of theirs follows from the speed" in done.output
    arrays = dict(np.load(target))
    assert np.isnan(arrays["speed"])
    assert arrays["damping"].tolist() == [[1.0, -1.0], [-1.0, 1.0]]


@for_all(
    "words",
    [
        ("solve", "--pdf"),
        ("solve", "--vtu"),
        ("solve", "--csv"),
        ("solve", "-o", "x"),
        ("solve", "--matrices", "m.npz"),
        ("joint", "-o", "x"),
        ("check", "-o", "x"),
        ("study", "-o", "x"),
    ],
)
def test_json_beside_an_option_that_writes_a_file_is_refused(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    command, option, *value = words
    done = CliRunner().invoke(app, [command, str(tmp_path / "none.yaml"), "--json", option, *value])
    assert done.exit_code == 2
    assert done.stderr.strip() == f"--json writes no file and {option} writes one; give one of them"
    assert "write" in CliRunner().invoke(app, [command, "--help"]).output
