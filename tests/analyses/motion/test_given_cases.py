"""Motion over time against closed forms and high-precision references, from the file to the peaks."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import torsion
from torsion.analyses.motion.events.events import Point
from torsion.analyses.motion.events.transient_settings import TransientSettings
from torsion.analyses.motion.motion_from_events import transient
from torsion.analyses.motion.transient_motion import TransientMotion
from torsion.assembly import assemble
from torsion.assembly.matrices import matrices
from torsion.errors import SolveError
from torsion.kernels.motion.loaded_modes import value


def moved(
    parts: str, body: dict, operation: str = "", ratio: float | None = None
) -> TransientMotion:
    """The motion of a train; `ratio` damps every mode alike."""
    study = torsion.parse(f"name: x\n{operation}train: [{parts}]\n")
    settings = TransientSettings.model_validate(body)
    return transient(study, assemble(study.train, model="lumped"), settings, damping_ratio=ratio)


def chain(inertia: list[float], stiffness: list[float], more: str = "") -> str:
    """Discs d1, d2, ... and couplings."""
    rows = [f"disc: {{name: d{k + 1}, inertia: {one!r}}}" for k, one in enumerate(inertia)]
    links = [
        f"coupling: {{name: s{k + 1}, stiffness: {one!r}{more}}}" for k, one in enumerate(stiffness)
    ]
    return ", ".join(row for pair in zip(rows, [*links, ""], strict=True) for row in pair if row)


def test_a_step_on_two_discs_with_a_viscous_spring() -> None:
    events = [{"at": "d1", "step": {"torque": 100.0}}]
    found = moved(
        chain([2.0, 3.0], [1e4], ", viscous: 5"),
        {"duration": 0.1, "initial": "rest", "events": events},
    )
    assert found.torque[0, -1] == pytest.approx(106.88964847969848, rel=1e-13)
    assert found.greatest[0] == pytest.approx(115.90597139664635, rel=1e-13)
    assert found.greatest_at[0] == pytest.approx(0.03392321515283623, rel=1e-7)
    assert found.residual < 1e-14


@pytest.mark.parametrize(
    ("length", "peak"),
    [
        (0.2, 0.770492375595188),
        (0.4, 1.3734088638886552),
        (0.81, 1.768457648783741),
        (1.2, 1.6488439597248326),
        (2.1, 1.227208818524607),
        (4.0, 1.1254945748710947),
    ],
)
def test_a_half_sine_shock(length: float, peak: float) -> None:
    events = [{"at": "d1", "pulse": {"torque": 2.0, "length": length}}]
    body = {"duration": length + 3.0, "initial": "rest", "events": events}
    assert moved(chain([2.0, 2.0], [4.0 * math.pi**2]), body).peak[0] == pytest.approx(
        peak, rel=1e-14
    )


def test_a_two_phase_short_circuit_of_a_generator() -> None:
    fault = {
        "coefficients": {"line": 8, "double": 4, "mean": 0.3},
        "decay": (0.2, 0.03),
        "sense": "drives",
    }
    body = {
        "duration": 1.0,
        "initial": {"speed": "3000 rpm"},
        "events": [{"at": "d2", "short-circuit": fault}],
    }
    operation = "operation: {rated: {speed: 3000 rpm, power: 20 MW}}\n"
    found = moved(chain([1800.0, 900.0, 250.0], [4e7, 6e6]), body, operation, 0.01)
    assert found.peak == pytest.approx([1427113.2471373763, 219564.8157750222], rel=1e-14)
    times = np.where(found.greatest > -found.least, found.greatest_at, found.least_at)
    assert times == pytest.approx([0.06455946354852823, 0.06453774961405975], rel=1e-7)
    at = int(np.argmin(np.abs(found.time - 0.1)))
    assert found.time[at] == pytest.approx(0.1, rel=1e-14)
    assert found.torque[:, at] == pytest.approx([-715882.4582240593, 110356.86618303378], rel=1e-13)


def test_ice_of_case_1_on_four_blades() -> None:
    parts = chain([30.0, 6.0, 4.0], [2e5, 8e6]) + (
        ", coupling: {name: s3, stiffness: 3e6}, propeller: {name: screw, inertia: 40, blades: 4}"
    )
    ice = [{"at": "screw", "ice": {"torque": 150e3, "case": 1}}]
    body = {"duration": 5.0, "initial": {"speed": "120 rpm"}, "events": ice, "samples": 50_000}
    found = moved(parts, body, ratio=0.02)
    assert found.peak == pytest.approx(
        [135444.7123371846, 134226.0259274523, 132990.3304500799], rel=2e-5
    )  # of a grid of 1e-4 s
    known = [13157.548152833731, 12070.14274798833, 11249.361147034186]
    assert found.torque[:, 10_000] == pytest.approx(known, rel=1e-9)


VISCOUS = ", viscous: 40"
AWKWARD = {
    "a chain": chain([1.0, 0.2, 3.0], [2e4, 3e4], VISCOUS),
    "a rigid coupling beside the torque": "disc: {name: d1, inertia: 1}, coupling: {flexibility: 0}, "
    "disc: {name: d2, inertia: 0.2}, coupling: {stiffness: 3e4, viscous: 40}, disc: {inertia: 3}",
    "a gear between viscous couplings": "disc: {name: d1, inertia: 1}, coupling: {stiffness: 3e4, viscous: 40}, "
    "gear: {teeth: [20, 41], inertia: [0.2, 0.5]}, coupling: {stiffness: 3e4, viscous: 40}, disc: {inertia: 3}",
    "a point without inertia": "disc: {inertia: 1}, coupling: {stiffness: 2e4}, disc: {name: d1, inertia: 0}, "
    "coupling: {stiffness: 3e4}, disc: {inertia: 3}, coupling: {stiffness: 2e4, viscous: 200}, disc: {inertia: 1}, "
    "coupling: {flexibility: 0}, disc: {inertia: 1, damping: 4}",
    "a damper with a ring": chain([1.0, 1.0], [3e4], VISCOUS)
    + ", coupling: {stiffness: 1e4, viscous: 40}, "
    "damper: {housing: 1, ring: 2, damping: 50}",
    "a fixed end and a ring": "disc: {held: true}, coupling: {stiffness: 3e4, viscous: 40}, "
    "disc: {name: d1, inertia: 1}, coupling: {stiffness: 1e4}, damper: {housing: 1, ring: 2, damping: 50}",
    "rings alone": "disc: {name: d1, inertia: 1}, damper: {housing: 1, ring: 2, damping: 500}",
}


@pytest.mark.parametrize("parts", AWKWARD.values(), ids=AWKWARD)
def test_after_the_decay_a_sine_is_the_response(parts: str) -> None:
    events = [{"at": "d1", "sine": {"torque": 7.0, "frequency": 30.0, "phase": "90 deg"}}]
    study = torsion.parse(
        f"name: x\ntrain: [{parts}]\nexcitations: [{{at: d1, torque: 7}}]\n"
        "analyses: {response: {frequencies: {from: 30, to: 31, steps: 2}}}\n"
    )
    body = {"duration": 30.0, "initial": "rest", "events": events}
    found = transient(
        study, assemble(study.train, model="lumped"), TransientSettings.model_validate(body)
    )
    steady = torsion.run(study).results["frequency_response"]
    late = found.time > 28.0
    exact = (steady.torque[0][:, None] * np.exp(2j * math.pi * 30.0 * found.time[late])).real
    assert np.abs(found.torque[:, late] - exact).max() <= 1e-9 * np.abs(exact).max()
    assert found.residual < 1e-11


@pytest.mark.parametrize("damping", ["viscous", "modal"])
def test_after_the_decay_a_sine_in_a_closed_loop_is_the_response(damping: str) -> None:
    more, top = (", viscous: 40", "") if damping == "viscous" else ("", "damping: {modal: 3 %}\n")
    study = torsion.parse(
        f"name: x\n{top}train: [{chain([1.0, 0.5, 2.0, 1.0], [2e4, 3e4, 1e4], more)}]\n"
        f"links: [{{between: [d1, d3], coupling: {{stiffness: 1e4{more}}}}}]\nexcitations: [{{at: d1, torque: 7}}]\n"
        "analyses: {response: {frequencies: {from: 30, to: 31, steps: 2}}}\n"
    )
    events = [{"at": "d1", "sine": {"torque": 7.0, "frequency": 30.0, "phase": "90 deg"}}]
    settings = TransientSettings.model_validate(
        {"duration": 10.0, "initial": "rest", "events": events}
    )
    found = transient(study, assemble(study.train, model="lumped"), settings)
    steady = torsion.run(study).results["frequency_response"]
    late = found.time > 9.5
    exact = (steady.torque[0][:, None] * np.exp(2j * math.pi * 30.0 * found.time[late])).real
    assert np.abs(found.torque[:, late] - exact).max() <= 1e-9 * np.abs(exact).max()


def test_a_steady_train_without_an_event_stays_as_it_is() -> None:
    text = """
