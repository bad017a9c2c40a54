"""An engine in a train: equal to its discs and torques written out, its misfires, its mean torque, its results."""

import cmath
import json
import math
from dataclasses import astuple, replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from tests.kernels.engine.test_engine_kernels import ORACLES

import torsion
from torsion.analyses.engine.engine_analysis import varying_inertia
from torsion.analyses.engine.engine_results import Engines
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.steady import Steady, steady
from torsion.analyses.undamped_modes import Modes
from torsion.arrays import FloatArray
from torsion.findings import Findings, Unanswered, Work
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.rules.verdict_line import BarredRange, Check, Checks
from torsion.runner import _select_worst
from torsion.schema.json_schema import json_schema
from torsion.schema.yaml_source import parse_source

KNOWN = ORACLES["six_cylinder_cases"]
FIRES = ORACLES["six_cylinder_mendes_pressure"]["train"]["firing_deg"]
SCENE = """
name: six cylinders
operation:
  at: flywheel
  speeds: {from: 1990 rpm, to: 2010 rpm, steps: 3}
  load: [[1000 rpm, 0 N*m], [3000 rpm, 2039.07372 N*m]]
train:
  - disc: {name: damper, inertia: 0.0170}
  - coupling: {stiffness: 1.106e6, loss_factor: 0.035}
  - disc: {name: gears, inertia: 0.0090}
  - coupling: {stiffness: 1.631e6, loss_factor: 0.035}
  - engine:
      name: main engine
      cylinders: 6
      strokes: 4
      firing_order: [1, 5, 3, 6, 2, 4]
      inertia: [0.0467, 0.0327, 0.0467, 0.0467, 0.0327, 0.0487]
      stiffness: [1.253e6, 1.253e6, 1.678e6, 1.253e6, 1.253e6]
      damping: 2
      loss_factor: 0.035
      geometry: {bore: 105 mm, stroke: 137 mm, rod_length: 207 mm}
      masses: {reciprocating: 2.521 kg}
      gas: {GAS}
      STATE
  - coupling: {stiffness: 1.976e6, loss_factor: 0.035}
  - disc: {name: flywheel, inertia: 2.0750}
analyses: {modes: {count: 8}, response: }
"""
CYCLE = (
    "cycle: wiebe, compression_ratio: 17, charge: 2.4 bar, exhaust: 2 bar, imep: 18 bar, p_max: 150 bar, "
    "duration: 60 deg, crankcase: 0"
)
SPEED = 2000.0 * math.pi / 30.0


def solved(gas: str = CYCLE, state: str = "", **changed: str) -> Findings:
    text = SCENE.replace("GAS", gas).replace("STATE", state)
    for old, new in changed.items():
        text = text.replace(old, new)
    return torsion.run(torsion.parse(text))


def at_speed(found: Findings) -> int:
    return int(np.argmin(np.abs(found.need(Response).speed - SPEED)))


def sampled(found: Findings, number: int = 7200) -> FloatArray:
    """(spans,) N m, half range of samples over two revolutions, as the vectors were made."""
    response = found.need(Response)
    order = np.array([float(line.order) for line in response.lines])
    turned = np.exp(1j * np.outer(4 * math.pi / number * np.arange(number), order))
    wave = (turned @ response.torque[at_speed(found)]).real
    return np.asarray((wave.max(axis=0) - wave.min(axis=0)) / 2.0)


STATES = {
    "normal": "",
    **{f"misfire {k}": f"misfire: {k}" for k in range(1, 7)},
    "imbalance +-5 % in 1, 6": "imbalance: [[1, 105 %], [6, 95 %]]",
}


@pytest.mark.parametrize("case", STATES)
def test_half_ranges_are_those_of_the_vector(case: str) -> None:
    found, known = solved(state=STATES[case]), KNOWN["half range s1..s8"][case]
    np.testing.assert_allclose(sampled(found), known, rtol=1e-7)  # of a cycle to 3e-8
    exact = found.need(Synthesis).half_range[at_speed(found)]
    assert np.all(exact >= sampled(found) * (1 - 1e-12)), "samples miss the extremes"
    np.testing.assert_allclose(exact, known, rtol=2e-5)


def test_orders_that_break_couplings_grow_with_a_misfire() -> None:
    for case, known in KNOWN["span 8 orders .5, 1, 1.5"].items():
        found = solved(state=STATES[case])
        size = np.abs(found.need(Response).torque[at_speed(found), :3, -1])
        np.testing.assert_allclose(size, known, rtol=1e-7)


