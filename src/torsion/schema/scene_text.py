"""The text of a file with other values in it: its own words and comments where that can be, else all of it anew."""

import re
from collections.abc import Callable, Collection, Iterable, Mapping

from torsion.errors import InputError, Path
from torsion.schema.fault_text import Node, Source
from torsion.schema.overlay import node_at
from torsion.schema.yaml_source import written

_SCALAR = re.compile(r""""(?:[^"\\]|\\.)*"|'(?:[^']|'')*'|[^,{}\[\]#\n]*[^,{}\[\]#\n\s]""")


def text_with(
    source: Source, puts: Iterable[tuple[Path, Node]], gone: Collection[Path], wanted: Source,
    read: Callable[[str], Source],
) -> str:  # fmt: skip
    """The file with values put at places and without some sections, saying what `wanted` says.

    read: a text with its tables. A text whose words cannot be kept (a value in a table, a section on one line with
    others) is written anew without its comments, with the rows of its tables; so is a case, without the other cases.
    """
    text = _edited(source, dict(puts), gone)
    if text is not None:
        try:
            if read(text).data == wanted.data:
                return text
        except InputError:
            pass
    is_case = read(source.text).data != source.data
    return written({key: value for key, value in wanted.data.items() if not (is_case and key == "cases")})


def _edited(source: Source, puts: Mapping[Path, Node], gone: Collection[Path]) -> str | None:
    """The text with its scalars replaced and the lines of sections left out; None where a value stands in a table."""
    lines: list[str | None] = list(source.text.split("\n"))
    places = []
    for path, new in puts.items():
        node = node_at(source.root, path)
        if node is None or node.source is not None or isinstance(node.value, dict | list):
            return None
        places.append((node.line - 1, node.column - 1, new.value))
    for line, column, value in sorted(places, reverse=True):  # the last in a line first
        words = lines[line] or ""
        found = _SCALAR.match(words, column)
        if found is None:
            return None
        lines[line] = f"{words[:column]}{value}{words[found.end() :]}"
    for path in gone:
        node = node_at(source.root, path[:-1])
        if node is None or str(path[-1]) not in node.keys:
            continue
        line, column = node.keys[str(path[-1])]
        if (lines[line - 1] or "")[: column - 1].strip():
            return None
        lines[line - 1] = None
        for below in range(line, len(lines)):
            words = lines[below] or ""
            if words.strip() and len(words) - len(words.lstrip()) < column:
                break
            lines[below] = None
    return "\n".join(line for line in lines if line is not None)
