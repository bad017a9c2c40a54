"""What tolerances do to barred ranges and margins: the ends of the bands, by solving the file at them."""

import math

import pytest
from tests.contracts.frozen import SCENES, solved

import torsion
from torsion.analyses.critical import CriticalSpeeds
from torsion.findings import Findings
from torsion.rules.class_rules.shaft_limits import barred_range
from torsion.rules.verdict_line import BarredRange, Checks

RPM = 30.0 / math.pi


def barred(findings: Findings) -> BarredRange:
    return next(one for check in findings.need(Checks).lines for one in check.barred)


def test_a_barred_range_covers_its_critical_speed_at_both_ends_of_the_tolerances() -> None:
    """The ship's propeller and its water at 1.05 and 0.95 of their figures, solved as files of their own."""
    one, rated = barred(solved("two_stroke_ship")), 105.0 / RPM
    text = SCENES["two_stroke_ship"].read_text(encoding="utf-8")
    assert "inertia: 42000" in text
    ends = []
    for factor in (1.05, 0.95):
        moved = text.replace("inertia: 42000", f"inertia: {42000 * factor}").replace(
            "tolerance: 5 %", ""
        )
        found = torsion.run(torsion.parse(moved), only=("critical",)).need(CriticalSpeeds)
        ends.append(min(c.speed for c in found.crossings if c.order == one.order and c.mode == 1))
    nominal = next(
        c.speed
        for c in solved("two_stroke_ship").need(CriticalSpeeds).crossings
        if c.order == one.order
    )
    ends = [one.critical * end / nominal for end in ends]
    assert one.tolerance_lower == pytest.approx(
        barred_range(ends[0], rated)[0] * one.lower / one.formula_lower
    )
    assert one.tolerance_upper == pytest.approx(
        barred_range(ends[1], rated)[1] * one.upper / one.formula_upper
    )
    assert one.tolerance_lower < one.lower < one.upper < one.tolerance_upper


@pytest.mark.parametrize(
    ("tolerance", "words"),
    [("", None), (", tolerance: 20 %", "mode 1 lies at 44.721 to 54.772 Hz")],
)
def test_a_margin_states_the_worst_end_of_the_band(tolerance: str, words: str | None) -> None:
    """Two discs at 50 Hz, twice a speed up to 1260 rpm, 42 Hz: 44.721 Hz is 6.48 % away."""
    k = 2.0 / 2.0 * (2.0 * math.pi * 50.0) ** 2
    study = torsion.parse(
        "name: x\noperation: {speeds: {from: 1000 rpm, to: 1260 rpm}}\ntrain:\n"
        f"  - motor: {{inertia: 2, ripple: [{{order: 2, torque: 10 N*m}}]}}\n"
        f"  - coupling: {{stiffness: {k!r}{tolerance}}}\n"
        "  - disc: {inertia: 2}\nanalyses: {modes: }\nrules: [api-610]\n"
    )
    line = next(one for one in torsion.run(study).need(Checks).lines if one.order == 2)
    assert line.value == pytest.approx(50.0 / 42.0 - 1.0)
    assert line.verdict == "pass"
    assert ("within the tolerances" in line.note) is (words is not None)
    if words is not None:
        assert f"{words}, 6.48 % away at the worst end" in line.note
