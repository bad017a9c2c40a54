"""Events that contradict each other are refused, and what a file leaves unsaid is said."""

import re
from dataclasses import replace

import numpy as np
import pytest
from tests.analyses.motion.test_given_cases import chain, moved

import torsion
from torsion.errors import InputError
from torsion.output.blocks import Paragraph
from torsion.output.chapters.motion_over_time import chapter
from torsion.rules.verdict_line import Checks

HEAD = (
    "motor: {name: m, held: true}, coupling: {name: c, stiffness: 200}, disc: {name: d, inertia: 2}"
)
START = {"torque": [["0 rpm", 20], ["9000 rpm", 20]]}


def test_a_second_program_of_speed_at_one_point_is_refused_at_its_place() -> None:
    text = f"""name: x
train: [{HEAD}]
analyses:
  transient:
    duration: 2 s
    initial: rest
    events:
    - {{at: m, speed: {{program: [[0 s, 0 rpm], [1 s, 100 rpm]]}}}}
    - {{at: m, time: 0.5 s, speed: {{program: [[0 s, 0 rpm], [1 s, 30 rpm]]}}}}
"""
    with pytest.raises(InputError, match="the speed of 'm' is prescribed twice") as refused:
        torsion.parse(text)
    assert refused.value.faults[0].line == 9


def test_a_start_while_another_is_on_is_refused_and_one_after_it_is_not() -> None:
    again = {"at": "m", "time": 0.5, "start": START}
    body = {"duration": 1.0, "initial": "rest"}
    text = """name: x
train: [motor: {name: m, inertia: 2}]
analyses:
  transient:
    duration: 2 s
    initial: rest
    events:
    - {at: m, start: {torque: [[0 rpm, 20], [9000 rpm, 20]]}}
    - {at: m, time: 0.5 s, start: {torque: [[0 rpm, 20], [9000 rpm, 20]]}}
"""
    with pytest.raises(InputError, match=r"'m' is switched on at 0 s already.*`off`") as refused:
        torsion.parse(text)
    assert refused.value.faults[0].line == 9
    first = {"at": "m", "start": {**START, "off": 0.5}}
    assert moved("motor: {name: m, inertia: 2}", {**body, "events": [first, again]}).speed[
        0, -1
    ] == pytest.approx(10.0)
    both = [{"at": "m", "start": START}, {"at": "m", "start": START}]  # two machines on one shaft
    assert moved("motor: {name: m, inertia: 2}", {**body, "events": both}).speed[
        0, -1
    ] == pytest.approx(20.0)


PAIR = "motor: {name: m, inertia: 1}, coupling: {stiffness: 2e4, viscous: 50}, propeller: {name: p, inertia: 3}"
RUNS = "operation: {rated: {speed: 1200 rpm, power: 20 kW}, load: constant}\n"


def test_a_brake_where_the_mean_torque_drives_does_not_end_that_in_silence() -> None:
    brake = {"at": "m", "time": 0.5, "load": {"law": "constant", "torque": 100}}
    with pytest.raises(InputError, match=r"the mean torque of 'm' drives.*stop"):
        moved(PAIR, {"duration": 1.0, "events": [brake]}, RUNS)
    stop = {"at": "m", "time": 0.5, "stop": {}}
    assert moved(PAIR, {"duration": 1.0, "events": [stop, brake]}, RUNS).steps > 0


def test_a_load_that_would_drive_is_refused() -> None:
    text = f"""name: x
train: [{HEAD.replace("held: true", "inertia: 1")}]
analyses:
  transient:
    duration: 2 s
    events:
    - {{at: d, load: {{law: [[0 rpm, 2], [100 rpm, -3]]}}}}
"""
    with pytest.raises(InputError, match="a load brakes") as refused:
        torsion.parse(text)
    assert refused.value.faults[0].line == 7


def test_the_samples_that_are_named_resolve_torques_too() -> None:
    events = [{"at": "d1", "sine": {"torque": 10.0, "frequency": "90 kHz", "phase": "90 deg"}}]
    parts, body = (
        chain([2.0, 3.0], [1e4]),
        {"duration": 50.0, "initial": "rest", "events": events, "samples": 100},
    )
    with pytest.raises(InputError) as refused:
        moved(parts, body)
    number = int(re.search(r"(\d+) resolve all", refused.value.faults[0].hint)[1])  # type: ignore[index]
    assert number >= 4 * 90e3 * 50.0


def test_where_the_default_gives_no_more_samples_fewer_segments_are_advised() -> None:
    shaft = "shaft: {length: 1 m, diameter: 50 mm, material: steel, segments: 4}"
    for link, number, is_said in (
        (shaft, 20_001, True),
        (shaft, 1001, False),
        ("coupling: {stiffness: 9}", 20_001, False),
    ):
        parts = f"disc: {{name: d, inertia: 1}}, {link}, disc: {{inertia: 1}}"
        events = [{"at": "d", "step": {"torque": 1.0}}]
        found = moved(parts, {"duration": 0.01, "initial": "rest", "events": events})
        doubtful = replace(found, unresolved=found.peak, time=np.linspace(0.0, 0.01, number))
        assert "give more `samples`" in doubtful.status
        assert ("fewer `segments`, `model: fem`" in doubtful.status) == is_said
        assert "`phase`" not in doubtful.status
        of_phases = replace(doubtful, phases_computed=28)
        assert "name the `phase` in several motions, give more `samples`" in of_phases.status


MOTIONS = """name: x
operation: {OPERATION}
train:
- motor: {name: m, inertia: 1}
- coupling: {name: rubber, stiffness: 1e4, viscous: 20, max_torque: 1 kN*m}
- propeller: {name: screw, inertia: 2}
analyses:
  transient:
"""
HIT = "  - {name: NAME, duration: 1 s, events: [{at: screw, pulse: {torque: -8 kN*m, length: 10 ms}}]}\n"
RATED = "rated: {speed: 600 rpm, power: 60 kW}"


def test_checks_of_several_motions_name_their_motion() -> None:
    text = MOTIONS.replace("OPERATION", RATED)
    found = torsion.run(
        torsion.parse(text + HIT.replace("NAME", "one") + HIT.replace("NAME", "two"))
    )
    assert [check.clause for check in found.need(Checks).lines] == ["T_Kmax, one", "T_Kmax, two"]
    found = torsion.run(torsion.parse(text + HIT.replace("NAME", "one")))
    assert [check.clause for check in found.need(Checks).lines] == ["T_Kmax"]


def test_a_motion_that_begins_at_the_highest_speed_says_so() -> None:
    text = MOTIONS.replace("OPERATION", "speeds: {from: 300 rpm, to: 900 rpm}")
    text = text.replace("inertia: 1}", "inertia: 1, ripple: [{order: 3, torque: 9}]}")
    found = torsion.run(torsion.parse(text + HIT))
    texts = [one.text for one in chapter(found) if isinstance(one, Paragraph) and one.brief]
    assert any("900.00 rpm" in one and "highest" in one for one in texts)
    step = next(step for step in found.plan.done if step.what.startswith("motion over time"))
    assert "begins steady at 900 rpm" in step.size
    assert np.isfinite(step.seconds)
