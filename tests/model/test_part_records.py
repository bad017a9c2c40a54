"""What a component leaves on its part is what the file says, and nothing above lowering reads a component."""

import ast
from pathlib import Path

import pytest
from tests.for_all import for_all

import torsion
from torsion.errors import InputError
from torsion.model import KINDS
from torsion.model.parts import (
    CouplingRatings,
    GearRating,
    JointRecord,
    NonlinearRecord,
    PendulumRecord,
    PropellerRecord,
)
from torsion.primitives import Bar
from torsion.train import Train

SOURCE = Path(torsion.__file__).parent
ABOVE = [
    path
    for path in SOURCE.rglob("*.py")
    if "model" not in path.parts and "schema" not in path.parts
]
SCENE = """
name: x
train:
  - motor: {name: m, inertia: 2, power: 30 kW, source: maker, note: as built}
  - coupling:
      {stiffness: 5 kN*m/rad, psi: 0.8, rated_torque: 1 kN*m, vibratory_torque: 300, max_torque: 2.5 kN*m,
       heat_limit: 120 W, tolerance: 15 %}
  - damper: {housing: 1, ring: 2, damping: 3}
  - pendulum: {mass: 2, arm: 80 mm, length: 20 mm, number: 3}
  - shaft:
      {length: 1, diameter: [60 mm, 50 mm], role: thrust, features: slot, loss_factor: 0.01,
       support: {at: 0.5, stiffness: 1e6}}
  - joint: {angle: 90e-3 rad, phase: 0.25 rad, kind: tripod, radius: 30 mm, arm: 600 mm, bearing: twin}
  - shaft: {length: 1, diameter: 50 mm}
  - joint: {angle: 0.1 rad, phase: 0.5 rad, plane: 0.125 rad}
  - gear: {ratio: 2, referred: true, application_factor: 1.3}
  - coupling: {flexibility: 0}
  - propeller:
      {inertia: 4, entrained: 25 %, blades: 3, diameter: 1500 mm, damping: {model: frahm, factor: 3}}
  - branch: {train: [{coupling: {stiffness: 1e3, viscous: 7}}, {disc: {inertia: 1}}, {propeller: {inertia: 1}}]}
  - branch: {train: [{turbine: {inertia: 1}}, {generator: {inertia: 1}}, {machine: {inertia: 1}}]}
  - branch: {train: [{pump: {inertia: 1}}, {fan: {inertia: 1}}]}
  - engine: {cylinders: 1, strokes: 2, inertia: 1, power: 9 kW, gas: {table: [[1, 5 N*m, 0 deg]]}}
  - compressor: {stroke: 0.1, rod_length: 0.3, inertia: 1, throws: [{angle: 0 deg, bore: 0.1, reciprocating: 1}]}
operation: {speeds: {from: 100 rpm, to: 200 rpm}}
analyses: {modes: }
"""


@pytest.fixture(scope="module")
def train() -> Train:
    return torsion.parse(SCENE).train


def test_a_part_has_the_figures_of_its_component_in_si(train: Train) -> None:
    part = train.__getitem__
    motor = part("m")
    assert (motor.kind, motor.is_point, motor.is_named, motor.machine.power) == (
        "motor",
        True,
        True,
        30e3,
    )
    assert (motor.source, motor.note) == ("maker", "as built")
    assert (part("damper-1").is_named, part("damper-1").damping) == (False, ("damping", 3.0))
    assert part("coupling-1").ratings == CouplingRatings(1000.0, 300.0, 2500.0, 120.0, 0.15)
    assert part("pendulum-1").pendulum == PendulumRecord(2.0, None, pytest.approx(0.06), 5.0)
    assert part("coupling-1").damping == ("psi", 0.8)
    assert part("coupling-3").damping == ("viscous", 7.0)
    assert (part("gear-1").get(GearRating), part("gear-1").is_point) == (
        GearRating(1.3, None),
        False,
    )
    assert part("propeller-1").propeller == PropellerRecord(4.0, 1.0, 3, 1.5, None, None)
    assert (
        part("propeller-1").machine.damping_model,
        part("propeller-1").machine.damping_factor,
    ) == ("frahm", 3.0)
    assert part("propeller-2").propeller == PropellerRecord(1.0, *[None] * 5)


STAGE = "{from: 0.1 rad, stiffness: 200, hysteresis_torque: 3}"


