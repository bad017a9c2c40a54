"""Centrifugal pendulums: the inertia that each order of their shaft meets, and the deflection of the bobs."""

import math
from fractions import Fraction

import numpy as np

from torsion.analyses.response.amplitudes import Response
from torsion.analyses.response.harmonic_components import lines
from torsion.arrays import FloatArray
from torsion.assembly.system import System
from torsion.errors import SolveError
from torsion.findings import Work
from torsion.model.parts import PendulumRecord
from torsion.results import reported, result

MOST = math.pi / 2.0  # rad of deflection from which no torque of a linear pendulum is an answer
FIXED = 1e-9  # of n/q - 1: nearer to its own order a pendulum fixes its carrier


@reported
class PendulumAtOrder:
    """A pendulum at one order that excites the train."""

    order: Fraction = result("", "cycles per revolution of the shaft that carries it, exact")
    inertia: float | None = result(
        "kg*m**2",
        "of the bobs as that order meets it at the carrier, m (R + l)^2/(1 - n^2/q^2); null: it is fixed",
    )
    deflection: float | None = result(
        "rad",
        "largest deflection of a bob from the radius by that order, amplitude (zero to peak); null: no response",
    )
    speed: float | None = result("rad/s", "reference speed of that")


@reported
class Pendulum:
    """One pendulum."""

    pendulum: str = result("", "its name")
    tuned: float = result(
        "", "order of the carrying shaft to which it is tuned, q = sqrt(R/l)", key="tuned_order"
    )
    inertia: float = result("kg*m**2", "of all bobs about the axis, m (R + l)^2, at its own speed")
    deflection: float | None = result(
        "rad",
        "largest deflection of a bob from the radius by all harmonic components, magnitudes added",
    )
    speed: float | None = result("rad/s", "reference speed of that")
    at_orders: tuple[PendulumAtOrder, ...] = result("", "by order that excites")


@reported
class Pendulums:
    """All pendulums of the train."""

    each: tuple[Pendulum, ...] = result("", "pendulums")
    speed: float | None = result(
        "rad/s",
        "reference speed of modes and of other results without a speed",
        key="modes_at_rad_per_s",
    )


def effective_inertia(record: PendulumRecord, order: Fraction) -> float | None:
    """Return the inertia (kg m2) that an order of its shaft meets; None where it fixes the carrier.

    >>> bobs = PendulumRecord(math.sqrt(8.0), None, 0.0081, 9.0)
    >>> [round(effective_inertia(bobs, Fraction(n)), 12) for n in (2, 3, 4)]
    [0.0162, -0.0648, -0.0081]
    """
    if order == record.exact or abs(float(order) / record.order - 1.0) < FIXED:
        return None
    return record.inertia / (1.0 - (float(order) / record.order) ** 2)


def deflections(
    system: System, response: Response, span: int, record: PendulumRecord
) -> FloatArray:
    """Return the deflection (speeds, lines) rad of the bobs, from the torque of the span that stands for their field."""
    w = 2.0 * math.pi * response.frequency
    stiffness, loss = system.elastic(span, w, None, response.speed[:, None])
    return record.lever * np.abs(response.torque[:, :, span]) / np.hypot(stiffness, loss)


def _pendulum(
    system: System, span: int, record: PendulumRecord, response: Response | None
) -> Pendulum:
    ratio = system.stations[system.spans[span].driving].ratio
    name = system.train.parts[system.spans[span].part].name
    orders = [line.order / ratio for line in lines(system) if line.order is not None]
    if response is None:
        rows = [PendulumAtOrder(n, effective_inertia(record, n), None, None) for n in orders]
        return Pendulum(name, record.order, record.inertia, None, None, tuple(rows))
    angles = deflections(system, response, span, record)
    rows = []
    for line, deflection in zip(response.lines, angles.T, strict=True):
        if line.order is not None:
            worst = int(np.argmax(deflection))
            n = line.order / ratio
            largest = float(deflection[worst]), float(response.speed[worst])
            rows.append(PendulumAtOrder(n, effective_inertia(record, n), *largest))
    total = angles.sum(axis=1)
    worst = int(np.argmax(total))
    if total[worst] > MOST:
        degrees = math.degrees(total[worst])
        rpm = response.speed[worst] * 30.0 / math.pi
        message = f"the bobs of '{name}' would be deflected by {degrees:.4g} degrees at {rpm:.5g} rpm: that is not linear"
        path = system.train.parts[system.spans[span].part].path
        raise SolveError(
            message, "heavier bobs, more of them, a longer arm, or speeds that begin higher", path
        )
    return Pendulum(
        name,
        record.order,
        record.inertia,
        float(total[worst]),
        float(response.speed[worst]),
        tuple(rows),
    )


def run(work: Work) -> None:
    """Put every pendulum, with its deflection where there is a response."""
    response = work.get(Response)
    system = work.system if response is None else response.system
    pendulums = [
        _pendulum(system, span, record, response)
        for span, table in sorted(system.tables.items())
        if table.over == "speed"
        if (record := system.train.parts[system.spans[span].part].pendulum) is not None
    ]
    work.put(pendulums=Pendulums(tuple(pendulums), work.study.operation.speed))
