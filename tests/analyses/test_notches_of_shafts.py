"""Notches where a shaft is not the same all along, and those that have no answer."""

import math

import pytest

import torsion
from torsion.analyses.response.amplitudes import Synthesis
from torsion.analyses.response.fillet_stresses import (
    Fillets,
    endurance,
    hole_factor,
    stated_fillets,
)
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
def test_notch_in_a_cone_is_judged_at_its_weaker_end(
    bores: tuple[float, float], outer: tuple[float, float]
) -> None:
    sizes = (f"[{one[0]} m, {one[1]} m]" for one in (outer, bores))
    shaft = "diameter: {}, bore: {}, notches: {{hole: 10 mm}}".format(*sizes)
    system = assemble(parse(SCENE.replace("SHAFT", shaft)).train)
    (found,) = stated_fillets(system)
    worst = max(
        hole_factor(0.01 / o) / float(section_modulus(o, b))
        for o, b in zip(outer, bores, strict=True)
    )
    assert found.factor / found.modulus == pytest.approx(worst, rel=1e-12)


def test_groove_without_an_answer_is_located(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("torsion.assembly.section.grooved_sections.ROUNDS", 2)
    splines = "{teeth: 3, root: 10 mm, width: 2 mm, fillet: 0.1 mm}"
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
FILLET = "corner in the bore, at the fillet of 4 mm, to b"
HOLE = "endurance: 60 MPa, notches: {hole: 9 mm}"


@pytest.mark.parametrize(
    ("step", "unjudged"),
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
def test_corner_without_a_fillet_beside_an_endurance_is_not_judged(
    step: str, unjudged: list[str]
) -> None:
    lines = (
        torsion.run(parse(JUDGED.replace("STEP", step).replace("HOLE", HOLE))).need(Checks).lines
    )
    assert [one.what for one in lines if one.verdict == "not judged"] == unjudged


def test_corner_in_the_bore_behind_a_fillet_is_not_judged() -> None:
    text = JUDGED.replace("STEP", "step: {fillet: 4 mm}").replace("HOLE", "bore: 40 mm")
    lines = torsion.run(parse(text)).need(Checks).lines
    assert [one.what for one in lines if one.verdict == "not judged"] == [FILLET]


FLANGE = "step: {flange: {diameter: 900 mm, thickness: 200 mm, fillet: 8 mm}}"
SMALL, LARGE = "diameter: 90 mm", "diameter: 140 mm"


@pytest.mark.parametrize("sizes", [(SMALL, LARGE), (LARGE, SMALL)])
def test_fillet_on_a_flange_has_the_torque_of_its_own_side(sizes: tuple[str, str]) -> None:
    text = JUDGED.replace("STEP", FLANGE).replace("HOLE", "endurance: 60 MPa")
    text = text.replace(SMALL, "FIRST").replace(LARGE, sizes[1]).replace("FIRST", sizes[0])
    found = torsion.run(parse(text))
    (one,) = found.need(Fillets).each
    own = found.system.span_part == found.study.train.positions["ab"[sizes.index(SMALL)]]
    torque = found.need(Synthesis).half_range[:, own].max(axis=1)
    assert one.nominal is not None
    assert one.nominal * one.modulus == pytest.approx(
        torque.max(), rel=0.02
    )  # the shaft's own inertia is slight


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [(60, 45, 45e6), (45, 60, 45e6), (60, None, 60e6), (None, 45, 45e6), (None, None, None)],
)
def test_a_fillet_endures_what_the_weaker_of_its_shafts_endures(
    first: int | None, second: int | None, expected: float | None
) -> None:
    stated = ("" if value is None else f", endurance: {value} MPa" for value in (first, second))
    shafts = [f"{{shaft: {{length: 1 m, diameter: 90 mm{words}}}}}" for words in stated]
    disc = "{disc: {inertia: 1}}"
    train = parse(f"{{name: x, train: [{disc}, {', '.join(shafts)}, {disc}]}}").train
    assert endurance(train, *train.bars) == expected


def factors(text: str) -> list[float]:
    scene = SCENE.replace("  - shaft: {name: seat, length: 200 mm, SHAFT}\n", text)
    return [one.factor for one in stated_fillets(assemble(parse(scene).train))]


@pytest.mark.parametrize("backwards", [False, True])
def test_fillet_beside_a_larger_shaft_of_thin_wall_has_at_least_its_nominal_stress(
    *, backwards: bool
) -> None:
    step = ", step: {fillet: 50 mm}"
    first, last = ["diameter: 100 mm", "diameter: 102 mm, bore: 98 mm"][:: -1 if backwards else 1]
    (found,) = factors(
        f"  - shaft: {{name: a, length: 1 m, {first}{step}}}\n  - shaft: {{name: b, length: 1 m, {last}}}\n"
    )
    ratio = float(section_modulus(0.1, 0.0) / section_modulus(0.102, 0.098))
    assert found == pytest.approx(ratio, rel=1e-12)  # 6.37; in the fillet itself 5.02


def neck(length: float, radius: float, larger: float = 300.0) -> str:
    """A shaft of 100 mm between two larger ones; mm."""
    beside = f"length: 1 m, diameter: {larger} mm"
    step = f"step: {{fillet: {radius} mm}}"
    return (
        f"  - shaft: {{name: a, {beside}, {step}}}\n  - shaft: {{name: b, length: {length} mm, diameter: 100 mm, "
        f"{step}}}\n  - shaft: {{name: c, {beside}}}\n"
    )


@pytest.mark.parametrize("radius", [5.0, 10.0, 20.0])
def test_two_fillets_that_meet_are_a_groove(radius: float) -> None:
    """Neuber (1958): deep hyperbolic groove in torsion; one with parallel flanks lies up to a tenth above it."""
    root = math.sqrt(50.0 / radius + 1.0)
    neuber = 3.0 * (1.0 + root) ** 2 / (4.0 * (1.0 + 2.0 * root))
    for found in factors(neck(2.0 * radius, radius)):
        assert 1.0 < found / neuber < 1.1


def test_fillets_two_diameters_apart_know_nothing_of_each_other() -> None:
    near, far = factors(neck(199.0, 10.0)), factors(neck(201.0, 10.0))
    assert near == pytest.approx(far, rel=2e-3)


def test_fillets_and_hubs_have_room_on_their_shaft() -> None:
    with pytest.raises(InputError, match="reaches into another detail of 'b'"):
        assemble(
            parse(
                SCENE.replace("  - shaft: {name: seat, length: 200 mm, SHAFT}\n", neck(19.0, 10.0))
            ).train
        )
    hub = neck(60.0, 10.0).replace("diameter: 100 mm, step: {fillet: 10.0 mm}", HUB)
    with pytest.raises(InputError, match="reaches into another detail of 'b'"):
        assemble(
            parse(SCENE.replace("  - shaft: {name: seat, length: 200 mm, SHAFT}\n", hub)).train
        )


HUB = "diameter: 100 mm, hub: {length: 55 mm, diameter: 160 mm, fit: shrink}"


@pytest.mark.parametrize("key", ["notches", "hub", "support"])
def test_empty_list_of_details_is_refused_in_its_place(key: str) -> None:
    with pytest.raises(InputError, match=f"`{key}` is an empty list"):
        parse(SCENE.replace("SHAFT", f"diameter: 90 mm, {key}: []"))


def test_endurance_of_a_shaft_without_a_detail_is_refused() -> None:
    with pytest.raises(InputError, match="finds no fillet or notch with an `endurance`"):
        torsion.run(
            parse(JUDGED.replace("STEP", "step: sharp").replace("HOLE", "notches: {hole: 9 mm}"))
        )


@pytest.mark.parametrize(("outer", "bore"), [(0.092, 0.085), (0.092, 0.076), (0.1, 0.085)])
def test_fillet_to_a_weaker_tube_has_more_stress_than_the_tube(outer: float, bore: float) -> None:
    """Its K_t is that of both ends: a thin tube behind it makes it larger, and the tube is not judged by itself."""
    larger = f"{outer} m, bore: {bore} m, endurance: 60 MPa"
    text = JUDGED.replace("140 mm, HOLE", larger).replace(
        "STEP", f"step: {{fillet: {outer / 2 - 0.045} m}}"
    )
    (fillet,) = stated_fillets(assemble(parse(text).train))
    assert (
        fillet.factor / fillet.modulus
        > 1.0 / float(section_modulus(outer, bore))
        > 1.0 / fillet.modulus
    )
