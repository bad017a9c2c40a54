"""Modes of whole trains: gears, branches, loops, Holzer tables, energies."""

import math

import numpy as np
import pytest

from torsion.analyses.modes.holzer import holzer
from torsion.analyses.undamped_modes import modes
from torsion.errors import InputError
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.train import Link


def _chain(inertias: list[float], stiffnesses: list[float]) -> list:
    line = [Disc(inertia=inertias[0])]
    for stiffness, inertia in zip(stiffnesses, inertias[1:], strict=True):
        line += [Coupling(stiffness=stiffness), Disc(inertia=inertia)]
    return line


def test_gear_reflects_inertia_with_the_square_of_the_ratio(build):
    _, geared = build(
        [Disc(inertia=2.0), Coupling(stiffness=1e4), Gear(teeth=(20, 50)), Disc(inertia=3.0)]
    )
    frequency = modes(geared).frequency[0]
    referred = 3.0 * (20 / 50) ** 2
    exact = math.sqrt(1e4 * (1 / 2.0 + 1 / referred)) / (2 * math.pi)
    assert frequency == pytest.approx(exact, rel=1e-15)


def test_gear_reflects_stiffness_with_the_square_of_the_ratio_and_torque_with_the_ratio(build):
    _, geared = build(
        [Disc(inertia=2.0), Gear(ratio=2.5), Coupling(stiffness=1e4), Disc(inertia=3.0)]
    )
    found = modes(geared)
    exact = math.sqrt(1e4 / 2.5**2 * (1 / 2.0 + 2.5**2 / 3.0)) / (2 * math.pi)
    assert found.frequency[0] == pytest.approx(exact, rel=1e-15)
    gear = next(k for k, span in enumerate(geared.spans) if span.ratio != 1)
    shaft = 1 - gear
    assert found.torque[shaft, 0] == pytest.approx(2.5 * found.torque[gear, 0], rel=1e-14)
    twist = found.shape[geared.spans[shaft].driving, 0] - found.shape[geared.spans[shaft].driven, 0]
    assert found.torque[shaft, 0] == pytest.approx(1e4 * twist, rel=1e-13)


@pytest.mark.parametrize("ratio", [1, 3])
def test_geared_t_of_friswell_in_either_direction_of_the_gear(build, ratio):
    """Benchmark B3, also with everything behind the gear at another speed: the referred train is the same."""
    scale = ratio**2
    line = [
        Disc(inertia=400e-6),
        Coupling(stiffness=10000),
        Disc(inertia=25e-6),
        Branch(train=(Coupling(stiffness=5000), Disc(inertia=700e-6))),
        Gear(ratio=ratio, inertia=(0, 25e-6 * scale)),
        Coupling(stiffness=5000.0 * scale),
        Disc(inertia=700e-6 * scale),
    ]
    _, system = build(line)
    assert modes(system).frequency == pytest.approx([425.359477, 634.07276, 3247.19235], rel=2e-9)


def test_span_torque_is_stiffness_times_twist_with_driving_less_driven(build):
    _, system = build(_chain([1.0, 2.0, 3.0], [100.0, 200.0]))
    found = modes(system)
    twist = found.shape[system.driving] - found.shape[system.driven]
    assert found.torque == pytest.approx(twist / system.flexibility[:, None], rel=1e-13)


def test_shapes_have_a_generalised_inertia_of_one_and_shares_add_up(build):
    _, system = build(_chain([1.0, 2.0, 3.0, 0.5], [100.0, 200.0, 50.0]))
    found = modes(system)
    assert found.shape.T @ np.diag(system.inertia) @ found.shape == pytest.approx(
        np.eye(3), abs=1e-14
    )
    assert found.kinetic.sum(axis=0) == pytest.approx(np.ones(3), rel=1e-14)
    assert found.elastic.sum(axis=0) == pytest.approx(np.ones(3), rel=1e-14)
    assert found.rigid == 1
    assert found.certified
    assert found.nodes.tolist() == [1, 2, 3]


def test_held_end_is_no_node_and_leaves_no_rigid_motion(build):
    _, system = build([Disc(held=True), Coupling(stiffness=100.0), Disc(inertia=4.0)])
    found = modes(system)
    assert found.frequency[0] == pytest.approx(5.0 / (2 * math.pi), rel=1e-15)
    assert found.rigid == 0
    assert found.nodes.tolist() == [0]
    assert found.shape[0, 0] == 0.0


