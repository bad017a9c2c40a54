"""Critical speeds: where an order that excites the train meets one of its natural frequencies."""

import math
from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import TYPE_CHECKING

from torsion.analyses.undamped_modes import Modes
from torsion.findings import Work
from torsion.results import reported, result
from torsion.study import Operation

if TYPE_CHECKING:
    from torsion.analyses.damped_modes import DampedModes
    from torsion.analyses.response.harmonic_components import Line


@reported
class CriticalSpeed:
    """One crossing of the Campbell diagram."""

    mode: int = result("counted from 1")
    order: Fraction = result("per revolution of the reference, exact")
    sources: tuple[str, ...] = result("what excites that order")
    frequency: float = result("Hz", "natural frequency")
    speed: float = result("rad/s", "reference speed")
    is_inside: bool = result("within the speed range", key="is_in_range")
    margin: float | None = result(
        "1",
        "distance from the rated speed or the nearest end of the range, relative; null if neither is given",
    )
    own_orders: tuple[Fraction, ...] = result(
        "of each source per revolution of the shaft of the source, exact", default=()
    )

    @property
    def line(self) -> "Line":
        """The harmonic component that excites."""
        from torsion.analyses.response.harmonic_components import Line

        return Line(self.order, None, self.sources, self.own_orders)


@reported
class CriticalSpeeds:
    """Every crossing, by ascending speed."""

    crossings: tuple[CriticalSpeed, ...] = result(
        "crossings of an order with a mode, by speed", key=""
    )


def critical_speeds(
    modes: "Modes | DampedModes", lines: "tuple[Line, ...]", operation: Operation
) -> tuple[CriticalSpeed, ...]:
    """Return every crossing of an order with a mode, by ascending speed; fixed frequencies cross nothing."""
    frequencies = list(enumerate(modes.frequency.tolist(), start=1))
    return _ascending(
        lines,
        lambda order: (
            (mode, 2.0 * math.pi * hertz / float(order), hertz) for mode, hertz in frequencies
        ),
        operation,
    )


def _ascending(
    lines: "tuple[Line, ...]",
    crossings: Callable[[Fraction], Iterable[tuple[int, float, float]]],
    operation: Operation,
) -> tuple[CriticalSpeed, ...]:
    """Return the crossings of all orders by speed, each with its distance from the rated speed, else from the range.

    crossings: mode, speed (rad/s) and frequency (Hz) of every crossing of an order.
    """
    speeds = operation.speeds
    rows = []
    for line in lines:
        if (order := line.order) is None:
            continue
        for mode, speed, hertz in crossings(order):
            is_inside = speeds is not None and speeds.first <= speed <= speeds.last
            near = None if operation.rated is None else operation.rated.speed
            if near is None and speeds is not None:
                near = min(speeds.first, speeds.last, key=lambda end: abs(end - speed))
            margin = None if near is None else (speed - near) / near
            values = hertz, speed, is_inside, margin
            rows.append(CriticalSpeed(mode, order, line.sources, *values, line.own_orders))
    return tuple(sorted(rows, key=lambda crossing: (crossing.speed, crossing.mode)))


def run(work: Work) -> None:
    """Put the critical speeds where orders excite and modes were computed."""
    modes = work.get(Modes)
    components: tuple[Line, ...] = ()
    if work.study.excites:
        from torsion.analyses.response.harmonic_components import lines

        components = lines(work.system)
    operation = work.study.operation
    crossings: tuple[CriticalSpeed, ...] = ()
    if modes is None or not any(line.order is not None for line in components):
        work.log.without("critical speeds", "no modes" if modes is None else "no order excites")
    elif work.study.train.follows_speed:
        from torsion.analyses.modes.frequencies_by_torque import FrequenciesOverSpeed

        work.log.without("critical speeds outside the speed range", "a stiffness follows the speed")
        if (curves := work.get(FrequenciesOverSpeed)) is not None:
            crossings = _ascending(components, curves.crossings, operation)
    else:
        crossings = critical_speeds(modes, components, operation)
        if work.study.train.has_tables_over("vibratory torque"):
            why = "a stiffness follows the vibratory torque; the critical speeds are for small vibration"
            work.log.without("critical speeds of large vibration", why)
    work.put(critical_speeds=CriticalSpeeds(crossings))
