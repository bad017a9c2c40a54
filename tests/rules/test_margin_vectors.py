"""Vectors of limits of gears and couplings, and of the torque that a required diameter is of."""

import json
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.steady import Steady
from torsion.rules.coupling_maker import CouplingMaker, CouplingSettings
from torsion.rules.rule_over_speed import full_torque
from torsion.rules.strength.gear_hammer import GearHammer, GearHammerSettings

VECTORS = {
    vector["id"]: vector
    for vector in json.loads((Path(__file__).parent / "margin_oracles.json").read_text())["vectors"]
}
RIPPLE = {"inertia": 1.0, "ripple": [{"order": 4, "torque": 10.0}]}


@pytest.mark.parametrize("flip", [False, True])
def test_all_components_together_count_as_their_half_range_or_as_the_root_of_their_squares(
    study, evidence, flip
) -> None:
    """Of a flat top the root of squares is larger; of the same components in phase, the half range."""
    vector = VECTORS["coupling-flat-top"]
    given, expected = vector["input"], vector["expected"]
    limit = [["0 Hz", given["T_KW"]], ["99 Hz", given["T_KW"]]]
    body = {"name": "rubber", "stiffness": 1e4, "psi": 1.0, "vibratory_torque": limit}
    results = evidence(
        study([("motor", RIPPLE), ("coupling", body), ("disc", {"inertia": 2.0})]),
        [300.0, 600.0],
        half={},
    )
    sizes = np.abs(given["torque"]) if flip else np.array(given["torque"])
    orders = [Fraction(order) for order in given["orders"]]
    response = results.need(Response)
    shape = len(response.speed), len(orders)
    torque = np.zeros((*shape, response.torque.shape[2]), dtype=complex)
    torque[:, :, 0] = sizes
    several = replace(
        response,
        lines=tuple(Line(order, None, ("screw",)) for order in orders),
        torque=torque,
        frequency=np.outer(response.speed / 2 / np.pi, np.array(given["orders"], dtype=float)),
        angle=np.zeros((*shape, response.angle.shape[2]), dtype=complex),
        residual=np.zeros(shape),
        joint_error=np.zeros(shape),
        status=np.zeros(shape, dtype=np.uint8),
    )
    _, together = CouplingMaker(CouplingSettings()).check(results.having(response=several))
    squares = float(np.sqrt((sizes**2).sum()))
    if flip:  # cos + cos 3 / 3 + cos 5 / 5, largest at 0
        assert together.value == pytest.approx(sizes.sum(), rel=1e-9)
        assert together.value > squares
    else:
        assert (
            expected["half range"] < expected["root of squares"] == pytest.approx(squares, rel=1e-6)
        )
        assert together.value == pytest.approx(expected["value"], rel=1e-6)
    assert together.verdict == expected["verdict"].lower()


@pytest.mark.parametrize("case", range(2))
def test_a_required_diameter_is_of_the_rated_power_at_least(study, evidence, case) -> None:
    vector = VECTORS["full-torque"]
    rated, carried = 1e3 * vector["input"]["rated_kW"], 1e3 * vector["input"]["carried_kW"][case]
    scene = study(
        [
            ("motor", RIPPLE),
            ("shaft", {"length": 1.0, "diameter": 0.1}),
            ("propeller", {"inertia": 2.0}),
        ],
        rated={"speed": "1000 rpm", "power": rated},
    )
    results = evidence(scene, [900.0, 1000.0, 1100.0], half={}, mean={"shaft-1": 1.0})
    steady = results.need(Steady)
    applied = np.zeros_like(steady.applied)
    applied[0], applied[-1] = carried / steady.speed, -carried / steady.speed
    mean = np.broadcast_to(carried / steady.speed, steady.torque.shape)
    results = results.having(mean=replace(steady, applied=applied, torque=mean))
    at_rated = carried / scene.operation.rated.speed
    factor = vector["expected"]["factor on the mean torque"][case]
    np.testing.assert_allclose(full_torque(results), factor * at_rated, rtol=1e-12)


@pytest.mark.parametrize("case", range(4))
def test_a_mesh_endures_its_application_factor_less_one(study, evidence, case) -> None:
    given, expected = VECTORS["gear-ka"]["input"], VECTORS["gear-ka"]["expected"]
    stated = (
        {}
        if given["drive"][case].startswith("usual")
        else {"application_factor": expected["K_A"][case]}
    )
    gear = {"name": "gearbox", "ratio": 2, "inertia": [0.1, 0.1], **stated}
    scene = study([("motor", RIPPLE), ("gear", gear), ("propeller", {"inertia": 2.0})])
    mean = [given["mean"], given["rated mesh torque"]]
    results = evidence(
        scene, [500.0, 1000.0], half={"gearbox": [given["vibratory"], 0.0]}, mean={"gearbox": mean}
    )
    checks = {check.clause: check for check in GearHammer(GearHammerSettings()).check(results)}
    rating, reversal = checks["(K_A - 1) T_rated"], checks["torque reversal"]
    assert rating.limit == pytest.approx(expected["limit"][case], rel=1e-12, abs=1e-9)
    assert rating.value == given["vibratory"]
    assert rating.fails == (expected["verdict"][case] == "FAIL")
    assert (reversal.fails, reversal.value, reversal.limit) == (
        True,
        given["vibratory"],
        given["mean"],
    )
