"""Mean torque in every span (order 0): where power enters and leaves, how the spans share it, its law, and faults.

Shares are exact fractions, referred to the reference speed: 1 is the whole mean torque at that speed. The sums run over
a spanning tree, so a span that carries nothing carries exactly nothing.
"""

from fractions import Fraction

import numpy as np

from torsion.arrays import FloatArray, IntArray
from torsion.assembly.system import System
from torsion.components.lowering import Part
from torsion.errors import Fault, InputError, SolveError
from torsion.findings import Work
from torsion.kernels.spanning_forest import Walk, closing_no_loop, walk
from torsion.results import reported, result
from torsion.study import Operation, Study
from torsion.train import Train

Shares = list[Fraction]


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
            twist[station] = twist[parent] - _toward_leaves(system, span, station) * (finite[span] * torque[span])
    return torque, twist


def _way(system: System, reference: int) -> Walk:
    """A spanning tree from the reference station, with spans without stiffness only where nothing else leads on."""
    ends, finite = (len(system.stations), system.driving, system.driven), np.isfinite(system.flexibility)
    way = walk(*ends, finite, [reference])
    if finite.all():
        return way
    ranked = np.concatenate([way.above[way.above >= 0], np.flatnonzero(~finite)])
    return walk(*ends, closing_no_loop(*ends, ranked), [reference])


def _from_roots(way: Walk) -> list[tuple[int, int, int]]:
    """Station, parent and span between them, every station after its parent; -1 at a root."""
    return list(zip(*(each.tolist() for each in (way.order, way.parent[way.order], way.above[way.order])), strict=True))


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
            raise SolveError("the mean torque cannot reach the load: drive and load are not joined by any span")
    return shares


def _cycles(system: System, way: Walk, loops: IntArray) -> FloatArray:
    """(loops, spans) 1 for each span that closes a loop and +-1 for those of the tree around it: their twists are 0."""
    cycle = np.zeros((len(loops), len(system.spans)))
    for row, closing in zip(cycle, loops.tolist(), strict=True):
        row[closing] = 1.0
        for end, sense in ((int(system.driving[closing]), 1.0), (int(system.driven[closing]), -1.0)):
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


Shared = list[tuple[int, Fraction]]  # stations with their shares of the power
Table = tuple[tuple[float, float], ...]  # rad/s, N m
SAME_POWER = 0.01  # relative: the sum of rounded ratings of motors that is still the rated power
SAME_SPEED = 1e-9  # relative: a speed that lies outside a table by less was written in another unit


def flow(train: Train, operation: Operation) -> tuple[Shares, str]:
    """(stations,) shares of the power, in positive and out negative, and where it enters and leaves in a sentence.

    It enters at the motors and engines, in proportion to their power, and leaves at the propellers, in equal parts, or
    at the throws of compressors, in proportion to what their pressures absorb.
    Without a motor it enters at the first station, without a propeller it leaves at the last station of the main line;
    where the power leaves (enters) there already, at the other end. Of an engine every cylinder that fires has its
    share; where one does not, that of the loads falls with it. Raises InputError where both ends are taken, only some
    of the motors have a power, or propellers stand beside compressors.
    """
    motors = [part for part in train.parts if part.machine is not None and part.machine.is_driver]
    propellers = [part for part in train.parts if part.machine is not None and not part.machine.is_driver]
    main = [part for part in train.parts if part.depth == 0 and part.stations and part.path[0] == "train"]
    first, last = 0, main[-1].stations[-1]
    compressors = [part for part in train.parts if part.compressor is not None]
    driving_shares, loads = _driving(motors), _equally(propellers) or _absorbing(compressors)
    drives = [at for part, share in driving_shares for at in _within(part, share)]
    driving, loading = _names(motors), _names(propellers or compressors)
    if propellers and compressors:
        message = f"'{propellers[0].name}' and '{compressors[0].name}' both absorb, in shares that are not known"
        raise InputError([Fault(propellers[0].path, message, "make the lesser of both a `disc`, or a compressor")])
    if not motors:
        drives, driving = _at_an_end((first, last), loads, ("motor", "propeller"), train, operation)
    elif len(motors) > 1:
        driving += " in equal parts" if _power(motors[0]) is None else " in proportion to their power"
    if not loads:
        loads, loading = _at_an_end((last, first), drives, ("propeller", "motor"), train, operation)
    elif len(propellers) > 1:
        loading += " in equal parts"
    shares = [Fraction(0)] * len(train.stations)
    whole = sum((share for _, share in drives), Fraction(0))  # of the mean torque; cylinders that do not fire lack
    for station, share in (*drives, *((station, -share * whole) for station, share in loads)):
        shares[station] += share
    stated = f"The mean torque enters at {driving} and leaves at {loading}."
    return shares, stated + _shares_alone(motors, operation)


def _at_an_end(
    ends: tuple[int, int], taken: Shared, kinds: tuple[str, str], train: Train, operation: Operation
) -> tuple[Shared, str]:
    """The first of two ends of the main line that is not taken, in place of a kind of component, and that in words.

    kinds: the one that is lacking and the other; raises InputError where both ends are taken.
    """
    free = [end for end in ends if end not in dict(taken)]
    if not free:
        where = ("operation", "load" if operation.rated is None else "rated")
        message = f"the mean torque would enter and leave the train at '{train.stations[ends[0]].name}'"
        hint = "name what drives a `motor` and what absorbs the power a `propeller`, or leave the power out"
        raise InputError([Fault(where, message, hint)])
    why = f"there is no {kinds[0]}" + ("" if free[0] == ends[0] else f", and the other end is a {kinds[1]}")
    return [(free[0], Fraction(1))], f"{train.stations[free[0]].name} ({why})"


