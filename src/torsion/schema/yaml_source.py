"""The text of a YAML file as plain data, with line and column of every value and key.

Values follow the core rules of YAML 1.2 (`1e6` is a number, `no` is text), and numbers may hold underscores. Tags,
merge keys, repeated keys, keys other than text and several documents are refused.
"""

import math
import re
from dataclasses import replace
from pathlib import Path as FilePath
from typing import Any

import yaml

from torsion.errors import CONTROLS, REORDERING, Fault, InputError, printable
from torsion.schema.declaration_reader import ALIAS
from torsion.schema.fault_text import input_error, missing_mark
from torsion.user_files import LARGEST_SCENE, Node, Source, end_of, read_file

_DEEPEST = 50  # lists and mappings within each other; the deepest sensible scene has about ten
_LARGEST = 100_000  # values after aliases are written out; bounds what a few lines can blow up to
_LOADER: Any = getattr(yaml, "CSafeLoader", yaml.SafeLoader)

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
_INDENTED = (
    "check the indentation of this line and the one above; put text that holds ': ' in quotes"
)
_ALIGNED = "what belongs to one list or mapping begins in one column"
_SYNTAX = (  # what yaml says; in plain words; what to do; whether the fault stands where the piece begins
    (
        r"expected ',' or '(.)'",
        "no closing '{0}' for this bracket, or no comma before {at}",
        "",
        True,
    ),
    (r"unexpected (?:end of stream|document)", "this quote is not closed", "", True),
    (r"could not find expected ':'", "this key has no ':' after it", "", True),
    (r"tab character|'\\t'", "a tab is used for indentation", "use spaces", False),
    (r"mapping values are not allowed", "a ':' is not allowed here", _INDENTED, False),
    (
        r"cannot start any token",
        "a value cannot begin with this character",
        "put text in quotes",
        False,
    ),
    (
        r"sequence entries are not allowed",
        "a list cannot begin here",
        "begin it on a new line",
        False,
    ),
    (
        r"expected key|expected <block end>|expected '-' indicator",
        "this does not fit the lines above",
        _ALIGNED,
        False,
    ),
    (r"node content", "a value is missing in front of this", "", False),
    (r"expected '?<document start>", "this belongs to nothing before it", "", False),
    (
        r"escape|hexdecimal",
        "the backslash stands for no character here",
        r"write \\ or use single quotes",
        False,
    ),
    (r"alphabetic or numeric", "a name is missing after '&' or '*'", "put text in quotes", False),
    (r"directive|YAML document", "lines that begin with % are not read", "remove it", False),
    (
        r"\btag\b|expected '>'|expected the '>'",
        "tags (!) are not read",
        "put text in quotes",
        False,
    ),
    (r"line break|chomping", "nothing may follow '|' or '>' in its line", "", False),
)


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
    builder = _Builder(bare.lines)
    try:
        for event in yaml.parse(text, Loader=_LOADER):
            builder.take(event)
    except _EndError:
        pass
    except yaml.MarkedYAMLError as error:
        builder.faults.append(_syntax(error, bare))
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        builder.faults.append(_fault(f"this is not YAML: {error}", "", 1, 1))
    if builder.root.value is None and not builder.faults:
        builder.faults.append(
            _fault("the file is empty", "a model file needs at least a name and a train", 1, 1)
        )
    if builder.faults:
        raise input_error(builder.faults, bare)
    source = Source(name, text, builder.root)
    if not (isinstance(source.data, dict) and ALIAS.search(text)):
        return source
    from torsion.schema.aliases import replace_aliases

    return replace(source, faults=tuple(replace_aliases(source.root)))


def yaml_text(value: object, *, is_flow: bool = False) -> str:
    """A mapping as YAML, in the order of its keys; `is_flow`: all in brackets on one line."""
    style, width = (True, math.inf) if is_flow else (None, 110)
    made: str = yaml.safe_dump(
        value, default_flow_style=style, sort_keys=False, allow_unicode=True, width=width
    )
    return made


def in_brackets(value: object) -> str:
    """A value as it may stand on one line, in brackets with others."""
    return yaml_text([value], is_flow=True).strip()[1:-1]


class _EndError(Exception):
    """What was noted last is a fault after which nothing more can be read."""


