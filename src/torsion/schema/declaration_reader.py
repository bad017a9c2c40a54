"""What the file says as an instance of its declaration, of components too, or faults in an engineer's words."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache
from itertools import chain
from typing import Any, TypeVar, get_args

from pydantic import BaseModel, BeforeValidator, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticUndefined

from torsion import units
from torsion.errors import Fault, Path, Refusal, nearest
from torsion.fields import Declared, Quantity, shown
from torsion.model import KINDS, KINDS_BY_ALIAS
from torsion.model.component import Component, component_class
from torsion.schema import template
from torsion.schema.fault_text import without_mark, words_for
from torsion.user_files import printable

KEYS_BY_ALIAS = {  # of components, and of mappings within them
    "OD": "diameter",
    "outer_diameter": "diameter",
    "ID": "bore",
    "inner_diameter": "bore",
    "fixed": "held",
    "relative_damping": "psi",
    "entrained_water": "entrained",
    "T_KN": "rated_torque",
    "T_KW": "vibratory_torque",
    "T_Kmax": "max_torque",
    "P_KW": "heat_limit",
}
SECTIONS_BY_ALIAS = {  # of the top level, of `operation` and of `analyses: {design: }`
    "": {"shoulders": "steps"},
    "operation": {"reference": "at"},
    "design": {
        "variables": "choose",
        "constraints": "keep",
        "objective": "aim",
        "pareto": "against",
    },
}
_ALIASES = {*KINDS_BY_ALIAS, *KEYS_BY_ALIAS, *chain(*SECTIONS_BY_ALIAS.values())}
ALIAS = re.compile(rf"(?<![\w-])(?:{'|'.join(sorted(_ALIASES))})[\"']?\s*:")


@cache
def other_words() -> tuple[tuple[str, ...], ...]:
    """Return the rows of the file: word, key that may be meant or `<component>` or `<analysis>`, meaning."""
    lines = template("other_words.txt").splitlines()
    return tuple(tuple(line.split(" | ")) for line in lines if not line.startswith("#"))


def _meanings(written: str) -> tuple[str, dict[str, str]]:
    """A word as the file of words spells it, and its meanings there by key."""
    spelled = re.sub("[ -]", "_", written.casefold())
    return spelled, {key: meaning for word, key, meaning in other_words() if word == spelled}


def key_for(written: str, keys: list[str]) -> str:
    """Return what to write for a word of the trade among these keys; empty for a word that means none of them.

    A word without an entry means the last key that is a part of it.

    >>> key_for("gear_teeth", ["teeth", "ratio"])
    'write `teeth`'
    """
    spelled, meanings = _meanings(written)
    possible = [f"`{key}` ({meanings[key]})" for key in meanings if key in keys]
    if not possible:
        possible = [f"`{part}`" for part in spelled.split("_") if part in keys][-1:]
    return f"write {' or '.join(possible)}" if possible else ""


def of_its_number(word: str, candidates: list[str]) -> list[str]:
    """Return the candidates with the digits of the word, in any order: iacs-m86 is a slip for iacs-m68, iacs-m54 is none."""
    digits = sorted(re.findall(r"\d", word))
    return [
        name for name in candidates if not digits or sorted(re.findall(r"\d", name)) in ([], digits)
    ]


Read = TypeVar("Read", bound=Declared)
CLOSE = 0.7  # similarity of a misspelt key: below it the key may be of another subject
WRONG = {  # by the first word of an error of pydantic
    "int": "is not a whole number",
    "bool": "is neither true nor false",
    "tuple": "is not a list",
    "model": "is not a mapping of keys",
    "dict": "is not a mapping of keys",
}
MOST_LISTED = 8  # keys that a message lists


def declared(kind: type[Read], body: object, path: Path, faults: list[Fault]) -> Read | None:
    """What the file says at `path` as an instance of its declaration, or None with every fault of it noted."""
    if body is None:
        body = {}
    if not isinstance(body, dict):
        keys = f"keys: {', '.join(keys_of(kind))}"
        faults.append(Fault(path, f"{shown(body)} is not a mapping of keys", keys))
        return None
    noted_faults = list(_empty(body, path))
    noted = [fault.path[len(path) :] for fault in noted_faults]
    values = _filled(body)
    try:
        read = kind.model_validate(values, strict=True)
    except ValidationError as error:
        read, details = None, error.errors(include_url=False)
        for detail in (*details, *_between_sound_keys(kind, values, details)):
            where, fault = _fault(kind, detail, body)
            # A list that is long enough is called too short if one of its values is faulty, which is reported anyway.
            size = _size(_path(detail["loc"], body)[1])
            is_echo = detail["type"] == "too_short" and size >= detail["ctx"]["min_length"]
            if not is_echo and not any(
                where[: len(noted_path)] == noted_path[: len(where)] for noted_path in noted
            ):
                noted_faults.append(replace(fault, path=(*path, *fault.path)))
    faults += noted_faults
    return None if noted_faults else read


def _between_sound_keys(
    kind: type[Declared], values: dict[str, Any], details: list[ErrorDetails]
) -> Iterator[ErrorDetails]:
    """What checks between keys refuse that read no faulty key; pydantic leaves them all out where one is faulty.

    None where a key is unknown, which may be one of theirs misspelt.
    """
    faulty = {str(detail["loc"][0]) for detail in details if detail["loc"]}
    if not faulty or not faulty <= keys_of(kind).keys():
        return
    sound = {
        field: key
        for key, field in zip(keys_of(kind), kind.model_fields, strict=True)
        if key not in faulty
    }
    partly = kind.model_construct(
        _fields_set={field for field, key in sound.items() if key in values}
    )
    try:
        for field in partly.model_fields_set:
            reader = TypeAdapter(kind.model_fields[field].rebuild_annotation())
            vars(partly)[field] = reader.validate_python(values[sound[field]], strict=True)
    except ValidationError:  # it is sound only because the component says `unusual`
        return
    for field in kind.model_fields.keys() - sound.keys():
        vars(partly).pop(field, None)
    for refuse in (*(clash.check for clash in kind.clashes), kind.refuse_clashes):
        try:
            refuse(partly)
        except Refusal as refusal:
            context = {"error": refusal}
            yield {"type": "value_error", "loc": (), "msg": "", "input": values, "ctx": context}
            return
        except AttributeError:  # it reads a key that is faulty
            continue


def entries_of(value: object) -> Iterator[tuple[str | int, Any]]:
    """What stands in a mapping or a list, with its key or position; nothing of any other value."""
    pairs = enumerate(value if isinstance(value, list) else ())
    return iter(value.items() if isinstance(value, dict) else pairs)


def unknown_word(
    path: Path, what: str, word: str, candidates: list[str], choices: Sequence[str] = ()
) -> Fault:
    """The fault of a word that is none of the candidates, or of `every` one there is."""
    marked = without_mark(word, candidates) if what == "component" or "{" in word else None
    if marked is not None:
        message, hint = words_for(*marked, dash="- " if what in ("component", "rule") else "")
        return Fault(path, message, hint, at_key=True)
    near = nearest(word, candidates, CLOSE if what == "key" else 0.6)
    hint = f"did you mean `{near}`?" if near else f"there is {', '.join(choices or candidates)}"
    if what == "key" and not near and len(candidates) > MOST_LISTED:
        hint = f"docs/reference/model-file lists the {len(candidates)} keys"
    if what == "key":
        hint = key_for(word, candidates) or hint
    # A component or an analysis may have a word of the trade that is to be written otherwise.
    hint = _meanings(word)[1].get(f"<{what}>", hint)
    return Fault(path, f"unknown {what} `{printable(word)}`", hint, at_key=True)


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
    if (
        isinstance(annotation, BeforeValidator)
        and annotation.json_schema_input_type is not PydanticUndefined
    ):
        yield from items_of(annotation.json_schema_input_type)
    for part in get_args(annotation):
        yield from items_of(part)


def mappings_of(annotation: Any) -> Iterator[type[Declared]]:
    """Declarations of the mappings in a field or an annotation."""
    return (
        item
        for item in items_of(annotation)
        if isinstance(item, type) and issubclass(item, Declared)
    )


def _empty(value: object, above: Path, path: Path = ()) -> Iterator[Fault]:
    """Yield the fault of every key without a value in what stands at a path.

    A key that begins with digits is half of a number with a decimal comma; one that holds a colon misses a blank behind
    it, which would part key and value.
    """
    for step, item in entries_of(value):
        yield from _empty(item, above, (*path, step))
    if value is not None:
        return
    name = next((step for step in reversed(path) if isinstance(step, str)), "the entry")
    is_number = name[:1].isdecimal()
    hint = "a decimal comma? write a point" if is_number else "give one, or leave the key out"
    if glued := re.match(r"([\w-]+):(?=\S)", name):
        hint = f"a blank is missing after the colon: `{glued[0]} {printable(name[glued.end() :])}`"
    yield Fault((*above, *path), f"`{name}` has no value", hint, True)


def _filled(value: Any) -> Any:
    """The same without keys that have no value, and with tuples for lists."""
    if isinstance(value, dict):
        return {key: _filled(item) for key, item in value.items() if item is not None}
    return tuple(_filled(item) for item in value) if isinstance(value, list) else value


def _fault(kind: type[BaseModel], detail: ErrorDetails, body: dict[str, Any]) -> tuple[Path, Fault]:
    """What one refusal of pydantic is about, and its fault; paths relative to the body of the file."""
    path, below = _path(detail["loc"], body)
    context: dict[str, Any] = detail.get("ctx", {})
    hint = ""
    match detail["type"]:
        case "value_error" if isinstance(refusal := context["error"], Refusal):
            steps, _ = _path(refusal.key, below)
            return path, Fault((*path, *steps), refusal.message, refusal.hint)
        case "missing" if isinstance(detail["loc"][-1], str):
            key = str(detail["loc"][-1])
            where = (*path, key)
            return where, Fault(where, f"`{key}` is missing", _meaning(kind, where))
        case "extra_forbidden":
            model, _ = _declaration(kind, path)
            keys = list(keys_of(model)) if model else []
            return path, unknown_word(path, "key", str(path[-1]), keys)
        case "literal_error":
            choices = context["expected"].replace(" or ", ", ").split(",")
            near = nearest(str(below), [choice.strip("' ") for choice in choices])
            message = f"{shown(below)} is none of {context['expected']}"
            hint = f"did you mean '{near}'?" if near else ""
        case "string_type":
            message = f"{shown(below)} is not text"
            hint = "put it in quotes" if isinstance(below, int | float) else ""
        case "string_too_long":
            message = f"the text is too long: {len(str(below))} characters"
            hint = f"at most {context['max_length']}"
        case "missing" | "too_short" | "too_long" as error:
            size, fits = _size(below), "long" if error == "too_long" else "short"
            what = "mapping" if below == {} else "list"
            message = f"the {what} is too {fits}: {size} value{'s' * (size != 1)}"
        case "greater_than_equal" | "less_than_equal":
            message = f"{shown(below)} is out of range"
            limit = f"at least {context['ge']}" if "ge" in context else f"at most {context['le']}"
            hint = f"must be {limit}"
        case error:
            family = error.partition("_")[0]
            message = f"{shown(below)} {WRONG.get(family, 'is not possible here')}"
            hint = "write true or false" if family == "bool" else ""
    return path, Fault(path, message, hint or _meaning(kind, path))


def _path(location: tuple[int | str, ...], body: object) -> tuple[Path, object]:
    """The steps of a location that exist in the file, and the value there; the rest are names of pydantic's own."""
    path: Path = ()
    for step in location:
        entries = dict(entries_of(body))
        if step in entries:
            path, body = (*path, step), entries[step]
    return path, body


