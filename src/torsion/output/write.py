"""Writes a report so that a failed or killed run leaves the earlier one whole."""

import errno
import os
import re
import secrets
import shutil
from collections.abc import Collection, Iterable, Mapping
from dataclasses import replace
from datetime import UTC, date, datetime
from functools import partial
from pathlib import Path, PurePosixPath

from torsion.errors import Fault, InputError, refusal
from torsion.findings import Findings
from torsion.output.document import Document, document
from torsion.output.renderers import OUTPUTS, Content, files
from torsion.output.reports import REPORTS, Report
from torsion.output.stored.results_json import SERIES
from torsion.output.stored.scene import curve_files
from torsion.output.stored.stored_report import names_in, naming
from torsion.primitives import SectionMesh
from torsion.study import Study


def write(
    findings: Findings,
    folder: str | Path,
    report: str = "solve",
    *,
    also: Collection[str] = (),
    today: date | None = None,
    is_full: bool = False,
) -> Document:
    """Write every file of a report into the folder, `also` those of outputs on request; return the report.

    That of every case with an answer goes into a folder of its own there, without its results, which stand among all.
    What an earlier report of its sort wrote there, and this one does not, is removed. Raises OSError where the folder
    cannot be written, InputError where a file is one of the scene's, or cannot be made of these findings: after all
    others are written, where it is one on request.
    """
    today = today or report_date()
    page = document(findings, today, REPORTS[report], is_full=is_full)
    # Below it no symbolic link is followed to remove a file.
    folder = Path(os.path.realpath(folder))
    folder.mkdir(parents=True, exist_ok=True)
    faults: list[Fault] = []
    contents = files(page, findings, also, faults)
    read, folders = inputs(findings.study), [folder]
    for case in findings.cases.values():
        if case.is_answered and case.study.case is not None:
            case_folder = case.study.case.folder
            case_page = document(case, today, REPORTS[report], is_full=is_full)
            case_files = files(case_page, case, also, faults, without=("json",))
            contents |= {f"{case_folder}/{name}": content for name, content in case_files.items()}
            folders.append(folder / case_folder)
            read += inputs(case.study)

    # A case may have been solved separately before.
    earlier = {path for target in folders for path in earlier_files(target, page.report)}
    placed = write_texts(contents, folder, read)
    for path in earlier.difference(placed):
        if not _is_among(path, read):
            path.unlink()
    if faults:
        end = "; all other files are written"
        raise InputError([replace(fault, message=fault.message + end) for fault in faults])
    return page


def write_place(findings: Findings, place: str | Path) -> list[Path]:
    """Write a report into a folder, or the one file of it that a name with a suffix stands for; return the paths.

    Raises OSError where nothing can be written, InputError for a suffix that no file of a report has.
    """
    target = Path(place)
    if not target.suffix or target.is_dir():
        write(findings, target)
        return sorted(target / name for name in names_in(target / "results.json"))
    outputs = {output.suffix: output for output in OUTPUTS.values() if output.suffix[:1] == "."}
    if target.suffix not in outputs:
        raise refusal(
            f"no file of a report ends in '{target.suffix}'",
            f"a folder, or a name with {', '.join(outputs)}",
        )
    content = outputs[target.suffix](document(findings, report_date()), findings)
    if content is None:
        raise refusal(f"these findings have nothing for a file '{target.suffix}'")
    return write_texts({target.name: content}, target.parent, inputs(findings.study))


