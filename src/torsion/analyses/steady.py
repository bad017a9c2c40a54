"""Mean torque in every span (order 0): where power enters and leaves, how the spans share it, its law, and faults.

Shares are exact fractions of the torque of each load, referred to the reference speed. The sums run over a spanning
tree, so a span that carries nothing carries exactly nothing.
"""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np

from torsion.analyses.power_balance import (
    TABLE,
    Balance,
    Shared,
    Shares,
    keeping_last,
    power_balance,
    uncovered,
)
from torsion.arrays import FloatArray
from torsion.assembly.elements import elements
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import Work
from torsion.kernels.trees.tree import closing_no_loop, walk
from torsion.model.machine_torques import DriveLaw
from torsion.model.parts import Part
from torsion.results import reported, result
from torsion.study import Operation, Study
from torsion.train import Train


def statics(system: System, applied: Shares, reference: int) -> tuple[FloatArray, FloatArray]:
    """Return torques (spans,) N m and twists (stations,) rad under 1 N m, of which the shares (stations,) sum to zero.

    A torque is positive from driving to driven; twists are against the reference station.
    A grounded station that neither drives nor loads takes no mean torque: it turns at the mean speed by definition.
    Raises SolveError where the mean torque has to pass a span without stiffness, or cannot reach its load.
    """
    # A tree from the reference station, with spans without stiffness only where nothing else leads on.
    ends = len(system.stations), system.driving, system.driven
    is_stiff = np.isfinite(system.flexibility)
    way = walk(*ends, is_stiff, [reference])
    if not is_stiff.all():
        ranked = np.concatenate([way.above[way.above >= 0], np.flatnonzero(~is_stiff)])
        way = walk(*ends, closing_no_loop(*ends, ranked), [reference])
    order = way.order.tolist()
    parent = way.parent.tolist()
    above = way.above.tolist()
    # 1 where the span above a station has its driven end there, else -1.
    toward_leaves = [
        1 if span >= 0 and system.driven[span] == station else -1
        for station, span in enumerate(above)
    ]

    # A span of the tree carries what is applied beyond it.
    beyond = list(applied)
    shares = [Fraction(0)] * len(system.spans)
    for station in reversed(order):
        if (span := above[station]) >= 0:
            shares[span] = -beyond[station] * toward_leaves[station]
            beyond[parent[station]] += beyond[station]
        elif beyond[station] != 0:
            message = "the mean torque cannot reach the load"
            raise SolveError(f"{message}: drive and load are not joined by any span")
    torque = np.array([float(share) for share in shares])

    flexibility = np.where(is_stiff, system.flexibility / system.span_ratio**2, 0.0)
    loops = np.setdiff1d(np.flatnonzero(is_stiff), way.above)
    if loops.size:
        # The twists around each loop sum to zero.
        cycle = np.zeros((len(loops), len(system.spans)))
        for row, chord in zip(cycle, loops.tolist(), strict=True):
            row[chord] = 1.0
            for end, sense in ((system.driving[chord], 1.0), (system.driven[chord], -1.0)):
                station = int(end)
                while (span := above[station]) >= 0:
                    row[span] += sense * toward_leaves[station]
                    station = parent[station]
        around = (cycle * flexibility) @ cycle.T
        torque = torque - cycle.T @ np.linalg.solve(around, cycle @ (flexibility * torque))
    for span in np.flatnonzero(~is_stiff & (torque != 0)).tolist():
        message = f"the mean torque has to pass through '{system.spans[span].name}', that has damping but no stiffness"
        raise SolveError(f"{message}; give it a stiffness")
    twist = np.zeros(len(system.stations))
    for station in order:
        if (span := above[station]) >= 0:
            change = toward_leaves[station] * (flexibility[span] * torque[span])
            twist[station] = twist[parent[station]] - change
    return torque, twist


@reported
class Steady:
    """The train at constant speed."""

    speed: FloatArray = result("rad/s", "speed", "reference speeds")
    torque: FloatArray = result(
        "N*m", ("span", "speed"), "mean torque at the driving station's speed"
    )
    applied: FloatArray = result("N*m", ("station", "speed"), "drive positive, load negative")
    twist: FloatArray  # (stations, speeds) rad at own speed, elastic, against the reference station
    sharing: str = result("how the load was shared, in words")
    # (stations, speeds) N m s/rad at own speed: dT/dω of the laws of load, -dT/dω of drives without a lag
    load_slope: FloatArray
    drive_slope: FloatArray


@reported
class MachinePower:
    """What one machine, or one end of the train, delivers or absorbs at the rated speed, else at the highest."""

    name: str = result("name of the machine, or of the station in its place")
    kind: str = result("its kind in the file; empty for a station")
    enters: bool = result("true: power enters here; false: it leaves")
    speed: float = result("rad/s", "own speed of the machine")
    power: float = result("W", "power that it delivers or absorbs there")
    torque: float = result("N*m", "mean torque at its own speed, positive if it drives")
    law: str = result("law of load; empty of a machine that drives")
    free: bool = result("it takes what the others leave: computed, not stated")


