"""The state space against the damped modes, and its gains against the dynamic stiffness in full."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import loadmat
from typer.testing import CliRunner

import torsion
from torsion.analyses.damped_modes import damped
from torsion.assembly.matrices import matrices
from torsion.cli import app
from torsion.errors import InputError
from torsion.exchange.state_space import state_space

GEARED = """
name: geared
operation: {rated: {speed: 1500 rpm}}
train:
- motor: {name: motor, inertia: 1, damping: 2}
- coupling: {name: soft, stiffness: 1 N*m/rad, viscous: 0.5}
- gear: {name: gear, ratio: 3, inertia: [0.1, 0.4], mesh_stiffness: 1e12 N*m/rad}
- coupling: {name: stiff, stiffness: 20 kN*m/rad, viscous: 3}
- propeller: {name: propeller, inertia: 4, damping: 7}
"""


def made(text: str = GEARED, **settings):
    study = torsion.parse(text)
    return state_space(study, torsion.assemble(study.train), speed=150.0, **settings)


def test_eigenvalues_are_the_damped_modes_and_one_mean_speed() -> None:
    study = torsion.parse(GEARED)
    system, model = torsion.assemble(study.train), made()
    found = np.linalg.eigvals(model.A)
    for value in damped(system, speed=150.0, count=None).eigenvalue:
        assert (
            np.abs(found - value).min() <= 4e-16 * np.abs(found).max()
        )  # of a matrix of that norm
    assert len(model.A) == 2 * 4 - 1


def test_gains_are_those_of_the_dynamic_stiffness() -> None:
    """Speeds i w x of (K + i w C - w^2 J) x = T."""
    text = GEARED.replace("1e12", "1e6").replace("stiffness: 1 N*m/rad", "stiffness: 1 kN*m/rad")
    system, model = torsion.assemble(torsion.parse(text).train), made(text)
    view = matrices(system)
    rows = [
        view.stations.index(name[9:].partition(" [")[0])
        for name in model.outputs
        if name.startswith("speed")
    ]
    columns = [view.stations.index(name[10:].partition(" [")[0]) for name in model.inputs]
    for w in (0.3, 40.0, 160.0):
        gain = model.C @ np.linalg.solve(1j * w * np.eye(len(model.A)) - model.A, model.B) + model.D
        dynamic = view.stiffness + 1j * w * view.damping - w**2 * view.inertia
        speeds = 1j * w * view.basis @ np.linalg.solve(dynamic, view.basis.T)
        expected = speeds[np.ix_(rows, columns)]
        assert np.abs(gain[-len(rows) :] - expected).max() <= 1e-8 * np.abs(expected).max()


def test_a_chain_of_two_masses_has_its_closed_form() -> None:
    """Torque of the span under a torque T on one end: T J2 z/(z (J1 + J2) - w^2 J1 J2) with z = k + i w c."""
    text = "name: two\ntrain:\n- disc: {name: a, inertia: 2}\n- coupling: {name: s, stiffness: 800, viscous: 3}\n"
    model = made(text + "- disc: {name: b, inertia: 5}\n", inputs=("a",), outputs=("b",))
    for w in (1.0, 23.0, 400.0):
        gain = model.C @ np.linalg.solve(1j * w * np.eye(3) - model.A, model.B)
        z = 800 + 3j * w
        torque = 5 * z / (z * 7 - w**2 * 10)
        assert gain[0, 0] == pytest.approx(torque, rel=1e-13)
        assert gain[1, 0] == pytest.approx(torque / (1j * w * 5), rel=1e-13)
    assert model.inputs == ("torque at a [N m]",)
    assert model.outputs == ("torque of s [N m]", "speed of b [rad/s]")


def test_a_loss_factor_is_exact_at_its_frequency() -> None:
    text = "name: two\ntrain:\n- disc: {name: a, inertia: 2}\n- coupling: {name: s, stiffness: 800, loss_factor: 0.1}\n"
    model = made(
        text + "- disc: {name: b, inertia: 5}\n", inputs=("a",), outputs=("b",), loss_at=23.0
    )
    gain = model.C @ np.linalg.solve(23j * np.eye(3) - model.A, model.B)
    z = 800 * (1 + 0.1j)
    assert gain[0, 0] == pytest.approx(5 * z / (z * 7 - 23.0**2 * 10), rel=1e-13)


@pytest.mark.parametrize(
    ("settings", "text", "words"),
    [
        ({"inputs": ("mottor",)}, GEARED, "did you mean 'motor'"),
        ({}, GEARED.replace("viscous: 3", "loss_factor: 0.1"), "--at"),
        ({}, GEARED.replace("- gear:", "- coupling: {stiffness: 5}\n- gear:"), "no inertia"),
    ],
)
def test_what_has_no_state_space_is_refused(settings: dict, text: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        made(text, **settings)


@pytest.mark.parametrize("form", ["npz", "mat"])
def test_the_command_writes_matrices_and_names(form: str, tmp_path: Path) -> None:
    file, out = tmp_path / "train.yaml", tmp_path / f"train.{form}"
    file.write_text(GEARED)
    options = ["-o", str(out), "--inputs", "motor", "--outputs", "motor, propeller"]
    run = CliRunner().invoke(app, ["export", str(file), *options])
    assert run.exit_code == 0, run.output
    if form == "npz":
        with np.load(out) as arrays:
            data = dict(arrays)
    else:
        data = loadmat(out, simplify_cells=True)
    model = made(inputs=("motor",), outputs=("motor", "propeller"))
    assert np.allclose(np.atleast_2d(data["A"]), model.A, rtol=1e-6)
    assert [str(name) for name in np.atleast_1d(data["outputs"])] == list(model.outputs)
