"""A damper to ground at a point with a load: it stands for the slope of the load, where that has one."""

import numpy as np
import pytest
from scipy.linalg import expm
from tests.analyses.motion.test_given_cases import moved

from torsion.errors import InputError


def test_the_law_of_a_load_damps_in_place_of_the_damper_of_its_point() -> None:
    parts = "motor: {name: m, inertia: 1}, coupling: {stiffness: 1e3}, propeller: {name: p, inertia: 3, damping: 40}"
    start = {"at": "m", "start": {"torque": [["0 rpm", 8], ["9000 rpm", 8]]}}
    load = {"at": "p", "load": {"law": [["0 rad/s", 0.0], ["90 rad/s", 180.0]]}}  # 2 N m s/rad
    body = {"duration": 1.0, "initial": "rest", "events": [start, load], "tolerance": 1e-9}
    found = moved(parts, body)
    assert found.torque[0] == pytest.approx(_torque_of_two(found.time, 0.0, 2.0), abs=1e-7)
    assert found.undamped == ("p",)
    for flat in (
        {"law": "constant", "torque": 1e-9, "speed": "90 rad/s"},
        {"law": [["0 rpm", 0], ["900 rpm", 0]]},
    ):
        for when in ({}, {"time": 0.99}):
            kept = moved(parts, {**body, "events": [start, {"at": "p", **when, "load": flat}]})
            assert kept.torque[0] == pytest.approx(
                _torque_of_two(kept.time, 40.0, 0.0), abs=1e-6
            ), flat
            assert kept.undamped == ()


def _torque_of_two(time: np.ndarray, damper: float, brake: float) -> np.ndarray:
    """(times,) N m between inertias 1 and 3 behind 1e3 N m/rad, under a step of 8 N m on the first.

    At the second stand a damper of its deviation from the motion as one, and a brake by its whole speed.
    """
    matrix = np.zeros((4, 4))  # twist, both speeds, and 1
    matrix[0, 1:3] = 1.0, -1.0
    matrix[1, [0, 3]] = -1e3, 8.0
    matrix[2, 0] = 1e3 / 3.0
    matrix[2, 2] -= brake / 3.0
    push = damper * np.array(
        [-0.25, 0.25]
    )  # N m, by the speed of the second less that of the train as one
    matrix[2, 1:3] -= push / 3.0
    matrix[1:3, 1:3] += push / 4.0  # the train as one is not braked
    return np.array([1e3 * expm(matrix * t)[0, 3] for t in time.tolist()])


@pytest.mark.parametrize("when", [{"time": 0.1}, {"off": 0.9}])
@pytest.mark.parametrize("play", ["", ", clearance: {angle: 0.1 deg}"])
def test_a_damper_beside_a_load_that_acts_at_times_only_is_refused(when: dict, play: str) -> None:
    parts = f"motor: {{inertia: 1}}, coupling: {{stiffness: 1e3{play}}}, disc: {{name: d, inertia: 3, damping: 4}}"
    off = {one: when[one] for one in when if one == "off"}
    law = {"law": "propeller", "torque": 9, "speed": "90 rpm", **off}
    load = {"at": "d", "time": when.get("time", 0.0), "load": law}
    body = {
        "duration": 1.0,
        "initial": "rest",
        "events": [{"at": "d", "step": {"torque": 1.0}}, load],
    }
    with pytest.raises(
        InputError, match=r"the damping of 'd' stands for the slope of this load.*`off`"
    ) as refused:
        moved(parts, body)
    assert refused.value.faults[0].path[-3:] == ("events", 1, "load")
