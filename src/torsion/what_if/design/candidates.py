"""Candidates of a design: of every candidate the objective, whether it meets the constraints, its mass and cost."""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from torsion.analyses import VARYING
from torsion.arrays import BoolArray, FloatArray
from torsion.columns import NotInColumns, plain
from torsion.errors import InputError, SolveError
from torsion.findings import Work
from torsion.study import Study, Variation
from torsion.train import Train
from torsion.what_if.design.design_settings import DesignSettings, Kept
from torsion.what_if.variants.chunks import (
    TO_BE_VERIFIED,
    Answers,
    Key,
    analyses_of_variant,
    solved,
)
from torsion.what_if.variants.frequencies import frequencies

FEWEST = 16  # trains of which the frequencies are found at once
DIGITS = 6  # of the range of a figure, in which its values are chosen
SAME = 9  # decimals to which two scores are equal
WIDEST = 50.0  # margin of a check of which nothing is used; beyond that of any other
# Constraint broken; exceeded or not judged; no limit or no answer.
BROKEN, DOUBTFUL, WITHOUT = -100.0, -200.0, -1000.0


@dataclass(frozen=True)
class Judged:
    """Objective and constraints of variants, (variants,) each."""

    aim: FloatArray  # smallest margin, or minus |ln(f / aim)|; NaN where there is none
    score: FloatArray  # the same with penalties: the greater, the better
    allowed: BoolArray
    decides: tuple[Key | None, ...]
    frequency: FloatArray  # Hz, that is aimed at


@dataclass(frozen=True)
class Tried:
    """One candidate with the worst of its cases and samples."""

    values: tuple[float, ...]
    aim: float
    score: float
    is_allowed: bool
    decides: Key | None
    case: str  # with the aim; empty for the nominal case
    worst: int  # sample with the aim; 0 is the file's own figures
    nominal_score: float  # at the file's own figures, and its worst case
    frequency: float
    mass: float
    cost: float


@dataclass(frozen=True)
class Case:
    """The nominal case, or a case of the file, with all that a candidate puts in before."""

    work: Work
    variation: Variation  # of the figures that are chosen
    sampled: Variation  # and of those of the samples


