"""Variants that fail restrict the verdict of a sweep, unless the file says how many may."""

import pytest

import torsion
from torsion.errors import InputError
from torsion.output.chapters import closing
from torsion.output.headline import headline
from torsion.rules.verdict_line import Checks
from torsion.what_if.sweep.sweep_results import Sweep

# two discs of 1 kg m2 on 1000 N m/rad have 7.12 Hz; 4e4 N m/rad make 45 Hz, which is 2 x 1200 rpm and more
SCENE = """name: x
operation: {speeds: {from: 1000 rpm, to: 1200 rpm}}
train:
- disc: {inertia: 1}
- coupling: {name: rubber, stiffness: 1000}
- disc: {inertia: 1}
RULES
analyses: {sweep: {vary: {rubber.stiffness: {values: [LIST]}}MORE}}
"""


def run(values, more="", rules="rules: [api-684]"):
    return torsion.run(
        torsion.parse(SCENE.replace("LIST", values).replace("MORE", more).replace("RULES", rules))
    )


def test_a_sweep_none_of_whose_variants_fails_changes_nothing() -> None:
    for more in ("", ", fail_at_most: 0 %"):
        findings = run("900, 1000, 1100, 1200", more)
        assert findings.need(Sweep).share_failing == 0.0
        assert findings.exit_status == 0
        assert headline(findings) == (("✓", "PASS: 2 limits met"), "pass")


@pytest.mark.parametrize(
    ("more", "status", "words", "kind"),
    [
        ("", 1, "! PASS with restrictions: 25 % of the variants fail a check", "note"),
        (
            ", fail_at_most: 24 %",
            1,
            "✗ FAIL: 25 % of the variants fail a check, 24 % are permitted",
            "fail",
        ),
        (", fail_at_most: 25 %", 0, "✓ PASS: 2 limits met", "pass"),
    ],
)
def test_variants_that_fail_make_the_exit_status_one_unless_the_file_permits_them(
    more, status, words, kind
) -> None:
    findings = run("900, 1000, 1100, 8000", more)
    assert {check.verdict for check in findings.need(Checks).lines} == {"pass"}
    assert findings.need(Sweep).share_failing == 0.25
    assert findings.exit_status == status
    (sign, clause), stands_out = headline(findings)
    assert (f"{sign} {clause}", stands_out) == (words, kind)
    conclusion = next(iter(closing.conclusion(findings)))
    assert conclusion.kind == kind
    assert ("25 % of the variants fail" in conclusion.text) == (status == 1)


def test_a_variant_without_an_answer_counts_as_one_that_fails_every_check() -> None:
    """The table ends at 1 kN m; 140 kW at 1200 rpm are 1.11 kN m, far within the limit of 2 kN m."""
    law = "table: {over: mean torque, at: [0, 1000], stiffness: [20e3, 30e3]}, rated_torque: 2 kN*m"
    text = SCENE.replace("stiffness: 1000", law).replace("RULES", "rules: [coupling-maker]")
    text = text.replace(
        "speeds: {from: 1000 rpm, to: 1200 rpm}", "rated: {speed: 1500 rpm, power: 50 kW}"
    )
    vary = "operation.rated.power: {values: [50 kW, 140 kW]}, operation.rated.speed: {values: [1500 rpm, 1200 rpm]}"
    text = text.replace("rubber.stiffness: {values: [LIST]}", vary).replace("MORE", "")
    found = torsion.run(torsion.parse(text)).need(Sweep)
    assert found.unsolved == 1
    assert [(check.failing, check.probability) for check in found.checks] == [(1, 0.25)]
    assert found.share_failing == 0.25


@pytest.mark.parametrize("power", [10, 200])
def test_the_least_and_the_greatest_of_a_long_list_are_read_before_the_sweep(power: int) -> None:
    """Of 150 values a hundred are, not the third; the table covers 100 N m to 1 kN m, 15.7 to 157 kW at 1500 rpm."""
    law = "table: {over: mean torque, at: [100, 1000], stiffness: [20e3, 30e3]}"
    text = SCENE.replace("stiffness: 1000", law).replace("RULES\n", "").replace("MORE", "")
    text = text.replace(
        "speeds: {from: 1000 rpm, to: 1200 rpm}", "rated: {speed: 1500 rpm, power: 50 kW}"
    )
    powers = [f"{power if k == 2 else 50 + 0.5 * k} kW" for k in range(150)]
    vary = f"operation.rated.power: {{values: [{', '.join(powers)}]}}"
    with pytest.raises(InputError, match=rf"operation\.rated\.power {power} kW: the table of"):
        torsion.parse(text.replace("rubber.stiffness: {values: [LIST]}", vary))


def test_a_share_that_nothing_can_fail_is_refused() -> None:
    with pytest.raises(InputError, match="no variant can fail") as refused:
        run("900, 1100", ", fail_at_most: 1 %", "")
    assert refused.value.faults[0].line == 8
