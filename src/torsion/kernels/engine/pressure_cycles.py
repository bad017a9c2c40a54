"""Pressures over the volume of one end of a cylinder, or over the travel of its piston, as pressures over the angle."""

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.bracketed_search import find_minimum, find_root
from torsion.kernels.engine.crank_slider import CrankSlider
from torsion.kernels.engine.gas_torque import NODES, Cylinder, Diagram, harmonics, panels

SAME_ROW = 1e-9  # of the stroke: rows no farther apart are one


def angle_of_travel(crank: CrankSlider, travel: FloatArray) -> FloatArray:
    """rad, 0 to pi: crank angle at which the piston has travelled (m) from its outer dead centre; without an offset.

    With s = l + r - x of the law of cosines, 1 - cos = x (2 l - x)/(2 r s) and 1 + cos = (2 r - x)(2 l + 2 r - x)/(2 r
    s): both without a difference that cancels, so that the dead centres are exact.

    >>> angle_of_travel(CrankSlider(0.05, 0.15), np.array([0.0, 0.1])) == [0.0, math.pi]
    array([ True,  True])
    """
    radius, rod = crank.radius, crank.rod
    inner = np.sqrt(travel * (2.0 * rod - travel))
    outer = np.sqrt(np.maximum(2.0 * radius - travel, 0.0) * (2.0 * (rod + radius) - travel))
    return 2.0 * np.arctan2(inner, outer)


class NoLoop(ValueError):
    """Rows that are no closed loop: the position of the row (None: of all), what is wrong, what would be right."""

    def __init__(self, row: int | None, message: str, hint: str) -> None:
        self.row, self.message, self.hint = row, message, hint
        super().__init__(message)


def of_loop(crank: CrankSlider, travel: FloatArray, pressure: FloatArray, meet: float) -> Diagram:
    """The diagram of rows in the order in which the piston moves, from any of them on; the last repeats the first.

    travel: (rows,) m from the outer dead centre, which rises once from 0 to the stroke and falls once to 0; pressure:
    (rows,) Pa. meet: of the largest pressure, by how much two rows at one place may differ. Raises NoLoop.
    """
    near, apart, kept = SAME_ROW * 2.0 * crank.radius, meet * pressure.max(), [0]
    for row in range(1, len(travel)):
        if abs(travel[row] - travel[kept[-1]]) > near:
            kept.append(row)
        elif abs(pressure[row] - pressure[kept[-1]]) > apart:
            raise NoLoop(row, "two pressures at one volume", "rows follow the motion of the piston")
    last = len(travel) - 1
    if abs(travel[-1] - travel[0]) > near:
        hint = "the last row repeats the first, a revolution later"
        raise NoLoop(last, "the loop is not closed", hint)
    if abs(pressure[-1] - pressure[0]) > apart:
        message = "it ends with another pressure than it begins with"
        raise NoLoop(last, message, "the loop is closed")
    rows = np.array(kept[:-1])
    rows = np.roll(rows, -int(np.argmin(travel[rows])))
    turn = int(np.argmax(travel[rows]))
    if not 0 < turn < len(rows) - 1:
        hint = "expansion and suction, then compression and discharge"
        raise NoLoop(None, "the rows do not form a loop of two branches", hint)
    wrong = np.flatnonzero((np.diff(travel[rows]) > 0) != (np.arange(len(rows) - 1) < turn))
    if wrong.size:
        hint = "in the order of motion it rises once and falls once"
        raise NoLoop(int(rows[wrong[0] + 1]), "the volume turns back between its ends", hint)
    angle = angle_of_travel(crank, travel[rows])
    angle[turn + 1 :] = 2.0 * math.pi - angle[turn + 1 :]
    return Diagram(np.append(angle, 2.0 * math.pi), np.append(pressure[rows], pressure[rows[0]]))


BURNT = 6.908  # a: 99.9 % of the heat at the end of the duration
# Of the start of heat.
EARLIEST, LATEST, STEP = math.radians(-60.0), math.radians(30.0), math.radians(3.0)
NODE, WEIGHT = np.polynomial.legendre.leggauss(NODES)


class UnreachablePressure(ValueError):
    """No start of heat gives the peak pressure; `lowest` and `highest` (Pa) are those that can be reached."""

    def __init__(self, lowest: float, highest: float) -> None:
        self.lowest, self.highest = lowest, highest
        super().__init__(f"the peak pressure can be {lowest:g} to {highest:g} Pa")


