"""Who drives and who absorbs: the balance of power at every speed, in which exactly one side is free."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property, wraps
from typing import Any, TypeVar

import numpy as np

from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.model.machine_torques import LoadLaw
from torsion.model.parts import MachineRecord, Part
from torsion.study import Operation, Study
from torsion.train import Train

Table = tuple[tuple[float, float], ...]  # rad/s, N m
SAME_SPEED = 1e-9  # relative: a speed that lies outside a table by less was written in another unit


def interpolated(table: Table, speed: FloatArray, about: Fault) -> FloatArray:
    """Return torque (speeds,) N m from a table over speed, linear between its rows and never beyond them.

    `about` names the table and its place; raises InputError where the table does not cover the speeds.
    """
    if faults := uncovered(table, speed, about):
        raise InputError(faults)
    rows = np.array(table, dtype=np.float64)
    return np.interp(speed, rows[:, 0], rows[:, 1])


def uncovered(table: Table, speed: FloatArray, about: Fault) -> list[Fault]:
    """Return the fault of a table that does not cover the speeds (rad/s); none where it does, or is empty."""
    if not table or not speed.size:
        return []
    ends = table[0][0], table[-1][0], speed.min(), speed.max()
    if ends[2] >= ends[0] * (1 - SAME_SPEED) and ends[3] <= ends[1] * (1 + SAME_SPEED):
        return []
    begin, end, slowest, fastest = (f"{end * 30.0 / np.pi:.6g} rpm" for end in ends)
    message = f"{about.message} covers {begin} to {end}, the speeds run from {slowest} to {fastest}"
    hint = "extend the table, or narrow the speeds; nothing is extrapolated"
    return [Fault(about.path, message, hint)]


Shares = list[Fraction]
Shared = list[tuple[int, Fraction]]  # stations with their shares of a torque
OF_OPERATION = ("operation", "load")
TABLE = Fault(OF_OPERATION, "the table of the load")


@dataclass(frozen=True)
class Load:
    """The torque that a load, or several loads alike in equal parts, take from the train."""

    parts: tuple[Part, ...]  # empty: a station of the train absorbs
    stations: Shared
    law: LoadLaw  # a table is in speeds and torques of the reference
    torque: float = 0.0  # N m at the reference, at `speed`; of a table nothing
    speed: float = 1.0  # rad/s of the reference
    about: Fault = TABLE
    is_free: bool = False  # it takes what is left

    def torque_at(self, speed: FloatArray) -> FloatArray:
        """Return the torque (speeds,) N m at the reference; raises InputError where a table ends before."""
        if self.law.table:
            return interpolated(self.law.table, speed, self.about).copy()
        return self.law.torque(speed, self.speed, self.torque)


@dataclass(frozen=True)
class Driver:
    """A machine, or a station of the train, at which power enters."""

    part: Part | None
    stations: Shared  # with their shares of the torque of all loads when all cylinders fire
    is_free: bool


@dataclass(frozen=True)
class Balance:
    """All loads, and how those that drive share them."""

    loads: tuple[Load, ...]
    drivers: tuple[Driver, ...]
    stations: int
    sentence: str  # who drives and who absorbs

    @cached_property
    def delivered(self) -> Fraction:
        """Share of the loads that enters; cylinders that do not fire lack, and every load falls with them."""
        return sum((share for driver in self.drivers for _, share in driver.stations), Fraction(0))

    def shares(self, load: Load) -> Shares:
        """Return the shares (stations,) of the torque of one load: positive where it enters, negative where it leaves."""
        shares = [Fraction(0)] * self.stations
        for driver in self.drivers:
            for station, share in driver.stations:
                shares[station] += share
        for station, share in load.stations:
            shares[station] -= share * self.delivered
        return shares

    def applied(self, station: int, speed: FloatArray) -> FloatArray:
        """Return the mean torque (speeds,) N m that enters at a station, referred to the reference speed."""
        first, *others = (
            load.torque_at(speed) * float(self.shares(load)[station]) for load in self.loads
        )
        return sum(others, start=first)

    @property
    def corners(self) -> list[float]:
        """Speeds (rad/s of the reference) at which a table of load bends."""
        return [speed for load in self.loads for speed, _ in load.law.table]


SAME_POWER = 0.01  # relative: the sum of rounded ratings that is still the rated power
SAME_SHARE = 1e-9  # relative: the shares of cylinders whose heat differs from the whole by rounding
Parts = Sequence[Part]
Answer = TypeVar("Answer")


def keeping_last(function: Callable[..., Answer]) -> Callable[..., Answer]:
    """Return the function with its last answer kept, for the same objects as arguments.

    The mean torque follows from the train and the operation alone, and ten steps of a run need it.

    >>> keeping_last(lambda left, right: left + right)(1, 2)
    3
    """
    last: list[tuple[tuple[object, ...], Answer]] = []

    @wraps(function)
    def answer(*arguments: Any) -> Answer:
        for known, value in last:
            if all(left is right for left, right in zip(known, arguments, strict=True)):
                return value
        value = function(*arguments)
        last[:] = [(arguments, value)]
        return value

    return answer


@keeping_last
def power_balance(train: Train, operation: Operation) -> Balance:
    """Return the balance of power; raises InputError where the file does not say it, or says it twice."""
    drivers, absorbers = (
        [part for part in train.parts if part.machine and part.machine.is_driver is drives]
        for drives in (True, False)
    )
    compressors = [part for part in train.parts if part.compressor is not None]
    stated = []
    for part in filter(_is_stated, absorbers):
        # By its own `power`, `torque` or table, referred to the reference speed.
        ratio = abs(float(part.ratio))
        stations = [(part.stations[0], Fraction(1))]
        own_law = None if part.machine is None else part.machine.load
        if own_law is not None and own_law.table:
            table = tuple((speed / ratio, torque * ratio) for speed, torque in own_law.table)
            about = Fault((*part.path, "load"), f"the table of the load of '{part.name}'")
            stated.append(Load((part,), stations, LoadLaw(table=table), about=about))
            continue
        # A table of the operation is refused where machines state their power.
        law = LoadLaw() if operation.load.table else law_of(part, operation)
        speed, torque = _stated_point(part, operation)
        stated.append(Load((part,), stations, law, torque, speed))
    free = [part for part in absorbers if not _is_stated(part)]
    for part in compressors if absorbers else ():
        compressor = part.compressor
        if compressor is None or not any(throw.gas[0].real for throw in compressor.throws):
            free.append(part)
            continue
        # Beside other loads its pressures absorb one torque at every speed.
        indicated = sum(torque for _, torque in compressor.absorbs)
        torque = indicated * abs(float(part.ratio)) / compressor.efficiency
        stated.append(Load((part,), _by_pressures([part]), LoadLaw(0.0), torque))
    loads = _loads(train, operation, stated, free, compressors)
    if stated and not drivers:
        hint = "name what drives a `motor`, `turbine` or `engine`"
        path = stated[0].parts[0].path
        raise InputError([Fault(path, "every machine absorbs; nothing drives", hint)])

    # An end of the main line stands for the machines of a side that names none.
    driving = _drivers(drivers, loads, operation)
    entering = _side_words(drivers, " in proportion to their power")
    leaving = _side_words(absorbers, "") or _joined([part.name for part in compressors])
    if not drivers:
        station, entering = _free_end(train, operation, loads, is_driving=True)
        driving = [Driver(None, [(station, Fraction(1))], is_free=False)]
    if not loads[0].stations:
        station, leaving = _free_end(train, operation, driving, is_driving=False)
        loads = [replace(loads[0], stations=[(station, Fraction(1))], is_free=False)]

    balance = Balance(tuple(loads), tuple(driving), len(train.stations), "")
    sentence = f"The mean torque enters at {entering} and leaves at {leaving}."
    return replace(balance, sentence=sentence + _remarks(drivers, balance, operation))


def rated_power(study: Study) -> float | None:
    """Return the rated power (W), else that of all loads at the rated speed; None where neither is known."""
    operation = study.operation
    rated = study.operation.rated
    if rated is None:
        return None
    if rated.power is not None or operation.load.table or not study.has_mean_torque:
        return rated.power
    return _total(power_balance(study.train, operation).loads, rated.speed) * rated.speed


def _total(loads: Sequence[Load], speed: float) -> float:
    """Return the torque (N m) of all loads at a reference speed (rad/s), when every cylinder fires."""
    return float(sum(load.torque_at(np.array([speed]))[0] for load in loads))


def law_of(part: Part, operation: Operation) -> LoadLaw:
    """Return the law of a load: its own, that of the operation where the file gives it, that of its kind."""
    machine = part.machine or MachineRecord(is_driver=False)
    usual = None if "load" in operation.model_fields_set else machine.usual_load
    return machine.load or usual or operation.load


def _is_stated(part: Part) -> bool:
    return part.machine is not None and part.machine.is_stated


def _loads(
    train: Train, operation: Operation, stated: list[Load], free: list[Part], compressors: Parts
) -> list[Load]:
    """Return the stated loads and the free one; a free one without stations stands for an end of the train."""
    rated = operation.rated
    power = None if rated is None else rated.power
    if not stated:
        parts = free or compressors
        _refuse_unlike(train, operation, free)
        # Only now: a load without stations is refused first.
        stations = [(part.stations[0], Fraction(1, len(free))) for part in free]
        stations = stations or _by_pressures(compressors)
        law = law_of(parts[0], operation) if parts else operation.load
        torque, speed = 0.0, 1.0
        if operation.load.table:
            law = operation.load
            for part in parts:
                if part.machine is not None and part.machine.load is not None:
                    message = f"`load` of '{part.name}' and a table of `operation.load` exclude each other"
                    raise InputError([Fault((*part.path, "load"), message, "keep one of them")])
        elif rated is None or power is None:
            message = "the mean torque needs the rated power"
            hint = "for example `rated: {speed: 1500 rpm, power: 100 kW}`"
            raise InputError([Fault(("operation", "rated"), message, hint)])
        else:
            torque, speed = power / rated.speed, rated.speed
        return [Load(tuple(parts), stations, law, torque, speed, is_free=True)]
    if operation.load.table:
        message = "a table of `load` is the total, and loads of the train state their power"
        hint = "give the table to one machine, or leave their power out"
        raise InputError([Fault(OF_OPERATION, message, hint)])
    if rated is None or power is None:
        if not free:
            return stated
        message = f"'{free[0].name}' has no `power`, and `rated` has no power from which its share could follow"
        hint = "give it its `power`, or give `operation.rated.power`"
        raise InputError([Fault(free[0].path, message, hint)])

    taken = _total(stated, rated.speed) * rated.speed
    if free and taken < power:
        _refuse_unlike(train, operation, free)
        torque = (power - taken) / rated.speed
        stations = [(part.stations[0], Fraction(1, len(free))) for part in free]
        law = law_of(free[0], operation)
        return [*stated, Load(tuple(free), stations, law, torque, rated.speed, is_free=True)]
    if free or abs(taken - power) > SAME_POWER * power:
        message = f"the loads absorb {_in_kw(taken)}, `rated` has {_in_kw(power)}"
        hint = "leave out the power of the one that takes the rest, or correct one"
        hint += "; make a machine that drives a `motor`" if free else ""
        raise InputError([Fault(("operation", "rated", "power"), message, hint)])
    return stated


def _stated_point(part: Part, operation: Operation) -> tuple[float, float]:
    """Return speed (rad/s) and torque (N m), both of the reference, that a machine states."""
    machine = part.machine or MachineRecord(is_driver=False)
    ratio = abs(float(part.ratio))
    speed = machine.speed or (None if operation.rated is None else operation.rated.speed * ratio)
    torque = machine.rated_torque(speed or 0.0)
    if speed is None or torque is None:
        key = "power" if machine.torque is None else "torque"
        message = f"`{key}` of '{part.name}' holds at a speed that is not given"
        hint = "give its `speed`, or `operation: {rated: {speed: ...}}`"
        raise InputError([Fault((*part.path, key), message, hint)])
    return speed / ratio, torque * ratio


def _by_pressures(compressors: Parts) -> Shared:
    """Return the throws with their shares of the power, by the mean torque that their pressures absorb."""
    torques = [
        (station, Fraction(torque) * abs(part.ratio) / Fraction(part.compressor.efficiency))
        for part in compressors
        if part.compressor is not None
        for station, torque in part.compressor.absorbs
    ]
    total = sum((torque for _, torque in torques), Fraction(0))
    return [(station, torque / total) for station, torque in torques]


def _refuse_unlike(train: Train, operation: Operation, parts: Parts) -> None:
    """Raise InputError where loads without a power are unlike: alike ones share what is left in equal parts."""
    inertias = dict[int, float]()
    for lump in train.inertias:
        inertias[lump.part] = inertias.get(lump.part, 0.0) + lump.inertia
    features = {
        (
            part.kind,
            abs(part.ratio),
            inertias.get(train.positions[part.name], 0.0),
            law_of(part, operation),
        )
        for part in parts
    }
    if len(features) < 2:
        return
    rated = operation.rated
    enters = "the power enters"
    if rated is not None and rated.power is not None:
        enters = f"{_in_kw(rated.power)} enter"
    names = _joined([f"'{part.name}'" for part in parts])
    message = f"{enters}, and the file does not say how they divide between {names}"
    hint = "give `power` to all, or to all but one and that takes the rest"
    if len(parts) == 2:
        hint = "give `power` to both, or to one of them and the other takes the rest"
    raise InputError([Fault(parts[0].path, message, hint)])


def _drivers(drivers: list[Part], loads: list[Load], operation: Operation) -> list[Driver]:
    """Return machines that drive with their shares: in proportion to their power, or all but one by it."""
    stated = [part for part in drivers if _is_stated(part)]
    free = [part for part in drivers if not _is_stated(part)]
    if len(drivers) < 2 or not stated:
        shares = [Fraction(1, len(drivers)) for _ in drivers]
        free = [] if any(load.is_free for load in loads) else drivers
    elif not free:
        machines = [part.machine for part in drivers if part.machine is not None]
        powers = [machine.power for machine in machines if machine.speed is None]
        weights = [Fraction(power) for power in powers if power is not None]
        if len(weights) < len(drivers):
            weights = [Fraction(_stated_point(part, operation)[1]) for part in drivers]
        shares = [weight / sum(weights) for weight in weights]
    elif len(free) > 1:
        names = _joined([f"'{part.name}'" for part in free])
        number = "both" if len(free) == 2 else "all"
        message = f"{names} drive, {number} without power, in addition to '{stated[0].name}'"
        raise InputError([Fault(free[0].path, message, "only one machine can be the free one")])
    else:
        # Of the torque of all loads at the speed of its power, kept at other speeds.
        share_of = {}
        for part in stated:
            speed, torque = _stated_point(part, operation)
            taken = _total(loads, speed)
            share_of[part.name] = Fraction(torque) / Fraction(taken) if taken else Fraction(1)
        left = 1 - sum(share_of.values(), Fraction(0))
        if left <= 0:
            message = f"the other machines that drive give all that the loads take, and nothing is left for '{free[0].name}'"
            hint = "correct a power, or make it a machine that absorbs"
            raise InputError([Fault(free[0].path, message, hint)])
        shares = [share_of.get(part.name, left) for part in drivers]

    driving = []
    for part, share in zip(drivers, shares, strict=True):
        # That of an engine enters at its throws.
        drives = [(part.stations[0], 1.0)] if part.engine is None else part.engine.drives
        stations = [(station, share * Fraction(weight)) for station, weight in drives]
        driving.append(Driver(part, stations, any(part is free_part for free_part in free)))
    return driving


def _free_end(
    train: Train, operation: Operation, others: Sequence[Load | Driver], *, is_driving: bool
) -> tuple[int, str]:
    """Return the end of the main line that drives, else absorbs, and its name with the reason for a sentence.

    It is the first, else the last end that the `others` leave; raises InputError where both are taken.
    """
    main = [
        part
        for part in train.parts
        if part.depth == 0 and part.stations and part.path[0] == "train"
    ]
    ends = [0, main[-1].stations[-1]]
    kinds = ["motor", "propeller"]
    if not is_driving:
        ends.reverse()
        kinds.reverse()
    taken = [station for machine in others for station, _ in machine.stations]
    free = [end for end in ends if end not in taken]
    if not free:
        path = ("operation", "load" if operation.rated is None else "rated")
        name = train.stations[ends[0]].name
        message = f"the mean torque would enter and leave the train at '{name}'"
        hint = "name what drives a `motor` and what absorbs the power a `propeller`, or leave the power out"
        raise InputError([Fault(path, message, hint)])
    reason = f"there is no {kinds[0]}"
    if free[0] != ends[0]:
        reason += f", and the other end is a {kinds[1]}"
    return free[0], f"{train.stations[free[0]].name} ({reason})"


def _side_words(parts: Parts, by_power: str) -> str:
    """Return the names of a side and how they share its power: `by_power` where each of them states its power."""
    stated = sum(map(_is_stated, parts))
    names = _joined([part.name for part in parts])
    if len(parts) < 2 or 0 < stated < len(parts):
        return names
    return names + (by_power if stated else " in equal parts")


def _remarks(drivers: Parts, balance: Balance, operation: Operation) -> str:
    """Return what the powers of drivers are not, and what cylinders that do not fire take from the loads."""
    remarks = ""
    rated = operation.rated
    power = None if rated is None else rated.power
    powers = [part.machine.power for part in drivers if part.machine and part.machine.power]
    is_known = power is not None and len(powers) == len(drivers) > 0
    if power is not None and is_known and abs(sum(powers) - power) > SAME_POWER * power:
        subject, use = "The power of the motor", "is not used"
        if len(powers) > 1:
            subject, use = "The powers of the motors, together", "say their shares alone"
        remarks = f" {subject} ({_in_kw(sum(powers))}) {use}: the torque follows from the rated {_in_kw(power)}."
    share = float(balance.delivered)
    if rated is None or abs(share - 1.0) <= SAME_SHARE:
        return remarks
    point = np.array([rated.speed])
    if any(uncovered(load.law.table, point, load.about) for load in balance.loads):
        return remarks
    full = _total(balance.loads, rated.speed) * rated.speed
    change = "rise alike"
    if share < 1.0:
        change = "fall alike (`keep_power: true` of the engine keeps them)"
    enters = f"{_in_kw(share * full)} of {_in_kw(full)} enter at the rated speed"
    return f"{remarks} Not every cylinder fires as the others: {enters}, and all loads {change}."


def _joined(words: list[str]) -> str:
    return ", ".join(words[:-1]) + " and " + words[-1] if len(words) > 1 else "".join(words)


def _in_kw(power: float) -> str:
    return f"{power / 1e3:.6g} kW"
