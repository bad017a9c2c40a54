"""What a design finds."""

import math

from torsion.arrays import BoolArray, FloatArray
from torsion.results import derived, reported, result


@reported
class ChosenFigure:
    """A figure of the file that was chosen."""

    name: str = result("component, and key")
    range: str = result("what it could be")
    before: str = result("what the file gives; empty if that is none of the alternatives")
    chosen: str = result("what the design chose")


@reported
class Candidate:
    """One of the ten best candidates of a design."""

    values: tuple[str, ...] = result("value of every figure")
    margin: float | None = result(
        "1",
        "smallest margin, ln(limit / value), for a minimum ln(value / limit); null without a margin as objective",
    )
    decides: str = result("check with that margin, and its component")
    worst_at: str = result(
        "case, and where `robust` the sample of `sweep`, at which it has that margin"
    )
    frequency: float | None = result(
        "Hz", "natural frequency of the objective; null if the objective is the margin"
    )
    mass: float | None = result(
        "kg", "mass of the shafts and of the catalogues; null if not requested"
    )
    cost: float | None = result("sum of the costs of the catalogues; null if not requested")
    is_allowed: bool = result("it keeps every condition and every limit", key="allowed")
    proven: str = result(
        "verdict of the separate solution: `kept`, `not kept`, `disagrees`; empty if not solved",
    )
    proven_margin: float | None = result(
        "1", "margin of the separate solution at the parameters of the file"
    )

    @derived(
        "1",
        "utilisation of the check with the smallest margin; null without a margin as objective",
    )
    def utilisation(self) -> float | None:
        """Return value over limit, which is exp(-margin)."""
        return None if self.margin is None else math.exp(-self.margin)


@reported
class Design:
    """The choice with the greatest smallest margin, or nearest to a frequency."""

    aim: str = result("what is aimed at")
    kept: tuple[str, ...] = result("conditions")
    method: str = result("how was searched")
    evaluations: int = result("variants that the search evaluated")
    solves: int = result("trains that it solved for them: times the samples, where `robust`")
    unsolved: int = result("candidates that failed; they rank last")
    faults: tuple[str, ...] = result("why, each cause once")
    figures: tuple[ChosenFigure, ...] = result("figures that were chosen")
    before: float | None = result(
        "1",
        "smallest margin of the nominal case; null without a margin, or with another objective",
    )
    before_frequency: float | None = result("Hz", "natural frequency of the nominal case")
    best: tuple[Candidate, ...] = result("the ten best, the best first")
    chosen: int | None = result(
        "which of them was chosen, from 1: the best that is proven; null for none"
    )
    verdict: str = result("verdict of the ordinary solution of the file with the chosen values")
    uncounted: tuple[str, ...] = result(
        "checks that do not enter the margin: their limit is to be verified"
    )
    against: str = result("mass, cost or nothing")
    front_amount: FloatArray = result(
        "", "front", "mass (kg) or cost of the best choices, ascending"
    )
    front_margin: FloatArray = result(
        "", "front", "largest objective (margin, or minus the distance) up to that"
    )
    values: FloatArray  # (evaluations, figures) as figures count them
    aims: FloatArray  # (evaluations,) margin, or minus |ln(f / aim)|; NaN where it is not allowed and has none
    amounts: FloatArray  # (evaluations,) mass or cost, NaN where none is requested
    allowed: BoolArray  # (evaluations,)
    rows: tuple[tuple[str, ...], ...]  # of every figure the names of its rows; () of a range
    unit: tuple[str, ...]  # of every figure
    picked: FloatArray  # (figures,) the chosen values; empty for none
    cases: tuple[str, ...] = result("cases of the file with which the choice was solved and judged")
    is_over_cases: bool = result(
        "the search takes the worst of the file and these cases; false: it computes the nominal case",
        key="searched_over_cases",
    )
