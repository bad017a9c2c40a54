"""Writes a report so that a failed or killed run leaves the earlier one whole."""

import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import date
from pathlib import Path

from torsion.findings import Findings


def write(
    findings: Findings, folder: str | Path, *, pdf: bool = False, vtu: bool = False, today: date | None = None
) -> list[Path]:
    """Write results.json, report.html and, if asked, report.pdf and modes.vtu into the folder; the paths of all.

    Every file is finished in a temporary folder beside the target before the first is put in its place. Raises
    OSError where the folder cannot be written, InputError where `vtu` is asked and there is no mode to draw.
    """
    from torsion.output.document import document
    from torsion.output.html import html
    from torsion.output.results_json import text

    target, made = Path(folder), document(findings, today or date.today(), also=("twisted_train",) if vtu else ())
    with _workshop(target) as workshop:
        finished = [_file(workshop / "results.json", text(findings)), _file(workshop / "report.html", html(made))]
        if pdf:
            from torsion.output.pdf import write_pdf

            finished.append(write_pdf(made, workshop))
        if vtu:
            from torsion.output.surface.vtu import write_vtu

            finished.append(write_vtu(findings, workshop))
        return [_placed(path, target / path.name) for path in finished]


def write_texts(texts: Mapping[str, str], folder: str | Path) -> list[Path]:
    """Write texts under their names into the folder, all or none; raises OSError where it cannot be written."""
    target = Path(folder)
    with _workshop(target) as workshop:
        finished = [_file(workshop / name, content) for name, content in texts.items()]
        return [_placed(path, target / path.name) for path in finished]


@contextmanager
def _workshop(target: Path) -> Iterator[Path]:
    """A folder inside the target, which is made where it is not there; taken away afterwards."""
    target.mkdir(parents=True, exist_ok=True)
    workshop = Path(tempfile.mkdtemp(prefix=".report-", dir=target))
    try:
        yield workshop
    finally:
        shutil.rmtree(workshop, ignore_errors=True)


def _file(path: Path, content: str) -> Path:
    with path.open("w", encoding="utf-8", newline="\n") as file:
        file.write(content)
        file.flush()
        os.fsync(file.fileno())
    return path


def _placed(source: Path, target: Path) -> Path:
    os.replace(source, target)
    return target
