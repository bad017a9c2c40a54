"""Couplings with dry friction in the steady vibration: harmonic balance, and the exact motion at its peaks."""

import math

import numpy as np
import pytest

import torsion
from torsion.errors import SolveError
from torsion.kernels.describing_functions import slider

DISC = """name: x
operation: {{speeds: {{from: 112 rad/s, to: 118 rad/s, steps: 3}}}}
train:
- disc: {{name: d, inertia: 1}}
- coupling: {{name: dry, stiffness: 1e4, viscous: 2, hysteresis_torque: {}}}
- disc: {{held: true}}
excitations: [{{at: d, order: 1, torque: {}}}]
analyses: {{response: }}
"""


def response(text: str):
    return torsion.run(torsion.parse(text), only=["response"]).results["response"]


def test_the_stiffness_of_a_slider_stores_and_loses_what_its_loop_does() -> None:
    found = slider(np.array([1e-3, 5e-5]), 5.0, 5e4)
    assert found[0] == pytest.approx(2602.200966545695 + 5729.57795130823j, rel=1e-14)
    assert math.pi * found[0].imag * 1e-3**2 == pytest.approx(0.018, rel=1e-13)  # 4 T (A - T/k)
    assert found[1] == 5e4  # it sticks


@pytest.mark.parametrize(
    ("speed", "known"),
    [(112.0, 0.00727644754527494), (115.0, 0.007313591888527168), (118.0, 0.006830346421666001)],
)
def test_a_disc_beside_a_slider_vibrates_as_harmonic_balance_knows(
    speed: float, known: float
) -> None:
    found = response(DISC.format("{torque: 20, stiffness: 4e3}", 10))
    at = int(np.argmin(np.abs(found.speed - speed)))
    assert abs(found.angle[at, 0, 0]) == pytest.approx(known, rel=1e-12)


def test_two_sliders_of_one_kind_are_one() -> None:
    both = "[{torque: 12, stiffness: 2.4e3}, {torque: 8, stiffness: 1.6e3}]"
    one, two = (response(DISC.format(dry, 10)) for dry in ("{torque: 20, stiffness: 4e3}", both))
    assert two.angle[:, 0, 0] == pytest.approx(one.angle[:, 0, 0], rel=1e-11)


def test_friction_in_two_couplings_satisfies_both_balances() -> None:
    dry = "hysteresis_torque: {torque: %g, stiffness: 4e3}"
    text = f"""name: x
operation: {{speeds: {{from: 60 rad/s, to: 140 rad/s, steps: 9}}}}
train:
- disc: {{name: d, inertia: 1}}
- coupling: {{stiffness: 1e4, viscous: 2, {dry % 20}}}
- disc: {{inertia: 0.5}}
- coupling: {{stiffness: 2e4, viscous: 2, {dry % 9}}}
- disc: {{held: true}}
excitations: [{{at: d, order: 1, torque: 12}}]
analyses: {{response: }}
"""
    found = response(text)
    w = found.speed
    twist = np.stack([found.angle[:, 0, 0] - found.angle[:, 0, 1], found.angle[:, 0, 1]], axis=1)
    for span, (stiffness, torque) in enumerate([(1e4, 20.0), (2e4, 9.0)]):
        own = stiffness + 2j * w + slider(np.abs(twist[:, span]), torque, 4e3)
        assert found.torque[:, 0, span] == pytest.approx(own * twist[:, span], rel=1e-9)


TRUCK = """name: x
operation: {speeds: {from: %g rpm, to: %g rpm, steps: %d}}
excitations: [{at: engine, order: 2, torque: 147.8}]
analyses: {response: }
"""


