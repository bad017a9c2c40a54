"""Faults in an engineer's words from what a declaration refuses."""

from collections.abc import Iterator
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from torsion import units
from torsion.errors import Fault, Path
from torsion.fields import Declared, Quantity
from torsion.schema.faults import nearest

Read = TypeVar("Read", bound=Declared)


def declared(kind: type[Read], body: object, path: Path, faults: list[Fault]) -> Read | None:
    """What the file says at `path` as an instance of its declaration, or None with every fault of it noted."""
    if body is None:
        body = {}
    if not isinstance(body, dict):
        faults.append(Fault(path, f"{shown(body)} is not a mapping of keys", _keys(kind)))
        return None
    known = [_without_value((*path, *where), where) for where in _empty(body)]
    known += [unbuilt((*path, key), f"`{key}`") for key in getattr(kind, "unbuilt", ()) if body.get(key) is not None]
    filled = {key: value for key, value in _filled(body).items() if key not in getattr(kind, "unbuilt", ())}
    try:
        read = kind.model_validate(filled, strict=True)
    except ValidationError as error:
        told = [fault.path[len(path) :] for fault in known]
        for detail in error.errors(include_url=False):
            where, fault = _fault(kind, detail, body)
            if not (_is_echo(detail, body) or any(_touch(where, other) for other in told)):
                known.append(_under(path, fault))
        read = None
    faults += known
    return None if known else read


def unbuilt(path: Path, what: str, hint: str = "") -> Fault:
    """The fault of a part of the format that cannot be computed yet."""
    return Fault(path, f"{what} is part of the format but not built yet", hint, at_key=True)


def unknown(path: Path, what: str, word: str, candidates: list[str]) -> Fault:
    """The fault of a word that is none of the candidates."""
    near = nearest(word, candidates)
    hint = f"did you mean `{near}`?" if near else f"there is {', '.join(candidates)}"
    return Fault(path, f"unknown {what} `{_short(word)}`", hint, at_key=True)


def shown(value: object) -> str:
    """A value as it is quoted in a message."""
    if isinstance(value, dict | list | tuple):
        return "a mapping" if isinstance(value, dict) else "a list"
    if value is None:
        return "nothing"
    return f"'{_short(value)}'" if isinstance(value, str) else str(value).lower()[:60]


def _short(text: str) -> str:
    plain = "".join(sign if sign.isprintable() else "?" for sign in text[:60])
    return plain if len(text) <= 60 else f"{plain}…"


def _empty(value: object, path: Path = ()) -> Iterator[Path]:
    """Paths of what stands in the file without a value."""
    if isinstance(value, dict | list):
        for step, item in value.items() if isinstance(value, dict) else enumerate(value):
            yield from _empty(item, (*path, step))
    elif value is None:
        yield path


def _without_value(path: Path, where: Path) -> Fault:
    """The fault of a key without a value; one that begins with digits is half of a number with a decimal comma."""
    name = _name(where)
    hint = "a decimal comma? write a point" if name[:1].isdecimal() else "give one, or leave the key out"
    return Fault(path, f"`{name}` has no value", hint, True)


def _filled(value: Any) -> Any:
    """The same without keys that have no value, and with tuples for lists."""
    if isinstance(value, dict):
        return {key: _filled(item) for key, item in value.items() if item is not None}
    return tuple(_filled(item) for item in value) if isinstance(value, list) else value


def _touch(one: Path, other: Path) -> bool:
    """One path is the other or leads to it."""
    length = min(len(one), len(other))
    return one[:length] == other[:length]


def _under(path: Path, fault: Fault) -> Fault:
    return Fault((*path, *fault.path), fault.message, fault.hint, fault.at_key)


def _name(path: Path) -> str:
    """The last key of a path, or what stands for the whole."""
    return next((step for step in reversed(path) if isinstance(step, str)), "the entry")


def _is_echo(detail: ErrorDetails, body: dict[str, Any]) -> bool:
    """A list that is long enough is called too short where one of its values is faulty, which is told anyway."""
    _, value = _path(detail["loc"], body)
    return detail["type"] == "too_short" and _size(value) >= detail["ctx"]["min_length"]


