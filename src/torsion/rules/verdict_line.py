"""A rule: what it needs, what it does not judge, and the lines of its verdict."""

import math
from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import astuple, replace
from datetime import date
from fractions import Fraction
from typing import Annotated, Generic, Literal, TypeVar

import numpy as np
from pydantic import Field

from torsion.arrays import FloatArray
from torsion.errors import Fault, Path
from torsion.fields import Declared, given, refuse, required
from torsion.findings import Results
from torsion.results import derived, reported, result
from torsion.study import Study

Verdict = Literal[
    "pass",
    "restricted",  # PASS with restrictions: kept if something stated is kept too
    "fail",
    "not kept",  # FAIL too: a limit whose edition is not confirmed is exceeded
    "not judged",  # the rule demands it, and it could not be judged
]
WORDS: Mapping[Verdict, str] = {  # what a reader sees, from the worst
    "fail": "FAIL",
    "not kept": "FAIL",
    "not judged": "NOT JUDGED",
    "restricted": "PASS with restrictions",
    "pass": "PASS",
}
Standing = Literal[
    "rule text",  # compared with the published text of the rule
    "confirmed",  # the user states in `verified` that it was compared with an edition
    "to be verified",  # published practice of the rule, not compared with the edition in force
    "maker",  # rated or published by a maker
    "setting",  # set in the file
    "by definition",  # of stability: that nothing grows
]
Kind = Literal["text", "confirmed", "unconfirmed", "maker", "user", "definition"]
KINDS: Mapping[Standing, Kind] = {
    "rule text": "text",
    "confirmed": "confirmed",
    "to be verified": "unconfirmed",
    "maker": "maker",
    "setting": "user",
    "by definition": "definition",
}
BASIS_WORDS: Mapping[Kind, str] = {
    "text": "rule text",
    "confirmed": "confirmed by {by}",
    "unconfirmed": "edition not confirmed",
    "maker": "manufacturer",
    "user": "stated by user",
    "definition": "by definition",
}
TO_BE_VERIFIED: Standing = "to be verified"
VERIFIED_CLAUSE = "verified clause"  # of what a run leaves out: a clause that no check has


def verdict_of(kept: bool, standing: Standing) -> Verdict:
    """Return the verdict on a known value; kept: it is within its limit."""
    if kept:
        return "pass"
    return "not kept" if standing == TO_BE_VERIFIED else "fail"


@reported
class BarredRange:
    """Speeds that are not for continuous use and are to be passed rapidly; rad/s of the reference station."""

    lower: float = result("rad/s", "lower end, reference speed")
    upper: float = result("rad/s", "upper end")
    critical: float = result(
        "rad/s", "speed of the worst stress, from which the rule's width follows"
    )
    shaft: str = result("shaft for which a range is barred")
    formula_lower: float = result(
        "rad/s",
        "lower end by the rule's formula for that speed, without tolerance",
        default=math.nan,
    )
    formula_upper: float = result("rad/s", "upper end by the same formula", default=math.nan)
    order: Fraction | None = result(
        "order with the maximum torque at that speed, exact", default=None
    )
    tolerance_lower: float = result(
        "rad/s",
        "lower end that covers the critical speed at every tolerance of the file; null without such",
        default=math.nan,
    )
    tolerance_upper: float = result("rad/s", "upper end of the same", default=math.nan)


@reported
class BarredTime:
    """A motion over time within a barred or unstable range."""

    motion: str = result("name of the transient response")
    lower: float = result("rad/s", "lower end of the range, reference speed")
    upper: float = result("rad/s", "upper end")
    seconds: float = result("s", "how long it is within the range", key="time_s")
    share: float | None = result(
        "1",
        "maximum amplitude of the resonances passed there / steady amplitude; null if unknown",
    )
    stays: bool = result("it ends within the range")


@reported
class Reach:
    """The speeds that a check stands on, where its rule demands more; rad/s of the reference station.

    Where `demanded` is below `first`, the rule demands speeds below those that were judged.
    """

    first: float = result("rad/s", "lowest speed that was judged, reference speed")
    last: float = result("rad/s", "highest speed that was judged")
    demanded: float = result(
        "rad/s", "speed up to which the rule is to be judged; 0: lower speeds lack"
    )


class Verified(Declared):
    """The statement of a user that limits were compared with an edition of their rule."""

    edition: str = required(
        'edition that the limits were compared with: "9th ed. 2022"', min_length=1
    )
    by: str = required("who compared them", min_length=1)
    on: date | str | None = given("day of the comparison")
    clauses: Annotated[tuple[str, ...], Field(min_length=1)] | None = given(
        "clauses that were compared, as the column Clause shows them (default: all)"
    )

    def refuse_clashes(self) -> None:
        refuse_blank(self, "edition", "by")


