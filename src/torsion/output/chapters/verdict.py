"""Chapters: the cover; the checks with barred ranges and remarks; remarks on the checks that pass."""

import math
from collections.abc import Iterable, Iterator, Sequence

from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.chapters import first_page
from torsion.output.chapters.case_verdict import overview
from torsion.output.check_words import STRESS, contributing, quoted
from torsion.output.headline import box, case_name
from torsion.output.numbers import NONE, counted, number, rpm, symbols
from torsion.output.reported_values import band_words, barred, barred_rpm, mode_near, rated
from torsion.results import listed
from torsion.rules.verdict_line import TO_BE_VERIFIED, WORDS, BarredRange, Check, Checks

MOST_NAMED = 12  # components without a source that are named
UNCONFIRMED = (
    "Limits with 'edition not confirmed' follow the published practice of the rule named. Compare them with the "
    "edition in force."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """The cover of every report, and the checks on the page after it."""
    case = findings.study.case
    yield Heading("Verdict" if case is None else f"Verdict of the case {case.name}", at_end=True)
    yield from first_page.blocks(findings)
    if findings.cases:
        yield overview(findings.each)
    yield from _details(
        findings,
        Heading(
            f"Checks of the case {name}" if (name := case_name(findings)) else "Checks", at_end=True
        ),
    )
    yield from _unjudged(findings)
    yield from _sources(findings)


def judged(findings: Findings) -> Iterator[Block]:
    """The verdict without pictures; nothing if no rule was applied."""
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
    yield _checks(findings, listed_checks)
    if omitted := len(checks) - len(listed_checks):
        yield Paragraph(
            f"{counted(omitted, 'more check')} below {check_words.SMALL} in results.json."
        )
    if editions := check_words.editions(checks):
        yield Paragraph(editions)
    if any(check.standing == TO_BE_VERIFIED for check in checks):
        yield Paragraph(UNCONFIRMED)
    yield from barred_ranges(findings)
    if remarks := _remarks(check for check in checks if check.verdict != "pass"):
        yield Heading("Remarks", 2)
        yield remarks


def _checks(findings: Findings, checks: Sequence[Check]) -> Table:
    return table(
        "< Check -> | < Component -> | Value -> | Limit -> | < Unit -> | Utilisation [%] -> util., % | "
        "Speed [rpm] | < Order | < Rule, clause and basis | < Verdict ->",
        [_row(findings, check) for check in checks],
        "Checks, each at its worst point, worst first. Order: the main contribution",
        marks=[check.verdict for check in checks],
        short="Checks, worst first",
        rows_in_summary=5,
    )


def remarks(findings: Findings) -> Iterator[Block]:
    """Appendix of the full report: remarks on the checks that pass."""
    if found := _remarks(check for check in findings.need(Checks).lines if check.verdict == "pass"):
        yield Heading("Appendix: remarks on the checks")
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
    reasons = {
        what.rpartition(" for ")[2]: why for what, why in findings.plan.left_out if " for " in what
    }
    about: dict[str, list[str]] = {}
    for bar in findings.study.train.bars if findings.study.rules else ():
        if bar.name not in judged:
            about.setdefault(reasons.get(bar.name, "no rule of the file applies"), []).append(
                quoted(bar.name)
            )
    if about:
        words = "; ".join(f"{listed(names)} ({why})" for why, names in about.items())
        yield Paragraph(f"Shaft stress not checked: {words}.", "note")


def _sources(findings: Findings) -> Iterator[Paragraph]:
    """How many components and excitations have no `source` for their data; nothing if all have one."""
    parts = [part for part in findings.study.train.parts if part.kind != "branch"]
    torques = [
        torque for torque in findings.study.train.torques if torque.path[:1] == ("excitations",)
    ]
    bare = [quoted(part.name) for part in parts if part.source is None]
    lacking = [f"{len(bare):,} of {counted(len(parts), 'component')}"] if bare else []
    if 0 < len(bare) <= MOST_NAMED:
        lacking[0] += f" ({', '.join(bare)})"
    if count := sum(torque.source is None for torque in torques):
        lacking.append(f"{count} of {counted(len(torques), 'excitation')}")
    if lacking:
        yield Paragraph(
            f"No `source` for the data of {' and '.join(lacking)}.".replace("`", ""), "note"
        )


OVER_TOLERANCES = (
    "The last two columns cover the critical speed at every combination of the tolerances, with the width of the rule. "
    "Only the critical speeds have guaranteed bounds. Stress is not monotonic in a parameter; the verdict is for the "
    "nominal input data."
)


def barred_ranges(findings: Findings) -> Iterator[Block]:
    """Nothing if no range is barred."""
    found, speed = barred(findings), rated(findings)
    if not found:
        return
    by = listed(dict.fromkeys(check.rule for check in findings.need(Checks).lines if check.barred))
    yield Paragraph(
        f"Barred for continuous operation: {'; '.join(map(band_words, barred_rpm(findings)))}. Pass the range rapidly, "
        "mark it on the tachometer and show it on a notice at every control station. The formula is 16 n_{c}/(18 − λ) "
        "to (18 − λ) n_{c}/16 with the critical speed n_{c} and λ = n_{c}/n_{rated}. The range is extended to every "
        f"speed at which the stress exceeds its limit, and by the tolerance of the tachometer ({by})."
    )
    moved = any(math.isfinite(b.tolerance_lower) for b in found)
    if moved:
        yield Paragraph(OVER_TOLERANCES)
    yield table(
        "< Shaft -> | From [rpm] -> from rpm | To [rpm] -> to rpm | < Order -> | Mode -> | Critical speed [rpm] | λ | "
        "From by formula [rpm] | To by formula [rpm]"
        + " | From, tolerances [rpm] | To, tolerances [rpm]"
        * moved,
        [
            (
                b.shaft,
                rpm(b.lower),
                rpm(b.upper),
                contributing(findings, b.order),
                _mode(findings, b),
                rpm(b.critical),
                number(b.critical / speed, 4) if speed else NONE,
                rpm(b.formula_lower),
                rpm(b.formula_upper),
                *(rpm(b.tolerance_lower), rpm(b.tolerance_upper)) * moved,
            )
            for b in found
        ],
        f"Barred ranges ({rpm(speed)} rpm rated)" if speed else "Barred ranges",
        short="Barred ranges",
    )
    times = dict.fromkeys(
        time for check in findings.need(Checks).lines for time in check.times if check.barred
    )
    if times:
        cells = [
            (
                passage.motion or "the only",
                rpm(passage.lower),
                rpm(passage.upper),
                number(passage.seconds, 3),
                NONE if passage.share is None else number(100.0 * passage.share, 3),
                "ends within" if passage.stays else "passes",
            )
            for passage in times
        ]
        titles = "< Transient | From [rpm] | To [rpm] | Time in the range [s] | Peak / steady resonance [%] | <"
        yield table(
            titles, cells, "Transients in barred ranges (the rule has no limit of the time)"
        )


def _mode(findings: Findings, barred: BarredRange) -> str:
    """The mode that the order of a barred range excites at its critical speed."""
    if barred.order is None:
        return NONE
    return mode_near(findings, float(barred.order) * barred.critical / (2.0 * math.pi))


def _row(findings: Findings, check: Check) -> tuple[str, ...]:
    used = NONE if check.utilisation is None else number(100.0 * check.utilisation, 4)
    return (
        check.what,
        check.where,
        check_words.value(check),
        check_words.limit(check),
        check_words.unit(check),
        used,
        rpm(check.speed),
        contributing(findings, check.order),
        f"{check.rule}: {symbols(check.clause)} ({check_words.basis(check)})",
        f"{check_words.SIGNS[check.verdict]} {WORDS[check.verdict]}",
    )
