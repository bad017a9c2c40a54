"""Faults of the input as an engineer reads them: sorted by place, each with its line quoted and a caret underneath."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from torsion.errors import Fault, InputError

if TYPE_CHECKING:
    from torsion.schema.yaml_source import Source

_WIDTH = 120  # characters quoted of a longer line
_BEFORE = 60  # of these in front of the caret

_SYNTAX = (  # what yaml says; in plain words; what to do; whether the fault stands where the piece begins
    (r"expected ',' or '(.)'", "no closing '{0}' for this bracket, or no comma before {at}", "", True),
    (r"unexpected (?:end of stream|document)", "this quote is not closed", "", True),
    (r"could not find expected ':'", "this key has no ':' behind it", "", True),
    (r"tab character|'\\t'", "a tab is used for indentation", "use spaces", False),
    (
        r"mapping values are not allowed",
        "a ':' is not allowed here",
        "check the indentation of this line and the one above; put text that holds ': ' in quotes",
        False,
    ),
    (r"cannot start any token", "a value cannot begin with this character", "put text in quotes", False),
    (r"sequence entries are not allowed", "a list cannot begin here", "begin it on a line of its own", False),
    (
        r"expected key|expected <block end>|expected '-' indicator",
        "this does not fit the lines above",
        "what belongs to one list or mapping begins in one column",
        False,
    ),
    (r"node content", "a value is missing in front of this", "", False),
    (r"expected '?<document start>", "this belongs to nothing before it", "", False),
    (r"escape|hexdecimal", "the backslash stands for no character here", r"write \\ or use single quotes", False),
    (r"alphabetic or numeric", "a name is missing after '&' or '*'", "put text in quotes", False),
    (r"directive|YAML document", "lines that begin with % are not read", "remove it", False),
    (r"\btag\b|expected '>'|expected the '>'", "tags (!) are not read", "put text in quotes", False),
    (r"line break|chomping", "nothing may follow '|' or '>' in its line", "", False),
)


def locate(faults: Iterable[Fault], source: "Source") -> list[Fault]:
    """The faults with line and column, in the order of the file, each once."""
    located = dict.fromkeys(_located(fault, source) for fault in faults)
    return sorted(located, key=lambda fault: (fault.line or 0, fault.column or 0))


def input_error(faults: Iterable[Fault], source: "Source") -> InputError:
    """The error to raise for these faults: it holds them located, and its text is all of them.

    `file:line:column: message (hint)`, the line, a caret; a blank line between two faults.
    """
    located = locate(faults, source)
    return InputError(located, "\n\n".join(_text(fault, source) for fault in located))


def syntax_words(problem: str, at: str) -> tuple[str, str, bool]:
    """What yaml says is wrong, in plain words; a hint; whether to show where the piece begins, rather than `at`."""
    for pattern, words, hint, at_begin in _SYNTAX:
        found = re.search(pattern, problem)
        if found:
            return words.format(*found.groups(), at=at), hint, at_begin
    return f"this is not YAML: {problem}", "", False


def _located(fault: Fault, source: "Source") -> Fault:
    if fault.line is not None:
        return fault
    line, column = source.place(fault.path, key=fault.at_key)
    message = fault.message
    if fault.other:
        there = source.place(fault.other)[0]
        message += f" in line {there}" + ("" if there == line else f", {_excerpt(source.lines[there - 1])}")
    return replace(fault, message=message, line=line, column=column)


def _excerpt(line: str) -> str:
    """A line as it is quoted within a message."""
    plain = "".join(sign if sign.isprintable() else " " for sign in line).strip()
    return f"`{plain}`" if len(plain) <= _WIDTH // 2 else f"`{plain[: _WIDTH // 2]}…`"


def _text(fault: Fault, source: "Source") -> str:
    hint = f" ({fault.hint})" if fault.hint else ""
    line, column = fault.line or 1, fault.column or 1
    head = f"{source.name}:{line}:{column}: {fault.message}{hint}"
    if not 1 <= line <= len(source.lines) or not source.lines[line - 1].strip():
        return head
    return "\n".join([head, *_quoted(source.lines[line - 1], column)])


def _quoted(line: str, column: int) -> Sequence[str]:
    """The line, cut around the column if it is long, and the caret under it (a tab stays a tab in both)."""
    first = column - 1 - _BEFORE if len(line) > _WIDTH and column - 1 > _BEFORE else 0
    shown = "".join(sign if sign.isprintable() or sign == "\t" else "?" for sign in line[first : first + _WIDTH])
    indent = "".join("\t" if sign == "\t" else " " for sign in shown[: column - 1 - first])
    return f"    {shown}".rstrip(), f"    {indent}^"
