"""Variants of a file solved and judged each as a file of its own, and the columns that keep what they answer."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.columns import NotInColumns
from torsion.errors import InputError, SolveError
from torsion.findings import Findings, Work
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


@dataclass(frozen=True)
class JudgedCheck:
    """One check of one variant that has a limit."""

    key: Key
    utilisation: float  # NaN where unknown
    fails: bool
    is_judged: bool
    standing: str  # of the limit


@dataclass(frozen=True)
class Answer:
    """What one variant answers: small, as it may come from another process."""

    frequency: FloatArray  # (modes,) Hz
    checks: tuple[JudgedCheck, ...] = ()
    fault: str = ""  # why there is no answer

    @classmethod
    def from_findings(cls, findings: Findings) -> "Answer":
        """The answer in the findings of a variant, none where an analysis was left unanswered."""
        unanswered = [f"{analysis.what}: {analysis.why}" for analysis in findings.plan.unanswered]
        if unanswered:
            return cls(np.empty(0), fault="; ".join(unanswered))
        modes = findings.get(Modes)
        checks = (
            JudgedCheck(
                (check.rule, check.clause, check.where, check.what),
                np.nan if check.utilisation is None else check.utilisation,
                check.fails,
                check.verdict != "not judged",
                check.standing,
            )
            for check in getattr(findings.results.get("checks"), "lines", ())
            if check.has_limit
        )
        return cls(np.empty(0) if modes is None else modes.frequency, tuple(checks))


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
    def empty(cls, modes: int, count: int) -> "Answers":
        """Of so many variants, as yet without any."""
        return cls(np.full((modes, count), np.nan))

    def check(self, key: Key) -> tuple[FloatArray, BoolArray]:
        """Utilisation and fails (variants,) of a check, to be filled in where it is a new one."""
        count = self.frequency.shape[1]
        return self.checks.setdefault(
            key, (np.full(count, np.nan), np.zeros(count, dtype=np.bool_))
        )

    def keep(self, column: int, answer: Answer) -> None:
        """Put the answer of a variant into its column; of checks with the same key the worst counts."""
        if answer.fault:
            self.faults[column] = answer.fault
            return
        frequency = answer.frequency[: len(self.frequency)]
        self.frequency[: len(frequency), column] = frequency
        for check in answer.checks:
            utilisation, fails = self.check(check.key)
            utilisation[column] = np.fmax(utilisation[column], check.utilisation)
            # What is not judged is not known to be kept.
            fails[column] |= check.fails or not check.is_judged
            self.standing[check.key] = check.standing
            if not check.is_judged:
                self.partly.add(column)

    def take(self, columns: IntArray | slice, answers: "Answers") -> None:
        """Put the frequencies and verdicts of other variants into the columns."""
        self.frequency[:, columns] = answers.frequency
        for key, (utilisation, fails) in answers.checks.items():
            columns_of_check = self.check(key)
            columns_of_check[0][columns], columns_of_check[1][columns] = utilisation, fails


def solved(
    work: Work,
    variation: Variation,
    values: FloatArray,
    modes: int,
    *,
    judged: bool,
    partial: Answers | None = None,
    places: Sequence[int] | None = None,
) -> Answers:
    """The answers of variants (variants, figures), each solved and judged by itself, on all processors.

    partial: answers to which those at the `places` alone are added.
    """
    answers = Answers.empty(modes, len(values)) if partial is None else partial
    columns = range(len(values)) if places is None else places
    solve = work.solve
    if solve is None or not columns:
        return answers
    only = analyses_of_variant(work, judged=judged)
    rows = values[columns]
    try:
        study_of = variation.studies(variation.in_columns(rows))
    except NotInColumns:
        study_of = lambda variant: variation.study(rows[variant].tolist())  # noqa: E731

    def answer_of(variant: int) -> Answer:
        try:
            study = study_of(variant)
            return Answer.from_findings(
                solve(study if judged else replace(study, rules=()), only=only)
            )
        except (InputError, SolveError) as error:
            return Answer(np.empty(0), fault=reason(error))

    found_answers = shared_out(answer_of, range(len(rows)))
    for number, (column, answer) in enumerate(zip(columns, found_answers, strict=True), start=1):
        answers.keep(column, answer)
        work.progress(f"variant {number} of {len(rows)}", number / len(rows))
    return answers


def analyses_of_variant(work: Work, *, judged: bool) -> tuple[str, ...]:
    """Names of the analyses that a variant needs: modes, and where it is judged what its checks read."""
    from torsion.analyses import ANALYSES

    wanted = [
        name
        for name in READ_BY_CHECKS
        if name in work.study.analyses or ANALYSES[name].wanted(work.study)
    ]
    return ("modes", *((*work.ruled, *wanted) if judged else ()))


def reason(error: InputError | SolveError) -> str:
    """Why a variant has no answer, in words."""
    return (
        "; ".join(fault.message for fault in error.faults)
        if isinstance(error, InputError)
        else error.message
    )