@reported
class MeanLoad:
    """Mean torque of one elastic element at the rated speed, else at the highest, at its own speed."""

    component: str = result("its name")
    speed: float = result("rad/s", "its own speed")
    torque: float = result("N*m", "mean torque at its driving end")
    power: float = result("W", "power that it transmits")
    largest: float = result("N*m", "largest magnitude over the speed range")


@reported
class MeanLoads:
    """Mean torques of all elastic elements."""

    each: tuple[MeanLoad, ...] = result("mean torque of every elastic element", key="")


@reported
class PowerBalance:
    """The balance of power, machine by machine."""

    machines: tuple[MachinePower, ...] = result(
        "balance of power, every machine at its own speed", key=""
    )


def steady(train: Train, system: System, operation: Operation, speed: FloatArray) -> Steady:
    """Return mean torques at reference speeds (speeds,) rad/s.

    Where the torque enters and leaves is that of `power_balance`. Raises InputError as that does, and where a table of
    load does not cover the speeds.
    """
    speed = np.atleast_1d(np.asarray(speed, dtype=np.float64))
    balance = power_balance(train, operation)
    ratio = system.speed_ratio
    means = [load.torque_at(speed) for load in balance.loads]
    torque, applied, twist = (
        np.asarray(sum(map(np.outer, unit, means)))
        for unit in zip(*_unit_loads(train, system, operation), strict=True)
    )
    slopes = slopes_of_laws(train, operation, balance, ratio, speed)
    return Steady(speed, torque, applied, twist, balance.sentence, *slopes)


@keeping_last
def _unit_loads(
    train: Train, system: System, operation: Operation
) -> list[tuple[FloatArray, FloatArray, FloatArray]]:
    """Return the torques (spans,), what is applied, and the twists (stations,) under 1 N m of each load."""
    balance = power_balance(train, operation)
    reference = reference_station(train, operation)
    inside_shafts = [Fraction(0)] * (len(system.stations) - balance.stations)  # nothing acts there
    unit_loads = []
    for load in balance.loads:
        shares = [*balance.shares(load), *inside_shafts]
        torque, twist = statics(system, shares, reference)
        exact = zip(shares, system.stations, strict=True)
        applied = np.array([float(share / station.ratio) for share, station in exact])
        unit_loads.append((torque / system.span_ratio, applied, twist * system.speed_ratio))
    return unit_loads


def driven_by_law(train: Train) -> list[tuple[Part, DriveLaw]]:
    """Return the machines that drive by a law of the file, each with that law."""
    return [
        (part, part.machine.drive)
        for part in train.parts
        if part.machine is not None and part.machine.drive
    ]


