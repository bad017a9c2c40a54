"""The closed cycle of a cylinder: one ratio of heats, heat by a Wiebe function, pressure by quadrature.

d(p V^g) = (g - 1) V^(g-1) dQ, hence p = V^-g (p_1 V_1^g + (g - 1) Q int V^(g-1) dx_b), x_b the burnt share
(1 - exp(-a y^(m+1)))/(1 - exp(-a)), y = (angle - start)/duration, a = 6.908. Pressure is linear in the heat Q, so that
Q follows from the indicated mean effective pressure, and one root remains: the start of heat for the peak pressure.
"""

import math
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache

import numpy as np

from torsion.arrays import ComplexArray, FloatArray
from torsion.kernels.bracketed_search import find_minimum, find_root
from torsion.kernels.engine.gas_torque import NODES, Cylinder, Panels, harmonics

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
    scavenge_opens: float = (
        math.pi
    )  # of two strokes; until then the pressure falls in a straight line to the charge
    start: float = 0.0  # of heat
    heat: float = 0.0  # J

    @property
    def is_two_stroke(self) -> bool:
        return self.cylinder.revolutions == 1

    @property
    def closes(self) -> float:
        """Crank angle at which compression begins."""
        bottom = self.cylinder.crank.bottom
        return -self.exhaust_opens if self.is_two_stroke else bottom - 2.0 * math.pi

    @property
    def opens(self) -> float:
        """Crank angle at which expansion ends."""
        return self.exhaust_opens if self.is_two_stroke else self.cylinder.crank.bottom

    @cached_property
    def burning(self) -> Panels:
        """Panels of the angles in which heat is released."""
        return Panels.between(np.array([self.start, self.start + self.duration]), math.radians(0.5))

    def _rate(self, angle: FloatArray) -> FloatArray:
        """V^(g-1) dx_b/dangle while heat is released."""
        y = np.clip((angle - self.start) / self.duration, 0.0, 1.0)
        share = (
            BURNT
            * (self.shape + 1.0)
            / self.duration
            * y**self.shape
            * np.exp(-BURNT * y ** (self.shape + 1.0))
        )
        return (
            self.cylinder.volume(angle, self.ratio) ** (self.gamma - 1.0)
            * share
            / -math.expm1(-BURNT)
        )

    @cached_property
    def _before(self) -> FloatArray:
        """(panels + 1,) integral of the rate up to every edge of the panels."""
        integral = (self._rate(self.burning.angle) * self.burning.weight).sum(axis=1)
        return np.append(0.0, np.cumsum(integral))

    def _released(self, angle: FloatArray) -> FloatArray:
        """Integral of the rate up to any angles."""
        edges, last = self.burning.edges, len(self.burning.edges) - 2
        flat = np.clip(angle.ravel(), edges[0], edges[-1])
        panel = np.clip(np.searchsorted(edges, flat, side="right") - 1, 0, last)
        half = (flat - edges[panel]) / 2.0
        inner = self._rate(edges[panel][:, None] + half[:, None] * (NODE + 1.0)) @ WEIGHT * half
        return (self._before[panel] + inner).reshape(angle.shape)

    def closed(self, angle: FloatArray) -> FloatArray:
        """Pa at crank angles between closing and opening."""
        first = self.cylinder.volume(np.array(self.closes), self.ratio)
        volume = self.cylinder.volume(angle, self.ratio)
        added = (self.gamma - 1.0) * self.heat * self._released(angle) if self.heat else 0.0
        return (self.charge * first**self.gamma + added) / volume**self.gamma

    def pressure(self, angle: FloatArray) -> FloatArray:
        """Pa at crank angles from closing on, over one cycle."""
        inside = np.clip(angle, self.closes, self.opens)
        pressure = self.closed(inside)
        if self.is_two_stroke:
            end = float(self.closed(np.array(self.opens)))
            share = np.clip(
                (angle - self.opens) / max(self.scavenge_opens - self.opens, 1e-12), 0.0, 1.0
            )
            return np.where(angle <= self.opens, pressure, end + (self.charge - end) * share)
        open_ = np.where(angle < 2.0 * math.pi, self.exhaust, self.charge)
        return np.where(angle <= self.opens, pressure, open_)

    @property
    def corners(self) -> FloatArray:
        """rad of one cycle from closing on, between which the pressure is smooth."""
        middle = self.scavenge_opens if self.is_two_stroke else 2.0 * math.pi
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
    def acting(angle: FloatArray) -> FloatArray:
        return (cycle.pressure(angle) - around) * cycle.cylinder.lever(angle)

    return harmonics(acting, Panels.between(cycle.corners), cycle.cylinder.revolutions, count)


def timed(cycle: Cycle, imep: float, start: float) -> Cycle:
    """The cycle with the heat (J) that gives an imep (Pa) when it begins at `start` (rad)."""
    some = replace(cycle, start=start, heat=imep * cycle.cylinder.swept)
    none, wanted = _mean(replace(cycle, heat=0.0)), cycle.cylinder.mean_torque(imep)
    return replace(some, heat=some.heat * (wanted - none) / (_mean(some) - none))


@lru_cache(maxsize=8)
def _mean(cycle: Cycle) -> float:
    """Return the mean gas torque (N m) of a cycle."""
    return float(cycle.torque(0)[0].real)


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
