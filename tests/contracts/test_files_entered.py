"""How many files of the program a figure of the input passes on its way to results.json."""

import subprocess
import sys
from pathlib import Path

import pytest

COUPLING = """
name: one coupling
operation: {speeds: {from: 300 rpm, to: 1800 rpm}, rated: {speed: 1500 rpm, power: 100 kW}}
train:
- motor: {inertia: 1.2, ripple: [{order: 2, torque: 5 %}]}
- coupling: {stiffness: 20 kN*m/rad, psi: 0.8, rated_torque: 1.0 kN*m, vibratory_torque: 0.3 kN*m}
- propeller: {inertia: 0.8}
rules: [coupling-maker]
"""
JOINT = COUPLING.replace(
    "- propeller", "- joint: {angle: 5 deg}\n- shaft: {length: 1 m, diameter: 60 mm}\n- propeller"
)
STEP = """
name: two discs
train:
- disc: {name: a, inertia: 1 kg*m^2}
- coupling: {stiffness: 100 N*m/rad}
- disc: {name: b, inertia: 2 kg*m^2}
analyses: {transient: {duration: 1 s, events: [{at: a, step: {torque: 5 N*m}}]}}
"""
COUNT = """
import contextlib, io, sys
source, scene = sys.argv[1:]
entered = set()

def note(frame, event, argument):
    name = frame.f_code.co_filename
    if event == "call" and name.startswith(source) and frame.f_code.co_name != "<module>":
        entered.add(name)

from torsion.cli import main
sys.argv = ["torsion", "solve", scene, "--json"]
sys.setprofile(note)
with contextlib.redirect_stdout(io.StringIO()) as text, contextlib.suppress(SystemExit):
    main()
sys.setprofile(None)
assert '"checks"' in text.getvalue()
print(len(entered))
"""


@pytest.mark.parametrize(
    ("scene", "most"),
    [(COUPLING, 55), (JOINT, 68), (STEP, 56)],
    ids=["stiffness", "angle of a joint", "step of torque"],
)
def test_a_figure_enters_few_files(scene: str, most: int, tmp_path: Path) -> None:
    """Files in which a function or the body of a class runs, from the command to the text of the results."""
    file, source = tmp_path / "scene.yaml", Path(__file__).parents[2] / "src" / "torsion"
    file.write_text(scene, encoding="utf-8")
    command = [sys.executable, "-c", COUNT, str(source), str(file)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert int(done.stdout) <= most
