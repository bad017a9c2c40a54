"""A report as it is kept in results.json: drawn from it again, it is the same to the last byte.

What is read is checked against the types of the report and against a checksum of the whole file; nothing of it is
executed.
"""

import json
import re
from collections.abc import Iterable
from hashlib import sha256
from pathlib import Path
from typing import Any, get_args

import torsion
from torsion.errors import Fault, InputError, printable
from torsion.output.blocks import Block
from torsion.output.document import Document
from torsion.output.figures.figure import Picture
from torsion.output.reports import FILES, KEY, REPORTS
from torsion.output.stored_data import Arrays, plain, restored
from torsion.user_files import LARGEST_RESULTS, read_file

FORMAT = 1
WRITES = "`torsion solve` writes results.json, from which it is drawn"
HEAD = re.compile(r'\{"format":\d+,"program":"[^"]*","sha256":"([0-9a-f]{64})","content":')
MARK, END = f',\n"{KEY}": ', "\n}\n"  # before and behind the report in its file
NAMED_CLASSES = frozenset((*get_args(Block), *get_args(Picture)))  # of which a field may hold any
CONTROL = re.compile(
    r"(?<!\\)(?:\\\\)*\\(?:u00|b|f)|[\x7f-\x84\x86-\x9f\ud800-\udfff]"
)  # in JSON text of no report
NAMED = f',\n"{FILES}": '  # before the line with the files of the report


def stored(document: Document, before: str = "") -> str:
    """Return the report as JSON text on one line; `before`: the SHA-256 of what stands before it in its file."""
    arrays = Arrays()
    written = plain(document, arrays, NAMED_CLASSES)
    content = _text({"document": written, "arrays": arrays.kept})
    head = _text(
        {"format": FORMAT, "program": torsion.__version__, "sha256": _checksum(before + content)}
    )
    return f'{head[:-1]},"content":{content}}}'


def _text(values: Any) -> str:
    return json.dumps(values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _checksum(text: str) -> str:
    return sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def file_at(path: Path) -> Path:
    """Return the file of results itself, or the results.json of a folder."""
    return path / REPORTS["solve"].files["json"] if path.is_dir() else path


def opened(path: Path) -> Document:
    """Return the report that a file of results, or the results.json of a folder, holds; raises InputError."""
    file = file_at(path)
    try:
        text = read_file(file, LARGEST_RESULTS).decode()
    except (OSError, UnicodeDecodeError) as error:
        raise _refused(
            file, f"cannot be read: {getattr(error, 'strerror', None) or 'it is not UTF-8 text'}"
        ) from None
    try:
        data = json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        location = (
            f" (line {error.lineno}, column {error.colno})"
            if isinstance(error, json.JSONDecodeError)
            else ""
        )
        raise _refused(file, f"is not JSON{location}") from None
    return _restored(file, text, data.get(KEY) if isinstance(data, dict) else None)


def named(file: Path) -> set[str]:
    """Return the files that a file of results names; empty if it is a symbolic link or its checksum does not hold."""
    try:
        text = "" if file.is_symlink() else file.read_bytes().decode()
        before, _, kept_text = text.rpartition(MARK)
        head = HEAD.match(kept_text)
        if (
            not head
            or _checksum(_checksum(before) + kept_text[head.end() :].removesuffix("}" + END))
            != head[1]
        ):
            return set()
        names = json.loads(before.rpartition(NAMED)[2])
    except (OSError, ValueError, RecursionError):
        return set()
    return {name for name in names if isinstance(name, str)}


def naming(text: str, names: Iterable[str]) -> str:
    """Return the text of a file of results with these names of files, and with its checksum."""
    before, mark, kept_text = text.rpartition(MARK)
    if not mark:
        return text  # a report without results
    before = before.rpartition(NAMED)[0] + NAMED + json.dumps(sorted(names))
    kept = json.loads(kept_text.removesuffix(END))
    kept["sha256"] = _checksum(_checksum(before) + _text(kept["content"]))
    return before + MARK + _text(kept) + END


def _before(text: str, kept: object) -> str:
    """Return the SHA-256 of what stands before the report, which stands last; '' if nothing does."""
    before, mark, kept_text = text.rpartition(MARK)
    return _checksum(before) if mark and kept_text == _text(kept) + END else ""


def _no_number(word: str) -> None:
    raise ValueError(word)


def _restored(file: Path, text: str, kept: object) -> Document:
    """Return the report from what stands under its key in the text."""
    if not isinstance(kept, dict) or not isinstance(kept.get("format"), int):
        raise _refused(file, f"holds no report (key `{KEY}`), as what `--json` prints does not")
    writer = f"torsion {printable(str(kept.get('program')), 20)}"
    if kept["format"] > FORMAT:
        reader = f"this is torsion {torsion.__version__}, which reads format {FORMAT}"
        raise _refused(
            file,
            f"holds a report in format {kept['format']} of {writer}; {reader}",
            "install that version",
        )
    content = kept.get("content")
    try:
        content_text = _text(content)
        checksum = _checksum(_before(text, kept) + content_text)
        if kept["format"] < 1 or not isinstance(content, dict) or checksum != kept.get("sha256"):
            again = "solve the scene again"
            raise _refused(
                file, "holds a report that is damaged or was changed after it was written", again
            )
        if CONTROL.search(content_text):
            raise ValueError("its texts have control characters")
        made = restored(Document, content.get("document"), _arrays(content.get("arrays")))
        made.report  # noqa: B018  its name is one of REPORTS
    except (ValueError, TypeError, LookupError, RecursionError) as error:
        message = (
            f"holds a report of {writer} that is none to torsion {torsion.__version__}: {error}"
        )
        raise _refused(
            file, message, "draw it with that version, or solve the model file again"
        ) from None
    return made


def _arrays(kept: object) -> Arrays:
    if not isinstance(kept, list):
        raise ValueError("it has no list of arrays")
    return Arrays(kept)


def _refused(file: Path, what: str, hint: str = WRITES) -> InputError:
    return InputError([Fault((), f"{file} {what}", hint)], f"{file} {what} ({hint})")
