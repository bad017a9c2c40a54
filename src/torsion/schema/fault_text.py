"""A text with the place of every value in it, and its faults as an engineer reads them: sorted, each with a caret."""

import re
from collections.abc import Iterable
from dataclasses import replace

from torsion.errors import Fault, InputError
from torsion.model import KINDS
from torsion.rules import RULES
from torsion.user_files import Source, printable, without_controls

_WIDTH = 120  # characters quoted of a longer line
_BEFORE = 60  # of these in front of the caret


def locate(faults: Iterable[Fault], source: Source) -> list[Fault]:
    """The faults with line and column, in the order of the file and then of its tables, each once.

    Where a fault was located before, as a reader of text does, nothing else is said of that place.
    """
    order = {table.name: number for number, (_, table) in enumerate(source.tables, start=1)}

    def place(fault: Fault) -> tuple[int, int, int, str]:
        return order.get(fault.file, 0), fault.line or 0, fault.column or 0, fault.file

    given = list(faults)
    located = dict.fromkeys(fault for fault in given if fault.line is not None)
    stated = set(map(place, located))
    for fault in given:
        if fault.line is not None:
            continue
        where, (line, column) = source.find(fault.path, key=fault.at_key)
        message = fault.message
        if fault.other:
            holds, (other_line, _) = source.find(fault.other)
            quoted = printable(re.sub(r"\s", " ", holds.lines[other_line - 1]).strip(), _WIDTH // 2)
            message += f" in line {other_line}" + ("" if holds is where else f" of {holds.name}")
            message += "" if (holds, other_line) == (where, line) else f", `{quoted}`"
        file = "" if where.name == source.name else where.name
        placed = replace(fault, message=message, line=line, column=column, file=file)
        if place(placed) not in stated:
            located[placed] = None
    return sorted(located, key=place)


def input_error(faults: Iterable[Fault], source: Source) -> InputError:
    """The error to raise for these faults: it holds them located, and its text is all of them.

    `file:line:column: message (hint)`, the line, a caret; a blank line between two faults.
    """
    located = locate(faults, source)
    return InputError(located, "\n\n".join(_text(fault, source) for fault in located))


def _text(fault: Fault, source: Source) -> str:
    """The fault, its line, cut around the column if it is long, and the caret under it (a tab stays a tab in both)."""
    line, column, hint = fault.line or 1, fault.column or 1, f" ({fault.hint})" * bool(fault.hint)
    tables = (table for _, table in source.tables if fault.file and table.name == fault.file)
    source = next(tables, source)
    head = without_controls(f"{source.name}:{line}:{column}: {fault.message}{hint}")
    quoted = source.lines[line - 1] if 1 <= line <= len(source.lines) else ""
    if not quoted.strip():
        return head
    first = column - 1 - _BEFORE if len(quoted) > _WIDTH and column - 1 > _BEFORE else 0
    shown = "".join(
        sign if sign.isprintable() or sign == "\t" else "?"
        for sign in quoted[first : first + _WIDTH]
    )
    indent = "".join("\t" if sign == "\t" else " " for sign in shown[: column - 1 - first])
    return "\n".join([head, f"    {shown}".rstrip(), f"    {indent}^"])


_WORD = r"([^\W\d][\w-]*)"
_UNOPENED = re.compile(rf"(\s*(?:-\s+)*){_WORD}\s*(:?)([{{\[])")  # `- coupling {`, `- coupling:{`
_ALONE = re.compile(rf"(\s*(?:-\s+)*){_WORD}\s*()(?:#.*)?$")  # `- coupling`
_WITHIN = re.compile(
    rf"(.*[{{,]\s*){_WORD}\s*()$"
)  # `clearance` in front of a bracket, within braces
_WITH_MARK = re.compile(r"([\w-]+)(?:\s*(:?)\{|\s+\S)")
_UNDASHED = re.compile(r"\s*([\w-]+):(?:\s|$)")


def without_mark(word: str, words: Iterable[str]) -> tuple[str, str] | None:
    """The known word in 'coupling {stiffness' or 'coupling:{stiffness', and its colon if it has one; None in another."""
    match = _WITH_MARK.match(word)
    return (match[1], match[2] or "") if match and match[1] in words else None


def words_for(word: str, colon: str, body: str = "{...}", dash: str = "") -> tuple[str, str]:
    """What is wrong with a word that misses its mark, and what would be right."""
    where = "a blank is missing after the colon of" if colon else "a colon is missing after"
    return f"{where} `{printable(word)}`", f"write `{dash}{printable(word)}: {body}`"


def missing_mark(
    problem: str, lines: list[str], position: tuple[int, int], begin: tuple[int, int]
) -> Fault | None:
    """The fault of a mark whose lack ends the reading at a place, for a reason that the parser gives; None of another.

    begin: where the piece begins that cannot be read on. Lines and columns from 1.
    """
    line, column = position
    before, behind = lines[line - 1][: column - 1], lines[line - 1][column - 1 : column]
    if re.search("expected ',' or '}'", problem) and behind in ("{", "["):
        return _without_colon(_WITHIN.match(before), line, "{...}")
    if not problem.startswith("mapping values"):
        return _of_a_block(lines, line) or _without_dash(lines, position, begin)
    # At the colon of a pair within brackets, whose own word misses its mark, or of a block.
    opened = 0  # brackets between the line and the colon, less those that are closed
    for number in range(line, 0, -1):
        text = lines[number - 1] if number < line else before
        opened += sum(map(text.count, "{[")) - sum(map(text.count, "}]"))
        if match := _UNOPENED.match(text):
            body = "{...}" if match[4] == "{" else "[...]"
            return _without_colon(match, number, body) if opened > 0 else None
        if re.match(r"\s*-\s", text):
            break
    return _of_a_block(lines, line)


def _of_a_block(lines: list[str], line: int) -> Fault | None:
    """At a key that stands deeper than the word above it, which is alone in its line."""
    above = next((k for k in range(line - 1, 0, -1) if _indent(lines[k - 1]) >= 0), 0)
    is_deeper = above and _indent(lines[above - 1]) < _indent(lines[line - 1])
    if not is_deeper or not _UNDASHED.match(lines[line - 1]):
        return None
    return _without_colon(_ALONE.match(lines[above - 1]), above, "{...}")


def _without_colon(match: re.Match[str] | None, line: int, body: str) -> Fault | None:
    """The fault of a word behind what stands in front of it in its line; None where there is none."""
    if match is None:
        return None
    dash = "- " if match[1].strip() == "-" else ""
    message, hint = words_for(match[2], match[3], body, dash)
    return Fault((), message, hint, line=line, column=match.end(1) + 1)


def _without_dash(
    lines: list[str], position: tuple[int, int], begin: tuple[int, int]
) -> Fault | None:
    """The fault of a kind or rule beside the entries of a list, first of them, between them or behind."""
    line_text, (line, column) = lines[position[0] - 1], position
    if not re.match(r"\s*-\s", line_text):
        is_behind = lines[begin[0] - 1][begin[1] - 1 :].startswith("- ")
        return _dashless(lines, line) if is_behind and _indent(line_text) == column - 1 else None
    # Lines of the same block above this one, from the last.
    block = list[int]()
    for k in range(line - 1, 0, -1):
        if 0 <= _indent(lines[k - 1]) < column - 1:
            break
        block += [k] * (_indent(lines[k - 1]) >= 0)
    siblings = [k for k in reversed(block) if k == block[-1] or _indent(lines[k - 1]) == column - 1]
    return next((fault for k in siblings if (fault := _dashless(lines, k))), None)


def _dashless(lines: list[str], line: int) -> Fault | None:
    match = _UNDASHED.match(lines[line - 1])
    if match is None or not (match[1] in KINDS or match[1] in RULES):
        return None
    message, hint = f"`{match[1]}` begins without a dash", f"write `- {match[1]}: ...`"
    return Fault((), message, hint, line=line, column=match.start(1) + 1)


def _indent(line: str) -> int:
    """Return how many blanks a line begins with; -1 where it is empty or a comment."""
    text = line.lstrip()
    return len(line) - len(text) if text and text[0] != "#" else -1