def refuse_blank(settings: Declared, *keys: str) -> None:
    """Raise the error of a text that has nothing but spaces."""
    for key in keys:
        if (text := getattr(settings, key)) is not None and not text.strip():
            raise refuse(f"`{key}` is blank", "write what it names, or leave it out", key)


class RuleSettings(Declared):
    """Base of the settings of all rules."""

    verified: Verified | None = given(
        "the limits were compared with an edition of the rule: {edition, by, on, clauses}; changes no limit"
    )


Settings = TypeVar("Settings", bound=RuleSettings)


@reported
class Basis:
    """What a limit is based on."""

    kind: Kind = result(
        "text (compared with the text of the rule), confirmed (by a user), unconfirmed (published practice, edition "
        "not confirmed), maker, user (stated in the file) or definition",
    )
    edition: str = result("rule and edition", default="")
    clause: str = result("clause of the rule", default="")
    by: str = result("who confirmed the limit", default="")
    on: str = result("day of the confirmation", default="")

    @property
    def words(self) -> str:
        """What the limit is based on, for a reader."""
        author = ", ".join(filter(None, (self.by, self.on)))
        return BASIS_WORDS[self.kind].format(by=author)


@reported
class Check:
    """One line of the verdict table."""

    rule: str = result("name of the rule")
    clause: str = result("its clause")
    where: str = result("component")
    what: str = result("what was compared")
    value: float = result("worst value; null where the response has none")
    limit: float = result("null where the rule has none")
    unit: str = result("of value and limit")
    verdict: Verdict = result(
        "pass, restricted (PASS with restrictions: met if what the note states is met too), fail, not kept (FAIL too: "
        "a limit whose edition is not confirmed is exceeded), or not judged (the rule demands it, and it could not be "
        "judged); the exit status is 1 for the last three",
    )
    standing: Standing = result(
        "where the limit is from: rule text, confirmed, to be verified, maker, setting or by definition",
    )
    speed: float | None = result(
        "rad/s", "reference speed of the worst value, or null", default=None
    )
    order: Fraction | None = result(
        "order of the reference that contributes most to the worst value, exact; null without one",
        default=None,
    )
    note: str = result("remarks", default="")
    at_least: bool = result(
        "the value must not be below the limit", key="limit_is_a_least_value", default=False
    )
    barred: tuple[BarredRange, ...] = result("ranges on which the verdict depends", default=())
    times: tuple[BarredTime, ...] = result(
        "transient responses within these, or within unstable ranges", default=()
    )
    misfire: str = ""  # the cylinder without heat at its worst, where every one is tried in turn
    reach: Reach | None = result(
        "computed speeds, if the rule demands more; null if all are computed", default=None
    )
    restrictions: tuple[str, ...] = result(
        "what must be met too for the check to be met, in words; barred ranges have their own list",
        default=(),
    )
    basis: Basis | None = result("what the limit is based on", default=None)
    parts: tuple[
        int, ...
    ] = ()  # positions of the components it is about, the worst first; none: that of the name

    @property
    def fails(self) -> bool:
        """The limit is exceeded, whatever its standing, or no value is known that keeps it."""
        return self.verdict in ("fail", "not kept")

    @property
    def has_limit(self) -> bool:
        """It counts for the verdict; a row for information alone has no limit and demands none."""
        return self.verdict != "restricted" or not math.isnan(self.limit)

    @derived(
        "1",
        "value / limit, of a required minimum limit / value; null if the limit is 0, negative or unknown",
    )
    def utilisation(self) -> float | None:
        """The share of the limit that is used; infinite where no value is known that keeps it."""
        if self.at_least and self.value == 0.0 < self.limit:
            return math.inf
        numerator, denominator = self.value, self.limit
        if self.at_least:
            numerator, denominator = denominator, numerator
        is_share = numerator >= 0 and denominator > 0 and self.limit > 0
        return numerator / denominator if is_share else None


def with_basis(check: Check, edition: str, verified: Verified | None = None) -> Check:
    """Return the check with the basis of its limit: that of the rule, or what a user confirms."""
    clauses = () if verified is None else verified.clauses or (check.clause,)
    if verified is None or check.standing != TO_BE_VERIFIED or check.clause not in clauses:
        kind = KINDS[check.standing]
        return replace(
            check,
            basis=Basis(kind, edition if kind in ("text", "unconfirmed") else "", check.clause),
        )
    day = "" if verified.on is None else str(verified.on)
    verdict: Verdict = "fail" if check.verdict == "not kept" else check.verdict
    basis = Basis("confirmed", f"{edition}, {verified.edition}", check.clause, verified.by, day)
    return replace(check, standing="confirmed", verdict=verdict, basis=basis)


