"""What the registries of chapters, reports and outputs name exists, and no two files of a report have one name."""

from importlib import import_module

import pytest
from tests.for_all import for_all

from torsion.analyses import ANALYSES
from torsion.output.renderers import OUTPUTS
from torsion.output.reports import REPORTS

CHAPTERS = [
    *(name for analysis in ANALYSES.values() for name in analysis.chapters),
    *(
        name
        for report in REPORTS.values()
        for name in (*report.chapters, report.columns)
        if name and name[0] != "@"
    ),
]
PLACES = [
    *(
        f"torsion.output.chapters.{name.replace('/', '.')}"
        if ":" in name
        else f"torsion.output.chapters.{name.replace('/', '.')}:chapter"
        for name in dict.fromkeys(CHAPTERS)
    ),
    *(output.render for output in OUTPUTS.values()),
]


@for_all("place", PLACES)
def test_what_a_registry_names_is_a_function(place: str) -> None:
    module, _, name = place.partition(":")
    assert callable(getattr(import_module(module), name))


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
def test_a_report_names_analyses_and_outputs_that_exist(report) -> None:
    named = {name.removeprefix("@") for name in report.chapters if name.startswith("@")} - {"*"}
    assert named <= ANALYSES.keys()
    assert set(report.files) <= OUTPUTS.keys()


@pytest.mark.parametrize("report", REPORTS.values(), ids=REPORTS)
def test_the_files_of_a_report_have_different_names(report) -> None:
    names = [
        report.files.get(key, report.stem + one.suffix)
        for key, one in OUTPUTS.items()
        if one.suffix
    ]
    assert len(set(names)) == len(names)


def test_every_analysis_with_results_has_a_chapter_of_its_own() -> None:
    assert [
        name for name, analysis in ANALYSES.items() if analysis.results and not analysis.chapters
    ] == []
