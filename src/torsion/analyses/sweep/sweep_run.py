"""A sweep: variants of the file in chunks, side by side where the train allows it, else each by itself."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.sweep.sweep_points import Points
from torsion.analyses.sweep.sweep_settings import SweepSettings
from torsion.analyses.sweep.sweep_summary import summed
from torsion.analyses.undamped_modes import Modes
from torsion.analyses.variants.chunks import Chunk, Pace, Part, chunks, duration, joined
from torsion.analyses.variants.judged_together import can_be_together, judged_together
from torsion.analyses.variants.one_by_one import Answers, solved
from torsion.analyses.variants.side_by_side import frequencies, together
from torsion.arrays import FloatArray
from torsion.findings import Work
from torsion.study import Variation

JUDGED_AT_ONCE, ALONE_AT_ONCE, TOGETHER_AT_ONCE = (
    16,
    1024,
    65536,
)  # variants of a chunk: about a second
VERDICTS_AT_ONCE = 4096  # variants judged side by side
MOST = 4096  # chunks of variants that are judged by themselves


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
        each = chunks_of(work, variation)
        if (
            settings.judges(work.study) and each[0].size < VERDICTS_AT_ONCE
        ):  # else it takes no time to speak of
            seconds = each[-1].end * sum(line.seconds for line in work.log.lines)
            work.progress(f"sweep, every variant solved separately: {duration(seconds)}", 0.0)
        parts = (work.answered or in_turn)(work, variation, each)
        values, answers = joined(each[-1].end, nominal.size, parts)
        step.method, step.size = answers.method, points.words
    work.put(sweep=summed(variation, settings, points, values, nominal, answers))


def chunks_of(work: Work, variation: Variation) -> tuple[Chunk, ...]:
    """The chunks of a sweep, which follow from its file alone: last digits of answers side by side follow from it.

    Variants that are solved one by one do not, and where nobody keeps them they stay one chunk.
    """
    judged, count = (
        work.settings("sweep", SweepSettings).judges(work.study),
        _points(work, variation).count,
    )
    few = _points(work, variation).values(slice(0, 2))
    if judged:
        by_itself = max(JUDGED_AT_ONCE, count // MOST)
        return chunks(
            count, VERDICTS_AT_ONCE if can_be_together(work, variation, few) else by_itself
        )
    if work.answered is None and count <= TOGETHER_AT_ONCE:
        return chunks(count, count)
    _, alone = together(work, variation, few, _modes(work))
    return chunks(count, ALONE_AT_ONCE if alone.size else TOGETHER_AT_ONCE)


def answered(work: Work, variation: Variation, chunk: Chunk) -> Part:
    """The values of a chunk and what they answer; nothing is put into the work."""
    values = _points(work, variation).values(slice(chunk.begin, chunk.end))
    return values, _answers(work, variation, values)


def _answers(work: Work, variation: Variation, values: FloatArray) -> Answers:
    """What variants (variants, figures) answer."""
    count = _modes(work)
    if not work.settings("sweep", SweepSettings).judges(work.study):
        return frequencies(work, variation, values, count)
    found, how = judged_together(work, variation, values, count)
    if found is None:
        found = solved(work, variation, values, count, judged=True)
        how = f"every variant solved and judged separately: {how}"
    found.method = how
    return found


def in_turn(work: Work, variation: Variation, each: Sequence[Chunk]) -> Iterator[Part]:
    """The answers of chunks, one after another in this process."""
    pace = Pace(each[-1].end, work.progress)
    for chunk in each:
        yield answered(replace(work, progress=pace.within(chunk)), variation, chunk)
        pace.finish(chunk)


def _points(work: Work, variation: Variation) -> Points:
    return Points.of(work.study, work.settings("sweep", SweepSettings), variation.figures)


def _modes(work: Work) -> int:
    """How many frequencies every variant has."""
    found = work.get(Modes)
    return 0 if found is None else found.frequency.size
