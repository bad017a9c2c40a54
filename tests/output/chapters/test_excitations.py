"""What excites the train: torques as the file gives them, joints, and the harmonic components of the response."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.system_data import SystemData
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.modes.mass_elastic import chapter

TEXT = """
name: geared
operation: {at: m, speeds: {from: 10 rad/s, to: 50 rad/s, steps: 5}, rated: {speed: 30 rad/s, power: 5 kW}}
train:
- motor: {name: m, inertia: 1, ripple: [{order: 6, torque: 2.5 %}], source: maker}
- gear: {name: g, ratio: 5/2, inertia: [0.5, 2.25]}
- coupling: {name: c, stiffness: 2e4, psi: 1}
- disc: {name: d, inertia: 1}
excitations:
- {at: d, order: 5, torque: 1234.5, phase: 40 deg}
- {at: d, order: 1/2, torque: 0}
- {at: d, order: 3, torque: [[30 rpm, 500], [400 rpm, 2500]]}
- {at: m, frequency: 7.25, torque: 2}
- {at: m, torque: 3}
analyses: {response: {frequencies: {from: 1, to: 2, steps: 3}}}
"""


def test_torques_as_the_file_gives_them() -> None:
    found = torsion.run(torsion.parse(TEXT))
    own = 30.0 * 0.4 * 30.0 / math.pi  # rpm of the disc at the rated speed
    between = 500.0 + 2000.0 * (own - 30.0) / 370.0
    rows = [
        (
            row.name,
            row.order,
            row.reference_order,
            row.frequency,
            row.torque,
            row.of_mean,
            row.source,
        )
        for row in found.need(SystemData).torques
    ]
    assert rows == [
        ("m", 6, 6, None, None, 0.025, "maker"),
        ("d", 5, 2, None, 1234.5, None, None),
        ("d", Fraction(1, 2), Fraction(1, 5), None, 0.0, None, None),
        ("d", 3, Fraction(6, 5), None, None, None, None),
        ("m", None, None, 7.25, 2.0, None, None),
        ("m", None, None, None, 3.0, None, None),
    ]
    rated = [row.rated for row in found.need(SystemData).torques]
    assert rated == pytest.approx([0.025 * 5000 / 30, 1234.5, 0.0, between, 2.0, 3.0], rel=1e-12)
    assert found.need(SystemData).torques[1].phase == pytest.approx(math.radians(40.0), rel=1e-15)
    (table,) = (
        block for block in chapter(found) if isinstance(block, Table) and "torques" in block.caption
    )
    assert [row[-1] for row in table.rows[:2]] == ["maker", "–"]


def test_harmonic_components_of_the_response() -> None:
    """Sources once each."""
    found = torsion.run(torsion.parse(TEXT))
    response = found.need(Response)
    lines = tuple(
        replace(line, sources=("x", "y", "x"), own_orders=()) for line in response.lines[:2]
    )
    lines = replace(lines[0], order=Fraction(5, 2)), replace(lines[1], order=None, frequency=7.25)
    frequency = np.array([[3.0, 7.25], [1.5, 7.25], [9.0, 7.25]])
    *_, said = chapter(found.having(response=replace(response, lines=lines, frequency=frequency)))
    assert (
        "Harmonic components of the response, per revolution of m: 2.5 × x, y, 7.25 Hz (x, y)."
        in said.text
    )
    for none in (replace(response, lines=()), None):
        assert isinstance(list(chapter(found.having(response=none)))[-1], Table)


def test_joints_are_named_with_their_order(bare: Findings) -> None:
    text = """
name: x
train:
- disc: {inertia: 1}
- joint: {name: a, angle: 10 deg}
- coupling: {stiffness: 100}
- joint: {name: pot, kind: tripod, angle: 20 deg, radius: 30 mm, arm: 600 mm}
- disc: {inertia: 1}
"""
    *_, head, said = chapter(torsion.run(torsion.parse(text)))
    assert head == Heading("Excitations", 2)
    assert isinstance(said, Paragraph)
    assert said.text.endswith("with the order of their driving shaft: a (order 2), pot (order 3).")
    assert head not in list(chapter(bare))
