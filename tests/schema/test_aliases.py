"""Other words for kinds and keys are read as the keys of the format; two words for one key are a fault."""

from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from docs.site.model_file_manual import pages

import torsion
from torsion.errors import InputError
from torsion.model import KINDS, KINDS_BY_ALIAS
from torsion.model.component import component_class
from torsion.schema.declaration_reader import KEYS_BY_ALIAS, SECTIONS_BY_ALIAS, keys_of, other_words
from torsion.schema.json_schema import json_schema
from torsion.schema.yaml_source import parse_source

CANONICAL = """name: x
operation: {at: motor-1, speeds: {from: 300 rpm, to: 900 rpm}, rated: {speed: 900 rpm, power: 10 kW}}
steps: none
train:
- motor: {inertia: 1}
- coupling: {stiffness: 5 kN*m/rad, psi: 1.1, rated_torque: 1 kN*m, vibratory_torque: 300 N*m, max_torque: 2 kN*m,
             heat_limit: 300 W}
- disc: {name: wheel, inertia: 2}
- gear: {ratio: 2, branches: [{ratio: 3, train: [coupling: {stiffness: 3 kN*m/rad}, disc: {inertia: 1}]}]}
- shaft: {length: 1 m, diameter: 80 mm, bore: 40 mm}
- joint: {angle: 5 deg}
- pump: {inertia: 3, entrained: 20 %}
links:
- {between: [motor-1, wheel], coupling: {stiffness: 1 kN*m/rad}}
cases:
  warm: {set: {coupling-1.psi: 0.9}}
"""
WRITTEN = """name: x
operation: {reference: motor-1, speeds: {from: 300 rpm, to: 900 rpm}, rated: {speed: 900 rpm, power: 10 kW}}
shoulders: none
train:
- motor: {inertia: 1}
- clutch: {stiffness: 5 kN*m/rad, relative_damping: 1.1, T_KN: 1 kN*m, T_KW: 300 N*m, T_Kmax: 2 kN*m,
           P_KW: 300 W}
- flywheel: {name: wheel, inertia: 2}
- gearbox: {ratio: 2, branches: [{ratio: 3, train: [spring: {stiffness: 3 kN*m/rad}, flywheel: {inertia: 1}]}]}
- shaft: {length: 1 m, OD: 80 mm, ID: 40 mm}
- cardan: {angle: 5 deg}
- impeller: {inertia: 3, entrained_water: 20 %}
links:
- {between: [motor-1, wheel], spring: {stiffness: 1 kN*m/rad}}
cases:
  warm: {set: {coupling-1.relative_damping: 0.9}}
"""
TRAIN = "name: x\ntrain:\n- disc: {inertia: 1}\n- {}\n- disc: {inertia: 2}\n"


def faults(text: str):
    with pytest.raises(InputError) as caught:
        torsion.parse(text)
    return caught.value.faults


def test_a_file_in_other_words_is_the_file_in_the_keys_of_the_format() -> None:
    read, canonical = torsion.parse(WRITTEN), torsion.parse(CANONICAL)
    assert list(read.cases) == ["warm"]
    assert replace(read, text="", cases={}) == replace(canonical, text="", cases={})
    assert read.cases["warm"].train == canonical.cases["warm"].train


@pytest.mark.parametrize("kind", KINDS_BY_ALIAS)
def test_another_word_for_a_kind_is_read(kind: str) -> None:
    body = {
        "coupling": "{stiffness: 5}",
        "gear": "{ratio: 2}",
        "joint": "{angle: 5 deg}",
        "pump": "{inertia: 1}",
        "disc": "{inertia: 1}",
        "machine": "{inertia: 1, power: 5 kW}",
    }[KINDS_BY_ALIAS[kind]]
    text = f"name: x\noperation: {{rated: {{speed: 9 rpm}}}}\ntrain:\n- motor: {{inertia: 1}}\n- {kind}: {body}\n"
    assert KINDS_BY_ALIAS[kind] in {
        part.kind for part in torsion.parse(text + "- disc: {inertia: 2}\n").train.parts
    }


def test_design_reads_the_words_of_optimisation() -> None:
    design = (
        "{%s: {coupling-1.stiffness: {from: 5, to: 9}}, %s: {mode-1.frequency: 0.5 Hz}, "
        "%s: [{mode-1.frequency: {outside: [1 Hz, 2 Hz]}}]}"
    )
    train = "name: x\ntrain: [disc: {inertia: 1}, coupling: {stiffness: 6}, disc: {inertia: 2}]\nanalyses:\n  design: "
    written = torsion.parse(train + design % ("variables", "objective", "constraints"))
    canonical = torsion.parse(train + design % ("choose", "aim", "keep"))
    assert written.analyses == canonical.analyses
    assert SECTIONS_BY_ALIAS["design"] == {
        "variables": "choose",
        "constraints": "keep",
        "objective": "aim",
        "pareto": "against",
    }


def test_two_words_for_one_key_are_a_fault_at_the_second() -> None:
    (fault,) = faults(TRAIN.replace("{}", "shaft: {length: 1 m, diameter: 80 mm, OD: 90 mm}"))
    assert (fault.line, fault.column, fault.message) == (
        4,
        41,
        "`OD` and `diameter` are the same key",
    )
    (fault,) = faults(TRAIN.replace("{}", "shaft: {length: 1 m, OD: 80 mm, outer_diameter: 90 mm}"))
    assert (fault.line, fault.message) == (4, "`outer_diameter` and `OD` are the same key")


def test_a_faulty_value_is_located_at_the_word_written() -> None:
    with pytest.raises(InputError, match=r"4:28: .*\n.*OD: 80 N") as caught:
        torsion.parse(TRAIN.replace("{}", "shaft: {length: 1 m, OD: 80 N}"))
    assert len(caught.value.faults) == 1


def test_a_table_has_other_words_as_columns_and_kinds(tmp_path: Path) -> None:
    table = "kind,inertia [kg*m**2],length [m],OD [mm],ID [mm]\nflywheel,1,,,\nshaft,,1,80,40\nflywheel,2,,,\n"
    (tmp_path / "line.csv").write_text(table, encoding="utf-8")
    (tmp_path / "train.yaml").write_text("name: x\ntrain: {table: line.csv}\n", encoding="utf-8")
    assert [part.kind for part in torsion.read(tmp_path / "train.yaml").train.parts] == [
        "disc",
        "shaft",
        "disc",
    ]


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


def test_aliases_and_hints_lead_to_keys_that_exist_and_hide_none() -> None:
    keys = {key for kind in KINDS for key in keys_of(component_class(kind))}
    assert set(KEYS_BY_ALIAS.values()) <= keys
    assert not set(KEYS_BY_ALIAS) & keys
    assert set(KINDS_BY_ALIAS.values()) <= set(KINDS)
    assert not (
        set(KINDS_BY_ALIAS) | {word for word, key, _ in other_words() if key == "<component>"}
    ) & set(KINDS)
    assert all(word == word.casefold() for word, _, _ in other_words())


def test_the_manual_lists_the_aliases() -> None:
    text = pages()
    assert "`T_KN`" in text["components/coupling.md"]
    assert "`spring`" in text["components/coupling.md"]
    assert "`reference`" in text["operation.md"]
    assert "`variables`" in text["analyses/design.md"]


def test_the_editor_accepts_every_alias() -> None:
    validator = pytest.importorskip("jsonschema").Draft202012Validator(json_schema())
    assert [
        error.message for error in validator.iter_errors(parse_source(CANONICAL, "x").data)
    ] == []
    assert [error.message for error in validator.iter_errors(yaml.safe_load(WRITTEN))] == []
