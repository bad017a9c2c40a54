"""Notches where a shaft is not the same all along, and those that have no answer."""

import pytest

import torsion
from torsion.analyses.fillet_stresses import hole_factor, stated_fillets
from torsion.assembly import assemble
from torsion.errors import InputError, SolveError
from torsion.kernels.round_sections import section_modulus
from torsion.rules.verdict_line import Checks
from torsion.schema.scene_reader import parse

SCENE = """
name: Notches
train:
  - disc: {name: rotor, inertia: 1 kg*m**2}
  - shaft: {name: seat, length: 200 mm, SHAFT}
  - disc: {name: fan, inertia: 1 kg*m**2}
"""


@pytest.mark.parametrize("bores", [(0.02, 0.08), (0.08, 0.02)])
@pytest.mark.parametrize("outer", [(0.1, 0.1), (0.09, 0.1)])
def test_notch_in_a_cone_is_judged_at_its_weaker_end(bores: tuple[float, float], outer: tuple[float, float]) -> None:
    sizes = (f"[{one[0]} m, {one[1]} m]" for one in (outer, bores))
    shaft = "diameter: {}, bore: {}, notches: {{hole: 10 mm}}".format(*sizes)
    system = assemble(parse(SCENE.replace("SHAFT", shaft)).train)
    (found,) = stated_fillets(system)
    worst = max(hole_factor(0.01 / o) / float(section_modulus(o, b)) for o, b in zip(outer, bores, strict=True))
    assert found.factor / found.modulus == pytest.approx(worst, rel=1e-12)


def test_groove_without_an_answer_is_located() -> None:
    splines = "{teeth: 3, root: 10 mm, width: 2 mm, fillet: 0.2 mm}"
    shaft = f"diameter: 100 mm, notches: [{{hole: 9 mm}}, {{splines: {splines}}}]"
    system = assemble(parse(SCENE.replace("SHAFT", shaft)).train)
    with pytest.raises(SolveError, match="does not converge") as raised:
        list(stated_fillets(system))
    assert raised.value.path == ("train", 1, "shaft", "notches", 1)


JUDGED = """
name: Corners
operation:
  speeds: {from: 300 rpm, to: 1800 rpm, steps: 3}
  rated: {speed: 1500 rpm, power: 250 kW}
train:
  - motor: {inertia: 9 kg*m**2, ripple: [{order: 2, torque: 2 %}]}
  - shaft: {name: a, length: 200 mm, diameter: 90 mm, loss_factor: 0.01, endurance: 60 MPa, STEP}
  - shaft: {name: b, length: 300 mm, diameter: 140 mm, HOLE}
  - disc: {name: fan, inertia: 24 kg*m**2}
analyses: {response: }
rules: [fillets]
"""
HOLE = "endurance: 60 MPa, notches: {hole: 9 mm}"


@pytest.mark.parametrize(
    ("step", "outside"),
    [
        ("step: {fillet: 4 mm}", []),
        ("step: sharp", ["sharp step to b"]),
        ("step: {chamfer: 5 mm}", ["chamfer of 5 mm to b"]),
        ("source: drawing", ["step to b"]),
        (
            "step: {undercut: {depth: 2 mm, width: 5 mm, fillet: 1 mm}}",
            ["other corner of the undercut of 2 mm by 5 mm to b"],
        ),
    ],
)
def test_corner_without_a_fillet_beside_an_endurance_is_outside_the_rule(step: str, outside: list[str]) -> None:
    lines = torsion.run(parse(JUDGED.replace("STEP", step).replace("HOLE", HOLE))).need(Checks).lines
    assert [one.what for one in lines if one.verdict == "outside"] == outside


def test_endurance_of_a_shaft_without_a_detail_is_refused() -> None:
    with pytest.raises(InputError, match="finds no fillet or notch with an `endurance`"):
        torsion.run(parse(JUDGED.replace("STEP", "step: sharp").replace("HOLE", "notches: {hole: 9 mm}")))


def test_step_of_the_bore_behind_a_fillet_is_outside_the_rule() -> None:
    text = JUDGED.replace("STEP", "step: {fillet: 4 mm}").replace("HOLE", f"bore: 40 mm, {HOLE}")
    lines = torsion.run(parse(text)).need(Checks).lines
    assert [one.what for one in lines if one.verdict == "outside"] == ["step of the bore to b"]


@pytest.mark.parametrize(("outer", "bore"), [(0.092, 0.085), (0.092, 0.076), (0.1, 0.085)])
def test_fillet_to_a_weaker_tube_has_more_stress_than_the_tube(outer: float, bore: float) -> None:
    """Its K_t is that of both ends: a thin tube behind it makes it larger, and the tube is not judged by itself."""
    larger = f"{outer} m, bore: {bore} m, endurance: 60 MPa"
    text = JUDGED.replace("140 mm, HOLE", larger).replace("STEP", f"step: {{fillet: {outer / 2 - 0.045} m}}")
    (fillet,) = stated_fillets(assemble(parse(text).train))
    assert fillet.factor / fillet.modulus > 1.0 / float(section_modulus(outer, bore)) > 1.0 / fillet.modulus
