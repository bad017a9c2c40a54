"""Chunks of the variants of a file: what is solved at once, in this process or on another machine, and kept as one."""

import time
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray
from torsion.errors import InputError, SolveError
from torsion.findings import Findings, Progress, Work, silent
from torsion.processes import shared_out
from torsion.study import Variation

READ_BY_CHECKS = (
    "engine",
    "coupling temperatures",
    "nonlinear peaks",
    "stability",
    "joints",
    "lateral",
    "transient",
)
TO_BE_VERIFIED = "to be verified"  # standing of a limit, as the rules call it
Key = tuple[str, str, str, str]  # rule, clause, where, what


@dataclass
class Answers:
    """What variants answer, a column each."""

    frequency: FloatArray  # (modes, variants) Hz, NaN where unknown
    # utilisation and whether it fails, (variants,) each
    checks: dict[Key, tuple[FloatArray, BoolArray]] = field(default_factory=dict)
    faults: dict[int, str] = field(default_factory=dict)  # why a variant has no answer
    method: str = ""
    standing: dict[Key, str] = field(default_factory=dict)  # where the limit of a check is from
    partly: set[int] = field(default_factory=set)  # variants that are not wholly judged

    @classmethod
    def of_findings(cls, findings: Findings, modes: int) -> "Answers":
        """Of one variant; of checks with the same key the worst counts. A fault where an analysis is left unanswered."""
        answers, unanswered = cls(np.full((modes, 1), np.nan)), findings.plan.unanswered
        if unanswered:
            answers.faults[0] = "; ".join(f"{answer.what}: {answer.why}" for answer in unanswered)
            return answers
        found_modes = findings.get(Modes)
        if found_modes is not None:
            frequency = found_modes.frequency[:modes]
            answers.frequency[: len(frequency), 0] = frequency
        for check in getattr(findings.results.get("checks"), "lines", ()):
            if not check.has_limit:
                continue
            key = check.rule, check.clause, check.where, check.what
            utilisation, fails = answers.check(key)
            if check.utilisation is not None:
                utilisation[0] = np.fmax(utilisation[0], check.utilisation)
            is_judged = check.verdict != "not judged"
            # What is not judged is not known to be kept.
            fails[0] |= check.fails or not is_judged
            answers.standing[key] = check.standing
            if not is_judged:
                answers.partly.add(0)
        return answers

    def check(self, key: Key) -> tuple[FloatArray, BoolArray]:
        """Utilisation and fails (variants,) of a check, to be filled in where it is a new one."""
        count = self.frequency.shape[1]
        return self.checks.setdefault(
            key, (np.full(count, np.nan), np.zeros(count, dtype=np.bool_))
        )

    def take(self, begin: int, answers: "Answers") -> None:
        """Put what other variants answer into the columns from `begin` on."""
        columns = slice(begin, begin + answers.frequency.shape[1])
        self.frequency[:, columns] = answers.frequency
        for key, (utilisation, fails) in answers.checks.items():
            columns_of_check = self.check(key)
            columns_of_check[0][columns], columns_of_check[1][columns] = utilisation, fails
        self.faults.update((begin + variant, why) for variant, why in answers.faults.items())
        self.partly.update(begin + variant for variant in answers.partly)
        self.standing |= answers.standing
        self.method = self.method or answers.method


def solved(
    work: Work, variation: Variation, values: FloatArray, modes: int, *, judged: bool
) -> Answers:
    """The answers of variants (variants, figures), each solved and judged by itself, on all processors."""
    answers, count = Answers(np.full((modes, len(values)), np.nan)), len(values)
    solve = work.solve
    if solve is None or not count:
        return answers
    only = analyses_of_variant(work, judged=judged)
    study_of = variation.studies(values)

    def answer_of(variant: int) -> Answers:
        try:
            study = study_of(variant)
            findings = solve(study if judged else replace(study, rules=()), only=only)
            return Answers.of_findings(findings, modes)
        except (InputError, SolveError) as error:
            return Answers(np.full((modes, 1), np.nan), faults={0: error.message})

    for variant, answer in enumerate(shared_out(answer_of, range(count))):
        answers.take(variant, answer)
        work.progress(f"variant {variant + 1} of {count}", (variant + 1) / count)
    return answers


def analyses_of_variant(work: Work, *, judged: bool) -> tuple[str, ...]:
    """Names of the analyses that a variant needs: modes, and where it is judged what its checks read."""
    from torsion.analyses import ANALYSES

    if not judged:
        return ("modes",)
    study = work.study
    wanted = (
        name for name in READ_BY_CHECKS if name in study.analyses or ANALYSES[name].is_wanted(study)
    )
    return ("modes", *work.ruled, *wanted)


@dataclass(frozen=True)
class Chunk:
    """Variants from `begin` up to `end`, which it does not hold; their samples follow from these and the seed alone."""

    number: int
    begin: int
    end: int

    @property
    def size(self) -> int:
        """Number of variants from `begin` to `end`."""
        return self.end - self.begin


Part = tuple[FloatArray, Answers]  # values (variants, figures) of a chunk, and what they answer


def chunks(count: int, length: int) -> tuple[Chunk, ...]:
    """Variants in chunks of one length, the last one shorter.

    >>> [(one.begin, one.end) for one in chunks(10, 4)]
    [(0, 4), (4, 8), (8, 10)]
    """
    begins = enumerate(range(0, count, length))
    return tuple(Chunk(number, begin, min(begin + length, count)) for number, begin in begins)


def joined(count: int, modes: int, parts: Iterable[Part]) -> Part:
    """All variants as one, of parts in the order of their chunks; each part is let go before the next is taken."""
    total, values, begin = Answers(np.full((modes, count), np.nan)), np.empty((0, 0)), 0
    for chunk_values, answers in parts:
        if not values.size:
            values = np.empty((count, chunk_values.shape[1]))
        values[begin : begin + len(chunk_values)] = chunk_values
        total.take(begin, answers)
        begin += len(chunk_values)
    return values, total


@dataclass
class Pace:
    """How fast variants are solved, and the time that is left."""

    count: int
    progress: Progress = silent
    kept: int = 0  # variants that were solved before
    solved: int = 0
    start: float = field(default_factory=time.perf_counter)

    def show(self, under_way: float = 0.0) -> None:
        """Variants, rate and time left, `more` being those of chunks under way."""
        solved, words = self.solved + under_way, ""
        if solved:
            rate = solved / max(time.perf_counter() - self.start, 1e-9)
            words = f", {rate:.3g} variants/s, {duration((self.count - self.kept - solved) / rate)} left"
        done = self.kept + solved
        self.progress(f"sweep, variant {done:.0f} of {self.count}{words}", done / self.count)


def duration(seconds: float) -> str:
    """A time in words.

    >>> duration(0.4), duration(200.0), duration(9000.0)
    ('about 1 s', 'about 3 min 20 s', 'about 2 h 30 min')
    """
    total = max(round(seconds), 1)
    if total < 60:
        return f"about {total} s"
    if total < 3600:
        return f"about {total // 60} min {total % 60} s"
    return f"about {total // 3600} h {total // 60 % 60} min"
