"""Chapter: bending of the shafts: critical speeds, whirl over speed, the answer to the joints' secondary couples."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from torsion.analyses.lateral.couple_response import extent
from torsion.analyses.lateral.shaft_bending import Lateral, ShaftFound
from torsion.analyses.lateral.whirl import UNSTABLE, Critical, Whirl
from torsion.findings import Findings
from torsion.kernels.trees.tree_response import Status
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.figures.curves import (
    SPEED,
    amplitudes,
    highest_shown,
    met,
    rated_level,
    span,
    unanswered,
    whirling,
)
from torsion.output.figures.figure import Axis, Band, Figure, Level, Line, Marks, Panel
from torsion.output.numbers import RPM, Scale, number, rpm, scale
from torsion.output.reported_values import of_bending, rated_rpm
from torsion.output.stored.scene import highest

AXES = (
    "y is the normal of the plane of the joint upstream of the shaft (otherwise downstream), z is "
    "perpendicular to y and to the shaft. Joints hold their shafts in place and let them tilt. Supports are "
    "springs."
)
FARTHEST = 2.0  # times the highest speed: beyond it only the lowest two critical speeds of an order are printed
MICRO = 1e6
STANDING = "nearly singular: next to a resonance that nothing damps"
NO_ANSWER = "singular: no answer"
Range = tuple[float, float] | None  # lowest and highest reference speed, rad/s
Shafts = tuple[ShaftFound, ...]


def chapter(findings: Findings) -> Iterator[Block]:
    """Nothing where bending is not requested and no shaft has a support."""
    bending = findings.get(Lateral)
    if bending is None:
        return
    requested = (
        getattr(findings.study.analyses.get("lateral"), "speeds", None)
        or findings.study.operation.speeds
    )
    speeds = None if requested is None else (requested.first, requested.last)
    yield Heading("Bending of the shafts")
    yield Paragraph(f"Speeds are speeds of {findings.study.reference}. {AXES}")
    # Length, what supports it, and the lowest frequency of both planes without rotation.
    rows = []
    for shaft in bending.shafts:
        supports = ", ".join(f"{held.name} at {number(held.at, 4)} m" for held in shaft.point)
        rows.append((shaft, shaft.at_rest, supports))
    yield table(
        "name: < Shaft | length: Length [m] | ratio: Speed / reference | < Supports | "
        "y@1: Lowest frequency at rest, y [Hz]:6 | z@1: z [Hz]:6",
        rows,
        "Shafts and their supports",
    )
    yield _criticals(bending.shafts, speeds)
    yield from _whirl(findings, bending.shafts, speeds)
    if any(shaft.answers for shaft in bending.shafts):
        yield Heading("Response to the secondary couples", 2)
        yield from _answers(bending.shafts)
        for count, shaft in enumerate(bending.shafts, start=1):
            if shaft.answers:
                yield _bending(findings, shaft, speeds, f"bending-{count}")
    if any(shaft.tilting is not None for shaft in bending.shafts):
        from torsion.output.chapters.stability_ranges import tilt_section

        yield from tilt_section(findings, bending.shafts)
    if bending.remarks:
        yield Heading("Not computed for the bending", 2)
        yield Points(bending.remarks)


def _criticals(shafts: Shafts, speeds: Range) -> Table:
    """Speeds of the reference at which an order of a shaft meets one of its bending frequencies."""
    rows = []
    for shaft in shafts:
        grows = shaft.whirl is not None and bool((shaft.whirl.log_decrement < UNSTABLE).any())
        grows |= shaft.tilting is not None and bool(shaft.tilting.zones)
        name = f"{shaft.name} (UNSTABLE)" if grows else shaft.name
        rows += [(critical, name, _inside(critical, speeds)) for critical in _near(shaft, speeds)]
    caption = (
        "Critical bending speeds in speeds of the reference; orders per revolution of the shaft (1: unbalance, others: "
        "couples of joints); damping ratio 0: unbounded amplitude"
    )
    if speeds is not None:
        caption += f"; above {rpm(FARTHEST * speeds[1])} rpm the lowest two of each order"
    return table(
        "< Shaft -> | order: Order -> | mode: Mode | speed: Critical speed [rpm] -> rpm | "
        "frequency: Frequency [Hz] -> Hz | whirl: < Whirl -> | damping_ratio: Damping ratio:3 -> | In the range -> in range",
        rows,
        caption,
        marks=["note" if row[-1] else "" for row in rows],
        short="Critical bending speeds",
    )


def _near(shaft: ShaftFound, speeds: Range) -> list[Critical]:
    """The critical speeds up to FARTHEST, and of every order the lowest two."""
    farthest = np.inf if speeds is None else FARTHEST * speeds[1]
    orders = [critical.order for critical in shaft.critical]
    return [
        critical
        for k, critical in enumerate(shaft.critical)
        if critical.speed <= farthest or orders[:k].count(critical.order) < 2
    ]


def _inside(critical: Critical, speeds: Range) -> bool:
    return speeds is not None and speeds[0] <= critical.speed <= speeds[1]


def _whirl(findings: Findings, shafts: Shafts, speeds: Range) -> Iterator[Block]:
    """Frequencies at both ends of the range, whether the motion dies out; nothing where no speeds are given."""
    rows, marks = [], []
    whirled = [(shaft, shaft.whirl) for shaft in shafts if shaft.whirl is not None]
    for shaft, mode in ((shaft, mode) for shaft, whirl in whirled for mode in whirl.modes):
        words = "stable" if mode.decrement > 0 else "undamped"
        if mode.grows_from is not None:
            words = f"UNSTABLE from {rpm(mode.grows_from)} rpm"
        rows.append((shaft, mode, words))
        marks.append("" if mode.grows_from is None else "fail")
    if not rows:
        return
    yield Heading("Whirl over the speed", 2)
    if grown := marks.count("fail"):
        yield Paragraph(f"{grown} of the modes below are unstable in the speed range.", "fail")
    yield table(
        "name: < Shaft | number: Mode | first: Frequency at the lowest speed [Hz] | last: at the highest [Hz] | "
        "whirl: < Whirl at the highest | decrement: Minimum log. decrement:3 | speed: Speed [rpm] | < Stability",
        rows,
        "Whirl over the speed range, by frequency; a negative logarithmic decrement is unstable",
        marks=marks,
    )
    for count, shaft in enumerate(shafts, start=1):
        whirl = shaft.whirl
        if whirl is None or speeds is None:
            continue
        yield of_bending(shaft, _whirl_figure(findings, shaft, whirl, speeds, f"whirl-{count}"))


def _whirl_figure(
    findings: Findings, shaft: ShaftFound, whirl: Whirl, speeds: Range, name: str
) -> Figure:
    """Draw the frequencies of bending over the speed, by their sense, and the orders that meet them."""
    x = whirl.speed * RPM
    first, last = float(x[0]), float(x[-1])
    orders = {
        order: order * last / 60.0 * float(shaft.ratio)
        for order in sorted({1, *(critical.order for critical in shaft.critical)})
    }
    crossings = []
    for critical in _near(shaft, speeds):
        words = (
            f"critical speed of bending {rpm(critical.speed)} rpm: order {critical.order} excites "
        )
        words += f"{number(critical.frequency)} Hz"
        place = critical.speed * RPM, critical.frequency
        crossings.append((*place, _inside(critical, speeds), words))
    right, top = 1.08 * last, highest_shown(whirl.frequency, max(orders.values()), crossings)
    lines = [
        piece
        for column, sense in zip(whirl.frequency.T, whirl.direction.T, strict=True)
        for piece in whirling(x, column, sense)
    ]
    for order, hertz in orders.items():
        end = np.array([0.0, min(right, top / hertz * last)])
        words = f"order {order}"
        lines.append(Line("orders", end, hertz * end / last, "pale", words, label_at="end"))
    rows, columns = np.nonzero(whirl.log_decrement < UNSTABLE)
    grows = Marks("UNSTABLE", x[rows], whirl.frequency[rows, columns], "cross", "unstable")
    panel = Panel(
        replace(SPEED, low=0.0, high=right),
        Axis("frequency of bending", "Hz", low=0.0, high=top),
        tuple(lines),
        rated_level(rated_rpm(findings)),
        (Band("speed range", first, last, "range"),),
        (grows, *met(crossings, right, top)),
        height=200.0,
    )
    return Figure(name, f"Whirl of {shaft.name}: frequency over speed", (panel,))


def _answers(shafts: Shafts) -> Iterator[Table]:
    """Largest displacement and bending moment of every order, and force on every joint and support."""
    rows = [(shaft, largest) for shaft in shafts for largest in shaft.largest]
    yield table(
        "name: < Shaft | order: Order | displacement: Maximum displacement [µm]:u | at: at [m]:4 | speed: at [rpm] | "
        "moment: Maximum bending moment [~N m]:u | moment_at: at [m]:4 | moment_speed: at [rpm] | "
        "unreliable: Speeds without reliable value",
        rows,
        "Response to the secondary couples of the joints: amplitudes in the direction of their maximum; order 0 is "
        "static. An undamped resonance has no maximum; the figures mark its speeds",
        marks=["note" if largest.unreliable else "" for _, largest in rows],
    )
    yield table(
        "< Shaft | name: < On | at: At [m]:4 | order: Order | force: Maximum force [~N]:u | speed: at [rpm]",
        [(force, shaft.name) for shaft in shafts for force in shaft.forces],
        "Forces of the shafts on their joints and supports by the secondary couples",
    )


def _bending(findings: Findings, shaft: ShaftFound, speeds: Range, name: str) -> Figure:
    """Draw the maximum displacement, moment and force of the shaft over speed, each order with its own line."""
    answers = shaft.answers
    critical = [
        Level("critical speeds of these orders", critical.speed * RPM, "natural", "x")
        for critical in shaft.critical
        if critical.order in [answer.order for answer in answers] and _inside(critical, speeds)
    ]
    singular = [answer.status == Status.SINGULAR for answer in answers]
    bands = tuple[Band, ...]()
    for answer, is_singular in zip(answers, singular, strict=True):
        bands += unanswered(answer.speed * RPM, is_singular, NO_ANSWER)[1]
    x, panels = span(SPEED, np.concatenate([answer.speed * RPM for answer in answers])), []
    for quantity, unit, curves in (
        ("displacement", "µm", [answer.orbit for answer in answers]),
        ("bending moment", "N m", [answer.largest_moment for answer in answers]),
        ("force on a joint or support", "N", [extent(answer.force) for answer in answers]),
    ):
        reliable = [answer.reliable(values) for answer, values in zip(answers, curves, strict=True)]
        shown = Scale(unit, MICRO) if unit == "µm" else scale(unit, map(highest, reliable))
        sizes = [shown.factor * values.max(axis=1) for values in curves]
        lines, marks = [], []
        for pen, (answer, size) in enumerate(zip(answers, sizes, strict=True)):
            near, speed = answer.status == Status.NEAR_SINGULAR, answer.speed * RPM
            sound = np.where(near | singular[pen], np.nan, size)
            words = f"order {answer.order}" + ("" if answer.order else ", static")
            lines.append(Line(words, speed, sound, pen, str(answer.order)))
            marks.append(Marks(STANDING, speed[near], size[near], "cross", "unstable"))
        y, levels = amplitudes(quantity, shown.unit, sizes), rated_level(rated_rpm(findings))
        levels = (*critical, *levels)
        panels.append(Panel(x, y, tuple(lines), levels, bands, tuple(marks), height=90.0))
    caption = f"{shaft.name}: maximum amplitude of displacement, bending moment and force by the secondary couples"
    return of_bending(shaft, Figure(name, caption, tuple(panels)))