name: x
operation: {speeds: {from: 500 rpm, to: 1500 rpm}, rated: {speed: 1200 rpm, power: 20 kW}}
train:
- motor: {inertia: 1, ripple: [{frequency: 40 Hz, torque: 5 %}]}
- coupling: {stiffness: 2e4, viscous: 10}
- gear: {teeth: [20, 41], inertia: [0.1, 0.3]}
- coupling: {stiffness: 4e4, loss_factor: 0.02}
- propeller: {inertia: 2}
"""
    study = torsion.parse(text)
    events = [{"at": "motor-1", "step": {"torque": 0.0}}]
    settings = TransientSettings.model_validate({"duration": 0.2, "events": events})
    found = transient(study, assemble(study.train, model="lumped"), settings)
    speed = 1200.0 * math.pi / 30.0
    known = torsion.response(study, assemble(study.train, model="lumped"), speeds=np.array([speed]))
    row = int(np.flatnonzero(known.speed == speed)[0])
    wave = np.exp(2j * math.pi * known.frequency[row, 0] * found.time)
    exact = known.mean[row][:, None] + (known.torque[row, 0][:, None] * wave).real
    assert found.torque == pytest.approx(exact, rel=1e-13)
    assert found.peak == pytest.approx(known.mean[row] + np.abs(known.torque[row, 0]), rel=1e-12)
    assert found.speed[0] == pytest.approx(np.full(len(found.time), speed), rel=1e-14)


def test_a_twist_that_is_released_swings_between_plus_and_minus() -> None:
    found = moved(chain([2.0, 3.0], [1e4]), {"duration": 1.0, "initial": {"torque": {"s1": 50.0}}})
    w = math.sqrt(1e4 / 1.2)
    assert found.torque[0] == pytest.approx(50.0 * np.cos(w * found.time), abs=1e-11)
    assert (found.greatest[0], found.least[0]) == pytest.approx((50.0, -50.0), rel=1e-14)


def test_a_motor_that_trips_leaves_the_train_to_its_load() -> None:
    text = """