@dataclass(frozen=True)
class Cycle:
    """What a cycle is made of; SI, angles in rad from firing top dead centre."""

    cylinder: Cylinder
    ratio: float  # of compression
    charge: float  # Pa, at the begin of compression and of the intake
    exhaust: float  # Pa, of the exhaust stroke (four strokes)
    gamma: float
    shape: float  # m
    duration: float  # rad
    exhaust_opens: float = math.pi  # of two strokes; it closes as long before top dead centre
    # Of two strokes; until then the pressure falls in a straight line to the charge.
    scavenge_opens: float = math.pi
    start: float = 0.0  # of heat
    heat: float = 0.0  # J

    @property
    def closes(self) -> float:
        """Crank angle at which compression begins."""
        bottom = self.cylinder.crank.bottom
        return -self.exhaust_opens if self.cylinder.revolutions == 1 else bottom - 2.0 * math.pi

    @property
    def opens(self) -> float:
        """Crank angle at which expansion ends."""
        return self.exhaust_opens if self.cylinder.revolutions == 1 else self.cylinder.crank.bottom

    def _rate(self, angle: FloatArray) -> FloatArray:
        """V^(g-1) dx_b/dangle while heat is released."""
        y = np.clip((angle - self.start) / self.duration, 0.0, 1.0)
        power = self.shape + 1.0
        share = BURNT * power / self.duration * y**self.shape * np.exp(-BURNT * y**power)
        volume = self.cylinder.volume(angle, self.ratio)
        return volume ** (self.gamma - 1.0) * share / -math.expm1(-BURNT)

    @cached_property
    def _burning(self) -> tuple[FloatArray, FloatArray]:
        """Edges (panels + 1,) of the angles in which heat is released, and the integral of the rate up to each."""
        ends = np.array([self.start, self.start + self.duration])
        edges, angle, weight = panels(ends, math.radians(0.5))
        integral = (self._rate(angle) * weight).sum(axis=1)
        return edges, np.append(0.0, np.cumsum(integral))

    def closed(self, angle: FloatArray) -> FloatArray:
        """Pa at crank angles between closing and opening."""
        first = self.cylinder.volume(np.array(self.closes), self.ratio)
        volume = self.cylinder.volume(angle, self.ratio)
        added: FloatArray | float = 0.0
        if self.heat:
            # The integral of the rate up to the angles, of which the last part is within a panel.
            edges, before = self._burning
            flat = np.clip(angle.ravel(), edges[0], edges[-1])
            panel = np.clip(np.searchsorted(edges, flat, side="right") - 1, 0, len(edges) - 2)
            half = (flat - edges[panel]) / 2.0
            inner = self._rate(edges[panel][:, None] + half[:, None] * (NODE + 1.0)) @ WEIGHT * half
            released = (before[panel] + inner).reshape(angle.shape)
            added = (self.gamma - 1.0) * self.heat * released
        return (self.charge * first**self.gamma + added) / volume**self.gamma

    def pressure(self, angle: FloatArray) -> FloatArray:
        """Pa at crank angles from closing on, over one cycle."""
        inside = np.clip(angle, self.closes, self.opens)
        pressure = self.closed(inside)
        if self.cylinder.revolutions == 1:
            end = float(self.closed(np.array(self.opens)))
            length = max(self.scavenge_opens - self.opens, 1e-12)
            share = np.clip((angle - self.opens) / length, 0.0, 1.0)
            exchanged = end + (self.charge - end) * share
        else:
            exchanged = np.where(angle < 2.0 * math.pi, self.exhaust, self.charge)
        return np.where(angle <= self.opens, pressure, exchanged)

    @property
    def corners(self) -> FloatArray:
        """rad of one cycle from closing on, between which the pressure is smooth."""
        middle = self.scavenge_opens if self.cylinder.revolutions == 1 else 2.0 * math.pi
        corners = [self.start, self.start + self.duration, self.opens, middle]
        ends = self.closes, self.closes + self.cylinder.period
        return np.unique([*ends, *(corner for corner in corners if ends[0] < corner < ends[1])])

    def torque(self, count: int, around: float = 0.0) -> ComplexArray:
        """(count + 1,) N m: harmonics of the gas torque."""
        return _torque(self, count, around).copy()

    @property
    def motored(self) -> "Cycle":
        return replace(self, heat=0.0)

    @property
    def peak(self) -> float:
        """Largest pressure of the cycle (Pa), refined between samples."""
        angle = np.linspace(min(self.start, -0.1), min(self.start + self.duration, self.opens), 241)
        highest = int(np.argmax(self.closed(angle)))
        ends = angle[max(highest - 1, 0)], angle[min(highest + 1, len(angle) - 1)]
        _, lowest = find_minimum(lambda x: -float(self.closed(np.array(x))), *ends, tolerance=1e-9)
        return -float(lowest)


@lru_cache(maxsize=32)
def _torque(cycle: Cycle, count: int, around: float) -> ComplexArray:
    return harmonics(
        lambda angle: (cycle.pressure(angle) - around) * cycle.cylinder.lever(angle),
        cycle.corners,
        cycle.cylinder.revolutions,
        count,
    )


def timed(cycle: Cycle, imep: float, start: float) -> Cycle:
    """The cycle with the heat (J) that gives an imep (Pa) when it begins at `start` (rad)."""
    some = replace(cycle, start=start, heat=imep * cycle.cylinder.swept)
    none, reached = (float(of_heat.torque(0)[0].real) for of_heat in (cycle.motored, some))
    wanted = cycle.cylinder.mean_torque(imep)
    return replace(some, heat=some.heat * (wanted - none) / (reached - none))


def fitted(cycle: Cycle, imep: float, peak: float) -> Cycle:
    """The cycle with start and amount of heat that give an imep and a peak pressure (Pa).

    Of several starts the latest stands, before which an earlier one raises the peak. Raises UnreachablePressure.
    """
    starts = np.arange(EARLIEST, LATEST, STEP)
    starts = starts[starts + cycle.duration < cycle.opens]
    over = np.empty(len(starts))
    for number in reversed(range(len(starts))):
        over[number] = timed(cycle, imep, starts[number]).peak - peak
        if over[number] >= 0 and number + 1 < len(starts) and over[number + 1] < 0:
            break
    else:
        raise UnreachablePressure(float(over.min()) + peak, float(over.max()) + peak)
    low, high = starts[number], starts[number + 1]
    root = find_root(lambda x: timed(cycle, imep, x).peak - peak, low, high, tolerance=1e-13)
    return timed(cycle, imep, float(root))
