"""Damping by mode: against closed forms, the undamped train, and motion over time; and what is refused beside it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.motion.transient_motion import Transients
from torsion.analyses.response.harmonic_components import sources, sweeping
from torsion.analyses.response.solver import answer
from torsion.assembly import assemble
from torsion.assembly.matrices import matrices
from torsion.errors import InputError
from torsion.output.blocks import Paragraph
from torsion.output.chapters.modes.mass_elastic import chapter

CHAIN = """name: x
damping: {{modal: {}}}
train:
- disc: {{name: d1, inertia: 1}}
- coupling: {{name: s1, stiffness: 2e4}}
- disc: {{name: d2, inertia: 0.2}}
- coupling: {{name: s2, flexibility: 0}}
- disc: {{name: d3, inertia: 0.3}}
- coupling: {{name: s3, stiffness: 4e4}}
- disc: {{name: d4, inertia: 0}}
- coupling: {{name: s4, stiffness: 3e4}}
- gear: {{name: g, teeth: [20, 41], inertia: [0.1, 0.4]}}
- coupling: {{name: s5, stiffness: 5e4}}
- disc: {{name: d5, inertia: 3}}
excitations: [{{at: {}, torque: 7}}]
analyses: {{response: {{frequencies: {{from: 5, to: 60, steps: 40}}}}}}
"""


def at(text: str, w: np.ndarray, ratios: tuple[float, ...] | None = None):
    """The answer at w (rad/s), with these damping ratios in place of those of the text."""
    study = torsion.parse(text)
    train = study.train if ratios is None else replace(study.train, modal_damping=ratios)
    system = assemble(train, model="lumped")
    force = sources(system, sweeping(system), np.array([0.0]), None)
    force = replace(force, force=np.tile(force.force, (1, len(w))))
    return answer(system, w, force, np.zeros((len(system.stations), len(w))))


def test_two_discs_answer_as_one_damped_mode() -> None:
    text = """name: x
damping: {modal: 3 %}
train: [disc: {name: d1, inertia: 2}, coupling: {stiffness: 1e4}, disc: {inertia: 3}]
excitations: [{at: d1, torque: 7}]
analyses: {response: {frequencies: {from: 1, to: 20, steps: 40}}}
"""
    found = torsion.run(torsion.parse(text)).results["frequency_response"]
    w, own = 2.0 * math.pi * found.frequency, math.sqrt(1e4 / 1.2)
    exact = 1e4 * (7.0 / 2.0) / (own**2 - w**2 + 0.06j * own * w)
    assert found.torque[:, 0] == pytest.approx(exact, rel=1e-13)


@pytest.mark.parametrize("place", ["d1", "d2", "d4", "d5"])
def test_without_damping_the_sum_over_the_modes_is_the_exact_answer(place: str) -> None:
    w = np.linspace(3.0, 900.0, 61)
    swept, summed = at(CHAIN.format("1 %", place), w, ()), at(CHAIN.format("1 %", place), w, (0.0,))
    for one, other in ((swept.torque, summed.torque), (swept.angle, summed.angle)):
        assert np.abs(one - other).max() <= 1e-11 * np.abs(one).max()


def test_a_list_by_mode_damps_each_by_its_own_and_those_above_by_the_last() -> None:
    found = torsion.run(
        torsion.parse(
            CHAIN.format("[1 %, 3 %]", "d1").replace("{response", "{modes: {count: 3}, response")
        )
    )
    assert found.need(DampedModes).damping_ratio == pytest.approx([0.01, 0.03, 0.03], rel=1e-14)


def test_motion_over_time_ends_in_the_response() -> None:
    text = CHAIN.format("4 %", "d4").replace(
        "{response",
        "{transient: {duration: 6 s, events: [{at: d4, sine: {torque: 7, frequency: 5, phase: 90 deg}}]}, response",
    )
    found = torsion.run(torsion.parse(text))
    moved, steady = found.need(Transients).each[0], found.results["frequency_response"]
    late = moved.time > 5.5
    exact = (steady.torque[0][:, None] * np.exp(10j * math.pi * moved.time[late])).real
    assert np.abs(moved.torque[:, late] - exact).max() <= 1e-9 * np.abs(exact).max()


def test_the_report_says_that_modes_are_damped() -> None:
    text = [
        one.text
        for one in chapter(torsion.run(torsion.parse(CHAIN.format("2 %", "d1"))))
        if isinstance(one, Paragraph)
    ]
    assert any("Damping ratio of every elastic mode: 2.00" in one for one in text)


@for_all(
    ("change", "words"),
    [
        (("stiffness: 2e4", "stiffness: 2e4, viscous: 3"), "'s1' has damping"),
        (("inertia: 0.3}", "inertia: 0.3, damping: 3}"), "'d3' has damping"),
        (("modal: 2 %", "modal: -2 %"), "at least 0"),
        (("modal: 2 %", "modal: 100 %"), "less than"),
        (("modal: 2 %", "modal: []"), "too short"),
        (("{modal: 2 %}", "2 %"), "not a mapping"),
        (
            ("analyses: {", "analyses: {stability: {}, "),
            "`stability` does not support damping by mode",
        ),
        (("analyses: {", "analyses: {check: {}, "), "`check` does not support damping by mode"),
        (
            (
                "name: s1, stiffness: 2e4}",
                "name: s1, stiffness: 2e4, heat_limit: 9, rated_torque: 1}",
            ),
            "the heat of 's1'",
        ),
        (
            ("- gear: {name: g, teeth: [20, 41], inertia: [0.1, 0.4]}", "- joint: {angle: 5 deg}"),
            "with joints",
        ),
    ],
)
def test_damping_by_mode_is_refused_beside_what_it_does_not_fit(
    change: tuple[str, str], words: str
) -> None:
    text = CHAIN.format("2 %", "d1")
    assert text.count(change[0]) == 1
    with pytest.raises(InputError) as refused:
        torsion.parse(
            text.replace(*change) + ("rules: [coupling-maker]\n" if "heat" in words else "")
        )
    assert words in str(refused.value)


def test_damping_by_mode_has_no_matrices() -> None:
    study = torsion.parse(CHAIN.format("2 %", "d1"))
    with pytest.raises(InputError, match="has no matrix"):
        matrices(assemble(study.train, model="lumped"))
