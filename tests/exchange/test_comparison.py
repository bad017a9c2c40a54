"""Two results compared: the revision of a propeller shaft, modes paired by shape, and what cannot be read."""

import json
from pathlib import Path

import pytest
from typer.testing import CliRunner

import torsion
from torsion.cli import app
from torsion.exchange.comparison import Comparison, compare_results, read_results
from torsion.output.stored.results_json import text as json_text

ROOT = Path(__file__).parents[2]
FERRY = (ROOT / "shafting_specs" / "haixun_06402.yaml").read_text(encoding="utf-8")
DISCS = """
name: three discs
operation: {speeds: {from: 300 rpm, to: 1800 rpm}}
train:
- disc: {name: a, inertia: 1}
- coupling: {name: soft, stiffness: 1 kN*m/rad}
- disc: {name: b, inertia: 2}
- coupling: {name: stiff, stiffness: 9 kN*m/rad}
- disc: {name: c, inertia: 3}
"""


def results(text: str) -> dict:
    return json.loads(json_text(torsion.run(torsion.parse(text)), ()))


def compared(before: str, after: str) -> Comparison:
    return compare_results(results(before), results(after))


def test_a_thinner_propeller_shaft_shows_its_stiffness_frequencies_and_checks() -> None:
    """Published case: 90 to 85 mm takes 110 939 to 88 265 N m/rad, by (85/90)^4, and 21.418 to 20.133 Hz."""
    case = compared(FERRY, FERRY.replace("diameter: 90 mm", "diameter: 85 mm")).cases[0]
    (change,) = case.inputs
    assert (change.component, change.what, change.unit) == (
        "propeller shaft",
        "stiffness",
        "N m/rad",
    )
    assert (change.before, change.after) == pytest.approx((110_939, 88_265), abs=1)
    assert change.after / change.before == pytest.approx((85 / 90) ** 4, rel=1e-12)
    shown = [(pair.frequency_before, pair.frequency_after) for pair in case.modes[:3]]
    assert shown == [
        pytest.approx(pair, rel=3e-5)
        for pair in ((21.418, 20.133), (35.628, 33.961), (383.40, 382.09))
    ]
    assert case.modes[0].criterion == pytest.approx(0.990, abs=5e-4)
    used = {
        (row.component, row.clause): (row.utilisation_before, row.utilisation_after)
        for row in case.checks
    }
    assert used["propeller shaft", "minimum diameter"] == pytest.approx((1.096, 1.161), abs=5e-4)
    assert used["gearbox", "torque reversal"] == pytest.approx((0.233, 0.265), abs=5e-4)


def test_a_result_equals_itself() -> None:
    found = results(DISCS)
    assert not compare_results(found, found).is_changed


def test_modes_are_paired_by_shape_not_by_number() -> None:
    """A disc on a soft spring at one end adds a low mode; the shapes of the others stay."""
    more = (
        DISCS.rstrip()
        + "\n- coupling: {name: d soft, stiffness: 1 N*m/rad}\n- disc: {name: d, inertia: 1 g*m**2}\n"
    )
    pairs = compared(DISCS, more).cases[0].modes
    assert [(pair.before, pair.after) for pair in pairs] == [(1, 2), (2, 3), (None, 1)]
    assert min(pair.criterion for pair in pairs[:2]) > 0.99


def test_finer_segments_change_no_input() -> None:
    shaft = DISCS.replace(
        "- coupling: {name: stiff, stiffness: 9 kN*m/rad}",
        "- shaft: {length: 2 m, diameter: 60 mm%s}",
    )
    case = compared(shaft % ", segments: 4", shaft % ", segments: 9").cases[0]
    assert not case.inputs


def test_a_case_that_only_one_has_is_a_change() -> None:
    cases = DISCS + "cases: {heavy: {set: {c.inertia: 4}}}\n"
    comparison = compared(DISCS, cases)
    assert [(case.name, case.verdict_before) for case in comparison.cases] == [
        ("", comparison.cases[0].verdict_before),
        ("heavy", None),
    ]
    assert comparison.is_changed


def test_a_case_without_results_is_not_judged_and_ends_in_no_traceback() -> None:
    """A case that was not solved has its plan alone; an analysis without a result is never a PASS."""
    solved = results(DISCS + "cases: {heavy: {set: {c.inertia: 4}}}\n")
    unsolved = solved | {"cases": {"heavy": {"plan": solved["plan"]}}}
    for pair in ((solved, unsolved), (unsolved, solved), (unsolved, unsolved)):
        assert [case.name for case in compare_results(*pair).cases] == ["", "heavy"]
    kept = solved | {
        "checks": [{"rule": "r", "clause": "c", "where": "w", "what": "x", "verdict": "pass"}]
    }
    assert compare_results(kept, kept).cases[0].verdict_after == "PASS"
    missing = kept | {"plan": {"unanswered": [{"what": "response"}]}}
    assert compare_results(kept, missing).cases[0].verdict_after == "NOT JUDGED"
    swept = kept | {"sweep": {"any_fails": {"failing": 41}}}
    assert compare_results(kept, swept).cases[0].verdict_after == "PASS with restrictions"
    failed = swept | {"checks": [kept["checks"][0] | {"verdict": "fail"}]}
    assert compare_results(swept, failed).cases[0].verdict_after == "FAIL"


