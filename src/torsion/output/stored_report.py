"""A report as it is kept in results.json: drawn from it again, it is the same to the last byte.

What is read is checked against the types of the report and against its own checksum; nothing of it is executed.
"""

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import torsion
from torsion.errors import Fault, InputError, printable
from torsion.output.document import Document
from torsion.output.frozen_data import Arrays, DamagedDataError, form
from torsion.output.reports import KEY, REPORTS

FORMAT = 1
WRITES = "`torsion solve` writes results.json, from which it is drawn"


def stored(document: Document) -> str:
    """The report as JSON text on one line."""
    arrays = Arrays()
    written = form(Document).write(document, arrays)
    content = _text({"document": written, "arrays": arrays.kept})
    head = _text({"format": FORMAT, "program": torsion.__version__, "sha256": _checksum(content)})
    return f'{head[:-1]},"content":{content}}}'


def _text(values: Any) -> str:
    return json.dumps(values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))


def _checksum(text: str) -> str:
    return sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def opened(path: Path) -> Document:
    """The report that a file of results, or the results.json of a folder, holds; raises InputError."""
    file = path / REPORTS["solve"].files["json"] if path.is_dir() else path
    try:
        text = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise _refused(file, f"cannot be read: {getattr(error, 'strerror', None) or 'it is not UTF-8 text'}") from None
    try:
        data = json.loads(text, parse_constant=_no_number)
    except (ValueError, RecursionError) as error:
        place = f" (line {error.lineno}, column {error.colno})" if isinstance(error, json.JSONDecodeError) else ""
        raise _refused(file, f"is not JSON{place}") from None
    return _restored(file, data.get(KEY) if isinstance(data, dict) else None)


def _no_number(word: str) -> None:
    raise ValueError(word)


def _restored(file: Path, kept: object) -> Document:
    """The report from what stands under its key."""
    if not isinstance(kept, dict) or not isinstance(kept.get("format"), int):
        raise _refused(file, f"holds no report (key `{KEY}`), as what `--json` prints does not")
    by = f"torsion {printable(str(kept.get('program')), 20)}"
    if kept["format"] > FORMAT:
        here = f"this is torsion {torsion.__version__}, which reads format {FORMAT}"
        raise _refused(file, f"holds a report in format {kept['format']} of {by}; {here}", "install that version")
    content = kept.get("content")
    try:
        if kept["format"] < 1 or not isinstance(content, dict) or _checksum(_text(content)) != kept.get("sha256"):
            again = "solve the scene again"
            raise _refused(file, "holds a report that is damaged or was changed after it was written", again)
        made: Document = form(Document).read(content.get("document"), _arrays(content.get("arrays")))
        made.report  # noqa: B018  its name is one of REPORTS
    except (ValueError, TypeError, LookupError, RecursionError) as error:
        message = f"holds a report of {by} that is none to torsion {torsion.__version__}: {error}"
        raise _refused(file, message, "draw it with that version, or solve the scene again") from None
    return made


def _arrays(kept: object) -> Arrays:
    if not isinstance(kept, list):
        raise DamagedDataError("it has no list of arrays")
    return Arrays(kept)


def _refused(file: Path, what: str, hint: str = WRITES) -> InputError:
    return InputError([Fault((), f"{file} {what}", hint)], f"{file} {what} ({hint})")
