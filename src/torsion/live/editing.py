"""What the editor of `torsion live --edit` requests: the text read as it is typed, and saved into the scene's file.

A file is written whole or not at all, and never over what has changed meanwhile: whoever writes says what was read.
"""

import hashlib
import os
import re
import shutil
import tempfile
from collections.abc import Mapping
from functools import cache
from typing import Any

from torsion.errors import InputError
from torsion.user_files import LARGEST_SCENE, read_file

Answer = dict[str, Any]  # with `refused`, in words, where nothing was written
CHANGED = "the file has changed on the disk meanwhile: nothing was written"
NOT_IN_TEXT = (
    "the value does not stand in the text of this file by itself (but in a table, a case, or once for several): "
    "nothing was written"
)
MARK = "\ufeff"  # with which some editors begin a file


def opened(file: str) -> Answer:
    """The text of the file with line feeds, what it was read from, and its faults."""
    content, text = _content(file)
    plain = re.sub(r"\r\n?", "\n", text.removeprefix(MARK))
    return {"text": plain, "of": _digest(content), "keys": _keys(), **faults(file, text)}


def faults(file: str, text: str) -> Answer:
    """The faults of a text in place of that of the file, each with its place; all of them in words."""
    from torsion.schema.scene_reader import parse

    try:
        parse(text, file)
    except InputError as error:
        found = [{"line": one.line, "column": one.column, "text": one.message + (f" ({one.hint})" if one.hint else "")}
                 for one in error.faults if not one.file]  # fmt: skip
        return {"faults": found, "words": str(error)}
    return {"faults": [], "words": ""}


def saved(file: str, text: str, of: str) -> Answer:
    """The text written in place of that which was read, with its line ends; faulty or not."""
    content, before = _content(file)
    if _digest(content) != of:
        return {"refused": CHANGED}
    line_end = "\r\n" if "\r\n" in before else "\n"
    return _written(file, re.sub(r"\r\n?|\n", lambda _: line_end, text), before)


def put(file: str, positions: Mapping[str, float], of: str, case: str | None) -> Answer:
    """The figures of moved sliders written into the text of the file."""
    from torsion.live.sliders import text_with
    from torsion.schema.scene_reader import parse, reread
    from torsion.schema.variation import movable

    content, before = _content(file)
    if _digest(content) != of:
        return {"refused": CHANGED}
    if case is not None:
        return {"refused": NOT_IN_TEXT}
    try:
        study = parse(before, file)
        return _written(file, text_with(movable(study, *reread(study)), positions), before)
    except InputError as error:
        return {"refused": str(error)}
    except LookupError:
        return {"refused": NOT_IN_TEXT}


def _content(file: str) -> tuple[bytes, str]:
    """Raises OSError, or ValueError of what is no text."""
    content = read_file(file, LARGEST_SCENE)
    return content, content.decode()


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


def _written(file: str, text: str, before: str) -> Answer:
    """Beside the file first, and then in its place: a reader sees the one or the other."""
    path = os.path.realpath(file)
    content = (MARK * before.startswith(MARK) + text.removeprefix(MARK)).encode()
    number, beside = tempfile.mkstemp(prefix=".", suffix=".new", dir=os.path.dirname(path))
    try:
        with open(number, "wb") as stream:
            stream.write(content)
        shutil.copymode(path, beside)
        os.replace(beside, path)
    except BaseException:
        os.unlink(beside)
        raise
    return {"of": _digest(content)}


@cache
def _keys() -> dict[str, list[str]]:
    from torsion.schema.json_schema import json_schema

    return keys(json_schema())


def keys(schema: Mapping[str, Any]) -> dict[str, list[str]]:
    """The keys that may stand below every key of a scene; below "" those of its top level."""
    found: dict[str, set[str]] = {}
    seen = set[tuple[str, str]]()

    def walk(under: str, part: Any) -> None:
        if not isinstance(part, dict):
            return
        if "$ref" in part:
            name = str(part["$ref"]).rpartition("/")[2]
            if (under, name) in seen:
                return
            seen.add((under, name))
            part = schema["$defs"][name]
        for key, inner in part.get("properties", {}).items():
            found.setdefault(under, set()).add(key)
            walk(key, inner)
        for one in (
            part.get("items"),
            part.get("additionalProperties"),
            *(one for kind in ("anyOf", "oneOf", "allOf", "prefixItems") for one in part.get(kind, ())),
        ):
            walk(under, one)

    walk("", schema)
    return {key: sorted(each) for key, each in found.items()}
