"""Faults as they are stated: sorted by place, quoted, with a caret."""

import pytest
from tests.for_all import for_all

from torsion.errors import Fault, InputError, nearest
from torsion.schema.fault_text import input_error, locate
from torsion.schema.yaml_source import parse_source

SOURCE = parse_source(
    "name: boat\ntrain:\n  - motor: {inertia: 5 m, powr: 3}\n  - shaft:\n\n      length: [1, 2]\n",
    "boat.yaml",
)
INERTIA = Fault(("train", 0, "motor", "inertia"), "is a length", "for example '1.2 kg*m**2'")
POWER = Fault(
    ("train", 0, "motor", "powr"), "unknown key `powr`", "did you mean `power`?", at_key=True
)
DIAMETER = Fault(("train", 1, "shaft", "diameter"), "missing key `diameter`", at_key=True)
LENGTH = Fault(("train", 1, "shaft", "length", 1), "one length is expected")


def test_faults_are_told_in_the_order_of_the_file_with_a_caret() -> None:
    assert (
        str(input_error([LENGTH, DIAMETER, POWER, INERTIA], SOURCE))
        == """\
boat.yaml:3:22: is a length (for example '1.2 kg*m**2')
      - motor: {inertia: 5 m, powr: 3}
                         ^

boat.yaml:3:27: unknown key `powr` (did you mean `power`?)
      - motor: {inertia: 5 m, powr: 3}
                              ^

boat.yaml:4:5: missing key `diameter`
      - shaft:
        ^

boat.yaml:6:19: one length is expected
          length: [1, 2]
                      ^"""
    )


def test_located_faults_carry_their_place_and_keep_the_rest() -> None:
    (fault,) = locate([POWER], SOURCE)
    assert (fault.line, fault.column) == (3, 27)
    assert (fault.path, fault.message, fault.hint, fault.at_key) == (
        POWER.path,
        POWER.message,
        POWER.hint,
        True,
    )


def test_a_place_that_the_reader_has_set_stays() -> None:
    (fault,) = locate([Fault((), "a tab", line=2, column=3)], SOURCE)
    assert (fault.line, fault.column) == (2, 3)


def test_the_same_fault_is_told_once() -> None:
    other = Fault(INERTIA.path, "is out of range")
    assert [fault.message for fault in locate([INERTIA, other, INERTIA], SOURCE)] == [
        "is a length",
        "is out of range",
    ]


def test_faults_of_one_place_keep_their_order() -> None:
    twice = [Fault(INERTIA.path, message) for message in "zab"]
    assert [fault.message for fault in locate(twice, SOURCE)] == ["z", "a", "b"]


def test_the_error_holds_the_faults_in_the_order_of_the_file() -> None:
    error = input_error([LENGTH, INERTIA], SOURCE)
    assert isinstance(error, InputError)
    assert [fault.line for fault in error.faults] == [3, 6]
    assert str(error) == str(input_error([INERTIA, LENGTH], SOURCE))


def test_an_empty_line_or_one_behind_the_end_is_not_quoted() -> None:
    assert str(input_error([Fault((), "a", line=5, column=1)], SOURCE)) == "boat.yaml:5:1: a"
    assert str(input_error([Fault((), "a", line=99, column=1)], SOURCE)) == "boat.yaml:99:1: a"


def test_a_tab_in_the_line_moves_the_caret_as_it_moves_the_text() -> None:
    source = parse_source("a: 'x\ty' # \tz", "f")
    stated = str(input_error([Fault((), "here", line=1, column=7)], source))
    assert stated == "f:1:7: here\n    a: 'x\ty' # \tz\n" + " " * 9 + "\t^"


@for_all("column", [1, 60, 61, 62, 121, 200, 290])
def test_a_long_line_is_cut_around_the_caret(column: int) -> None:
    line = "a: [" + "0123456789" * 28 + ", end]"
    _, quoted, caret = str(
        input_error([Fault((), "here", line=1, column=column)], parse_source(line, "f"))
    ).split("\n")
    assert len(quoted) <= 4 + 120
    assert caret.endswith("^")
    assert quoted[caret.index("^")] == line[column - 1]
    assert line.find(quoted[4:]) >= 0


def test_signs_that_cannot_be_printed_are_quoted_as_question_marks() -> None:
    with pytest.raises(InputError) as caught:
        parse_source("a: \x1b[31m", "f")
    assert str(caught.value).split("\n")[1:] == ["    a: ?[31m", "       ^"]


@for_all(
    ("word", "candidates", "expected"),
    [
        ("powr", ["power", "inertia"], "power"),
        ("rated torque", ["rated_torque", "max_torque"], "rated_torque"),
        ("Stiffness", ["stiffness", "flexibility"], "stiffness"),
        ("stifness", ["stiffness", "flexibility"], "stiffness"),
        ("iacs_m68", ["iacs-m68", "gear-hammer"], "iacs-m68"),
        ("zzz", ["power", "inertia"], None),
        ("", ["power"], None),
        ("power", [], None),
        ("x" * 100_000, ["power"], None),
    ],
)
def test_the_nearest_word_is_proposed(
    word: str, candidates: list[str], expected: str | None
) -> None:
    assert nearest(word, candidates) == expected
