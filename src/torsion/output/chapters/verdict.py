"""Chapters: the cover; the checks with barred ranges and remarks; remarks on the checks that pass."""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, Heading, PageEnd, Paragraph, Points, table
from torsion.output.chapters import plant
from torsion.output.chapters.case_comparison import overview, side_by_side
from torsion.output.check_words import STRESS, contributing, quoted, use_of_joint, use_of_part
from torsion.output.drawing.words import fitted
from torsion.output.figures.curves import SPEED, barred_bands, rated_level, unanswered
from torsion.output.figures.figure import (
    Axis,
    Band,
    Figure,
    Level,
    Panel,
    Share,
    Shares,
    Use,
)
from torsion.output.headline import box, case_name, worst
from torsion.output.headline import judged as judged_cases
from torsion.output.numbers import RPM, counted, number, rpm, symbols
from torsion.output.reported_values import (
    band_words,
    barred,
    barred_rpm,
    mode_of,
    of_torsion,
    rated,
    rated_rpm,
    unstable_rpm,
    widened,
)
from torsion.output.station_layout import layout
from torsion.results import listed
from torsion.rules.verdict_line import TO_BE_VERIFIED, WORDS, Check, Checks

MOST_CRITICAL = 5  # critical speeds that are drawn
MOST_SHARES = 5  # checks that are drawn
SPEEDS_HEIGHT, ROOM = 46.0, 0.03  # px; of the range of speeds, free beyond its ends
LONGEST = 480.0  # px of the names of all orders together
HEIGHT = 130.0  # px from the lowest to the highest axis of the sketch, at most
KEY = "Train with the utilisation of stress or torque; a red outline marks a failed check. Not to scale"
ALWAYS_GRADED, GRADED_IF_JUDGED = ("shaft", "coupling", "joint"), ("gear", "crank")  # links


def blocks(findings: Findings) -> Iterator[Block]:
    """Yield one page: the verdict, the train by its utilisation, the speeds, and the worst checks."""
    yield box(findings)
    yield from _train(findings)
    yield from _speeds(findings)
    # The worst checks over all judged cases; nothing if no check has a utilisation.
    cases = judged_cases(findings.each) if findings.cases else {"": findings}
    rows = [
        row
        for row in side_by_side(cases)
        if row.check.has_limit and (row.check.utilisation is not None or row.check.fails)
    ]
    shares = []
    for row in rows[:MOST_SHARES]:
        used = np.inf if row.check.utilisation is None else row.check.utilisation
        clause = symbols(row.check.clause) + f" ({row.worst})" * bool(row.worst)
        shares.append(Share(row.check.where, clause, used, check_words.use(row.check)))
    if shares:
        few = f"the {MOST_SHARES} worst of {len(rows)} checks"
        few = few if len(rows) > MOST_SHARES else "worst first"
        yield Figure("shares", f"Utilisation of the limits, {few}", (Shares(tuple(shares)),))
    yield PageEnd()


def _train(findings: Findings) -> Iterator[Figure]:
    """Yield the sketch with the use of every link that can be judged; nothing for a train too long for a page."""
    sketch, parts = plant.sketch(findings), findings.study.train.parts
    if len(sketch.links) > plant.MOST_LINKS:
        return
    # The name in a check is that of a component, or of one of its spans.
    part_of = {span.name: span.part for span in findings.system.spans}
    part_of |= {part.name: position for position, part in enumerate(parts)}

    def about(check: Check) -> tuple[int, ...]:
        return check.parts or ((part_of[check.where],) if check.where in part_of else ())

    checks = defaultdict[int, list[Check]](list)
    for check in findings.need(Checks).lines:
        for part in about(check):
            checks[part].append(check)

    links = []
    for link in sketch.links:
        about_link = [check for part in link.parts for check in checks.get(part, [])]
        use: Use | None = None
        if link.kind in ALWAYS_GRADED or (link.kind in GRADED_IF_JUDGED and about_link):
            use = (use_of_joint if link.kind == "joint" else use_of_part)(about_link)
        name = parts[link.parts[0]].name if link.parts else link.label
        links.append(replace(link, label=name if use else "", use=use))
    discs = tuple(
        replace(disc, label=parts[int(disc.label.split()[0]) - 1].name if disc.label else "")
        for disc in sketch.discs
    )

    first, pointed = worst(findings), None
    if first is not None and (first.utilisation is not None or first.fails) and about(first):
        # Where the component stands in the sketch, if it is drawn.
        part, point = about(first)[0], None
        stations, places = parts[part].stations, layout(findings.system)
        if drawn_links := [link for link in links if part in link.parts]:
            start, end = drawn_links[0].start, drawn_links[0].end
            point = (start[0] + end[0]) / 2, end[1]
        elif stations:
            point = float(places.x[stations[0]]), float(places.row[stations[0]])
        title, use = "worst" if first.fails else "largest", check_words.use(first)
        words = f"{title}: {use.words.partition(' ')[2]}, {symbols(first.clause)}"
        pointed = None if point is None else (point, replace(use, words=words))
    case = f" (case {name})" if (name := case_name(findings)) else ""
    drawn = replace(sketch, discs=discs, links=tuple(links), worst=pointed, height=HEIGHT)
    yield Figure("utilisation", KEY + case, (drawn,))


