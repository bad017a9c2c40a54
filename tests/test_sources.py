"""Sources of formulas: what the code cites is recorded, what is recorded is cited, and a run lists what it used."""

import json
import re
from pathlib import Path

import pytest
from tests.contracts.frozen import solved
from typer.testing import CliRunner

from torsion.cli import app
from torsion.findings import UsedSource
from torsion.output.blocks import Paragraph
from torsion.output.chapters import chapters
from torsion.output.stored.results_json import text
from torsion.sources import SOURCES, collected, note, source

ROOT = Path(__file__).parents[1]
CITED = re.compile(r'\b(?:source|note)\("([\w-]+)"')


def used(name: str) -> dict[str, UsedSource]:
    return {record.key: record for record in solved(name).plan.sources}


def test_every_key_that_the_code_cites_is_recorded_and_every_record_is_cited() -> None:
    files = [path for path in (ROOT / "src").rglob("*.py") if path.name != "sources.py"]
    cited = {key for path in files for key in CITED.findall(path.read_text(encoding="utf-8"))}
    by_name = {"Archer", "Frahm"}  # cited by the word of the file
    assert cited | by_name == SOURCES.keys()


def test_two_discs_use_no_rule_and_no_propeller_formula() -> None:
    records = used("two_discs")
    assert not any(record.is_rule for record in records.values())
    assert "WittrickWilliams1971" in records
    assert "Archer" not in records


def test_usv_lists_ur_m68_by_clause_and_the_damping_of_archer() -> None:
    records = used("usv")
    assert records["iacs-m68"].is_rule
    assert records["iacs-m68"].words.startswith("IACS UR M68")
    assert {"tau_C", "minimum diameter"} == set(records["iacs-m68"].where)
    assert records["Archer"].compared is False


@pytest.mark.parametrize(
    ("name", "key"),
    [
        ("cardan_line", "Ma2011"),
        ("cardan_line", "Liu2023"),
        ("rubber_damper", "NishiharaAsami2002"),
        ("fan_start", "Kloss1916"),
        ("toleranced_drive", "Rayleigh1877"),
        ("wind_gearbox", "Willis1841"),
    ],
)
def test_an_example_lists_the_source_of_its_formula(name: str, key: str) -> None:
    assert key in used(name)


def test_results_have_the_sources_under_a_key() -> None:
    findings = solved("usv")
    rows = json.loads(text(findings))["sources"]
    assert {"key", "words", "where", "compared"} == set(rows[0])
    assert [row["key"] for row in rows] == [record.key for record in findings.plan.sources]


def test_a_block_within_a_block_counts_for_both() -> None:
    @source("Lewis1932", "fig. 1")
    def passing() -> int:
        return 1

    with collected() as outer:
        note("Kruskal1956")
        with collected() as inner:
            assert passing() == 1
    note("Kruskal1956")  # outside of a run nothing is collected
    assert list(inner) == [("Lewis1932", "fig. 1")]
    assert list(outer) == [("Kruskal1956", ""), ("Lewis1932", "fig. 1")]
    with pytest.raises(KeyError), collected():
        note("Nobody1900")


def test_the_command_prints_all_sources_and_a_bibliography() -> None:
    printed = CliRunner().invoke(app, ["sources"]).stdout
    assert "DenHartog1956: Den Hartog: Mechanical Vibrations, McGraw-Hill (1956)" in printed
    assert "iacs-m68: IACS UR M68" in printed
    entries = CliRunner().invoke(app, ["sources", "--bib"]).stdout
    assert re.findall(r"^@misc\{([\w-]+),$", entries, re.MULTILINE) == list(SOURCES)


def test_the_report_lists_the_sources_of_the_formulas() -> None:
    blocks = chapters(solved("usv"))
    (text,) = (
        block.text
        for block in blocks
        if isinstance(block, Paragraph) and "Sources of the formulas" in block.text
    )
    assert "Archer: damping A Q/n of propellers, edition not confirmed" in text
    assert "M68" not in text, "rules are in the appendix of the limits"
