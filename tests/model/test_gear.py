"""The gear component: what `referred` refers, and to which speed."""

from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.response.over_speed import response
from torsion.analyses.undamped_modes import modes
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.model.branch import Branch
from torsion.model.coupling import Coupling
from torsion.model.damper import RingDamper
from torsion.model.disc import Disc
from torsion.model.gears.gear import Gear, GearBranch
from torsion.model.machine import Motor, Propeller
from torsion.model.machine_torques import Excitation
from torsion.study import Operation, Study
from torsion.train import Link, train

OPERATION = Operation(
    speeds={"from": "300 rpm", "to": "1500 rpm", "steps": 9},
    rated={"speed": "1500 rpm", "power": 1e5},
)
FIRST, WHEEL, SECOND, THIRD, LAST = (
    Fraction(x) for x in ("5/2", "3/2", "6/5", "4/5", "2/3")
)  # before / after


def _train(referred: bool, also: bool = False) -> list:
    """A train whose first gear is `referred`, or the same with every figure behind it at its own speed, by hand.

    `also`: a gear behind it says `referred` as well, which refers nothing anew.
    """

    def own(value: float, *ratios: Fraction) -> float:
        return value if referred else value * float(np.prod([ratio**2 for ratio in ratios]))

    def soft(value: float, *ratios: Fraction) -> float:
        return value if referred else value / float(np.prod([ratio**2 for ratio in ratios]))

    one, wheel, two, aux = (FIRST,), (FIRST, THIRD), (FIRST, SECOND), (FIRST, LAST)
    hung = (
        Coupling(stiffness=own(2e4, *one), viscous=own(1.0, *one)),
        Gear(
            ratio=THIRD,
            inertia=(own(0.02, *one), own(0.03, *wheel)),
            mesh_stiffness=own(3e5, *one),
            referred=also,
        ),
        Disc(name="fan", inertia=own(0.4, *wheel), stiffness=own(150.0, *wheel)),
        Coupling(stiffness=own(3e4, *wheel)),
        Disc(name="rotor", inertia=own(0.2, *wheel)),
    )
    beside = (
        Coupling(stiffness=own(2e4, WHEEL), viscous=own(1.0, WHEEL)),
        Disc(name="pump", inertia=own(0.7, WHEEL), damping=own(2.0, WHEEL)),
    )
    side = GearBranch(ratio=WHEEL, inertia=own(0.4, WHEEL), mesh_stiffness=4e5, train=beside)
    far = GearBranch(
        ratio=LAST,
        inertia=own(0.05, *aux),
        mesh_stiffness=own(6e5, *one),
        train=(Coupling(stiffness=own(5e4, *aux)), Disc(name="aux", inertia=own(0.3, *aux))),
    )
    return [
        Motor(inertia=3.0),
        Coupling(stiffness=3e4, psi=1.0),
        Gear(
            name="first",
            ratio=FIRST,
            inertia=(0.3, own(0.2, *one)),
            mesh_stiffness=5e5,
            referred=referred,
            branches=(side,),
        ),
        Disc(name="hub", inertia=own(0.05, *one)),
        Branch(train=hung),
        Coupling(
            flexibility=soft(1e-6, *one),
            loss_factor=0.05,
            inertia=(own(0.02, *one), own(0.03, *one)),
        ),
        RingDamper(
            housing=own(0.01, *one),
            ring=own(0.1, *one),
            damping=own(3.0, *one),
            stiffness=own(1e3, *one),
        ),
        Coupling(stiffness=own(7e4, *one)),
        Gear(
            name="second",
            ratio=SECOND,
            inertia=(own(0.01, *one), own(0.02, *two)),
            mesh_stiffness=own(2e5, *one),
            referred=also,
            branches=(far,),
        ),
        Disc(name="end", inertia=own(0.02, *two)),
        Coupling(name="tail", stiffness=own(1e5, *two)),
        Propeller(
            name="screw",
            inertia=own(0.8, *two),
            blades=4,
            damping=own(15.0, *two),
            excitation=[{"blade_order": 1, "torque": 40.0}, {"blade_order": 2, "torque": "5 %"}],
        ),
    ]


def _solved(components: list, links: list):
    excite = [
        Excitation(at="fan", order="3/2", torque=9.0),
        Excitation(at="pump", frequency=20.0, torque=4.0),
    ]
    built = train(components, excitations=excite, links=links)
    study, system = Study("gears", built, operation=OPERATION), assemble(built)
    return (
        modes(system, 8).frequency,
        response(study, system),
        [station.ratio for station in system.stations],
    )


@pytest.mark.parametrize("loop", [False, True])
@pytest.mark.parametrize("also", [False, True])
def test_everything_behind_a_referred_gear_is_at_the_speed_before_it_behind_further_gears_too(
    also, loop
):
    closing = (3e3, 3e3 * float(FIRST * THIRD) ** 2)
    pairs = []
    for referred in (True, False):
        links = [Link(("fan", "rotor"), Coupling(stiffness=closing[not referred]))] if loop else []
        pairs.append(_solved(_train(referred, also and referred), links))
    (frequency, moved, ratios), (own_frequency, own_moved, own_ratios) = pairs
    assert ratios == own_ratios
    assert [line.order for line in moved.lines] == [line.order for line in own_moved.lines]
    np.testing.assert_allclose(frequency, own_frequency, rtol=1e-12)
    np.testing.assert_allclose(moved.mean, own_moved.mean, rtol=1e-12, atol=0.0)
    largest = np.abs(own_moved.torque).max(axis=-1, keepdims=True)
    assert (np.abs(moved.torque - own_moved.torque) / largest).max() < 1e-12


def test_gear_of_equal_wheels_refers_what_stands_behind_the_gears_after_it_too():
    behind = (Gear(ratio=2), Disc(inertia=1.0))
    built = train([Disc(inertia=1.0), Gear(ratio=1, referred=True), *behind])
    assert [lump.inertia for lump in built.inertias] == [1.0, 4.0]
    built = train([Disc(inertia=1.0), Gear(ratio=1), *behind])
    assert [lump.inertia for lump in built.inertias] == [1.0, 1.0]


def test_link_between_a_referred_point_and_one_that_is_not_has_no_speed_to_be_referred_to():
    wheel = GearBranch(ratio=2, train=(Gear(ratio=3, referred=True), Disc(name="b", inertia=1.0)))
    line = [
        Disc(inertia=1.0),
        Gear(ratio=6, branches=(wheel.model_copy(update={"sense": 1}),)),
        Disc(name="a", inertia=1.0),
    ]
    with pytest.raises(InputError, match="not referred to one speed") as raised:
        train(line, links=[Link(("a", "b"), Coupling(stiffness=1e3))])
    assert raised.value.faults[0].path == ("links", 0, "between")
