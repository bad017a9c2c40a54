"""Forced response of whole trains against dense solutions and closed forms; grid, status and refusals."""

import math
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.damped_modes import damped
from torsion.analyses.response import grid
from torsion.analyses.response.harmonic_components import amplitude, excitations, sources
from torsion.analyses.response.over_frequency import frequency_response
from torsion.analyses.response.over_speed import ResponseSettings, response
from torsion.analyses.response.solver import Answer, answer, by_magnitude, ground_damping
from torsion.analyses.steady import steady_if_known
from torsion.analyses.undamped_modes import modes
from torsion.errors import InputError
from torsion.kernels.trees.tree_response import Status
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.machine import Motor, Propeller
from torsion.model.machine_torques import Excitation
from torsion.train import Link

RATED = (100.0, 50e3)  # rad/s, W: 500 N m


@pytest.mark.parametrize("seed", range(8))
def test_random_trains_agree_with_a_dense_solution_in_own_angles(
    build, dense, random_train, operation, seed
):
    random = np.random.default_rng(seed)
    line = random_train(random, 5)
    excite = [
        Excitation(
            at=f"disc-{k}",
            order=order,
            torque=float(random.uniform(1, 50)),
            phase=f"{random.uniform(0, 360)} deg",
        )
        for k, order in ((1, "1"), (2, "3/2"), (3, "2"))
    ]
    _, system = build(line, excitations=excite, operation=operation(10.0, 60.0, 4))
    speed = np.array([10.0, 23.0, 37.0, 60.0])
    ground = ground_damping(system, speed, None)
    for one in excitations(system):
        w = float(one.line.order) * speed
        found = answer(system, w, sources(system, one, speed, None), ground)
        force = np.zeros(len(system.stations), dtype=complex)
        for torque in one.torques:
            force[torque.station] += torque.torque * np.exp(1j * torque.phase)
        for k in range(len(speed)):
            angle, torque = dense(system, w[k], force, ground[:, k])
            assert found.angle[k] == pytest.approx(angle, rel=1e-9, abs=1e-11 * abs(angle).max())
            assert found.torque[k] == pytest.approx(torque, rel=1e-9, abs=1e-9 * abs(torque).max())
        assert found.residual.max() < 1e-13
        assert (found.status == Status.OK).all()


def test_train_with_a_closed_loop_agrees_with_a_dense_solution(build, dense):
    line = [
        Disc(name="a", inertia=1.0, damping=2.0),
        Coupling(stiffness=100.0, viscous=3.0),
        Disc(inertia=2.0),
        Coupling(stiffness=300.0),
        Disc(name="b", inertia=0.5),
    ]
    links = [Link(("a", "b"), Coupling(stiffness=60.0, loss_factor=0.1))]
    _, system = build(line, links=links, excitations=[Excitation(at="b", order=1, torque=7.0)])
    speed = np.array([3.0, 9.0, 31.0])
    ground = ground_damping(system, speed, None)
    found = answer(system, speed, sources(system, excitations(system)[0], speed, None), ground)
    for k, w in enumerate(speed):
        angle, torque = dense(system, w, np.array([0.0, 0.0, 7.0]), ground[:, k])
        assert found.angle[k] == pytest.approx(angle, rel=1e-12)
        assert found.torque[k] == pytest.approx(torque, rel=1e-12)


def test_parallel_damper_and_spring_between_the_same_points_add_up(build):
    line = [Disc(name="a", held=True), Coupling(stiffness=100.0), Disc(name="b", inertia=2.0)]
    study, system = build(
        line,
        links=[Link(("a", "b"), Coupling(stiffness=50.0, viscous=4.0))],
        excitations=[Excitation(at="b", torque=1.0)],
    )
    found = frequency_response(study, system, frequencies=np.array([0.5, 1.0]))
    w = 2 * math.pi * found.frequency
    exact = 1.0 / (150.0 + 4j * w - 2.0 * w**2)
    assert found.angle[:, 1] == pytest.approx(exact, rel=1e-13)


