"""JSON Schema of the whole file, from the same declarations that read it, so that an editor completes and checks it."""

from collections.abc import Iterator, Mapping
from functools import cache
from importlib import import_module
from typing import Any

from pydantic.json_schema import GenerateJsonSchema, JsonSchemaValue, models_json_schema
from pydantic_core import core_schema

from torsion.analyses import ANALYSES, MODELS, settings_classes
from torsion.fields import Declared, OneOrMany, Quantity
from torsion.model import KINDS, KINDS_BY_ALIAS
from torsion.model.component import Component, Material, component_class
from torsion.model.machine_torques import Excitation
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.schema import template
from torsion.schema.aliases import aliases_of
from torsion.schema.declaration_reader import SECTIONS_BY_ALIAS, items_of, mappings_of
from torsion.schema.scene_reader import LINKS, Scene
from torsion.schema.table_rows import MAPPINGS, PAIRS
from torsion.schema.variants.cases import FROM, TOLERANCES, CaseKeys
from torsion.schema.yaml_source import parse_source
from torsion.study import FiniteElements, FrontMatter, ModalDamping, Operation, ShaftModel

Schema = dict[str, Any]
TABLE: Schema = {
    "description": "a CSV file whose rows are read here, its path relative to the folder of this file",
    "type": "object",
    "properties": {
        "table": {"type": "string", "description": "the file", "examples": ["line.csv"]}
    },
    "required": ["table"],
    "additionalProperties": False,
}


def declarations() -> dict[str, type[Declared]]:
    """Every declaration of the format by its word in the file."""
    return {
        **{kind: component_class(kind) for kind in KINDS},
        "document": FrontMatter,
        "material": Material,
        "operation": Operation,
        "damping": ModalDamping,
        "excitation": Excitation,
        "fem": FiniteElements,
        "case": CaseKeys,
        **settings_classes(),
        **{name: rule_settings(name) for name in RULES},
    }


def first_line(declared: type) -> str:
    """Return the first line of a docstring, with PYTHONOPTIMIZE=2 an empty text."""
    return (declared.__doc__ or "").strip().partition("\n")[0]


def parts_within(declared: type[Declared]) -> Iterator[type[Declared] | Quantity]:
    """Yield a declaration, the quantities in it, and the same of its mappings; without components in it."""
    yield declared
    for field in declared.model_fields.values():
        yield from (item for item in items_of(field) if isinstance(item, Quantity))
        for part in mappings_of(field):
            if not issubclass(part, Component):
                yield from parts_within(part)


@cache
def setting_examples() -> dict[str, str]:
    """Return an example of the settings of every analysis and rule by its name."""
    examples = template("setting_examples.txt").strip().split("\n\n")
    return {example.partition(":")[0]: example for example in examples}


class _Declarations(GenerateJsonSchema):
    """Keys without a value are refused by the reader, so null is no choice; one value stands for a list of one."""

    def nullable_schema(self, schema: core_schema.NullableSchema) -> JsonSchemaValue:
        return self.generate_inner(schema["schema"])

    def default_schema(self, schema: core_schema.WithDefaultSchema) -> JsonSchemaValue:
        inner, default = self.generate_inner(schema["schema"]), schema.get("default")
        is_plain = isinstance(default, str | bool | int | float) and "pattern" not in inner
        return inner | {"default": default} if is_plain and "$ref" not in inner else inner

    def field_title_should_be_set(self, schema: Any) -> bool:
        return False

    def function_before_schema(
        self, schema: core_schema.BeforeValidatorFunctionSchema
    ) -> JsonSchemaValue:
        inner = super().function_before_schema(schema)
        if schema["function"]["function"] is OneOrMany.func and "items" in inner:
            return {"anyOf": [inner["items"], inner]}
        return inner


