"""Quantities that no train has are refused with the likely slip, unless the file says that they are meant."""

import math
from pathlib import Path

import pytest
from docs.site.model_file_manual import pages
from pydantic import ValidationError
from tests.for_all import for_all

from torsion.errors import InputError, Refusal
from torsion.fields import LARGEST, SMALLEST, read_exact
from torsion.model import KINDS
from torsion.model.component import Material, component_class
from torsion.model.coupling import Coupling
from torsion.model.disc import Disc
from torsion.model.gears.planetary import Planetary
from torsion.model.machine import Propeller
from torsion.model.machine_torques import Excitation
from torsion.model.shafts.shaft import Shaft
from torsion.schema.json_schema import json_schema
from torsion.schema.scene_reader import parse
from torsion.units import USUAL

SCENES = Path(__file__).parents[2] / "shafting_specs"

SCENE = """name: a
operation: {OPERATIONrated: {speed: 1500 rpm, power: 12 GW}, speeds: {from: 300 rpm, to: 1800 rpm}}
materials:
  odd: {MATERIALshear_modulus: 0.5 GPa, youngs_modulus: 2 TPa, density: 1, tensile_strength: 11 GPa, loss_factor: 3}
train:
  - motor: {inertia: 1, MOTORripple: [{order: 6, torque: 900 %}]}
  - coupling: {psi: 80, COUPLINGstiffness: 1e-4, tolerance: 15}
  - gear: {ratio: 2, GEARbranches: [{ratio: 3, mesh_stiffness: 1e-5, train: [disc: {inertia: 1}]}]}
  - shaft: {length: 21 km, SHAFTdiameter: [60, 70], bore: 4, material: odd}
  - joint: {kind: tripod, angle: 5 deg, JOINTradius: 30, arm: 600}
  - propeller: {inertia: 1, PROPELLERdiameter: 500, pitch_ratio: 80, area_ratio: 70}
excitations:
  - {EXCITATIONat: motor-1, order: 1, torque: {of_mean: 10}}
"""
CARRIERS = {
    "OPERATION": 1,
    "MATERIAL": 5,
    "MOTOR": 1,
    "COUPLING": 3,
    "GEAR": 1,
    "SHAFT": 4,
    "JOINT": 2,
    "PROPELLER": 3,
    "EXCITATION": 1,
}


def scene(meant=()):
    """The scene with `unusual: true` on those that are meant, and `unusual: false` or nothing on the others."""
    text = SCENE
    for place, carrier in enumerate(CARRIERS):
        text = text.replace(
            carrier, "unusual: true, " if carrier in meant else ("", "unusual: false, ")[place % 2]
        )
    return text


def faults_of(text):
    with pytest.raises(InputError) as caught:
        parse(text)
    return caught.value.faults


def test_every_slip_of_a_file_is_told_at_once_with_the_key_that_lifts_it():
    faults = faults_of(scene())
    found = {
        carrier: [fault for fault in faults if f"on the {carrier.lower()} says so" in fault.hint]
        for carrier in CARRIERS
    }
    assert {carrier: len(stated) for carrier, stated in found.items()} == CARRIERS
    assert len(faults) == sum(CARRIERS.values())
    assert len({(fault.line, fault.column) for fault in faults}) == len(faults)


@pytest.mark.parametrize("carrier", CARRIERS)
def test_unusual_lifts_the_ranges_of_what_says_it_and_of_nothing_else(carrier):
    faults = faults_of(scene([carrier]))
    assert len(faults) == sum(CARRIERS.values()) - CARRIERS[carrier]
    assert not any(f"on the {carrier.lower()} says so" in fault.hint for fault in faults)


def test_what_is_meant_is_read_as_it_is_written():
    study = parse(scene(CARRIERS))
    (shaft,) = study.train.bars
    assert (shaft.length, shaft.outer, shaft.bore) == (21e3, (60.0, 70.0), (4.0, 4.0))
    assert [
        spring.loss_factor for spring in study.train.springs if spring.name == "coupling-1"
    ] == [80 / (2 * math.pi)]


