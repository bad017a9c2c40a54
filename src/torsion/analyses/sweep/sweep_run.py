"""A sweep: variants of the file in chunks, side by side where the train allows it, else each by itself."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.sweep.sweep_settings import CHECKED, SweepSettings
from torsion.analyses.sweep.sweep_summary import summed
from torsion.analyses.undamped_modes import Modes
from torsion.analyses.variants.chunks import Chunk, Pace, Part, chunks, duration, joined
from torsion.analyses.variants.judged_together import can_be_together, judged_together
from torsion.analyses.variants.one_by_one import Answers, solved
from torsion.analyses.variants.sampling import units
from torsion.analyses.variants.side_by_side import side_by_side
from torsion.arrays import FloatArray
from torsion.findings import Work
from torsion.study import Variation

UNJUDGED = 16384  # variants of frequencies alone
JUDGED_AT_ONCE, ALONE_AT_ONCE, TOGETHER_AT_ONCE = 16, 1024, 65536  # variants of a chunk: about a second
VERDICTS_AT_ONCE = 4096  # variants judged side by side
MOST = 4096  # chunks of variants that are judged by themselves


def run(work: Work) -> None:
    """Where the file was read with figures that vary, and has modes or rules."""
    study, settings = work.study, work.settings("sweep", SweepSettings)
    variation, modes = study.variations.get("sweep"), work.get(Modes)
    if variation is None or work.solve is None:
        work.log.without("sweep", "no figure of the file varies")
        return
    if not study.rules and "checks" in settings.results:
        work.log.without("the probability that a check fails", "the file names no rules")
    with work.log.step("sweep", "the file names it") as step:
        nominal = np.empty(0) if modes is None else modes.frequency
        each = chunks_of(work, variation)
        if is_judged(work) and each[0].size < VERDICTS_AT_ONCE:  # else side by side, which takes no time to speak of
            seconds = each[-1].end * sum(line.seconds for line in work.log.lines)
            work.progress(f"sweep, every variant solved by itself: {duration(seconds)}", 0.0)
        parts = (work.answered or in_turn)(work, variation, each)
        values, answers = joined(each[-1].end, nominal.size, parts)
        step.method = answers.method
        step.size = f"{len(values)} variants ({settings.method}) of {len(variation.figures)} figures"
    work.put(sweep=summed(variation, settings, values, nominal, answers))


def chunks_of(work: Work, variation: Variation) -> tuple[Chunk, ...]:
    """The chunks of a sweep, which follow from its file alone: last digits of answers side by side follow from it.

    Variants that are solved one by one do not, and where nobody keeps them they stay one chunk.
    """
    settings, judged = work.settings("sweep", SweepSettings), is_judged(work)
    count = settings.samples or (CHECKED if judged else UNJUDGED)
    if judged:
        few = draw(variation, settings, Chunk(0, 0, 2), count)
        by_itself = max(JUDGED_AT_ONCE, count // MOST)
        return chunks(count, VERDICTS_AT_ONCE if can_be_together(work, variation, few) else by_itself)
    if work.answered is None and count <= TOGETHER_AT_ONCE:
        return chunks(count, count)
    few = draw(variation, settings, Chunk(0, 0, 2), count)
    return chunks(count, ALONE_AT_ONCE if _together(work, variation, few) is None else TOGETHER_AT_ONCE)


def is_judged(work: Work) -> bool:
    """Variants answer checks."""
    settings = work.settings("sweep", SweepSettings)
    return "checks" in settings.results or (not settings.results and bool(work.study.rules))


def draw(variation: Variation, settings: SweepSettings, chunk: Chunk, count: int) -> FloatArray:
    """Values (variants, figures) of a chunk of the `count` variants, whatever the others are."""
    columns = 1 + max(one.column for one in variation.figures)
    drawn = units(count, columns, settings.method, settings.seed, slice(chunk.begin, chunk.end))
    return np.stack([one.at(drawn[:, one.column]) for one in variation.figures], axis=1)


def answer(work: Work, variation: Variation, values: FloatArray) -> Answers:
    """What variants (variants, figures) answer; nothing is put into the work."""
    judged, modes = is_judged(work), work.get(Modes)
    count = 0 if modes is None else modes.frequency.size
    frequency = None if judged else _together(work, variation, values)
    if frequency is not None:
        return Answers(frequency, method="frequencies of all variants side by side, each certified by counts")
    together, how = judged_together(work, variation, values, count) if judged else (None, "")
    if together is None:
        together = solved(work, variation, values, count, judged=judged)
        how = f"every variant solved and judged by itself: {how}" if judged else "every variant solved by itself"
    together.method = how
    return together


def in_turn(work: Work, variation: Variation, each: Sequence[Chunk]) -> Iterator[Part]:
    """The answers of chunks, one after another in this process."""
    settings, pace = work.settings("sweep", SweepSettings), Pace(each[-1].end, work.progress)
    for chunk in each:
        values = draw(variation, settings, chunk, each[-1].end)
        yield values, answer(replace(work, progress=pace.within(chunk)), variation, values)
        pace.finish(chunk)


def _together(work: Work, variation: Variation, values: FloatArray) -> FloatArray | None:
    modes = work.get(Modes)
    return None if modes is None else side_by_side(work.system, variation, values, modes.frequency.size)
