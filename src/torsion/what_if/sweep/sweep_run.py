"""A sweep: variants of the file in chunks; frequencies side by side where the train allows it, verdicts one by one."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.findings import Work
from torsion.processes import processors
from torsion.study import Variation
from torsion.what_if.sweep.sweep_points import Points
from torsion.what_if.sweep.sweep_settings import SweepSettings
from torsion.what_if.sweep.sweep_summary import summed
from torsion.what_if.variants.chunks import Chunk, Pace, Part, chunks, duration, joined
from torsion.what_if.variants.frequencies import frequencies
from torsion.what_if.variants.one_by_one import solved

JUDGED_AT_ONCE, FREQUENCIES_AT_ONCE = 16, 16384  # variants of a chunk that is kept
MOST_CHUNKS = 4096  # of variants that are judged


def run(work: Work) -> None:
    """Where the file was read with figures that vary, and has modes or rules."""
    settings = work.settings("sweep", SweepSettings)
    variation, modes = work.study.variations.get("sweep"), work.get(Modes)
    if variation is None or work.solve is None:
        work.log.without("sweep", "no parameter of the file varies")
        return
    points = _points(work, variation)
    with work.log.step("sweep", "the file names it") as step:
        nominal = np.empty(0) if modes is None else modes.frequency
        count, length = points.count, FREQUENCIES_AT_ONCE
        if settings.judges(work.study):
            # Chunks follow from the file alone; where nobody keeps them one takes what fits the memory.
            length = max(JUDGED_AT_ONCE, count // MOST_CHUNKS) if work.answered else count
        all_chunks = chunks(count, length)
        if settings.judges(work.study):
            seconds = (
                all_chunks[-1].end * sum(line.seconds for line in work.log.lines) / processors()
            )
            work.progress(f"sweep, every variant solved separately: {duration(seconds)}", 0.0)
        parts = (work.answered or in_turn)(work, variation, all_chunks)
        values, answers = joined(all_chunks[-1].end, nominal.size, parts)
        step.method, step.size = answers.method, points.words
    work.put(sweep=summed(variation, settings, points, values, nominal, answers))


def answered(work: Work, variation: Variation, chunk: Chunk) -> Part:
    """The values of a chunk and what they answer; nothing is put into the work."""
    values = _points(work, variation).values(slice(chunk.begin, chunk.end))
    modes = work.get(Modes)
    count = 0 if modes is None else modes.frequency.size
    if not work.settings("sweep", SweepSettings).judges(work.study):
        return values, frequencies(work, variation, values, count)
    answers = solved(work, variation, values, count, judged=True)
    answers.method = "every variant solved and judged separately"
    return values, answers


def in_turn(work: Work, variation: Variation, parts: Sequence[Chunk]) -> Iterator[Part]:
    """The answers of chunks, one after another in this process."""
    pace = Pace(parts[-1].end, work.progress)
    for chunk in parts:
        yield answered(replace(work, progress=pace.within(chunk)), variation, chunk)
        pace.finish(chunk)


def _points(work: Work, variation: Variation) -> Points:
    return Points.from_settings(
        work.study, work.settings("sweep", SweepSettings), variation.figures
    )
