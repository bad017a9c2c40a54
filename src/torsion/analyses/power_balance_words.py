"""The balance of power in sentences: who drives, who absorbs, and how several share."""

from collections.abc import Sequence

import numpy as np

from torsion.analyses.loads_and_drivers import Balance, Load
from torsion.components.lowering import Part
from torsion.study import Operation

SAME_POWER = 0.01  # relative: the sum of rounded ratings that is still the rated power
SAME_SHARE = 1e-9  # relative: the shares of cylinders whose heat only rounding takes from the whole


def loads_in_words(loads: Sequence[Load], absorbers: Sequence[Part], *, has_sizes: bool) -> str:
    """The loads by name, where they state their power with that."""
    if not has_sizes:
        equal = " in equal parts" if len(absorbers) > 1 and absorbers[0].machine is not None else ""
        return names_of(absorbers) + equal
    words = []
    for load in loads:
        size = "table" if load.law.table else f"{in_kw(load.torque * load.speed)}, {load.law.words}"
        if load.parts[0].compressor is not None:
            size = "by its pressures"
        rest = "the rest" + (" in equal parts, " if len(load.parts) > 1 else ", ") if load.is_free else ""
        words.append(f"{names_of(load.parts)} ({rest}{size})")
    return _joined(words)


def sharing_in_words(drivers: Sequence[Part]) -> str:
    """How several machines that drive share the loads, in words."""
    stated = [part for part in drivers if (part.machine is not None and part.machine.is_stated)]
    if not stated:
        return " in equal parts"
    if len(stated) == len(drivers):
        return " in proportion to their power"
    sizes = _joined([f"{part.name} {size_of(part)}" for part in stated])
    return f" ({sizes}, and in this share at every speed)"


def ratings_in_words(drivers: Sequence[Part], operation: Operation) -> str:
    """What the powers of drivers are not, where together they are not the rated power."""
    given = [part.machine.power for part in drivers if part.machine is not None and part.machine.power is not None]
    rated = None if operation.rated is None else operation.rated.power
    if len(given) < len(drivers) or not given or rated is None or abs(sum(given) - rated) <= SAME_POWER * rated:
        return ""
    together = "The power of the motor" if len(given) == 1 else "The powers of the motors, together"
    used = "is not used" if len(given) == 1 else "say their shares alone"
    return f" {together} ({sum(given) / 1e3:.6g} kW) {used}: the torque follows from the rated {rated / 1e3:.6g} kW."


def lacking_in_words(balance: Balance, operation: Operation) -> str:
    """What cylinders that do not fire take from the loads, in kW at the rated point."""
    share, rated = float(balance.delivered), operation.rated
    if rated is None or abs(share - 1.0) <= SAME_SHARE:
        return ""
    speed = np.array([rated.speed])
    if any(load.faults(speed) for load in balance.loads):
        return ""
    full = float(balance.full_torque(speed)[0]) * rated.speed
    falls = "fall alike (`keep_power: true` of the engine keeps them)" if share < 1.0 else "rise alike"
    fired = f"{in_kw(share * full)} of {in_kw(full)} enter at the rated speed"
    return f" Not every cylinder fires as the others: {fired}, and all loads {falls}."


def size_of(part: Part) -> str:
    machine = part.machine
    if machine is None or (machine.power is None and machine.torque is None):
        return "its table"
    return in_kw(machine.power) if machine.power is not None else f"{machine.torque:.6g} N m"


def names_of(parts: Sequence[Part], *, quote: bool = False) -> str:
    return _joined([f"'{part.name}'" if quote else part.name for part in parts])


def _joined(words: list[str]) -> str:
    return ", ".join(words[:-1]) + " and " + words[-1] if len(words) > 1 else "".join(words)


def in_kw(power: float) -> str:
    return f"{power / 1e3:.6g} kW"
