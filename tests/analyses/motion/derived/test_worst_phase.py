"""Phases of pulsations: as given, and the worst where a file leaves it open."""

import math

import numpy as np
import pytest
from tests.analyses.motion.test_given_cases import chain, moved

import torsion
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.errors import InputError
from torsion.output.blocks import Paragraph
from torsion.output.chapters.motion_over_time import chapter


def started(phase: object) -> TransientMotion:
    """A synchronous motor that pulls a train through its resonance; phase: None where it is left open."""
    start = {
        "torque": [["0 rpm", 1200.0], ["9000 rpm", 1200.0]],
        "synchronous": "1500 rpm",
        "slip_pulsation": [["0 rpm", 300.0], ["9000 rpm", 300.0]],
    }
    start |= {} if phase is None else {"phase": phase}
    parts = chain([4.0, 5.0], [3e4], ", viscous: 12")
    body = {
        "duration": 1.15,
        "initial": "rest",
        "events": [{"at": "d1", "start": start}],
        "tolerance": 1e-4,
    }
    return moved(parts, body)


def test_the_worst_phase_is_as_bad_as_any() -> None:
    """The resonance is passed at a time that depends on the phase: the torque over the phase has several harmonics."""
    found = started(None)
    peaks = np.array([started(f"{phase} deg").peak for phase in range(10, 360, 36)])
    assert (found.peak >= peaks.max(axis=0)).all()
    assert (found.peak <= 1.01 * peaks.max(axis=0)).all()
    assert (found.peak > 1.02 * peaks.min(axis=0)).all()  # it matters
    assert 7 <= found.phases_computed <= 10
    (phase,) = found.slip_phase
    same = started(f"{phase} rad")
    assert (same.phases_computed, same.slip_phase) == (0, ())
    assert found.torque == pytest.approx(same.torque, rel=1e-12, abs=1e-9)


def test_a_phase_of_the_slip_pulsation_is_that_of_its_cosine() -> None:
    # the disc turns freely: the speed rises by 5 rad/s2, and the pulsation adds its work
    motor = {
        "torque": [["0 rpm", 100.0], ["1500 rpm", 100.0]],
        "synchronous": "1500 rpm",
        "phase": "50 deg",
        "slip_pulsation": [["0 rpm", 1e-6], ["1500 rpm", 1e-6]],
    }
    body = {
        "duration": 1.0,
        "initial": "rest",
        "events": [{"at": "d", "start": motor}],
        "tolerance": 1e-9,
    }
    found = moved("disc: {name: d, inertia: 20}", body)
    t = np.linspace(0.0, 1.0, 200_001)
    wave = 1e-6 * np.cos(math.radians(50.0) + 200.0 * math.pi * (t - 2.5 * t**2 / (50.0 * math.pi)))
    gained = float(((wave[:-1] + wave[1:]) / 2.0).sum() * (t[1] - t[0])) / 20.0
    assert found.speed[0, -1] - 5.0 == pytest.approx(gained, rel=1e-4)


def test_a_phase_of_the_line_pulsation_is_that_of_its_sine() -> None:
    pulsation = {"torque": 40.0, "decay": 0.2, "phase": "70 deg"}
    motor = {"torque": [["0 rpm", 10.0], ["9000 rpm", 10.0]], "pulsation": pulsation}
    body = {
        "duration": 1.0,
        "initial": "rest",
        "events": [{"at": "d", "start": motor}],
        "tolerance": 1e-9,
    }
    found = moved("disc: {name: d, inertia: 2}", body)
    rate = complex(-5.0, 100.0 * math.pi)
    whole = (40.0 * np.exp(1j * math.radians(70.0)) * (np.exp(rate) - 1.0) / rate).imag
    assert found.speed[0, -1] == pytest.approx((10.0 + whole) / 2.0, rel=1e-10)


def test_a_phase_without_its_pulsation_is_refused() -> None:
    text = """name: x
train: [disc: {name: d, inertia: 1}]
analyses:
  transient:
    duration: 1 s
    events:
    - {at: d, start: {torque: [[0 rpm, 1], [10 rpm, 0]], phase: 3 deg}}
"""
    with pytest.raises(InputError, match="`phase` is that of `slip_pulsation`") as refused:
        torsion.parse(text)
    assert refused.value.faults[0].line == 7


