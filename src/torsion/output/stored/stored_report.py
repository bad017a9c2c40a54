"""A report as it is kept in results.json: drawn from it again, it is the same to the last byte.

What is read is checked against the types of the report and against a checksum of all results before it; nothing of it
is executed. The names of the files of the report stand behind it, as files may be added later.
"""

import json
import re
from collections.abc import Callable, Iterable
from functools import partial
from hashlib import sha256
from mmap import ACCESS_READ, mmap
from pathlib import Path
from typing import Any, get_args

import torsion
from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.blocks import Block
from torsion.output.document import Document
from torsion.output.figures.figure import Picture
from torsion.output.reports import REPORTS
from torsion.output.stored.results_json import END, KEYS, makers, write_json
from torsion.output.stored.stored_data import Arrays, plain, restored
from torsion.user_files import LARGEST_RESULTS, printable, read_file

FORMAT = 1
KEY = "report"  # of a report in a file of results
FILES = "files"  # key of the names of its files
WRITES = "`torsion solve` writes results.json, from which it is drawn"
HEAD = re.compile(r'\{"format":(\d+),"program":"([^"]*)","sha256":"([0-9a-f]{64})","content":')
# What stands before the report, before the names of its files, and behind them.
MARK, NAMED = f',\n"{KEY}": ', f',\n"{FILES}": '
# Classes of which a field may hold any.
NAMED_CLASSES = frozenset((*get_args(Block), *get_args(Picture)))
# In JSON text of no report; its first character alone is sought fast.
CONTROL = re.compile(
    r"[\\\x7f-\x84\x86-\x9f\ud800-\udfff](?:(?<!\\)|(?<!\\\\)(?:\\\\)*(?:u00|b|f))"
)


def rendered(document: Document, findings: Findings) -> Callable[[Path], list[Path]]:
    """Return a writer of the results and their report into a file, and of very long arrays into another beside it."""
    parts = makers(findings, KEYS.get(document.name, ()))
    return partial(write_json, parts, ending=partial(stored, document))


def stored(document: Document, before: str, names: Iterable[str]) -> str:
    """Return the last lines of a file of results: the report and names of files; `before`: the SHA-256 of all lines above."""
    arrays = Arrays()
    written = plain(document, arrays, NAMED_CLASSES)
    content = _text({"document": written, "arrays": arrays.kept})
    sha = _checksum(before + content)
    head = _text({"format": FORMAT, "program": torsion.__version__, "sha256": sha})
    return f'{MARK}{head[:-1]},"content":{content}}}{_named(names)}'


def _text(values: Any) -> str:
    return json.dumps(values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _named(names: Iterable[str]) -> str:
    return f"{NAMED}{json.dumps(sorted(names))}{END}"


def _checksum(text: str) -> str:
    return sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def file_at(path: Path) -> Path:
    """Return the file of results itself, or the results.json of a folder."""
    return path / REPORTS["solve"].files["json"] if path.is_dir() else path


def names_in(file: Path) -> set[str]:
    """Return the names of the files of a report from its results; none where they are behind a symbolic link.

    A pipe is not opened: it may wait for a writer.
    """
    if file.is_symlink() or not file.is_file():
        return set()
    mark = NAMED.encode()
    try:
        # Of a file of many MB only its end is read.
        with file.open("rb") as source, mmap(source.fileno(), 0, access=ACCESS_READ) as results:
            end = results[max(results.rfind(mark), 0) :]
        names = json.loads(end.removeprefix(mark).removesuffix(END.encode()))
    except (OSError, ValueError, RecursionError):
        return set()
    return {name for name in names if isinstance(name, str)} if isinstance(names, list) else set()


def naming(text: str, names: Iterable[str]) -> str:
    """Return the text of a file of results with these names of files."""
    return text.rpartition(NAMED)[0] + _named(names)


def opened(path: Path) -> Document:
    """Return the report that a file of results, or the results.json of a folder, holds; raises InputError."""
    file, again = file_at(path), "solve the scene again"
    try:
        text = read_file(file, LARGEST_RESULTS).decode()
    except (OSError, UnicodeDecodeError) as error:
        why = getattr(error, "strerror", None) or "it is not UTF-8 text"
        raise _refused(file, f"cannot be read: {why}", WRITES) from None

    before, _, kept = text.rpartition(NAMED)[0].rpartition(MARK)
    head = HEAD.match(kept)
    if head is None:
        raise _refused(file, f"holds no report (key `{KEY}`), as what `--json` prints does not")
    number, writer, reader = int(head[1]), f"torsion {printable(head[2], 20)}", torsion.__version__
    if number > FORMAT:
        message = f"holds a report in format {number} of {writer}; this is torsion {reader}"
        hint = "install that version"
        raise _refused(file, f"{message}, which reads format {FORMAT}", hint)
    content = kept[head.end() : -1]
    if _checksum(_checksum(before) + content) != head[3]:
        message = "holds a report that is damaged or was changed after it was written"
        raise _refused(file, message, again)

    if CONTROL.search(content):
        raise _refused(file, "holds a report whose texts have control characters", again)

    try:
        data = json.loads(content)
        document = restored(Document, data["document"], Arrays(data["arrays"]))
        document.report  # noqa: B018  its name is one of REPORTS
    except (ValueError, TypeError, LookupError, RecursionError):
        message = f"holds a report of {writer} with other parts than torsion {reader} draws here"
        raise _refused(file, message, f"draw it with what wrote it, or {again}") from None
    return document


def _refused(file: Path, what: str, hint: str = WRITES) -> InputError:
    return InputError([Fault((), f"{file} {what}", hint)], f"{file} {what} ({hint})")
