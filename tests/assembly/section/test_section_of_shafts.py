"""Shafts with a meshed cross-section in a train: every model, paths, rules, and what is imported."""

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import torsion
from torsion.assembly import MODELS, assemble, bar_segments
from torsion.assembly.section.solved_sections import resolved, section_results, stress_modulus
from torsion.kernels.round_sections import section_modulus
from torsion.primitives import Section, SectionMesh

SCENES = Path(__file__).parents[3] / "shafting_specs"
SCENE = """
name: a square shaft
train:
- disc: {name: a, inertia: 2}
- shaft: {name: line, length: 1.5 m, section: {mesh: square.vtu, unit: mm}}
- disc: {name: b, inertia: 3}
"""
G, RHO = 79.3e9, 7850.0


@pytest.fixture
def scene(tmp_path, draw) -> Path:
    """A file beside a mesh of a square of 60 mm."""
    points, nodes = draw("blocks")(["#"], 4)
    draw("write")((60.0 * points, nodes), tmp_path / "square.vtu")
    (tmp_path / "scene.yaml").write_text(SCENE)
    return tmp_path / "scene.yaml"


def test_mesh_is_found_beside_the_file_from_anywhere(scene, tmp_path, monkeypatch) -> None:
    (tmp_path / "elsewhere").mkdir()
    monkeypatch.chdir(tmp_path / "elsewhere")
    (found,) = section_results(torsion.read(scene).train).values()
    monkeypatch.chdir(tmp_path)
    (again,) = section_results(torsion.read("scene.yaml").train).values()
    assert (
        found.torsion_constant
        == again.torsion_constant
        == pytest.approx(0.1405770 * 0.06**4, rel=1e-6)
    )


def test_stiffness_and_inertia_are_those_of_the_section(scene) -> None:
    train = resolved(torsion.read(scene).train)
    (bar,) = train.bars
    assert isinstance(bar.section, Section)
    flexibility, inertia = bar_segments(bar, 3)
    assert flexibility.sum() == pytest.approx(1.5 / (G * bar.section.torsion_constant), rel=1e-14)
    assert inertia.sum() == pytest.approx(RHO * 1.5 * 0.06**4 / 6.0, rel=1e-13)
    assert stress_modulus(bar) == pytest.approx(0.20816526 * 0.06**3, rel=1e-5)


def test_a_train_is_resolved_once(scene) -> None:
    train = torsion.read(scene).train
    assert isinstance(train.bars[0].section, SectionMesh)
    assert resolved(resolved(train)) == resolved(train)
    round_ones = torsion.read(SCENES / "usv.yaml").train
    assert resolved(round_ones) is round_ones


@pytest.mark.parametrize("model", MODELS)
def test_every_model_has_the_waves_of_the_section(scene, model) -> None:
    """Two discs on a continuum: tan(kl) = k l (r1 + r2)/(k^2 l^2 r1 r2 - 1), r the discs' over the shaft's inertia."""
    train = torsion.read(scene).train
    (section,) = section_results(train).values()
    polar_moment = section.moments.polar
    shaft = RHO * polar_moment * 1.5
    frequency = torsion.modes(assemble(train, model, frequency=4000.0), count=3).frequency
    speed = math.sqrt(G * section.torsion_constant / (RHO * polar_moment))
    phase = 2.0 * math.pi * frequency * 1.5 / speed
    first, last = 2.0 / shaft, 3.0 / shaft
    left = np.sin(phase) * (phase**2 * first * last - 1.0) - np.cos(phase) * phase * (first + last)
    slope = phase**2 * first * last + phase * (first + last)
    tolerance = {"lumped": 2e-3, "fem": 2e-6, "exact": 1e-10}[model]
    np.testing.assert_array_less(np.abs(left / slope), tolerance * phase)


def test_faulty_mesh_of_a_train_made_in_python_is_told(scene) -> None:
    train = torsion.parse(SCENE.replace("square.vtu", str(scene.parent / "square.vtu"))).train
    (scene.parent / "square.vtu").unlink()
    with pytest.raises(
        torsion.InputError, match=r"train\.1\.shaft\.section\.mesh: the mesh file does not exist"
    ):
        assemble(train)