def worst_verdict(checks: "Iterable[Check]") -> Verdict:
    """Return the worst verdict, from which headline and exit status follow; NOT JUDGED where there is no check."""
    verdicts = {check.verdict for check in checks}
    return next((verdict for verdict in WORDS if verdict in verdicts), "not judged")


def rank(check: Check) -> tuple[int, float]:
    """Return the sort key of its verdict and the share of its limit; the greater, the worse."""
    used = check.utilisation
    severity = -list(WORDS).index(check.verdict)
    return severity, (math.inf if check.fails else -math.inf) if used is None else used


def distinct_ranges(ranges: Iterable[BarredRange]) -> tuple[BarredRange, ...]:
    """Return every barred range once, in the order of the first of each."""
    # As tuples: from Python 3.13 on data with a NaN are not equal to themselves.
    return tuple({astuple(barred): barred for barred in ranges}.values())


def worst_checks(
    cases: Mapping[str, tuple[Check, ...]],
) -> dict[tuple[str, ...], tuple[str, Check]]:
    """Return the worst of every check over cases, with the name of its case; barred ranges are those of all of them."""
    worst: dict[tuple[str, ...], tuple[str, Check]] = {}
    for words, lines in cases.items():
        for check in lines:
            key = check.rule, check.clause, check.what, check.where
            name, worse = worst.get(key, (words, check))
            barred = distinct_ranges((*worse.barred, *check.barred))
            if rank(check) > rank(worse):
                name, worse = words, check
            worst[key] = name, replace(worse, barred=barred)
    return worst


def restricted(check: Check, *words: str, reach: Reach | None = None) -> Check:
    """Return a check that is met as one that is met with restrictions, in words; another check as it is."""
    words = tuple(filter(None, words))
    if not words or check.verdict not in ("pass", "restricted"):
        return check
    return replace(
        check,
        verdict="restricted",
        restrictions=(*check.restrictions, *words),
        reach=reach or check.reach,
    )


@reported
class Checks:
    """The verdict table."""

    lines: tuple[Check, ...] = result("every verdict", key="")

    @property
    def fails(self) -> bool:
        """Whether any check exceeds its limit."""
        return any(check.fails for check in self.lines)

    @property
    def counts(self) -> str:
        """How many checks have each word: "1 FAIL, 3 PASS", the worst first."""
        count = Counter(WORDS[check.verdict] for check in self.lines)
        words = dict.fromkeys(WORDS.values())
        return ", ".join(f"{count[word]} {word}" for word in words if count[word]) or "no check"

    @property
    def is_partial(self) -> bool:
        """Something that a rule demands could not be judged."""
        return any(check.verdict == "not judged" for check in self.lines)


class Rule(Generic[Settings]):
    """Base of all rules: the settings of the file, what they demand of it, and the checks of its results.

    A rule overrides what it has to say. Without that it demands nothing, leaves nothing out and judges nothing.
    """

    name: str = ""  # in the file
    settings_class: type[RuleSettings] = RuleSettings
    edition: str = ""  # of the text that its limits follow
    needs: tuple[str, ...] = ()  # analyses that it reads
    scope: float = 1.0  # speed ratio up to which it is to be judged
    has_clutches_stuck = True  # what it reads takes clutches as stuck; a motion over time does not

    def __init__(self, settings: Settings, name: str = "") -> None:
        """Keep the settings, and the name in the file of a class that serves several rules."""
        self.settings = settings
        self.name = name or self.name

    def edition_of(self, check: Check, study: Study) -> str:
        """Return rule and edition of the text that the limit of a check follows."""
        return self.edition or self.name

    def path(self, study: Study) -> Path:
        """Return where the rule with these settings stands in the file."""
        for position, (_, settings) in enumerate(study.rules):
            if settings is self.settings:
                return "rules", position
        return ("rules",)

    def faults(self, study: Study) -> Iterable[Fault]:
        """Return what the file lacks for this rule."""
        return []

    def left_out(self, study: Study) -> Iterable[tuple[str, str]]:
        """Return what the rule does not judge, and why."""
        return ()

    def demanded_rows(self, study: Study) -> Iterable[Check]:
        """Return rows that follow from the file alone: demands that it, or a part of it, does not meet."""
        return ()

    def speeds(self, study: Study) -> tuple[float, ...]:
        """Return speeds (rad/s of the reference station) that must be computed, where they lie in the range."""
        return ()

    def speeds_between(self, evidence: Results) -> FloatArray:
        """Return (speeds,) rad/s between those computed at which the rule may find more."""
        return np.empty(0)

    def judge(self, evidence: Results) -> Iterable[Check]:
        """Return the checks of what was computed: one for each clause and component."""
        return ()

    def check(self, evidence: Results) -> tuple[Check, ...]:
        """Return all checks: those of the results, then the rows that follow from the file alone."""
        return *self.judge(evidence), *self.demanded_rows(evidence.study)
