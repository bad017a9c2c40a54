"""The mean torque of every element, in the table and in the figure, of torques written by hand."""

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

import torsion
from torsion.analyses.steady import Steady, mean_loads
from torsion.findings import Findings
from torsion.output.blocks import Heading, Paragraph, Table
from torsion.output.chapters.response.mean_torques import chapter

RPM = 30.0 / math.pi
TEXT = """
name: geared
operation: {at: m, speeds: {from: 10 rad/s, to: 50 rad/s, steps: 5}, rated: {speed: 28 rad/s, power: 5 kW}}
train:
- motor: {name: m, inertia: 1}
- coupling: {name: c, stiffness: 2e4}
- gear: {name: g, ratio: 5/2, inertia: [0.5, 2.25], mesh_stiffness: 1e6}
- shaft: {name: tail, length: 1 m, diameter: 50 mm, segments: 2}
- propeller: {name: screw, inertia: 3}
"""
SPEED = np.array([12.0, 20.0, 27.0, 40.0])
RISE = np.array([-4.0, 1.0, 2.0, 3.0])


def written(scale: Sequence[float], text: str = TEXT, speed: np.ndarray = SPEED) -> Findings:
    """Torques of c, g and both segments of the tail are these times the rise, N m."""
    found = torsion.run(torsion.parse(text))
    names = [span.name for span in found.system.spans]
    torque = np.zeros((len(names), len(speed)))
    for name, size in zip(("c", "g", "tail [1]", "tail [2]"), scale, strict=True):
        torque[names.index(name)] = size * RISE[: len(speed)]
    mean, operation = replace(found.need(Steady), speed=speed, torque=torque), found.study.operation
    point = int(np.argmin(np.abs(speed - (operation.speed or speed[-1]))))
    return found.having(mean=mean, mean_loads=mean_loads(found.system, mean, point))


def table(findings: Findings) -> Table:
    return next(block for block in chapter(findings) if isinstance(block, Table))


def test_mean_torque_and_power_at_the_speed_nearest_to_the_rated() -> None:
    """27 rad/s; largest are magnitudes, of the tail the larger one of its segments."""
    found = written((100.0, -200.0, 500.0, 700.0))
    made = table(found)
    assert made.rows == (
        ("c", "257.83", "0.20000", f"{200 * 27 / 1e3:.4f}", "0.40000"),
        ("g", "257.83", "−0.40000", f"−{400 * 27 / 1e3:.3f}", "0.80000"),
        ("tail", "103.13", "1.0000", f"{1000 * 27 * 0.4 / 1e3:.3f}", "2.8000"),
    )
    assert [column.unit for column in made.columns] == ["", "rpm", "kN m", "kW", "kN m"]
    head, said, *_ = chapter(found)
    assert head == Heading("Mean torque")
    assert isinstance(said, Paragraph)
    assert said.text.startswith(found.need(Steady).sharing)


def test_without_a_rated_speed_the_highest_counts() -> None:
    text = TEXT.replace(
        "rated: {speed: 28 rad/s, power: 5 kW}", "load: [[10 rad/s, 5], [50 rad/s, 9]]"
    )
    found = written((1.0, 2.0, 5.0, 5.0), text)
    assert [row[2] for row in table(found).rows] == ["3.0000", "6.0000", "15.000"]


def test_nothing_without_a_mean_torque(bare: Findings) -> None:
    found = written((1.0, 2.0, 3.0, 4.0))
    still = replace(found.need(Steady), torque=0.0 * found.need(Steady).torque)
    assert (
        list(chapter(found.having(mean=still)))
        == list(chapter(found.having(mean=None)))
        == list(chapter(bare))
        == []
    )
    one = written((1.0, 2.0, 3.0, 4.0), speed=SPEED[:1])
    assert [row[2] for row in table(one).rows] == ["−4.0000", "−8.0000", "−12.000"]
