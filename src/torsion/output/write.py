"""Writes a report so that a failed or killed run leaves the earlier one whole."""

import os
import secrets
import shutil
from collections.abc import Collection, Mapping
from dataclasses import replace
from datetime import date
from pathlib import Path

from torsion.errors import Fault, InputError
from torsion.findings import Findings
from torsion.output.document import Document, document
from torsion.output.renderers import OUTPUTS, Content, files
from torsion.output.reports import REPORTS
from torsion.output.results_json import SERIES


def write(
    findings: Findings, folder: str | Path, report: str = "solve", *,
    also: Collection[str] = (), today: date | None = None,
) -> Document:  # fmt: skip
    """Write every file of a report into the folder, `also` those of outputs on request; the report.

    Raises OSError where the folder cannot be written, InputError where a file cannot be made of these findings: after
    all others are written, where it is one on request.
    """
    made = document(findings, today or date.today(), also, REPORTS[report])
    Path(folder).mkdir(parents=True, exist_ok=True)
    faults: list[Fault] = []
    placed = write_texts(files(made, findings, also, faults), folder)
    for pattern in ("table-[0-9]*.csv", "input.yaml"):
        for earlier in Path(folder).glob(f"{made.report.stem}-{pattern}"):
            if earlier not in placed:
                earlier.unlink(missing_ok=True)  # of an earlier report, of which a table or the input was long
    if faults:
        raise InputError([replace(one, message=f"{one.message}; all other files are written") for one in faults])
    return made


def redraw(document: Document, folder: str | Path, *, also: Collection[str] = ()) -> None:
    """Write every file that a report alone makes, `also` those of outputs on request.

    Raises OSError where the folder cannot be written, InputError where the report cannot be drawn.
    """
    try:
        OUTPUTS["terminal"](document)
        contents = files(document, also=also)
    except (ArithmeticError, LookupError, RuntimeError, TypeError, ValueError) as error:
        message = f"the report cannot be drawn: {type(error).__name__}, {error}"
        raise InputError([Fault((), message, "solve the scene again")]) from None
    write_texts(contents, folder)


def write_texts(contents: Mapping[str, Content], folder: str | Path) -> list[Path]:
    """Write contents under their names into the folder, all or none; raises OSError where it cannot be written.

    Every file is finished in a temporary folder inside the target before the first is put in its place.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    workshop = target / f".report-{secrets.token_hex(4)}"  # named first: a signal may come as soon as it is made
    try:
        workshop.mkdir(mode=0o700)
        finished = [path for name, content in contents.items() for path in _finished(workshop / name, content)]
        placed = [Path(shutil.move(path, target / path.name)) for path in finished]
        names = {path.name for path in placed}
        if SERIES not in names and any(name.endswith(".json") for name in names):
            (target / SERIES).unlink(missing_ok=True)  # of an earlier report
        return placed
    finally:
        shutil.rmtree(workshop, ignore_errors=True)


def _finished(path: Path, content: Content) -> list[Path]:
    """The files of a content, after all of them are on the disk."""
    if callable(content):
        made = content(path)
    else:
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
        made = [path]
    for one in made:
        with one.open("rb+") as file:
            os.fsync(file.fileno())
    return made
