"""Variants of a file solved one by one, and what is kept of each."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from torsion.analyses.undamped_modes import Modes
from torsion.arrays import BoolArray, FloatArray, IntArray
from torsion.errors import InputError, SolveError
from torsion.findings import Findings, Work
from torsion.study import Variation

READ = (
    "engine",
    "coupling temperatures",
    "nonlinear peaks",
    "stability",
    "joints",
    "lateral",
    "transient",
)  # by checks
TO_BE_VERIFIED = "to be verified"  # standing of a limit, as the rules call it
Key = tuple[str, str, str, str]  # rule, clause, where, what


@dataclass
class Answers:
    """What variants answer, a column each."""

    frequency: FloatArray  # (modes, variants) Hz, NaN where unknown
    checks: dict[Key, tuple[FloatArray, BoolArray]] = field(
        default_factory=dict
    )  # utilisation, fails: (variants,)
    faults: dict[int, str] = field(default_factory=dict)  # why a variant has no answer
    method: str = ""  # by which they were found
    standing: dict[Key, str] = field(default_factory=dict)  # where the limit of a check is from
    partly: set[int] = field(default_factory=set)  # variants that are not wholly judged

    @classmethod
    def unknown(cls, modes: int, count: int) -> "Answers":
        """Of so many variants, as yet without any."""
        return cls(np.full((modes, count), np.nan))

    def check(self, key: Key) -> tuple[FloatArray, BoolArray]:
        """Utilisation and fails (variants,) of a check, to be filled in where it is a new one."""
        count = self.frequency.shape[1]
        return self.checks.setdefault(
            key, (np.full(count, np.nan), np.zeros(count, dtype=np.bool_))
        )

    def keep(self, place: int, found: Findings | str) -> None:
        """Put the frequencies and the verdicts of a variant, or why it has none, in its column."""
        if isinstance(found, str):
            self.faults[place] = found
            return
        own = found.get(Modes)
        if own is not None:
            here = own.frequency[: len(self.frequency)]
            self.frequency[: len(here), place] = here
        for check in getattr(found.results.get("checks"), "lines", ()):
            if not check.has_limit:
                continue
            key = check.rule, check.clause, check.where, check.what
            used, fails = self.check(key)
            used[place] = np.fmax(
                used[place], np.nan if check.utilisation is None else check.utilisation
            )
            fails[place] |= (
                check.fails or check.verdict == "not judged"
            )  # what is not judged is not known to be kept
            self.standing[key] = check.standing
            if check.verdict == "not judged":
                self.partly.add(place)

    def take(
        self, places: IntArray | slice, own: "Answers", at: IntArray | slice = slice(None)
    ) -> None:
        """Put frequencies and verdicts of others, those in its columns `at`, into the columns `places`."""
        self.frequency[:, places] = own.frequency[:, at]
        for key, (used, fails) in own.checks.items():
            whole = self.check(key)
            whole[0][places], whole[1][places] = used[at], fails[at]


def solved(
    work: Work,
    variation: Variation,
    values: FloatArray,
    modes: int,
    *,
    judged: bool,
    known: Answers | None = None,
    places: Sequence[int] | None = None,
) -> Answers:
    """The answers of variants (variants, figures), each read, solved and judged as a file of its own.

    known: answers to which those at the `places` alone are added.
    """
    answers = Answers.unknown(modes, len(values)) if known is None else known
    chosen = range(len(values)) if places is None else places
    if work.solve is None or not chosen:
        return answers
    for place, found in zip(
        chosen, _each(work, work.solve, variation, values[chosen], judged), strict=True
    ):
        answers.keep(place, found)
    return answers


def read(work: Work, *, judged: bool) -> tuple[str, ...]:
    """The analyses that a variant has."""
    from torsion.analyses import ANALYSES

    own = [
        name for name in READ if name in work.study.analyses or ANALYSES[name].wanted(work.study)
    ]
    return ("modes", *((*work.ruled, *own) if judged else ()))


def _each(
    work: Work,
    solve: Callable[..., Findings],
    variation: Variation,
    values: FloatArray,
    judged: bool,
) -> Iterator[Findings | str]:
    """Of every variant its findings, or why it has none."""
    only = read(work, judged=judged)
    for place, row in enumerate(values.tolist()):
        work.progress(f"variant {place + 1} of {len(values)}", place / len(values))
        try:
            study = variation.study(row)
            one = study if judged else replace(study, rules=())
            found = solve(one, only=only)
            yield "; ".join(f"{left.what}: {left.why}" for left in found.plan.unanswered) or found
        except (InputError, SolveError) as error:
            yield why(error)


def why(error: InputError | SolveError) -> str:
    """Why a variant has no answer."""
    return (
        "; ".join(fault.message for fault in error.faults)
        if isinstance(error, InputError)
        else error.message
    )