def written_out(rows: list[tuple[Fraction, complex]], mass: float) -> str:
    """The train of discs with a torque for every cylinder and order: those of gas rows and of a reciprocating mass."""
    inertia = CrankSlider.of_stroke(0.137, 0.207).inertia_torque(12, mass)
    inertias = (0.0467, 0.0327, 0.0467, 0.0467, 0.0327, 0.0487)
    throws = [
        f"- disc: {{name: cylinder {k}, inertia: {J}, damping: 2}}"
        for k, J in enumerate(inertias, 1)
    ]
    springs = [
        f"- coupling: {{stiffness: {k}, loss_factor: 0.035}}"
        for k in (1.253e6, 1.253e6, 1.678e6, 1.253e6, 1.253e6)
    ]
    crank = [line for pair in zip(throws, [*springs, ""], strict=True) for line in pair if line]
    text = SCENE.partition("  - engine:")[0] + "".join(f"  {line}\n" for line in crank)
    text += (
        "  - coupling: {stiffness: 1.976e6"
        + SCENE.partition("  - coupling: {stiffness: 1.976e6")[2]
    )
    text += "excitations:\n"
    for order, gas in rows:
        whole = gas + (inertia[int(order)] * SPEED**2 if order.denominator == 1 else 0.0)
        for k, fires in enumerate(FIRES):
            torque = complex(whole * cmath.exp(-1j * math.radians(float(order * fires % 360))))
            amount = f"torque: {abs(torque)!r}, phase: {cmath.phase(torque)!r} rad"
            text += f"  - {{at: cylinder {k + 1}, order: {order}, {amount}}}\n"
    return text


def test_an_engine_is_its_discs_and_torques_written_out() -> None:
    """144 torques at one speed, at which alone a torque that grows with the square of the speed can be a number."""
    random = np.random.default_rng(5)
    rows = [(Fraction(k, 2), complex(*random.uniform(-300, 300, 2))) for k in range(1, 25)]
    table = ", ".join(f"{{order: {order}, a: {c.real!r}, b: {-c.imag!r}}}" for order, c in rows)
    engine = solved(f"table: [{table}]")
    discs = torsion.run(torsion.parse(written_out(rows, 2.521)))
    own, other = (found.need(Response).torque[at_speed(found)] for found in (engine, discs))
    assert len(discs.study.train.torques) == 144
    for line in range(24):
        np.testing.assert_allclose(own[line], other[line], rtol=0, atol=3e-13 * np.abs(other).max())


def test_torque_follows_from_pressure_by_area_and_crank_radius() -> None:
    tangential = math.pi / 4 * 0.105**2 * 0.137 / 2
    in_torque = solved(f"table: [[1.5, {2e5 * tangential!r} N*m, -80 deg]]")
    in_pressure = solved("table: [[1.5, 2 bar, -80 deg]]")
    by_parts = solved(
        f"table: [{{order: 1.5, a: {2 * math.cos(math.radians(80))!r} bar, "
        f"b: {2 * math.sin(math.radians(80))!r} bar}}]"
    )
    for other in (in_pressure, by_parts):
        np.testing.assert_allclose(
            other.need(Response).torque, in_torque.need(Response).torque, rtol=0, atol=1e-9
        )


def test_the_table_at_one_load_follows_the_mean_torque() -> None:
    found = solved(
        "table: [[3, 600 N*m, 0 deg]], at: {torque: 1000 N*m}", masses="note: none #masses"
    )
    response = found.need(Response)
    mean = 2039.07372 / 2000.0 * (response.speed * 30.0 / math.pi - 1000.0)
    (torque,) = [
        one
        for one in found.study.train.torques
        if one.station == found.study.train.torques[0].station
    ]
    amplitude = torque.cylinder.amplitude(response.speed, mean / 6.0)
    np.testing.assert_allclose(amplitude, 0.6 * mean, rtol=1e-12)


def test_tables_over_speed_are_interpolated_as_complex_numbers() -> None:
    tables = "tables: [{speed: 1900 rpm, rows: [[3, 400 N*m, 0 deg]]}, {speed: 2100 rpm, rows: [[3, 400 N*m, 90 deg]]}]"
    found = solved(tables, masses="note: none #masses")
    torque = found.study.train.torques[0]
    assert torque.cylinder.amplitude(np.array([SPEED]), None)[0] == pytest.approx(
        200 + 200j, rel=1e-12
    )


