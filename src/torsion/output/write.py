"""Writes a report so that a failed or killed run leaves the earlier one whole."""

import os
import secrets
import shutil
from collections.abc import Collection, Mapping
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

    That of every case with an answer goes into a folder of its own there, without its results, which stand among all.

    Raises OSError where the folder cannot be written, InputError where a file cannot be made of these findings.
    """
    made = document(findings, today or date.today(), also, REPORTS[report])
    Path(folder).mkdir(parents=True, exist_ok=True)
    contents = files(made, findings, also)
    for found in findings.cases.values():
        if found.is_answered and found.study.case is not None:
            page = document(found, today or date.today(), also, REPORTS[report])
            own = files(page, found, also, without=("json",))
            contents |= {f"{found.study.case.folder}/{name}": content for name, content in own.items()}
    placed = write_texts(contents, folder)
    for one in {path.parent for path in placed}:
        _clear(made, one, placed)
    return made


def _clear(made: Document, folder: Path, placed: Collection[Path]) -> None:
    """Take away what is left there of an earlier report: of long tables, a long input, or a case solved alone."""
    stem, of_a_case = made.report.stem, (made.report.files.get("json", f"{made.report.stem}.json"), SERIES)
    is_case = not any(path.parent == folder and path.suffix == ".json" for path in placed)
    for pattern in (f"{stem}-table-[0-9]*.csv", f"{stem}-input.yaml", *(of_a_case if is_case else ())):
        for earlier in folder.glob(pattern):
            if earlier not in placed:
                earlier.unlink(missing_ok=True)


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

    A name may begin with a folder: `warm/report.html`.

    Every file is finished in a temporary folder inside the target before the first is put in its place.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    workshop = target / f".report-{secrets.token_hex(4)}"  # named first: a signal may come as soon as it is made
    try:
        workshop.mkdir(mode=0o700)
        finished = [path for name, content in contents.items() for path in _finished(workshop / name, content)]
        for one in {(target / name).parent for name in contents}:
            one.mkdir(exist_ok=True)
        placed = [Path(shutil.move(path, target / path.relative_to(workshop))) for path in finished]
        for one in {path.parent for path in placed if path.suffix == ".json"}:
            if one / SERIES not in placed:
                (one / SERIES).unlink(missing_ok=True)  # of an earlier report
        return placed
    finally:
        shutil.rmtree(workshop, ignore_errors=True)


def _finished(path: Path, content: Content) -> list[Path]:
    """The files of a content, after all of them are on the disk."""
    path.parent.mkdir(exist_ok=True)
    if callable(content):
        made = content(path)
    else:
        path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
        made = [path]
    for one in made:
        with one.open("rb+") as file:
            os.fsync(file.fileno())
    return made
