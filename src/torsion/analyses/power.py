"""Where the power enters the train and where it leaves it, and in which shares."""

from dataclasses import dataclass
from fractions import Fraction

from torsion.components.lowering import Part
from torsion.errors import Fault, InputError
from torsion.study import Operation
from torsion.train import Train

Shared = list[tuple[int, Fraction]]  # stations with their shares of the power
SAME_POWER = 0.01  # relative: the sum of rounded ratings of motors that is still the rated power


@dataclass(frozen=True)
class Flow:
    """Stations that drive and that absorb the power, with their shares of it, and all of that in a sentence."""

    drives: Shared
    loads: Shared
    told: str


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
    told = f"The mean torque enters at {driving} and leaves at {loading}."
    return Flow(drives, loads, told + _shares_alone(motors, operation))


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