KEPT = "misfire: 3\n      keep_power: true"


@pytest.mark.parametrize(
    ("state", "heat"),
    [
        ("", (1, 1, 1, 1, 1, 1)),
        ("misfire: 3", (1, 1, 0, 1, 1, 1)),
        ("cut_out: [1, 2]", (0, 0, 1, 1, 1, 1)),
        (KEPT, (1.2, 1.2, 0, 1.2, 1.2, 1.2)),
        (f"imbalance: [[1, 80 %]]\n      {KEPT}", (1, 1.25, 0, 1.25, 1.25, 1.25)),
    ],
)
def test_mean_torque_enters_at_the_cylinders_that_fire(state: str, heat: tuple[float, ...]) -> None:
    found = solved(state=state)
    at = steady(found.study.train, found.system, found.study.operation, np.array([SPEED]))
    applied = {
        station.name: float(value)
        for station, value in zip(found.system.stations, at.applied[:, 0], strict=True)
    }
    shares = [cylinder.share for cylinder in found.need(Engines).each[0].cylinders]
    assert shares == pytest.approx(heat, rel=1e-15)
    engine = [value for name, value in applied.items() if name.startswith("main engine")]
    assert engine == pytest.approx([1019.53686 * share / 6.0 for share in heat], rel=1e-9)
    assert applied["flywheel"] == pytest.approx(-sum(engine), rel=1e-12)
    np.testing.assert_allclose(
        found.need(Steady).torque[-1], -found.need(Steady).applied[-1], rtol=1e-12
    )


def test_misfires_by_superposition_are_those_of_runs_of_their_own() -> None:
    engine = solved(state="imbalance: [[2, 103 %]]").need(Engines).each[0]
    for case in engine.misfires[:3]:
        found = solved(state=f"misfire: {case.cylinder}" if case.cylinder else "")
        there = int(np.argmin(np.abs(case.speed - SPEED)))
        own = found.need(Synthesis).half_range[at_speed(found)]
        np.testing.assert_allclose(case.half_range[there], own, rtol=1e-11)


def test_the_sums_of_phasors_with_the_first_shape_are_those_of_the_vector() -> None:
    found = solved()
    engine = found.need(Engines).each[0]
    shape = ORACLES["phasor_sums"]["in-line 6, 1-5-3-6-2-4"]["shape (mode 1 of the train below)"]
    sums = [one.by_mode[0] * max(shape) for one in engine.harmonics[:12]]
    np.testing.assert_allclose(
        sums, ORACLES["phasor_sums"]["in-line 6, 1-5-3-6-2-4"]["orders .5..6 by .5"], atol=2e-6
    )
    # Of every shape the sum over the cylinders, their firing angles written out.
    fires = 2.0 * math.pi * np.array([(1, 5, 3, 6, 2, 4).index(k) for k in range(1, 7)]) / 6.0
    names = [station.name for station in found.system.stations]
    throws = [names.index(cylinder.station) for cylinder in engine.cylinders]
    for k, angle in enumerate(found.need(Modes).shape[throws, :3].T):
        weight = np.abs(angle) / np.abs(angle).max() * np.sign(angle)
        for one in engine.harmonics[:12]:
            turned = np.exp(-1j * float(2 * one.order) * fires)
            assert one.by_mode[k] == pytest.approx(abs(turned @ weight), rel=1e-11, abs=1e-13)
    rigid = [one.rigid for one in engine.harmonics]
    np.testing.assert_allclose(
        rigid, [6.0 if one.order % 3 == 0 else 0.0 for one in engine.harmonics], atol=4e-15
    )


def test_balance_of_mean_torque_and_mean_pressure() -> None:
    engine = solved(state="mechanical_efficiency: 90 %", rated="rated").need(Engines).each[0]
    swept = math.pi / 4 * 0.105**2 * 0.137
    assert engine.mean_torque == pytest.approx(
        2039.07372 * 1010 / 2000, rel=1e-9
    )  # at the highest speed
    assert engine.imep == pytest.approx(
        engine.mean_torque / 0.9 / 6 * 4 * math.pi / swept, rel=1e-12
    )
    assert engine.stated == pytest.approx(18e5, rel=1e-9)


