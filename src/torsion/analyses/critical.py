"""Critical speeds: where an order that excites the train meets one of its natural frequencies."""

import math
from fractions import Fraction
from typing import TYPE_CHECKING

from torsion.analyses.damped_modes import DampedModes
from torsion.analyses.response.harmonic_components import Line, lines
from torsion.analyses.undamped_modes import Modes
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Operation

if TYPE_CHECKING:
    from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed


@reported
class CriticalSpeed:
    """One crossing of the Campbell diagram."""

    mode: int = result("", (), "counted from 1")
    order: Fraction = result("", (), "per revolution of the reference, exact")
    sources: tuple[str, ...] = result("", (), "what excites that order")
    frequency: float = result("Hz", (), "natural frequency")
    speed: float = result("rad/s", (), "reference speed")
    is_inside: bool = result("", (), "within the speed range", key="is_in_range")
    margin: float | None = result(
        "1",
        (),
        "distance from the rated speed or the nearest end of the range, relative; null if neither is given",
    )
    own_orders: tuple[Fraction, ...] = result(
        "", (), "of each source per revolution of the shaft of the source, exact", default=()
    )

    @property
    def line(self) -> Line:
        """What excites."""
        return Line(self.order, None, self.sources, self.own_orders)


@reported
class CriticalSpeeds:
    """Every crossing, by ascending speed."""

    crossings: tuple[CriticalSpeed, ...] = result(
        "", (), "crossings of an order with a mode, by speed", key=""
    )


def critical_speeds(
    modes: Modes | DampedModes, lines: tuple[Line, ...], operation: Operation
) -> tuple[CriticalSpeed, ...]:
    """Every crossing of an order with a mode, by ascending speed; fixed frequencies cross nothing."""
    speeds, found = operation.speeds, []
    for line in lines:
        if line.order is None:
            continue
        for mode, frequency in enumerate(modes.frequency.tolist(), start=1):
            speed = 2.0 * math.pi * frequency / float(line.order)
            inside = speeds is not None and speeds.first <= speed <= speeds.last
            at = frequency, speed, inside, _margin(speed, operation)
            found.append(CriticalSpeed(mode, line.order, line.sources, *at, line.own_orders))
    return tuple(sorted(found, key=lambda crossing: (crossing.speed, crossing.mode)))


def critical_by_torque(
    found: "FrequenciesOverSpeed", lines: tuple[Line, ...], operation: Operation
) -> tuple[CriticalSpeed, ...]:
    """The same within the speed range, of modes whose frequencies follow the speed."""
    met = [
        CriticalSpeed(
            mode,
            line.order,
            line.sources,
            hertz,
            speed,
            True,
            _margin(speed, operation),
            line.own_orders,
        )
        for line in lines
        if line.order is not None
        for mode, speed, hertz in found.crossings(line.order)
    ]
    return tuple(sorted(met, key=lambda crossing: (crossing.speed, crossing.mode)))


def _margin(speed: float, operation: Operation) -> float | None:
    """Relative distance from the rated speed, else from the nearest end of the range."""
    if operation.rated is not None:
        return (speed - operation.rated.speed) / operation.rated.speed
    if operation.speeds is None:
        return None
    end = min(operation.speeds.first, operation.speeds.last, key=lambda end: abs(end - speed))
    return (speed - end) / end


def run(work: Work) -> None:
    """Where orders excite and modes were found."""
    modes, harmonics = work.get(Modes), lines(work.system)
    found: tuple[CriticalSpeed, ...] = ()
    if modes is None or not any(line.order is not None for line in harmonics):
        work.log.without("critical speeds", "no modes" if modes is None else "no order excites")
    elif work.study.train.follows_speed:
        from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed

        over_speed = work.get(FrequenciesOverSpeed)
        work.log.without("critical speeds outside the speed range", "a stiffness follows the speed")
        if over_speed is not None:
            found = critical_by_torque(over_speed, harmonics, work.study.operation)
    else:
        found = critical_speeds(modes, harmonics, work.study.operation)
        if work.study.train.has_tables_over("vibratory torque"):
            why = "a stiffness follows the vibratory torque; the critical speeds are for small vibration"
            work.log.without("critical speeds of large vibration", why)
    work.put(critical_speeds=CriticalSpeeds(found))