def _within(part: Part, share: Fraction) -> Shared:
    """Where a motor's or engine's share of the mean torque enters: of an engine at its throws."""
    if part.engine is None:
        return [(part.stations[0], share)]
    return [(station, share * Fraction(own)) for station, own in part.engine.drives]


def _driving(motors: list[Part]) -> list[tuple[Part, Fraction]]:
    """The motors with their shares; raises InputError where only some of them have a power."""
    power = [_power(motor) for motor in motors]
    given = [Fraction(value) for value in power if value is not None]
    if len(motors) == 1 or not given:
        return [(part, Fraction(1, len(motors))) for part in motors]
    if len(given) < len(motors):
        lacking = motors[power.index(None)]
        hint = "give every motor its power, or none of them to share the load equally"
        raise InputError([Fault(lacking.path, f"'{lacking.name}' has no power, other motors have", hint)])
    return [(part, value / sum(given)) for part, value in zip(motors, given, strict=True)]


def _power(part: Part) -> float | None:
    return None if part.machine is None else part.machine.power


def _shares_alone(motors: list[Part], operation: Operation) -> str:
    """What the powers of motors are not, where together they are not the rated power."""
    given = [power for power in map(_power, motors) if power is not None]
    rated = None if operation.rated is None else operation.rated.power
    if not given or rated is None or abs(sum(given) - rated) <= SAME_POWER * rated:
        return ""
    together = "The power of the motor" if len(given) == 1 else "The powers of the motors, together"
    used = "is not used" if len(given) == 1 else "say their shares alone"
    return f" {together} ({sum(given) / 1e3:.6g} kW) {used}: the torque follows from the rated {rated / 1e3:.6g} kW."


def _absorbing(compressors: list[Part]) -> Shared:
    """Throws with their shares of the power, by the mean torque that their pressures absorb."""
    power = [
        (station, Fraction(torque) * abs(part.ratio) / Fraction(part.compressor.efficiency))
        for part in compressors
        if part.compressor is not None
        for station, torque in part.compressor.absorbs
    ]
    whole = sum((one for _, one in power), Fraction(0))
    return [(station, one / whole) for station, one in power]


def _equally(parts: list[Part]) -> Shared:
    return [(part.stations[0], Fraction(1, len(parts))) for part in parts]


def _names(parts: list[Part]) -> str:
    names = [part.name for part in parts]
    return ", ".join(names[:-1]) + " and " + names[-1] if len(names) > 1 else "".join(names)


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

    Where the torque enters and leaves is `flow`'s. Raises InputError as that does, and where the operation says
    no mean torque or its table does not cover the speeds.
    """
    speed = np.atleast_1d(np.asarray(speed, dtype=np.float64))
    mean = mean_torque(operation, speed)
    shares, stated = flow(train, operation)
    shares += [Fraction(0)] * (len(system.stations) - len(shares))  # nothing acts inside shafts
    torque, twist = statics(system, shares, reference_station(train, operation))
    applied = np.array([float(share / station.ratio) for share, station in zip(shares, system.stations, strict=True)])
    each = (torque / system.span_ratio, applied, twist * system.speed_ratio)
    torques, acting, twists = (np.outer(of_one, mean) for of_one in each)
    return Steady(speed, torques, acting, twists, stated)


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


def interpolated(table: Table, speed: FloatArray, about: Fault) -> FloatArray:
    """Torque (speeds,) N m from a table over speed, linear between its rows and never beyond them.

    `about` names the table and its place; raises InputError where the table does not cover the speeds.
    """
    if faults := _uncovered(table, speed, about):
        raise InputError(faults)
    rows = np.array(table, dtype=np.float64)
    return np.asarray(np.interp(speed, rows[:, 0], rows[:, 1]))


def _uncovered(table: Table, speed: FloatArray, about: Fault) -> list[Fault]:
    first, last = table[0][0], table[-1][0]
    if not speed.size or (speed.min() >= first * (1 - SAME_SPEED) and speed.max() <= last * (1 + SAME_SPEED)):
        return []
    covers = f"covers {_rpm(first)} to {_rpm(last)}, the speeds run from {_rpm(speed.min())} to {_rpm(speed.max())}"
    hint = "extend the table, or narrow the speeds; nothing is extrapolated"
    return [Fault(about.path, f"{about.message} {covers}", hint)]


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


def power_faults(study: Study) -> list[Fault]:
    """Why the mean torque finds no way through the train, and a table of the load that does not cover the speeds."""
    operation = study.operation
    ends = [] if operation.speeds is None else [operation.speeds.first, operation.speeds.last]
    speed = np.array([*ends, *([] if operation.rated is None else [operation.rated.speed])])
    if not speed.size:
        return []
    found: list[Fault] = []
    if not isinstance(operation.load, str):
        found += _uncovered(operation.load, speed, Fault(("operation", "load"), "the table of the load"))
    try:
        flow(study.train, operation)
    except InputError as error:
        found += error.faults
    return found


def table_faults(study: Study) -> list[Fault]:
    """Tables of torques over speed, of those that the response reads, that do not cover its speeds."""
    speeds, orders = study.operation.speeds, getattr(study.analyses.get("response"), "orders", "all")
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
            found += _uncovered(torque.table, np.array([speeds.first, speeds.last]) * float(ratio), about)
    return found
