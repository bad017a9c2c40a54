"""Tables of keys, as Markdown: value, limits, default and meaning of every key of a declaration."""

from collections.abc import Iterable, Iterator, Mapping
from fractions import Fraction
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from torsion import units
from torsion.fields import SHARE_OF_MEAN, Amount, Declared, OneOrMany, Quantity
from torsion.model.component import Component
from torsion.schema.declaration_reader import items_of, keys_of, mappings_of

PLAIN = {
    str: "text",
    bool: "`true` or `false`",
    int: "a whole number",
    float: "a number",
    Fraction: "an exact number: `2`, `0.5` or `21/8`",
    Amount: "N*m, `5 %` or `{of_mean: 5 %}`",
}
COMPONENT, MAPPING = "a component", "a mapping, below"
SEVERAL = {COMPONENT: "components", MAPPING: "mappings, below"}
HEAD = ["| key | value | limits | default | meaning |", "|---|---|---|---|---|"]


def key_table(declared: type[Declared], keys: Iterable[str] | None = None) -> str:
    """Return a Markdown table of `keys`, or of all keys, the required keys first."""
    fields = keys_of(declared)
    chosen = list(fields) if keys is None else [key for key in fields if key in set(keys)]
    rows = [
        _row(key, fields[key])
        for key in sorted(chosen, key=lambda key: not fields[key].is_required())
    ]
    return "\n".join([*HEAD, *rows]) + "\n" if rows else "There are no settings.\n"


def tables_with_parts(
    declared: type[Declared],
    common: type[Declared] | None = None,
    groups: Iterable[tuple[str, str]] = (),
) -> str:
    """Return the tables of a declaration without the keys of `common`, then one for every mapping within it.

    groups: headings of groups of keys, with their keys parted by blanks; other keys follow as "Other keys".
    """
    keys = [key for key in keys_of(declared) if common is None or key not in keys_of(common)]
    text = _grouped(declared, keys, groups) if groups else key_table(declared, keys)

    headings = dict[type[Declared], str]()
    waiting = [declared]
    while waiting:
        for key, field in sorted(
            keys_of(waiting.pop(0)).items(), key=lambda entry: not entry[1].is_required()
        ):
            for part in mappings_of(field):
                if not issubclass(part, Component) and part not in headings:
                    headings[part] = key
                    waiting.append(part)
    return text + "".join(
        f"\n### Keys of `{key}`\n\n{key_table(part)}" for part, key in headings.items()
    )


def _grouped(declared: type[Declared], keys: list[str], groups: Iterable[tuple[str, str]]) -> str:
    """Return one table a group, and one of the keys of no group."""
    grouped = {heading: names.split() for heading, names in groups}
    grouped["Other keys"] = [
        key for key in keys if all(key not in names for names in grouped.values())
    ]
    return "\n".join(
        f"### {heading}\n\n{key_table(declared, names)}"
        for heading, names in grouped.items()
        if names
    )


def _row(key: str, field: FieldInfo) -> str:
    annotation = (
        Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
    )
    limits = ", ".join(dict.fromkeys(_limits(field)))
    cells = (f"`{key}`", _value(annotation), limits, _default(field), field.description or "")
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _value(annotation: Any) -> str:
    """Return what a value may be, in words."""
    metadata: list[Any] = []
    while get_origin(annotation) is Annotated:
        annotation, *annotations = get_args(annotation)
        metadata += annotations
    for item in metadata:
        if isinstance(item, Quantity) and item.unit == "1":
            return "a number or %"
        if isinstance(item, Quantity):
            return f"`{item.unit}`" + (", unit required" if units.needs_unit(item.unit) else "")
        if isinstance(item, BeforeValidator):
            if item.func is OneOrMany.func:
                return f"{_value(get_args(annotation)[0])}, or a list"
            if item.json_schema_input_type not in (PydanticUndefined, Any):
                return _value(item.json_schema_input_type)
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(_value(part) for part in inner if part is not type(None)))
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in inner)
    if origin is tuple:
        words = [_value(part) for part in inner if part is not Ellipsis]
        return (
            f"a list of {SEVERAL.get(words[0], words[0])}"
            if inner[-1] is Ellipsis
            else f"[{', '.join(words)}]"
        )
    if origin in (dict, Mapping):
        return f"a mapping of names to {_value(inner[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Declared):
        return COMPONENT if issubclass(annotation, Component) else MAPPING
    return PLAIN.get(annotation, "see meaning")


def _limits(field: FieldInfo) -> Iterator[str]:
    for item in items_of(field):
        if isinstance(item, Quantity):
            yield from (f"{words} {limit:.5g}" for words, limit, _ in item.limits)
            yield f"usually {item.usual_words()}"
        if item is Amount:
            yield f"usually {SHARE_OF_MEAN.usual_words()} of the mean"
        for words, name in (("at least", "ge"), ("at most", "le")):
            if isinstance(limit := getattr(item, name, None), int):
                yield f"{words} {limit}"


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "**required**"
    value = field.default
    if isinstance(value, tuple) and len(value) == 1:
        value = value[0]
    if value is None or value in ((), "", {}):
        return ""
    return f"`{str(value).lower()}`" if isinstance(value, bool | str) else f"`{value:g}`"
