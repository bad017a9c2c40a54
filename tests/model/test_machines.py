"""Machines that drive or absorb: one set of keys; the kind says sign and usual law of load."""

import math

import numpy as np
import pytest
from tests.for_all import for_all

import torsion
from torsion.assembly import assemble
from torsion.errors import InputError
from torsion.model.component import component_class
from torsion.model.machine_torques import LoadLaw, read_load

ABSORB = ("generator", "pump", "fan", "machine", "propeller")
DRIVE = ("motor", "turbine")
HEAD = (
    "name: x\noperation: {speeds: {from: 300 rpm, to: 900 rpm}, rated: {speed: 900 rpm}}\ntrain:\n"
)


def record(entry: str):
    text = f"{HEAD}- {entry}\n- coupling: {{stiffness: 20 kN*m/rad}}\n- motor: {{inertia: 1}}\n"
    return torsion.parse(text).train.parts[0].machine


def fault(entry: str):
    with pytest.raises(InputError) as caught:
        record(entry)
    (refused,) = caught.value.faults
    return refused


@pytest.mark.parametrize("kind", ABSORB + DRIVE)
def test_every_kind_has_inertia_or_is_fixed_and_says_who_drives(kind: str) -> None:
    assert record(f"{kind}: {{inertia: 2, damping: 3, tolerance: 5 %}}").is_driver is (
        kind in DRIVE
    )
    assert record(f"{kind}: {{held: true}}").is_held
    assert "`inertia` is missing" in fault(f"{kind}: {{name: m}}").message
    assert component_class(kind).sort == "point"


def test_a_machine_drives_where_the_file_says_so() -> None:
    assert record("machine: {inertia: 2, drives: true}").is_driver


@pytest.mark.parametrize(
    ("kind", "law"),
    [
        ("generator", LoadLaw(0.0)),
        ("pump", LoadLaw(2.0)),
        ("fan", LoadLaw(2.0)),
        ("propeller", LoadLaw(2.0)),
        ("machine", None),
    ],
)
def test_the_usual_law_is_that_of_the_kind(kind: str, law: LoadLaw | None) -> None:
    assert record(f"{kind}: {{inertia: 2}}").usual_load == law


@pytest.mark.parametrize(
    ("written", "at_half_speed"),
    [
        ("constant", 1.0),
        ("linear", 0.5),
        ("quadratic", 0.25),
        ("propeller", 0.25),
        ("constant-power", 2.0),
        ({"exponent": 1.8}, 0.5**1.8),
        ({"exponent": 2, "at_rest": "20 %"}, 0.2 + 0.8 * 0.25),
    ],
)
def test_laws_of_load_are_powers_of_the_speed(written: object, at_half_speed: float) -> None:
    assert read_load(written).torque(np.array([50.0]), 100.0, 400.0) == pytest.approx(
        [400 * at_half_speed], rel=1e-15
    )


def test_power_and_torque_state_the_rated_torque_at_the_stated_speed() -> None:
    assert record("generator: {inertia: 2, power: 1200 kW, speed: 375 rpm}").rated_torque(
        1.0
    ) == pytest.approx(30557.749073643903, rel=1e-15)
    assert record("fan: {inertia: 2, torque: 30 N*m}").rated_torque(1.0) == 30.0
    assert record("fan: {inertia: 2, power: 30 W}").rated_torque(10.0) == 3.0
    assert record("fan: {inertia: 2}").rated_torque(10.0) is None


