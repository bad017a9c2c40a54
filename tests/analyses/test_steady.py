"""Mean torque: shares, ratios, load laws and what is refused."""

import math
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.steady import statics, steady
from torsion.errors import InputError, SolveError
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear, GearBranch
from torsion.model.machine import Motor, Propeller
from torsion.train import Link

RATED = (100.0, 50e3)  # rad/s, W: 500 N m


def _two_motors_two_propellers() -> list:
    behind = (Coupling(stiffness=3e5), Propeller(name="port", inertia=4.0))
    return [
        Motor(name="main motor", inertia=1.0, power=300e3),
        Coupling(stiffness=1e5),
        Disc(name="hub", inertia=0.5),
        Branch(train=(Coupling(stiffness=1e4), Motor(name="boost", inertia=0.2, power=100e3))),
        Gear(teeth=(20, 50), branches=(GearBranch(teeth=(50,), train=behind),)),
        Coupling(name="shaft", stiffness=2e5),
        Propeller(name="starboard", inertia=4.0),
    ]


def test_power_that_enters_leaves_and_every_station_is_in_balance(build, operation):
    study, system = build(
        _two_motors_two_propellers(), operation=operation(50.0, 120.0, rated=RATED)
    )
    found = steady(study.train, system, study.operation, np.array([50.0, 100.0, 120.0]))
    power = found.applied * system.speed_ratio[:, None]
    assert power.sum(axis=0) == pytest.approx(np.zeros(3), abs=1e-12 * 500)
    left = found.applied.copy()
    for k, span in enumerate(system.spans):
        left[span.driving] -= found.torque[k]
        left[span.driven] += found.torque[k] / float(span.ratio)
    assert left == pytest.approx(np.zeros_like(left), abs=1e-12 * 500)


def test_motors_share_by_power_and_propellers_equally(build, operation):
    study, system = build(
        _two_motors_two_propellers(), operation=operation(50.0, 120.0, rated=RATED)
    )
    found = steady(study.train, system, study.operation, np.array([100.0]))
    at = {station.name: found.applied[k, 0] for k, station in enumerate(system.stations)}
    assert at["main motor"] == pytest.approx(375.0, rel=1e-15)
    assert at["boost"] == pytest.approx(125.0, rel=1e-15)
    assert at["starboard"] == pytest.approx(-250.0 * 50 / 20, rel=1e-15)
    assert at["port"] == pytest.approx(-250.0 * 50 / 20, rel=1e-15)
    assert "in proportion to their power" in found.sharing
    assert "in equal parts" in found.sharing
    shaft = [span.name for span in system.spans].index("shaft")
    assert found.torque[shaft, 0] == pytest.approx(625.0, rel=1e-15)


def test_propeller_law_is_the_square_of_speed_and_constant_is_constant(build, operation):
    line = [Motor(inertia=1), Coupling(stiffness=1e4), Propeller(inertia=1)]
    study, system = build(line, operation=operation(50.0, 200.0, rated=RATED))
    assert steady(study.train, system, study.operation, np.array([50.0, 200.0])).torque[
        0
    ] == pytest.approx([125.0, 2000.0], rel=1e-15)
    study, system = build(line, operation=operation(50.0, 200.0, rated=RATED, load="constant"))
    assert steady(study.train, system, study.operation, np.array([50.0, 200.0])).torque[
        0
    ].tolist() == [500.0, 500.0]


def test_reference_behind_a_gear_reads_power_at_its_own_speed(build, operation):
    line = [
        Motor(inertia=1),
        Coupling(stiffness=1e4),
        Gear(ratio=4),
        Propeller(name="wheel", inertia=1),
    ]
    study, system = build(line, operation=operation(5.0, 25.0, rated=(25.0, 50e3), at="wheel"))
    found = steady(study.train, system, study.operation, np.array([25.0]))
    assert found.torque[0, 0] == pytest.approx(500.0, rel=1e-15)
    assert found.torque[1, 0] == pytest.approx(500.0, rel=1e-15)
    assert found.applied[system.driven[1], 0] == pytest.approx(-2000.0, rel=1e-15)


