"""Chapter: bending of the shafts: critical speeds, whirl over speed, the answer to the joints' secondary couples."""

from collections.abc import Callable, Iterator

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
from torsion.output.numbers import NONE, RPM, number, rpm, scale
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
    found = findings.get(Lateral)
    if found is None:
        return
    requested = (
        getattr(findings.study.analyses.get("lateral"), "speeds", None)
        or findings.study.operation.speeds
    )
    speeds = None if requested is None else (requested.first, requested.last)
    yield Heading("Bending of the shafts")
    yield Paragraph(f"Speeds are speeds of {reference(findings)}. {AXES}")
    yield _supports(found.shafts)
    yield _criticals(found.shafts, speeds)
    yield from _whirl(findings, found.shafts, speeds)
    if any(shaft.answers for shaft in found.shafts):
        yield Heading("Response to the secondary couples", 2)
        yield _answers(found.shafts)
        yield _forces(found.shafts)
        for count, shaft in enumerate(found.shafts, start=1):
            if shaft.answers:
                yield _bending(findings, shaft, speeds, f"bending-{count}")
    if any(shaft.tilting is not None for shaft in found.shafts):
        from torsion.output.chapters.stability_ranges import tilt_section

        yield from tilt_section(findings, found.shafts)
    if found.remarks:
        yield Heading("Not computed for the bending", 2)
        yield Points(found.remarks)


def _supports(found: Shafts) -> Table:
    """Length, what supports it, and the lowest frequency of both planes without rotation."""
    return table(
        "< Shaft | Length [m] | Speed / reference | < Supports | Lowest frequency at rest, y [Hz] | z [Hz]",
        [
            (
                shaft.name,
                shaft.length,
                shaft.ratio,
                ", ".join(f"{one.name} at {number(one.at, 4)} m" for one in shaft.point),
                *(
                    number(float(plane[0]), 6) if plane.size else NONE
                    for plane in (shaft.at_rest.y, shaft.at_rest.z)
                ),
            )
            for shaft in found
        ],
        "Shafts and their supports",
    )


def _criticals(found: Shafts, speeds: Range) -> Table:
    """Speeds of the reference at which an order of a shaft meets one of its bending frequencies."""
    rows = []
    for shaft in found:
        grows = shaft.whirl is not None and bool(unstable(shaft.whirl.log_decrement).any())
        grows |= shaft.tilting is not None and bool(shaft.tilting.zones)
        name = f"{shaft.name} (UNSTABLE)" if grows else shaft.name
        rows += [
            (
                name,
                one.order,
                one.mode,
                rpm(one.speed),
                one.frequency,
                sense(one.direction),
                number(one.damping_ratio, 3),
                _inside(one, speeds),
            )
            for one in _near(shaft, speeds)
        ]
    caption = (
        "Critical bending speeds in speeds of the reference; orders per revolution of the shaft (1: unbalance, others: "
        "couples of joints); damping ratio 0: unbounded amplitude"
    )
    if speeds is not None:
        caption += f"; above {rpm(FARTHEST * speeds[1])} rpm the lowest two of each order"
    return table(
        "< Shaft -> | Order -> | Mode | Critical speed [rpm] -> rpm | Frequency [Hz] -> Hz | < Whirl -> | "
        "Damping ratio -> | In the range -> in range",
        rows,
        caption,
        marks=["note" if row[-1] else "" for row in rows],
        short="Critical bending speeds",
    )


def _near(shaft: ShaftFound, speeds: Range) -> list[Critical]:
    """The critical speeds up to FARTHEST, and of every order the lowest two."""
    if speeds is None:
        return list(shaft.critical)
    highest = FARTHEST * speeds[1]
    orders = [one.order for one in shaft.critical]
    return [
        one
        for k, one in enumerate(shaft.critical)
        if one.speed <= highest or orders[:k].count(one.order) < 2
    ]


