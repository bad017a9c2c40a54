"""Slopes of the laws of load and drive: what their mean torques answer to a change of the mean speed.

A slope is -dT/dω of a drive and +dT/dω of a load, at own speed; a positive one damps.
"""

import numpy as np

from torsion.analyses.power_balance import Balance, interpolated, power_balance, uncovered
from torsion.arrays import FloatArray
from torsion.errors import Fault, InputError
from torsion.model.machine_torques import DriveLaw
from torsion.model.parts import Part
from torsion.study import Operation, Study
from torsion.train import Train

SAME_TORQUE = 0.01  # relative: what the table of a drive may miss of the balance at the rated speed


def driven_by_law(train: Train) -> list[tuple[Part, DriveLaw]]:
    """Return the machines that drive by a law of the file, each with that law."""
    return [
        (part, part.machine.drive)
        for part in train.parts
        if part.machine is not None and part.machine.drive
    ]


def mean_speed_slopes(study: Study) -> dict[str, str]:
    """Return who drives or absorbs by a slope that acts on the mean speed alone, each with the key that it lacks."""
    lacking = {
        part.name: "lag"
        for part, law in driven_by_law(study.train)
        if law.law is None and law.lag is None
    }
    if not study.has_mean_torque:
        return lacking
    damped = {damper.station for damper in study.train.dampers}
    for load in power_balance(study.train, study.operation).loads:
        has_slope = load.law.exponent != 0
        if load.law.table:
            has_slope = len({torque for _, torque in load.law.table}) > 1
        for station, _ in load.stations:
            if has_slope and station not in damped:
                part = study.train.parts[study.train.stations[station].part]
                lacking[part.name] = "damping: law"
    return lacking


def slopes_of_laws(
    train: Train, operation: Operation, balance: Balance, ratio: FloatArray, speed: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the slopes (stations, speeds) N m s/rad of the loads, and of the drives, at reference speeds (rad/s).

    A drive with a lag has none here: it is a damper of the train. ratio: (stations,) own speed / reference speed.
    """
    loads, drives = np.zeros((2, len(ratio), len(speed)))
    for load in balance.loads:
        at_reference = load.law.slope(speed, load.speed, load.torque)
        for station, share in load.stations:
            loads[station] += float(share * balance.delivered) * at_reference / ratio[station] ** 2
    for part, law in driven_by_law(train):
        if law.lag is None:
            station = part.stations[0]
            rated_speed, rated_torque = rated_point(part, operation, balance)
            drives[station] += law.slopes(speed * abs(ratio[station]), rated_torque, rated_speed)
    return loads, drives


def rated_point(part: Part, operation: Operation, balance: Balance) -> tuple[float, float]:
    """Return own speed (rad/s) and torque (N m) of a machine that drives: as it states them, else by the balance.

    Raises InputError where neither its own speed nor that of the operation is rated.
    """
    machine = part.machine
    ratio = abs(float(part.ratio))
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
    """Return why a law of drive contradicts the speeds and the balance of power of the file."""
    faults = list[Fault]()
    operation = study.operation
    if not study.has_mean_torque:
        message = "the law of a drive needs the mean torque"
        hint = "give the rated power, or the power of the loads"
        return [
            Fault((*part.path, "drive"), message, hint)
            for part, law in driven_by_law(study.train)
            if not law.law
        ]
    try:
        balance = power_balance(study.train, operation)
    except InputError:  # which the faults of the power report
        return []
    for part, law in driven_by_law(study.train):
        try:
            _, torque = rated_point(part, operation, balance)
        except InputError as error:
            faults += error.faults
            continue
        kloss = law.rated_torque()
        if law.torque is not None:
            about = Fault(
                (*part.path, "drive", "torque"), f"the table of the drive of '{part.name}'"
            )
            ratio = abs(float(part.ratio))
            points = np.array([] if operation.rated is None else [operation.rated.speed])
            if operation.speeds is not None:
                points = np.append(points, [operation.speeds.first, operation.speeds.last])
            lacking = uncovered(law.torque, points * ratio, about)
            faults += lacking
            if lacking or operation.rated is None:
                continue
            needed = float(balance.applied(part.stations[0], points[:1])[0]) / ratio
            given = float(interpolated(law.torque, points[:1] * ratio, about)[0])
            if abs(given - needed) > SAME_TORQUE * abs(needed):
                message = f"{about.message} gives {given:.6g} N m at the rated speed"
                hint = "correct the table or the loads; they have to agree within 1 %"
                message += f", the loads take {needed:.6g} N m"
                faults.append(Fault(about.path, message, hint))
        elif kloss is not None and abs(kloss - torque) > SAME_TORQUE * abs(torque):
            message = f"the law of the drive of '{part.name}' gives {kloss:.6g} N m at its slip at the rated speed"
            message += f", the loads take {torque:.6g} N m"
            hint = "correct slip, pull-out torque or the loads; they have to agree within 1 %"
            faults.append(Fault((*part.path, "drive", "slip"), message, hint))
    if study.setting("analyses", "transient") is None:
        return faults
    for part, law in driven_by_law(study.train):
        if law.law != "torque":
            message = f"the `drive` of '{part.name}' follows the mean speed and does not act in a transient response"
            hint = "an event `start` with its torque over speed follows the vibration too; else leave `drive` out"
            faults.append(Fault((*part.path, "drive"), message, hint))
    return faults


def slopes_without_vibration(study: Study) -> list[tuple[str, float, str]]:
    """Return the machines whose stated law has a slope that does not act in vibration, with it and the key it lacks.

    The slope is in N m s/rad at own speed.
    """
    operation = study.operation
    lacking = mean_speed_slopes(study)
    if not study.has_mean_torque or operation.speed is None:
        return []
    balance = power_balance(study.train, operation)
    speed = np.array([operation.speed])
    ratio = np.array([float(station.ratio) for station in study.train.stations])
    loads, drives = slopes_of_laws(study.train, operation, balance, ratio, speed)
    return [
        (part.name, slope, lacking[part.name])
        for part in study.train.parts
        if part.machine and (part.machine.drive or part.machine.load) and part.name in lacking
        if (slope := float((loads + drives)[part.stations[0], 0]))
    ]
