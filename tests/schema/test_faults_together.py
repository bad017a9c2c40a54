"""Faults of different kinds that are stated in one round, and what a fault must not draw after it."""

import pytest
from tests.for_all import for_all

from torsion.errors import InputError
from torsion.schema.scene_reader import parse

TRAIN = """name: x
operation: {speeds: {from: 100 rpm, to: 900 rpm, steps: 21}}
train:
  - motor: {name: a, inertia: 1}
  - coupling: {name: k, stiffness: 1e4}
  - gear: {ratio: 2}
  - disc: {name: b, inertia: 1}
  - disc: {inertia: 1}
"""


def stated(text: str) -> list[tuple[int, str]]:
    """Line and message of every fault."""
    with pytest.raises(InputError) as caught:
        parse(text)
    return [(fault.line or 0, f"{fault.message} ({fault.hint})") for fault in caught.value.faults]


def of(found: list[tuple[int, str]], *wanted: tuple[int, str]) -> bool:
    """The faults are the wanted ones: lines, and words of the messages."""
    return len(found) == len(wanted) and all(
        line == at and words in message
        for (line, message), (at, words) in zip(found, wanted, strict=True)
    )


def test_faults_of_excitations_in_key_name_mean_torque_and_table_are_told_together():
    found = stated(
        TRAIN
        + """excitations:
  - {at: a, order: 1, torque: [[200 rpm, 5], [900 rpm, 50]]}
  - {at: k, order: 1, torque: 5}
  - {at: b, order: 2, torque: {of_mean: 5 %}}
  - {at: b, ordr: 2, torque: 5}
  - {at: bb, order: 2, torque: 5}
  - {at: b, order: 1, torque: [[50 rpm, 5], [450 rpm, 50]]}
"""
    )
    assert of(
        found,
        (10, "covers 200 rpm to 900 rpm"),
        (11, "'k' is a coupling"),
        (12, "rated power is not given"),
        (13, "did you mean `order`"),
        (14, "did you mean 'b'"),
    ), found


def test_a_faulty_link_or_component_hides_no_unknown_name():
    links = """links:
  - {between: [a], coupling: {stiffness: 1}}
  - {between: [b, z], coupling: {stiffness: 1}}
  - {between: [disc-2, b], coupling: {stiffness: 1}}
excitations: [{at: disc-9, order: 1, torque: 5}]
"""
    wanted = (10, "names of the two points"), (11, "called 'z'"), (13, "called 'disc-9'")
    assert of(stated(TRAIN + links), *wanted), stated(TRAIN + links)
    faulty = (
        (TRAIN + links)
        .replace("stiffness: 1e4", "stiffness: -1e4")
        .replace("to: 900 rpm", "to: 900 rpm, step: 1")
    )
    assert of(stated(faulty), (2, "unknown key `step`"), (5, "out of range"), *wanted), stated(
        faulty
    )


def test_nothing_is_told_of_names_where_the_kind_of_a_component_is_unknown():
    text = (
        TRAIN.replace("motor: {name: a,", "moter: {")
        + "excitations: [{at: motor-1, order: 1, torque: 5}]\n"
    )
    assert of(stated(text), (4, "did you mean `motor`")), stated(text)


def test_faults_of_one_section_do_not_hide_those_between_others_nor_make_any():
    text = (
        TRAIN
        + "excitations: [{at: a, order: 1, torque: 5}]\nanalyses: {response: }\nrules: [coupling-maker]\n"
    )
    no_speeds = text.replace("operation: {speeds: {from: 100 rpm, to: 900 rpm, steps: 21}}\n", "")
    assert [line for line, _ in stated(no_speeds)] == [9, 10]
    assert of(stated(no_speeds.replace("response:", "respons:")), (9, "did you mean `response`"))
    assert of(stated(text.replace("operation:", "operatoin:")), (2, "did you mean `operation`"))


