"""Whatever stands in a file, the reader ends in a study or in located faults, never in anything else."""

from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tests.texts import ANY_CHARACTER

from torsion.errors import InputError
from torsion.model import KINDS
from torsion.model.component import component_class
from torsion.schema import template
from torsion.schema.scene_reader import parse
from torsion.study import Study

ROOT = Path(__file__).parents[2]
GOOD = [
    (ROOT / "tests" / "faults" / "good.yaml").read_text(encoding="utf-8"),
    template("example.yaml"),
]
FIELDS = {
    field.alias or key
    for kind in KINDS
    for key, field in component_class(kind).model_fields.items()
}
WORDS = sorted(
    {"train", "between", "at", "limit", "count", "name", "of_mean", "from", "to", *KINDS, *FIELDS}
)
ODD = """ ~ -1 0 1e400 .nan 1e-320 5_deg 1e99999999_N*m '1e99999999' true no [] {} [[]] [1,_2] [null] {a:_1} {null:_1}
*a &a_5 !!int_5 ' " 5_% -_x 1/3 0x1F 12:30 2026-01-01 \ud7ff ° << disc steel [x,_x] {train:_[]} @ ? | > # a:_b"""
ODD = ["", "\t", "9" * 400, *(word.replace("_", " ") for word in ODD.split())]
DUMPER = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
BREAKS = "\n\r\x85\u2028\u2029"


def quick(examples: int) -> settings:
    return settings(
        max_examples=examples,
        deadline=None,
        derandomize=True,
        suppress_health_check=list(HealthCheck),
        database=None,
    )


def ends_well(text: str) -> None:
    try:
        found = parse(text)
    except InputError as error:
        found = error
    if isinstance(found, Study):
        return
    lines = 1 + sum(text.count(sign) for sign in BREAKS)
    assert found.faults
    assert all(fault.line and fault.column and 1 <= fault.line <= lines for fault in found.faults)
    assert all(fault.message for fault in found.faults)
    assert str(found)


scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | st.text(ANY_CHARACTER, max_size=8)
    | st.sampled_from([*WORDS, *ODD])
)
nested = st.recursive(
    scalars,
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.sampled_from(WORDS) | st.text(ANY_CHARACTER, max_size=5), inner)
    ),
    max_leaves=12,
)
entries = st.lists(
    st.dictionaries(st.sampled_from(sorted(KINDS)), nested, min_size=1, max_size=1), max_size=4
)
sections = ["materials", "operation", "links", "excitations", "analyses", "rules", "description"]


@quick(80)
@given(
    st.fixed_dictionaries(
        {"train": entries | nested}, optional=dict.fromkeys(["name", *sections], nested)
    )
)
def test_arbitrary_data_under_the_keys_of_the_format_ends_in_a_study_or_in_located_faults(data):
    ends_well(yaml.dump(data, Dumper=DUMPER, allow_unicode=True))


@quick(100)
@given(st.data())
def test_file_with_mutilated_lines_ends_in_a_study_or_in_located_faults(data):
    lines = data.draw(st.sampled_from(GOOD)).splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        place = data.draw(st.integers(0, len(lines) - 1))
        match data.draw(st.sampled_from(["delete", "repeat", "move", "indent", "cut"])):
            case "delete":
                lines[place] = ""
            case "repeat":
                lines.insert(data.draw(st.integers(0, len(lines))), lines[place])
            case "move":
                lines.insert(data.draw(st.integers(0, len(lines) - 1)), lines.pop(place))
            case "indent":
                lines[place] = " " * data.draw(st.integers(0, 9)) + lines[place].lstrip()
            case _:
                lines[place] = lines[place][: data.draw(st.integers(0, len(lines[place])))]
    ends_well("\n".join(lines))


@quick(150)
@given(st.data())
def test_file_with_exchanged_values_ends_in_a_study_or_in_located_faults(data):
    lines = data.draw(st.sampled_from(GOOD)).splitlines()
    for _ in range(data.draw(st.integers(1, 2))):
        place = data.draw(
            st.sampled_from([number for number, line in enumerate(lines) if ": " in line])
        )
        parts = lines[place].split(": ")
        piece = data.draw(st.integers(1, len(parts) - 1))
        value, *rest = parts[piece].split(",", 1)
        closing = value[len(value.rstrip("}] ")) :]
        parts[piece] = ",".join([data.draw(st.sampled_from(ODD)) + closing, *rest])
        lines[place] = ": ".join(parts)
    ends_well("\n".join(lines))


@pytest.mark.parametrize("section", ["name", "train", *sections])
def test_odd_section_ends_in_a_study_or_in_located_faults(section):
    for odd in ODD:
        body = {"name": "a", "train": "[disc: {inertia: 1}]"} | {section: odd}
        ends_well("\n".join(f"{key}: {value}" for key, value in body.items()))
