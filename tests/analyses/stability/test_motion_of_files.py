"""Exact motion from the file to the findings: published numbers, when it is computed, what it imports."""

import re
import subprocess
import sys
from fractions import Fraction

import numpy as np
import pytest
from tests.contracts.frozen import solved as solved_scene
from tests.for_all import for_all

import torsion
from torsion.analyses.joints.joint_lines import Joints
from torsion.analyses.stability.periodic_orbits import PeriodicResponse
from torsion.analyses.stability.stability_over_speed import Stability, StabilityMap
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

TRAIN = """
name: six stations
operation:
  speeds: {{from: {first} rad/s, to: {last} rad/s, steps: {steps}}}
  load: constant
  rated: {{speed: 100 rad/s, power: 30 kW}}
train:
  - motor: {{inertia: 2.0, damping: 0.5}}
  - coupling: {{stiffness: 2e4, viscous: 0.4}}
  - joint: {{angle: {angle} deg, inertia: [0.02, 0.02]}}
  - coupling: {{stiffness: 1.5e4, viscous: 0.3}}
  - joint: {{angle: {angle} deg, phase: {phase} deg, inertia: [0.02, 0.02]}}
  - coupling: {{stiffness: 3e4, viscous: 0.6}}
  - disc: {{name: screw, inertia: 0.8, damping: {damping}}}
analyses: {{{analyses}}}
"""
FIRST_MODE = 107.103746  # rad/s


def solved(
    analyses: str,
    *,
    angle: float = 20,
    phase: float = 0,
    damping: float = 8,
    first: float = 50,
    last: float = 80,
    steps: int = 2,
) -> Findings:
    text = TRAIN.format(
        analyses=analyses,
        angle=angle,
        phase=phase,
        damping=damping,
        first=first,
        last=last,
        steps=steps,
    )
    return torsion.run(torsion.parse(text, "six.yaml"))


PUBLISHED = [
    (
        10,
        0,
        50,
        (28.1573702516, 30.5347522996, 25.0471257435),
        (0.3043810289, 0.05876792978, 0.2249929484),
        300.008109078,
    ),
    (
        20,
        0,
        50,
        (115.908011946, 125.563788691, 103.109324886),
        (5.083490124, 0.9798571905, 3.757834528),
        300.1374715618,
    ),
    (
        20,
        0,
        80,
        (32.6899100665, 14.5556194383, 38.3684059712),
        (1.418590806, 0.4609776401, 2.339605435),
        300.004889001,
    ),
    (
        30,
        90,
        80,
        (1747.96965329, 1722.59208262, 1646.20523637),
        (70.15310037, 69.40240531, 196.4070239),
        309.795942077,
    ),
]  # joint angle, phase, speed, torques of order 2 and 4, mean torque of the motor


@pytest.mark.parametrize(("angle", "phase", "speed", "second", "fourth", "motor"), PUBLISHED)
def test_six_station_train_of_a_file_has_the_published_torques(
    angle, phase, speed, second, fourth, motor
):
    found = solved(
        "response: {method: harmonic-balance}",
        angle=angle,
        phase=phase,
        first=speed,
        last=speed + 2,
    )
    exact, elastic = found.need(PeriodicResponse), found.system.flexibility > 0
    at = int(np.argmin(np.abs(exact.speed - speed)))
    assert exact.speed[at] == speed
    for order, published in ((2, second), (4, fourth)):
        torque = np.abs(exact.torque[at, exact.orders.index(Fraction(order))][elastic])
        assert torque == pytest.approx(published, rel=1e-8)
    assert exact.drive[at] == pytest.approx(motor, rel=1e-10)


@pytest.mark.parametrize(
    ("analyses", "angle", "phase", "is_exact", "words"),
    [
        ("response: ", 20, 0, True, "beyond 10 degrees"),
        ("response: {method: first-order}", 20, 0, False, "first-order"),
        ("response: ", 5, 0, False, "10 degrees"),
        ("response: ", 10, 90, True, "beyond 1 %"),
        ("response: {method: harmonic-balance}", 5, 0, True, "requested"),
        ("modes: ", 20, 0, False, ""),
    ],
)
def test_exact_response_is_the_default_where_the_first_order_does_not_hold(
    analyses, angle, phase, is_exact, words
):
    found = solved(analyses, angle=angle, phase=phase, first=40, last=FIRST_MODE / 2)
    assert (found.get(PeriodicResponse) is not None) == is_exact
    said = [line.why for line in found.plan.done if line.what == "exact periodic response"]
    said += [why for what, why in found.plan.left_out if what == "exact periodic response"]
    assert [words in one for one in said] == ([True] if words else [])


