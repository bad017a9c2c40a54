"""An editor marks a quantity in the wrong unit, and nothing that the reader takes."""

import re
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.for_all import for_all
from tests.test_units import QUANTITIES

from torsion import units
from torsion.schema.json_schema import json_schema
from torsion.schema.manual import pages
from torsion.schema.unit_patterns import pattern, spellings
from torsion.schema.yaml_source import parse_source

ROOT = Path(__file__).parents[2]
KNOWN = list(units._KINDS)
WORDS = [
    "N",
    "kN",
    "m",
    "mm",
    "rad",
    "deg",
    "s",
    "kg",
    "lbf",
    "in",
    "rpm",
    "Hz",
    "min",
    "/",
    "*",
    "·",
    " ",
    "**2",
    "²",
    "(",
    ")",
    "%",
    "J",
    "kW",
    "1/",
    "-",
    "GPa",
    "°",
    "5",
    "e3",
    ".",
    "1_0",
    "kNm",
    "kgm2",
    "Nms",
]

TWOFOLD = {
    ("K", "degC")
}  # 300 K is a temperature and a difference of temperature; 20 degC is a temperature alone


def takes(text: str, unit: str) -> bool:
    try:
        units.to_si(text, unit)
    except units.UnitFault:
        return False
    return True


@pytest.fixture(scope="module")
def validator():
    return pytest.importorskip("jsonschema").Draft202012Validator(json_schema())


@for_all(("text", "unit", "expected"), QUANTITIES)
def test_a_quantity_that_is_read_fulfils_its_pattern(text: str, unit: str, expected: float) -> None:
    assert re.search(pattern(unit), text)


@for_all("unit", KNOWN)
def test_the_example_of_a_quantity_fulfils_its_pattern_and_no_other(unit: str) -> None:
    fulfilled = [other for other in KNOWN if re.search(pattern(other), units.example(unit))]
    assert fulfilled == [other for other in KNOWN if other == unit or (unit, other) in TWOFOLD]


@settings(max_examples=400, deadline=None)
@given(st.data())
def test_usual_spellings_of_one_quantity_are_refused_for_every_other(data: st.DataObject) -> None:
    """By the pattern and by the reader; and the pattern of its own takes what the reader takes."""
    unit, expected = data.draw(st.sampled_from(KNOWN)), data.draw(st.sampled_from(KNOWN))
    text = "20 " + data.draw(st.from_regex(spellings(unit), fullmatch=True))
    fits = unit == expected or (unit, expected) in TWOFOLD
    assert bool(re.search(pattern(expected), text)) == fits
    assert fits or not takes(text, expected)


def expanded(body: Any) -> list[str]:
    """Every text of a parsed regular expression, without the signs and blanks that it may leave out."""
    texts = [""]
    for kind, value in body:
        name = str(kind)
        if name == "LITERAL":
            found = [chr(value)]
        elif name == "IN":
            found = [chr(one[1]) for one in value if str(one[0]) == "LITERAL"]
        elif name == "BRANCH":
            found = [text for one in value[1] for text in expanded(one)]
        elif name == "SUBPATTERN":
            found = expanded(value[-1])
        else:
            assert (name, *value[:2]) == ("MAX_REPEAT", 0, 1)
            inner = expanded(value[2])
            found = [""] if " " in inner else ["", *inner]
        texts = [text + one for text in texts for one in dict.fromkeys(found)]
    return texts


@for_all("unit", KNOWN)
def test_no_usual_spelling_of_one_quantity_is_read_as_another(unit: str) -> None:
    """Every one without signs between its units: `kgfs`, which names kgf in the plural, is none of `kgf s`."""
    for text in expanded(re._parser.parse(spellings(unit))):  # type: ignore[attr-defined]
        others = (one for one in KNOWN if one != unit and not {(unit, one), (one, unit)} & TWOFOLD)
        assert [other for other in others if takes(f"20 {text}", other)] == [], text


@settings(max_examples=1500, deadline=None)
@given(
    st.lists(st.sampled_from(WORDS), max_size=6),
    st.sampled_from(["20", "1.5e3", "-.5", "2_000", "", " 3"]),
)
def test_what_a_pattern_refuses_the_reader_refuses(pieces: list[str], number: str) -> None:
    for text in (number + "".join(pieces), f"{number} {''.join(pieces)}"):
        for unit in KNOWN:
            assert re.search(pattern(unit), text) or not takes(text, unit), (text, unit)


def test_what_a_pattern_refuses_of_two_units_at_once_is_neither() -> None:
    both = pattern("N*m", "1")
    assert re.search(both, "5 %")
    assert re.search(both, "5 kNm")
    assert not re.search(both, "5 kN/m")


@pytest.mark.parametrize(
    ("good", "bad"),
    [
        ("coupling: {stiffness: 20 kN*m/rad}", "coupling: {stiffness: 20 kN/m}"),
        ("coupling: {stiffness: 20 kNm/rad}", "coupling: {stiffness: 20 kNm}"),
        ("coupling: {stiffness: 2e4}", "coupling: {stiffness: soft}"),
        ("disc: {inertia: 2 kgm2}", "disc: {inertia: 2 kg}"),
        ("disc: {inertia: 2 kgm²}", "disc: {inertia: 2 kN·m}"),
        (
            "shaft: {length: 1 m, diameter: [60 mm, 50 mm]}",
            "shaft: {length: 1 m, diameter: [60 mm, 50 N/mm2]}",
        ),
        ("joint: {angle: 5°}", "joint: {angle: 5 mm}"),
        (
            "motor: {inertia: 1, ripple: [{order: 2, torque: 5 %}]}",
            "motor: {inertia: 1, ripple: [{order: 2, torque: 5 m}]}",
        ),
        ("motor: {inertia: 1, power: 5 PS}", "motor: {inertia: 1, power: 5 kN}"),
    ],
)
def test_the_editor_marks_a_wrong_unit(validator, good: str, bad: str) -> None:
    def faults(entry: str) -> list[str]:
        data = parse_source(f"name: x\ntrain:\n- {entry}\n", "f").data
        return [error.message for error in validator.iter_errors(data)]

    assert faults(good) == []
    assert faults(bad) != []


def test_every_example_of_the_manual_is_valid(validator) -> None:
    blocks = [
        block
        for text in pages().values()
        for block in re.findall(r"```yaml\n(.*?)```", text, re.DOTALL)
    ]
    assert len(blocks) > 60
    for block in blocks:
        data = parse_source(block, "page.md").data
        parts = [
            {"train": data},
            {"links": data},
            {"excitations": data},
            {"analyses": data},
            {"rules": [data]},
            data,
        ]
        whole = (
            [data]
            if isinstance(data, dict) and "train" in data
            else [
                {"name": "x", "train": [{"disc": {"inertia": 1}}], **part}
                for part in parts
                if isinstance(part, dict)
            ]
        )
        assert any(validator.is_valid(scene) for scene in whole), block
