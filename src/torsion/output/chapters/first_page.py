"""The first page of a report: the verdict in a box, the train by its utilisation, its speeds, and shares of limits."""

from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import replace
from functools import partial

import numpy as np

from torsion.analyses.critical import CriticalSpeed, CriticalSpeeds
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.sweep.sweep_results import Sweep
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output import check_words
from torsion.output.blocks import Block, Box, PageEnd
from torsion.output.chapters import closing, plant
from torsion.output.check_words import contributing, is_judged, use_of_joint, use_of_part
from torsion.output.figures.figure import Band, Figure, Link, Place, Share, Shares, Sketch, Use, runs
from torsion.output.figures.ranges import unanswered
from torsion.output.figures.speed_range import speed_range
from torsion.output.headline import headline
from torsion.output.nearest_criticals import of_torsion
from torsion.output.numbers import RPM, counted, number, rpm, symbols
from torsion.output.reported_values import (
    band_words,
    barred,
    barred_rpm,
    failed,
    mode_near,
    operation_words,
    rated_rpm,
    reference,
    unreliable,
    unstable_rpm,
)
from torsion.output.scene import checksum
from torsion.output.station_layout import layout
from torsion.results import listed
from torsion.rules.verdict_line import TO_BE_VERIFIED, Check, Checks

MOST_BARRED, MOST_UNANSWERED = 3, 3  # stated one by one in the box
MOST_BESIDE = 3  # failures that are not drawn, in words
MOST_CRITICAL = 5  # critical speeds that are drawn
MOST_SHARES, FEWEST_SHARES = 20, 8  # shares of limits that are drawn
LETTERS, USUAL_ROWS = 115, 8  # of a row of the box, and its rows beside which MOST_SHARES have room on A4
LEAST_FOR_SPEEDS = -6  # shares for which there is room, below two boxes, where the speeds have room
BRANCHES = 13  # shares for which another row of the sketch leaves no room
HEIGHT = 190.0  # px from the lowest to the highest axis of the sketch, at most


def box(findings: Findings) -> Box:
    """The verdict, its worst place, what is barred and unanswered, and how many checks there are of each verdict."""
    checks = findings.need(Checks).lines
    said = closing.overall(findings).text
    lines = [
        ("Conclusion", said),
        *sweep_line(findings),
        *_design_line(findings),
        *_engines_line(findings),
        *worst_line(findings),
    ]
    lines += [("Barred ranges", "; ".join(words)) for words in [_barred_words(findings)] if words]
    if others := closing.other_restrictions(findings, is_barred=bool(barred(findings))):
        lines.append(("Speeds", " ".join(others)))
    unknown = [f"{one.what}, because {one.words}" for one in findings.plan.unanswered]
    if unknown:
        lines.append(("No answer", "; ".join(unknown[:MOST_UNANSWERED]) + _more(len(unknown) - MOST_UNANSWERED)))
    lines += [("Also", one.text) for one in closing.beside(findings)]
    if checks:
        lines.append(("Checks", _counts(findings, checks)))
    lines.append(("Calculated", _basis(findings)))
    (sign, words), kind = headline(findings)
    return Box(sign, f"Case {case}: {words}" if (case := case_name(findings)) else words, kind, tuple(lines))


def case_name(findings: Findings) -> str:
    """The case that the findings are of; empty of a file without cases."""
    return next(iter(findings.each)) if findings.cases or findings.study.case is not None else ""


def worst(findings: Findings) -> Check | None:
    """The check that ranks first of those with a limit."""
    return min(filter(is_judged, findings.need(Checks).lines), key=check_words.rank, default=None)


