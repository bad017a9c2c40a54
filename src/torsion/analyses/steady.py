"""Mean torque in every span (order 0) from the load law and the gear ratios."""

from fractions import Fraction

import numpy as np

from torsion.analyses.power import flow
from torsion.analyses.statics import Shares, statics
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Operation, Study
from torsion.train import Train

SAME_SPEED = 1e-9  # relative: a speed that lies outside a table by less was written in another unit


@reported
class Steady:
    """The train at constant speed."""

    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    torque: FloatArray = result("N*m", ("span", "speed"), "mean torque at the driving station's speed")
    applied: FloatArray = result("N*m", ("station", "speed"), "drive positive, load negative")
    twist: FloatArray  # (stations, speeds) rad at own speed, elastic, against the reference station
    sharing: str = result("", (), "how the load was shared, in words")


def steady(train: Train, system: System, operation: Operation, speed: FloatArray) -> Steady:
    """Mean torques at reference speeds (speeds,) rad/s.

    Where the torque enters and leaves is `power.flow`'s. Raises InputError as that does, and where the operation says
    no mean torque or its table does not cover the speeds.
    """
    speed = np.atleast_1d(np.asarray(speed, dtype=np.float64))
    mean = mean_torque(operation, speed)
    power = flow(train, operation)
    shares: Shares = [Fraction(0)] * len(system.stations)
    for station, share in power.drives:
        shares[station] += share
    for station, share in power.loads:
        shares[station] -= share
    one = statics(system, shares, reference_station(train, operation))
    applied = np.array([float(share / station.ratio) for share, station in zip(shares, system.stations, strict=True)])
    return Steady(
        speed,
        np.outer(one.torque / system.span_ratio, mean),
        np.outer(applied, mean),
        np.outer(one.twist * system.speed_ratio, mean),
        power.told,
    )


def steady_if_known(study: Study, system: System, speed: FloatArray) -> Steady | None:
    """Mean torques at the speeds (speeds,) rad/s; None where the operation does not say them."""
    if not study.operation.has_mean_torque:
        return None
    return steady(study.train, system, study.operation, speed)


def mean_torque(operation: Operation, speed: FloatArray) -> FloatArray:
    """(speeds,) N m at the reference station, from the load law; raises InputError where the file does not say it."""
    load = operation.load
    if not isinstance(load, str):
        return interpolated(load, speed, Fault(("operation", "load"), "the table of the load", "")).copy()
    rated = operation.rated
    if rated is None or rated.power is None:
        hint = "for example `rated: {speed: 1500 rpm, power: 100 kW}`"
        raise InputError([Fault(("operation", "rated"), "the mean torque needs the rated power", hint)])
    torque = rated.power / rated.speed
    return torque * (speed / rated.speed) ** 2 if load == "propeller" else np.full_like(speed, torque)


def interpolated(table: tuple[tuple[float, float], ...], speed: FloatArray, about: Fault) -> FloatArray:
    """Torque (speeds,) N m from a table over speed, linear between its rows and never beyond them.

    `about` names the table and its place; raises InputError where the table does not cover the speeds.
    """
    rows = np.array(table, dtype=np.float64)
    first, last = rows[0, 0], rows[-1, 0]
    if speed.size and (speed.min() < first * (1 - SAME_SPEED) or speed.max() > last * (1 + SAME_SPEED)):
        covers = f"covers {_rpm(first)} to {_rpm(last)}, the speeds run from {_rpm(speed.min())} to {_rpm(speed.max())}"
        hint = "extend the table, or narrow the speeds; nothing is extrapolated"
        raise InputError([Fault(about.path, f"{about.message} {covers}", hint)])
    return np.asarray(np.interp(speed, rows[:, 0], rows[:, 1]))


def reference_station(train: Train, operation: Operation) -> int:
    """The station whose speed and angle are meant: that of the component `at`, else the first one."""
    if operation.at is not None:
        stations = train.part(operation.at).stations
        if stations:
            return stations[0]
    return next((k for k, station in enumerate(train.stations) if station.ratio == 1), 0)


def _rpm(speed: float) -> str:
    return f"{speed * 30.0 / np.pi:.6g} rpm"


def run(work: Work) -> None:
    """Mean torques over the speed range, at the rated speed and at the corners of a table of the load."""
    operation = work.study.operation
    if not operation.has_mean_torque:
        work.log.without("mean torque", "`operation` says no rated power and no table of the load")
        return
    speeds = operation.speeds
    grid = speeds.values() if speeds is not None else np.array([operation.speed] if operation.speed is not None else [])
    if operation.rated is not None:
        grid = np.union1d(grid, [operation.rated.speed])
    if speeds is not None and not isinstance(operation.load, str):
        grid = np.union1d(grid, [row[0] for row in operation.load if speeds.first <= row[0] <= speeds.last])
    if not grid.size:
        work.log.without("mean torque", "`operation` says no speed")
        return
    with work.log.step("mean torque", "`operation` says the load") as step:
        work.put(mean=steady(work.study.train, work.system, operation, grid))
        step.method = "sums over the tree"
        step.size = f"{grid.size} speeds"
