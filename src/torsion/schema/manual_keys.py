"""The keys of a declaration as rows of a table: what may stand there, in which unit, within which limits."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from torsion import units
from torsion.components.base import Component
from torsion.fields import SHARE_OF_MEAN, Amount, Declared, OneOrMany, Quantity

PLAIN = {
    str: "text", bool: "`true` or `false`", int: "a whole number", float: "a number",
    Fraction: "an exact number: `2`, `0.5` or `21/8`", Amount: "N*m, `5 %` or `{of_mean: 5 %}`",
}  # fmt: skip


@dataclass(frozen=True)
class Key:
    """One key of a declaration."""

    name: str
    value: str  # what may stand there
    limits: str
    default: str
    meaning: str
    parts: tuple[type[Declared], ...]  # declarations of the mappings that stand in it


def table_of(declared: type[Declared], without: type[Declared] | None = None) -> str:
    """A Markdown table of the keys, but for those that `without` has already."""
    known = set(without.model_fields) if without is not None else set()
    rows = ["| key | value | limits | default | meaning |", "|---|---|---|---|---|"]
    for key in keys_of(declared):
        if key.name not in known:
            cells = (f"`{key.name}`", key.value, key.limits, key.default, key.meaning)
            rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n" if len(rows) > 2 else "It has no settings.\n"


def keys_of(declared: type[Declared]) -> Iterator[Key]:
    """The keys in the order of their declaration, the required ones first."""
    fields = sorted(declared.model_fields.items(), key=lambda entry: not entry[1].is_required())
    for name, field in fields:
        whole = _annotated(field)
        limits = dict.fromkeys(_limits(whole))
        yield Key(
            field.alias or name, _value(whole), ", ".join(limits), _default(field), field.description or "",
            tuple(dict.fromkeys(_classes(whole))),
        )  # fmt: skip


def quantities_of(declared: type[Declared]) -> Iterator[Quantity]:
    """Every quantity in a declaration and in its mappings."""
    for field in declared.model_fields.values():
        whole = _annotated(field)
        yield from (item for item in _items(whole) if isinstance(item, Quantity))
        for part in _classes(whole):
            yield from quantities_of(part)


def _annotated(field: FieldInfo) -> Any:
    """The annotation of a field with what pydantic took off it."""
    return Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation


def _value(annotation: Any) -> str:
    """What may stand there, in words."""
    metadata: list[Any] = []
    while get_origin(annotation) is Annotated:
        annotation, *more = get_args(annotation)
        metadata += more
    for item in metadata:
        if isinstance(item, Quantity):
            return _unit(item)
        if isinstance(item, BeforeValidator):
            if item.func is OneOrMany.func:
                return f"{_value(get_args(annotation)[0])}, or a list"
            if item.json_schema_input_type not in (PydanticUndefined, Any):
                return _value(item.json_schema_input_type)
    return _plain(annotation)


def _unit(quantity: Quantity) -> str:
    if quantity.unit == "1":
        return "a number or %"
    return f"`{quantity.unit}`" + (", unit required" if units.needs_unit(quantity.unit) else "")


def _plain(annotation: Any) -> str:
    """Words for an annotation without metadata."""
    origin, inner = get_origin(annotation), get_args(annotation)
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(_value(part) for part in inner if part is not type(None)))
    if origin is Literal:
        return ", ".join(f"`{choice}`" for choice in inner)
    if origin is tuple:
        if inner[-1] is Ellipsis:
            return f"a list of {_many(inner[0])}"
        return f"[{', '.join(_value(part) for part in inner)}]"
    if origin in (dict, Mapping):
        return f"a mapping of names to {_value(inner[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Declared):
        return "a component" if issubclass(annotation, Component) else "a mapping, below"
    return PLAIN.get(annotation, "see meaning")


def _many(annotation: Any) -> str:
    words = _value(annotation)
    return {"a component": "components", "a mapping, below": "mappings, below"}.get(words, words)


def _items(annotation: Any) -> Iterator[Any]:
    """Everything that an annotation is made of."""
    yield annotation
    if isinstance(annotation, FieldInfo):
        yield from annotation.metadata
    if isinstance(annotation, BeforeValidator) and annotation.json_schema_input_type is not PydanticUndefined:
        yield from _items(annotation.json_schema_input_type)
    for part in get_args(annotation):
        yield from _items(part)


def _classes(annotation: Any) -> Iterator[type[Declared]]:
    """Declarations in an annotation, components left out."""
    for item in _items(annotation):
        if isinstance(item, type) and issubclass(item, Declared) and not issubclass(item, Component):
            yield item


def _limits(annotation: Any) -> Iterator[str]:
    for item in _items(annotation):
        if isinstance(item, Quantity):
            for words, limit in (("more than", item.above), ("at least", item.at_least),
                                 ("less than", item.below), ("at most", item.at_most)):  # fmt: skip
                if limit is not None:
                    yield f"{words} {limit:.5g}"
            if usual := item.usual_words():
                yield f"usually {usual}"
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