def worst_line(findings: Findings) -> Iterator[tuple[str, str]]:
    """The worst check with value, limit, speed and component."""
    check = worst(findings)
    if check is None or (check.utilisation is None and not check.fails):
        return
    against = f"{check_words.value(check)} against {check_words.limit(check)} {check_words.unit(check)}".rstrip()
    share = check.utilisation
    used = "" if share is None or np.isinf(share) else f", {check_words.percent(share)} of the limit"
    at = "" if check.speed is None else f", at {rpm(check.speed)} rpm"
    order = "" if check.order is None else f", mostly order {contributing(findings, check.order)}"
    order += f", with {check.misfire}" if check.misfire else ""
    clause = f"{symbols(check.clause)}, {check.rule}; limit: {check.standing}"
    title = "Worst check" if check.fails else "Largest use"
    yield title, f"{check.where}: {check.what} {against}{used}{at}{order} ({clause})"


def _design_line(findings: Findings) -> Iterator[tuple[str, str]]:
    """What a design chose; nothing where there is none."""
    if "design" in findings.results:
        from torsion.output.chapters.design import design_line

        yield from design_line(findings)


def _engines_line(findings: Findings) -> Iterator[tuple[str, str]]:
    """What misfires; nothing where every cylinder fires alike."""
    if any(part.engine is not None for part in findings.study.train.parts):
        from torsion.output.chapters.engine_states import states

        if words := listed(states(findings), "; "):
            yield "Judged with", words


def sweep_line(findings: Findings) -> Iterator[tuple[str, str]]:
    """How many variants of a sweep fail a check; nothing where none was judged."""
    found = findings.get(Sweep)
    whole = None if found is None else found.any_fails
    if found is None or whole is None:
        return
    if found.method == "grid":
        fail = f"{whole.failing:,} of {counted(found.samples, 'variant')} fail a check{_turns(found)}"
        interval = ""
    else:
        share, low, high = (number(100.0 * (one or 0.0), 3) for one in (whole.probability, whole.lower, whole.upper))
        fail = (
            f"{share} % of the variants fail a check" if whole.failing else f"none of {found.samples:,} variants fails"
        )
        interval = f" ({low} to {high} %)"
    passes = not (failed(findings) or findings.need(Checks).is_partial)
    kept = ", although no check of the file as it stands does" if whole.failing and passes else ""
    without = f"; {found.unsolved} without an answer among them" if found.unsolved else ""
    yield "Sweep", f"{fail}{interval}{kept}{without}"


def _turns(found: Sweep) -> str:
    """Along a curve, between which values the variants begin or cease to fail."""
    grid = found.grid
    if grid is None or len(grid.axes) != 1 or not grid.axes[0].is_numeric:
        return ""
    axis, edges = grid.axes[0], runs(grid.fails)
    ranges = [axis.words[a] if a == b else f"{axis.words[a]} to {axis.words[b]}" for a, b in edges[:MOST_BARRED]]
    return f": {axis.name} {listed(ranges)}{_more(len(edges) - MOST_BARRED)}" if ranges else ""


def _barred_words(findings: Findings) -> list[str]:
    """The barred ranges in their short form."""
    found = []
    for one in barred(findings):
        parts = [band_words((one.lower * RPM, one.upper * RPM)), one.shaft]
        if one.order is not None:
            mode = mode_near(findings, float(one.order) * one.critical / (2.0 * np.pi))
            parts += [f"order {contributing(findings, one.order)}", f"mode {mode}"]
        if np.isfinite(one.formula_lower):
            parts.append(f"by formula {band_words((one.formula_lower * RPM, one.formula_upper * RPM))}")
        found.append(", ".join(parts))
    more = len(found) - MOST_BARRED
    return found if more <= 0 else [*found[:MOST_BARRED], f"{more} more in the table of barred ranges"]


def _more(count: int) -> str:
    return f" and {count} more" if count > 0 else ""


def _counts(findings: Findings, checks: tuple[Check, ...]) -> str:
    """How many checks there are of each verdict."""
    doubt = sum(check.standing == TO_BE_VERIFIED for check in checks)
    unknown = len(findings.plan.unanswered)
    return (
        f"{len(checks)}: {findings.need(Checks).counts}; {doubt} with a limit to be verified; "
        f"{unknown or 'no'} {'analysis' if unknown == 1 else 'analyses'} without an answer"
    )