def test_viscous_span_holds_the_share_of_its_damper(build):
    """k 100, c 20, w 10: the elastic part alone would be 55 % low."""
    study, system = build(
        [Disc(inertia=2.0), Coupling(stiffness=100.0, viscous=20.0), Disc(inertia=3.0)],
        excitations=[Excitation(at="disc-1", torque=1.0)],
    )
    found = frequency_response(study, system, frequencies=np.array([10.0 / (2 * math.pi)]))
    stiffness = 100.0 + 200.0j
    reduced = 2.0 * 3.0 / 5.0
    torque = stiffness * (reduced / 2.0) / (stiffness - reduced * 100.0)
    assert found.torque[0, 0] == pytest.approx(torque, rel=1e-13)
    assert abs(found.torque[0, 0]) == pytest.approx(
        math.sqrt(5.0) * 100.0 * abs(found.angle[0, 0] - found.angle[0, 1]), rel=1e-12
    )


def test_two_discs_under_opposed_torques_at_5_rad_s(build):
    """Benchmark B15b."""
    excite = [
        Excitation(at="disc-1", torque=1.0),
        Excitation(at="disc-2", torque=1.0, phase="180 deg"),
    ]
    study, system = build(
        [Disc(inertia=2.0), Coupling(stiffness=120.0), Disc(inertia=3.0)], excitations=excite
    )
    found = frequency_response(study, system, frequencies=np.array([5.0 / (2 * math.pi)]))
    assert found.angle[0] == pytest.approx([1 / 150, -1 / 225], rel=1e-14)
    assert found.torque[0] == pytest.approx([4 / 3], rel=1e-14)
    assert found.sources == ("disc-1", "disc-2")


def test_contributions_of_one_order_from_two_shafts_meet_in_one_line_as_phasors(build, operation):
    """Order 5/2 behind a gear of 5/2 is order 1 of the motor; opposed and referred, the two cancel."""
    line = [
        Disc(inertia=1.0),
        Gear(teeth=(20, 50)),
        Disc(name="wheel", inertia=1.0),
        Coupling(stiffness=1e3),
        Disc(inertia=2.0),
    ]
    excite = [
        Excitation(at="disc-1", order=1, torque=10.0, phase="0 deg"),
        Excitation(at="wheel", order="5/2", torque=25.0, phase="180 deg"),
    ]
    study, system = build(line, excitations=excite, operation=operation(10.0, 12.0, 3))
    found = response(study, system)
    assert [line.order for line in found.lines] == [Fraction(1)]
    assert found.lines[0].sources == ("disc-1", "wheel")
    assert abs(found.angle).max() < 1e-15


def test_share_of_the_mean_torque_follows_the_load_and_archer_damping_its_torque_over_speed(
    build, operation
):
    propeller = Propeller(
        inertia=1.0,
        blades=4,
        excitation=[{"blade_order": 1, "torque": "6 %"}],
        damping={"model": "archer", "factor": 30},
    )
    study, system = build(
        [Motor(held=True), Coupling(stiffness=1e5), propeller],
        operation=operation(50.0, 100.0, 2, rated=RATED),
    )
    found = response(study, system, speeds=np.array([50.0, 100.0]))
    for speed, mean in ((50.0, 125.0), (100.0, 500.0)):
        at = int(np.flatnonzero(found.speed == speed)[0])
        w, damping = 4.0 * speed, 30.0 * mean / (speed * 30.0 / math.pi)
        assert found.angle[at, 0, 1] == pytest.approx(
            0.06 * mean / (1e5 - w * w + 1j * w * damping), rel=1e-13
        )
        assert found.mean[at, 0] == pytest.approx(mean, rel=1e-15)


@pytest.mark.parametrize(("ratio", "mean"), [("1/2", 250.0), ("2", 1000.0)])
def test_share_of_mean_where_none_is_applied_is_of_the_largest_in_its_spans(
    build, operation, ratio, mean
):
    line = [
        Motor(inertia=1.0),
        Gear(ratio=ratio),
        Disc(name="mid", inertia=2.0),
        Coupling(stiffness=1e6),
        Propeller(inertia=1.0),
    ]
    excite = [Excitation(at="mid", order=1, torque={"of_mean": "10 %"})]
    study, system = build(
        line, excitations=excite, operation=operation(99.0, 100.0, 2, rated=RATED)
    )
    one, speed = excitations(system)[0], np.array([100.0])
    found = amplitude(system, one.torques[0], speed, steady_if_known(study, system, speed))
    assert found == pytest.approx([0.1 * mean], rel=1e-14)


