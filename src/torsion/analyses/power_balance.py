"""Who drives and who absorbs: the balance of power at every speed, in which exactly one side is free."""

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from torsion.analyses.loads_and_drivers import OF_OPERATION, Balance, Driver, Load, Shared
from torsion.errors import Fault, InputError
from torsion.model.load_law import LoadLaw
from torsion.model.lowering import Part
from torsion.model.machine_records import MachineRecord
from torsion.study import Operation, Study
from torsion.train import Train

SAME_POWER = 0.01  # relative: the sum of rounded ratings that is still the rated power
SAME_SHARE = 1e-9  # relative: the shares of cylinders whose heat only rounding takes from the whole


def power_balance(train: Train, operation: Operation) -> Balance:
    """Return the balance of power; raises InputError where the file does not say it, or says it twice."""
    drivers = [part for part in train.parts if part.machine is not None and part.machine.is_driver]
    absorbers = [
        part for part in train.parts if part.machine is not None and not part.machine.is_driver
    ]
    compressors = [part for part in train.parts if part.compressor is not None]
    stated = [_stated_load(part, operation) for part in absorbers if _is_stated(part)]
    rest = tuple(part for part in absorbers if not _is_stated(part))
    if absorbers:
        stated += [_pressures(part) for part in compressors if _has_pressures(part)]
        rest += tuple(part for part in compressors if not _has_pressures(part))
    loads = _loads(train, operation, stated, rest, compressors)
    if not drivers and stated:
        hint = "name what drives a `motor`, `turbine` or `engine`"
        raise InputError(
            [Fault(stated[0].parts[0].path, "every machine absorbs; nothing drives", hint)]
        )

    first, last = _ends(train)
    entering, leaving = (
        _names_of(drivers),
        _loads_in_words(loads, absorbers or compressors, has_sizes=bool(stated)),
    )
    driving = _drivers(drivers, loads, operation)
    if not drivers:
        taken = [station for load in loads for station, _ in load.stations]
        station, entering = _at_an_end(
            (first, last), taken, ("motor", "propeller"), train, operation
        )
        driving = [Driver(None, [(station, Fraction(1))], is_free=False)]
    elif len(drivers) > 1:
        entering += _sharing_in_words(drivers)
    if not loads[0].stations:
        taken = [station for driver in driving for station, _ in driver.stations]
        station, leaving = _at_an_end(
            (last, first), taken, ("propeller", "motor"), train, operation
        )
        loads = [Load((), [(station, Fraction(1))], loads[0].law, loads[0].torque, loads[0].speed)]
    sentence = f"The mean torque enters at {entering} and leaves at {leaving}."
    balance = Balance(
        tuple(loads),
        tuple(driving),
        len(train.stations),
        sentence + _ratings_in_words(drivers, operation),
    )
    return Balance(
        balance.loads,
        balance.drivers,
        balance.stations,
        balance.sentence + _lacking_in_words(balance, operation),
    )


def rated_power(study: Study) -> float | None:
    """Return the rated power (W), else that of all loads at the rated speed; None where neither is known."""
    rated = study.operation.rated
    if (
        rated is None
        or rated.power is not None
        or study.operation.load.table
        or not study.has_mean_torque
    ):
        return None if rated is None else rated.power
    return (
        float(power_balance(study.train, study.operation).full_torque(np.array([rated.speed]))[0])
        * rated.speed
    )


def _is_stated(part: Part) -> bool:
    """The file states what this machine absorbs or delivers."""
    return part.machine is not None and part.machine.is_stated


def _loads(
    train: Train,
    operation: Operation,
    stated: list[Load],
    rest: tuple[Part, ...],
    compressors: Sequence[Part],
) -> list[Load]:
    """The stated loads and the free one; a free one without stations stands for an end of the train."""
    if not stated:
        if not rest and compressors:
            return [_whole_load(operation, tuple(compressors), _by_pressures(compressors))]
        _refuse_unlike(train, operation, rest)
        return [_whole_load(operation, rest, _equally(rest))]
    if operation.load.table:
        message = "a table of `load` is the total, and loads of the train state their power"
        raise InputError(
            [
                Fault(
                    OF_OPERATION, message, "give the table to one machine, or leave their power out"
                )
            ]
        )
    rated = operation.rated
    power = None if rated is None else rated.power
    if rest and (rated is None or power is None):
        message = f"'{rest[0].name}' has no `power`, and `rated` has no power from which its share could follow"
        raise InputError(
            [Fault(rest[0].path, message, "give it its `power`, or give `operation.rated.power`")]
        )
    if rated is None or power is None:
        return stated
    taken = float(sum(load.torque_at(np.array([rated.speed]))[0] for load in stated)) * rated.speed
    if rest and taken < power:
        _refuse_unlike(train, operation, rest)
        torque = (power - taken) / rated.speed
        return [
            *stated,
            Load(
                rest, _equally(rest), law_of(rest[0], operation), torque, rated.speed, is_free=True
            ),
        ]
    if rest or abs(taken - power) > SAME_POWER * power:
        message = f"the loads absorb {_in_kw(taken)}, `rated` has {_in_kw(power)}"
        hint = "leave out the power of the one that takes the rest, or correct one"
        hint += "; make a machine that drives a `motor`" if rest else ""
        raise InputError([Fault(("operation", "rated", "power"), message, hint)])
    return stated


