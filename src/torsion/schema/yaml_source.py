"""The text of a YAML file as plain data, with line and column of every value and key.

Values follow the core rules of YAML 1.2 (`1e6` is a number, `no` is text), and numbers may hold underscores. Tags,
merge keys, repeated keys, keys other than text and several documents are refused.
"""

import math
import re
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path as FilePath
from typing import Any

import yaml

from torsion.errors import Fault, InputError, Path
from torsion.schema.fault_text import input_error, syntax_words

_DEEPEST = 50  # lists and mappings within each other; the deepest sensible scene has about ten
_LARGEST = 100_000  # values after aliases are written out; bounds what a few lines can blow up to
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

_BREAK = re.compile(r"\r\n|[\n\r\x85\u2028\u2029]")
_FORBIDDEN = re.compile("[^\t\n\r -~\x85\xa0-\ud7ff\ue000-\ufefe\uff00-\ufffd\U00010000-\U0010ffff]")
_WORDS: dict[str, bool | None] = {"": None, "~": None}
_WORDS |= dict.fromkeys(("null", "Null", "NULL"))
_WORDS |= dict.fromkeys(("true", "True", "TRUE"), True) | dict.fromkeys(("false", "False", "FALSE"), False)
_HALF = re.compile(r"([0-9]+),$")  # of a number with a decimal comma, in a mapping within braces
_WHOLE = re.compile(r"[-+]?[0-9]+(?:_[0-9]+)*|0x[0-9a-fA-F]+|0o[0-7]+")
_DIGITS = r"[0-9]+(?:_[0-9]+)*"
_DECIMAL = re.compile(rf"[-+]?(?:\.{_DIGITS}|{_DIGITS}(?:\.(?:{_DIGITS})?)?)(?:[eE][-+]?[0-9]+)?")
_NOT_FINITE = re.compile(r"([-+]?)\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)")


@dataclass(slots=True, eq=False)
class Node:
    """A value where it stands; `parts` are the values in it by key or position, `keys` the places of its keys."""

    value: Any
    line: int
    column: int
    parts: "dict[str | int, Node]" = field(default_factory=dict)
    keys: dict[str, tuple[int, int]] = field(default_factory=dict)
    size: int = 1  # values in it and itself, aliases written out
    height: int = 0  # lists and mappings within each other


@dataclass(frozen=True, eq=False)
class Source:
    """A text and what it says: plain dict, list, str, int, float, bool and None."""

    name: str
    text: str
    root: Node

    @property
    def data(self) -> Any:
        return self.root.value

    @cached_property
    def lines(self) -> list[str]:
        return _BREAK.split(self.text)

    def place(self, path: Path, key: bool = False) -> tuple[int, int]:
        """Line and column, from 1, of the value (or its key) at `path`, or of the nearest parent that exists."""
        node = self.root
        label = node.line, node.column
        for step in path:
            part = node.parts.get(step)
            if part is None:
                break
            label = node.keys.get(str(step), (part.line, part.column))
            node = part
        return _within(label if key else (node.line, node.column), self.lines)


def read_source(path: str | FilePath) -> Source:
    """The file as data with places; raises InputError."""
    name = str(path)
    try:
        content = FilePath(path).read_bytes()
    except FileNotFoundError:
        raise _without_place(name, "the file does not exist") from None
    except IsADirectoryError:
        raise _without_place(name, "this is a folder, not a file") from None
    except (OSError, ValueError) as error:
        raise _without_place(name, f"the file cannot be read: {getattr(error, 'strerror', None) or error}") from None
    try:
        return parse_source(content.decode(), name)
    except UnicodeDecodeError as error:
        before = content[: error.start].decode()
        fault = _fault("the file is not UTF-8 text", "save it as UTF-8", *_end(before))
        raise input_error([fault], _bare(name, content.decode(errors="replace"))) from None