def _fault(kind: type[BaseModel], detail: ErrorDetails, body: dict[str, Any]) -> tuple[Path, Fault]:
    """What one refusal of pydantic is about, and its fault; paths relative to the body of the file."""
    path, below = _path(detail["loc"], body)
    context: dict[str, Any] = detail.get("ctx", {})
    match detail["type"]:
        case "fault":
            holds = isinstance(below, dict) and context["key"] in below
            return path, Fault((*path, context["key"]) if holds else path, context["message"], context["hint"])
        case "missing" if isinstance(detail["loc"][-1], str):
            key = str(detail["loc"][-1])
            where = (*path, key)
            return where, Fault(where, f"`{key}` is missing", _meaning(kind, where))
        case "extra_forbidden":
            keys = _model(kind, path[:-1])
            return path, unknown(path, "key", str(path[-1]), _names(keys) if keys else [])
        case other:
            message, hint = _words(other, context, below)
            return path, Fault(path, message, hint or _meaning(kind, path))


def _path(location: tuple[int | str, ...], body: object) -> tuple[Path, object]:
    """The steps of a location that exist in the file, and the value there; the rest are names of pydantic's own."""
    path: Path = ()
    for step in location:
        keys = body if isinstance(body, dict) else range(len(body)) if isinstance(body, list) else ()
        if step in keys:
            path, body = (*path, step), body[step]  # type: ignore[index]
    return path, body


def _words(error: str, context: dict[str, Any], value: object) -> tuple[str, str]:
    """What is wrong and what would be right, for the errors of pydantic's own types."""
    match error:
        case "literal_error":
            near = nearest(str(value), [choice.strip("' ") for choice in _choices(context)])
            return f"{shown(value)} is none of {context['expected']}", f"did you mean '{near}'?" if near else ""
        case "int_type" | "int_parsing" | "int_from_float" | "int_parsing_size":
            return f"{shown(value)} is not a whole number", ""
        case "bool_type" | "bool_parsing":
            return f"{shown(value)} is neither true nor false", "write true or false"
        case "string_type":
            return f"{shown(value)} is not text", "put it in quotes" if isinstance(value, int | float) else ""
        case "tuple_type":
            return f"{shown(value)} is not a list", ""
        case "missing" | "too_short":
            return f"the list is too short: {_count(value)}", ""
        case "too_long":
            return f"the list is too long: {_count(value)}", ""
        case "greater_than_equal" | "less_than_equal":
            limit = f"at least {context['ge']}" if "ge" in context else f"at most {context['le']}"
            return f"{shown(value)} is out of range", f"must be {limit}"
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"{shown(value)} is not a mapping of keys", ""
        case _:
            return f"{shown(value)} is not possible here", ""


def _choices(context: dict[str, Any]) -> list[str]:
    return str(context["expected"]).replace(" or ", ", ").split(",")


def _count(value: object) -> str:
    size = _size(value)
    return f"{size} value" if size == 1 else f"{size} values"


def _size(value: object) -> int:
    return len(value) if isinstance(value, list | tuple) else 1


def _names(kind: type[BaseModel]) -> list[str]:
    return [field.alias or name for name, field in kind.model_fields.items()]


def _keys(kind: type[BaseModel]) -> str:
    return f"keys: {', '.join(_names(kind))}"


def _field(kind: type[BaseModel] | None, key: str) -> FieldInfo | None:
    fields = {} if kind is None else kind.model_fields
    return next((field for name, field in fields.items() if key == (field.alias or name)), None)


def _model(kind: type[BaseModel] | None, path: Path) -> type[BaseModel] | None:
    """The declaration that stands at a path below another one."""
    for step in path:
        if isinstance(step, str):
            field = _field(kind, step)
            if field is not None:  # else a name that the user chose
                kind = next(_parts(field.annotation, BaseModel), None)
    return kind


def _parts(annotation: Any, kind: type) -> Iterator[Any]:
    """Classes derived from `kind`, or instances of it, anywhere in an annotation."""
    if isinstance(annotation, kind) or (isinstance(annotation, type) and issubclass(annotation, kind)):
        yield annotation
    for part in get_args(annotation):
        yield from _parts(part, kind)


def _meaning(kind: type[BaseModel], path: Path) -> str:
    """What the key at a path is, and in which unit."""
    keys = [position for position, step in enumerate(path) if isinstance(step, str)]
    if not keys:
        return ""
    field = _field(_model(kind, path[: keys[-1]]), str(path[keys[-1]]))
    if field is None:
        return ""
    found = [*_parts(field.annotation, Quantity), *(item for item in field.metadata if isinstance(item, Quantity))]
    unit = f"; {units.speak(found[0].unit)} in {found[0].unit}" if found and found[0].unit != "1" else ""
    return f"{field.description or ''}{unit}"
