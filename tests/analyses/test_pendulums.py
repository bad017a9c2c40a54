"""Centrifugal pendulums against the equations of hub and bob, each order's own inertia and the generalised problem."""

import math
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigvals

import torsion
from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.engine.engine_results import Engines
from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed
from torsion.analyses.response.amplitudes import Synthesis
from torsion.analyses.response.component_loads import harmonic_heat
from torsion.analyses.response.pendulums import Pendulums, deflections, effective_inertia
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.model.parts import PendulumRecord
from torsion.study import Study

RPM = math.pi / 30.0
MASS, ARM, LENGTH, NUMBER, HUB, PIVOT = 0.7, 0.08, 0.01, 4, 0.02, 3e-3
DISCS, STIFFNESS = (0.1, 0.15, 0.3), (1.2e4, 2.0e4, 0.9e4)
TRAIN = f"""name: test
train:
  - disc: {{name: a, inertia: {DISCS[0]}}}
  - coupling: {{stiffness: {STIFFNESS[0]}, viscous: 2}}
  - disc: {{inertia: {DISCS[1]}}}
  - coupling: {{stiffness: {STIFFNESS[1]}}}
  - pendulum: {{name: p, mass: {MASS}, number: {NUMBER}, arm: 80 mm, length: 10 mm, inertia: {HUB}, damping: {PIVOT}}}
  - coupling: {{stiffness: {STIFFNESS[2]}, viscous: 1}}
  - disc: {{name: d, inertia: {DISCS[2]}}}
operation: {{speeds: {{from: 100 rpm, to: 6000 rpm}}, rated: {{speed: 3000 rpm, power: 10 kW}}}}
excitations:
  - {{at: a, order: 2, torque: 10}}
  - {{at: a, order: 5/2, torque: 7, phase: 30 deg}}
  - {{at: d, order: 4, torque: 5}}
  - {{at: a, frequency: 40 Hz, torque: 3}}
"""


def study(text: str = TRAIN) -> Study:
    return torsion.parse(text)