def _whole_load(operation: Operation, parts: tuple[Part, ...], stations: Shared) -> Load:
    """What takes the whole rated power, or the table of the operation."""
    own = next(
        (part for part in parts if part.machine is not None and part.machine.load is not None), None
    )
    if operation.load.table:
        if own is not None:
            message = f"`load` of '{own.name}' and a table of `operation.load` exclude each other"
            raise InputError([Fault((*own.path, "load"), message, "keep one of them")])
        return Load(parts, stations, operation.load, is_free=True)
    rated = operation.rated
    if rated is None or rated.power is None:
        hint = "for example `rated: {speed: 1500 rpm, power: 100 kW}`"
        raise InputError(
            [Fault(("operation", "rated"), "the mean torque needs the rated power", hint)]
        )
    law = law_of(parts[0], operation) if parts else operation.load
    return Load(parts, stations, law, rated.power / rated.speed, rated.speed, is_free=True)


def law_of(part: Part, operation: Operation) -> LoadLaw:
    """Return the law of a load: its own, that of the operation where the file gives it, that of its kind."""
    machine = part.machine or MachineRecord(is_driver=False)
    if machine.load is not None:
        return machine.load
    law: LoadLaw = operation.load
    return (
        law
        if "load" in operation.model_fields_set or machine.usual_load is None
        else machine.usual_load
    )


def _stated_load(part: Part, operation: Operation) -> Load:
    """A load by its own `power`, `torque` or table."""
    machine, ratio = part.machine or MachineRecord(is_driver=False), abs(float(part.ratio))
    stations = [(part.stations[0], Fraction(1))]
    if machine.load is not None and machine.load.table:
        table = tuple((speed / ratio, torque * ratio) for speed, torque in machine.load.table)
        return Load((part,), stations, LoadLaw(table=table), path=(*part.path, "load"))
    speed, torque = _rated_point(part, machine, operation)
    law = (
        LoadLaw() if operation.load.table else law_of(part, operation)
    )  # such a table is refused beside it
    return Load((part,), stations, law, torque * ratio, speed / ratio)


def _rated_point(part: Part, machine: MachineRecord, operation: Operation) -> tuple[float, float]:
    """Own speed (rad/s) at which a machine states its torque, and that (N m)."""
    rated = None if operation.rated is None else operation.rated.speed * abs(float(part.ratio))
    speed = machine.speed or rated
    torque = machine.rated_torque(speed or 0.0)
    if speed is None or torque is None:
        key = "power" if machine.torque is None else "torque"
        message = f"`{key}` of '{part.name}' holds at a speed that is not given"
        raise InputError(
            [
                Fault(
                    (*part.path, key),
                    message,
                    "give its `speed`, or `operation: {rated: {speed: ...}}`",
                )
            ]
        )
    return speed, torque


def _has_pressures(part: Part) -> bool:
    """The pressures of a compressor say what it absorbs."""
    return part.compressor is not None and any(
        throw.gas[0].real for throw in part.compressor.throws
    )


def _by_pressures(compressors: Sequence[Part]) -> Shared:
    """Throws with their shares of the power, by the mean torque that their pressures absorb."""
    power = [
        (station, Fraction(torque) * abs(part.ratio) / Fraction(part.compressor.efficiency))
        for part in compressors
        if part.compressor is not None
        for station, torque in part.compressor.absorbs
    ]
    whole = sum((share for _, share in power), Fraction(0))
    return [(station, share / whole) for station, share in power]


