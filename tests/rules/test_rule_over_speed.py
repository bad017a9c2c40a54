"""What every rule over speed stands on: the worst point, its words, ranges but for rounding, and the rated torque."""

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from torsion.analyses.power_balance import SAME_SPEED
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import Line
from torsion.analyses.steady import Steady
from torsion.findings import Results
from torsion.rules import demands, rule_over_speed
from torsion.rules.rule_over_speed import (
    MOSTLY,
    Clause,
    Continuous,
    Curve,
    RuleOverSpeed,
    UseSettings,
    judge_clause,
)

RPM = math.pi / 30.0
PARTS = [
    ("motor", {"inertia": 1.0, "ripple": [{"order": 4, "torque": 10.0}]}),
    ("coupling", {"name": "rubber", "stiffness": 3e4}),
    ("disc", {"inertia": 2.0}),
]
HALF, TWO = SAME_SPEED / 2, SAME_SPEED * 2


def curve(value, limit, status=None):
    value = np.array(value, dtype=float)
    flags = np.zeros(len(value), dtype=int) if status is None else np.array(status)
    return Curve(
        np.arange(1.0, len(value) + 1),
        value,
        np.broadcast_to(np.array(limit, dtype=float), value.shape),
        flags,
    )


def test_utilisation_is_the_share_of_the_limit_and_nothing_of_nothing_is_0() -> None:
    shares = curve(
        [3.0, 0.0, 2.0, 0.0, math.nan, 1.0], [4.0, 0.0, 0.0, 5.0, 1.0, 8.0], [0, 0, 0, 0, 0, 1]
    )
    assert shares.utilisation().tolist() == [0.75, 0.0, math.inf, 0.0, math.inf, math.inf]


def test_worst_of_several_infinite_shares_is_the_greatest_value_and_an_unknown_one_before_all() -> (
    None
):
    share = np.array([9.0, math.inf, math.inf, math.inf])
    assert rule_over_speed.worst_of(share, np.array([99.0, 3.0, 5.0, 4.0])) == 2
    assert rule_over_speed.worst_of(share, np.array([99.0, 3.0, 5.0, math.nan])) == 3
    assert rule_over_speed.worst_of(np.array([0.5, 0.8, 0.8]), np.array([9.0, 1.0, 2.0])) == 2


@pytest.fixture
def seen(study, evidence):
    """Evidence of two harmonic components at three speeds: torques of one coupling by component, (speeds, 2)."""

    def make(torque):
        found = evidence(study(PARTS), [300.0, 600.0, 900.0], half={})
        lines = Line(Fraction(4), None, ("screw",)), Line(Fraction(3, 2), None, ("motor",))
        response = replace(
            found.need(Response), lines=lines, torque=np.array(torque, dtype=complex)[:, :, None]
        )
        return Results(found.study, {**found.results, "response": response})

    return make


@pytest.mark.parametrize(
    ("torque", "words"),
    [
        ((0.2, 0.5), "mostly 1.5 × motor"),
        ((-0.5j, 0.2), "mostly 4 × screw"),
        ((0.0, 0.0), ""),
        ((0.0, 0.1), "mostly 1.5 × motor"),
        ((math.nan, 0.5), ""),
        ((0.5, math.inf), ""),
    ],
)
def test_the_component_with_the_greatest_torque_at_the_worst_speed_is_named(
    seen, torque, words
) -> None:
    found = seen([(9.0, 1.0), torque, (9.0, 1.0)])
    clause = Clause(
        "c",
        "rubber",
        "what",
        "maker",
        curve([1, 2, 1], 4.0),
        np.ones(3, bool),
        "N m",
        (MOSTLY,),
        np.array([0]),
    )
    check = judge_clause("rule", clause, found)
    assert (check.note, check.speed, check.value, check.limit) == (words, 2.0, 2.0, 4.0)


def test_the_greatest_torque_is_that_of_any_of_the_spans_judged(study, evidence) -> None:
    """Of order 4 in the second piece of the shaft, though order 3/2 has more in the first; none of the coupling."""
    shaft = ("shaft", {"name": "line", "length": 1.0, "diameter": 0.1, "segments": 2})
    found = evidence(study([*PARTS[:2], PARTS[2], shaft, PARTS[2]]), [300.0], half={})
    lines = Line(Fraction(4), None, ("screw",)), Line(Fraction(3, 2), None, ("motor",))
    torque = np.array([[[1.0, 2.0, 7.0], [9.0, 5.0, 6.0]]], dtype=complex)  # (speeds, lines, spans)
    response = replace(found.need(Response), lines=lines, torque=torque)
    seen = Results(found.study, {**found.results, "response": response})
    for spans, words in (([1, 2], "mostly 4 × screw"), ([0, 1], "mostly 1.5 × motor")):
        clause = Clause(
            "c",
            "w",
            "what",
            "maker",
            curve([1.0], 4.0),
            np.ones(1, bool),
            notes=(MOSTLY,),
            spans=np.array(spans),
        )
        assert judge_clause("rule", clause, seen).note == words


