"""Scenes with names that no renderer may take for its own language."""

import pytest

import torsion
from torsion.findings import Findings

NASTY = 'quill <b>#1</b> & "co" $x$ _{y} {{ z }} \\n [a](b)'
TRAIN = """
name: "Ferry <script>alert(1)</script> & *sons*"
description: "a </style> b"
operation:
  speeds: {from: 300 rpm, to: 1800 rpm, steps: 31}
  rated: {speed: 1500 rpm, power: 100 kW}
materials:
  alloy: {shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa, loss_factor: 0.01}
train:
  - motor: {inertia: 1.2, ripple: [{order: 6, torque: 2 %}]}
  - coupling: {name: rubber, stiffness: 20 kN*m/rad, psi: 0.8, vibratory_torque: 0.3 kN*m}
  - shaft: {name: NAME, length: 0.8 m, diameter: 60 mm, role: thrust, material: alloy}
  - gear:
      teeth: [20, 41]
      inertia: [0.05, 0.2]
      branches: [{teeth: [20, 30], train: [{disc: {name: pump, inertia: 0.3}}]}]
  - branch: {train: [{coupling: {stiffness: 1e5, loss_factor: 0.05}}, {disc: {name: generator, inertia: 0.5}}]}
  - joint: {angle: 5 deg}
  - shaft: {name: tail, length: 2.0 m, diameter: [90 mm, 80 mm], role: propeller, material: alloy}
  - propeller:
      inertia: 0.8
      blades: 4
      damping: {model: archer, factor: 30}
      excitation: [{blade_order: 1, torque: 6 %}]
rules: [iacs-m68, coupling-maker, gear-hammer]
"""
BARE = (
    "name: two discs\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
)
UNDAMPED = """
name: undamped
operation: {speeds: {from: 5 rad/s, to: 15 rad/s, steps: 11}}
train: [disc: {inertia: 2}, coupling: {stiffness: 120}, disc: {name: far, inertia: 3}]
excitations: [{at: far, order: 1, torque: 1}]
"""


def solved(text: str) -> Findings:
    """The findings of a scene."""
    return torsion.run(torsion.parse(text, "scene.yaml"))


@pytest.fixture(scope="session")
def train() -> Findings:
    """A train with everything in it, and names to trip over."""
    return solved(TRAIN.replace("NAME", "'" + NASTY + "'"))


@pytest.fixture(scope="session")
def bare() -> Findings:
    """Two discs and nothing else."""
    return solved(BARE)


@pytest.fixture(scope="session")
def undamped() -> Findings:
    """A train whose resonance at 10 rad/s has no finite answer."""
    return solved(UNDAMPED)


@pytest.fixture(scope="session")
def nasty() -> str:
    """A name full of signs that mean something to HTML, Typst, Jinja, rich and the subscripts."""
    return NASTY
