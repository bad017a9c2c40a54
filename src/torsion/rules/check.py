"""The verdict of a rule on one thing."""

from fractions import Fraction
from typing import Literal

from torsion.results import reported, result

Verdict = Literal["pass", "fail", "outside", "to be verified"]


@reported
class BarredRange:
    """Speeds that are not for continuous use and are to be passed rapidly; rad/s of the reference station."""

    lower: float = result("rad/s", (), "lower end, reference speed")
    upper: float = result("rad/s", (), "upper end")
    critical: float = result("rad/s", (), "speed of the worst stress, from which the rule's width follows")
    shaft: str = result("", (), "shaft for which a range is barred")


@reported
class Check:
    """One line of the verdict table."""

    rule: str = result("", (), "name of the rule")
    clause: str = result("", (), "its clause")
    where: str = result("", (), "component")
    what: str = result("", (), "what was compared")
    value: float = result("", (), "worst value; null where the response has none")
    limit: float = result("", (), "null where the rule has none")
    unit: str = result("", (), "of value and limit")
    verdict: Verdict = result("", (), "pass, fail, outside or to be verified")
    speed: float | None = result("rad/s", (), "reference speed of the worst value, or null", default=None)
    order: Fraction | None = result("", (), "of the worst value; null for all orders together", default=None)
    note: str = result("", (), "remarks", default="")
    at_least: bool = result(
        "", (), "the value must not be below the limit", key="limit_is_a_least_value", default=False
    )
    barred: tuple[BarredRange, ...] = result("", (), "ranges that the verdict stands on", default=())


@reported
class Checks:
    """The verdict table."""

    lines: tuple[Check, ...] = result("", (), "every verdict", key="")

    @property
    def fails(self) -> bool:
        """A limit is not kept."""
        return any(check.verdict == "fail" for check in self.lines)
