"""Designs that change how a lumped shaft is divided: a choice, and the frequency of the continuum at it."""

import math

import pytest

import torsion
from torsion.what_if.design.candidates import shaft_mass
from torsion.what_if.design.design_results import Design

SHEAR, DENSITY, FIRST, SECOND = 79.3e9, 7850.0, 1.0, 2.0
SCENE = f"""name: x
materials: {{s: {{shear_modulus: 79.3 GPa, density: 7850 kg/m**3}}}}
train:
- disc: {{name: a, inertia: {FIRST}}}
- shaft: {{name: line, length: 2 m, diameter: 80 mm, material: s}}
- disc: {{name: b, inertia: {SECOND}}}
analyses: {{modes: COUNT, design: {{choose: {{line.WHAT: {{from: FROM, to: TO}}}}, aim: {{mode-AIM Hz}}}}}}
"""


def lack(frequency: float, length: float, diameter: float) -> float:
    """Torque that the second disc lacks, where the first turns by 1 rad; 0 at a natural frequency of the continuum."""
    w = 2.0 * math.pi * frequency
    impedance = math.pi / 32.0 * diameter**4 * math.sqrt(SHEAR * DENSITY)
    along = w * length * math.sqrt(DENSITY / SHEAR)
    sine = -FIRST * w / impedance
    torque = impedance * w * (-math.sin(along) + sine * math.cos(along))
    return torque - SECOND * w**2 * (math.cos(along) + sine * math.sin(along))


@pytest.mark.parametrize(
    ("what", "first", "last", "aim", "count"),
    [
        ("diameter", "60 mm", "200 mm", "2.frequency: 800", ""),
        ("diameter", "60 mm", "200 mm", "2.frequency: 800", "{count: 2}"),
        ("length", "1 m", "4 m", "1.frequency: 70", "{count: 2}"),
        ("diameter", "60 mm", "100 mm", "1.frequency: 60", ""),
    ],
)
def test_a_design_over_segments_ends_with_a_choice_at_its_frequency(
    what, first, last, aim, count
) -> None:
    """Trials were divided for the mode that is aimed at, and the file for all of its modes."""
    text = SCENE
    for key, value in (
        ("WHAT", what),
        ("FROM", first),
        ("TO", last),
        ("AIM", aim),
        ("COUNT", count),
    ):
        text = text.replace(key, value)
    design = torsion.run(torsion.parse(text)).need(Design)
    assert (design.chosen, design.best[0].proven) == (1, "kept")
    (chosen,) = design.picked.tolist()
    sizes = {"length": 2.0, "diameter": 0.08} | {
        what: chosen * (1e-3 if what == "diameter" else 1.0)
    }
    wanted = float(aim.split()[-1])
    assert design.best[0].frequency == pytest.approx(wanted, rel=1e-6)
    assert lack(0.999 * wanted, **sizes) * lack(1.001 * wanted, **sizes) < 0.0


def test_mass_of_conical_shafts_is_that_of_the_cones_cut_from_each_other() -> None:
    """A bore of 40 mm in a frustum of 100 to 60 mm: whole cone less its tip, less a cylinder."""
    text = f"""name: x
train:
- disc: {{inertia: 1}}
- shaft: {{length: 0.8 m, diameter: [100 mm, 60 mm], bore: 40 mm, material: s}}
- shaft: {{length: 0.3 m, diameter: 60 mm, bore: [0, 30 mm], material: s}}
- disc: {{inertia: 1}}
materials: {{s: {{shear_modulus: 79.3 GPa, density: {DENSITY}}}}}
"""
    cone = math.pi / 4.0 * (0.1**2 * 2.0 - 0.06**2 * 1.2) / 3.0  # its tip lies at 2 m
    volume = cone - math.pi / 4.0 * 0.04**2 * 0.8
    volume += math.pi / 4.0 * (0.06**2 * 0.3 - 0.03**2 * 0.3 / 3.0)
    assert shaft_mass(torsion.parse(text).train) == pytest.approx(DENSITY * volume, rel=1e-13)
