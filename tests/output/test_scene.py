"""The head of the results: the scene, its stations and its spans."""

import math
from typing import Any

import pytest

import torsion
from torsion.output.stored.results_json import results

TEXT = """
name: geared
description: two speeds
operation:
  at: tail
  speeds: {from: 10 rad/s, to: 30 rad/s, steps: 3}
  rated: {speed: 25 rad/s, power: 1.5 kW}
train:
- disc: {name: wall, held: true}
- coupling: {name: soft, stiffness: 250, loss_factor: 0.04, rated_torque: 9}
- gear: {name: mesh, teeth: [40, 20], inertia: [4, 0.5]}
- coupling: {name: stiff, stiffness: 400, viscous: 3}
- disc: {name: tail, inertia: 2, stiffness: 80}
- damper: {name: ring, housing: 1, ring: 5, damping: 7}
rules: [coupling-maker]
"""


@pytest.fixture(scope="module")
def found() -> dict[str, Any]:
    return results(torsion.run(torsion.parse(TEXT, "geared.yaml"), only=("modes",)))


def test_the_scene_states_what_was_read_and_how_it_runs(found) -> None:
    scene = found["scene"]
    assert [
        scene[key] for key in ("name", "description", "file", "model", "reference", "rules")
    ] == [
        "geared",
        "two speeds",
        "geared.yaml",
        "lumped",
        "tail",
        ["coupling-maker"],
    ]
    assert scene["speed_range_rad_per_s"] == [10.0, 30.0]
    assert (scene["rated_speed_rad_per_s"], scene["rated_power_W"]) == (25.0, 1500.0)


def test_without_operation_the_reference_is_the_first_component_and_speeds_are_null() -> None:
    text = "name: x\ntrain: [disc: {name: a, inertia: 2}, coupling: {stiffness: 120}, disc: {inertia: 3}]\n"
    scene = results(torsion.run(torsion.parse(text)))["scene"]
    assert scene["reference"] == "a"
    assert [scene[f"{key}_rad_per_s"] for key in ("speed_range", "rated_speed")] == [None, None]
    assert scene["rated_power_W"] is None


def test_stations_with_their_speed_sense_and_inertia(found) -> None:
    """The tail turns twice as fast as the wall and is the reference; gears turn the sense."""
    rows = {row["name"]: row for row in found["stations"]}
    assert {name: row["inertia_kg_m2"] for name, row in rows.items()} == {
        "wall": None,
        "soft end": 4.0,
        "mesh end": 0.5,
        "tail": 2.0,
        "tail ground": None,
        "ring": 1.0,
        "ring ring": 5.0,
    }
    assert [rows[name]["speed_ratio"] for name in ("wall", "soft end", "mesh end", "tail")] == [
        "1/2",
        "1/2",
        "1",
        "1",
    ]
    assert rows["wall"]["sense"] == -rows["tail"]["sense"]
    assert [name for name, row in rows.items() if row["is_held"]] == ["wall", "tail ground"]
    assert [name for name, row in rows.items() if row["is_ground"]] == ["tail ground"]
    assert (rows["mesh end"]["component"], rows["mesh end"]["kind"]) == ("mesh", "gear")
    assert (rows["tail"]["component"], rows["tail"]["kind"]) == ("tail", "disc")


def test_spans_with_their_ends_stiffness_and_damping(found) -> None:
    names, rows = (
        [row["name"] for row in found["stations"]],
        {row["name"]: row for row in found["spans"]},
    )
    ends = {
        name: (names[row["driving_station"]], names[row["driven_station"]])
        for name, row in rows.items()
    }
    assert ends == {
        "soft": ("wall", "soft end"),
        "stiff": ("mesh end", "tail"),
        "tail to ground": ("tail", "tail ground"),
        "ring rigid": ("tail", "ring"),
        "ring ring": ("ring", "ring ring"),
        "mesh": ("soft end", "mesh end"),
    }
    stiffness = {name: row["stiffness_Nm_per_rad"] for name, row in rows.items()}
    assert stiffness == {
        "soft": pytest.approx(250.0),
        "stiff": pytest.approx(400.0),
        "tail to ground": pytest.approx(80.0),
        "ring rigid": None,
        "ring ring": 0.0,
        "mesh": None,
    }
    for name, row in rows.items():
        wanted = {"ring ring": None}.get(
            name, 0.0 if stiffness[name] is None else 1.0 / (stiffness[name] or math.inf)
        )
        assert row["flexibility_rad_per_Nm"] == (None if wanted is None else pytest.approx(wanted))
    assert {name: row["loss_factor"] for name, row in rows.items() if row["loss_factor"]} == {
        "soft": 0.04
    }
    assert {
        name: row["viscous_Nms_per_rad"] for name, row in rows.items() if row["viscous_Nms_per_rad"]
    } == {
        "stiff": 3.0,
        "ring ring": 7.0,
    }
    assert [rows[name]["ratio"] for name in ("soft", "mesh")] == ["1", "2"]
    assert (rows["mesh"]["component"], rows["mesh"]["kind"]) == ("mesh", "gear")
    assert (rows["ring rigid"]["component"], rows["ring rigid"]["kind"]) == ("ring", "damper")
