"""Verdicts of many variants side by side, by the rules' own clauses at the speeds of all of them.

Variants of which a share of a limit lies too near to 1, or a response is not ok, are left to be solved by themselves,
and so are a few of the others, which have to say the same.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from torsion.analyses.variants.one_by_one import Answers, Key, solved
from torsion.analyses.variants.variant_shares import Swept, swept, unfit
from torsion.arrays import BoolArray, FloatArray
from torsion.findings import Progress, Work, silent
from torsion.kernels.variant_response import vertex
from torsion.study import Variation

MARGIN = 5e-3  # of a limit: over three times what was missed of a share beyond its error in 432 random trains
ROUGH = 0.05  # error of a share from which its variant is solved by itself
COLUMNS = 2**15  # variants times speeds at once
VALUES = 2**20  # variants times speeds, harmonic components and spans at once
POINTS = 2**10  # speeds of a variant, at most in most trains
COMPARED = 8  # variants that are solved by themselves as well


def judged_together(
    work: Work, variation: Variation, values: FloatArray, modes: int
) -> tuple[Answers | None, str]:
    """The answers of all variants, and how they were found; None, and why, where they have to be solved one by one."""
    train = _train(work, variation, values)
    if isinstance(train, str):
        return None, train
    if train.displaces(train.enters.factors(values)):
        return None, "damping moves a resonance by more than its width"
    tried = judged_of(train, values, modes, work.progress)
    answers, left, compared = tried.answers, tried.left, tried.some(COMPARED)
    if not compared:
        return None, "every variant is near a limit, or its shafts are divided otherwise"
    alone = solved(work, variation, values[compared], modes, judged=True)
    if not tried.agrees(alone, compared):
        return None, "a few of the variants do not say the same side by side"
    difference = tried.largest_difference(
        alone, compared
    )  # before those left take the places of what was tried
    answers.standing |= alone.standing
    places = np.flatnonzero(left).tolist()
    for used, fails in answers.checks.values():
        used[places], fails[places] = np.nan, False
    solved(work, variation, values, modes, judged=True, known=answers, places=places)
    return answers, (
        f"judged side by side; {len(places)} variants near a limit solved separately. For {len(compared)} variants, "
        f"also solved separately, the utilisations differ by at most {difference:.1e}; for the others the difference "
        "is unknown"
    )


def can_be_together(work: Work, variation: Variation, values: FloatArray) -> bool:
    """Whether variants like these (variants, figures) can be tried side by side."""
    return isinstance(_train(work, variation, values), Swept)


def _train(work: Work, variation: Variation, values: FloatArray) -> Swept | str:
    """The train with how figures enter it; or why the variants (variants, figures) cannot be tried side by side."""
    return (
        unfit(work)
        or swept(work, variation, values)
        or "a figure enters neither as a power nor as a share of a sum"
    )


@dataclass(frozen=True)
class Tried:
    """Answers side by side; the error (variants,) of each clause's shares, and which variants are left (variants,)."""

    answers: Answers
    errors: dict[Key, FloatArray]
    left: BoolArray

    def some(self, count: int) -> list[int]:
        """Places of so many variants that are not left, from the first to the last."""
        sure = np.flatnonzero(~self.left)
        return (
            sure[sorted({k * (len(sure) - 1) // (count - 1) for k in range(count)})].tolist()
            if sure.size
            else []
        )

    def agrees(self, alone: Answers, places: Sequence[int]) -> bool:
        """What the variants at `places` say side by side is what they say `alone`, as far as they are not left."""
        answers, sure = self.answers, ~self.left[places]
        if alone.faults or sure[list(alone.partly)].any():
            return False
        count = len(self.left)  # what no variant says in one way, those left may say in the other
        none = np.full(count, np.nan), np.zeros(count, dtype=np.bool_)
        for key in alone.checks.keys() | answers.checks.keys():
            own, error = (
                answers.checks.get(key, none),
                self.errors.get(key, np.zeros(count))[places],
            )
            used, fails = alone.checks.get(key, tuple(one[: len(places)] for one in none))
            mine, theirs = own[0][places][sure], used[sure]
            near = (MARGIN + 2.0 * error[sure]) * np.abs(theirs)
            close = np.isnan(mine) & np.isnan(theirs) | (np.abs(mine - theirs) <= near)
            if not close.all() or (own[1][places] != fails)[sure].any():
                return False
        known = np.isfinite(alone.frequency) & sure
        return np.allclose(
            answers.frequency[:, places][known], alone.frequency[known], rtol=1e-12, atol=0.0
        )

    def largest_difference(self, alone: Answers, places: Sequence[int]) -> float:
        """Largest relative difference of a share of the variants at `places` from what it is `alone`."""
        shared = self.answers.checks.keys() & alone.checks.keys()
        pairs = ((self.answers.checks[key][0][places], alone.checks[key][0]) for key in shared)
        known = (
            (side_by_side, share)
            for side_by_side, share in pairs
            if np.isfinite(share).all() and share.all()
        )
        return max((float(np.abs(one / share - 1.0).max()) for one, share in known), default=0.0)


def judged_of(train: Swept, values: FloatArray, modes: int, progress: Progress = silent) -> Tried:
    """The answers of variants (variants, figures) of a train."""
    count = len(values)
    answers, left = Answers.unknown(modes, count), np.zeros(count, dtype=np.bool_)
    errors = dict[Key, FloatArray]()
    for part, frequency, found in _chunks(train, values, modes):
        factor = train.enters.factors(values[part])
        answers.frequency[: len(frequency), part] = frequency[:modes] / (2.0 * np.pi)
        for key, (used, fails, error) in found.lines.items():
            whole = answers.check(key)
            whole[0][part], whole[1][part] = used, fails
            errors.setdefault(key, np.zeros(count))[part] = error
        left[part] = (
            found.left | train.displaces(factor) | train.is_divided_otherwise(factor, frequency)
        )
        progress(f"{part.stop} of {count} variants side by side", part.stop / count)
    return Tried(answers, errors, left)


@dataclass(frozen=True)
class _Chunk:
    """Verdicts of some variants: by clause utilisation, fails and error (variants,); and which are left."""

    lines: dict[Key, tuple[FloatArray, BoolArray, FloatArray]]
    left: BoolArray


def _chunks(
    train: Swept, values: FloatArray, modes: int
) -> Iterator[tuple[slice, FloatArray, _Chunk]]:
    """Variants in order with their frequencies (modes, variants) rad/s."""
    columns = min(COLUMNS, VALUES // (len(train.found) * len(train.spans)))
    few = values[:1] if len(values) * POINTS > columns else values
    (speed, frequency), begin = train.grid(factor := train.enters.factors(few), modes), 0
    while begin < len(values):
        part = slice(begin, min(begin + max(1, columns // speed.shape[1]), len(values)))
        if part != slice(0, len(few)):
            factor = train.enters.factors(values[part])
            speed, frequency = train.grid(factor, modes)
        begin = part.stop
        yield part, frequency, _verdicts(train, speed, factor)


def _verdicts(train: Swept, speed: FloatArray, factor: FloatArray) -> _Chunk:
    """Of one chunk; where each clause's highest share stands between the speeds, it is computed there too."""
    at = train.shares(speed, factor)
    fine, place, _ = vertex(speed, at.share)
    coarse = vertex(speed[:, ::2], at.share[:, :, ::2])[0]
    there = train.shares(place.T, factor)
    row = np.arange(len(at.keys))
    used = np.fmax(at.share.max(axis=2), there.share[row, :, row])
    with np.errstate(all="ignore"):
        error = np.where(used > 0.0, np.abs(np.stack([fine, coarse]) / used - 1.0).max(axis=0), 0.0)
    error[at.unlimited] = 0.0
    is_sure = (np.abs(used - 1.0) > MARGIN + 2.0 * error * used) & (error < ROUGH)
    is_sure &= (used < 1.0) | ~at.if_kept[:, None]
    lines = dict[Key, tuple[FloatArray, BoolArray, FloatArray]]()
    for k, key in enumerate(at.keys):
        own = np.where(at.unlimited[k], np.nan, used[k]), used[k] > 1.0, error[k]
        if key in lines:
            same = lines[key]
            own = np.fmax(same[0], own[0]), same[1] | own[1], np.fmax(same[2], own[2])
        lines[key] = own
    return _Chunk(lines, ~(is_sure | at.unlimited).all(axis=0) | at.unclear | there.unclear)
