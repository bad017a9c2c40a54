"""A load at constant power feeds vibration: what grows fails, against the eigenvalues of the matrices by hand."""

from collections.abc import Sequence

import numpy as np
import pytest

import torsion
from torsion.primitives import Damper
from torsion.rules.verdict_line import Checks

TRAIN = """
name: converter load
operation: {{speeds: {{from: 900 rpm, to: 1500 rpm}}, rated: {{speed: 1500 rpm}}}}
train:
- motor: {{name: m, inertia: 2}}
- coupling: {{name: c, stiffness: 10 kN*m/rad, viscous: {viscous}, rated_torque: 2000, vibratory_torque: 200}}
- generator: {{name: g, inertia: 1, power: 100 kW, load: {load}, damping: law}}
excitations: [{{at: m, order: 2, torque: 10}}]
rules: [coupling-maker]
"""
SPEEDS = np.linspace(900.0, 1500.0, 41) * np.pi / 30.0


def growth(viscous: float, slopes: Sequence[float] = tuple(-100e3 / SPEEDS**2)) -> float:
    """The largest real part (1/s) of the oscillating roots over slopes of the load; T = P/omega has -P/omega^2."""
    stiffness, parts = 1e4, []
    for slope in slopes:
        k = stiffness * np.array([[1, -1], [-1, 1]])
        c = viscous * np.array([[1, -1], [-1, 1]]) + np.diag([0.0, slope])
        j = np.diag([2.0, 1.0])
        inverse = np.diag(1.0 / np.diag(j))
        roots = np.linalg.eigvals(
            np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ k, -inverse @ c]])
        )
        parts.append(roots[np.abs(roots.imag) > 1.0].real.max())
    return max(parts)


def judged(**values) -> list:
    checks = torsion.run(torsion.parse(TRAIN.format(**values))).need(Checks)
    return [check for check in checks.lines if check.clause == "vibration"]


@pytest.mark.parametrize(("viscous", "verdict"), [(0.5, "fail"), (60.0, "pass")])
def test_vibration_that_a_load_feeds_fails_where_it_grows(viscous: float, verdict: str) -> None:
    (check,) = judged(viscous=viscous, load="constant-power")
    assert check.value == pytest.approx(growth(viscous), rel=1e-9)
    assert check.verdict == verdict
    assert "'" not in check.note
    assert "load law of g is negative" in check.note


@pytest.mark.parametrize("corners", [(695, 715), (300, 310), (1490, 1500)])
def test_a_slope_between_two_of_the_even_speeds_fails_where_it_grows(
    corners: tuple[int, int],
) -> None:
    """Speeds every 30 rpm miss what a table does within 20: its slope feeds the load as a damper of -100 N m/20 rpm."""
    first, last = corners
    table = f"[[200 rpm, 500], [{first} rpm, 600], [{last} rpm, 500], [1600 rpm, 650]]"
    text = TRAIN.replace("from: 900 rpm", "from: 300 rpm").replace(", power: 100 kW", "")
    scene = torsion.parse(text.format(viscous=0.5, load=table))
    (check,) = [row for row in torsion.run(scene).need(Checks).lines if row.clause == "vibration"]
    slope = -100.0 / ((last - first) * np.pi / 30.0)
    assert check.value == pytest.approx(growth(0.5, [slope]), rel=1e-9)
    assert check.verdict == "fail"


def test_a_load_that_rises_with_speed_needs_no_such_row() -> None:
    assert judged(viscous=0.5, load="quadratic") == []


@pytest.mark.parametrize("factor", ["constant", "torque_factor", "speed_factor"])
def test_a_damping_that_is_negative_itself_is_looked_at_too(factor: str) -> None:
    assert Damper(0, **{factor: -1e-3}).may_drive
    assert not Damper(0, **{factor: 1.0}).may_drive
    assert Damper(0, load_factor=0.5).may_drive
