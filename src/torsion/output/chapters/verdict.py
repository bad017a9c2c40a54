"""Chapters: the cover; the checks with barred ranges and remarks; remarks on the checks that pass."""

import math
from collections.abc import Iterable, Iterator
from typing import Literal

from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Heading, Paragraph, Points, table
from torsion.output.chapters import first_page
from torsion.output.chapters.case_verdict import overview
from torsion.output.check_words import STRESS, contributing, quoted
from torsion.output.headline import box, case_name
from torsion.output.numbers import counted, rpm, symbols
from torsion.output.reported_values import band_words, barred, barred_rpm, mode_of, rated
from torsion.results import listed
from torsion.rules.verdict_line import TO_BE_VERIFIED, WORDS, Check, Checks

MOST_NAMED = 12  # components without a source that are named
UNCONFIRMED = (
    "Limits with 'edition not confirmed' follow the published practice of the rule named. Compare them with the "
    "edition in force."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the cover of every report, and the checks on the page after it."""
    case = findings.study.case
    yield Heading("Verdict" if case is None else f"Verdict of the case {case.name}", at_end=True)
    yield from first_page.blocks(findings)
    if findings.cases:
        yield overview(findings.each)
    name = case_name(findings)
    heading = f"Checks of the case {name}" if name else "Checks"
    yield from _details(findings, Heading(heading, at_end=True))
    yield from _unjudged(findings)
    yield from _sources(findings)


def judged(findings: Findings) -> Iterator[Block]:
    """Yield the verdict without pictures; nothing if no rule was applied."""
    if findings.need(Checks).lines:
        yield Heading("Verdict", at_end=True)
        yield box(findings)
        yield from _details(findings)


def _details(findings: Findings, *heading: Block) -> Iterator[Block]:
    checks = sorted(findings.need(Checks).lines, key=check_words.rank)
    if not checks:
        return
    yield from heading
    listed_checks = [check for row, check in enumerate(checks) if check_words.is_listed(check, row)]
    # A sign only where some values are least values.
    at_most = "≤" if any(check.at_least for check in listed_checks) else ""
    yield table(
        "what: < Check -> | where: < Component -> | value: Value:u -> | < To be:? -> ≤≥ | limit: Limit:g -> | < Unit -> | "
        "utilisation: Utilisation [%]:4 -> util., % | speed: Speed [rpm] | < Order | < Rule, clause and basis | "
        "< Verdict ->",
        [
            (
                check,
                "≥" if check.at_least else at_most if check.has_limit else "",
                check_words.unit(check),
                contributing(findings, check.order),
                f"{check.rule}: {symbols(check.clause)} ({check_words.basis(check)})",
                f"{check_words.SIGNS[check.verdict]} {WORDS[check.verdict]}",
            )
            for check in listed_checks
        ],
        "Checks, each at its worst point, worst first. Order: the main contribution",
        marks=[check.verdict for check in listed_checks],
        short="Checks, worst first",
        rows_in_summary=5,
    )
    if omitted := len(checks) - len(listed_checks):
        yield check_words.omitted(omitted)
    if editions := check_words.editions(checks):
        yield Paragraph(editions)
    if any(check.standing == TO_BE_VERIFIED for check in checks):
        yield Paragraph(UNCONFIRMED)
    yield from barred_ranges(findings)
    yield from _remarks("Remarks", 2, [check for check in checks if check.verdict != "pass"])


def remarks(findings: Findings) -> Iterator[Block]:
    """Yield an appendix of the full report: remarks on the checks that pass."""
    checks = [check for check in findings.need(Checks).lines if check.verdict == "pass"]
    yield from _remarks("Appendix: remarks on the checks", 1, checks)


def _remarks(title: str, level: Literal[1, 2], checks: Iterable[Check]) -> Iterator[Block]:
    """Yield each remark once, with the components that it is about; nothing where there is none."""
    about: dict[str, list[Check]] = {}
    for check in checks:
        if check.note:
            about.setdefault(f"{check.what}: {symbols(check.note)}", []).append(check)
    if about:
        yield Heading(title, level)
        yield Points(
            tuple(f"{listed(check_words.about(some))}: {note}" for note, some in about.items())
        )


def _unjudged(findings: Findings) -> Iterator[Paragraph]:
    """Yield the shafts whose stress no rule judges, and why; nothing where the file names no rule."""
    checked = {check.where for check in findings.need(Checks).lines if check.unit == STRESS}
    reasons = {
        what.rpartition(" for ")[2]: why for what, why in findings.plan.left_out if " for " in what
    }
    about: dict[str, list[str]] = {}
    for bar in findings.study.train.bars if findings.study.rules else ():
        if bar.name not in checked:
            reason = reasons.get(bar.name, "no rule of the file applies")
            about.setdefault(reason, []).append(quoted(bar.name))
    if about:
        words = "; ".join(f"{listed(names)} ({why})" for why, names in about.items())
        yield Paragraph(f"Shaft stress not checked: {words}.", "note")


def _sources(findings: Findings) -> Iterator[Paragraph]:
    """Yield how many components and excitations have no `source` for their data; nothing if all have one."""
    train = findings.study.train
    parts = [part for part in train.parts if part.kind != "branch"]
    torques = [torque for torque in train.torques if torque.path[:1] == ("excitations",)]
    bare = [quoted(part.name) for part in parts if part.source is None]
    lacking = [f"{len(bare):,} of {counted(len(parts), 'component')}"] if bare else []
    if 0 < len(bare) <= MOST_NAMED:
        lacking[0] += f" ({', '.join(bare)})"
    if count := sum(torque.source is None for torque in torques):
        lacking.append(f"{count} of {counted(len(torques), 'excitation')}")
    if lacking:
        yield Paragraph(f"No source for the data of {' and '.join(lacking)}.", "note")


OVER_TOLERANCES = (
    "The last two columns cover the critical speed at every combination of the tolerances, with the width of the rule. "
    "Only the critical speeds have guaranteed bounds. Stress is not monotonic in a parameter; the verdict is for the "
    "nominal input data."
)


def barred_ranges(findings: Findings) -> Iterator[Block]:
    """Yield the barred ranges and the transients in them; nothing if no range is barred."""
    ranges, speed = barred(findings), rated(findings)
    if not ranges:
        return
    checks = [check for check in findings.need(Checks).lines if check.barred]
    rules = listed(dict.fromkeys(check.rule for check in checks))
    yield Paragraph(
        f"Barred for continuous operation: {'; '.join(map(band_words, barred_rpm(findings)))}. Pass the range rapidly, "
        "mark it on the tachometer and show it on a notice at every control station. The formula is 16 n_{c}/(18 − λ) "
        "to (18 − λ) n_{c}/16 with the critical speed n_{c} and λ = n_{c}/n_{rated}. The range is extended to every "
        f"speed at which the stress exceeds its limit, and by the tolerance of the tachometer ({rules})."
    )
    if any(math.isfinite(band.tolerance_lower) for band in ranges):
        yield Paragraph(OVER_TOLERANCES)
    yield table(
        "shaft: < Shaft -> | lower: From [rpm] -> from rpm | upper: To [rpm] -> to rpm | < Order -> | Mode -> | "
        "critical: Critical speed [rpm] | λ:4? | formula_lower: From by formula [rpm] | "
        "formula_upper: To by formula [rpm] | tolerance_lower: From, tolerances [rpm]:? | "
        "tolerance_upper: To, tolerances [rpm]:?",
        [
            (
                band,
                contributing(findings, band.order),
                mode_of(findings, band),
                band.critical / speed if speed else None,
            )
            for band in ranges
        ],
        f"Barred ranges ({rpm(speed)} rpm rated)" if speed else "Barred ranges",
        short="Barred ranges",
    )
    if times := dict.fromkeys(time for check in checks for time in check.times):
        yield table(
            "motion: < Transient | lower: From [rpm] | upper: To [rpm] | seconds: Time in the range [s]:3 | "
            "share: Peak / steady resonance [%]:3 | stays: Ends within",
            times,
            "Transients in barred ranges (the rule has no limit of the time)",
        )
