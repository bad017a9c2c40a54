"""Slopes of the laws of load and drive: what their mean torques answer to a change of the mean speed.

A slope is -dT/dω of a drive and +dT/dω of a load, at own speed; a positive one damps.
"""

import numpy as np

from torsion.analyses.loads_and_drivers import Balance
from torsion.analyses.power_balance import power_balance
from torsion.analyses.speed_tables import interpolated, uncovered
from torsion.arrays import FloatArray
from torsion.components.drive_law import DriveLaw
from torsion.components.lowering import Part
from torsion.errors import Fault, InputError
from torsion.study import Operation, Study
from torsion.train import Train

SAME_TORQUE = 0.01  # relative: what the table of a drive may miss of the balance at the rated speed


def driven_by_law(train: Train) -> list[tuple[Part, DriveLaw]]:
    """Return the machines that drive by a law of the file, each with that law."""
    return [(part, part.machine.drive) for part in train.parts if part.machine is not None and part.machine.drive]


def drives_without_lag(train: Train) -> list[str]:
    """Return the names of the machines that drive by a law with a slope, and without a lag."""
    return [part.name for part, law in driven_by_law(train) if law.law is None and law.lag is None]


def load_slopes(balance: Balance, ratio: FloatArray, speed: FloatArray) -> FloatArray:
    """Return the slopes (stations, speeds) N m s/rad of the loads at reference speeds (rad/s).

    ratio: (stations,) own speed / reference speed.
    """
    slopes = np.zeros((len(ratio), len(speed)))
    for load in balance.loads:
        at_reference = load.law.slope(speed, load.speed, load.torque)
        for station, share in load.stations:
            slopes[station] += float(share * balance.delivered) * at_reference / ratio[station] ** 2
    return slopes


def drive_slopes(
    train: Train, operation: Operation, balance: Balance, ratio: FloatArray, speed: FloatArray
) -> FloatArray:
    """Return the slopes (stations, speeds) N m s/rad of the laws of drive; one with a lag is a damper of the train."""
    slopes = np.zeros((len(ratio), len(speed)))
    for part, law in driven_by_law(train):
        if law.lag is None:
            station = part.stations[0]
            rated_speed, rated_torque = rated_point(part, operation, balance)
            slopes[station] += law.slopes(speed * abs(ratio[station]), rated_torque, rated_speed)
    return slopes


def rated_point(part: Part, operation: Operation, balance: Balance) -> tuple[float, float]:
    """Return own speed (rad/s) and torque (N m) of a machine that drives: as it states them, else by the balance.

    Raises InputError where neither its own speed nor that of the operation is rated.
    """
    machine, ratio = part.machine, abs(float(part.ratio))
    rated_speed = None if operation.rated is None else operation.rated.speed * ratio
    speed = (None if machine is None else machine.speed) or rated_speed
    if speed is None:
        message = f"`drive` of '{part.name}' needs a rated speed"
        hint = "give its `power` and `speed`, or `operation: {rated: {speed: ...}}`"
        raise InputError([Fault((*part.path, "drive"), message, hint)])
    torque = None if machine is None else machine.rated_torque(speed)
    if torque is None:
        torque = float(balance.applied(part.stations[0], np.array([speed / ratio]))[0]) / ratio
    return speed, torque


def drive_faults(study: Study) -> list[Fault]:
    """Why a law of drive cannot stand beside the speeds and the balance of power of the file."""
    found, operation = list[Fault](), study.operation
    if not study.has_mean_torque:
        message, hint = "the law of a drive needs the mean torque", "give the rated power, or the power of the loads"
        return [Fault((*part.path, "drive"), message, hint) for part, law in driven_by_law(study.train) if not law.law]
    try:
        balance = power_balance(study.train, operation)
    except InputError:  # which the faults of the power report
        return []
    for part, law in driven_by_law(study.train):
        ratio = abs(float(part.ratio))
        try:
            rated_point(part, operation, balance)
        except InputError as error:
            found += error.faults
            continue
        if law.law_table is None:
            continue
        about = Fault((*part.path, "drive", "torque"), f"the table of the drive of '{part.name}'")
        ends = [] if operation.speeds is None else [operation.speeds.first * ratio, operation.speeds.last * ratio]
        rated = [] if operation.rated is None else [operation.rated.speed * ratio]
        if faults := uncovered(law.law_table, np.array([*ends, *rated]), about):
            found += faults
        elif rated:
            needed = float(balance.applied(part.stations[0], np.array(rated) / ratio)[0]) / ratio
            given = float(interpolated(law.law_table, np.array(rated), about)[0])
            if abs(given - needed) > SAME_TORQUE * abs(needed):
                message = f"{about.message} gives {given:.6g} N m at the rated speed, the loads take {needed:.6g} N m"
                found.append(
                    Fault(about.path, message, "correct the table or the loads; they have to agree within 1 %")
                )
    transient = study.setting("analyses", "transient") is not None
    for part, law in driven_by_law(study.train):
        if transient and law.law != "torque":
            message = f"the law of `drive` of '{part.name}' does not act in a transient response yet"
            hint = "write it as an event with a torque over speed, or leave one of both out"
            found.append(Fault((*part.path, "drive"), message, hint))
    return found


def slopes_without_vibration(study: Study) -> list[tuple[str, float]]:
    """Return the machines whose stated law has a slope that does not act in vibration, with it (N m s/rad)."""
    operation = study.operation
    if not study.has_mean_torque or operation.speed is None:
        return []
    balance, speed = power_balance(study.train, operation), np.array([operation.speed])
    ratio = np.array([float(station.ratio) for station in study.train.stations])
    drive = drive_slopes(study.train, operation, balance, ratio, speed)[:, 0]
    load = load_slopes(balance, ratio, speed)[:, 0]
    damped = {damper.station for damper in study.train.dampers}
    found = [(part.name, float(drive[part.stations[0]])) for part, law in driven_by_law(study.train)]
    found += [
        (part.name, float(load[part.stations[0]]))
        for part in study.train.parts
        if part.machine is not None and part.machine.load is not None and part.stations[0] not in damped
    ]
    return [(name, slope) for name, slope in found if slope]