def test_a_clause_is_judged_at_its_own_speeds_alone_and_at_none_not_at_all(seen) -> None:
    found, values = seen(np.zeros((3, 2))), curve([5.0, 2.0, 3.0], 4.0)
    clause = Clause(
        "c", "w", "what", "maker", values, np.array([False, True, True]), notes=("", "a", "", "b")
    )
    check = judge_clause("rule", clause, found)
    assert (check.value, check.verdict, check.note, check.unit) == (3.0, "pass", "a; b", "N m")
    assert judge_clause("rule", replace(clause, within=np.zeros(3, bool)), found) is None


@pytest.mark.parametrize(("value", "verdict"), [(4.0, "pass"), (np.nextafter(4.0, 5.0), "fail")])
def test_a_value_at_its_limit_passes(seen, value, verdict) -> None:
    clause = Clause("c", "w", "what", "maker", curve([1.0, value, 2.0], 4.0), np.ones(3, bool))
    assert judge_clause("rule", clause, seen(np.zeros((3, 2)))).verdict == verdict


def test_a_speed_is_in_a_range_but_for_rounding() -> None:
    use = Continuous.model_validate({"from": "100 rad/s", "to": "200 rad/s"})
    at = 100 * np.array(
        [
            1 - TWO,
            1 - SAME_SPEED,
            1 - HALF,
            1,
            2,
            2 * (1 + HALF),
            2 * (1 + SAME_SPEED),
            2 * (1 + TWO),
        ]
    )
    assert rule_over_speed.within(use, at).tolist() == [
        False,
        True,
        True,
        True,
        True,
        True,
        True,
        False,
    ]
    assert rule_over_speed.within(None, at).tolist() == [True] * 8


def test_the_words_for_speeds_are_per_minute() -> None:
    use = Continuous.model_validate({"from": "100 rpm", "to": "200.5 rpm"})
    assert Uses(UseSettings(continuous=use)).use_words == "in continuous use, 100 rpm to 200.5 rpm"
    assert Uses(UseSettings()).use_words == ""
    assert demands.in_rpm(10.0 * math.pi) == "300 rpm"


@pytest.mark.parametrize("needed", [1.0, 1.05])
def test_speeds_that_reach_as_far_as_is_judged_need_no_words(needed) -> None:
    rated = 1000 * RPM
    reached = needed * rated
    for last in (reached * 1.1, reached, reached * (1 - HALF), needed * rated * (1 - SAME_SPEED)):
        assert demands.coverage(last, rated, needed) == ""
    assert "judged up to" in demands.coverage(reached * (1 - TWO), rated, needed)
    assert (
        demands.coverage(750 * RPM, rated, needed)
        == "judged up to 750 rpm only, 0.75 of the rated speed"
    )


def test_speeds_must_reach_the_rated_one_unless_more_is_said() -> None:
    assert demands.coverage(100.0, 100.0) == ""
    assert demands.coverage(99.0, 100.0)


RATED = 1000 * RPM
TABLE = [["0 rpm", 1.0], ["3000 rpm", 1.0]]


def with_mean(study, speeds, torque, **operation):
    """Evidence that knows the mean torque of one span at these speeds alone."""
    speeds = np.array(speeds)
    blank = np.zeros((1, len(speeds)))
    steady = Steady(speeds, np.array([torque], dtype=float), blank, blank, "by hand", blank, blank)
    return Results(study(PARTS, **operation), {"mean": steady})


@pytest.mark.parametrize(
    ("load", "torque"),
    [
        ("propeller", 100 + 300 * (1.0 - 0.8**2) / (1.2**2 - 0.8**2)),
        ("constant", 250.0),
        (TABLE, 250.0),
    ],
)
def test_rated_torque_between_two_speeds_is_straight_in_the_law_of_the_load(
    study, load, torque
) -> None:
    """100 and -400 N m of magnitude at 0.8 and 1.2 of the rated speed; the propeller law is straight in its square."""
    for sign in (1.0, -1.0):
        found = with_mean(
            study, [0.8 * RATED, 1.2 * RATED], [sign * 100.0, sign * 400.0], load=load
        )
        assert rule_over_speed.rated_torque(found) == pytest.approx([torque], rel=1e-12)


