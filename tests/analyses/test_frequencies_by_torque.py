"""Stiffness over mean torque: frequencies, critical speeds and response against closed forms and plain couplings."""

import math

import numpy as np
import pytest

import torsion
from torsion.analyses.critical import CriticalSpeeds
from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed
from torsion.analyses.response.component_loads import harmonic_heat
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.study import Study

RPM = math.pi / 30.0
T, K = (0.0, 2500.0, 5000.0, 7500.0, 10000.0), (40e3, 60e3, 90e3, 130e3, 180e3)
POINTS = "at: [0 N*m, 2.5 kN*m, 5e3, 7500, 10 kN*m], stiffness: [40e3, 60e3, 90e3, 130e3, 180e3]"
TRAIN = """name: test
train:
  - motor: {{name: a, inertia: 10}}
  - coupling: {{name: c, {coupling}}}
  - propeller: {{name: b, inertia: 40}}
operation:
  speeds: {{from: 100 rpm, to: 1000 rpm}}
  rated: {{speed: 1000 rpm, power: {power} W}}
excitations: [{{at: a, order: 1, torque: 100}}, {{at: a, order: 3/2, torque: 50}}, {{at: b, order: 2, torque: 9}}]
"""


def study(coupling: str = f"table: {{over: mean torque, {POINTS}}}", more: str = "") -> Study:
    return torsion.parse(TRAIN.format(coupling=coupling, power=repr(10e3 * 1000.0 * RPM)) + more)


def stiffness(rpm: float) -> float:
    return float(np.interp(10e3 * (rpm / 1000.0) ** 2, T, K))


def test_frequency_is_that_of_the_stiffness_at_each_speed() -> None:
    found = torsion.run(study()).need(FrequenciesOverSpeed)
    expected = [math.sqrt(stiffness(n / RPM) / 8.0) / (2.0 * math.pi) for n in found.speed]
    assert found.frequency[0] == pytest.approx(expected, rel=1e-13)
    published = {
        300: 12.224923143825823,
        500: 13.783222385544802,
        700: 16.76801373471191,
        900: 21.204073957918418,
    }
    for rpm, hertz in published.items():
        assert found.at(rpm * RPM)[0] == pytest.approx(hertz, rel=1e-14)


def test_critical_speeds_are_the_roots_within_the_range_and_may_be_none() -> None:
    """8 (2 pi o n/60)^2 = a + b T with T = n^2/100: in n^2 linear on each piece; order 1 has none."""
    found = torsion.run(study()).need(CriticalSpeeds).crossings
    (second, above) = [
        math.sqrt(a / (8.0 * (order * RPM) ** 2 - b / 100.0))
        for order, a, b in ((2.0, 40e3, 8.0), (1.5, 30e3, 12.0))
    ]
    assert [float(one.order) for one in found] == [2.0, 1.5]
    assert [one.speed / RPM for one in found] == pytest.approx([second, above], rel=1e-12)
    assert (second, above) == pytest.approx((384.2466140615, 622.6046291047), rel=1e-12)


def test_an_order_that_meets_a_curve_three_times_has_three_critical_speeds() -> None:
    """The stiffness doubles between 6.4 and 6.6 kN m, from 800 to 812 rpm."""
    steep = "table: {over: mean torque, at: [0, 6400, 6600, 10e3], stiffness: [90e3, 90e3, 180e3, 180e3]}"
    found = [
        one
        for one in torsion.run(study(steep)).need(CriticalSpeeds).crossings
        if float(one.order) == 1.5
    ]
    low, high = (math.sqrt(k / 8.0) / (1.5 * RPM) for k in (90e3, 180e3))
    through = math.sqrt((90e3 - 450.0 * 6400.0) / (8.0 * (1.5 * RPM) ** 2 - 4.5))
    assert low < 800.0 < through < 812.5 < high < 1000.0
    assert [one.speed / RPM for one in found] == pytest.approx([low, through, high], rel=1e-11)