def test_train_between_two_held_ends_has_one_node_less_than_its_mode(build):
    line = [Disc(held=True), *_chain([1.0] * 4, [100.0] * 3), Disc(held=True)]
    line[1:1], line[-1:-1] = [Coupling(stiffness=900.0)], [Coupling(stiffness=20.0)]
    _, system = build(line)
    assert modes(system).nodes.tolist() == [0, 1, 2, 3]


def test_line_that_stands_still_adds_no_nodes(build):
    """Two equal branches that swing against each other leave the whole main line at rest, but for rounding."""
    branch = Branch(train=(Coupling(stiffness=3.3), Disc(inertia=0.7)))
    line = _chain([1.3, 0.9, 1.7, 1.1, 2.3], [130.0, 170.0, 190.0, 110.0])
    _, system = build([*line, branch, branch])
    found = modes(system)
    still = next(k for k in range(len(found.frequency)) if abs(found.shape[:5, k]).max() < 1e-12)
    assert found.nodes[still] == 1


def test_held_end_behind_a_rigid_span_stays_the_root_beside_a_spring_to_ground(build):
    line = [
        Disc(inertia=4.0, stiffness=60.0),
        Coupling(stiffness=40.0),
        Coupling(flexibility=0),
        Disc(held=True),
    ]
    _, system = build(line)
    assert modes(system).frequency == pytest.approx([5.0 / (2 * math.pi)], rel=1e-15)


def test_repeated_branches_count_one_node_each(build):
    """Three equal branches on a hub: a pair of modes in which the hub stands still."""
    branch = Branch(train=(Coupling(stiffness=300.0), Disc(inertia=0.5)))
    _, system = build(
        [Disc(inertia=2.0), branch, branch, Coupling(stiffness=300.0), Disc(inertia=0.5)]
    )
    found = modes(system)
    exact = math.sqrt(600.0) / (2 * math.pi)
    assert found.frequency[:2] == pytest.approx([exact, exact], rel=1e-15)
    assert abs(found.shape[0, :2]).max() < 1e-14
    assert found.shape.T @ np.diag(system.inertia) @ found.shape == pytest.approx(
        np.eye(3), abs=1e-13
    )


def test_viscous_ring_is_one_more_rigid_motion(build):
    _, system = build(
        [
            RingDamper(housing=1.0, ring=5.0, damping=10.0),
            Coupling(stiffness=100.0),
            Disc(inertia=2.0),
        ]
    )
    found = modes(system)
    assert found.rigid == 2
    assert found.frequency == pytest.approx([math.sqrt(100.0 * 1.5) / (2 * math.pi)], rel=1e-15)
    ring = next(k for k, station in enumerate(system.stations) if "ring" in station.name)
    assert found.shape[ring, 0] == 0.0


def test_parallel_springs_between_the_same_points_add_their_stiffness_and_share_the_torque(build):
    line = [Disc(name="a", inertia=1.0), Coupling(stiffness=100.0), Disc(name="b", inertia=2.0)]
    _, system = build(line, links=[Link(("a", "b"), Coupling(stiffness=50.0))])
    found = modes(system)
    assert found.frequency[0] == pytest.approx(math.sqrt(150.0 * 1.5) / (2 * math.pi), rel=1e-14)
    assert found.torque[0, 0] == pytest.approx(2.0 * found.torque[1, 0], rel=1e-13)
    twist = found.shape[0, 0] - found.shape[1, 0]
    assert found.torque[1, 0] == pytest.approx(50.0 * twist, rel=1e-13)


def test_closed_ring_of_equal_discs_has_its_closed_form(build):
    """w^2 = 4 k/J sin(pi m/n)^2, in pairs."""
    line = _chain([1.0] * 5, [100.0] * 4)
    line[0], line[-1] = Disc(name="a", inertia=1.0), Disc(name="z", inertia=1.0)
    _, system = build(line, links=[Link(("z", "a"), Coupling(stiffness=100.0))])
    exact = [20.0 * math.sin(math.pi * m / 5) / (2 * math.pi) for m in (1, 1, 2, 2)]
    found = modes(system)
    assert found.frequency == pytest.approx(exact, rel=1e-14)
    twist = found.shape[system.driving] - found.shape[system.driven]
    assert found.torque == pytest.approx(100.0 * twist, rel=1e-11, abs=1e-12)


