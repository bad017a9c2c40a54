"""Rule `shrink-fits`: what friction carries in a shrink fit, by integration over it, and its verdicts at the limit."""

import math

import numpy as np
import pytest
from scipy.integrate import dblquad

import torsion
from torsion.analyses.motion.transient_motion import Transients
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.errors import InputError
from torsion.rules.strength.shrink_fits import slip_torque
from torsion.rules.verdict_line import Checks
from torsion.schema.scene_reader import parse

SCENE = """name: Fit
operation: {speeds: {from: 300 rpm, to: 1800 rpm, steps: 31}, rated: {speed: 1500 rpm, power: 250 kW}}
train:
  - motor: {inertia: 9, ripple: [{order: 2, torque: 2 %%}]}
  - shaft: {name: a, length: 400 mm, diameter: 100 mm, hub: {length: 120 mm, %s}}
  - disc: {inertia: 24}
rules: [shrink-fits%s]
"""
FIT = "diameter: 180 mm, fit: shrink, pressure: %.17g Pa, friction: 0.15"


def line(pressure: float, settings: str = ": {safety: 1.5}"):
    results = torsion.run(parse(SCENE % (FIT % pressure, settings)))
    (found,) = results.need(Checks).lines
    return results, found


def test_slip_torque_is_the_moment_of_friction_all_over_the_seat() -> None:
    radius, length, pressure, friction = 0.06, 0.11, 45e6, 0.12
    moment = dblquad(
        lambda turn, z: radius * friction * pressure * radius, 0.0, length, 0.0, 2.0 * math.pi
    )[0]
    assert slip_torque(2.0 * radius, length, pressure, friction) == pytest.approx(moment, rel=1e-12)


def test_fit_passes_to_its_slip_torque_over_the_safety_and_fails_above() -> None:
    results, found = line(60e6)
    response, synthesis = results.need(Response), results.need(Synthesis)
    most = float(synthesis.peak.max())
    assert most > 1.001 * float(
        np.abs(response.mean).max()
    )  # vibration is in it, beside the mean torque
    assert found.value == pytest.approx(most, rel=1e-12)
    assert found.limit == pytest.approx(slip_torque(0.1, 0.12, 60e6, 0.15) / 1.5, rel=1e-12)
    enough = 60e6 * found.value / found.limit
    assert [line(share * enough)[1].verdict for share in (1.0 + 1e-6, 1.0 - 1e-6)] == [
        "restricted",
        "fail",
    ]
    assert line(2.0 * enough, "")[1].limit == pytest.approx(
        1.5 * found.value, rel=1e-9
    )  # 2 where nothing is set


def test_slip_reaches_into_the_seat_by_its_share_of_the_slip_torque() -> None:
    _, found = line(60e6)
    reach = 120.0 * found.value / (1.5 * found.limit)
    assert f"slip reaches over at most {reach:.3g} of 120 mm" in found.note


@pytest.mark.parametrize(
    ("hub", "power", "words"),
    [
        ("diameter: 180 mm, fit: shrink", ", power: 250 kW", "finds no hub with a `pressure`"),
        (FIT % 60e6, "", "the mean torque is not known"),
    ],
)
def test_what_the_rule_lacks_is_a_fault(hub: str, power: str, words: str) -> None:
    with pytest.raises(InputError, match=words):
        parse(
            (SCENE % (hub, ""))
            .replace(", power: 250 kW", power)
            .replace("ripple: [{order: 2, torque: 2 %}]", "ripple: [{order: 2, torque: 20 N*m}]")
        )


@pytest.mark.parametrize(
    ("step", "safety", "verdict"),
    [(10.0, 1.0, "restricted"), (10.0, 1.5, "not judged"), (30.0, 1.0, "fail")],
)
def test_a_motion_of_the_file_slips_the_fit(step: float, safety: float, verdict: str) -> None:
    """A step of torque on the motor sets shaft and discs, 9 and 24 kg m2, to twice its share for the load."""
    text = SCENE % (FIT % 80e6, f": {{safety: {safety}}}")
    event = f"{{at: motor-1, time: 0.01 s, step: {{torque: {step} kN*m}}}}"
    text += f"analyses: {{transient: {{duration: 60 ms, torques: none, events: [{event}]}}}}\n"
    results = torsion.run(parse(text))
    steady, motion = results.need(Checks).lines
    (transient,) = results.need(Transients).each
    before, added = float(np.abs(transient.before).max()), 2e3 * step * 24.0 / 33.0
    assert motion.value == pytest.approx(before + added, rel=1e-3)
    assert motion.limit == pytest.approx(slip_torque(0.1, 0.12, 80e6, 0.15), rel=1e-12)
    assert motion.verdict == verdict
    assert steady.verdict == "restricted"
    assert "transient responses of the file" in steady.restrictions[0]