def test_the_report_says_which_phase_it_shows() -> None:
    text = """name: x
operation: {rated: {speed: 1500 rpm, power: 200 kW}}
train: [motor: {name: m, inertia: 18}, coupling: {stiffness: 2e5, viscous: 40, max_torque: 9e3}, disc: {inertia: 12}]
analyses:
  transient:
    duration: 0.3 s
    initial: rest
    tolerance: 1e-4
    events:
    - at: m
      start:
        torque: [[0 rpm, 1800], [9000 rpm, 2000]]
        synchronous: 1500 rpm
        slip_pulsation: [[0 rpm, 700], [9000 rpm, 600]]
"""
    found = torsion.run(torsion.parse(text))
    texts = [one.text for one in chapter(found) if isinstance(one, Paragraph) and one.brief]
    assert any(
        "computed 4 phases" in one and "The curves show the worst phase" in one for one in texts
    )


def test_beside_a_play_an_open_phase_never_passes() -> None:
    text = """name: x
operation: {rated: {speed: 1500 rpm, power: 200 kW}}
train:
- motor: {name: m, inertia: 18}
- coupling: {name: c, stiffness: 2e5, clearance: {angle: 1 deg, viscous: 40}, max_torque: 9e9}
- disc: {inertia: 12}
analyses:
  transient:
    duration: 0.1 s
    initial: rest
    tolerance: 1e-4
    events:
    - at: m
      start: {torque: [[0 rpm, 1800], [9000 rpm, 2000]], synchronous: 1500 rpm, slip_pulsation: [[0 rpm, 900], [9000 rpm, 900]]PHASE}
"""  # noqa: E501
    verdicts, words = [], []
    for phase in ("", ", phase: 30 deg"):
        found = torsion.run(torsion.parse(text.replace("PHASE", phase)))
        (check,) = (one for one in found.results["checks"].lines if one.clause.startswith("T_Kmax"))
        verdicts.append(check.verdict)
        words.append(found.results["transient"].each[0].status)
    assert verdicts == ["fail", "pass"]
    assert "name its `phase`, in several motions" in words[0]
    assert words[1] == "ok"


def test_two_open_phases_never_pass_where_a_pair_is_worse_than_those_computed() -> None:
    text = """name: x
operation: {rated: {speed: 1500 rpm}}
train:
- motor: {name: m, inertia: 4}
- coupling: {stiffness: 3e4, viscous: 6, max_torque: 1e4}
- disc: {inertia: 6}
- coupling: {name: c, stiffness: 6e4, viscous: 6, max_torque: 3100}
- motor: {name: n, inertia: 5}
analyses:
  transient:
    duration: 0.7 s
    initial: rest
    tolerance: 1e-3
    samples: 1500
    events:
    - at: m
      start: {torque: [[0 rpm, 1500], [9000 rpm, 1500]], synchronous: 1500 rpm, slip_pulsation: [[0 rpm, 500], [9000 rpm, 500]]FIRST}
    - at: n
      start: {torque: [[0 rpm, 1500], [9000 rpm, 1500]], synchronous: 1500 rpm, line: 60 Hz, slip_pulsation: [[0 rpm, 500], [9000 rpm, 500]]SECOND}
"""  # noqa: E501
    checks, words = [], []
    for first, second in (("", ""), (", phase: 80 deg", ", phase: 280 deg")):
        found = torsion.run(torsion.parse(text.replace("FIRST", first).replace("SECOND", second)))
        lines = found.results["checks"].lines
        checks += [line for line in lines if line.where == "c" and "T_Kmax" in line.clause]
        words.append(found.results["transient"].each[0].status)
    assert checks[0].value < 3100.0 < checks[1].value
    assert [check.verdict for check in checks] == ["fail", "fail"]
    assert "name all but one `phase`, in several motions" in words[0]
    assert words[1] == "ok"


def test_phases_are_searched_for_a_limit_on_the_range_as_for_one_on_the_torque() -> None:
    """Beside a coupling with a limit on its torque; without it the range was 5 % too low."""
    start = {
        "torque": [["0 rpm", 1500.0], ["9000 rpm", 1500.0]],
        "synchronous": "1500 rpm",
        "slip_pulsation": [["0 rpm", 1200.0], ["9000 rpm", 1200.0]],
    }
    body = {
        "duration": 0.7,
        "initial": "rest",
        "events": [{"at": "m", "start": start}],
        "tolerance": 1e-3,
        "samples": 1500,
    }
    ranges = [
        moved(
            "disc: {name: m, inertia: 4}, "
            "coupling: {stiffness: 3e6, viscous: 300, max_torque: 2e5}, disc: {inertia: 1}, "
            f"coupling: {{stiffness: 1.5e4, viscous: 6, {limit}}}, disc: {{inertia: 3}}",
            body,
        ).range[1]
        for limit in ("max_torque_range: 1e4", "max_torque: 1e3")
    ]
    assert ranges[0] == pytest.approx(ranges[1], rel=2e-3)