def test_unusual_lifts_no_other_limit():
    text = scene(CARRIERS).replace("psi: 80", "psi: -80").replace("bore: 4", "bore: 65")
    assert [fault.message for fault in faults_of(text)] == [
        "-80 is out of range",
        "the bore is not smaller than the diameter",
    ]


def test_only_true_says_that_it_is_meant():
    faults = faults_of(
        scene(CARRIERS).replace("psi: 80, unusual: true", "psi: 80, unusual: 'true'")
    )
    assert any("neither true nor false" in fault.message for fault in faults)
    assert any("80 %?" in fault.hint for fault in faults)


def test_a_gear_does_not_speak_for_the_components_of_its_branches():
    text = scene(CARRIERS).replace("disc: {inertia: 1}", "coupling: {stiffness: 1e-4}")
    (fault,) = faults_of(text)
    assert "on the coupling" in fault.hint


@for_all(
    ("lowest", "highest", "build"),
    [
        (None, 3.0, lambda value, **meant: Shaft(length=1.0, diameter=value, **meant)),
        (
            1e-6,
            20e3,
            lambda value, **meant: Shaft(
                length=value, diameter=1.0 if value > 1.0 else 1e-3, **meant
            ),
        ),
        (None, 4.0 * math.pi, lambda value, **meant: Coupling(stiffness=1e4, psi=value, **meant)),
        (None, 2.0, lambda value, **meant: Coupling(stiffness=1e4, loss_factor=value, **meant)),
        (
            None,
            2.0,
            lambda value, **meant: Shaft(length=1.0, diameter=0.1, loss_factor=value, **meant),
        ),
        (500.0, 25e3, lambda value, **meant: Material(shear_modulus=8e10, density=value, **meant)),
        (1e9, 1e12, lambda value, **meant: Material(shear_modulus=value, density=7850.0, **meant)),
        (
            1e9,
            1e12,
            lambda value, **meant: Material(
                shear_modulus=8e10, youngs_modulus=value, density=0.0, **meant
            ),
        ),
        (
            None,
            5.0,
            lambda value, **meant: Excitation(at="a", order=1, torque={"of_mean": value}, **meant),
        ),
        (
            None,
            5.0,
            lambda value, **meant: Propeller(
                inertia=1.0,
                blades=4,
                excitation=[{"blade_order": 1, "torque": {"of_mean": value}}],
                **meant,
            ),
        ),
    ],
)
def test_the_ends_of_a_range_are_usual_and_what_lies_beyond_is_refused_in_python_too(
    lowest, highest, build
):
    for end, beyond in ((lowest, 0.0), (highest, math.inf)):
        if end is not None:
            build(end)
            with pytest.raises(ValidationError, match=r"outside the usual range .*unusual: true"):
                build(math.nextafter(end, beyond))
            build(math.nextafter(end, beyond), unusual=True)


def test_no_density_is_a_massless_shaft_and_not_unusual():
    assert Material(shear_modulus=8e10, density=0.0).density == 0.0


def test_a_refused_component_leaves_nothing_to_the_next():
    with pytest.raises(ValidationError, match="out of range"):
        Shaft(length=-1.0, diameter=60.0, unusual=True)
    with pytest.raises(ValidationError, match="60 mm"):
        Shaft(length=1.0, diameter=60.0)


