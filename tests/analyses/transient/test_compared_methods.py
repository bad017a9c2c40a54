"""Compared methods of integration on a file's own motion: the order of each, and what is refused."""

import math

import numpy as np
import pytest

import torsion
from torsion.analyses.compare.motion_times import timed_motions
from torsion.analyses.compare.timing import Effort
from torsion.analyses.transient.compared_methods import errors_of, linear_curves, marched, solved
from torsion.analyses.transient.torque_curves import Curves
from torsion.analyses.transient.transient_motion import Transients
from torsion.analyses.transient.transient_settings import cases
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.findings import silent
from torsion.kernels.transient.integrator_methods import METHODS
from torsion.output.blocks import Paragraph
from torsion.output.chapters.motion_over_time import chapter

SCENE = """name: x
operation: {{rated: {{speed: 600 rpm, power: 60 kW}}}}
train:
- motor: {{name: drive, inertia: 1}}
- coupling: {{name: rubber, stiffness: 1e4, viscous: 20{more}}}
- disc: {{name: middle, inertia: 0.5}}
- shaft: {{name: line, length: 1 m, diameter: 50 mm, segments: 1, loss_factor: 0.02}}
- propeller: {{name: screw, inertia: 2, blades: 3}}
excitations: [{{at: screw, frequency: 30 Hz, torque: 50 N*m}}]
analyses:
  model: {model}
  transient: {{duration: 0.5 s, {body}}}
"""
RELEASED = "torques: none, initial: {torque: {rubber: 100, line: 50}}"
STEPPED = "events: [{at: drive, time: 0.125 s, step: {torque: 100}}, {at: screw, step: {torque: -70, until: 0.25 s}}]"
PULSED = (
    "events: [{at: drive, time: 0.125 s, pulse: {torque: 100, length: 125 ms, shape: triangle}}]"
)
FOURTH = ("runge-kutta-4",)
EXACT = ("precise",)


def curves(body: str, model: str = "lumped") -> Curves:
    study = torsion.parse(SCENE.format(body=body, model=model, more=""))
    ((settings, place),) = cases(study)
    return linear_curves(study, assemble(study.train, model=model), settings, place)


@pytest.mark.parametrize("body", [RELEASED, PULSED], ids=["released", "pulsed"])
@pytest.mark.parametrize("method", METHODS)
def test_a_method_converges_with_its_order(method: str, body: str) -> None:
    exact = curves(body)
    steps = [0.5 / n for n in ((400, 800) if method in FOURTH else (4000, 8000))]
    coarse, fine = (
        float(errors_of(exact, marched(exact.motion, method, h, 0.5)).max()) for h in steps
    )
    if method in EXACT:
        assert fine < 1e-8
    else:
        assert math.log2(coarse / fine) == pytest.approx(4.0 if method in FOURTH else 2.0, abs=0.15)
        assert fine < 0.05


@pytest.mark.parametrize("method", ["dop853", "radau"])
@pytest.mark.parametrize("model", ["lumped", "fem"])
def test_solvers_that_choose_their_steps_find_the_motion(method: str, model: str) -> None:
    body = f"{STEPPED}, modes: 2"
    exact = curves(body, model)
    coarse, fine = (
        float(errors_of(exact, solved(exact.motion, method, one, 0.5)).max())
        for one in (1e-3, 1e-6)
    )
    assert fine < 1e-5
    assert fine < 0.1 * coarse


def test_a_method_that_grows_has_no_answer() -> None:
    exact = curves(RELEASED)
    assert np.isinf(
        errors_of(exact, marched(exact.motion, "central-differences", 0.006, 5.0)).max()
    )


def test_the_named_method_is_reported_beside_the_exact_motion() -> None:
    plain, named = (
        torsion.run(torsion.parse(SCENE.format(body=f"{STEPPED}{more}", model="lumped", more="")))
        for more in ("", ", method: newmark, step: 0.1 ms")
    )
    (first,), (second,) = (found.need(Transients).each for found in (plain, named))
    np.testing.assert_array_equal(first.torque, second.torque)
    assert first.compared is None
    assert second.compared is not None
    assert second.compared.error is not None
    assert 1e-6 < second.compared.error < 0.1
    texts = [
        one.text
        for one in chapter(named)
        if isinstance(one, Paragraph) and one.text.startswith("Compared")
    ]
    assert texts[0].startswith("Compared: newmark with steps of 0.00010000 s differs by")


@pytest.mark.parametrize(
    ("body", "words"),
    [
        (f"{STEPPED}, step: 1 ms", "`exact` has no step"),
        (f"{STEPPED}, method: newmark", "`newmark` needs a step"),
        (f"{STEPPED}, method: dop853, step: 1 ms", "`dop853` has no step"),
        (f"{STEPPED}, method: euler", "'euler'"),
        (f"{STEPPED}, method: newmark, step: 0", "more than 0"),
    ],
)
def test_a_method_and_its_step_belong_together(body: str, words: str) -> None:
    with pytest.raises(InputError) as refused:
        torsion.parse(SCENE.format(body=body, model="lumped", more=""))
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("more", "body"),
    [
        (", clearance: 1 deg", "method: radau, events: [{at: drive, step: {torque: 1}}]"),
        (
            "",
            "method: bathe, step: 1 ms, events: [{at: drive, start: {torque: [[0 rpm, 9], [900 rpm, 0]]}}]",
        ),
    ],
)
def test_a_method_beside_a_motion_that_is_not_linear_is_refused_at_its_place(
    more: str, body: str
) -> None:
    found = torsion.run(torsion.parse(SCENE.format(body=body, model="lumped", more=more)))
    (one,) = found.plan.unanswered
    assert "compared on linear motions" in one.why
    assert (one.line, one.is_input) == (12, True)


def test_the_study_times_every_method_on_the_motions_of_a_file() -> None:
    effort = Effort(
        rounds=1, longest=0.0, segments=1, unknowns=1, degrees=(1,), modes=1, dense=1, speeds=2
    )
    study = torsion.parse(SCENE.format(body=STEPPED, model="lumped", more=""))
    (found,), remarks = timed_motions(study, 0.0, effort, silent)
    assert remarks == []
    assert len({row.curve for row in found.rows}) == 1 + len(METHODS) + 2
    assert found.bound < 1e-10
    assert all(row.error == 0.0 for row in found.rows if row.curve == "modes, exact")
