"""The chapters of a report: functions of the findings, which give no block where these have nothing for them."""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import partial
from importlib import import_module

from torsion.analyses import ANALYSES
from torsion.findings import Findings
from torsion.output.blocks import Block
from torsion.output.reports import REPORTS, STEPS, Report

Chapter = Callable[[Findings], Iterable[Block]]
OF_ANALYSIS, OF_THE_REST = (
    "@",
    "@*",
)  # in a list of chapters: those of an analysis, or of all that it does not name


def chapters(
    findings: Findings, report: Report = REPORTS["solve"], *, is_full: bool = False
) -> list[Block]:
    """Return the blocks of a report's chapters in their order, each once; the full report has more appendices."""
    names = report.chapters
    if is_full and report.more:
        end = names.index(STEPS)
        names = (*names[:end], *report.more, *names[end:])
    return [
        block for chapter in dict.fromkeys(_named(findings, names)) for block in chapter(findings)
    ]


def _named(findings: Findings, names: Sequence[str]) -> Iterator[Chapter]:
    for name in names:
        if name == OF_THE_REST:
            rest = [key for key in ANALYSES if OF_ANALYSIS + key not in names]
        elif name.startswith(OF_ANALYSIS):
            rest = [name.removeprefix(OF_ANALYSIS)]
        else:
            rest = []
            yield _function(name)
        # The chapters that an analysis declares, else its results as they are declared.
        for analysis in (ANALYSES[key] for key in rest):
            if any(findings.results.get(result) is not None for result in analysis.results):
                yield from map(_function, analysis.chapters)
                if not analysis.chapters:
                    yield partial(import_module(f"{__name__}.declared_results").chapter, analysis)


def _function(name: str) -> Chapter:
    """Return the function of `natural_frequencies`, `joint_motion:summary`, or of another module."""
    module, _, function = name.partition(":")
    path = module if "." in module else f"{__name__}.{module.replace('/', '.')}"
    made: Chapter = getattr(import_module(path), function or "chapter")
    return made
