"""The crank spans of an engine under the rules: the stress of the weaker of journal and pin."""

import math
from pathlib import Path

import pytest

import torsion
from torsion.analyses.response.amplitudes import Synthesis
from torsion.errors import InputError
from torsion.findings import Findings
from torsion.rules.verdict_line import Checks

SCENE = Path(__file__).parents[2] / "shafting_specs" / "diesel_misfire.yaml"
RULES = "rules: [coupling-maker, gear-hammer]"


def findings(*changes: tuple[str, str]) -> Findings:
    text = SCENE.read_text(encoding="utf-8")
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return torsion.run(torsion.parse(text, str(SCENE)))


def test_a_crank_span_is_judged_by_the_section_of_its_pin_where_that_is_weaker() -> None:
    found = findings((RULES, "rules: [engine-maker: {crank_stress: 40 MPa}]"))
    half, spans = found.need(Synthesis).half_range, [one.name for one in found.system.spans]
    modulus = math.pi * 0.250**3 / 16.0
    *checks, firing = found.need(Checks).lines
    assert len(checks) == 7  # of eight cylinders
    assert (firing.clause, firing.verdict) == ("normal firing", "not judged")
    for check in checks:
        largest = half[:, spans.index(check.where)].max()
        assert check.value == pytest.approx(largest / modulus * 1e-6, rel=1e-12)
        assert check.verdict == ("fail" if check.value > 40.0 else "pass")


def test_a_crankshaft_without_journal_and_pin_is_no_crankshaft_for_the_rule() -> None:
    lines = SCENE.read_text(encoding="utf-8").splitlines()
    bare = [
        (f"{one}\n", "") for one in lines if one.strip().startswith(("journal:", "pin:", "web:"))
    ]
    with pytest.raises(InputError, match="finds no crankshaft"):
        findings(*bare, (RULES, "rules: [engine-maker: {crank_stress: 40 MPa}]"))


def test_an_unknown_material_of_a_crankshaft_is_refused() -> None:
    with pytest.raises(InputError, match="no material is called '42CrMo4'"):
        findings(("      journal: {", "      material: 42CrMo4\n      journal: {"))
