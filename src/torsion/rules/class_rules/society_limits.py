"""Tables of the classification societies: editions, standings, and the limits of crankshafts and generator shafts.

Stresses in N/mm2, diameters in mm. Sources: KR Rules 2025 Part 5 Ch. 4, 201 (crankshafts of main engines), 203
(generator sets), 204 (major critical speeds), read; CCS Part 3 Ch. 12 and all others from memory.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Literal

import numpy as np

from torsion.arrays import FloatArray
from torsion.rules.class_rules.shaft_limits import (
    LimitCurve,
    Mark,
    Piece,
)
from torsion.rules.demands import BARRED_BELOW

LAST = 1.15  # speed ratio above which the tables of crankshafts end
STEEL_STRENGTH, STEEL_YIELD = 440.0, 225.0  # N/mm2, above which f_m counts
CARBON_CAP, ALLOY_CAP = 590.0, 835.0  # N/mm2, the greatest tensile strength in f_m
SET_RANGE = 0.9, 1.1  # speed ratios of a generator set in use
Duty = Literal["propulsion", "generator set"]


Coefficients = tuple[float, float, float, float]
NONE: Coefficients = (0.0, 0.0, 0.0, 0.0)


@dataclass(frozen=True)
class CrankTable:
    """Limits of crankshafts up to the rated speed and above it.

    Of coefficients c, s, w and v: c + s r^2 + (w + v (r - 0.8)) sqrt(r - 1) of the speed ratio r, the root from r = 1 on.
    """

    below: Coefficients
    above: Coefficients
    below_per_mm: Coefficients = NONE  # more for every mm of the diameter
    above_per_mm: Coefficients = NONE


PASSING = 2.0  # limit while a barred range is passed / that of continuous use
# four-stroke in-line, V 45 and 60 degrees
KR_IN_LINE = CrankTable((45.0, -24.0, 0.0, 0.0), (21.0, 0.0, 0.0, 237.0))
# two-stroke, and other V
KR_OTHER = CrankTable((45.0, -29.0, 0.0, 0.0), (16.0, 0.0, 0.0, 237.0))
CCS_CRANK = CrankTable(
    (52.0, -33.8, 0.0, 0.0),
    (18.1, 0.0, 87.3, 0.0),
    (-0.031, 0.02, 0.0, 0.0),
    (-0.0113, 0.0, -0.052, 0.0),
)
KR_SET_CRANK = {"in-line": (21.0, 90.0), "other": (16.0, 90.0)}  # in use, and below
KR_SET_SHAFT = 31.0, 118.0
Letters = tuple[str, str]  # of the limits in continuous use and of passing
OWN, NUMBERED = ("tau_C", "tau_T"), ("tau_1", "tau_2")


@dataclass(frozen=True)
class Society:
    """What one society's rule set is."""

    title: str
    edition: str
    mark: Mark  # of its limits of line shafts
    letters: Letters = OWN
    crank: Literal["", "kr", "ccs"] = ""  # whose table of crankshafts
    crank_edition: str = ""  # where that is another text
    crank_mark: Mark = "to be verified"
    mesh: float | None = None  # greatest vibratory torque of a gear / its rated torque
    has_majors: bool = False  # limits where major critical speeds may lie
    scope: float = 1.05  # speed ratio up to which stresses are to be reported
    not_judged: tuple[tuple[str, str], ...] = ()  # what, why


_CCS = "CCS Part 3 Ch. 12"
_M68 = "formulas of IACS UR M68 as {} has them"
SOCIETIES: Mapping[str, Society] = {
    "kr": Society(
        "KR",
        "KR Rules 2025 Part 5 Ch. 4",
        "rule text",
        NUMBERED,
        "kr",
        "",
        "rule text",
        has_majors=True,
        scope=1.2,
    ),
    "lr": Society(
        "LR",
        _M68.format("LR"),
        "to be verified",
        mesh=1.0 / 3.0,
    ),
    "dnv": Society(
        "DNV",
        _M68.format("DNV"),
        "to be verified",
        not_judged=(
            ("fatigue by CG-0038", "not checked: low cycle, high cycle and transient criteria"),
        ),
    ),
    "abs": Society("ABS", _M68.format("ABS"), "to be verified"),
    "bv": Society("BV", _M68.format("BV"), "to be verified", NUMBERED),
    "ccs": Society("CCS", _M68.format(_CCS), "to be verified", crank="ccs", crank_edition=_CCS),
    "nk": Society(
        "NK", _M68.format("NK"), "to be verified", NUMBERED, "kr", "limits of KR 5-4, taken for NK"
    ),
    "rina": Society("RINA", _M68.format("RINA"), "to be verified", NUMBERED),
}


def strength_factor(strength: float | None, *, alloy: bool) -> float:
    """Return f_m of tau_1 and tau_3 for a tensile strength above 440 N/mm2 (KR), 1 where none is known.

    >>> round(strength_factor(600.0, alloy=True), 10)
    1.2424242424
    """
    counted = min(strength or 0.0, ALLOY_CAP if alloy else CARBON_CAP)
    return 1.0 + 2.0 / 3.0 * (max(counted, STEEL_STRENGTH) / STEEL_STRENGTH - 1.0)


def yield_factor(limit: float | None) -> float:
    """Return f_m of tau_2 for a yield strength above 225 N/mm2 (KR), 1 where none is known.

    >>> round(yield_factor(350.0), 10)
    1.5555555556
    """
    return max(limit or 0.0, STEEL_YIELD) / STEEL_YIELD


def crank_curve(
    table: CrankTable, letters: Letters, diameter: float, strength: float = 1.0, yields: float = 1.0
) -> LimitCurve:
    """Return the limits of the crankshaft of a main engine; strength, yields: the factors f_m.

    >>> curve = crank_curve(KR_IN_LINE, NUMBERED, 200.0)
    >>> [round(float(value), 4) for value in curve.continuous(np.array([0.8, 1.0, 1.05]))]
    [29.64, 21.0, 34.2487]
    """
    below = np.array(table.below) + diameter * np.array(table.below_per_mm)
    above = np.array(table.above) + diameter * np.array(table.above_per_mm)
    last = "tau_3" if letters == NUMBERED else letters[0]
    return LimitCurve(
        (
            Piece(letters[0], 1.0, partial(_limit, below, strength)),
            Piece(last, LAST, partial(_limit, above, strength)),
        ),
        Piece(letters[1], BARRED_BELOW, partial(_limit, below, PASSING * yields)),
    )


def _limit(row: FloatArray, factor: float, ratio: FloatArray) -> FloatArray:
    """Return the limit at speed ratios (speeds,), by a row of coefficients and a factor f_m."""
    constant, square, root, slope = row
    above_rated = (root + slope * (ratio - 0.8)) * np.sqrt(np.maximum(ratio - 1.0, 0.0))
    return np.asarray(factor * (constant + square * ratio**2 + above_rated))


def set_curve(limits: tuple[float, float], factor: float) -> LimitCurve:
    """Return the limits of a shaft of a generator set, whose range of use nothing is barred in; factor: f_m.

    >>> set_curve((31.0, 118.0), 1.0).continuous(np.array([0.5, 0.9, 1.1, 1.2]))
    array([118.,  31.,  31.,  nan])
    """
    (first, last), (use, below) = SET_RANGE, limits
    of_use, of_below = (
        partial(_limit, np.array([value, 0.0, 0.0, 0.0]), factor) for value in (use, below)
    )
    return LimitCurve((Piece("tau_2", first, of_below, is_open=True), Piece("tau_1", last, of_use)))
