"""The best ring of a damper on a train: the inertia of the mode at its housing, speeds of gears, what the ring does."""

import math
from typing import Any

import numpy as np
import pytest
import yaml

from torsion.runner import solved

RING, HOUSING, WHEEL, STIFFNESS = 0.4, 1.0, 50.0, 1e5


def found(tmp_path: Any, **changes: Any) -> Any:
    """Findings of a scene of a wheel, a coupling and a damper, with changes of its top-level keys."""
    scene = {
        "name": "two discs",
        "train": [
            {"disc": {"name": "wheel", "inertia": WHEEL}},
            {"coupling": {"stiffness": STIFFNESS}},
            {"damper": {"housing": HOUSING, "ring": RING, "damping": 30}},
        ],
    }
    file = tmp_path / "scene.yaml"
    file.write_text(yaml.safe_dump({**scene, **changes}))
    return solved(file)


def test_mode_has_the_inertia_of_two_discs_at_the_housing(tmp_path: Any) -> None:
    (one,) = found(tmp_path).results["dampers"].each
    inertia = HOUSING * (1.0 + HOUSING / WHEEL)
    omega = math.sqrt(STIFFNESS * (1.0 / HOUSING + 1.0 / WHEEL))
    assert one.inertia == pytest.approx(inertia, rel=1e-14)
    assert one.frequency == pytest.approx(omega / (2 * math.pi), rel=1e-14)
    assert one.ratio == pytest.approx(RING / inertia, rel=1e-14)
    ratio = RING / inertia
    assert one.viscous == pytest.approx(
        2 * RING * omega / math.sqrt(2 * (1 + ratio) * (2 + ratio)), rel=1e-13
    )
    assert one.viscous_peak == pytest.approx((2 + ratio) / ratio, rel=1e-14)


def test_figures_are_at_the_speed_of_a_damper_behind_a_gear(tmp_path: Any) -> None:
    half = [
        {"disc": {"name": "wheel", "inertia": WHEEL}},
        {"coupling": {"stiffness": STIFFNESS}},
        {"gear": {"teeth": [20, 40], "inertia": [0, 0]}},
        {"damper": {"housing": 4 * HOUSING, "ring": 4 * RING, "damping": 120}},
    ]
    (plain,), (geared,) = (
        one.results["dampers"].each for one in (found(tmp_path), found(tmp_path, train=half))
    )
    assert geared.frequency == pytest.approx(plain.frequency, rel=1e-14)
    for name in ("inertia", "viscous", "stiffness", "damping"):
        assert getattr(geared, name) == pytest.approx(4 * getattr(plain, name), rel=1e-13)
    for name in ("ratio", "viscous_peak", "tuned_peak", "given_peak"):
        assert getattr(geared, name) == pytest.approx(getattr(plain, name), rel=1e-13)


@pytest.mark.parametrize(
    "ring",
    [
        {"damping": 43.0},
        {"damping": 25.0, "stiffness": 2e4},
        {"stiffness": 2e4, "loss_factor": 0.3},
        {"stiffness": 2e4, "magnifier": 5, "damping": 10},
    ],
)
def test_the_peak_as_given_is_that_of_the_response_over_a_fixed_end(
    tmp_path: Any, ring: dict[str, Any]
) -> None:
    """With the other end fixed there is one mode, and the closed form is exact."""
    train = [
        {"disc": {"held": True}},
        {"coupling": {"stiffness": STIFFNESS}},
        {"damper": {"name": "damper", "housing": HOUSING, "ring": RING, **ring}},
    ]
    excited = {
        "operation": {"speeds": {"from": "600 rpm", "to": "6000 rpm", "steps": 4001}},
        "excitations": [{"at": "damper", "order": 1, "torque": 1.0}],
    }
    findings = found(tmp_path, train=train, **excited | {"analyses": {"modes": {}, "response": {}}})
    (one,) = findings.results["dampers"].each
    angle = np.abs(findings.results["response"].angle)[:, 0]
    housing = [station.name for station in findings.system.stations].index("damper")
    assert float(angle[:, housing].max()) * STIFFNESS == pytest.approx(one.given_peak, rel=1e-5)


def test_a_damper_beside_another_point_is_joined_to_it_rigidly(tmp_path: Any) -> None:
    beside = [
        {"disc": {"name": "wheel", "inertia": WHEEL}},
        {"coupling": {"stiffness": STIFFNESS}},
        {"disc": {"name": "nose", "inertia": HOUSING / 2}},
        {"damper": {"housing": HOUSING / 2, "ring": RING, "damping": 30}},
    ]
    (plain,), (joined,) = (
        one.results["dampers"].each for one in (found(tmp_path), found(tmp_path, train=beside))
    )
    assert joined.inertia == pytest.approx(plain.inertia, rel=1e-13)
    assert joined.given_peak == pytest.approx(plain.given_peak, rel=1e-13)


def test_a_ring_that_is_too_small_for_a_mode_is_left_out(tmp_path: Any) -> None:
    train = [
        {"disc": {"inertia": WHEEL}},
        {"coupling": {"stiffness": STIFFNESS}},
        {"damper": {"housing": HOUSING, "ring": 1e-4, "damping": 0.1}},
    ]
    assert found(tmp_path, train=train).results["dampers"].each == ()


@pytest.mark.parametrize(
    ("ring", "words"),
    [
        ({}, "`damping` is missing"),
        ({"loss_factor": 0.1}, "`loss_factor` needs `stiffness`"),
        ({"stiffness": 1e4, "psi": 1, "magnifier": 5}, "psi and magnifier exclude each other"),
    ],
)
def test_a_ring_without_damping_is_refused(tmp_path: Any, ring: dict[str, Any], words: str) -> None:
    from torsion.errors import InputError

    train = [{"damper": {"housing": 1, "ring": 1, **ring}}]
    with pytest.raises(InputError, match=words):
        found(tmp_path, train=train)


def test_heat_of_a_ring_is_half_its_damping_times_the_square_of_its_speed(tmp_path: Any) -> None:
    train = [
        {"disc": {"name": "wheel", "inertia": WHEEL}},
        {"coupling": {"stiffness": STIFFNESS}},
        {
            "damper": {
                "name": "damper",
                "housing": HOUSING,
                "ring": RING,
                "damping": 30,
                "heat_limit": 1e-3,
            }
        },
    ]
    findings = found(
        tmp_path,
        train=train,
        rules=["coupling-maker"],
        operation={"speeds": {"from": "1000 rpm", "to": "4000 rpm", "steps": 301}},
        excitations=[{"at": "wheel", "order": 1, "torque": 100.0}],
    )
    (check,) = findings.results["checks"].lines
    omega = check.speed
    matrix = np.array(
        [
            [STIFFNESS - omega**2 * WHEEL, -STIFFNESS, 0],
            [-STIFFNESS, STIFFNESS + 30j * omega - omega**2 * HOUSING, -30j * omega],
            [0, -30j * omega, 30j * omega - omega**2 * RING],
        ]
    )
    angle = np.linalg.solve(matrix, np.array([100.0, 0, 0]))
    assert check.value == pytest.approx(
        0.5 * 30 * omega**2 * abs(angle[1] - angle[2]) ** 2, rel=1e-9
    )
    assert check.verdict == "fail"
