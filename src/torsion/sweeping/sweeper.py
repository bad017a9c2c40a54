"""Answers the chunks of a sweep from the parts of its folder, and solves those that are not there yet."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from torsion.commands import OTHER_FOLDER, folder_of
from torsion.errors import Fault, InputError, SolveError, refusal
from torsion.findings import Findings, Progress, Work, silent
from torsion.processes import shared_out
from torsion.runner import one_case, run
from torsion.schema.scene_reader import located, read
from torsion.study import Variation
from torsion.sweeping.cluster import Workplace, answers_of_workers, check_workplace, unprotected
from torsion.sweeping.sweep_folder import SweepFolder, alone, identity
from torsion.sweeping.worker_task import errand
from torsion.what_if.sweep.sweep_run import answered
from torsion.what_if.variants.chunks import Chunk, Pace, Part


class Stopped(Exception):
    """The sweep cannot go on, because of an error; it ends the command, and is no analysis without an answer."""


@dataclass
class Sweeper:
    """What `run` takes as `answered`: the parts of each case in a folder of its own."""

    folder: Path
    workplace: Workplace = Workplace()  # noqa: RUF009 - frozen
    fresh: bool = False
    csv: bool = False
    kept: int = 0  # parts that were there
    solved: int = 0
    begun: set[Path] = field(default_factory=set)

    def __call__(self, work: Work, variation: Variation, chunks: Sequence[Chunk]) -> Iterator[Part]:
        """The parts of a sweep in the order of its chunks, after all are there; raises Stopped."""
        case = work.study.case
        sweep_folder = SweepFolder(self.folder if case is None else self.folder / case.folder)
        is_new = sweep_folder.folder not in self.begun
        self.begun.add(sweep_folder.folder)
        try:
            with alone(sweep_folder.folder):
                sweep_folder.open(identity(work, variation, chunks), fresh=self.fresh and is_new)
                left = [chunk for chunk in chunks if sweep_folder.part_path(chunk) is None]
                self.kept += is_new * (len(chunks) - len(left))

                # The chunks that are not there are solved, each written as soon as it is answered.
                count = chunks[-1].end
                pace = Pace(count, work.progress, count - sum(chunk.size for chunk in left))
                if self.workplace.is_elsewhere and left:
                    pairs = answers_of_workers(
                        self.workplace,
                        errand(work, variation),
                        left,
                        lambda words: work.progress(words, pace.kept / count),
                    )
                else:
                    answer_of = partial(answered, replace(work, progress=silent), variation)
                    answers = shared_out(answer_of, left, fewest=2, most=self.workplace.processes)
                    pairs = zip(left, answers, strict=True)
                for chunk, part in pairs:
                    sweep_folder.write(chunk, variation, part)
                    self.solved += 1
                    pace.solved += chunk.size
                    pace.show()
                if self.csv and is_new:
                    sweep_folder.write_csv(chunks)
                yield from map(sweep_folder.read, chunks)
        except (InputError, SolveError) as error:
            raise Stopped(error) from None


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
    """Read, solve and judge a scene as `runner.solved`; what its variants answer is kept in `out` as it comes.

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
        raise stopped.args[0] from None
    except OSError as error:
        message = f"the parts cannot be written to {folder}: {error.strerror or error}"
        raise refusal(message, OTHER_FOLDER) from None
    if sweeper.kept:
        notice(f"{sweeper.kept} of {sweeper.kept + sweeper.solved} parts were there already")
    return findings