def test_static_twist_lags_by_torque_times_flexibility_at_own_speed(build, operation):
    line = [
        Motor(inertia=1),
        Coupling(stiffness=1e4),
        Disc(inertia=1),
        Gear(ratio=4),
        Coupling(stiffness=1e5),
        Propeller(inertia=1),
    ]
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    found = steady(study.train, system, study.operation, np.array([100.0]))
    at = {station.name: found.twist[k, 0] for k, station in enumerate(system.stations)}
    assert at["motor-1"] == 0.0
    assert at["disc-1"] == pytest.approx(-0.05, rel=1e-15)
    assert at["propeller-1"] == pytest.approx(-0.05 / 4 - 2000.0 / 1e5, rel=1e-14)


def test_idle_branch_carries_exactly_nothing(build, operation):
    idle = Branch(train=(Coupling(name="idle", stiffness=1e4), Disc(inertia=1.0)))
    line = [
        Motor(inertia=1, power=0.1),
        Coupling(stiffness=1e4),
        Disc(inertia=1),
        idle,
        Branch(train=(Coupling(stiffness=1e4), Motor(inertia=1, power=0.2))),
        Coupling(stiffness=1e4),
        Propeller(inertia=1),
    ]
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    found = steady(study.train, system, study.operation, np.array([70.0]))
    assert found.torque[[span.name for span in system.spans].index("idle"), 0] == 0.0


def test_parallel_ways_share_by_stiffness(build, operation):
    line = [
        Motor(name="a", inertia=1),
        Coupling(stiffness=1e4),
        Disc(inertia=1),
        Coupling(stiffness=3e4),
        Propeller(name="b", inertia=1),
    ]
    study, system = build(
        line,
        operation=operation(50.0, 100.0, rated=RATED),
        links=[Link(("a", "b"), Coupling(stiffness=2.5e3))],
    )
    found = steady(study.train, system, study.operation, np.array([100.0]))
    assert found.torque[:, 0] == pytest.approx([375.0, 375.0, 125.0], rel=1e-14)
    assert found.twist[-1, 0] == pytest.approx(-0.05, rel=1e-14)


def test_train_without_motor_and_propeller_runs_from_its_first_to_the_last_station_of_the_main_line(
    build, operation
):
    side = Branch(train=(Coupling(stiffness=1e4), Disc(inertia=1)))
    line = [
        Disc(held=True),
        Coupling(stiffness=1e4),
        Disc(inertia=1),
        side,
        Coupling(stiffness=1e4),
        Disc(inertia=1),
    ]
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    found = steady(study.train, system, study.operation, np.array([100.0]))
    assert found.torque[:, 0].tolist() == [500.0, 0.0, 500.0]
    assert "disc-1" in found.sharing


@pytest.mark.parametrize(
    ("line", "entering", "leaving"),
    [
        (
            [Disc(name="pump", inertia=2), Coupling(stiffness=3e4), Motor(name="drive", inertia=1)],
            "drive",
            "pump",
        ),
        (
            [
                Propeller(name="screw", inertia=2),
                Coupling(stiffness=3e4),
                Disc(name="drive", inertia=1),
            ],
            "drive",
            "screw",
        ),
    ],
)
def test_power_that_would_enter_and_leave_at_one_component_runs_to_the_other_end(
    build, operation, line, entering, leaving
):
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    found = steady(study.train, system, study.operation, np.array([100.0]))
    at = {station.name: found.applied[k, 0] for k, station in enumerate(system.stations)}
    assert (at[entering], at[leaving]) == (500.0, -500.0)
    assert found.torque[:, 0].tolist() == [-500.0]
    words = (
        "no propeller, and the other end is a motor"
        if leaving == "pump"
        else "no motor, and the other end"
    )
    assert f"enters at {entering}" in found.sharing
    assert f"leaves at {leaving}" in found.sharing
    assert words in found.sharing


@pytest.mark.parametrize(
    "line",
    [
        [Disc(inertia=1.0)],
        [Motor(inertia=1.0)],
        [
            Motor(inertia=1.0),
            Coupling(stiffness=1e4),
            Disc(inertia=1),
            Coupling(stiffness=1e4),
            Motor(inertia=1),
        ],
        [Propeller(inertia=1.0), Coupling(stiffness=1e4), Propeller(inertia=1)],
    ],
)
def test_power_with_no_way_through_the_train_is_refused_and_not_nothing(build, operation, line):
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    with pytest.raises(InputError, match="would enter and leave the train at") as raised:
        steady(study.train, system, study.operation, np.array([100.0]))
    assert raised.value.faults[0].path == ("operation", "rated")


