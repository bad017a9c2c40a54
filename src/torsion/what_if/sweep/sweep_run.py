"""A sweep: variants of the file in chunks; frequencies side by side where the train allows it, verdicts one by one."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray
from torsion.findings import Work
from torsion.processes import processors
from torsion.sources import source
from torsion.study import Variation
from torsion.what_if.sweep.sweep_results import (
    Grid,
    GridAxis,
    SobolIndex,
    Sweep,
    SweptCheck,
    Turn,
    VariedFigure,
)
from torsion.what_if.sweep.sweep_settings import Points, SweepSettings
from torsion.what_if.variants.chunks import (
    Answers,
    Chunk,
    Key,
    Pace,
    Part,
    chunks,
    duration,
    joined,
    solved,
)
from torsion.what_if.variants.frequencies import frequencies
from torsion.what_if.variants.laws import LEVEL, SCRAMBLES, probability

MOST_REPORTED = 100_000  # variants, each of which has its numbers among the results


def grid_of(
    variation: Variation,
    points: Points,
    checks: Sequence[SweptCheck],
    frequency: FloatArray,
    faults: Mapping[int, str],
) -> Grid | None:
    """The grid with its answers; None of samples, and of a very large one."""
    count = points.samples
    if points.method != "grid" or count > MOST_REPORTED:
        return None
    axes = list[GridAxis]()
    for column in range(len(points.shape)):
        figures = [figure for figure in variation.figures if figure.column == column]
        rows = zip(*(figure.all_values().tolist() for figure in figures), strict=True)
        words = tuple(
            ", ".join(figure.words(value) for figure, value in zip(figures, row, strict=True))
            for row in rows
        )
        in_file = None if np.isnan(figures[0].in_file) else float(figures[0].in_file)
        names = tuple(figure.name for figure in figures)
        number, unit = figures[0].numbers
        axes.append(GridAxis(names, words, number, unit, in_file))

    # Behind the checks stands a row without a limit: of a grid without checks nothing is known.
    used = np.array([*(check.utilisation for check in checks), np.full(count, np.nan)])
    fails = np.any(
        [*(check.fails for check in checks), np.isin(range(count), list(faults))], axis=0
    )
    greatest = np.fmax.reduce(used, axis=0)
    decisive = np.argmax(np.nan_to_num(used, nan=-np.inf), axis=0)
    decisive[np.isnan(greatest)] = -1

    # Of a curve, neighbours of which one keeps the limit and the other does not.
    turns = list[Turn]()
    for position, check in enumerate(checks if len(axes) == 1 and axes[0].is_numeric else ()):
        for k in np.flatnonzero(np.diff(check.fails)).tolist():
            pair = [k, k + 1] if check.fails[k + 1] else [k + 1, k]
            kept, failing = axes[0].number[pair].tolist()
            low, high = check.utilisation[pair].tolist()
            between = None
            if low <= 1.0 < high < np.inf:
                between = kept + (1.0 - low) / (high - low) * (failing - kept)
            turns.append(Turn(position, kept, failing, between))
    why = tuple(sorted(faults.items()))
    return Grid(tuple(axes), frequency, used[:-1], greatest, decisive, fails, tuple(turns), why)


LEAST_SPREAD = 1e-9  # relative: below it an answer does not vary, and nothing decides


@source("Saltelli2010")
@source("Jansen1999")
def sobol_indices(points: Points, answers: Answers) -> tuple[SobolIndex, ...]:
    """Of every frequency and share of a limit that all variants have; nothing of one that does not vary."""
    names = [
        ", ".join(figure.name for figure in points.figures if figure.column == column)
        for column in range(len(points.shape))
    ]
    quantities = {f"mode {mode}": hertz for mode, hertz in enumerate(answers.frequency, start=1)}
    quantities |= {
        f"{key[1]}: {key[2]}, {key[3]}": used for key, (used, _) in answers.checks.items()
    }
    indices = []
    for words, values in quantities.items():
        if not np.isfinite(values).all() or np.ptp(values) <= LEAST_SPREAD * np.abs(values).max():
            continue
        value, error = estimated(values.reshape(points.sets, points.samples))
        indices += [
            SobolIndex(words, name, *np.column_stack([value[:, k], error[:, k]]).ravel().tolist())
            for k, name in enumerate(names)
        ]
    return tuple(indices)


def estimated(values: FloatArray) -> tuple[FloatArray, FloatArray]:
    """First and total indices (2, figures), and half of their 95 % intervals.

    values: (2 + figures, samples) of the sets A, B, and A with each column of B; first indices after Saltelli et al.
    (2010), total ones after Jansen (1999). The interval is Student's t over the sequences left out one after another
    (jackknife).
    """
    from scipy.special import stdtrit

    sequences = values.reshape(len(values), SCRAMBLES, -1)
    left_out = np.stack([_indices(np.delete(sequences, k, axis=1)) for k in range(SCRAMBLES)])
    spread = np.sqrt((SCRAMBLES - 1) * left_out.var(axis=0))
    return _indices(sequences), float(stdtrit(SCRAMBLES - 1, 0.5 + LEVEL / 2.0)) * spread


def _indices(values: FloatArray) -> FloatArray:
    """(2, figures) from values (2 + figures, ...)."""
    first, second, *mixed = (answers.ravel() - values[:2].mean() for answers in values)
    variance = np.concatenate([first, second]).var()
    return np.array(
        [
            [np.mean(second * (answers - first)) / variance for answers in mixed],
            [np.mean((first - answers) ** 2) / (2.0 * variance) for answers in mixed],
        ]
    )


MOST_FAULTS = 10


def summed(
    variation: Variation,
    settings: SweepSettings,
    points: Points,
    factor: FloatArray,
    nominal: FloatArray,
    answers: Answers,
) -> Sweep:
    """Statistics of what all variants (variants, figures) gave; nominal: frequencies of the file (modes,) Hz."""
    indices = () if points.sets == 1 else sobol_indices(points, answers)
    # Statistics are of the first set; those behind it, mixed of two, are for the indices alone.
    count = points.samples
    factor, frequency = factor[:count], answers.frequency[:, :count]
    faults = {variant: why for variant, why in answers.faults.items() if variant < count}
    names = [figure.name for figure in variation.figures]
    unsolved = np.isin(range(count), list(faults))
    checks = [
        _check(key, used[:count], fails[:count] | unsolved, factor, names, points.method)
        for key, (used, fails) in answers.checks.items()
    ]
    checks.sort(key=lambda check: (-check.probability, -(check.worst or 0.0)))
    any_check = None
    if checks:
        used = np.fmax.reduce([check.utilisation for check in checks])
        fails = np.any([check.fails for check in checks], axis=0)
        any_check = _check(("", "", "", "any check"), used, fails, factor, names, points.method)
    solved = frequency[:, np.isfinite(frequency).all(axis=0)] if frequency.size else frequency
    solved = solved if solved.size else np.full((len(nominal), 1), np.nan)
    low, high = np.quantile(solved, (0.025, 0.975), axis=1)
    figures = (
        VariedFigure(
            figure.name,
            figure.law.words,
            figure.column + 1,
            None if figure.law.is_relative else "row" if figure.rows else figure.law.unit,
        )
        for figure in variation.figures
    )
    return Sweep(
        tuple(figures),
        count,
        points.method,
        settings.seed,
        len(faults),
        tuple(dict.fromkeys(faults.values()))[:MOST_FAULTS],
        nominal,
        solved.mean(axis=1),
        solved.std(axis=1),
        low,
        high,
        solved.min(axis=1),
        solved.max(axis=1),
        tuple(checks),
        any_check,
        indices,
        grid_of(variation, points, checks, frequency, faults),
        factor,
        frequency,
        settings.fail_at_most,
    )


def _check(
    key: Key,
    used: FloatArray,
    fails: BoolArray,
    factor: FloatArray,
    names: Sequence[str],
    method: str,
) -> SweptCheck:
    share, low, high = probability(fails, method)
    finite = used[np.isfinite(used)]
    decides, correlation = _decides(used, factor)
    middle, best, worst = (
        float(statistic(finite)) if finite.size else None
        for statistic in (np.median, np.min, np.max)
    )
    return SweptCheck(
        *key,
        int(fails.sum()),
        share,
        None if method == "grid" else low,
        None if method == "grid" else high,
        middle,
        best,
        worst,
        names[decides] if correlation is not None else "",
        correlation,
        used,
        fails,
    )


def _decides(used: FloatArray, factor: FloatArray) -> tuple[int, float | None]:
    """The figure whose ranks go most with those of the share of a limit, and how much (Spearman 1904)."""
    is_finite = np.isfinite(used)
    values = used[is_finite]
    if values.size < 3 or np.ptp(values) <= LEAST_SPREAD * np.abs(values).max():
        return 0, None
    share = _ranks(values)
    ranks = np.column_stack([_ranks(column) for column in factor[is_finite].T])
    size = np.sqrt((ranks**2).sum(axis=0) * (share @ share))
    # 0: it takes one value alone.
    correlation = np.divide(share @ ranks, size, out=np.zeros(len(size)), where=size > 0.0)
    best = int(np.argmax(np.abs(correlation)))
    return best, float(correlation[best])


def _ranks(values: FloatArray) -> FloatArray:
    """(samples,) rank of each about the mean of all; of equal values the mean of their ranks.

    >>> _ranks(np.array([3.0, 1.0, 3.0, 2.0]))
    array([ 1. , -1.5,  1. , -0.5])
    """
    _, rank, count = np.unique(values, return_inverse=True, return_counts=True)
    return (np.cumsum(count) - count / 2.0 - len(values) / 2.0)[rank]


JUDGED_AT_ONCE, FREQUENCIES_AT_ONCE = 16, 16384  # variants of a chunk that is kept
MOST_CHUNKS = 4096  # of variants that are judged


def run(work: Work) -> None:
    """Where the file was read with figures that vary, and has modes or rules."""
    settings = work.settings("sweep", SweepSettings)
    variation, modes = work.study.variations.get("sweep"), work.get(Modes)
    if variation is None or work.solve is None:
        work.log.without("sweep", "no parameter of the file varies")
        return
    points = Points.from_settings(work.study, settings, variation.figures)
    with work.log.step("sweep", "the file names it") as step:
        nominal = np.empty(0) if modes is None else modes.frequency
        count, length = points.count, FREQUENCIES_AT_ONCE
        if settings.judges(work.study):
            # Chunks follow from the file alone; where nobody keeps them one takes what fits the memory.
            length = max(JUDGED_AT_ONCE, count // MOST_CHUNKS) if work.answered else count
            seconds = count * sum(line.seconds for line in work.log.lines) / processors()
            work.progress(f"sweep, every variant solved separately: {duration(seconds)}", 0.0)
        parts = (work.answered or in_turn)(work, variation, chunks(count, length))
        values, answers = joined(count, nominal.size, parts)
        step.method, step.size = answers.method, points.words
    work.put(sweep=summed(variation, settings, points, values, nominal, answers))


def answered(work: Work, variation: Variation, chunk: Chunk) -> Part:
    """The values of a chunk and what they answer; nothing is put into the work."""
    settings, modes = work.settings("sweep", SweepSettings), work.get(Modes)
    points = Points.from_settings(work.study, settings, variation.figures)
    values = points.values(slice(chunk.begin, chunk.end))
    count = 0 if modes is None else modes.frequency.size
    if not settings.judges(work.study):
        return values, frequencies(work, variation, values, count)
    answers = solved(work, variation, values, count, judged=True)
    answers.method = "every variant solved and judged separately"
    return values, answers


def in_turn(work: Work, variation: Variation, parts: Sequence[Chunk]) -> Iterator[Part]:
    """The answers of chunks, one after another in this process."""
    pace = Pace(parts[-1].end, work.progress)
    for chunk in parts:
        # The progress of one chunk as that of all.
        part_of_all = lambda _, share, size=chunk.size: pace.show(share * size)  # noqa: E731
        yield answered(replace(work, progress=part_of_all), variation, chunk)
        pace.solved += chunk.size
        pace.show()
