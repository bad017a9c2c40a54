"""Mean torque in every span (order 0): where the power enters and leaves, the load law, and faults of both."""

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from torsion.analyses.statics import Shares, statics
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.components.lowering import Part
from torsion.errors import Fault, InputError
from torsion.findings import Work
from torsion.primitives import Torque
from torsion.results import reported, result
from torsion.study import Operation, Study
from torsion.train import Train

Shared = list[tuple[int, Fraction]]  # stations with their shares of the power
SAME_POWER = 0.01  # relative: the sum of rounded ratings of motors that is still the rated power
SAME_SPEED = 1e-9  # relative: a speed that lies outside a table by less was written in another unit


@dataclass(frozen=True)
class Flow:
    """Stations that drive and that absorb the power, with their shares of it, and all of that in a sentence."""

    drives: Shared
    loads: Shared
    stated: str


def flow(train: Train, operation: Operation) -> Flow:
    """The power enters at the motors, in proportion to their power, and leaves at the propellers, in equal parts.

    Without a motor it enters at the first station, without a propeller it leaves at the last station of the main line;
    where the power leaves (enters) there already, at the other end. Raises InputError where both ends are taken, or
    only some of the motors have a power.
    """
    motors, propellers = ([part for _, part in train.of_kind(kind)] for kind in ("motor", "propeller"))
    first, last = 0, _last(train)
    drives, loads = _driving(motors), _equally(propellers)
    driving, loading = _names(motors), _names(propellers)
    if not motors:
        end = _free_end((first, last), loads, train, operation)
        drives, driving = [(end, Fraction(1))], _at_an_end(train, end, "motor", "propeller", end == first)
    elif len(motors) > 1:
        driving += " in equal parts" if motors[0].power is None else " in proportion to their power"
    if not propellers:
        end = _free_end((last, first), drives, train, operation)
        loads, loading = [(end, Fraction(1))], _at_an_end(train, end, "propeller", "motor", end == last)
    elif len(propellers) > 1:
        loading += " in equal parts"
    stated = f"The mean torque enters at {driving} and leaves at {loading}."
    return Flow(drives, loads, stated + _shares_alone(motors, operation))


def _last(train: Train) -> int:
    """The last station of the main line."""
    main = [part for part in train.parts if part.depth == 0 and part.stations and part.path[0] == "train"]
    return main[-1].stations[-1]


def _free_end(ends: tuple[int, int], taken: Shared, train: Train, operation: Operation) -> int:
    """The first of the two ends of the main line that is not taken; raises InputError where both are."""
    stations = {station for station, _ in taken}
    for end in ends:
        if end not in stations:
            return end
    where = ("operation", "load" if operation.rated is None else "rated")
    message = f"the mean torque would enter and leave the train at '{train.stations[ends[0]].name}'"
    hint = "name what drives a `motor` and what absorbs the power a `propeller`, or leave the power out"
    raise InputError([Fault(where, message, hint)])


def _at_an_end(train: Train, end: int, lacking: str, other: str, usual: bool) -> str:
    """The name of the end that stands in for a kind of component, and why."""
    name = train.stations[end].name
    why = f"there is no {lacking}" if usual else f"there is no {lacking}, and the other end is a {other}"
    return f"{name} ({why})"


def _driving(motors: list[Part]) -> Shared:
    """The motors with their shares; raises InputError where only some of them have a power."""
    power = [motor.power for motor in motors]
    given = [Fraction(value) for value in power if value is not None]
    if len(motors) == 1 or not given:
        return _equally(motors)
    if len(given) < len(motors):
        lacking = motors[power.index(None)]
        hint = "give every motor its power, or none of them to share the load equally"
        raise InputError([Fault(lacking.path, f"'{lacking.name}' has no power, other motors have", hint)])
    return [(part.stations[0], value / sum(given)) for part, value in zip(motors, given, strict=True)]


def _shares_alone(motors: list[Part], operation: Operation) -> str:
    """What the powers of motors are not, where together they are not the rated power."""
    given = [motor.power for motor in motors if motor.power is not None]
    rated = None if operation.rated is None else operation.rated.power
    if not given or rated is None or abs(sum(given) - rated) <= SAME_POWER * rated:
        return ""
    together = "The power of the motor" if len(given) == 1 else "The powers of the motors, together"
    used = "is not used" if len(given) == 1 else "say their shares alone"
    return f" {together} ({sum(given) / 1e3:.6g} kW) {used}: the torque follows from the rated {rated / 1e3:.6g} kW."


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
        power.stated,
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


def power_faults(study: Study) -> list[Fault]:
    """Why the mean torque finds no way through the train, and a table of the load that does not cover the speeds."""
    operation = study.operation
    speed = _speeds(operation)
    if not operation.has_mean_torque or not speed.size:
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
    """Tables of torques over speed that do not cover the speeds of the response."""
    operation, orders = study.operation, getattr(study.analyses.get("response"), "orders", "all")
    if operation.speeds is None:
        return []
    ends = np.array([operation.speeds.first, operation.speeds.last])
    found: list[Fault] = []
    for torque in _over_speed(study.train, orders):
        about = Fault((*torque.path, "torque"), f"the table of the torque at '{torque.name}'")
        found += _uncovered(torque.table, ends * float(study.train.stations[torque.station].ratio), about)
    return found


def _over_speed(train: Train, orders: object) -> Iterator[Torque]:
    """Torques by table that the response over speed reads; `orders` of the reference, or 'all'."""
    for torque in train.torques:
        if not torque.table or (torque.order is None and torque.frequency is None):
            continue
        if (
            torque.order is None
            or not isinstance(orders, tuple)
            or torque.order * train.stations[torque.station].ratio in orders
        ):
            yield torque


def _speeds(operation: Operation) -> FloatArray:
    """rad/s at which the mean torque is needed, its ends among them."""
    ends = [] if operation.speeds is None else [operation.speeds.first, operation.speeds.last]
    return np.array([*ends, *([operation.speed] if operation.rated is not None else [])])


def _uncovered(table: tuple[tuple[float, float], ...], speed: FloatArray, about: Fault) -> tuple[Fault, ...]:
    try:
        interpolated(table, speed, about)
    except InputError as error:
        return error.faults
    return ()
