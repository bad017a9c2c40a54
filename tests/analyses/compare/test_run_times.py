"""The study of run times: its errors obey the laws of the methods; of times it is said only that they are there."""

from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.compare import run_times as module
from torsion.analyses.compare.run_times import study_times
from torsion.analyses.compare.shaft_divisions import plain, reference
from torsion.analyses.compare.timing import Effort, TimedQuantity, Timings
from torsion.study import Study

SHORT = Effort(
    rounds=2, longest=5.0, segments=64, unknowns=24, degrees=(1, 2, 3), modes=32, dense=16, speeds=7
)
SHAFT = """
name: a shaft between two discs
operation: {speeds: {from: 600 rpm, to: 3000 rpm}}
train:
  - disc: {name: left, inertia: 0.02}
  - shaft: {length: 1.5 m, diameter: 60 mm, loss_factor: 0.01}
  - disc: {name: right, inertia: 0.03}
excitations: [{at: right, order: 6, torque: 100 N*m}, {at: left, order: 2, torque: 30 N*m}]
"""
JOINT = SHAFT.replace("  - disc: {name: right", "  - joint: {angle: 8 deg}\n  - disc: {name: right")
BRAKED = JOINT.replace("inertia: 0.03}", "inertia: 0.03, damping: 0.4}").replace(
    ", loss_factor: 0.01", ""
)
DISCS = """
name: three discs
operation: {speeds: {from: 600 rpm, to: 3000 rpm}}
train:
  - disc: {name: first, inertia: 0.02}
  - coupling: {stiffness: 20 kN*m/rad, loss_factor: 0.01}
  - disc: {name: second, inertia: 0.03}
  - coupling: {stiffness: 30 kN*m/rad, loss_factor: 0.01}
  - disc: {name: last, inertia: 0.05}
excitations: [{at: last, order: 6, torque: 100 N*m}]
"""
DAMPED = """
name: three discs, every damper in proportion to inertia or stiffness
operation: {speeds: {from: 600 rpm, to: 3000 rpm}}
train:
  - disc: {name: first, inertia: 0.02, damping: 0.06}
  - coupling: {stiffness: 20 kN*m/rad, viscous: 2}
  - disc: {name: second, inertia: 0.03, damping: 0.09}
  - coupling: {stiffness: 30 kN*m/rad, viscous: 3}
  - disc: {name: last, inertia: 0.05, damping: 0.15}
excitations:
  - {at: last, order: 6, torque: 100 N*m}
  - {at: last, order: 5, torque: 1e-6 N*m}
  - {at: first, order: 4, torque: 100 N*m}
  - {at: first, order: 2, torque: 100 N*m}
"""


@pytest.fixture(scope="module")
def timings() -> dict[str, Timings]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "QUICK", SHORT)
        patch.setattr(module, "FULL", SHORT)
        return {
            "shaft": study_times(parsed(SHAFT), highest=300.0, count=3),
            "joint": study_times(parsed(JOINT), highest=300.0),
            "braked": study_times(parsed(BRAKED), highest=300.0),
            "discs": study_times(parsed(DISCS), highest=300.0),
            "damped": study_times(parsed(DAMPED), highest=300.0),
        }


def parsed(text: str) -> Study:
    return torsion.parse(text, "scene.yaml")


def quantity(timings: Timings, key: str) -> TimedQuantity:
    return next(one for one in timings.quantities if one.key == key)


def errors(found: TimedQuantity, curve: str) -> dict[int, float]:
    """Worst error by size."""
    return {row.size: row.error for row in found.rows if row.curve == curve}


def rate(found: TimedQuantity, curve: str, coarse: int) -> float:
    """Power with which the error of a curve falls from one division to the next."""
    known = errors(found, curve)
    return float(np.log2(known[coarse] / known[2 * coarse]))


@pytest.mark.parametrize("key", ["frequencies", "response"])
def test_the_error_of_lumped_shafts_falls_with_the_square_of_their_segments(
    timings: dict, key: str
) -> None:
    curve = {"frequencies": "lumped", "response": "lumped, elimination"}[key]
    assert rate(quantity(timings["shaft"], key), curve, 32) == pytest.approx(2.0, rel=0.03)


@pytest.mark.parametrize(("degree", "coarse"), [(1, 8), (2, 4), (3, 4)])
def test_the_error_of_finite_elements_falls_with_twice_their_degree(
    timings: dict, degree: int, coarse: int
) -> None:
    found = quantity(timings["shaft"], "frequencies")
    assert rate(found, f"fem, degree {degree}", coarse) == pytest.approx(2.0 * degree, rel=0.05)


@pytest.mark.parametrize(("degree", "coarse"), [(1, 8), (2, 2)])
def test_the_error_of_torques_by_finite_elements_falls_likewise(
    timings: dict, degree: int, coarse: int
) -> None:
    found = quantity(timings["shaft"], "response")
    assert rate(found, f"fem, degree {degree}, elimination", coarse) == pytest.approx(
        2.0 * degree, rel=0.05
    )


@pytest.mark.parametrize("key", ["frequencies", "response"])
def test_the_exact_model_errs_by_rounding_alone(timings: dict, key: str) -> None:
    found = quantity(timings["shaft"], key)
    exact = next(row for row in found.rows if row.curve.startswith("exact"))
    assert exact.error <= found.bound < 1e-11


