"""A study as the page of `torsion live` shows it: frequencies and Campbell diagram first, then all else."""

from collections.abc import Iterable, Iterator
from dataclasses import replace

from torsion.analyses import ANALYSES
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Findings, Progress, silent
from torsion.output.blocks import Block, Heading, PageEnd, Paragraph
from torsion.output.chapters import (
    critical_speeds,
    first_page,
    forced_response,
    natural_frequencies,
)
from torsion.output.document import numbered
from torsion.output.figures.figure import Figure
from torsion.output.html import fragment
from torsion.results import listed
from torsion.rules import rule
from torsion.runner import run
from torsion.study import Study

LEFT_OUT = (  # what a picture cannot wait for
    "tolerances",
    "sweep",
    "design",
    "fit",
    "periodic",
    "stability",
    "stability map",
    "transient",
    "check",
)
ELSEWHERE = "the live page leaves it out; `torsion solve` computes it"
Fragment = dict[str, str]


def left_out(study: Study) -> tuple[str, ...]:
    """Return what the pictures of a study omit, in words."""
    names = [
        ANALYSES[name].title if name in ANALYSES else name
        for name in LEFT_OUT
        if _is_wanted(study, name)
    ]
    rules = [
        f"rule {name}"
        for name, settings in study.rules
        if set(rule(name, settings).needs) & set(LEFT_OUT)
    ]
    return (*names, *rules, *([f"cases {', '.join(study.cases)}"] if study.cases else []))


def _is_wanted(study: Study, name: str) -> bool:
    return name in study.analyses or (name in ANALYSES and ANALYSES[name].wanted(study))


def drawn(
    study: Study, moved: Iterable[str], progress: Progress = silent
) -> tuple[Fragment, Fragment]:
    """Return frequencies with the Campbell diagram, and the first page with the response.

    moved: figures that are not those of the file.
    """
    quick = [name for name in ANALYSES if name not in LEFT_OUT and _is_wanted(study, name)]
    findings = run(replace(study, cases={}), only=quick, progress=progress)
    plan = replace(
        findings.plan,
        left_out=(*findings.plan.left_out, *((name, ELSEWHERE) for name in left_out(study))),
    )
    if moved_names := listed(moved):  # no checksum of a file stands for them
        study = replace(study, file=f"{study.file} with another {moved_names}", text="")
    findings = replace(findings, plan=plan, study=study)
    changed = [Paragraph(f"{study.shown_file}.", "note")] if moved_names else []
    blocks = [
        Heading("Verdict"),
        *changed,
        *first_page.blocks(findings),
        *forced_response.without_tables(findings),
    ]
    page = fragment([*numbered([block for block in blocks if not isinstance(block, PageEnd)])])
    return _modes(findings), page


def _modes(findings: Findings) -> Fragment:
    modes = findings.get(Modes)
    if modes is None or not modes.frequency.size:
        reason = next(
            (why for what, why in findings.plan.left_out if what == ANALYSES["modes"].title),
            "there are none",
        )
        return fragment([*numbered([Paragraph(f"No natural frequencies: {reason}.", "note")])])
    blocks = [
        *_criticals(findings),
        Heading("Natural frequencies"),
        natural_frequencies.frequencies(modes),
    ]
    return fragment([*numbered(blocks)])


def _criticals(findings: Findings) -> Iterator[Block]:
    """Yield the Campbell diagram; nothing where no order excites."""
    if "critical_speeds" in findings.results:
        yield from (
            block
            for block in critical_speeds.chapter(findings)
            if isinstance(block, Heading | Figure)
        )
