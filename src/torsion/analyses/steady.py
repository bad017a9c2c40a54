"""Mean torque in every span (order 0): where power enters and leaves, how the spans share it, its law, and faults.

Shares are exact fractions of the torque of each load, referred to the reference speed. The sums run over a spanning
tree, so a span that carries nothing carries exactly nothing.
"""

from collections.abc import Iterator
from fractions import Fraction
from functools import reduce

import numpy as np

from torsion.analyses.law_slopes import drive_slopes, load_slopes, slopes_without_vibration
from torsion.analyses.loads_and_drivers import Balance, Load, Shared, Shares
from torsion.analyses.power_balance import power_balance
from torsion.analyses.speed_tables import uncovered
from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import Work
from torsion.kernels.spanning_forest import Walk, closing_no_loop, walk
from torsion.model.lowering import Part
from torsion.results import reported, result
from torsion.study import Operation, Study
from torsion.train import Train


def statics(system: System, applied: Shares, reference: int) -> tuple[FloatArray, FloatArray]:
    """Under 1 N m, of which the shares (stations,) sum to zero: torques (spans,) N m, twists (stations,) rad.

    A torque is positive from driving to driven; twists are against the reference station.
    A grounded station that neither drives nor loads takes no mean torque: it turns at the mean speed by definition.
    Raises SolveError where the mean torque has to pass a span without stiffness, or cannot reach its load.
    """
    way = _way(system, reference)
    torque = np.array([float(share) for share in _tree_torques(system, way, applied)])
    flexibility = system.flexibility / system.span_ratio**2
    finite = np.where(np.isfinite(flexibility), flexibility, 0.0)
    loops = np.setdiff1d(np.flatnonzero(np.isfinite(flexibility)), way.above)
    if loops.size:
        cycle = _cycles(system, way, loops)
        around = (cycle * finite) @ cycle.T
        torque = torque - cycle.T @ np.linalg.solve(around, cycle @ (finite * torque))
    _refuse_slipping(system, torque)
    twist = np.zeros(len(system.stations))
    for station, parent, span in _from_roots(way):
        if span >= 0:
            twist[station] = twist[parent] - _toward_leaves(system, span, station) * (
                finite[span] * torque[span]
            )
    return torque, twist


def _way(system: System, reference: int) -> Walk:
    """A spanning tree from the reference station, with spans without stiffness only where nothing else leads on."""
    ends, finite = (
        (len(system.stations), system.driving, system.driven),
        np.isfinite(system.flexibility),
    )
    way = walk(*ends, finite, [reference])
    if finite.all():
        return way
    ranked = np.concatenate([way.above[way.above >= 0], np.flatnonzero(~finite)])
    return walk(*ends, closing_no_loop(*ends, ranked), [reference])


def _from_roots(way: Walk) -> list[tuple[int, int, int]]:
    """Station, parent and span between them, every station after its parent; -1 at a root."""
    return list(
        zip(
            *(each.tolist() for each in (way.order, way.parent[way.order], way.above[way.order])),
            strict=True,
        )
    )


def _toward_leaves(system: System, span: int, station: int) -> int:
    """1 where the span's driven end is `station`, else -1."""
    return 1 if system.driven[span] == station else -1


def _tree_torques(system: System, way: Walk, applied: Shares) -> Shares:
    """(spans,) share carried by each span of the tree: what is applied beyond it, with the sign of its direction."""
    beyond, shares = list(applied), [Fraction(0)] * len(system.spans)
    for station, parent, span in reversed(_from_roots(way)):
        if span >= 0:
            shares[span] = -beyond[station] * _toward_leaves(system, span, station)
            beyond[parent] += beyond[station]
        elif beyond[station] != 0:
            raise SolveError(
                "the mean torque cannot reach the load: drive and load are not joined by any span"
            )
    return shares


def _cycles(system: System, way: Walk, loops: IntArray) -> FloatArray:
    """(loops, spans) 1 for each span that closes a loop and +-1 for those of the tree around it: their twists are 0."""
    cycle = np.zeros((len(loops), len(system.spans)))
    for row, closing in zip(cycle, loops.tolist(), strict=True):
        row[closing] = 1.0
        for end, sense in (
            (int(system.driving[closing]), 1.0),
            (int(system.driven[closing]), -1.0),
        ):
            station = end
            while (span := int(way.above[station])) >= 0:
                row[span] += sense * _toward_leaves(system, span, station)
                station = int(way.parent[station])
    return cycle