def _basis(findings: Findings) -> str:
    """By which rules, for which speeds, from which file."""
    study = findings.study
    rules = listed(name for name, _ in study.rules) or "no rule requested"
    digest = checksum(study)
    parts = [
        f"rules: {rules}",
        operation_words(findings),
        study.shown_file,
        f"SHA-256 begins {digest[:12]}" if digest else "",
    ]
    return "; ".join(filter(None, parts))


def blocks(findings: Findings, notes: Iterable[Block], taken: int = 0) -> Iterator[Block]:
    """One A4: the box, the train by its utilisation, the speeds, as many shares of limits as have room, and notes.

    Where few have, they are the first thing behind its end, and before them the speeds where these have no room either.
    `taken`: rows of the page that stand before the box.
    """
    verdict, (train, joining) = box(findings), _train(findings)
    axes = {row for link in train.links for row in (link.start[1], link.end[1])}
    rows = taken + rows_of(verdict)
    most = MOST_SHARES - BRANCHES * max(len(axes) - 1, 0) - max(rows - USUAL_ROWS, 0)
    shares = tuple(_shares(findings, most if most >= FEWEST_SHARES else MOST_SHARES))
    yield verdict
    yield Figure(
        "utilisation",
        "The train: shafts, couplings and gears in colour and pattern of their largest utilisation (value / limit) of "
        "stress or torque, and joints that fail. Outlined with a sign: a limit of any kind is exceeded. Not to scale"
        + "; ".join([joining, *train.beside]),
        (train,),
    )
    speeds, behind = tuple(_speeds(findings)), bool(taken) and most < LEAST_FOR_SPEEDS
    yield from () if behind else speeds
    yield from shares if most >= FEWEST_SHARES else ()
    yield from notes
    yield PageEnd()
    yield from speeds if behind else ()
    yield from shares if most < FEWEST_SHARES else ()


