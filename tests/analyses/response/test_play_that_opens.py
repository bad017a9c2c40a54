"""A play under a mean torque in the steady vibration: closed, opening, jumping; against shooting for the cycle."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import torsion
from torsion.errors import SolveError
from torsion.rules.class_rules.supplements import surplus

STIFFNESS, HALF, DAMPING = 1e4, 0.01, 4.0
TEXT = """name: x
operation: {{speeds: {{from: {first} rad/s, to: {last} rad/s, steps: {steps}}}, {load}}}
train:
- disc: {{name: m, inertia: 1, damping: 4}}
- coupling: {{unusual: true, name: teeth, stiffness: 1e4, {play}}}
- disc: {{unusual: true, name: p, inertia: 1e13}}
excitations: [{{at: m, order: 1, torque: {torque}}}]
analyses: {{response: }}
"""
PLAY = "clearance: 0.02 rad"


@cache
def run(
    torque: float,
    mean: float = 20.0,
    play: str = PLAY,
    speeds: tuple[float, float, int] = (60, 110, 51),
    only: tuple[str, ...] = ("response",),
):
    load = f"rated: {{speed: 100 rad/s, power: {100.0 * mean} W}}, load: constant" if mean else ""
    first, last, steps = speeds
    text = TEXT.format(first=first, last=last, steps=steps, load=load, torque=torque, play=play)
    return torsion.run(torsion.parse(text.replace(", }", "}")), only=only)


def carried(u):
    return STIFFNESS * (u - np.minimum(np.maximum(u, -HALF), HALF))


def cycle(w: float, mean: float, torque: float, start: tuple[float, float]) -> tuple[float, float]:
    """Amplitude of the fundamental of the torque and its half range, of the periodic motion near a state at time 0."""
    period = 2.0 * math.pi / w

    def rate(time, z):
        twist, speed = z.reshape(2, -1)  # of all starts
        drive = mean + torque * math.cos(w * time)
        return np.concatenate([speed, drive - carried(twist) - DAMPING * speed])

    def moved(state, times=None):
        return solve_ivp(
            rate,
            (0.0, period),
            state,
            method="DOP853",
            rtol=1e-10,
            atol=1e-12,
            max_step=period / 60,
            t_eval=times,
        )

    state, small = np.array(start), 1e-7
    for _ in range(4):  # the first of the transient, so that Newton's method begins near the cycle
        state = moved(state).y[:, -1]
    for _ in range(12):
        starts = state[:, None] + small * np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        ends = moved(starts.ravel()).y[:, -1].reshape(2, 3)
        end, slope = ends[:, 0], (ends[:, 1:] - ends[:, [0]]) / small
        step = np.linalg.solve(slope - np.eye(2), end - state)
        state = state - step
        if np.abs(step).max() < 1e-8:
            break
    else:
        raise AssertionError("no periodic motion was found")
    time = (np.arange(1024) + 0.5) * period / 1024
    force = carried(moved(state, time).y[0])
    return 2.0 * abs(np.mean(force * np.exp(-1j * w * time))), (force.max() - force.min()) / 2.0


def state_of(response, at: int, amplitude: float, mean: float) -> tuple[float, float]:
    """Twist and its rate at time 0 of a solution of harmonic balance with this amplitude, from its own mean."""
    from torsion.kernels.describing_functions import PiecewiseCoupling

    w, coupling = response.speed[at], PiecewiseCoupling(STIFFNESS, HALF)
    one = coupling.secant(np.array([amplitude]), np.array([mean]))
    u = 2.0 / (STIFFNESS * one.share[0] - w**2 + 1j * DAMPING * w)
    assert abs(u) == pytest.approx(amplitude, rel=1e-8)  # it is a solution
    return coupling.bias(np.array([amplitude]), np.array([mean]))[0] + u.real, (1j * w * u).real


def test_below_the_mean_torque_the_play_changes_no_digit() -> None:
    closed, plain, linear = (
        run(0.3, play=play, speeds=(60, 110, 6)).results["response"]
        for play in (PLAY, "clearance: 2 rad", "tolerance: 0 %")
    )
    assert np.abs(linear.torque).max() < 20.0
    for one in (closed, plain):
        assert np.array_equal(one.torque, linear.torque)
        assert np.array_equal(one.angle, linear.angle)
        assert (one.balanced.number == 1).all()


def test_a_play_that_vanishes_is_none() -> None:
    found = run(2.0, mean=0.0, play="clearance: 1e-12 rad").results["response"]
    k = int(np.argmin(np.abs(found.speed - 80.0)))
    linear = 2.0 / (STIFFNESS - found.speed[k] ** 2 + 1j * DAMPING * found.speed[k])
    assert found.angle[k, 0, 0] == pytest.approx(linear, rel=1e-7)


@pytest.mark.parametrize("speed", [75.0, 80.0, 90.0])
def test_the_opened_resonance_bends_down_and_has_two_motions(speed: float) -> None:
    found = run(2.0)
    response, balanced = found.results["response"], found.results["response"].balanced
    at = int(np.argmin(np.abs(response.speed - speed)))
    assert balanced.number[at, 0] == 3
    assert balanced.share[at, 0] < 0.8
    linear = 2.0 / abs(STIFFNESS - speed**2 + 1j * DAMPING * speed)
    assert balanced.smallest[at, 0] == pytest.approx(
        linear, rel=1e-12
    )  # the closed play is a solution too
    upper = cycle(speed, 20.0, 2.0, state_of(response, at, float(balanced.amplitude[at, 0]), 20.0))
    lower = cycle(speed, 20.0, 2.0, state_of(response, at, float(balanced.smallest[at, 0]), 20.0))
    assert lower[0] == pytest.approx(STIFFNESS * linear, rel=1e-6)
    assert abs(response.torque[at, 0, 0]) == pytest.approx(upper[0], rel=0.07)
    assert upper[0] > 2.0 * lower[0]


def test_the_jump_lies_below_the_natural_frequency_and_the_peak_beside_it() -> None:
    found = run(2.0)
    response, balanced = found.results["response"], found.results["response"].balanced
    several = response.speed[balanced.number[:, 0] > 1]
    assert several.max() < 100.0
    assert f"several solutions from {several.min() * 30 / math.pi:.5g}" in response.remark
    left = int(np.flatnonzero(response.speed == several.max())[0])
    assert response.speed[left + 1] - response.speed[left] < 3e-3  # narrowed
    assert np.abs(response.torque[:, 0, 0]).max() > 1.5 * 20.0


def test_the_exact_motion_beside_it_is_that_of_shooting() -> None:
    found = run(2.0, speeds=(72, 110, 39), only=())
    response, balanced = found.results["response"], found.results["response"].balanced
    each = found.results["nonlinear_peaks"].each
    assert len(each) == 4
    for one in each:
        at = int(np.argmin(np.abs(response.speed - one.speed)))
        start = state_of(response, at, float(balanced.amplitude[at, 0]), 20.0)
        fundamental, half_range = cycle(one.speed, 20.0, 2.0, start)
        assert one.exact == pytest.approx(fundamental, rel=2e-3)
        assert one.half_range == pytest.approx(half_range, rel=2e-3)
        assert abs(one.difference) < 0.07
        if one.solutions > 1:
            assert one.from_rest == pytest.approx(STIFFNESS * balanced.smallest[at, 0], rel=1e-3)
        share = balanced.share[at, 0]
        assert (one.mode, one.natural_frequency) == (
            1,
            pytest.approx(math.sqrt(1e4 * share) / (2.0 * math.pi), rel=1e-9),
        )
    assert each[0].opens_from == each[0].several_from == 72.0
    factor = surplus(found)[0][:, 0]
    for one in each:
        at = int(np.argmin(np.abs(response.speed - one.speed)))
        own = max(one.half_range / abs(response.torque[at, 0, 0]), 1.0)
        assert factor[at] == pytest.approx(own if own > 1.001 else 1.0, rel=1e-12)
    assert (factor[balanced.share[:, 0] == 1.0] == 1.0).all()
    between = (response.speed > 72.0) & (response.speed < sorted(one.speed for one in each)[1])
    assert factor[between].min() >= factor[response.speed == 72.0][0]


def test_without_mean_torque_the_play_floats_or_hammers() -> None:
    found = run(2.0, mean=0.0, speeds=(30, 110, 17), only=())
    response, balanced = found.results["response"], found.results["response"].balanced
    at = int(np.argmin(np.abs(response.speed - 35.0)))
    assert balanced.number[at, 0] == 3
    floating = 2.0 / abs(-(response.speed[at] ** 2) + 1j * DAMPING * response.speed[at])
    assert balanced.smallest[at, 0] == pytest.approx(floating, rel=1e-9)
    assert balanced.amplitude[at, 0] > HALF
    (one, *_) = found.results["nonlinear_peaks"].each
    assert one.opens_from == 30.0


def test_further_stages_stiffen_and_bend_the_resonance_up() -> None:
    stages = "stages: [{from: 0.004 rad, stiffness: 1e4}]"
    found = run(4.0, mean=0.0, play=stages, speeds=(90, 150, 16), only=())
    response, balanced = found.results["response"], found.results["response"].balanced
    several = response.speed[balanced.number[:, 0] > 1]
    assert several.size
    assert several.min() > 100.0
    upper = int(np.flatnonzero(response.speed == several.min())[0])
    assert balanced.extra[upper, 0].real > 1e3
    for one in found.results["nonlinear_peaks"].each:
        assert one.exact is not None
        assert abs(one.difference) < 0.1 or one.response > one.exact


TWO = """name: x
operation: {speeds: {from: 60 rad/s, to: 120 rad/s, steps: 13}, rated: {speed: 100 rad/s, power: 500 W}, load: constant}
train:
- motor: {name: m, inertia: 1}
- coupling: {name: dry, stiffness: 1e4, viscous: 3, hysteresis_torque: {torque: 4, stiffness: 5e3}}
- disc: {name: d, inertia: 0.5}
- coupling: {name: teeth, stiffness: 3e4, clearance: {angle: 0.01 rad, viscous: 6}}
- propeller: {name: p, inertia: 0.8}
excitations: [{at: m, order: 1, torque: 9}, {at: m, order: 2, torque: 1}]
analyses: {response: }
"""


def test_friction_and_play_satisfy_both_balances_at_every_speed() -> None:
    from torsion.kernels.describing_functions import PiecewiseCoupling, Slider

    below = TWO.replace("to: 120 rad/s, steps: 13", "to: 62 rad/s, steps: 2")
    response = torsion.run(torsion.parse(below), only=["response"]).results["response"]
    balanced, w = response.balanced, response.speed[:, None] * [1.0, 2.0]
    assert balanced.settled.all()
    assert (balanced.share[:, 1] < 1.0).any()
    twist = response.angle[:, :, :-1] - response.angle[:, :, 1:]
    couplings = PiecewiseCoupling(1e4, sliders=(Slider(4.0, 5e3),)), PiecewiseCoupling(3e4, 0.005)
    for k, (coupling, damping) in enumerate(zip(couplings, (3.0, 6.0), strict=True)):
        amplitude = np.abs(twist[:, :, k]).max(axis=1)
        one = coupling.secant(amplitude, np.full(len(amplitude), 5.0))
        stiffness = (
            one.share[:, None] * (coupling.stiffness + 1j * w * damping) + one.extra[:, None]
        )
        assert response.torque[:, :, k] == pytest.approx(stiffness * twist[:, :, k], rel=1e-6)
        assert balanced.amplitude[:, k] == pytest.approx(amplitude, rel=1e-7)


@pytest.mark.parametrize(("torque", "opens"), [(0.5, False), (5.0, True)])
def test_a_train_damped_by_mode_keeps_its_play_closed_or_has_no_response(
    torque: float, opens: bool
) -> None:
    text = TWO.replace(", viscous: 3, hysteresis_torque: {torque: 4, stiffness: 5e3}", "").replace(
        ", viscous: 6", ""
    )
    text = text.replace("torque: 9}", f"torque: {torque}}}") + "damping: {modal: 5 %}\n"
    if not opens:
        text = text.replace(", {at: m, order: 2, torque: 1}", "")
        found = torsion.run(torsion.parse(text), only=["response"]).results["response"]
        assert (found.balanced.share == 1.0).all()
        return
    with pytest.raises(SolveError, match="damped by mode") as refused:
        torsion.run(torsion.parse(text, "x.yaml"))
    words = "'teeth' is in a train that is damped by mode, and its backlash or stages in the response are not supported yet"
    assert refused.value.located.startswith(
        f"x.yaml:7:13: {words} (give the damping of the components)\n    - coupling:"
    )


def test_over_frequency_a_play_opens_too() -> None:
    text = TWO.replace("order: 1, torque: 9}, {at: m, order: 2, torque: 1}", "torque: 9}")
    text = text.replace(
        "{response: }", "{response: {frequencies: {from: 12 Hz, to: 12.4 Hz, steps: 2}}}"
    )
    found, linear = (
        torsion.run(torsion.parse(one)).results["frequency_response"]
        for one in (text, text.replace("power: 500 W", "power: 100 kW"))
    )
    both = [one.torque[np.searchsorted(one.frequency, 12.0), 1] for one in (found, linear)]
    assert abs(both[0]) > 5.0
    assert both[0] != pytest.approx(both[1], rel=0.01)


@pytest.mark.parametrize(("power", "closed"), [("500 W", True), ("1 W", False)])
def test_a_play_that_closes_a_loop_stays_closed_or_there_is_no_response(
    power: str, closed: bool
) -> None:
    text = TWO.replace(", hysteresis_torque: {torque: 4, stiffness: 5e3}", "").replace(
        "500 W", power
    )
    text = text.replace(", clearance: {angle: 0.01 rad, viscous: 6}", "").replace(
        "torque: 9}", "torque: 0.1}"
    )
    text = text.replace(", {at: m, order: 2, torque: 1}", "")
    loop = (
        "links: [{between: [d, p], coupling: {name: loop, stiffness: 1e4, clearance: 0.01 rad}}]\n"
    )
    if closed:
        found = torsion.run(torsion.parse(text + loop), only=["response"]).results["response"]
        assert (found.balanced.share == 1.0).all()
        return
    with pytest.raises(SolveError, match="closes a loop") as refused:
        torsion.run(torsion.parse(text + loop))
    assert refused.value.path == ("links", 0, "coupling")
