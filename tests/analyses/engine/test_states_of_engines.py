"""States of engines: misfires in cases, engines of any phase to each other, loads that tables do not cover."""

import numpy as np
import pytest

import torsion
from torsion.analyses.motion.transient_motion import Transients
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

DIESEL = """
name: four cylinders on a rubber coupling
operation: {at: diesel, speeds: {from: 900 rpm, to: 1500 rpm, steps: 11}, rated: {speed: 1500 rpm, power: 90 kW}}
train:
- engine:
    name: diesel
    cylinders: 4
    strokes: 4
    firing_order: [1, 3, 4, 2]
    inertia: 0.045
    stiffness: 1.25 MN*m/rad
    loss_factor: 3.5 %
    gas: {table: [[0.5, 60 N*m, 0 deg], [1, 90 N*m, 0 deg], [2, 80 N*m, 0 deg]], motored: [[2, 10 N*m, 0 deg]]}
    STATE
- disc: {name: flywheel, inertia: 1.5}
- coupling: {name: rubber, stiffness: 18 kN*m/rad, psi: 1.1, vibratory_torque: 250 N*m}
- propeller: {name: generator, inertia: 3.5}
rules: [coupling-maker]
"""


def values(found: Findings) -> list[tuple[str, float, str]]:
    return [(one.what, one.value, one.note) for one in found.need(Checks).lines]


def test_the_worst_misfire_of_a_case_is_that_of_a_file_of_its_own() -> None:
    own = torsion.run(torsion.parse(DIESEL.replace("STATE", "misfire: worst")))
    plain = DIESEL.replace("STATE", "")
    cases = torsion.run(torsion.parse(plain + "cases: {misfire: {set: {diesel.misfire: worst}}}\n"))
    assert own.failed
    assert not torsion.run(torsion.parse(plain)).failed
    assert cases.cases["misfire"].failed
    *checks, firing = values(own)
    assert firing[0] == "All cylinders firing"
    assert values(cases.cases["misfire"]) == checks
    assert values(cases) == values(torsion.run(torsion.parse(plain)))


def test_a_case_of_a_file_that_tries_every_cylinder_does_so_too() -> None:
    change = "{rubber.stiffness: 16 kN*m/rad}"
    plain = DIESEL.replace("STATE", "misfire: worst")
    own = torsion.run(torsion.parse(plain.replace("18 kN*m/rad", "16 kN*m/rad")))
    found = torsion.run(torsion.parse(plain + f"cases: {{warm: {{set: {change}}}}}\n"))
    assert values(found.cases["warm"]) == values(own)
    assert len(found.cases["warm"].results["engines"].each[0].misfires) == 5


def test_modes_alone_are_found_of_an_engine_that_tries_every_cylinder() -> None:
    found, plain = (
        torsion.run(torsion.parse(DIESEL.replace("STATE", state)), only=["modes"])
        for state in ("misfire: worst", "")
    )
    np.testing.assert_array_equal(found.need(Modes).frequency, plain.need(Modes).frequency)


TWO = """
name: two engines on a gear
operation: {at: one, speeds: {from: 900 rpm, to: 1500 rpm, steps: 7}, rated: {speed: 1500 rpm, power: 200 kW}}
train:
- engine: {name: one, cylinders: 1, strokes: 4, inertia: 0.5, gas: {table: FIRST}}
- coupling:
    name: rubber
    stiffness: 30 kN*m/rad
    psi: 1
    temperature: {now: 30 degC, stiffness: [[30, 1], [100, 0.6]], rise: 70 K, at: 1 kW, to: 100 degC}
- gear:
    name: gear
    ratio: 1
    branches:
    - ratio: 1
      inertia: 0.3
      train:
      - coupling: {stiffness: 25 kN*m/rad, psi: 1}
      - engine: {name: two, cylinders: 1, strokes: 4, inertia: 0.6, phase: PHASE, gas: {table: SECOND}}
- coupling: {name: shaft, stiffness: 60 kN*m/rad, psi: 1}
- propeller: {name: screw, inertia: 8}
analyses: {response: }
rules: [nvh: {at: screw, acceleration: 300 rad/s**2, fluctuation: 15 rpm}, coupling-maker]
"""
BOTH = (
    "[[0.5, 300 N*m, 0 deg], [1.5, 300 N*m, 40 deg]]",
    "[[0.5, 200 N*m, 70 deg], [1.5, 400 N*m, 0 deg]]",
)
EACH = (
    "[[0.5, 300 N*m, 0 deg], [1.5, 300 N*m, 40 deg]]",
    "[[1, 300 N*m, 70 deg], [2, 700 N*m, 0 deg]]",
)