class _Builder:
    """Nodes from the events of the YAML parser, without recursion: depth is bounded before it can hurt."""

    def __init__(self, lines: list[str]) -> None:
        self.root = Node(None, 1, 1)
        self._lines = lines
        self.faults: list[Fault] = []
        self._anchors: dict[str, Node] = {}
        self._open: list[Node] = []
        self._keys: list[
            str | int | None
        ] = []  # of every open node: what the next value belongs to
        self._documents = 0
        self._last = 0  # position behind the last value that was read

    def take(self, event: Any) -> None:
        """Take the next event: the key of the value that follows, a value, or the end of a list or mapping."""
        end: Any = event.end_mark
        if isinstance(event, yaml.DocumentStartEvent):
            self._documents += 1
            if self._documents > 1:
                hint = "one file, one model: remove '---'"
                self._note("a second document begins here", hint, event)
                raise _EndError
        elif isinstance(event, yaml.NodeEvent):
            awaits_key = self._keys[-1:] == [None]
            if not awaits_key:
                self._take_value(event)
                return
            if not isinstance(event, yaml.ScalarEvent):
                self._note("a key must be text", "put it in quotes", event)
                raise _EndError
            (line, column), keys = _position(event.start_mark), self._open[-1].keys
            key: str = event.value
            self._check(event)
            if event.implicit[0] and not isinstance(resolved(key), str):
                # The key may be the second half of a number like 1,5.
                before, hint = _HALF.search(self._lines[line - 1][: column - 1]), "put it in quotes"
                if before and key.isdecimal():
                    hint = f"a decimal comma? write {before[1]}.{key}"
                self._note(f"the key {key or 'before this colon'} is not text", hint, event)
            elif event.implicit[0] and key == "<<":
                self._note("merge keys (<<) are not read", "write the keys out", event)
            # After a repeated key nothing but faults is kept.
            self._keys[-1] = key
            if key in keys:
                message = f"the key '{key}' is already in line {keys[key][0]}"
                self._note(message, "remove one", event)
            keys.setdefault(key, (line, column))
        elif isinstance(event, yaml.CollectionEndEvent):
            self._keys.pop()
            node = self._open.pop()
            if node.is_flow:
                self._last = end.index
            node.end = self._last
            self._attach(node)

    def _note(self, message: str, hint: str, event: Any) -> None:
        """Note a fault at an event."""
        self.faults.append(_fault(message, hint, *_position(event.start_mark)))

    def _take_value(self, event: Any) -> None:
        """Attach a scalar or what an alias stands for, open a list or mapping; refuse what makes the file too large."""
        is_alias, begins = (
            isinstance(event, kind) for kind in (yaml.AliasEvent, yaml.CollectionStartEvent)
        )
        target, message, hint = self._anchors.get(event.anchor) if is_alias else None, "", ""
        if not is_alias:
            self._check(event)
        elif target is None:
            message = f"nothing above is named &{event.anchor}"
            hint = "put text that begins with * in quotes"
        elif target in self._open:
            message = f"*{event.anchor} lies within the part that it repeats"
        if not message and len(self._open) + (target.height if target else begins) > _DEEPEST:
            message = f"more than {_DEEPEST} lists and mappings within each other"
        elif target and sum(node.size for node in self._open) + target.size > _LARGEST:
            message = message or f"aliases make more than {_LARGEST} values of this file"
        if message:
            self._note(message, hint, event)
            raise _EndError
        node = Node(None, *_position(event.start_mark))
        if target is not None:
            node = replace(target, line=node.line, column=node.column, is_flow=False, source=None)
        elif event.anchor:
            self._anchors[event.anchor] = node
        node.begin = event.start_mark.index
        if begins:
            is_mapping = isinstance(event, yaml.MappingStartEvent)
            node.is_flow = bool(event.flow_style)
            node.value, node.height = ({} if is_mapping else []), 1
            self._open.append(node)
            self._keys.append(None if is_mapping else 0)
            return
        if isinstance(event, yaml.ScalarEvent):
            node.value = resolved(event.value) if event.implicit[0] else event.value
        node.end = self._last = event.end_mark.index
        self._attach(node)

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

    def _check(self, event: Any) -> None:
        """Note a tag, and in a text a character that an escape makes and that the file itself must not hold."""
        if event.tag is not None:
            tag = event.tag.replace("tag:yaml.org,2002:", "!!")
            self._note(f"tags are not read: {tag}", "remove it, or put text in quotes", event)
        if not isinstance(event, yaml.ScalarEvent):
            return
        is_name = self._keys[-1:] in ([None], ["name"])  # names and keys are one line
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
    for pattern, words, hint, at_begin in _SYNTAX:
        if match := re.search(pattern, problem):
            message = words.format(*match.groups(), at=f"line {line}, column {column}")
            return _fault(
                message, hint, *(begin if at_begin and error.context_mark else (line, column))
            )
    return _fault(f"this is not YAML: {problem}", "", line, column)


def _fault(message: str, hint: str, line: int, column: int) -> Fault:
    return Fault(
        (), printable(message, 200), hint, line=line, column=column
    )  # the message may quote the file


def _position(mark: Any) -> tuple[int, int]:
    return (mark.line + 1, mark.column + 1) if mark else (1, 1)
