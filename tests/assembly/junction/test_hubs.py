"""Shafts in hubs on their ends, against mixed boundaries in closed form and laws of long hubs; keyways in a train."""

import math

import numpy as np
import pytest
from scipy.special import jn_zeros
from tests.for_all import for_all

import torsion
from torsion.analyses.modes.steps_and_hubs import HubMoves, SharpSteps
from torsion.analyses.response.amplitudes import Synthesis
from torsion.analyses.response.fillet_stresses import Fillets
from torsion.analyses.undamped_modes import Modes, modes
from torsion.assembly import assemble
from torsion.assembly.junction.hubs import bonded
from torsion.errors import InputError
from torsion.rules.verdict_line import Checks
from torsion.schema.scene_reader import parse

SCENE = """name: Hub
operation: {speeds: {from: 300 rpm, to: 1800 rpm, steps: 31}, rated: {speed: 1500 rpm, power: 250 kW}}
train:
  - motor: {inertia: 9, ripple: [{order: 2, torque: 2 %%}]}
  - shaft: {name: a, length: 400 mm, diameter: 100 mm, role: intermediate, endurance: 60 MPa%s}
  - disc: {inertia: 24}
rules: [%s]
materials:
  steel: {shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa}
  bronze: {shear_modulus: 39.65 GPa, density: 8800}
  air: {shear_modulus: 2 MPa, density: 1100, unusual: true}
  gum: {shear_modulus: 2 GPa, density: 1100}
"""
KEYWAY = "{keyway: {width: 25 mm, depth: 14 mm, fillet: 2 mm}}"


def test_shaft_clamped_on_its_surface_is_that_of_wiener_and_hopf() -> None:
    """A long shaft, free and then clamped all around: k I_2/I_1 in factors has the zeros of J_2 and J_1.

    Its further twist is that of sum(1/j_1n - 1/j_2n) radii; the tail of the sum by its leading term.
    """
    number = 4000
    tail = 1.0 / (2.0 * math.pi * (number + 1.0))
    length = float(np.sum(1.0 / jn_zeros(1, number) - 1.0 / jn_zeros(2, number))) + tail
    thin = [bonded(2.0, 1.0 + step, 0.0, "rim")[0] for step in (4e-4, 2e-4)]
    assert 2.0 * thin[1] - thin[0] == pytest.approx(length / 2.0, rel=1e-3)


def test_every_further_length_of_a_hub_fixed_at_its_face_twists_as_the_solid_of_both() -> None:
    short, long = (bonded(length, 1.6, 0.0, "face")[0] for length in (2.0, 3.0))
    assert long - short == pytest.approx(1.6**-4, abs=1e-5)
    assert bonded(3.0, 1.6, 0.0, "rim")[0] == pytest.approx(
        bonded(2.0, 1.6, 0.0, "rim")[0], abs=2e-5
    )


def test_hub_of_the_material_of_its_shaft_is_the_limit_of_equal_moduli() -> None:
    for torque in ("rim", "face"):
        found, error = bonded(1.0, 1.8, 0.0, torque)
        near, other = bonded(1.0, 1.8, 0.0, torque, 1.0 + 1e-9)
        assert abs(near - found) <= error + other


def test_very_stiff_hub_clamps_the_surface_of_its_shaft() -> None:
    """Whatever its diameter, and wherever it is fixed: the length of Wiener and Hopf, 1e5 its distance from rigid."""
    number = 4000
    tail = 1.0 / (2.0 * math.pi * (number + 1.0))
    length = float(np.sum(1.0 / jn_zeros(1, number) - 1.0 / jn_zeros(2, number)) + tail) / 2.0
    for hub, torque in ((1.4, "rim"), (1.8, "rim"), (1.8, "face")):
        found, error = bonded(2.0, hub, 0.0, torque, 1e5)
        assert abs(found - length) < error + 2e-5
        assert error < 2e-5