@for_all(
    ("keys", "record"),
    [
        (
            f"hysteresis_torque: {{torque: 6, stiffness: 50}}, stages: [{STAGE}]",
            NonlinearRecord(
                4e3, friction=((12.0, 200.0),), stages=((0.05, 800.0, (6.0, 100.0 * 800.0)),)
            ),
        ),
        ("capacity: 40", NonlinearRecord(4e3, capacity=80.0)),
        (
            "viscous: 3, clearance: {angle: 0.2 rad, stiffness: 1e3, viscous: 5}",
            NonlinearRecord(4e3, play=0.05, viscous=20.0),
        ),
        ("viscous: 3, clearance: 0.2 rad", NonlinearRecord(4e3, play=0.05, viscous=12.0)),
        ("viscous: 3, clearance: {angle: 0.2 rad, viscous: 0}", NonlinearRecord(4e3, play=0.05)),
    ],
)
def test_referred_figures_of_a_coupling_are_taken_to_half_the_speed(
    keys: str, record: NonlinearRecord
) -> None:
    """Stiffness and damping four times, torques twice, angles half of those referred to the reference."""
    text = (
        "{name: x, train: [{motor: {inertia: 2}}, {gear: {ratio: 2, referred: true}}, "
        f"{{coupling: {{name: c, stiffness: 1e3, {keys}}}}}, {{disc: {{inertia: 4}}}}]}}"
    )
    assert torsion.parse(text).train["c"].nonlinear == record


@for_all(
    ("keys", "words"),
    [
        ("max_torque: 7, hysteresis_torque: 6.9", ""),
        ("max_torque: 7, hysteresis_torque: 7", "the friction of 7 N m is not below the maximum"),
        ("max_torque: 7, hysteresis_torque: [3, 4]", "the friction of 7 N m is not below"),
        ("max_torque: 7, max_torque_rare: 7", ""),
        ("max_torque: 7, max_torque_rare: 6.9", "6.9 N m is below the 7 N m of `max_torque`"),
        ("stages: [{from: 0.1 rad, stiffness: 2}, {from: 0.11 rad, stiffness: 3}]", ""),
        (
            "stages: [{from: 0.1 rad, stiffness: 2}, {from: 0.1 rad, stiffness: 3}]",
            "stages come in the order of the twists",
        ),
    ],
)
def test_figures_of_a_coupling_that_contradict_each_other_are_refused(
    keys: str, words: str
) -> None:
    text = (
        "{name: x, train: [{disc: {inertia: 2}}, "
        f"{{coupling: {{stiffness: 1e3, {keys}}}}}, {{disc: {{inertia: 4}}}}]}}"
    )
    if not words:
        torsion.parse(text)
        return
    with pytest.raises(InputError, match=words):
        torsion.parse(text)


def test_a_joint_has_its_yoke_counted_along_its_shaft_line(train: Train) -> None:
    """Behind a tripod nothing is added: 0.25 of its own, then 0.5 - 0.125 of the cross."""
    assert train["joint-1"].joint == JointRecord("tripod", 0.09, 0.0, 0.25, 0.25, 0, 0.03, 0.6)
    assert train["joint-2"].joint == JointRecord("cross", 0.1, 0.125, 0.5, 0.625, 2, None, None)


def test_a_bar_finds_its_shaft_and_no_other_component(train: Train) -> None:
    first, second = (train.shaft(bar) for bar in train.bars)
    assert (first.material, first.role, first.features) == ("steel", "thrust", ("slot",))
    assert [one.at for one in first.support] == [0.5]
    assert (second.role, second.features, second.support) == (None, (), ())
    assert (train["shaft-1"].damping, train["shaft-2"].damping) == (
        ("loss_factor", 0.01),
        None,
    )
    with pytest.raises(LookupError):
        train.shaft(Bar("m", 0, 0, 1, 1.0, (1.0, 1.0), (0.0, 0.0), 1.0, 1.0))


@for_all("kind", KINDS)
def test_the_parts_of_a_kind_stand_at_their_positions(train: Train, kind: str) -> None:
    found = dict(train.of_kind(kind))
    assert found
    assert all(
        train.parts[number] is part and part.path[-1] == kind for number, part in found.items()
    )


def test_limits_are_known_to_be_there_where_one_is() -> None:
    for position in range(4):
        ratings = CouplingRatings(*(1.0 if k == position else None for k in range(4)), None)
        assert (ratings.limit_anything, ratings.limit_vibration) == (True, position > 0)
    none = CouplingRatings(None, None, None, None, 0.1)
    assert (none.limit_anything, none.limit_vibration) == (False, False)


def test_nothing_above_lowering_knows_a_kind_of_component() -> None:
    kinds = {place.split(":")[0] for place in KINDS.values()}
    for path in ABOVE:
        nodes = list(ast.walk(ast.parse(path.read_text(encoding="utf-8"))))
        assert not kinds & {node.module for node in nodes if isinstance(node, ast.ImportFrom)}, path
        assert "keyword" not in {node.attr for node in nodes if isinstance(node, ast.Attribute)}, (
            path
        )
