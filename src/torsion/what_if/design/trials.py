"""Trials of a design: of every choice that is tried the aim, whether it keeps what it has to, its mass and cost."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from torsion.analyses import VARYING
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.study import Study, Variation
from torsion.train import Train
from torsion.what_if.design.design_settings import DesignSettings, Kept
from torsion.what_if.variants.frequencies import frequencies
from torsion.what_if.variants.one_by_one import (
    TO_BE_VERIFIED,
    Answer,
    Answers,
    Key,
    analyses_of_variant,
    solved,
)

FEWEST = 16  # trains of which the frequencies are found side by side
DIGITS = 6  # of the range of a figure, in which its values are chosen
SAME = 9  # decimals to which two scores are equal
WIDEST = 50.0  # margin of a check of which nothing is used; beyond that of any other
BROKEN, DOUBTFUL, WITHOUT = (
    -100.0,
    -200.0,
    -1000.0,
)  # condition broken; exceeded or not judged; no limit or no answer


@dataclass(frozen=True)
class Judged:
    """Of some variants, (variants,) each."""

    aim: FloatArray  # smallest margin, or minus |ln(f / aim)|; NaN where there is none
    score: FloatArray  # the same with penalties: the greater, the better
    allowed: BoolArray
    decides: tuple[Key | None, ...]
    frequency: FloatArray  # Hz, that is aimed at


@dataclass(frozen=True)
class Trial:
    """One choice that was tried."""

    values: tuple[float, ...]
    aim: float
    score: float
    is_allowed: bool
    decides: Key | None
    case: str  # with the aim; empty for the file as it stands
    worst: int  # sample with the aim; 0 is the file's own figures
    nominal_score: float  # at the file's own figures, and its worst case
    frequency: float
    mass: float
    cost: float


@dataclass(frozen=True)
class Case:
    """The file as it stands, or a case of it, with all that a choice puts in before."""

    study: Study
    work: Work
    variation: Variation  # of the figures that are chosen
    sampled: Variation  # and of those of the samples

    def answers(self, trials: "Trials", rows: FloatArray) -> Answers:
        """Of choices with samples (variants, figures)."""
        work = trials.shown(self.work)
        if not trials.judged:
            return frequencies(work, self.sampled, rows, trials.modes, least=FEWEST)
        return solved(work, self.sampled, rows, trials.modes, judged=True)


@dataclass
class Trials:
    """All choices that were tried so far."""

    work: Work
    settings: DesignSettings
    variation: Variation
    modes: int
    limit: int = 0  # choices at most
    cases: Mapping[str, Case] = field(
        default_factory=dict
    )  # that are judged, the file as it stands first
    sweep: Variation | None = None  # whose samples the worst is of
    samples: FloatArray = field(
        default_factory=lambda: np.empty((1, 0))
    )  # (samples, figures) of `sweep`
    done: dict[tuple[float, ...], Trial] = field(default_factory=dict)
    standing: dict[Key, str] = field(default_factory=dict)
    faults: dict[str, None] = field(default_factory=dict)
    unsolved: int = 0
    masses: dict[tuple[float, ...], float] = field(
        default_factory=dict
    )  # of the shafts, kg, by their figures

    @property
    def judged(self) -> bool:
        """The aim is a margin of checks."""
        return self.settings.target is None

    @property
    def best(self) -> list[Trial]:
        """From the best to the worst; of equals the lightest, or cheapest, first."""
        against = self.settings.against or "mass"
        return sorted(
            self.done.values(),
            key=lambda one: (-round(one.score, SAME), np.nan_to_num(getattr(one, against))),
        )

    def scores(self, values: FloatArray) -> FloatArray:
        """(variants,) of choices (variants, figures): the greater, the better; each is tried once."""
        keys = [self.rounded(row) for row in values.tolist()]
        new = [key for key in dict.fromkeys(keys) if key not in self.done]
        if new:
            self._try(np.array(new))
        return np.array([self.done[key].score for key in keys])

    def rounded(self, row: Sequence[float]) -> tuple[float, ...]:
        """Values of a range with so many digits as matter; rows of a list as they are."""
        return tuple(
            value if digits is None else round(value, digits)
            for value, digits in zip(row, self._digits, strict=True)
        )

    @cached_property
    def _digits(self) -> list[int | None]:
        return [
            None if one.places else DIGITS - int(np.floor(np.log10(one.law.width)))
            for one in self.variation.figures
        ]

    def _try(self, values: FloatArray) -> None:
        count, each = len(values), len(self.samples)
        rows = np.hstack([np.repeat(values, each, axis=0), np.tile(self.samples, (count, 1))])
        amounts = np.array([self.amounts(row) for row in values.tolist()])
        searched = self.searched
        found = [one.answers(self, rows) for one in searched.values()]
        judged = [
            self.judge(own, np.repeat(amounts, each, axis=0), of_case=bool(name))
            for name, own in zip(searched, found, strict=True)
        ]
        self.unsolved += len({place // each for own in found for place in own.faults})
        for name, own in zip(searched, found, strict=True):
            self.faults |= dict.fromkeys(_of_case(name, why) for why in own.faults.values())
            self.standing |= own.standing
        score = np.stack(
            [one.score.reshape(count, each) for one in judged], axis=1
        )  # (choices, cases, samples)
        worst = score.reshape(count, -1).argmin(axis=1)
        allowed = np.stack([one.allowed for one in judged]).all(axis=0).reshape(count, each)
        for k, row in enumerate(values.tolist()):
            case, sample = divmod(int(worst[k]), each)
            at, one = k * each + sample, judged[case]
            self.done[tuple(row)] = Trial(
                tuple(row),
                float(one.aim[at]),
                float(one.score[at]),
                bool(allowed[k].all()),
                one.decides[at],
                list(searched)[case],
                sample,
                float(score[k, :, 0].min()),
                float(judged[0].frequency[k * each]),
                float(amounts[k, 0]),
                float(amounts[k, 1]),
            )

    def judge(self, found: Answers, amounts: FloatArray, *, of_case: bool = False) -> Judged:
        """Aims and conditions of the answers; amounts (variants, 2): mass and cost of each.

        of_case: a frequency that is aimed at is that of the file as it stands, and a case may have no limit.
        """
        count, target = found.frequency.shape[1], self.settings.target
        unsolved = np.isin(np.arange(count), list(found.faults))
        decides: tuple[Key | None, ...] = (None,) * count
        frequency, doubtful = np.full(count, np.nan), np.zeros(count, dtype=np.bool_)
        if target is None:
            aim, decides, doubtful = self._margins(found, count)
            aim = np.where(of_case & ~unsolved & np.isnan(aim), WIDEST, aim)
        elif of_case:
            aim = np.full(count, WIDEST)
        else:
            frequency = found.frequency[target[0].mode - 1]
            aim = -np.abs(np.log(frequency / target[1]))
        broken = sum(
            (_broken(one, found.frequency, amounts) for one in self.settings.kept), np.zeros(count)
        )
        unknown = unsolved | ~np.isfinite(aim) | ~np.isfinite(broken)
        known = np.where(unknown, 0.0, aim)
        score = np.where(broken > 0.0, BROKEN - np.minimum(np.nan_to_num(broken), 50.0), known)
        score = np.where(
            unknown, WITHOUT, np.where(doubtful, DOUBTFUL + np.minimum(known, 0.0), score)
        )
        allowed = ~unknown & ~doubtful & (broken == 0.0) & ((target is not None) | (known >= 0.0))
        return Judged(np.where(unknown, np.nan, aim), score, allowed, decides, frequency)

    def _margins(
        self, found: Answers, count: int
    ) -> tuple[FloatArray, tuple[Key | None, ...], BoolArray]:
        """Smallest margin, the check that has it, and whether something is not kept that has no margin."""
        standing = self.standing | found.standing
        doubtful = np.isin(np.arange(count), list(found.partly))
        keys = [key for key in found.checks if standing.get(key) != TO_BE_VERIFIED]
        for key, (used, fails) in found.checks.items():
            doubtful |= fails & (
                ~((used > 1.0) & np.isfinite(used)) | (standing.get(key) == TO_BE_VERIFIED)
            )
        if not keys:
            return np.full(count, np.nan), (None,) * count, doubtful
        used = np.stack([found.checks[key][0] for key in keys])
        with np.errstate(divide="ignore", invalid="ignore"):
            margin = np.minimum(-np.log(used), WIDEST)
        margin[~np.isfinite(used)] = np.inf
        least: IntArray = margin.argmin(axis=0)
        value = margin.min(axis=0)
        names = tuple(
            keys[k] if np.isfinite(one) else None for k, one in zip(least, value, strict=True)
        )
        return np.where(np.isfinite(value), value, np.nan), names, doubtful

    def as_it_stands(self) -> Trial | None:
        """The file without a choice, with its cases; None where it has no answer."""
        if self.work.solve is None:
            return None
        mass, every = shaft_mass(self.work.study.train), list[Judged]()
        for name, case in self.cases.items():
            found = Answers.unknown(self.modes, 1)
            try:
                own = self.work.solve(
                    bare(case.study), only=analyses_of_variant(case.work, judged=self.judged)
                )
                found.keep(0, Answer.of(own))
            except (InputError, SolveError):
                return None
            if name:
                case.work.put(**own.results)
            self.standing |= found.standing
            every.append(self.judge(found, np.array([[mass, np.nan]]), of_case=bool(name)))
        one = min(every, key=lambda one: one.score[0])
        return Trial(
            (),
            float(one.aim[0]),
            float(one.score[0]),
            all(bool(own.allowed[0]) for own in every),
            one.decides[0],
            "",
            0,
            float(one.score[0]),
            float(every[0].frequency[0]),
            mass,
            np.nan,
        )

    @cached_property
    def searched(self) -> dict[str, Case]:
        """The file and its cases of which the worst counts: a frequency is that of the file, conditions of all."""
        return {
            name: one
            for name, one in self.cases.items()
            if not name or self.judged or self.settings.keeps_modes
        }

    def amounts(self, row: Sequence[float]) -> tuple[float, float]:
        """Mass (kg) and cost; NaN where nothing requests it."""
        rows = [
            one.rows[int(value)].said
            for one, value in zip(self.variation.figures, row, strict=True)
            if one.rows
        ]
        requested = {self.settings.against, *(one.subject.name for one in self.settings.kept)}
        cost = sum(one.get("cost", 0.0) for one in rows) if "cost" in requested else np.nan
        mass = (
            sum(one.get("mass", 0.0) for one in rows) + self._shafts(row)
            if "mass" in requested
            else np.nan
        )
        return mass, cost

    def _shafts(self, row: Sequence[float]) -> float:
        """Mass of the shafts (kg), which is that of another choice with the same figures of them."""
        key = tuple(row[place] for place in self._of_shafts)
        if key not in self.masses:
            try:
                self.masses[key] = shaft_mass(self.variation.study(list(row)).train)
            except InputError:
                return np.nan
        return self.masses[key]

    @cached_property
    def _of_shafts(self) -> list[int]:
        """The figures that stand in a shaft or a material."""
        shafts = {part.path for part in self.work.study.train.parts if part.kind == "shaft"}
        paths = [
            [*(path for path, _ in one.paths), *(path for row in one.rows for path, _ in row.puts)]
            for one in self.variation.figures
        ]
        return [
            place
            for place, each in enumerate(paths)
            if any(
                path[0] == "materials" or any(path[: len(own)] == own for own in shafts)
                for path in each
            )
        ]

    def shown(self, work: Work) -> Work:
        """The work with a progress of all trials."""
        progress: Callable[[str, float], None] = lambda what, share: self.work.progress(  # noqa: E731
            f"design, {len(self.done)} choices tried", min(len(self.done) / self.limit, 1.0)
        )
        return replace(work, progress=progress)


def _of_case(name: str, why: str) -> str:
    """A fault with the case that it is of."""
    return f"case '{name}': {why}" if name and not why.startswith(f"case '{name}'") else why


def bare(study: Study) -> Study:
    """The study without what varies figures, and without its cases."""
    own = {name: one for name, one in study.analyses.items() if name not in VARYING}
    return replace(study, analyses=own, variations={}, cases={})


def shaft_mass(train: Train) -> float:
    """Of all shafts with a density, by their dimensions, kg; NaN where a section is no circle.

    A frustum has a third of length times the sum of both end areas and their geometric mean.
    """
    if any(bar.section is not None for bar in train.bars):
        return float("nan")
    areas = [_cone(bar.outer) - _cone(bar.bore) for bar in train.bars]
    return float(
        sum(bar.density * bar.length * area for bar, area in zip(train.bars, areas, strict=True))
    )


def _cone(ends: tuple[float, float]) -> float:
    return float(np.pi / 12.0 * (ends[0] ** 2 + ends[0] * ends[1] + ends[1] ** 2))


def _broken(one: Kept, frequency: FloatArray, amounts: FloatArray) -> FloatArray:
    """(variants,) by how much a condition is not kept, as a logarithm; 0 where it is, NaN where it is not known."""
    value = (
        frequency[one.subject.mode - 1]
        if one.subject.mode
        else amounts[:, int(one.subject.name == "cost")]
    )
    with np.errstate(divide="ignore"):
        above: FloatArray = np.log(one.high) - np.log(value)
        below: FloatArray = (
            np.log(value) - np.log(one.low)
            if one.low
            else np.where(np.isnan(value), np.nan, np.inf)
        )
    if one.is_outside:
        return np.maximum(np.minimum(below, above), 0.0)
    return np.maximum(np.maximum(-below, -above), 0.0)