def equations(speed: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """M, C and K of the four angles of the shaft and of the bobs relative to their carrier, at a speed (rad/s)."""
    m, total = NUMBER * MASS, ARM + LENGTH
    mass = np.diag([DISCS[0], DISCS[1], HUB + m * total**2, DISCS[2], m * LENGTH**2])
    mass[2, 4] = mass[4, 2] = m * LENGTH * total
    stiff, damp = np.zeros((5, 5)), np.zeros((5, 5))
    for at, (k, c) in enumerate(zip(STIFFNESS, (2.0, 0.0, 1.0), strict=True)):
        pattern = np.array([[1.0, -1.0], [-1.0, 1.0]])
        stiff[at : at + 2, at : at + 2] += k * pattern
        damp[at : at + 2, at : at + 2] += c * pattern
    stiff[4, 4], damp[4, 4] = m * ARM * LENGTH * speed**2, NUMBER * PIVOT
    return mass, damp, stiff


def test_response_is_that_of_hub_and_bob_about_a_constant_speed() -> None:
    """Each order at each speed, and a fixed frequency, by a dense solve of the linearised equations."""
    given = study()
    speeds = np.array([300.0, 987.0, 2345.0, 5500.0]) * RPM
    found = torsion.response(given, assemble(given.train), speeds=speeds)
    names = [station.name for station in found.system.stations]
    shaft = [names.index(name) for name in ("a", "disc-2", "p", "d")]
    span = [one.name for one in found.system.spans].index("p bobs")
    record = found.system.train["p"].pendulum
    assert record is not None
    deflection = deflections(found.system, found, span, record)
    torques = {
        Fraction(2): (0, 10.0),
        Fraction(5, 2): (0, 7.0 * np.exp(1j * math.pi / 6)),
        Fraction(4): (3, 5.0),
    }
    for speed in speeds:
        at = int(np.argmin(abs(found.speed - speed)))
        mass, damp, stiff = equations(speed)
        for column, line in enumerate(found.lines):
            place, torque = (0, 3.0) if line.order is None else torques[line.order]
            w = 2.0 * math.pi * found.frequency[at, column]
            force = np.zeros(5, dtype=complex)
            force[place] = torque
            expected = np.linalg.solve(stiff + 1j * w * damp - w * w * mass, force)
            assert (
                np.abs(found.angle[at, column, shaft] - expected[:4]).max()
                <= 1e-12 * np.abs(expected[:4]).max()
            )
            assert deflection[at, column] == pytest.approx(abs(expected[4]), rel=1e-12)


def test_the_deflection_of_all_orders_is_the_sum_of_their_magnitudes() -> None:
    """Of the bobs at the worst speed, by the equations of hub and bob."""
    (bobs,) = torsion.run(study()).need(Pendulums).each
    assert bobs.speed is not None
    mass, damp, stiff = equations(bobs.speed)
    total = 0.0
    acting = ((2.0, 0, 10.0), (2.5, 0, 7.0), (4.0, 3, 5.0), (80.0 * math.pi / bobs.speed, 0, 3.0))
    for order, place, torque in acting:
        w, force = order * bobs.speed, np.zeros(5)
        force[place] = torque
        total += abs(np.linalg.solve(stiff + 1j * w * damp - w * w * mass, force)[4])
    assert bobs.deflection == pytest.approx(total, rel=1e-9)
    assert bobs.deflection > 1.0001 * max(row.deflection or 0.0 for row in bobs.at_orders)


def test_heat_is_that_of_the_pivots() -> None:
    given = study()
    found = torsion.response(given, assemble(given.train), speeds=np.array([2345.0 * RPM]))
    span = [one.name for one in found.system.spans].index("p bobs")
    record = found.system.train["p"].pendulum
    assert record is not None
    deflection, w = deflections(found.system, found, span, record), 2.0 * math.pi * found.frequency
    expected = (0.5 * NUMBER * PIVOT * (w * deflection) ** 2).sum(axis=1)
    assert harmonic_heat(found, found.system, np.array([span])).sum(axis=1) == pytest.approx(
        expected, rel=1e-12
    )


def test_each_order_meets_its_own_inertia() -> None:
    """reference [dampers]: m 1, R .08, l .01."""
    record = PendulumRecord(math.sqrt(8.0), None, (0.08 + 0.01) ** 2, 9.0)
    published = {"2": 0.0162, "5/2": 0.0370285714, "3": -0.0648, "4": -0.0081}
    for order, inertia in published.items():
        assert effective_inertia(record, Fraction(order)) == pytest.approx(inertia, rel=1e-9)


def test_frequencies_at_each_speed_are_those_of_the_equations() -> None:
    found = torsion.run(study()).need(FrequenciesOverSpeed)
    for speed in (200.0 * RPM, 1234.5 * RPM, 6000.0 * RPM):
        mass, _, stiff = equations(speed)
        expected = np.sqrt(np.sort(eigvals(stiff, mass).real)[1:]) / (2.0 * math.pi)
        assert found.at(speed) == pytest.approx(expected, rel=1e-11)


def test_critical_speeds_of_an_order_are_those_of_the_train_with_its_inertia() -> None:
    """Every positive root of K x = w^2 M x with the inertia that the order meets, which is negative above q."""
    found = torsion.run(study()).need(CriticalSpeeds).crossings
    m = NUMBER * MASS * (ARM + LENGTH) ** 2
    for order in (2.0, 2.5, 4.0):
        inertia = np.diag(
            [DISCS[0], DISCS[1], HUB + m / (1.0 - order**2 / (ARM / LENGTH)), DISCS[2]]
        )
        root = eigvals(equations(0.0)[2][:4, :4], inertia)
        w = np.sqrt(root.real[(abs(root.imag) < 1e-6 * abs(root)) & (root.real > 1.0)])
        expected = sorted(
            one / order for one in w.tolist() if 100.0 * RPM <= one / order <= 6000.0 * RPM
        )
        met = sorted(one.speed for one in found if float(one.order) == order)
        assert met == pytest.approx(expected, rel=1e-12)
        assert expected


def test_figures_hold_behind_a_gear() -> None:
    """The same hub at twice the speed of the reference: order n of the reference is n/2 of its shaft."""
    geared = TRAIN.replace("  - pendulum:", "  - gear: {ratio: 1/2}\n  - pendulum:")
    given = study(geared)
    system = assemble(given.train)
    assert given.train["p"].ratio == 2
    speed, w = 1500.0 * RPM, 2.0 * 1500.0 * RPM
    found = torsion.response(given, system, speeds=np.array([speed]))
    mass, damp, stiff = equations(2.0 * speed)
    shaft = np.diag(
        [1.0, 1.0, 2.0, 2.0, 2.0]
    )  # hub, d and bobs turn twice as fast as the discs before the gear
    before = np.zeros((5, 5))  # the coupling between disc-2 and the gear, of the first shaft
    before[1:3, 1:3] = STIFFNESS[1] * np.array([[1.0, -1.0], [-1.0, 1.0]])
    mass, damp, stiff = (shaft @ one @ shaft for one in (mass, damp, stiff - before))
    stiff += before
    force = np.array([10.0, 0, 0, 0, 0])
    expected = shaft @ np.linalg.solve(stiff + 1j * w * damp - w * w * mass, force)
    names = [station.name for station in system.stations]
    at = int(np.argmin(abs(found.speed - speed)))
    column = next(k for k, line in enumerate(found.lines) if line.order == 2)
    assert found.angle[at, column, names.index("p")] == pytest.approx(expected[2], rel=1e-12)
    orders = [one.order for one in torsion.run(given).need(Pendulums).each[0].at_orders]
    assert orders == [Fraction(1), Fraction(5, 4), Fraction(4)]  # d turns as the pendulum does


def test_a_pendulum_of_the_order_that_excites_fixes_its_carrier() -> None:
    """Without damping at the pivot; the bobs deflection so that their torque balances the shaft's."""
    tuned = (
        TRAIN.replace("length: 10 mm", "order: 2")
        .replace(f", damping: {PIVOT}", "")
        .replace("from: 100 rpm", "from: 1500 rpm")
    )
    findings = torsion.run(study(tuned))
    (one,) = findings.need(Pendulums).each
    assert one.tuned == 2.0
    row = next(row for row in one.at_orders if row.order == 2)
    assert row.inertia is None
    given = study(tuned)
    found = torsion.response(given, assemble(given.train), speeds=np.array([1700.0 * RPM]))
    column = next(k for k, line in enumerate(found.lines) if line.order == 2)
    names = [station.name for station in found.system.stations]
    angle = found.angle[0, column]
    assert abs(angle[names.index("p")]) <= 1e-13 * abs(angle[names.index("a")])
    mass, damp, stiff = equations(1700.0 * RPM)
    w = 2.0 * 1700.0 * RPM
    expected = np.linalg.solve((stiff + 1j * w * damp - w * w * mass)[:2, :2], [10.0, 0.0])
    assert angle[names.index("a")] == pytest.approx(expected[0], rel=1e-12)


def test_modes_are_those_of_the_rated_speed_and_said_so(tmp_path: Path) -> None:
    findings = torsion.run(study())
    mass, _, stiff = equations(3000.0 * RPM)
    expected = np.sqrt(np.sort(eigvals(stiff, mass).real)[1:]) / (2.0 * math.pi)
    assert findings.results["modes"].frequency == pytest.approx(expected, rel=1e-11)
    assert findings.need(Pendulums).speed == pytest.approx(3000.0 * RPM)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (
            (
                "operation: {speeds: {from: 100 rpm, to: 6000 rpm}, rated: {speed: 3000 rpm, power: 10 kW}}",
                "",
            ),
            "frequencies of a train with a pendulum follow the speed",
        ),
        (
            ("excitations:", "analyses: {transient: {duration: 1}}\nexcitations:"),
            "does not support a pendulum",
        ),
        (("excitations:", "damping: {modal: 2 %}\nexcitations:"), "a pendulum has many"),
    ],
)
def test_what_takes_no_pendulum_is_refused_at_the_pendulum(
    change: tuple[str, str], words: str
) -> None:
    with pytest.raises(InputError, match=words) as caught:
        study(TRAIN.replace(*change))
    assert any(words in fault.message and fault.line == 7 for fault in caught.value.faults)


