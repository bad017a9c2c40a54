"""The chapter of all cases: what it says is what their results say, and the worst is worst."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tests.contracts.frozen import solved as solved_scene
from tests.contracts.printed import printed

import torsion
from torsion import commands
from torsion.findings import NORMAL, Findings, Unanswered
from torsion.output.blocks import Box, Heading, Table
from torsion.output.chapters.case_comparison import chapter, overview, side_by_side
from torsion.output.check_words import is_listed
from torsion.output.document import document
from torsion.output.figures.figure import Figure
from torsion.output.headline import box as verdict_box
from torsion.output.headline import verdict as case_verdict
from torsion.output.pages.html import html
from torsion.output.stored.results_json import MOST_OF_A_CASE, results
from torsion.output.write import write
from torsion.rules.verdict_line import WORDS, BarredRange, Checks

RPM = 30.0 / math.pi
WORST = {"pass": 0, "restricted": 1, "not judged": 2, "not kept": 3, "fail": 4}


@pytest.fixture(scope="module")
def ferry() -> Findings:
    return solved_scene("ferry_cases")


@pytest.fixture(scope="module")
def blocks(ferry: Findings) -> list[Any]:
    return list(chapter(ferry))


def tables(blocks: list[Any], begin: str) -> list[Table]:
    return [one for one in blocks if isinstance(one, Table) and one.caption.startswith(begin)]


def test_every_check_of_every_case_stands_in_its_row_and_column(
    ferry: Findings, blocks: list[Any]
) -> None:
    found, every = results(ferry), 0
    for table in tables(blocks, "Checks by case"):
        titles = [column.title for column in table.columns]
        for row in table.rows:
            cells = dict(zip(titles, row, strict=True))
            for name, case in {NORMAL: found, **found["cases"]}.items():
                if cells.get(name, "–") == "–":
                    continue
                (check,) = [
                    one
                    for one in case["checks"]
                    if (f"{one['what']} ({one['rule']})", one["where"])
                    == (cells["Check"], cells["Component"])
                ]
                value, _, place = cells[name].partition(" at ")
                value, _, limit = value.partition(" / ")
                middle = printed(value, 5)
                assert middle.low <= check["value"] <= middle.high
                limit = (limit or cells["Limit"]).removeprefix("≥ ")
                assert float(limit) == pytest.approx(check["limit"], rel=5e-5)
                speed, _, order = place.partition(" rpm")
                assert float(speed) == pytest.approx(check["speed_rad_per_s"] * RPM, rel=5e-5)
                assert order.strip(" ()").partition(")")[0] == (check["order"] or "")
                assert cells[name].endswith(f" {WORDS[check['verdict']]}") == (
                    check["verdict"] != "pass"
                )
                every += 1
    listed = [
        row for place, row in enumerate(side_by_side(ferry.each)) if is_listed(row.check, place)
    ]
    assert every == sum(len(row.checks) for row in listed) > 20


def test_the_worst_case_of_a_row_is_the_worst_that_is_judged(ferry: Findings) -> None:
    rows = side_by_side(ferry.each)
    for row in rows:
        assert ferry.each[row.worst].is_judged
        for name, check in row.checks.items():
            worst = row.checks[row.worst]
            if ferry.each[name].is_judged:
                assert WORST[check.verdict] <= WORST[worst.verdict]
                if check.verdict == worst.verdict and check.utilisation is not None:
                    assert check.utilisation <= worst.utilisation
    used = [row.checks[row.worst].utilisation or 0.0 for row in rows]
    assert used == sorted(used, reverse=True)


def test_frequencies_of_all_cases_stand_in_one_table(ferry: Findings, blocks: list[Any]) -> None:
    (table,) = tables(blocks, "Natural frequencies of the cases")
    assert [row[0] for row in table.rows] == list(ferry.each)
    for row, one in zip(table.rows, ferry.each.values(), strict=True):
        frequency = one.results["modes"].frequency
        assert [float(cell) for cell in row[1:]] == pytest.approx(frequency.tolist(), rel=5e-7)


def test_curves_are_those_of_each_case(ferry: Findings, blocks: list[Any]) -> None:
    curves = {one.name: one for one in blocks if isinstance(one, Figure)}
    assert list(curves) == ["case-stress"]
    stress = curves["case-stress"].lines
    assert set(stress) <= set(ferry.each)
    shaft = (
        curves["case-stress"]
        .caption.removeprefix("Vibratory shear stress of ")
        .removesuffix(" in the cases")
    )
    for name, line in stress.items():
        found = ferry.each[name]
        part = found.study.train[shaft]
        spans = [
            k
            for k, span in enumerate(found.system.spans)
            if found.study.train.parts[span.part] == part
        ]
        half_range = found.results["synthesis"].half_range[:, spans].max(axis=1)
        (modulus,) = {round(value, 12) for value in half_range / line.y}
        assert modulus > 0.0
        np.testing.assert_array_equal(line.x, found.results["response"].speed * RPM)


def test_a_case_for_information_is_no_part_of_the_verdict(
    ferry: Findings, blocks: list[Any]
) -> None:
    assert ferry.cases["damper seized"].failed
    box = verdict_box(ferry)
    assert (box.sign, box.text, box.kind) == (
        "!",
        "PASS with restrictions: all 6 cases",
        "note",
    )  # from 400 rpm
    lines = dict(box.lines)
    assert " in 6 cases: " in lines["Checks"]
    assert lines["For information"] == "case damper seized: not part of the verdict"


TRAIN = """name: n
operation: {speeds: {from: 300 rpm, to: 900 rpm, steps: 31}, rated: {speed: 800 rpm, power: 50 kW}}
train:
  - motor: {name: engine, inertia: 2, ripple: [{order: 3, torque: 10 %}]}
  - coupling: {name: rubber, stiffness: 40 kN*m/rad, psi: 0.9, vibratory_torque: 900 N*m}
  - propeller: {name: wheel, inertia: 4, damping: {model: archer, factor: 30}}
