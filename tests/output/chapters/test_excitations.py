"""What excites the train: torques as the file gives them, joints, and the harmonic components of the response."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np

import torsion
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.excitations import chapter
from torsion.output.numbers import number

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


def tables(findings: Findings) -> list[Table]:
    return [block for block in chapter(findings) if isinstance(block, Table)]


def test_torques_as_the_file_gives_them() -> None:
    found = torsion.run(torsion.parse(TEXT))
    (torques,) = tables(found)
    own = 30.0 * 0.4 * 30.0 / math.pi  # rpm of the disc at the rated speed
    between = number((500.0 + 2000.0 * (own - 30.0) / 370.0) / 1e3)
    assert torques.columns[5].unit == "kN m"
    assert torques.rows == (
        ("m", "6", "6", "–", "2.5 % of the mean torque", "0.0041667", "0", "maker"),
        ("d", "5", "2", "–", "1.2345 kN m", "1.2345", "40", "not stated"),
        ("d", "0.5", "0.2", "–", "0 N m", "0", "0", "not stated"),
        (
            "d",
            "3",
            "1.2",
            "–",
            "0.5 kN m at 30 rpm; 2.5 kN m at 400 rpm",
            between,
            "0",
            "not stated",
        ),
        ("m", "–", "–", "7.25", "2 N m", "0.0020000", "0", "not stated"),
        ("m", "–", "–", "all requested", "3 N m", "0.0030000", "0", "not stated"),
    )
    train = found.study.train
    both = replace(
        train, torques=tuple(replace(one, of_mean=0.0625) for one in train.torques[1:4:2])
    )
    rows = tables(replace(found, study=replace(found.study, train=both)))[0].rows
    assert [row[4] for row in rows] == [
        "1.2345 kN m + 6.25 % of the mean torque",
        "0.5 kN m at 30 rpm; 2.5 kN m at 400 rpm + 6.25 % of the mean torque",
    ]


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
    assert said.text.startswith(
        "Harmonic components of the response, per revolution of m: 2.5 × x, y, 7.25 Hz (x, y)."
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
    head, said = chapter(torsion.run(torsion.parse(text)))
    assert head == Heading("Appendix: excitations")
    assert isinstance(said, Paragraph)
    assert said.text.endswith("with the order of their driving shaft: a (order 2), pot (order 3).")
    assert list(chapter(bare)) == []
    alone = torsion.run(torsion.parse(TEXT[: TEXT.index("- {at: m, torque")]))
    assert sum(isinstance(block, Paragraph) for block in chapter(alone)) <= 1