@pytest.mark.parametrize("scene", ["shaft", "joint", "braked"])
def test_dense_solve_and_elimination_agree_on_lumped_shafts(timings: dict, scene: str) -> None:
    found = quantity(timings[scene], "response")
    dense, swept = errors(found, "lumped, dense solve"), errors(found, "lumped, elimination")
    assert [dense[size] for size in dense] == pytest.approx(
        [swept[size] for size in dense], rel=1e-7
    )


def test_all_modes_of_a_train_that_damps_them_alike_give_its_response(timings: dict) -> None:
    """Static correction or not: with one loss factor everywhere no mode drives another."""
    found = quantity(timings["discs"], "response")
    for curve in ("modal superposition", "modal superposition, static correction"):
        known = errors(found, curve)
        assert known[2] < 1e-12
        assert known[1] > 1e-3
    assert errors(found, "dense solve")[1] < 1e-12


def test_damping_in_proportion_to_inertia_and_stiffness_does_not_couple_the_modes(
    timings: dict,
) -> None:
    found = quantity(timings["damped"], "response")
    for curve in ("modal superposition", "modal superposition, static correction"):
        assert errors(found, curve)[2] < 1e-12
    assert errors(found, "dense solve")[1] < 1e-12


def test_the_harmonics_of_the_largest_torques_are_compared(timings: dict) -> None:
    orders = [name.split()[0] for name in quantity(timings["damped"], "response").columns]
    assert orders == ["2", "4", "6"]


def test_a_speed_in_resonance_without_damping_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "QUICK", SHORT)
    discs = "train: [disc: {name: a, inertia: 0.5}, coupling: {stiffness: 1600}, disc: {name: b, inertia: 0.5}]"
    rest = "operation: {speeds: {from: 80 rad/s, to: 140 rad/s}}\nexcitations: [{at: a, order: 1, torque: 1}]"
    found = study_times(parsed(f"name: x\n{discs}\n{rest}\n"), highest=30.0, quick=True)
    assert any(
        remark.startswith("1 of 7 speeds are omitted") for remark in found.quantities[0].remarks
    )


def test_frequencies_are_compared_up_to_the_highest_excited_one_or_the_last_requested_mode(
    timings: dict,
) -> None:
    assert quantity(timings["joint"], "frequencies").highest == 300.0
    found = quantity(timings["shaft"], "frequencies")
    assert len(found.columns) == 3
    assert f"mode 3, {found.highest:.6g} Hz" == found.columns[-1]


def test_finite_elements_have_no_more_unknowns_than_the_effort_says(timings: dict) -> None:
    found = quantity(timings["shaft"], "frequencies")
    for degree in SHORT.degrees:
        assert max(errors(found, f"fem, degree {degree}")) == {1: 16, 2: 8, 3: 8}[degree]


def test_the_reference_has_twice_the_pieces_of_the_exact_model() -> None:
    coarse, fine = reference(plain(parsed(SHAFT)), 3000.0, None)
    assert fine.system.segments == {
        name: 2 * number for name, number in coarse.system.segments.items()
    }
    assert fine.frequency[-1] < 3000.0


def test_modes_of_a_continuum_converge_and_a_static_correction_gains_two_orders(
    timings: dict,
) -> None:
    found = quantity(timings["shaft"], "response")
    plain = errors(found, "modal superposition")
    corrected = errors(found, "modal superposition, static correction")
    assert np.log2(plain[16] / plain[32]) == pytest.approx(1.0, abs=0.2)
    assert np.log2(corrected[16] / corrected[32]) == pytest.approx(3.0, abs=0.3)


def test_modes_with_static_correction_converge_to_the_twist_of_a_joint(timings: dict) -> None:
    found = quantity(timings["joint"], "response")
    corrected = errors(found, "modal superposition, static correction")
    assert corrected[32] < 0.6 * corrected[16] < 0.36 * corrected[8]
    assert not errors(found, "modal superposition")
    assert any("imposes" in remark for remark in found.remarks)


def test_a_division_with_too_few_modes_has_no_error(timings: dict) -> None:
    found = quantity(timings["shaft"], "frequencies")
    assert errors(found, "lumped")[1] == float("inf")


def test_a_train_without_shafts_says_so_and_compares_the_methods_of_the_response(
    timings: dict,
) -> None:
    found = timings["discs"]
    assert [one.key for one in found.quantities] == ["response"]
    assert any("nothing to divide" in remark for remark in found.remarks)
    assert errors(found.quantities[0], "two-sided elimination") == {1: 0.0}


def test_every_method_has_its_turn_in_every_round(timings: dict) -> None:
    for one in timings["shaft"].quantities:
        for row in one.rows:
            assert len(row.assembly) == len(row.solve) == row.total.runs >= SHORT.rounds


def test_segments_of_the_file_are_not_used_and_that_is_said(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "QUICK", replace(SHORT, segments=4, degrees=(1,), unknowns=2))
    given = parsed(SHAFT.replace("length: 1.5 m", "length: 1.5 m, segments: 3"))
    found = study_times(given, count=1, no_response="it is not requested", quick=True)
    assert set(errors(found.quantities[0], "lumped")) == {1, 2, 4}
    assert any("`segments`" in remark for remark in found.remarks)
    assert any("it is not requested" in remark for remark in found.remarks)