V = """
name: two cylinders
operation: {speeds: {from: 900 rpm, to: 1000 rpm, steps: 2}}
train:
  - engine: {name: e, cylinders: Z, strokes: 4, inertia: 0.1, FIRING,
             gas: {table: [[0.5, 7 N*m, 0 deg], [1, 10 N*m, 20 deg], [1.5, 4 N*m, 0 deg]]}}
  - coupling: {stiffness: 1e5, loss_factor: 0.1}
  - disc: {inertia: 5}
analyses: {response: }
"""


def v_engine(cylinders: int, firing: str) -> dict[Fraction, np.ndarray]:
    response = torsion.run(
        torsion.parse(V.replace("Z", str(cylinders)).replace("FIRING", firing))
    ).need(Response)
    return {line.order: response.torque[0, k] for k, line in enumerate(response.lines)}


def test_two_cylinders_of_a_throw_a_revolution_apart_double_whole_orders_and_cancel_half_ones() -> (
    None
):
    one, two = (
        v_engine(1, "firing_order: [1]"),
        v_engine(2, "firing_angles: [0 deg, 360 deg], throws: [[1, 2]]"),
    )
    np.testing.assert_allclose(two[Fraction(1)], 2 * one[Fraction(1)], rtol=1e-13)
    np.testing.assert_allclose(
        two[Fraction(1, 2)], 0.0, atol=1e-13 * np.abs(one[Fraction(1, 2)]).max()
    )


def test_a_bank_angle_adds_as_its_cosine() -> None:
    one, two = (
        v_engine(1, "firing_order: [1]"),
        v_engine(2, "firing_angles: [0 deg, 90 deg], throws: [[1, 2]]"),
    )
    for order, torque in two.items():
        factor = 1 + cmath.exp(-1j * math.radians(90.0) * float(order))
        np.testing.assert_allclose(torque, factor * one[order], rtol=1e-12)


def test_a_phase_turns_the_whole_engine() -> None:
    plain, turned = (
        v_engine(1, "firing_order: [1]"),
        v_engine(1, "firing_order: [1], phase: 40 deg"),
    )
    for order, torque in turned.items():
        np.testing.assert_allclose(
            torque, cmath.exp(-1j * math.radians(40.0) * float(order)) * plain[order], rtol=1e-12
        )


def test_reversed_the_train_meets_the_last_throw_first() -> None:
    text = SCENE.replace("GAS", CYCLE).replace("STATE", "reverse: true")
    names = [
        part.name
        for part in torsion.parse(text).train.parts
        if part.name.startswith("main engine ")
    ]
    assert names[:3] == [
        "main engine cylinder 6",
        "main engine crank 5-6",
        "main engine cylinder 5",
    ]


def test_crank_inertia_takes_the_mean_of_its_masses() -> None:
    known = ORACLES["rod"]
    masses = (
        f"{{piston: {known['piston']}, rod: {{mass: {known['rod_mass']}, centre: {known['cg_from_big_end']}, "
        f"inertia: {known['I_cg']}}}}}"
    )
    found = torsion.parse(
        f"name: x\ntrain:\n- engine: {{cylinders: 1, strokes: 4, firing_order: [1], crank_inertia: 0.035, "
        f"geometry: {{bore: 105 mm, stroke: 137 mm, rod_length: 207 mm}}, masses: {masses}}}\nanalyses: {{modes: }}\n"
    )
    whole = sum(lump.inertia for lump in found.train.inertias)
    assert whole == pytest.approx(0.035 + known["mean_equivalent_inertia"], rel=1e-12)
    assert whole == pytest.approx(0.0467, rel=3e-3)  # printed


def test_a_diagram_of_a_file_gives_back_the_harmonics_of_its_cycle(tmp_path: Path) -> None:
    curve = solved().need(Engines).each[0].curves[0]
    text = "angle [deg], pressure [bar]\n" + "".join(
        f"{math.degrees(a) + 360.0!r}, {p / 1e5!r}\n"
        for a, p in zip(curve.angle.tolist(), curve.pressure.tolist(), strict=True)
    )
    (tmp_path / "p.csv").write_text(text.replace("np.float64", ""), encoding="utf-8")
    gas = "diagram: p.csv, tdc: 360 deg, absolute: true, crankcase: 0, imep: 18 bar"
    (tmp_path / "scene.yaml").write_text(
        SCENE.replace("GAS", gas).replace("STATE", ""), encoding="utf-8"
    )
    measured = torsion.run(torsion.read(tmp_path / "scene.yaml")).need(Engines).each[0]
    computed = solved().need(Engines).each[0]
    assert measured.curves[0].imep == pytest.approx(18e5, rel=2e-3)  # a degree between the points
    largest = max(abs(one.gas) for one in computed.harmonics)
    for one, other in zip(measured.harmonics, computed.harmonics, strict=True):
        assert abs(one.gas - other.gas) < 5e-3 * largest