def test_ring_without_damping_and_stiffness_takes_no_part(build):
    alone = [Disc(held=True), Coupling(stiffness=100.0), Disc(name="b", inertia=2.0)]
    ringed = [*alone[:2], RingDamper(name="b", housing=2.0, ring=1.0, damping=0.0)]
    excite = [Excitation(at="b", torque=1.0)]
    given = {"frequencies": np.array([1.0, 2.0])}
    plain = frequency_response(*build(alone, excitations=excite), **given)
    found = frequency_response(*build(ringed, excitations=excite), **given)
    rows = np.isin(found.frequency, plain.frequency[plain.requested])
    assert found.angle[rows][:, :2] == pytest.approx(plain.angle[plain.requested], rel=1e-14)
    assert not found.angle[:, 2].any()


def test_first_order_damping_ratios_are_those_of_the_damped_modes(build):
    """Ground, viscous and hysteretic damping on both sides of a gear: they differ by the square of the ratio."""
    line = [
        Disc(inertia=3.0, damping=0.02),
        Coupling(stiffness=2e4, viscous=0.05),
        Gear(ratio=3),
        Disc(inertia=0.5),
        Coupling(stiffness=1e4, loss_factor=1e-3),
        Disc(inertia=0.7, damping=0.01),
    ]
    _, system = build(line)
    speeds = np.array([1.0]), 0.0, 1e4
    at, ratio = grid.resonances(system, *speeds, lambda speed: ground_damping(system, speed, None))
    exact = damped(system, speed=1.0)
    assert ratio == pytest.approx(exact.damping_ratio, rel=1e-4)
    assert at == pytest.approx(2 * math.pi * exact.frequency, rel=1e-5)


def test_undamped_resonance_is_flagged_and_everything_else_is_sound(build, operation):
    study, system = build(
        [Disc(inertia=2.0), Coupling(stiffness=120.0), Disc(inertia=3.0)],
        excitations=[Excitation(at="disc-1", order=1, torque=1.0)],
        operation=operation(5.0, 15.0, 11),
    )
    found = response(study, system)
    at = np.flatnonzero(found.speed == 10.0)
    assert found.status[at, 0].tolist() == [Status.SINGULAR]
    exactly = np.abs(found.speed - 10.0) < 1e-9
    assert (found.status[~exactly] == Status.OK).all()
    assert np.isfinite(found.torque[~exactly]).all()
    assert np.count_nonzero(np.abs(found.speed / 10.0 - 1) < 2e-2) > 10
    exact = 120.0 / 2.0 / (100.0 - found.speed[~exactly] ** 2)
    assert found.torque[~exactly, 0, 0] == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize("zeta", [0.2, 0.05, 1e-2, 1e-3, 1e-5, 1e-7])
@pytest.mark.parametrize("known", [False, True])
def test_no_peak_falls_between_two_speeds(build, operation, zeta, known):
    """One degree of freedom, damped to ground: the largest torque is F/(2 zeta sqrt(1 - zeta^2))."""
    stiffness, inertia = 1e4, 1.0
    damping = 2 * zeta * math.sqrt(stiffness * inertia)
    study, system = build(
        [Disc(held=True), Coupling(stiffness=stiffness), Disc(inertia=inertia, damping=damping)],
        excitations=[Excitation(at="disc-2", order="3/2", torque=1.0)],
        operation=operation(20.0, 120.0, 4),
    )
    given = {"damped": damped(system, speed=100.0), "modes": modes(system)} if known else {}
    found = response(study, system, **given)
    exact = 1.0 / (2 * zeta * math.sqrt(1 - zeta**2))
    assert np.abs(found.torque).max() == pytest.approx(exact, rel=2e-5)
    assert found.requested.sum() == 4
    assert len(found.speed) < 50


def test_no_peak_of_a_damped_train_falls_between_two_speeds(build, operation):
    """The highest computed torque of every span is within 0.1 % of that of a grid a hundred times as dense."""
    line = [
        Motor(inertia=3.0, ripple=[{"order": 6, "torque": 20.0}, {"order": 1, "torque": 5.0}]),
        Coupling(stiffness=2e4, psi=0.8),
        Disc(inertia=0.5),
        Branch(train=(Coupling(stiffness=9e3, viscous=2.0), Disc(inertia=0.3))),
        Gear(ratio=2),
        Coupling(stiffness=6e4, loss_factor=1e-3),
        Disc(inertia=2.0, damping=1.0),
    ]
    study, system = build(line, operation=operation(20.0, 200.0, 10))
    found = response(study, system)
    ground = ground_damping(system, np.array([100.0]), None)
    for k, one in enumerate(excitations(system)):
        near = found.speed[np.abs(found.torque[:, k]).argmax(axis=0)]
        dense_grid = np.concatenate(
            [np.linspace(20.0, 200.0, 20001), *(n * np.linspace(0.99, 1.01, 4001) for n in near)]
        )
        dense_grid = dense_grid[(dense_grid >= 20.0) & (dense_grid <= 200.0)]
        w = float(one.line.order) * dense_grid
        damping = np.tile(ground, (1, len(dense_grid)))
        exact = np.abs(
            answer(system, w, sources(system, one, dense_grid, None), damping).torque
        ).max(axis=0)
        assert np.abs(found.torque[:, k]).max(axis=0) == pytest.approx(exact, rel=1e-3)


