"""A pass says so where variants, or values within tolerances, are not judged."""

import pytest

import torsion
from torsion.output.headline import headline, headline_of_cases
from torsion.rules.verdict_line import Checks

TRAIN = """
name: x
operation: {speeds: {from: 200 rpm, to: 1200 rpm, steps: 3}, rated: {speed: 1200 rpm, power: 50 kW}}
train:
- motor: {name: m, inertia: 1, ripple: [{order: 1, torque: 4 N*m}]}
- coupling: {name: soft, stiffness: 10000, loss_factor: 5 %, vibratory_torque: 1 kN*mTOLERANCE}
- disc: {name: d, inertia: 2}
rules: [RULES]
"""
STIFFNESSES = "soft.stiffness: {values: [7e3, 13e3]}"
SWEEP = f"analyses: {{sweep: {{vary: {{{STIFFNESSES}}}RESULTS}}}}\n"
INERTIAS = "d.inertia: {values: [1.4, 1.8, 2, 2.6]}"
VARIANTS = "variants of the sweep not judged: write `results: [checks]` of the sweep"
TOLERANCES = "tolerances of 'soft' not judged: write `cases: {from: tolerances}`"

ENDS = "cases: {low: {scale: {soft.stiffness: 80 %}}, high: {scale: {soft.stiffness: 120 %}}}\n"


def solved(rules="coupling-maker", tolerance="", more=""):
    text = TRAIN.replace("RULES", rules).replace("TOLERANCE", tolerance)
    return torsion.run(torsion.parse(text + more))


def restrictions(found):
    return [words for line in found.need(Checks).lines for words in line.restrictions]


@pytest.mark.parametrize(
    ("results", "words"),
    [(", results: [modes]", [VARIANTS]), (", results: [modes, checks]", []), ("", [])],
)
def test_a_sweep_whose_variants_answer_no_checks_restricts_a_pass(results, words) -> None:
    found = solved(more=SWEEP.replace("RESULTS", results))
    assert restrictions(found) == words
    assert headline(found)[0][1] == (
        f"PASS with restrictions: {words[0]}" if words else "PASS: 1 limit met"
    )
    assert found.exit_status == 0


def test_a_sweep_of_a_file_without_rules_has_no_such_row() -> None:
    assert not solved("", more=SWEEP.replace("RESULTS", "")).need(Checks).lines


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("", [TOLERANCES]),
        ("cases: {soft: {scale: {soft.stiffness: 80 %}}}\n", [TOLERANCES]),
        (ENDS, []),
        (ENDS.replace("120 %}", "120 %}, judged: false"), [TOLERANCES]),
        (ENDS.replace("120 %", "119 %"), [TOLERANCES]),
        (SWEEP.replace("RESULTS", ""), []),
        (SWEEP.replace("RESULTS", "").replace(STIFFNESSES, INERTIAS), [TOLERANCES]),
    ],
)
def test_tolerances_without_a_case_or_a_sweep_at_their_ends_restrict_a_pass(more, words) -> None:
    assert restrictions(solved(tolerance=", tolerance: 20 %", more=more)) == words


def test_the_stiffness_of_another_coupling_is_no_end_of_a_tolerance() -> None:
    second = ", tolerance: 20 %}\n- disc: {inertia: 1}\n- coupling: {name: b, stiffness: 1e6"
    found = solved(tolerance=second, more="cases: {x: {set: {b.stiffness: 1.01e6}}}\n")
    assert restrictions(found) == [TOLERANCES]


@pytest.mark.parametrize(
    ("more", "is_open"),
    [
        ("", True),
        ("analyses: {sweep: {samples: 128}}\n", False),
        (SWEEP.replace("RESULTS", ""), True),
        (SWEEP.replace("RESULTS", "").replace(STIFFNESSES, INERTIAS), False),
        (ENDS.replace("soft.stiffness", "d.inertia"), True),
        (
            ENDS.replace("soft.stiffness", "d.inertia")
            .replace("80 %", "70 %")
            .replace("120", "130"),
            False,
        ),
    ],
)
def test_a_tolerance_of_an_inertia_that_nothing_varies_restricts_a_pass(
    more: str, is_open: bool
) -> None:
    text = TRAIN.replace("RULES", "coupling-maker").replace("TOLERANCE", "")
    found = torsion.run(
        torsion.parse(text.replace("inertia: 2", "inertia: 2, tolerance: 30 %") + more)
    )
    words = "tolerances of the inertia of 'd' not judged: a sweep, or cases at both ends"
    assert (words in restrictions(found)) == is_open


def test_corners_of_the_tolerances_as_cases_leave_no_such_row() -> None:
    found = solved(tolerance=", tolerance: 20 %", more="cases: {from: tolerances}\n")
    assert len(found.each) > 1
    assert all(restrictions(each) == [] for each in found.each.values())


def test_the_share_of_variants_that_fail_comes_first_in_the_headline() -> None:
    """At resonance 4 N m / 5 % of the share of the driven inertia: 53.3 N m, 46.7 to 57.8 in the sweep."""
    text = TRAIN.replace("1 kN*mTOLERANCE", "55 N*m").replace(
        "RULES", "coupling-maker: {continuous: {from: 300 rpm, to: 1200 rpm}}"
    )
    found = torsion.run(
        torsion.parse(text + SWEEP.replace(STIFFNESSES, INERTIAS).replace("RESULTS", ""))
    )
    assert restrictions(found) == ["judged in continuous use only, 300 rpm to 1200 rpm"]
    assert found.results["sweep"].share_failing == 0.25
    assert headline(found)[0][1] == "PASS with restrictions: 25 % of the variants fail a check"
    assert found.exit_status == 1


@pytest.mark.parametrize(
    ("limit", "words"), [("1 kN*m", "PASS: case normal"), ("1 N*m", "FAIL: case normal")]
)
def test_one_case_that_counts_is_named_in_the_headline(limit, words) -> None:
    text = TRAIN.replace("RULES", "coupling-maker").replace("1 kN*mTOLERANCE", limit)
    cases = "cases: {other: {scale: {soft.stiffness: 80 %}, judged: false}}\n"
    assert headline_of_cases(torsion.run(torsion.parse(text + cases)).each)[0][1] == words


def test_a_case_whose_motion_has_no_answer_is_not_judged_although_no_rule_is_named() -> None:
    text = """
name: clutch
operation: {speeds: {from: 300 rpm, to: 1500 rpm}, rated: {speed: 1500 rpm, power: 50 kW}}
train:
- motor: {name: M, inertia: 1.2}
- coupling: {name: c, stiffness: 20 kN*m/rad, capacity: 500 N*m, max_torque: 2 kN*m}
- machine: {inertia: 6}
analyses: {modes: , transient: {duration: 0.4 s, events: [{at: M, step: {torque: 100 N*m}}]}}
cases: {overload: {set: {operation.rated.power: 90 kW}}}
"""
    (_, words), _ = headline_of_cases(torsion.run(torsion.parse(text)).each)
    assert words == "NOT JUDGED: case overload (1 of 2)"
