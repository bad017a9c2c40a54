"""The verdict table: what a line says and when it, or the whole table, fails."""

import math

import numpy as np
import pytest

from torsion.analyses.lateral.shaft_bending import Lateral
from torsion.analyses.stability.stability_over_speed import Stability
from torsion.findings import Results
from torsion.rules import standing_verdicts
from torsion.rules.verdict_line import Check, Checks, verdict_of


def line(verdict):
    return Check("rule", "clause", "where", "what", 1.0, 2.0, "N m", verdict, "maker")


@pytest.mark.parametrize(
    ("standing", "exceeded"),
    [
        ("rule text", "fail"),
        ("maker", "fail"),
        ("setting", "fail"),
        ("by definition", "fail"),
        ("to be verified", "not kept"),
    ],
)
def test_a_limit_that_is_to_be_verified_is_not_kept_and_any_other_fails(standing, exceeded) -> None:
    assert (verdict_of(True, standing), verdict_of(False, standing)) == ("pass", exceeded)


def test_a_line_says_no_more_than_it_was_given() -> None:
    check = line("pass")
    assert (check.speed, check.order, check.note, check.at_least, check.barred) == (
        None,
        None,
        "",
        False,
        (),
    )


@pytest.mark.parametrize(
    ("verdicts", "fails"),
    [
        ((), False),
        (("pass",), False),
        (("restricted", "pass"), False),
        (("not judged",), False),
        (("pass", "fail", "pass"), True),
        (("pass", "not kept"), True),
        (("fail",), True),
    ],
)
def test_a_table_fails_with_any_of_its_lines(verdicts, fails) -> None:
    lines = tuple(line(verdict) for verdict in verdicts)
    assert Checks(lines).fails == fails
    assert [one.fails for one in lines] == [verdict in ("fail", "not kept") for verdict in verdicts]


def test_stability_is_judged_wherever_it_was_computed(study) -> None:
    scene = study(
        [("motor", {"inertia": 1.0}), ("coupling", {"stiffness": 1e4}), ("disc", {"inertia": 1.0})]
    )
    speed, growth = scene.operation.speeds.values(), np.full(201, -1.0)
    known = Stability(
        speed, growth > 0, growth, growth, growth, (), speed[:1], "hill", 0.0, speed[:0], True
    )
    assert standing_verdicts(Results(scene, {})) == ()
    assert standing_verdicts(Results(scene, {"stability": None, "lateral": Lateral((), ())})) == ()
    (check,) = standing_verdicts(Results(scene, {"stability": known}))
    assert (check.clause, check.value, check.verdict) == ("stability", -1.0, "pass")
    assert not math.isnan(check.limit)
