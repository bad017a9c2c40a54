"""How files of a user are read, a text with the place of every value in it, and how a text of a user is shown.

A file is a regular one of a stated size at most, read as bytes; nothing else opens one.
"""

import errno
import os
import re
import stat
from collections.abc import Iterable
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cached_property
from operator import itemgetter
from pathlib import Path as FilePath
from typing import Any

from torsion.errors import Fault, Path

_REORDERING = "\xad\u061c\u180e\u200b\u200e\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\U000e0000-\U000e007f"
CONTROLS = re.compile(  # characters that a terminal obeys, that reorder or hide text, or that no file can hold
    f"[\0-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff{_REORDERING}]"
)
REORDERING = re.compile(f"[{_REORDERING}]")
_BREAK = re.compile(r"\r\n|[\n\r\x85\u2028\u2029]")
LARGEST_SCENE = 10_000_000  # bytes; a train of 20,000 stations has about 3 MB
LARGEST_TABLE = 20_000_000  # bytes; 200 a row of the longest table
LARGEST_SIGNAL = 100_000_000  # bytes; 50 a row of the longest signal
LARGEST_RESULTS = 500_000_000  # bytes
# Of a file: when it was written, its size, which one it is; None of a missing one.
Stamp = tuple[int, int, int] | None
# The files that are opened, also in vain, as they were before: what the live page follows.
OPENED: ContextVar[dict[str, Stamp] | None] = ContextVar("OPENED", default=None)


def stamp(file: str | FilePath) -> Stamp:
    """Return the stamp of a file as it is now."""
    try:
        status = os.stat(file)
    except (OSError, ValueError):
        return None
    return status.st_mtime_ns, status.st_size, status.st_ino


def read_file(file: str | FilePath, largest: int) -> bytes:
    """The content of a file of at most so many bytes; raises OSError, whose `strerror` says why it is not read.

    A device or a pipe is refused before it is opened: it may have no end, or wait for a writer.
    """
    check_file(file, largest)
    with open(file, "rb") as stream:
        content = stream.read(largest + 1)
    check_file(file, largest, len(content))  # it may have grown since, or state no size
    return content


def check_file(file: str | FilePath, largest: int, size: int = 0) -> None:
    """Raise OSError for what is no regular file, or larger than that (bytes); for a reader that opens it itself.

    size: as far as more is known of it than the file system says.
    """
    if (opened := OPENED.get()) is not None:
        opened.setdefault(os.path.abspath(file), stamp(file))
    status = os.stat(file)
    if stat.S_ISDIR(status.st_mode):
        raise IsADirectoryError(errno.EISDIR, "it is a folder", str(file))
    if not stat.S_ISREG(status.st_mode):
        raise OSError(errno.EINVAL, "it is a device or a pipe, not a file", str(file))
    if (size := max(size, status.st_size)) > largest:
        unit, name = (1e6, "MB") if largest >= 1e6 else (1e3, "kB")
        words = f"it has {size / unit:,.0f} {name}, at most {largest / unit:,.0f} {name} are read"
        raise OSError(errno.EFBIG, words, str(file))


@dataclass(slots=True, eq=False)
class Node:
    """A value where it stands; of a mapping or list `parts` are the values in it, by key or position."""

    plain: Any  # the value; of a mapping or list with parts its kind alone, {} or []
    line: int
    column: int
    parts: "dict[str | int, Node]" = field(default_factory=dict)
    key_place: tuple[int, int] | None = None  # of a value in a mapping
    begin: int = 0  # position in the text of the file
    end: int = 0  # behind it; of a list or mapping without brackets behind the last value in it
    is_flow: bool = False  # it stands in brackets
    source: "Source | None" = None  # of a value that a table states: the text of that table

    @property
    def value(self) -> Any:
        """The value as plain data."""
        if not self.parts:
            return self.plain
        if isinstance(self.plain, list):
            return [part.value for part in self.parts.values()]
        return {key: part.value for key, part in self.parts.items()}

    @property
    def place(self) -> tuple[int, int]:
        """Where it begins: at its key, where it has one."""
        return self.key_place or (self.line, self.column)

    def as_list(self, parts: "Iterable[Node]") -> "Node":
        """Return the parts as a list in its place."""
        return replace(self, plain=[], parts=dict(enumerate(parts)))

    def as_mapping(self, parts: "dict[str | int, Node]") -> "Node":
        """Return the parts as a mapping in its place."""
        return replace(self, plain={}, parts=parts)


@dataclass(frozen=True, eq=False)
class Source:
    """A text and what it says: plain dict, list, str, int, float, bool and None."""

    name: str
    text: str
    root: Node = field(
        default_factory=lambda: Node(None, 1, 1)
    )  # nothing, of a text to quote from alone
    tables: "tuple[tuple[str, Source], ...]" = ()  # every table by the name that the text gives it
    faults: tuple[Fault, ...] = ()  # of its tables, which can be read all the same

    @cached_property
    def data(self) -> Any:
        return self.root.value

    @cached_property
    def lines(self) -> list[str]:
        return _BREAK.split(self.text)

    def at(self, path: Path) -> Node | None:
        """What stands at a path; None where nothing does."""
        node = self.root
        for step in path:
            if step not in node.parts:
                return None
            node = node.parts[step]
        return node

    def find(self, path: Path, key: bool = False) -> tuple["Source", tuple[int, int]]:
        """The text in which the value at `path` stands, this one or a table's, and its place there."""
        node, source = self.root, self
        for step in path:
            if step not in node.parts:
                break
            node = node.parts[step]
            source = node.source or source
        return source, source.within(node.place if key else (node.line, node.column))

    def within(self, position: tuple[int, int]) -> tuple[int, int]:
        """The place, or the end of the text if it lies behind it (where the parser puts what is missing there)."""
        return min(position, (len(self.lines), len(self.lines[-1]) + 1), key=itemgetter(0))


def end_of(text: str) -> tuple[int, int]:
    """Line and column behind a text."""
    lines = _BREAK.split(text)
    return len(lines), len(lines[-1]) + 1


def line_starts(text: str) -> list[int]:
    """Position in a text at which each of its lines begins."""
    return [0, *(ending.end() for ending in _BREAK.finditer(text))]


def without_controls(text: str) -> str:
    """Return the text with '?' for each control character but tabs and line breaks, and for what is not UTF-8.

    >>> without_controls("a " + chr(27) + "[31mred")
    'a ?[31mred'
    """
    return CONTROLS.sub("?", text)


def printable(text: str, longest: int = 60) -> str:
    """Return the text as a message quotes it: cut, and '?' for what cannot be shown."""
    shown = "".join(sign if sign.isprintable() else "?" for sign in text[:longest])
    return shown if len(text) <= longest else f"{shown}…"