def test_peak_of_the_exact_response_is_resolved():
    found = solved("response: ", phase=90, first=45, last=62, steps=9)
    size = np.abs(
        found.need(PeriodicResponse).torque[:, found.need(PeriodicResponse).orders.index(2), 0]
    )
    top = int(np.argmax(size))
    assert 0 < top < len(size) - 1
    assert min(size[top - 1], size[top + 1]) > 0.97 * size[top]
    assert set(np.linspace(45.0, 62.0, 9)) <= set(found.need(PeriodicResponse).speed)


@pytest.mark.parametrize(
    ("angle", "damping", "growth"),
    [(10, 1.5, None), (20, 1.5, 0.67), (30, 1.5, 2.57), (20, 8, None)],
)
def test_train_is_unstable_at_its_first_mode_as_published(angle, damping, growth):
    found = solved("stability: ", angle=angle, damping=damping, first=104, last=110, steps=3)
    (check,) = (line for line in found.need(Checks).lines if line.clause == "stability")
    assert found.failed == (growth is not None)
    if growth is None:
        assert found.need(Stability).ranges == ()
        assert check.value < 0
        return
    (only,) = found.need(Stability).ranges
    assert only.first < FIRST_MODE < only.last
    assert only.name == "principal of mode 1 (2 w1)"
    near = int(np.argmin(np.abs(found.need(Stability).speed - FIRST_MODE)))
    assert found.need(Stability).growth[near] == pytest.approx(growth, abs=0.02)
    assert check.value == only.growth >= found.need(Stability).growth[near]


def test_unstable_periodic_motion_is_told_without_asking_for_stability():
    found = solved("response: ", damping=1.5, first=100, last=112, steps=13)
    unstable = found.need(PeriodicResponse).speed[found.need(PeriodicResponse).is_unstable]
    assert found.get(Stability) is None
    assert unstable.size
    assert np.all(np.abs(unstable / FIRST_MODE - 1.0) < 0.02)


def test_scene_of_six_stations_fails_by_its_stability():
    found = solved_scene("six_stations")
    assert found.failed
    angles = np.degrees(found.need(StabilityMap).value)
    unstable = (found.need(StabilityMap).growth > 0).any(axis=0)
    assert not unstable[angles < 11].any()
    assert unstable[angles > 19].all()


LIGHT = """
import sys, torsion
from torsion.output.stored.results_json import text
from torsion.output.document import document
from torsion.output.pages.terminal import screen
found = torsion.run(torsion.parse({scene!r}))
text(found), screen(document(found))
print([name for name in sys.modules if "analyses.motion" in name or ".periodic" in name])
"""


def test_scene_without_joints_imports_nothing_of_the_exact_motion():
    scene = (
        "name: a\noperation: {speeds: {from: 5 rad/s, to: 15 rad/s, steps: 5}}\n"
        "train: [disc: {inertia: 2}, coupling: {stiffness: 120, viscous: 1}, disc: {name: b, inertia: 3}]\n"
        "excitations: [{at: b, order: 1, torque: 1}]\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", LIGHT.format(scene=scene)],
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "[]"


def test_closed_loops_and_other_models_of_shafts_are_refused_where_exact_motion_is_asked():
    text = TRAIN.format(
        analyses="stability: ", angle=5, phase=0, damping=1, first=50, last=80, steps=2
    )
    for bad, words in (
        (
            text.replace("analyses: {", "analyses: {model: fem, ").replace(
                "coupling: {stiffness: 3e4, viscous: 0.6}", "shaft: {length: 1, diameter: 0.05}"
            ),
            "lumped",
        ),
        (
            text + "links: [{between: [motor-1, screw], coupling: {stiffness: 1e4}}]\n",
            "closed loops",
        ),
        (text.replace("  speeds: {from: 50 rad/s, to: 80 rad/s, steps: 2}\n", ""), "needs speeds"),
    ):
        with pytest.raises(torsion.InputError, match=words):
            torsion.parse(bad, "six.yaml")
    with pytest.raises(torsion.InputError, match="no joint"):
        torsion.parse(
            "name: a\noperation: {speeds: {from: 5 rad/s, to: 9 rad/s}}\ntrain: [disc: {inertia: 2}]\n"
            "analyses: {stability: }\n"
        )


NOTHING_TO_VARY = [
    (
        "torque",
        ("  load: constant\n  rated: {speed: 100 rad/s, power: 30 kW}\n", ""),
        "mean torque, and the train has none",
    ),
    (
        "torque",
        ("load: constant", "load: [[1 rad/s, 0], [900 rad/s, 0]]"),
        "mean torque, and the train has none",
    ),
    ("damping", (r", (viscous|damping): [\d.]+", ""), "nothing in the train damps"),
    (
        "angle",
        ("joint: {angle: 20 deg", "joint: {kind: cv, angle: 20 deg"),
        "none of the train is bent",
    ),
    ("angle", ("angle: 20 deg", "angle: 0 deg"), "none of the train is bent"),
]