def test_pendulum_in_a_train_with_a_closed_loop_has_the_response_of_a_disc_of_its_inertia() -> None:
    """At one order; the loop is a coupling beside another."""
    looped = """name: test
train:
  - disc: {name: a, inertia: 0.1}
  - coupling: {stiffness: 1.2e4, viscous: 2}
  - disc: {name: b, inertia: 0.15}
  - coupling: {stiffness: 2e4}
  - %s
links: [{between: [a, p], coupling: {stiffness: 3e3}}]
operation: {speeds: {from: 100 rpm, to: 6000 rpm}}
excitations: [{at: a, order: 2, torque: 10}]
"""
    plain = {"disc": {"name": "p", "inertia": 0.02 + 0.0081 / (1 - 4 / 8)}}
    bobs: dict[str, Any] = {
        "pendulum": {"name": "p", "mass": 1, "arm": 0.08, "length": 0.01, "inertia": 0.02}
    }
    one, other = (torsion.parse(looped % str(each).replace("'", "")) for each in (plain, bobs))
    speeds = np.array([800.0, 2000.0, 4000.0]) * RPM
    first, second = (
        torsion.response(each, assemble(each.train), speeds=speeds) for each in (one, other)
    )
    at = [
        [int(np.argmin(abs(found.speed - speed))) for speed in speeds] for found in (first, second)
    ]
    assert second.angle[at[1], 0, :3] == pytest.approx(first.angle[at[0], 0, :3], rel=1e-11)


