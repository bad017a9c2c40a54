"""The text of a file with other values at some places, all else of it, comments too, as it was written."""

from collections.abc import Iterable
from contextlib import suppress
from operator import itemgetter
from typing import Any

from torsion.analyses import VARYING
from torsion.errors import InputError, Path
from torsion.schema.scene_tables import with_tables
from torsion.schema.yaml_source import in_brackets, parse_source, yaml_text
from torsion.user_files import Node, Source, line_starts

Edit = tuple[int, int, str]  # from, to, what stands there instead
LIBRARY = {"from", "size"}  # of a coupling whose row is written out


def edited(
    source: Source, changes: Iterable[tuple[Path, Node]], gone: Iterable[Path], expected: Any
) -> str:
    """The text with values put in, and without what stands at the paths `gone`.

    expected: what the file then says, but for what varies figures. Where the text cannot be changed in its places (a
    value stands in a table, or is repeated by an alias), all that the file says is written anew; so is a
    case, without the other cases.
    """
    with suppress(LookupError, InputError):
        text, edits, added = source.text, list[Edit](), dict[Path, dict[str, Any]]()
        for path, new in changes:
            if source.at(path) is None:
                added.setdefault(path[:-1], {})[str(path[-1])] = new.value
                continue
            node = _own_node(source, path)
            edits.append((node.begin, node.end, in_brackets(new.value)))
        for path, keys in added.items():
            node = _own_node(source, path)
            entries = [f"{key}: {in_brackets(value)}" for key, value in keys.items()]
            behind, begin = f"{text}\n".index("\n", node.end), "\n" + " " * (node.column - 1)
            written = "".join(begin + entry for entry in entries)
            if node.is_flow:
                behind, written = node.end - 1, ", " * bool(node.parts) + ", ".join(entries)
            edits.append((behind, behind, written))
        edits += [_removal(source, path) for path in gone if source.at(path)]
        # From the last to the first; of several at one place the first stands first.
        for start, end, written in sorted(edits, key=itemgetter(0), reverse=True):
            text = text[:start] + written + text[end:]
        if _plain(_read(text, source).data) == _plain(expected):
            return text
    is_case = _read(source.text, source).data != source.data
    return yaml_text(
        _written_out({key: expected[key] for key in expected if not (is_case and key == "cases")})
    )


def _read(text: str, source: Source) -> Source:
    """A text with the tables of a source."""
    return with_tables(
        parse_source(text, source.name), {name: table.text for name, table in source.tables}
    )


def _plain(data: Any) -> Any:
    """What a file says without what varies figures."""
    analyses = {
        key: value for key, value in (data.get("analyses") or {}).items() if key not in VARYING
    }
    return {**data, "analyses": analyses}


def _written_out(value: Any) -> Any:
    """Without the names of libraries whose rows stand there."""
    if isinstance(value, dict):
        keys = value.keys() - LIBRARY if value.keys() > LIBRARY else value.keys()
        return {key: _written_out(value[key]) for key in value if key in keys}
    return [_written_out(item) for item in value] if isinstance(value, list) else value


def _own_node(source: Source, path: Path) -> Node:
    """What stands at a path of the text itself; raises LookupError."""
    node = source.at(path)
    if node is None or node.source is not None:
        raise LookupError
    return node


def _removal(source: Source, path: Path) -> Edit:
    """Return the removal of what stands at a path with its key, and of a mapping that has nothing else."""
    parent, node = _own_node(source, path[:-1]), _own_node(source, path)
    if len(parent.parts) == 1 and len(path) > 1:
        return _removal(source, path[:-1])
    text, (line, column) = source.text, node.place
    line_start = line_starts(text)[line - 1]
    begin, end = line_start + column - 1, node.end
    if parent.is_flow:
        following = text[end:].lstrip()
        if following.startswith(","):
            return begin, len(text) - len(following[1:].lstrip()), ""
        return len(text[:begin].rstrip().removesuffix(",")), end, ""
    return line_start, min(f"{text}\n".index("\n", end) + 1, len(text)), ""