def test_names_of_throws_may_be_excited() -> None:
    text = V.replace("Z", "1").replace("FIRING", "firing_order: [1]")
    text += "excitations: [{at: e cylinder 1, order: 2, torque: 5 N*m}]\n"
    assert Fraction(2) in {
        line.order for line in torsion.run(torsion.parse(text)).need(Response).lines
    }


def test_results_say_the_engine_in_json() -> None:
    from torsion.output.stored.results_json import results

    found = json.loads(
        json.dumps(results(solved())["engines"], default=lambda value: value.tolist())
    )
    assert found[0]["harmonics"][0]["order"] == "1/2"
    assert [case["cylinder"] for case in found[0]["misfires"]] == list(range(7))


def test_a_scene_with_an_engine_is_valid_against_the_schema() -> None:
    validator = pytest.importorskip("jsonschema").Draft202012Validator(json_schema())
    data = parse_source(
        SCENE.replace("GAS", CYCLE).replace("STATE", "misfire: [1, 2]"), "x.yaml"
    ).data
    assert [error.message for error in validator.iter_errors(data)] == []


RUN_UP = """
name: run-up
operation: {at: wheel, speeds: {from: 600 rpm, to: 900 rpm, steps: 2}, rated: {speed: 600 rpm}}
train:
  - TRAIN
  - coupling: {name: shaft, stiffness: 1e4, viscous: 4}
  - disc: {name: wheel, held: true}
EXTRA
analyses:
  transient:
    {duration: 0.6 s, samples: 400, initial: steady,
     events: [{at: wheel, speed: {program: [[0 s, 600 rpm], [0.6 s, 900 rpm]]}}]}
"""


def test_a_run_up_with_an_engine_is_that_with_its_torques_written_out() -> None:
    from torsion.analyses.motion.transient_motion import Transients

    rows = "[[0.5, 7 N*m, 0 deg], [1, 10 N*m, 20 deg], [3, 4 N*m, -50 deg]]"
    engine = f"engine: {{name: e, cylinders: 1, strokes: 4, inertia: 0.1, gas: {{table: {rows}}}}}"
    plain = "excitations:\n" + "".join(
        f"- {{at: d, order: {order}, torque: {size}, phase: {phase} deg}}\n"
        for order, size, phase in ((0.5, 7, 0), (1, 10, 20), (3, 4, -50))
    )
    own, other = (
        torsion.run(torsion.parse(RUN_UP.replace("TRAIN", train).replace("EXTRA", extra)))
        .need(Transients)
        .each[0]
        for train, extra in ((engine, ""), ("disc: {name: d, inertia: 0.1}", plain))
    )
    np.testing.assert_allclose(own.torque, other.torque, atol=1e-7 * np.abs(other.torque).max())


def test_the_estimate_of_parametric_resonance_is_that_of_the_undamped_equation_to_first_order() -> (
    None
):
    """J_0 (1 + e cos 2 angle): growth e/4 of the frequency, a range of e/2 of it; the vector's are exact.

    The range lies about twice the frequency over the harmonic, to first order in e.
    """
    words = ORACLES["varying_inertia"]["result"].split()
    share, growth = abs(float(words[1])), float(words[-1])
    first, last = (float(word.strip("[],")) for word in words[4:6])
    assert share / 4 == pytest.approx(growth, rel=0.02)

    mean = 3.0
    train = (
        f"train: [disc: {{inertia: {mean}}}, coupling: {{stiffness: 5e4}}, disc: {{held: true}}]"
    )
    findings = torsion.run(torsion.parse(f"name: x\n{train}\n"), only=("modes",))
    work = Work(findings.study, dict(findings.results))
    (mode,) = varying_inertia(work, [(0, mean * np.array([0.0, -share]))])
    assert (mode.mode, mode.harmonic, mode.share) == (1, 2, pytest.approx(share, rel=1e-12))
    frequency = math.sqrt(5e4 / mean)
    assert (mode.upper - mode.lower) / frequency == pytest.approx(last - first, rel=0.02)
    assert (mode.upper + mode.lower) / 2 / frequency == pytest.approx(
        (first + last) / 2, abs=share**2
    )
    assert not mode.is_stable
    assert replace(mode, damping=growth * 1.02).is_stable
    assert not replace(mode, damping=growth * 0.98 / 1.02).is_stable


