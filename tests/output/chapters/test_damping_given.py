"""The damping used: internal with what the file gives of it, to ground by model, and what is said of too little."""

import math
from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.amplitudes import FrequencyResponse
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.damping_given import chapter
from torsion.output.numbers import number
from torsion.primitives import Damper

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


def table(findings: Findings, caption: str) -> dict[str, tuple[str, ...]]:
    made = next(
        block
        for block in chapter(findings)
        if isinstance(block, Table) and block.caption == caption
    )
    return {row[0]: row[1:] for row in made.rows}


def texts(findings: Findings) -> list[str]:
    return [block.text for block in chapter(findings) if isinstance(block, Paragraph)]


def test_internal_damping_in_all_its_measures() -> None:
    eta = 0.1234567 / (2.0 * math.pi)
    found = solved()
    assert table(found, "Internal damping") == {
        "soft": ("ψ = 0.123457", number(eta), "0.12346", number(1.0 / eta), "–"),
        "oily": ("c = 4.5", "–", "–", "–", "4.5000"),
        "tail": ("material alloy", "0.012500", number(2.0 * math.pi * 0.0125), "80.000", "–"),
        "v ring": ("c = 7.5", "–", "–", "–", "7.5000"),
    }
    assert "Undamped: dry, steel." in texts(found)
    assert next(iter(chapter(found))) == Heading("Appendix: damping")
    assert "Undamped" not in " ".join(texts(solved("2", SMALL)))


SMALL = """
name: x
train: [disc: {name: d, inertia: 2, damping: DAMPING}, coupling: {stiffness: 5, psi: 1}, disc: {inertia: 3}]
"""


def test_only_what_damps_has_a_table() -> None:
    captions = [block.caption for block in chapter(solved("2", SMALL)) if isinstance(block, Table)]
    assert captions == ["Internal damping", "Damping to ground"]
    for text, left in (
        (SMALL.replace(", damping: DAMPING", ""), captions[0]),
        (SMALL.replace(", psi: 1", ""), captions[1]),
    ):
        assert [
            block.caption for block in chapter(solved("2", text)) if isinstance(block, Table)
        ] == [left]


@pytest.mark.parametrize(
    ("damping", "row"),
    [
        ("2", ("viscous", "–", "2.0000")),
        (
            "{model: schwanecke}",
            ("schwanecke", "–", number(0.0231 * 1025 * 1.5**5 * 0.81 * 0.6 / math.pi * 31 * 0.4)),
        ),
        (
            "{model: archer, factor: 30}",
            ("archer", "30", number(30 * (5000 / 31 / 0.4) / (31 * 0.4 * 30 / math.pi))),
        ),
        ("{model: frahm, factor: 4}", ("frahm", "4", number(4 * (5000 / 31 / 0.4) / (31 * 0.4)))),
    ],
)
def test_damping_to_ground_at_the_rated_speed(damping: str, row: tuple[str, ...]) -> None:
    """At 31 rad/s of the motor, 2/5 of that at the screw; a constant needs no speed."""
    found = table(solved(damping), "Damping to ground")
    assert found == {
        "m": ("viscous", "–", "3.2500", "maker"),
        "d": ("viscous", "–", "2.5000", "not stated"),
        "screw": (*row, "not stated"),
    }
    made = next(
        block
        for block in chapter(solved(damping))
        if isinstance(block, Table) and "ground" in block.caption
    )
    assert made.columns[3].title == f"Value at {31 * 30 / math.pi:.3f} rpm"


@pytest.mark.parametrize(
    ("damping", "values"),
    [
        ("{model: frahm, factor: 4}", ("varies with speed", "varies with mean torque")),
        (
            "{model: schwanecke}",
            ("varies with speed", number(0.0231 * 1025 * 1.5**5 * 0.81 * 0.6 / math.pi * 31 * 0.4)),
        ),
        ("2", ("2.0000", "2.0000")),
    ],
)
def test_damping_that_is_not_known_varies(damping: str, values: tuple[str, str]) -> None:
    rated = "rated: {speed: 31 rad/s, power: 5 kW}"
    for text, value in (
        (TEXT.replace(f", {rated}", ""), values[0]),
        (TEXT.replace(", power: 5 kW", ""), values[1]),
    ):
        assert table(solved(damping, text), "Damping to ground")["screw"][2] == value
    bare = next(
        block
        for block in chapter(solved(damping, TEXT.replace(f", {rated}", "")))
        if isinstance(block, Table) and "ground" in block.caption
    )
    assert bare.columns[3].title == "Value"


def test_dampers_of_one_place_add_up() -> None:
    """A constant beside another, and beside one that varies with the mean torque, known or not."""
    varying = 4 * (5000 / 31 / 0.4) / (31 * 0.4)
    unknown = TEXT.replace(", power: 5 kW", "")
    for damping, text, value in (
        ("2", TEXT, "7.5000"),
        ("{model: frahm, factor: 4}", TEXT, number(5.5 + varying)),
        ("{model: frahm, factor: 4}", unknown, "varies with mean torque"),
    ):
        found = solved(damping, text)
        system = found.system
        (own,) = [one for one in system.dampers if system.stations[one.station].name == "screw"]
        more = replace(system, dampers=(*system.dampers, Damper(own.station, constant=5.5)))
        assert table(found.having(system=more), "Damping to ground")["screw"][2] == value


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
    assert list(chapter(bare)) == []
    head, said = chapter(undamped)
    assert head == Heading("Appendix: damping")
    assert said.text.startswith("The train has no damping.")
    text = "name: x\ntrain: [disc: {name: a, inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
    text += "excitations: [{at: a, torque: 1}]\nanalyses: {response: {frequencies: {from: 1, to: 2, steps: 3}}}\n"
    over_frequency = torsion.run(torsion.parse(text))
    assert over_frequency.get(FrequencyResponse) is not None
    assert len(list(chapter(over_frequency))) == 2