rules: [coupling-maker]
"""
GOOD, BAD = "{set: {rubber.stiffness: 36 kN*m/rad}}", "{set: {rubber.vibratory_torque: 1 N*m}}"
NO_RULES = "{rules: []}"


@pytest.mark.parametrize(
    ("cases", "sign", "text"),
    [
        ({"a": GOOD}, "✓", "PASS: both cases"),
        ({"a": GOOD, "b": BAD}, "✗", "FAIL: case b (1 of 3)"),
        ({"a": GOOD, "b": BAD.replace("}}", "}, judged: false}")}, "✓", "PASS: both cases"),
        (
            {"a": GOOD, "b": NO_RULES},
            "!",
            "PASS with restrictions: both cases, without coupling-maker in case b",
        ),
    ],
)
def test_the_page_begins_with_the_worst_verdict_of_those_judged(
    cases: dict[str, str], sign: str, text: str
) -> None:
    stated = "".join(f"  {name}: {body}\n" for name, body in cases.items())
    found = torsion.run(torsion.parse(f"{TRAIN}cases:\n{stated}", "t.yaml"))
    body = [item.block for item in document(found).body]
    (first,) = [one for one in body if isinstance(one, Box)]
    assert body.index(first) == 1
    assert (first.sign, first.text) == (sign, text)
    page = html(document(found))
    assert page.index(text) < page.index('class="contents"')
    assert page.count('class="contents"') == 1


def test_what_lacks_an_answer_stands_in_the_box_above_all_that_pass() -> None:
    linked = (
        TRAIN + "links: [{between: [engine, wheel], coupling: {name: chord, stiffness: 1e4}}]\n"
    )
    gone = "remove: [rubber.stiffness, rubber.psi, chord.stiffness]"
    lost = f"{{{gone}, set: {{rubber.flexibility: 0, chord.flexibility: 0}}}}"
    found = torsion.run(torsion.parse(f"{linked}cases: {{x: {lost}}}\n", "t.yaml"))
    box = verdict_box(found)
    assert (box.sign, box.text) == ("?", "NOT JUDGED: case x (1 of 2)")
    assert dict(box.lines)["Not computed"].startswith("case x: case 'x': ")


def test_the_running_head_of_a_numbered_document_names_the_case() -> None:
    text = f"{TRAIN}document: {{document_number: D-1, revision: B}}\ncases: {{a: {GOOD}}}\n"
    found = torsion.run(torsion.parse(text, "t.yaml"))
    assert document(found).cover.identity == "D-1 · revision B"
    assert document(found.cases["a"]).cover.identity == "D-1 · revision B · case a"


def test_the_report_begins_with_the_cases_and_each_has_its_own(
    ferry: Findings, tmp_path: Path
) -> None:
    write(ferry, tmp_path)
    made = sorted(str(path.relative_to(tmp_path)) for path in tmp_path.rglob("*.*"))
    folders = ["PTO-out", "damper-seized", "soft", "stiff", "warm", "zero-pitch"]
    own = sorted(
        [
            *(f"{folder}/report.html" for folder in folders),
            "report.html",
            "results.json",
            "series.npz",
        ]
    )
    assert made == own
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert all(
        f'<a href="{folder}/report.html">{folder}/report.html</a>' in page for folder in folders
    )
    first = [item.block.text for item in document(ferry).body if isinstance(item.block, Heading)][
        :3
    ]
    assert first == ["Verdict", "Checks of the case normal", "Remarks"]
    warm = document(ferry.cases["warm"])
    assert warm.cover.subtitle == "Ferry drive in its cases, case warm"
    own = [
        item.block.text
        for item in warm.body
        if isinstance(item.block, Heading) and item.block.level == 1
    ][:3]
    assert own == ["Verdict of the case warm", "Checks of the case warm", "Changes by this case"]


@pytest.fixture(scope="module")
def pair() -> Findings:
    """A file and a case, with long arrays."""
    return torsion.run(
        torsion.parse(f"{TRAIN.replace('31', '701')}cases: {{soft: {GOOD}}}", "t.yaml")
    )


def test_what_a_case_solved_alone_left_is_taken_away(pair: Findings, tmp_path: Path) -> None:
    write(pair.cases["soft"], tmp_path / "soft")
    assert (tmp_path / "soft" / "results.json").exists()
    write(pair, tmp_path)
    assert [path.name for path in (tmp_path / "soft").iterdir()] == ["report.html"]


def test_the_page_of_all_cases_is_drawn_again_and_those_of_the_cases_stay(
    pair: Findings, tmp_path: Path
) -> None:
    write(pair, tmp_path, also=("tables",))
    before = {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()}
    (tmp_path / "report.html").unlink()
    commands.report(tmp_path)
    assert {path: path.read_bytes() for path in tmp_path.rglob("*.*") if path.is_file()} == before


def test_long_arrays_of_the_cases_stand_beside_the_results(pair: Findings, tmp_path: Path) -> None:
    write(pair, tmp_path)
    read = json.loads((tmp_path / "results.json").read_text(encoding="utf-8"))
    whole = results(pair)
    with np.load(tmp_path / "series.npz") as series:

        def back(value: Any) -> Any:
            if isinstance(value, dict) and value.keys() == {"file", "array", "shape"}:
                array = series[value["array"]]
                assert array.size > MOST_OF_A_CASE
                return (
                    np.where(np.isnan(array), None, array).tolist()
                    if array.dtype.kind == "f"
                    else array.tolist()
                )
            if isinstance(value, dict):
                return {key: back(one) for key, one in value.items()}
            return [back(one) for one in value] if isinstance(value, list) else value

        assert back(read["cases"]) == json.loads(json.dumps(whole["cases"]))
    assert {key: read[key] for key in read if key not in ("cases", "files", "report")} == {
        key: whole[key] for key in whole if key != "cases"
    }


def test_a_link_leads_to_a_file_and_a_name_is_text() -> None:
    nasty = "a<b>|[x]_{1} & {{ y }}"
    text = "name: n\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 9}, disc: {inertia: 1}]\n"
    text += f"cases: {{'{nasty}': {{set: {{disc-1.inertia: 3}}}}}}\n"
    found = torsion.run(torsion.parse(text, "t.yaml"))
    page = html(document(found))
    assert "a&lt;b&gt;|[x]_{1} &amp; {{ y }}</td>" in page
    assert '<a href="a-b-x-_-1-y/report.html">' in page
    table = overview(found.each)
    assert [row[1] for row in table.rows] == ["–", "a-b-x-_-1-y/report.html"]
    assert [column.title for column in table.columns if "l" in column.form] == ["Report"]
    assert {case_verdict(one) for one in found.each.values()} == {"not judged"}


def test_a_file_without_cases_has_no_such_chapter() -> None:
    text = "name: n\ntrain: [disc: {inertia: 2}, coupling: {stiffness: 9}, disc: {inertia: 1}]\n"
    found = torsion.run(torsion.parse(text, "t.yaml"))
    assert not [*chapter(found)]


GEARED = TRAIN.replace(
    "  - propeller", "  - gear: {name: box, teeth: [20, 40], inertia: [0.1, 0.6]}\n  - propeller"
).replace("[coupling-maker]", "[coupling-maker, gear-hammer: {limit: 5}]")


def test_a_rule_that_a_case_leaves_out_is_stated_in_headline_and_tables() -> None:
    """The gear of a case without the rule `gear-hammer` is not judged there, and passes nowhere in silence."""
    cases = "cases: {a: {set: {rubber.stiffness: 36 kN*m/rad}, rules: [coupling-maker]}, b: {rules: [coupling-maker]}}\n"
    geared = GEARED.replace(
        "gear-hammer: {limit: 5}",
        "gear-hammer: {limit: 5, continuous: {from: 700 rpm, to: 900 rpm}}",
    )
    found = torsion.run(torsion.parse(geared + cases, "t.yaml"))
    box, table = verdict_box(found), overview(found.each)
    without = "without gear-hammer in case a, without gear-hammer in case b"
    assert box.text == f"PASS with restrictions: case normal (1 of 3), {without}"
    assert [row[-1] for row in table.rows] == [
        "PASS with restrictions",
        "PASS, without gear-hammer",
        "PASS, without gear-hammer",
    ]
    (table,) = tables(list(chapter(found)), "Checks by case")
    for row in table.rows:
        cells = dict(zip([column.title for column in table.columns], row, strict=True))
        assert ({cells["a"], cells["b"]} == {"not checked"}) == ("gear-hammer" in cells["Check"])


def test_a_case_of_fewer_speeds_is_named_with_them() -> None:
    cases = "cases: {slow: {speeds: {from: 300 rpm, to: 700 rpm}}}\n"
    found = torsion.run(torsion.parse(TRAIN + cases, "t.yaml"))
    box = verdict_box(found)
    assert box.text == "PASS with restrictions: case slow (1 of 2)"
    assert dict(box.lines)["Restrictions"].startswith("case slow: Judged up to 700 rpm only")


def test_a_failure_is_worse_than_an_analysis_without_an_answer(ferry: Findings) -> None:
    failed = ferry.cases["damper seized"]
    lacking = Unanswered("transient", "motion over time", "why", "", None, True, False, "text")
    open_too = replace(failed, plan=replace(failed.plan, unanswered=(lacking,)))
    assert (case_verdict(failed), case_verdict(open_too)) == ("fail", "fail")
    passed = replace(ferry, cases={}, plan=replace(ferry.plan, unanswered=(lacking,)))
    assert case_verdict(passed) == "not judged"
    both = replace(
        ferry, cases={"seized": replace(open_too, study=replace(open_too.study, case=None))}
    )
    table = overview(both.each)
    assert (table.rows[1][-1], table.marks[1]) == ("FAIL", "fail")


def test_barred_ranges_of_a_case_for_information_are_no_restriction(ferry: Findings) -> None:
    seized = ferry.cases["damper seized"]
    band = BarredRange(50.0, 60.0, 55.0, "shaft")
    lines = (replace(seized.need(Checks).lines[0], barred=(band,)), *seized.need(Checks).lines[1:])
    for judged in (False, True):
        case = replace(seized.study, case=replace(seized.study.case, is_judged=judged))
        one = replace(seized, study=case).having(checks=Checks(lines))
        box = verdict_box(replace(ferry, cases={"damper seized": one}))
        assert ("Barred ranges" in dict(box.lines)) == judged


def test_a_case_that_passes_with_restrictions_reads_so_in_headline_and_table() -> None:
    found = torsion.run(
        torsion.parse(GEARED + "cases: {a: {set: {rubber.stiffness: 36 kN*m/rad}}}\n", "t.yaml")
    )
    checks = found.need(Checks)
    limited = Checks((replace(checks.lines[0], verdict="restricted"), *checks.lines[1:]))
    whole = replace(found.having(checks=limited), cases=found.cases)
    box, table = verdict_box(whole), overview(whole.each)
    assert [row[-1] for row in table.rows] == ["PASS with restrictions", "PASS"]
    assert box.text == "PASS with restrictions: case normal (1 of 2)"
