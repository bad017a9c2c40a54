"""What chapters and tables read from the exact periodic response and from the stability of a train."""

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.analyses.motion.periodic_orbits import Found, PeriodicResponse
from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.synthesis import common_cycle, extremes
from torsion.arrays import FloatArray
from torsion.findings import Findings
from torsion.output.elastic_elements import Element, elements
from torsion.output.numbers import number, rpm
from torsion.output.reported_values import amplitude, rounding, synthesis, without
from torsion.output.selection import highest, largest

SMALLEST = 0.01  # of an element's largest torque: smaller orders are not compared
Point = tuple[float, int]  # N m, position of the speed
WORDS = {Found.OK: "ok", Found.COARSE: "coarse", Found.NONE: "none found"}


@dataclass(frozen=True)
class Compared:
    """The largest torque of an element over the speeds, by both methods; order None is the half range of all orders."""

    element: Element
    order: Fraction | None
    first: Point | None  # in the response
    exact: Point | None  # in the periodic response

    @property
    def excess(self) -> float:
        """(exact - first order)/first order; NaN where one is missing or nothing."""
        if self.first is None or self.exact is None or self.first[0] == 0:
            return np.nan
        return self.exact[0] / self.first[0] - 1.0


def exact_amplitude(findings: Findings, spans: Sequence[int]) -> FloatArray:
    """(speeds, orders) N m: largest exact amplitude in the spans; NaN where no periodic motion was found."""
    return np.asarray(np.abs(findings.need(PeriodicResponse).torque[:, :, list(spans)]).max(axis=2))


def exact_half_range(findings: Findings, spans: Sequence[int]) -> FloatArray:
    """(speeds,) N m: largest half range of all orders together, true to phase; NaN where nothing was found."""
    found = findings.need(PeriodicResponse)
    turns, harmonics = common_cycle(list(found.orders))
    torque = np.moveaxis(found.torque[:, :, list(spans)], 1, 2)
    if turns == 0:
        return np.asarray(np.abs(torque).sum(axis=2).max(axis=1))
    known = found.status != Found.NONE
    out = np.full(len(found.speed), np.nan)
    highest, lowest = extremes(torque[known].reshape(-1, len(found.orders)), harmonics)
    out[known] = ((highest - lowest) / 2.0).reshape(-1, len(spans)).max(axis=1)
    return out


def compared(findings: Findings) -> tuple[Compared, ...]:
    """Every element that carries torque: all orders together (where no torque has a fixed frequency), then each."""
    if findings.get(Response) is None or findings.get(PeriodicResponse) is None:
        return ()
    nothing = rounding(findings)
    return tuple(row for element in elements(findings.system) for row in _of(findings, element, nothing))


def _of(findings: Findings, element: Element, nothing: FloatArray) -> list[Compared]:
    """nothing: (spans,) N m, below which a torque is rounding and reported as 0."""
    spans, lines = element.spans, findings.need(Response).lines
    here = nothing[list(spans)]
    first, exact = without(amplitude(findings, spans), here), exact_amplitude(findings, spans)
    top = highest(exact)
    if top == 0.0 or findings.get(PeriodicResponse) is None:
        return []
    exact, orders = _where_found(without(exact, here)), [line.order for line in lines]
    rows = []
    if None not in orders:
        both = synthesis(findings, spans), _where_found(exact_half_range(findings, spans))
        rows.append(Compared(element, None, *(_largest(without(one, here)) for one in both)))
    for k, order in enumerate(findings.need(PeriodicResponse).orders):
        mine = None if order not in orders else _largest(first[:, orders.index(order)])
        found = _largest(exact[:, k])
        if max((point[0] for point in (mine, found) if point is not None), default=0.0) >= SMALLEST * top:
            rows.append(Compared(element, order, mine, found))
    return rows


def _where_found(values: FloatArray) -> FloatArray:
    """The values with the least of all for NaN, so that the largest is that of the speeds with a periodic motion."""
    return np.where(np.isnan(values), -np.inf, values)


def _largest(values: FloatArray) -> Point | None:
    at = largest(values)
    return None if at is None else (float(values[at]), at)


def flagged(findings: Findings) -> np.ndarray:
    """(speeds,) bool: the exact response has no value, a coarse one, or one that small deviations leave."""
    found = findings.need(PeriodicResponse)
    return np.asarray((found.status != Found.OK) | found.is_unstable)


@dataclass(frozen=True)
class OtherMotion:
    """One of several periodic motions at a speed, by its largest amplitude."""

    speed: float  # rad/s
    name: str  # "reported", "another"
    torque: float  # N m
    order: Fraction
    where: str
    growth: float  # 1/s


def other_motions(findings: Findings) -> tuple[OtherMotion, ...]:
    """Every motion at the speeds at which several were found, the one that is reported before the others."""
    found = findings.need(PeriodicResponse)
    if found.others is None:
        return ()
    rows = []
    for speed in np.unique(found.others.speed).tolist():
        here = int(np.flatnonzero(found.speed == speed)[0])
        rows.append(_motion(findings, found, here, "reported"))
        rows += [
            _motion(findings, found.others, k, "another") for k in np.flatnonzero(found.others.speed == speed).tolist()
        ]
    return tuple(rows)


def _motion(findings: Findings, found: PeriodicResponse, row: int, name: str) -> OtherMotion:
    """By its largest amplitude in any element."""
    size = [(float(np.abs(found.torque[row][:, list(e.spans)]).max()), e) for e in elements(findings.system)]
    torque, element = max(size, key=lambda one: one[0])
    rank = int(np.abs(found.torque[row][:, list(element.spans)]).max(axis=1).argmax())
    growth = np.nan if found.growth is None else float(found.growth[row])
    return OtherMotion(float(found.speed[row]), name, torque, found.orders[rank], element.name, growth)


def first_order_judged(findings: Findings) -> str:
    """That the rules judge the first order, and by how much it misses the exact one; empty where there is only one."""
    rows = compared(findings)
    if not rows or not findings.study.rules:
        return ""
    together = [row for row in rows if row.order is None] or list(rows)
    known = [row for row in together if np.isfinite(row.excess)]
    text = "The rules and the synthesis judge the first-order response, not the exact periodic one."
    if not known:
        return text
    worst = max(known, key=lambda row: row.excess)
    if worst.first is None or worst.exact is None:
        return text
    response, exact = findings.need(Response), findings.need(PeriodicResponse)
    return (
        f"{text} The exact one exceeds it most in {worst.element.name}: largest "
        f"{'half range' if worst.order is None else f'amplitude of order {worst.order}'} "
        f"{number(worst.exact[0])} N m at {rpm(float(exact.speed[worst.exact[1]]))} rpm against "
        f"{number(worst.first[0])} N m at {rpm(float(response.speed[worst.first[1]]))} rpm of the first order "
        f"({signed(worst.excess)} %)."
    )


def signed(share: float, digits: int = 3) -> str:
    """A relative difference in percent, with its sign."""
    return ("+" if share > 0 else "") + number(100.0 * share, digits)
