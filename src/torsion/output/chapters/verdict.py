"""Chapters: the verdict, first page and details: barred ranges and every check; remarks on those that pass."""

import math
from collections.abc import Iterable, Iterator, Sequence
from functools import partial

from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.chapters import case_verdict, first_page
from torsion.output.check_words import STRESS, contributing, quoted
from torsion.output.numbers import NONE, counted, number, rpm, symbols
from torsion.output.reported_values import band_words, barred, barred_rpm, mode_near, rated
from torsion.results import listed
from torsion.rules.verdict_line import WORDS, BarredRange, Check, Checks

MOST_NAMED = 12  # components without a source that are named on the first page


def chapter(findings: Findings) -> Iterator[Block]:
    """The verdict on the first page of every report; what it stands on follows."""
    yield Heading(f"Verdict of the case {case}" if (case := first_page.case_name(findings)) else "Verdict", at_end=True)
    before = case_verdict.rows_of_first_page(findings.each) if findings.cases else 0
    yield from first_page.blocks(findings, [*_unjudged(findings), _sources(findings)], before)
    yield from _details(findings)


def judged(findings: Findings) -> Iterator[Block]:
    """The verdict without pictures; nothing where no rule judged."""
    if findings.need(Checks).lines:
        yield Heading("Verdict", at_end=True)
        yield first_page.box(findings)
        yield from _details(findings)


def _details(findings: Findings) -> Iterator[Block]:
    checks = sorted(findings.need(Checks).lines, key=check_words.rank)
    if checks:
        yield _checks(findings, checks)
    yield from barred_ranges(findings)
    if remarks := _remarks(check for check in checks if check.verdict != "pass"):
        yield Heading("Remarks on the checks that do not pass", 2)
        yield remarks
    if checks:
        yield table(
            "< Clause -> | < Component -> | < Check | < Rule | < Standing of the limit -> limit from",
            [(symbols(one.clause), one.where, one.what, one.rule, one.standing) for one in checks],
            "Clause and standing of every limit",
            short="Standing of every limit",
        )


def _checks(findings: Findings, checks: Sequence[Check]) -> Table:
    return table(
        "< Check -> | < Component -> | Value / limit -> | Utilisation [%] -> used, % | At speed [rpm] -> at rpm | "
        "< Order | < Verdict ->",
        map(partial(_row, findings), checks),
        "Checks against the rules, each at its worst point: those that fail first, then by utilisation of the "
        "limit (value / limit, of a least value limit / value: of a diameter no share of stress). Order: the one "
        "that contributes most",
        marks=[check.verdict for check in checks],
        short="Checks, each at its worst point",
    )


def remarks(findings: Findings) -> Iterator[Block]:
    """Appendix: what is to be said of checks that pass."""
    if found := _remarks(check for check in findings.need(Checks).lines if check.verdict == "pass"):
        yield Heading("Appendix: remarks on the checks that pass")
        yield found


def _remarks(checks: Iterable[Check]) -> Points | None:
    """Each remark once, with the components that it is about; None where there is none."""
    about: dict[str, list[Check]] = {}
    for check in checks:
        if check.note:
            about.setdefault(f"{check.what}: {symbols(check.note)}", []).append(check)
    found = (f"{listed(check_words.about(some))}: {note}" for note, some in about.items())
    return Points(tuple(found)) if about else None


def _unjudged(findings: Findings) -> Iterator[Paragraph]:
    """The shafts whose stress no rule judges, and why; nothing where the file names no rule."""
    lines = findings.need(Checks).lines
    judged = {check.where for check in lines if check.unit == STRESS}
    reasons = {what.rpartition(" for ")[2]: why for what, why in findings.plan.left_out if " for " in what}
    about: dict[str, list[str]] = {}
    for bar in findings.study.train.bars if findings.study.rules else ():
        if bar.name not in judged:
            about.setdefault(reasons.get(bar.name, "no rule that the file names judges it"), []).append(
                quoted(bar.name)
            )
    if about:
        words = "; ".join(f"{listed(names)} ({why})" for why, names in about.items())
        yield Paragraph(f"Shafts whose stress no rule judges: {words}.", "note")