def test_powers_of_motors_that_are_not_the_rated_power_are_told_as_shares(build, operation):
    study, system = build(
        _two_motors_two_propellers(), operation=operation(50.0, 120.0, rated=RATED)
    )
    stated = steady(study.train, system, study.operation, np.array([100.0])).sharing
    assert (
        "together (400 kW) say their shares alone: the torque follows from the rated 50 kW"
        in stated
    )
    line = [Motor(inertia=1, power=50.4e3), Coupling(stiffness=1e4), Propeller(inertia=1)]
    study, system = build(line, operation=operation(50.0, 120.0, rated=RATED))
    assert "kW" not in steady(study.train, system, study.operation, np.array([100.0])).sharing


def test_viscous_ring_carries_no_mean_torque_but_a_viscous_link_cannot_pass_it(build, operation):
    line = [
        Motor(inertia=1),
        RingDamper(housing=1.0, ring=2.0, damping=5.0),
        Coupling(stiffness=1e4),
        Propeller(inertia=1),
    ]
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    found = steady(study.train, system, study.operation, np.array([100.0]))
    assert sorted(np.abs(found.torque[:, 0]).tolist()) == [0.0, 500.0, 500.0]
    line = [Disc(inertia=1), RingDamper(name="d", housing=1, ring=2, damping=5)]
    study, system = build(line, operation=operation(50.0, 100.0, rated=RATED))
    ring = next(k for k, station in enumerate(system.stations) if "ring" in station.name)
    shares = [Fraction(0)] * len(system.stations)
    shares[0], shares[ring] = Fraction(1), Fraction(-1)
    with pytest.raises(SolveError, match="no stiffness"):
        statics(system, shares, 0)


def test_table_is_interpolated_and_never_extrapolated(build, operation):
    load = [["40 rad/s", 100.0], ["80 rad/s", 300.0]]
    study, system = build(
        [Motor(inertia=1), Coupling(stiffness=1e4), Propeller(inertia=1)],
        operation=operation(50.0, 120.0, load=load),
    )
    assert study.has_mean_torque
    assert steady(study.train, system, study.operation, np.array([50.0, 80.0])).torque[
        0
    ] == pytest.approx([150.0, 300.0])
    with pytest.raises(InputError) as raised:
        steady(study.train, system, study.operation, np.array([50.0, 120.0]))
    assert raised.value.faults[0].path == ("operation", "load")
    assert "763.944 rpm" in raised.value.faults[0].message
    assert 80.0 * 30.0 / math.pi == pytest.approx(763.944, abs=1e-3)


def test_mean_torque_needs_a_power(build, operation):
    study, system = build([Motor(inertia=1), Coupling(stiffness=1e4), Propeller(inertia=1)])
    assert not study.has_mean_torque
    with pytest.raises(InputError, match="rated power"):
        steady(study.train, system, study.operation, np.array([50.0]))


def test_of_some_motors_without_power_one_alone_is_free(build, operation):
    line = [
        Motor(name="m1", inertia=1),
        Coupling(stiffness=1e4),
        Motor(name="m2", inertia=1),
        Coupling(stiffness=1e4),
        Motor(name="m3", inertia=1, power=300e3),
        Coupling(stiffness=1e4),
        Propeller(inertia=1),
    ]
    study, system = build(line, operation=operation(50.0, 100.0, rated=(100.0, 500e3)))
    with pytest.raises(
        InputError, match="'m1' and 'm2' drive, both without power, in addition to 'm3'"
    ) as raised:
        steady(study.train, system, study.operation, np.array([50.0]))
    assert raised.value.faults[0].hint == "only one machine can be the free one"
    study, system = build(line[2:], operation=operation(50.0, 100.0, rated=(100.0, 500e3)))
    assert steady(study.train, system, study.operation, np.array([100.0])).torque[
        :, 0
    ] == pytest.approx([2e3, 5e3])