def test_lanchester_damper_at_its_optimum_peaks_at_2_plus_mu_over_mu(build, operation):
    """Benchmark B19: mu 0.2, peak 11 at 0.953463 of the natural frequency."""
    mu, stiffness = 0.2, 1e4
    zeta = 1 / math.sqrt(2 * (1 + mu) * (2 + mu))
    ring = RingDamper(housing=1.0, ring=mu, damping=2 * zeta * mu * 100.0)
    study, system = build(
        [Disc(held=True), Coupling(stiffness=stiffness), ring],
        excitations=[Excitation(at="damper-1", order=1, torque=1.0)],
        operation=operation(50.0, 150.0, 6),
    )
    found = response(study, system)
    size = np.abs(found.torque[:, 0, 0])
    assert size.max() == pytest.approx(11.0, rel=2e-5)
    assert found.speed[size.argmax()] == pytest.approx(95.3463, rel=2e-3)


def test_orders_asked_for_are_the_only_lines(build, operation):
    excite = [Excitation(at="disc-1", order=k, torque=1.0) for k in ("1", "3/2", "2")]
    excite.append(Excitation(at="disc-1", frequency=3.0, torque=1.0))
    study, system = build(
        [Disc(inertia=1.0), Coupling(stiffness=100.0), Disc(inertia=1.0)],
        excitations=excite,
        operation=operation(1.0, 2.0, 2),
        analyses={"response": ResponseSettings(orders=["3/2"])},
    )
    found = response(study, system)
    assert [(line.order, line.frequency) for line in found.lines] == [
        (Fraction(3, 2), None),
        (None, 3.0),
    ]
    assert found.frequency[:, 1].tolist() == [3.0] * len(found.speed)


def test_table_over_speed_is_read_at_the_own_speed_and_never_extrapolated(build, operation):
    table = [["10 rad/s", 5.0], ["50 rad/s", 25.0]]
    line = [Disc(held=True), Gear(ratio=2), Coupling(stiffness=1e9), Disc(name="end", inertia=1e-9)]
    study, system = build(
        line,
        excitations=[Excitation(at="end", order=1, torque=table)],
        operation=operation(40.0, 80.0, 3),
    )
    found = response(study, system)
    assert np.abs(found.torque[:, 0, 0]) == pytest.approx(found.speed / 4.0, rel=1e-6)
    with pytest.raises(InputError, match="nothing is extrapolated"):
        response(study, system, speeds=np.array([40.0, 120.0]))


def test_share_of_an_unknown_mean_torque_names_the_power(build, operation):
    excite = [Excitation(at="disc-1", order=1, torque="10 %")]
    study, system = build(
        [Disc(inertia=1.0), Coupling(stiffness=100.0), Disc(inertia=1.0)],
        excitations=excite,
        operation=operation(1.0, 2.0, 2),
    )
    with pytest.raises(InputError) as raised:
        response(study, system)
    assert raised.value.faults[0].path == ("operation", "rated", "power")


def test_response_without_speeds_or_frequencies_is_refused(build):
    study, system = build([Disc(inertia=1.0)])
    with pytest.raises(InputError, match="needs the speeds"):
        response(study, system)
    with pytest.raises(InputError, match="needs the frequencies"):
        frequency_response(study, system)
    with pytest.raises(InputError, match="no torque acts at every frequency"):
        frequency_response(study, system, frequencies=np.array([1.0]))


def test_methods_are_two_words_and_orders_are_exact():
    assert ResponseSettings(method="harmonic-balance").method == "harmonic-balance"
    with pytest.raises(ValueError, match="first-order"):
        ResponseSettings(method="shooting")
    assert ResponseSettings(orders=[1, 0.5, "21/8"]).orders == (
        Fraction(1),
        Fraction(1, 2),
        Fraction(21, 8),
    )
    with pytest.raises(ValueError, match="orders are"):
        ResponseSettings(orders="some")