def _sources(findings: Findings) -> Paragraph:
    """How many components and excitations do not say where their figures come from."""
    parts = [part for part in findings.study.train.parts if part.kind != "branch"]
    given = [torque for torque in findings.study.train.torques if torque.path[:1] == ("excitations",)]
    bare = [quoted(part.name) for part in parts if part.source is None]
    lacking = f"{len(bare):,} of {counted(len(parts), 'component')}" if bare else ""
    lacking += f" ({', '.join(bare)})" if 0 < len(bare) <= MOST_NAMED else ""
    acting = sum(torque.source is None for torque in given)
    excited = f"{acting} of {counted(len(given), 'excitation')}" if acting else ""
    lacking = " and ".join(filter(None, (lacking, excited)))
    if lacking:
        return Paragraph(f"Where the figures come from is not stated for {lacking}.", "note")
    return Paragraph("Where the figures come from is stated for every component and excitation.")


OVER_TOLERANCES = (
    "Over the tolerances of the file the critical speed moves; the last two columns are the range that covers it, with "
    "the rule's width, wherever it lies. That is proven of the critical speed alone: how far the stress then exceeds "
    "its limit follows no figure in one sense, and the verdict is that of the file's figures."
)


def barred_ranges(findings: Findings) -> Iterator[Block]:
    """Nothing where no range is barred."""
    found, speed = barred(findings), rated(findings)
    if not found:
        return
    by = listed(dict.fromkeys(check.rule for check in findings.need(Checks).lines if check.barred))
    yield Paragraph(
        f"Barred for continuous operation: {'; '.join(map(band_words, barred_rpm(findings)))}. The range is to be "
        "passed rapidly, to be marked on the tachometer and to be shown on a notice at every control station. By "
        "formula 16 n_{c}/(18 − λ) to (18 − λ) n_{c}/16 with λ = n_{c}/n_{rated}, extended to every speed at which the "
        f"stress exceeds its limit and by the tolerance of the tachometer ({by}); n_{{c}} is the critical speed."
    )
    moved = any(math.isfinite(b.tolerance_lower) for b in found)
    if moved:
        yield Paragraph(OVER_TOLERANCES)
    yield table(
        "< Shaft -> | From [rpm] -> from rpm | To [rpm] -> to rpm | < Order -> | Mode -> | Critical speed [rpm] | λ | "
        "From by formula [rpm] | To by formula [rpm]" + " | From, tolerances [rpm] | To, tolerances [rpm]" * moved,
        [
            (b.shaft, rpm(b.lower), rpm(b.upper), contributing(findings, b.order), _mode(findings, b), rpm(b.critical),
             number(b.critical / speed, 4) if speed else NONE, rpm(b.formula_lower), rpm(b.formula_upper),
             *(rpm(b.tolerance_lower), rpm(b.tolerance_upper)) * moved)
            for b in found
        ],
        f"Barred ranges ({rpm(speed)} rpm rated)" if speed else "Barred ranges",
        short="Barred ranges",
    )  # fmt: skip
    times = dict.fromkeys(one for check in findings.need(Checks).lines for one in check.times if check.barred)
    if times:
        cells = [
            (one.motion or "the only", rpm(one.lower), rpm(one.upper), number(one.seconds, 3),
             NONE if one.share is None else number(100.0 * one.share, 3), "ends within" if one.stays else "passes")
            for one in times
        ]  # fmt: skip
        titles = "< Motion over time | From [rpm] | To [rpm] | Within [s] | Reached, of the steady resonance [%] | <"
        yield table(titles, cells, "Motions over time within barred ranges; the rule has no limit of the time")


def _mode(findings: Findings, barred: BarredRange) -> str:
    """The mode that the order of a barred range excites at its critical speed."""
    if barred.order is None:
        return NONE
    return mode_near(findings, float(barred.order) * barred.critical / (2.0 * math.pi))


def _row(findings: Findings, check: Check) -> tuple[str, ...]:
    used = NONE if check.utilisation is None else number(100.0 * check.utilisation, 4)
    against = f"{check_words.value(check)} / {check_words.limit(check)} {check_words.unit(check)}".rstrip()
    return (
        f"{symbols(check.clause)}: {check.what}", check.where, against, used, rpm(check.speed),
        contributing(findings, check.order), f"{check_words.SIGNS[check.verdict]} {WORDS[check.verdict]}",
    )  # fmt: skip