def json_schema() -> Schema:
    """The schema (draft 2020-12) of a shaft-train file; parts of the format that are not built yet are absent."""
    models = declarations()
    references, shared = models_json_schema(
        [(model, "validation") for model in dict.fromkeys(models.values())],
        schema_generator=_Declarations,
    )
    refs = {name: dict(references[model, "validation"]) for name, model in models.items()}
    schema = Scene.model_json_schema(schema_generator=_Declarations)
    kinds = dict[str, Schema]()
    for kind in KINDS:
        entries = parse_source(component_class(kind).example or "[]", kind).data
        examples = [entry[kind] for entry in entries if kind in entry]
        about = {"description": first_line(component_class(kind)), "examples": examples}
        kinds[kind] = refs[kind] | about
    kinds |= {
        word: refs[kind] | {"description": f"another word for `{kind}`"}
        for word, kind in KINDS_BY_ALIAS.items()
    }
    for key, body in _sections(refs, kinds).items():
        schema["properties"][key] |= body
    schema |= {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Shaft train",
        "description": "A train of shafts and what is computed of it.",
    }
    keys_of_case = shared["$defs"]["CaseKeys"]["properties"]
    keys_of_case["rules"] |= {key: schema["properties"]["rules"][key] for key in ("type", "items")}
    named = {
        "description": "a CSV file whose rows are read here, one component each",
        "type": "string",
    }
    train = _or_table(_list_of(_one_of({**kinds, "table": named})))
    # A table wherever the reader takes one; every other word of such a key stays.
    for model in shared["$defs"].values():
        for key in {*MAPPINGS, *PAIRS} & set(model.get("properties", {})):
            body = model["properties"][key]
            lists = [form for form in (body, *body.get("anyOf", ())) if form.get("type") == "array"]
            if lists and lists[0]["items"] != {"type": "number"}:
                kept = {name: body.pop(name) for name in ("description", "default") if name in body}
                model["properties"][key] = _or_table(body) | kept
    parts = {name: body for name, body in shared["$defs"].items() if name != "Component"}
    schema["$defs"] = {
        "train": {"description": "components in a row", **train},
        "table": TABLE,
        **parts,
    }
    # Every other word for a key next to the key.
    parts_of_kinds = (part for kind in KINDS for part in parts_within(component_class(kind)))
    for word in {part.__name__ for part in parts_of_kinds if isinstance(part, type)}:
        body = schema["$defs"].get(word, {})
        _offer(body, aliases_of(body.get("properties", {})))
    _offer(schema, SECTIONS_BY_ALIAS[""])
    _offer(schema["$defs"][Operation.__name__], SECTIONS_BY_ALIAS["operation"])
    _offer(schema["$defs"][settings_classes()["design"].__name__], SECTIONS_BY_ALIAS["design"])
    return schema


def _offer(body: Schema, aliases: Mapping[str, str]) -> None:
    """Add aliases to the properties; a required key may be given by its alias."""
    for alias, key in aliases.items():
        body["properties"][alias] = body["properties"][key] | {
            "description": f"another word for `{key}`"
        }
    for key in {*aliases.values()} & {*body.get("required", ())}:
        body["required"].remove(key)
        words = [key, *(alias for alias, meant in aliases.items() if meant == key)]
        body.setdefault("allOf", []).append({"anyOf": [{"required": [word]} for word in words]})


def _or_table(body: Schema) -> Schema:
    """A list, or the file of a table whose rows are its entries."""
    return {"anyOf": [body, {"$ref": "#/$defs/table"}]}


def _settings(name: str, body: Schema, description: str | None) -> Schema:
    """Settings of an analysis or a rule, or its key alone, with the example of the manual, where it has one."""
    settings: Schema = {"anyOf": [body, {"type": "null"}], "description": description}
    if example := setting_examples().get(name):
        settings["examples"] = [parse_source(example, name).data[name]]
    return settings


def _sections(refs: dict[str, Schema], kinds: Schema) -> dict[str, Schema]:
    # A rule with what it judges, in the words of its module.
    rules = {}
    for name, place in RULES.items():
        words = (import_module(place.partition(":")[0]).__doc__ or "").strip().partition("\n")[0]
        rules[name] = _settings(name, refs[name], words.partition(": ")[2])
    rule = {"anyOf": [{"enum": list(RULES)}, _one_of(rules)]}
    ends: Schema = {"type": "array", "items": {"type": "string"}, "minItems": 2, "maxItems": 2}
    ends["description"] = "names of the two points that the link joins"
    link_kinds = (*LINKS, *(word for word, kind in KINDS_BY_ALIAS.items() if kind in LINKS))
    link = _one_of({word: kinds[word] for word in link_kinds}, between=ends)
    model, fem = (ShaftModel.model_fields[name].description for name in ("model", "fem"))
    settings: Schema = {"fem": _settings("fem", refs["fem"], fem)}
    for name in settings_classes():
        settings[name] = _settings(name, refs[name], ANALYSES[name].title)
        settings[name]["anyOf"] += [_list_of(refs[name])] if ANALYSES[name].is_listed else []
    # Cases by name, and those of the tolerances.
    meaning = "soft and stiff: all couplings at either end of their tolerance"
    cases = {
        "type": "object",
        "properties": {FROM: {"const": TOLERANCES, "description": meaning}},
        "additionalProperties": refs["case"],
        "minProperties": 1,
    }
    return {
        "document": refs["document"],
        "materials": {"type": "object", "additionalProperties": refs["material"]},
        "operation": refs["operation"],
        "damping": refs["damping"],
        "train": {"$ref": "#/$defs/train"},
        "links": _list_of(link),
        "excitations": _or_table(_list_of(refs["excitation"])),
        "analyses": {
            "type": "object",
            "properties": {"model": {"enum": list(MODELS), "description": model}, **settings},
            "additionalProperties": False,
        },
        "rules": _list_of(rule),
        "cases": cases,
    }


def _one_of(properties: Schema, **needed: Schema) -> Schema:
    """A mapping with exactly one of the properties, and all that are needed."""
    body = {
        "type": "object",
        "properties": {**needed, **properties},
        "additionalProperties": False,
        "minProperties": 1 + len(needed),
        "maxProperties": 1 + len(needed),
    }
    return body | {"required": list(needed)} if needed else body


def _list_of(items: Schema) -> Schema:
    return {"type": "array", "items": items}
