"""Every faulty file is refused where the fault stands, in words that help; faulty_files.txt has one line for each."""

from pathlib import Path

import pytest
from tests.for_all import for_all

from torsion.errors import InputError
from torsion.model import KINDS
from torsion.schema.scene_reader import parse

HERE = Path(__file__).parent
GOOD = (HERE / "good.yaml").read_text(encoding="utf-8")
SPEEDS = "name: a\noperation: {speeds: {from: 5 rad/s, to: 6 rad/s}}\n"
ESCAPES = {"\\n": "\n", "\\t": "\t", "\\a": "\a", "\\ufeff": "\ufeff"}


def rows(name: str = "faulty_files.txt") -> list[tuple[str, str, str, str]]:
    found = []
    for line in (HERE / name).read_text(encoding="utf-8").splitlines():
        if line and not line.startswith("#"):
            place, good, bad, words = line.split(" | ")
            found.append((place, plain(good), plain(bad), words))
    return found


def plain(text: str) -> str:
    for escape, sign in ESCAPES.items():
        text = text.replace(escape, sign)
    return text


def faults_of(text: str):
    with pytest.raises(InputError) as caught:
        parse(text, "bad.yaml")
    return caught.value.faults, str(caught.value)


MACHINES = {"turbine", "generator", "pump", "fan", "machine"}  # tests/model/test_machines.py


def test_good_file_of_the_table_is_good_and_has_every_kind():
    study = parse(GOOD)
    assert {part.kind for part in study.train.parts} == set(KINDS) - {
        "engine",
        "compressor",
        "pendulum",
    } - MACHINES


@for_all(("place", "good", "bad", "words"), rows())
def test_faulty_file_is_refused_at_the_fault_and_only_there(place, good, bad, words):
    assert GOOD.count(good) == 1
    text = GOOD.replace(good, bad)
    faults, message = faults_of(text)
    assert [f"{fault.line}:{fault.column}" for fault in faults] == [place]
    assert [
        word for word in words.split() if word not in f"{faults[0].message} ({faults[0].hint})"
    ] == []
    line, column = (int(figure) for figure in place.split(":"))
    head, quoted, caret = message.splitlines()
    assert head.startswith(f"bad.yaml:{place}: ")
    line_shown = "".join(
        sign if sign.isprintable() or sign == "\t" else "?" for sign in text.split("\n")[line - 1]
    )
    assert quoted[4:] in line_shown
    assert f"{quoted} "[caret.index("^")] == f"{line_shown} "[column - 1]


def test_all_faults_of_a_file_are_told_at_once_in_the_order_of_the_file():
    changes = [
        ("name: A train", "nam: A train"),
        ("density: 7850 kg/m**3", "density: 7850 kg"),
        ("at: wheel", "at: 3"),
        ("speed: 1500 rpm", "speed: 25 Hz"),
        ("psi: 0.8", "psi: -1"),
        ("joint: {angle: 5 deg}", "jiont: {}"),
        ("inertia: 0.7", "inertia: x"),
        ("blades: 4", "blades: 4.5"),
        ("stiffness: 1e5", "stiffness: 0"),
        ("model: lumped", "model: exat"),
        ("count: 6", "count: six"),
        ("limit: 0.35", "limt: 0.35"),
        ("name: tube", "name: drive"),
    ]
    text = GOOD
    for good, bad in changes:
        text = text.replace(good, bad)
    faults, message = faults_of(text)
    lines = [fault.line for fault in faults]
    assert lines == [1, 1, 4, 8, 12, 26, 29, 30, 36, 43, 46, 49, 50, 54]
    assert message.count("bad.yaml:") == len(faults) == message.count("^")


def test_several_faults_of_one_component_are_told_at_once():
    text = GOOD.replace(
        "length: 0.8 m, diameter: 60 mm, material: alloy",
        "lenght: 0.8 m, diameter: 60 N, material: 5",
    )
    faults, _ = faults_of(text)
    words = ["`length` is missing", "unknown key `lenght`", "'60 N' is a force", "5 is not text"]
    assert [
        word for word, fault in zip(words, faults, strict=True) if word not in fault.message
    ] == []


@for_all(
    ("text", "words"),
    [
        ("", "empty"),
        ("# nothing\n", "empty"),
        ("5", "mapping"),
        ("- disc: {inertia: 1}", "mapping name train"),
        ("name: a", "`train` missing"),
        ("name: a\ntrain:", "`train` no value"),
        ("name: a\ntrain: []", "no component"),
        ("name: a\ntrain: {disc: {inertia: 1}}", "mapping list of components"),
        ("name: a\ntrain: [branch: {}]", "`train` missing"),
        ("name: a\ntrain: [branch: {train: }]", "`train` no value"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nmaterials: [steel]", "list mapping shear_modulus"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nrules: iacs-m68", "'iacs-m68' list"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nrules: [coupling-maker]", "no coupling limit"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nanalyses: modes", "'modes' mapping"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nanalyses: [modes]", "list mapping"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nanalyses:\n  response:", "speeds frequencies"),
        ("name: a\ntrain: [disc: {inertia: 1}]\nanalyses: {model: }", "model"),
        (
            "name: a\ntrain: [disc: {name: b, inertia: 1}]\nexcitations: [{at: b, order: 1, torque: 5}]",
            "speeds",
        ),
        ("name: a\ntrain: [disc: {inertia: 1}]\nexcitations: {at: disc-1}", "mapping list"),
        (
            "name: a\ntrain: [disc: {inertia: 1}]\nlinks: [{between: [a, b]}]",
            "`coupling` or `shaft` missing",
        ),
        ("name: a\ntrain: [gear: {ratio: 2, branches: [{teeth: 4}]}]", "teeth"),
        (
            f"{SPEEDS}train: [joint: {{angle: 5 deg}}]\nanalyses: {{stability: }}",
            "no component inertia",
        ),
        ("name: a\nfrob: 1\ntrain: [disc: {inertia: 1}]", "unknown `frob` model-file keys"),
    ],
)
def test_small_file_is_refused_in_words(text, words):
    (fault, *others), _ = faults_of(text)
    assert others == []
    assert fault.line is not None
    assert [word for word in words.split() if word not in f"{fault.message} ({fault.hint})"] == []


def test_mean_torque_that_is_needed_and_not_known_is_told_where_it_is_needed():
    text = GOOD.replace(", power: 100 kW}\n", "}\n").replace("  - gear-hammer: {limit: 0.35}\n", "")
    faults, _ = faults_of(text)
    assert [(fault.line, "rated power" in fault.message) for fault in faults] == [(11, True)]


def test_scene_without_speeds_is_good_as_long_as_nothing_needs_them():
    text = "name: a\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 1}, disc: {inertia: 1, name: b}]\n"
    excited = text + "excitations: [{at: b, order: 1, torque: 5}]\n"
    assert parse(text).operation.speeds is None
    assert parse(excited + "analyses: {modes: }").train.torques
    faults_of(excited)