def _size(value: object) -> int:
    return len(value) if isinstance(value, list | tuple) or value == {} else 1


def _declaration(
    kind: type[BaseModel], path: Path
) -> tuple[type[BaseModel] | None, FieldInfo | None]:
    """The declaration in which the last key of a path stands, and what it says of that key."""
    model: type[BaseModel] | None = kind
    holder, field = model, None
    for step in path:
        stated = None if model is None else keys_of(model).get(str(step))
        if isinstance(step, str):
            holder, field = model, stated
        if stated is not None:  # else a position, or a name that the user chose
            model = next(mappings_of(stated), None)
    return holder, field


def _meaning(kind: type[BaseModel], path: Path) -> str:
    """What the key at a path is, and in which unit."""
    _, field = _declaration(kind, path)
    if field is None:
        return ""
    quantities = (item for item in items_of(field) if isinstance(item, Quantity))
    unit = next((quantity.unit for quantity in quantities if quantity.unit != "1"), "")
    return (field.description or "") + (f"; {units.speak(unit)} in {unit}" if unit else "")


def components(entries: object, path: Path, faults: list[Fault]) -> tuple[Component, ...]:
    """The sound components of a list; every fault of the others is noted."""
    if not isinstance(entries, list):
        hint = "`- disc: {inertia: 1.2}`, ..."
        if isinstance(entries, dict) and (
            kind := next((key for key in entries if key in KINDS), None)
        ):
            path, hint = (*path, kind), f"begin each component with a dash: `- {kind}: ...`"
        message = f"{shown(entries)} is not a list of components"
        faults.append(Fault(path, message, hint, at_key=path[-1] in KINDS))
        return ()
    read = list[Component]()
    for position, entry in enumerate(entries):
        entry_path = (*path, position)
        if not isinstance(entry, dict) or not entry:
            named = without_mark(f"{entry} {{", KINDS) if isinstance(entry, str) else None
            hint = f"write `- {named[0]}: {{...}}`" if named else "`- disc: {inertia: 1.2}`"
            message = f"{shown(entry)} is not a component, a mapping with one key"
            faults.append(Fault(entry_path, message, hint))
        elif len(entry) > 1:
            kinds = [key for key in entry if key in KINDS]
            extra = next(key for key in entry if key != kinds[0]) if kinds else list(entry)[1]
            hint = "indent the keys of a component below its kind"
            hint = "start each with its own `-`" if len(kinds) > 1 else hint
            keys = ", ".join(f"`{key}`" for key in list(entry)[:5])
            message = f"a component is one key, its kind; there are {keys}"
            faults.append(Fault((*entry_path, extra), message, hint, at_key=True))
        else:
            ((kind, body),) = entry.items()
            component = one_component(kind, body, (*entry_path, kind), faults)
            read += [] if component is None else [component]
    return tuple(read)