def test_the_six_lowest_modes_have_the_shares_of_their_shapes_in_a_varying_inertia() -> None:
    """Eight equal discs: w = 2 sqrt(k/J) sin(r pi/16), and 2/(8 J) cos2(r pi/16) on the first."""
    line = ", coupling: {stiffness: 9e4}, ".join(["disc: {inertia: 3}"] * 8)
    text = f"name: x\ntrain: [{line}]\nanalyses: {{modes: {{count: 7}}}}\n"
    findings = torsion.run(torsion.parse(text), only=("modes",))
    work = Work(findings.study, dict(findings.results))
    rows = list(varying_inertia(work, [(0, np.array([0.02j, 0.06 + 0.08j]))]))
    turn = math.pi / 16.0 * np.arange(1, 7)
    share = 0.1 * 2.0 / (8.0 * 3.0) * np.cos(turn) ** 2
    middle = 2.0 * math.sqrt(9e4 / 3.0) * np.sin(turn)  # twice the frequency over harmonic 2
    assert [(row.mode, row.harmonic) for row in rows] == [(mode, 2) for mode in range(1, 7)]
    assert [row.share for row in rows] == pytest.approx(share.tolist(), rel=1e-12)
    ends = [(row.lower, row.upper) for row in rows]
    expected = np.transpose([middle * (1.0 - share / 4.0), middle * (1.0 + share / 4.0)])
    np.testing.assert_allclose(ends, expected, rtol=1e-12)


TWIN = """
name: two engines
operation: {speeds: {from: 900 rpm, to: 1000 rpm, steps: 3}}
train:
  - engine: {name: one, cylinders: 1, strokes: 4, inertia: 0.1, gas: {table: ROWS}}
  - coupling: {stiffness: 1e5, loss_factor: 0.1}
  - disc: {inertia: 5}
  - coupling: {stiffness: 2e5, loss_factor: 0.1}
  - engine: {name: two, cylinders: 1, strokes: 4, inertia: 0.2, PHASE gas: {table: ROWS}}
analyses: {response: }
""".replace("ROWS", "[[0.5, 7 N*m, 0 deg], [1, 10 N*m, 20 deg], [1.5, 4 N*m, 0 deg]]")


def twins(phase: str) -> Findings:
    return torsion.run(torsion.parse(TWIN.replace("PHASE", f"phase: {phase},")))


def test_the_worst_phase_of_two_engines_is_above_every_phase_and_met_by_single_orders() -> None:
    worst = twins("worst")
    each = [twins(f"{degrees} deg") for degrees in range(0, 720, 30)]
    bound = np.abs(worst.need(Response).torque)
    found = np.array([np.abs(one.need(Response).torque) for one in each])
    assert np.all(found <= bound * (1 + 1e-12))
    np.testing.assert_allclose(
        found.max(axis=0), bound, rtol=0.04
    )  # a phase of each order within 15 degrees
    half = np.array([one.need(Synthesis).half_range for one in each]).max(axis=0)
    assert np.all(half <= worst.need(Synthesis).half_range)
    assert worst.need(Synthesis).turns == 0


TWO_STROKE = """
name: low-speed ship
operation: {at: engine, speeds: {from: 40 rpm, to: 110 rpm, steps: 8}, rated: {speed: 105 rpm, power: 9000 kW}}
train:
  - engine:
      name: engine
      cylinders: 6
      strokes: 2
      firing_order: [1, 5, 3, 4, 2, 6]
      crank_inertia: 9000
      stiffness: 900 MN*m/rad
      loss_factor: 1 %
      geometry: {bore: 500 mm, stroke: 2 m, rod_length: 2.05 m}
      masses: {piston: 2000 kg, rod: {mass: 1500 kg, centre: 0.8 m, inertia: 900}}
      gas: {cycle: wiebe, compression_ratio: 17, charge: 3.4 bar, imep: 19 bar, p_max: 160 bar, duration: 70 deg,
            exhaust_opens: 112 deg, scavenge_opens: 138 deg}
      STATE
  - shaft: {length: 6 m, diameter: 400 mm}
  - shaft: {length: 6 m, diameter: 450 mm}
  - propeller: {inertia: 30000, entrained: 25 %, blades: 4, damping: {model: archer, factor: 30}}
analyses: {response: }
"""