def test_schema_and_manual_tell_the_ranges_and_the_key_that_lifts_them():
    definitions = json_schema()["$defs"]
    assert definitions["Shaft"]["properties"]["length"]["x-usual"] == [1e-6, 20e3]
    assert definitions["Material"]["properties"]["density"]["x-usual"] == [500.0, 25e3]
    torque = definitions["Ripple"]["properties"]["torque"]["anyOf"]
    assert [None, 5.0] in [
        way.get("properties", {}).get("of_mean", {}).get("x-usual") for way in torque
    ]
    assert "usually 1e-05 to 3" in str(definitions["Shaft"]["properties"]["diameter"])
    for name in (
        "Material",
        "Operation",
        "Excitation",
        *(component_class(kind).__name__ for kind in KINDS),
    ):
        assert definitions[name]["properties"]["unusual"]["type"] == "boolean"
    rows = [
        line
        for line in pages()["components/shaft.md"].splitlines()
        if line.startswith("| `diameter` | `m`, or a list")
    ]
    assert [row.split(" | ")[2] for row in rows] == ["more than 0, usually 1e-05 to 3"]


TRAIN = """name: a
operation: {{rated: {{speed: {speed}, power: 100 kW}}}}
train:
  - disc: {{inertia: {inertia}}}
  - coupling: {{stiffness: 1e4, {coupling}}}
  - gear: {{planetary: {{sun: 21, ring: 93, planets: {planets}}}}}
  - shaft: {{length: {length}, diameter: {diameter}}}
  - propeller: {{inertia: 1, entrained: {entrained}}}
  - branch: {{train: {branch}}}
  - disc: {{inertia: 1}}
analyses: {{{analyses}}}
"""
SOUND = {
    "speed": "1500 rpm",
    "inertia": "2",
    "coupling": "viscous: 1",
    "planets": "3",
    "length": "4500 mm",
    "diameter": "60 mm",
    "entrained": "25 %",
    "branch": "[disc: {inertia: 1}]",
    "analyses": "modes: {count: 3}",
}
SWEEP = "sweep: {{vary: {{coupling-1.stiffness: {{values: {}}}}}}}"
NONSENSE = [  # key, what it says, line of the fault, words of the refusal
    ("planets", "60", 6, "60 planets of these teeth overlap (at most 4 on their circle)"),
    ("coupling", "stages: []", 5, "`stages` is an empty list"),
    ("analyses", SWEEP.format("[1, 1]"), 11, "the value 1 is listed twice"),
    ("analyses", SWEEP.format("[10 kN*m/rad, 20 kN*m/rad, 10 kN*m/rad]"), 11, "listed twice"),
    ("branch", "[]", 9, "`train` is an empty list"),
    (
        "branch",
        "[disc: {inertia: 1}, gear: {ratio: 3, differential: {train: []}}]",
        9,
        "`train` is an empty list",
    ),
    ("analyses", "tolerances: {aim: [{mode: 1}]}", 11, "`frequency` is missing"),
    (
        "length",
        "4500",
        7,
        "the length is 75000 times the diameter, outside the usual range (4500 mm?",
    ),
    ("diameter", "6e-11 mm", 7, "6e-11 mm is outside the usual range (usual: 0.01 to 3000 mm"),
    ("speed", "1e15 rpm", 2, "1e+15 rpm is outside the usual range"),
    (
        "coupling",
        "clearance: 36000 deg",
        5,
        "36000 deg is outside the usual range (usual: 5.7296e-07 to 720 deg",
    ),
    ("entrained", "25", 8, "25 times the inertia of the propeller, outside the usual range (25 %?"),
    (
        "entrained",
        "2500 %",
        8,
        "25 times the inertia of the propeller, outside the usual range (usual: 1e-06 to 5",
    ),
    ("inertia", "1e12", 4, "1e+12 kg*m**2 is outside the usual range (1e+12 kg*mm**2?"),
    ("inertia", "1e200", 4, "1e+200 kg*m**2 is outside the usual range"),
    (
        "inertia",
        "1e200, unusual: true",
        4,
        "beyond all that can be computed with (in SI from 1e-60 to 1e+60, or 0)",
    ),
    ("inertia", "1e-200 kg*m**2", 4, "outside the usual range"),
]


def test_the_sound_train_of_the_nonsense_is_read():
    assert len(parse(TRAIN.format(**SOUND)).train.bars) == 1