def test_changed_checks_stand_with_the_worsened_verdict_first_and_then_by_the_rise_of_utilisation() -> (
    None
):
    solved = results(DISCS)

    def rows(**checks: tuple[str, float | None, float]) -> dict:
        """Return the results with checks: verdict, utilisation and value of each place."""
        return solved | {
            "checks": [
                {"rule": "r", "clause": "c", "where": where, "what": "x"}
                | dict(zip(("verdict", "utilisation", "value"), row, strict=True))
                for where, row in checks.items()
            ]
        }

    before = rows(
        falls=("pass", 0.5, 5.0),
        rises=("pass", 0.5, 5.0),
        same=("pass", 0.5, 5.0),
        mended=("fail", 1.2, 12.0),
        worsened=("pass", 0.9, 9.0),
        without_limit=("pass", None, 5.0),
        without_limit_same=("pass", None, 5.0),
    )
    after = rows(
        falls=("pass", 0.4, 4.0),
        rises=("pass", 0.6, 6.0),
        same=("pass", 0.5, 5.1),
        mended=("pass", 0.8, 8.0),
        worsened=("fail", 1.1, 11.0),
        without_limit=("pass", None, 6.0),
        without_limit_same=("pass", None, 5.0),
    )
    changes = compare_results(before, after).cases[0].checks
    assert [change.component for change in changes] == [
        "worsened",
        "rises",
        "without_limit",
        "falls",
        "mended",
    ]


def test_a_component_is_present_in_the_results_that_have_it() -> None:
    more = DISCS + "- coupling: {name: d soft, stiffness: 1}\n- disc: {name: d, inertia: 1}\n"
    changes = compared(DISCS, more).cases[0].inputs
    assert ("d", "-", "present") in [
        (change.component, change.before, change.after) for change in changes
    ]


def test_the_command_prints_writes_and_ends_with_its_status(tmp_path: Path) -> None:
    for name, text in (("a", DISCS), ("b", DISCS.replace("inertia: 3", "inertia: 3.3"))):
        (tmp_path / f"{name}.yaml").write_text(text)
        CliRunner().invoke(
            app, ["solve", str(tmp_path / f"{name}.yaml"), "-o", str(tmp_path / name)]
        )
    a, b = str(tmp_path / "a"), str(tmp_path / "b")
    page = tmp_path / "page.html"
    changed = CliRunner().invoke(app, ["compare", a, b, "--html", str(page)])
    assert changed.exit_code == 1, changed.output
    assert "10.0" in changed.output
    assert "Input that differs" in page.read_text()
    data = json.loads(CliRunner().invoke(app, ["compare", a, b, "--json"]).output)
    assert data["is_changed"]
    assert data["cases"][0]["inputs"][0]["after"] == 3.3
    assert CliRunner().invoke(app, ["compare", a, a]).exit_code == 0


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "not JSON"),
        ("[]", "does not hold"),
        ('{"format": 1}', "does not hold"),
        (None, "cannot be read"),
    ],
)
def test_what_is_no_result_is_refused(tmp_path: Path, text: str | None, why: str) -> None:
    file = tmp_path / "results.json"
    if text is not None:
        file.write_text(text)
    refused = CliRunner().invoke(app, ["compare", str(file), str(file)])
    assert (refused.exit_code, why in refused.output) == (2, True), refused.output


def test_another_format_is_named(tmp_path: Path) -> None:
    file = tmp_path / "results.json"
    file.write_text(json.dumps(results(DISCS) | {"format": 2}))
    with pytest.raises(torsion.InputError, match="format 2"):
        read_results(file)


def test_a_rule_more_is_a_change_of_the_input_and_no_number_is_cut(tmp_path: Path) -> None:
    text = """
name: a train with a name that does not fit into a cell of a narrow terminal, drawing %s
operation: {speeds: {from: 300 rpm, to: 600 rpm}, rated: {speed: 600 rpm, power: 5 kW}}
train:
- motor: {name: motor, inertia: 1, ripple: [{order: 1, torque: 5 %%}]}
- coupling: {name: coupling, stiffness: %s, psi: 0.5, rated_torque: 200 N*m}
- pump: {name: pump, inertia: 2}
rules: [%s]
"""
    for values in (("a", 20000, "coupling-maker"), ("b", 25000, "coupling-maker, api-684")):
        path = tmp_path / f"{values[0]}.yaml"
        path.write_text(text % values)
        CliRunner().invoke(app, ["solve", str(path), "-o", str(tmp_path / values[0])])
    folders = [str(tmp_path / name) for name in "ab"]
    done = CliRunner().invoke(app, ["compare", *folders], env={"COLUMNS": "80", "TERM": "dumb"})
    assert done.exit_code == 1
    rows = [line.split() for line in done.output.splitlines()]
    assert ["coupling", "stiffness", "20000", "25000", "N", "m/rad", "25.0"] in rows
    assert ["\N{EN DASH}", "rules", "coupling-maker", "coupling-maker,", "\N{EN DASH}"] in rows
