"""Several held points: what rigid spans join to them stands still, and the same train written otherwise is the same."""

import math
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import excitations, sources
from torsion.analyses.response.solver import answer, ground_damping
from torsion.analyses.stability.periodic_orbits import PeriodicResponse
from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.kernels.trees.tree_response import Status
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine_torques import Excitation
from torsion.runner import run
from torsion.schema.scene_reader import parse
from torsion.train import fixed_point_faults, train

WALL, RIGID = Disc(held=True), Coupling(flexibility=0)
SOFT, STIFF = Coupling(stiffness=1e4, viscous=5.0), Coupling(stiffness=3e4, viscous=2.0)
BODY = Disc(name="body", inertia=2.0, damping=3.0)
PUSH = [Excitation(at="body", order=1, torque=7.0)]
SPEED = np.array([30.0, 141.0, 400.0])


def _answered(line: list, pushed: bool = True):
    """System, and the answer of the train to each of its excitations at SPEED."""
    system = assemble(train(line, excitations=PUSH if pushed else []))
    ground = ground_damping(system, SPEED, None)
    found = [
        answer(system, float(one.line.order) * SPEED, sources(system, one, SPEED, None), ground)
        for one in excitations(system)
    ]
    return system, ground, found


def _torque(system, found, name: str):
    """(speeds,) N m in a span."""
    return found.torque[:, [span.name for span in system.spans].index(name)]


LINES = {
    "wall at the end behind a rigid coupling": [WALL, SOFT, BODY, STIFF, RIGID, WALL],
    "walls at both ends behind rigid couplings": [WALL, RIGID, SOFT, BODY, STIFF, RIGID, WALL],
    "disc fixed to the last wall": [WALL, RIGID, SOFT, BODY, STIFF, Disc(inertia=0.3), RIGID, WALL],
    "rigid gear before the last wall": [
        WALL,
        RIGID,
        SOFT,
        BODY,
        STIFF,
        Gear(ratio=2, inertia=(0.1, 0.2)),
        WALL,
    ],
    "disc fixed to an inner wall, and a branch beyond": [
        WALL,
        RIGID,
        SOFT,
        BODY,
        STIFF,
        Disc(inertia=0.3),
        RIGID,
        WALL,
        SOFT,
        Disc(inertia=1.0),
    ],
    "elastic branch at what a wall holds": [
        WALL,
        RIGID,
        SOFT,
        BODY,
        STIFF,
        Disc(inertia=0.3),
        Branch(train=(SOFT, Disc(inertia=0.4, damping=1.0))),
        RIGID,
        WALL,
    ],
}


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_a_body_between_two_walls_swings_on_both_springs(line) -> None:
    system, _, (found,) = _answered(line)
    first = modes(assemble(train(line)), None)
    near = int(np.argmin(np.abs(first.frequency - math.sqrt(4e4 / 2.0) / (2 * math.pi))))
    assert first.frequency[near] == pytest.approx(math.sqrt(4e4 / 2.0) / (2 * math.pi), rel=1e-14)
    assert first.rigid == 0
    assert first.certified
    hand = 7.0 / (4e4 - 2.0 * SPEED**2 + 1j * SPEED * (3.0 + 5.0 + 2.0))
    body = [station.name for station in system.stations].index("body")
    assert found.angle[:, body] == pytest.approx(hand, rel=1e-13)
    assert _torque(
        system, found, "coupling-2" if line[1] is RIGID else "coupling-1"
    ) == pytest.approx(-(1e4 + 5j * SPEED) * hand, rel=1e-13)
    assert (found.status == Status.OK).all()
    assert found.residual.max() < 1e-14


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_every_angle_torque_and_reaction_agrees_with_a_dense_solution(dense, line) -> None:
    system, ground, (found,) = _answered(line)
    force = np.array([7.0 * (station.name == "body") for station in system.stations])
    for k, w in enumerate(SPEED):
        angle, torque = dense(system, w, force, ground[:, k])
        assert found.angle[k] == pytest.approx(angle, rel=1e-12, abs=1e-13 * abs(angle).max())
        assert found.torque[k] == pytest.approx(torque, rel=1e-12, abs=1e-12 * abs(torque).max())


@pytest.mark.parametrize("line", LINES.values(), ids=LINES)
def test_mode_shapes_keep_the_equilibrium_of_every_station_that_turns(line) -> None:
    system = assemble(train(line))
    found = modes(system, None)
    rest = (
        (2 * np.pi * found.frequency) ** 2
        * np.where(system.held, 0.0, system.inertia)[:, None]
        * found.shape
    )
    ratio = np.array([float(span.ratio) for span in system.spans])[:, None]
    np.subtract.at(rest, system.driving, found.torque)
    np.add.at(rest, system.driven, found.torque / ratio)
    assert np.abs(rest[~system.held]).max() < 1e-12 * np.abs(found.torque).max()


