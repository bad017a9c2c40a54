"""Barred ranges that several cases have in common are one."""

from dataclasses import replace
from fractions import Fraction

from torsion.rules.verdict_line import BarredRange, Check, worst_checks


def test_a_range_that_every_case_has_is_named_once() -> None:
    """Its ends over tolerances are NaN: such data are not equal to themselves from Python 3.13 on."""
    ranges = [BarredRange(20.0, 30.0, 24.0, "crank", 21.0, 29.0, Fraction(2)) for _ in range(2)]
    check = Check("kr", "tau_1", "crank", "stress", 60.0, 50.0, "N/mm2", "fail", "rule text")
    cases = {
        name: (replace(check, barred=(barred,)),)
        for name, barred in zip(("normal", "misfire"), ranges, strict=True)
    }
    ((_, worst),) = worst_checks(cases).values()
    assert len(worst.barred) == 1
