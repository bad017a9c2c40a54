"""The cover of a report: the verdict in a box, the train by its utilisation, its speeds, the worst checks."""

from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.response.amplitudes import Response
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output import check_words
from torsion.output.blocks import Block, PageEnd
from torsion.output.chapters import plant
from torsion.output.chapters.case_verdict import side_by_side
from torsion.output.check_words import is_judged, use_of_joint, use_of_part
from torsion.output.figures.figure import Band, Figure, Link, Place, Share, Shares, Sketch, Use
from torsion.output.figures.ranges import unanswered
from torsion.output.figures.speed_range import speed_range
from torsion.output.headline import box, case_name, judged, worst
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import RPM, symbols
from torsion.output.reported_values import (
    barred_rpm,
    rated_rpm,
    reference,
    unreliable,
    unstable_rpm,
)
from torsion.output.station_layout import layout
from torsion.results import listed
from torsion.rules.verdict_line import Check, Checks

MOST_BESIDE = 3  # failed checks of components that are not drawn, in words
MOST_CRITICAL = 5  # critical speeds that are drawn
MOST_SHARES = 5  # checks that are drawn
HEIGHT = 130.0  # px from the lowest to the highest axis of the sketch, at most
KEY = "Train with the utilisation of stress or torque; an outline with a sign marks a failed check. Not to scale"


def blocks(findings: Findings) -> Iterator[Block]:
    """One page: the verdict, the cases, the train by its utilisation, the speeds, and the worst checks."""
    train, joining = _train(findings)
    yield box(findings)
    case = f" (case {name})" if (name := case_name(findings)) else ""
    yield Figure("utilisation", KEY + case + "; ".join([joining, *train.beside]), (train,))
    yield from _speeds(findings)
    yield from _shares(findings)
    yield PageEnd()


def _train(findings: Findings) -> tuple[Sketch, str]:
    """The sketch with the use of every link that can be judged, and what is to be said where links are joined."""
    (found, joining), parts = plant.sketch(findings), findings.study.train.parts
    checks = _checks_of_parts(findings)
    links = tuple(_used(findings, link, checks) for link in found.links)
    discs = tuple(
        replace(disc, label=parts[int(disc.label.split()[0]) - 1].name if disc.label else "")
        for disc in found.discs
    )
    pointed = _pointed_at(findings, links, is_whole=not joining)
    return Sketch(
        discs, links, pointed, HEIGHT, _beside(findings, found, checks) if joining else ()
    ), joining


def _beside(findings: Findings, drawn: Sketch, checks: dict[int, list[Check]]) -> tuple[str, ...]:
    """What fails in components that are not drawn, the worst of them in words."""
    parts, place = findings.study.train.parts, layout(findings.system)
    shown = {part for link in drawn.links for part in link.parts}
    shown.update(int(disc.label.split()[0]) - 1 for disc in drawn.discs if disc.label)
    worst = {
        part: min(every, key=check_words.rank)
        for part, every in checks.items()
        if part not in shown
    }
    bad = sorted(
        (part for part, one in worst.items() if one.fails),
        key=lambda part: check_words.rank(worst[part]),
    )
    stated = [
        f"{check_words.use(worst[part]).words}: {parts[part].name}, "
        + (
            "on a branch that is not drawn"
            if place.row[parts[part].stations[-1]]
            else "drawn together with others"
        )
        for part in bad
        if parts[part].stations
    ]
    more = len(stated) - MOST_BESIDE
    return tuple(
        stated
        if more <= 0
        else [*stated[:MOST_BESIDE], f"✗ {more} more components with a failed check"]
    )


def _pointed_at(
    findings: Findings, links: tuple[Link, ...], *, is_whole: bool
) -> tuple[Place, Use] | None:
    """The place of the worst check, and its words; None where it is no single place, or has no share."""
    check = worst(findings)
    place = None if check is None else _place(findings, links, check, is_whole=is_whole)
    if check is None or place is None or (check.utilisation is None and not check.fails):
        return None
    title, found = "worst" if check.fails else "largest", check_words.use(check)
    return place, replace(
        found, words=f"{title}: {found.words.partition(' ')[2]}, {symbols(check.clause)}"
    )


def _part_of(findings: Findings) -> dict[str, int]:
    """The component that the name in a check stands for: its own, or that of one of its spans."""
    spans = {span.name: span.part for span in findings.system.spans}
    return spans | {part.name: position for position, part in enumerate(findings.study.train.parts)}


def _about(check: Check, part_of: dict[str, int]) -> tuple[int, ...]:
    """The components that a check is about, the worst first; none of the train as a whole."""
    return check.parts or ((part_of[check.where],) if check.where in part_of else ())


def _checks_of_parts(findings: Findings) -> dict[int, list[Check]]:
    """The checks of every component."""
    part_of, found = _part_of(findings), defaultdict[int, list[Check]](list)
    for check in findings.need(Checks).lines:
        for part in _about(check, part_of):
            found[part].append(check)
    return found