def test_a_changed_mesh_is_solved_anew(scene, draw) -> None:
    before = section_results(torsion.read(scene).train)["line"]
    points, nodes = draw("blocks")(["##", "##"], 3)
    draw("write")((60.0 * points, nodes), scene.parent / "square.vtu")
    after = section_results(torsion.read(scene).train)["line"]
    assert after.torsion_constant == pytest.approx(16.0 * before.torsion_constant, rel=1e-5)


def test_section_says_its_bounds_and_convergence_in_words(scene) -> None:
    (found,) = section_results(torsion.read(scene).train).values()
    assert found.words.startswith("square.vtu: I_t 1.82187")
    assert "within" in found.words
    assert "128, 512" in found.words.replace("32, ", "")
    assert math.hypot(*found.moments.centroid) < 1e-15


def test_stress_modulus_of_a_round_bar_is_that_of_its_thinner_end() -> None:
    (bar,) = torsion.parse(
        "name: a\ntrain: [shaft: {length: 1, diameter: [0.2, 0.1], bore: 0.05}]"
    ).train.bars
    assert stress_modulus(bar) == section_modulus(0.1, 0.05)


def test_class_rule_leaves_a_meshed_shaft_out_and_says_why(scene) -> None:
    from torsion.rules.verdict_line import Checks

    operation = (
        "operation: {speeds: {from: 300 rpm, to: 900 rpm}, rated: {speed: 900 rpm, power: 1 kW}}\n"
    )
    tail = "- shaft: {name: tail, length: 1, diameter: 0.1, role: propeller}\nrules: [iacs-m68]\n"
    tail += "excitations: [{at: a, order: 2, torque: 1 N*m}]\n"
    text = (
        scene.read_text().replace("unit: mm}}", "unit: mm}, role: intermediate}") + tail + operation
    )
    scene.write_text(text)
    rows = [
        check
        for check in torsion.run(torsion.read(scene)).need(Checks).lines
        if check.where == "line"
    ]
    assert [(check.verdict, "mesh" in check.note) for check in rows] == [("not judged", True)]
    scene.write_text(text.replace(", role: propeller", ""))
    with pytest.raises(torsion.InputError, match="no round shaft has a `role`"):
        torsion.read(scene)


def test_bending_of_a_meshed_tube_is_left_out(scene) -> None:
    from torsion.rules.universal_joints import tubes

    line = "- joint: {angle: 5 deg}\n- shaft: {name: tube, length: 1, section: {mesh: square.vtu, unit: mm}}\n"
    scene.write_text(
        scene.read_text() + line + "- joint: {angle: 5 deg}\n- disc: {name: c, inertia: 1}\n"
    )
    (tube,) = tubes(torsion.read(scene).train)
    assert "mesh" in tube.lacks


def test_scene_of_a_keyed_shaft_is_softer_than_the_plain_one() -> None:
    """Its keyway of 18 x 7 mm, rounded with 0.6 mm, takes an eighth of the stiffness and concentrates stress."""
    (found,) = section_results(torsion.read(SCENES / "keyed_shaft.yaml").train).values()
    plain = math.pi / 32.0 * 0.06**4
    inscribed = math.pi / 2.0 * 0.023**4
    assert inscribed < found.levels[-1].lower < found.levels[-1].upper < plain
    assert found.error < 1e-8
    area = math.pi * 0.03**2 - found.moments.area
    assert area == pytest.approx(18e-3 * 7e-3, rel=0.15), "the segment above the keyway is the rest"
    assert found.stress_modulus < 0.5 * section_modulus(0.06)
    assert found.changes[-1] < 1e-2


LOADED = """
import sys, torsion
torsion.modes(torsion.assemble(torsion.read(sys.argv[1]).train), count=2)
print(sorted({"meshio", "skfem"} & set(sys.modules)))
"""


@pytest.mark.parametrize(("name", "loaded"), [("usv", []), ("keyed_shaft", ["meshio", "skfem"])])
def test_mesh_libraries_are_imported_by_scenes_with_a_mesh_alone(name, loaded) -> None:
    command = [sys.executable, "-c", LOADED, str(SCENES / f"{name}.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == str(loaded)