def _inside(one: Critical, speeds: Range) -> bool:
    """It lies in the speed range."""
    return speeds is not None and speeds[0] <= one.speed <= speeds[1]


def sense(direction: float) -> str:
    """Forward or backward whirl in words."""
    if abs(direction) < FLAT:
        return "nearly in a plane"
    way = "forward" if direction > 0 else "backward"
    return way if abs(direction) >= PURE else f"{way}, ellipse"


def unstable(decrement: FloatArray) -> np.ndarray:
    """Where the motion grows by itself."""
    return np.asarray(decrement < UNSTABLE)


def _whirl(findings: Findings, found: Shafts, speeds: Range) -> Iterator[Block]:
    """Frequencies at both ends of the range, whether the motion dies out; nothing where no speeds are given."""
    rows = [
        row for shaft in found if shaft.whirl is not None for row in _whirl_rows(shaft, shaft.whirl)
    ]
    if not rows:
        return
    marks = ["fail" if row[-1].startswith("UNSTABLE") else "" for row in rows]
    yield Heading("Whirl over the speed", 2)
    if grown := marks.count("fail"):
        text = f"{grown} of the modes below are unstable in the speed range."
        yield Paragraph(text, "fail")
    yield table(
        "< Shaft | Mode | Frequency at the lowest speed [Hz] | at the highest [Hz] | < Whirl at the highest | "
        "Minimum log. decrement | Speed [rpm] | < Stability",
        rows,
        "Whirl over the speed range, by frequency; a negative logarithmic decrement is unstable",
        marks=marks,
    )
    for count, shaft in enumerate(found, start=1):
        over = shaft.whirl
        if over is None or speeds is None:
            continue
        orders = sorted({1, *(one.order for one in shaft.critical)})
        last = float(over.speed[-1]) * float(shaft.ratio) / (2.0 * np.pi)
        crossings = [
            (
                one.speed * RPM,
                one.frequency,
                _inside(one, speeds),
                f"critical speed of bending {rpm(one.speed)} rpm: order {one.order} excites {number(one.frequency)} Hz",
            )
            for one in _near(shaft, speeds)
        ]
        yield of_bending(
            shaft,
            frequencies_over_speed.whirl(
                f"whirl-{count}",
                f"Whirl of {shaft.name}: frequency over speed",
                speed=over.speed * RPM,
                frequency=over.frequency,
                direction=over.direction,
                unstable=unstable(over.log_decrement),
                orders=[(order * last, f"order {order}") for order in orders],
                crossings=crossings,
                rated=rated_rpm(findings),
            ),
        )


def _whirl_rows(shaft: ShaftFound, over: Whirl) -> Iterator[tuple[str, ...]]:
    """Every mode by its frequency at the highest speed."""
    speed = over.speed
    ascending = np.argsort(over.frequency[-1], kind="stable")  # what does not oscillate last
    for position, k in enumerate(ascending.tolist(), start=1):
        decrement, grows = over.log_decrement[:, k], unstable(over.log_decrement[:, k])
        if not np.isfinite(decrement).any():
            continue
        at = int(np.nanargmin(decrement))
        least = float(decrement[at])
        verdict = "stable" if least > -UNSTABLE else "undamped"
        if grows.any():
            verdict = f"UNSTABLE from {rpm(float(speed[grows][0]))} rpm"
        yield (
            shaft.name,
            str(position),
            number(float(over.frequency[0, k])),
            number(float(over.frequency[-1, k])),
            sense(float(over.direction[-1, k])),
            number(0.0 if abs(least) <= -UNSTABLE else least, 3),
            rpm(float(speed[at])),
            verdict,
        )


