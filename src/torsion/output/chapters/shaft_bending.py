"""Chapter: bending of the shafts: critical speeds, whirl over speed, the answer to the joints' secondary couples."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from torsion.analyses.lateral.couple_response import Answer, extent
from torsion.analyses.lateral.shaft_bending import Lateral, ShaftFound
from torsion.analyses.lateral.whirl import Critical, Whirl
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Block, Heading, Paragraph, Points, Table, table
from torsion.output.figures import curves_over_speed, frequencies_over_speed
from torsion.output.figures.figure import Figure
from torsion.output.nearest_criticals import of_bending
from torsion.output.numbers import RPM, Scale, number, rpm, scale
from torsion.output.reported_values import rated_rpm, reference
from torsion.output.selection import NO_VALUE, highest, largest

AXES = (
    "y is the normal of the plane of the joint upstream of the shaft (otherwise downstream), z is "
    "perpendicular to y and to the shaft. Joints hold their shafts in place and let them tilt. Supports are "
    "springs."
)
PURE, FLAT = 0.99, 0.1  # of a direction: a circle from the first on, nearly a line up to the second
FARTHEST = 2.0  # times the highest speed: beyond it only the lowest two critical speeds of an order are printed
UNSTABLE = -1e-9  # of a logarithmic decrement; what lies between it and 0 is rounding
MICRO = 1e6
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
    yield Paragraph(f"Speeds are speeds of {reference(findings)}. {AXES}")
    yield _supports(bending.shafts)
    yield _criticals(bending.shafts, speeds)
    yield from _whirl(findings, bending.shafts, speeds)
    if any(shaft.answers for shaft in bending.shafts):
        yield Heading("Response to the secondary couples", 2)
        yield _answers(bending.shafts)
        yield _forces(bending.shafts)
        for count, shaft in enumerate(bending.shafts, start=1):
            if shaft.answers:
                yield _bending(findings, shaft, speeds, f"bending-{count}")
    if any(shaft.tilting is not None for shaft in bending.shafts):
        from torsion.output.chapters.stability_ranges import tilt_section

        yield from tilt_section(findings, bending.shafts)
    if bending.remarks:
        yield Heading("Not computed for the bending", 2)
        yield Points(bending.remarks)


def _supports(shafts: Shafts) -> Table:
    """Length, what supports it, and the lowest frequency of both planes without rotation."""
    return table(
        "< Shaft | Length [m] | Speed / reference | < Supports | Lowest frequency at rest, y [Hz]:6 | z [Hz]:6",
        [
            (
                shaft.name,
                shaft.length,
                shaft.ratio,
                ", ".join(f"{held.name} at {number(held.at, 4)} m" for held in shaft.point),
                *(next(iter(plane), None) for plane in (shaft.at_rest.y, shaft.at_rest.z)),
            )
            for shaft in shafts
        ],
        "Shafts and their supports",
    )


def _criticals(shafts: Shafts, speeds: Range) -> Table:
    """Speeds of the reference at which an order of a shaft meets one of its bending frequencies."""
    rows = []
    for shaft in shafts:
        grows = shaft.whirl is not None and bool(unstable(shaft.whirl.log_decrement).any())
        grows |= shaft.tilting is not None and bool(shaft.tilting.zones)
        name = f"{shaft.name} (UNSTABLE)" if grows else shaft.name
        rows += [
            (
                name,
                critical.order,
                critical.mode,
                critical.speed,
                critical.frequency,
                sense(critical.direction),
                critical.damping_ratio,
                _inside(critical, speeds),
            )
            for critical in _near(shaft, speeds)
        ]
    caption = (
        "Critical bending speeds in speeds of the reference; orders per revolution of the shaft (1: unbalance, others: "
        "couples of joints); damping ratio 0: unbounded amplitude"
    )
    if speeds is not None:
        caption += f"; above {rpm(FARTHEST * speeds[1])} rpm the lowest two of each order"
    return table(
        "< Shaft -> | Order -> | Mode | Critical speed [rpm] -> rpm | Frequency [Hz] -> Hz | < Whirl -> | "
        "Damping ratio:3 -> | In the range -> in range",
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


def sense(direction: float) -> str:
    """Return forward or backward whirl in words."""
    if abs(direction) < FLAT:
        return "nearly in a plane"
    way = "forward" if direction > 0 else "backward"
    return way if abs(direction) >= PURE else f"{way}, ellipse"


def unstable(decrement: FloatArray) -> np.ndarray:
    """Return where the motion grows by itself."""
    return np.asarray(decrement < UNSTABLE)


def _whirl(findings: Findings, shafts: Shafts, speeds: Range) -> Iterator[Block]:
    """Frequencies at both ends of the range, whether the motion dies out; nothing where no speeds are given."""
    rows = [
        row
        for shaft in shafts
        if shaft.whirl is not None
        for row in _whirl_rows(shaft.name, shaft.whirl)
    ]
    if not rows:
        return
    marks = ["fail" if row[-1].startswith("UNSTABLE") else "" for row in rows]
    yield Heading("Whirl over the speed", 2)
    if grown := marks.count("fail"):
        yield Paragraph(f"{grown} of the modes below are unstable in the speed range.", "fail")
    yield table(
        "< Shaft | Mode | Frequency at the lowest speed [Hz] | at the highest [Hz] | < Whirl at the highest | "
        "Minimum log. decrement:3 | Speed [rpm] | < Stability",
        rows,
        "Whirl over the speed range, by frequency; a negative logarithmic decrement is unstable",
        marks=marks,
    )
    for count, shaft in enumerate(shafts, start=1):
        whirl = shaft.whirl
        if whirl is None or speeds is None:
            continue
        orders = sorted({1, *(critical.order for critical in shaft.critical)})
        last = float(whirl.speed[-1]) * float(shaft.ratio) / (2.0 * np.pi)
        crossings = [
            (
                critical.speed * RPM,
                critical.frequency,
                _inside(critical, speeds),
                (
                    f"critical speed of bending {rpm(critical.speed)} rpm: order {critical.order} excites "
                    f"{number(critical.frequency)} Hz"
                ),
            )
            for critical in _near(shaft, speeds)
        ]
        yield of_bending(
            shaft,
            frequencies_over_speed.whirl(
                f"whirl-{count}",
                f"Whirl of {shaft.name}: frequency over speed",
                speed=whirl.speed * RPM,
                frequency=whirl.frequency,
                direction=whirl.direction,
                unstable=unstable(whirl.log_decrement),
                orders=[(order * last, f"order {order}") for order in orders],
                crossings=crossings,
                rated=rated_rpm(findings),
            ),
        )


def _whirl_rows(name: str, whirl: Whirl) -> Iterator[tuple[Any, ...]]:
    """Every mode by its frequency at the highest speed, what does not oscillate last."""
    for position, k in enumerate(np.argsort(whirl.frequency[-1], kind="stable").tolist(), start=1):
        decrement = whirl.log_decrement[:, k]
        if not np.isfinite(decrement).any():
            continue
        row = int(np.nanargmin(decrement))
        smallest, grows = float(decrement[row]), unstable(decrement)
        verdict = "stable" if smallest > -UNSTABLE else "undamped"
        if grows.any():
            verdict = f"UNSTABLE from {rpm(float(whirl.speed[grows][0]))} rpm"
        yield (
            name,
            position,
            whirl.frequency[0, k],
            whirl.frequency[-1, k],
            sense(float(whirl.direction[-1, k])),
            0.0 if abs(smallest) <= -UNSTABLE else smallest,
            whirl.speed[row],
            verdict,
        )


def _answers(shafts: Shafts) -> Table:
    """Largest displacement and bending moment of every order."""
    rows = []
    for shaft in shafts:
        for answer in shaft.answers:
            bad = int((answer.status != Status.OK).sum())
            orbit, moment = (
                _worst(answer, values, shaft.position)
                for values in (answer.orbit, answer.largest_moment)
            )
            rows.append(
                (shaft.name, answer.order, *orbit, *moment, f"{bad} of {len(answer.speed)}")
            )
    return table(
        "< Shaft | Order | Maximum displacement [µm] | at [m]:4 | at [rpm] | Maximum bending moment [~N m] | "
        "at [m]:4 | at [rpm] | Speeds without reliable value",
        rows,
        "Response to the secondary couples of the joints: amplitudes in the direction of their maximum; order 0 is "
        "static. An undamped resonance has no maximum; the figures mark its speeds",
        marks=["" if row[-1].startswith("0 ") else "note" for row in rows],
    )


def _forces(shafts: Shafts) -> Table:
    """Largest force of every order on every joint and support."""
    rows = []
    for shaft in shafts:
        for place_index, held in enumerate(shaft.point):
            for answer in shaft.answers:
                force = extent(answer.force)[:, place_index : place_index + 1]
                size, _, speed = _worst(answer, force, shaft.position)
                rows.append((shaft.name, held.name, held.at, answer.order, size, speed))
    return table(
        "< Shaft | < On | At [m]:4 | Order | Maximum force [~N] | at [rpm]",
        rows,
        "Forces of the shafts on their joints and supports by the secondary couples",
    )


def _reliable(answer: Answer, values: FloatArray) -> FloatArray:
    """Values (speeds, ...) without those whose status is not ok."""
    return np.where(answer.status == Status.OK, values.T, np.nan).T


def _worst(
    answer: Answer, values: FloatArray, position: FloatArray
) -> tuple[float | str, float | None, float | None]:
    """Value, place along the shaft and reference speed of the largest of (speeds, places)."""
    index = largest(_reliable(answer, values).ravel())
    if index is None:
        return NO_VALUE, None, None
    row, place_index = divmod(index, values.shape[1])
    return float(values[row, place_index]), float(position[place_index]), float(answer.speed[row])


def _bending(findings: Findings, shaft: ShaftFound, speeds: Range, name: str) -> Figure:
    """Largest displacement, moment and force of the shaft over speed, every order apart."""
    panels = []
    for quantity, unit, curves in (
        ("displacement", "µm", [answer.orbit for answer in shaft.answers]),
        ("bending moment", "N m", [answer.largest_moment for answer in shaft.answers]),
        ("force on a joint or support", "N", [extent(answer.force) for answer in shaft.answers]),
    ):
        reliable = [_reliable(*pair) for pair in zip(shaft.answers, curves, strict=True)]
        shown = Scale(unit, MICRO) if unit == "µm" else scale(unit, map(highest, reliable))
        panels.append(
            (quantity, shown.unit, [shown.factor * values.max(axis=1) for values in curves])
        )
    orders = [answer.order for answer in shaft.answers]
    return of_bending(
        shaft,
        curves_over_speed.bending(
            name,
            f"{shaft.name}: maximum amplitude of displacement, bending moment and force by the secondary couples",
            speed=[answer.speed * RPM for answer in shaft.answers],
            orders=[f"order {order}" + ("" if order else ", static") for order in orders],
            panels=panels,
            near=[answer.status == Status.NEAR_SINGULAR for answer in shaft.answers],
            singular=[answer.status == Status.SINGULAR for answer in shaft.answers],
            crossings=[
                critical.speed * RPM
                for critical in shaft.critical
                if critical.order in orders and _inside(critical, speeds)
            ],
            rated=rated_rpm(findings),
        ),
    )