@pytest.mark.parametrize(
    ("damping", "expected"),
    [
        # 0.0231 rho D^5 (P/D)^2 EAR/pi times the speed; 30 Q/n with n in rpm; 2 Q/omega
        ("{model: schwanecke}", 0.0231 * 1025.0 * 2.0**5 * 0.8**2 * 0.5 / math.pi * 10.0),
        ("{model: archer, factor: 30}", 30.0 * 500.0 / (10.0 * 30.0 / math.pi)),
        ("{model: frahm, factor: 2}", 2.0 * 500.0 / 10.0),
    ],
)
def test_damping_of_a_propeller_by_its_formula(damping: str, expected: float) -> None:
    """Diameter 2 m, pitch ratio 0.8, area ratio 0.5; 10 rad/s and 500 N m."""
    propeller = (
        "{propeller: {inertia: 4, diameter: 2 m, pitch_ratio: 0.8, area_ratio: 0.5, damping: DAMPING}}"
    ).replace("DAMPING", damping)
    text = f"{{name: x, train: [{{motor: {{inertia: 1}}}}, {{coupling: {{stiffness: 1e3}}}}, {propeller}]}}"
    system = assemble(torsion.parse(text).train)
    found = system.ground_damping(np.array([10.0]), np.full((len(system.stations), 1), 500.0))
    assert found.ravel().tolist() == pytest.approx([0.0, expected], rel=1e-14)


@for_all(
    ("entry", "message", "hint", "place"),
    [
        (
            "pump: {inertia: 1, power: 3 kW, torque: 2}",
            "`power` and `torque` exclude each other",
            "keep one",
            "2}",
        ),
        (
            "motor: {inertia: 1, load: linear}",
            "`load` of a machine that drives",
            "give `drive`",
            "linear",
        ),
        (
            "machine: {inertia: 1, drives: true, load: linear}",
            "`load` of a machine that drives",
            "`drive`",
            "linear",
        ),
        (
            "pump: {held: true, power: 3 kW}",
            "a `held` machine takes what is left: leave out its power",
            "",
            "3 kW",
        ),
        ("pump: {inertia: 1, load: cubic}", "unknown load law 'cubic'", "constant-power", "cubic"),
        ("pump: {inertia: 1, load: {at_rest: 0.3}}", "exponent", "", "{at_rest"),
        (
            "fan: {inertia: 1, speed: 30 rpm}",
            "`speed` belongs to a `power` or `torque`",
            "give one",
            "30 rpm",
        ),
        (
            "generator: {held: true, ripple: [{order: 2, torque: 3}]}",
            "a fixed generator cannot be moved by its ripple",
            "inertia",
            "[{",
        ),
        (
            "machine: {held: true, excitation: [{order: 2, torque: 3}]}",
            "a fixed machine cannot be moved",
            "inertia",
            "[{",
        ),
        (
            "fan: {inertia: 1, load: [[0 rpm, 1], [9 rpm, 2]], power: 8}",
            "`power` and a table of `load` exclude",
            "",
            "8}",
        ),
        (
            "pump: {inertia: 1, damping: {model: schwanecke}}",
            "schwanecke needs diameter",
            "",
            "{model",
        ),
    ],
)
def test_what_a_machine_cannot_have_is_refused_at_its_place(
    entry: str, message: str, hint: str, place: str
) -> None:
    refused = fault(entry)
    assert message in refused.message
    assert hint in refused.hint
    assert (refused.line, refused.column) == (4, 3 + entry.index(place))


def test_the_torques_of_a_machine_act_at_the_orders_of_its_own_shaft() -> None:
    text = HEAD + (
        "- turbine: {inertia: 1, ripple: [{order: 7, torque: 1}]}\n- coupling: {stiffness: 20 kN*m/rad}\n"
        "- machine: {inertia: 2, excitation: [{order: 3, torque: 2}, {frequency: 5 Hz, torque: 3}]}\n"
        "- coupling: {stiffness: 20 kN*m/rad}\n"
        "- pump: {inertia: 3, entrained: 20 %, blades: 5, excitation: [{blade_order: 2, torque: 4}]}\n"
    )
    train = torsion.parse(text).train
    assert [(torque.order, torque.frequency, torque.torque) for torque in train.torques] == [
        (7, None, 1.0),
        (3, None, 2.0),
        (None, 5.0, 3.0),
        (10, None, 4.0),
    ]
    assert sum(lump.inertia for lump in train.inertias) == pytest.approx(1 + 2 + 3 * 1.2, rel=1e-15)
    assert [torque.path[-3:] for torque in train.torques[1:3]] == [
        ("machine", "excitation", 0),
        ("machine", "excitation", 1),
    ]