def rows_of(made: Box) -> int:
    """Rows of text that a box has on A4."""
    return sum(-(-len(text) // LETTERS) for _, text in made.lines)


def _train(findings: Findings) -> tuple[Sketch, str]:
    """The sketch with the use of every link that can be judged, and what is to be said where links are joined."""
    (found, joining), parts = plant.sketch(findings), findings.study.train.parts
    checks = _checks_of_parts(findings)
    links = tuple(_used(findings, link, checks) for link in found.links)
    discs = tuple(
        replace(disc, label=parts[int(disc.label.split()[0]) - 1].name if disc.label else "") for disc in found.discs
    )
    pointed = _pointed_at(findings, links, is_whole=not joining)
    return Sketch(discs, links, pointed, HEIGHT, _beside(findings, found, checks) if joining else ()), joining


def _beside(findings: Findings, drawn: Sketch, checks: dict[int, list[Check]]) -> tuple[str, ...]:
    """What fails in components that are not drawn, the worst of them in words."""
    parts, place = findings.study.train.parts, layout(findings.system)
    shown = {part for link in drawn.links for part in link.parts}
    shown.update(int(disc.label.split()[0]) - 1 for disc in drawn.discs if disc.label)
    worst = {part: min(every, key=check_words.rank) for part, every in checks.items() if part not in shown}
    bad = sorted((part for part, one in worst.items() if one.fails), key=lambda part: check_words.rank(worst[part]))
    stated = [
        f"{check_words.use(worst[part]).words}: {parts[part].name}, "
        + ("on a branch that is not drawn" if place.row[parts[part].stations[-1]] else "which is joined with others")
        for part in bad
        if parts[part].stations
    ]
    more = len(stated) - MOST_BESIDE
    return tuple(stated if more <= 0 else [*stated[:MOST_BESIDE], f"✗ {more} more that fail are not drawn"])


def _pointed_at(findings: Findings, links: tuple[Link, ...], *, is_whole: bool) -> tuple[Place, Use] | None:
    """The place of the worst check, and its words; None where it is no single place, or has no share."""
    check = worst(findings)
    place = None if check is None else _place(findings, links, check, is_whole=is_whole)
    if check is None or place is None or (check.utilisation is None and not check.fails):
        return None
    title, found = "worst" if check.fails else "largest use", check_words.use(check)
    return place, replace(found, words=f"{title}: {found.words.partition(' ')[2]}, {symbols(check.clause)}")


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


def _place(findings: Findings, links: tuple[Link, ...], check: Check, *, is_whole: bool) -> Place | None:
    """x and row of what a check is about; None where that is no single place, or a point of a joined sketch."""
    part = next(iter(_about(check, _part_of(findings))), None)
    if part is None:
        return None
    for link in links:
        if part in link.parts:
            return (link.start[0] + link.end[0]) / 2, link.end[1]
    stations, place = findings.study.train.parts[part].stations, layout(findings.system)
    return (float(place.x[stations[0]]), float(place.row[stations[0]])) if stations and is_whole else None


def _speeds(findings: Findings) -> Iterator[Figure]:
    """Nothing where the scene has no range of speeds."""
    speeds = findings.study.operation.speeds
    if speeds is None:
        return
    response, unknown = findings.get(Response), tuple[Band, ...]()
    if response is not None and np.any(unreliable(findings)):
        _, unknown = unanswered(response.speed * RPM, unreliable(findings))
    critical = [(one.speed * RPM, one.line.named().partition(" (")[0]) for one in strongest(findings)]
    bars, unstable = barred_rpm(findings), unstable_rpm(findings)
    ranges = listed([kind for kind, found in (("barred", bars), ("unstable", unstable)) if len(found)])
    several = f"{len(critical)} critical speeds" if len(critical) > 1 else "critical speed"
    largest = f"the {several}{'' if response is None else ' with the largest torque'}"
    restricted = f"{ranges} range{'s' * (len(bars) + len(unstable) > 1)}"
    each = ((restricted, ranges), ("ranges without an answer", unknown), (largest, critical))
    drawn = [words for words, is_there in each if is_there]
    caption = f"Speeds of {reference(findings)}" + (f": {listed(drawn)}" if drawn else " in operation")
    yield of_torsion(findings, speed_range(
        "speeds", caption, speeds=(speeds.first * RPM, speeds.last * RPM), rated=rated_rpm(findings),
        barred=bars, unstable=unstable, unknown=unknown, critical=critical,
    ))  # fmt: skip


def strongest(findings: Findings) -> list[CriticalSpeed]:
    """The critical speeds in the range at which their order has the largest torque, by speed."""
    found = findings.get(CriticalSpeeds)
    inside = [] if found is None else [one for one in found.crossings if one.is_inside]
    size = partial(_strength, findings, findings.get(Response))
    return sorted(sorted(inside, key=size, reverse=True)[:MOST_CRITICAL], key=lambda one: one.speed)


def _strength(findings: Findings, response: Response | None, critical: CriticalSpeed) -> float:
    """The largest torque of the order at the computed speed next to a critical one, referred, N m."""
    lines = [] if response is None else [k for k, line in enumerate(response.lines) if line.order == critical.order]
    if response is None or not lines:
        return 0.0
    at = int(np.argmin(np.abs(response.speed - critical.speed)))
    if response.status[at, lines[0]] != Status.OK:
        return float("inf")
    return float((np.abs(response.torque[at, lines[0]]) * findings.system.span_ratio).max(initial=0.0))


def _shares(findings: Findings, most: int) -> Iterator[Figure]:
    """The largest shares of limits, those first that fail; nothing where no check has one."""
    checks = sorted(filter(is_judged, findings.need(Checks).lines), key=check_words.rank)
    shown = [one for one in checks if one.utilisation is not None or one.fails]
    if not shown:
        return
    rows = tuple(
        Share(one.where, symbols(one.clause), np.inf if one.utilisation is None else one.utilisation,
              check_words.use(one))
        for one in shown[:most]
    )  # fmt: skip
    rest = f" (the first {most} of {len(shown)})" if len(shown) > most else ""
    yield Figure("shares", f"Share of each limit used, worst first{rest}", (Shares(rows),))
