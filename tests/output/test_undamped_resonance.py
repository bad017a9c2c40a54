"""No output states an amplitude at an undamped resonance, nor a largest one of a range that holds it."""

from dataclasses import replace

import numpy as np
import pytest

import torsion
from torsion.analyses.response.amplitudes import Response, Synthesis
from torsion.analyses.response.synthesis import synthesis
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Paragraph, Table
from torsion.output.document import document
from torsion.output.figures.curves import unanswered
from torsion.output.stored.results_json import results
from torsion.output.stored.scene import NO_VALUE
from torsion.rules.verdict_line import Checks

SCENE = """
name: undamped
operation: {speeds: {from: 300 rpm, to: 2500 rpm, steps: 41}, rated: {speed: 1500 rpm, power: 100 kW}}
materials:
  alloy: {shear_modulus: 79.3 GPa, density: 7850, tensile_strength: 600 MPa}
train:
  - motor: {inertia: 1.2, ripple: [{order: 6, torque: 2 %}]}
  - coupling:
      {name: rubber, stiffness: 20 kN*m/rad, psi: 0, vibratory_torque: 1 GN*m, heat_limit: 1 GW, max_torque: 1 GN*m}
  - shaft: {name: mid, length: 0.8 m, diameter: 60 mm, role: intermediate, material: alloy}
  - gear: {teeth: [20, 41], inertia: [0.05, 0.2], application_factor: 1.35}
  - joint: {name: hooke, angle: 5 deg}
  - shaft: {name: tail, length: 2.0 m, diameter: 90 mm, role: propeller, material: alloy}
  - propeller: {inertia: 0.8, blades: 4, excitation: [{blade_order: 1, torque: 6 %}]}
analyses: {response: {frequencies: {from: 1, to: 200}}}
excitations: [{at: motor-1, torque: 10}]
"""
RULES = "rules: [iacs-m68, coupling-maker, gear-hammer]\n"
OVER_SPEED = (
    "Maximum vibratory torque",
    "Maximum stress",
    "Torque and power loss",
    "Vibratory torque (",
)
OVER_FREQUENCY = ("Maximum torque amplitude",)


@pytest.fixture(scope="module")
def geared() -> Findings:
    """Resonances of every order lie in the range of speeds and in that of frequencies."""
    return torsion.run(torsion.parse(SCENE + RULES, "scene.yaml"))


def test_no_table_states_a_largest_amplitude(geared: Findings) -> None:
    tables = [one.block for one in document(geared).body if isinstance(one.block, Table)]
    for caption in (*OVER_SPEED, *OVER_FREQUENCY):
        (made, *_) = [table for table in tables if table.caption.startswith(caption)]
        assert made.rows
        assert all(NO_VALUE in row for row in made.rows)


def test_the_text_says_so_over_speed_and_over_frequency(geared: Findings) -> None:
    stated = [one.block.text for one in document(geared).body if isinstance(one.block, Paragraph)]
    (over_speed,) = [text for text in stated if "singular" in text]
    (over_frequency,) = [
        text for text in stated if "Hz the response has no reliable finite value" in text
    ]
    assert "no maximum over the range" in over_speed
    assert "no maximum over the range" in over_frequency


def test_every_rule_that_needs_the_amplitude_fails_without_a_value(geared: Findings) -> None:
    """Limits of 1 GN m that no finite torque here exceeds."""
    judged = {
        (c.rule, c.clause): c
        for c in geared.need(Checks).lines
        if c.where in ("rubber", "gear-1", "mid")
    }
    needs = [("coupling-maker", clause) for clause in ("T_KW", "T_Kmax", "P_KW")]
    needs += [
        ("gear-hammer", "(K_A - 1) T_rated"),
        ("gear-hammer", "torque reversal"),
        ("iacs-m68", "tau_T"),
    ]
    for key in needs:
        assert (judged[key].verdict, judged[key].value) == ("fail", np.inf)
    assert geared.failed


def test_without_a_rule_nothing_failed(geared: Findings) -> None:
    assert not torsion.run(torsion.parse(SCENE, "scene.yaml")).failed


def test_sum_of_all_lines_is_not_finite_where_a_line_is_not_ok(geared: Findings) -> None:
    bad = geared.need(Response).unreliable
    assert bad.any()
    assert not np.isfinite(geared.need(Synthesis).half_range[bad]).any()
    assert np.isfinite(geared.need(Synthesis).half_range[~bad]).all()


def test_results_hold_null_where_a_line_is_not_ok(geared: Findings) -> None:
    status = geared.need(Response).status.copy()
    status[0, 1], status[1, 0] = Status.NEAR_SINGULAR, Status.SINGULAR
    response = replace(geared.need(Response), status=status)
    flagged = geared.having(response=response, synthesis=synthesis(response))
    found = results(flagged)
    assert found["response"]["lines"][1]["status"][0] == "near-singular"
    for line in found["response"]["lines"]:
        for word, torque, angle in zip(
            line["status"], line["torque_Nm"], line["angle_rad"], strict=True
        ):
            unknown = {part is None for pair in (*torque, *angle) for part in pair}
            assert unknown == {word != "ok"}
    for values in (
        row for key, rows in found["synthesis"].items() if key.endswith("_Nm") for row in rows
    ):
        assert [value is None for value in values] == flagged.need(Response).unreliable.tolist()


def test_no_curve_runs_inside_the_hatching() -> None:
    """A lone speed is hatched by a thousandth of the range to either side, a wide one to its neighbours."""
    x = np.array([0.0, 100.0, 499.4, 499.6, 500.0, 500.1, 501.0, 700.0, 800.0, 1000.0])
    inside, _ = unanswered(x, np.isin(x, [500.0, 800.0]))
    assert x[inside].tolist() == [499.4, 499.6, 500.0, 500.1, 800.0]
