"""Natural frequencies over the speed where the stiffness of a coupling follows its mean torque, and critical speeds."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

import numpy as np

from torsion.analyses.steady import steady
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import refuse_beyond, taken_under
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.primitives import tabled_spring
from torsion.results import reported, result
from torsion.study import Study

SPEEDS = 61  # at least so many over the range, and the corners of the tables between them
ROUNDING = 1e-13  # relative, of a speed at which an order meets a mode


@reported
class StiffnessOverSpeed:
    """A coupling with a table over mean torque."""

    coupling: str = result("", (), "its name")
    torque: FloatArray = result("N*m", ("speed",), "its mean torque, at its driving station's speed")
    stiffness: FloatArray = result("N*m/rad", ("speed",), "tangent stiffness there")


@reported
class FrequenciesOverSpeed:
    """Natural frequencies at the stiffness that the mean torque of each speed gives."""

    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    frequency: FloatArray = result("Hz", ("mode", "speed"), "undamped natural frequencies at each speed")
    couplings: tuple[StiffnessOverSpeed, ...] = result("", (), "couplings by table over mean torque")
    at: Callable[[float], FloatArray]  # rad/s of the reference station to (modes,) Hz

    def crossings(self, order: Fraction) -> Iterator[tuple[int, float, float]]:
        """Mode (from 1), speed (rad/s) and frequency (Hz) of every root of order n/2 pi = f(n) in the range.

        A mode may have none or several. They are sought between the speeds of the result, and where the distance has a
        least value between two of them.
        """
        for mode in range(len(self.frequency)):

            def apart(speed: float, row: int = mode) -> float:
                return float(order) * speed / (2.0 * math.pi) - float(self.at(speed)[row])

            for speed in _roots(apart, self.speed.tolist()):
                yield mode + 1, speed, float(order) * speed / (2.0 * math.pi)


def _roots(distance: Callable[[float], float], points: list[float]) -> Iterator[float]:
    """Every root that changes of sign between the points show, or between a point and a least value beside it."""
    from scipy.optimize import brentq, minimize_scalar

    values = [distance(point) for point in points]
    marks = list(zip(points, values, strict=True))
    for k in range(1, len(points) - 1):
        before, here, after = values[k - 1 : k + 2]
        same = min(before * here, here * after) > 0.0
        if same and abs(here) <= abs(before) and abs(here) <= abs(after):
            sign = math.copysign(1.0, here)
            least = minimize_scalar(
                lambda x, s=sign: s * distance(x), bounds=(points[k - 1], points[k + 1]), method="bounded"
            )
            marks.append((float(least.x), sign * float(least.fun)))
    marks.sort()
    for (left, first), (right, second) in pairwise(marks):
        if first == 0.0:
            yield left
        elif first * second < 0.0:
            yield float(brentq(distance, left, right, xtol=ROUNDING * right, rtol=4.0 * np.finfo(float).eps))
    if marks[-1][1] == 0.0:
        yield marks[-1][0]


def frequencies_over_speed(study: Study, system: System, count: int) -> FrequenciesOverSpeed:
    """Over the speed range of the operation, of `count` modes; raises InputError where a table does not cover it."""
    speeds, tables = study.operation.speeds, system.tables_over("mean torque")
    if speeds is None:
        hint = "for example `speeds: {from: 300 rpm, to: 1800 rpm}`"
        raise InputError([Fault(("operation", "speeds"), "frequencies over the speed need the speeds", hint)])
    grid = np.union1d(np.linspace(speeds.first, speeds.last, SPEEDS), _corners(study, system, speeds.values()))
    mean = steady(study.train, system, study.operation, grid).torque
    rows = []
    for span, table in tables.items():
        torque = np.abs(mean[span])
        refuse_beyond(system, span, torque)
        rows.append(StiffnessOverSpeed(system.spans[span].name, torque, table.values(torque)[0]))

    @lru_cache(maxsize=4096)
    def at(speed: float) -> FloatArray:
        torque = steady(study.train, system, study.operation, np.array([speed])).torque[:, 0]
        return modes_as_discretised(taken_under(system, torque), count).frequency

    found = np.array([at(speed) for speed in grid.tolist()]).T
    return FrequenciesOverSpeed(grid, found, tuple(rows), at)


def _corners(study: Study, system: System, fine: FloatArray) -> FloatArray:
    """Speeds (rad/s) near which the mean torque of a coupling passes a point of its table: there curves bend."""
    mean = np.abs(steady(study.train, system, study.operation, fine).torque)
    found = [fine[:0]]
    for span, table in system.tables_over("mean torque").items():
        piece = np.searchsorted(table.at, mean[span], side="right")
        found.append(fine[1:][np.diff(piece) != 0])
    return np.concatenate(found)


def at_operating_point(study: Study) -> Study:
    """The study whose couplings by mean torque have the stiffness of the rated, else of the highest speed.

    Raises InputError where a table does not cover the mean torque there.
    """
    if not study.train.has_tables_over("mean torque"):
        return study
    system = assemble(study.train)
    mean = steady(study.train, system, study.operation, np.array([study.operation.speed or 0.0])).torque[:, 0]
    springs = list(study.train.springs)
    for span, table in system.tables_over("mean torque").items():
        refuse_beyond(system, span, np.abs(mean[span]))
        one = springs[span]
        springs[span] = tabled_spring(one.name, one.part, (one.driving, one.driven), table, abs(float(mean[span])))
    return replace(study, train=replace(study.train, springs=tuple(springs)))


def run(work: Work) -> None:
    """Where modes were found and speeds are given."""
    modes = work.get(Modes)
    if modes is None or work.study.operation.speeds is None or not modes.frequency.size:
        work.log.without("frequencies over the speed", "no modes" if modes is None else "`operation` has no speeds")
        return
    with work.log.step("frequencies over the speed", "a stiffness follows the mean torque") as step:
        found = frequencies_over_speed(work.study, work.system, modes.frequency.size)
        step.method = "modes at the stiffness of each speed"
        step.size = f"{found.speed.size} speeds"
    work.put(frequencies_over_speed=found)