def parse_source(text: str, name: str) -> Source:
    """The text as data with places; raises InputError with every fault up to the first one that ends the reading."""
    text = text.removeprefix("\ufeff")  # the byte order mark with which some editors begin a file
    bare = _bare(name, text)
    forbidden = _FORBIDDEN.search(text)
    if forbidden:
        raise input_error([_forbidden(forbidden[0], *_end(text[: forbidden.start()]))], bare)
    builder = _Builder(bare.lines)
    try:
        for event in yaml.parse(text, Loader=_LOADER):
            builder.take(event)
    except _EndError as end:
        builder.faults.append(end.fault)
    except yaml.MarkedYAMLError as error:
        builder.faults.append(_syntax(error, bare.lines))
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        builder.faults.append(_fault(f"this is not YAML: {error}", "", 1, 1))
    if builder.root.value is None and not builder.faults:
        builder.faults.append(_fault("the file is empty", "a scene needs at least a name and a train", 1, 1))
    if builder.faults:
        raise input_error(builder.faults, bare)
    return Source(name, text, builder.root)


class _EndError(Exception):
    """A fault after which nothing more can be read."""

    def __init__(self, message: str, hint: str, event: Any) -> None:
        self.fault = _fault(message, hint, *_mark(event))


class _Builder:
    """Nodes from the events of the YAML parser, without recursion: depth is bounded before it can hurt."""

    def __init__(self, lines: list[str]) -> None:
        self.root = Node(None, 1, 1)
        self._lines = lines
        self.faults: list[Fault] = []
        self._anchors: dict[str, Node] = {}
        self._open: list[Node] = []
        self._keys: list[str | int | None] = []  # of every open node: what the next value belongs to
        self._documents = 0

    def take(self, event: Any) -> None:
        if isinstance(event, yaml.DocumentStartEvent):
            self._documents += 1
            if self._documents > 1:
                raise _EndError("a second document begins here", "one file, one scene: remove '---'", event)
        elif isinstance(event, yaml.ScalarEvent) and self._awaits_key():
            self._take_key(event)
        elif isinstance(event, yaml.NodeEvent):
            if self._awaits_key():
                raise _EndError("a key must be text", "put it in quotes", event)
            self._take_value(event)
        elif isinstance(event, yaml.CollectionEndEvent):
            self._keys.pop()
            self._attach(self._open.pop())

    def _awaits_key(self) -> bool:
        return bool(self._keys) and self._keys[-1] is None

    def _take_key(self, event: Any) -> None:
        """The key of the value that follows; after a repeated one nothing but faults is kept."""
        place, keys, key = _mark(event), self._open[-1].keys, event.value
        self._check_tag(event)
        if event.implicit[0] and not isinstance(resolved(key), str):
            hint = self._decimal_comma(key, place) or "put it in quotes"
            self.faults.append(_fault(f"the key {key or 'before this colon'} is not text", hint, *place))
        elif event.implicit[0] and key == "<<":
            self.faults.append(_fault("merge keys (<<) are not read", "write the keys out", *place))
        self._keys[-1] = key
        if key in keys:
            self.faults.append(_fault(f"the key '{key}' is already in line {keys[key][0]}", "remove one", *place))
        else:
            keys[key] = place

    def _decimal_comma(self, key: str, place: tuple[int, int]) -> str:
        """The hint to a key that is the second half of a number like 1,5; empty where it is none."""
        before = _HALF.search(self._lines[place[0] - 1][: place[1] - 1])
        return f"a decimal comma? write {before[1]}.{key}" if before and key.isdecimal() else ""

    def _take_value(self, event: Any) -> None:
        if isinstance(event, yaml.AliasEvent):
            self._attach(self._aliased(event))
            return
        self._check_tag(event)
        scalar = isinstance(event, yaml.ScalarEvent)
        node = Node(None, *_mark(event))
        if event.anchor:
            self._anchors[event.anchor] = node
        if scalar:
            node.value = resolved(event.value) if event.implicit[0] else event.value
            self._attach(node)
            return
        if len(self._open) >= _DEEPEST:
            raise _EndError(f"more than {_DEEPEST} lists and mappings within each other", "", event)
        mapping = isinstance(event, yaml.MappingStartEvent)
        node.value, node.height = ({} if mapping else []), 1
        self._open.append(node)
        self._keys.append(None if mapping else 0)

    def _aliased(self, event: Any) -> Node:
        target = self._anchors.get(event.anchor)
        if target is None:
            raise _EndError(f"nothing above is named &{event.anchor}", "put text that begins with * in quotes", event)
        if target in self._open:
            raise _EndError(f"*{event.anchor} stands within the very thing it repeats", "", event)
        if len(self._open) + target.height > _DEEPEST:
            raise _EndError(f"more than {_DEEPEST} lists and mappings within each other", "", event)
        if sum(node.size for node in self._open) + target.size > _LARGEST:
            raise _EndError(f"aliases make more than {_LARGEST} values of this file", "", event)
        return Node(target.value, *_mark(event), target.parts, target.keys, target.size, target.height)

    def _attach(self, node: Node) -> None:
        """Put a complete node where it belongs."""
        if not self._open:
            self.root = node
            return
        parent, key = self._open[-1], self._keys[-1]
        parent.size += node.size
        parent.height = max(parent.height, node.height + 1)
        if isinstance(key, int):
            parent.value.append(node.value)
            parent.parts[key] = node
            self._keys[-1] = key + 1
            return
        if key is not None:
            parent.value[key] = node.value
            parent.parts[key] = node
        self._keys[-1] = None

    def _check_tag(self, event: Any) -> None:
        if event.tag is not None:
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            self.faults.append(_fault(f"tags are not read: {tag}", "remove it, or put text in quotes", *_mark(event)))