@pytest.mark.parametrize(
    ("ratio", "rpm", "friction", "known"),
    [
        (
            1.95,
            1760,
            2.851,
            (33.37120721577358, 182.31372456824647, 101.62826077878826, 104.19037910751648),
        ),
        (
            1.95,
            1760,
            7.139,
            (28.653779114452647, 30.582874273221034, 17.04799970141764, 17.477791495239916),
        ),
        (
            1.0,
            1400,
            2.851,
            (44.28255265971678, 90.01979569793674, 101.35873990391335, 97.55033948650248),
        ),
        (
            1.0,
            1400,
            7.139,
            (38.91009934820659, 59.78217971748681, 67.3123767710643, 64.78321664106606),
        ),
    ],
)
def test_the_truck_by_harmonic_balance(
    ratio: float, rpm: float, friction: float, known: tuple[float, ...]
) -> None:
    from tests.analyses.motion.train.test_nonlinear_couplings import truck

    text = truck(ratio, friction) + (TRUCK % (rpm, rpm + 10, 2)).removeprefix("name: x\n")
    study = torsion.parse(text)
    found = torsion.run(study, only=["response"]).results["response"]
    names = [station.name for station in study.train.stations]
    for name, amplitude in zip(("engine", "hub", "output", "pinion"), known, strict=True):
        speed = abs(found.angle[0, 0, names.index(name)]) * 2.0 * found.speed[0] * 30.0 / math.pi
        assert speed == pytest.approx(amplitude, rel=1e-9)


def test_the_peak_of_the_truck_in_third_gear() -> None:
    from tests.analyses.motion.train.test_nonlinear_couplings import truck

    text = truck(1.95, 2.851) + (TRUCK % (1500, 2000, 101)).removeprefix("name: x\n")
    study = torsion.parse(text)
    found = torsion.run(study, only=["response"]).results["response"]
    own = [station.name for station in study.train.stations].index("output")
    amplitude = np.abs(found.angle[:, 0, own]) * 2.0 * found.speed * 30.0 / math.pi
    best = int(amplitude.argmax())
    assert found.speed[best] * 30.0 / math.pi == pytest.approx(1746.227000635657, rel=2e-4)
    assert amplitude[best] == pytest.approx(103.77195218725255, rel=5e-6)


def test_friction_in_a_loop_is_refused() -> None:
    text = DISC.format("20", 10).replace(
        "excitations",
        "links: [{between: [d, held], coupling: {stiffness: 1e3, hysteresis_torque: 5}}]\nexcitations",
    )
    with pytest.raises(SolveError, match="closes a loop"):
        torsion.run(torsion.parse(text.replace("held: true", "name: held, held: true")))


def test_the_exact_motion_stands_beside_the_response_at_its_peak() -> None:
    from tests.analyses.motion.train.test_nonlinear_couplings import truck

    findings = torsion.run(torsion.parse(DISC.format("{torque: 20, stiffness: 4e3}", 10)))
    disc, *_ = findings.results["nonlinear_peaks"].each
    assert (disc.coupling, disc.component) == ("dry", "1 × d")
    assert disc.difference == pytest.approx(disc.response / disc.exact - 1.0)
    assert abs(disc.difference) < 4e-3  # one term of many is enough at a resonance
    text = truck(1.95, 7.139) + (TRUCK % (1900, 2000, 11)).removeprefix("name: x\n")
    clutch, *_ = torsion.run(torsion.parse(text)).results["nonlinear_peaks"].each
    assert clutch.speed == pytest.approx(2000.0 * math.pi / 30.0)
    assert clutch.exact == pytest.approx(
        9.995606016475547, rel=1e-4
    )  # DOP853 at 1e-6 over 250 periods
    assert clutch.difference > 0.3  # it slips nearly all the time


@pytest.mark.parametrize(("ripple", "parts"), [("20 %", False), ("400 %", True)])
def test_a_play_is_closed_in_the_response_as_long_as_the_mean_torque_keeps_it_so(
    ripple: str, parts: bool
) -> None:
    text = f"""name: x
operation: {{speeds: {{from: 900 rpm, to: 1100 rpm}}, rated: {{speed: 1000 rpm, power: 20 kW}}, load: constant}}
train:
- motor: {{inertia: 1, ripple: [{{order: 2, torque: {ripple}}}]}}
- coupling: {{name: teeth, stiffness: 4e4, clearance: {{angle: 0.3 deg, viscous: 30}}}}
- disc: {{inertia: 0.5}}
- coupling: {{stiffness: 9e3, viscous: 20}}
- propeller: {{inertia: 2}}
analyses: {{response: }}
"""
    teeth, *_ = torsion.run(torsion.parse(text)).results["nonlinear_peaks"].each
    if parts:
        assert abs(teeth.difference) > 0.01
    else:
        assert teeth.response == pytest.approx(teeth.exact, rel=1e-11)