def _speeds(findings: Findings) -> Iterator[Figure]:
    """Yield the axis of speeds; nothing where the file has no range of speeds."""
    speeds = findings.study.operation.speeds
    if speeds is None:
        return
    response, unreliable_bands = findings.get(Response), tuple[Band, ...]()
    if response is not None and np.any(response.unreliable):
        _, unreliable_bands = unanswered(response.speed * RPM, response.unreliable)
    critical = [
        (crossing.speed * RPM, crossing.line.named().partition(" (")[0])
        for crossing in strongest(findings)
    ]
    barred, unstable = barred_rpm(findings), unstable_rpm(findings)
    kinds = listed(
        [kind for kind, ranges in (("barred", barred), ("unstable", unstable)) if ranges]
    )
    plural = "s" * (len(barred) + len(unstable) > 1)
    several = f"{len(critical)} critical speeds" if len(critical) > 1 else "critical speed"
    largest = several if response is None else f"{several} with the largest torque"
    drawn = [f"{kinds} range{plural}"] if kinds else []
    drawn += ["ranges without a reliable response"] if unreliable_bands else []
    drawn += [largest] if critical else []
    caption = f"Operating speeds of {findings.study.reference}" + (
        f": {listed(drawn)}" if drawn else ""
    )
    levels, ends = list[Level](), [speeds.first * RPM, speeds.last * RPM]
    operation = Band("speeds of the operation", ends[0], ends[1], "range")
    for level in rated_level(rated_rpm(findings)):
        ends.append(level.value)
        levels.append(replace(level, label=f"rated {number(level.value, 4)}"))
    for speed, words in critical:
        label = f"{number(speed, 4)}: {fitted(words, LONGEST / len(critical))}"
        levels.append(Level("critical speed", speed, "second limit", "x", label))
    ranges = [
        replace(band, label=f"{band.kind} {' to '.join(widened((band.low, band.high)))}")
        for band in barred_bands(barred, unstable)
    ]
    room = ROOM * ((max(ends) - min(ends)) or max(ends))
    x = Axis(SPEED.quantity, SPEED.unit, max(min(ends) - room, 0.0), max(ends) + room)
    y, bands = Axis("", "", 0.0, 1.0, places=((0.0, ""),)), (operation, *ranges, *unreliable_bands)
    plot = Panel(x, y, (), tuple(levels), bands, height=SPEEDS_HEIGHT)
    yield of_torsion(findings, Figure("speeds", caption, (plot,)))


def strongest(findings: Findings) -> list[CriticalSpeed]:
    """Return the critical speeds in the range at which their order has the largest torque, by speed."""
    critical, loads = findings.get(CriticalSpeeds), findings.get(ComponentLoads)
    inside = [crossing for crossing in critical.crossings if crossing.is_inside] if critical else []
    strength = defaultdict[tuple[Any, ...], float](float)  # N m, referred, by order and mode
    for peak in () if loads is None else loads.peaks:
        key = peak.order, peak.mode
        strength[key] = max(strength[key], peak.referred)
    axis = findings.study.reference
    largest = sorted(inside, key=lambda speed: -strength[speed.line.named(axis), speed.mode])
    return sorted(largest[:MOST_CRITICAL], key=lambda crossing: crossing.speed)


MOST_NAMED = 12  # components without a source that are named
UNCONFIRMED = (
    "Limits with 'edition not confirmed' follow the published practice of the rule named. Compare them with the "
    "edition in force."
)


def chapter(findings: Findings) -> Iterator[Block]:
    """Yield the cover of every report, and the checks on the page after it."""
    case = findings.study.case
    yield Heading("Verdict" if case is None else f"Verdict of the case {case.name}", at_end=True)
    yield from blocks(findings)
    if findings.cases:
        yield overview(findings.each)
    name = case_name(findings)
    heading = f"Checks of the case {name}" if name else "Checks"
    yield from _details(findings, Heading(heading, at_end=True))

    # The shafts whose stress no rule judges, and why.
    checked = {check.where for check in findings.need(Checks).lines if check.unit == STRESS}
    reasons = {
        what.rpartition(" for ")[2]: why for what, why in findings.plan.left_out if " for " in what
    }
    about, train = dict[str, list[str]](), findings.study.train
    for bar in train.bars if findings.study.rules else ():
        if bar.name not in checked:
            reason = reasons.get(bar.name, "no rule of the file applies")
            about.setdefault(reason, []).append(quoted(bar.name))
    if about:
        words = "; ".join(f"{listed(names)} ({why})" for why, names in about.items())
        yield Paragraph(f"Shaft stress not checked: {words}.", "note")

    # How many components and excitations have no `source` for their data.
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
    about: dict[str, list[str]] = {}
    for check in checks:
        if check.note:
            # A check of several parts lists them itself.
            name = check.where if len(check.parts) > 1 else quoted(check.where)
            about.setdefault(f"{check.what}: {symbols(check.note)}", []).append(name)
    if about:
        yield Heading(title, level)
        yield Points(
            tuple(f"{listed(dict.fromkeys(names))}: {note}" for note, names in about.items())
        )


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
