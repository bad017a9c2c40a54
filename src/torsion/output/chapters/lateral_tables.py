"""Tables of the bending of the shafts: what holds them, critical speeds, whirl over the range, and their answer."""

from typing import TYPE_CHECKING

import numpy as np

from torsion.arrays import FloatArray
from torsion.kernels.tree_response import Status
from torsion.output.blocks import Table, head
from torsion.output.numbers import NONE, RPM, number, rpm, scale
from torsion.output.selection import NO_VALUE, highest, largest

if TYPE_CHECKING:
    from torsion.analyses.lateral.couple_response import Answer
    from torsion.analyses.lateral.shaft_bending import ShaftFound
    from torsion.analyses.lateral.whirl import Critical

Range = tuple[float, float] | None  # lowest and highest reference speed, rad/s
PURE, FLAT = 0.99, 0.1  # of a direction: a circle from the first on, nearly a line up to the second
FARTHEST = 2.0  # times the highest speed: beyond it only the lowest two critical speeds of an order are printed
UNSTABLE = -1e-9  # of a logarithmic decrement; what lies between it and 0 is rounding
MICRO = 1e6


def shafts(found: "tuple[ShaftFound, ...]") -> Table:
    """Length, what supports it, and the lowest frequency of both planes without rotation."""
    columns = head("< Shaft | Length [m] | Speed / reference | < Supports | Lowest frequency at rest, y [Hz] | z [Hz]")
    rows = tuple(
        (
            shaft.name, number(shaft.length), str(shaft.ratio),
            ", ".join(f"{one.name} at {number(one.at, 4)} m" for one in shaft.point),
            *(number(float(plane[0]), 6) if plane.size else NONE for plane in (shaft.at_rest.y, shaft.at_rest.z)),
        )
        for shaft in found
    )  # fmt: skip
    return Table(columns, rows, "Shafts that bend, and what supports them")


def criticals(found: "tuple[ShaftFound, ...]", speeds: Range) -> Table:
    """Speeds of the reference at which an order of a shaft meets one of its bending frequencies."""
    columns = head(
        "< Shaft -> | Order -> | Mode | Critical speed [rpm] -> rpm | Frequency [Hz] -> Hz | < Whirl -> | "
        "Damping ratio -> | In the range -> in range"
    )
    stated = [(shaft, one) for shaft in found for one in near(shaft, speeds)]
    rows = [(*_critical_row(shaft, one), "yes" if inside(one, speeds) else "no") for shaft, one in stated]
    marks = tuple("note" if row[-1] == "yes" else "" for row in rows)
    caption = (
        "Critical bending speeds: orders are per revolution of the shaft (1: unbalance; others: its joints' couples), "
        "speeds are those of the reference; damping ratio 0: no bound is known for the amplitude"
    )
    if speeds is not None:
        caption += f"; above {number(FARTHEST * speeds[1] * RPM)} rpm only the lowest two of an order"
    return Table(columns, tuple(rows), caption, marks, "Critical bending speeds")


def _critical_row(shaft: "ShaftFound", one: "Critical") -> tuple[str, ...]:
    """Shaft and whether it is unstable, order, mode, reference rpm, Hz, sense of whirl, damping ratio."""
    grows = shaft.whirl is not None and bool(unstable(shaft.whirl.log_decrement).any())
    grows |= shaft.tilting is not None and bool(shaft.tilting.zones)
    return (
        f"{shaft.name} (UNSTABLE)" if grows else shaft.name, str(one.order), str(one.mode),
        rpm(one.speed), number(one.frequency), sense(one.direction), number(one.damping_ratio, 3),
    )  # fmt: skip


def near(shaft: "ShaftFound", speeds: Range) -> "list[Critical]":
    """The critical speeds up to FARTHEST, and of every order the lowest two."""
    if speeds is None:
        return list(shaft.critical)
    highest = FARTHEST * speeds[1]
    seen: dict[int, int] = {}
    kept = []
    for one in shaft.critical:
        seen[one.order] = seen.get(one.order, 0) + 1
        if one.speed <= highest or seen[one.order] <= 2:
            kept.append(one)
    return kept


def inside(one: "Critical", speeds: Range) -> bool:
    """It lies in the speed range."""
    return speeds is not None and speeds[0] <= one.speed <= speeds[1]


def sense(direction: float) -> str:
    """Forward or backward whirl in words."""
    if abs(direction) < FLAT:
        return "nearly in a plane"
    way = "forward" if direction > 0 else "backward"
    return way if abs(direction) >= PURE else f"{way}, ellipse"


