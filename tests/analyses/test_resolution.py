"""A system knows up to which frequency its shafts are resolved; modes and response beyond it refine, or say so."""

import math
from functools import cache

import numpy as np
import pytest
from scipy.optimize import brentq

import torsion
from torsion import assembly
from torsion.analyses.response.over_frequency import frequency_response
from torsion.analyses.undamped_modes import Modes

MODELS = {"lumped": 1e-3, "fem": 1e-6, "exact": 1e-12}  # error that each promises
SHAFTS = [(3.0, 0.09), (2.0, 0.14), (4.0, 0.07)]  # m, length and diameter
MODULUS, DENSITY = 79.3e9, 7850.0  # steel
DISCS = (10.0, 4.0)  # kg m2
STEPPED = "\n".join(
    [
        "name: stepped",
        "train:",
        f"- disc: {{name: first, inertia: {DISCS[0]}}}",
        *(f"- shaft: {{length: {length}, diameter: {outer}}}" for length, outer in SHAFTS),
        f"- disc: {{name: last, inertia: {DISCS[1]}}}",
    ]
)
EXCITED = "\noperation: {speeds: {from: 30 rad/s, to: 150 rad/s}}\nexcitations: [{at: first, order: 20, torque: 100}]\n"


def torque_behind(hertz: float | np.ndarray) -> float | np.ndarray:
    """N m behind the last disc where the first one turns by 1 rad, no torque on it: continua, closed form."""
    w = 2.0 * math.pi * hertz
    angle, torque = 1.0, -w * w * DISCS[0]
    for length, outer in SHAFTS:
        wave = w * math.sqrt(DENSITY / MODULUS)
        stiff = MODULUS * math.pi * outer**4 / 32.0 * wave
        c, s = np.cos(wave * length), np.sin(wave * length)
        angle, torque = c * angle + s / stiff * torque, c * torque - stiff * s * angle
    return torque - w * w * DISCS[1] * angle


@cache
def stepped_frequencies(count: int) -> np.ndarray:
    """(count,) Hz: both ends are free of torque."""
    scan = np.linspace(1.0, 2000.0, 40_001)
    value = torque_behind(scan)
    roots = [
        brentq(torque_behind, *scan[k : k + 2], xtol=1e-12, rtol=1e-14)
        for k in np.flatnonzero(value[:-1] * value[1:] < 0)
    ]
    return np.array(roots[:count])


def assembled(text: str, model: str, **settings: object):
    return torsion.assemble(torsion.parse(text).train, model=model, **settings)


@pytest.mark.parametrize("model", MODELS)
def test_modes_of_a_system_assembled_without_a_frequency_are_right(model):
    found = torsion.modes(assembled(STEPPED, model), count=7)
    np.testing.assert_allclose(found.frequency, stepped_frequencies(7), rtol=MODELS[model])
    assert found.certified
    assert found.frequency[-1] <= found.system.resolved_to
    assert found.shape.shape == (len(found.system.stations), 7)
    assert found.torque.shape == (len(found.system.spans), 7)


@pytest.mark.parametrize("model", MODELS)
def test_python_and_the_command_give_the_same_frequencies(model):
    requested = f"\nanalyses: {{model: {model}, modes: {{count: 7}}}}\n"
    of_command = torsion.run(torsion.parse(STEPPED + requested))
    found = torsion.modes(assembled(STEPPED, model), count=7)
    np.testing.assert_array_equal(found.frequency, of_command.need(Modes).frequency)
    assert found.system.segments == of_command.system.segments


@pytest.mark.parametrize("model", ["lumped", "fem"])
def test_without_refinement_a_mode_that_is_not_resolved_is_an_error(model):
    coarse = assembled(STEPPED, model)
    with pytest.raises(torsion.SolveError, match=r"resolved up to .* Hz"):
        torsion.modes(coarse, count=7, refine=False)
    fine = assembled(STEPPED, model, frequency=stepped_frequencies(7)[-1])
    found = torsion.modes(fine, count=7, refine=False)
    assert found.system is fine
    np.testing.assert_allclose(found.frequency, stepped_frequencies(7), rtol=MODELS[model])