def _used(findings: Findings, link: Link, checks: dict[int, list[Check]]) -> Link:
    """A link with its use; a joint that does not fail, and a gear or crank that no rule judges, stay as they are."""
    mine = [check for part in link.parts for check in checks.get(part, [])]
    if link.kind == "run":
        return replace(link, use=use_of_part(mine))
    if link.kind not in ("shaft", "coupling", "gear", "crank", "joint") or (
        link.kind in ("gear", "crank") and not mine
    ):
        return replace(link, label="")
    used = use_of_joint(mine) if link.kind == "joint" else use_of_part(mine)
    name = findings.study.train.parts[link.parts[0]].name if link.parts else link.label
    return replace(link, label=name if used else "", use=used)


def _place(
    findings: Findings, links: tuple[Link, ...], check: Check, *, is_whole: bool
) -> Place | None:
    """x and row of what a check is about; None where that is no single place, or a point of a joined sketch."""
    part = next(iter(_about(check, _part_of(findings))), None)
    if part is None:
        return None
    for link in links:
        if part in link.parts:
            return (link.start[0] + link.end[0]) / 2, link.end[1]
    stations, place = findings.study.train.parts[part].stations, layout(findings.system)
    return (
        (float(place.x[stations[0]]), float(place.row[stations[0]]))
        if stations and is_whole
        else None
    )


def _speeds(findings: Findings) -> Iterator[Figure]:
    """Nothing where the scene has no range of speeds."""
    speeds = findings.study.operation.speeds
    if speeds is None:
        return
    response, unknown = findings.get(Response), tuple[Band, ...]()
    if response is not None and np.any(unreliable(findings)):
        _, unknown = unanswered(response.speed * RPM, unreliable(findings))
    critical = [
        (one.speed * RPM, one.line.named().partition(" (")[0]) for one in strongest(findings)
    ]
    bars, unstable = barred_rpm(findings), unstable_rpm(findings)
    ranges = listed(
        [kind for kind, found in (("barred", bars), ("unstable", unstable)) if len(found)]
    )
    several = f"{len(critical)} critical speeds" if len(critical) > 1 else "critical speed"
    largest = several if response is None else f"{several} with the largest torque"
    restricted = f"{ranges} range{'s' * (len(bars) + len(unstable) > 1)}"
    each = (
        (restricted, ranges),
        ("ranges without a reliable response", unknown),
        (largest, critical),
    )
    drawn = [words for words, is_there in each if is_there]
    caption = f"Operating speeds of {reference(findings)}" + (f": {listed(drawn)}" if drawn else "")
    yield of_torsion(
        findings,
        speed_range(
            "speeds",
            caption,
            speeds=(speeds.first * RPM, speeds.last * RPM),
            rated=rated_rpm(findings),
            barred=bars,
            unstable=unstable,
            unknown=unknown,
            critical=critical,
        ),
    )


def strongest(findings: Findings) -> list[CriticalSpeed]:
    """The critical speeds in the range at which their order has the largest torque, by speed."""
    found = findings.get(CriticalSpeeds)
    inside = [] if found is None else [one for one in found.crossings if one.is_inside]
    size = partial(_strength, findings, findings.get(Response))
    return sorted(sorted(inside, key=size, reverse=True)[:MOST_CRITICAL], key=lambda one: one.speed)


def _strength(findings: Findings, response: Response | None, critical: CriticalSpeed) -> float:
    """The largest torque of the order at the computed speed next to a critical one, referred, N m."""
    lines = (
        []
        if response is None
        else [k for k, line in enumerate(response.lines) if line.order == critical.order]
    )
    if response is None or not lines:
        return 0.0
    at = int(np.argmin(np.abs(response.speed - critical.speed)))
    if response.status[at, lines[0]] != Status.OK:
        return float("inf")
    return float(
        (np.abs(response.torque[at, lines[0]]) * findings.system.span_ratio).max(initial=0.0)
    )


def _shares(findings: Findings) -> Iterator[Figure]:
    """The worst checks over all judged cases; nothing if no check has a utilisation."""
    cases = judged(findings.each) if findings.cases else {"": findings}
    rows = [
        row
        for row in side_by_side(cases)
        if is_judged(row.check) and (row.check.utilisation is not None or row.check.fails)
    ]
    if not rows:
        return
    shares = tuple(
        Share(
            row.check.where,
            symbols(row.check.clause) + f" ({row.worst})" * bool(row.worst),
            np.inf if row.check.utilisation is None else row.check.utilisation,
            check_words.use(row.check),
        )
        for row in rows[:MOST_SHARES]
    )
    few = (
        f"the {MOST_SHARES} worst of {len(rows)} checks"
        if len(rows) > MOST_SHARES
        else "worst first"
    )
    yield Figure("shares", f"Utilisation of the limits, {few}", (Shares(shares),))