def _answers(found: Shafts) -> Table:
    """Largest displacement and bending moment of every order."""
    stated = [(shaft, one) for shaft in found for one in shaft.answers]
    unit = scale("N m", [highest(_sound(one, extent(one.moment))) for _, one in stated])
    rows, marks = [], []
    for shaft, one in stated:
        bad = int((one.status != Status.OK).sum())
        orbit = _worst(shaft, one, MICRO * one.orbit)
        moment = _worst(shaft, one, unit.factor * extent(one.moment))
        rows.append((shaft.name, one.order, *orbit, *moment, f"{bad} of {len(one.speed)}"))
        marks.append("note" if bad else "")
    return table(
        f"< Shaft | Order | Maximum displacement [µm] | at [m] | at [rpm] | Maximum bending moment [{unit.unit}] | "
        "at [m] | at [rpm] | Speeds without reliable value",
        rows,
        "Response to the secondary couples of the joints: amplitudes in the direction of their maximum; order 0 is "
        "static. An undamped resonance has no maximum; the figures mark its speeds",
        marks=marks,
    )


def _forces(found: Shafts) -> Table:
    """Largest force of every order on every joint and support."""
    sizes = [highest(_sound(one, extent(one.force))) for shaft in found for one in shaft.answers]
    unit = scale("N", sizes)
    rows = [
        (
            shaft.name,
            held.name,
            number(held.at, 4),
            one.order,
            *_worst(shaft, one, unit.factor * extent(one.force)[:, place : place + 1])[::2],
        )
        for shaft in found
        for place, held in enumerate(shaft.point)
        for one in shaft.answers
    ]
    columns = f"< Shaft | < On | At [m] | Order | Maximum force [{unit.unit}] | at [rpm]"
    return table(
        columns, rows, "Forces of the shafts on their joints and supports by the secondary couples"
    )


def _sound(answer: Answer, values: FloatArray) -> FloatArray:
    """Values (speeds, ...) without those whose status is not ok."""
    return np.where(answer.status == Status.OK, values.T, np.nan).T


def _worst(shaft: ShaftFound, answer: Answer, values: FloatArray) -> tuple[str, str, str]:
    """Value, place along the shaft and reference speed of the largest of (speeds, places)."""
    at = largest(_sound(answer, values).ravel())
    if at is None:
        return NO_VALUE, NONE, NONE
    row, place = divmod(at, values.shape[1])
    speed = rpm(float(answer.speed[row]))
    return number(float(values[row, place])), number(float(shaft.position[place]), 4), speed


def _bending(findings: Findings, shaft: ShaftFound, speeds: Range, name: str) -> Figure:
    """Largest displacement, moment and force of the shaft over speed, every order apart."""

    def over(of: Callable[[Answer], FloatArray]) -> list[FloatArray]:
        return [of(one).max(axis=1) for one in shaft.answers]

    moment = scale("N m", [highest(_sound(one, extent(one.moment))) for one in shaft.answers])
    force = scale("N", [highest(_sound(one, extent(one.force))) for one in shaft.answers])
    orders = {answer.order for answer in shaft.answers}
    return of_bending(
        shaft,
        curves_over_speed.bending(
            name,
            f"{shaft.name}: maximum amplitude of displacement, bending moment and force by the secondary couples",
            speed=[one.speed * RPM for one in shaft.answers],
            orders=[
                f"order {one.order}" + ("" if one.order else ", static") for one in shaft.answers
            ],
            panels=[
                ("displacement", "µm", over(lambda one: MICRO * one.orbit)),
                (
                    "bending moment",
                    moment.unit,
                    over(lambda one: moment.factor * extent(one.moment)),
                ),
                (
                    "force on a joint or support",
                    force.unit,
                    over(lambda one: force.factor * extent(one.force)),
                ),
            ],
            near=[one.status == Status.NEAR_SINGULAR for one in shaft.answers],
            singular=[one.status == Status.SINGULAR for one in shaft.answers],
            crossings=[
                one.speed * RPM
                for one in shaft.critical
                if one.order in orders and _inside(one, speeds)
            ],
            rated=rated_rpm(findings),
        ),
    )