@pytest.mark.parametrize(("model", "degree"), [("lumped", None), ("fem", 2), ("fem", 3)])
def test_a_shaft_keeps_its_promise_up_to_the_frequency_to_which_it_is_resolved(model, degree):
    """A uniform shaft held at both ends: half waves of c/(2 L)."""
    ends = "\n- disc: {held: true}"
    text = f"name: held\ntrain:{ends}\n- shaft: {{length: 1, diameter: 50 mm}}{ends}"
    system = assembled(text, model, frequency=20_000.0, **({"degree": degree} if degree else {}))
    half_wave = math.sqrt(MODULUS / DENSITY) / 2.0
    assert 20_000.0 <= system.resolved_to <= 25_000.0
    number = math.floor(system.resolved_to / half_wave)
    found = torsion.modes(system, count=number, refine=False).frequency
    wanted = half_wave * np.arange(1, number + 1)
    np.testing.assert_allclose(found, wanted, rtol=MODELS[model] * 1.02)
    assert (
        abs(found[-1] / wanted[-1] - 1.0) > MODELS[model] / 5.0
    )  # nor is it more than what was requested


def test_discs_springs_and_stated_segments_leave_nothing_to_refine():
    springs = assembled(
        "name: s\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 10}, disc: {inertia: 1}]",
        "lumped",
    )
    assert math.isinf(springs.resolved_to)
    assert torsion.modes(springs, 1, refine=False).system is springs
    stated = assembled(STEPPED.replace("length:", "segments: 3, length:"), "lumped")
    assert math.isinf(stated.resolved_to)
    assert torsion.modes(stated, 4).system is stated
    assert math.isinf(assembled(STEPPED, "exact").resolved_to)


def test_more_modes_than_segments_are_an_error_only_where_they_must_not_be_refined():
    coarse = assembled(STEPPED, "lumped")
    with pytest.raises(torsion.SolveError, match="so many modes"):
        torsion.modes(coarse, count=200, refine=False)
    assert torsion.modes(coarse, count=20).frequency.size == 20


def test_shafts_that_cannot_be_refined_enough_are_an_error(monkeypatch):
    monkeypatch.setattr(assembly, "MOST", 8)
    for count in (7, 60):  # resolved too coarsely, and fewer modes than requested
        with pytest.raises(torsion.SolveError, match="resolved up to"):
            torsion.modes(assembled(STEPPED, "lumped"), count=count)


@pytest.mark.parametrize("model", MODELS)
def test_a_response_beyond_the_resolution_refines_the_shafts(model):
    """The angle of the last disc under 100 N m at the first: that of the continua."""
    scene = torsion.parse(STEPPED + EXCITED)
    speeds = np.array([30.0, 100.0, 150.0])  # rad/s; order 20 up to 477 Hz
    coarse = torsion.assemble(scene.train, model=model)
    found = torsion.response(scene, coarse, speeds=speeds)
    at = [int(np.flatnonzero(found.speed == speed)[0]) for speed in speeds]
    last = 100.0 / torque_behind(20.0 * np.array(speeds) / (2.0 * math.pi))
    station = scene.train["last"].stations[0]
    np.testing.assert_allclose(found.angle[at, 0, station], last, rtol=50 * MODELS[model])
    assert found.system.resolved_to >= 20.0 * 150.0 / (2.0 * math.pi)
    assert found.torque.shape[2] == len(found.system.spans)
    if model != "exact":
        with pytest.raises(torsion.SolveError, match="resolved up to"):
            torsion.response(
                scene,
                torsion.assemble(scene.train, model, frequency=10.0),
                speeds=10 * speeds,
                refine=False,
            )


def test_a_response_over_frequency_beyond_the_resolution_refines_the_shafts():
    text = (
        EXCITED.replace("order: 20, ", "")
        + "analyses: {response: {frequencies: {from: 40, to: 300}}}\n"
    )
    scene = torsion.parse(STEPPED + text)
    coarse = torsion.assemble(scene.train, model="lumped")
    hertz = np.array([40.0, 300.0])
    found = frequency_response(scene, coarse, frequencies=hertz)
    at = [int(np.flatnonzero(found.frequency == one)[0]) for one in hertz]
    last = 100.0 / torque_behind(np.array(hertz))
    station = scene.train["last"].stations[0]
    np.testing.assert_allclose(found.angle[at, station], last, rtol=0.05)
    assert found.system.resolved_to >= 300.0
    with pytest.raises(torsion.SolveError, match="resolved up to"):
        frequency_response(scene, coarse, frequencies=hertz, refine=False)


def test_modes_of_a_coarser_system_do_not_serve_a_refined_response():
    scene = torsion.parse(STEPPED + EXCITED)
    coarse = torsion.assemble(scene.train, model="lumped")
    known = torsion.modes(coarse, 20)
    plain, given = (
        torsion.response(scene, coarse, speeds=np.array([30.0, 150.0]), modes=m)
        for m in (None, known)
    )
    np.testing.assert_array_equal(plain.angle, given.angle)