def test_misfires_of_an_engine_with_a_pendulum_are_those_of_runs_of_their_own() -> None:
    """The table of misfires has at every speed the pendulum of that speed, far from the rated one too."""
    scene = """name: one throw
operation: {speeds: {from: 900 rpm, to: 1100 rpm, steps: 3}, rated: {speed: 3000 rpm, power: 1 kW}}
train:
  - engine:
      name: e
      cylinders: 2
      strokes: 4
      inertia: 0.05
      firing_angles: [0 deg, 360 deg]
      stiffness: 2e5
      STATE
      gas: {cycle: wiebe, compression_ratio: 10, charge: 1 bar, exhaust: 1 bar, imep: 8 bar, p_max: 50 bar,
            duration: 60 deg}
      geometry: {bore: 80 mm, stroke: 80 mm, rod_length: 140 mm}
      masses: {reciprocating: 0.5 kg}
  - coupling: {stiffness: 1e5, viscous: 3}
  - pendulum: {mass: 1, arm: 0.1, order: 1, inertia: 0.1}
  - coupling: {stiffness: 3e3, viscous: 2}
  - disc: {inertia: 2}
analyses: {response: }
"""
    (engine,) = (
        torsion.run(torsion.parse(scene.replace("STATE", "imbalance: [[2, 103 %]]")))
        .need(Engines)
        .each
    )
    case = next(one for one in engine.misfires if one.cylinder == 1)
    own = torsion.run(torsion.parse(scene.replace("STATE", "misfire: 1")))
    speed, half = own.results["response"].speed, own.need(Synthesis).half_range
    for place, at in enumerate(case.speed):
        near = np.flatnonzero(abs(speed / at - 1.0) < 1e-12)
        if near.size:
            assert case.half_range[place] == pytest.approx(half[near[0]], rel=1e-10)
    assert sum(bool((abs(speed / at - 1.0) < 1e-12).any()) for at in case.speed) >= 3


