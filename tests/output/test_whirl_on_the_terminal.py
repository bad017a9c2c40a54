"""A shaft is called unstable on the terminal where its whirl grows, and nowhere else."""

import io

import pytest
from rich.console import Console

import torsion
from torsion.output.document import document
from torsion.output.pages.terminal import show

SCENE = """
name: Cardan shaft
operation: {{speeds: {{from: {first} rpm, to: {last} rpm, steps: 9}}}}
train:
  - motor: {{inertia: 1}}
  - joint: {{angle: 8 deg}}
  - shaft: {{name: tube, length: 1.5 m, diameter: 60 mm, bore: 50 mm, loss_factor: 0.02}}
  - joint: {{angle: 5 deg}}
  - disc: {{name: pump, inertia: 2}}
analyses: {{lateral: {{modes: 2}}}}
"""


@pytest.mark.parametrize(("first", "last", "grows"), [(300, 2000, False), (3000, 8000, True)])
def test_internal_damping_makes_a_shaft_unstable_above_its_critical_speed_alone(first, last, grows):
    """Simply supported at its joints the tube has its first critical speed near 4190 rpm."""
    stream = io.StringIO()
    found = torsion.run(torsion.parse(SCENE.format(first=first, last=last)))
    show(document(found), None, Console(file=stream, width=120, color_system=None))
    assert "tube" in stream.getvalue()
    assert ("(UNSTABLE)" in stream.getvalue()) == grows
