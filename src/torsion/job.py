"""A file to its findings and its report: what the command does."""

from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from torsion.errors import Fault, InputError
from torsion.findings import Findings, run
from torsion.schema.read import read


def solve(
    file: str | Path,
    out: str | Path | None = None,
    *,
    pdf: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Findings:
    """Read, solve and judge a scene; write its report into `out` (default: reports/<scene>/ beside where you stand).

    Raises InputError with every fault of the file, SolveError where no answer has the promised accuracy; an earlier
    report stays whole then.
    """
    findings = run(read(file), progress=progress)
    write(findings, folder_of(file, out), pdf=pdf)
    return findings


def folder_of(file: str | Path, out: str | Path | None) -> Path:
    """Where the report of a scene goes."""
    return Path(out) if out is not None else Path("reports") / Path(file).stem


def write(findings: Findings, folder: Path, *, pdf: bool = False) -> list[Path]:
    """Write report and results; raises InputError where the folder cannot be written."""
    from torsion.report.write import write as write_report

    try:
        return write_report(findings, folder, pdf=pdf)
    except OSError as error:
        message = f"the report cannot be written to {folder}: {error.strerror or error}"
        raise InputError([Fault((), message)], f"{message} (choose another folder with -o)") from None


def write_matrices(findings: Findings, file: Path) -> None:
    """Write J, K and C in free coordinates as .npz; raises InputError where the file cannot be written."""
    from torsion.assembly.matrices import matrices

    view = matrices(findings.system)
    try:
        with file.open("wb") as target:
            arrays: dict[str, Any] = {key: np.asarray(value) for key, value in asdict(view).items()}
            np.savez(target, **arrays)
    except OSError as error:
        message = f"the matrices cannot be written to {file}: {error.strerror or error}"
        raise InputError([Fault((), message)], message) from None
