"""Natural frequencies over the speed where a stiffness follows the speed or a mean torque, and critical speeds.

Of a stiffness that follows the square of the speed alone (a pendulum's) no curve rises faster than the speed, as shares
of the elastic energy are 1 at most: an order meets each curve once at most, and a change of sign misses none.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from fractions import Fraction
from functools import lru_cache, partial
from itertools import pairwise

import numpy as np

from torsion.analyses.response.grid import modes_reaching
from torsion.analyses.steady import steady
from torsion.analyses.undamped_modes import Modes, modes_as_discretised
from torsion.arrays import FloatArray
from torsion.assembly import assemble
from torsion.assembly.system import System
from torsion.assembly.tabled_spans import refuse_beyond, taken_at
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
TAU = 2.0 * math.pi


@reported
class StiffnessOverSpeed:
    """A coupling with a table over mean torque."""

    coupling: str = result("its name")
    torque: FloatArray = result("N*m", "speed", "its mean torque, at its driving station's speed")
    stiffness: FloatArray = result("N*m/rad", "speed", "tangent stiffness there")


@reported
class FrequenciesOverSpeed:
    """Natural frequencies at the stiffness that each speed and its mean torque give."""

    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    frequency: FloatArray = result(
        "Hz", ("mode", "speed"), "undamped natural frequencies at each speed"
    )
    couplings: tuple[StiffnessOverSpeed, ...] = result("couplings by table over mean torque")
    at: Callable[[float], FloatArray]  # rad/s of the reference station to (modes,) Hz

    def crossings(self, order: Fraction) -> Iterator[tuple[int, float, float]]:
        """Yield mode (from 1), speed (rad/s) and frequency (Hz) of every root of order n/2 pi = f(n) in the range.

        A mode may have none or several. They are sought between the speeds of the result, and where the distance has a
        minimum between two of them.
        """
        for mode in range(len(self.frequency)):

            def distance(speed: float, row: int = mode, sign: float = 1.0) -> float:
                return sign * (float(order) * speed / TAU - float(self.at(speed)[row]))

            marks = [(speed, distance(speed)) for speed in self.speed.tolist()]
            triples = zip(marks, marks[1:], marks[2:], strict=False) if self.couplings else ()
            for (left, before), (_, middle), (right, after) in list(triples):
                has_one_sign = min(before * middle, middle * after) > 0.0
                if has_one_sign and abs(middle) <= min(abs(before), abs(after)):
                    sign = math.copysign(1.0, middle)
                    lowest, value = find_minimum(partial(distance, sign=sign), left, right)
                    marks.append((float(lowest), sign * float(value)))
            marks.sort()
            roots = []
            for (left, before), (right, after) in pairwise(marks):
                if before == 0.0:
                    roots.append(left)
                elif before * after < 0.0:
                    root = find_root(distance, left, right, tolerance=ROUNDING * right)
                    roots.append(float(root))
            if marks[-1][1] == 0.0:
                roots.append(marks[-1][0])
            for speed in roots:
                yield mode + 1, speed, float(order) * speed / TAU


def frequencies_over_speed(study: Study, system: System, count: int) -> FrequenciesOverSpeed:
    """Return `count` modes over the speed range; raises InputError where a table does not cover it."""
    speeds = study.operation.speeds
    tables = system.tables_over("mean torque")
    if speeds is None:
        message = "frequencies over the speed need the speeds"
        hint = "for example `speeds: {from: 300 rpm, to: 1800 rpm}`"
        raise InputError([Fault(("operation", "speeds"), message, hint)])
    # Near where the mean torque of a coupling passes a point of its table the curves bend.
    requested = speeds.values()
    mean = np.abs(_mean_torque(study, system, requested))
    grid = np.linspace(speeds.first, speeds.last, SPEEDS if tables else FEW_SPEEDS)
    for span, table in tables.items():
        piece = np.searchsorted(table.at, mean[span], side="right")
        grid = np.union1d(grid, requested[1:][np.diff(piece) != 0])
    mean = _mean_torque(study, system, grid)
    couplings = []
    for span, table in tables.items():
        torque = np.abs(mean[span])
        refuse_beyond(system, span, torque)
        stiffness = table.values(torque)[0]
        couplings.append(StiffnessOverSpeed(system.spans[span].name, torque, stiffness))

    @lru_cache(maxsize=4096)
    def frequencies_at(speed: float) -> FloatArray:
        torque = _mean_torque(study, system, np.array([speed]))[:, 0]
        return modes_as_discretised(taken_at(system, mean=torque, speed=speed), count).frequency

    columns = [frequencies_at(speed) for speed in grid.tolist()]
    number = min(map(len, columns))  # a table over frequency may end below a mode
    rows = np.array([column[:number] for column in columns]).T
    return FrequenciesOverSpeed(grid, rows, tuple(couplings), frequencies_at)


def reaching(
    study: Study, system: System, known: FrequenciesOverSpeed | None, highest: float
) -> FrequenciesOverSpeed:
    """Return the known frequencies if they reach `highest` (rad/s) at every speed; else those of more modes."""
    if known is not None and known.frequency.size and TAU * known.frequency[-1].min() > highest:
        return known
    count = 1
    speeds = study.operation.speeds
    for speed in np.linspace(speeds.first, speeds.last, COUNTED) if speeds is not None else ():
        torque = _mean_torque(study, system, np.array([speed]))[:, 0]
        modes = modes_reaching(taken_at(system, mean=torque, speed=speed), highest, None)
        count = max(count, modes.frequency.size)
    return frequencies_over_speed(study, system, count)


def _mean_torque(study: Study, system: System, speed: FloatArray) -> FloatArray:
    """Return the mean torque (spans, speeds) N m; 0 where no stiffness follows it."""
    if not system.tables_over("mean torque"):
        return np.zeros((len(system.spans), len(speed)))
    return steady(study.train, system, study.operation, speed).torque


def at_operating_point(study: Study) -> Study:
    """Return the study whose stiffnesses by speed or mean torque are those of the rated, else of the highest speed.

    Raises InputError where a table does not cover the mean torque there.
    """
    if not study.train.follows_speed:
        return study
    system = assemble(study.train)
    speed = np.array(study.operation.speed or 0.0)
    mean = _mean_torque(study, system, speed[None])[:, 0]
    springs = list(study.train.springs)
    for span, table in system.tables.items():
        if table.over == "frequency":
            continue
        value = system.followed(span, np.zeros(()), np.asarray(mean[span]), speed)
        if value is not None:
            refuse_beyond(system, span, value)
            spring = springs[span]
            ends = spring.driving, spring.driven
            springs[span] = tabled_spring(spring.name, spring.part, ends, table, float(value))
    return replace(study, train=replace(study.train, springs=tuple(springs)))


def run(work: Work) -> None:
    """Put the frequencies over the speed where modes were computed and speeds are given."""
    modes = work.get(Modes)
    step_name = "frequencies over the speed"
    if modes is None:
        work.log.without(step_name, "no modes")
    elif work.study.operation.speeds is None or not modes.frequency.size:
        work.log.without(step_name, "`operation` has no speeds")
    else:
        with work.log.step(step_name, "a stiffness follows the speed") as step:
            curves = frequencies_over_speed(work.study, work.system, modes.frequency.size)
            step.method = "modes at the stiffness of each speed"
            step.size = f"{curves.speed.size} speeds"
        work.put(frequencies_over_speed=curves)
