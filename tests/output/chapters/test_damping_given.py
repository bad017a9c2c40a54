"""The damping used: internal with what the file gives of it, to ground by model, and what is said of too little."""

import math
from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse
from torsion.analyses.system_data import SystemData
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.modes.mass_elastic import NO_DAMPING, chapter

TEXT = """
name: all damping
operation: {at: m, speeds: {from: 10 rad/s, to: 50 rad/s, steps: 5}, rated: {speed: 31 rad/s, power: 5 kW}}
materials: {alloy: {shear_modulus: 80 GPa, density: 7850, loss_factor: 0.0125}}
train:
- motor: {name: m, inertia: 1, damping: 3.25, source: maker}
- coupling: {name: soft, stiffness: 2e4, psi: 0.1234567}
- disc: {name: d, inertia: 1, damping: 2.5}
- coupling: {name: oily, stiffness: 2e4, viscous: 4.5}
- coupling: {name: stiff, flexibility: 0}
- disc: {name: e, inertia: 1}
- coupling: {name: dry, stiffness: 0.5}
- shaft: {name: tail, length: 1 m, diameter: 50 mm, segments: 2, material: alloy}
- coupling: {name: steel, stiffness: 2e4}
- damper: {name: v, housing: 1, ring: 2, damping: 7.5}
- gear: {name: g, ratio: 5/2, inertia: [0.5, 2.25]}
- propeller: {name: screw, inertia: 3, diameter: 1.5 m, pitch_ratio: 0.9, area_ratio: 0.6, damping: DAMPING}
"""
EXCITED = "excitations: [{at: m, order: 1, torque: 1}]\n"


def solved(damping: str = "2", text: str = TEXT) -> Findings:
    return torsion.run(torsion.parse(text.replace("DAMPING", damping)))


def ground(findings: Findings) -> dict[str, tuple[str, ...]]:
    rows = findings.need(SystemData).ground
    return {row.station: (row.model, row.factor, row.value, row.source) for row in rows}


def texts(findings: Findings) -> list[str]:
    return [block.text for block in chapter(findings) if isinstance(block, Paragraph)]


def test_undamped_elements_are_named() -> None:
    assert [text for text in texts(solved()) if "Undamped: dry, steel." in text]
    assert "Undamped" not in " ".join(texts(solved("2", SMALL)))


SMALL = """
name: x
train: [disc: {name: d, inertia: 2, damping: DAMPING}, coupling: {stiffness: 5, psi: 1}, disc: {inertia: 3}]
"""


def test_damping_to_ground_has_a_table_where_there_is_some() -> None:
    for text, count in ((SMALL, 1), (SMALL.replace(", damping: DAMPING", ""), 0)):
        blocks = list(chapter(solved("2", text)))
        assert Heading("Damping", 2) in blocks
        captions = [block.caption for block in blocks if isinstance(block, Table)]
        assert captions.count("Damping to ground") == count


SCHWANECKE = 0.0231 * 1025 * 1.5**5 * 0.81 * 0.6 / math.pi * 31 * 0.4


@pytest.mark.parametrize(
    ("damping", "model", "factor", "value"),
    [
        ("2", "viscous", None, 2.0),
        ("{model: schwanecke}", "schwanecke", None, SCHWANECKE),
        (
            "{model: archer, factor: 30}",
            "archer",
            30.0,
            30 * (5000 / 31 / 0.4) / (31 * 0.4 * 30 / math.pi),
        ),
        ("{model: frahm, factor: 4}", "frahm", 4.0, 4 * (5000 / 31 / 0.4) / (31 * 0.4)),
    ],
)
def test_damping_to_ground_at_the_rated_speed(
    damping: str, model: str, factor: float | None, value: float
) -> None:
    """At 31 rad/s of the motor, 2/5 of that at the screw; a constant needs no speed."""
    found = solved(damping)
    assert ground(found) == {
        "m": ("viscous", None, 3.25, "maker"),
        "d": ("viscous", None, 2.5, None),
        "screw": (model, factor, pytest.approx(value, rel=1e-12), None),
    }
    made = [block.caption for block in chapter(found) if isinstance(block, Table)]
    assert f"Damping to ground at {31 * 30 / math.pi:.3f} rpm" in made


@pytest.mark.parametrize(
    ("damping", "values"),
    [
        ("{model: frahm, factor: 4}", (None, None)),
        ("{model: schwanecke}", (None, SCHWANECKE)),
        ("2", (2.0, 2.0)),
    ],
)
def test_damping_that_is_not_known_has_no_value(
    damping: str, values: tuple[float | None, float | None]
) -> None:
    rated = "rated: {speed: 31 rad/s, power: 5 kW}"
    for text, value in (
        (TEXT.replace(f", {rated}", ""), values[0]),
        (TEXT.replace(", power: 5 kW", ""), values[1]),
    ):
        stated = ground(solved(damping, text))["screw"][2]
        assert stated == (None if value is None else pytest.approx(value, rel=1e-12))


def test_next_to_no_damping_is_no_prediction() -> None:
    found = solved("2", TEXT + EXCITED)
    weak = replace(
        found.need(DampedModes), damping_ratio=np.array([0.5, 0.9e-4, 1e-4, 0.02, 0.5e-4])
    )
    (said,) = [text for text in texts(found.having(damped_modes=weak)) if "damping ratio" in text]
    assert said.startswith("The damping ratio of mode 2, 5 is below 0.01 %: the amplitudes")
    strong = replace(weak, damping_ratio=np.array([0.5, 1e-4]))
    for one in (
        found.having(damped_modes=strong),
        found.having(damped_modes=weak, response=None),
        found.having(damped_modes=None),
    ):
        assert not [text for text in texts(one) if "damping ratio" in text]


def test_an_undamped_train_says_so_where_it_responds(undamped: Findings, bare: Findings) -> None:
    assert Heading("Damping", 2) not in list(chapter(bare))
    assert NO_DAMPING in texts(undamped)
    text = "name: x\ntrain: [disc: {name: a, inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
    text += "excitations: [{at: a, torque: 1}]\nanalyses: {response: {frequencies: {from: 1, to: 2, steps: 3}}}\n"
    over_frequency = torsion.run(torsion.parse(text))
    assert over_frequency.get(FrequencyResponse) is not None
    assert NO_DAMPING in texts(over_frequency)
