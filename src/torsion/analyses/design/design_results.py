"""What a design finds."""

import math

from torsion.arrays import BoolArray, FloatArray
from torsion.results import derived, reported, result


@reported
class ChosenFigure:
    """A figure of the file that was chosen."""

    name: str = result("", (), "component, and key")
    range: str = result("", (), "what it could be")
    before: str = result("", (), "what the file gives; empty where that is none of the alternatives")
    chosen: str = result("", (), "what the design chose")


@reported
class Candidate:
    """One of the best choices."""

    values: tuple[str, ...] = result("", (), "value of every figure")
    margin: float | None = result(
        "1", (), "smallest margin, ln(limit / value) (of a least value ln(value / limit)); null where none is aimed at"
    )
    decides: str = result("", (), "check with that margin, and its component")
    worst_at: str = result("", (), "case, and where `robust` the sample of `sweep`, at which it has that margin")
    frequency: float | None = result("Hz", (), "natural frequency that is aimed at; null where it is the margin")
    mass: float | None = result(
        "kg", (), "mass of the shafts and of what catalogues state; null where nothing requests it"
    )
    cost: float | None = result("", (), "sum of the costs of the catalogues; null where nothing requests it")
    is_allowed: bool = result("", (), "it keeps every condition and every limit", key="allowed")
    proven: str = result("", (), "what the ordinary solution says: kept, not kept, disagrees; empty where not solved")
    proven_margin: float | None = result("1", (), "margin, at the file's figures, of the ordinary solution")

    @derived("1", (), "share of the limit that is used where the margin is smallest; null where none is aimed at")
    def utilisation(self) -> float | None:
        """By the margin, exp(-margin)."""
        return None if self.margin is None else math.exp(-self.margin)


@reported
class Design:
    """The choice with the greatest smallest margin, or nearest to a frequency."""

    aim: str = result("", (), "what is aimed at")
    kept: tuple[str, ...] = result("", (), "conditions")
    method: str = result("", (), "how was searched")
    evaluations: int = result("", (), "variants that the search evaluated")
    solves: int = result("", (), "trains that it solved for them: times the samples, where `robust`")
    unsolved: int = result("", (), "variants without an answer; worse than any other")
    faults: tuple[str, ...] = result("", (), "why, each cause once")
    figures: tuple[ChosenFigure, ...] = result("", (), "figures that were chosen")
    before: float | None = result(
        "1", (), "smallest margin of the file as it stands; null where it has none, or none is aimed at"
    )
    before_frequency: float | None = result("Hz", (), "natural frequency of the file as it stands")
    best: tuple[Candidate, ...] = result("", (), "the ten best, the best first")
    chosen: int | None = result("", (), "which of them was chosen, from 1: the best that is proven; null for none")
    verdict: str = result("", (), "verdict of the ordinary solution of the file with the chosen values")
    uncounted: tuple[str, ...] = result("", (), "checks that are no margin: their limit is to be verified")
    against: str = result("", (), "mass, cost or nothing")
    front_amount: FloatArray = result("", ("front",), "mass (kg) or cost of the best choices, ascending")
    front_margin: FloatArray = result("", ("front",), "greatest aim (margin, or minus the distance) up to that")
    values: FloatArray  # (evaluations, figures) as figures count them
    aims: FloatArray  # (evaluations,) margin, or minus |ln(f / aim)|; NaN where it is not allowed and has none
    amounts: FloatArray  # (evaluations,) mass or cost, NaN where none is requested
    allowed: BoolArray  # (evaluations,)
    rows: tuple[tuple[str, ...], ...]  # of every figure the names of its rows; () of a range
    unit: tuple[str, ...]  # of every figure
    picked: FloatArray  # (figures,) the chosen values; empty for none
    cases: tuple[str, ...] = result("", (), "cases of the file with which the choice was solved and judged")
    is_over_cases: bool = result(
        "", (), "the search takes the worst of the file and these cases; false: it looks at the file as it stands",
        key="searched_over_cases",
    )  # fmt: skip