def test_joints_at_both_walls_push_through_the_springs_behind_them(dense) -> None:
    """Two joints at walls: each imposes its unevenness on a massless body, exactly as the dense equations say."""
    line = [
        WALL,
        Joint(angle="15 deg"),
        SOFT,
        BODY,
        STIFF,
        Joint(angle="9 deg", phase="30 deg"),
        WALL,
    ]
    system, ground, (found,) = _answered(line, pushed=False)
    errors = {k: dict(span.error)[2] for k, span in enumerate(system.spans) if span.error}
    for k, speed in enumerate(SPEED):
        angle, torque = dense(
            system, 2 * speed, np.zeros(len(system.stations)), ground[:, k], errors
        )
        assert found.angle[k] == pytest.approx(angle, rel=1e-12, abs=1e-13 * abs(angle).max())
        assert found.torque[k] == pytest.approx(torque, rel=1e-12, abs=1e-12 * abs(torque).max())


def test_the_exact_motion_of_flat_joints_at_both_walls_has_the_torques_of_the_first_order() -> None:
    text = """
name: x
operation: {speeds: {from: 300 rpm, to: 500 rpm, steps: 2}, rated: {speed: 400 rpm, power: 0.1 W}}
train:
  - disc: {held: true}
  - joint: {angle: 1 deg}
  - coupling: {stiffness: 1e4, viscous: 5}
  - disc: {inertia: 1, damping: 2}
  - coupling: {stiffness: 2e4, viscous: 5}
  - joint: {angle: 2 deg}
  - disc: {held: true}
analyses: {response: {method: harmonic-balance}}
"""
    found = run(parse(text))
    rows = np.isin(found.need(PeriodicResponse).speed, found.need(Response).speed)
    assert np.count_nonzero(rows) == found.need(Response).speed.size == 2
    second = found.need(PeriodicResponse).torque[
        rows, found.need(PeriodicResponse).orders.index(Fraction(2))
    ]
    assert second == pytest.approx(found.need(Response).torque[:, 0], rel=2e-3)


def test_a_joint_between_two_walls_twists_the_spring_by_its_unevenness() -> None:
    line = [WALL, SOFT, Joint(angle="15 deg"), WALL]
    system, _, (found,) = _answered(
        line, pushed=False
    )  # 0 = angle between + error: the spring turns by the error
    amplitude = dict(next(span.error for span in system.spans if span.error))[2]
    assert abs(amplitude) == pytest.approx(math.tan(math.radians(7.5)) ** 2, rel=1e-12)
    assert _torque(system, found, "coupling-1") == pytest.approx(
        amplitude * (1e4 + 10j * SPEED), rel=1e-14
    )


def test_the_same_train_from_either_end_and_with_the_wall_for_the_rigid_body_is_the_same() -> None:
    one = [WALL, RIGID, SOFT, BODY, STIFF, RIGID, WALL]
    for other in (
        one[::-1],
        [WALL, SOFT, BODY, STIFF, WALL],
        [WALL, SOFT, BODY, STIFF, RIGID, WALL],
    ):
        (a, _, (first,)), (b, _, (second,)) = _answered(one), _answered(other)
        places = [[station.name for station in system.stations].index("body") for system in (a, b)]
        assert first.angle[:, places[0]] == pytest.approx(second.angle[:, places[1]], rel=1e-14)
        frequency = [modes(assemble(train(line)), None).frequency for line in (one, other)]
        assert frequency[0] == pytest.approx(frequency[1], rel=1e-15)


def test_a_wall_amid_elastic_spans_to_a_wall_parts_the_train(dense) -> None:
    """The span between two held points moves with neither of them, whatever hangs beyond."""
    system, ground, (found,) = _answered([WALL, SOFT, WALL, STIFF, BODY])
    angle, torque = dense(system, SPEED[1], np.array([0.0, 0.0, 7.0]), ground[:, 1])
    assert found.angle[1] == pytest.approx(angle, rel=1e-13)
    assert found.torque[1] == pytest.approx(torque, rel=1e-13)


FAULTS = {
    "side by side": ([WALL, WALL, SOFT, BODY], ("train", 1, "disc", "held"), "'disc-2' is fixed"),
    "rigid coupling": (
        [WALL, RIGID, WALL, SOFT, BODY],
        ("train", 2, "disc", "held"),
        "'disc-1', which is fixed too",
    ),
    "rigid gear": (
        [WALL, Gear(ratio=2), WALL, SOFT, BODY],
        ("train", 2, "disc", "held"),
        "rigid parts alone",
    ),
    "joint": ([WALL, Joint(angle="5 deg"), WALL], ("train", 1, "joint"), "'joint-1' cannot turn"),
    "joint in line": (
        [WALL, Joint(angle="0 deg"), WALL],
        ("train", 2, "disc", "held"),
        "rigid parts",
    ),
}


@pytest.mark.parametrize(("line", "path", "words"), FAULTS.values(), ids=FAULTS)
def test_two_held_points_with_nothing_elastic_between_are_a_fault_where_they_stand(
    line, path, words
) -> None:
    (fault,) = fixed_point_faults(train(line))
    assert fault.path == path
    assert words in fault.message
    with pytest.raises(InputError, match=words):
        _ = assemble(train(line)).condensed


def test_a_file_with_such_points_is_refused_at_its_line() -> None:
    text = "name: x\ntrain:\n  - disc: {held: true}\n  - joint: {angle: 5 deg}\n  - disc: {held: true}\n"
    with pytest.raises(InputError) as caught:
        parse(text)
    assert [fault.line for fault in caught.value.faults] == [4]
