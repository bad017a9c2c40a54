"""Answers the chunks of a sweep from the parts of its folder, and solves those that are not there yet."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.study import Variation
from torsion.sweeping.cluster import Workers
from torsion.sweeping.folder_lock import alone
from torsion.sweeping.sweep_folder import SweepFolder, identity
from torsion.sweeping.worker_task import errand
from torsion.what_if.sweep.sweep_run import answered
from torsion.what_if.variants.chunks import Chunk, Pace, Part


class Stopped(Exception):
    """The sweep cannot go on; it ends the command, and is no analysis without an answer."""

    def __init__(self, error: InputError | SolveError) -> None:
        super().__init__(str(error))
        self.error = error


@dataclass
class Sweeper:
    """What `run` takes as `answered`: the parts of each case in a folder of its own."""

    folder: Path
    workers: Workers | None = None  # None: this process alone
    fresh: bool = False
    csv: bool = False
    notice: Callable[[str], object] = print
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
            with alone(sweep_folder.folder, self.notice):
                sweep_folder.open(identity(work, variation, chunks), fresh=self.fresh and is_new)
                self.kept += (
                    sum(sweep_folder.part_path(chunk) is not None for chunk in chunks)
                    if is_new
                    else 0
                )
                self._complete(sweep_folder, work, variation, chunks)
                if self.csv and is_new:
                    sweep_folder.write_csv(chunks)
                yield from map(sweep_folder.read, chunks)
        except (InputError, SolveError) as error:
            raise Stopped(error) from None

    def _complete(
        self, sweep_folder: SweepFolder, work: Work, variation: Variation, chunks: Sequence[Chunk]
    ) -> None:
        """Solve the chunks that are not there, each written as soon as it is answered."""
        left = [chunk for chunk in chunks if sweep_folder.part_path(chunk) is None]
        pace = Pace(
            chunks[-1].end, work.progress, chunks[-1].end - sum(chunk.size for chunk in left)
        )
        for chunk, part in self._answers(work, variation, left, pace):
            sweep_folder.write(chunk, variation, part)
            self.solved += 1
            pace.finish(chunk)

    def _answers(
        self, work: Work, variation: Variation, left: Sequence[Chunk], pace: Pace
    ) -> Iterator[tuple[Chunk, Part]]:
        if self.workers is not None and left:
            share = pace.kept / pace.count
            yield from self.workers.answers(
                errand(work, variation), left, lambda words: work.progress(words, share)
            )
            return
        for chunk in left:
            yield chunk, answered(replace(work, progress=pace.within(chunk)), variation, chunk)