def _pressures(part: Part) -> Load:
    """A compressor beside other loads: its pressures absorb one torque at every speed."""
    assert part.compressor is not None
    torque = (
        sum(torque for _, torque in part.compressor.absorbs)
        * abs(float(part.ratio))
        / part.compressor.efficiency
    )
    return Load((part,), _by_pressures([part]), LoadLaw(0.0), torque)


def _equally(parts: Sequence[Part]) -> Shared:
    return [(part.stations[0], Fraction(1, len(parts))) for part in parts]


def _refuse_unlike(train: Train, operation: Operation, parts: Sequence[Part]) -> None:
    """Loads without a power share what is left in equal parts where they are alike, and not otherwise."""
    if len(parts) < 2:
        return
    inertias = dict[int, float]()
    for lump in train.inertias:
        inertias[lump.part] = inertias.get(lump.part, 0.0) + lump.inertia
    features = {
        (
            part.kind,
            abs(part.ratio),
            inertias.get(train.position(part.name), 0.0),
            law_of(part, operation),
        )
        for part in parts
    }
    if len(features) == 1:
        return
    rated = operation.rated
    enters = (
        "the power enters"
        if rated is None or rated.power is None
        else f"{_in_kw(rated.power)} enter"
    )
    message = f"{enters}, and the file does not say how they divide between {_names_of(parts, quote=True)}"
    both = "both" if len(parts) == 2 else "all"
    hint = f"give `power` to {both}, or to all but one and that takes the rest"
    if len(parts) == 2:
        hint = "give `power` to both, or to one of them and the other takes the rest"
    raise InputError([Fault(parts[0].path, message, hint)])


def _drivers(drivers: list[Part], loads: list[Load], operation: Operation) -> list[Driver]:
    """Machines that drive with their shares: in proportion to their power, or all but one by it."""
    if len(drivers) < 2 or not any(map(_is_stated, drivers)):
        is_free = not any(load.is_free for load in loads)
        return [Driver(part, _within(part, Fraction(1, len(drivers))), is_free) for part in drivers]
    free = [part for part in drivers if not _is_stated(part)]
    if not free:
        powers = [
            part.machine.power
            for part in drivers
            if part.machine is not None and part.machine.speed is None
        ]
        weights = [Fraction(power) for power in powers if power is not None]
        if len(weights) < len(drivers):
            weights = [Fraction(_stated_torque(part, operation)[1]) for part in drivers]
        return [
            Driver(part, _within(part, weight / sum(weights)), is_free=False)
            for part, weight in zip(drivers, weights, strict=True)
        ]
    if len(free) > 1:
        stated = next(part for part in drivers if _is_stated(part))
        message = f"{_names_of(free, quote=True)} drive, {'both' if len(free) == 2 else 'all'} without power, in addition to "
        message += f"'{stated.name}' with {_size_of(stated)}"
        raise InputError([Fault(free[0].path, message, "only one machine can be the free one")])
    shares = {
        part.name: _stated_share(part, loads, operation) for part in drivers if part is not free[0]
    }
    left = 1 - sum(shares.values(), Fraction(0))
    if left <= 0:
        message = f"the other machines that drive give all that the loads take, and nothing is left for '{free[0].name}'"
        raise InputError(
            [Fault(free[0].path, message, "correct a power, or make it a machine that absorbs")]
        )
    return [
        Driver(part, _within(part, shares.get(part.name, left)), part is free[0])
        for part in drivers
    ]


def _stated_torque(part: Part, operation: Operation) -> tuple[float, float]:
    """Speed (rad/s) and torque (N m), both of the reference, that a machine states."""
    ratio = abs(float(part.ratio))
    speed, torque = _rated_point(part, part.machine or MachineRecord(is_driver=True), operation)
    return speed / ratio, torque * ratio


def _stated_share(part: Part, loads: Sequence[Load], operation: Operation) -> Fraction:
    """Of the torque of all loads at the speed of its power; it keeps that share at other speeds."""
    speed, torque = _stated_torque(part, operation)
    taken = float(sum(load.torque_at(np.array([speed]))[0] for load in loads))
    return Fraction(torque) / Fraction(taken) if taken else Fraction(1)


def _within(part: Part, share: Fraction) -> Shared:
    """Where a machine's share of the mean torque enters: of an engine at its throws."""
    if part.engine is None:
        return [(part.stations[0], share)]
    return [(station, share * Fraction(own)) for station, own in part.engine.drives]


def _ends(train: Train) -> tuple[int, int]:
    """The first station, and the last of the main line."""
    main = [
        part
        for part in train.parts
        if part.depth == 0 and part.stations and part.path[0] == "train"
    ]
    return 0, main[-1].stations[-1]


