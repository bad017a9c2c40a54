"""Dashes, colons and blanks that are missing: found from the lines where the YAML parser ends, or within a word."""

import re
from collections.abc import Iterable
from itertools import takewhile

from torsion.errors import Fault, printable
from torsion.model import KINDS
from torsion.rules import RULES

_WORD = r"([^\W\d][\w-]*)"
_UNOPENED = re.compile(rf"(\s*(?:-\s+)*){_WORD}\s*(:?)([{{\[])")  # `- coupling {`, `- coupling:{`
_ALONE = re.compile(rf"(\s*(?:-\s+)*){_WORD}\s*()(?:#.*)?$")  # `- coupling`
_WITHIN = re.compile(
    rf"(.*[{{,]\s*){_WORD}\s*()$"
)  # `clearance` in front of a bracket, within braces
_WITH_MARK = re.compile(r"([\w-]+)(?:\s*(:?)\{|\s+\S)")
_UNDASHED = re.compile(r"\s*([\w-]+):(?:\s|$)")


def without_mark(word: str, words: Iterable[str]) -> tuple[str, str] | None:
    """The known word in 'coupling {stiffness' or 'coupling:{stiffness' and the mark that it misses; None in another."""
    match = _WITH_MARK.match(word)
    return (match[1], _mark(match[2])) if match and match[1] in words else None


def words_for(word: str, mark: str, body: str = "{...}", dash: str = "") -> tuple[str, str]:
    """What is wrong with a word that misses its mark, and what would be right."""
    where = (
        "a blank is missing after the colon of" if mark == "blank" else "a colon is missing after"
    )
    return f"{where} `{printable(word)}`", f"write `{dash}{printable(word)}: {body}`"


def missing_mark(
    problem: str, lines: list[str], position: tuple[int, int], begin: tuple[int, int]
) -> Fault | None:
    """The fault of a mark whose lack ends the reading at a place, for a reason that the parser gives; None of another.

    begin: where the piece begins that cannot be read on. Lines and columns from 1.
    """
    if problem.startswith("mapping values"):
        return _of_a_pair(lines, position)
    if re.search("expected ',' or '}'", problem) and lines[position[0] - 1][
        position[1] - 1 : position[1]
    ] in ("{", "["):
        return _without_colon(
            _WITHIN.match(lines[position[0] - 1][: position[1] - 1]), position[0], "{...}"
        )
    return _of_a_block(lines, position[0]) or _without_dash(lines, position, begin)


def _mark(colon: str) -> str:
    return "blank" if colon else "colon"


def _of_a_pair(lines: list[str], position: tuple[int, int]) -> Fault | None:
    """At the colon of a pair within brackets, or of a block, whose own word misses its mark."""
    opened = 0  # brackets between the line and the colon, less those that are closed
    for number in range(position[0], 0, -1):
        line = lines[number - 1] if number < position[0] else lines[number - 1][: position[1] - 1]
        opened += sum(map(line.count, "{[")) - sum(map(line.count, "}]"))
        if match := _UNOPENED.match(line):
            return (
                _without_colon(match, number, "{...}" if match[4] == "{" else "[...]")
                if opened > 0
                else None
            )
        if re.match(r"\s*-\s", line):
            break
    return _of_a_block(lines, position[0])


def _of_a_block(lines: list[str], line: int) -> Fault | None:
    """At a key that stands deeper than the word above it, which is alone in its line."""
    line_text, above = (
        lines[line - 1],
        next((k for k in range(line - 1, 0, -1) if _is_filled(lines[k - 1])), None),
    )
    if (
        above is None
        or not _UNDASHED.match(line_text)
        or _indent(lines[above - 1]) >= _indent(line_text)
    ):
        return None
    return _without_colon(_ALONE.match(lines[above - 1]), above, "{...}")


def _without_colon(match: re.Match[str] | None, line: int, body: str) -> Fault | None:
    """The fault of a word behind what stands in front of it in its line; None where there is none."""
    if match is None:
        return None
    message, hint = words_for(
        match[2], _mark(match[3]), body, "- " if match[1].strip() == "-" else ""
    )
    return Fault((), message, hint, line=line, column=match.end(1) + 1)


def _without_dash(
    lines: list[str], position: tuple[int, int], begin: tuple[int, int]
) -> Fault | None:
    """The fault of a kind or rule beside the entries of a list, first of them, between them or behind."""
    line_text, (line, column) = lines[position[0] - 1], position
    if not re.match(r"\s*-\s", line_text):
        is_behind = lines[begin[0] - 1][begin[1] - 1 :].startswith("- ")
        return _dashless(lines, line) if is_behind and _indent(line_text) == column - 1 else None
    above = range(line - 1, 0, -1)
    block = [
        k
        for k in takewhile(lambda k: _fits(lines[k - 1], column - 1), above)
        if _is_filled(lines[k - 1])
    ]
    siblings = [k for k in reversed(block) if k == block[-1] or _indent(lines[k - 1]) == column - 1]
    return next((fault for k in siblings if (fault := _dashless(lines, k))), None)


def _dashless(lines: list[str], line: int) -> Fault | None:
    match = _UNDASHED.match(lines[line - 1])
    if match is None or not (match[1] in KINDS or match[1] in RULES):
        return None
    message, hint = f"`{match[1]}` begins without a dash", f"write `- {match[1]}: ...`"
    return Fault((), message, hint, line=line, column=match.start(1) + 1)


def _fits(line: str, indent: int) -> bool:
    """Whether a line belongs to what is indented so far, or says nothing."""
    return not _is_filled(line) or _indent(line) >= indent


def _is_filled(line: str) -> bool:
    return bool(line.strip()) and not line.lstrip().startswith("#")


def _indent(line: str) -> int:
    return len(line) - len(line.lstrip())
