"""The mean speed of a free train: the torque that the vibration of its joints costs, and where the speed drifts.

Averaged over the common period J dΩ/dt = T_drive - T_loads - P/Ω, with the power P lost by the vibration. A deviation
of the mean speed grows as exp(σt) with σ ≈ -D/J, D = d(P/Ω)/dΩ + slopes of drive and load; both are zero together.
"""

from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from functools import partial

import numpy as np

from torsion.analyses.stability.mechanism_loads import Scene
from torsion.analyses.stability.periodic_orbits import Orbit, orbit
from torsion.arrays import FloatArray
from torsion.errors import SolveError
from torsion.kernels.bracketed_search import find_minimum, find_root
from torsion.results import reported, result

SLOW = 1e-3  # 1/s: a slower drift is not reported
STEP = 1e-5  # relative: of the speed, in a difference quotient of the torque lost
BOUNDARY = 1e-6  # relative: how closely the ends of a drift are sought
PEAK = 2e-3  # of the interval in which the greatest drift is sought
AROUND = 0.02  # relative: how far the speed that lacks the greatest slope moves as the slope damps the vibration
SMOOTH = 1e-4  # relative: how closely it is sought
SHARP = 1e-4  # relative: how closely the slope that is missing is sought
MOST_TURNS = 8  # of speed and slope


@reported
class MeanSpeedDrift:
    """Speeds at which the mean speed runs away from its value, and the slope of a drive that holds it."""

    first: float = result(
        "rad/s", "lowest speed that drifts faster than 1e-3 1/s", key="from_rad_per_s"
    )
    last: float = result("rad/s", "highest one", key="to_rad_per_s")
    growth: float = result("1/s", "fastest drift")
    at: float = result("rad/s", "where")
    slope: float = result(
        "N*m*s/rad", "slope missing at the machine, at its own speed; null if not found"
    )
    machine: str = result("the machine that drives, at which the slope is missing")
    given: float = result(
        "N*m*s/rad",
        "slopes and damping of the file that act on the mean speed, at that machine",
    )
    slip: float = result(
        "N*m*s/rad", "slope at 1 % slip of that machine; null without a rated speed"
    )


def drift_slope(mechanism: Scene, speed: float, near: Orbit) -> tuple[float, Orbit | None]:
    """Return D (N m s/rad at the reference) at a speed (rad/s), from two motions beside it, and one of them.

    near: a motion to start from. D is NaN where there is none.
    """
    try:
        slower = orbit(mechanism, speed * (1.0 - STEP), near)
        faster = orbit(mechanism, speed * (1.0 + STEP), slower)
    except SolveError:
        return np.nan, None
    # What the vibration costs beside the torque of the loads.
    lost = [float(side.balance.load[0] - side.operation.load[0]) for side in (slower, faster)]
    change = (lost[1] - lost[0]) / (2.0 * STEP * speed)
    return change + (mean_speed_damping(slower) + mean_speed_damping(faster)) / 2.0, faster


def mean_speed_damping(motion: Orbit) -> float:
    """Return the sum of slopes and dampings to ground (N m s/rad at the reference) that act on the mean speed."""
    return float(motion.operation.loading.damping.sum() + motion.operation.on_mean_speed)


def missing_slope(
    mechanism: Scene, start: Orbit, limits: tuple[float, float], station: int
) -> float:
    """Return the slope (N m s/rad at the reference) that the station lacks so that the speed does not drift.

    start: the motion that drifts fastest; limits: lowest and highest speed (rad/s) of all. NaN where none was found.
    The slope damps the vibration too, so that less is needed than -D without it.
    """
    before = start
    worst = start.operation.loading.speed
    at_station = np.eye(len(mechanism.slopes))[station]

    def slope_of_all(speed: float, slope: float) -> float:
        """Return D at a speed with a slope at the station; infinite where there is no motion."""
        nonlocal before
        steadied = replace(mechanism, slopes=mechanism.slopes + slope * at_station)
        total, motion = drift_slope(steadied, float(speed), before)
        before = motion or before
        return float(np.nan_to_num(total, nan=np.inf))

    # In turn the slope that the speed lacks and the speed that lacks most with it: it hardly moves with the slope, and
    # what is lacking is flat about it, so that two or three turns suffice.
    slope, speed, least = 0.0, worst, slope_of_all(worst, 0.0)
    around = AROUND * worst
    for _ in range(MOST_TURNS):
        if abs(least) <= SHARP * slope or (least >= 0.0 and slope == 0.0):
            return slope
        try:
            root = find_root(
                partial(slope_of_all, speed),
                slope,
                slope - least,
                relative=SHARP / 10.0 if slope else AROUND,
            )
        except ValueError:  # the slope steadies nothing there
            break
        slope = float(root)
        reach = max(speed - around, limits[0]), min(speed + around, limits[1])
        tolerance = SMOOTH * speed
        place, least = find_minimum(partial(slope_of_all, slope=slope), *reach, tolerance=tolerance)
        speed, around = place, 2.0 * abs(place - speed) + tolerance
    return np.nan


def drift_ends(
    drift: Callable[[float], float], speeds: FloatArray, values: FloatArray
) -> tuple[float, float]:
    """Return the lowest and the highest speed (rad/s) at which the drift reaches SLOW; speeds ascend."""
    fast = np.flatnonzero(np.nan_to_num(values, nan=-np.inf) > SLOW)
    ends = []
    for row, neighbour in ((fast[0], fast[0] - 1), (fast[-1], fast[-1] + 1)):
        end = float(speeds[row])
        if 0 <= neighbour < len(speeds) and np.isfinite(values[neighbour]):
            bounds = end, float(speeds[neighbour])
            with suppress(ValueError):  # no drift was distinguished between them
                end = float(
                    find_root(
                        lambda w: drift(w) - SLOW, *bounds, tolerance=2e-12, relative=BOUNDARY
                    )
                )
        ends.append(end)
    return ends[0], ends[1]