def test_grounded_train_through_a_gear_keeps_every_span_law(build):
    line = [
        Disc(inertia=1.0, stiffness=40.0),
        Coupling(stiffness=100.0),
        Gear(ratio=2),
        Disc(inertia=3.0, stiffness=500.0),
        Coupling(stiffness=80.0),
        Disc(inertia=0.4),
    ]
    _, system = build(line)
    found = modes(system)
    assert found.rigid == 0
    elastic = system.flexibility > 0
    ratio = np.array([float(span.ratio) for span in system.spans])
    twist = found.shape[system.driving] - found.shape[system.driven] / ratio[:, None]
    assert found.torque[elastic] == pytest.approx(
        twist[elastic] / system.flexibility[elastic, None], rel=1e-12
    )


@pytest.mark.parametrize("mode", [0, 1, 2])
def test_holzer_table_closes(build, mode):
    """Each row's torque is the sum of the inertia torques above it, its angle the angle above less the twist."""
    _, system = build(_chain([1.0, 2.0, 3.0, 0.5], [100.0, 200.0, 50.0]))
    table = holzer(system, modes(system), mode)
    assert table.angle[0] == 1.0
    total = 0.0
    for row in range(1, 4):
        total += table.inertia_torque[row - 1]
        assert table.before[row] == row - 1
        assert table.torque_in[row] == table.torque_out[row] == pytest.approx(total, rel=1e-11)
        assert table.angle[row] == pytest.approx(table.angle[row - 1] - table.twist[row], rel=1e-11)
    assert total + table.inertia_torque[3] == pytest.approx(
        0.0, abs=1e-11 * abs(table.inertia_torque).max()
    )


@pytest.mark.parametrize("end", [Disc(inertia=3.0), Disc(held=True)])
def test_holzer_table_of_a_grounded_geared_branched_train_balances_every_station(build, end):
    line = [
        Disc(inertia=1.0, stiffness=40.0),
        Coupling(stiffness=100.0),
        Disc(inertia=0.3),
        Branch(train=(Coupling(stiffness=70.0), Disc(inertia=0.7))),
        Gear(ratio=2),
        Disc(inertia=2.0),
        Coupling(stiffness=300.0),
        end,
    ]
    _, system = build(line)
    table = holzer(system, modes(system), 1)
    sums = table.inertia_torque + table.torque_out
    for row, before in enumerate(table.before.tolist()):
        if before >= 0:
            sums[before] -= table.torque_in[row]
            assert table.angle[row] == pytest.approx(
                table.angle[before] - table.twist[row], rel=1e-11, abs=1e-13
            )
    free = np.isfinite(table.inertia)
    assert np.count_nonzero(~free) == 1 + end.held
    assert sums[free] == pytest.approx(np.zeros(free.sum()), abs=1e-11 * abs(table.torque_in).max())
    assert table.residual == abs(sums[free]).max()


def test_change_of_units_changes_nothing(build):
    """A train in units of 8 kg m2 and 8 N m is the same train; in half the time its frequencies double."""
    plain = modes(build(_chain([1.1, 2.3, 0.7], [130.0, 210.0]))[1])
    heavy = modes(build(_chain([8.8, 18.4, 5.6], [1040.0, 1680.0]))[1])
    quick = modes(build(_chain([1.1, 2.3, 0.7], [520.0, 840.0]))[1])
    assert heavy.frequency == pytest.approx(plain.frequency, rel=1e-15)
    assert quick.frequency == pytest.approx(2.0 * plain.frequency, rel=1e-15)


@pytest.mark.parametrize("count", [-1, 0, 100_001])
def test_number_of_modes_out_of_range_is_a_fault_of_the_input(build, count):
    _, system = build([Disc(inertia=1.0), Coupling(stiffness=1e4), Disc(inertia=1.0)])
    with pytest.raises(InputError, match="give 1 to 100000"):
        modes(system, count)
