"""Natural frequencies over the speed where a stiffness follows the speed or a mean torque, and critical speeds.

Of a stiffness that follows the square of the speed alone (a pendulum's) no curve rises faster than the speed, as shares
of the elastic energy are 1 at most: an order meets each curve once at most, and a change of sign misses none.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache
from itertools import pairwise

import numpy as np

from torsion.analyses.response.grid import resonances
from torsion.analyses.steady import steady
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import refuse_beyond, taken_under
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.kernels.bracketed_search import find_minimum, find_root
from torsion.primitives import tabled_spring
from torsion.results import reported, result
from torsion.study import Study

SPEEDS = 61  # at least so many over the range, and the corners of the tables between them
COUNTED = 5  # speeds at which modes are counted
FEW_SPEEDS = 31  # of smooth curves that each order meets once at most
ROUNDING = 1e-13  # relative, of a speed at which an order meets a mode


@reported
class StiffnessOverSpeed:
    """A coupling with a table over mean torque."""

    coupling: str = result("", (), "its name")
    torque: FloatArray = result(
        "N*m", ("speed",), "its mean torque, at its driving station's speed"
    )
    stiffness: FloatArray = result("N*m/rad", ("speed",), "tangent stiffness there")


@reported
class FrequenciesOverSpeed:
    """Natural frequencies at the stiffness that each speed and its mean torque give."""

    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    frequency: FloatArray = result(
        "Hz", ("mode", "speed"), "undamped natural frequencies at each speed"
    )
    couplings: tuple[StiffnessOverSpeed, ...] = result(
        "", (), "couplings by table over mean torque"
    )
    at: Callable[[float], FloatArray]  # rad/s of the reference station to (modes,) Hz

    def crossings(self, order: Fraction) -> Iterator[tuple[int, float, float]]:
        """Mode (from 1), speed (rad/s) and frequency (Hz) of every root of order n/2 pi = f(n) in the range.

        A mode may have none or several. They are sought between the speeds of the result, and where the distance has a
        least value between two of them.
        """
        for mode in range(len(self.frequency)):

            def apart(speed: float, row: int = mode) -> float:
                return float(order) * speed / (2.0 * math.pi) - float(self.at(speed)[row])

            for speed in _roots(apart, self.speed.tolist(), once=not self.couplings):
                yield mode + 1, speed, float(order) * speed / (2.0 * math.pi)


def _roots(
    distance: Callable[[float], float], points: list[float], *, once: bool
) -> Iterator[float]:
    """Every root that changes of sign between the points show, or between a point and a least value beside it.

    once: there is one at most.
    """
    values = [distance(point) for point in points]
    marks = list(zip(points, values, strict=True))
    for k in range(1, 0 if once else len(points) - 1):
        before, here, after = values[k - 1 : k + 2]
        same = min(before * here, here * after) > 0.0
        if same and abs(here) <= abs(before) and abs(here) <= abs(after):
            sign = math.copysign(1.0, here)
            nearest, least = find_minimum(
                lambda x, s=sign: s * distance(x), points[k - 1], points[k + 1]
            )
            marks.append((float(nearest), sign * float(least)))
    marks.sort()
    for (left, first), (right, second) in pairwise(marks):
        if first == 0.0:
            yield left
        elif first * second < 0.0:
            yield float(find_root(distance, left, right, tolerance=ROUNDING * right))
    if marks[-1][1] == 0.0:
        yield marks[-1][0]


def frequencies_over_speed(study: Study, system: System, count: int) -> FrequenciesOverSpeed:
    """Over the speed range of the operation, of `count` modes; raises InputError where a table does not cover it."""
    speeds, tables = study.operation.speeds, system.tables_over("mean torque")
    if speeds is None:
        hint = "for example `speeds: {from: 300 rpm, to: 1800 rpm}`"
        raise InputError(
            [Fault(("operation", "speeds"), "frequencies over the speed need the speeds", hint)]
        )
    number = SPEEDS if tables else FEW_SPEEDS
    grid = np.union1d(
        np.linspace(speeds.first, speeds.last, number), _corners(study, system, speeds.values())
    )
    mean = _mean_torque(study, system, grid)
    rows = []
    for span, table in tables.items():
        torque = np.abs(mean[span])
        refuse_beyond(system, span, torque)
        rows.append(StiffnessOverSpeed(system.spans[span].name, torque, table.values(torque)[0]))

    @lru_cache(maxsize=4096)
    def at(speed: float) -> FloatArray:
        torque = _mean_torque(study, system, np.array([speed]))[:, 0]
        return modes_as_discretised(taken_under(system, torque, speed), count).frequency

    found = [at(speed) for speed in grid.tolist()]
    number = min(map(len, found))  # a table over frequency may end below a mode
    return FrequenciesOverSpeed(grid, np.array([one[:number] for one in found]).T, tuple(rows), at)


def reaching(
    study: Study, system: System, known: FrequenciesOverSpeed | None, highest: float
) -> FrequenciesOverSpeed:
    """The known frequencies where they reach a highest one (rad/s) at every speed; else of as many modes as do."""
    speeds = study.operation.speeds
    if (
        known is not None
        and known.frequency.size
        and 2.0 * math.pi * known.frequency[-1].min() > highest
    ):
        return known
    count = 1
    for speed in np.linspace(speeds.first, speeds.last, COUNTED) if speeds is not None else ():
        mean = _mean_torque(study, system, np.array([speed]))[:, 0]
        count = max(
            count, len(resonances(taken_under(system, mean, speed), highest, None, None).frequency)
        )
    return frequencies_over_speed(study, system, count)


def _mean_torque(study: Study, system: System, speed: FloatArray) -> FloatArray:
    """(spans, speeds) N m; 0 where no stiffness follows it."""
    if not system.tables_over("mean torque"):
        return np.zeros((len(system.spans), len(speed)))
    return steady(study.train, system, study.operation, speed).torque


def _corners(study: Study, system: System, fine: FloatArray) -> FloatArray:
    """Speeds (rad/s) near which the mean torque of a coupling passes a point of its table: there curves bend."""
    mean = np.abs(_mean_torque(study, system, fine))
    found = [fine[:0]]
    for span, table in system.tables_over("mean torque").items():
        piece = np.searchsorted(table.at, mean[span], side="right")
        found.append(fine[1:][np.diff(piece) != 0])
    return np.concatenate(found)


def at_operating_point(study: Study) -> Study:
    """The study whose stiffnesses by speed or mean torque are those of the rated, else of the highest speed.

    Raises InputError where a table does not cover the mean torque there.
    """
    if not study.train.follows_speed:
        return study
    system, speed = assemble(study.train), study.operation.speed or 0.0
    mean = _mean_torque(study, system, np.array([speed]))[:, 0]
    springs = list(study.train.springs)
    for span, table in system.tables.items():
        own, none = np.array(speed), np.zeros(())
        x = (
            None
            if table.over == "frequency"
            else system.followed(span, none, np.asarray(mean[span]), own)
        )
        if x is None:
            continue
        refuse_beyond(system, span, x)
        one = springs[span]
        springs[span] = tabled_spring(
            one.name, one.part, (one.driving, one.driven), table, float(x)
        )
    return replace(study, train=replace(study.train, springs=tuple(springs)))


def run(work: Work) -> None:
    """Where modes were found and speeds are given."""
    modes = work.get(Modes)
    if modes is None or work.study.operation.speeds is None or not modes.frequency.size:
        work.log.without(
            "frequencies over the speed",
            "no modes" if modes is None else "`operation` has no speeds",
        )
        return
    with work.log.step("frequencies over the speed", "a stiffness follows the speed") as step:
        found = frequencies_over_speed(work.study, work.system, modes.frequency.size)
        step.method = "modes at the stiffness of each speed"
        step.size = f"{found.speed.size} speeds"
    work.put(frequencies_over_speed=found)
