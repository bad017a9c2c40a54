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

    order: Fraction = result("cycles per revolution of the shaft that carries it, exact")
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

    pendulum: str = result("its name")
    tuned: float = result(
        "order of the carrying shaft to which it is tuned, q = sqrt(R/l)", key="tuned_order"
    )
    inertia: float = result("kg*m**2", "of all bobs about the axis, m (R + l)^2, at its own speed")
    deflection: float | None = result(
        "rad",
        "largest deflection of a bob from the radius by all harmonic components, magnitudes added",
    )
    speed: float | None = result("rad/s", "reference speed of that")
    at_orders: tuple[PendulumAtOrder, ...] = result("by order that excites")


@reported
class Pendulums:
    """All pendulums of the train."""

    each: tuple[Pendulum, ...] = result("pendulums")
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


def run(work: Work) -> None:
    """Put every pendulum, with its deflection where there is a response."""
    response = work.get(Response)
    system = work.system if response is None else response.system
    pendulums = []
    for span, table in sorted(system.tables.items()):
        part = system.train.parts[system.spans[span].part]
        if table.over != "speed" or (record := part.pendulum) is None:
            continue
        ratio = system.stations[system.spans[span].driving].ratio
        excited = lines(system) if response is None else response.lines
        orders = [None if line.order is None else line.order / ratio for line in excited]
        largest: list[tuple[float | None, float | None]] = [(None, None)] * (len(orders) + 1)
        if response is not None:
            # By order, and the magnitudes of all together.
            angles = deflections(system, response, span, record)
            largest = []
            for deflection in (*angles.T, angles.sum(axis=1)):
                worst = int(np.argmax(deflection))
                largest.append((float(deflection[worst]), float(response.speed[worst])))
        *by_order, (deflected, speed) = largest
        if deflected is not None and speed is not None and deflected > MOST:
            degrees = math.degrees(deflected)
            rpm = speed * 30.0 / math.pi
            message = f"the bobs of '{part.name}' would be deflected by {degrees:.4g} degrees at {rpm:.5g} rpm"
            message += ": that is not linear"
            hint = "heavier bobs, more of them, a longer arm, or speeds that begin higher"
            raise SolveError(message, hint, part.path)
        rows = tuple(
            PendulumAtOrder(order, effective_inertia(record, order), *of_order)
            for order, of_order in zip(orders, by_order, strict=True)
            if order is not None
        )
        row = Pendulum(part.name, record.order, record.inertia, deflected, speed, rows)
        pendulums.append(row)
    work.put(pendulums=Pendulums(tuple(pendulums), work.study.operation.speed))