def whirl(found: "tuple[ShaftFound, ...]") -> Table | None:
    """Frequencies at both ends of the range, and whether the motion dies out; None where no speeds are given."""
    columns = head(
        "< Shaft | Mode | Frequency at the lowest speed [Hz] | at the highest [Hz] | < Whirl at the highest | "
        "Least log. decrement | at [rpm] | < Stability"
    )
    rows, marks = [], []
    for shaft in found:
        over = shaft.whirl
        if over is None:
            continue
        ascending = np.argsort(np.nan_to_num(over.frequency[-1], nan=np.inf), kind="stable")
        for position, k in enumerate(ascending.tolist(), start=1):
            decrement = over.log_decrement[:, k]
            if not np.isfinite(decrement).any():
                continue
            at = int(np.nanargmin(decrement))
            verdict, worst = _stability(over.speed, decrement), rpm(float(over.speed[at]))
            rows.append((
                shaft.name, str(position), number(float(over.frequency[0, k])), number(float(over.frequency[-1, k])),
                sense(float(over.direction[-1, k])), number(_clean(float(decrement[at])), 3), worst, verdict,
            ))  # fmt: skip
            marks.append("fail" if verdict.startswith("UNSTABLE") else "")
    caption = "Whirl over the speed range, by frequency; a negative logarithmic decrement grows"
    return Table(columns, tuple(rows), caption, tuple(marks)) if rows else None


def unstable(decrement: FloatArray) -> np.ndarray:
    """Where the motion grows by itself."""
    return np.asarray(np.nan_to_num(decrement, nan=0.0) < UNSTABLE)


def _stability(speed: FloatArray, decrement: FloatArray) -> str:
    grows = unstable(decrement)
    if grows.any():
        return f"UNSTABLE from {rpm(float(speed[grows][0]))} rpm"
    return "stable" if np.nanmin(decrement) > -UNSTABLE else "nothing damps it"


def _clean(decrement: float) -> float:
    return 0.0 if abs(decrement) <= -UNSTABLE else decrement


def answers(found: "tuple[ShaftFound, ...]") -> Table | None:
    """Largest displacement and bending moment of every order; None where no torque is known."""
    from torsion.analyses.lateral.couple_response import extent

    stated = [(shaft, one) for shaft in found for one in shaft.answers]
    if not stated:
        return None
    unit = scale("N m", [_top(sound(one, extent(one.moment))) for _, one in stated])
    columns = head(
        f"< Shaft | Order | Largest displacement [µm] | at [m] | at [rpm] | Largest bending moment [{unit.unit}] | "
        "at [m] | at [rpm] | Speeds without reliable answer"
    )
    rows, marks = [], []
    for shaft, one in stated:
        bad = int((one.status != Status.OK).sum())
        orbit = _worst(shaft, one, MICRO * sound(one, one.orbit))
        moment = _worst(shaft, one, unit.factor * sound(one, extent(one.moment)))
        rows.append((shaft.name, str(one.order), *orbit, *moment, f"{bad} of {len(one.speed)}"))
        marks.append("note" if bad else "")
    caption = (
        "Answer to the secondary couples of the joints; half ranges, in the direction in which they are largest; order "
        "0 stands still. Beside a resonance without damping there is no largest; its speeds are marked in the figures"
    )
    return Table(columns, tuple(rows), caption, tuple(marks))


def forces(found: "tuple[ShaftFound, ...]") -> Table | None:
    """Largest force of every order on every joint and support; None where no torque is known."""
    from torsion.analyses.lateral.couple_response import extent

    stated = [(shaft, one) for shaft in found for one in shaft.answers]
    if not stated:
        return None
    unit = scale("N", [_top(sound(one, extent(one.force))) for _, one in stated])
    columns = head(f"< Shaft | < On | At [m] | Order | Largest force [{unit.unit}] | at [rpm]")
    rows = []
    for shaft in found:
        for place, held in enumerate(shaft.point):
            for one in shaft.answers:
                force = sound(one, extent(one.force))[:, place]
                k = largest(force)
                speed = NONE if k is None else rpm(float(one.speed[k]))
                size = NO_VALUE if k is None else unit.text(float(force[k]))
                rows.append((shaft.name, held.name, number(held.at, 4), str(one.order), size, speed))
    return Table(columns, tuple(rows), "Forces of the shafts on their joints and supports by the secondary couples")


def sound(answer: "Answer", values: FloatArray) -> FloatArray:
    """Values (speeds, ...) without those whose status is not ok."""
    bad = answer.status != Status.OK
    return np.where(bad.reshape(-1, *[1] * (values.ndim - 1)), np.nan, values)


def _top(values: FloatArray) -> float:
    return highest(values)


def _worst(shaft: "ShaftFound", answer: "Answer", values: FloatArray) -> tuple[str, str, str]:
    """Value, place along the shaft and reference speed of the largest of (speeds, places)."""
    at = largest(values.ravel())
    if at is None:
        return NO_VALUE, NONE, NONE
    row, place = divmod(at, values.shape[1])
    speed = rpm(float(answer.speed[row]))
    return number(float(values[row, place])), number(float(shaft.position[place]), 4), speed