name: x
operation: {rated: {speed: 1200 rpm, power: 20 kW}}
train: [motor: {inertia: 1}, coupling: {stiffness: 2e4, viscous: 100}, propeller: {inertia: 2}]
"""
    study = torsion.parse(text)
    settings = TransientSettings.model_validate(
        {"duration": 3.0, "events": [{"at": "motor-1", "stop": {}}]}
    )
    found = transient(study, assemble(study.train, model="lumped"), settings)
    load = 20e3 / (1200.0 * math.pi / 30.0)
    assert found.before[0] == pytest.approx(load, rel=1e-14)
    assert found.torque[0, -1] == pytest.approx(load / 3.0, rel=1e-9)  # it slows the motor
    assert found.speed[0, -1] == pytest.approx(1200.0 * math.pi / 30.0 - load * 3.0 / 3.0, rel=1e-4)


def test_a_torque_on_a_rigid_pair_is_shared_at_once_by_its_inertias() -> None:
    parts = "disc: {name: d1, inertia: 1}, coupling: {flexibility: 0}, disc: {inertia: 3}, coupling: {stiffness: 1e4}, "
    events = [{"at": "d1", "time": 0.0103, "step": {"torque": 8.0}}]
    body = {"duration": 0.0103 + 1e-6, "initial": "rest", "events": events, "samples": 103}
    found = moved(parts + "disc: {inertia: 4}", body)
    assert found.greatest[0] == pytest.approx(6.0, rel=1e-8)
    assert found.greatest_at[0] == pytest.approx(0.0103, rel=1e-3)


def test_viscous_damping_at_a_point_without_inertia_is_refused() -> None:
    parts = "disc: {name: d1, inertia: 1}, coupling: {stiffness: 1e4, viscous: 5}, disc: {name: hub, inertia: 0}, "
    body = {"duration": 1.0, "initial": "rest", "events": [{"at": "d1", "step": {"torque": 1.0}}]}
    with pytest.raises(SolveError, match="at 'hub', a point without inertia"):
        moved(parts + "coupling: {stiffness: 1e4}, disc: {inertia: 2}", body)


def test_samples_that_need_too_much_memory_are_refused() -> None:
    study = replace(torsion.parse(f"name: x\ntrain: [{chain([2.0, 3.0], [1e4])}]\n"), memory=1e6)
    body = {
        "duration": 1.0,
        "initial": "rest",
        "samples": 100_000,
        "events": [{"at": "d1", "step": {"torque": 1.0}}],
    }
    with pytest.raises(SolveError, match=r"all samples need 0\.004 GB of memory"):
        transient(
            study, assemble(study.train, model="lumped"), TransientSettings.model_validate(body)
        )


def test_a_branched_train_with_a_reversing_gear_moves_as_an_independent_solver_says() -> None:
    parts = (
        "disc: {name: d1, inertia: 1, damping: 2}, coupling: {stiffness: 2e4, viscous: 15}, gear: {name: g, "
        "teeth: [20, 41], inertia: [0.2, 0.5], branches: [{teeth: 30, inertia: 0.1, train: [coupling: {stiffness: 8e3, "
        "viscous: 5}, disc: {name: d2, inertia: 0.7}]}]}, coupling: {stiffness: 4e4, viscous: 30}, "
        "disc: {name: d3, inertia: 2}"
    )
    events = [
        {
            "at": "d2",
            "time": 0.01,
            "table": {"rows": [["0 s", 0.0], ["0.02 s", 50.0], ["0.07 s", -20.0]]},
        },
        {
            "at": "d3",
            "time": 0.03,
            "sine": {"torque": -40.0, "frequency": 25.0, "decay": 0.05, "phase": "30 deg"},
        },
        {"at": "d1", "pulse": {"torque": 30.0, "length": 0.013}},
    ]
    study = torsion.parse(f"name: x\ntrain: [{parts}]\n")
    system = assemble(study.train, model="lumped")
    settings = TransientSettings.model_validate(
        {"duration": 0.1, "initial": "rest", "events": events, "samples": 200}
    )
    found, view = transient(study, system, settings), matrices(system)
    pieces = [event.pieces(Point()) for event in settings.events]
    rows = view.basis[[study.train[event.at].stations[0] for event in settings.events]]
    n = len(view.inertia)

    def rate(t: float, x: np.ndarray) -> np.ndarray:
        acting = rows.T @ [value(one, np.array([t]))[0] for one in pieces]
        gained = np.linalg.solve(
            view.inertia, acting - view.stiffness @ x[:n] - view.damping @ x[n:]
        )
        return np.concatenate([x[n:], gained])

    cuts, x, known = [0.0, 0.01, 0.013, 0.03, 0.08, 0.1], np.zeros(2 * n), []
    for begin, end in pairwise(cuts):
        at = found.time[(found.time > begin + 1e-12) & (found.time < end + 1e-12)]
        run = solve_ivp(
            rate, (begin, max(end, at[-1])), x, "DOP853", t_eval=at, rtol=1e-12, atol=1e-13
        )
        known.append(run.y)
        x = run.y[:, -1]
    y = np.concatenate(known, axis=1)
    twist, turning = (
        system.twist(view.basis / system.speed_ratio[:, None]) @ half for half in (y[:n], y[n:])
    )
    soft = np.flatnonzero(system.flexibility > 0)
    exact = (
        twist[soft] / system.flexibility[soft, None] + system.viscous[soft, None] * turning[soft]
    )
    assert np.abs(found.torque[soft, 1:] - exact).max() <= 1e-9 * np.abs(exact).max()
    assert np.abs(found.speed[:, 1:] - view.basis @ y[n:]).max() <= 1e-9 * np.abs(y[n:]).max()
