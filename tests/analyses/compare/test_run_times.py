"""The study of run times: its errors obey the laws of the methods; of times it is said only that they are there."""

from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.compare import run_times as module
from torsion.analyses.compare.model_errors import plain, reference
from torsion.analyses.compare.run_times import study_times
from torsion.analyses.compare.timing import Effort, TimedQuantity, Timings
from torsion.study import Study

SHORT = Effort(rounds=2, longest=5.0, segments=64, unknowns=24, degrees=(1, 2, 3), speeds=7)
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


@pytest.fixture(scope="module")
def timings() -> dict[str, Timings]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "QUICK", SHORT)
        patch.setattr(module, "FULL", SHORT)
        return {
            "shaft": study_times(parsed(SHAFT), highest=300.0, count=3),
            "joint": study_times(parsed(JOINT), highest=300.0),
            "braked": study_times(parsed(BRAKED), highest=300.0),
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
    assert rate(quantity(timings["shaft"], key), "lumped", 32) == pytest.approx(2.0, rel=0.03)


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
    assert rate(found, f"fem, degree {degree}", coarse) == pytest.approx(2.0 * degree, rel=0.05)


@pytest.mark.parametrize("key", ["frequencies", "response"])
def test_the_exact_model_errs_by_rounding_alone(timings: dict, key: str) -> None:
    found = quantity(timings["shaft"], key)
    exact = next(row for row in found.rows if row.curve == "exact")
    assert exact.error <= found.bound < 1e-11


def test_the_harmonics_of_the_largest_torques_are_compared(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "QUICK", replace(SHORT, rounds=1, segments=2, degrees=()))
    sizes = {6: 100, 5: 1e-6, 4: 100, 2: 100}
    applied = ", ".join(f"{{at: left, order: {n}, torque: {t}}}" for n, t in sizes.items())
    text = SHAFT[: SHAFT.index("excitations")] + f"excitations: [{applied}]\n"
    found = study_times(parsed(text), highest=300.0, quick=True)
    orders = [name.split()[0] for name in quantity(found, "response").columns]
    assert orders == ["2", "4", "6"]


def test_a_speed_in_resonance_without_damping_is_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A shaft between equal discs whose first mode is at the middle of seven speeds."""
    monkeypatch.setattr(module, "QUICK", replace(SHORT, rounds=1, segments=4, degrees=()))
    text = SHAFT.replace(", loss_factor: 0.01", "")
    first = float(reference(plain(parsed(text)), 0.0, 1)[0].frequency[0]) * 60.0
    speeds = f"{{from: {0.8 * first!r} rpm, to: {1.2 * first!r} rpm}}"
    text = text.replace("{from: 600 rpm, to: 3000 rpm}", speeds)
    text = text[: text.index("excitations")] + "excitations: [{at: left, order: 1, torque: 1}]\n"
    found = quantity(study_times(parsed(text), highest=1.2 * first / 60.0, quick=True), "response")
    assert any(remark.startswith("1 of 7 speeds are omitted") for remark in found.remarks)


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


def test_a_division_with_too_few_modes_has_no_error(timings: dict) -> None:
    found = quantity(timings["shaft"], "frequencies")
    assert errors(found, "lumped")[1] == float("inf")


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