@for_all(("key", "value", "line", "words"), NONSENSE)
def test_nonsense_is_refused_where_it_stands(key, value, line, words):
    (fault,) = faults_of(TRAIN.format(**SOUND | {key: value}))
    assert fault.line == line
    assert words in f"{fault.message} ({fault.hint})"


@pytest.mark.parametrize(
    ("scene", "good", "bad", "words"),
    [
        (
            "v12_generator_set",
            "duration: 65 deg",
            "duration: 0.0001 deg",
            "0.0001 deg is outside the usual range",
        ),
        (
            "genset_short_circuit",
            "line: 8,",
            "line: 8e12,",
            "8e+12 is outside the usual range (usual: 1e-06 to 100)",
        ),
    ],
)
def test_nonsense_in_a_scene_is_refused_where_it_stands(scene, good, bad, words):
    text = (SCENES / f"{scene}.yaml").read_text(encoding="utf-8")
    faults = faults_of(text.replace(good, bad, 1))
    assert faults[0].line == next(
        number for number, line in enumerate(text.splitlines(), 1) if good in line
    )
    assert words in f"{faults[0].message} ({faults[0].hint})"


@pytest.mark.parametrize(
    ("teeth", "room"), [((21, 93, 36), 4), ((60, 100, 20), 12), ((30, 90, 30), 5)]
)
def test_as_many_planets_are_possible_as_have_room_on_their_circle(teeth, room):
    """Pitch circles beside each other: (sun + planet) sin(pi/N) > planet; six circles about an equal one touch."""
    sun, ring, planet = teeth
    assert (sun + planet) * math.sin(math.pi / room) > planet * (1.0 + 1e-12)
    assert (sun + planet) * math.sin(math.pi / (room + 1)) < planet * (1.0 + 1e-12)
    Planetary(sun=sun, ring=ring, planets=room)
    with pytest.raises(ValidationError, match=f"at most {room} on their circle"):
        Planetary(sun=sun, ring=ring, planets=room + 1)


@for_all("row", USUAL)
def test_every_range_has_its_ends_in_order_and_holds_nothing_beyond_what_can_be_computed(row):
    usual = USUAL[row]
    assert usual.low < usual.high
    assert usual.holds(0.0)
    assert all(end is None or usual.holds(end) for end in usual.ends)
    assert all(not end or SMALLEST <= abs(end) <= LARGEST for end in usual.ends)


def test_stiffnesses_may_be_apart_by_the_range_that_is_promised():
    """1e12 from the softest to the stiffest, at any place that trains have: 1 mN m/rad to 1e15 N m/rad, rigid."""
    for stiffness in (1e-3, 1.0, 1e3, 1e9, 1e12, 1e15):
        Coupling(stiffness=stiffness)
    for inertia in (1e-11, 1e-9, 1.0, 1e6, 1e9):
        Disc(inertia=inertia)


@for_all(
    ("row", "number", "is_usual"),
    [
        ("degC", -60.0, True),
        ("degC", -61.0, False),  # though 61 degC is usual
        ("degC", 251.0, False),
        ("exponent of a load", -2.0, False),
        ("N*m", -100.0, True),  # a torque of either sense, by its size
        ("N*m", -2e10, False),
        ("kg", 0.0, True),
    ],
)
def test_a_range_from_below_0_has_a_sign_and_one_from_above_0_is_of_the_size(
    row: str, number: float, is_usual: bool
) -> None:
    assert USUAL[row].holds(number) is is_usual


@for_all("written", ["1/1000000000", "1/2000000000", "0.000000001", "1000000000", "0", "-2"])
def test_an_exact_ratio_lies_between_a_thousand_millionth_and_a_thousand_millions(
    written: str,
) -> None:
    with pytest.raises(Refusal, match="out of range"):
        read_exact(written)
    assert read_exact("1/999999999") * read_exact("999999999") == 1