@dataclass
class Candidates:
    """All candidates that were tried so far."""

    work: Work
    settings: DesignSettings
    variation: Variation
    modes: int
    sweep: Variation | None  # whose samples the worst is of
    samples: FloatArray  # (samples, figures) of `sweep`
    cases: Mapping[str, Case]  # that are judged, the nominal case first
    limit: int = 0  # candidates at most
    tried: dict[tuple[float, ...], Tried] = field(default_factory=dict)
    standing: dict[Key, str] = field(default_factory=dict)
    faults: dict[str, None] = field(default_factory=dict)
    unsolved: int = 0

    @property
    def judged(self) -> bool:
        """The aim is a margin of checks."""
        return self.settings.target is None

    @property
    def best(self) -> list[Tried]:
        """From the best to the worst; of equals the lightest, or cheapest, first."""
        against = self.settings.against or "mass"

        def rank(candidate: Tried) -> tuple[float, float]:
            amount = float(np.nan_to_num(getattr(candidate, against)))
            return -round(candidate.score, SAME), amount

        return sorted(self.tried.values(), key=rank)

    @cached_property
    def searched(self) -> dict[str, Case]:
        """The cases of which the worst counts: a frequency is that of the nominal case, constraints are of all."""
        has_all = self.judged or any(condition.subject.mode for condition in self.settings.kept)
        return {name: case for name, case in self.cases.items() if not name or has_all}

    def scores(self, values: FloatArray) -> FloatArray:
        """Return the scores (variants,) of candidates (variants, figures), each tried once: the greater, the better."""
        figures = self.variation.figures
        digits = [
            None if figure.places else DIGITS - int(np.floor(np.log10(np.ptp(figure.law.ends))))
            for figure in figures
        ]
        keys = [
            tuple(
                value if decimals is None else round(value, decimals)
                for value, decimals in zip(row, digits, strict=True)
            )
            for row in values.tolist()
        ]
        new = [key for key in dict.fromkeys(keys) if key not in self.tried]
        if new:
            self._try(np.array(new))
        return np.array([self.tried[key].score for key in keys])

    def _try(self, values: FloatArray) -> None:
        count, samples, names = len(values), len(self.samples), list(self.searched)
        rows = np.hstack([np.repeat(values, samples, axis=0), np.tile(self.samples, (count, 1))])
        amounts = self.amounts(values)
        judged, unsolved = list[Judged](), set[int]()
        words, share = f"design, {len(self.tried)} choices tried", len(self.tried) / self.limit
        for name, case in self.searched.items():
            work = replace(
                case.work, progress=lambda *_: self.work.progress(words, min(share, 1.0))
            )
            if self.judged:
                answers = solved(work, case.sampled, rows, self.modes, judged=True)
            else:
                answers = frequencies(work, case.sampled, rows, self.modes, least=FEWEST)
            judged.append(
                self.judge(answers, np.repeat(amounts, samples, axis=0), of_case=bool(name))
            )
            unsolved |= {position // samples for position in answers.faults}
            begin = f"case '{name}': " if name else ""
            self.faults |= dict.fromkeys(
                why if why.startswith(begin) else begin + why for why in answers.faults.values()
            )
            self.standing |= answers.standing
        self.unsolved += len(unsolved)

        score = np.stack([over_case.score.reshape(count, samples) for over_case in judged], axis=1)
        worst = score.reshape(count, -1).argmin(axis=1)  # of cases and samples
        allowed = np.all([over_case.allowed for over_case in judged], axis=0).reshape(
            count, samples
        )
        for k, row in enumerate(values.tolist()):
            number, sample = divmod(int(worst[k]), samples)
            position, decisive = k * samples + sample, judged[number]
            self.tried[tuple(row)] = Tried(
                tuple(row),
                float(decisive.aim[position]),
                float(decisive.score[position]),
                bool(allowed[k].all()),
                decisive.decides[position],
                names[number],
                sample,
                float(score[k, :, 0].min()),
                float(judged[0].frequency[k * samples]),
                *amounts[k].tolist(),
            )

    def judge(self, answers: Answers, amounts: FloatArray, *, of_case: bool = False) -> Judged:
        """Return objectives and constraints of the answers; amounts (variants, 2): mass and cost of each.

        of_case: a frequency that is aimed at is that of the nominal case, and a case may have no limit.
        """
        count, target = answers.frequency.shape[1], self.settings.target
        unsolved = np.isin(np.arange(count), list(answers.faults))
        decides: tuple[Key | None, ...] = (None,) * count
        frequency, doubtful = np.full(count, np.nan), np.zeros(count, dtype=np.bool_)
        if target is None:
            # The smallest margin, the check that has it, and whether a check without a margin fails.
            standing = self.standing | answers.standing
            doubtful = np.isin(np.arange(count), list(answers.partly))
            margins = [np.full(count, np.inf)]
            counted = [key for key in answers.checks if standing.get(key) != TO_BE_VERIFIED]
            for key, (used, fails) in answers.checks.items():
                doubtful |= fails & ~((used > 1.0) & np.isfinite(used) & (key in counted))
            with np.errstate(divide="ignore", invalid="ignore"):
                for used in (answers.checks[key][0] for key in counted):
                    margin = np.minimum(-np.log(used), WIDEST)
                    margins.append(np.where(np.isfinite(used), margin, np.inf))
            decisive, smallest = np.argmin(margins, axis=0), np.min(margins, axis=0)
            is_known = np.isfinite(smallest)
            decides = tuple(
                counted[k - 1] if is_finite else None
                for k, is_finite in zip(decisive, is_known, strict=True)
            )
            without = np.where(of_case & ~unsolved, WIDEST, np.nan)
            aim = np.where(is_known, smallest, without)
        elif of_case:
            aim = np.full(count, WIDEST)
        else:
            frequency = answers.frequency[target[0].mode - 1]
            aim = -np.abs(np.log(frequency / target[1]))
        excesses = [
            _excess(condition, answers.frequency, amounts) for condition in self.settings.kept
        ]
        broken = np.sum([np.zeros(count), *excesses], axis=0)
        is_unknown = unsolved | ~np.isfinite(aim) | ~np.isfinite(broken)
        value = np.where(is_unknown, 0.0, aim)
        score = np.where(broken > 0.0, BROKEN - np.minimum(np.nan_to_num(broken), 50.0), value)
        score = np.where(doubtful, DOUBTFUL + np.minimum(value, 0.0), score)
        score = np.where(is_unknown, WITHOUT, score)
        allowed = (
            ~is_unknown & ~doubtful & (broken == 0.0) & ((target is not None) | (value >= 0.0))
        )
        return Judged(np.where(is_unknown, np.nan, aim), score, allowed, decides, frequency)

    def nominal(self) -> Tried | None:
        """Return the file without a choice, with its cases; None if it has no answer."""
        if self.work.solve is None:
            return None
        mass, judged = float(shaft_mass(self.work.study.train)), list[Judged]()
        for name, case in self.cases.items():
            only = analyses_of_variant(case.work, judged=self.judged)
            try:
                findings = self.work.solve(bare(case.work.study), only=only)
            except (InputError, SolveError):
                return None
            answers = Answers.of_findings(findings, self.modes)
            if name:
                case.work.put(**findings.results)
            self.standing |= answers.standing
            judged.append(self.judge(answers, np.array([[mass, np.nan]]), of_case=bool(name)))
        worst = min(judged, key=lambda case: case.score[0])
        aim, score = float(worst.aim[0]), float(worst.score[0])
        is_allowed = all(bool(case.allowed[0]) for case in judged)
        frequency = float(judged[0].frequency[0])
        return Tried(
            (), aim, score, is_allowed, worst.decides[0], "", 0, score, frequency, mass, np.nan
        )

    def amounts(self, values: FloatArray) -> FloatArray:
        """Return mass (kg) and cost (variants, 2) of candidates (variants, figures); NaN if not requested."""
        requested = {self.settings.against, *(kept.subject.name for kept in self.settings.kept)}
        amounts = np.full((len(values), 2), np.nan)
        for column, name in enumerate(("mass", "cost")):
            if name not in requested:
                continue
            amounts[:, column] = 0.0
            for figure, chosen in zip(self.variation.figures, values.T, strict=True):
                if figure.rows:
                    of_rows = np.array([row.amounts.get(name, 0.0) for row in figure.rows])
                    amounts[:, column] += of_rows[chosen.astype(np.intp)]
        if "mass" in requested:
            try:
                masses = plain(shaft_mass(self.variation.in_columns(values)))
            except NotInColumns:
                masses = np.full(len(values), np.nan)
                for position, row in enumerate(values.tolist()):
                    with suppress(InputError):
                        masses[position] = shaft_mass(self.variation.study(row).train)
            amounts[:, 0] += masses
        return amounts


def bare(study: Study) -> Study:
    """Return the study without what varies figures, and without its cases."""
    analyses = {name: settings for name, settings in study.analyses.items() if name not in VARYING}
    return replace(study, analyses=analyses, variations={}, cases={})


def shaft_mass(train: Train) -> float:
    """Return the mass of all shafts with a density, by their dimensions, kg; NaN if a section is no circle.

    A frustum has a third of length times the sum of both end areas and their geometric mean. A train in columns has a
    column of masses.
    """
    if any(bar.section is not None for bar in train.bars):
        return float("nan")
    mass = 0.0
    for bar in train.bars:
        area, hole = (
            float(np.pi / 12.0) * (first**2 + first * last + last**2)
            for first, last in (bar.outer, bar.bore)
        )
        mass += bar.density * bar.length * (area - hole)
    return mass


def _excess(condition: Kept, frequency: FloatArray, amounts: FloatArray) -> FloatArray:
    """Return by how much a constraint is exceeded (variants,), as a logarithm; 0 if it is met, NaN if unknown."""
    subject = condition.subject
    value = frequency[subject.mode - 1] if subject.mode else amounts[:, int(subject.name == "cost")]
    with np.errstate(divide="ignore"):
        above = np.log(condition.high) - np.log(value)
        below = np.where(np.isnan(value), np.nan, np.inf)
        if condition.low:
            below = np.log(value) - np.log(condition.low)
    if condition.is_outside:
        return np.asarray(np.maximum(np.minimum(below, above), 0.0))
    return np.asarray(np.maximum(np.maximum(-below, -above), 0.0))