def slopes_of_laws(
    train: Train, operation: Operation, balance: Balance, ratio: FloatArray, speed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the slopes (stations, speeds) N m s/rad of the loads, and of the drives, at reference speeds (rad/s).

    A drive with a lag has none here: it is a damper of the train. ratio: (stations,) own speed / reference speed.
    """
    loads, drives = np.zeros((2, len(ratio), len(speed)))
    for load in balance.loads:
        at_reference = load.law.slope(speed, load.speed, load.torque)
        for station, share in load.stations:
            loads[station] += float(share * balance.delivered) * at_reference / ratio[station] ** 2
    for part, law in driven_by_law(train):
        if law.lag is None:
            station = part.stations[0]
            rated_speed, rated_torque = rated_point(part, operation, balance)
            drives[station] += law.slopes(speed * abs(ratio[station]), rated_torque, rated_speed)
    return loads, drives


def rated_point(part: Part, operation: Operation, balance: Balance) -> tuple[float, float]:
    """Return own speed (rad/s) and torque (N m) of a machine that drives: as it states them, else by the balance.

    Raises InputError where neither its own speed nor that of the operation is rated.
    """
    machine = part.machine
    ratio = abs(float(part.ratio))
    rated_speed = None if operation.rated is None else operation.rated.speed * ratio
    speed = (None if machine is None else machine.speed) or rated_speed
    if speed is None:
        message = f"`drive` of '{part.name}' needs a rated speed"
        hint = "give its `power` and `speed`, or `operation: {rated: {speed: ...}}`"
        raise InputError([Fault((*part.path, "drive"), message, hint)])
    torque = None if machine is None else machine.rated_torque(speed)
    if torque is None:
        torque = float(balance.applied(part.stations[0], np.array([speed / ratio]))[0]) / ratio
    return speed, torque


def steady_if_known(study: Study, system: System, speed: FloatArray) -> Steady | None:
    """Return mean torques at the speeds (speeds,) rad/s; None where the operation does not say them."""
    if not study.has_mean_torque:
        return None
    return steady(study.train, system, study.operation, speed)


def reference_station(train: Train, operation: Operation) -> int:
    """Return the station whose speed and angle are meant: that of the component `at`, else the first one."""
    if operation.at is not None:
        stations = train[operation.at].stations
        if stations:
            return stations[0]
    return next((k for k, station in enumerate(train.stations) if station.ratio == 1), 0)


def run(work: Work) -> None:
    """Put mean torques over the speed range, at the rated speed and at the corners of a table of the load."""
    study = work.study
    operation = work.study.operation
    speeds = work.study.operation.speeds
    balance = power_balance(study.train, operation)
    grid = np.array([] if operation.speed is None else [operation.speed])
    if speeds is not None:
        corners = [speed for speed in balance.corners if speeds.first <= speed <= speeds.last]
        grid = np.union1d(speeds.values(), corners)
    if operation.rated is not None:
        grid = np.union1d(grid, [operation.rated.speed])
    if not grid.size:
        work.log.without("mean torque", "`operation` says no speed")
        return
    with work.log.step("mean torque", "the file states the load") as step:
        mean = steady(study.train, work.system, operation, grid)
        point = int(np.argmin(np.abs(mean.speed - (operation.speed or float(grid[-1])))))
        machines = tuple(_machines(balance, work.system, mean, point))
        loads = mean_loads(work.system, mean, point)
        work.put(mean=mean, machines=PowerBalance(machines), mean_loads=loads)
        step.method = "sums over the tree"
        step.size = f"{grid.size} speeds"


def mean_loads(system: System, mean: Steady, point: int) -> MeanLoads:
    """Return the mean torque of every elastic element at one of the computed speeds."""
    loads = []
    for element in elements(system):
        speed = float(mean.speed[point]) * element.ratio
        torque = float(mean.torque[element.spans[0], point])
        largest = float(np.abs(mean.torque[list(element.spans)]).max())
        loads.append(MeanLoad(element.name, speed, torque, torque * speed, largest))
    return MeanLoads(tuple(loads))


def _machines(balance: Balance, system: System, mean: Steady, point: int) -> Iterator[MachinePower]:
    """Yield every machine, or end in place of one, with its power at one of the computed speeds."""
    sides: list[tuple[Part | None, Shared, str, bool]] = [
        (driver.part, driver.stations, "", driver.is_free) for driver in balance.drivers
    ]
    for load in sorted(balance.loads, key=lambda load: not load.parts):
        for machine in load.parts or (None,):
            sides.append((machine, load.stations, load.law.words, load.is_free))
    for number, (part, shared, law, is_free) in enumerate(sides):
        stations = list(dict.fromkeys(station for station, _ in shared))
        if part is not None and part.compressor is not None:
            stations = list(dict.fromkeys(throw.station for throw in part.compressor.throws))
        elif part is not None and part.engine is None:
            stations = [part.stations[0]]
        station = system.stations[stations[0]]
        name, kind = (station.name, "") if part is None else (part.name, part.kind)
        torque = float(mean.applied[stations, point].sum())
        speed = float(mean.speed[point]) * abs(float(station.ratio))
        enters = number < len(balance.drivers)
        yield MachinePower(name, kind, enters, speed, abs(torque) * speed, torque, law, is_free)


def power_faults(study: Study) -> list[Fault]:
    """Return why the mean torque finds no way through the train, and tables of load that do not cover the speeds."""
    operation = study.operation
    points = [] if operation.rated is None else [operation.rated.speed]
    if operation.speeds is not None:
        points += [operation.speeds.first, operation.speeds.last]
    speed = np.array(points)
    if not points:
        return []
    try:
        balance = power_balance(study.train, operation)
    except InputError as error:
        return [*uncovered(operation.load.table, speed, TABLE), *error.faults]
    return [
        fault for load in balance.loads for fault in uncovered(load.law.table, speed, load.about)
    ]


def table_faults(study: Study) -> list[Fault]:
    """Return the tables of torques over speed, of those that the response reads, that do not cover its speeds."""
    speeds = study.operation.speeds
    faults = []
    orders = getattr(study.analyses.get("response"), "orders", "all")
    for torque in study.train.torques:
        ratio = study.train.stations[torque.station].ratio
        is_read = torque.frequency is not None
        if torque.order is not None:
            is_read = not isinstance(orders, tuple) or torque.order * ratio in orders
        if torque.table and is_read and speeds is not None:
            about = Fault((*torque.path, "torque"), f"the table of the torque at '{torque.name}'")
            ends = np.array([speeds.first, speeds.last]) * float(ratio)
            faults += uncovered(torque.table, ends, about)
    return faults