def test_a_two_stroke_engine_has_whole_orders_up_to_fifteen_and_majors_at_its_number_of_cylinders() -> (
    None
):
    found = torsion.run(torsion.parse(TWO_STROKE.replace("STATE", "")))
    engine = found.need(Engines).each[0]
    assert [one.order for one in engine.harmonics] == list(range(1, 16))
    assert [int(one.order) for one in engine.harmonics if one.rigid > 1] == [6, 12]
    swept = math.pi / 4 * 0.5**2 * 2.0
    assert engine.imep == pytest.approx(
        9e6 / (105 * math.pi / 30) / 6 * 2 * math.pi / swept, rel=1e-12
    )
    assert len(engine.misfires) == 7


def test_a_misfire_changes_no_torque_of_the_masses() -> None:
    plain, out = (torsion.parse(TWO_STROKE.replace("STATE", state)) for state in ("", "cut_out: 4"))
    speed = np.array([11.0])
    for one, other in zip(plain.train.torques, out.train.torques, strict=True):
        if other.cylinder.state == "cut out":
            wanted = other.cylinder.turned * other.cylinder.inertia * speed**2
            np.testing.assert_allclose(other.cylinder.amplitude(speed, None), wanted, rtol=1e-15)
        else:
            np.testing.assert_allclose(
                other.cylinder.amplitude(speed, None), one.cylinder.amplitude(speed, None)
            )


def test_tables_over_the_load_are_interpolated_and_not_left() -> None:
    rows = "{imep: IMEP bar, rows: [[3, SIZE N*m, 0 deg]]}"
    low, high = (
        rows.replace("IMEP", str(at)).replace("SIZE", str(size))
        for at, size in ((4, 100), (20, 500))
    )
    text = SCENE.replace("STATE", "").replace(
        "load: [[1000 rpm, 0 N*m], [3000 rpm, 2039.07372 N*m]]",
        "load: [[1000 rpm, LOW N*m], [3000 rpm, 1000 N*m]]",
    )
    swept = 6 * math.pi / 4 * 0.105**2 * 0.137 / (4 * math.pi)  # mean torque of the engine / imep
    found = torsion.parse(
        text.replace("LOW", str(12e5 * swept * 2 - 1000)).replace("GAS", f"tables: [{low}, {high}]")
    )
    torque = next(one for one in found.train.torques if one.order == 3).cylinder
    mean = np.array([12e5 * swept / 6])
    gas = replace(torque, inertia=0.0, turned=1.0).amplitude(np.array([SPEED]), mean)
    assert gas[0] == pytest.approx(300.0, rel=1e-12)
    with pytest.raises(torsion.InputError, match=r"cover 4 to 20 `bar` imep, the operation needs"):
        torsion.parse(text.replace("LOW", "-990").replace("GAS", f"tables: [{low}, {high}]"))
    unknown = text.replace("  load: [[1000 rpm, LOW N*m], [3000 rpm, 1000 N*m]]\n", "")
    found = torsion.parse(unknown.replace("GAS", f"tables: [{low}, {high}]"))
    torque = next(one for one in found.train.torques if one.order == 3).cylinder
    gas = replace(torque, inertia=0.0, turned=1.0).amplitude(np.array([SPEED]), None)
    assert gas[0] == 500.0  # of the highest load, where none is known


def test_a_phase_that_is_any_is_not_for_motion_over_time() -> None:
    text = TWIN.replace("PHASE", "phase: worst,").replace(
        "{response: }", "{transient: {duration: 1 s, events: []}}"
    )
    with pytest.raises(
        torsion.InputError, match=r"`phase: worst` adds magnitudes, and a motion over time"
    ):
        torsion.parse(text)


def test_a_phase_that_is_any_is_not_for_couplings_with_backlash() -> None:
    text = TWIN.replace("PHASE", "phase: worst,")
    text = text.replace("1e5, loss_factor: 0.1", "1e5, viscous: 3, clearance: 0.1 deg")
    words = "`phase: worst` adds magnitudes, and backlash, friction, stages or a clutch does not"
    with pytest.raises(torsion.InputError, match=words) as caught:
        torsion.parse(text)
    assert caught.value.faults[0].path[-1] == "phase"