def two(tables: tuple[str, str], phase: str) -> Findings:
    text = TWO.replace("FIRST", tables[0]).replace("SECOND", tables[1]).replace("PHASE", phase)
    return torsion.run(torsion.parse(text))


@pytest.mark.parametrize("tables", [BOTH, EACH], ids=["of one order", "of orders of their own"])
def test_nothing_of_two_engines_at_any_phase_exceeds_their_worst_phase(
    tables: tuple[str, str],
) -> None:
    worst, each = (
        two(tables, "worst"),
        [two(tables, f"{degrees} deg") for degrees in range(0, 720, 120)],
    )
    half = np.array([one.need(Synthesis).half_range.max(axis=0) for one in each]).max(axis=0)
    assert np.all(half <= worst.need(Synthesis).half_range.max(axis=0))
    checks = {one.what: one.value for one in worst.need(Checks).lines}
    assert len(checks) == 3
    for found in each:
        for one in found.need(Checks).lines:
            assert one.value <= checks[one.what] * (1 + 1e-9), one.what


def test_half_ranges_at_any_phase_are_sums_of_magnitudes() -> None:
    found = two(EACH, "worst")
    torque = np.abs(found.need(Response).torque).sum(axis=1)
    np.testing.assert_allclose(found.need(Synthesis).half_range, torque, rtol=1e-13)
    angle = np.abs(found.need(Response).angle[:, :, -1]) * (
        2 * np.pi * found.need(Response).frequency
    )
    (speed,) = (one for one in found.need(Checks).lines if one.clause == "fluctuation")
    assert speed.value == pytest.approx(angle.sum(axis=1).max() * 30 / np.pi, rel=1e-12)


LOADS = "{tables: [{torque: 10 N*m, rows: [[2, 100 N*m, 0 deg]]}, {torque: TOP N*m, rows: [[2, 400 N*m, 0 deg]]}]}"


def test_a_load_that_tables_do_not_cover_is_refused_of_each_of_several_engines() -> None:
    text = TWO.replace("{table: FIRST}", "{table: [[1, 5 N*m, 0 deg]]}").replace(
        "PHASE", "90 deg, power: 60 kW"
    )
    text = text.replace("inertia: 0.5,", "inertia: 0.5, power: 140 kW,").replace(
        "{table: SECOND}", LOADS
    )
    most = 200e3 / (1500 * np.pi / 30) * 0.3  # N m of the second engine, at the highest speed
    torsion.parse(text.replace("TOP", f"{most * 1.001}"))
    with pytest.raises(
        torsion.InputError, match=rf"'two' cover 10 to 300 N m .* 137\.\d+ to {most:.5g} "
    ):
        torsion.parse(text.replace("TOP", "300"))


def test_the_order_table_at_the_rated_speed_is_covered_too() -> None:
    gas = DIESEL.partition("gas: ")[2].partition("\n")[0]
    text = DIESEL.replace("STATE", "").replace(gas, LOADS.replace("TOP", "500"))
    with pytest.raises(torsion.InputError, match=r"'diesel' cover 2\.5 to 125 N m .* to 143\.24 "):
        torsion.parse(text.replace("to: 1500 rpm", "to: 1000 rpm"))


def test_a_motion_over_time_counts_its_orders_from_the_engine_that_the_operation_names() -> None:
    text = DIESEL.replace("STATE", "").replace(
        "rules: [coupling-maker]", "analyses: {transient: {duration: 0.1 s}}"
    )
    found = torsion.run(torsion.parse(text))
    assert len(found.need(Transients).each) == 1


def test_a_single_throw_takes_no_stiffness_between_throws() -> None:
    single = TWO.replace("PHASE", "0 deg").replace("FIRST", EACH[0]).replace("SECOND", EACH[1])
    torsion.parse(single)
    with pytest.raises(torsion.InputError, match="`stiffness` has 1 values, and there are 0 spans"):
        torsion.parse(single.replace("inertia: 0.5,", "inertia: 0.5, stiffness: 1 MN*m/rad,"))


BY_TORQUE = "table: {over: mean torque, at: [0, 900], stiffness: [9e3, 30e3], psi: [1, 1]}"


def test_misfires_are_not_superposed_where_the_mean_torque_sets_the_stiffness() -> None:
    plain = DIESEL.replace("STATE", "")
    assert len(torsion.run(torsion.parse(plain)).results["engines"].each[0].misfires) == 5
    found = torsion.run(torsion.parse(plain.replace("stiffness: 18 kN*m/rad, psi: 1.1", BY_TORQUE)))
    assert found.results["engines"].each[0].misfires == ()
    assert (
        "the stiffness of a coupling changes"
        in dict(found.plan.left_out)["misfire of each cylinder of diesel"]
    )