def resolved(text: str) -> str | int | float | bool | None:
    """What a plain scalar stands for by the core rules of YAML 1.2, with underscores between digits."""
    if text in _WORDS:
        return _WORDS[text]
    if _WHOLE.fullmatch(text):
        return _whole(text)
    if _DECIMAL.fullmatch(text):
        return float(text)
    found = _NOT_FINITE.fullmatch(text)
    if found:
        return math.nan if found[1] is None else float(f"{found[1]}inf")
    return text


def _whole(text: str) -> int | float:
    """A whole number; as a float if it is so long that no float is (which is then not finite)."""
    if text[:2] in {"0x", "0o"}:
        return int(text, 0) if len(text) <= 250 else math.inf
    return int(text) if len(text) <= 300 else float(text)


def _syntax(error: yaml.MarkedYAMLError, lines: list[str]) -> Fault:
    line, column = _within(_place(error.problem_mark), lines)
    indented_by_tab = lines[line - 1][:column].isspace() and lines[line - 1][column - 1] == "\t"
    problem = "tab character" if indented_by_tab else str(error.problem)
    message, hint, at_begin = syntax_words(problem, f"line {line}, column {column}")
    if at_begin and error.context_mark:
        line, column = _within(_place(error.context_mark), lines)
    return _fault(message, hint, line, column)


def _within(place: tuple[int, int], lines: list[str]) -> tuple[int, int]:
    """The place, or the end of the text if it lies behind it (where the parser puts what is missing at the end)."""
    return place if place[0] <= len(lines) else (len(lines), len(lines[-1]) + 1)


def _forbidden(sign: str, line: int, column: int) -> Fault:
    if sign == "\ufeff":
        return _fault("a byte order mark (U+FEFF) stands here", "save the file as UTF-8 without it", line, column)
    return _fault(f"the character U+{ord(sign):04X} is not allowed", "remove it", line, column)


def _fault(message: str, hint: str, line: int, column: int) -> Fault:
    plain = "".join(sign if sign.isprintable() else "?" for sign in message[:200])  # it may quote the file
    return Fault((), plain, hint, line=line, column=column)


def _mark(event: Any) -> tuple[int, int]:
    return _place(event.start_mark)


def _place(mark: Any) -> tuple[int, int]:
    return (mark.line + 1, mark.column + 1) if mark else (1, 1)


def _end(text: str) -> tuple[int, int]:
    lines = _BREAK.split(text)
    return len(lines), len(lines[-1]) + 1


def _bare(name: str, text: str) -> Source:
    """A text of which nothing has been read, to quote from."""
    return Source(name, text, Node(None, 1, 1))


def _without_place(name: str, message: str) -> InputError:
    return InputError([Fault((), message)], f"{name}: {message}")