def test_the_first_page_names_the_cylinder_that_misfires() -> None:
    from torsion.output.chapters.verdict import box

    assert ("Engine state", "main engine with cylinder 2 motored (misfire)") in box(
        solved(state="misfire: 2")
    ).lines
    assert "Engine state" not in dict(box(solved()).lines)


RATED = "{stiffness: 1.976e6, loss_factor: 0.035, vibratory_torque: 5 kN*m, max_torque: 7 kN*m}"


def test_the_worst_misfire_is_the_worst_of_every_check_with_its_cylinder() -> None:
    changed = {
        "{stiffness: 1.976e6, loss_factor: 0.035}": RATED,
        "response: }": "response: }\nrules: [coupling-maker]",
    }
    worst = solved(state="misfire: worst", **changed)
    single = [solved(state=f"misfire: {number}", **changed) for number in range(1, 7)]
    *checks, firing = worst.need(Checks).lines
    assert firing.clause == "normal firing"
    for check in checks:
        values = [
            next(one.value for one in found.need(Checks).lines if one.what == check.what)
            for found in single
        ]
        assert check.value == pytest.approx(max(values), rel=1e-12)
        assert check.note.startswith(
            f"cylinder {values.index(max(values)) + 1} of main engine motored"
        )
    vibratory = next(one for one in worst.need(Checks).lines if one.clause == "T_KW")
    assert vibratory.note.startswith("cylinder 3 ")
    assert worst.failed


def test_the_worst_misfire_of_a_case_is_that_of_the_file() -> None:
    """And checks of one rule that differ in their clause alone stay two."""
    changed = {
        "response: }": "response: }\nrules: [kr: {duty: generator set}]\nROOM",
        "  load: [[1000 rpm, 0 N*m], [3000 rpm, 2039.07372 N*m]]": "  rated: {speed: 2000 rpm, power: 250 kW}",
        "from: 1990 rpm": "from: 1700 rpm",
    }
    journal = "journal: {diameter: 90 mm}"
    alone = solved(state=f"{journal}\n      misfire: worst", **changed, ROOM="")
    cases = solved(
        state=journal, **changed, ROOM="cases: {out: {set: {main engine.misfire: worst}}}"
    ).cases["out"]
    found = [check for check in alone.need(Checks).lines if check.clause != "normal firing"]
    # As tuples: from Python 3.13 on data with a NaN are not equal to themselves.
    assert [*map(astuple, cases.need(Checks).lines)] == [*map(astuple, found)]
    assert {check.clause for check in found if check.where == "main engine crank 1-2"} >= {
        "tau_1",
        "tau_2",
    }


def test_no_barred_range_and_no_missing_answer_of_a_case_is_dropped() -> None:
    found = solved()
    lost = Unanswered("lateral", "bending", "it does not converge", "", None, False, False, "")
    bands = [BarredRange(20.0 + n, 30.0, 24.0, "crank", 21.0, 29.0, Fraction(2)) for n in range(2)]
    line = Check(
        "rule",
        "clause",
        "crank",
        "stress",
        60.0,
        50.0,
        "N/mm2",
        "fail",
        "setting",
        30.0,
        Fraction(2),
    )
    first = found.having(checks=Checks((replace(line, barred=(bands[0],)),)))
    second = found.having(
        checks=Checks((replace(line, value=40.0, verdict="pass", barred=(bands[1],)),))
    )
    whole = _select_worst(
        {"one": first, "two": replace(second, plan=replace(second.plan, unanswered=(lost,)))}
    )
    (check,) = whole.need(Checks).lines
    assert (check.verdict, check.note) == ("fail", "one")
    assert [*map(astuple, check.barred)] == [astuple(bands[0])]  # united: 20 to 30
    assert whole.plan.unanswered == (lost,)
    assert (lost.what, lost.words) in whole.plan.left_out


def test_no_order_of_a_table_is_lost_but_those_above_the_orders_that_are_named() -> None:
    table = "table: [[3, 5 N*m, 0 deg], [18.5, 2 N*m, 0 deg]]"
    for state, wanted in (("", {3, Fraction(37, 2)}), ("orders: 12", {3})):
        text = (
            SCENE.replace("GAS", table).replace("STATE", state).replace("masses:", "note: none #")
        )
        assert {one.order for one in torsion.parse(text).train.torques} == wanted
