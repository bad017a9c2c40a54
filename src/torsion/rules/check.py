"""The verdict of a rule on one thing."""

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal

Verdict = Literal["pass", "fail", "not kept", "outside"]  # not kept: a limit to be verified is exceeded
Standing = Literal[
    "rule text",  # compared with the published text of the rule
    "to be verified",  # from memory or a handbook: against the edition in force
    "maker",  # rated or published by a maker
    "setting",  # set in the file
    "by definition",  # of stability: that nothing grows
]
TO_BE_VERIFIED: Standing = "to be verified"


def verdict_of(kept: bool, standing: Standing) -> Verdict:
    """Of a value that is known and its limit."""
    if kept:
        return "pass"
    return "not kept" if standing == TO_BE_VERIFIED else "fail"


@dataclass(frozen=True, slots=True)
class BarredRange:
    """Speeds that are not for continuous use and are to be passed rapidly; rad/s of the reference station."""

    lower: float
    upper: float
    critical: float  # the speed of the worst stress, from which the rule's width follows
    shaft: str


@dataclass(frozen=True, slots=True)
class Check:
    """One line of the verdict table."""

    rule: str
    clause: str
    where: str  # name of the component
    what: str  # "synthesis stress amplitude"
    value: float  # infinite where the response has no answer
    limit: float  # NaN where the rule has no limit (verdict "outside")
    unit: str
    verdict: Verdict
    standing: Standing  # of the limit: where it is from
    speed: float | None = None  # rad/s of the reference station, at the worst point
    order: Fraction | None = None  # of the reference station; None for the synthesis
    note: str = ""
    at_least: bool = False  # the limit is a least value, not a greatest
    barred: tuple[BarredRange, ...] = ()  # the ranges that the verdict stands on

    @property
    def fails(self) -> bool:
        """The limit is exceeded, whatever its standing, or no value is known that keeps it."""
        return self.verdict in ("fail", "not kept")
