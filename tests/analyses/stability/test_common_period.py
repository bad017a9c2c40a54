"""Common periods behind gears: what the joints alone need, against equations written out, and which teeth would do."""

import re
from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import fsolve

import torsion
from torsion.analyses.stability.common_period import period_too_long
from torsion.analyses.stability.mechanism_loads import scene
from torsion.analyses.stability.periodic_orbits import harmonics_at_least
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.assembly import assemble
from torsion.errors import SolveError
from torsion.study import Study

RATIO = 37 / 211  # speed of the joint's shaft / speed of the motor
MOTOR, SCREW = 0.02, 1.0  # kg m2
STIFFNESS, VISCOUS, DAMPING = 1e4, 2.0, 0.4  # of the coupling; of the screw to its mean motion
TORQUE, ANGLE = 40.0, 20.0  # N m at the motor, deg
SCENE = """
name: joint behind a gear
operation:
  speeds: {{from: {first} rad/s, to: {last} rad/s, steps: {steps}}}
  load: [[1 rad/s, {torque}], [2000 rad/s, {torque}]]
train:
  - motor: {{inertia: {motor}}}
  - gear: {{teeth: [37, 211]}}
  - joint: {{angle: {angle} deg}}
  - coupling: {{stiffness: {stiffness}, viscous: {viscous}}}
  - disc: {{name: screw, inertia: {screw}, damping: {damping}}}
excitations: [{{at: motor-1, order: 1, torque: 3}}, {{at: screw, order: 3, torque: 10}}]
analyses: {{stability: {{method: {method}}}}}
"""


def read(first: float, last: float, steps: int = 2, method: str = "monodromy") -> Study:
    return torsion.parse(
        SCENE.format(
            first=first,
            last=last,
            steps=steps,
            method=method,
            torque=TORQUE,
            motor=MOTOR,
            angle=ANGLE,
            screw=SCREW,
            stiffness=STIFFNESS,
            viscous=VISCOUS,
            damping=DAMPING,
        )
    )


def rates(y: np.ndarray, mean: float, drive: float) -> np.ndarray:
    """d/dt of (a, b, a', b'): angles of the gear's wheel with all in front of it, and of the screw, at their own speed.

    Driven angle of the joint: tan f = tan a / cos(angle), all of it written out.
    """
    a, b, rate_a, rate_b = y
    c, s = np.cos(np.radians(ANGLE)), np.sin(np.radians(ANGLE))
    slope = c / (1.0 - s**2 * np.cos(a) ** 2)
    joint = a + np.arctan2((1.0 - c) * np.sin(a) * np.cos(a), c * np.cos(a) ** 2 + np.sin(a) ** 2)
    spring = STIFFNESS * (joint - b) + VISCOUS * (slope * rate_a - rate_b)
    load = TORQUE / RATIO
    gain_a = (drive - slope * spring) / (MOTOR / RATIO**2)
    return np.array([rate_a, rate_b, gain_a, (spring - load - DAMPING * (rate_b - mean)) / SCREW])


def floquet(speed: float) -> np.ndarray:
    """Growth rates (1/s) at a speed of the motor, without the free turning, by shooting over half a revolution.

    Unknown: the rates at the wheel's angle 0, the screw's angle, and the drive's torque that keeps the mean speed.
    """
    mean = speed * RATIO
    period = np.pi / mean

    def after(start: np.ndarray, drive: float) -> np.ndarray:
        solved = solve_ivp(
            lambda t, y: rates(y, mean, drive),
            (0.0, period),
            start,
            method="DOP853",
            rtol=1e-12,
            atol=1e-13,
        )
        return solved.y[:, -1]

    def missed(unknown: np.ndarray) -> np.ndarray:
        start = np.array([0.0, *unknown[:3]])
        return (after(start, unknown[3]) - start - [np.pi, np.pi, 0.0, 0.0]) / [
            1.0,
            1.0,
            mean,
            mean,
        ]

    load = TORQUE / RATIO
    found, _, _, words = fsolve(
        missed, [-load / STIFFNESS, mean, mean, load], xtol=1e-12, full_output=True
    )
    assert np.abs(missed(found)).max() < 1e-9, words
    start, step = np.array([0.0, *found[:3]]), np.array([1e-5, 1e-5, 1e-5 * mean, 1e-5 * mean])
    columns = [
        (after(start + one, found[3]) - after(start - one, found[3])) / (2.0 * one.max())
        for one in np.diag(step)
    ]
    multiplier = np.linalg.eigvals(np.array(columns).T)
    free = int(np.argmin(np.abs(multiplier - 1.0)))
    assert abs(multiplier[free] - 1.0) < 1e-5
    return np.sort(np.log(np.abs(np.delete(multiplier, free))) / period)[::-1]


@pytest.mark.parametrize("method", ["monodromy", "hill"])
def test_joint_behind_a_gear_of_37_and_211_teeth_has_the_growth_of_its_equations_written_out(
    method,
):
    mode = (
        np.sqrt(STIFFNESS * (RATIO**2 / MOTOR + 1.0 / SCREW)) / RATIO
    )  # principal zone: order 2 at twice the mode
    found = torsion.run(read(0.97 * mode, mode, 2, method)).need(Stability)
    for speed in (0.97 * mode, mode):
        at = int(np.argmin(np.abs(found.speed - speed)))
        assert found.drift is not None
        assert max(found.growth[at], found.drift[at]) == pytest.approx(floquet(speed)[0], rel=1e-5)
    assert found.growth[0] < 0 < found.growth[-1]


def test_stability_takes_the_period_of_the_joints_alone():
    study = read(300.0, 600.0)
    system = assemble(study.train)
    at = scene(study, system, vibratory=False)
    assert 1 / at.order == Fraction(
        211, 74
    )  # revolutions of the motor: half of one of the joint's shaft
    assert harmonics_at_least(at) < 20
    assert 1 / scene(study, system).order == 211


TWO_GEARS = """
name: three shafts
train:
  - motor: {{inertia: 1}}
  - joint: {{angle: 6 deg}}
  - coupling: {{stiffness: 1e4}}
  - gear: {{name: near, teeth: [{0}, {1}]}}
  - coupling: {{stiffness: 1e4}}
  - gear: {{name: far, teeth: [{2}, {3}]}}
  - joint: {{angle: 12 deg}}
  - coupling: {{stiffness: 1e4}}
  - disc: {{inertia: 1}}
"""


def test_orders_of_one_shaft_that_rarely_repeat_are_named_without_a_gear():
    train = torsion.parse(
        "name: a\noperation: {speeds: {from: 1 rad/s, to: 2 rad/s}}\n"
        "train: [motor: {inertia: 1}, joint: {angle: 5 deg}, coupling: {stiffness: 1e4}, disc: {name: b, inertia: 1}]\n"
        "excitations: [{at: b, order: 1/977, torque: 1}]\n"
    ).train
    error = period_too_long(train, 5, 400, vibratory=True)
    assert re.search(
        r"joint-1 \(order 2 of its shaft\) and b .*1/977.* only every 977 revolutions",
        error.message,
    )
    assert error.path == ()


def test_gear_with_joints_on_both_sides_is_named_with_its_line():
    text = TWO_GEARS.format(1, 2, 97, 101) + "operation: {speeds: {from: 10 rad/s, to: 20 rad/s}}\n"
    study = torsion.parse(text)
    with pytest.raises(
        SolveError, match=r"'far' .teeth 97/101. and repeat together only every 101 rev"
    ) as caught:
        harmonics_at_least(scene(study, assemble(study.train)))
    assert study.train.parts[5].name == "far"
    assert caught.value.path == study.train.parts[5].path
