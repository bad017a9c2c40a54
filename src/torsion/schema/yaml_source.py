"""The text of a YAML file as plain data, with line and column of every value and key.

Values follow the core rules of YAML 1.2 (`1e6` is a number, `no` is text), and numbers may hold underscores. Tags,
merge keys, repeated keys, keys other than text and several documents are refused.
"""

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import yaml

from torsion.errors import Fault, InputError
from torsion.schema import template
from torsion.schema.declaration_reader import ALIAS
from torsion.schema.fault_text import input_error, missing_mark
from torsion.user_files import (
    CONTROLS,
    LARGEST_SCENE,
    REORDERING,
    Node,
    Source,
    end_of,
    printable,
    read_file,
)

_DEEPEST = 50  # lists and mappings within each other; the deepest sensible scene has about ten
_TOO_DEEP = f"more than {_DEEPEST} lists and mappings within each other"
_LARGEST = 100_000  # values after aliases are written out; bounds what a few lines can blow up to
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
_END: Any = yaml.CollectionEndEvent

_FORBIDDEN = re.compile(
    "[\0-\x08\x0b\x0c\x0e-\x1f\x7f-\x84\x86-\x9f\ud800-\udfff\ufeff\ufffe\uffff]"
)
_BREAK = re.compile("[\t\n]")
_WORDS: dict[str, bool | None] = {"": None, "~": None}
_WORDS |= dict.fromkeys(("null", "Null", "NULL"))
_WORDS |= dict.fromkeys(("true", "True", "TRUE"), True) | dict.fromkeys(
    ("false", "False", "FALSE"), False
)
_HALF = re.compile(r"([0-9]+),$")  # of a number with a decimal comma, in a mapping within braces
_WHOLE = re.compile(r"[-+]?[0-9]+(?:_[0-9]+)*|0x[0-9a-fA-F]+|0o[0-7]+")
_DIGITS = r"[0-9]+(?:_[0-9]+)*"
_DECIMAL = re.compile(rf"[-+]?(?:\.{_DIGITS}|{_DIGITS}(?:\.(?:{_DIGITS})?)?)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"([-+]?)\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")


class Based(int):
    """A whole number that is not written in decimal digits: 0x1F, 0o17."""


def read_source(path: str | FilePath) -> Source:
    """The file as data with places; raises InputError."""
    name = str(path)
    try:
        content = read_file(path, LARGEST_SCENE)
    except (OSError, ValueError) as error:
        message = f"the file cannot be read: {getattr(error, 'strerror', None) or error}"
        if isinstance(error, FileNotFoundError | IsADirectoryError):
            is_folder = isinstance(error, IsADirectoryError)
            message = "this is a folder, not a file" if is_folder else "the file does not exist"
        raise InputError([Fault((), message)], f"{name}: {message}") from None
    try:
        return parse_source(content.decode(), name)
    except UnicodeDecodeError as error:
        before = content[: error.start].decode()
        fault = _fault("the file is not UTF-8 text", "save it as UTF-8", *end_of(before))
        raise input_error([fault], Source(name, content.decode(errors="replace"))) from None


def parse_source(text: str, name: str) -> Source:
    """The text as data with places; raises InputError with every fault up to the first one that ends the reading."""
    text = text.removeprefix("\ufeff")  # the byte order mark with which some editors begin a file
    bare = Source(name, text)
    forbidden = _FORBIDDEN.search(text) or REORDERING.search(text)
    if forbidden:
        sign, hint = f"the character U+{ord(forbidden[0]):04X} is not allowed", "remove it"
        if forbidden[0] == "\ufeff":
            sign = "there is a byte order mark (U+FEFF) here"
            hint = "save the file as UTF-8 without it"
        raise input_error([_fault(sign, hint, *end_of(text[: forbidden.start()]))], bare)
    builder, root = _Builder(bare.lines, yaml.parse(text, Loader=_LOADER)), bare.root
    try:
        root = builder.document()
    except _EndError:
        pass
    except yaml.MarkedYAMLError as error:
        builder.faults.append(_syntax(error, bare))
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        builder.faults.append(_fault(f"this is not YAML: {error}", "", 1, 1))
    if root.plain is None and not builder.faults:
        builder.faults.append(
            _fault("the file is empty", "a model file needs at least a name and a train", 1, 1)
        )
    if builder.faults:
        raise input_error(builder.faults, bare)
    source = Source(name, text, root)
    if not (isinstance(root.plain, dict) and ALIAS.search(text)):
        return source
    from torsion.schema.aliases import replace_aliases

    return replace(source, faults=tuple(replace_aliases(root)))


def yaml_text(value: object, *, is_flow: bool = False) -> str:
    """A mapping as YAML, in the order of its keys; `is_flow`: all in brackets on one line."""
    style, width = (True, math.inf) if is_flow else (None, 110)
    made: str = yaml.dump(
        value,
        None,
        _Writer,
        default_flow_style=style,
        sort_keys=False,
        allow_unicode=True,
        width=width,
    )
    return made


class _Writer(yaml.SafeDumper):
    """Quotes what is text and would be read as a number, such as a part called 1e3."""


_Writer.add_representer(
    str,
    lambda writer, text: writer.represent_scalar(
        "tag:yaml.org,2002:str", text, style=None if isinstance(resolved(text), str) else "'"
    ),
)


def in_brackets(value: object) -> str:
    """A value as it may stand on one line, in brackets with others."""
    return yaml_text([value], is_flow=True).strip()[1:-1]


class _EndError(Exception):
    """What was noted last is a fault after which nothing more can be read."""


def _size(node: Node) -> tuple[int, int]:
    """How many values a node is with those in it, and how many lists and mappings lie within each other there."""
    sizes = [(1, int(isinstance(node.plain, list | dict))), *map(_size, node.parts.values())]
    counts, heights = zip(*sizes, strict=True)
    return sum(counts), heights[0] + max(heights[1:], default=0)


class _Builder:
    """Nodes from the events of the YAML parser; depth is bounded before it can hurt."""

    def __init__(self, lines: list[str], events: Iterator[Any]) -> None:
        self._lines, self._events = lines, events
        self.faults: list[Fault] = []
        self._anchors: dict[str, Node] = {}
        self._count = 0  # values so far, aliases written out
        self._last = 0  # position behind the last value that was read

    def document(self) -> Node:
        """Return the value of the one document that there may be, or nothing."""
        root, documents = Node(None, 1, 1), 0
        for event in self._events:
            if isinstance(event, yaml.NodeEvent):
                root = self._value(event, 0)
            documents += isinstance(event, yaml.DocumentStartEvent)
            if documents > 1:
                hint = "one file, one model: remove '---'"
                raise self._end("a second document begins here", hint, event)
        return root

    def _note(self, message: str, hint: str, event: Any) -> None:
        """Note a fault at an event."""
        self.faults.append(_fault(message, hint, *_position(event.start_mark)))

    def _end(self, message: str, hint: str, event: Any) -> "_EndError":
        """Note a fault that ends the reading."""
        self._note(message, hint, event)
        return _EndError()

    def _value(self, event: Any, depth: int, *, is_name: bool = False) -> Node:
        """Return what begins with an event, in so many lists and mappings, to its end; refuse a file that is too large."""
        node = Node(None, *_position(event.start_mark), begin=event.start_mark.index)
        if isinstance(event, yaml.AliasEvent):
            node = self._repeated(node, event, depth)
        else:
            self._check(event, is_name=is_name)
            self._count += 1
            if event.anchor:
                self._anchors[event.anchor] = node
        if isinstance(event, yaml.ScalarEvent):
            node.plain = resolved(event.value) if event.implicit[0] else event.value
        if not isinstance(event, yaml.CollectionStartEvent):
            node.end = self._last = event.end_mark.index
            return node
        if depth == _DEEPEST:
            raise self._end(_TOO_DEEP, "", event)
        node.is_flow = bool(event.flow_style)
        node.plain = {} if isinstance(event, yaml.MappingStartEvent) else []
        while not isinstance(inner := next(self._events), _END):
            step: str | int = len(node.parts)
            key_place = None
            if isinstance(event, yaml.MappingStartEvent):
                step, key_place = self._key(inner, node), _position(inner.start_mark)
                inner = next(self._events)
            part = self._value(inner, depth + 1, is_name=step == "name")
            part.key_place = key_place
            node.parts[step] = part
        if node.is_flow:
            self._last = inner.end_mark.index
        node.end = self._last
        return node

    def _key(self, event: Any, node: Node) -> str:
        """Return the key of a mapping at an event; after a faulty one nothing but faults is kept."""
        if not isinstance(event, yaml.ScalarEvent):
            raise self._end("a key must be text", "put it in quotes", event)
        (line, column), key = _position(event.start_mark), event.value
        self._check(event, is_name=True)
        if event.implicit[0] and not isinstance(resolved(key), str):
            # The key may be the second half of a number like 1,5.
            before, hint = _HALF.search(self._lines[line - 1][: column - 1]), "put it in quotes"
            if before and key.isdecimal():
                hint = f"a decimal comma? write {before[1]}.{key}"
            self._note(f"the key {key or 'before this colon'} is not text", hint, event)
        elif event.implicit[0] and key == "<<":
            self._note("merge keys (<<) are not read", "write the keys out", event)
        if key in node.parts:
            message = f"the key '{key}' is already in line {node.parts[key].place[0]}"
            self._note(message, "remove one", event)
        return str(key)

    def _repeated(self, node: Node, event: Any, depth: int) -> Node:
        """Return what an alias stands for in the place of a node; refuse what makes the file too large."""
        target = self._anchors.get(event.anchor)
        if target is None:
            hint = "put text that begins with * in quotes"
            raise self._end(f"nothing above is named &{event.anchor}", hint, event)
        if not target.end:
            message = f"*{event.anchor} lies within the part that it repeats"
            raise self._end(message, "", event)
        size, height = _size(target)
        self._count += size
        if depth + height > _DEEPEST:
            raise self._end(_TOO_DEEP, "", event)
        if self._count > _LARGEST:
            message = f"aliases make more than {_LARGEST} values of this file"
            raise self._end(message, "", event)
        return replace(node, plain=target.plain, parts=target.parts)

    def _check(self, event: Any, *, is_name: bool) -> None:
        """Note a tag, and in a text a character that an escape makes and that the file itself must not hold."""
        if event.tag is not None:
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            self._note(f"tags are not read: {tag}", "remove it, or put text in quotes", event)
        if not isinstance(event, yaml.ScalarEvent):
            return
        if sign := CONTROLS.search(event.value):
            hint = "remove its escape: names and texts are printed on terminals"
            self._note(f"the character U+{ord(sign[0]):04X} is not allowed", hint, event)
        elif is_name and (sign := _BREAK.search(event.value)):
            message = f"the character U+{ord(sign[0]):04X} is not allowed in a name or key"
            self._note(message, "write it on one line", event)


def resolved(text: str) -> str | int | float | bool | None:
    """What a plain scalar stands for by the core rules of YAML 1.2, with underscores between digits."""
    if text in _WORDS:
        return _WORDS[text]
    if _WHOLE.fullmatch(text):  # one so long that no float is becomes infinite
        if text[:2] in {"0x", "0o"}:
            return Based(text, 0) if len(text) <= 250 else math.inf
        return int(text) if len(text) <= 300 else float(text)
    if _DECIMAL.fullmatch(text):
        return float(text)
    match = _NOT_FINITE.fullmatch(text)
    if match:
        return math.nan if match[1] is None else float(f"{match[1]}inf")
    return text


def is_number(text: str) -> bool:
    """Whether a plain scalar, or the cell of a table, says a number."""
    value = resolved(text)
    return isinstance(value, int | float) and not isinstance(value, bool)


def _syntax(error: yaml.MarkedYAMLError, source: Source) -> Fault:
    """The fault in plain words, where the text cannot be read on or where the piece that is not closed begins."""
    line, column = source.within(_position(error.problem_mark))
    before = source.lines[line - 1][:column]
    begin = source.within(_position(error.context_mark))
    if missing := missing_mark(str(error.problem), source.lines, (line, column), begin):
        return missing
    problem = "tab character" if before.isspace() and before.endswith("\t") else str(error.problem)
    for row in template("yaml_faults.txt").splitlines()[2:]:
        where, pattern, hint, words = row.split(" | ")
        if match := re.search(pattern, problem):
            message = words.format(*match.groups(), at=f"line {line}, column {column}")
            is_begin = where == "begin" and error.context_mark
            return _fault(message, hint, *(begin if is_begin else (line, column)))
    return _fault(f"this is not YAML: {problem}", "", line, column)


def _fault(message: str, hint: str, line: int, column: int) -> Fault:
    return Fault(
        (), printable(message, 200), hint, line=line, column=column
    )  # the message may quote the file


def _position(mark: Any) -> tuple[int, int]:
    return (mark.line + 1, mark.column + 1) if mark else (1, 1)
