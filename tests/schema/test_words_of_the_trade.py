"""Other words for kinds and keys are read as the keys of the format; two words for one key are a fault."""

from pathlib import Path

import pytest

import torsion
from torsion.errors import InputError
from torsion.model import KINDS
from torsion.schema.declaration_reader import other_words

TRAIN = "name: x\ntrain:\n- disc: {inertia: 1}\n- {}\n- disc: {inertia: 2}\n"


def faults(text: str):
    with pytest.raises(InputError) as caught:
        torsion.parse(text)
    return caught.value.faults


@pytest.mark.parametrize(
    ("entry", "word", "hint"),
    [
        (
            "shaft: {length: 1 m, diameter: 9 mm, damping_ratio: 1 %}",
            "damping_ratio",
            "write `loss_factor` (eta, about 2 zeta)",
        ),
        (
            "coupling: {stiffness: 5, damping_ratio: 1 %}",
            "damping_ratio",
            "write `loss_factor` (eta, about 2 zeta) or `psi` (2 pi eta)",
        ),
        ("coupling: {stiffness: 5, T_KN: 5}", "T_KN", "write `rated_torque` (T_KN)"),
        ("shaft: {length: 1 m, OD: 9 mm}", "OD", "write `diameter` (outer diameter)"),
        ("disc: {inertia: 1, fixed: true}", "fixed", "write `held` (a fixed end)"),
        ("coupling: {k: 5}", "k", "write `stiffness` (torsional stiffness)"),
        ("coupling: {stiffness: 5, backlash: 1 deg}", "backlash", "write `clearance` (backlash)"),
        ("disc: {J: 5}", "J", "write `inertia` (polar mass moment of inertia)"),
        ("gear: {reduction: 5}", "reduction", "write `ratio` (speed before / speed after)"),
        (
            "gear: {ratio: 2, branches: [{i: 3, train: [disc: {inertia: 1}]}]}",
            "i",
            "write `ratio` (speed before / speed after)",
        ),
        (
            "shaft: {length: 1 m, diameter: 9 mm, colour: 5}",
            "colour",
            "docs/reference/model-file lists the 19 keys",
        ),
    ],
)
def test_an_unknown_key_gets_the_key_that_the_trade_means_or_none(
    entry: str, word: str, hint: str
) -> None:
    fault = next(
        fault for fault in faults(TRAIN.replace("{}", entry)) if "unknown" in fault.message
    )
    assert (fault.message, fault.hint) == (f"unknown key `{word}`", hint)


@pytest.mark.parametrize(
    ("text", "hint"),
    [
        (TRAIN.replace("{}", "flywheel: {inertia: 1}"), "`disc: {inertia: ...}`"),
        (TRAIN.replace("{}", "spring: {stiffness: 1}"), "`coupling: {stiffness: ...}`"),
        (TRAIN + "shoulders: none\n", "write `steps` (steps between shafts)"),
        (
            TRAIN.replace("{}", "disc: {inertia: 1}") + "operation: {reference: disc-1}\n",
            "write `at` (the component whose speed is meant)",
        ),
    ],
)
def test_another_word_for_a_kind_or_a_section_is_refused_with_the_word_of_the_format(
    text: str, hint: str
) -> None:
    assert hint in [fault.hint for fault in faults(text)]


def test_a_table_with_another_word_says_the_column(tmp_path: Path) -> None:
    (tmp_path / "line.csv").write_text("kind,OD [mm]\nshaft,80\n", encoding="utf-8")
    (tmp_path / "train.yaml").write_text("name: x\ntrain: {table: line.csv}\n", encoding="utf-8")
    with pytest.raises(InputError, match=r"unknown column `OD` \(write `diameter`"):
        torsion.read(tmp_path / "train.yaml")


def test_other_words_lead_to_keys_that_exist_and_hide_none() -> None:
    kinds = {word for word, key, _ in other_words() if key == "<component>"}
    assert not kinds & set(KINDS)
    assert all(word == word.casefold() for word, _, _ in other_words())
