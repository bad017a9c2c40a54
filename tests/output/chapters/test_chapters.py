"""Which chapters a report has, and the chapters on what was computed and from which file."""

import hashlib
from dataclasses import replace
from pathlib import Path

import pytest

import torsion
from torsion.findings import Findings, Plan, PlanLine
from torsion.output.blocks import Heading, KeyValues, Paragraph, Table, Verbatim
from torsion.output.chapters import chapters, closing
from torsion.output.reports import Report

SCENES = Path(__file__).parents[3] / "shafting_specs"


def heads(findings: Findings, *names: str) -> list[str]:
    report = Report("r", names, "stem")
    return [
        block.text
        for block in chapters(findings, report)
        if isinstance(block, Heading) and block.level == 1
    ]


def test_chapters_by_module_by_function_and_by_analysis(undamped: Findings) -> None:
    assert heads(undamped, "plant", "closing", "torsion.output.chapters.modes.mass_elastic") == [
        "The plant",
        "Conclusion and proposed measurements",
        "Appendix: mass-elastic system",
    ]
    assert heads(undamped, "plant", "verdict", "plant") == ["The plant", "Verdict"]
    assert heads(undamped, "@modes", "plant")[0] == "Natural frequencies and mode shapes"
    assert heads(undamped.having(modes=None), "@modes") == []


def test_the_chapters_of_all_other_analyses(undamped: Findings) -> None:
    every, rest = heads(undamped, "@*"), heads(undamped, "@*", "@modes", "plant")
    assert {"Natural frequencies and mode shapes", "Critical speeds"} < set(every)
    assert "Verdict" not in every
    assert [*rest[-2:]] == ["Natural frequencies and mode shapes", "The plant"]
    assert sorted(rest[:-1]) == sorted(every)


def test_steps_with_their_times(bare: Findings) -> None:
    plan = Plan(
        (PlanLine("w", "m", "s", 0.012445, "y"), PlanLine("v", "n", "t", 2.5, "z")),
        (("l", "o"),),
        {"lib": "1"},
    )
    head, done, time, left, versions = closing.steps(replace(bare, plan=plan))
    assert head == Heading("Appendix: what was computed")
    assert isinstance(done, Table)
    assert isinstance(left, Table)
    assert done.rows == (("w", "m", "s", "y"), ("v", "n", "t", "z"))
    assert time == Paragraph("Computing time: 2.51 s.")
    assert left.rows == (("l", "o"),)
    assert versions == KeyValues((("lib", "1"),))
    assert (
        len(list(closing.steps(replace(bare, plan=replace(plan, left_out=(), versions={}))))) == 3
    )


def test_the_input_with_its_checksums_and_those_of_its_meshes(bare: Findings) -> None:
    keyed = torsion.read(SCENES / "keyed_shaft.yaml")
    found = replace(bare, study=keyed)
    head, _, said, text = closing.input_file(found)
    assert head == Heading("Appendix: the input as read")
    assert isinstance(said, KeyValues)
    sums = [
        hashlib.sha256((SCENES / name).read_bytes()).hexdigest()
        for name in ("keyed_shaft.yaml", "keyed_60_mm.msh")
    ]
    assert [value for _, value in said.pairs] == sums
    assert said.pairs[0][0].endswith("keyed_shaft.yaml")
    assert said.pairs[1][0].endswith("keyed_60_mm.msh")
    assert text == Verbatim((SCENES / "keyed_shaft.yaml").read_text(encoding="utf-8"))
    _, _, said, _ = closing.input_file(replace(bare, study=replace(bare.study, file="")))
    assert isinstance(said, KeyValues)
    assert [name for name, _ in said.pairs] == ["Input"]
    assert list(closing.input_file(replace(bare, study=replace(bare.study, text="")))) == []


@pytest.mark.parametrize("name", ["nowhere", "plant:nothing"])
def test_a_chapter_that_does_not_exist_is_an_error(bare: Findings, name: str) -> None:
    with pytest.raises((ModuleNotFoundError, AttributeError)):
        heads(bare, name)
