"""What a limit is based on, and how a user confirms an edition."""

import pytest

import torsion
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.output.headline import box
from torsion.rules.verdict_line import KINDS, Checks

PUMP = """
name: pump
operation: {{speeds: {{from: 1400 rpm, to: 1550 rpm}}, rated: {{speed: 1485 rpm, power: 100 kW}}}}
train:
- motor: {{inertia: 2 kg*m**2}}
- coupling: {{stiffness: 20 kN*m/rad, psi: 0.8, rated_torque: 1 kN*m}}
- pump: {{inertia: 1 kg*m**2, power: 100 kW}}
rules:
- api-610: {{line_frequency: 50 Hz{}}}
- coupling-maker
"""
VERIFIED = ', verified: {edition: "12th ed. 2021", by: A. Engineer, on: 2026-11-23}'


def solved(settings: str = "") -> Findings:
    return torsion.run(torsion.parse(PUMP.format(settings)))


def test_every_limit_has_a_basis_in_words() -> None:
    checks = solved().need(Checks).lines
    bases = [(check.rule, check.basis) for check in checks if check.basis is not None]
    assert {(rule, basis.edition, basis.words) for rule, basis in bases} >= {
        ("api-610", "API 610 (pumps)", "edition not confirmed"),
        ("coupling-maker", "", "manufacturer"),
    }
    assert all(
        check.basis is not None and check.basis.kind == KINDS[check.standing] for check in checks
    )


def test_a_confirmed_edition_changes_the_basis_and_no_number() -> None:
    plain, confirmed = solved().need(Checks).lines, solved(VERIFIED).need(Checks).lines
    assert [(check.value, check.limit) for check in plain] == [
        (check.value, check.limit) for check in confirmed
    ]
    rows = [check for check in confirmed if check.rule == "api-610"]
    assert rows
    for check in rows:
        assert check.basis is not None
        assert check.basis.clause == check.clause
        assert check.basis.edition == "API 610 (pumps), 12th ed. 2021"
        assert check.basis.words == "confirmed by A. Engineer, 2026-11-23"
        assert check.verdict != "not kept"
    assert all(
        check.basis.kind == "maker"
        for check in confirmed
        if check.rule == "coupling-maker" and check.basis
    )


def test_some_clauses_are_confirmed_and_an_unknown_one_is_named() -> None:
    findings = solved(", verified: {edition: x, by: y, clauses: [separatoin]}")
    assert all(check.standing != "confirmed" for check in findings.need(Checks).lines)
    assert any("separatoin" in what for what, _ in findings.plan.left_out)
    (words,) = [words for title, words in box(findings).lines if title == "Not confirmed"]
    assert "separatoin" in words
    assert "did you mean 'separation" in words


@pytest.mark.parametrize(
    "verified",
    ["{edition: x}", "{by: y}", "{edition: '', by: y}", "{edition: x, by: y, clauses: []}"],
)
def test_edition_and_name_are_required(verified: str) -> None:
    with pytest.raises(InputError, match=r"verified|edition|by|clauses"):
        torsion.parse(PUMP.format(f", verified: {verified}"))