def _refuse_slipping(system: System, torque: FloatArray) -> None:
    """A span without stiffness carries no torque while both of its ends turn at one speed."""
    for span in np.flatnonzero(np.isinf(system.flexibility) & (torque != 0)).tolist():
        message = f"the mean torque has to pass through '{system.spans[span].name}', that has damping but no stiffness"
        raise SolveError(f"{message}; give it a stiffness")


@reported
class Steady:
    """The train at constant speed."""

    speed: FloatArray = result("rad/s", ("speed",), "reference speeds")
    torque: FloatArray = result(
        "N*m", ("span", "speed"), "mean torque at the driving station's speed"
    )
    applied: FloatArray = result("N*m", ("station", "speed"), "drive positive, load negative")
    twist: FloatArray  # (stations, speeds) rad at own speed, elastic, against the reference station
    sharing: str = result("", (), "how the load was shared, in words")
    load_slope: FloatArray | None = (
        None  # (stations, speeds) N m s/rad at own speed: dT/dω of the laws of load
    )
    drive_slope: FloatArray | None = None  # the same, -dT/dω of the laws of drive without a lag


@reported
class MachinePower:
    """What one machine, or one end of the train, delivers or absorbs at the rated speed, else at the highest."""

    name: str = result("", (), "name of the machine, or of the station in its place")
    kind: str = result("", (), "its kind in the file; empty for a station")
    enters: bool = result("", (), "true: power enters here; false: it leaves")
    speed: float = result("rad/s", (), "own speed of the machine")
    power: float = result("W", (), "power that it delivers or absorbs there")
    torque: float = result("N*m", (), "mean torque at its own speed, positive if it drives")
    law: str = result("", (), "law of load; empty of a machine that drives")
    free: bool = result("", (), "it takes what the others leave: computed, not stated")


@reported
class PowerBalance:
    """The balance of power, machine by machine."""

    machines: tuple[MachinePower, ...] = result(
        "", (), "balance of power, every machine at its own speed", key=""
    )


def steady(train: Train, system: System, operation: Operation, speed: FloatArray) -> Steady:
    """Mean torques at reference speeds (speeds,) rad/s.

    Where the torque enters and leaves is that of `power_balance`. Raises InputError as that does, and where a table of
    load does not cover the speeds.
    """
    speed = np.atleast_1d(np.asarray(speed, dtype=np.float64))
    balance, reference = power_balance(train, operation), reference_station(train, operation)
    none = [Fraction(0)] * (len(system.stations) - balance.stations)  # nothing acts inside shafts
    torques, acting, twists = [], [], []
    for load in balance.loads:
        shares, mean = [*balance.shares(load), *none], load.torque_at(speed)
        torque, twist = statics(system, shares, reference)
        applied = [
            float(share / station.ratio)
            for share, station in zip(shares, system.stations, strict=True)
        ]
        torques.append(np.outer(torque / system.span_ratio, mean))
        acting.append(np.outer(applied, mean))
        twists.append(np.outer(twist * system.speed_ratio, mean))
    torque_of_all, applied_of_all, twist_of_all = (
        reduce(np.add, each) for each in (torques, acting, twists)
    )
    ratio = system.speed_ratio
    return Steady(
        speed,
        torque_of_all,
        applied_of_all,
        twist_of_all,
        balance.sentence,
        load_slopes(balance, ratio, speed),
        drive_slopes(train, operation, balance, ratio, speed),
    )


def steady_if_known(study: Study, system: System, speed: FloatArray) -> Steady | None:
    """Mean torques at the speeds (speeds,) rad/s; None where the operation does not say them."""
    if not study.has_mean_torque:
        return None
    return steady(study.train, system, study.operation, speed)


def reference_station(train: Train, operation: Operation) -> int:
    """The station whose speed and angle are meant: that of the component `at`, else the first one."""
    if operation.at is not None:
        stations = train.part(operation.at).stations
        if stations:
            return stations[0]
    return next((k for k, station in enumerate(train.stations) if station.ratio == 1), 0)