@pytest.mark.parametrize(
    ("first", "last", "known"),
    [
        (1.0, 1.2, True),
        (1 + HALF, 1.2, True),
        (1 + TWO, 1.2, False),
        (0.5, 1.0, True),
        (0.5, 1 - HALF, True),
        (0.5, 1 - TWO, False),
        (0.4, 0.6, False),
        (1.5, 1.9, False),
    ],
)
def test_rated_torque_is_known_within_the_speeds_computed(study, first, last, known) -> None:
    found = with_mean(study, [first * RATED, last * RATED], [70.0, 70.0])
    assert (rule_over_speed.rated_torque(found) is not None) == known


def test_rated_torque_is_unknown_without_a_mean_torque_or_a_rated_speed(study) -> None:
    assert (
        rule_over_speed.rated_torque(with_mean(study, [50.0, 150.0], [1.0, 1.0], rated=None))
        is None
    )
    assert rule_over_speed.rated_torque(Results(study(PARTS), {})) is None
    assert rule_over_speed.rated_torque(Results(study(PARTS, rated=None), {})) is None


def test_rated_speed_is_that_of_the_operation(study) -> None:
    assert rule_over_speed.rated_speed(study(PARTS)) == pytest.approx(1000 * RPM, rel=1e-15)
    with pytest.raises(ValueError, match="rated speed"):
        rule_over_speed.rated_speed(study(PARTS, rated=None))


class Uses(RuleOverSpeed):
    """A rule with nothing but a range of continuous use."""

    name = "uses"


def use(first, last):
    ends = {"from": f"{first} rpm", "to": f"{last} rpm"}
    return UseSettings.model_validate({"continuous": ends})


def test_rule_needs_the_rated_speed_and_the_ends_of_continuous_use(study) -> None:
    speeds = [one / RPM for one in Uses(use(300, 700)).speeds(study(PARTS))]
    assert speeds == pytest.approx([1000, 300, 700])
    assert [
        one / RPM for one in Uses(use(300, 700)).speeds(study(PARTS, rated=None))
    ] == pytest.approx([300, 700])
    assert [one / RPM for one in Uses(UseSettings()).speeds(study(PARTS))] == pytest.approx([1000])


@pytest.mark.parametrize("ends", [(99, 700), (300, 1201), (99, 1201)])
def test_continuous_use_beyond_the_speeds_computed_is_a_fault(study, ends) -> None:
    settings = use(*ends)
    (fault,) = Uses(settings).continuous_faults(study(PARTS, [("uses", settings)]))
    assert fault.path == ("rules", 0, "uses", "continuous")
    assert fault.hint == "computed: 100 rpm to 1200 rpm"
    assert not list(Uses(settings).continuous_faults(study(PARTS, speeds=None)))


@pytest.mark.parametrize("settings", [UseSettings(), use(100, 1200), use(300, 700)])
def test_continuous_use_within_the_speeds_computed_is_none(study, settings) -> None:
    assert not list(Uses(settings).continuous_faults(study(PARTS)))


def test_a_rule_without_clauses_gives_no_verdict_and_needs_no_speeds_between(seen) -> None:
    found = seen(np.zeros((3, 2)))
    assert Uses(UseSettings()).check(found) == ()
    assert Uses(UseSettings()).speeds_between(found).size == 0


@pytest.mark.parametrize(
    ("value", "status", "verdict", "speed"),
    [
        ([1, math.nan, 2], [0, 0, 0], "not judged", 2),
        ([1, math.nan, 5], [0, 0, 0], "fail", 3),
        ([1, math.nan, 2], [0, 2, 0], "fail", 2),
        ([1, math.nan, math.nan], [0, 0, 2], "fail", 3),
        ([1, math.inf, 2], [0, 0, 0], "not judged", 2),
        ([1, 1, 2], [0, 0, 0], "pass", 3),
    ],
)
def test_a_missing_value_is_not_judged_and_a_singular_response_fails(
    seen, value, status, verdict, speed
) -> None:
    found = seen([(9.0, 1.0)] * 3)
    clause = Clause(
        "c", "rubber", "what", "maker", curve(value, 4.0, status), np.ones(3, bool), "N m"
    )
    line = rule_over_speed.judge_clause("r", clause, found)
    assert (line.verdict, line.speed) == (verdict, speed)
    assert math.isnan(line.value) == (verdict == "not judged")