def report_date() -> date:
    """Return today, or the day of SOURCE_DATE_EPOCH (seconds, UTC) for a reproducible report."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    return datetime.fromtimestamp(int(epoch), UTC).date() if epoch.isdecimal() else date.today()


def earlier_files(folder: Path, report: Report) -> set[Path]:
    """Return the files of an earlier report in the folder, by its results: only names that a report can have.

    Nothing is found behind a symbolic link, nor if the results were changed after they were written.
    """
    names = {output.file_of(name, report) for name, output in OUTPUTS.items() if output.suffix}
    family = re.compile(
        rf"figure-[\w.-]+\.csv|motion(-[\w.-]+)?\.csv|{report.stem}-(table-[\w.]+\.csv|input\.yaml)"
    )
    paths = set()
    for relative in map(PurePosixPath, names_in(folder / OUTPUTS["json"].file_of("json", report))):
        *case, name = relative.parts or ("",)
        is_ours = (name in {*names, SERIES} or family.fullmatch(name)) and len(case) <= 1
        path = folder / relative
        is_link = path.is_symlink() or path.parent.is_symlink()
        if is_ours and ".." not in case and path.is_file() and not is_link:
            paths.add(path)
    return paths


def inputs(study: Study) -> list[Path]:
    """Return every file that a scene was read from."""
    folder, bars = Path(study.file).parent, study.train.bars
    names = [name for name, _ in study.tables] + curve_files(study)
    if study.document is not None and study.document.logo:
        names.append(study.document.logo)
    if "transient" in study.analyses:
        from torsion.analyses.motion.events.transient_settings import cases

        events = (event for motion, _ in cases(study) for event in motion.events)
        tables = (getattr(event, "table", None) for event in events)
        names += [table.file for table in tables if table is not None and table.file]
    meshes = [Path(bar.section.file) for bar in bars if isinstance(bar.section, SectionMesh)]
    return [Path(study.file), *(folder / name for name in names), *meshes] if study.file else meshes


def refuse_inputs(targets: Iterable[Path], read: Collection[Path]) -> None:
    """Raise InputError where a file to be written is one of those that were read, by whatever path."""
    for target in targets:
        if _is_among(target, read):
            message = f"{target} is a file that was read, and would be overwritten"
            raise refusal(message, "write to another place")


def _is_among(path: Path, files: Collection[Path]) -> bool:
    return path.exists() and any(file.exists() and path.samefile(file) for file in files)


def redraw(
    document: Document,
    folder: str | Path,
    *,
    also: Collection[str] = (),
    results: Path | None = None,
) -> None:
    """Write every file that a report alone makes, `also` those of outputs on request, and name them in its results.

    Raises OSError where the folder cannot be written, InputError where the report cannot be drawn, or the folder holds
    results that are not the file `results` of this report.
    """
    target = Path(folder) / OUTPUTS["json"].file_of("json", document.report)
    read = [] if results is None else [results]
    is_beside = _is_among(target, read)
    if read and target.exists() and not is_beside:
        raise refusal(
            f"{target} holds the results of another report", "choose another folder with -o"
        )
    try:
        contents = files(document, also=also)
    except (ArithmeticError, LookupError, RuntimeError, TypeError, ValueError) as error:
        message = f"the report cannot be drawn: {type(error).__name__}, {error}"
        raise InputError([Fault((), message, "solve the scene again")]) from None
    if is_beside:
        contents[target.name] = partial(_name_files, target)
    write_texts(contents, folder, [] if is_beside else read)


def _name_files(results: Path, target: Path) -> list[Path]:
    """Write the results with the names of the finished files next to the target, unless they name them already."""
    known_names = names_in(results)
    names = known_names.union(os.listdir(target.parent))
    if names == known_names:
        return []
    target.write_bytes(naming(results.read_bytes().decode(), names).encode())
    return [target]


def write_texts(
    contents: Mapping[str, Content], folder: str | Path, read: Collection[Path] = ()
) -> list[Path]:
    """Write contents under their names into the folder, all or none; files of results last.

    A name may begin with a folder: `warm/report.html`. Every file is finished in a temporary folder inside the target
    before the first is put in its place. Raises OSError where the folder cannot be written, InputError where a file is
    one of those `read`.
    """
    target = Path(folder)
    target.mkdir(parents=True, exist_ok=True)
    # The folder is named first: a signal may come as soon as it is made.
    workshop = target / f".report-{secrets.token_hex(4)}"
    try:
        workshop.mkdir(mode=0o700)
        ordered = sorted(contents.items(), key=lambda item: item[0].endswith(".json"))
        finished = list[Path]()
        for name, content in ordered:
            path = workshop / name
            path.parent.mkdir(exist_ok=True)
            if callable(content):
                finished += content(path)
            else:
                path.write_bytes(content if isinstance(content, bytes) else content.encode("utf-8"))
                finished.append(path)
        targets = [target / path.relative_to(workshop) for path in finished]
        refuse_inputs(targets, read)
        if any(path.is_dir() for path in targets):  # a file would be moved into it
            raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR))
        for parent in {path.parent for path in targets}:
            parent.mkdir(exist_ok=True)
        return [Path(shutil.move(*pair)) for pair in zip(finished, targets, strict=True)]
    finally:
        shutil.rmtree(workshop, ignore_errors=True)