def run(work: Work) -> None:
    """Mean torques over the speed range, at the rated speed and at the corners of a table of the load."""
    study, operation = work.study, work.study.operation
    if not study.has_mean_torque:
        work.log.without(
            "mean torque", "the file states neither the power of the loads nor a table of the load"
        )
        return
    balance, speeds = power_balance(study.train, operation), operation.speeds
    grid = (
        speeds.values()
        if speeds is not None
        else np.array([operation.speed] if operation.speed is not None else [])
    )
    if operation.rated is not None:
        grid = np.union1d(grid, [operation.rated.speed])
    if speeds is not None and balance.corners:
        grid = np.union1d(
            grid, [speed for speed in balance.corners if speeds.first <= speed <= speeds.last]
        )
    if not grid.size:
        work.log.without("mean torque", "`operation` says no speed")
        return
    with work.log.step("mean torque", "the file states the load") as step:
        mean = steady(study.train, work.system, operation, grid)
        machines = balance_of(balance, work.system, mean, operation.speed or float(grid[-1]))
        work.put(mean=mean, machines=PowerBalance(tuple(machines)))
        step.method = "sums over the tree"
        step.size = f"{grid.size} speeds"
    for name, slope, key in slopes_without_vibration(study):
        why = f"its {slope:.6g} N m s/rad act on the mean speed alone; `{key}` lets it damp vibration too"
        work.log.without(f"slope of '{name}' in vibration", why)


def balance_of(
    balance: Balance, system: System, mean: Steady, speed: float
) -> Iterator[MachinePower]:
    """Yield every machine with its power at the computed speed nearest to a reference speed (rad/s)."""
    at = int(np.argmin(np.abs(mean.speed - speed)))
    sides = [(driver.part, driver.stations, "", driver.is_free) for driver in balance.drivers]
    sides += [
        (part, load.stations, load.law.words, load.is_free)
        for load in balance.loads
        for part in load.parts
    ]
    sides += [
        (None, load.stations, load.law.words, load.is_free)
        for load in balance.loads
        if not load.parts
    ]
    for number, (part, shared, law, is_free) in enumerate(sides):
        places = _places(part, shared)
        torque = float(mean.applied[places, at].sum())
        own = float(mean.speed[at]) * abs(float(system.stations[places[0]].ratio))
        name = part.name if part is not None else system.stations[places[0]].name
        enters = number < len(balance.drivers)
        kind = part.kind if part is not None else ""
        yield MachinePower(name, kind, enters, own, abs(torque) * own, torque, law, is_free)


def _places(part: Part | None, shared: Shared) -> list[int]:
    """The stations at which a machine drives or absorbs."""
    if part is not None and part.compressor is not None:
        return list(dict.fromkeys(throw.station for throw in part.compressor.throws))
    if part is not None and part.engine is None:
        return [part.stations[0]]
    return list(dict.fromkeys(station for station, _ in shared))


def power_faults(study: Study) -> list[Fault]:
    """Why the mean torque finds no way through the train, and a table of the load that does not cover the speeds."""
    operation = study.operation
    ends = [] if operation.speeds is None else [operation.speeds.first, operation.speeds.last]
    speed = np.array([*ends, *([] if operation.rated is None else [operation.rated.speed])])
    if not speed.size:
        return []
    try:
        balance = power_balance(study.train, operation)
    except InputError as error:
        table = Load((), [], operation.load)
        return [*table.faults(speed), *error.faults]
    return [fault for load in balance.loads for fault in load.faults(speed)]


def table_faults(study: Study) -> list[Fault]:
    """Tables of torques over speed, of those that the response reads, that do not cover its speeds."""
    speeds, orders = (
        study.operation.speeds,
        getattr(study.analyses.get("response"), "orders", "all"),
    )
    if speeds is None:
        return []
    found: list[Fault] = []
    for torque in study.train.torques:
        ratio = study.train.stations[torque.station].ratio
        is_read = torque.frequency is not None
        if torque.order is not None:
            is_read = not isinstance(orders, tuple) or torque.order * ratio in orders
        if torque.table and is_read:
            about = Fault((*torque.path, "torque"), f"the table of the torque at '{torque.name}'")
            found += uncovered(
                torque.table, np.array([speeds.first, speeds.last]) * float(ratio), about
            )
    return found
