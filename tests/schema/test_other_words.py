"""Words of the trade that the format writes otherwise, and slips of its marks: each is answered with what is right."""

import pytest
import yaml
from tests.for_all import for_all

import torsion
from torsion.analyses import ANALYSES
from torsion.errors import InputError
from torsion.rules import RULES
from torsion.schema import yaml_source
from torsion.schema.declaration_reader import of_its_number, other_words
from torsion.schema.fault_text import without_mark

ANALYSIS_FOR = {word: meaning for word, key, meaning in other_words() if key == "<analysis>"}
MOTOR, END = "- motor: {inertia: 1}", "- disc: {inertia: 2}"
COLON, WRITE = "a colon is missing after `coupling`", "write `- coupling: {...}`"
DASHLESS, DASH = "`motor` begins without a dash", "write `- motor: ...`"
ALIGNED = (
    "this does not fit the lines above",
    "what belongs to one list or mapping begins in one column",
)
SHAFT = "- shaft: {length: 1 m, diameter: 50 mm, role: intermediate}"


def fault(*lines: str):
    """The only fault of a scene of these lines, which begin in line 3."""
    with pytest.raises(InputError) as caught:
        torsion.parse("name: x\ntrain:\n" + "\n".join(lines) + "\n")
    (one,) = caught.value.faults
    return one


@for_all(
    ("lines", "place", "message", "hint"),
    [
        (
            [MOTOR, "- coupling {stiffness: 5}", END],
            (4, 3),
            "a colon is missing after `coupling`",
            "write `- coupling: {...}`",
        ),
        (
            [MOTOR, "- coupling {}", END],
            (4, 3),
            "'coupling {}' is not a component, a mapping with one key",
            "write `- coupling: {...}`",
        ),
        (
            ["- alternator: {inertia: 1}", END],
            (3, 3),
            "unknown component `alternator`",
            "`generator: {inertia: ...}`",
        ),
        (
            [MOTOR, "- gear: {ratio: 1/5.77}", END],
            (4, 17),
            "'1/5.77' is not a number",
            "a quotient has whole numbers: write 100/577",
        ),
        (
            [MOTOR, "- gear: {ratio: 1/0}", END],
            (4, 17),
            "'1/0' is not a number",
            "write 2, 0.5 or 21/8",
        ),
        (
            [MOTOR, "coupling: {stiffness: 5}", END],
            (4, 1),
            "`coupling` begins without a dash",
            "write `- coupling: ...`",
        ),
        (
            ["  motor: {inertia: 1}", "  disc: {inertia: 2}"],
            (3, 3),
            "a mapping is not a list of components",
            "begin each component with a dash: `- motor: ...`",
        ),
        (
            [END, "motor: {inertia: 3}"],
            (4, 1),
            "unknown key `motor`",
            "a component is an entry of `train`, with a dash: `- motor: ...`",
        ),
        (
            [MOTOR, SHAFT, END, "rules: [m68]"],
            (6, 9),
            "unknown rule `m68`",
            "did you mean `iacs-m68`?",
        ),
        (
            [MOTOR, SHAFT, END, "rules: [m53]"],
            (6, 9),
            "unknown rule `m53`",
            "did you mean `iacs-m53`?",
        ),
        (
            [MOTOR, SHAFT, END, "rules: [iacs-m69]"],
            (6, 9),
            "unknown rule `iacs-m69`",
            f"there is {', '.join(RULES)}",
        ),
        (
            [MOTOR, "- gear: {ratio: 5.77:1}", END],
            (4, 17),
            "'5.77:1' is not a number",
            "write 5.77",
        ),
        (
            [MOTOR, "- gear: {ratio: 1:5.77}", END],
            (4, 17),
            "'1:5.77' is not a number",
            "write 100/577",
        ),
        ([MOTOR, "- gear: {ratio: 21:8}", END], (4, 17), "'21:8' is not a number", "write 21/8"),
        (
            [MOTOR, "- gear: {ratio: 0:1}", END],
            (4, 17),
            "'0:1' is not a number",
            "write 2, 0.5 or 21/8",
        ),
        (
            [MOTOR, "- coupling:{stiffness: 5}", END],
            (4, 3),
            "a blank is missing after the colon of `coupling`",
            WRITE,
        ),
        (
            [MOTOR, END, "operation:", "  speeds {from: 3 rpm}"],
            (6, 3),
            "a colon is missing after `speeds`",
            "write `speeds: {...}`",
        ),
        (
            [MOTOR, "- coupling: {stiffness:20 kN*m/rad, psi: 1}", END],
            (4, 14),
            "`stiffness:20 kN*m/rad` has no value",
            "a blank is missing after the colon: `stiffness: 20 kN*m/rad`",
        ),
        (
            [MOTOR, SHAFT, END, "rules:", "- gear-hammer {limit: 0.3}"],
            (7, 3),
            "a colon is missing after `gear-hammer`",
            "write `- gear-hammer: {...}`",
        ),
    ],
)
def test_a_slip_is_answered_at_its_place_with_what_is_right(lines, place, message, hint) -> None:
    found = fault(*lines)
    assert ((found.line, found.column), found.message, found.hint) == (place, message, hint)