def test_frequency_response_catches_the_peak_of_a_light_mode(build):
    study, system = build(
        [Disc(held=True), Coupling(stiffness=1e4, loss_factor=1e-4), Disc(inertia=1.0)],
        excitations=[Excitation(at="disc-2", torque=1.0)],
    )
    found = frequency_response(study, system, frequencies=np.linspace(1.0, 30.0, 5))
    assert np.abs(found.angle[:, 1]).max() == pytest.approx(1.0, rel=1e-6)
    assert (found.status == Status.OK).all()
    assert found.requested.sum() == 5


def test_many_resonances_are_bounded_in_number_and_it_is_said(build, operation, monkeypatch):
    line = [Disc(inertia=1.0)]
    for _ in range(30):
        line += [Coupling(stiffness=1e4, loss_factor=1e-3), Disc(inertia=0.1)]
    excite = [Excitation(at="disc-1", order=k, torque=1.0) for k in (1, 2, 3, 4)]
    study, system = build(line, excitations=excite, operation=operation(10.0, 400.0, 3))
    monkeypatch.setattr(grid, "MOST_ADDED", 200)
    monkeypatch.setattr(grid, "MOST_PEAKS", 10)
    found = response(study, system)
    assert (
        len(found.speed) <= 3 + 200 + 2 * 40 + 2 * 10
    )  # two further points by each of 40 resonances
    assert "most prominent" in found.remark
    assert response(study, system, speeds=np.array([10.0, 10.5])).remark == ""


def test_a_large_train_has_fewer_points_at_each_resonance_and_loses_none():
    """Values of the response: those requested, and MOST_VALUES around resonances unless these have the fewest."""
    requested, resonances, ratio = (
        np.array([1.0, 100.0]),
        np.linspace(10.0, 90.0, 50),
        np.full(50, 0.01),
    )
    many, remark = grid.refined(requested, resonances, ratio)
    assert remark == ""
    for values in (6_000, 8_000, 10**9):
        points, remark = grid.refined(requested, resonances, ratio, values)
        assert len(points) < len(many)
        assert np.isin(np.concatenate([requested, resonances]), points).all()
        assert len(points) <= 2 + 50 * (
            2 + max(grid.MOST_VALUES // (50 * values), grid.FEWEST_POINTS)
        )
        assert "each of 50 resonances" in remark


def test_peaks_between_the_points_of_a_large_train_are_bounded():
    """The inverse square of every curve is a parabola, of which 300 have their lowest point at places of their own."""
    x, place = np.arange(301.0), np.arange(1.0, 300.0) + np.linspace(-0.4, 0.4, 299)
    torque = 1.0 / np.sqrt(0.01 + (x[:, None] - place) ** 2)[:, None, :]
    sound = np.ones((301, 1), dtype=bool)
    assert len(grid.missed_peaks(x, torque, sound)[0]) > 200
    wide = np.tile(torque, (1, 1, 20))
    peaks, remark = grid.missed_peaks(x, wide, sound)
    assert len(peaks) == grid.FEWEST_PEAKS
    assert "the 100 most prominent" in remark


def test_a_sum_of_magnitudes_is_as_doubtful_as_the_worst_of_its_parts() -> None:
    """Three frequencies of two sources in any phase: magnitudes 5 + 13, 10 + 1 and 2 + 3, phases of the first."""
    first, second = (
        Answer(np.array([angle]).T, 2.0 * np.array([angle]).T, np.array(residual), np.array(status))
        for angle, residual, status in (
            ([3 + 4j, -10j, 2.0 + 0j], [1e-9, 2e-3, 0.0], [Status.SINGULAR, Status.OK, Status.OK]),
            ([5 - 12j, 1j, -3.0 + 0j], [4e-6, 1e-4, 0.0], [1, Status.NEAR_SINGULAR, Status.OK]),
        )
    )
    total = by_magnitude([first, second])
    assert total.angle[:, 0] == pytest.approx([18 * (0.6 + 0.8j), -11j, 5.0], rel=1e-14)
    assert total.torque == pytest.approx(2.0 * total.angle, rel=1e-14)
    assert total.residual.tolist() == [4e-6, 2e-3, 0.0]
    worst = [Status.SINGULAR, Status.NEAR_SINGULAR, Status.OK]
    assert total.status.tolist() == worst