def test_a_table_is_judged_at_the_components_own_speed_and_where_it_is_read_alone():
    line = TRAIN + "excitations: [{at: b, order: 3, torque: [[50 rpm, 5], [450 rpm, 50]]}]\n"
    assert parse(line).train.torques
    short = line.replace("50 rpm, 5]", "60 rpm, 5]")
    assert of(stated(short), (9, "covers 60 rpm to 450 rpm, the speeds run from 50 rpm to 450 rpm"))
    assert parse(short + "analyses: {modes: }\n").train.torques
    more = short.replace("}]", "}, {at: a, order: 1, torque: 2}]")
    assert parse(more + "analyses: {response: {orders: [1]}}\n").train.torques
    assert of(stated(short + "analyses: {response: {orders: [3/2]}}\n"), (9, "covers 60 rpm"))


def test_a_power_without_a_way_and_a_short_table_of_the_load_are_told_when_the_file_is_read():
    rated = "rated: {speed: 900 rpm, power: 1 kW}"
    alone = f"name: x\noperation: {{{rated}}}\ntrain: [motor: {{name: m, inertia: 1}}]\n"
    assert of(stated(alone), (2, "would enter and leave the train at 'm'"))
    text = TRAIN.replace("steps: 21}", "steps: 21}, load: [[100 rpm, 5], [800 rpm, 9]]")
    other = (
        text + "  - coupling: {stiffness: 1}\n  - motor: {name: second, inertia: 1, power: 1 kW}\n"
    )
    assert of(
        stated(other),
        (2, "covers 100 rpm to 800 rpm"),
        (10, "`power` of 'second' holds at a speed that is not given"),
    )


def test_a_name_that_is_taken_is_told_with_the_line_that_has_it():
    text = "name: x\ntrain:\n  - disc: {inertia: 1, name: disc-2}\n  - coupling: {stiffness: 1}\n  - disc: {inertia: 1}\n"
    ((line, message),) = stated(text)
    assert line == 5
    assert (
        "would be 'disc-2', which is taken in line 3, `- disc: {inertia: 1, name: disc-2}`"
        in message
    )
    given = text.replace("{inertia: 1}", "{name: disc-2, inertia: 1}")
    assert of(stated(given), (5, "the name 'disc-2' is taken in line 3"))


@pytest.mark.parametrize(
    ("value", "words"), [("1,5", "write 1.5"), ("1,5 kg*m**2", "a decimal comma?")]
)
def test_a_decimal_comma_within_braces_is_told_as_one(value, words):
    assert of(stated(f"name: x\ntrain:\n  - disc: {{inertia: {value}}}\n"), (3, words))
    assert "comma" not in stated("name: x\ntrain:\n  - disc: {inertia: 1, 5: }\n")[0][1]


@for_all(
    ("component", "wanted"),
    [
        (
            "propeller: {inertia: -1, blades: 4, damping: {model: schwanecke}}",
            ("out of range", "schwanecke needs diameter, pitch_ratio, area_ratio"),
        ),
        (
            "coupling: {stiffness: 1e4, psi: 1, viscous: 5, inertia: true}",
            ("exclude each other", "is not a list"),
        ),
        (
            "shaft: {length: -1, diameter: 50 mm, bore: 60 mm}",
            ("out of range", "the bore is not smaller"),
        ),
        ("shaft: {length: -1, diameter: -50 mm, bore: 60 mm}", ("out of range", "out of range")),
        (
            "shaft: {lenght: 1, diameter: 50 mm, bore: 60 mm}",
            ("`length` is missing", "unknown key `lenght`"),
        ),
        ("disc: {inertia: -1}", ("out of range",)),
        ("disc: {inerta: 1}", ("did you mean `inertia`",)),
        (
            "propeller: {inertia: 1, damping: {model: schwanecke, factor: -1}, diameter: 1 kg}",
            ("is", "is"),
        ),
    ],
)
def test_what_sound_keys_need_of_each_other_is_told_beside_faulty_ones(component, wanted):
    found = stated(f"name: x\ntrain:\n  - {component}\n")
    assert of(found, *((3, words) for words in wanted)), found


def test_a_faulty_key_hides_no_clash_of_other_keys():
    text = TRAIN.replace("stiffness: 1e4", "stiffness: 1e4, psi: -1, max_torque_rare: 5 kN*m")
    told = stated(text)
    assert of(told, (5, "out of range"), (5, "needs `max_torque`")), told