def _at_an_end(
    ends: tuple[int, int],
    taken: Sequence[int],
    kinds: tuple[str, str],
    train: Train,
    operation: Operation,
) -> tuple[int, str]:
    """The first of two ends of the main line that is not taken, in place of a kind of component, and that in words.

    kinds: the one that is lacking and the other; raises InputError where both ends are taken.
    """
    free = [end for end in ends if end not in taken]
    if not free:
        where = ("operation", "load" if operation.rated is None else "rated")
        message = (
            f"the mean torque would enter and leave the train at '{train.stations[ends[0]].name}'"
        )
        hint = "name what drives a `motor` and what absorbs the power a `propeller`, or leave the power out"
        raise InputError([Fault(where, message, hint)])
    why = f"there is no {kinds[0]}" + (
        "" if free[0] == ends[0] else f", and the other end is a {kinds[1]}"
    )
    return free[0], f"{train.stations[free[0]].name} ({why})"


def _loads_in_words(loads: Sequence[Load], absorbers: Sequence[Part], *, has_sizes: bool) -> str:
    """The loads by name, where they state their power with that."""
    if not has_sizes:
        equal = " in equal parts" if len(absorbers) > 1 and absorbers[0].machine is not None else ""
        return _names_of(absorbers) + equal
    words = []
    for load in loads:
        size = (
            "table" if load.law.table else f"{_in_kw(load.torque * load.speed)}, {load.law.words}"
        )
        if load.parts[0].compressor is not None:
            size = "by its pressures"
        rest = (
            "the rest" + (" in equal parts, " if len(load.parts) > 1 else ", ")
            if load.is_free
            else ""
        )
        words.append(f"{_names_of(load.parts)} ({rest}{size})")
    return _joined(words)


def _sharing_in_words(drivers: Sequence[Part]) -> str:
    """How several machines that drive share the loads, in words."""
    stated = [part for part in drivers if _is_stated(part)]
    if not stated:
        return " in equal parts"
    if len(stated) == len(drivers):
        return " in proportion to their power"
    sizes = _joined([f"{part.name} {_size_of(part)}" for part in stated])
    return f" ({sizes}, and in this share at every speed)"


def _ratings_in_words(drivers: Sequence[Part], operation: Operation) -> str:
    """What the powers of drivers are not, where together they are not the rated power."""
    given = [
        part.machine.power
        for part in drivers
        if part.machine is not None and part.machine.power is not None
    ]
    rated = None if operation.rated is None else operation.rated.power
    if (
        len(given) < len(drivers)
        or not given
        or rated is None
        or abs(sum(given) - rated) <= SAME_POWER * rated
    ):
        return ""
    together = "The power of the motor" if len(given) == 1 else "The powers of the motors, together"
    used = "is not used" if len(given) == 1 else "say their shares alone"
    return f" {together} ({sum(given) / 1e3:.6g} kW) {used}: the torque follows from the rated {rated / 1e3:.6g} kW."


def _lacking_in_words(balance: Balance, operation: Operation) -> str:
    """What cylinders that do not fire take from the loads, in kW at the rated point."""
    share, rated = float(balance.delivered), operation.rated
    if rated is None or abs(share - 1.0) <= SAME_SHARE:
        return ""
    speed = np.array([rated.speed])
    if any(load.faults(speed) for load in balance.loads):
        return ""
    full = float(balance.full_torque(speed)[0]) * rated.speed
    falls = (
        "fall alike (`keep_power: true` of the engine keeps them)" if share < 1.0 else "rise alike"
    )
    fired = f"{_in_kw(share * full)} of {_in_kw(full)} enter at the rated speed"
    return f" Not every cylinder fires as the others: {fired}, and all loads {falls}."


def _size_of(part: Part) -> str:
    machine = part.machine
    if machine is None or (machine.power is None and machine.torque is None):
        return "its table"
    return _in_kw(machine.power) if machine.power is not None else f"{machine.torque:.6g} N m"


def _names_of(parts: Sequence[Part], *, quote: bool = False) -> str:
    return _joined([f"'{part.name}'" if quote else part.name for part in parts])


def _joined(words: list[str]) -> str:
    return ", ".join(words[:-1]) + " and " + words[-1] if len(words) > 1 else "".join(words)


def _in_kw(power: float) -> str:
    return f"{power / 1e3:.6g} kW"