@for_all("loader", ["libyaml", "python"])
@for_all(
    ("lines", "place", "message", "hint"),
    [
        ([MOTOR, "- coupling {stiffness: 5, psi: 1}", END], (4, 3), COLON, WRITE),
        ([f"  {MOTOR}", "  -  coupling{stiffness: 5, psi: 1}"], (4, 6), COLON, WRITE),
        ([MOTOR, "- coupling {stiffness: 5,", "    psi: 1}", END], (4, 3), COLON, WRITE),
        (
            [MOTOR, "- coupling:{stiffness: 5, psi: 1}", END],
            (4, 3),
            "a blank is missing after the colon of `coupling`",
            WRITE,
        ),
        ([MOTOR, "- coupling", "    stiffness: 5", "    psi: 1", END], (4, 3), COLON, WRITE),
        (
            [MOTOR, "- coupling # of rubber", "", "    # new", "    stiffness: 5", END],
            (4, 3),
            COLON,
            WRITE,
        ),
        (
            [MOTOR, "- coupling: {stiffness: 5, clearance {angle: 1 deg}}", END],
            (4, 28),
            "a colon is missing after `clearance`",
            "write `clearance: {...}`",
        ),
        (
            [MOTOR, END, "operation:", "  speeds {from: 3 rpm, to: 5 rpm}"],
            (6, 3),
            "a colon is missing after `speeds`",
            "write `speeds: {...}`",
        ),
        (
            [MOTOR, END, "excitations [{at: x}, {at: y}]"],
            (5, 1),
            "a colon is missing after `excitations`",
            "write `excitations: [...]`",
        ),
        (["    motor: {inertia: 1}", "  - gear: {ratio: 2}", f"  {END}"], (3, 5), DASHLESS, DASH),
        (
            ["  motor:", "    inertia: 1", "  - gear: {ratio: 2}", f"  {END}"],
            (3, 3),
            DASHLESS,
            DASH,
        ),
        (["motor: {inertia: 1}", END], (3, 1), DASHLESS, DASH),
        ([f"  {END}", "  motor: {inertia: 1}", f"  {END}"], (4, 3), DASHLESS, DASH),
        ([f"  {END}", "   motor: {inertia: 1}"], (4, 4), DASHLESS, DASH),
        (
            [f"  {MOTOR}", "  - coupling:", "      stiffness: 5", "  psi: 1"],
            (6, 3),
            *ALIGNED,
        ),  # no kind: no dash
        (
            [
                MOTOR,
                "links:",
                "  - between: [a, b]",
                "    coupling: {stiffness: 1}",
                " - between: [c, d]",
            ],
            (7, 2),
            *ALIGNED,
        ),
        (
            [MOTOR, "- coupling: {stiffness: 5, psi: 1}", "- gear: ratio: 2"],
            (5, 14),
            "a ':' is not allowed here",
            "check the indentation of this line and the one above; put text that holds ': ' in quotes",
        ),
    ],
)
def test_a_missing_mark_is_named_where_it_is_missing(
    lines, place, message, hint, loader, monkeypatch
) -> None:
    if loader == "python":
        monkeypatch.setattr(yaml_source, "_LOADER", yaml.SafeLoader)
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


def test_a_word_with_its_mark_is_none_without_it() -> None:
    words = ("disc {inertia", "disc x", "disc:{inertia", "disc", "disk {", "{")
    missing = [("disc", ""), ("disc", ""), ("disc", ":"), None, None, None]
    assert [without_mark(word, ["disc"]) for word in words] == missing


def test_only_candidates_with_the_figures_of_the_word_are_meant() -> None:
    assert of_its_number("m53", ["iacs-m68", "gear-hammer"]) == ["gear-hammer"]
    assert of_its_number("m86", ["iacs-m68"]) == of_its_number("iacs", ["iacs-m68"]) == ["iacs-m68"]


@for_all(
    ("line", "hint"),
    [
        ("- motor: {inertia: 1, torque_ripple: 2}", "write `ripple`"),
        ("- gear: {gear_teeth: [20, 30]}", "write `teeth`"),
        ("- coupling: {stiffness: 1, torque_rating: 2}", "write `rated_torque` (T_KN)"),
    ],
)
def test_a_key_inside_of_a_word_is_offered(line: str, hint: str) -> None:
    assert fault(MOTOR, line, END).hint == hint


@for_all("word", sorted(ANALYSIS_FOR))
def test_a_word_for_an_analysis_is_answered_with_keys_that_there_are(word: str) -> None:
    found = fault(MOTOR, END, f"analyses: {{{word}: {{}}}}")
    assert (found.message, found.hint) == (f"unknown analysis `{word}`", ANALYSIS_FOR[word])
    key = found.hint.split("`")[1].split(":")[0]
    assert key in ANALYSES or key == "cases"