def empty_lists(value: object, path: Path = ()) -> Iterator[Fault]:
    """The faults of components, and of halves of a differential, with an empty list at a key.

    A wheel of a gear may have no train behind it. A case may empty a list that it takes components from; a file that
    states an empty list has forgotten its entries.
    """
    for step, item in entries_of(value):
        if item == [] and path and path[-1] in (*KINDS, "differential"):
            yield Fault(
                (*path, step), f"`{step}` is an empty list", "list one, or leave the key out"
            )
        yield from empty_lists(item, (*path, step))


def one_component(kind: str, body: object, path: Path, faults: list[Fault]) -> Component | None:
    """A component of a kind; `path` ends with the kind. Trains within it are read first."""
    if kind not in KINDS:
        faults.append(unknown_word(path, "component", kind, list(KINDS)))
        return None
    before = len(faults)
    read = declared(component_class(kind), _with_trains(body, path, faults), path, faults)
    return read if len(faults) == before else None


def _with_trains(body: Any, path: Path, faults: list[Fault]) -> Any:
    """The same with every train in it read into components."""
    if isinstance(body, list):
        return [_with_trains(item, (*path, position), faults) for position, item in enumerate(body)]
    if not isinstance(body, dict):
        return body
    return {
        key: components(item, (*path, key), faults)
        if key == "train" and item is not None
        else _with_trains(item, (*path, key), faults)
        for key, item in body.items()
    }
