"""The cover of a report: the verdict in a box, the train by its utilisation, its speeds, the worst checks."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.component_loads import ComponentLoads
from torsion.findings import Findings
from torsion.output import check_words
from torsion.output.blocks import Block, PageEnd
from torsion.output.chapters import plant
from torsion.output.chapters.case_verdict import side_by_side
from torsion.output.check_words import use_of_joint, use_of_part
from torsion.output.drawing.words import fitted
from torsion.output.figures.figure import (
    Axis,
    Band,
    Figure,
    Level,
    Link,
    Panel,
    Place,
    Share,
    Shares,
    Use,
)
from torsion.output.figures.ranges import SPEED, barred_bands, rated_level, unanswered
from torsion.output.headline import box, case_name, judged, worst
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import RPM, number, symbols
from torsion.output.reported_values import (
    barred_rpm,
    rated_rpm,
    reference,
    unstable_rpm,
    widened,
)
from torsion.output.station_layout import layout
from torsion.results import listed
from torsion.rules.verdict_line import Check, Checks

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
    yield from _shares(findings)
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
        point = _position(findings, links, about(first)[0])
        title, use = "worst" if first.fails else "largest", check_words.use(first)
        words = f"{title}: {use.words.partition(' ')[2]}, {symbols(first.clause)}"
        pointed = None if point is None else (point, replace(use, words=words))
    case = f" (case {name})" if (name := case_name(findings)) else ""
    drawn = replace(sketch, discs=discs, links=tuple(links), worst=pointed, height=HEIGHT)
    yield Figure("utilisation", KEY + case, (drawn,))


def _position(findings: Findings, links: list[Link], part: int) -> Place | None:
    """Return x and row of a component in the sketch; None if it is not drawn."""
    for link in links:
        if part in link.parts:
            return (link.start[0] + link.end[0]) / 2, link.end[1]
    stations, places = findings.study.train.parts[part].stations, layout(findings.system)
    return (float(places.x[stations[0]]), float(places.row[stations[0]])) if stations else None


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
    caption = f"Operating speeds of {reference(findings)}" + (f": {listed(drawn)}" if drawn else "")
    levels, ends = list(rated_level(rated_rpm(findings))), [speeds.first * RPM, speeds.last * RPM]
    operation = Band("speeds of the operation", ends[0], ends[1], "range")
    for level in levels:
        ends.append(level.value)
        levels[0] = replace(level, label=f"rated {number(level.value, 4)}")
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
    critical = findings.get(CriticalSpeeds)
    inside = (
        []
        if critical is None
        else [crossing for crossing in critical.crossings if crossing.is_inside]
    )
    loads = findings.get(ComponentLoads)
    peaks = () if loads is None else loads.peaks

    def strength(critical: CriticalSpeed) -> float:
        """Return the largest torque (N m, referred) of the order at a peak of the mode."""
        name = critical.line.named(reference(findings))
        meeting = (p.referred for p in peaks if (p.order, p.mode) == (name, critical.mode))
        return max(meeting, default=0.0)

    largest = sorted(inside, key=strength, reverse=True)[:MOST_CRITICAL]
    return sorted(largest, key=lambda crossing: crossing.speed)


def _shares(findings: Findings) -> Iterator[Figure]:
    """Yield the worst checks over all judged cases; nothing if no check has a utilisation."""
    cases = judged(findings.each) if findings.cases else {"": findings}
    rows = [
        (row.check, f" ({row.worst})" * bool(row.worst))
        for row in side_by_side(cases)
        if row.check.has_limit and (row.check.utilisation is not None or row.check.fails)
    ]
    if not rows:
        return
    shares = tuple(
        Share(
            check.where,
            symbols(check.clause) + case,
            np.inf if check.utilisation is None else check.utilisation,
            check_words.use(check),
        )
        for check, case in rows[:MOST_SHARES]
    )
    few = (
        f"the {MOST_SHARES} worst of {len(rows)} checks"
        if len(rows) > MOST_SHARES
        else "worst first"
    )
    yield Figure("shares", f"Utilisation of the limits, {few}", (Shares(shares),))