@for_all(("over", "change", "words"), NOTHING_TO_VARY)
def test_map_over_what_the_train_does_not_have_is_refused_where_it_is_asked(over, change, words):
    ends = "from: 1 deg, to: 2 deg" if over == "angle" else "from: 0, to: 2"
    requested = f"stability: {{map: {{over: {over}, {ends}}}}}"
    text = TRAIN.format(
        analyses=requested, angle=20, phase=0, damping=8, first=50, last=80, steps=2
    )
    torsion.parse(text, "six.yaml")
    without = re.sub(*change, text)
    assert without != text
    with pytest.raises(torsion.InputError, match=words) as caught:
        torsion.parse(without, "six.yaml")
    (fault,) = caught.value.faults
    assert without.splitlines()[fault.line - 1][fault.column - 1 :].startswith(over)


def test_long_train_is_reduced_to_the_modes_that_matter_and_keeps_its_growth():
    text = TRAIN.format(
        analyses="stability: ", angle=25, phase=0, damping=1.5, first=106, last=108, steps=2
    )
    shaft = "  - shaft: {length: 0.5, diameter: 60 mm, segments: SEGMENTS}\n"
    text = text.replace("  - disc: {name: screw", shaft + "  - disc: {name: screw")
    whole = text.replace("stability: ", "stability: {modes: 100}")
    texts = (
        whole.replace("SEGMENTS", "2"),
        text.replace("SEGMENTS", "2"),
        text.replace("SEGMENTS", "12"),
    )
    every, short, long = (torsion.run(torsion.parse(one, "long.yaml")) for one in texts)
    assert every.need(Stability).kept is None
    assert short.need(Stability).kept == long.need(Stability).kept == 1
    assert short.need(Stability).left_out < 1e-8
    assert long.need(Stability).left_out < 1e-3
    assert short.need(Checks).lines[0].value == pytest.approx(
        every.need(Checks).lines[0].value, rel=1e-8
    )
    assert long.need(Checks).lines[0].value == pytest.approx(
        every.need(Checks).lines[0].value, rel=1e-2
    )


GEARED = """
name: joints at two speeds
operation: {{speeds: {{from: 30 rad/s, to: 90 rad/s, steps: 4}}, rated: {{speed: 60 rad/s, power: 20 kW}}}}
train:
  - motor: {{inertia: 1, damping: 1}}
  - joint: {{angle: 5 deg}}
  - coupling: {{stiffness: 1e4, viscous: 5}}
  - gear: {{teeth: [{teeth}]}}
  - joint: {{angle: 15 deg}}
  - coupling: {{stiffness: 1e4, viscous: 5}}
  - disc: {{inertia: 1, damping: 2}}
analyses: {{{analyses}}}
"""


@pytest.mark.parametrize(
    ("teeth", "words"),
    [
        ("17, 23", "only every 11.5 revolutions of the reference shaft, which takes 138 harmonics"),
        ("97, 101", "only every 50.5 revolutions"),
    ],
)
def test_joints_that_repeat_together_only_after_many_turns_are_left_out_unasked(teeth, words):
    found = torsion.run(torsion.parse(GEARED.format(teeth=teeth, analyses="response: ")))
    assert found.get(PeriodicResponse) is None
    assert words in dict(found.plan.left_out)["exact periodic response"]


@pytest.mark.parametrize("requested", ["response: {method: harmonic-balance}", "stability: "])
def test_joints_that_never_repeat_within_reach_leave_out_what_needs_it_and_nothing_else(requested):
    text = GEARED.format(teeth="97, 101", analyses=f"modes: , {requested}")
    found, plain = (
        torsion.run(torsion.parse(text)),
        torsion.run(torsion.parse(text.replace(f", {requested}", ""))),
    )
    assert found.get(PeriodicResponse) is None
    assert found.get(Stability) is None
    assert found.need(Modes).frequency.tolist() == plain.need(Modes).frequency.tolist()
    assert found.need(Joints).angle.tolist() == plain.need(Joints).angle.tolist()
    (one,) = found.plan.unanswered
    assert one.is_named
    assert (
        "every 50.5 revolutions of the reference shaft, which takes about 606 harmonics" in one.why
    )
    assert "'gear-1' (teeth 97/101)" in one.why
    assert text.splitlines()[one.line - 1].strip().startswith("- gear")
    assert dict(found.plan.left_out)[one.what] == one.words
