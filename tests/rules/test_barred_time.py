"""How long a motion over time stays within a barred range, against the program of its speed."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

import torsion
from torsion.analyses.motion.derived.resonances_passed import share_of_steady
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.analyses.stability.unstable_ranges import UnstableRange
from torsion.findings import Findings
from torsion.output.blocks import Table
from torsion.output.chapters.verdict import barred_ranges
from torsion.output.stored.results_json import results
from torsion.rules.class_rules.barred_time import barred_times, within
from torsion.rules.stable_motion import StableMotion
from torsion.rules.verdict_line import Check, Checks

RPM = np.pi / 30.0
SCENE = """name: x
materials: {{tough: {{shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa, loss_factor: 0.04}}}}
operation: {{speeds: {{from: 300 rpm, to: 1050 rpm, steps: 151}}, rated: {{speed: 1000 rpm, power: 50 kW}}}}
train:
- disc: {{name: drive, held: true}}
- shaft: {{name: line, length: 1 m, diameter: 60 mm, role: intermediate, material: tough, segments: 1}}
- disc: {{name: screw, inertia: 10}}
excitations:
- {{at: screw, order: 2, torque: 170 N*m}}
analyses:
  response:
  transient:
    duration: 6 s
    initial: {{speed: 300 rpm}}
    events: [{{at: drive, speed: {{program: [[0 s, 300 rpm], [5 s, {last} rpm]]}}}}]
rules: [iacs-m68]
"""


@cache
def run(last: float) -> tuple[Findings, Check]:
    """The findings, and the line of the barred range."""
    found = torsion.run(torsion.parse(SCENE.format(last=last)))
    (line,) = [check for check in found.need(Checks).lines if check.clause == "tau_T"]
    return found, line


def test_a_range_is_passed_in_the_time_that_the_program_needs() -> None:
    found, line = run(900.0)
    ((barred,), (time,)) = line.barred, line.times
    gain = 600.0 * RPM / 5.0
    assert time.seconds == pytest.approx((barred.upper - barred.lower) / gain, rel=1e-9)
    assert not time.stays
    (mode,) = found.results["modes"].frequency
    w, ratio = 2.0 * np.pi * mode, 0.04 / 2.0
    assert time.share == pytest.approx(share_of_steady(ratio * w / np.sqrt(2.0 * gain)), rel=1e-6)
    assert (
        f"passed in {time.seconds:.3g} s, {100 * time.share:.3g} % of the steady resonance"
        in line.note
    )
    assert results(found)["checks"][1]["times"][0]["time_s"] == time.seconds
    (cells,) = [
        one.rows
        for one in barred_ranges(found)
        if isinstance(one, Table) and "Transients in" in one.caption
    ]
    assert cells[0][-1] == "no"  # does not end within


def test_a_motion_that_ends_within_the_range_does_not_pass_it() -> None:
    _, line = run(480.0)
    ((barred,), (time,)) = line.barred, line.times
    assert time.stays
    assert time.seconds == pytest.approx(
        1.0 + (480.0 * RPM - barred.lower) / (180.0 * RPM / 5.0), rel=1e-9
    )
    assert "ends within the range" in line.note


def test_of_several_resonances_in_a_range_the_largest_share_counts() -> None:
    found, line = run(900.0)
    transients = found.results["transient"]
    (motion,) = transients.each
    (barred,) = line.barred
    passage = next(
        part for part in motion.passages if barred.lower < abs(part.speed) < barred.upper
    )
    shares = {0.5: 0.97, 0.2: 0.3, 1.2: 1.0}  # by place in the range; the last lies beyond it
    places = (
        replace(passage, speed=barred.lower + at * (barred.upper - barred.lower), share=share)
        for at, share in shares.items()
    )
    several = replace(transients, each=(replace(motion, passages=tuple(places)),))
    (time,) = barred_times(found.having(transient=several), line.barred)
    assert time.share == 0.97


@pytest.mark.parametrize("last", [480.0, 900.0])
def test_a_train_that_turns_backward_stays_as_long_in_a_range(last: float) -> None:
    found, line = run(last)
    transients = found.results["transient"]
    (motion,) = transients.each
    backward = replace(transients, each=(replace(motion, speed=-motion.speed),))
    assert line.times
    assert barred_times(found.having(transient=backward), line.barred) == line.times


def test_a_motion_through_an_unstable_range_says_how_long_it_is_within() -> None:
    found, _ = run(900.0)
    speed = np.linspace(30.0, 100.0, 5)
    zone = UnstableRange("principal", (1,), 1, 50.0, 56.0, (False, False), 0.3, 53.0)
    none = np.full(5, -1.0)
    unstable = Stability(
        speed,
        np.ones(5, dtype=bool),
        none,
        none,
        none,
        (zone,),
        np.array([50.0]),
        "monodromy",
        0.0,
        speed[:0],
        True,
    )
    (line,) = StableMotion(None).check(found.having(stability=unstable))
    assert line.verdict == "fail"
    assert line.times[0].seconds == pytest.approx(6.0 / (600.0 * RPM / 5.0), rel=1e-9)
    assert f"is {line.times[0].seconds:.3g} s within an unstable range" in line.note


def test_speeds_outside_at_the_ends_and_still_ones() -> None:
    time = np.array([0.0, 1.0, 2.0, 5.0])
    assert within(time, np.array([1.0, 1.0, 1.0, 1.0]), 2.0, 3.0) == 0.0
    assert within(time, np.array([2.5, 2.5, 2.5, 2.5]), 2.0, 3.0) == 5.0
    assert within(time, np.array([0.0, 4.0, 0.0, 0.0]), 2.0, 3.0) == pytest.approx(0.5)