@pytest.mark.parametrize("modulus", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize("bore", [0.0, 0.5])
def test_very_soft_hub_is_an_elastic_bed_of_its_shaft(modulus: float, bore: float) -> None:
    """G I theta'' = k theta: coth(lambda L)/lambda, lambda^2 = k/(G I), k = 4 pi G_h/(1/a^2 - 1/b^2) of the ring.

    The ring's 1/k alone is too little, with the shaft's own shear across, a^2/(24 G I) where it is solid, too much.
    """
    length, hub = 1.0, 1.8
    area = math.pi / 32.0 * (1.0 - bore**4)
    bed = (4.0 - 4.0 / hub**2) / (4.0 * math.pi * modulus)
    across = 0.25 / (24.0 * area)
    rates = [1.0 / math.sqrt(area * one) for one in (bed, bed + across)]
    low, high = (1.0 / (math.tanh(rate * length) * rate) for rate in rates)
    found, error = bonded(length, hub, bore, "rim", modulus)
    assert low < found - error < found + error < high
    assert error < 2e-5 * found


@pytest.mark.parametrize("modulus", [0.35, 2.6])
def test_long_hub_of_another_material_twists_as_the_sum_of_both_stiffnesses(modulus: float) -> None:
    short, long = (bonded(length, 1.6, 0.0, "face", modulus)[0] for length in (2.0, 3.0))
    assert long - short == pytest.approx(1.0 / (1.0 + modulus * (1.6**4 - 1.0)), abs=2e-5)


@pytest.mark.parametrize("model", ["lumped", "fem", "exact"])
@pytest.mark.parametrize(
    ("hub", "left"),
    [
        ("{length: 120 mm, fit: key}", 0.04),
        ("{length: 120 mm, fit: key, end: first}", 0.04),
        ("{length: 120 mm, fit: shrink, diameter: 180 mm}", 0.1 * bonded(1.2, 1.8, 0.0, "rim")[0]),
        (
            "{length: 120 mm, fit: shrink, diameter: 180 mm, torque: face}",
            0.1 * bonded(1.2, 1.8, 0.0, "face")[0],
        ),
        (
            "{length: 120 mm, fit: shrink, diameter: 180 mm, material: bronze}",
            0.1 * bonded(1.2, 1.8, 0.0, "rim", 0.5)[0],
        ),
    ],
)
def test_hub_leaves_a_part_of_its_seat_to_twist(model: str, hub: str, left: float) -> None:
    found = modes(
        assemble(parse(SCENE % (f", hub: {hub}", "")).train, model, frequency=300.0), 1
    ).frequency[0]
    bare = modes(assemble(parse(SCENE % ("", "")).train, model, frequency=300.0), 1).frequency[0]
    assert found / bare == pytest.approx(
        math.sqrt(0.4 / (0.28 + left)), rel=1e-4
    )  # the shaft has a little inertia


def test_notches_are_judged_by_their_endurance_and_lower_the_limits_of_class_rules() -> None:
    plain = torsion.run(parse(SCENE % ("", "iacs-m68"))).need(Checks).lines
    found = torsion.run(
        parse(SCENE % (f", notches: [{KEYWAY}, {{hole: 8 mm}}]", "iacs-m68, fillets"))
    )
    lines = [line for line in found.need(Checks).lines if line.clause != "endurance"]
    assert [(line.clause, line.where, line.value) for line in lines] == [
        (line.clause, line.where, line.value) for line in plain
    ]
    pairs = zip(lines, plain, strict=True)
    (factor,) = {
        line.limit / before.limit
        for line, before in pairs
        if line.clause == "tau_C" and line.limit > 0
    }
    assert factor == pytest.approx(0.45, rel=1e-12)  # C_K of a cylinder keyway, of a flange 1
    own = [line for line in found.need(Checks).lines if line.clause == "endurance"]
    for one, line in zip(found.need(Fillets).each, own, strict=True):
        torque = found.need(Synthesis).half_range[:, one.spans].max()
        assert one.peak == pytest.approx(one.factor * torque * 16.0 / (math.pi * 1e-3), rel=1e-12)
        assert line.value == pytest.approx(1e-6 * one.peak * (1.0 + (one.error or 0.0)), rel=1e-12)
    keyway, hole = found.need(Fillets).each
    assert (keyway.form, hole.form, hole.error) == ("keyway", "hole", None)
    assert keyway.factor == pytest.approx(keyway.peterson, rel=0.04)


def test_a_hub_leaves_the_fillet_and_the_sharp_step_beside_it_as_they_are() -> None:
    """A hub takes from the twist of a shaft, not from the modulus of its material."""
    rest = "\n  - shaft: {name: b, length: 400 mm, diameter: 110 mm}\n  - shaft: {name: c, length: 1 m, diameter: 140 mm"
    hub = ", hub: {length: 150 mm, fit: key%s}"
    found = []
    for own, last in (("", ""), (hub % ", end: first", hub % "")):
        results = torsion.run(
            parse(SCENE % (f", step: {{fillet: 3 mm}}{own}}}{rest}{last}", "fillets"))
        )
        steps, (fillet,) = results.need(SharpSteps).steps, results.need(Fillets).each
        found.append((fillet.factor, [step.flexibility for step in steps]))
    assert found[0] == found[1]


@pytest.mark.parametrize("model", ["lumped", "exact"])
def test_each_hub_moves_the_frequencies_as_its_absence_from_the_file(model: str) -> None:
    first, last = (
        "{length: 120 mm, fit: shrink, diameter: 180 mm, end: first}",
        "{length: 90 mm, fit: key}",
    )
    settings = f"analyses: {{model: {model}, modes: {{count: 2}}}}\n"
    both, *alone = (
        torsion.run(parse(SCENE % (f", hub: [{hubs}]", "") + settings))
        for hubs in (f"{first}, {last}", last, first)
    )
    for move, other, error in zip(both.need(HubMoves).each, alone, (True, False), strict=True):
        without = other.need(Modes).frequency
        rtol = (
            1e-12 if model == "exact" else 1e-4
        )  # lumped: divided as the shaft with the hub, not by itself
        np.testing.assert_allclose(move.frequency, without, rtol=rtol)
        np.testing.assert_allclose(
            move.change, both.need(Modes).frequency / move.frequency - 1.0, rtol=1e-9
        )
        assert move.change[0] > 0.01
        assert (move.error is not None) is error
    assert both.need(HubMoves).each[1].twisting == pytest.approx(0.03, rel=1e-12)


@for_all(
    ("keys", "at", "words"),
    [
        ("hub: {length: 500 mm, fit: key}", "5:", "hub is longer than its shaft"),
        ("hub: {length: 50 mm, fit: shrink}", "5:", "lacks its `diameter`"),
        ("hub: {length: 50 mm, fit: key, diameter: 0.2}", "5:", "has no `diameter`"),
        ("hub: {length: 50 mm, fit: shrink, diameter: 90 mm}", "5:", "not larger than its shaft"),
        ("hub: {length: 50 mm, fit: key, material: steel}", "5:", "has no `material`"),
        (
            "hub: {length: 50 mm, fit: shrink, diameter: 180 mm, material: brass}",
            "5:",
            "no material is called 'brass'",
        ),
        (
            "hub: {length: 50 mm, fit: shrink, diameter: 180 mm, material: gum, torque: face}",
            "5:",
            "below 0.1",
        ),
        (
            "hub: {length: 50 mm, fit: key, pressure: 60 MPa, friction: 0.1}",
            "5:",
            "has no `pressure`",
        ),
        (
            "hub: {length: 50 mm, fit: shrink, diameter: 180 mm, pressure: 60 MPa}",
            "5:",
            "needs",
        ),
        (
            "hub: {length: 50 mm, fit: shrink, diameter: 180 mm, material: air}",
            "5:",
            "below 0.0001",
        ),
        ("hub: {length: 50 mm, fit: key}, step: sharp", "5:", "the place of a `step`"),
        ("hub: [{length: 50 mm, fit: key}, {length: 60 mm, fit: key}]", "5:", "sit on one end"),
        (
            "notches: {keyway: {width: 20 mm, depth: 4 mm, fillet: 5 mm}}",
            "5:",
            "not smaller than the depth",
        ),
        (
            "notches: {keyway: {width: 8 mm, depth: 6 mm, fillet: 5 mm}}",
            "5:",
            "larger than half the width",
        ),
        (
            "notches: {keyway: {width: 60 mm, depth: 30 mm, fillet: 1 mm}}",
            "5:",
            "no room for keyway",
        ),
        (
            "notches: {keyway: {width: 25 mm, depth: 9 mm, fillet: 1 mm, number: 12}}",
            "5:",
            "number is too large",
        ),
        (
            "notches: {splines: {teeth: 10, root: 110 mm, width: 15 mm, fillet: 1 mm}}",
            "5:",
            "root is not smaller",
        ),
        (
            "notches: {splines: {teeth: 10, root: 80 mm, width: 30 mm, fillet: 1 mm}}",
            "5:",
            "do not fit",
        ),
        ("notches: {hole: 30 mm}", "5:", "larger than 0.2"),
        (
            "notches: {hole: 8 mm, keyway: {width: 25 mm, depth: 9 mm, fillet: 1 mm}}",
            "5:",
            "one form",
        ),
    ],
)
def test_faults_of_details_are_located(keys: str, at: str, words: str) -> None:
    with pytest.raises(InputError) as error:
        parse(SCENE % (f", {keys}", ""))
    line = next(one for one in str(error.value).splitlines() if words in one)
    assert f":{at}" in line or line.startswith(at)
    column = int(line.split(":5:")[1].split(":")[0]) if ":5:" in line else int(line.split(":")[1])
    assert column > 90  # in what the keys state, not at the shaft


def test_hubs_that_hold_a_shaft_along_its_length_leave_no_shaft() -> None:
    """Of two seats some 20 mm each are left to twist, and what lies between them: below a twentieth it is refused."""
    hub = "{length: %d mm, fit: shrink, diameter: 180 mm, end: %s}"
    for length, is_refused in ((900, False), (990, True)):
        hubs = f", hub: [{hub % (length, 'first')}, {hub % (length, 'last')}]"
        text = SCENE.replace("400 mm", "2 m") % (hubs, "")
        if is_refused:
            with pytest.raises(InputError, match=r":5:12: hubs and fillets take up the complete"):
                torsion.run(parse(text))
        else:
            assert torsion.run(parse(text)).need(Modes).frequency.size
