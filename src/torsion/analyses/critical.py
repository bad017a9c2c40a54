"""Critical speeds: where an order that excites the train meets one of its natural frequencies."""

import math
from collections.abc import Iterable
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

    mode: int = result("", "counted from 1")
    order: Fraction = result("", "per revolution of the reference, exact")
    sources: tuple[str, ...] = result("", "what excites that order")
    frequency: float = result("Hz", "natural frequency")
    speed: float = result("rad/s", "reference speed")
    is_inside: bool = result("", "within the speed range", key="is_in_range")
    margin: float | None = result(
        "1",
        "distance from the rated speed or the nearest end of the range, relative; null if neither is given",
    )
    own_orders: tuple[Fraction, ...] = result(
        "", "of each source per revolution of the shaft of the source, exact", default=()
    )

    @property
    def line(self) -> Line:
        """The harmonic component that excites."""
        return Line(self.order, None, self.sources, self.own_orders)


@reported
class CriticalSpeeds:
    """Every crossing, by ascending speed."""

    crossings: tuple[CriticalSpeed, ...] = result(
        "", "crossings of an order with a mode, by speed", key=""
    )


def critical_speeds(
    modes: Modes | DampedModes, lines: tuple[Line, ...], operation: Operation
) -> tuple[CriticalSpeed, ...]:
    """Return every crossing of an order with a mode, by ascending speed; fixed frequencies cross nothing."""
    frequencies = list(enumerate(modes.frequency.tolist(), start=1))
    return _ascending(
        _crossing(
            line, line.order, mode, 2.0 * math.pi * hertz / float(line.order), hertz, operation
        )
        for line in lines
        if line.order is not None
        for mode, hertz in frequencies
    )


def critical_by_torque(
    curves: "FrequenciesOverSpeed", lines: tuple[Line, ...], operation: Operation
) -> tuple[CriticalSpeed, ...]:
    """Return the crossings within the speed range, of modes whose frequencies follow the speed."""
    return _ascending(
        _crossing(line, line.order, mode, speed, hertz, operation)
        for line in lines
        if line.order is not None
        for mode, speed, hertz in curves.crossings(line.order)
    )


def _ascending(crossings: Iterable[CriticalSpeed]) -> tuple[CriticalSpeed, ...]:
    return tuple(sorted(crossings, key=lambda crossing: (crossing.speed, crossing.mode)))


def _crossing(
    line: Line, order: Fraction, mode: int, speed: float, hertz: float, operation: Operation
) -> CriticalSpeed:
    """Return a crossing, with its distance from the rated speed, else from the nearest end of the range."""
    speeds = operation.speeds
    margin = None
    inside = speeds is not None and speeds.first <= speed <= speeds.last
    near = None if operation.rated is None else operation.rated.speed
    if near is None and speeds is not None:
        near = min(speeds.first, speeds.last, key=lambda end: abs(end - speed))
    if near is not None:
        margin = (speed - near) / near
    return CriticalSpeed(mode, order, line.sources, hertz, speed, inside, margin, line.own_orders)


def run(work: Work) -> None:
    """Put the critical speeds where orders excite and modes were computed."""
    modes = work.get(Modes)
    components = lines(work.system)
    operation = work.study.operation
    crossings: tuple[CriticalSpeed, ...] = ()
    if modes is None or not any(line.order is not None for line in components):
        work.log.without("critical speeds", "no modes" if modes is None else "no order excites")
    elif work.study.train.follows_speed:
        from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed

        work.log.without("critical speeds outside the speed range", "a stiffness follows the speed")
        if (curves := work.get(FrequenciesOverSpeed)) is not None:
            crossings = critical_by_torque(curves, components, operation)
    else:
        crossings = critical_speeds(modes, components, operation)
        if work.study.train.has_tables_over("vibratory torque"):
            why = "a stiffness follows the vibratory torque; the critical speeds are for small vibration"
            work.log.without("critical speeds of large vibration", why)
    work.put(critical_speeds=CriticalSpeeds(crossings))