@pytest.mark.parametrize(
    "analyses", ["{response: }", "{modes: {count: 1}, response: }", "{modes: , response: }"]
)
def test_response_has_a_point_at_every_resonance_whatever_modes_are_requested(
    analyses: str,
) -> None:
    """At every positive root of K x = w^2 M x of every order that lies in the range."""
    coarse = TRAIN.replace("to: 6000 rpm", "to: 6000 rpm, steps: 4")
    speed = torsion.run(study(coarse + f"analyses: {analyses}\n")).results["response"].speed
    m, met = NUMBER * MASS * (ARM + LENGTH) ** 2, 0
    for order in (2.0, 2.5, 4.0):
        inertia = np.diag(
            [DISCS[0], DISCS[1], HUB + m / (1.0 - order**2 / (ARM / LENGTH)), DISCS[2]]
        )
        root = eigvals(equations(0.0)[2][:4, :4], inertia)
        w = np.sqrt(root.real[(abs(root.imag) < 1e-6 * abs(root)) & (root.real > 1.0)])
        for one in w[(w / order >= 100.0 * RPM) & (w / order <= 6000.0 * RPM)]:
            assert abs(speed / (one / order) - 1.0).min() < 1e-9
            met += 1
    assert met >= 5


def test_a_table_that_ends_beside_a_pendulum_leaves_out_the_modes_above_it() -> None:
    table = "  - coupling: {table: {over: frequency, at: [START, 130], stiffness: [1.9e4, 2e4], loss_factor: [0, 0]}}\n"
    ends = TRAIN.replace("  - coupling: {stiffness: 20000.0}\n", table).replace(
        "to: 6000 rpm", "to: 1500 rpm"
    )
    assert ends.count("over: frequency") == 1
    findings = torsion.run(study(ends.replace("START", "1")))
    modes = findings.results["modes"].frequency
    curves = findings.need(FrequenciesOverSpeed).frequency
    assert 1 <= len(curves) <= len(modes)
    assert "response" in findings.results
    fourth = "".join(
        line
        for line in ends.splitlines(True)
        if "order: 2" not in line and "order: 5/2" not in line
    )
    below = torsion.run(
        study(fourth.replace("START", "6.5"))
    )  # at 100 rpm the pendulum's own lies below
    assert "response" in below.results
    assert [one.analysis for one in below.plan.unanswered] == ["frequencies over speed"]
    assert "points of the response at every resonance" in [what for what, _ in below.plan.left_out]


def test_bobs_that_would_swing_past_a_right_angle_are_no_answer() -> None:
    """A light pendulum without damping would take any torque of its order, by deflections without meaning."""
    light = (
        TRAIN.replace("mass: 0.7", "mass: 1 g")
        .replace(f", damping: {PIVOT}", "")
        .replace("length: 10 mm", "order: 2")
    )
    found = torsion.run(study(light))
    assert ["degrees" in one.why for one in found.plan.unanswered] == [True]


def test_a_deflection_is_an_answer_up_to_a_right_angle() -> None:
    """The deflection of a linear pendulum is in proportion to the torque: to 89 and to 91 degrees."""
    text = TRAIN.split("excitations:", maxsplit=1)[0].replace(
        "to: 6000 rpm", "to: 150 rpm, steps: 2"
    )

    def run(torque: float) -> Findings:
        return torsion.run(study(f"{text}excitations: [{{at: a, order: 2, torque: {torque!r}}}]\n"))

    (bobs,) = run(1.0).need(Pendulums).each
    assert bobs.deflection is not None
    degree = math.radians(1.0) / bobs.deflection
    (near,) = run(89.0 * degree).need(Pendulums).each
    assert near.deflection == pytest.approx(math.radians(89.0), rel=1e-12)
    beyond = run(91.0 * degree)
    assert beyond.get(Pendulums) is None
    assert ["91 degrees" in row.why for row in beyond.plan.unanswered] == [True]