def test_an_order_that_passes_a_curve_between_two_speeds_of_the_grid_has_both_critical_speeds() -> (
    None
):
    """It meets the flat part 1 rpm below the corner at 800 rpm, where the curve begins to rise beyond it at once."""
    flat = 8.0 * (1.5 * RPM * 799.0) ** 2
    steep = f"table: {{over: mean torque, at: [0, 6400, 6600, 10e3], stiffness: [{flat!r}, {flat!r}, 180e3, 180e3]}}"
    found = [
        one.speed / RPM
        for one in torsion.run(study(steep)).need(CriticalSpeeds).crossings
        if float(one.order) == 1.5
    ]
    rise = (180e3 - flat) / 200.0
    through = math.sqrt((6400.0 * rise - flat) / (rise / 100.0 - 8.0 * (1.5 * RPM) ** 2))
    high = math.sqrt(180e3 / 8.0) / (1.5 * RPM)
    assert 800.0 < through < 801.0
    assert found == pytest.approx([799.0, through, high], rel=1e-11)


def test_response_has_a_point_where_an_order_meets_a_mode_that_only_high_torque_lifts_above_it() -> (
    None
):
    """Three discs on equal couplings: w2 = sqrt(3 k/J) is met at 637 rpm, w1 = sqrt(k/J) by nothing at 1000 rpm."""
    soft = 10.0 * (2.0 * 637.0 * RPM) ** 2 / 3.0
    law = f"at: [0, 6e3, 7e3, 10e3], stiffness: [{soft!r}, {soft!r}, 600e3, 600e3]"
    coupling = f"  - coupling: {{table: {{over: mean torque, {law}, loss_factor: [0.1, 0.1, 0.1, 0.1]}}}}\n"
    discs = ("motor: {name: a", "disc: {name: b", "propeller: {name: c")
    train = coupling.join(f"  - {disc}, inertia: 10}}\n" for disc in discs)
    speeds = f"{{from: 100 rpm, to: 1000 rpm, steps: 10}}, rated: {{speed: 1000 rpm, power: {10e3 * 1000.0 * RPM!r}}}"
    text = f"name: t\ntrain:\n{train}operation: {{speeds: {speeds}}}\nexcitations: [{{at: a, order: 2, torque: 9}}]\n"
    found = torsion.run(torsion.parse(text + "analyses: {modes: {count: 1}, response: }\n"))
    speed = found.results["response"].speed / RPM
    assert abs(speed / 637.0 - 1.0).min() < 1e-11


def test_response_of_each_speed_has_the_stiffness_of_its_mean_torque() -> None:
    table = f"table: {{over: mean torque, {POINTS}, loss_factor: [0.1, 0.1, 0.1, 0.1, 0.1]}}"
    given, speeds = study(table), np.array([300.0, 450.0, 700.0, 1000.0]) * RPM
    found = torsion.response(given, assemble(given.train), speeds=speeds)
    for speed in speeds:
        plain = study(f"stiffness: {stiffness(speed / RPM)!r}, loss_factor: 0.1")
        other = torsion.response(plain, assemble(plain.train), speeds=np.array([speed]))
        k, n = int(np.argmin(abs(found.speed - speed))), int(np.argmin(abs(other.speed - speed)))
        assert (
            np.abs(found.torque[k] - other.torque[n]).max() <= 1e-12 * np.abs(other.torque[n]).max()
        )
        spans = np.array([0])
        assert harmonic_heat(found, found.system, spans).sum(axis=1)[k] == pytest.approx(
            harmonic_heat(other, other.system, spans).sum(axis=1)[n], rel=1e-11
        )


def test_modes_are_those_of_the_rated_speed() -> None:
    rated = torsion.run(study()).results["modes"].frequency
    assert rated == pytest.approx([math.sqrt(180e3 / 8.0) / (2.0 * math.pi)], rel=1e-14)


def test_mean_torque_is_needed_and_must_be_covered() -> None:
    text = TRAIN.format(coupling=f"table: {{over: mean torque, {POINTS}}}", power=1.0).replace(
        ", power: 1.0 W", ""
    )
    with pytest.raises(InputError, match="a stiffness over mean torque needs the mean torque"):
        torsion.parse(text)
    with pytest.raises(InputError, match="covers 0 to 100 N m; 10000 N m is needed") as caught:
        study("table: {over: mean torque, at: [0, 100], stiffness: [1e4, 2e4]}")
    assert caught.value.faults[0].line == 4
