"""What can be told of the mean torque and of tables over speed before anything is computed."""

from collections.abc import Iterator

import numpy as np

from torsion.analyses.power import flow
from torsion.analyses.steady import interpolated
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.primitives import Torque
from torsion.study import Operation, Study
from torsion.train import Train


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
    operation, asked = study.operation, getattr(study.analyses.get("response"), "orders", "all")
    if operation.speeds is None:
        return []
    ends = np.array([operation.speeds.first, operation.speeds.last])
    found: list[Fault] = []
    for torque in _over_speed(study.train, asked):
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
    """rad/s at which the mean torque is told, its ends among them."""
    ends = [] if operation.speeds is None else [operation.speeds.first, operation.speeds.last]
    return np.array([*ends, *([operation.speed] if operation.rated is not None else [])])


def _uncovered(table: tuple[tuple[float, float], ...], speed: FloatArray, about: Fault) -> tuple[Fault, ...]:
    try:
        interpolated(table, speed, about)
    except InputError as error:
        return error.faults
    return ()
