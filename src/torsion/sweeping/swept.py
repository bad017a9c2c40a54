"""What the command `torsion sweep` does: a scene solved as always, the variants of its sweep kept and shared out."""

from collections.abc import Callable
from pathlib import Path

from torsion.commands import OTHER_FOLDER, folder_of, one_case
from torsion.errors import Fault, InputError
from torsion.findings import Findings, Progress, silent
from torsion.runner import run
from torsion.schema.scene_reader import located, read
from torsion.sweeping.cluster import Workplace, check_workplace, unprotected
from torsion.sweeping.sweeper import Stopped, Sweeper


def swept(
    file: str | Path,
    out: str | Path | None = None,
    *,
    workplace: Workplace = Workplace(),  # noqa: B008 - frozen
    fresh: bool = False,
    csv: bool = False,
    case: str | None = None,
    progress: Progress = silent,
    notice: Callable[[str], object] = print,
) -> Findings:
    """Read, solve and judge a scene as `commands.solved`; what its variants answer is kept in `out` as it comes.

    Parts that are there are not solved again; `fresh`: they are removed first. workplace: who answers the chunks. csv:
    all variants as a table too. notice: is given what the user should know. Raises InputError, also where the file
    names no sweep or the parts are of another one, and SolveError.
    """
    check_workplace(workplace)
    scene = read(file)
    study = scene if case is None else one_case(scene, case)
    if not any("sweep" in each_study.variations for each_study in (study, *study.cases.values())):
        hint = "`analyses: {sweep: {vary: {disc-1.inertia: {uniform: 5 %}}}}`"
        raise located(InputError([Fault(("analyses",), "the file names no sweep", hint)]), study)
    if warning := unprotected(workplace):
        notice(warning)
    folder = folder_of(file, out, study.case)
    sweeper = Sweeper(folder, workplace, fresh, csv)
    try:
        findings = run(study, progress=progress, answered=sweeper)
    except Stopped as stopped:
        raise stopped.error from None
    except OSError as error:
        message = f"the parts cannot be written to {folder}: {error.strerror or error}"
        raise InputError([Fault((), message)], message + OTHER_FOLDER) from None
    if sweeper.kept:
        notice(f"{sweeper.kept} of {sweeper.kept + sweeper.solved} parts were there already")
    return findings
