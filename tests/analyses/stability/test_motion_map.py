"""Maps of the growth rate, reduced to few modes, against the whole train point by point."""

import numpy as np
import pytest

from torsion.analyses.stability.floquet_exponents import growth_search, modes_that_matter
from torsion.analyses.stability.mechanism_loads import scene
from torsion.analyses.stability.requested_motion import MapSettings, StabilitySettings
from torsion.analyses.stability.stability_over_speed import stability_map
from torsion.analyses.stability.straight_modes import basis
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear
from torsion.model.joint import Joint
from torsion.model.machine import Motor
from torsion.study import Operation, Study
from torsion.train import train


def long_train(
    angle: float = 20.0,
    *,
    torque: float = 300.0,
    factor: float = 1.0,
    loss: float = 0.002,
    **joint: object,
) -> tuple[Study, System]:
    """Twelve discs with two joints in line; damping times a factor."""
    joint.setdefault("inertia", (0.05, 0.05))
    line: list = [Motor(inertia=2.0, damping=0.2 * factor)]
    for k in range(10):
        if k in (3, 7):
            line.append(Joint(angle=f"{angle} deg", **joint))
        shaft = {"loss_factor": loss * factor} if k == 1 else {"viscous": 0.2 * factor}
        line += [Coupling(stiffness=4e4 + 3e3 * k, **shaft), Disc(inertia=0.08)]
    line += [Coupling(stiffness=5e4, viscous=0.2 * factor), Disc(inertia=0.8, damping=0.6 * factor)]
    built = train(line)
    operation = Operation(load=[["1 rad/s", torque], ["1000 rad/s", torque]])
    return Study("long", built, operation=operation), assemble(built)


SPEEDS = np.array([84.0, 90.0, 93.0])


def worst(found: np.ndarray, variants: list[tuple[Study, System]]) -> float:
    """Largest difference to the unreduced trains, 1/s."""
    whole = [[growth_search(*one).growth(float(speed)) for one in variants] for speed in SPEEDS]
    return float(np.abs(found - np.array(whole)).max())


def test_map_over_joint_angle_is_that_of_the_whole_trains():
    degrees = [10.0, 20.0, 30.0]
    found = stability_map(*long_train(), SPEEDS, "angle", np.radians(degrees))
    apart = worst(found.growth, [long_train(angle) for angle in degrees])
    assert apart < 1e-5  # dampers stand for the loss factors of the modes that are kept
    assert found.error < 1e-5
    assert (found.checked, found.elsewhere) == (6, 0)
    assert found.modes < found.of_modes


def test_map_over_damping_is_that_of_the_whole_trains():
    factors = [0.5, 1.5]
    found = stability_map(*long_train(), SPEEDS, "damping", np.array(factors))
    assert worst(found.growth, [long_train(factor=factor) for factor in factors]) < 1e-3


def test_map_over_mean_torque_is_that_of_the_whole_trains():
    factors = [0.0, 2.0]
    found = stability_map(*long_train(), SPEEDS, "torque", np.array(factors))
    assert worst(found.growth, [long_train(torque=300.0 * factor) for factor in factors]) < 1e-3


def test_map_of_a_train_with_massless_joints_is_that_of_the_whole_trains():
    degrees = [10.0, 25.0]
    found = stability_map(*long_train(inertia=None), SPEEDS, "angle", np.radians(degrees))
    assert worst(found.growth, [long_train(angle, inertia=None) for angle in degrees]) < 3e-3


def geared_train(angle: float = 20.0) -> tuple[Study, System]:
    """Two joints with a gear between them that makes their common order a third of the highest."""
    line: list = [Motor(inertia=2.0, damping=0.2)]
    between = {
        2: Joint(angle=f"{angle} deg", inertia=(0.05, 0.05)),
        4: Gear(teeth=(20, 30), inertia=(0.1, 0.2)),
        6: Joint(angle=f"{angle} deg", inertia=(0.05, 0.05)),
    }
    for k in range(8):
        line += [between[k]] if k in between else []
        line += [Coupling(stiffness=4e4 + 3e3 * k, viscous=0.2), Disc(inertia=0.08)]
    line += [Coupling(stiffness=5e4, viscous=0.2), Disc(inertia=0.8, damping=0.6)]
    built = train(line)
    operation = Operation(load=[["1 rad/s", 300.0], ["1000 rad/s", 300.0]])
    return Study("geared", built, operation=operation), assemble(built)


def test_map_of_a_geared_train_keeps_the_modes_that_its_stability_keeps():
    speeds, study_system = np.array([130.0]), geared_train()
    at = scene(*study_system)
    fewer = modes_that_matter(at, basis(at.layout), 130.0)
    found = stability_map(*study_system, speeds, "angle", np.radians([20.0, 30.0]))
    assert found.modes == fewer.modes - fewer.rigid > 3
    expected = [growth_search(*geared_train(angle)).growth(130.0) for angle in (20.0, 30.0)]
    assert found.growth[0] == pytest.approx(expected, abs=5e-4)


def test_map_tells_its_progress_and_needs_a_joint():
    stated: list[float] = []
    stability_map(
        *long_train(),
        SPEEDS[:1],
        "angle",
        np.radians([5.0]),
        progress=lambda what, share: stated.append(share),
    )
    assert stated == [0.0]
    built = train([Disc(inertia=1.0), Coupling(stiffness=1e4), Disc(inertia=1.0)])
    with pytest.raises(SolveError, match="needs a joint"):
        stability_map(Study("none", built), assemble(built), SPEEDS, "damping", np.array([1.0]))


def test_settings_read_ranges_and_refuse_what_cannot_be():
    requested = StabilitySettings(
        method="hill", map={"over": "angle", "from": "1 deg", "to": "30 deg", "steps": 3}
    )
    assert requested.map.values() == pytest.approx(np.radians([1.0, 15.5, 30.0]))
    for wrong in (
        {"from": "3 deg", "to": "1 deg"},
        {"from": "0 deg", "to": "95 deg"},
        {"from": 1, "to": "2 deg"},
    ):
        with pytest.raises(ValueError, match=r"`from`|out of range|no unit"):
            MapSettings(over="angle", **wrong)
    with pytest.raises(ValueError, match="range"):
        MapSettings(over="damping", **{"from": -1, "to": 1})
