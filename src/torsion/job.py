"""A file to its findings and its report: what the command does."""

from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np

from torsion.errors import Fault, InputError
from torsion.findings import Findings, run
from torsion.schema.read import located, read

JOINT_RULES = ("universal-joints",)
REST = ("everything but the joints", "`torsion joint` tells of the joints alone; `torsion solve` does the rest")
ELSEWHERE = ("natural frequencies", "damped modes", "response over speed", "critical speeds", "mean torque", "rules")


def solve(
    file: str | Path,
    out: str | Path | None = None,
    *,
    pdf: bool = False,
    vtu: bool = False,
    progress: Callable[[str, float], None] | None = None,
) -> Findings:
    """Read, solve and judge a scene; write its report into `out` (default: reports/<scene>/ beside where you stand).

    Raises InputError with every fault of the file, SolveError where no answer has the promised accuracy; an earlier
    report stays whole then. With `vtu` the mode shapes are written too, as a surface, and pictured.
    """
    findings = run(read(file), progress=progress)
    write(findings, folder_of(file, out), pdf=pdf, vtu=vtu)
    return findings


def folder_of(file: str | Path, out: str | Path | None) -> Path:
    """Where the report of a scene goes."""
    return Path(out) if out is not None else Path("reports") / Path(file).stem


def write(findings: Findings, folder: Path, *, pdf: bool = False, vtu: bool = False) -> list[Path]:
    """Write report and results; raises InputError where the folder cannot be written or `vtu` has no mode to draw."""
    from torsion.report.write import write as write_report

    try:
        return write_report(findings, folder, pdf=pdf, vtu=vtu)
    except OSError as error:
        raise _unwritable(folder, error) from None
    except InputError as error:
        raise located(error, findings.study) from None


def _unwritable(folder: Path, error: OSError) -> InputError:
    message = f"the report cannot be written to {folder}: {error.strerror or error}"
    return InputError([Fault((), message)], f"{message} (choose another folder with -o)")


def joint(file: str | Path, *, turns: int | None = None) -> Findings:
    """Read a scene and compute its joints alone, with the rules that judge them; nothing is written.

    `turns` takes the place of the file's own. Raises InputError, also where the train has no joint, and SolveError.
    """
    from torsion.analyses.joints import Asked

    study = read(file)
    if all(part.component.keyword != "joint" for part in study.train.parts):
        fault = Fault(("train",), "the train has no joint", "`torsion joint` tells of joints; use `torsion solve`")
        raise located(InputError([fault]), study)
    settings = study.analyses.get("joints") or Asked()
    if turns is not None:
        settings = settings.model_copy(update={"turns": turns})
    rules = tuple((name, asked) for name, asked in study.rules if name in JOINT_RULES)
    findings = run(replace(study, analyses={"joints": settings}, rules=rules))
    mine = tuple(pair for pair in findings.plan.left_out if pair[0] not in ELSEWHERE)
    return replace(findings, plan=replace(findings.plan, left_out=(REST, *mine)))


def write_joints(findings: Findings, folder: Path) -> list[Path]:
    """Write joints.html, joints.json and joints.csv; raises InputError where the folder cannot be written."""
    from torsion.report.joint_pages import write_joints as write_pages

    try:
        return write_pages(findings, folder)
    except OSError as error:
        raise _unwritable(folder, error) from None


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
