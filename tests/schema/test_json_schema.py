"""The JSON Schema takes what the reader takes and refuses what is wrong in structure."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from docs.site.model_file_manual import pages
from tests.for_all import for_all

from torsion.analyses import settings_classes
from torsion.errors import InputError
from torsion.model import KINDS
from torsion.model.component import component_class
from torsion.rules import RULES, settings
from torsion.schema import template
from torsion.schema.aliases import aliases_of
from torsion.schema.json_schema import declarations, json_schema, setting_examples
from torsion.schema.scene_reader import parse
from torsion.schema.yaml_source import parse_source

jsonschema = pytest.importorskip("jsonschema")
ROOT = Path(__file__).parents[2]
SCENES = sorted((ROOT / "shafting_specs").glob("**/*.yaml"))
GOOD = (ROOT / "tests" / "faults" / "good.yaml").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def validator():
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def refusals(validator, text: str) -> list[str]:
    return [error.message for error in validator.iter_errors(parse_source(text, "train.yaml").data)]


@for_all("path", SCENES)
def test_every_scene_of_the_repository_is_valid(validator, path):
    assert refusals(validator, path.read_text(encoding="utf-8")) == []


@pytest.mark.parametrize(
    "text", [GOOD, template("example.yaml")], ids=["one of every kind", "example"]
)
def test_scene_with_every_sort_of_value_is_valid(validator, text):
    assert refusals(validator, text) == []


@for_all("name", RULES)
def test_a_rule_and_its_settings_may_be_left_empty_where_the_reader_takes_it(validator, name):
    for entry in (name, f"{{{name}: }}", f"{{{name}: {{}}}}"):
        text = f"name: x\ntrain: [disc: {{inertia: 1}}, shaft: {{length: 1, diameter: 0.1}}]\nrules: [{entry}]\n"
        try:
            parse(text, "f")
            words = ""
        except InputError as error:
            words = str(error)
        if "has no value" not in words and "is missing" not in words:
            assert refusals(validator, text) == []


@for_all(
    ("good", "bad"),
    [
        ("name: A train", "nam: A train"),
        ("length: 0.8 m", "lenght: 0.8 m"),
        ("length: 0.8 m, ", ""),
        ("length: 0.8 m", "length: [0.8, 0.9]"),
        ("diameter: [70 mm, 76 mm]", "diameter: {from: 70 mm}"),
        ("angle: 5 deg", "angle: 5"),
        ("from: 300 rpm", "from: 300"),
        ("steps: 31", "steps: 1"),
        ("load: propeller", "load: 5"),
        ("load: propeller", "load: fan"),
        ("joint: {angle: 5 deg}", "jiont: {angle: 5 deg}"),
        ("- joint: {angle: 5 deg}", "- {joint: {angle: 5 deg}, disc: {inertia: 1}}"),
        ("- joint: {angle: 5 deg}", "- engine: {cylinders: 6}"),
        ("psi: 0.8", "table: [[1, 2]]"),
        ("psi: 0.8", "psi: null"),
        ("inertia: [0.1, 0.2]", "inertia: [0.1]"),
        ("inertia: [0.1, 0.2]", "inertia: [0.1, 0.2, 0.3]"),
        ("teeth: [20, 41]", "teeth: 20"),
        ("train: [disc: {name: generator, inertia: 0.7}]", "train: [disk: {inertia: 0.7}]"),
        ("role: thrust", "role: trust"),
        ("model: archer", "model: arche"),
        ("blade_order: 1, ", ""),
        ("blades: 4", "blades: 4.5"),
        ("[screw, screw cap]", "[screw]"),
        ("    coupling: {stiffness: 1e5}", "    disc: {inertia: 1}"),
        ("order: 2, torque: 100 N*m", "order: 2"),
        ("model: lumped", "model: beam"),
        ("modes: {count: 6}", "transient: {}"),
        ("count: 6", "cuont: 6"),
        ("- iacs-m68", "- iacs"),
        ("{limit: 0.35}", "{limits: 0.35}"),
    ],
)
def test_structural_fault_is_refused(validator, good, bad):
    assert good in GOOD
    assert refusals(validator, GOOD.replace(good, bad)) != []


def test_every_key_of_every_kind_is_offered_with_its_meaning():
    definitions = json_schema()["$defs"]
    for kind in KINDS:
        entry = definitions["train"]["anyOf"][0]["items"]["properties"][kind]
        keys = definitions[entry["$ref"].removeprefix("#/$defs/")]["properties"]
        own = {field.alias or name for name, field in component_class(kind).model_fields.items()}
        assert set(keys) == own | aliases_of(own).keys()
        assert [key for key, body in keys.items() if not body.get("description")] == []


def test_every_reference_of_the_schema_is_defined():
    def references(body):
        if isinstance(body, dict):
            yield from ([body["$ref"]] if "$ref" in body else [])
        if isinstance(body, dict | list):
            for part in body.values() if isinstance(body, dict) else body:
                yield from references(part)

    schema = json_schema()
    assert {name.removeprefix("#/$defs/") for name in references(schema)} == set(schema["$defs"])


def test_nothing_in_the_schema_lacks_a_description(validator):
    """Every key of every mapping, and every mapping that has a name, says what it is where an editor looks for it."""

    def silent(body, path):
        if isinstance(body, dict):
            for key, one in body.get("properties", {}).items():
                if isinstance(one, dict) and not one.get("description"):
                    yield f"{path}: {key}"
        if isinstance(body, dict | list):
            for step, part in body.items() if isinstance(body, dict) else enumerate(body):
                yield from silent(part, f"{path}/{step}")

    schema = json_schema()
    assert list(silent(schema, "")) == []
    assert [name for name, body in schema["$defs"].items() if not body.get("description")] == []


def test_every_kind_has_examples_that_are_valid_and_defaults_are_said(validator):
    schema = json_schema()
    kinds = schema["$defs"]["train"]["anyOf"][0]["items"]["properties"]
    for kind in KINDS:
        assert kinds[kind]["examples"]
        for body in kinds[kind]["examples"]:
            scene = {"name": "x", "train": [{"disc": {"inertia": 1}}, {kind: body}]}
            assert [error.message for error in validator.iter_errors(scene)] == []
    analyses = schema["properties"]["analyses"]["properties"]
    rules = schema["properties"]["rules"]["items"]["anyOf"][1]["properties"]
    for name in settings_classes():
        for body in analyses[name]["examples"]:
            scene = {"name": "x", "train": [{"disc": {"inertia": 1}}], "analyses": {name: body}}
            assert [error.message for error in validator.iter_errors(scene)] == []
            assert settings_classes()[name].model_validate(
                parse_source(setting_examples()[name], "f").data[name]
            )
    for name in RULES:
        for body in rules[name]["examples"]:
            scene = {"name": "x", "train": [{"disc": {"inertia": 1}}], "rules": [{name: body}]}
            assert [error.message for error in validator.iter_errors(scene)] == []
            assert settings(name).model_validate(body)
    assert schema["$defs"]["SpeedRange"]["properties"]["steps"]["default"] == 201
    assert schema["$defs"]["Shaft"]["properties"]["material"]["default"] == "steel"


def test_every_default_of_a_declaration_is_that_of_the_schema_unless_it_needs_a_unit():
    schema = json_schema()
    found = 0
    for kind in declarations().values():
        body = schema["$defs"].get(kind.__name__, {}).get("properties", {})
        for name, field in kind.model_fields.items():
            written = body.get(field.alias or name)
            if written is None or not isinstance(field.default, str | bool | int | float):
                continue
            found += "default" in written
            needs_unit = "pattern" in written and "x-usual" in written
            assert needs_unit or written["default"] == field.default, (kind, name)
    assert found > 30


def test_the_schema_is_printed_without_docstrings_too() -> None:
    """Python leaves docstrings out with PYTHONOPTIMIZE=2; the keys are the same."""
    command = [sys.executable, "-m", "torsion", "schema"]
    printed = subprocess.run(
        command, env={**os.environ, "PYTHONOPTIMIZE": "2"}, capture_output=True, check=True
    ).stdout
    assert json.loads(printed)["properties"].keys() == json_schema()["properties"].keys()


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
