"""Words of the trade that the format writes otherwise, and slips of its marks: each is answered with what is right."""

import pytest

import torsion
from torsion.errors import InputError
from torsion.schema.other_words import of_its_number, without_colon

MOTOR, END = "- motor: {inertia: 1}", "- disc: {inertia: 2}"
SHAFT = "- shaft: {length: 1 m, diameter: 50 mm, role: intermediate}"


def fault(*lines: str):
    """The only fault of a scene of these lines, which begin in line 3."""
    with pytest.raises(InputError) as caught:
        torsion.parse("name: x\ntrain:\n" + "\n".join(lines) + "\n")
    (one,) = caught.value.faults
    return one


@pytest.mark.parametrize(
    ("lines", "place", "message", "hint"),
    [
        ([MOTOR, "- coupling {stiffness: 5}", END], (4, 3), "a colon is missing behind `coupling`",
         "write `- coupling: {...}`"),
        ([MOTOR, "- coupling {}", END], (4, 3), "'coupling {}' is not a component, a mapping with one key",
         "write `- coupling: {...}`"),
        (["- generator: {inertia: 1}", END], (3, 3), "unknown component `generator`",
         "`propeller` for what absorbs the power, `motor` for what drives"),
        (["- engine: {cylinders: 6}", END], (3, 3), "`engine` is part of the format but not built yet", ""),
        ([MOTOR, "- gear: {ratio: 1/5.77}", END], (4, 17), "'1/5.77' is not a number",
         "a quotient has whole numbers: write 100/577"),
        ([MOTOR, "- gear: {ratio: 1/0}", END], (4, 17), "'1/0' is not a number", "write 2, 0.5 or 21/8"),
        ([MOTOR, "coupling: {stiffness: 5}", END], (4, 1), "`coupling` begins without a dash",
         "write `- coupling: ...`"),
        (["  motor: {inertia: 1}", "  disc: {inertia: 2}"], (3, 3), "a mapping is not a list of components",
         "begin each component with a dash: `- motor: ...`"),
        ([END, "motor: {inertia: 3}"], (4, 1), "unknown key `motor`",
         "a component is an entry of `train`, with a dash: `- motor: ...`"),
        ([MOTOR, SHAFT, END, "rules: [m68]"], (6, 9), "unknown rule `m68`", "did you mean `iacs-m68`?"),
        ([MOTOR, SHAFT, END, "rules: [iacs-m53]"], (6, 9), "unknown rule `iacs-m53`",
         "UR M53 is about crankshafts of engines and is not built; `iacs-m68` is another rule, about shafts"),
        ([MOTOR, SHAFT, END, "rules: [iacs-m69]"], (6, 9), "unknown rule `iacs-m69`",
         "there is iacs-m68, coupling-maker, gear-hammer, ice, universal-joints"),
    ],
)  # fmt: skip
def test_a_slip_is_answered_at_its_place_with_what_is_right(lines, place, message, hint) -> None:
    found = fault(*lines)
    assert ((found.line, found.column), found.message, found.hint) == (place, message, hint)


def test_a_steel_that_is_not_declared_is_answered_with_an_example_that_reads() -> None:
    shaft = "- shaft: {length: 1 m, diameter: 50 mm, material: 42CrMo4}"
    found = fault(MOTOR, shaft, END)
    assert found.message == "no material is called '42CrMo4'"
    example = found.hint.split("`")[1]
    made = torsion.parse(f"name: x\n{example}\ntrain:\n{MOTOR}\n{shaft}\n{END}\n")
    assert made.train.materials["42CrMo4"].shear_modulus == 79.3e9
    assert fault(MOTOR, shaft.replace("42CrMo4", "stel"), END).hint == "did you mean 'steel'?"


def test_a_word_with_its_mark_is_none_without_a_colon() -> None:
    assert [without_colon(word) for word in ("disc {inertia", "disc x", "disc", "disk {", "{")] == ["disc", "disc"] + [
        ""
    ] * 3


def test_only_candidates_with_the_figures_of_the_word_are_meant() -> None:
    assert of_its_number("m53", ["iacs-m68", "gear-hammer"]) == ["gear-hammer"]
    assert of_its_number("m86", ["iacs-m68"]) == of_its_number("iacs", ["iacs-m68"]) == ["iacs-m68"]
