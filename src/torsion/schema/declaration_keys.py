"""What declarations are made of, and their keys as rows of a table: what may stand there, in which unit and limits."""

from collections.abc import Iterator, Mapping
from fractions import Fraction
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from pydantic import BaseModel, BeforeValidator
from pydantic.fields import FieldInfo
from pydantic_core import PydanticUndefined

from torsion import units
from torsion.analyses import settings_classes
from torsion.components import KINDS, component
from torsion.components.component import Component
from torsion.components.harmonic_torques import Excitation
from torsion.components.material import Material
from torsion.fields import SHARE_OF_MEAN, Amount, Declared, OneOrMany, Quantity
from torsion.rules import RULES
from torsion.rules import settings as rule_settings
from torsion.study import FiniteElements, Operation

PLAIN = {
    str: "text", bool: "`true` or `false`", int: "a whole number", float: "a number",
    Fraction: "an exact number: `2`, `0.5` or `21/8`", Amount: "N*m, `5 %` or `{of_mean: 5 %}`",
}  # fmt: skip
COMPONENT, MAPPING = "a component", "a mapping, below"
SEVERAL = {COMPONENT: "components", MAPPING: "mappings, below"}


def declarations() -> dict[str, type[Declared]]:
    """Every declaration of the format by its word in the file."""
    return {
        **{kind: component(kind) for kind in KINDS},
        "material": Material, "operation": Operation, "excitation": Excitation, "fem": FiniteElements,
        **settings_classes(), **{name: rule_settings(name) for name in RULES},
    }  # fmt: skip


def keys_of(declared: type[BaseModel]) -> dict[str, FieldInfo]:
    """The keys of a declaration as the file writes them."""
    return {field.alias or name: field for name, field in declared.model_fields.items()}


def items_of(annotation: Any) -> Iterator[Any]:
    """Everything that a field or an annotation is made of."""
    if isinstance(annotation, FieldInfo):
        for item in (annotation.annotation, *annotation.metadata):
            yield from items_of(item)
        return
    yield annotation
    if isinstance(annotation, BeforeValidator) and annotation.json_schema_input_type is not PydanticUndefined:
        yield from items_of(annotation.json_schema_input_type)
    for part in get_args(annotation):
        yield from items_of(part)


def mappings_of(annotation: Any) -> Iterator[type[Declared]]:
    """Declarations of the mappings in a field or an annotation."""
    return (item for item in items_of(annotation) if isinstance(item, type) and issubclass(item, Declared))


def quantities_of(declared: type[Declared]) -> Iterator[Quantity]:
    """Every quantity in a declaration and in its mappings, components left out."""
    for field in declared.model_fields.values():
        yield from (item for item in items_of(field) if isinstance(item, Quantity))
        for part in mappings_of(field):
            if not issubclass(part, Component):
                yield from quantities_of(part)


def table_of(declared: type[Declared], without: type[Declared] | None = None) -> str:
    """A Markdown table of the keys, the required ones first, but for those that `without` has already."""
    known = set(without.model_fields) if without is not None else set()
    rows = ["| key | value | limits | default | meaning |", "|---|---|---|---|---|"]
    for key, field in sorted(keys_of(declared).items(), key=lambda entry: not entry[1].is_required()):
        if key not in known:
            whole = Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation
            limits = ", ".join(dict.fromkeys(_limits(field)))
            cells = (f"`{key}`", _value(whole), limits, _default(field), field.description or "")
            rows.append("| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |")
    return "\n".join(rows) + "\n" if len(rows) > 2 else "It has no settings.\n"


def _value(annotation: Any) -> str:
    """What may stand there, in words."""
    metadata: list[Any] = []
    while get_origin(annotation) is Annotated:
        annotation, *more = get_args(annotation)
        metadata += more
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
        return f"a list of {SEVERAL.get(words[0], words[0])}" if inner[-1] is Ellipsis else f"[{', '.join(words)}]"
    if origin in (dict, Mapping):
        return f"a mapping of names to {_value(inner[1])}"
    if isinstance(annotation, type) and issubclass(annotation, Declared):
        return COMPONENT if issubclass(annotation, Component) else MAPPING
    return PLAIN.get(annotation, "see meaning")


def _limits(field: FieldInfo) -> Iterator[str]:
    for item in items_of(field):
        if isinstance(item, Quantity):
            yield from (f"{words} {limit:.5g}" for words, limit, _ in item.limits)
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
