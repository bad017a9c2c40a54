"""The end of a table of a load is exact, whatever the samples."""

import math

import pytest
from tests.analyses.motion.test_given_cases import moved
from tests.analyses.motion.train.test_starts import alone
from tests.for_all import for_all

from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.errors import SolveError

PLAY = "motor: {name: d, inertia: 1}, coupling: {stiffness: 1e3, clearance: {angle: 5 deg}}, disc: {inertia: 1}"
ENDS_AT_10_RPM = {"law": [["0 rpm", 0.0], ["10 rpm", 0.0]]}


def pulsed(parts: str, sense: float, load: dict, samples: int) -> TransientMotion:
    """From rest up to 2 rad/s within 10 ms, and back."""
    pulse = [(0.50001, sense), (0.51001, -sense)]
    steps = [
        {"at": "d", "time": t, "step": {"torque": 200.0 * one, "length": 0.01}} for t, one in pulse
    ]
    body = {
        "duration": 2.0,
        "initial": "rest",
        "samples": samples,
        "events": [*steps, {"at": "d", **load}],
    }
    return moved(parts, body)


@for_all("samples", [100, 10_000])
@for_all("sense", [1.0, -1.0])
@for_all("parts", ["disc: {name: d, inertia: 1}", PLAY])
def test_a_table_that_is_outrun_between_samples_is_refused_alike(
    parts: str, sense: float, samples: int
) -> None:
    when = 0.50001 + math.pi / 3.0 / 200.0
    with pytest.raises(
        SolveError, match=f"at {when:.6g} s the load at 'd' is outrun: its table ends at 10 rpm"
    ) as one:
        pulsed(parts, sense, {"load": ENDS_AT_10_RPM}, samples)
    assert one.value.path[-3:] == ("events", 2, "load")


def test_a_table_is_not_outrun_while_its_load_does_not_act_nor_at_its_very_end() -> None:
    alone_there = "disc: {name: d, inertia: 1}"
    assert pulsed(alone_there, 1.0, {"time": 0.6, "load": ENDS_AT_10_RPM}, 1000).steps
    assert pulsed(alone_there, 1.0, {"load": {**ENDS_AT_10_RPM, "off": 0.4}}, 1000).steps
    with pytest.raises(SolveError, match=r"at 0\.51 s the load at 'd' is outrun"):
        pulsed(alone_there, 1.0, {"time": 0.51, "load": ENDS_AT_10_RPM}, 1000)
    assert alone(1.0, [{"load": ENDS_AT_10_RPM}], 1.0, {"speed": "10 rpm"}).steps
